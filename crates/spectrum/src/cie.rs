//! The CIE's observers: color-matching functions and luminous efficiency.
//!
//! The tables are those of the CIE, in steps of 1 nm: 360-830 nm for 1931 and 1964, 390-830 nm for 2015. The band of light here
//! begins at 350 nm. Below its first wavelength, each function therefore continues to fall at the mean logarithmic rate of its
//! first ten nanometers ([`crate::Outside::Geometric`]): for the 1931 observer a factor of about 3.2 in ten nanometers.
//! Everything below 360 nm adds 1e-5 to the X of equal-energy light.

use std::sync::{Arc, OnceLock};

use spectra_core::spectral::{BAND, Grid, SpectralPower};

use crate::bundled;
use crate::filter::Sensitivity;
use crate::tabulated::Tabulated;

/// A standard observer: three color-matching functions.
#[derive(Clone, Debug)]
pub struct Observer {
    name: &'static str,
    functions: [Tabulated; 3],
    band: [Vec<f64>; 3],
}

impl Observer {
    fn load(name: &'static str, path: &str) -> Self {
        let table = bundled::table(path);
        let functions = [0, 1, 2].map(|i| table.column_at(i));
        let band = [0, 1, 2].map(|i| BAND.wavelengths_nm().map(|w| functions[i].at(w)).collect());
        Self { name, functions, band }
    }

    /// Returns the CIE 1931 observer for a field of 2 degrees, which is the default.
    pub fn cie_1931_2deg() -> &'static Self {
        static ONE: OnceLock<Observer> = OnceLock::new();
        ONE.get_or_init(|| Self::load("CIE 1931 2 deg", "spectra/cie/cie-1931-2deg.csv"))
    }

    /// Returns the CIE 1964 observer for a field of 10 degrees.
    pub fn cie_1964_10deg() -> &'static Self {
        static ONE: OnceLock<Observer> = OnceLock::new();
        ONE.get_or_init(|| Self::load("CIE 1964 10 deg", "spectra/cie/cie-1964-10deg.csv"))
    }

    /// Returns the CIE 2015 observer (from cone fundamentals) for a field of 2 degrees.
    pub fn cie_2015_2deg() -> &'static Self {
        static ONE: OnceLock<Observer> = OnceLock::new();
        ONE.get_or_init(|| Self::load("CIE 2015 2 deg", "spectra/cie/cie-2015-2deg.csv"))
    }

    /// Returns the CIE 2015 observer (from cone fundamentals) for a field of 10 degrees.
    pub fn cie_2015_10deg() -> &'static Self {
        static ONE: OnceLock<Observer> = OnceLock::new();
        ONE.get_or_init(|| Self::load("CIE 2015 10 deg", "spectra/cie/cie-2015-10deg.csv"))
    }

    /// Returns the CIE RGB functions of 1931 (primaries 700, 546.1 and 435.8 nm), with their negative lobes; every 5 nm from
    /// 380 to 780 nm, 0 beyond.
    pub fn cie_rgb_1931() -> &'static Self {
        static ONE: OnceLock<Observer> = OnceLock::new();
        ONE.get_or_init(|| Self::load("CIE RGB 1931", "spectra/cie/cie-rgb-1931.csv"))
    }

    /// Common name of the observer.
    #[must_use]
    pub fn name(&self) -> &'static str {
        self.name
    }

    /// Returns the three functions at `wavelength_nm`.
    #[must_use]
    pub fn at(&self, wavelength_nm: f64) -> [f64; 3] {
        [0, 1, 2].map(|i| self.functions[i].at(wavelength_nm))
    }

    /// Returns the three functions on `grid`.
    #[must_use]
    pub fn on_grid(&self, grid: &Grid) -> [Vec<f64>; 3] {
        if *grid == BAND {
            return self.band.clone();
        }
        [0, 1, 2].map(|i| grid.wavelengths_nm().map(|w| self.functions[i].at(w)).collect())
    }

    /// Computes XYZ of a light on a grid: the sum over the grid's points times the step, as the CIE prescribes at 1 nm (CIE
    /// 15:2004, 7.1). Lines are added at their own wavelengths. No factor is applied.
    ///
    /// The integral of the piecewise linear functions ([`SpectralPower::seen_by`]) differs by 5e-5 for a smooth surface.
    #[must_use]
    pub fn xyz_of_power(&self, light: &SpectralPower) -> [f64; 3] {
        let elsewhere = (light.grid != BAND).then(|| self.on_grid(&light.grid));
        let functions = elsewhere.as_ref().unwrap_or(&self.band);
        let mut xyz = [0, 1, 2].map(|i| {
            let sum: f64 = light.continuum.iter().zip(&functions[i]).map(|(p, f)| p * f).sum();
            sum * light.grid.step_nm
        });
        for line in light.lines.iter().filter(|l| light.grid.contains(l.wavelength_nm)) {
            let at = self.at(line.wavelength_nm);
            (0..3).for_each(|i| xyz[i] += line.power * at[i]);
        }
        xyz
    }
}

