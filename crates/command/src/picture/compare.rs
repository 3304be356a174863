//! `spectra picture compare`: compares two pictures.

use super::arguments::PictureCompare;
use super::{load, not_written, percent, refuse, significant, stem};
use crate::console;
use crate::folder::apart;
use crate::outcome::{DONE, Outcome};
use serde::Serialize;
use spectra_analysis::picture::{self, Differs, NotMeasured, Scale, view};
use spectra_core::params::Fault;
use spectra_plot::Format;
use std::fmt::Write as _;

/// Statistics of CIEDE2000 between two pictures.
#[derive(Debug, Serialize)]
struct DeltaE {
    mean: f64,
    median: f64,
    percentile_95: f64,
    maximum: f64,
    /// Column and row of the maximum.
    maximum_at: [u32; 2],
    /// White of both pictures, as text.
    white: Option<String>,
}

/// Result of comparing two pictures.
#[derive(Debug, Serialize)]
struct Report {
    first: String,
    second: String,
    delta_e_2000: Option<DeltaE>,
    channels: Vec<Differs>,
}

/// Compares two pictures and writes the result to standard output, and a map of CIEDE2000 if requested.
pub(super) fn compare(arguments: &PictureCompare) -> Outcome {
    let [first_path, second_path] = [&arguments.first, &arguments.second];
    if let Some(output) = &arguments.output {
        Format::of(output).map_err(not_written)?;
        apart(output, &[first_path, second_path])?;
    }
    let (first, second) = (load(first_path)?, load(second_path)?);
    let between = |error: NotMeasured| {
        let text = format!("{}, {}: {}", first_path.display(), second_path.display(), error.text);
        Fault::new(text).hint(error.hint)
    };
    let difference = picture::compare(&first, &second, arguments.white.white).map_err(between)?;
    if let Some(output) = &arguments.output {
        let Some(field) = difference.field() else {
            let colorless = if first.colors.is_none() { (&first, first_path) } else { (&second, second_path) };
            return Err(refuse(colorless.1, colorless.0.without_colors()));
        };
        let title = format!("{} and {}", stem(first_path), stem(second_path));
        let canvas = view(&first, &field, Scale::default(), &title).map_err(between)?;
        canvas.write(output).map_err(not_written)?;
        console::note(&format!("wrote {}", output.display()));
    }
    let delta_e = difference.delta_e_figures(first.planes.width);
    let report = Report {
        first: first_path.display().to_string(),
        second: second_path.display().to_string(),
        delta_e_2000: delta_e.map(|([mean, median, percentile_95, maximum], maximum_at)| DeltaE {
            mean,
            median,
            percentile_95,
            maximum,
            maximum_at,
            white: difference.white.clone(),
        }),
        channels: difference.channels,
    };
    if arguments.report.json {
        console::pretty_json(&report)?;
    } else {
        console::out(&text(&report))?;
    }
    Ok(DONE)
}

/// Largest number of channels that are shown one by one.
const MOST_CHANNELS: usize = 12;

/// Formats the report as text.
fn text(report: &Report) -> String {
    let mut out = format!("{} and {}\n\n", report.first, report.second);
    if let Some(e) = &report.delta_e_2000 {
        let [column, row] = e.maximum_at;
        // Writing to a String cannot fail.
        let _ = writeln!(
            out,
            "  CIEDE2000  mean {:.4}, median {:.4}, 95 % below {:.4}, largest {:.4} at column {column}, row {row}",
            e.mean, e.median, e.percentile_95, e.maximum
        );
        let _ = writeln!(out, "             {}\n", e.white.as_deref().unwrap_or_default());
    }
    let width = report.channels.iter().take(MOST_CHANNELS).map(|c| c.name.chars().count()).fold(7, usize::max);
    let _ = writeln!(
        out,
        "  {:<width$}  {:>12}  {:>12}  {:>10}  {:>10}  {:>10}  {:>10}  {:>14}",
        "channel", "mean 1", "mean 2", "difference", "+-", "RMS", "noise", "blocks > 3 se"
    );
    let share = |value: Option<f64>| value.map_or_else(|| "-".to_owned(), |v| format!("{:.3} %", 100.0 * v));
    for c in report.channels.iter().take(MOST_CHANNELS) {
        let [one, two] = c.means.map(significant);
        let row = format!(
            "  {:<width$}  {one:>12}  {two:>12}  {:>10}  {:>10}  {:>10}  {:>10}  {:>14}  {}",
            c.name,
            share(c.relative_mean),
            share(c.relative_standard_error),
            share(c.relative_rms),
            share(c.relative_noise),
            c.blocks_beyond_3.map_or_else(|| "-".to_owned(), percent),
            c.unit
        );
        let _ = writeln!(out, "{}", row.trim_end());
    }
    if report.channels.len() > MOST_CHANNELS {
        let _ = writeln!(out, "  ... {} channels in all (--json shows each)", report.channels.len());
    }
    out
}
