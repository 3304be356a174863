//! Film stocks: the data of a maker's sheet, each value with its source. Unknown values are absent.

mod base_stock;
mod color;
mod file;
mod layer_file;
mod material;
mod reciprocity;
mod sensitivity;
mod sensitivity_file;
mod speed;
mod structure;

pub use color::{AimDensity, Interlayer, Medium};
pub use material::{Densitometry, Dye, MinimumDensity, SpectralDensity};
pub use reciprocity::{Reciprocity, unknown as unknown_reciprocity};
pub use sensitivity::{SensitivityError, SensitivityScale, SpectralSensitivity};
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

/// Kind of process for which a stock is made.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Process {
    /// A camera negative: more light gives more density; to be printed or scanned.
    Negative,
    /// A camera film developed to a positive: more light gives less density; to be projected.
    Reversal,
    /// A print stock, onto which negatives are printed.
    Print,
}

/// A film stock with all known data.
#[derive(Clone, Debug, PartialEq)]
pub struct Stock {
    /// Name for people.
    pub name: String,
    /// Maker of the stock.
    pub maker: Option<String>,
    /// Source of the values.
    pub source: String,
    /// License of the values.
    pub license: String,
    /// Remarks for people.
    pub remark: Option<String>,
    /// Process for which the stock is made.
    pub process: Process,
    /// Base of a print stock: film or paper.
    pub medium: Medium,
    /// Kind of densitometry with which its curves were measured.
    pub densitometry: Densitometry,
    /// Year in which it was first sold, if known.
    pub year: Option<i32>,
    /// Speed in daylight (arithmetic), to which meters are set; `None` only for a print stock.
    pub iso: Option<f64>,
    /// Kind of the stated speed.
    pub speed_kind: SpeedKind,
    /// Shift along log10 of exposure that was applied to the curves so that they give the stated speed. `None` unless the file
    /// has relative exposures.
    pub slid: Option<f64>,
    /// Spectral response of a meter for this stock.
    pub meter: MeterResponse,
    /// Speed in tungsten light, if the sheet states one.
    pub iso_tungsten: Option<f64>,
    /// Name of the illuminant under which the exposure axis of the curves is in photometric lux-seconds.
    pub reference_illuminant: String,
    /// Spectrum of the reference illuminant.
    pub reference: Emission,
    /// Layers, in the order in which light meets them.
    pub layers: Vec<Layer>,
    /// Bases on which the film is coated.
    pub bases: Vec<Base>,
    /// Spectral density of unexposed film; `None` if only the curves include it.
    pub minimum_density: Option<MinimumDensity>,
    /// Interaction of the layers in development; `None` if unknown.
    pub interlayer: Option<Interlayer>,
    /// Aim densities of a print of mid gray, for a print stock of three dyes; `None` if its maker states none.
    pub aim_density: Option<AimDensity>,
    /// Values that are assumed, not measured, for all layers.
    pub assumed: Assumptions,
    /// Granularity of silver; `None` if the sheet states none, and for films with dyes.
    pub granularity: Option<Granularity>,
    /// Halation; `None` if unknown.
    pub halation: Option<Halation>,
    /// Print stock that the maker intends for its negatives.
    pub print: Option<String>,
    /// Reciprocity failure at long exposures; `None` if the sheet states none.
    pub reciprocity: Option<Reciprocity>,
    /// Filter factors of the sheet.
    pub filter_factors: Vec<FilterFactor>,
}

