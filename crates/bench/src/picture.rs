//! Figure of a report: error against samples and against time, in log-log scale.

use crate::report::{Measure, Report, Series};
use crate::statistics::ROUNDING;
use spectra_plot::{Canvas, Color, Rect, Stroke, TextStyle};

const WIDTH: f64 = 1060.0;
const LEFT: f64 = 78.0;
const GAP: f64 = 70.0;
const PANEL_WIDTH: f64 = 440.0;
const PANEL_HEIGHT: f64 = 300.0;
const TOP: f64 = 62.0;
const BETWEEN: f64 = 78.0;
const LEGEND_LINE: f64 = 20.0;
/// Dash patterns: once the colors are used up they repeat with the next pattern, so that all strategies differ.
const DASHES: [&[f64]; 3] = [&[], &[7.0, 4.0], &[2.0, 3.0]];

/// Draws the errors with their 95 % intervals, against samples on the left and against time on the right. The upper row shows the
/// spectral integral (with the kind of numbers that the scene uses), the lower row the rendered scene.
#[must_use]
pub fn picture(report: &Report) -> Canvas {
    let own = report.series.first().map(|s| s.numbers);
    let measures = [Measure::Integral, Measure::Scene];
    let of = |measure: Measure| -> Vec<&Series> {
        report.series.iter().filter(|s| s.measure == measure && Some(s.numbers) == own).collect()
    };
    let panels: Vec<(Measure, Vec<&Series>)> =
        measures.into_iter().map(|m| (m, of(m))).filter(|(_, s)| !s.is_empty()).collect();
    let strategies = panels.first().map_or(0, |(_, s)| s.len());
    let bottom = TOP + panels.len() as f64 * (PANEL_HEIGHT + BETWEEN);
    let height = bottom + (strategies.div_ceil(2)) as f64 * LEGEND_LINE + 8.0;
    let mut canvas = Canvas::new(WIDTH, height, &format!("Error of wavelength strategies: {}", report.scene));
    let channels = report.channels.join(", ");
    let numbers = own.map_or("", |n| n.name());
    canvas.text(
        [LEFT, 26.0],
        &format!("{}: relative RMS error of {channels}; {numbers} numbers", report.scene).replace('_', " "),
        &TextStyle::new(15.0).weight(1.4),
    );
    for (row, (measure, series)) in panels.iter().enumerate() {
        let top = TOP + row as f64 * (PANEL_HEIGHT + BETWEEN);
        let what = match measure {
            Measure::Integral => "Spectral integral alone",
            Measure::Scene => "Scene, all pixels",
        };
        for column in 0..2 {
            let left = LEFT + column as f64 * (PANEL_WIDTH + GAP);
            let frame = Rect::new(left, top, left + PANEL_WIDTH, top + PANEL_HEIGHT);
            let (label, x): (_, fn(&Series, usize) -> f64) = match (column, measure) {
                (0, Measure::Integral) => ("samples", |s, i| f64::from(s.points[i].samples)),
                (0, Measure::Scene) => ("samples per pixel", |s, i| f64::from(s.points[i].samples)),
                (_, Measure::Integral) => ("time / s", |s, i| s.points[i].seconds),
                (_, Measure::Scene) => ("time per frame / s", |s, i| s.points[i].seconds),
            };
            panel(&mut canvas, frame, series, label, x);
            canvas.text([left, top - 8.0], what, &TextStyle::new(13.0));
        }
    }
    if let Some((_, series)) = panels.first() {
        legend(&mut canvas, bottom, series);
    }
    canvas
}

fn stroke(at: usize) -> Stroke {
    let colors = Color::PALETTE.len();
    let line = Stroke::new(Color::PALETTE[at % colors], 1.8);
    match DASHES[(at / colors).min(DASHES.len() - 1)] {
        [] => line.round(),
        dashes => line.dashed(dashes),
    }
}

fn legend(canvas: &mut Canvas, top: f64, series: &[&Series]) {
    let lines = series.len().div_ceil(2);
    for (at, one) in series.iter().enumerate() {
        let x = LEFT + (at / lines) as f64 * (PANEL_WIDTH + GAP);
        let y = top + (at % lines) as f64 * LEGEND_LINE - 6.0;
        canvas.line([x, y - 4.0], [x + 30.0, y - 4.0], &stroke(at));
        canvas.disc([x + 15.0, y - 4.0], 3.2, stroke(at).color);
        let slope = one.slope.map_or("exact".to_owned(), |s| format!("slope {:.2}", s.value));
        canvas.text([x + 38.0, y], &format!("{}, {slope}", one.strategy).replace('_', " "), &TextStyle::new(12.0));
    }
}

