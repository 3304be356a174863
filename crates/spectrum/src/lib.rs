//! Spectra, illuminants, colorimetry and spectral lines.
//!
//! A spectrum is one of four things, and the compiler keeps them apart: an [`Emission`] is light, a [`Transmittance`]
//! and a [`Reflectance`] are matter, a [`Sensitivity`] is a detector. Light meets matter by `*`, lights add by `+`; light
//! times light is refused.
//!
//! ```
//! use spectra_spectrum::{Observer, find_emission, find_reflectance, lab, xyz_of_light, xyz_of_reflectance};
//! let light = find_emission("D50")?;
//! let patch = find_reflectance("colorchecker#red")?;
//! let observer = Observer::cie_1931_2deg();
//! let white = xyz_of_light(&light, observer).unwrap();
//! let xyz = xyz_of_reflectance(&patch, &light, observer).unwrap();
//! assert!((lab(xyz, white)[1] - 56.1).abs() < 0.1);
//! # Ok::<(), spectra_spectrum::SpectrumError>(())
//! ```
//!
//! Conventions: wavelengths are in nanometres in air; power is per nanometre, lines hold power as such; the band is
//! 350-830 nm by 1 nm ([`spectra_core::spectral::BAND`]) unless a grid is given; luminance is 683 lm/W times an
//! integral over V(lambda) ([`constants::LUMINOUS_EFFICACY_LM_PER_W`]).

mod adaptation;
mod bundled;
mod by_name;
mod cct;
mod cell;
mod cie;
mod colorimetry;
pub mod constants;
mod difference;
mod document;
mod dominant;
mod emission;
mod error;
mod filter;
mod gamut;
mod gaussian;
mod illuminants;
mod inline;
mod line_color;
mod lines;
pub mod matrix;
mod meta;
mod names;
mod normal;
mod normal_quantile;
mod piece;
mod planck;
mod primaries;
pub mod rgb;
mod round_trip;
mod shape;
mod spectral_color;
mod sprague;
pub mod table;
mod tabulated;
mod truncated;

pub use adaptation::Adaptation;
pub use by_name::{
    Found, bundled_meta, bundled_spectra, find, find_as_in, find_emission, find_emission_in, find_in, find_reflectance,
    find_reflectance_in, find_sensitivity, find_sensitivity_in, find_transmittance, find_transmittance_in, function_in,
    meta_in, notes_in,
};
pub use cct::{Cct, cct, uv_1960};
pub use cie::{Observer, v_lambda, v_prime};
pub use colorimetry::{chromaticity, lab, xyz_of_lab, xyz_of_light, xyz_of_reflectance, xyz_of_transmittance};
pub use difference::ciede2000;
pub use document::schema as document_schema;
pub use dominant::{Dominant, dominant_wavelength};
pub use emission::Emission;
pub use error::SpectrumError;
pub use filter::{Reflectance, Sensitivity, Transmittance};
pub use gamut::{Gamut, into_gamut, oklab, xyz_of_oklab};
pub use gaussian::{GaussianFit, GaussianFitReport, GaussianMixture, GaussianTerm, NoGaussian, fit_gaussians};
pub use illuminants::{daylight, daylight_xy, illuminant, illuminant_names};
pub use line_color::LineColor;
pub use lines::{LINE_SETS, LineOrWavelength, NAMED_LINES, NamedLine, balmer, line_set, named_line};
pub use meta::{Interpolation, Kind, Meta, Outside, Scale, Strengths};
pub use planck::planck_radiance;
pub use primaries::{srgb_light, srgb_primaries};
pub use rgb::{RgbSpace, Transfer, from_u8, to_u8, xyz_of_xy};
pub use round_trip::{RoundTrip, RoundTripErrors};
pub use shape::Shape;
pub use spectra_core::spectral::{BAND, Grid, Line, SpectralPower};
pub use spectral_color::{spectral_color_encoded, spectral_color_linear, spectral_color_srgb8};
pub use tabulated::Tabulated;
pub use truncated::TruncatedGaussian;
