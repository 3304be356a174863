//! Built-in responses: what a detector sees, channel by channel, and the picture that it makes of that. An
//! `imager: {kind: detector, response: ...}` has one.

#![cfg_attr(not(test), warn(clippy::disallowed_methods))]

mod luminous;
mod sensitivities;
mod shown;

pub use luminous::{Luminous, PhotopicParams, ScotopicParams};
pub use sensitivities::{Sensitivities, SensitivitiesParams};
