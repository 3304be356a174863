//! Spectral sensitivity of a layer, and the exposure channel that follows from it.

use spectra_core::math::pow;
use spectra_core::spectral::{BAND, Channel, Grid};
use spectra_spectrum::constants::LUMINOUS_EFFICACY_LM_PER_W;
use spectra_spectrum::{Emission, v_lambda};

/// Scale of the values in a sensitivity table.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum SensitivityScale {
    /// Values are linear.
    Linear,
    /// Values are logarithms to base 10. A value at or below the floor (where the sheet's plot ends) means no sensitivity at all.
    Log10 {
        /// Floor of the plot; `None` if every value counts.
        floor: Option<f64>,
    },
}

/// Errors of spectral sensitivities.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum SensitivityError {
    /// There are fewer than two points, or wavelengths do not increase.
    #[error("a sensitivity needs two points or more, of increasing wavelength")]
    Points,
    /// A value is negative, or not finite when read as stated.
    #[error("{value} at {wavelength_nm} nm is not a sensitivity")]
    Value {
        /// Wavelength of the value, nm.
        wavelength_nm: f64,
        /// Value in the table.
        value: f64,
    },
    /// The light of the measurement has no power where the table has a sensitivity.
    #[error(
        "the light that it was measured under has no power at {wavelength_nm} nm, where the table has a sensitivity"
    )]
    DarkLight {
        /// Wavelength without power, nm.
        wavelength_nm: f64,
    },
    /// The layer is not sensitive to the reference light at all.
    #[error("the layer is not sensitive to the reference illuminant")]
    Blind,
}

/// Spectral sensitivity of a layer: one over the energy (J m^-2 nm^-1) that gives a fixed density, in any scale.
///
/// The sensitivity is 0 outside the table. Between two points with sensitivity, it is interpolated on the scale of the table (logarithms as
/// such). Next to a point without sensitivity, it rises linearly from 0.
#[derive(Clone, Debug, PartialEq)]
pub struct SpectralSensitivity {
    wavelengths_nm: Vec<f64>,
    linear: Vec<f64>,
    logarithmic: bool,
    light: Option<Emission>,
}

impl SpectralSensitivity {
    /// Reads points (wavelength in nm, value) of a plot that was measured with equal energy at each wavelength, or with `light`, by which
    /// the values are divided.
    ///
    /// # Errors
    /// [`SensitivityError`]: too few or unsorted points, invalid values, or a `light` without power where the table has a sensitivity.
    pub fn new(
        points: &[[f64; 2]],
        reading: SensitivityScale,
        light: Option<Emission>,
    ) -> Result<Self, SensitivityError> {
        let increasing = points.windows(2).all(|w| w[0][0] < w[1][0]);
        if points.len() < 2 || !increasing || points.iter().any(|p| !(p[0] > 0.0 && p[0].is_finite())) {
            return Err(SensitivityError::Points);
        }
        let mut linear = Vec::with_capacity(points.len());
        for &[wavelength_nm, value] in points {
            let v = match reading {
                SensitivityScale::Linear => value,
                SensitivityScale::Log10 { floor: Some(floor) } if value <= floor => 0.0,
                SensitivityScale::Log10 { .. } => pow(10.0, value),
            };
            if !(value.is_finite() && v >= 0.0 && v.is_finite()) {
                return Err(SensitivityError::Value { wavelength_nm, value });
            }
            if v > 0.0 && light.as_ref().is_some_and(|l| l.at(wavelength_nm) <= 0.0) {
                return Err(SensitivityError::DarkLight { wavelength_nm });
            }
            linear.push(v);
        }
        let wavelengths_nm = points.iter().map(|p| p[0]).collect();
        Ok(Self { wavelengths_nm, linear, logarithmic: matches!(reading, SensitivityScale::Log10 { .. }), light })
    }

    /// Returns the relative sensitivity to energy at a wavelength.
    #[must_use]
    pub fn at(&self, wavelength_nm: f64) -> f64 {
        let w = &self.wavelengths_nm;
        let last = w.len() - 1;
        if !(wavelength_nm >= w[0] && wavelength_nm <= w[last]) {
            return 0.0;
        }
        let i = (w.partition_point(|v| *v <= wavelength_nm).max(1) - 1).min(last - 1);
        let f = (wavelength_nm - w[i]) / (w[i + 1] - w[i]);
        let (a, b) = (self.linear[i], self.linear[i + 1]);
        let value = if self.logarithmic && a > 0.0 && b > 0.0 { a * pow(b / a, f) } else { a + (b - a) * f };
        match &self.light {
            Some(light) if value > 0.0 => {
                let power = light.at(wavelength_nm);
                if power > 0.0 { value / power } else { 0.0 }
            }
            _ => value,
        }
    }

    /// First and last wavelength of the table, nm.
    #[must_use]
    pub fn range_nm(&self) -> (f64, f64) {
        (self.wavelengths_nm[0], self.wavelengths_nm[self.wavelengths_nm.len() - 1])
    }

    /// Returns the layer's response to one lux of `light`, in the scale of [`SpectralSensitivity::at`]. The ratio of the values for two
    /// lights is that of the film's speeds in them.
    #[must_use]
    pub fn per_lux(&self, light: &Emission) -> f64 {
        let power = light.to_power(&BAND);
        let on_band = |f: &dyn Fn(f64) -> f64| BAND.wavelengths_nm().map(f).collect::<Vec<f64>>();
        let v = v_lambda();
        let seen = power.seen_by(&on_band(&|w| self.at(w)));
        seen / (LUMINOUS_EFFICACY_LM_PER_W * power.seen_by(&on_band(&|w| v.at(w))))
    }

