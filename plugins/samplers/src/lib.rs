//! Built-in ways to draw a wavelength.
//!
//! All strategies share one form, a [`Mixture`]: lines are drawn as lines, and beside them a
//! [`Continuum`], mostly [`Quantiles`] of a density. They differ in the density that they build it from.
//!
//! | `kind` | density |
//! |---|---|
//! | `source-times-response` | the source's power times what the imager sees (the default) |
//! | `inverse-transform` | any named spectrum |
//! | `truncated-gaussian` | one Gaussian, cut off at the ends of the band |
//! | `gaussian-terms` | Gaussian terms fitted to the source |
//! | `hero` | that of another strategy, one number rotated among the samples of a group |
//! | `uniform` | the same everywhere |
//! | `stratified` | the same everywhere, in strata of equal width |
//! | `lines` | the source's lines, where it has nothing else |
//!
//! `gaussian-terms` draws from all its terms at once, from one whose sign the sample keeps, or follows one. What follows a
//! term of every factor has no wavelength and can pass no lens: it is no sampler, but [`OneTerm`] does it for
//! spectral integrals.

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
mod seen;
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
