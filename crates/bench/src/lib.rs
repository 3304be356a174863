//! Wavelength strategies against each other: error against samples and against time.
//!
//! [`bench()`] takes a scene and measures every strategy on it in two ways: the spectral integral alone (the exposure of
//! each channel, against exact quadrature), and the scene as it is rendered (every pixel, against a reference render
//! of many more samples). What comes out is a [`Report`]: [`table`] shows it to a person, [`csv()`] to a spreadsheet,
//! [`picture()`] draws it, and `serde` writes it as JSON.
//!
//! Errors are relative root-mean-square errors of linear exposure over seeds. Their 95 % intervals, and those of the
//! slopes, are percentiles of a bootstrap over the seeds (B. Efron, Annals of Statistics 7, 1 (1979)): seeds are
//! independent, pixels and channels are not, so the seed is what is drawn again.

//!
//! [`noise()`] measures something else: how long the scene takes until it is clean, by each estimator.

#![cfg_attr(not(test), warn(clippy::disallowed_methods))]

mod colors;
mod csv;
mod error;
mod every_factor;
mod frame;
mod ghosts;
mod integral;
mod noise;
mod picture;
mod report;
mod runner;
mod statistics;
mod strategy;
mod table;

pub use csv::{csv, seeds_csv};
pub use error::BenchError;
pub use ghosts::{GhostNoise, GhostRow, GhostSettings, ghost_table, ghosts};
pub use noise::{NoiseRow, NoiseSettings, noise, noise_table};
pub use picture::picture;
pub use report::{ChannelBias, Interval, LeftOut, Measure, NumberKind, OfSeed, Point, Reference, Report, Series};
pub use runner::{Settings, bench};
pub use strategy::{Strategy, parse_list};
pub use table::table;