/// Returns the luminous efficiency for photopic vision, V(lambda) of the CIE 1924; the y function of the 1931 observer.
#[must_use]
pub fn v_lambda() -> Sensitivity {
    Sensitivity::from_checked(bundled::table("spectra/cie/v-lambda-1924.csv").column_at(0))
}

/// Returns the luminous efficiency for scotopic vision, V'(lambda) of the CIE 1951.
#[must_use]
pub fn v_prime() -> Sensitivity {
    Sensitivity::from_checked(bundled::table("spectra/cie/v-prime-1951.csv").column_at(0))
}

/// Returns mean and characteristic vectors S0, S1 and S2 of daylight (CIE 15:2004, table T.2).
pub(crate) fn daylight_components() -> &'static [Tabulated; 3] {
    static ONE: OnceLock<Arc<[Tabulated; 3]>> = OnceLock::new();
    ONE.get_or_init(|| {
        let table = bundled::table("spectra/cie/daylight-components.csv");
        Arc::new([0, 1, 2].map(|i| table.column_at(i)))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// CIE 018:2019: V(555 nm) = 1; the 1931 functions have equal sums (their chromaticity of E is 1/3, 1/3).
    #[test]
    fn functions_are_those_of_the_cie() {
        let o = Observer::cie_1931_2deg();
        assert_eq!(o.at(555.0)[1], 1.0);
        assert_eq!(o.at(575.0), [0.8425, 0.9154, 0.0018]);
        let sums = [0, 1, 2].map(|i| o.band[i].iter().sum::<f64>());
        for s in sums {
            assert!((s - 106.87).abs() < 0.03, "{sums:?}");
        }
        let v = v_lambda();
        for w in [380.0, 450.5, 555.0, 700.0] {
            assert!((v.at(w) - o.at(w)[1]).abs() < 1e-9, "{w}");
        }
        assert_eq!(v_prime().at(507.0), 1.0);
    }

    /// The CIE RGB functions at 575 nm, W. D. Wright and J. Guild.
    #[test]
    fn cie_rgb_has_its_negative_lobe() {
        let rgb = Observer::cie_rgb_1931().at(575.0);
        for (got, want) in rgb.into_iter().zip([0.2072, 0.1543, -0.0012]) {
            assert!((got - want).abs() <= 1e-4, "{rgb:?}");
        }
        assert!(Observer::cie_rgb_1931().at(500.0)[0] < -0.07);
    }

    #[test]
    fn below_the_table_functions_fall_smoothly_toward_350_nm() {
        for o in [
            Observer::cie_1931_2deg(),
            Observer::cie_1964_10deg(),
            Observer::cie_2015_2deg(),
            Observer::cie_2015_10deg(),
        ] {
            for f in &o.functions {
                let first = f.range_nm().0;
                let (end, below) = (f.at(first), f.at(first - 0.5));
                assert!(below > 0.8 * end && below < end, "{} {below} {end}", o.name);
                assert!(f.at(350.0) > 0.0 && f.at(350.0) < 0.4 * end, "{}", o.name);
            }
        }
        let o = Observer::cie_1931_2deg();
        let added: f64 = (350..360).map(|w| o.at(f64::from(w))[0]).sum();
        assert!(added / 106.87 < 1.2e-5, "{added}");
    }
}
