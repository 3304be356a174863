//! Spectral lines at which refractive indices are stated.
//!
//! Wavelengths are those in air, in nanometers, with the digits that glass makers use (Schott TIE-29; ISO 7944).

use spectra_core::params::{Dimension, Reading, Unit};

/// A spectral line by its Fraunhofer name, or any wavelength taken as one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Line {
    /// Fraunhofer's letter, with a prime for the second line of that letter; empty for a wavelength without a name.
    pub name: &'static str,
    /// Wavelength in air, nm.
    pub wavelength_nm: f64,
}

const fn line(name: &'static str, wavelength_nm: f64) -> Line {
    Line { name, wavelength_nm }
}

/// The line i of mercury, ultraviolet.
pub const I: Line = line("i", 365.0146);
/// The line h of mercury, violet.
pub const H: Line = line("h", 404.6561);
/// The line g of mercury, blue.
pub const G: Line = line("g", 435.8343);
/// The line F' of cadmium, blue.
pub const F_PRIME: Line = line("F'", 479.9914);
/// The line F of hydrogen, blue.
pub const F: Line = line("F", 486.1327);
/// The line e of mercury, green.
pub const E: Line = line("e", 546.074);
/// The line d of helium, yellow: the reference line of most catalogues.
pub const D: Line = line("d", 587.5618);
/// The line D, mean of the sodium doublet, yellow: the reference line of old patents.
pub const SODIUM_D: Line = line("D", 589.2938);
/// The line C' of cadmium, red.
pub const C_PRIME: Line = line("C'", 643.8469);
/// The line C of hydrogen, red.
pub const C: Line = line("C", 656.2725);
/// The line r of helium, red.
pub const R: Line = line("r", 706.5188);
/// The line A' of potassium, deep red.
pub const A_PRIME: Line = line("A'", 768.195);
/// The line s of cesium, infrared.
pub const S: Line = line("s", 852.11);
/// The line t of mercury, infrared.
pub const T: Line = line("t", 1013.98);

/// All lines, from short to long.
pub const ALL: [Line; 14] = [I, H, G, F_PRIME, F, E, D, SODIUM_D, C_PRIME, C, R, A_PRIME, S, T];

/// Wavelengths at which an index may be stated, nm.
const STATED_NM: std::ops::RangeInclusive<f64> = 100.0..=50_000.0;

impl Line {
    /// Returns the line at a wavelength in nm: a named line if the wavelength is exactly its own. `None` outside of 100 to 50 000 nm.
    #[must_use]
    pub fn at(wavelength_nm: f64) -> Option<Line> {
        let named = ALL.into_iter().find(|line| line.wavelength_nm == wavelength_nm);
        named.or_else(|| STATED_NM.contains(&wavelength_nm).then_some(Line { name: "", wavelength_nm }))
    }

    /// Reads the name of a line (`F'`), or a wavelength in nm if bare (`450`, `0.45 um`).
    #[must_use]
    pub fn read(text: &str) -> Option<Line> {
        by_name(text).or_else(|| match Reading::of(text.trim()) {
            Reading::Bare(nm) => Line::at(nm),
            Reading::Quantity { value, unit } if unit.dimension == Dimension::Length => {
                Line::at(unit.convert(value, Unit::find("nm")?))
            }
            _ => None,
        })
    }

    /// Returns the name or, for a line without one, the wavelength: `F'`, `450 nm`.
    #[must_use]
    pub fn label(&self) -> String {
        if self.name.is_empty() { format!("{} nm", self.wavelength_nm) } else { self.name.to_owned() }
    }

    /// Returns the usual name of an index (`symbol` is `n`) or an Abbe number (`V`) at the line: `nd`, `n(450 nm)`.
    #[must_use]
    pub fn indexed(&self, symbol: &str) -> String {
        if self.name.is_empty() { format!("{symbol}({})", self.label()) } else { format!("{symbol}{}", self.name) }
    }
}

/// Finds the line of this name; `d` and `D` differ, so case counts. A prime may be written `'` or typographically.
#[must_use]
pub fn by_name(name: &str) -> Option<Line> {
    let name = name.trim().replace(['\u{2019}', '\u{2032}'], "'");
    ALL.into_iter().find(|line| line.name == name)
}

/// Three lines that define an Abbe number V = (n_mid - 1) / (n_short - n_long).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LineTriple {
    /// The line at which the index itself is stated.
    pub mid: Line,
    /// The blue line.
    pub short: Line,
    /// The red line.
    pub long: Line,
}

impl LineTriple {
    /// Lines F, d, C: Vd, the Abbe number of modern catalogues.
    pub const FDC: LineTriple = LineTriple { mid: D, short: F, long: C };
    /// Lines F, D, C: VD, the Abbe number of old catalogues and patents, for the sodium line.
    pub const F_SODIUM_C: LineTriple = LineTriple { mid: SODIUM_D, short: F, long: C };
    /// Lines F, e, C: reference line e with the hydrogen lines.
    pub const FEC: LineTriple = LineTriple { mid: E, short: F, long: C };
    /// Lines F', e, C': Ve, with reference line e and the cadmium lines.
    pub const F_PRIME_E_C_PRIME: LineTriple = LineTriple { mid: E, short: F_PRIME, long: C_PRIME };

