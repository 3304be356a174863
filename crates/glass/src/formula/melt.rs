//! A catalogue glass as it was measured on one melt.

use super::Formula;
use crate::lines::{D, LineTriple};

/// A glass with the dispersion of a catalogue glass, shifted and scaled to the nd and Vd of a melt sheet. Its index is nd' +
/// (n(lambda) - nd) (nF' - nC') / (nF - nC), where primes mark the melt.
#[derive(Clone, Debug, PartialEq)]
pub struct Melt {
    base: Formula,
    offset: f64,
    factor: f64,
}

impl Melt {
    /// Creates the melt of the glass with formula `base`, with the measured `nd` and `vd`. `None` unless nd > 1, Vd > 0 and the
    /// glass has dispersion.
    #[must_use]
    pub fn new(base: Formula, nd: f64, vd: f64) -> Option<Melt> {
        let n = |w| base.index(w);
        let base_nd = n(D.wavelength_nm);
        let principal_dispersion = n(LineTriple::FDC.short.wavelength_nm) - n(LineTriple::FDC.long.wavelength_nm);
        let factor = (nd - 1.0) / vd / principal_dispersion;
        let usable = nd > 1.0 && nd.is_finite() && vd > 0.0 && factor.is_finite() && factor > 0.0;
        usable.then_some(Melt { base, offset: nd - factor * base_nd, factor })
    }

    pub(super) fn index(&self, wavelength_nm: f64) -> f64 {
        self.offset + self.factor * self.base.index(wavelength_nm)
    }

    /// Formula of the catalogue glass.
    #[must_use]
    pub fn base(&self) -> &Formula {
        &self.base
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::formula::{CAUCHY, SELLMEIER_1};

    /// Schott melts of N-BK7 keep nd within 5e-4 and Vd within 0.5 %: the melt meets its sheet, and its partial dispersion
    /// stays that of the type.
    #[test]
    fn meets_the_melt_sheet() {
        let n_bk7 = SELLMEIER_1.with(&[
            1.039_612_12,
            0.006_000_698_67,
            0.231_792_344,
            0.020_017_914_4,
            1.010_469_45,
            103.560_653,
        ]);
        let melt = Melt::new(n_bk7.clone(), 1.51712, 64.01).map(|m| Formula::Melt(m.into())).expect("a melt");
        assert!((melt.index(D.wavelength_nm) - 1.51712).abs() < 1e-15);
        assert!((LineTriple::FDC.abbe_number(|w| melt.index(w)) - 64.01).abs() < 1e-9);
        let partial = |f: &Formula| (f.index(435.8343) - f.index(486.1327)) / (f.index(486.1327) - f.index(656.2725));
        assert!((partial(&melt) - partial(&n_bk7)).abs() < 1e-12);
        assert!((partial(&n_bk7) - 0.5349).abs() < 1e-4);
    }

    #[test]
    fn no_melt_without_dispersion() {
        for (base, nd, vd) in [(1.5, 1.5, 60.0), (f64::NAN, 1.5, 60.0)] {
            assert!(Melt::new(Formula::Constant(base), nd, vd).is_none());
        }
        let crown = CAUCHY.with(&[1.5, 0.004]);
        assert!(Melt::new(crown.clone(), 1.0, 60.0).is_none() && Melt::new(crown, 1.5, 0.0).is_none());
    }
}
