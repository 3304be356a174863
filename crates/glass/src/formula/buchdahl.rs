//! Buchdahl's chromatic coordinate, in which the index of a glass is nearly a parabola.

/// n = N0 + v1 w + v2 w^2 with w = d / (1 + 2.5 d), d = L - L0; `c` is L0, N0, v1, v2, lengths in um.
///
/// P. N. Robb and R. I. Mercado, Applied Optics 22, 1198 (1983), equations 1 and 2.
pub(super) fn buchdahl(c: &[f64; 4], um: f64) -> f64 {
    let d = um - c[0];
    let w = d / (1.0 + 2.5 * d);
    c[1] + w * (c[2] + w * c[3])
}

#[cfg(test)]
mod tests {
    use crate::formula::{Formula, check};

    /// SCHOTT F2 from the table of Robb and Mercado against the maker's indices of the time: within the maximum error
    /// of 4.8e-5 that the table prints.
    #[test]
    fn buchdahl_of_f2() {
        let f2 = Formula::Buchdahl([0.574, 1.621_258, -0.093_127, 0.023_802]);
        check::indices(
            &f2,
            &[(435.8343, 1.64202), (486.1327, 1.63208), (546.074, 1.62408), (587.5618, 1.62004), (656.2725, 1.61503)],
            4.8e-5,
        );
    }
}
