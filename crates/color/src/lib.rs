//! Color: converts spectra to what an eye or a screen sees.
//!
//! The crate computes XYZ of lights, surfaces and filters, chromaticities, correlated color temperature, dominant wavelength, CIE Lab and
//! color differences.
//! It also holds chromatic adaptation, RGB color spaces and gamut mapping.
//!
//! ```
//! use spectra_color::{lab, xyz_of_light, xyz_of_reflectance};
//! use spectra_spectrum::{Observer, find_emission, find_reflectance};
//! let light = find_emission("D50")?;
//! let patch = find_reflectance("colorchecker#red")?;
//! let observer = Observer::cie_1931_2deg();
//! let white = xyz_of_light(&light, observer).unwrap();
//! let xyz = xyz_of_reflectance(&patch, &light, observer).unwrap();
//! assert!((lab(xyz, white)[1] - 56.1).abs() < 0.1);
//! # Ok::<(), spectra_spectrum::SpectrumError>(())
//! ```

#![cfg_attr(not(test), warn(clippy::disallowed_methods))]

mod aces;
mod adaptation;
mod cct;
mod colorimetry;
mod deficiency;
mod difference;
mod dominant;
mod gamut;
pub mod matrix;
mod primaries;
mod real_gamut;
mod rendering;
pub mod rgb;
mod round_trip;
mod spectral_color;

pub use aces::{aces_cct, from_aces_cct};
pub use adaptation::Adaptation;
pub use cct::{Cct, cct, uv_1960};
pub use colorimetry::{chromaticity, lab, xyz_of_lab, xyz_of_light, xyz_of_reflectance, xyz_of_transmittance};
pub use deficiency::Deficiency;
pub use difference::ciede2000;
pub use dominant::{Dominant, dominant_wavelength};
pub use gamut::{Gamut, into_gamut, oklab, xyz_of_oklab};
pub use primaries::{srgb_light, srgb_primaries};
pub use real_gamut::{GamutFit, GamutPosition, MARGIN, RealGamut, fit_to_gamut};
pub use rendering::{
    ColorRendering, Fidelity, cam02_ucs, cie_test_colors, color_evaluation_samples, color_rendering, fidelity,
    fidelity_index, luminous_efficacy, uv_1976,
};
pub use rgb::{RgbSpace, Transfer, from_u8, to_u8, xyz_of_xy};
pub use round_trip::{RoundTrip, RoundTripErrors};
pub use spectral_color::{spectral_color_encoded, spectral_color_linear, spectral_color_srgb8};
