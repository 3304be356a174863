//! The sensitivity of a layer in a stock's file, and the lights that the file names.

use super::{SensitivityError, SensitivityScale, SpectralSensitivity};
use schemars::JsonSchema;
use serde::Deserialize;
use spectra_core::params::{Faults, Node, Params};
use spectra_core::resources::{Resource, ResourceError, Resources, beside};
use spectra_spectrum::table::{MAX_BYTES, Table, TableFault};
use spectra_spectrum::{Emission, Kind, Scale, SpectrumError, find_emission_in};
use std::borrow::Cow;

#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
pub(super) struct SensitivityFile {
    /// CSV file next to this one with the sensitivity over wavelength; or else `table`.
    file: Option<String>,
    /// Column of that file; may be left out if there is only one.
    column: Option<String>,
    /// Pairs of wavelength (nm, ascending) and sensitivity; or else `file`. Zero outside the table.
    table: Option<Vec<[f64; 2]>>,
    /// Scale of the values: `linear` (proportional to one over the energy that gives a fixed density) or `log10` of that.
    reading: ReadingFile,
    /// Value of a logarithmic table that means no sensitivity at all, at the foot of the figure. None if absent.
    floor: Option<f64>,
    /// Light with which the figure was made: `equal-energy`, or the name of an illuminant, by which the values are divided.
    measured_under: String,
    /// Whether it was chosen rather than measured; then `remark` says why.
    #[serde(default)]
    pub(super) assumed: bool,
    /// Remarks for people, for example doubts and choices.
    pub(super) remark: Option<String>,
}

#[derive(Clone, Copy, Debug, Deserialize, JsonSchema, PartialEq)]
#[serde(rename_all = "kebab-case")]
enum ReadingFile {
    /// Proportional to one over the energy that gives a fixed density.
    Linear,
    /// Logarithm to base 10 of the linear sensitivity.
    Log10,
}

/// Finds the light that a key of the stock's file names: a bundled one, or a file next to the stock's.
pub(super) fn light(
    params: &Params,
    key: &str,
    name: &str,
    resources: &dyn Resources,
) -> Result<Emission, SpectrumError> {
    match params.node().at_path(key) {
        Some(node) => find_emission_in(&beside_spectrum(node, name), resources),
        None => find_emission_in(name, resources),
    }
}

/// Reads the sensitivity of the layer at this path.
pub(super) fn sensitivity(
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
