//! Sellmeier's forms: n^2 as a sum of resonances.

use super::closed_form::form;

form! {
    /// Sellmeier 1: n^2 = 1 + the sum of three K L^2 / (L^2 - M).
    ///
    /// Coefficients K1, M1, K2, M2, K3, M3; the form of most glass catalogues today. Some print B and C in place of K and M, and
    /// B1, B2, B3 before C1, C2, C3.
    ///
    /// # Example
    /// ```yaml
    /// {formula: sellmeier-1, coefficients: [1.03961212, 0.00600069867, 0.231792344, 0.0200179144, 1.01046945, 103.560653]}
    /// ```
    SELLMEIER_1: "sellmeier-1", "Sellmeier 1", 6..=6 of 6, |c, um| terms(c, um * um).sqrt()
}

form! {
    /// Sellmeier 2: n^2 = 1 + A + B1 L^2 / (L^2 - M1^2) + B2 / (L^2 - M2^2).
    ///
    /// Coefficients A, B1, M1, B2, M2: the poles are stated as wavelengths.
    ///
    /// # Example
    /// ```yaml
    /// {formula: sellmeier-2, coefficients: [1.25, 0.01, 0.1, 0.009, 0.12]}
    /// ```
    SELLMEIER_2: "sellmeier-2", "Sellmeier 2", 5..=5 of 5, |c, um| sellmeier2(c, um * um).sqrt()
}

form! {
    /// Sellmeier 3: n^2 = 1 + the sum of four K L^2 / (L^2 - M).
    ///
    /// Coefficients K1, M1 to K4, M4; for media with one more resonance than a glass.
    ///
    /// # Example
    /// ```yaml
    /// {formula: sellmeier-3, coefficients: [0.8559, 0.00345744, 0.8391, 0.019881, 0.0009, 0.038809, 0.6845, 49.070025]}
    /// ```
    SELLMEIER_3: "sellmeier-3", "Sellmeier 3", 8..=8 of 8, |c, um| terms(c, um * um).sqrt()
}

form! {
    /// Sellmeier 4: n^2 = A + B L^2 / (L^2 - C) + D L^2 / (L^2 - E).
    ///
    /// Coefficients A, B, C, D, E; the form in which many crystals are listed.
    ///
    /// # Example
    /// ```yaml
    /// {formula: sellmeier-4, coefficients: [1.38757, 0.70757, 0.00931, 0.18849, 50.99741]}
    /// ```
    SELLMEIER_4: "sellmeier-4", "Sellmeier 4", 5..=5 of 5, |c, um| sellmeier4(c, um * um).sqrt()
}

form! {
    /// Sellmeier 5: n^2 = 1 + the sum of five K L^2 / (L^2 - M).
    ///
    /// Coefficients K1, M1 to K5, M5; for media that are known over several octaves.
    ///
    /// # Example
    /// ```yaml
    /// {formula: sellmeier-5, coefficients: [0.6961663, 0.00467914825849, 0.4079426, 0.01351206307396, 0.8974794, 97.93400253792, 0, 0, 0, 0]}
    /// ```
    SELLMEIER_5: "sellmeier-5", "Sellmeier 5", 10..=10 of 10, |c, um| terms(c, um * um).sqrt()
}

/// n^2 = 1 + sum of K L^2 / (L^2 - M); `c` is K1 M1 K2 M2 ... (forms 1, 3 and 5).
fn terms(c: &[f64], square: f64) -> f64 {
    c.chunks_exact(2).fold(1.0, |sum, term| sum + term[0] * square / (square - term[1]))
}

/// n^2 = 1 + A + B1 L^2 / (L^2 - M1^2) + B2 / (L^2 - M2^2): the poles are given as wavelengths.
fn sellmeier2(c: &[f64], square: f64) -> f64 {
    1.0 + c[0] + c[1] * square / (square - c[2] * c[2]) + c[3] / (square - c[4] * c[4])
}

/// n^2 = A + B L^2 / (L^2 - C) + D L^2 / (L^2 - E).
fn sellmeier4(c: &[f64], square: f64) -> f64 {
    c[0] + c[1] * square / (square - c[2]) + c[3] * square / (square - c[4])
}

#[cfg(test)]
mod tests {
    use super::{SELLMEIER_1, SELLMEIER_2, SELLMEIER_3, SELLMEIER_4, SELLMEIER_5};
    use crate::formula::HERZBERGER;
    use crate::formula::check;

