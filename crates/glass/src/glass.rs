//! A named medium with its data.

use std::sync::Arc;

use crate::air::{self, AirConditions};
use crate::formula::{Formula, Melt, Table};
use crate::lines::{D, LineTriple};

/// The category of a medium.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Category {
    /// Optical glass from a maker's catalogue.
    OpticalGlass,
    /// Window, display and laboratory glass, fused silica, glass ceramics.
    TechnicalGlass,
    /// Chalcogenide and other infrared glass.
    InfraredGlass,
    /// Colored or absorbing glass, as for filters.
    FilterGlass,
    /// Crystal for optical use.
    Crystal,
    /// Polymer, such as PMMA.
    Plastic,
    /// Organic liquid or solid.
    Organic,
    /// Element or simple compound: crystals, metals, water, gases.
    Inorganic,
    /// Mixture, alloy, tissue or air.
    Mixed,
    /// Glass of a user's catalogue file.
    User,
}

impl Category {
    /// Name of the category in the catalogue file and in reports.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Category::OpticalGlass => "optical glass",
            Category::TechnicalGlass => "technical glass",
            Category::InfraredGlass => "infrared glass",
            Category::FilterGlass => "filter glass",
            Category::Crystal => "crystal",
            Category::Plastic => "plastic",
            Category::Organic => "organic",
            Category::Inorganic => "inorganic",
            Category::Mixed => "mixed",
            Category::User => "user",
        }
    }

    /// Returns whether media of this category are named by glass types, not by substances and measurements.
    #[must_use]
    pub fn is_glass(self) -> bool {
        use Category::*;
        matches!(self, OpticalGlass | TechnicalGlass | InfraredGlass | FilterGlass | User)
    }

    /// Finds the category of this name.
    #[must_use]
    pub fn by_name(name: &str) -> Option<Category> {
        use Category::*;
        [OpticalGlass, TechnicalGlass, InfraredGlass, FilterGlass, Crystal, Plastic, Organic, Inorganic, Mixed, User]
            .into_iter()
            .find(|c| c.name() == name)
    }
}

/// The availability of a glass.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Status {
    /// The maker recommends it for new designs.
    Preferred,
    /// In regular production.
    Standard,
    /// Made on request.
    Special,
    /// No longer made, or in historical catalogues only.
    Obsolete,
    /// Known from a melt sheet.
    Melt,
    /// The source does not say.
    Unknown,
}

impl Status {
    /// Name of the status in reports.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Status::Preferred => "preferred",
            Status::Standard => "standard",
            Status::Special => "special",
            Status::Obsolete => "obsolete",
            Status::Melt => "melt",
            Status::Unknown => "unknown",
        }
    }
}

/// Schott's equation for the change of the absolute index n with temperature (Schott TIE-19). It is
/// dn = (n^2 - 1) / (2 n) (D0 t + D1 t^2 + D2 t^3 + (E0 t + E1 t^2) / (L^2 - L_tk^2)). Here t is the temperature difference from the reference temperature,
/// and L the wavelength.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Thermal {
    /// Coefficients D0 (1/K), D1 (1/K^2) and D2 (1/K^3).
    pub d: [f64; 3],
    /// Coefficients E0 (um^2/K) and E1 (um^2/K^2).
    pub e: [f64; 2],
    /// Wavelength L_tk of the resonance, um.
    pub lambda_tk_um: f64,
}

/// The extinction coefficient k of the complex index n - i k.
#[derive(Clone, Debug, PartialEq)]
pub struct Extinction {
    wavelength_nm: Arc<[f64]>,
    k: Box<[f64]>,
}

