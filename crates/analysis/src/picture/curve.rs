//! Figure of a cut through a picture.

use super::cut::Cut;
use super::measured::NotMeasured;
use crate::figure::{entry, order, palette, rows, stroke};
use spectra_plot::{Axes, Axis, Canvas, Rect, TextStyle};

const WIDTH: f64 = 900.0;
const HEIGHT: f64 = 500.0;
/// Smallest value of a logarithmic scale, relative to the largest.
const DEEPEST: f64 = 1e-6;

/// Draws the curves of a cut against millimeters on the film if known, else against pixels. With `is_log` the scale is logarithmic.
///
/// # Errors
/// No value along the cut is defined, or none is above 0 on a logarithmic scale.
pub fn curve(cut: &Cut, is_log: bool, title: &str) -> Result<Canvas, NotMeasured> {
    let shown = |value: f64| match value {
        v if !v.is_finite() => None,
        v if is_log => (v > 0.0).then(|| libm::log10(v)),
        v => Some(v),
    };
    let all: Vec<f64> = cut.values.iter().flatten().filter_map(|v| shown(*v)).collect();
    let most = all.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    if all.is_empty() {
        let (text, hint) = if is_log {
            ("no value along the cut is above 0, so a logarithmic scale shows nothing", "leave `--log` out")
        } else {
            ("no value is defined along the cut", "choose another line or another `--quantity`")
        };
        return Err(NotMeasured::new(text, hint));
    }
    let least = all.iter().copied().fold(f64::INFINITY, f64::min);
    let (low, high) = if is_log { (least.max(most + libm::log10(DEEPEST)), most) } else { (least.min(0.0), most) };
    let span = if high > low { high - low } else { high.abs().max(1.0) };
    let low = if low == 0.0 { 0.0 } else { low - 0.04 * span };
    let (x, name) = match &cut.distance_mm {
        Some(mm) => (mm, "distance on the film / mm"),
        None => (&cut.distance_px, "distance / px"),
    };
    let mut canvas = Canvas::new(WIDTH, HEIGHT, title);
    let style = TextStyle::new(14.0);
    canvas.text([92.0, 26.0], title, &style.clone().weight(1.3));
    let several = cut.labels.len() > 1;
    let (places, lines) = rows(&cut.labels, [92.0, 50.0], WIDTH - 24.0, &style);
    let top = if several { 44.0 + 22.4 * lines as f64 } else { 42.0 };
    let frame = Rect::new(92.0, top, WIDTH - 24.0, HEIGHT - 66.0);
    let quantity = match cut.labels.as_slice() {
        [only] => only.clone(),
        all => in_one_unit(all).map_or_else(|| "value".to_owned(), |unit| format!("value / {unit}")),
    };
    let quantity = if is_log { format!("log_{{10}} ({quantity})") } else { quantity };
    let end = x.last().copied().unwrap_or(0.0).max(f64::MIN_POSITIVE);
    let axes = Axes::new(frame, Axis::new(name, 0.0, end), Axis::new(&quantity, low, high + 0.05 * span).ticks(6, 2));
    axes.draw_grid(&mut canvas);
    canvas.clip(Some(frame));
    let order = order(&cut.labels);
    for (i, values) in order.iter().zip(&cut.values) {
        // Undefined values interrupt the line.
        let points: Vec<_> = x.iter().zip(values).map(|(x, v)| shown(*v).map(|v| axes.at(*x, v))).collect();
        for run in points.split(Option::is_none).filter(|run| !run.is_empty()) {
            let run: Vec<_> = run.iter().flatten().copied().collect();
            if let [alone] = run[..] {
                canvas.disc(alone, 1.5, palette(*i));
            }
            canvas.polyline(&run, &stroke(*i, 1.7));
        }
    }
    canvas.clip(None);
    axes.draw_frame(&mut canvas);
    if several {
        for (i, (label, at)) in order.iter().zip(cut.labels.iter().zip(places)) {
            entry(&mut canvas, at, label, &stroke(*i, 2.4), &style);
        }
    }
    Ok(canvas)
}

/// Returns the unit that all labels end with; `None` if they differ.
fn in_one_unit(labels: &[String]) -> Option<&str> {
    let (_, first) = labels.first()?.rsplit_once(" / ")?;
    let ends = |label: &String| label.rsplit_once(" / ").is_some_and(|(_, unit)| unit == first);
    labels.iter().all(ends).then_some(first)
}
