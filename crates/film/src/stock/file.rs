//! A stock's YAML file: its keys, and the checks that need more than a type.

use super::{
    Base, Development, FilterFactor, Layer, Reading, Reciprocity, SensitivityError, SpectralSensitivity, Stock,
};
use crate::curve::{
    AVERAGE_GRADIENT_SPAN, CharacteristicCurve, CurveError, SPEED_POINT_DENSITY, TabulatedCurve, ToeShoulder,
};
use serde::Deserialize;
use spectra_core::math::log10;
use spectra_core::params::{Fault, Faults, Length, Params, Positive, Time};
use spectra_core::resources::{Resource, ResourceError, Resources};
use spectra_core::spectral::BAND;
use spectra_spectrum::table::{MAX_BYTES, Table};
use spectra_spectrum::{Emission, Kind, Scale, SpectrumError, find_emission, illuminant};
use std::borrow::Cow;

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
struct StockFile {
    /// Format of the file.
    spectra: Option<f64>,
    name: String,
    maker: Option<String>,
    source: String,
    licence: String,
    remark: Option<String>,
    iso: Positive<f64>,
    iso_tungsten: Option<Positive<f64>>,
    reference_illuminant: String,
    layers: Vec<LayerFile>,
    #[serde(default)]
    bases: Vec<BaseFile>,
    reciprocity: Option<ReciprocityFile>,
    #[serde(default)]
    filter_factors: Vec<FilterFactorFile>,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
struct LayerFile {
    name: String,
    sensitivity: SensitivityFile,
    curves: Vec<CurveFile>,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
struct SensitivityFile {
    file: Option<String>,
    column: Option<String>,
    table: Option<Vec<[f64; 2]>>,
    reading: ReadingFile,
    floor: Option<f64>,
    measured_under: String,
    remark: Option<String>,
}

#[derive(Clone, Copy, Debug, Deserialize, PartialEq)]
#[serde(rename_all = "kebab-case")]
enum ReadingFile {
    Linear,
    Log10,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
struct CurveFile {
    development: String,
    #[serde(default)]
    assumed: bool,
    remark: Option<String>,
    /// Printed: pairs of log10 exposure (lx s) and density.
    points: Option<Vec<[f64; 2]>>,
    /// Assumed: the numbers of a [`ToeShoulder`].
    average_gradient: Option<f64>,
    maximum_density: Option<f64>,
    toe: Option<f64>,
    shoulder: Option<f64>,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
struct BaseFile {
    formats: String,
    material: Option<String>,
    thickness: Positive<Length>,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
struct ReciprocityFile {
    exponent: f64,
    above: Positive<Time>,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
struct FilterFactorFile {
    filter: String,
    daylight: Positive<f64>,
    tungsten: Positive<f64>,
}

/// Reads and checks the whole file; every fault of it in one go.
pub(super) fn read(params: &Params, resources: &dyn Resources) -> Result<Stock, Faults> {
    let file: StockFile = params.parse()?;
    let mut faults = Faults::new();
    if file.spectra.is_some_and(|v| v != 1.0) {
        faults.push(params.fault("spectra", "the format of a stock file that this program reads is 1"));
    }
    let reference = faults.take(reference(params, &file.reference_illuminant));
    if file.layers.is_empty() {
        faults.push(params.fault("layers", "a film has at least one layer"));
    }
    let mut layers: Vec<Layer> = Vec::new();
    for (i, layer) in file.layers.iter().enumerate() {
        let at = format!("layers[{i}]");
        if layer.name.is_empty() || file.layers[..i].iter().any(|l| l.name == layer.name) {
            faults.push(params.fault(&format!("{at}.name"), "each layer has a name of its own: it names the channel"));
        }
        let sensitivity = faults.take(sensitivity(params, &at, &layer.sensitivity, resources));
        let developments = faults.take(developments(params, &at, &layer.curves, file.iso.get()));
        let (Some(sensitivity), Some(developments)) = (sensitivity, developments) else {
            continue;
        };
        if let Some(reference) = &reference
            && let Err(error) = sensitivity.channel(&layer.name, reference, &BAND)
        {
            faults.push(params.fault(&format!("{at}.sensitivity"), error.to_string()));
        }
        let remark = layer.sensitivity.remark.clone();
        layers.push(Layer { name: layer.name.clone(), sensitivity, remark, developments });
    }
    faults.extend(unlike_developments(params, &file.layers));
    let reciprocity = file.reciprocity.map(|r| {
        if !(1.0..=10.0).contains(&r.exponent) {
            let text = format!("the exponent is between 1 and 10, not {}", r.exponent);
            faults.push(params.fault("reciprocity.exponent", text));
        }
        Reciprocity { exponent: r.exponent, above_s: r.above.s() }
    });
    let Some(reference) = reference else {
        return Err(faults);
    };
    faults.into_result(Stock {
        name: file.name,
        maker: file.maker,
        source: file.source,
        licence: file.licence,
        remark: file.remark,
        iso: file.iso.get(),
        iso_tungsten: file.iso_tungsten.map(|v| v.get()),
        reference_illuminant: file.reference_illuminant,
        reference,
        layers,
        bases: file.bases.into_iter().map(base).collect(),
        reciprocity,
        filter_factors: file.filter_factors.into_iter().map(filter_factor).collect(),
    })
}

fn base(file: BaseFile) -> Base {
    Base { formats: file.formats, material: file.material, thickness_mm: file.thickness.mm() }
}

fn filter_factor(file: FilterFactorFile) -> FilterFactor {
    FilterFactor { filter: file.filter, daylight: file.daylight.get(), tungsten: file.tungsten.get() }
}

fn reference(params: &Params, name: &str) -> Result<Emission, Fault> {
    illuminant(name).map_err(|error| {
        let hint = "the sheets of films mean iso-7589-sensitometric-daylight";
        params.fault("reference-illuminant", error.to_string()).hint(hint)
    })
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
    let light = faults.take(measured_under(&file.measured_under).map_err(|error| {
        params.fault(&format!("{at}.measured-under"), error.to_string()).hint("`equal-energy`, or an illuminant")
    }));
    let reading = match (file.reading, file.floor) {
        (ReadingFile::Log10, floor) => Reading::Log10 { floor },
        (ReadingFile::Linear, None) => Reading::Linear,
        (ReadingFile::Linear, Some(_)) => {
            faults.push(params.fault(&format!("{at}.floor"), "only logarithms have a floor"));
            Reading::Linear
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

fn measured_under(name: &str) -> Result<Option<Emission>, SpectrumError> {
    if name == "equal-energy" { Ok(None) } else { find_emission(name).map(Some) }
}

fn points(
    params: &Params,
    at: &str,
    file: &SensitivityFile,
    resources: &dyn Resources,
) -> Result<Vec<[f64; 2]>, Fault> {
    let name = match (&file.table, &file.file) {
        (Some(table), None) => return Ok(table.clone()),
        (None, Some(name)) => name,
        (None, None) => {
            return Err(params.fault(at, "the sensitivity has no values").hint("give `file` or `table`"));
        }
        (Some(_), Some(_)) => {
            return Err(params
                .fault(&format!("{at}.table"), "the sensitivity is given twice")
                .hint("either file or table"));
        }
    };
    let fault = |text: String| params.fault(&format!("{at}.file"), text);
    let found = beside(params, name, resources).map_err(|error| fault(format!("`{name}`: {error}")))?;
    let table = Table::parse_bytes(&found.name, &found.bytes, Some(Kind::Sensitivity)).map_err(|e| {
        fault(e.to_string()).hint("logarithms need `# spectra: 1` and `# unit: log10` above the header")
    })?;
    let logarithms = table.meta.scale() == Scale::Log10;
    if logarithms != (file.reading == ReadingFile::Log10) {
        let says = if logarithms { "log10" } else { "linear" };
        return Err(params.fault(&format!("{at}.reading"), format!("{}: its front matter says {says}", found.name)));
    }
    let column = match &file.column {
        None if table.columns.len() == 1 => 0,
        None => {
            return Err(fault(format!("{} has several columns", found.name)).hint(columns(&table)));
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

/// The file `name` that a stock's file names: beside it, bundled where the stock is, else as the scene finds it.
fn beside(params: &Params, name: &str, resources: &dyn Resources) -> Result<Resource, ResourceError> {
    let read = |path: &str| resources.read(path, &[super::FOLDER], &[], MAX_BYTES);
    let Some(folder) = params.base_dir() else {
        let path = format!("{}/{name}", super::FOLDER);
        let bundled = |bytes| Resource { name: format!("bundled:{path}"), folder: None, bytes: Cow::Borrowed(bytes) };
        return spectra_data::get(&path).map_or_else(|| read(name), |bytes| Ok(bundled(bytes)));
    };
    // The scene may lie in another folder, and a relative path would be taken as relative to that.
    if let Ok(path) = std::path::absolute(folder.join(name))
        && let Some(path) = path.to_str()
    {
        match read(path) {
            Err(ResourceError::NotFound(_)) => {}
            other => return other,
        }
    }
    read(name)
}

fn developments(params: &Params, at: &str, files: &[CurveFile], iso: f64) -> Result<Vec<Development>, Faults> {
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
            let hint = "a `remark` says what it rests on";
            faults.push(params.fault(&format!("{at}.assumed"), "an assumed curve says why").hint(hint));
        }
        if let Some(curve) = faults.take(curve(params, &at, file, iso)) {
            let (name, remark) = (file.development.clone(), file.remark.clone());
            developments.push(Development { name, assumed: file.assumed, remark, curve });
        }
    }
    faults.into_result(developments)
}

fn curve(params: &Params, at: &str, file: &CurveFile, iso: f64) -> Result<CharacteristicCurve, Fault> {
    let shape = [
        ("average-gradient", file.average_gradient),
        ("maximum-density", file.maximum_density),
        ("toe", file.toe),
        ("shoulder", file.shoulder),
    ];
    if let Some(points) = &file.points {
        if let Some((key, _)) = shape.iter().find(|(_, v)| v.is_some()) {
            return Err(params.fault(&format!("{at}.{key}"), "a curve given by `points` has no other shape"));
        }
        return TabulatedCurve::new(points)
            .map(Into::into)
            .map_err(|error| params.fault(&format!("{at}.points"), error.to_string()));
    }
    let missing: Vec<&str> = shape.iter().filter(|(_, v)| v.is_none()).map(|(key, _)| *key).collect();
    let [Some(gradient), Some(maximum), Some(toe), Some(shoulder)] = shape.map(|(_, v)| v) else {
        let text = format!("the curve has no {}", missing.join(", "));
        return Err(params.fault(at, text).hint("or `points`: pairs of log10 exposure (lx s) and density"));
    };
    // ISO 6:1993: the exposure 0.8/S lx s gives the density 0.1 over base and fog.
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

/// Layers are developed together, so each has a curve for each development.
fn unlike_developments(params: &Params, layers: &[LayerFile]) -> Vec<Fault> {
    let names = |layer: &LayerFile| layer.curves.iter().map(|c| c.development.clone()).collect::<Vec<_>>();
    let Some(first) = layers.first().map(names) else {
        return Vec::new();
    };
    let unlike = layers.iter().enumerate().filter(|(_, layer)| names(layer) != first);
    let text = format!("the developments are those of the first layer: {}", first.join(", "));
    unlike.map(|(i, _)| params.fault(&format!("layers[{i}].curves"), &text)).collect()
}
