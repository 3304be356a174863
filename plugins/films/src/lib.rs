//! Built-in film processes.

mod stock;

pub use stock::{StockFilm, StockParams};
