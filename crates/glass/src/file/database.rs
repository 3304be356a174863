//! Pages of the refractiveindex.info database, in its own YAML; a user may put a page beside a scene as it was downloaded.
//!
//! Format: M. N. Polyanskiy, "Refractiveindex.info database of optical constants", Sci. Data 11, 94 (2024). Wavelengths
//! are in micrometers.

use super::{OWN_MAKER, sensible};
use crate::{Category, Extinction, Formula, Glass, NumberedFormula, Table};
use spectra_core::params::{Fault, Faults, Node, Params, Value};

/// Returns whether a document is a page of the database.
pub(super) fn is_one(params: &Params) -> bool {
    params.get("DATA").is_some()
}

/// Reads the glass of a page.
pub(super) fn from_params(params: &Params) -> Result<Glass, Faults> {
    let Some(Value::Seq(blocks)) = params.get("DATA").map(|node| &node.value) else {
        return Err(params.fault("DATA", "a list of data is expected here").into());
    };
    let file = &params.node().file.name;
    let stem = file.rsplit(['/', '\\']).next().unwrap_or(file);
    let stem = stem.rsplit_once('.').map_or(stem, |(stem, _)| stem);
    let (mut index, mut extinction) = (None, None);
    for block in blocks {
        let fault = |key: &str, text: String| {
            let node = block.get(key).unwrap_or(block);
            node.fault(text).hint("write it as refractiveindex.info does")
        };
        let kind = block.get("type").and_then(Node::as_str).unwrap_or_default();
        let numbers = |key: &str| -> Result<Vec<f64>, Fault> {
            let text = block.get(key).and_then(Node::as_str).unwrap_or_default();
            let parse = |word: &str| word.parse::<f64>().ok().filter(|v| v.is_finite());
            let all: Option<Vec<f64>> = text.split_whitespace().map(parse).collect();
            all.filter(|all| !all.is_empty()).ok_or_else(|| fault(key, format!("`{key}` is not a row of numbers")))
        };
        match kind.split_once(' ') {
            Some(("formula", number)) => {
                let number: u8 = number.trim().parse().map_err(|_| fault("type", format!("unknown type `{kind}`")))?;
                let coefficients = numbers("coefficients")?;
                let formula = NumberedFormula::new(number, &coefficients);
                let formula = formula.ok_or_else(|| fault("coefficients", format!("do not fit `{kind}`")))?;
                let range = if block.get("wavelength_range").is_some() { "wavelength_range" } else { "range" };
                let &[from, to] = &numbers(range)?[..] else {
                    return Err(fault(range, "two wavelengths in micrometers are expected here".to_owned()).into());
                };
                if !(from > 0.0 && from < to) {
                    return Err(fault(range, format!("not a range: {from} to {to} um")).into());
                }
                index = Some((Formula::Numbered(formula), (from * 1e3, to * 1e3)));
            }
            Some(("tabulated", what @ ("n" | "nk" | "k"))) => {
                let width = what.len() + 1;
                let values = numbers("data")?;
                if !values.len().is_multiple_of(width) {
                    return Err(fault("data", format!("{} numbers cannot form rows of {width}", values.len())).into());
                }
                let rows: Vec<&[f64]> = values.chunks_exact(width).collect();
                let nm: Vec<f64> = rows.iter().map(|row| row[0] * 1e3).collect();
                if what.contains('n') {
                    let points: Vec<(f64, f64)> = rows.iter().zip(&nm).map(|(row, nm)| (*nm, row[1])).collect();
                    let table = Table::new(&points).map_err(|e| fault("data", e.to_string()))?;
                    let range = table.range_nm();
                    index = Some((Formula::Table(table.into()), range));
                }
                if what.contains('k') {
                    let k = rows.iter().map(|row| row[width - 1]).collect();
                    let k = Extinction::new(nm.into(), k);
                    extinction = Some(k.ok_or_else(|| fault("data", "no extinction coefficients".to_owned()))?);
                }
            }
            _ => return Err(fault("type", format!("unknown type `{kind}`")).into()),
        }
    }
    let Some((formula, range)) = index else {
        return Err(params.fault("DATA", "there is no refractive index in it").into());
    };
    let mut glass = Glass::new(OWN_MAKER, stem, Category::User, formula, range);
    glass.extinction = extinction;
    glass.source = params.get("REFERENCES").and_then(Node::as_str).unwrap_or("refractiveindex.info").trim().into();
    sensible(&glass).map_err(|text| params.fault("DATA", text))?;
    Ok(glass)
}
