//! One resonance in the ultraviolet, as simple renderers write dispersion.

use super::Formula;
use super::closed_form::form;
use crate::lines::LineTriple;

/// Square of the wavelength of the resonance, um^2, that goes with an index and an Abbe number alone.
const RESONANCE_UM2: f64 = 0.014;

form! {
    /// One resonance: n = c0 + c1 / (L^2 - c2).
    ///
    /// Some renderers lay this curve, with c2 of 0.014 um^2, through an index and an Abbe number;
    /// `glass: {abbe: {curve: resonance, lines: [F, d, C], n: 1.62004, v: 36.37}}` finds the other two coefficients. Real
    /// glasses rise more steeply toward violet: F2 is off by 9e-4 at 405 nm, where the usual curve of an Abbe number is off by
    /// 8e-5.
    ///
    /// # Example
    /// ```yaml
    /// {formula: resonance, coefficients: [1.59441, 0.0085, 0.014]}
    /// ```
    RESONANCE: "resonance", "One resonance", 3..=3 of 3, |c, um| c[0] + c[1] / (um * um - c[2])
}

/// Returns the curve of one resonance at 0.014 um^2 through the index `n` at the middle of three lines with the Abbe number `v`.
pub(crate) fn through(n: f64, v: f64, lines: LineTriple) -> Formula {
    let shape = |nm: f64| 1.0 / (nm * nm * 1e-6 - RESONANCE_UM2);
    let [short, mid, long] = [lines.short, lines.mid, lines.long].map(|line| shape(line.wavelength_nm));
    let strength = (n - 1.0) / v / (short - long);
    RESONANCE.with(&[n - strength * mid, strength, RESONANCE_UM2])
}

#[cfg(test)]
mod tests {
    use super::{RESONANCE, through};
    use crate::formula::check;
    use crate::lines::{self, LineTriple};

    /// F2 by SCHOTT's sheet, nd 1.62004 and Vd 36.37: met at the three lines; at the h line 9e-4 from the sheet's 1.65064.
    #[test]
    fn an_index_and_an_abbe_number_are_met() {
        let curve = through(1.62004, 36.37, LineTriple::FDC);
        check::indices(&curve, &[(lines::D.wavelength_nm, 1.62004)], 1e-12);
        let v = LineTriple::FDC.abbe_number(|nm| curve.index(nm));
        assert!((v - 36.37).abs() < 1e-9, "{v}");
        let off = curve.index(lines::H.wavelength_nm) - 1.65064;
        assert!((off + 9e-4).abs() < 1.5e-4, "{off:e}");
    }

    /// Each coefficient by hand: 1.5 + 0.02 / (0.25 - 0.05) = 1.6.
    #[test]
    fn each_coefficient_counts() {
        check::indices(&RESONANCE.with(&[1.5, 0.02, 0.05]), &[(500.0, 1.6)], 1e-12);
    }
}
