//! Herzberger's form, which holds from the ultraviolet to the infrared.

/// n = A + B l + C l^2 + D L^2 + E L^4 + F L^6 with l = 1 / (L^2 - 0.028 um^2).
pub(super) fn herzberger(c: &[f64; 6], square: f64) -> f64 {
    let l = 1.0 / (square - 0.028);
    c[0] + l * (c[1] + l * c[2]) + square * (c[3] + square * (c[4] + square * c[5]))
}

#[cfg(test)]
mod tests {
    use crate::formula::{Formula, check};

    /// Silicon (Herzberger and Salzberg 1962, J. Opt. Soc. Am. 52, 420): constants, and the measured indices of Salzberg
    /// and Villa (1957) to which they were fitted.
    #[test]
    fn herzberger_of_silicon() {
        let silicon = Formula::Herzberger([3.416_96, 0.138_497, 0.013_924, -2.09e-5, 1.48e-7, 0.0]);
        check::indices(
            &silicon,
            &[(2437.3, 3.4408), (2714.4, 3.4358), (3303.3, 3.4297), (5500.0, 3.4213), (10_000.0, 3.4179)],
            4e-4,
        );
    }
}
