//! Spectra, illuminants, observers' tables and spectral lines.
//!
//! A spectrum is one of four things, and the compiler keeps them apart: an [`Emission`] is light, a [`Transmittance`] and a
//! [`Reflectance`] are matter, a [`Sensitivity`] is a detector. Light meets matter by `*`, and lights add by `+`; light times
//! light does not compile.
//!
//! ```
//! use spectra_spectrum::{find_emission, find_reflectance};
//! let light = find_emission("D50")?;
//! let patch = find_reflectance("colorchecker#red")?;
//! let reflected = &light * &patch;
//! assert!(reflected.at(640.0) > 3.0 * reflected.at(500.0));
//! # Ok::<(), spectra_spectrum::SpectrumError>(())
//! ```
//!
//! Conventions: wavelengths are in nanometers in air; power is per nanometer, but lines hold power as such. The band is 350-830
//! nm by 1 nm ([`spectra_core::spectral::BAND`]) unless a grid is given. Luminance is 683 lm/W times an integral over V(lambda)
//! ([`constants::LUMINOUS_EFFICACY_LM_PER_W`]).

#![cfg_attr(not(test), warn(clippy::disallowed_methods))]

mod any_spectrum;
mod bundled;
mod by_name;
mod cell;
mod cie;
mod color_checker;
mod common_words;
pub mod constants;
mod document;
mod emission;
mod error;
mod expression;
mod extent;
mod filter;
mod gaussian;
mod illuminants;
mod inline;
mod kind;
mod line_color;
mod lines;
mod meta;
mod names;
mod normal;
mod pending_spectrum;
mod planck;
mod separator;
mod signed_spectrum;
mod spectral_function;
mod sprague;
pub mod table;
mod table_error;
mod tabulated;
mod truncated;

pub use any_spectrum::AnySpectrum;
pub use by_name::{
    bundled_meta, bundled_spectra, find, find_as_in, find_emission, find_emission_in, find_in, find_reflectance,
    find_reflectance_in, find_sensitivity, find_sensitivity_in, find_transmittance, find_transmittance_in, function_in,
    meta_in, notes_in,
};
pub use cie::{Observer, v_lambda, v_prime};
pub use color_checker::COLOR_CHECKER;
pub use document::schema as document_schema;
pub use emission::Emission;
pub use error::SpectrumError;
pub use filter::{Reflectance, Sensitivity, Transmittance};
pub use gaussian::{GaussianFit, GaussianFitReport, GaussianMixture, GaussianTerm, NoGaussian, OneTerm, fit_gaussians};
pub use illuminants::{daylight, daylight_xy, illuminant, illuminant_names};
pub use inline::Expression;
pub use kind::{SpectrumContext, SpectrumEntry, SpectrumForm, SpectrumKind, build_kind};
pub use line_color::LineColor;
pub use lines::{LINE_SETS, LineOrWavelength, NAMED_LINES, NamedLine, balmer, line_set, named_line};
pub use meta::{Interpolation, Kind, Meta, Outside, Scale, Strengths};
pub use pending_spectrum::PendingSpectrum;
pub use planck::planck_radiance;
pub use signed_spectrum::SignedSpectrum;
#[doc(hidden)] // for `expression!`
pub use spectra_core::registry::inventory;
pub use spectra_core::spectral::{BAND, Grid, Line, SpectralPower};
pub use spectral_function::SpectralFunction;
pub use tabulated::Tabulated;
pub use truncated::TruncatedGaussian;
