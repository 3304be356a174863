//! The chromaticity diagram with locus, gamuts and named points.

use super::sheet as paper;
use spectra_color::{RgbSpace, chromaticity as chromaticity_of, to_u8, uv_1976, xyz_of_xy};
use spectra_plot::legend::{SAMPLE, entry, shortened};
use spectra_plot::{Axes, Axis, Canvas, Color, Labels, Paint, Picture, Point, Rect, Stroke, TextStyle, text_width};
use spectra_spectrum::{Emission, Observer};

/// Range of the drawn locus, nm. Beyond it the color matching functions keep their ratios, so the locus has no direction.
const LOCUS_NM: (u32, u32) = (380, 700);
/// Wavelengths labeled along the locus, nm.
const NAMED_NM: [u32; 18] = [460, 470, 480, 490, 500, 510, 520, 530, 540, 550, 560, 570, 580, 590, 600, 610, 620, 650];
/// Temperatures marked on the Planckian locus, K.
const MARKED_K: [f64; 5] = [2000.0, 3000.0, 4000.0, 6500.0, 10_000.0];

/// The coordinates of a chromaticity diagram.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Diagram {
    /// CIE 1931 x, y.
    Xy,
    /// CIE 1976 u', v', in which equal distances look more nearly equal.
    Uv,
}

impl Diagram {
    fn of_xy(self, [x, y]: [f64; 2]) -> [f64; 2] {
        match self {
            Self::Xy => [x, y],
            Self::Uv => uv_1976([x, y]),
        }
    }

    fn to_xy(self, [u, v]: [f64; 2]) -> [f64; 2] {
        match self {
            Self::Xy => [u, v],
            Self::Uv => {
                let divisor = 6.0 * u - 16.0 * v + 12.0;
                [9.0 * u / divisor, 4.0 * v / divisor]
            }
        }
    }

    /// Ranges shown across and up, and the number of canvas units per unit of coordinate.
    fn extent(self) -> ((f64, f64), (f64, f64), f64) {
        match self {
            Self::Xy => ((-0.08, 0.8), (-0.05, 0.9), 800.0),
            Self::Uv => ((-0.05, 0.68), (-0.03, 0.63), 1080.0),
        }
    }
}

/// A diagram for an observer, with the axes of its frame.
struct Sheet<'a> {
    axes: Axes,
    diagram: Diagram,
    observer: &'a Observer,
}

impl Sheet<'_> {
    fn at_xy(&self, xy: [f64; 2]) -> Point {
        let [across, up] = self.diagram.of_xy(xy);
        self.axes.at(across, up)
    }

    fn spectral(&self, nm: u32) -> [f64; 2] {
        chromaticity_of(self.observer.at(f64::from(nm))).expect("the observer sees 390 to 700 nm")
    }
}

/// Draws the CIE 1931 diagram: the spectral locus, the gamuts of sRGB, Rec.2020 and ACEScg, the Planckian locus, and named points (x, y).
/// The colors are as sRGB can show them, each at its largest brightness.
#[must_use]
pub fn chromaticity(points: &[(String, [f64; 2])]) -> Canvas {
    chromaticity_diagram(points, Diagram::Xy, Observer::cie_1931_2deg())
}

/// Draws a chromaticity diagram with the coordinates `diagram` for any observer. `points` are names with the x, y that `observer`
/// sees. The gamuts are defined for the 1931 observer and shown only for it.
#[must_use]
pub fn chromaticity_diagram(points: &[(String, [f64; 2])], diagram: Diagram, observer: &Observer) -> Canvas {
    let (left, top) = (76.0, 22.0);
    let (across, up, unit) = diagram.extent();
    let frame = Rect::new(left, top, left + unit * (across.1 - across.0), top + unit * (up.1 - up.0));
    let (x, y) = match diagram {
        Diagram::Xy => ("x", "y"),
        Diagram::Uv => ("u'", "v'"),
    };
    let (x, y) = (Axis::new(x, across.0, across.1).ticks(9, 2), Axis::new(y, up.0, up.1).ticks(9, 2));
    let sheet = Sheet { axes: Axes::new(frame, x, y), diagram, observer };
    let standard = Observer::cie_1931_2deg();
    let title = match diagram {
        Diagram::Xy if observer.name() == standard.name() => "CIE 1931 chromaticity diagram".to_owned(),
        Diagram::Xy => format!("Chromaticity diagram, {}", observer.name()),
        Diagram::Uv => format!("CIE 1976 chromaticity diagram, {}", observer.name()),
    };
    let mut canvas = Canvas::new(frame.right + 22.0, frame.bottom + 62.0, &title);
    sheet.axes.draw_grid(&mut canvas);
    // The tables of some observers begin at 390 nm.
    let first = LOCUS_NM.0.max((LOCUS_NM.0..400).find(|nm| observer.at(f64::from(*nm)) != [0.0; 3]).unwrap_or(400));
    let locus: Vec<Point> = (first..=LOCUS_NM.1).map(|nm| sheet.at_xy(sheet.spectral(nm))).collect();
    canvas.polygon(&locus, Paint::Picture(colors(frame, diagram)));
    canvas.outline(&locus, &Stroke::new(Color::INK, 1.5));
    let mut labels = Labels::new(frame.grown(-3.0));
    // Keep labels off the locus.
    for [x, y] in &locus {
        labels.keep_clear(Rect::new(x - 1.0, y - 1.0, x + 1.0, y + 1.0));
    }
    let style = TextStyle::new(13.5).end();
    // Put text where the locus leaves room: at the top for x, y, at the bottom for u', v'.
    let top = match diagram {
        Diagram::Xy => frame.top,
        Diagram::Uv => frame.bottom - 128.0,
    };
    let corner = [frame.right - 16.0, top + 26.0];
    canvas.text(corner, observer.name(), &style);
    labels.keep_clear(style.bounds(corner, observer.name()));
    if observer.name() == standard.name() {
        let legend = gamuts(&mut canvas, &sheet, top + 38.0);
        labels.keep_clear(legend);
    }
    name_locus(&mut canvas, &sheet, &mut labels);
    planckian(&mut canvas, &sheet, &mut labels, points);
    draw_points(&mut canvas, &sheet, &mut labels, points);
    sheet.axes.draw_frame(&mut canvas);
    canvas
}

