//! Power series in the wavelength: Cauchy, Conrady, Schott and the extended forms.

use super::closed_form::form;

form! {
    /// Cauchy: n = c0 + c1 L^-2 + c2 L^-4 + ...
    ///
    /// Two or three terms describe a glass over the visible; one is a constant index.
    ///
    /// # Example
    /// ```yaml
    /// {formula: cauchy, coefficients: [1.5046, 0.0042]}
    /// ```
    CAUCHY: "cauchy", "Cauchy", 1..=8 of 1, |c, um| cauchy(c, um * um)
}

form! {
    /// Conrady: n = c0 + c1 / L + c2 / L^3.5.
    ///
    /// Three terms that describe most glasses over the visible to 1e-5, from few measured indices.
    ///
    /// # Example
    /// ```yaml
    /// {formula: conrady, coefficients: [1.45217, 0.01258, 6.659e-5]}
    /// ```
    ///
    /// # References
    /// - A. E. Conrady, Applied Optics and Optical Design, volume 2 (1960).
    CONRADY: "conrady", "Conrady", 3..=3 of 3, conrady
}

form! {
    /// Schott: n^2 = c0 + c1 L^2 + c2 L^-2 + c3 L^-4 + c4 L^-6 + c5 L^-8.
    ///
    /// The form of glass catalogues until about 1992, and still that of several makers.
    ///
    /// # Example
    /// ```yaml
    /// {formula: schott, coefficients: [2.2718929, -0.010108077, 0.010592509, 0.00020816965, -7.6472538e-6, 4.9240991e-7]}
    /// ```
    SCHOTT: "schott", "Schott", 2..=6 of 6, |c, um| schott(c, um * um).sqrt()
}

form! {
    /// Extended: Schott's form with c6 L^-10 + c7 L^-12 added.
    ///
    /// The additional terms belong to n^2; for glasses that were measured far into the ultraviolet.
    ///
    /// # Example
    /// ```yaml
    /// {formula: extended, coefficients: [2.2181132, -0.005799427, 0.0083470679, 6.5046523e-5, 8.5142186e-6, -5.8852269e-7]}
    /// ```
    EXTENDED: "extended", "Extended", 2..=8 of 8, |c, um| schott(c, um * um).sqrt()
}

form! {
    /// Extended 2: Schott's form with c6 L^4 + c7 L^6 added.
    ///
    /// The additional terms belong to n^2; for glasses that were measured far into the infrared.
    ///
    /// # Example
    /// ```yaml
    /// {formula: extended-2, coefficients: [2.2181132, -0.005799427, 0.0083470679, 6.5046523e-5, 8.5142186e-6, -5.8852269e-7]}
    /// ```
    EXTENDED_2: "extended-2", "Extended 2", 2..=8 of 8, |c, um| extended2(c, um * um).sqrt()
}

form! {
    /// Extended 3: n^2 = c0 + c1 L^2 + c2 L^4 + c3 L^-2 + c4 L^-4, on to c8 L^-12.
    ///
    /// The form of Nikon and of others who give L^4 and six inverse powers.
    ///
    /// # Example
    /// ```yaml
    /// {formula: extended-3, coefficients: [3.22566311, -0.0126719158, -0.000122584245, 0.0306900263, 0.000649958511, 1.0629994e-5, 1.20774149e-6]}
    /// ```
    EXTENDED_3: "extended-3", "Extended 3", 2..=9 of 9, |c, um| extended3(c, um * um).sqrt()
}

/// A + B / L^2 + C / L^4 + ...; `square` is L^2 in um^2.
fn cauchy(c: &[f64], square: f64) -> f64 {
    let x = 1.0 / square;
    c.iter().rev().fold(0.0, |sum, c| sum * x + c)
}

/// n0 + A / L + B / L^3.5.
fn conrady(c: &[f64], um: f64) -> f64 {
    // L^3.5 = L^3 sqrt(L): no library power needed.
    c[0] + c[1] / um + c[2] / (um * um * um * um.sqrt())
}

/// n^2 of Schott's older form, with any number of inverse powers.
fn schott(c: &[f64], square: f64) -> f64 {
    c[0] + c[1] * square + inverse(&c[2..], square)
}

/// n^2 of the Schott form with L^4 and L^6.
fn extended2(c: &[f64], square: f64) -> f64 {
    c[0] + square * (c[1] + square * (c[6] + square * c[7])) + inverse(&c[2..6], square)
}

/// n^2 with L^2, L^4 and six inverse powers.
fn extended3(c: &[f64], square: f64) -> f64 {
    c[0] + square * (c[1] + square * c[2]) + inverse(&c[3..], square)
}

/// c0 L^-2 + c1 L^-4 + ...
fn inverse(c: &[f64], square: f64) -> f64 {
    let x = 1.0 / square;
    x * c.iter().rev().fold(0.0, |sum, c| sum * x + c)
}