    /// Builds the channel that records the layer's exposure in lx s on `grid`.
    ///
    /// It is scaled so that light of the spectrum of `reference` gives its photometric lx s. With the power I of the reference, K = 683
    /// int(I V) / int(I S), and the exposure of any light E is K int(E S) times the time.
    /// K is computed over the whole band of 350-830 nm, whatever the grid.
    ///
    /// # Errors
    /// [`SensitivityError::Blind`] if the layer is not sensitive to the reference.
    pub fn channel(&self, name: &str, reference: &Emission, grid: &Grid) -> Result<Channel, SensitivityError> {
        let per_lux = self.per_lux(reference);
        if !(per_lux > 0.0 && per_lux.is_finite()) {
            return Err(SensitivityError::Blind);
        }
        let response = grid.wavelengths_nm().map(|w| self.at(w) / per_lux).collect();
        Ok(Channel { name: name.into(), unit: "lx s".into(), response })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use spectra_spectrum::illuminant;

    #[test]
    fn logarithms_are_read_above_the_floor_only() {
        let points = [[400.0, 0.0], [410.0, 1.0], [420.0, 0.5], [430.0, 0.0]];
        let s = SpectralSensitivity::new(&points, SensitivityScale::Log10 { floor: Some(0.0) }, None).expect("a table");
        let root = pow(10.0, 0.5);
        for (w, want) in [
            (399.9, 0.0),
            (400.0, 0.0),
            (405.0, 5.0),
            (410.0, 10.0),
            (415.0, pow(10.0, 0.75)),
            (420.0, root),
            (425.0, root / 2.0),
            (430.0, 0.0),
            (431.0, 0.0),
        ] {
            assert!((s.at(w) - want).abs() < 1e-12, "{w}: {} {want}", s.at(w));
        }
        let s = SpectralSensitivity::new(&points, SensitivityScale::Log10 { floor: None }, None).expect("a table");
        assert!((s.at(400.0) - 1.0).abs() < 1e-15 && s.at(399.0) == 0.0);
        assert_eq!(s.at(f64::NAN), 0.0);
    }

    #[test]
    fn the_light_of_the_measurement_is_divided_out() {
        let lamp = Emission::blackbody(2850.0).expect("a lamp");
        let points: Vec<[f64; 2]> = (0..21).map(|i| f64::from(400 + 10 * i)).map(|w| [w, lamp.at(w) * 1e-9]).collect();
        let s = SpectralSensitivity::new(&points, SensitivityScale::Linear, Some(lamp)).expect("a table");
        assert!((400..=600).step_by(10).all(|w| (s.at(f64::from(w)) / 1e-9 - 1.0).abs() < 1e-12));
        let blue = Emission::rectangle(380.0, 500.0).expect("a light");
        let fault = SpectralSensitivity::new(&[[450.0, 1.0], [550.0, 1.0]], SensitivityScale::Linear, Some(blue));
        assert_eq!(fault, Err(SensitivityError::DarkLight { wavelength_nm: 550.0 }));
    }

    /// A layer with the sensitivity of the eye records photometric lux-seconds in any light.
    #[test]
    fn a_layer_like_the_eye_is_a_light_meter() {
        let v = v_lambda();
        let points: Vec<[f64; 2]> = (360..=830).map(|w| [f64::from(w), v.at(f64::from(w)) * 37.0]).collect();
        let eye = SpectralSensitivity::new(&points, SensitivityScale::Linear, None).expect("a table");
        let daylight = illuminant("iso-7589-sensitometric-daylight").expect("bundled");
        let channel = eye.channel("eye", &daylight, &BAND).expect("seen");
        for name in ["A", "D65", "FL11"] {
            let light = illuminant(name).expect("bundled");
            let luminous: Vec<f64> = BAND.wavelengths_nm().map(|w| 683.0 * v.at(w)).collect();
            let lux = light.to_power(&BAND).seen_by(&luminous);
            // Below 360 nm V(lambda) is extended and the table is not: 1e-7 of the luminance at most.
            let recorded = light.to_power(&BAND).seen_by(&channel.response);
            assert!((recorded / lux - 1.0).abs() < 1e-7, "{name}: {recorded} {lux}");
        }
    }

    #[test]
    fn faulty_tables_are_refused() {
        let new = |points: &[[f64; 2]], reading| SpectralSensitivity::new(points, reading, None);
        assert_eq!(new(&[[400.0, 1.0]], SensitivityScale::Linear), Err(SensitivityError::Points));
        assert_eq!(new(&[[400.0, 1.0], [400.0, 1.0]], SensitivityScale::Linear), Err(SensitivityError::Points));
        assert!(new(&[[400.0, 1.0], [410.0, -1.0]], SensitivityScale::Linear).is_err());
        assert!(new(&[[400.0, 1.0], [410.0, 400.0]], SensitivityScale::Log10 { floor: None }).is_err());
        assert!(new(&[[400.0, 1.0], [410.0, f64::NAN]], SensitivityScale::Log10 { floor: Some(0.0) }).is_err());
        let infrared = new(&[[900.0, 1.0], [910.0, 1.0]], SensitivityScale::Linear).expect("a table");
        let light = illuminant("D65").expect("bundled");
        assert_eq!(infrared.channel("ir", &light, &BAND), Err(SensitivityError::Blind));
    }
}