impl Extinction {
    /// Creates the table from wavelengths (nm) and the extinction coefficients at them. `None` unless both have the same length,
    /// the wavelengths are positive and ascending, and no coefficient is negative.
    #[must_use]
    pub fn new(wavelength_nm: Arc<[f64]>, k: Vec<f64>) -> Option<Extinction> {
        let rising =
            wavelength_nm.windows(2).all(|w| w[0] < w[1]) && wavelength_nm.iter().all(|w| w.is_finite() && *w > 0.0);
        let usable = k.iter().all(|k| k.is_finite() && *k >= 0.0);
        (wavelength_nm.len() == k.len() && !k.is_empty() && rising && usable)
            .then(|| Extinction { wavelength_nm, k: k.into() })
    }

    /// Returns the extinction coefficient k at `wavelength_nm`, interpolated between the points of the table: ln k linearly if k
    /// is positive at both, otherwise k linearly. `None` outside the table.
    #[must_use]
    pub fn at(&self, wavelength_nm: f64) -> Option<f64> {
        let (min, max) = self.range_nm();
        if !(wavelength_nm >= min && wavelength_nm <= max) {
            return None;
        }
        let i = self.wavelength_nm.partition_point(|&w| w <= wavelength_nm).clamp(1, self.k.len()) - 1;
        let Some(&next) = self.wavelength_nm.get(i + 1) else {
            return Some(self.k[i]);
        };
        let t = (wavelength_nm - self.wavelength_nm[i]) / (next - self.wavelength_nm[i]);
        let (a, b) = (self.k[i], self.k[i + 1]);
        Some(if a > 0.0 && b > 0.0 { a * libm::pow(b / a, t) } else { a + (b - a) * t })
    }

    /// First and last wavelength of the table, nm.
    #[must_use]
    pub fn range_nm(&self) -> (f64, f64) {
        (self.wavelength_nm[0], self.wavelength_nm[self.wavelength_nm.len() - 1])
    }

    /// Iterates over the points of the table: wavelength (nm) and k.
    pub fn points(&self) -> impl Iterator<Item = (f64, f64)> + '_ {
        self.wavelength_nm.iter().copied().zip(self.k.iter().copied())
    }
}

/// A medium of a catalogue.
#[derive(Clone, Debug, PartialEq)]
pub struct Glass {
    /// Maker's short name (`SCHOTT`), or the substance of research data (`H2O`).
    pub maker: Arc<str>,
    /// Name within the maker's catalogue (`N-BK7`), or name of the measurement (`Daimon-20.0C`).
    pub name: String,
    /// Category of the medium.
    pub category: Category,
    /// Dispersion formula n(lambda), relative to air for glasses.
    pub formula: Formula,
    /// Shortest and longest wavelength of the data, nm.
    pub range_nm: (f64, f64),
    /// Index at the d line as the maker lists it.
    pub listed_nd: Option<f64>,
    /// Abbe number (d, F, C) as the maker lists it.
    pub listed_vd: Option<f64>,
    /// Availability of the glass.
    pub status: Status,
    /// Years of the first and last catalogue in which the glass was found.
    pub years: Option<(u16, u16)>,
    /// Temperature of the data, degrees Celsius.
    pub temperature_c: Option<f64>,
    /// Change of the index with temperature; `None` if it is not known.
    pub thermal: Option<Thermal>,
    /// Extinction coefficient by wavelength; `None` if it is not known.
    pub extinction: Option<Extinction>,
    /// Source of the data.
    pub source: Arc<str>,
}

impl Glass {
    /// Creates a glass with a maker, a name, a category, a formula and the range of its data (nm); all else is unknown.
    #[must_use]
    pub fn new(maker: &str, name: &str, category: Category, formula: Formula, range_nm: (f64, f64)) -> Glass {
        Glass {
            maker: maker.into(),
            name: name.to_owned(),
            category,
            formula,
            range_nm,
            listed_nd: None,
            listed_vd: None,
            status: Status::Unknown,
            years: None,
            temperature_c: None,
            thermal: None,
            extinction: None,
            source: "".into(),
        }
    }

    /// Returns the full name `MAKER/NAME`, as [`crate::Catalog::find`] reads it.
    #[must_use]
    pub fn full_name(&self) -> String {
        format!("{}/{}", self.maker, self.name)
    }

