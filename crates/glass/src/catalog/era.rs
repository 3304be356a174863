//! The glasses that a designer of some time could have had.

use std::str::FromStr;

use crate::glass::{Glass, Status};
use crate::lines::LineTriple;

/// A time for which glasses are chosen, as far as the bundled catalogues can tell.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Era {
    /// Glasses that were listed by that year. The oldest bundled list is of 1983; for earlier years it is used as a whole. For
    /// years before 1940, glasses with rare earths and fluor phosphates are left out (see [`Era::admits`]).
    Year(u16),
    /// Glasses listed by 1983.
    Historical,
    /// Glasses of catalogues of 2017 and later that are still made.
    Modern,
}

/// Year of the oldest bundled list.
pub(super) const OLDEST: u16 = 1983;
/// Year from which a catalogue counts as current.
pub(super) const TODAY: u16 = 2017;
/// Rare-earth glasses came into lenses after the patent of G. W. Morey (US 2150694, filed 1936, granted 1939).
const RARE_EARTH: u16 = 1940;

/// Error of a text that is not an era.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("`{0}` is not an era: use historical, modern, or a year from 1880 to 2100")]
pub struct EraError(String);

impl FromStr for Era {
    type Err = EraError;

    fn from_str(text: &str) -> Result<Era, EraError> {
        match text.trim() {
            "historical" => Ok(Era::Historical),
            "modern" => Ok(Era::Modern),
            year => match year.parse() {
                Ok(year @ 1880..=2100) => Ok(Era::Year(year)),
                _ => Err(EraError(text.to_owned())),
            },
        }
    }
}

impl Era {
    /// Returns whether a glass fits the era by its type; its years are not looked at.
    ///
    /// Before 1940 this is a rule of thumb, drawn through Schott's list of 1983. The old glasses (fluor, phosphate and boron
    /// crowns, crowns and flints, barium crowns and flints) stay below nd + 0.0066 Vd = 2.02 and Vd = 71. Most lanthanum
    /// glasses lie above; the others are recognized by their names. The list has no years of first melting, so some younger
    /// glasses of an old kind pass.
    #[must_use]
    pub fn admits(self, glass: &Glass) -> bool {
        match self {
            Era::Year(year) if year < RARE_EARTH => {
                let (nd, vd) = (glass.nd(), glass.abbe_number(LineTriple::FDC));
                nd + 0.0066 * vd <= 2.02 && vd <= 71.0 && !has_name_of_rare_earths(&glass.name)
            }
            Era::Modern => glass.status != Status::Obsolete,
            Era::Year(_) | Era::Historical => true,
        }
    }
}

/// Returns whether a name is that of a lanthanum, tantalum or niobium type: LaK, LaF, N-LaSF, TaC, TaFD, NbF, S-LAL, J-LASF ...
fn has_name_of_rare_earths(name: &str) -> bool {
    let upper = name.to_uppercase();
    // A letter and a hyphen before the type tell how it is made.
    let bare = upper.split_once('-').filter(|(before, _)| before.len() <= 2).map_or(upper.as_str(), |(_, rest)| rest);
    ["LA", "TA", "NB"].iter().any(|kind| bare.starts_with(kind))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn eras_are_words_or_years() {
        assert_eq!(" 1927".parse(), Ok(Era::Year(1927)));
        assert_eq!("modern".parse(), Ok(Era::Modern));
        for bad in ["", "old", "27", "19277", "-1927"] {
            assert!(bad.parse::<Era>().is_err(), "{bad}");
        }
    }

    #[test]
    fn names_of_rare_earths() {
        for name in ["LAK9", "N-LASF44", "S-LAL14", "TaFD5", "NbF1", "LaF2"] {
            assert!(has_name_of_rare_earths(name), "{name}");
        }
        for name in ["SK16", "BAF9", "N-BK7", "KZFSN5", "F2", "BALF4", "PLANE"] {
            assert!(!has_name_of_rare_earths(name), "{name}");
        }
    }
}