/// Returns the colors of all chromaticities in the frame.
fn colors(place: Rect, diagram: Diagram) -> Picture {
    let (across, up, _) = diagram.extent();
    let (width_px, height_px) = (176, 190);
    let srgb = RgbSpace::srgb();
    let rgb = (0..width_px * height_px).map(|i| {
        let share = |at: u32, count: u32| (f64::from(at) + 0.5) / f64::from(count);
        let x = across.0 + (across.1 - across.0) * share(i % width_px, width_px);
        let y = up.1 - (up.1 - up.0) * share(i / width_px, height_px);
        let [x, y] = diagram.to_xy([x, y]);
        // Keep y above 0, which only the edge of the area reaches.
        let linear = srgb.from_xyz(xyz_of_xy([x, y.max(0.002)], 1.0)).map(|v| v.max(0.0));
        let brightest = linear.into_iter().fold(1e-9, f64::max);
        srgb.encode(linear.map(|v| v / brightest)).map(to_u8)
    });
    Picture { place, width_px, height_px, rgb: rgb.collect() }
}

/// Draws ticks and wavelengths along the outer side of the locus.
fn name_locus(canvas: &mut Canvas, sheet: &Sheet<'_>, labels: &mut Labels) {
    let style = TextStyle::new(12.0).middle().halo(Color::WHITE.with_opacity(0.85));
    for nm in (LOCUS_NM.0 + 70..=650).step_by(10) {
        let spectral = |nm| sheet.at_xy(sheet.spectral(nm));
        let (here, before, after) = (spectral(nm), spectral(nm - 2), spectral(nm + 2));
        let along = [after[0] - before[0], after[1] - before[1]];
        let length = libm::hypot(along[0], along[1]);
        // Outside is to the left, since the locus runs clockwise on the sheet.
        let out = [along[1] / length, -along[0] / length];
        let off = |distance: f64| [here[0] + out[0] * distance, here[1] + out[1] * distance];
        let named = NAMED_NM.contains(&nm);
        canvas.line(here, off(if named { 7.0 } else { 4.0 }), &Stroke::new(Color::INK, 1.0));
        if named {
            let text = nm.to_string();
            let [x, y] = off(10.0);
            let place = [x + out[0] * 0.5 * text_width(&text, style.size), y + style.half_cap() * (1.0 + out[1])];
            labels.keep_clear(style.bounds(place, &text).grown(2.0));
            canvas.text(place, &text, &style);
        }
    }
}

/// Draws the gamut triangles and their legend from `top` on; returns the area of the legend.
fn gamuts(canvas: &mut Canvas, on: &Sheet<'_>, top: f64) -> Rect {
    let axes = &on.axes;
    let dashes: [&[f64]; 3] = [&[], &[9.0, 4.0], &[2.5, 3.5]];
    let style = TextStyle::new(13.5);
    let spaces = RgbSpace::all();
    let widest = spaces.iter().map(|s| text_width(s.name, style.size)).fold(0.0, f64::max);
    let right = axes.frame.right - 14.0;
    let left = right - SAMPLE - widest - 24.0;
    let rect = Rect::new(left, top, right, top + 12.0 + 22.0 * spaces.len() as f64);
    paper(canvas, rect);
    for (i, (space, dashes)) in spaces.iter().zip(dashes).enumerate() {
        let stroke = Stroke::new(Color::INK, 1.5).dashed(dashes);
        canvas.outline(&space.primaries_xy.map(|xy| on.at_xy(xy)), &stroke);
        entry(canvas, [left + 12.0, top + 21.0 + 22.0 * i as f64], space.name, &stroke, &style);
    }
    rect
}

/// Draws the chromaticities of black bodies.
fn planckian(canvas: &mut Canvas, sheet: &Sheet<'_>, labels: &mut Labels, points: &[(String, [f64; 2])]) {
    let place = |kelvin: f64| {
        let light = Emission::blackbody(kelvin).ok()?;
        Some(sheet.at_xy(chromaticity_of(sheet.observer.xyz(&light))?))
    };
    // Even steps of reciprocal temperature are nearly even steps along the locus: 40 000 K to 1000 K.
    let line: Vec<Point> = (0..=40).filter_map(|i| place(1e6 / (25.0 + 24.375 * f64::from(i)))).collect();
    canvas.polyline(&line, &Stroke::new(Color::INK, 1.2));
    for (_, xy) in points {
        let [x, y] = sheet.at_xy(*xy);
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

fn draw_points(canvas: &mut Canvas, sheet: &Sheet<'_>, labels: &mut Labels, points: &[(String, [f64; 2])]) {
    let style = TextStyle::new(13.0).weight(1.2).halo(Color::WHITE.with_opacity(0.7));
    for (_, xy) in points {
        let at = sheet.at_xy(*xy);
        canvas.disc(at, 5.0, Color::WHITE);
        canvas.circle(at, 5.0, &Stroke::new(Color::INK, 1.6));
        canvas.disc(at, 1.6, Color::INK);
    }
    for (name, xy) in points {
        let name = shortened(name);
        if let Some(place) = labels.place(sheet.at_xy(*xy), &name, &style, 10.0) {
            canvas.text(place, &name, &style);
        }
    }
}
