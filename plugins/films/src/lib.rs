//! Built-in film processes.

mod metering;
mod stock;
mod view;

pub use metering::{Metering, SpotParams};
pub use stock::{StockFilm, StockParams};
pub use view::{PaperParams, View};
