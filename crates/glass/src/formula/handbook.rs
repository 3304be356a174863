//! The two forms of the Handbook of Optics.

use super::closed_form::form;

form! {
    /// Handbook of Optics 1: n^2 = A + B / (L^2 - C) - D L^2.
    ///
    /// Coefficients A, B, C, D, as the Handbook of Optics lists many crystals.
    ///
    /// # Example
    /// ```yaml
    /// {formula: handbook-1, coefficients: [2.7405, 0.0184, 0.0179, 0.0155]}
    /// ```
    HANDBOOK_1: "handbook-1", "Handbook of Optics 1", 4..=4 of 4, |c, um| handbook1(c, um * um).sqrt()
}

form! {
    /// Handbook of Optics 2: n^2 = A + B L^2 / (L^2 - C) - D L^2.
    ///
    /// Coefficients A, B, C, D, as the Handbook of Optics lists other crystals.
    ///
    /// # Example
    /// ```yaml
    /// {formula: handbook-2, coefficients: [2.81418, 0.87968, 0.09253764, 0.00711]}
    /// ```
    HANDBOOK_2: "handbook-2", "Handbook of Optics 2", 4..=4 of 4, |c, um| handbook2(c, um * um).sqrt()
}

/// n^2 = A + B / (L^2 - C) - D L^2.
fn handbook1(c: &[f64], square: f64) -> f64 {
    c[0] + c[1] / (square - c[2]) - c[3] * square
}

/// n^2 = A + B L^2 / (L^2 - C) - D L^2.
fn handbook2(c: &[f64], square: f64) -> f64 {
    c[0] + c[1] * square / (square - c[2]) - c[3] * square
}

#[cfg(test)]
mod tests {
    use super::{HANDBOOK_1, HANDBOOK_2};
    use crate::formula::check;

    /// Beta barium borate (Eimerl et al. 1987, J. Appl. Phys. 62, 1968): constants and measured indices of the paper.
    #[test]
    fn handbook1_of_beta_barium_borate() {
        let ordinary = HANDBOOK_1.with(&[2.7405, 0.0184, 0.0179, 0.0155]);
        let extraordinary = HANDBOOK_1.with(&[2.3730, 0.0128, 0.0156, 0.0044]);
        check::indices(&ordinary, &[(1064.2, 1.65510), (532.1, 1.67493), (354.7, 1.70556)], 1e-3);
        check::indices(&extraordinary, &[(1064.2, 1.54254), (532.1, 1.55552), (354.7, 1.57757)], 1e-3);
    }

    /// Potassium titanyl phosphate (Fan et al. 1987, Appl. Opt. 26, 2390): n_x 1.7377 and n_z 1.8305 at 1064 nm,
    /// n_x 1.7785 and n_z 1.8894 at 532 nm.
    #[test]
    fn handbook2_of_potassium_titanyl_phosphate() {
        let x = HANDBOOK_2.with(&[2.167_47, 0.837_33, 0.046_11, 0.017_13]);
        let z = HANDBOOK_2.with(&[2.254_11, 1.065_43, 0.054_86, 0.021_40]);
        check::indices(&x, &[(1064.2, 1.7379), (532.1, 1.7785)], 1e-3);
        check::indices(&z, &[(1064.2, 1.8297), (532.1, 1.8873)], 2.5e-3);
    }

    /// Zinc oxide, ordinary ray (Handbook of Optics II, after Bond 1965): n 1.9985 at 600 nm in Bond's table.
    #[test]
    fn handbook2_of_zinc_oxide() {
        let oxide = HANDBOOK_2.with(&[2.814_18, 0.879_68, 0.304_2 * 0.304_2, 0.007_11]);
        check::indices(&oxide, &[(600.0, 1.9985), (1000.0, 1.9435)], 2e-3);
    }
}
