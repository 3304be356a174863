//! Absorption of glasses without published data: that of the nearest glass that has data.
//!
//! Makers print internal transmittance for what they sell today. Nothing is published for most older glasses, and for a glass
//! known by its nd and Vd. Blue and violet absorption follows the ultraviolet edge, and that follows index and dispersion. The
//! neighbor in the Abbe diagram is therefore a better guess than perfect clarity.

use std::fmt;
use std::sync::OnceLock;

use super::{Catalog, RecordIndex};
use crate::formula::ModelGlass;
use crate::glass::{Category, Extinction, Glass};
use crate::lines::{D, LineTriple};
use crate::medium::Medium;

/// One unit of distance in the index.
const UNIT_ND: f64 = 0.01;
/// One unit of distance in the Abbe number.
const UNIT_VD: f64 = 1.0;
/// Distance added for a glass of another maker, and for one of another time.
const ANOTHER: f64 = 1.0;
/// Largest distance of glasses that are alike: 0.1 in nd, or 10 in Vd.
const FARTHEST: f64 = 10.0;
/// Least transmittance of a lender's plate of 3 mm at every wavelength from 420 to 700 nm, so that it is fit for optics. Much
/// research data of plastics come from ellipsometers, which do not see small absorption; what they leave would make any lens
/// opaque.
const LEAST_PASSED: f64 = 0.8;
/// Last year of the list of lead and arsenic glasses, the oldest one of the catalogue.
const OLD_LIST: u16 = 1983;
/// Year until which, roughly, lenses were made of these glasses.
const OLD_UNTIL: i32 = 1990;

/// A glass whose absorption is used for another glass that has no data.
#[derive(Clone, Debug, PartialEq)]
pub struct AbsorptionSubstitute {
    /// Full name of the glass that lends its absorption: `MAKER/NAME`.
    pub full_name: String,
    /// Index of the lending glass less the index of the borrowing one, at the d line.
    pub delta_nd: f64,
    /// Abbe number of the lending glass less that of the borrowing one, for the lines d, F and C.
    pub delta_vd: f64,
    /// Distance of both glasses in index and Abbe number; see [`Medium::absorption`].
    pub distance: f64,
}

impl fmt::Display for AbsorptionSubstitute {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} (nd {:+.4}, Vd {:+.1})", self.full_name, self.delta_nd, self.delta_vd)
    }
}

/// The absorption of a medium.
#[derive(Clone, Debug, PartialEq)]
pub struct Absorption {
    /// Extinction coefficient of the medium by wavelength.
    pub extinction: Extinction,
    /// Glass from which the data are borrowed; `None` if they are the medium's own.
    pub lender: Option<AbsorptionSubstitute>,
}

/// A glass that needs absorption data.
struct Borrower<'a> {
    nd: f64,
    vd: f64,
    category: Category,
    maker: Option<&'a str>,
    /// Whether the glass is of the time of the oldest list; `None` if that is not known.
    old: Option<bool>,
}

/// A glass that could lend.
struct Candidate {
    glass: Glass,
    nd: f64,
    vd: f64,
    old: Option<bool>,
}

impl Medium {
    /// Returns the absorption of the medium, from its own data or from the nearest medium of the bundled catalogue that has data.
    /// `year` is the year of the lens, if known; it matters only for media of no catalogue.
    ///
    /// The nearest medium has the smallest hypot(dnd / 0.01, dVd / 1), where another maker adds 1 and another time adds 1. Glass
    /// that was listed by 1983, when flints contained lead, or belongs to a lens built by 1990, is of one time; all other glass
    /// is of another. Glasses borrow from optical and technical glasses, plastics from plastics. The lending medium passes at
    /// least 80 % from 420 to 700 nm through 3 mm.
    ///
    /// `None` means clear: for air, vacuum, media known by an index alone, and if no medium lies within a distance of 10.
    /// Crystals, liquids and filter glasses borrow no data either, because a neighbor in index tells nothing about their
    /// absorption.
    #[must_use]
    pub fn absorption(&self, year: Option<i32>) -> Option<Absorption> {
        let of_year = year.map(|year| year <= OLD_UNTIL);
        let borrower = match self {
            Medium::Air | Medium::Vacuum | Medium::Constant(_) => return None,
            Medium::Model(model) => borrower_of(model, of_year),
            Medium::Glass(glass) => {
                if let Some(own) = &glass.extinction {
                    return Some(Absorption { extinction: own.clone(), lender: None });
                }
                let own = old(glass).or_else(|| of_year.filter(|_| glass.category == Category::User));
                Borrower {
                    nd: glass.nd(),
                    vd: glass.vd(),
                    category: glass.category,
                    maker: Some(&*glass.maker),
                    old: own,
                }
            }
        };
        Catalog::bundled().lender(&borrower)
    }
}

