//! Built-in film processes: `stock`, a film from a data file, and `three-strip`, a three-strip camera.

#![cfg_attr(not(test), warn(clippy::disallowed_methods))]

mod camera;
mod described_process;
mod development;
mod effects;
mod frame;
mod metering;
mod misexposure;
mod settings;
mod stock;
mod stocks;
mod three_strip;
mod three_strip_settings;
mod view;

pub use effects::{Assumed, HalationParams, HalationSetting, Off, OpticsParams, OpticsSetting};
pub use frame::{BorderKind, FrameParams};
pub use metering::{Metering, SpotParams};
pub use settings::StockParams;
pub use stock::StockFilm;
pub use three_strip::ThreeStrip;
pub use three_strip_settings::{RecordParams, ThreeStripParams};
pub use view::{PaperParams, View};
