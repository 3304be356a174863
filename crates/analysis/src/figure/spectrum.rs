//! Figure of spectra against wavelength.

use spectra_color::{RgbSpace, spectral_color_linear, to_u8};
use spectra_plot::legend::{entry, order, palette, rows, shortened, stroke};
use spectra_plot::{Axes, Axis, Canvas, Color, Labels, Paint, Point, Rect, Stop, Stroke, TextStyle};
use spectra_spectrum::{AnySpectrum, BAND, Grid, Kind, Line, Tabulated};

const WIDTH: f64 = 900.0;
const HEIGHT: f64 = 500.0;
/// Grid of half nanometers, finer than the figure can show.
const GRID: Grid = Grid { start_nm: 350.0, step_nm: 0.5, count: 961 };

/// Draws spectra over 350-830 nm, with the colors of the wavelengths below the curves.
///
/// The power of lights is relative: the highest point of a continuum is 1, and so is the strongest of its lines in that band.
/// Transmittance, reflectance and sensitivity are shown as they are. Spectral lines are drawn as vertical lines; a figure of one light
/// labels the wavelengths of its strongest ones.
#[must_use]
pub fn spectrum(spectra: &[(String, AnySpectrum)]) -> Canvas {
    spectrum_and_functions(spectra, &[])
}

/// Draws spectra as [`spectrum`] does, and other functions of wavelength that may be negative, such as color matching functions or the
/// components that spectra are summed from. The functions are shown as they are.
#[must_use]
pub fn spectrum_and_functions(spectra: &[(String, AnySpectrum)], functions: &[(String, Tabulated)]) -> Canvas {
    let all_names = spectra.iter().map(|(name, _)| name).chain(functions.iter().map(|(name, _)| name));
    let names: Vec<String> = all_names.map(|name| shortened(name)).collect();
    let values = |f: &Tabulated| GRID.wavelengths_nm().map(|nm| f.at(nm)).collect();
    let function = |(_, f): &(String, Tabulated)| Curve { continuum: Some(values(f)), lines: Vec::new() };
    let curves = spectra.iter().map(|(_, found)| Curve::of(found)).chain(functions.iter().map(function));
    let curves: Vec<Curve> = curves.collect();
    let lowest = curves.iter().flat_map(|c| c.continuum.iter().flatten()).copied().fold(0.0, f64::min);
    let quantity = match (spectra, functions) {
        (_, []) => quantity(spectra),
        ([], _) => "value",
        _ => "relative value",
    };
    let mut canvas = Canvas::new(WIDTH, HEIGHT, &format!("Spectrum: {}", names.join(", ")));
    let style = TextStyle::new(14.0);
    let (places, rows) = rows(&names, [92.0, 26.0], WIDTH - 24.0, &style);
    let frame = Rect::new(92.0, 20.0 + 22.4 * rows as f64, WIDTH - 24.0, HEIGHT - 66.0);
    let axes = Axes::new(
        frame,
        Axis::new("wavelength / nm", BAND.start_nm, BAND.end_nm()).ticks(10, 5),
        Axis::new(quantity, 1.06 * lowest, top(spectra, &curves)).ticks(6, 2),
    );
    axes.draw_grid(&mut canvas);
    if lowest < 0.0 {
        let zero = [axes.at(BAND.start_nm, 0.0), axes.at(BAND.end_nm(), 0.0)];
        canvas.line(zero[0], zero[1], &Stroke::new(Color::INK, 0.8));
    }
    canvas.clip(Some(frame));
    let alone = curves.len() == 1;
    // Use a paler background behind many curves.
    let opacity = match curves.len() {
        1 => 0.92,
        2..=7 => 0.4,
        _ => 0.18,
    };
    fill(&mut canvas, &axes, &curves, opacity);
    let order = order(&names);
    for (i, curve) in order.iter().copied().zip(&curves) {
        let color = if alone { Color::INK } else { palette(i) };
        for line in &curve.lines {
            let color = if alone { shown(line.wavelength_nm) } else { color };
            let ends = [axes.at(line.wavelength_nm, 0.0), axes.at(line.wavelength_nm, line.power)];
            canvas.line(ends[0], ends[1], &Stroke::new(color, 2.2));
        }
        if let Some(values) = &curve.continuum {
            let line = if alone { Stroke::new(color, 1.7) } else { stroke(i, 1.7) };
            canvas.polyline(&points(&axes, values), &line);
        }
    }
    canvas.clip(None);
    if alone {
        name_lines(&mut canvas, &axes, &curves[0].lines);
    }
    axes.draw_frame(&mut canvas);
    for (i, (name, at)) in order.into_iter().zip(names.iter().zip(places)) {
        if alone {
            canvas.text([frame.left, at[1]], name, &style.clone().weight(1.35));
        } else {
            entry(&mut canvas, at, name, &stroke(i, 2.4), &style);
        }
    }
    canvas
}

/// A spectrum on the scale of the figure.
struct Curve {
    continuum: Option<Vec<f64>>,
    lines: Vec<Line>,
}