fn borrower_of(model: &ModelGlass, old: Option<bool>) -> Borrower<'static> {
    let vd = LineTriple::FDC.abbe_number(|w| model.index(w));
    Borrower { nd: model.index(D.wavelength_nm), vd, category: Category::OpticalGlass, maker: None, old }
}

/// Returns whether a glass stands in the oldest list; `None` if it has no years.
fn old(glass: &Glass) -> Option<bool> {
    glass.years.map(|(first, _)| first <= OLD_LIST)
}

/// Returns whether a thin plate of the glass passes light.
fn is_clear(extinction: &Extinction) -> bool {
    const PLATE_NM: f64 = 3e6;
    let passed =
        |nm: f64| extinction.at(nm).map_or(1.0, |k| libm::exp(-4.0 * std::f64::consts::PI * k * PLATE_NM / nm));
    (0..=28).map(|i| 420.0 + 10.0 * f64::from(i)).all(|nm| passed(nm) >= LEAST_PASSED)
}

fn lends_to(lender: Category, borrower: Category) -> bool {
    use Category::{OpticalGlass, Plastic, TechnicalGlass, User};
    match borrower {
        OpticalGlass | TechnicalGlass | User => matches!(lender, OpticalGlass | TechnicalGlass),
        Plastic => lender == Plastic,
        _ => false,
    }
}

impl Catalog {
    fn lender(&self, borrower: &Borrower<'_>) -> Option<Absorption> {
        let distance = |candidate: &Candidate| {
            let (dn, dv) = ((candidate.nd - borrower.nd) / UNIT_ND, (candidate.vd - borrower.vd) / UNIT_VD);
            let near = (dn * dn + dv * dv).sqrt();
            if !(near <= FARTHEST) {
                return None;
            }
            let maker = borrower.maker.is_some_and(|maker| !maker.eq_ignore_ascii_case(&candidate.glass.maker));
            let time = borrower.old.zip(candidate.old).is_some_and(|(a, b)| a != b);
            Some(near + ANOTHER * (f64::from(u8::from(maker)) + f64::from(u8::from(time))))
        };
        let (best, at) = (self.substitutes())
            .iter()
            .filter(|candidate| lends_to(candidate.glass.category, borrower.category))
            .filter_map(|candidate| Some((distance(candidate)?, candidate)))
            .min_by(|a, b| a.0.total_cmp(&b.0))?;
        let lender = AbsorptionSubstitute {
            full_name: at.glass.full_name(),
            delta_nd: at.nd - borrower.nd,
            delta_vd: at.vd - borrower.vd,
            distance: best,
        };
        Some(Absorption { extinction: at.glass.extinction.clone()?, lender: Some(lender) })
    }

    /// Returns the glasses with absorption, by name; they are looked for once.
    fn substitutes(&self) -> &'static [Candidate] {
        static LENDERS: OnceLock<Vec<Candidate>> = OnceLock::new();
        LENDERS.get_or_init(|| {
            let catalogue = Catalog::bundled();
            let candidate = |place: RecordIndex| {
                let glass = catalogue.with_absorption(place)?;
                let seen = glass.extinction.as_ref()?.range_nm();
                let lends = lends_to(glass.category, glass.category)
                    && seen.0 <= 440.0
                    && seen.1 >= 640.0
                    && is_clear(glass.extinction.as_ref()?);
                lends.then(|| Candidate { nd: glass.nd(), vd: glass.vd(), old: old(&glass), glass })
            };
            catalogue.index.iter().filter_map(|(_, place)| candidate(*place)).collect()
        })
    }

    /// Returns the glass at a place, if its record has a column of absorption.
    fn with_absorption(&self, place: RecordIndex) -> Option<Glass> {
        match place {
            RecordIndex::Text(i) if !self.bundle.has_extinction(i as usize) => None,
            _ => Some(self.glass(place)),
        }
    }
}