#[cfg(test)]
mod tests {
    use super::{CAUCHY, CONRADY, EXTENDED, EXTENDED_2, EXTENDED_3, SCHOTT};
    use crate::formula::{Formula, check};

    /// Cauchy's two terms for BK7, as printed in the textbooks (Jenkins and White; A = 1.5046, B = 0.00420 um^2):
    /// nd of 1.5168 within the fit's own 1e-4, nF and nC within 3e-4.
    #[test]
    fn cauchy_of_borosilicate_crown() {
        check::indices(
            &CAUCHY.with(&[1.5046, 0.00420]),
            &[(587.5618, 1.5168), (486.1327, 1.52238), (656.2725, 1.51432)],
            3e-4,
        );
    }

    /// Constants of Pyrex (Corning 7740) in Conrady's form against Corning's printed nd 1.474 and nF - nC 0.00721 (V 65.4).
    #[test]
    fn conrady_of_pyrex() {
        let pyrex = CONRADY.with(&[1.452_17, 0.012_58, 6.659e-5]);
        check::indices(&pyrex, &[(587.5618, 1.474)], 1e-4);
        let v = crate::LineTriple::FDC.abbe_number(|w| pyrex.index(w));
        assert!((v - 65.4).abs() < 0.1, "{v}");
    }

    /// BK7 in the Schott catalogue of 1967 to 1992: constants and indices of the same page.
    #[test]
    fn schott_of_bk7() {
        let bk7 = SCHOTT.with(&[
            2.271_892_9,
            -1.010_807_7e-2,
            1.059_250_9e-2,
            2.081_696_5e-4,
            -7.647_253_8e-6,
            4.924_099_1e-7,
        ]);
        check::indices(
            &bk7,
            &[
                (365.0146, 1.53627),
                (435.8343, 1.52668),
                (486.1327, 1.52238),
                (546.074, 1.51872),
                (587.5618, 1.51680),
                (656.2725, 1.51432),
                (1013.98, 1.50731),
            ],
            1e-5,
        );
    }

    /// HOYA FCD1 (constants of 2017) has the six Schott terms only; nd 1.49700, Vd 81.61. The same medium written in
    /// each of the longer forms must be the same function, and each further coefficient must weigh its own power.
    #[test]
    fn extended_forms_hold_the_schott_form_and_their_own_powers() {
        let c = [2.218_113_2, -0.005_799_427, 0.008_347_067_9, 6.504_652_3e-5, 8.514_218_6e-6, -5.885_226_9e-7];
        let published = [(587.5618, 1.49700), (486.1327, 1.50123), (656.2725, 1.49514), (435.8343, 1.50451)];
        let pad = [c[0], c[1], c[2], c[3], c[4], c[5], 0.0, 0.0];
        let third = [c[0], c[1], 0.0, c[2], c[3], c[4], c[5], 0.0, 0.0];
        check::indices(&SCHOTT.with(&c), &published, 1e-5);
        check::indices(&EXTENDED.with(&pad), &published, 1e-5);
        check::indices(&EXTENDED_2.with(&pad), &published, 1e-5);
        check::indices(&EXTENDED_3.with(&third), &published, 1e-5);
        let powers = |formula: fn(usize) -> Formula, expected: &[i32]| {
            for (k, power) in expected.iter().enumerate() {
                // n^2 at L = 2 um of a unit coefficient is 2^power.
                let n = formula(k).index(2000.0);
                assert!((n * n - 2f64.powi(*power)).abs() < 1e-14 * 2f64.powi(*power), "coefficient {k}");
            }
        };
        powers(
            |k| EXTENDED.with(&std::array::from_fn::<f64, 8, _>(|i| f64::from(u8::from(i == k)))),
            &[0, 2, -2, -4, -6, -8, -10, -12],
        );
        powers(
            |k| EXTENDED_2.with(&std::array::from_fn::<f64, 8, _>(|i| f64::from(u8::from(i == k)))),
            &[0, 2, -2, -4, -6, -8, 4, 6],
        );
        powers(
            |k| EXTENDED_3.with(&std::array::from_fn::<f64, 9, _>(|i| f64::from(u8::from(i == k)))),
            &[0, 2, 4, -2, -4, -6, -8, -10, -12],
        );
    }

    /// Extended 3 as Nikon uses it: Q-LASFH19S, constants of the maker with its printed nd and Vd.
    #[test]
    fn extended3_of_a_nikon_glass() {
        let glass = EXTENDED_3.with(&[
            3.225_663_11,
            -1.267_191_58e-2,
            -1.225_842_45e-4,
            3.069_002_63e-2,
            6.499_585_11e-4,
            1.062_999_4e-5,
            1.207_741_49e-6,
            0.0,
            0.0,
        ]);
        check::indices(&glass, &[(587.5618, 1.820_98)], 1e-6);
        let v = crate::LineTriple::FDC.abbe_number(|w| glass.index(w));
        assert!((v - 42.656_7).abs() < 1e-3, "{v}");
    }
}
