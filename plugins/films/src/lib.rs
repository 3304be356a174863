//! Built-in film processes.

#![cfg_attr(not(test), warn(clippy::disallowed_methods))]

mod effects;
mod frame;
mod metering;
mod stock;
mod three_strip;
mod view;

pub use effects::{Assumed, HalationParams, HalationSetting, Off, OpticsParams, OpticsSetting};
pub use frame::{BorderKind, FrameParams};
pub use metering::{Metering, SpotParams};
pub use stock::{StockFilm, StockParams};
pub use three_strip::{RecordParams, ThreeStrip, ThreeStripParams};
pub use view::{PaperParams, View};