/// A logarithmic axis, base 10.
struct Log {
    from: f64,
    to: f64,
}

impl Log {
    /// Creates an axis that contains all values with some margin; `None` without values.
    fn of(values: impl Iterator<Item = f64>) -> Option<Self> {
        let (from, to) = values
            .map(libm::log10)
            .filter(|v| v.is_finite())
            .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), v| (low.min(v), high.max(v)));
        (from <= to).then_some(Self { from: from - 0.12, to: to + 0.12 })
    }

    fn share(&self, value: f64) -> f64 {
        (libm::log10(value) - self.from) / (self.to - self.from)
    }

    /// Iterates over the powers of ten on the axis.
    fn decades(&self) -> impl Iterator<Item = i32> + use<> {
        self.from.ceil() as i32..=self.to.floor() as i32
    }
}

fn panel(canvas: &mut Canvas, frame: Rect, series: &[&Series], label: &str, x: fn(&Series, usize) -> f64) {
    let shown = || series.iter().flat_map(|s| s.points.iter().enumerate().map(move |(i, p)| (s, i, p)));
    let shown = || shown().filter(|(_, _, p)| p.error.value > ROUNDING);
    // Cut an interval that reaches down to 0, because the noise of the reference was subtracted, at the frame.
    let (Some(across), Some(up)) = (
        Log::of(shown().map(|(s, i, _)| x(s, i))),
        Log::of(shown().flat_map(|(_, _, p)| [p.error.low.max(0.5 * p.error.value), p.error.high])),
    ) else {
        let middle = [0.5 * (frame.left + frame.right), 0.5 * (frame.top + frame.bottom)];
        canvas.text(middle, "all exact", &TextStyle::new(14.0).middle());
        canvas.outline(&frame.corners(), &Stroke::new(Color::INK, 1.0));
        return;
    };
    let px = |value: f64| frame.left + across.share(value) * frame.width();
    let py = |value: f64| (frame.bottom - up.share(value) * frame.height()).min(frame.bottom + 50.0);
    grid(canvas, frame, &across, &up, &px, &py);
    canvas.clip(Some(frame));
    for (at, one) in series.iter().enumerate() {
        let line = stroke(at);
        let points: Vec<(usize, _)> = one.points.iter().enumerate().filter(|(_, p)| p.error.value > ROUNDING).collect();
        let places: Vec<[f64; 2]> = points.iter().map(|(i, p)| [px(x(one, *i)), py(p.error.value)]).collect();
        if places.len() > 1 {
            canvas.polyline(&places, &line);
        }
        for ((_, point), [x, y]) in points.iter().zip(&places) {
            let bar = Stroke::new(line.color, 1.1);
            let (low, high) = (py(point.error.low.max(1e-300)), py(point.error.high));
            canvas.line([*x, low], [*x, high], &bar);
            for end in [low, high] {
                canvas.line([x - 3.0, end], [x + 3.0, end], &bar);
            }
            canvas.disc([*x, *y], 2.8, line.color);
        }
    }
    canvas.clip(None);
    canvas.outline(&frame.corners(), &Stroke::new(Color::INK, 1.0));
    let text = TextStyle::new(12.0).middle();
    canvas.text([0.5 * (frame.left + frame.right), frame.bottom + 36.0], label, &text);
    let middle = [frame.left - 50.0, 0.5 * (frame.top + frame.bottom)];
    canvas.text(middle, "relative RMS error", &text.turned_deg(90.0));
}

fn grid(canvas: &mut Canvas, frame: Rect, across: &Log, up: &Log, px: &dyn Fn(f64) -> f64, py: &dyn Fn(f64) -> f64) {
    let pale = Stroke::new(Color::PALE, 1.0);
    let small = TextStyle::new(11.0);
    for decade in across.decades() {
        let x = px(libm::pow(10.0, f64::from(decade)));
        canvas.line([x, frame.top], [x, frame.bottom], &pale);
        canvas.text([x, frame.bottom + 17.0], &format!("10^{{{decade}}}"), &small.clone().middle());
    }
    for decade in up.decades() {
        let y = py(libm::pow(10.0, f64::from(decade)));
        canvas.line([frame.left, y], [frame.right, y], &pale);
        canvas.text([frame.left - 6.0, y + 4.0], &format!("10^{{{decade}}}"), &small.clone().end());
    }
}
