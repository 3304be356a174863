//! A stock's YAML file: its keys, and the checks that go beyond types.

use super::base_stock::inherited;
use super::color::{AimDensityFile, InterlayerFile, Medium};
use super::layer_file::{LayerFile, layers, unlike_developments};
use super::material::{DensityFile, MinimumDensityFile, densitometry};
use super::reciprocity::ReciprocityFile;
use super::sensitivity_file::light;
use super::speed::{ExposureFile, MeterResponse, SpeedKind};
use super::structure::{Assumptions, AssumptionsFile, BaseFile, GranularityFile, HalationFile};
use super::{FilterFactor, Granularity, Interlayer, MinimumDensity, Process, Stock};
use schemars::{JsonSchema, Schema, SchemaGenerator};
use serde::Deserialize;
use serde_json::{Value, json};
use spectra_core::params::{Fault, Faults, Params, Positive, Whole};
use spectra_core::resources::Resources;
use spectra_spectrum::{Emission, SpectrumError};

/// A film stock: its layers, their sensitivity and development, and the source of the figures.
///
/// Leave out what is not known: a stock without grain, halation or modulation transfer in its file has none in the picture. A figure that
/// was chosen rather than measured needs `assumed: true` and a `remark` that gives the reasons.
/// Exposures are photometric lux-seconds of the `reference-illuminant`, densities are decadic.
///
/// A black-and-white film has one layer, whose curve includes base and fog. A color film has a layer for each dye, starting with the one
/// that is sensitive to blue light, each with its `dye`.
/// The curves of a color film are integral densities, and `minimum-density` is the spectrum of base, fog and mask. Layers are developed
/// together: each has a curve for each development.
///
/// # Example
/// ```yaml
/// spectra: 1
/// name: Old orthochromatic film
/// source: sheet of the maker, 1950
/// license: facts
/// iso: 80
/// reference-illuminant: iso-7589-sensitometric-daylight
/// layers:
///   - name: ortho
///     sensitivity:
///       reading: linear
///       measured-under: equal-energy
///       table: [[360, 0.5], [400, 0.9], [450, 1], [500, 0.6], [550, 0.8], [580, 0.2], [600, 0]]
///     curves:
///       - development: normal
///         points: [[-3, 0.2], [-2.2, 0.24], [-1.6, 0.5], [-0.6, 1.2], [0.4, 1.8], [1, 1.95]]
/// granularity: {rms: 11}
/// bases:
///   - {formats: "135", material: triacetate, thickness: 0.125 mm, index: 1.48}
/// ```
/// # References
/// - ISO 6:1993: the exposure 0.8/S lx s gives the density 0.1 above base and fog.
/// - ISO 7589: the illuminants by which sensitivities are scaled.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
struct StockFile {
    /// Format version of the file: 1; 1 if absent.
    #[expect(dead_code, reason = "its schema allows one version")]
    spectra: Option<Whole<1, 1>>,
    /// Name for people.
    name: String,
    /// Maker of the film; not known if absent.
    maker: Option<String>,
    /// Source of the figures: sheet, edition, who digitized it.
    source: String,
    /// License of the figures; required.
    license: Option<String>,
    /// Older spelling of `license`.
    licence: Option<String>,
    /// Remarks for people, for example doubts and choices.
    remark: Option<String>,
    /// Kind of stock: `negative` (the default), `reversal` (a positive, to be projected) or `print` (a positive made from a negative, which
    /// has no speed).
    #[serde(default)]
    process: ProcessFile,
    /// Base of a print stock: `film` (the default; projected in the dark) or `paper` (viewed in a lit room).
    #[serde(default)]
    medium: Medium,
    /// Kind of densitometry: `visual` (the default; silver), `status-a` (positives with dyes) or `status-m` (negatives with dyes).
    #[serde(default)]
    density: DensityFile,
    /// Year in which it was first sold; not known if absent.
    year: Option<i32>,
    /// Speed in daylight, to which meters are set. Required unless `process: print`.
    iso: Option<Positive<f64>>,
    /// Speed in tungsten light; for the record. Not known if absent.
    iso_tungsten: Option<Positive<f64>>,
    /// Kind of the stated speeds: `iso` (the default; by a standard), `exposure-index` (the maker's recommendation for the meter) or
    /// `assumed`.
    #[serde(default)]
    speed: SpeedKind,
    /// Zero of the exposures in the curves' `points`: `lux-seconds` (the default) or `relative`, for sheets that print a relative log
    /// exposure.
    /// Relative curves are shifted together until the first development has the speed `iso`: by ISO 6 for a silver negative, ISO 5800 for a
    /// color negative, ISO 2240 for a reversal film.
    #[serde(default)]
    exposure: ExposureFile,
    /// Spectral response of its meter: `photopic` (the default; the eye's) or `film` (the film's own sensitivity, like the actinometers for
    /// plates). A film of several layers must use `photopic`.
    #[serde(default)]
    meter: MeterResponse,
    /// Name of the light whose exposure is counted in photometric lux-seconds: mostly `iso-7589-sensitometric-daylight`.
    reference_illuminant: String,
    /// Name of the print stock on which it is printed if a scene names none; paper, or none, if absent.
    print: Option<String>,
    /// Spectrum of base, fog and mask of a film with dyes; nothing if absent.
    minimum_density: Option<MinimumDensityFile>,
    /// Interaction between the layers of a color film; nothing if absent.
    interlayer: Option<InterlayerFile>,
    /// Densities to which the print of a mid gray is timed on a color print stock, including the base (the laboratory aim density, LAD, of
    /// Kodak's print films). A mid gray of the picture if absent.
    aim_density: Option<AimDensityFile>,
    /// Figures that were chosen rather than measured for all layers, each with its reasons; nothing if absent.
    assumed: Option<AssumptionsFile>,
    /// Granularity of its silver; no grain if absent.
    granularity: Option<GranularityFile>,
    /// Light that the base reflects back, a halo around bright lights; nothing if absent.
    halation: Option<HalationFile>,
    /// Layers, one or more; each is a channel of the exposure.
    layers: Vec<LayerFile>,
    /// Bases on which it is coated, by format; the first is used for halation. Not known if absent.
    #[serde(default)]
    bases: Vec<BaseFile>,
    /// Loss of speed at long exposures; nothing if absent.
    reciprocity: Option<ReciprocityFile>,
    /// Factors by which filters lengthen the exposure, as the maker states them; for the record. Not known if absent.
    #[serde(default)]
    filter_factors: Vec<FilterFactorFile>,
}

