//! Hartmann's form, with which spectroscopists interpolate.

use super::closed_form::form;

form! {
    /// Hartmann: n = c0 + c1 / (L - c2)^c3, where c3 is 1 if it is left out.
    ///
    /// Three measured indices determine the three coefficients without any fitting, and others come out to 1e-5 over the
    /// visible. Old tables of prisms and liquids use this form, often with an exponent of 1.2.
    ///
    /// # Example
    /// ```yaml
    /// {formula: hartmann, coefficients: [1.498958664, 0.007594716, 0.161867846]}
    /// ```
    ///
    /// # References
    /// - J. Hartmann, Astrophysical Journal 8, 218 (1898).
    HARTMANN: "hartmann", "Hartmann", 3..=4 of 4, hartmann
}

fn hartmann(c: &[f64], um: f64) -> f64 {
    let distance = um - c[2];
    let power = if c[3] == 0.0 || c[3] == 1.0 { distance } else { libm::pow(distance, c[3]) };
    c[0] + c[1] / power
}

#[cfg(test)]
mod tests {
    use super::HARTMANN;
    use crate::formula::check;
    use crate::lines;

    /// N-BK7 through three indices of SCHOTT's data sheet (g, F, C), in closed form: the others of the sheet come back to 1.5e-5.
    #[test]
    fn three_indices_give_the_others_of_n_bk7() {
        let through = [(0.435_834_3, 1.526_68), (0.486_132_7, 1.522_38), (0.656_272_5, 1.514_32)];
        let [(l1, n1), (l2, n2), (l3, n3)] = through;
        let ratio = (n1 - n2) / (n2 - n3) * (l3 - l2) / (l2 - l1);
        let pole = (ratio * l1 - l3) / (ratio - 1.0);
        let strength = (n1 - n2) / (1.0 / (l1 - pole) - 1.0 / (l2 - pole));
        let glass = HARTMANN.with(&[n1 - strength / (l1 - pole), strength, pole]);
        let sheet = [(404.6561, 1.53024), (546.074, 1.51872), (587.5618, 1.51680), (706.5188, 1.51289)];
        check::indices(&glass, &sheet, 1.5e-5);
        check::indices(&glass, &[(lines::G.wavelength_nm, n1), (lines::F.wavelength_nm, n2)], 1e-7);
    }

    /// Each coefficient by hand: 1.4 + 0.27 / (0.7 - 0.4)^3 = 11.4.
    #[test]
    fn the_exponent_counts() {
        check::indices(&HARTMANN.with(&[1.4, 0.27, 0.4, 3.0]), &[(700.0, 11.4)], 1e-12);
        check::indices(&HARTMANN.with(&[1.4, 0.03, 0.4, 1.0]), &[(700.0, 1.5)], 1e-12);
    }
}
