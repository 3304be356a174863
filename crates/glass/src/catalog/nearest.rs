//! Search for the real glass behind a patent's index and Abbe number.

use super::Catalog;
use super::era::{Era, OLDEST, TODAY};
use crate::glass::{Category, Glass, Status};
use crate::lines::LineTriple;

/// A search for glasses. [`Query::new`] asks for the ten nearest optical glasses of all makers and eras.
#[derive(Clone, Debug, PartialEq)]
pub struct Query {
    /// Index at the middle line of `lines`.
    pub n: f64,
    /// Abbe number; if `None`, the index alone decides.
    pub v: Option<f64>,
    /// Lines of the index and the Abbe number, such as [`LineTriple::FDC`] for nd and Vd.
    pub lines: LineTriple,
    /// Makers allowed, any case; all if empty.
    pub makers: Vec<String>,
    /// Categories allowed; all if empty.
    pub categories: Vec<Category>,
    /// Only glasses found in a catalogue of this year or earlier; the oldest bundled one is of 1983.
    pub known_by: Option<u16>,
    /// Only glasses still found in a catalogue of this year or later.
    pub still_in: Option<u16>,
    /// Only glasses that a designer of that time could have had; see [`Era::narrow`].
    pub era: Option<Era>,
    /// Whether obsolete glasses count.
    pub obsolete: bool,
    /// Number of glasses to list.
    pub count: usize,
}

impl Query {
    /// Creates a search for the ten optical glasses nearest to the index `n` and the Abbe number `v` at `lines`; `v` of `None`
    /// leaves the index alone to decide.
    #[must_use]
    pub fn new(n: f64, v: Option<f64>, lines: LineTriple) -> Query {
        Query {
            n,
            v,
            lines,
            makers: Vec::new(),
            categories: vec![Category::OpticalGlass],
            known_by: None,
            still_in: None,
            era: None,
            obsolete: true,
            count: 10,
        }
    }

    fn admits(&self, glass: &Glass) -> bool {
        let maker = self.makers.is_empty() || self.makers.iter().any(|m| m.eq_ignore_ascii_case(&glass.maker));
        let category = self.categories.is_empty() || self.categories.contains(&glass.category);
        let known = self.known_by.is_none_or(|year| glass.years.is_some_and(|(first, _)| first <= year));
        let still = self.still_in.is_none_or(|year| glass.years.is_some_and(|(_, last)| year <= last));
        let of_era = self.era.is_none_or(|era| era.admits(glass));
        maker && category && known && still && of_era && (self.obsolete || glass.status != Status::Obsolete)
    }
}

impl Era {
    /// Narrows a search to glasses of this era.
    pub fn narrow(self, query: &mut Query) {
        match self {
            Era::Year(year) => {
                query.known_by = Some(year.max(OLDEST));
                query.era = Some(self);
            }
            Era::Historical => query.known_by = Some(OLDEST),
            Era::Modern => {
                query.still_in = Some(TODAY);
                query.obsolete = false;
            }
        }
    }
}

/// A glass that was found, and its distance from the query.
#[derive(Clone, Debug, PartialEq)]
pub struct Match {
    /// The glass.
    pub glass: Glass,
    /// Index of the glass at the middle line.
    pub n: f64,
    /// Abbe number of the glass for the lines asked for.
    pub v: f64,
    /// Index of the glass less the one asked for.
    pub delta_n: f64,
    /// Abbe number of the glass less the one asked for; 0 if none was asked for.
    pub delta_v: f64,
    /// Distance in index and Abbe number: 1 is the usual tolerance of a catalogue (0.0005 in n, or 0.5 % in V; ISO 12123, NP050
    /// and AN5).
    pub distance: f64,
}

/// Largest difference of a melt's index, and of the Abbe number of an older list, from the catalogue's for the glass to be the same.
const NEAR: (f64, f64) = (5e-4, 0.5);
/// Tolerance of the index in the ranking.
const TOLERANCE_N: f64 = 5e-4;
/// Relative tolerance of the Abbe number in the ranking.
const TOLERANCE_V: f64 = 5e-3;
/// Distance within which printed figures cannot tell two glasses apart.
const SAME: f64 = 0.02;

impl Catalog {
    /// Returns whether the catalogue has a glass or a plastic within 0.0005 of `nd` and 0.5 of `vd`, for the lines d, F and C.
    #[must_use]
    pub fn has_near(&self, nd: f64, vd: f64) -> bool {
        let (of_n, of_v) = NEAR;
        let is_lens_material =
            |c: Category| matches!(c, Category::OpticalGlass | Category::TechnicalGlass | Category::Plastic);
        let places =
            self.index.iter().map(|(_, place)| *place).filter(|place| is_lens_material(self.category_of(*place)));
        places
            .map(|place| self.glass(place))
            .any(|glass| (glass.nd() - nd).abs() <= of_n && (glass.vd() - vd).abs() <= of_v)
    }

    /// Lists the glasses nearest to an index and an Abbe number, nearest first; glasses of equal distance are sorted by name.
    #[must_use]
    pub fn nearest(&self, query: &Query) -> Vec<Match> {
        let mut matches: Vec<Match> = (self.glasses())
            .filter(|glass| query.admits(glass))
            .filter_map(|glass| {
                let (n, v) = (glass.index(query.lines.mid.wavelength_nm), glass.abbe_number(query.lines));
                let delta_n = n - query.n;
                let delta_v = query.v.map_or(0.0, |asked| v - asked);
                let in_v = query.v.map_or(0.0, |asked| delta_v / (TOLERANCE_V * asked));
                let in_n = delta_n / TOLERANCE_N;
                let distance = (in_n * in_n + in_v * in_v).sqrt();
                distance.is_finite().then_some(Match { glass, n, v, delta_n, delta_v, distance })
            })
            .collect();
        // Of glasses that figures cannot tell apart, those that can be bought come first.
        let rank = |m: &Match| ((m.distance / SAME).floor(), m.distance < SAME && m.glass.status == Status::Obsolete);
        matches.sort_by(|a, b| {
            let ((near, gone), (other_near, other_gone)) = (rank(a), rank(b));
            near.total_cmp(&other_near)
                .then_with(|| gone.cmp(&other_gone))
                .then_with(|| a.distance.total_cmp(&b.distance))
                .then_with(|| a.glass.name.cmp(&b.glass.name))
                .then_with(|| a.glass.maker.cmp(&b.glass.maker))
        });
        matches.truncate(query.count);
        matches
    }
}
