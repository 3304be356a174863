//! Reports as tables for a terminal.

use crate::report::{Interval, Measure, Report, Series};
use crate::statistics::ROUNDING;

/// Formats a report as tables of relative RMS errors: one table for each measure and kind of numbers, one row for each strategy.
#[must_use]
pub fn table(report: &Report) -> String {
    let mut text = format!(
        "{}: {}\nthrough {}, {} channels ({}), {} x {} pixels, {}; intervals: {}\n",
        report.scene,
        report.source,
        report.lens,
        report.channels.len(),
        report.channels.join(", "),
        report.width_px,
        report.height_px,
        report.direction,
        report.intervals,
    );
    let mut rest: &[Series] = &report.series;
    while let Some(first) = rest.first() {
        let many = rest.iter().take_while(|s| (s.measure, s.numbers) == (first.measure, first.numbers)).count();
        let (now, later) = rest.split_at(many);
        let what = match first.measure {
            Measure::Integral => "spectral integral alone".to_owned(),
            Measure::Scene => report.reference.as_ref().map_or("scene".to_owned(), |r| {
                format!(
                    "scene, against {} x {} samples by {} (error {:.1e})",
                    r.renders, r.samples, r.strategy, r.error
                )
            }),
        };
        text.push_str(&format!("\n{what}; {} numbers, {} seeds\n", first.numbers.name(), first.seeds));
        text.push_str(&rows(now));
        rest = later;
    }
    for left in &report.left_out {
        text.push_str(&format!("\nleft out: {}: {}\n", left.strategy, left.reason));
    }
    text
}

fn rows(series: &[Series]) -> String {
    let mut head = vec!["relative RMS error".to_owned()];
    head.extend(series[0].points.iter().map(|p| format!("{}", p.samples)));
    head.extend(["95 %", "slope", "ns/sample", "= samples", "= time", "bias/se"].map(str::to_owned));
    let colors = series.iter().any(|s| s.points.iter().any(|p| p.ciede2000.is_some()));
    if colors {
        head.push("CIEDE2000".to_owned());
    }
    let mut rows = vec![head];
    for one in series {
        let last = &one.points[one.points.len() - 1];
        let mut row = vec![one.strategy.clone()];
        row.extend(one.points.iter().map(|p| error(p.error.value)));
        row.push(within(last.error));
        row.push(one.slope.map_or("-".to_owned(), |s| format!("{:.2} [{:.2}, {:.2}]", s.value, s.low, s.high)));
        row.push(format!("{:.1}", one.ns_a_sample));
        row.push(ratio(one.ratio_at_equal_samples));
        row.push(ratio(one.ratio_at_equal_time));
        row.push(format!("{:.1}", one.largest_bias()));
        if colors {
            row.push(last.ciede2000.map_or("-".to_owned(), |d| format!("{d:.2e}")));
        }
        rows.push(row);
    }
    aligned(&rows)
}

fn error(value: f64) -> String {
    if value > ROUNDING { format!("{value:.2e}") } else { "exact".to_owned() }
}

/// Formats an interval relative to its value: `-4 +5 %`.
fn within(error: Interval) -> String {
    if error.value > ROUNDING {
        let percent = |end: f64| 100.0 * (end / error.value - 1.0);
        format!("{:+.0} {:+.0} %", percent(error.low), percent(error.high))
    } else {
        "-".to_owned()
    }
}

fn ratio(value: Option<f64>) -> String {
    match value {
        Some(r) if r >= 99.5 => format!("{r:.0}"),
        Some(r) if r >= 9.95 => format!("{r:.1}"),
        Some(r) => format!("{r:.2}"),
        None => "-".to_owned(),
    }
}

/// Aligns the columns; the first one to the left, the others to the right.
fn aligned(rows: &[Vec<String>]) -> String {
    let width = |column: usize| rows.iter().map(|row| row[column].chars().count()).max().unwrap_or(0);
    let widths: Vec<usize> = (0..rows[0].len()).map(width).collect();
    let mut text = String::new();
    for row in rows {
        let mut line = format!("  {:<1$}", row[0], widths[0]);
        for (cell, width) in row.iter().zip(&widths).skip(1) {
            line.push_str(&format!("  {cell:>width$}"));
        }
        text.push_str(line.trim_end());
        text.push('\n');
    }
    text
}
