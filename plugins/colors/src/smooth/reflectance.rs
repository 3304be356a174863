//! The reflectance of a color: a sigmoid of a quadratic in the wavelength.

use spectra_core::spectral::BAND;

/// Coefficients of the quadratic in terms of 1, t and (3 t^2 - 1) / 2, with t from -1 to 1 over 350-830 nm.
pub(super) type Coefficients = [f64; 3];

#[inline(always)]
pub(super) fn sigmoid(x: f64) -> f64 {
    0.5 + 0.5 * x / (1.0 + x * x).sqrt()
}

#[inline(always)]
pub(super) fn place(wavelength_nm: f64) -> f64 {
    (wavelength_nm - 0.5 * (BAND.start_nm + BAND.end_nm())) / (0.5 * (BAND.end_nm() - BAND.start_nm))
}

#[inline(always)]
pub(super) fn quadratic([a, b, c]: Coefficients, wavelength_nm: f64) -> f64 {
    let t = place(wavelength_nm);
    a + b * t + c * (1.5 * t * t - 0.5)
}
