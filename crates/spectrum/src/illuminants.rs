//! Illuminants by name and by color temperature.

use crate::bundled;
use crate::cie::daylight_components;
use crate::emission::Emission;
use crate::error::{SpectrumError, check};
use crate::meta::{Outside, Scale};
use crate::names::{candidates, normalized};
use crate::tabulated::Tabulated;

const FOLDER: &str = "spectra/illuminants/";

/// Lists the names of the bundled illuminants, in the order of their files.
pub fn illuminant_names() -> impl Iterator<Item = &'static str> {
    spectra_data::list(FOLDER).filter_map(|p| p.strip_prefix(FOLDER)?.strip_suffix(".csv"))
}

/// Returns the bundled illuminant `name`, such as `A`, `D65`, `FL11` (or `F11`), `LED-B3` or `ISO 7589 Photographic Daylight`.
///
/// Case, spaces, hyphens and underscores do not matter. Values are relative, per nanometer.
///
/// # Errors
/// [`SpectrumError::Unknown`] with similar names.
pub fn illuminant(name: &str) -> Result<Emission, SpectrumError> {
    let wanted = normalized(name);
    let fluorescent = wanted.strip_prefix('f').filter(|n| n.starts_with(|c: char| c.is_ascii_digit()));
    let wanted = fluorescent.map_or(wanted.clone(), |n| format!("fl{n}"));
    let found = illuminant_names().find(|n| normalized(n) == wanted);
    let Some(found) = found else {
        let candidates = candidates(name, illuminant_names());
        return Err(SpectrumError::Unknown { name: name.to_owned(), candidates });
    };
    Emission::tabulated(bundled::table(&format!("{FOLDER}{found}.csv")).column_at(0))
}

/// Returns the chromaticity x, y of CIE daylight of correlated color temperature `cct_k` (CIE 15:2004, 3.1).
///
/// # Errors
/// [`SpectrumError::OutOfRange`] outside of 4000-25000 K.
pub fn daylight_xy(cct_k: f64) -> Result<[f64; 2], SpectrumError> {
    let t = check("temperature of daylight, K", "4000 to 25000", cct_k, |t| (4000.0..=25_000.0).contains(&t))?;
    let polynomial = |c: [f64; 4]| ((c[0] / t + c[1]) / t + c[2]) / t + c[3];
    let x = if t <= 7000.0 {
        polynomial([-4.6070e9, 2.9678e6, 0.09911e3, 0.244_063])
    } else {
        polynomial([-2.0064e9, 1.9018e6, 0.24748e3, 0.237_040])
    };
    Ok([x, -3.0 * x * x + 2.870 * x - 0.275])
}

/// Returns CIE daylight of correlated color temperature `cct_k`, 100 at 560 nm, every 5 nm from 300 to 830 nm.
///
/// The weights of the characteristic vectors are not rounded, so the chromaticity equals [`daylight_xy`]. The temperature is on
/// the scale of the exact second radiation constant, c2. The named illuminants were defined on an older scale: D65 has 6503.6 K,
/// which is 6500 K times 1.438777 / 1.438.
///
/// # Errors
/// [`SpectrumError::OutOfRange`] outside of 4000-25000 K.
pub fn daylight(cct_k: f64) -> Result<Emission, SpectrumError> {
    let [x, y] = daylight_xy(cct_k)?;
    let m = 0.0241 + 0.2562 * x - 0.7341 * y;
    let m1 = (-1.3515 - 1.7703 * x + 5.9114 * y) / m;
    let m2 = (0.0300 - 31.4424 * x + 30.0717 * y) / m;
    let [s0, s1, s2] = daylight_components();
    let values: Vec<f64> = (0..s0.values().len())
        // Far from white the sum can dip below 0 at the ultraviolet end, where there is no light.
        .map(|i| (s0.values()[i] + m1 * s1.values()[i] + m2 * s2.values()[i]).max(0.0))
        .collect();
    Emission::tabulated(Tabulated::new(s0.wavelengths_nm(), &values, Outside::Constant, Scale::Linear)?)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Observer;
    use spectra_color::chromaticity;

    #[test]
    fn names_are_found_however_written() {
        for name in ["D65", "d65", "F11", "fl 11", "FL3.15", "led_b3", "iso 7589 photographic daylight"] {
            assert!(illuminant(name).is_ok(), "{name}");
        }
        assert_eq!(illuminant_names().count(), 59);
        let Err(SpectrumError::Unknown { candidates, .. }) = illuminant("D66") else { panic!("unknown") };
        assert!(candidates.contains(&"D65".to_owned()), "{candidates:?}");
    }

    /// The CIE's table of D65 uses weights of the vectors rounded to three decimals, and is itself rounded. With vectors up to
    /// 60 that explains a difference of 0.06.
    #[test]
    fn daylight_of_6504_k_is_d65() {
        let computed = daylight(6500.0 * 1.438_776_877 / 1.438).expect("in range");
        let named = illuminant("D65").expect("bundled");
        for w in 300..=780 {
            let (a, b) = (computed.at(f64::from(w)), named.at(f64::from(w)));
            assert!((a - b).abs() < 0.06, "{w} nm: {a} {b}");
        }
    }

    /// D65 at the edge of the band: CIE 15:2004, table T.1 (44.9117 at 350 nm, 46.6383 at 360 nm).
    #[test]
    fn d65_is_right_at_the_ultraviolet_edge() {
        let d65 = illuminant("D65").expect("bundled");
        assert_eq!([d65.at(350.0), d65.at(355.0), d65.at(360.0)], [44.9117, 45.775, 46.6383]);
    }

    /// By definition a daylight has its own chromaticity; the vectors were rounded to one decimal, hence 5e-4.
    #[test]
    fn daylight_has_its_chromaticity() {
        for t in [4000.0, 5003.0, 6504.0, 7000.0, 7001.0, 10_000.0, 25_000.0] {
            let want = daylight_xy(t).expect("in range");
            let got = chromaticity(Observer::cie_1931_2deg().xyz(&daylight(t).expect("in range"))).expect("light");
            assert!((got[0] - want[0]).abs() < 5e-4 && (got[1] - want[1]).abs() < 5e-4, "{t}: {got:?} {want:?}");
        }
        assert!(daylight(3999.0).is_err() && daylight(f64::NAN).is_err());
    }
}
