//! Figure of fitted dispersion formulas with the data that they were fitted to.

use spectra_plot::legend::{entry, entry_disc, palette, rows, shortened};
use spectra_plot::{Axes, Axis, Canvas, Color, Rect, Stroke, TextStyle};

const WIDTH: f64 = 900.0;
const HEIGHT: f64 = 700.0;
/// Lower edge of the index plot; the deviations are plotted below it.
const MIDDLE: f64 = 430.0;

/// A dispersion formula fitted to measured indices.
#[derive(Clone, Debug, PartialEq)]
pub struct FittedCurve {
    /// Name for the legend.
    pub name: String,
    /// Points of the curve: wavelength (nm) and index.
    pub points: Vec<[f64; 2]>,
    /// Index of the formula minus the measured index, for each measured point in order.
    pub deviations: Vec<f64>,
}

/// Draws the measured indices (wavelength in nm, n) as points, and dispersion formulas as curves through them. A second plot
/// below shows the deviation of each formula at each measured point.
#[must_use]
pub fn glass_fit(title: &str, measured: &[[f64; 2]], curves: &[FittedCurve]) -> Canvas {
    let mut canvas = Canvas::new(WIDTH, HEIGHT, title);
    let style = TextStyle::new(14.0);
    canvas.text([92.0, 26.0], title, &style.clone().weight(1.3));
    let mut names = vec!["rows".to_owned()];
    names.extend(curves.iter().map(|curve| shortened(&curve.name)));
    let (places, lines) = rows(&names, [92.0, 50.0], WIDTH - 24.0, &style);
    let ends = |values: &mut dyn Iterator<Item = f64>| {
        let range =
            values.filter(|v| v.is_finite()).fold([f64::INFINITY, f64::NEG_INFINITY], |[a, b], v| [a.min(v), b.max(v)]);
        if range[0] <= range[1] { range } else { [0.0, 1.0] }
    };
    let widened = |[low, high]: [f64; 2], least: f64| {
        let margin = (0.06 * (high - low)).max(least);
        (low - margin, high + margin)
    };
    let drawn = || curves.iter().flat_map(|curve| curve.points.iter());
    let nm = widened(ends(&mut measured.iter().map(|p| p[0])), 1.0);
    let n = widened(ends(&mut measured.iter().chain(drawn()).map(|p| p[1])), 1e-5);
    let top = Axes::new(
        Rect::new(92.0, 44.0 + 22.4 * lines as f64, WIDTH - 24.0, MIDDLE),
        Axis::new("wavelength / nm", nm.0, nm.1).ticks(10, 5),
        Axis::new("refractive index", n.0, n.1).ticks(6, 2),
    );
    top.draw_grid(&mut canvas);
    canvas.clip(Some(top.frame));
    for (i, curve) in curves.iter().enumerate() {
        let run: Vec<_> = curve.points.iter().map(|p| top.at(p[0], p[1])).collect();
        canvas.polyline(&run, &Stroke::new(palette(i), 1.9));
    }
    for [nm, n] in measured {
        canvas.disc(top.at(*nm, *n), 4.0, Color::INK);
    }
    canvas.clip(None);
    top.draw_frame(&mut canvas);

    // Deviations are small parts of the index, so the axis label states one common power of ten for them.
    let largest =
        curves.iter().flat_map(|c| &c.deviations).filter(|d| d.is_finite()).fold(0.0_f64, |a, d| a.max(d.abs()));
    let power = if largest > 0.0 { libm::floor(libm::log10(largest)) as i32 } else { 0 };
    let unit = libm::pow(10.0, f64::from(power));
    let end = if largest > 0.0 { 1.15 * largest / unit } else { 1.0 };
    let label = match power {
        0 => "formula minus row".to_owned(),
        _ => format!("formula minus row / 10^{{{}}}", power.to_string().replace('-', "\u{2212}")),
    };
    let low = Axes::new(
        Rect::new(92.0, MIDDLE + 66.0, WIDTH - 24.0, HEIGHT - 66.0),
        Axis::new("wavelength / nm", nm.0, nm.1).ticks(10, 5),
        Axis::new(&label, -end, end).ticks(4, 2),
    );
    low.draw_grid(&mut canvas);
    canvas.line(low.at(nm.0, 0.0), low.at(nm.1, 0.0), &Stroke::new(Color::INK, 0.8));
    for (i, curve) in curves.iter().enumerate() {
        for ([nm, _], deviation) in measured.iter().zip(&curve.deviations).filter(|(_, d)| d.is_finite()) {
            let at = low.at(*nm, deviation / unit);
            canvas.line(low.at(*nm, 0.0), at, &Stroke::new(palette(i).with_opacity(0.5), 1.2));
            canvas.disc(at, 3.5, palette(i));
        }
    }
    low.draw_frame(&mut canvas);
    entry_disc(&mut canvas, places[0], &names[0], Color::INK, &style);
    for (i, (name, at)) in names.iter().zip(places).enumerate().skip(1) {
        entry(&mut canvas, at, name, &Stroke::new(palette(i - 1), 2.4), &style);
    }
    canvas
}
