//! Buchdahl's chromatic coordinate, in which the index of a glass is nearly a parabola.

use super::closed_form::form;

form! {
    /// Buchdahl: n = N0 + v1 w + v2 w^2 with w = (L - L0) / (1 + 2.5 (L - L0)).
    ///
    /// Coefficients L0, N0, v1, v2. In this chromatic coordinate the index of a glass is nearly a parabola.
    ///
    /// # Example
    /// ```yaml
    /// {formula: buchdahl, coefficients: [0.574, 1.621258, -0.093127, 0.023802]}
    /// ```
    ///
    /// # References
    /// - P. N. Robb and R. I. Mercado, Applied Optics 22, 1198 (1983).
    BUCHDAHL: "buchdahl", "Buchdahl", 4..=4 of 4, buchdahl
}

/// n = N0 + v1 w + v2 w^2 with w = d / (1 + 2.5 d), d = L - L0; `c` is L0, N0, v1, v2, lengths in um.
///
/// P. N. Robb and R. I. Mercado, Applied Optics 22, 1198 (1983), equations 1 and 2.
fn buchdahl(c: &[f64], um: f64) -> f64 {
    let d = um - c[0];
    let w = d / (1.0 + 2.5 * d);
    c[1] + w * (c[2] + w * c[3])
}

#[cfg(test)]
mod tests {
    use super::BUCHDAHL;
    use crate::formula::check;

    /// SCHOTT F2 from the table of Robb and Mercado against the maker's indices of the time: within the maximum error
    /// of 4.8e-5 that the table prints.
    #[test]
    fn buchdahl_of_f2() {
        let f2 = BUCHDAHL.with(&[0.574, 1.621_258, -0.093_127, 0.023_802]);
        check::indices(
            &f2,
            &[(435.8343, 1.64202), (486.1327, 1.63208), (546.074, 1.62408), (587.5618, 1.62004), (656.2725, 1.61503)],
            4.8e-5,
        );
    }
}
