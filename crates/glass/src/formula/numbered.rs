//! The nine numbered forms of the refractiveindex.info database.

use super::Formula;

/// Registers a form by its number.
macro_rules! numbered {
    ($(#[doc = $doc:literal])* $name:literal, $number:literal) => {
        const _: () = {
            $(#[doc = $doc])*
            #[derive(Debug, serde::Deserialize, schemars::JsonSchema)]
            #[serde(deny_unknown_fields)]
            struct Params {
                /// Coefficients C1, C2, ... of the form, with lengths in micrometers.
                #[schemars(length(min = 1, max = 41))]
                coefficients: Vec<f64>,
            }

            spectra_core::register!(crate::FormulaEntry, $name: Params, |params, _| {
                let p: Params = params.parse()?;
                let formula = NumberedFormula::new($number, &p.coefficients).map(|formula| Box::new(Formula::Numbered(formula)));
                let text = || format!("{} coefficients do not fit the form", p.coefficients.len());
                formula.ok_or_else(|| params.fault("coefficients", text()).hint("write them as refractiveindex.info does").into())
            });
        };
    };
}

numbered! {
    /// refractiveindex.info 1: n^2 - 1 = C1 + C2 L^2 / (L^2 - C3^2) + ....
    ///
    /// Sellmeier with poles as wavelengths; C1 and up to twenty pairs.
    ///
    /// # Example
    /// ```yaml
    /// {formula: refractiveindex-1, coefficients: [0, 0.6961663, 0.0684043, 0.4079426, 0.1162414, 0.8974794, 9.896161]}
    /// ```
    ///
    /// # References
    /// - M. N. Polyanskiy, Sci. Data 11, 94 (2024).
    "refractiveindex-1", 1
}
numbered! {
    /// refractiveindex.info 2: n^2 - 1 = C1 + C2 L^2 / (L^2 - C3) + ....
    ///
    /// Sellmeier with poles as squared wavelengths; C1 and up to twenty pairs.
    ///
    /// # Example
    /// ```yaml
    /// {formula: refractiveindex-2, coefficients: [0, 1.34533359, 0.00997743871, 0.209073176, 0.0470450767, 0.937357162, 111.886764]}
    /// ```
    ///
    /// # References
    /// - M. N. Polyanskiy, Sci. Data 11, 94 (2024).
    "refractiveindex-2", 2
}
numbered! {
    /// refractiveindex.info 3: n^2 = C1 + C2 L^C3 + C4 L^C5 + ....
    ///
    /// A polynomial in the wavelength with stated powers; C1 and up to twenty pairs.
    ///
    /// # Example
    /// ```yaml
    /// {formula: refractiveindex-3, coefficients: [2.2181132, -0.005799427, 2, 0.0083470679, -2, 6.5046523e-5, -4]}
    /// ```
    ///
    /// # References
    /// - M. N. Polyanskiy, Sci. Data 11, 94 (2024).
    "refractiveindex-3", 3
}
numbered! {
    /// refractiveindex.info 4: n^2 = C1 + two resonances of four coefficients + C10 L^C11 + ....
    ///
    /// A resonance is C2 L^C3 / (L^2 - C4^C5). It is used for crystals with unusual powers.
    ///
    /// # Example
    /// ```yaml
    /// {formula: refractiveindex-4, coefficients: [2.259276, 13.00522, 2, 400, 1, 0.01008956, 0, 0.0129426, 1]}
    /// ```
    ///
    /// # References
    /// - M. N. Polyanskiy, Sci. Data 11, 94 (2024).
    "refractiveindex-4", 4
}
numbered! {
    /// refractiveindex.info 5: n = C1 + C2 L^C3 + C4 L^C5 + ....
    ///
    /// Cauchy's form with stated powers; C1 and up to twenty pairs. It is used mostly for liquids and plastics.
    ///
    /// # Example
    /// ```yaml
    /// {formula: refractiveindex-5, coefficients: [1.35265, 0.00306, -2, 0.00002, -4]}
    /// ```
    ///
    /// # References
    /// - M. N. Polyanskiy, Sci. Data 11, 94 (2024).
    "refractiveindex-5", 5
}
numbered! {
    /// refractiveindex.info 6: n - 1 = C1 + C2 / (C3 - L^-2) + ....
    ///
    /// It is used for gases; C1 and up to twenty pairs, as in the database refractiveindex.info.
    ///
    /// # Example
    /// ```yaml
    /// {formula: refractiveindex-6, coefficients: [0, 0.05792105, 238.0185, 0.00167917, 57.362]}
    /// ```
    ///
    /// # References
    /// - M. N. Polyanskiy, Sci. Data 11, 94 (2024).
    "refractiveindex-6", 6
}
numbered! {
    /// refractiveindex.info 7: n = C1 + C2 l + C3 l^2 + C4 L^2 + C5 L^4 + C6 L^6, l = 1 / (L^2 - 0.028).
    ///
    /// Herzberger's form, for media that are clear far into the infrared, as in the database refractiveindex.info.
    ///
    /// # Example
    /// ```yaml
    /// {formula: refractiveindex-7, coefficients: [2.2596285, 0.0311097853, 0.0010251756, -0.000594355286, 4.49796618e-7, 0]}
    /// ```
    ///
    /// # References
    /// - M. N. Polyanskiy, Sci. Data 11, 94 (2024).
    "refractiveindex-7", 7
}
numbered! {
    /// refractiveindex.info 8: (n^2 - 1) / (n^2 + 2) = C1 + C2 L^2 / (L^2 - C3) + C4 L^2.
    ///
    /// The form of Lorentz and Lorenz, with four coefficients, for a few salts of silver.
    ///
    /// # Example
    /// ```yaml
    /// {formula: refractiveindex-8, coefficients: [0.452505, 0.09939, 0.070537, -0.00015]}
    /// ```
    ///
    /// # References
    /// - M. N. Polyanskiy, Sci. Data 11, 94 (2024).
    "refractiveindex-8", 8
}
numbered! {
    /// refractiveindex.info 9: n^2 = C1 + C2 / (L^2 - C3) + C4 (L - C5) / ((L - C5)^2 + C6).
    ///
    /// It has six coefficients and is used for urea and the like, as in the database refractiveindex.info.
    ///
    /// # Example
    /// ```yaml
    /// {formula: refractiveindex-9, coefficients: [2.51527, 0.024, 0.03, 0.02, 1.52, 0.8771]}
    /// ```
    ///
    /// # References
    /// - M. N. Polyanskiy, Sci. Data 11, 94 (2024).
    "refractiveindex-9", 9
}

/// A form of refractiveindex.info, 1 to 9, with its coefficients C1, C2, ... in the order of the database.
///
/// Source: M. N. Polyanskiy, "Dispersion formulas", refractiveindex.info; L is the wavelength in micrometers.
#[derive(Clone, Debug, PartialEq)]
pub struct NumberedFormula {
    number: u8,
    coefficients: Box<[f64]>,
}

impl NumberedFormula {
    /// Creates form `number` with `coefficients`; coefficients that are missing at the end are 0. `None` unless `number` is 1 to
    /// 9 and the form can have that many coefficients.
    #[must_use]
    pub fn new(number: u8, coefficients: &[f64]) -> Option<NumberedFormula> {
        let (at_least, at_most) = match number {
            // 1 + pairs of strength and pole, or of coefficient and power.
            1 | 2 | 3 | 5 | 6 => (1, 41),
            4 => (9, 41),
            7 | 9 => (6, 6),
            8 => (4, 4),
            _ => return None,
        };
        let mut c = coefficients.to_vec();
        let length = c.len().max(at_least);
        // A pair that is cut short has a coefficient without a power.
        let odd = matches!(number, 1..=6) && length % 2 == 0;
        if c.is_empty() || length > at_most || odd || c.iter().any(|c| !c.is_finite()) {
            return None;
        }
        c.resize(length, 0.0);
        Some(NumberedFormula { number, coefficients: c.into() })
    }

    /// Number of the form, 1 to 9.
    #[must_use]
    pub fn number(&self) -> u8 {
        self.number
    }

    /// Coefficients C1, C2, ... of the form.
    #[must_use]
    pub fn coefficients(&self) -> &[f64] {
        &self.coefficients
    }

    /// Name of the form in the database.
    #[must_use]
    pub fn name(&self) -> &'static str {
        match self.number {
            1 => "Sellmeier (form 1)",
            2 => "Sellmeier-2 (form 2)",
            3 => "Polynomial (form 3)",
            4 => "RefractiveIndex.INFO (form 4)",
            5 => "Cauchy (form 5)",
            6 => "Gases (form 6)",
            7 => "Herzberger (form 7)",
            8 => "Retro (form 8)",
            _ => "Exotic (form 9)",
        }
    }

    /// Index at a wavelength in micrometers.
    pub(super) fn index(&self, um: f64) -> f64 {
        let c = &self.coefficients;
        let square = um * um;
        let pairs = |from: usize| c[from..].chunks_exact(2).map(|pair| (pair[0], pair[1]));
        match self.number {
            1 => pairs(1).fold(1.0 + c[0], |s, (b, m)| s + b * square / (square - m * m)).sqrt(),
            2 => pairs(1).fold(1.0 + c[0], |s, (b, m)| s + b * square / (square - m)).sqrt(),
            3 => pairs(1).fold(c[0], |s, (b, p)| s + b * power(um, p)).sqrt(),
            4 => {
                // A resonance without strength has no pole: 0^0 is 1, which would put one at 1 um.
                let resonance = |c: &[f64]| {
                    if c[0] == 0.0 { 0.0 } else { c[0] * power(um, c[1]) / (square - power(c[2], c[3])) }
                };
                let start = c[0] + resonance(&c[1..5]) + resonance(&c[5..9]);
                pairs(9).fold(start, |s, (b, p)| s + b * power(um, p)).sqrt()
            }
            5 => pairs(1).fold(c[0], |s, (b, p)| s + b * power(um, p)),
            6 => pairs(1).fold(1.0 + c[0], |s, (b, m)| s + b / (m - 1.0 / square)),
            7 => super::herzberger::herzberger(&[c[0], c[1], c[2], c[3], c[4], c[5]], square),
            8 => {
                // (n^2 - 1) / (n^2 + 2) = y
                let y = c[0] + c[1] * square / (square - c[2]) + c[3] * square;
                ((1.0 + 2.0 * y) / (1.0 - y)).sqrt()
            }
            _ => {
                let d = um - c[4];
                (c[0] + c[1] / (square - c[2]) + c[3] * d / (d * d + c[5])).sqrt()
            }
        }
    }
}

/// Raises x to the power p: whole powers by multiplication, others through libm. 0^0 is 1, as in the database.
fn power(x: f64, p: f64) -> f64 {
    if p == libm::trunc(p) && p.abs() <= 32.0 {
        let mut result = 1.0;
        for _ in 0..p.abs() as u32 {
            result *= x;
        }
        if p < 0.0 { 1.0 / result } else { result }
    } else {
        libm::pow(x, p)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::formula::check;

    fn form(number: u8, c: &[f64]) -> Formula {
        Formula::Numbered(NumberedFormula::new(number, c).expect("a form"))
    }

    /// Fused silica, Malitson 1965: poles as wavelengths.
    #[test]
    fn form_1_of_fused_silica() {
        let silica = form(1, &[0.0, 0.696_166_3, 0.068_404_3, 0.407_942_6, 0.116_241_4, 0.897_479_4, 9.896_161]);
        check::indices(&silica, &[(404.656, 1.46962), (587.561, 1.45847), (656.272, 1.45637)], 1e-5);
    }

    /// SCHOTT F2, the maker's sheet: nd 1.62004, nF 1.63208, nC 1.61503.
    #[test]
    fn form_2_of_f2() {
        let f2 =
            form(2, &[0.0, 1.345_333_59, 0.009_977_438_71, 0.209_073_176, 0.047_045_076_7, 0.937_357_162, 111.886_764]);
        check::indices(&f2, &[(587.5618, 1.62004), (486.1327, 1.63208), (656.2725, 1.61503)], 5.1e-6);
    }

    /// HOYA FCD1: nd 1.49700.
    #[test]
    fn form_3_of_fcd1() {
        let c = [
            2.218_113_2,
            -0.005_799_427,
            2.0,
            0.008_347_067_9,
            -2.0,
            6.504_652_3e-5,
            -4.0,
            8.514_218_6e-6,
            -6.0,
            -5.885_226_9e-7,
            -8.0,
        ];
        check::indices(&form(3, &c), &[(587.5618, 1.49700), (435.8343, 1.50451)], 1e-5);
    }

    /// KDP, ordinary ray (Zernike 1964, J. Opt. Soc. Am. 54, 1215), with both kinds of resonance: constants and measured
    /// indices of the paper.
    #[test]
    fn form_4_of_kdp() {
        let kdp = form(4, &[2.259_276, 13.005_22, 2.0, 400.0, 1.0, 0.010_089_56, 0.0, 0.012_942_6, 1.0]);
        check::indices(&kdp, &[(546.07, 1.51152), (578.0, 1.50987), (632.8, 1.50737)], 3e-4);
        // Further pairs add powers: + 0.5 L^2 at L = 1 um.
        let more = form(4, &[2.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.5, 2.0]);
        let n = more.index(1000.0);
        assert!((n * n - 2.5).abs() < 1e-14);
    }

    /// Ethanol at 20 C (Rheims 1997): 1.3616 at the sodium line (CRC: 1.3611).
    #[test]
    fn form_5_of_ethanol() {
        let ethanol = form(5, &[1.352_65, 0.003_06, -2.0, 0.000_02, -4.0]);
        check::indices(&ethanol, &[(589.3, 1.3616)], 2e-4);
    }

    /// Standard air (Ciddor 1996; 15 C, 101 325 Pa, 450 ppm CO2): 1e8 (n - 1) = 27 653 at 633 nm.
    #[test]
    fn form_6_of_air() {
        let air = form(6, &[0.0, 0.057_921_05, 238.0185, 0.001_679_17, 57.362]);
        check::indices(&air, &[(633.0, 1.000_276_5)], 1e-7);
    }

    /// Silicon at 26 C (Edwards and Ochoa 1980, Appl. Opt. 19, 4130): 3.4215 at 10 um in Palik's table.
    #[test]
    fn form_7_of_silicon() {
        let silicon = form(7, &[3.419_83, 0.159_906, -0.123_109, 1.268_78e-6, -1.951_04e-9]);
        check::indices(&silicon, &[(10_000.0, 3.4215), (2437.3, 3.4434)], 5e-4);
    }

    /// Silver bromide (Schroeter 1931, Z. Phys. 67, 24), the form of Lorentz and Lorenz: 2.253 at the sodium line (CRC).
    #[test]
    fn form_8_of_silver_bromide() {
        check::indices(&form(8, &[0.452_505, 0.099_39, 0.070_537, -0.000_150]), &[(589.3, 2.253)], 5e-3);
    }

    /// Each term of the form by hand, at L = 2 um: 1 + 3 / (4 - 1) + 2 * 1 / (1 + 1) = 3.
    #[test]
    fn form_9_by_hand() {
        check::indices(&form(9, &[1.0, 3.0, 1.0, 2.0, 1.0, 1.0]), &[(2000.0, 3f64.sqrt())], 1e-15);
    }

    #[test]
    fn refuses_what_is_no_form() {
        assert!(NumberedFormula::new(0, &[1.0]).is_none());
        assert!(NumberedFormula::new(10, &[1.0]).is_none());
        assert!(NumberedFormula::new(2, &[]).is_none());
        assert!(NumberedFormula::new(2, &[0.0, 1.0]).is_none());
        assert!(NumberedFormula::new(2, &[0.0, f64::NAN, 1.0]).is_none());
        assert_eq!(NumberedFormula::new(4, &[2.0]).map(|f| f.coefficients().len()), Some(9));
    }
}