/// One light-sensitive layer of a film.
#[derive(Clone, Debug, PartialEq)]
pub struct Layer {
    /// Name of the layer and of its channel.
    pub name: String,
    /// Spectral sensitivity of the layer.
    pub sensitivity: SpectralSensitivity,
    /// Whether its sensitivity is assumed; the remark gives the reasons.
    pub assumed: bool,
    /// Remark on how the sensitivity table was read.
    pub remark: Option<String>,
    /// Dye that forms in the layer; `None` for silver.
    pub dye: Option<Dye>,
    /// Measured modulation transfer: (spatial frequency in cycles/mm, response), frequencies increasing. Empty if the sheet
    /// states none. The response may exceed 1, because development enhances edges.
    pub mtf: Vec<[f64; 2]>,
    /// Granularity of a layer with a dye: pairs of density above the minimum (ascending) and 1000 times the standard deviation
    /// through 48 um. Both are measured on neutral film through the filter of the layer's dye. Empty if the sheet states none.
    pub granularity: Vec<[f64; 2]>,
    /// Curves by development, the default one first; at least one.
    pub developments: Vec<Development>,
}

/// A layer's curve after one kind of development.
#[derive(Clone, Debug, PartialEq)]
pub struct Development {
    /// Name of the development, for example `pictorial`.
    pub name: String,
    /// Development time, min; `None` if the sheet states none.
    pub minutes: Option<f64>,
    /// Whether the curve is assumed because none is printed.
    pub assumed: bool,
    /// Reasons for an assumed curve, and other remarks.
    pub remark: Option<String>,
    /// Characteristic curve.
    pub curve: CharacteristicCurve,
}

/// Exposure factor of a filter.
#[derive(Clone, Debug, PartialEq, serde::Serialize)]
pub struct FilterFactor {
    /// The filter, as the sheet names it.
    pub filter: String,
    /// Factor in daylight.
    pub daylight: f64,
    /// Factor in tungsten light.
    pub tungsten: f64,
}

impl Stock {
    /// Returns the spectral products through which a densitometer reads each layer ([`Densitometry::products`]); `None` for silver.
    #[must_use]
    pub fn filters(&self) -> Option<Vec<Vec<f64>>> {
        let names: Vec<&str> = self.layers.iter().map(|layer| layer.name.as_str()).collect();
        self.densitometry.products(&names)
    }

    /// Reads the stock `name`: a YAML file next to the scene, or the name of a bundled one.
    ///
    /// # Errors
    /// All faults of the file, with their places. If there is no such file, one fault without a place, which the caller puts at the key
    /// that named it.
    pub fn load(name: &str, resources: &dyn Resources) -> Result<Self, Faults> {
        let params = resources.document(name, &[FOLDER], &[".yaml", ".yml"])?;
        Self::from_params(&params, resources)
    }

    /// Reads a stock that has been parsed as YAML; its tables come from `resources`.
    ///
    /// # Errors
    /// All faults of the file, with their places.
    pub fn from_params(params: &Params, resources: &dyn Resources) -> Result<Self, Faults> {
        file::read(params, resources)
    }

    /// Returns the schema of a stock file, for editors.
    #[must_use]
    pub fn schema(generator: &mut SchemaGenerator) -> Schema {
        file::schema(generator)
    }

    /// Names of the bundled stocks, sorted.
    pub fn bundled() -> impl Iterator<Item = &'static str> {
        let stem = |path: &'static str| path.strip_prefix(FOLDER)?.strip_prefix('/')?.strip_suffix(".yaml");
        spectra_data::list(FOLDER).filter_map(stem)
    }

    /// Names of the stock's developments, the default one first.
    pub fn developments(&self) -> impl Iterator<Item = &str> {
        self.layers.first().into_iter().flat_map(|layer| layer.developments.iter().map(|d| d.name.as_str()))
    }

    /// Builds the channels that record the exposure of the layers on `grid`, in lx s.
    ///
    /// # Errors
    /// [`SensitivityError::Blind`]. It cannot occur for a stock that was read from a file.
    pub fn channels(&self, grid: &Grid) -> Result<Vec<Channel>, SensitivityError> {
        self.layers.iter().map(|l| l.sensitivity.channel(&l.name, &self.reference, grid)).collect()
    }
}

impl Layer {
    /// Returns the development with this name.
    #[must_use]
    pub fn development(&self, name: &str) -> Option<&Development> {
        self.developments.iter().find(|d| d.name == name)
    }
}
