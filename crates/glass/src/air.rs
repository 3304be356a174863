//! The refractive index of air, and what "relative to air" means.
//!
//! Glass makers state n relative to air at their measuring temperature (20 or 22 C) and standard pressure. A lens
//! stands in air, so these relative indices are what a trace needs: air is 1. In vacuum every index is larger by
//! the factor n_air (1.00027), and vacuum itself, seen from this convention, is 1 / n_air.

/// State of dry air with 450 ppm of carbon dioxide.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AirConditions {
    /// Temperature, degrees Celsius; -40 to 100.
    pub temperature_c: f64,
    /// Pressure, Pa; 80 000 to 120 000 (0 is vacuum).
    pub pressure_pa: f64,
}

/// Air of the glass catalogues: 20 C, 101 325 Pa.
pub const CATALOGUE_AIR: AirConditions = AirConditions { temperature_c: 20.0, pressure_pa: 101_325.0 };

/// Standard air of spectroscopy: 15 C, 101 325 Pa.
pub const STANDARD_AIR: AirConditions = AirConditions { temperature_c: 15.0, pressure_pa: 101_325.0 };

/// Absolute refractive index of dry air at a wavelength (nm in this air, 230 to 1690).
///
/// P. E. Ciddor, "Refractive index of air: new equations for the visible and near infrared", Applied Optics 35, 1566
/// (1996), equations 1 to 5 and 12, dry part; uncertainty 2e-8 to 5e-8.
#[must_use]
pub fn index(wavelength_nm: f64, air: AirConditions) -> f64 {
    // Ciddor's wave number is that in vacuum: one step of the fixed point is exact to 1e-12.
    let first = index_at_vacuum_wavelength(wavelength_nm, air);
    index_at_vacuum_wavelength(wavelength_nm * first, air)
}

/// Absolute refractive index of dry air at a wavelength in vacuum (nm); see [`index`].
#[must_use]
pub fn index_at_vacuum_wavelength(vacuum_nm: f64, air: AirConditions) -> f64 {
    let sigma2 = 1e6 / (vacuum_nm * vacuum_nm);
    let standard = 0.057_921_05 / (238.0185 - sigma2) + 0.001_679_17 / (57.362 - sigma2);
    1.0 + standard * density(air) / density(STANDARD_AIR)
}

/// Converts an index relative to air, as in a catalogue, to an absolute index, at a wavelength in nm. `air` is the air to which
/// the index is relative.
#[must_use]
pub fn absolute(relative_index: f64, wavelength_nm: f64, air: AirConditions) -> f64 {
    relative_index * index(wavelength_nm, air)
}

/// Density of dry air up to a constant factor: p / (Z T), with the compressibility Z of BIPM 1981/91.
fn density(air: AirConditions) -> f64 {
    let t = air.temperature_c;
    let kelvin = t + 273.15;
    let ratio = air.pressure_pa / kelvin;
    let z = 1.0 - ratio * (1.581_23e-6 + t * (-2.9331e-8 + t * 1.1043e-10)) + ratio * ratio * 1.83e-11;
    ratio / z
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Table 1 of Ciddor 1996: 1e8 (n - 1) of dry air at 633 nm.
    #[test]
    fn dry_air_as_in_ciddors_table() {
        for (t, p, expected) in [
            (20.0, 80_000.0, 21_458.0),
            (20.0, 100_000.0, 26_824.4),
            (20.0, 120_000.0, 32_191.6),
            (10.0, 100_000.0, 27_774.7),
            (30.0, 100_000.0, 25_937.2),
        ] {
            let n = index_at_vacuum_wavelength(633.0, AirConditions { temperature_c: t, pressure_pa: p });
            assert!(((n - 1.0) * 1e8 - expected).abs() < 0.06, "{t} {p}: {}", (n - 1.0) * 1e8);
        }
    }

    #[test]
    fn vacuum_is_one_and_absolute_is_larger() {
        let vacuum = AirConditions { temperature_c: 20.0, pressure_pa: 0.0 };
        assert_eq!(index(550.0, vacuum), 1.0);
        assert!(
            (absolute(1.5168, 587.5618, CATALOGUE_AIR) - 1.5168 * (1.0 + 2.7717e-4 * 288.15 / 293.15)).abs() < 3e-8
        );
    }
}
