//! Herzberger's form, which holds from the ultraviolet to the infrared.

use super::closed_form::form;

form! {
    /// Herzberger: n = A + B l + C l^2 + D L^2 + E L^4 + F L^6 with l = 1 / (L^2 - 0.028).
    ///
    /// Coefficients A to F. It holds from the ultraviolet far into the infrared, where the pole is out of reach.
    ///
    /// # Example
    /// ```yaml
    /// {formula: herzberger, coefficients: [2.2596285, 0.0311097853, 0.0010251756, -0.000594355286, 4.49796618e-7]}
    /// ```
    ///
    /// # References
    /// - M. Herzberger and C. D. Salzberg, J. Opt. Soc. Am. 52, 420 (1962).
    HERZBERGER: "herzberger", "Herzberger", 2..=6 of 6, |c, um| herzberger(c, um * um)
}

/// n = A + B l + C l^2 + D L^2 + E L^4 + F L^6 with l = 1 / (L^2 - 0.028 um^2).
pub(super) fn herzberger(c: &[f64], square: f64) -> f64 {
    let l = 1.0 / (square - 0.028);
    c[0] + l * (c[1] + l * c[2]) + square * (c[3] + square * (c[4] + square * c[5]))
}

#[cfg(test)]
mod tests {
    use super::HERZBERGER;
    use crate::formula::check;

    /// Silicon (Herzberger and Salzberg 1962, J. Opt. Soc. Am. 52, 420): constants, and the measured indices of Salzberg
    /// and Villa (1957) to which they were fitted.
    #[test]
    fn herzberger_of_silicon() {
        let silicon = HERZBERGER.with(&[3.416_96, 0.138_497, 0.013_924, -2.09e-5, 1.48e-7, 0.0]);
        check::indices(
            &silicon,
            &[(2437.3, 3.4408), (2714.4, 3.4358), (3303.3, 3.4297), (5500.0, 3.4213), (10_000.0, 3.4179)],
            4e-4,
        );
    }
}
