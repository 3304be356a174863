//! The chromaticity diagram.

use super::{SAMPLE, entry, sheet, shortened};
use spectra_color::{RgbSpace, chromaticity as chromaticity_of, to_u8, xyz_of_xy};
use spectra_plot::{Axes, Axis, Canvas, Color, Labels, Paint, Picture, Point, Rect, Stroke, TextStyle, text_width};
use spectra_spectrum::{Emission, Observer};

/// A unit of x is as long as one of y.
const UNIT: f64 = 800.0;
const X: (f64, f64) = (-0.08, 0.8);
const Y: (f64, f64) = (-0.05, 0.9);
/// Where the locus has a direction of its own; beyond, the functions keep their ratios.
const LOCUS_NM: (u32, u32) = (380, 700);
/// Wavelengths that are named along the locus.
const NAMED_NM: [u32; 18] = [460, 470, 480, 490, 500, 510, 520, 530, 540, 550, 560, 570, 580, 590, 600, 610, 620, 650];
/// Temperatures that are marked on the Planckian locus, K.
const MARKED_K: [f64; 5] = [2000.0, 3000.0, 4000.0, 6500.0, 10_000.0];

/// The CIE 1931 diagram: the spectral locus, the gamuts of sRGB, Rec.2020 and ACEScg, the Planckian locus, and points
/// with their names. The colors are as sRGB can show them, each as bright as it can be.
#[must_use]
pub fn chromaticity(points: &[(String, [f64; 2])]) -> Canvas {
    let (left, top) = (76.0, 22.0);
    let frame = Rect::new(left, top, left + UNIT * (X.1 - X.0), top + UNIT * (Y.1 - Y.0));
    let axes = Axes::new(frame, Axis::new("x", X.0, X.1).ticks(9, 2), Axis::new("y", Y.0, Y.1).ticks(9, 2));
    let mut canvas = Canvas::new(frame.right + 22.0, frame.bottom + 62.0, "CIE 1931 chromaticity diagram");
    axes.draw_grid(&mut canvas);
    let locus: Vec<Point> = (LOCUS_NM.0..=LOCUS_NM.1).map(|nm| at_xy(&axes, spectral(nm))).collect();
    canvas.polygon(&locus, Paint::Picture(colors(frame)));
    canvas.outline(&locus, &Stroke::new(Color::INK, 1.5));
    let legend = gamuts(&mut canvas, &axes);
    let mut labels = Labels::new(frame.grown(-3.0));
    labels.keep_clear(legend);
    name_locus(&mut canvas, &axes, &mut labels);
    planckian(&mut canvas, &axes, &mut labels, points);
    draw_points(&mut canvas, &axes, &mut labels, points);
    axes.draw_frame(&mut canvas);
    canvas
}

fn at_xy(axes: &Axes, xy: [f64; 2]) -> Point {
    axes.at(xy[0], xy[1])
}

fn spectral(nm: u32) -> [f64; 2] {
    chromaticity_of(Observer::cie_1931_2deg().at(f64::from(nm))).expect("the observer sees 380 to 700 nm")
}

/// The colors of all chromaticities of the frame.
fn colors(place: Rect) -> Picture {
    let (width_px, height_px) = (176, 190);
    let srgb = RgbSpace::srgb();
    let rgb = (0..width_px * height_px).map(|i| {
        let share = |at: u32, count: u32| (f64::from(at) + 0.5) / f64::from(count);
        let x = X.0 + (X.1 - X.0) * share(i % width_px, width_px);
        let y = Y.1 - (Y.1 - Y.0) * share(i / width_px, height_px);
        // Only the edge of the area reaches y = 0.
        let linear = srgb.from_xyz(xyz_of_xy([x, y.max(0.002)], 1.0)).map(|v| v.max(0.0));
        let brightest = linear.into_iter().fold(1e-9, f64::max);
        srgb.encode(linear.map(|v| v / brightest)).map(to_u8)
    });
    Picture { place, width_px, height_px, rgb: rgb.collect() }
}