#[derive(Clone, Copy, Debug, Default, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
enum ProcessFile {
    /// A negative, to be printed or scanned.
    #[default]
    Negative,
    /// A reversal film: a positive, to be projected.
    Reversal,
    /// A print stock: a positive made from a negative.
    Print,
}

#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
struct FilterFactorFile {
    /// Name of the filter.
    filter: String,
    /// Exposure factor in daylight.
    daylight: Positive<f64>,
    /// Exposure factor in tungsten light.
    tungsten: Positive<f64>,
}

/// Returns the schema of a stock file.
pub(super) fn schema(generator: &mut SchemaGenerator) -> Schema {
    let mut whole = StockFile::json_schema(generator);
    if let Some(Value::Object(keys)) = whole.get_mut("properties") {
        let text = "Base stock, bundled or a file next to this one: its keys, except `maker` and `year`, apply where this file has none.";
        keys.insert("like".to_owned(), json!({ "type": "string", "description": text }));
    }
    // A stock that is based on another one may leave out required keys.
    let required = whole.remove("required").unwrap_or_else(|| json!([]));
    whole.insert("if".to_owned(), json!({ "required": ["like"] }));
    whole.insert("then".to_owned(), json!({ "required": ["like", "name"] }));
    whole.insert("else".to_owned(), json!({ "required": required }));
    whole
}

impl StockFile {
    fn process(&self) -> Process {
        match self.process {
            ProcessFile::Negative => Process::Negative,
            ProcessFile::Reversal => Process::Reversal,
            ProcessFile::Print => Process::Print,
        }
    }

    /// Number of layers with a dye.
    fn dyes(&self) -> usize {
        self.layers.iter().filter(|l| l.dye.is_some()).count()
    }

    /// Returns the faults of keys that do not suit the kind of stock.
    fn kind_faults(&self, params: &Params) -> Faults {
        let mut faults = Faults::new();
        if self.layers.is_empty() {
            let fault = params.fault("layers", "a film has at least one layer");
            faults.push(fault.hint("each with `name`, `sensitivity` and `curves`; the bundled stocks are examples"));
        }
        let process = self.process();
        if self.iso.is_none() && process != Process::Print {
            let fault = params.fault("iso", "a camera film needs a speed");
            faults.push(fault.hint("write `iso: 100`; only a `process: print` has no speed"));
        }
        if self.meter == MeterResponse::Film && self.layers.len() > 1 {
            let fault = params.fault("meter", "a meter with the film's own sensitivity needs a film with one layer");
            faults.push(fault.hint("write `meter: photopic`, or leave `meter` out"));
        }
        if self.medium == Medium::Paper && process != Process::Print {
            let fault = params.fault("medium", "only a print stock can be on paper");
            faults.push(fault.hint("`process: print`, or leave `medium` out"));
        }
        faults
    }

    /// Returns the faults of layers with and without dyes side by side.
    fn dye_faults(&self, params: &Params) -> Faults {
        let mut faults = Faults::new();
        let dyes = self.dyes();
        if dyes != 0 && dyes != self.layers.len() {
            let fault = params.fault("layers", "some layers have a dye and some have none");
            faults.push(fault.hint("a `dye` in each, or none for silver"));
        }
        if dyes == 0 && self.layers.len() > 1 {
            faults.push(params.fault("layers", "a film of several layers needs a `dye` in each"));
        }
        faults
    }

    fn minimum_density(&self, params: &Params, faults: &mut Faults) -> Option<MinimumDensity> {
        let minimum_density = self.minimum_density.as_ref().and_then(|m| faults.take(m.read(params)));
        if self.minimum_density.is_some() && self.dyes() == 0 {
            let fault = params.fault("minimum-density", "curves of silver already include base and fog");
            faults.push(fault.hint("leave `minimum-density` out"));
        }
        minimum_density
    }

