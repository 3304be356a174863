//! Film stocks: what a maker's sheet says, each value with its source; what is unknown is absent.

mod color;
mod file;
mod like;
mod material;
mod reciprocity;
mod sensitivity;
mod speed;
mod structure;

pub use color::{AimDensity, Interlayer, Medium};
pub use material::{Densitometry, Dye, MinimumDensity, SpectralDensity};
pub use reciprocity::{Reciprocity, unknown as unknown_reciprocity};
pub use sensitivity::{Reading, SensitivityError, SpectralSensitivity};
pub use speed::{ISO_6_SPAN, Iso6, MeterResponse, SpeedKind};
pub use structure::{Assumptions, Backing, Base, Granularity, Halation};

use crate::curve::CharacteristicCurve;
use schemars::{Schema, SchemaGenerator};
use spectra_core::params::{Faults, Params};
use spectra_core::resources::Resources;
use spectra_core::spectral::{Channel, Grid};
use spectra_spectrum::Emission;

/// Folder of the bundled stocks.
pub const FOLDER: &str = "spectra/film";

/// What becomes of light and shade on a stock.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Process {
    /// A camera negative: the more light, the denser; to be printed or scanned.
    Negative,
    /// A camera film developed to a positive: the more light, the clearer; to be projected.
    Reversal,
    /// What negatives are printed on.
    Print,
}

/// A film stock.
#[derive(Clone, Debug, PartialEq)]
pub struct Stock {
    /// Name that people know it by.
    pub name: String,
    /// Who makes it.
    pub maker: Option<String>,
    /// Where the values come from.
    pub source: String,
    /// Terms under which they came.
    pub license: String,
    /// What else is worth knowing.
    pub remark: Option<String>,
    /// What it is for.
    pub process: Process,
    /// What a print stock is coated on.
    pub medium: Medium,
    /// How the densities of its curves were measured.
    pub densitometry: Densitometry,
    /// Year in which it was first sold, where known.
    pub year: Option<i32>,
    /// Speed in daylight (arithmetic), what meters are set to; `None` for a print stock alone.
    pub iso: Option<f64>,
    /// What that speed is.
    pub speed_kind: SpeedKind,
    /// By how much the curves of a file with relative exposures were slid to that speed, log10 of exposure; `None` of any other.
    pub slid: Option<f64>,
    /// What a meter for it weighs light by.
    pub meter: MeterResponse,
    /// The same in tungsten light, where the sheet prints one.
    pub iso_tungsten: Option<f64>,
    /// Name of the illuminant under which the unit of the curves' axis is photometric lux-seconds.
    pub reference_illuminant: String,
    /// That illuminant.
    pub reference: Emission,
    /// Layers, in the order in which light meets them.
    pub layers: Vec<Layer>,
    /// The bases that it is coated on.
    pub bases: Vec<Base>,
    /// What is left where nothing was exposed, over wavelengths; `None` where the curves alone tell it.
    pub minimum_density: Option<MinimumDensity>,
    /// What its layers do to each other; `None` where nothing is known of it.
    pub interlayer: Option<Interlayer>,
    /// Of a print stock of three dyes, what the print of a mid gray is timed to; `None` where its maker states none.
    pub aim_density: Option<AimDensity>,
    /// What was chosen rather than measured in all of its layers.
    pub assumed: Assumptions,
    /// How grainy its silver is; `None` where the sheet does not say, and of films with dyes.
    pub granularity: Option<Granularity>,
    /// What its back sends back; `None` where nothing is known of it.
    pub halation: Option<Halation>,
    /// The stock that its maker wants its negatives printed on.
    pub print: Option<String>,
    /// How it fails to count long exposures in full; `None` where the sheet does not say.
    pub reciprocity: Option<Reciprocity>,
    /// Filter factors that the sheet prints.
    pub filter_factors: Vec<FilterFactor>,
}

/// One light-sensitive layer.
#[derive(Clone, Debug, PartialEq)]
pub struct Layer {
    /// Name; that of its channel too.
    pub name: String,
    /// Which light it sees.
    pub sensitivity: SpectralSensitivity,
    /// Whether its sensitivity is assumed; the remark says on what grounds.
    pub assumed: bool,
    /// How its table came to be read as it is.
    pub remark: Option<String>,
    /// The dye that forms in it; `None` for silver.
    pub dye: Option<Dye>,
    /// Modulation transfer: (spatial frequency in cycles/mm, response), frequencies increasing; empty where the sheet does
    /// not say. Developing makes edges stand out, so it may exceed 1.
    pub mtf: Vec<[f64; 2]>,
    /// Of a layer with a dye: density over the minimum, read through the filter of its dye on neutral film, increasing, and 1000
    /// times the deviation through 48 um; empty where the sheet does not say.
    pub granularity: Vec<[f64; 2]>,
    /// Its curves by development, the usual one first; at least one.
    pub developments: Vec<Development>,
}

/// A layer's curve after one kind of development.
#[derive(Clone, Debug, PartialEq)]
pub struct Development {
    /// Name, such as `pictorial`.
    pub name: String,
    /// How long it takes, min; `None` where the sheet does not say.
    pub minutes: Option<f64>,
    /// Whether the curve is assumed since none is printed.
    pub assumed: bool,
    /// What it rests on.
    pub remark: Option<String>,
    /// The curve.
    pub curve: CharacteristicCurve,
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
    /// The spectral products through which a densitometer reads each layer ([`Densitometry::products`]); `None` where it reads silver.
    #[must_use]
    pub fn filters(&self) -> Option<Vec<Vec<f64>>> {
        let names: Vec<&str> = self.layers.iter().map(|layer| layer.name.as_str()).collect();
        self.densitometry.products(&names)
    }

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

    /// The schema of a stock file, for editors.
    #[must_use]
    pub fn schema(generator: &mut SchemaGenerator) -> Schema {
        file::schema(generator)
    }

    /// Names of the bundled stocks, sorted.
    pub fn bundled() -> impl Iterator<Item = &'static str> {
        let stem = |path: &'static str| path.strip_prefix(FOLDER)?.strip_prefix('/')?.strip_suffix(".yaml");
        spectra_data::list(FOLDER).filter_map(stem)
    }

    /// Names of its developments, the usual one first.
    pub fn developments(&self) -> impl Iterator<Item = &str> {
        self.layers.first().into_iter().flat_map(|layer| layer.developments.iter().map(|d| d.name.as_str()))
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
