//! Figure of refractive index against wavelength.

use spectra_plot::legend::{entry, palette, rows, shortened};
use spectra_plot::{Axes, Axis, Canvas, Color, Point, Rect, Stroke, TextStyle};

const WIDTH: f64 = 900.0;
const HEIGHT: f64 = 560.0;

/// The refractive index of a medium as a function of wavelength.
#[derive(Clone, Debug, PartialEq)]
pub struct IndexCurve {
    /// Name for the legend.
    pub name: String,
    /// Wavelength (nm, ascending) and index; an index that is not finite interrupts the curve.
    pub points: Vec<[f64; 2]>,
    /// Range of wavelengths of the data, nm; outside it the curve is dashed. `None` means no limit.
    pub range_nm: Option<(f64, f64)>,
}

/// Draws n(lambda) of several media from `band_nm.0` to `band_nm.1`, with thin lines at the `marks` (name, nm).
#[must_use]
pub fn dispersion(curves: &[IndexCurve], band_nm: (f64, f64), marks: &[(&str, f64)]) -> Canvas {
    let names: Vec<String> = curves.iter().map(|curve| shortened(&curve.name)).collect();
    let mut canvas = Canvas::new(WIDTH, HEIGHT, &format!("Refractive index: {}", names.join(", ")));
    let style = TextStyle::new(14.0);
    let (places, rows) = rows(&names, [92.0, 26.0], WIDTH - 24.0, &style);
    let frame = Rect::new(92.0, 38.0 + 22.4 * rows as f64, WIDTH - 24.0, HEIGHT - 66.0);
    let (low, high) = span(curves, band_nm);
    let axes = Axes::new(
        frame,
        Axis::new("wavelength / nm", band_nm.0, band_nm.1).ticks(10, 5),
        Axis::new("refractive index", low, high).ticks(7, 2),
    );
    axes.draw_grid(&mut canvas);
    name_marks(&mut canvas, &axes, band_nm, marks);
    canvas.clip(Some(frame));
    for (i, curve) in curves.iter().enumerate() {
        let stroke = Stroke::new(palette(i), 1.9);
        let dashed = Stroke::new(palette(i), 1.4).dashed(&[5.0, 4.0]);
        for (known, points) in parts(curve) {
            let places: Vec<Point> = points.iter().map(|[nm, n]| axes.at(*nm, *n)).collect();
            canvas.polyline(&places, if known { &stroke } else { &dashed });
        }
    }
    canvas.clip(None);
    axes.draw_frame(&mut canvas);
    for (i, (name, at)) in names.iter().zip(places).enumerate() {
        entry(&mut canvas, at, name, &Stroke::new(palette(i), 2.4), &style);
    }
    canvas
}

/// Range of the index axis: the shown indices with a margin.
fn span(curves: &[IndexCurve], band_nm: (f64, f64)) -> (f64, f64) {
    let inside = |p: &&[f64; 2]| p[0] >= band_nm.0 && p[0] <= band_nm.1 && p[1].is_finite();
    let known = |curve: &IndexCurve, nm: f64| curve.range_nm.is_none_or(|(from, to)| from <= nm && nm <= to);
    let mut low = f64::INFINITY;
    let mut high = f64::NEG_INFINITY;
    // Extrapolated indices may leave the plot: they set the scale only if there are no others.
    for only_known in [true, false] {
        for curve in curves {
            for [nm, n] in curve.points.iter().filter(inside) {
                if !only_known || known(curve, *nm) {
                    (low, high) = (low.min(*n), high.max(*n));
                }
            }
        }
        if low <= high {
            break;
        }
    }
    if low > high {
        return (1.0, 2.0);
    }
    let margin = (0.06 * (high - low)).max(0.002);
    (low - margin, high + margin)
}

/// Splits a curve into pieces inside its data range (true) and outside it (false), each joined to the next.
fn parts(curve: &IndexCurve) -> Vec<(bool, Vec<[f64; 2]>)> {
    let known = |nm: f64| curve.range_nm.is_none_or(|(from, to)| from <= nm && nm <= to);
    let mut parts: Vec<(bool, Vec<[f64; 2]>)> = Vec::new();
    let mut broken = true;
    for &[nm, n] in &curve.points {
        if !n.is_finite() {
            broken = true;
            continue;
        }
        let of = known(nm);
        match parts.last_mut() {
            Some((kind, points)) if !broken && *kind == of => points.push([nm, n]),
            Some((_, points)) if !broken => {
                // Begin at the last point of the piece before, so that the two join.
                let joint = points.last().copied();
                parts.push((of, joint.into_iter().chain([[nm, n]]).collect()));
            }
            _ => parts.push((of, vec![[nm, n]])),
        }
        broken = false;
    }
    parts
}

/// Draws spectral lines with their names above the frame.
fn name_marks(canvas: &mut Canvas, axes: &Axes, band_nm: (f64, f64), marks: &[(&str, f64)]) {
    let style = TextStyle::new(12.0).middle();
    let mut last = f64::NEG_INFINITY;
    for (name, nm) in marks.iter().filter(|(_, nm)| band_nm.0 < *nm && *nm < band_nm.1) {
        let [x, _] = axes.at(*nm, axes.y.from);
        canvas.line([x, axes.frame.top], [x, axes.frame.bottom], &Stroke::new(Color::GREY.with_opacity(0.45), 0.9));
        if x - last > 15.0 {
            canvas.text([x, axes.frame.top - 6.0], name, &style);
            last = x;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn curve(range_nm: Option<(f64, f64)>) -> IndexCurve {
        let points = (0..=10).map(|i| [400.0 + 40.0 * f64::from(i), 1.5 + 0.01 * f64::from(10 - i)]).collect();
        IndexCurve { name: "a".into(), points, range_nm }
    }

    #[test]
    fn what_is_extrapolated_is_a_part_of_its_own() {
        let kinds: Vec<(bool, usize)> =
            parts(&curve(Some((480.0, 700.0)))).iter().map(|(known, points)| (*known, points.len())).collect();
        assert_eq!(kinds, [(false, 2), (true, 7), (false, 4)]);
        let mut broken = curve(None);
        broken.points[5][1] = f64::NAN;
        assert_eq!(parts(&broken).len(), 2);
    }

    #[test]
    fn the_scale_holds_what_is_known() {
        let (low, high) = span(&[curve(Some((400.0, 600.0)))], (400.0, 800.0));
        assert!(low < 1.55 && low > 1.54 && high > 1.6 && high < 1.61, "{low} {high}");
        assert_eq!(span(&[], (400.0, 800.0)), (1.0, 2.0));
    }

    /// Checks that the curve is drawn where its values are: frame from x 92 to 876 for 400 to 800 nm.
    #[test]
    fn curves_are_in_their_color() {
        let pixels = dispersion(&[curve(None)], (400.0, 800.0), &[("d", 587.6)]).to_pixels(1.0);
        let column = (92.0 + 784.0 * 0.75) as usize;
        let blue = |y: usize| {
            let [r, _, b] = pixels.rgb[y * pixels.width_px as usize + column].map(i32::from);
            b - r > 90
        };
        // Scale of n: 1.525 on an axis from 1.494 to 1.606; the frame reaches from y 60.4 down to 494.
        let y = (494.0 - (1.525 - 1.494) / 0.112 * 433.6) as usize;
        assert!((y - 3..=y + 3).any(blue), "{y}");
        assert!(!(100..y - 8).any(blue) && !(y + 8..480).any(blue));
    }
}
