//! Position and width of a function of the wavelength.

use crate::emission::Emission;
use crate::spectral_function::SpectralFunction;
use spectra_core::spectral::BAND;

impl SpectralFunction {
    /// Returns the two wavelengths (nm), on both sides of the highest value on 350-830 nm, at which the function has fallen to
    /// half of that value.
    ///
    /// `None` if the function does not fall that far on both sides within the band, or is nowhere positive.
    #[must_use]
    pub fn half_height_nm(&self) -> Option<[f64; 2]> {
        /// Step of the search, nm; narrower dips beside the peak are stepped over.
        const STEP_NM: f64 = 0.05;
        let (height, peak_nm) = self.survey().high;
        if !(height > 0.0 && height.is_finite()) {
            return None;
        }
        let is_high = |nm: f64| self.at(nm) >= 0.5 * height;
        let side = |toward_nm: f64| -> Option<f64> {
            // The highest value is at the very end: on that side it does not fall.
            if toward_nm == peak_nm {
                return None;
            }
            let step = STEP_NM.copysign(toward_nm - peak_nm);
            let mut high = peak_nm;
            let mut low = loop {
                let next = high + step;
                if !BAND.contains(next) {
                    return None;
                }
                if !is_high(next) {
                    break next;
                }
                high = next;
            };
            for _ in 0..60 {
                let middle = 0.5 * (high + low);
                if is_high(middle) { high = middle } else { low = middle }
            }
            Some(0.5 * (high + low))
        };
        Some([side(BAND.start_nm)?, side(BAND.end_nm())?])
    }

    /// Returns the mean wavelength (nm) on 350-830 nm, weighted by the values; `None` if their sum is not positive.
    #[must_use]
    pub fn centroid_nm(&self) -> Option<f64> {
        let [sum, moment] = self.moments();
        mean(sum, moment)
    }

    /// Returns the integral over 350-830 nm of the values, and that of the values times the wavelength in nm.
    fn moments(&self) -> [f64; 2] {
        let (low, high) = (BAND.start_nm, BAND.end_nm());
        [self.integral(low, high, PANEL_NM), self.weighted(low, high, PANEL_NM, |nm| nm)]
    }
}

/// Widest panel of the quadrature, nm.
const PANEL_NM: f64 = 2.0;

impl Emission {
    /// Returns the mean wavelength (nm) on 350-830 nm, weighted by power, lines included; `None` for no light.
    #[must_use]
    pub fn centroid_nm(&self) -> Option<f64> {
        let [mut sum, mut moment] = self.continuum().map_or([0.0; 2], SpectralFunction::moments);
        for line in self.lines().iter().filter(|line| BAND.contains(line.wavelength_nm)) {
            sum += line.power;
            moment += line.power * line.wavelength_nm;
        }
        mean(sum, moment)
    }
}

fn mean(sum: f64, moment: f64) -> Option<f64> {
    (sum > 0.0 && moment.is_finite()).then(|| moment / sum)
}

#[cfg(test)]
mod tests {
    use crate::find_emission;

    /// Closed forms: a Gaussian's width is 2 sqrt(2 ln 2) sigma, a rectangle's its own, an LED's as its data sheet says.
    #[test]
    fn widths_and_centroids() {
        for (name, width, center) in [
            ("gaussian:550,20", 47.096_400_900_61, 550.0),
            ("gaussian:550.37,0.01", 0.023_548_200_45, 550.37),
            ("rectangle:500,601.5", 101.5, 550.75),
            ("led:450,20", 20.0, 450.0),
        ] {
            let light = find_emission(name).expect("a light");
            let [low, high] = light.continuum().and_then(|c| c.half_height_nm()).expect("within the band");
            assert!((high - low - width).abs() < 1e-8, "{name}: {}", high - low);
            let centroid = light.centroid_nm().expect("light");
            assert!((centroid - center).abs() < 1e-6, "{name}: {centroid}");
        }
        let both = find_emission("line:500 + 3 * line:600").expect("a light");
        assert_eq!(both.centroid_nm(), Some(575.0));
        // If the highest value is at an end of the band, the other side alone gives no width.
        for open in ["A", "D65 / A / 10", "1 - 0.9 * gaussian:550,20", "rectangle:300,500"] {
            let open = find_emission(open).expect("a light");
            assert!(open.continuum().and_then(|c| c.half_height_nm()).is_none());
        }
        assert!(find_emission("line:t").expect("a light").centroid_nm().is_none());
    }
}