    /// Returns the triple that belongs to a reference line: d and D go with F and C, e with F' and C'; `None` for other lines.
    #[must_use]
    pub fn of_reference(line: Line) -> Option<LineTriple> {
        match line.name {
            "d" => Some(LineTriple::FDC),
            "D" => Some(LineTriple::F_SODIUM_C),
            "e" => Some(LineTriple::F_PRIME_E_C_PRIME),
            _ => None,
        }
    }

    /// Combines three lines into a triple; `None` unless their wavelengths rise from `short` to `long`.
    #[must_use]
    pub fn rising(short: Line, mid: Line, long: Line) -> Option<LineTriple> {
        let rising = short.wavelength_nm < mid.wavelength_nm && mid.wavelength_nm < long.wavelength_nm;
        rising.then_some(LineTriple { mid, short, long })
    }

    /// Reads the lines at which figures are stated, as a person writes them; `None` if it cannot. The text is a reference line
    /// (`d`, `e`), to which two other lines belong, or three lines from blue to red. Each line is a name or a wavelength in nm
    /// (`F',e,C'`, `450,580,680`).
    #[must_use]
    pub fn read(text: &str) -> Option<LineTriple> {
        let lines: Option<Vec<Line>> = text.split(',').map(Line::read).collect();
        match *lines?.as_slice() {
            [line] => LineTriple::of_reference(line),
            [short, mid, long] => LineTriple::rising(short, mid, long),
            _ => None,
        }
    }

    /// Lists the lines from short to long: `F', e, C'`.
    #[must_use]
    pub fn label(&self) -> String {
        [self.short, self.mid, self.long].map(|line| line.label()).join(", ")
    }

    /// Returns the name of the Abbe number: `Vd`, `Ve`, `VD` for the usual lines, otherwise with all three: `V(450 nm, e, C)`.
    #[must_use]
    pub fn abbe_label(&self) -> String {
        let usual = LineTriple::of_reference(self.mid) == Some(*self);
        if usual { self.mid.indexed("V") } else { format!("V({})", self.label()) }
    }

    /// Abbe number of the index function `n(wavelength_nm)`: infinite without dispersion.
    pub fn abbe_number(&self, n: impl Fn(f64) -> f64) -> f64 {
        (n(self.mid.wavelength_nm) - 1.0) / (n(self.short.wavelength_nm) - n(self.long.wavelength_nm))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_case_sensitive_and_unique() {
        assert_eq!(by_name("d"), Some(D));
        assert_eq!(by_name("D"), Some(SODIUM_D));
        assert_eq!(by_name("F\u{2032}"), Some(F_PRIME));
        assert_eq!(by_name("x"), None);
        for pair in ALL.windows(2) {
            assert!(pair[0].wavelength_nm < pair[1].wavelength_nm);
        }
    }

    #[test]
    fn lines_as_a_person_writes_them() {
        assert_eq!(Line::read("F'"), Some(F_PRIME));
        assert_eq!(Line::read("587.5618 nm"), Some(D));
        let named = |text| Line::read(text).map(|line| (line.label(), line.indexed("n")));
        assert_eq!(named("0.45 um"), Some(("450 nm".to_owned(), "n(450 nm)".to_owned())));
        for wrong in ["", "q", "1 kg", "5", "-450", "inf"] {
            assert_eq!(Line::read(wrong), None, "{wrong}");
        }
        assert_eq!(LineTriple::read("e"), Some(LineTriple::F_PRIME_E_C_PRIME));
        assert_eq!(LineTriple::read(" F, e ,C"), Some(LineTriple::FEC));
        assert_eq!(
            LineTriple::read("450,580 nm,680").map(|t| t.abbe_label()).as_deref(),
            Some("V(450 nm, 580 nm, 680 nm)")
        );
        assert_eq!(LineTriple::F_PRIME_E_C_PRIME.abbe_label(), "Ve");
        assert_eq!(LineTriple::FEC.abbe_label(), "V(F, e, C)");
        for wrong in ["g", "C,d,F", "F,d", "F,d,C,r", "d,d,d"] {
            assert_eq!(LineTriple::read(wrong), None, "{wrong}");
        }
    }

    /// Balmer lines from the Rydberg constant of hydrogen (reduced mass), in air of index 1.000277.
    #[test]
    fn hydrogen_lines_follow_balmer() {
        let rydberg = 1.096_775_834e7; // 1/m, hydrogen
        let balmer = |n: f64| 1e9 / (rydberg * (0.25 - 1.0 / (n * n))) / 1.000_277;
        for (level, expected) in [(3.0, 656.288), (4.0, 486.139), (5.0, 434.053), (6.0, 410.180)] {
            assert!((balmer(level) - expected).abs() < 1e-3, "{} {expected}", balmer(level));
        }
        // The catalogue's values are weighted means of the fine structure, some hundredths of a nanometer off.
        assert!((balmer(3.0) - C.wavelength_nm).abs() < 0.02 && (balmer(4.0) - F.wavelength_nm).abs() < 0.01);
    }
}
