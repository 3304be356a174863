//! Spectral lines by their usual letters, and the lines of hydrogen.

use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::de::Error;
use serde::{Deserialize, Deserializer};
use spectra_core::params::Wavelength;
use std::borrow::Cow;

use crate::constants::{AIR_INDEX, PROTON_ELECTRON_MASS_RATIO, RYDBERG_PER_M};

/// Spectral line that is known in optics by a letter.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NamedLine {
    /// Letter of the line, such as `C'`.
    pub symbol: &'static str,
    /// Wavelength in air as it is usually written, nm; this is what the name means in a scene.
    pub nominal_nm: f64,
    /// Wavelength in air with more digits, nm; this is what glass catalogs mean.
    pub precise_nm: f64,
    /// Element that emits the line.
    pub element: &'static str,
}

const fn named(symbol: &'static str, nominal_nm: f64, precise_nm: f64, element: &'static str) -> NamedLine {
    NamedLine { symbol, nominal_nm, precise_nm, element }
}

/// All named lines, by wavelength, from ISO 7944:1998. The precise values are those that makers of glass state (Schott TIE-29).
pub const NAMED_LINES: [NamedLine; 14] = [
    named("i", 365.01, 365.0146, "mercury"),
    named("h", 404.66, 404.6561, "mercury"),
    named("g", 435.84, 435.8343, "mercury"),
    named("F'", 479.99, 479.9914, "cadmium"),
    named("F", 486.13, 486.1327, "hydrogen"),
    named("e", 546.07, 546.074, "mercury"),
    named("d", 587.56, 587.5618, "helium"),
    named("D", 589.3, 589.2938, "sodium"),
    named("C'", 643.85, 643.8469, "cadmium"),
    named("C", 656.27, 656.2725, "hydrogen"),
    named("r", 706.52, 706.5188, "helium"),
    named("A'", 768.2, 768.195, "potassium"),
    named("s", 852.11, 852.11, "cesium"),
    named("t", 1013.98, 1013.98, "mercury"),
];

/// Sets of three lines that define a dispersion: name, and the letters from blue to red.
pub const LINE_SETS: [(&str, [&str; 3]); 4] =
    [("FDC", ["F", "D", "C"]), ("FdC", ["F", "d", "C"]), ("FeC", ["F", "e", "C"]), ("F'eC'", ["F'", "e", "C'"])];

/// Returns the line with the given letter. Case matters: `d` is helium, `D` sodium. A typographic apostrophe counts as a
/// straight one.
#[must_use]
pub fn named_line(symbol: &str) -> Option<&'static NamedLine> {
    let symbol = symbol.trim().replace(['\u{2019}', '\u{2032}'], "'");
    NAMED_LINES.iter().find(|l| l.symbol == symbol)
}

/// Wavelength as written in a file: the letter of a line, or a number.
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema)]
#[serde(untagged)]
pub enum LineOrWavelength {
    /// A named spectral line.
    Line(NamedLine),
    /// A wavelength; a bare number is in nm.
    Wavelength(Wavelength),
}

impl LineOrWavelength {
    /// Returns the wavelength, nm.
    #[must_use]
    pub fn nm(self) -> f64 {
        match self {
            Self::Line(line) => line.nominal_nm,
            Self::Wavelength(wavelength) => wavelength.nm(),
        }
    }
}

impl<'de> Deserialize<'de> for NamedLine {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let symbol = String::deserialize(deserializer)?;
        named_line(&symbol).copied().ok_or_else(|| D::Error::custom(format!("no line is called `{symbol}`")))
    }
}

impl JsonSchema for NamedLine {
    fn inline_schema() -> bool {
        true
    }

    fn schema_name() -> Cow<'static, str> {
        "NamedLine".into()
    }

    fn json_schema(_: &mut SchemaGenerator) -> Schema {
        json_schema!({ "enum": NAMED_LINES.map(|line| line.symbol) })
    }
}

/// Returns the three lines of a set such as `F'eC'`, from blue to red.
#[must_use]
pub fn line_set(name: &str) -> Option<[&'static NamedLine; 3]> {
    let name = name.trim().replace(['\u{2019}', '\u{2032}'], "'");
    let (_, symbols) = LINE_SETS.iter().find(|(set, _)| *set == name)?;
    Some(symbols.map(|s| named_line(s).expect("sets are made of named lines")))
}

/// Returns the wavelength in air (nm) of the Balmer line from level `upper` to 2; `None` below 3.
///
/// It is Rydberg's formula with the reduced mass of hydrogen and a constant index of air of 1.000277. The result is the center
/// of the fine structure, within 0.003 nm of the measured wavelength.
#[must_use]
pub fn balmer(upper: u32) -> Option<f64> {
    if upper < 3 {
        return None;
    }
    let hydrogen = RYDBERG_PER_M * PROTON_ELECTRON_MASS_RATIO / (1.0 + PROTON_ELECTRON_MASS_RATIO);
    let n = f64::from(upper);
    Some(1e9 / (hydrogen * (0.25 - 1.0 / (n * n)) * AIR_INDEX))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Precise wavelengths of the named lines in air, in nm, as stated by makers of glass.
    #[test]
    fn precise_lines() {
        for (symbol, want) in [
            ("h", 404.6561),
            ("g", 435.8343),
            ("F'", 479.9914),
            ("F", 486.1327),
            ("e", 546.074),
            ("d", 587.5618),
            ("D", 589.2938),
            ("C'", 643.8469),
            ("C", 656.2725),
            ("r", 706.5188),
            ("A'", 768.195),
        ] {
            assert_eq!(named_line(symbol).expect("named").precise_nm, want, "{symbol}");
        }
    }

    #[test]
    fn nominal_lines_are_the_precise_ones_rounded() {
        assert!(NAMED_LINES.windows(2).all(|w| w[0].nominal_nm < w[1].nominal_nm));
        for l in NAMED_LINES {
            // i, g and D are rounded by custom, not arithmetic: 435.8343 is written 435.84.
            assert!((l.nominal_nm - l.precise_nm).abs() < 0.0075, "{}", l.symbol);
        }
        for (name, symbols) in LINE_SETS {
            let set = line_set(name).expect("known");
            assert_eq!(set.map(|l| l.symbol), symbols);
            assert!(set[0].nominal_nm < set[1].nominal_nm && set[1].nominal_nm < set[2].nominal_nm);
        }
        assert_eq!(named_line("C\u{2032}"), named_line("C'"));
        assert!(named_line("q").is_none() && line_set("abc").is_none());
    }

    /// Rydberg's formula with reduced mass in air of index 1.000277, computed independently.
    #[test]
    fn balmer_lines() {
        for (upper, want) in [(3, 656.288), (4, 486.139), (5, 434.053), (6, 410.180)] {
            let got = balmer(upper).expect("upper level above 2");
            assert!((got - want).abs() <= 0.001, "{upper}: {got}");
        }
        assert!(balmer(2).is_none());
    }
}
