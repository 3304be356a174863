//! Draws a stock in the manner of a maker's data sheet.

use super::info::{points, sensitivity};
use spectra_core::math::log10;
use spectra_core::spectral::BAND;
use spectra_film::print::metered_exposure_lx_s;
use spectra_film::stock::{Layer, Stock};
use spectra_plot::{Axes, Axis, Canvas, Color, Rect, Stroke, TextStyle};

const WIDTH: f64 = 760.0;
const PANEL: f64 = 360.0;
/// Drawing colors of layers with these names.
const COLORS: [(&str, Color); 3] =
    [("red", Color::new(0xc8, 0x2a, 0x2a)), ("green", Color::new(0x1f, 0x8a, 0x3b)), ("blue", Color::BLUE)];

/// Draws the sheet of a stock: sensitivities, then curves, then dyes if the stock has any.
pub(super) fn sheet(stock: &Stock) -> Canvas {
    let dyed = stock.layers.iter().any(|l| l.dye.is_some());
    let panels = if dyed { 3 } else { 2 };
    let mut canvas = Canvas::new(WIDTH, 40.0 + PANEL * f64::from(panels), &format!("Film stock: {}", stock.name));
    canvas.text([84.0, 30.0], &stock.name, &TextStyle::new(18.0).weight(1.35));
    sensitivities(&mut canvas, stock, frame(0));
    curves(&mut canvas, stock, frame(1));
    if dyed {
        dyes(&mut canvas, stock, frame(2));
    }
    canvas
}

fn frame(panel: u32) -> Rect {
    let top = 52.0 + PANEL * f64::from(panel);
    Rect::new(84.0, top, WIDTH - 24.0, top + PANEL - 74.0)
}

fn color(stock: &Stock, i: usize) -> Color {
    if stock.layers.len() == 1 {
        return Color::INK;
    }
    let name = stock.layers[i].name.as_str();
    let known = COLORS.iter().find(|(n, _)| *n == name).map(|(_, c)| *c);
    known.unwrap_or(Color::PALETTE[i % Color::PALETTE.len()])
}

fn name(canvas: &mut Canvas, frame: Rect, row: usize, text: &str, color: Color) {
    let y = frame.top + 20.0 + 19.0 * row as f64;
    canvas.line([frame.left + 12.0, y - 5.0], [frame.left + 36.0, y - 5.0], &Stroke::new(color, 2.0));
    canvas.text([frame.left + 44.0, y], text, &TextStyle::new(13.0));
}

fn sensitivities(canvas: &mut Canvas, stock: &Stock, frame: Rect) {
    let tables: Vec<Vec<[f64; 2]>> = stock.layers.iter().map(|l| sensitivity(l, 1)).collect();
    let lowest = tables.iter().flatten().map(|p| p[1]).fold(-1.0, f64::min).max(-4.0);
    let x = Axis::new("wavelength / nm", BAND.start_nm, BAND.end_nm()).ticks(10, 5);
    let axes = Axes::new(frame, x, Axis::new("log10 relative sensitivity", lowest - 0.15, 0.35).ticks(6, 2));
    axes.draw_grid(canvas);
    canvas.clip(Some(frame));
    for (i, table) in tables.iter().enumerate() {
        let line: Vec<_> = table.iter().map(|[w, s]| axes.at(*w, *s)).collect();
        canvas.polyline(&line, &Stroke::new(color(stock, i), 1.8));
    }
    canvas.clip(None);
    axes.draw_frame(canvas);
    let right = Rect::new(frame.right - 190.0, frame.top, frame.right, frame.bottom);
    for (i, layer) in stock.layers.iter().enumerate() {
        let assumed = if layer.assumed { " (assumed)" } else { "" };
        name(canvas, right, i, &format!("{}{assumed}", layer.name), color(stock, i));
    }
}

