//! A stock's YAML file: its keys, and the checks that go beyond types.

use super::base_stock::inherited;
use super::color::{AimDensityFile, InterlayerFile, Medium};
use super::material::{DensityFile, DyeFile, MinimumDensityFile, densitometry};
use super::reciprocity::ReciprocityFile;
use super::speed::{ExposureFile, MeterResponse, SpeedKind};
use super::structure::{Assumptions, AssumptionsFile, BaseFile, GranularityFile, HalationFile, granularity, mtf};
use super::{
    Development, FilterFactor, Layer, Process, SensitivityError, SensitivityScale, SpectralSensitivity, Stock,
};
use crate::curve::{
    AVERAGE_GRADIENT_SPAN, CharacteristicCurve, CurveError, SPEED_POINT_DENSITY, TabulatedCurve, ToeShoulder,
};
use schemars::{JsonSchema, Schema, SchemaGenerator};
use serde::Deserialize;
use serde_json::{Value, json};
use spectra_core::math::log10;
use spectra_core::params::{Fault, Faults, Node, Params, Positive, Whole};
use spectra_core::resources::{Resource, ResourceError, Resources, beside};
use spectra_core::spectral::BAND;
use spectra_spectrum::table::{MAX_BYTES, Table, TableFault};
use spectra_spectrum::{Emission, Kind, Scale, SpectrumError, find_emission_in};
use std::borrow::Cow;

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
struct LayerFile {
    /// Name of the layer and of its channel; different for each layer.
    name: String,
    /// Spectral sensitivity, of which only the shape counts: the speed is in the curve.
    sensitivity: SensitivityFile,
    /// Dye that forms in the layer; silver if absent.
    dye: Option<DyeFile>,
    /// Modulation transfer of the emulsion: pairs of spatial frequency, cycles/mm, increasing, and response, 0 to 2. Light is not spread if
    /// absent.
    #[serde(default)]
    mtf: Vec<[f64; 2]>,
    /// Granularity of a layer with a dye: pairs of density above the minimum, measured through the filter of its dye on neutral film,
    /// increasing, and 1000 times the standard deviation through 48 um. No grain if absent.
    #[serde(default)]
    granularity: Vec<[f64; 2]>,
    /// Characteristic curves, one for each development.
    curves: Vec<CurveFile>,
}

#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
struct SensitivityFile {
    /// CSV file next to this one with the sensitivity over wavelength; or else `table`.
    file: Option<String>,
    /// Column of that file; may be left out if there is only one.
    column: Option<String>,
    /// Pairs of wavelength, nm, increasing, and sensitivity; or else `file`. Zero outside the table.
    table: Option<Vec<[f64; 2]>>,
    /// Scale of the values: `linear` (proportional to one over the energy that gives a fixed density) or `log10` of that.
    reading: ReadingFile,
    /// Value of a logarithmic table that means no sensitivity at all, at the foot of the figure. None if absent.
    floor: Option<f64>,
    /// Light with which the figure was made: `equal-energy`, or the name of an illuminant, by which the values are divided.
    measured_under: String,
    /// Whether it was chosen rather than measured; then `remark` says why.
    #[serde(default)]
    assumed: bool,
    /// Remarks for people, for example doubts and choices.
    remark: Option<String>,
}

#[derive(Clone, Copy, Debug, Deserialize, JsonSchema, PartialEq)]
#[serde(rename_all = "kebab-case")]
enum ReadingFile {
    /// Proportional to one over the energy that gives a fixed density.
    Linear,
    /// Logarithm to base 10 of the linear sensitivity.
    Log10,
}

