//! Spectral lines at which refractive indices are stated.
//!
//! Wavelengths are those in air, in nanometres, with the digits that glass makers use (Schott TIE-29; ISO 7944).

/// A spectral line by its Fraunhofer name.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Line {
    /// Fraunhofer's letter, with a prime where a second line bears it.
    pub name: &'static str,
    /// Wavelength in air, nm.
    pub wavelength_nm: f64,
}

const fn line(name: &'static str, wavelength_nm: f64) -> Line {
    Line { name, wavelength_nm }
}

/// i, mercury, ultraviolet.
pub const I: Line = line("i", 365.0146);
/// h, mercury, violet.
pub const H: Line = line("h", 404.6561);
/// g, mercury, blue.
pub const G: Line = line("g", 435.8343);
/// F', cadmium, blue.
pub const F_PRIME: Line = line("F'", 479.9914);
/// F, hydrogen, blue.
pub const F: Line = line("F", 486.1327);
/// e, mercury, green.
pub const E: Line = line("e", 546.074);
/// d, helium, yellow: the reference line of most catalogues.
pub const D: Line = line("d", 587.5618);
/// D, mean of the sodium doublet, yellow: the reference line of old patents.
pub const SODIUM_D: Line = line("D", 589.2938);
/// C', cadmium, red.
pub const C_PRIME: Line = line("C'", 643.8469);
/// C, hydrogen, red.
pub const C: Line = line("C", 656.2725);
/// r, helium, red.
pub const R: Line = line("r", 706.5188);
/// A', potassium, deep red.
pub const A_PRIME: Line = line("A'", 768.195);
/// s, caesium, infrared.
pub const S: Line = line("s", 852.11);
/// t, mercury, infrared.
pub const T: Line = line("t", 1013.98);

/// All lines, from short to long.
pub const ALL: [Line; 14] = [I, H, G, F_PRIME, F, E, D, SODIUM_D, C_PRIME, C, R, A_PRIME, S, T];

/// The line of that name; `d` and `D` differ, so case counts. A prime may be written `'` or typographically.
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
    /// F, d, C: Vd, the Abbe number of modern catalogues.
    pub const FDC: LineTriple = LineTriple { mid: D, short: F, long: C };
    /// F, D, C: the sodium line's Abbe number of old catalogues and patents.
    pub const F_SODIUM_C: LineTriple = LineTriple { mid: SODIUM_D, short: F, long: C };
    /// F, e, C.
    pub const FEC: LineTriple = LineTriple { mid: E, short: F, long: C };
    /// F', e, C': Ve.
    pub const F_PRIME_E_C_PRIME: LineTriple = LineTriple { mid: E, short: F_PRIME, long: C_PRIME };

    /// The triple that belongs to a reference line: d and D go with F and C, e with F' and C'; none for other lines.
    #[must_use]
    pub fn of_reference(line: Line) -> Option<LineTriple> {
        match line.name {
            "d" => Some(LineTriple::FDC),
            "D" => Some(LineTriple::F_SODIUM_C),
            "e" => Some(LineTriple::F_PRIME_E_C_PRIME),
            _ => None,
        }
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

    /// Balmer lines from the Rydberg constant of hydrogen (reduced mass), in air of index 1.000277.
    #[test]
    fn hydrogen_lines_follow_balmer() {
        let rydberg = 1.096_775_834e7; // 1/m, hydrogen
        let balmer = |n: f64| 1e9 / (rydberg * (0.25 - 1.0 / (n * n))) / 1.000_277;
        for (level, expected) in [(3.0, 656.288), (4.0, 486.139), (5.0, 434.053), (6.0, 410.180)] {
            assert!((balmer(level) - expected).abs() < 1e-3, "{} {expected}", balmer(level));
        }
        // The catalogue's values are weighted means of the fine structure, some hundredths of a nanometre off.
        assert!((balmer(3.0) - C.wavelength_nm).abs() < 0.02 && (balmer(4.0) - F.wavelength_nm).abs() < 0.01);
    }
}
