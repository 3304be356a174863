//! Curves over a common axis.

use serde_json::{Map, Value, json};
use spectra_plot::legend::{entry, order, palette, rows, stroke};
use spectra_plot::{Axes, Axis, Canvas, Rect, TextStyle};

const WIDTH: f64 = 900.0;
const HEIGHT: f64 = 500.0;
/// Smallest value of a logarithmic scale, relative to the largest.
const DEEPEST: f64 = 1e-6;

/// Curves in a frame with two axes.
#[derive(Clone, Debug, PartialEq)]
pub struct Chart {
    pub(crate) key: String,
    title: String,
    /// Quantity and unit along the horizontal axis.
    x: String,
    is_log: bool,
    labels: Vec<String>,
    curves: Vec<Vec<[f64; 2]>>,
}

impl Chart {
    /// Creates a chart without curves. `key` names it in JSON; `x` is the quantity and unit of the horizontal axis, such as
    /// `wavelength / nm`.
    #[must_use]
    pub fn new(key: &str, title: &str, x: &str) -> Self {
        let [key, title, x] = [key, title, x].map(str::to_owned);
        Self { key, title, x, is_log: false, labels: Vec::new(), curves: Vec::new() }
    }

    /// Sets whether values are shown as their decimal logarithms, down to a millionth of the largest value. Values that are not
    /// above 0 then interrupt their curve.
    #[must_use]
    pub fn logarithmic(self, is_log: bool) -> Self {
        Self { is_log, ..self }
    }

    /// Adds a curve through points `[x, value]`. The label is the quantity with its unit (`X / lx s`). A value that is not finite interrupts
    /// the curve.
    pub fn push(&mut self, label: &str, points: impl IntoIterator<Item = [f64; 2]>) {
        self.labels.push(label.to_owned());
        self.curves.push(points.into_iter().collect());
    }

    /// Title of the chart.
    #[must_use]
    pub fn title(&self) -> &str {
        &self.title
    }

    /// Returns the points of each curve by its label.
    pub(crate) fn to_json(&self) -> Value {
        self.labels.iter().cloned().zip(self.curves.iter().map(|points| json!(points))).collect::<Map<_, _>>().into()
    }

    /// Returns a value as the scale shows it; `None` if it cannot.
    fn shown(&self, value: f64) -> Option<f64> {
        match value {
            v if !v.is_finite() => None,
            v if self.is_log => (v > 0.0).then(|| libm::log10(v)),
            v => Some(v),
        }
    }

    /// Draws the chart, with a legend if it has several curves. Returns `None` if no point can be shown.
    #[must_use]
    pub fn canvas(&self) -> Option<Canvas> {
        let all = || self.curves.iter().flatten().filter_map(|[_, value]| self.shown(*value));
        let most = all().reduce(f64::max)?;
        let least = all().reduce(f64::min)?;
        let (low, high) =
            if self.is_log { (least.max(most + libm::log10(DEEPEST)), most) } else { (least.min(0.0), most) };
        let span = if high > low { high - low } else { high.abs().max(1.0) };
        let low = if low == 0.0 { 0.0 } else { low - 0.04 * span };
        let mut canvas = Canvas::new(WIDTH, HEIGHT, &self.title);
        let style = TextStyle::new(14.0);
        canvas.text([92.0, 26.0], &self.title, &style.clone().weight(1.3));
        let several = self.labels.len() > 1;
        let (places, lines) = rows(&self.labels, [92.0, 50.0], WIDTH - 24.0, &style);
        let top = if several { 44.0 + 22.4 * lines as f64 } else { 42.0 };
        let frame = Rect::new(92.0, top, WIDTH - 24.0, HEIGHT - 66.0);
        let x = || self.curves.iter().flatten().map(|[x, _]| *x);
        let start = x().fold(0.0, f64::min);
        let end = x().fold(start + f64::MIN_POSITIVE, f64::max);
        let vertical = Axis::new(&self.quantity(), low, high + 0.05 * span).ticks(6, 2);
        let axes = Axes::new(frame, Axis::new(&self.x, start, end), vertical);
        axes.draw_grid(&mut canvas);
        canvas.clip(Some(frame));
        let order = order(&self.labels);
        for (i, points) in order.iter().zip(&self.curves) {
            let points: Vec<_> = points.iter().map(|[x, v]| self.shown(*v).map(|v| axes.at(*x, v))).collect();
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
            for (i, (label, at)) in order.iter().zip(self.labels.iter().zip(places)) {
                entry(&mut canvas, at, label, &stroke(*i, 2.4), &style);
            }
        }
        Some(canvas)
    }

    /// Returns the label of the vertical axis: the only curve's, or the unit that all labels end with.
    fn quantity(&self) -> String {
        let unit = |label: &String| label.rsplit_once(" / ").map(|(_, unit)| unit.to_owned());
        let quantity = match self.labels.as_slice() {
            [only] => only.clone(),
            all => match all.first().and_then(unit) {
                Some(first) if all.iter().all(|label| unit(label).as_ref() == Some(&first)) => {
                    format!("value / {first}")
                }
                _ => "value".to_owned(),
            },
        };
        if self.is_log { format!("log_{{10}} ({quantity})") } else { quantity }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_axis_has_the_unit_that_all_curves_share() {
        let mut chart = Chart::new("cut", "a cut", "distance / mm");
        assert!(chart.canvas().is_none(), "nothing to draw");
        chart.push("X / lx", [[0.0, 1.0], [1.0, f64::NAN], [2.0, 3.0]]);
        assert_eq!(chart.quantity(), "X / lx");
        chart.push("Y / lx", [[0.0, 2.0], [1.0, 2.0], [2.0, 4.0]]);
        assert_eq!(chart.quantity(), "value / lx");
        let svg = chart.canvas().expect("two curves").to_svg();
        assert!(svg.contains("<svg") && svg.contains("a cut"));
        assert_eq!(
            chart.to_json().to_string(),
            r#"{"X / lx":[[0.0,1.0],[1.0,null],[2.0,3.0]],"Y / lx":[[0.0,2.0],[1.0,2.0],[2.0,4.0]]}"#
        );
        chart.push("hue / deg", [[0.0, 0.0]]);
        assert_eq!(chart.logarithmic(true).quantity(), "log_{10} (value)");
    }
}