#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
struct CurveFile {
    /// Name of the development, by which a scene selects it.
    development: String,
    /// Development time, min; not known if absent. Curves with a time form a series, in which a scene can `push`.
    minutes: Option<Positive<f64>>,
    /// Whether it was chosen rather than measured; then `remark` says why.
    #[serde(default)]
    assumed: bool,
    /// Remarks for people: developer, temperature, doubts.
    remark: Option<String>,
    /// The printed curve: pairs of log10 exposure (lx s of the reference illuminant), increasing, and density. Replaces the four numbers
    /// below.
    points: Option<Vec<[f64; 2]>>,
    /// Slope of an assumed curve: that of the chord from the speed point, 0.8/S lx s, over 1.5 in log10 exposure.
    average_gradient: Option<f64>,
    /// Maximum density of an assumed curve, above base and fog.
    maximum_density: Option<f64>,
    /// Width of the toe of an assumed curve, log10 of exposure, above 0 to 2.
    #[schemars(extend("exclusiveMinimum" = 0, "maximum" = 2))]
    toe: Option<f64>,
    /// Sharpness of the shoulder of an assumed curve, 1 to 64.
    #[schemars(range(min = 1, max = 64))]
    shoulder: Option<f64>,
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

/// Reads and checks the whole file, and reports all faults together.
pub(super) fn read(params: &Params, resources: &dyn Resources) -> Result<Stock, Faults> {
    let params = &inherited(params, resources)?;
    let file: StockFile = params.parse()?;
    let mut faults = Faults::new();
    let reference = faults.take(reference(params, &file.reference_illuminant, resources));
    if file.layers.is_empty() {
        let fault = params.fault("layers", "a film has at least one layer");
        faults.push(fault.hint("each with `name`, `sensitivity` and `curves`; the bundled stocks are examples"));
    }
    let process = match file.process {
        ProcessFile::Negative => Process::Negative,
        ProcessFile::Reversal => Process::Reversal,
        ProcessFile::Print => Process::Print,
    };
    if file.iso.is_none() && process != Process::Print {
        let fault = params.fault("iso", "a camera film needs a speed");
        faults.push(fault.hint("write `iso: 100`; only a `process: print` has no speed"));
    }
    if file.meter == MeterResponse::Film && file.layers.len() > 1 {
        let fault = params.fault("meter", "a meter with the film's own sensitivity needs a film with one layer");
        faults.push(fault.hint("`meter: photopic`, or leave it out"));
    }
    if file.medium == Medium::Paper && process != Process::Print {
        let fault = params.fault("medium", "only a print stock can be on paper");
        faults.push(fault.hint("`process: print`, or leave `medium` out"));
    }
    let layers = layers(params, &file, reference.as_ref(), resources, &mut faults);
    faults.extend(unlike_developments(params, &file.layers));
    let densitometry = faults.take(densitometry(params, file.density, file.layers.len()));
    let dyes = file.layers.iter().filter(|l| l.dye.is_some()).count();
    if dyes != 0 && dyes != file.layers.len() {
        let fault = params.fault("layers", "some layers have a dye and some have none");
        faults.push(fault.hint("a `dye` in each, or none for silver"));
    }
    if dyes == 0 && file.layers.len() > 1 {
        faults.push(params.fault("layers", "a film of several layers needs a `dye` in each"));
    }
    let minimum_density = file.minimum_density.as_ref().and_then(|m| faults.take(m.read(params)));
    if file.minimum_density.is_some() && dyes == 0 {
        let fault = params.fault("minimum-density", "curves of silver already include base and fog");
        faults.push(fault.hint("leave it out"));
    }
    if file.interlayer.is_some() && dyes == 0 {
        let fault = params.fault("interlayer", "a film of one silver layer has no other layer to act on");
        faults.push(fault.hint("leave it out"));
    }
    let interlayer = file.interlayer.as_ref().filter(|_| dyes != 0);
    let interlayer = interlayer.and_then(|i| faults.take(i.read(params, file.layers.len())));
    if file.aim_density.is_some() && (process != Process::Print || dyes != 3) {
        let fault = params.fault("aim-density", "an aim density belongs to a print stock of three dyes");
        faults.push(fault.hint("leave it out"));
    }
    let aim_density = file.aim_density.and_then(|aim| faults.take(aim.read(params)));
    let granularity = file.granularity.as_ref().and_then(|g| faults.take(g.read(params)));
    if file.granularity.is_some() && dyes != 0 {
        let fault = params.fault("granularity", "a film with dyes needs a granularity in each layer");
        faults.push(fault.hint("`granularity: [[density over the minimum, RMS], ...]` of each layer"));
    }
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

/// Reads the layers; those with faults are left out.
fn layers(
    params: &Params,
    file: &StockFile,
    reference: Option<&Emission>,
    resources: &dyn Resources,
    faults: &mut Faults,
) -> Vec<Layer> {
    let mut layers: Vec<Layer> = Vec::new();
    for (i, layer) in file.layers.iter().enumerate() {
        let at = format!("layers[{i}]");
        if layer.name.is_empty() || file.layers[..i].iter().any(|l| l.name == layer.name) {
            faults.push(
                params.fault(
                    &format!("{at}.name"),
                    "each layer needs a name of its own, which is also that of its channel",
                ),
            );
        }
        if layer.sensitivity.assumed && layer.sensitivity.remark.as_ref().is_none_or(|r| r.trim().is_empty()) {
            let fault = params.fault(&format!("{at}.sensitivity.assumed"), "an assumed sensitivity needs a remark");
            faults.push(fault.hint("add a `remark` that says what it is based on"));
        }
        let sensitivity = faults.take(sensitivity(params, &at, &layer.sensitivity, resources));
        let developments = faults.take(developments(params, &at, &layer.curves, file.iso.map(|v| v.get())));
        let dye = match &layer.dye {
            Some(dye) => faults.take(dye.read(params, &at)).map(Some),
            None => Some(None),
        };
        let mtf = faults.take(mtf(params, &at, &layer.mtf));
        let grain = faults.take(granularity(params, &at, &layer.granularity));
        let (Some(sensitivity), Some(developments), Some(dye), Some(mtf), Some(granularity)) =
            (sensitivity, developments, dye, mtf, grain)
        else {
            continue;
        };
        if let Some(reference) = reference
            && let Err(error) = sensitivity.channel(&layer.name, reference, &BAND)
        {
            let (first, last) = sensitivity.range_nm();
            let fault = params.fault(&format!("{at}.sensitivity"), error.to_string());
            faults.push(fault.hint(format!(
                "its table runs from {first} to {last} nm; light is computed from {} to {} nm",
                BAND.start_nm,
                BAND.end_nm()
            )));
        }
        let (name, remark, assumed) = (layer.name.clone(), layer.sensitivity.remark.clone(), layer.sensitivity.assumed);
        layers.push(Layer { name, sensitivity, assumed, remark, dye, mtf, granularity, developments });
    }
    layers
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

/// Finds the light that a key of the stock's file names: a bundled one, or a file next to the stock's.
fn light(params: &Params, key: &str, name: &str, resources: &dyn Resources) -> Result<Emission, SpectrumError> {
    match params.node().at_path(key) {
        Some(node) => find_emission_in(&beside_spectrum(node, name), resources),
        None => find_emission_in(name, resources),
    }
}

fn sensitivity(
    params: &Params,
    at: &str,
    file: &SensitivityFile,
    resources: &dyn Resources,
) -> Result<SpectralSensitivity, Faults> {
    let at = format!("{at}.sensitivity");
    let mut faults = Faults::new();
    let points = faults.take(points(params, &at, file, resources));
    let key = format!("{at}.measured-under");
    let light = match file.measured_under.as_str() {
        "equal-energy" => Ok(None),
        name => light(params, &key, name, resources).map(Some),
    };
    let light = faults.take(light.map_err(|error| error.faults(|text| params.fault(&key, text))));
    let reading = match (file.reading, file.floor) {
        (ReadingFile::Log10, floor) => SensitivityScale::Log10 { floor },
        (ReadingFile::Linear, None) => SensitivityScale::Linear,
        (ReadingFile::Linear, Some(_)) => {
            faults.push(params.fault(&format!("{at}.floor"), "only logarithms have a floor"));
            SensitivityScale::Linear
        }
    };
    let (Some(points), Some(light)) = (points, light) else {
        return Err(faults);
    };
    match SpectralSensitivity::new(&points, reading, light) {
        Ok(sensitivity) => faults.into_result(sensitivity),
        Err(error) => {
            let key = match (&error, &file.table) {
                (SensitivityError::DarkLight { .. }, _) => "measured-under",
                (_, Some(_)) => "table",
                (_, None) => "file",
            };
            faults.push(params.fault(&format!("{at}.{key}"), error.to_string()));
            Err(faults)
        }
    }
}

fn points(
    params: &Params,
    at: &str,
    file: &SensitivityFile,
    resources: &dyn Resources,
) -> Result<Vec<[f64; 2]>, Faults> {
    let name = match (&file.table, &file.file) {
        (Some(table), None) => return Ok(table.clone()),
        (None, Some(name)) => name,
        (None, None) => {
            return Err(params.fault(at, "the sensitivity has no values").hint("give `file` or `table`").into());
        }
        (Some(_), Some(_)) => {
            return Err(params
                .fault(&format!("{at}.table"), "the sensitivity is given twice")
                .hint("give either `file` or `table`")
                .into());
        }
    };
    let fault = |text: String| params.fault(&format!("{at}.file"), text);
    let written = params.node().at_path(&format!("{at}.file")).unwrap_or(params.node());
    let found = read_beside(written, name, resources).map_err(|error| {
        let hint = match &error {
            ResourceError::NotFound(near) if !near.is_empty() => format!("did you mean `{}`?", near.join("` or `")),
            _ => "a table is looked for beside the stock's file".to_owned(),
        };
        fault(format!("`{name}`: {error}")).hint(hint)
    })?;
    let reading = if file.reading == ReadingFile::Log10 { Scale::Log10 } else { Scale::Linear };
    let table = Table::parse_read_as(&found.name, &found.bytes, Kind::Sensitivity, reading).map_err(|e| {
        let placed = e.fault();
        match e.cause {
            TableFault::Negative { .. } | TableFault::AboveBound { .. } => {
                placed.hint("for logarithms, write `reading: log10`")
            }
            _ => placed,
        }
    })?;
    let logarithms = table.meta.scale() == Scale::Log10;
    if logarithms != (file.reading == ReadingFile::Log10) {
        let says = if logarithms { "log10" } else { "linear" };
        let fault = params.fault(&format!("{at}.reading"), format!("{}: its front matter says {says}", found.name));
        return Err(fault.into());
    }
    let column = match &file.column {
        None if table.columns.len() == 1 => 0,
        None => {
            return Err(fault(format!("{} has several columns", found.name)).hint(columns(&table)).into());
        }
        Some(column) => table.columns.iter().position(|c| c == column).ok_or_else(|| {
            let text = format!("{} has no column `{column}`", found.name);
            params.fault(&format!("{at}.column"), text).hint(columns(&table))
        })?,
    };
    Ok(table.wavelengths_nm.iter().zip(table.values[column].iter()).map(|(w, v)| [*w, *v]).collect())
}

fn columns(table: &Table) -> String {
    format!("`column`: {}", table.columns.join(", "))
}

/// Reads the file `name` that a value of a stock's file names: next to that file, or bundled if the stock is, or else where the scene finds
/// it.
fn read_beside(written: &Node, name: &str, resources: &dyn Resources) -> Result<Resource, ResourceError> {
    let read = |path: &str| resources.read(path, &[super::FOLDER], &[], MAX_BYTES);
    if written.file.folder().is_none() {
        let path = format!("{}/{name}", super::FOLDER);
        let bundled = |bytes| Resource { name: format!("bundled:{path}"), folder: None, bytes: Cow::Borrowed(bytes) };
        return spectra_data::get(&path).map_or_else(|| read(name), |bytes| Ok(bundled(bytes)));
    }
    read(&beside(written, name))
}

/// Returns the name of a spectrum, resolved to a file next to the one that names it if there is such a file. The column is kept.
fn beside_spectrum(written: &Node, name: &str) -> String {
    match name.rsplit_once('#') {
        Some((file, column)) => format!("{}#{column}", beside(written, file)),
        None => beside(written, name),
    }
}

fn developments(params: &Params, at: &str, files: &[CurveFile], iso: Option<f64>) -> Result<Vec<Development>, Faults> {
    let mut faults = Faults::new();
    if files.is_empty() {
        faults.push(params.fault(&format!("{at}.curves"), "a layer has at least one curve"));
    }
    let mut developments: Vec<Development> = Vec::new();
    for (i, file) in files.iter().enumerate() {
        let at = format!("{at}.curves[{i}]");
        if files[..i].iter().any(|f| f.development == file.development) {
            faults.push(params.fault(&format!("{at}.development"), "each curve has a development of its own"));
        }
        if file.assumed && file.remark.as_ref().is_none_or(|r| r.trim().is_empty()) {
            let hint = "add a `remark` that says what it is based on";
            faults.push(params.fault(&format!("{at}.assumed"), "an assumed curve needs a remark").hint(hint));
        }
        if let Some(curve) = faults.take(curve(params, &at, file, iso)) {
            let (name, remark) = (file.development.clone(), file.remark.clone());
            let minutes = file.minutes.map(|m| m.get());
            developments.push(Development { name, minutes, assumed: file.assumed, remark, curve });
        }
    }
    faults.into_result(developments)
}

fn curve(params: &Params, at: &str, file: &CurveFile, iso: Option<f64>) -> Result<CharacteristicCurve, Fault> {
    let shape = [
        ("average-gradient", file.average_gradient),
        ("maximum-density", file.maximum_density),
        ("toe", file.toe),
        ("shoulder", file.shoulder),
    ];
    if let Some(points) = &file.points {
        if let Some((key, _)) = shape.iter().find(|(_, v)| v.is_some()) {
            return Err(params.fault(&format!("{at}.{key}"), "a curve given by `points` can have no other shape"));
        }
        return TabulatedCurve::new(points).map(Into::into).map_err(|error| {
            let (key, hint) = match &error {
                CurveError::Order { index, .. } => (
                    format!("{at}.points[{}]", index.saturating_sub(1)),
                    "pairs of log10 exposure (lx s), increasing, and density, which only rises or only falls",
                ),
                _ => (format!("{at}.points"), "two or more pairs of log10 exposure (lx s) and density"),
            };
            params.fault(&key, error.to_string()).hint(hint)
        });
    }
    let missing: Vec<&str> = shape.iter().filter(|(_, v)| v.is_none()).map(|(key, _)| *key).collect();
    let [Some(gradient), Some(maximum), Some(toe), Some(shoulder)] = shape.map(|(_, v)| v) else {
        let text = format!("the curve has no {}", missing.join(", "));
        return Err(params.fault(at, text).hint("or `points`: pairs of log10 exposure (lx s) and density"));
    };
    let Some(iso) = iso else {
        let text = "without a speed, a curve must be given by `points`";
        return Err(params.fault(at, text).hint("pairs of log10 exposure (lx s) and density"));
    };
    // ISO 6:1993: the exposure 0.8/S lx s gives the density 0.1 above base and fog.
    let low = [log10(0.8 / iso), SPEED_POINT_DENSITY];
    let high = [low[0] + AVERAGE_GRADIENT_SPAN, low[1] + AVERAGE_GRADIENT_SPAN * gradient];
    ToeShoulder::through(low, high, toe, maximum, shoulder).map(Into::into).map_err(|error| {
        let key = match &error {
            CurveError::ToeTooLong { .. } | CurveError::OutOfRange { what: "toe", .. } => ".toe",
            CurveError::OutOfRange { what: "shoulder", .. } => ".shoulder",
            CurveError::OutOfRange { what: "maximum density", .. } => ".maximum-density",
            CurveError::OutOfRange { what: "density of the second point", .. } => ".average-gradient",
            _ => "",
        };
        params.fault(&format!("{at}{key}"), error.to_string())
    })
}

/// Returns faults for layers with other developments than the first: layers are developed together.
fn unlike_developments(params: &Params, layers: &[LayerFile]) -> Vec<Fault> {
    let names = |layer: &LayerFile| layer.curves.iter().map(|c| c.development.clone()).collect::<Vec<_>>();
    let Some(first) = layers.first().map(names) else {
        return Vec::new();
    };
    let unlike = layers.iter().enumerate().filter(|(_, layer)| names(layer) != first);
    let text = format!("each layer needs the developments of the first layer: {}", first.join(", "));
    unlike.map(|(i, _)| params.fault(&format!("layers[{i}].curves"), &text)).collect()
}
