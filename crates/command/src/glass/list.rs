//! `spectra glass list`: lists media by name.

use super::arguments::GlassList;
use super::{catalogue, makers, period};
use crate::console;
use crate::outcome::{DONE, Outcome};
use serde::Serialize;
use spectra_glass::Glass;
use std::fmt::Write;

/// A medium of the list.
#[derive(Debug, Serialize)]
struct GlassListRow {
    name: String,
    category: &'static str,
    /// Index at d; null if the data do not reach the line.
    nd: Option<f64>,
    vd: Option<f64>,
    range_nm: (f64, f64),
    status: &'static str,
    years: Option<(u16, u16)>,
    /// Whether the absorption is known.
    absorption: bool,
}

/// Lists media by name, maker and category on standard output.
pub(crate) fn list(arguments: &GlassList) -> Outcome {
    let catalogue = catalogue(&arguments.own)?;
    let makers = makers(&arguments.makers, &catalogue)?;
    let found = match &arguments.fragment {
        Some(fragment) => catalogue.search(fragment),
        None => catalogue.glasses().collect(),
    };
    let wanted = |glass: &Glass| {
        arguments.category.is_none_or(|category| glass.category == category)
            && (makers.is_empty() || makers.iter().any(|maker| **maker == *glass.maker))
    };
    let mut rows: Vec<GlassListRow> = found.iter().filter(|glass| wanted(glass)).map(row).collect();
    rows.sort_by(|a, b| a.name.cmp(&b.name));
    if arguments.json {
        console::pretty_json(&rows)?;
    } else {
        console::out(&text(&rows))?;
        if rows.is_empty() {
            console::note(
                "no glass has this name; `spectra glass match --nd N --vd V` finds a glass by its index and Abbe number",
            );
        }
    }
    Ok(DONE)
}

fn row(glass: &Glass) -> GlassListRow {
    let covered = |from: f64, to: f64| glass.range_nm.0 <= from && to <= glass.range_nm.1;
    GlassListRow {
        name: glass.full_name(),
        category: glass.category.name(),
        nd: Some(glass.nd()).filter(|n| n.is_finite() && covered(587.6, 587.5)),
        vd: Some(glass.vd()).filter(|v| v.is_finite() && v.abs() < 1000.0 && covered(486.2, 656.2)),
        range_nm: glass.range_nm,
        status: glass.status.name(),
        years: glass.years,
        absorption: glass.extinction.is_some(),
    }
}

fn text(rows: &[GlassListRow]) -> String {
    let width = rows.iter().map(|row| row.name.chars().count()).max().unwrap_or(0).max(4);
    let mut out = String::new();
    // Writing to a String cannot fail.
    if !rows.is_empty() {
        let _ =
            writeln!(out, "{:<width$}  {:>8}  {:>6}  {:<15}  {:<9}  listed", "name", "nd", "Vd", "category", "status");
    }
    for row in rows {
        let nd = row.nd.map_or(String::new(), |n| format!("{n:.5}"));
        let vd = row.vd.map_or(String::new(), |v| format!("{v:.2}"));
        let status = if row.status == "unknown" { "" } else { row.status };
        let years = row.years.map_or(String::new(), period);
        let line = format!("{:<width$}  {nd:>8}  {vd:>6}  {:<15}  {status:<9}  {years}", row.name, row.category);
        let _ = writeln!(out, "{}", line.trim_end());
    }
    out
}