    /// Refractive index at a wavelength in nm, relative to air. It is extrapolated outside of [`Glass::range_nm`].
    #[must_use]
    pub fn index(&self, wavelength_nm: f64) -> f64 {
        self.formula.index(wavelength_nm)
    }

    /// Index at the d line, computed from the formula.
    #[must_use]
    pub fn nd(&self) -> f64 {
        self.index(D.wavelength_nm)
    }

    /// Abbe number at the lines d, F and C, computed from the formula.
    #[must_use]
    pub fn vd(&self) -> f64 {
        self.abbe_number(LineTriple::FDC)
    }

    /// Abbe number for any lines, computed from the formula.
    #[must_use]
    pub fn abbe_number(&self, lines: LineTriple) -> f64 {
        lines.abbe_number(|w| self.index(w))
    }

    /// Returns this glass with the nd and Vd measured on a melt: its dispersion is shifted and scaled to fit them. `None` unless
    /// nd > 1, Vd > 0 and the glass has dispersion.
    #[must_use]
    pub fn melt(&self, nd: f64, vd: f64) -> Option<Glass> {
        let formula = Formula::Melt(Melt::new(self.formula.clone(), nd, vd)?.into());
        Some(Glass { formula, listed_nd: Some(nd), listed_vd: Some(vd), status: Status::Melt, ..self.clone() })
    }

    /// Returns whether the data reach from `min_nm` to `max_nm`.
    #[must_use]
    pub fn covers(&self, min_nm: f64, max_nm: f64) -> bool {
        self.range_nm.0 <= min_nm && max_nm <= self.range_nm.1
    }

    /// Internal transmittance (without reflections) of a path of `thickness_mm`: exp(-4 pi k d / lambda); `None` if k is not known.
    #[must_use]
    pub fn internal_transmittance(&self, wavelength_nm: f64, thickness_mm: f64) -> Option<f64> {
        let k = self.extinction.as_ref()?.at(wavelength_nm)?;
        Some(libm::exp(-4.0 * std::f64::consts::PI * k * thickness_mm * 1e6 / wavelength_nm))
    }

    /// Absolute index (relative to vacuum) at a wavelength in nm (in air), at 101 325 Pa. `temperature_c` is the temperature of
    /// the glass and of the air, degrees Celsius. If the glass has no thermal data, its index is that at the reference
    /// temperature.
    #[must_use]
    pub fn absolute_index(&self, wavelength_nm: f64, temperature_c: f64) -> f64 {
        let relative = self.index(wavelength_nm);
        let reference = self.temperature_c.unwrap_or(air::CATALOGUE_AIR.temperature_c);
        let air_at = |t| AirConditions { temperature_c: t, ..air::CATALOGUE_AIR };
        let change = self.thermal.map_or(0.0, |thermal| {
            let t = temperature_c - reference;
            let um2 = wavelength_nm * wavelength_nm * 1e-6;
            let resonance = um2 - thermal.lambda_tk_um * thermal.lambda_tk_um;
            let [d0, d1, d2] = thermal.d;
            let [e0, e1] = thermal.e;
            (relative * relative - 1.0) / (2.0 * relative) * t * (d0 + t * (d1 + t * d2) + (e0 + t * e1) / resonance)
        });
        air::absolute(relative, wavelength_nm, air_at(reference)) + change
    }

    /// Index relative to air of the same temperature as the glass (degrees Celsius), at 101 325 Pa.
    #[must_use]
    pub fn index_at(&self, wavelength_nm: f64, temperature_c: f64) -> f64 {
        let air = AirConditions { temperature_c, ..air::CATALOGUE_AIR };
        self.absolute_index(wavelength_nm, temperature_c) / air::index(wavelength_nm, air)
    }

    /// Returns the maker's table of points; `None` if the data are not a table.
    #[must_use]
    pub fn table(&self) -> Option<&Table> {
        match &self.formula {
            Formula::Table(table) => Some(table),
            _ => None,
        }
    }
}
