//! Film stocks: what a maker's sheet says, each value with its source; what is unknown is absent.

mod file;
mod sensitivity;

pub use sensitivity::{Reading, SensitivityError, SpectralSensitivity};

use crate::curve::CharacteristicCurve;
use spectra_core::params::{Faults, Params};
use spectra_core::resources::Resources;
use spectra_core::spectral::{Channel, Grid};
use spectra_spectrum::Emission;

/// Folder of the bundled stocks.
pub const FOLDER: &str = "spectra/film";

/// A film stock.
#[derive(Clone, Debug)]
pub struct Stock {
    /// Name that people know it by.
    pub name: String,
    /// Who makes it.
    pub maker: Option<String>,
    /// Where the values come from.
    pub source: String,
    /// Terms under which they came.
    pub licence: String,
    /// What else is worth knowing.
    pub remark: Option<String>,
    /// ISO speed in daylight (arithmetic).
    pub iso: f64,
    /// ISO speed in tungsten light, where the sheet prints one.
    pub iso_tungsten: Option<f64>,
    /// Name of the illuminant under which the unit of the curves' axis is photometric lux-seconds.
    pub reference_illuminant: String,
    /// That illuminant.
    pub reference: Emission,
    /// Layers, in the order in which light meets them.
    pub layers: Vec<Layer>,
    /// The bases that it is coated on.
    pub bases: Vec<Base>,
    /// How it fails to count long exposures in full; `None` where the sheet does not say.
    pub reciprocity: Option<Reciprocity>,
    /// Filter factors that the sheet prints.
    pub filter_factors: Vec<FilterFactor>,
}

/// One light-sensitive layer.
#[derive(Clone, Debug)]
pub struct Layer {
    /// Name; that of its channel too.
    pub name: String,
    /// Which light it sees.
    pub sensitivity: SpectralSensitivity,
    /// How its table came to be read as it is.
    pub remark: Option<String>,
    /// Its curves by development, the usual one first; at least one.
    pub developments: Vec<Development>,
}

/// A layer's curve after one kind of development.
#[derive(Clone, Debug, PartialEq)]
pub struct Development {
    /// Name, such as `pictorial`.
    pub name: String,
    /// Whether the curve is assumed since none is printed.
    pub assumed: bool,
    /// What it rests on.
    pub remark: Option<String>,
    /// The curve.
    pub curve: CharacteristicCurve,
}

/// What the emulsion is coated on.
#[derive(Clone, Debug, PartialEq)]
pub struct Base {
    /// The formats that come on it, as the sheet names them.
    pub formats: String,
    /// Material, such as `acetate`.
    pub material: Option<String>,
    /// Thickness, mm.
    pub thickness_mm: f64,
}

/// Reciprocity failure by a power law: to act like Tm, an exposure longer than the threshold takes Tm^exponent (s).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Reciprocity {
    /// Exponent, at least 1.
    pub exponent: f64,
    /// Threshold, s.
    pub above_s: f64,
}

/// How much longer to expose behind a filter.
#[derive(Clone, Debug, PartialEq)]
pub struct FilterFactor {
    /// The filter, as the sheet names it.
    pub filter: String,
    /// Factor in daylight.
    pub daylight: f64,
    /// Factor in tungsten light.
    pub tungsten: f64,
}

impl Stock {
    /// Reads the stock `name`: a YAML file beside the scene, or the name of a bundled one.
    ///
    /// # Errors
    /// All that is wrong with the file, placed there. Where there is no such file, one fault without a place: put it
    /// at the key that named it.
    pub fn load(name: &str, resources: &dyn Resources) -> Result<Self, Faults> {
        let params = resources.document(name, &[FOLDER], &[".yaml", ".yml"])?;
        Self::from_params(&params, resources)
    }

    /// Reads a stock that has been parsed as YAML; its tables come from `resources`.
    ///
    /// # Errors
    /// All that is wrong with it.
    pub fn from_params(params: &Params, resources: &dyn Resources) -> Result<Self, Faults> {
        file::read(params, resources)
    }

    /// Names of the bundled stocks, sorted.
    pub fn bundled() -> impl Iterator<Item = &'static str> {
        let stem = |path: &'static str| path.strip_prefix(FOLDER)?.strip_prefix('/')?.strip_suffix(".yaml");
        spectra_data::list(FOLDER).filter_map(stem)
    }

    /// The channels that record the exposure of its layers on `grid`, in lx s.
    ///
    /// # Errors
    /// [`SensitivityError::Blind`]; a stock that was read from a file has none such.
    pub fn channels(&self, grid: &Grid) -> Result<Vec<Channel>, SensitivityError> {
        self.layers.iter().map(|l| l.sensitivity.channel(&l.name, &self.reference, grid)).collect()
    }
}

impl Layer {
    /// The development called `name`.
    #[must_use]
    pub fn development(&self, name: &str) -> Option<&Development> {
        self.developments.iter().find(|d| d.name == name)
    }
}