    fn interlayer(&self, params: &Params, faults: &mut Faults) -> Option<Interlayer> {
        if self.interlayer.is_some() && self.dyes() == 0 {
            let fault = params.fault("interlayer", "a film of one silver layer has no other layer to act on");
            faults.push(fault.hint("leave `interlayer` out"));
        }
        let interlayer = self.interlayer.as_ref().filter(|_| self.dyes() != 0);
        interlayer.and_then(|i| faults.take(i.read(params, self.layers.len())))
    }

    fn granularity(&self, params: &Params, faults: &mut Faults) -> Option<Granularity> {
        let granularity = self.granularity.as_ref().and_then(|g| faults.take(g.read(params)));
        if self.granularity.is_some() && self.dyes() != 0 {
            let fault = params.fault("granularity", "a film with dyes needs a granularity in each layer");
            faults.push(fault.hint("`granularity: [[density over the minimum, RMS], ...]` of each layer"));
        }
        granularity
    }
}

/// Reads and checks the whole file, and reports all faults together.
pub(super) fn read(params: &Params, resources: &dyn Resources) -> Result<Stock, Faults> {
    let params = &inherited(params, resources)?;
    let mut file: StockFile = params.parse()?;
    let mut faults = Faults::new();
    let reference = faults.take(reference(params, &file.reference_illuminant, resources));
    let process = file.process();
    faults.extend(file.kind_faults(params));
    let layers = layers(params, &file.layers, file.iso.map(|v| v.get()), reference.as_ref(), resources, &mut faults);
    faults.extend(unlike_developments(params, &file.layers));
    let densitometry = faults.take(densitometry(params, file.density, file.layers.len()));
    faults.extend(file.dye_faults(params));
    let minimum_density = file.minimum_density(params, &mut faults);
    let interlayer = file.interlayer(params, &mut faults);
    if file.aim_density.is_some() && (process != Process::Print || file.dyes() != 3) {
        let fault = params.fault("aim-density", "an aim density belongs to a print stock of three dyes");
        faults.push(fault.hint("leave `aim-density` out"));
    }
    let aim_density = file.aim_density.take().and_then(|aim| faults.take(aim.read(params)));
    let granularity = file.granularity(params, &mut faults);
    let assumed = file.assumed.map_or(Some(Assumptions::default()), |a| faults.take(a.read(params)));
    let assumed = assumed.unwrap_or_default();
    let layer_count = file.layers.len();
    let halation = file.halation.as_ref().and_then(|h| faults.take(h.read(params, layer_count)));
    let bases = file.bases.iter().map(BaseFile::read).collect();
    let reciprocity = file.reciprocity.as_ref().and_then(|r| faults.take(r.read(params)));
    let license = file.license.or(file.licence);
    if license.is_none() {
        faults.push(
            params.fault_here("`license` is missing").hint("the terms of the figures, such as `license: CC0-1.0`"),
        );
    }
    let Some(densitometry) = densitometry else {
        return Err(faults);
    };
    let Some(reference) = reference else {
        return Err(faults);
    };
    let exposure = file.exposure;
    let mut stock = faults.into_result(Stock {
        slid: None,
        name: file.name,
        maker: file.maker,
        source: file.source,
        license: license.unwrap_or_default(),
        remark: file.remark,
        process,
        medium: file.medium,
        densitometry,
        year: file.year,
        iso: file.iso.map(|v| v.get()),
        speed_kind: file.speed,
        meter: file.meter,
        iso_tungsten: file.iso_tungsten.map(|v| v.get()),
        reference_illuminant: file.reference_illuminant,
        reference,
        layers,
        bases,
        minimum_density,
        interlayer,
        aim_density,
        assumed,
        granularity,
        halation,
        print: file.print,
        reciprocity,
        filter_factors: file.filter_factors.into_iter().map(filter_factor).collect(),
    })?;
    if exposure == ExposureFile::Relative && stock.slide().is_none() {
        let fault = params.fault("exposure", "relative exposures are shifted to the speed, and these curves give none");
        return Err(fault.hint("state `iso`, and begin the curves at the density of unexposed film").into());
    }
    Ok(stock)
}

fn filter_factor(file: FilterFactorFile) -> FilterFactor {
    FilterFactor { filter: file.filter, daylight: file.daylight.get(), tungsten: file.tungsten.get() }
}

fn reference(params: &Params, name: &str, resources: &dyn Resources) -> Result<Emission, Faults> {
    let key = "reference-illuminant";
    let hint = "data sheets of films usually mean iso-7589-sensitometric-daylight";
    light(params, key, name, resources).map_err(|error| {
        let near = matches!(&error, SpectrumError::Unknown { candidates, .. } if !candidates.is_empty());
        let faults = error.faults(|text| params.fault(key, text));
        let hinted = |fault: Fault| if near || fault.path != key { fault } else { fault.hint(hint) };
        Faults(faults.into_iter().map(hinted).collect())
    })
}
