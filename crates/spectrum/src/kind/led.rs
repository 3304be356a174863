//! The spectrum of `kind: led`.
//!
//! Y. Ohno, "Spectral design considerations for white LED color rendering", Optical Engineering 44, 111302 (2005): with
//! g = exp(-((w - w0) / d)^2) the light is (g + 2 g^5) / 3. The second term is a Gaussian too, so the whole is a mixture of two.

use super::gaussian::Center;
use super::{SpectrumContext, SpectrumEntry, SpectrumKind, bell_nm, build_kind};
use crate::error::SpectrumError;
use crate::gaussian::{GaussianMixture, GaussianTerm};
use crate::inline::wavelengths;
use crate::pending_spectrum::PendingSpectrum;
use crate::spectral_function::SpectralFunction;
use schemars::JsonSchema;
use serde::Deserialize;
use spectra_core::params::{Faults, Positive, Wavelength};

/// Light of one LED chip, by its peak wavelength and its width at half maximum.
///
/// The curve is sharper at the top and wider at the foot than a Gaussian, as chips measure; its scale is relative. A white LED
/// is a `sum` of several, or of one and the measured light of its phosphor. As an expression: `led:450,20`.
///
/// # Example
/// ```yaml
/// {kind: led, peak: 450 nm, width: 20 nm}
/// ```
///
/// # References
/// - Y. Ohno, Optical Engineering 44, 111302 (2005).
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
struct Led {
    /// Wavelength of the peak, nm if bare.
    peak: Center,
    /// Full width at half maximum, as data sheets state it, nm if bare.
    width: Positive<Wavelength>,
}

spectra_core::register!(SpectrumEntry, "led": Led, build_kind::<Led>);
crate::expression!("led:450,20", "write peak and width at half maximum in nm, such as led:450,20", |text| {
    let [peak_nm, width_nm] = wavelengths(text)?.try_into().ok()?;
    Some(led(peak_nm, width_nm))
});

impl SpectrumKind for Led {
    fn make(&self, making: &SpectrumContext<'_>) -> Result<PendingSpectrum, Faults> {
        bell_nm(self.peak.0, self.width.nm()).map_err(making.at("peak"))?;
        led(self.peak.0, self.width.nm()).map_err(making.at("width"))
    }
}

/// Width at half maximum over d: twice the root of -ln y where y + 2 y^5 = 3 / 2.
const WIDTH_OVER_D: f64 = 0.921_823_119_649_820_5;

fn led(peak_nm: f64, width_nm: f64) -> Result<PendingSpectrum, SpectrumError> {
    bell_nm(peak_nm, width_nm)?;
    let sigma_nm = width_nm / WIDTH_OVER_D * std::f64::consts::FRAC_1_SQRT_2;
    let wide = GaussianTerm::new(1.0 / 3.0, peak_nm, sigma_nm)?;
    let narrow = GaussianTerm::new(2.0 / 3.0, peak_nm, sigma_nm / 5.0_f64.sqrt())?;
    SpectralFunction::positive_mixture(GaussianMixture::new(vec![wide, narrow]))
        .map(|(shape, _)| PendingSpectrum::Bare(shape))
}

#[cfg(test)]
mod tests {
    use crate::find_emission;

    /// The light is 1 at the peak, half of it at half the width on both sides, and has the area of Ohno's formula: d sqrt(pi)
    /// (1 + 2 / sqrt(5)) / 3.
    #[test]
    fn peak_width_and_area_are_those_of_the_formula() {
        for (peak_nm, width_nm) in [(450.0, 20.0), (530.0, 35.0), (625.0, 18.0)] {
            let light = find_emission(&format!("led:{peak_nm},{width_nm}")).expect("light");
            assert!((light.at(peak_nm) - 1.0).abs() < 1e-12);
            for side in [-0.5, 0.5] {
                let half = light.at(peak_nm + side * width_nm);
                assert!((half - 0.5).abs() < 1e-12, "{half}");
            }
            // Twice as far out it is brighter than a Gaussian of that width, 1 / 16.
            assert!(light.at(peak_nm + width_nm) > 1.0 / 16.0);
            // In steps of 0.1 nm; for so smooth a function the sum is the integral.
            let sum: f64 = (0..=4000).map(|i| light.at(peak_nm - 200.0 + 0.1 * f64::from(i))).sum::<f64>() * 0.1;
            let d_nm = width_nm / 0.921_823_12;
            let area = d_nm * std::f64::consts::PI.sqrt() * (1.0 + 2.0 / 5.0_f64.sqrt()) / 3.0;
            assert!((sum / area - 1.0).abs() < 1e-7, "{sum} {area}");
        }
        assert!(find_emission("led:450").is_err() && find_emission("led:450,0").is_err());
    }
}
