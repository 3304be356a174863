//! Check of the catalogue against itself: nd and Vd as computed, and as the makers list them.

use super::Catalog;
use crate::formula::Formula;
use crate::glass::Glass;

/// A medium whose coefficients yield a different nd or Vd from the one that its maker lists.
#[derive(Clone, Debug, PartialEq)]
pub struct Deviation {
    /// The medium.
    pub glass: Glass,
    /// nd as listed.
    pub listed_nd: f64,
    /// Vd as listed.
    pub listed_vd: f64,
    /// nd as computed.
    pub nd: f64,
    /// Vd as computed.
    pub vd: f64,
}

/// The result of checking all listed values.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ListedCheck {
    /// Media with listed nd and Vd and coefficients of their own.
    pub listed: usize,
    /// Media that deviate, by full name.
    pub deviating: Vec<Deviation>,
}

/// Largest difference of computed values from listed ones: nd.
pub const LISTED_TOLERANCE_ND: f64 = 1e-4;
/// Largest difference of computed values from listed ones: Vd.
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
