//! `spectra glass check`: compares computed indices with the values that makers list.

use super::arguments::GlassCheck;
use super::catalogue;
use crate::console;
use crate::outcome::{DONE, Outcome};
use serde::Serialize;
use spectra_glass::{LISTED_TOLERANCE_ND, LISTED_TOLERANCE_VD, ListedCheck};
use std::fmt::Write;

/// Result of the check.
#[derive(Debug, Serialize)]
struct Report {
    /// Number of media that have listed nd and Vd as well as coefficients.
    listed: usize,
    tolerance_nd: f64,
    tolerance_vd: f64,
    deviating: Vec<DeviationRow>,
}

/// A medium whose computed values differ from the listed ones.
#[derive(Debug, Serialize)]
struct DeviationRow {
    name: String,
    listed_nd: f64,
    nd: f64,
    listed_vd: f64,
    vd: f64,
}

/// Compares computed values with listed ones, and writes the result to standard output.
pub(crate) fn check(arguments: &GlassCheck) -> Outcome {
    let report = report(catalogue(&arguments.own)?.check_listed());
    if arguments.report.json {
        console::pretty_json(&report)?;
    } else {
        console::out(&text(&report))?;
    }
    Ok(DONE)
}

fn report(check: ListedCheck) -> Report {
    let row = |d: &spectra_glass::Deviation| DeviationRow {
        name: d.glass.full_name(),
        listed_nd: d.listed_nd,
        nd: d.nd,
        listed_vd: d.listed_vd,
        vd: d.vd,
    };
    Report {
        listed: check.listed,
        tolerance_nd: LISTED_TOLERANCE_ND,
        tolerance_vd: LISTED_TOLERANCE_VD,
        deviating: check.deviating.iter().map(row).collect(),
    }
}

fn text(report: &Report) -> String {
    let many = report.deviating.len();
    let share = 100.0 * (1.0 - many as f64 / report.listed.max(1) as f64);
    let mut out = format!(
        "{} of {} media ({share:.2} %) have the listed nd within {} and Vd within {}; the others:\n\n",
        report.listed - many,
        report.listed,
        report.tolerance_nd,
        report.tolerance_vd
    );
    let width = report.deviating.iter().map(|row| row.name.len()).max().unwrap_or(0).max(5);
    // Writing to a String cannot fail.
    let _ = writeln!(out, "  {:<width$}  {:>9} {:>9}  {:>8} {:>8}", "glass", "nd listed", "computed", "Vd", "computed");
    for row in &report.deviating {
        let _ = writeln!(
            out,
            "  {:<width$}  {:>9.5} {:>9.5}  {:>8.2} {:>8.2}",
            row.name, row.listed_nd, row.nd, row.listed_vd, row.vd
        );
    }
    out
}