    /// N-BK7, Schott's data sheet: constants and indices of the same sheet.
    #[test]
    fn sellmeier1_of_n_bk7() {
        let n_bk7 = SELLMEIER_1.with(&[
            1.039_612_12,
            0.006_000_698_67,
            0.231_792_344,
            0.020_017_914_4,
            1.010_469_45,
            103.560_653,
        ]);
        check::indices(
            &n_bk7,
            &[
                (365.0146, 1.53627),
                (404.6561, 1.53024),
                (435.8343, 1.52668),
                (546.074, 1.51872),
                (587.5618, 1.51680),
                (706.5188, 1.51289),
                (852.11, 1.50980),
                (1013.98, 1.50731),
            ],
            5.1e-6,
        );
    }

    /// Fused silica (Malitson 1965) in Sellmeier 3 with an empty fourth, and in Sellmeier 5 with two empty terms:
    /// n of his table.
    #[test]
    fn sellmeier3_and_5_of_fused_silica() {
        let (k, m) = ([0.696_166_3, 0.407_942_6, 0.897_479_4], [0.068_404_3, 0.116_241_4, 9.896_161]);
        let published =
            [(404.656, 1.46962), (486.133, 1.46313), (589.264, 1.45841), (1013.98, 1.45024), (2325.42, 1.43293)];
        let mut five = [0.0; 10];
        for i in 0..3 {
            five[2 * i] = k[i];
            five[2 * i + 1] = m[i] * m[i];
        }
        let mut three = [0.0; 8];
        three.copy_from_slice(&five[..8]);
        check::indices(&SELLMEIER_3.with(&three), &published, 1.1e-5);
        check::indices(&SELLMEIER_5.with(&five), &published, 1.1e-5);
        // The last term of each counts too: K L^2 / (L^2 - M) = 3 at L = 2, K = 1.5, M = 2.
        three[6..].copy_from_slice(&[1.5, 2.0]);
        five[8..].copy_from_slice(&[1.5, 2.0]);
        for (formula, plain) in [(SELLMEIER_3.with(&three), 1.438_1), (SELLMEIER_5.with(&five), 1.438_1)] {
            let n = formula.index(2000.0);
            assert!((n * n - 3.0 - plain * plain).abs() < 1e-3, "{n}");
        }
    }

    /// Calcite, ordinary ray, four terms (Handbook of Optics II, table 33.22): the catalogues' nd 1.658643 and Vd 48.541.
    #[test]
    fn sellmeier3_of_calcite() {
        let calcite = SELLMEIER_3.with(&[
            0.8559,
            0.0588 * 0.0588,
            0.8391,
            0.141 * 0.141,
            0.0009,
            0.197 * 0.197,
            0.6845,
            7.005 * 7.005,
        ]);
        check::indices(&calcite, &[(587.5618, 1.658_643)], 1e-6);
        let v = crate::LineTriple::FDC.abbe_number(|w| calcite.index(w));
        assert!((v - 48.541_4).abs() < 1e-3, "{v}");
    }

    /// Zinc sulphide (Debenham 1984, Appl. Opt. 23, 2238): n^2 = 8.393 + 0.14383 / (L^2 - 0.2421^2) plus
    /// 4430.99 / (L^2 - 36.71^2), both poles as wavelengths, against the separately fitted Herzberger constants of Cleartran
    /// zinc sulphide (listed nd 2.367678). The infrared term is B1's once it is written B / M^2 (L^2 / (L^2 - M^2) - 1).
    #[test]
    fn sellmeier2_of_zinc_sulphide() {
        let infrared = 4430.99 / (36.71 * 36.71);
        let zns = SELLMEIER_2.with(&[7.393 - infrared, infrared, 36.71, 0.143_83, 0.2421]);
        let cleartran = HERZBERGER.with(&[
            2.259_628_5,
            3.110_978_53e-2,
            1.025_175_6e-3,
            -5.943_552_86e-4,
            4.497_966_18e-7,
            -4.128_528_34e-9,
        ]);
        for (wavelength_nm, tolerance) in [(587.5618, 1e-4), (10_000.0, 4e-4)] {
            check::indices(&zns, &[(wavelength_nm, cleartran.index(wavelength_nm))], tolerance);
        }
        // 1 + 0 + B1 L^2 / (L^2 - M1^2) at L = 2, M1 = 1: 4/3 B1.
        let n = SELLMEIER_2.with(&[0.0, 0.75, 1.0, 0.0, 0.0]).index(2000.0);
        assert!((n * n - 2.0).abs() < 1e-15);
    }

    /// Lithium yttrium fluoride, ordinary ray (Barnes and Gettemy 1980): nd 1.45378, Vd 93.55.
    #[test]
    fn sellmeier4_of_lithium_yttrium_fluoride() {
        let ylf = SELLMEIER_4.with(&[1.387_57, 0.707_57, 0.009_31, 0.188_49, 50.997_41]);
        check::indices(&ylf, &[(587.5618, 1.453_776)], 2e-5);
        let v = crate::LineTriple::FDC.abbe_number(|w| ylf.index(w));
        assert!((v - 93.55).abs() < 0.05, "{v}");
    }
}