impl Curve {
    fn of(found: &AnySpectrum) -> Self {
        let matter = |values: Vec<f64>| Self { continuum: Some(values), lines: Vec::new() };
        match found {
            AnySpectrum::Emission(light) => {
                let power = light.to_power(&GRID);
                let peak = |values: &mut dyn Iterator<Item = f64>| values.fold(0.0, f64::max);
                let unit = |value: f64, peak: f64| if peak > 0.0 { value / peak } else { 0.0 };
                let highest = peak(&mut power.continuum.iter().copied());
                let strongest = peak(&mut power.lines.iter().map(|l| l.power));
                let lines = power.lines.iter().map(|l| Line { power: unit(l.power, strongest), ..*l }).collect();
                let continuum = light.continuum().map(|_| power.continuum.iter().map(|v| unit(*v, highest)).collect());
                Self { continuum, lines }
            }
            AnySpectrum::Transmittance(filter) => matter(filter.on_grid(&GRID)),
            AnySpectrum::Reflectance(surface) => matter(surface.on_grid(&GRID)),
            AnySpectrum::Sensitivity(detector) => matter(detector.on_grid(&GRID)),
        }
    }
}

fn quantity(spectra: &[(String, AnySpectrum)]) -> &'static str {
    let all = |kind: Kind| spectra.iter().all(|(_, found)| found.kind() == kind);
    match () {
        () if all(Kind::Emission) => "relative power",
        () if all(Kind::Transmittance) => "transmittance",
        () if all(Kind::Reflectance) => "reflectance",
        () if all(Kind::Sensitivity) => "sensitivity",
        () => "relative value",
    }
}

/// Upper end of the scale: at least 1 if any spectrum is not a sensitivity, with room for labels above lines.
fn top(spectra: &[(String, AnySpectrum)], curves: &[Curve]) -> f64 {
    let values = curves.iter().flat_map(|c| c.continuum.iter().flatten()).copied();
    let highest = values.fold(0.0, f64::max);
    let shares = spectra.iter().any(|(_, found)| found.kind() != Kind::Sensitivity);
    let highest = if shares { highest.max(1.0) } else { highest };
    match highest {
        h if curves.iter().any(|c| !c.lines.is_empty()) => 1.12 * h,
        h if h > 0.0 => 1.06 * h,
        _ => 1.0,
    }
}

fn points(axes: &Axes, values: &[f64]) -> Vec<Point> {
    GRID.wavelengths_nm().zip(values).map(|(nm, value)| axes.at(nm, *value)).collect()
}

/// Fills the area under the highest curve with the colors of the wavelengths.
fn fill(canvas: &mut Canvas, axes: &Axes, curves: &[Curve], opacity: f64) {
    let mut highest = vec![0.0_f64; GRID.count];
    for values in curves.iter().filter_map(|c| c.continuum.as_ref()) {
        highest.iter_mut().zip(values).for_each(|(h, v)| *h = h.max(*v));
    }
    if highest.iter().all(|h| *h <= 0.0) {
        return;
    }
    let mut area = points(axes, &highest);
    area.push(axes.at(BAND.end_nm(), 0.0));
    area.push(axes.at(BAND.start_nm, 0.0));
    let stops = (0..=240).map(|i| {
        let at = f64::from(i) / 240.0;
        let color = shown(BAND.start_nm + at * (BAND.end_nm() - BAND.start_nm));
        Stop { at, color: color.with_opacity(opacity) }
    });
    let stops = stops.collect();
    let (from, to) = (axes.at(BAND.start_nm, 0.0), axes.at(BAND.end_nm(), 0.0));
    canvas.polygon(&area, Paint::Gradient { from, to, stops });
}

/// Returns the color of a wavelength on paper. It fades to gray toward the ends of the visible range and beyond.
fn shown(wavelength_nm: f64) -> Color {
    const GREY: f64 = 0.2;
    let smooth = |from: f64, to: f64| {
        let t = ((wavelength_nm - from) / (to - from)).clamp(0.0, 1.0);
        t * t * (3.0 - 2.0 * t)
    };
    let seen = smooth(375.0, 435.0) * smooth(775.0, 670.0);
    let linear = spectral_color_linear(wavelength_nm, RgbSpace::srgb());
    RgbSpace::srgb().encode(linear.map(|v| GREY + (v - GREY) * seen)).map(to_u8).into()
}

/// Writes the wavelengths of the strongest lines above them, as far as there is room.
fn name_lines(canvas: &mut Canvas, axes: &Axes, lines: &[Line]) {
    const WEAKEST: f64 = 0.05;
    let style = TextStyle::new(11.5).middle();
    let mut labels = Labels::new(axes.frame.grown(-2.0));
    let mut strongest: Vec<&Line> = lines.iter().filter(|l| l.power >= WEAKEST).collect();
    strongest.sort_by(|a, b| b.power.total_cmp(&a.power));
    for line in lines {
        let [x, y] = axes.at(line.wavelength_nm, line.power);
        labels.keep_clear(Rect::new(x - 1.0, y, x + 1.0, axes.frame.bottom));
    }
    for line in strongest {
        let [x, y] = axes.at(line.wavelength_nm, line.power);
        let text = format!("{:.1}", line.wavelength_nm);
        let at = [x, y - 5.0];
        if labels.claim(style.bounds(at, &text)) {
            canvas.text(at, &text, &style);
        }
    }
}
