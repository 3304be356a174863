//! Check of the catalogue against itself: nd and Vd as computed, and as the makers list them.

use super::Catalog;
use crate::formula::Formula;
use crate::glass::Glass;

/// A medium whose computed nd or Vd differs from the value that its maker lists.
#[derive(Clone, Debug, PartialEq)]
pub struct Deviation {
    /// The medium.
    pub glass: Glass,
    /// Index at the d line as the maker lists it.
    pub listed_nd: f64,
    /// Abbe number (d, F, C) as the maker lists it.
    pub listed_vd: f64,
    /// Index at the d line, computed from the coefficients.
    pub nd: f64,
    /// Abbe number (d, F, C), computed from the coefficients.
    pub vd: f64,
}

/// Result of comparing computed with listed values, for a whole catalogue.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ListedCheck {
    /// Number of media that have listed nd and Vd and coefficients of their own.
    pub listed: usize,
    /// Media whose values deviate by more than the tolerances, sorted by full name.
    pub deviating: Vec<Deviation>,
}

/// Largest difference between computed and listed nd that does not count as a deviation.
pub const LISTED_TOLERANCE_ND: f64 = 1e-4;
/// Largest difference between computed and listed Vd that does not count as a deviation.
pub const LISTED_TOLERANCE_VD: f64 = 0.1;

impl Catalog {
    /// Compares computed nd and Vd with those that makers list, for every medium that has both. Media of which only the
    /// listed values are known prove nothing, and are left out.
    #[must_use]
    pub fn check_listed(&self) -> ListedCheck {
        let mut check = ListedCheck::default();
        for glass in self.glasses() {
            let (Some(listed_nd), Some(listed_vd)) = (glass.listed_nd, glass.listed_vd) else { continue };
            if matches!(glass.formula, Formula::Model(_)) {
                continue;
            }
            check.listed += 1;
            let (nd, vd) = (glass.nd(), glass.vd());
            let near = (nd - listed_nd).abs() <= LISTED_TOLERANCE_ND && (vd - listed_vd).abs() <= LISTED_TOLERANCE_VD;
            if !near {
                check.deviating.push(Deviation { glass, listed_nd, listed_vd, nd, vd });
            }
        }
        check.deviating.sort_by_key(|d| d.glass.full_name());
        check
    }
}