fn curves(canvas: &mut Canvas, stock: &Stock, frame: Rect) {
    // All layers of a color film share one development, so each has one curve. Silver film has one curve per development.
    let all: Vec<(String, Color, Vec<[f64; 2]>)> = if let [layer] = &stock.layers[..] {
        let one = |(i, d): (usize, &spectra_film::stock::Development)| {
            let assumed = if d.assumed { " (assumed)" } else { "" };
            (format!("{}{assumed}", d.name), Color::PALETTE[i % Color::PALETTE.len()], points(&d.curve, 0.02))
        };
        layer.developments.iter().enumerate().map(one).collect()
    } else {
        let one = |(i, l): (usize, &Layer)| (l.name.clone(), color(stock, i), points(&l.developments[0].curve, 0.02));
        stock.layers.iter().enumerate().map(one).collect()
    };
    let xs = || all.iter().flat_map(|(.., p)| p.iter().map(|p| p[0]));
    let (low, high) = (xs().fold(f64::INFINITY, f64::min), xs().fold(f64::NEG_INFINITY, f64::max));
    let top = all.iter().flat_map(|(.., p)| p.iter().map(|p| p[1])).fold(0.5, f64::max);
    let label = format!("density ({})", stock.densitometry.name());
    let x = Axis::new("log10 exposure / lx s", low, high).ticks(8, 5);
    let axes = Axes::new(frame, x, Axis::new(&label, 0.0, 1.06 * top).ticks(6, 2));
    axes.draw_grid(canvas);
    if let Some(iso) = stock.iso {
        let [x, _] = axes.at(log10(metered_exposure_lx_s(iso)), 0.0);
        canvas.line([x, frame.top], [x, frame.bottom], &Stroke::new(Color::GREY, 1.2));
        canvas.text([x + 6.0, frame.bottom - 8.0], "mid gray", &TextStyle::new(12.0));
    }
    for (_, color, table) in &all {
        let line: Vec<_> = table.iter().map(|[x, d]| axes.at(*x, *d)).collect();
        canvas.polyline(&line, &Stroke::new(*color, 1.8));
    }
    axes.draw_frame(canvas);
    // The curves of a reversal film fall, so its names go to the right, where the plot is empty.
    let falling = all.iter().any(|(.., p)| p.first().map(|p| p[1]) > p.last().map(|p| p[1]));
    let corner = if falling { Rect::new(frame.right - 190.0, frame.top, frame.right, frame.bottom) } else { frame };
    for (i, (text, color, _)) in all.iter().enumerate() {
        name(canvas, corner, i, text, *color);
    }
}

fn dyes(canvas: &mut Canvas, stock: &Stock, frame: Rect) {
    let grid = |f: &dyn Fn(f64) -> f64| -> Vec<[f64; 2]> { BAND.wavelengths_nm().map(|w| [w, f(w)]).collect() };
    let mut all: Vec<(String, Color, Vec<[f64; 2]>)> = Vec::new();
    for (i, dye) in stock.layers.iter().enumerate().filter_map(|(i, l)| l.dye.as_ref().map(|d| (i, d))) {
        all.push((dye.name.clone(), color(stock, i), grid(&|w| dye.density.at(w))));
    }
    if let Some(minimum) = &stock.minimum_density {
        let assumed = if minimum.assumed { " (assumed)" } else { "" };
        all.push((format!("minimum density{assumed}"), Color::INK, grid(&|w| minimum.density.at(w))));
    }
    let top = all.iter().flat_map(|(.., p)| p.iter().map(|p| p[1])).fold(0.5, f64::max);
    let x = Axis::new("wavelength / nm", BAND.start_nm, BAND.end_nm()).ticks(10, 5);
    let axes = Axes::new(frame, x, Axis::new("density of a unit of dye", 0.0, 1.55 * top).ticks(6, 2));
    axes.draw_grid(canvas);
    canvas.clip(Some(frame));
    for (_, color, table) in &all {
        let line: Vec<_> = table.iter().map(|[x, d]| axes.at(*x, *d)).collect();
        canvas.polyline(&line, &Stroke::new(*color, 1.8));
    }
    canvas.clip(None);
    axes.draw_frame(canvas);
    let right = Rect::new(frame.right - 220.0, frame.top, frame.right, frame.bottom);
    for (i, (text, color, _)) in all.iter().enumerate() {
        name(canvas, right, i, text, *color);
    }
}
