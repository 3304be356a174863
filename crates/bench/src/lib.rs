//! Comparison of wavelength strategies: error against number of samples and against time.
//!
//! [`bench()`] takes a scene and measures every strategy on it in two ways. One is the spectral integral alone: the exposure of each
//! channel, compared with exact quadrature. The other is the rendered scene: every pixel, compared with a reference render with many more
//! samples. The result is a [`Report`]: [`table()`] formats it as text, [`csv()`] for a spreadsheet, [`picture()`] draws it, and `serde`
//! writes it as JSON.
//!
//! Errors are relative root-mean-square errors of linear exposure over seeds. Their 95 % intervals, and those of the slopes, are
//! percentiles of a bootstrap over the seeds (B. Efron, Annals of Statistics 7, 1 (1979)). The bootstrap resamples seeds because seeds are
//! independent, while pixels and channels are not.
//!
//! [`noise()`] measures how long a scene takes to become clean with each estimator. [`ghosts()`] measures the same for ghosts.

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
mod scene;
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
