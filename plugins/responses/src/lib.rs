//! Built-in responses: the spectral sensitivity of a detector's channels, and the picture made from them. An
//! `imager: {kind: detector, response: ...}` has one.

#![cfg_attr(not(test), warn(clippy::disallowed_methods))]

mod luminous;
mod picture;
mod sensitivities;

pub use luminous::{Luminous, PhotopicParams, ScotopicParams};
pub use sensitivities::{Sensitivities, SensitivitiesParams};
