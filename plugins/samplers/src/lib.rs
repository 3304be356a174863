//! Built-in strategies for drawing wavelengths.
//!
//! All strategies share one form, a [`Mixture`] of spectral lines and a [`Continuum`], which is mostly the [`Quantiles`] of a
//! density. They differ in that density.
//!
//! | `kind` | density |
//! |---|---|
//! | `source-times-response` | the source's power times the imager's response (the default) |
//! | `inverse-transform` | any named spectrum |
//! | `truncated-gaussian` | one Gaussian, cut off at the ends of the band |
//! | `gaussian-terms` | Gaussian terms fitted to the source |
//! | `hero` | the density of another strategy; one number is rotated among the samples of a group |
//! | `uniform` | constant over the band |
//! | `stratified` | constant over the band, in strata of equal width |
//! | `lines` | the source's lines, for a source that has nothing else |
//!
//! `gaussian-terms` draws from all its terms at once, or from one term whose sign the sample keeps, or follows the light of one
//! term. Following one term of every factor gives no wavelength, so it cannot pass a lens and is not a sampler; [`OneTerm`] does it
//! for spectral integrals.

#![cfg_attr(not(test), warn(clippy::disallowed_methods))]

mod cells;
mod floor;
mod followed;
mod gaussian_terms;
mod hero;
mod inverse_transform;
mod lines;
mod mixture;
mod quantiles;
mod recorded_spectrum;
mod source_times_response;
mod stratified;
mod truncated_gaussian;
mod uniform;

pub use cells::Cells;
pub use floor::Floor;
pub use gaussian_terms::{Follow, GaussianTerms, GaussianTermsParams};
pub use hero::{Hero, HeroParams};
pub use inverse_transform::{InverseTransform, InverseTransformParams};
pub use lines::Lines;
pub use mixture::{Continuum, Mixture, Shares};
pub use quantiles::Quantiles;
pub use source_times_response::SourceTimesResponse;
pub use spectra_spectrum::OneTerm;
pub use stratified::{Stratified, StratifiedParams};
pub use truncated_gaussian::{TruncatedGaussianParams, TruncatedGaussianSampler};
pub use uniform::Uniform;