/// Ticks and wavelengths along the outer side of the locus.
fn name_locus(canvas: &mut Canvas, axes: &Axes, labels: &mut Labels) {
    let style = TextStyle::new(12.0).middle().halo(Color::WHITE.with_opacity(0.85));
    for nm in (LOCUS_NM.0 + 70..=650).step_by(10) {
        let here = at_xy(axes, spectral(nm));
        let (before, after) = (at_xy(axes, spectral(nm - 2)), at_xy(axes, spectral(nm + 2)));
        let along = [after[0] - before[0], after[1] - before[1]];
        let length = libm::hypot(along[0], along[1]);
        // The locus runs clockwise on the sheet: outside is to its left.
        let out = [along[1] / length, -along[0] / length];
        let off = |distance: f64| [here[0] + out[0] * distance, here[1] + out[1] * distance];
        let named = NAMED_NM.contains(&nm);
        canvas.line(here, off(if named { 7.0 } else { 4.0 }), &Stroke::new(Color::INK, 1.0));
        if named {
            let text = nm.to_string();
            let [x, y] = off(10.0);
            let place = [x + out[0] * 0.5 * text_width(&text, style.size), y + style.half_cap() * (1.0 + out[1])];
            labels.keep_clear(style.bounds(place, &text));
            canvas.text(place, &text, &style);
        }
    }
}

/// The triangles and their legend; returns where that lies.
fn gamuts(canvas: &mut Canvas, axes: &Axes) -> Rect {
    let dashes: [&[f64]; 3] = [&[], &[9.0, 4.0], &[2.5, 3.5]];
    let style = TextStyle::new(13.5);
    let spaces = RgbSpace::all();
    let widest = spaces.iter().map(|s| text_width(s.name, style.size)).fold(0.0, f64::max);
    let right = axes.frame.right - 14.0;
    let left = right - SAMPLE - widest - 24.0;
    let top = axes.frame.top + 14.0;
    let rect = Rect::new(left, top, right, top + 12.0 + 22.0 * spaces.len() as f64);
    sheet(canvas, rect);
    for (i, (space, dashes)) in spaces.iter().zip(dashes).enumerate() {
        let stroke = Stroke::new(Color::INK, 1.5).dashed(dashes);
        canvas.outline(&space.primaries_xy.map(|xy| at_xy(axes, xy)), &stroke);
        entry(canvas, [left + 12.0, top + 21.0 + 22.0 * i as f64], space.name, &stroke, &style);
    }
    rect
}

/// The chromaticities of black bodies.
fn planckian(canvas: &mut Canvas, axes: &Axes, labels: &mut Labels, points: &[(String, [f64; 2])]) {
    let place = |kelvin: f64| {
        let light = Emission::blackbody(kelvin).ok()?;
        Some(at_xy(axes, chromaticity_of(Observer::cie_1931_2deg().xyz(&light))?))
    };
    // Even steps of reciprocal temperature are nearly even steps along it: 40 000 K to 1000 K.
    let line: Vec<Point> = (0..=40).filter_map(|i| place(1e6 / (25.0 + 24.375 * f64::from(i)))).collect();
    canvas.polyline(&line, &Stroke::new(Color::INK, 1.2));
    for (_, xy) in points {
        let [x, y] = at_xy(axes, *xy);
        labels.keep_clear(Rect::new(x - 6.0, y - 6.0, x + 6.0, y + 6.0));
    }
    let style = TextStyle::new(10.5);
    for kelvin in MARKED_K {
        let (Some(here), Some(next)) = (place(kelvin), place(0.99 * kelvin)) else { continue };
        let along = [next[0] - here[0], next[1] - here[1]];
        let length = libm::hypot(along[0], along[1]);
        let across = [-along[1] / length * 5.0, along[0] / length * 5.0];
        let end = |sign: f64| [here[0] + sign * across[0], here[1] + sign * across[1]];
        canvas.line(end(-1.0), end(1.0), &Stroke::new(Color::INK, 1.2));
        let text = format!("{kelvin:.0} K");
        let below = [here[0] + 1.6 * across[0], here[1] + 1.6 * across[1] + 2.0 * style.half_cap()];
        if labels.claim(style.bounds(below, &text)) {
            canvas.text(below, &text, &style);
        }
    }
}

fn draw_points(canvas: &mut Canvas, axes: &Axes, labels: &mut Labels, points: &[(String, [f64; 2])]) {
    let style = TextStyle::new(13.0).weight(1.2).halo(Color::WHITE.with_opacity(0.7));
    for (_, xy) in points {
        let at = at_xy(axes, *xy);
        canvas.disc(at, 5.0, Color::WHITE);
        canvas.circle(at, 5.0, &Stroke::new(Color::INK, 1.6));
        canvas.disc(at, 1.6, Color::INK);
    }
    for (name, xy) in points {
        let name = shortened(name);
        if let Some(place) = labels.place(at_xy(axes, *xy), &name, &style, 10.0) {
            canvas.text(place, &name, &style);
        }
    }
}
