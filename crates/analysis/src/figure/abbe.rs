//! The Abbe diagram: refractive index against Abbe number.

use spectra_plot::legend::{entry_disc, palette, rows, shortened};
use spectra_plot::{Axes, Axis, Canvas, Color, Labels, Point, Rect, Stroke, TextStyle};

const WIDTH: f64 = 980.0;
const HEIGHT: f64 = 740.0;

/// The glasses of one maker.
#[derive(Clone, Debug, PartialEq)]
pub struct AbbeGroup {
    /// Name for the legend.
    pub name: String,
    /// Abbe number Vd and index nd of each glass.
    pub points: Vec<[f64; 2]>,
}

/// Draws nd against Vd, with Vd decreasing to the right as in makers' diagrams. Each group has its color; `named` glasses (name,
/// [Vd, nd]) are marked and labeled on top. `axes` are the labels of the Abbe number and of the index, since both may refer to
/// other lines.
#[must_use]
pub fn abbe(groups: &[AbbeGroup], named: &[(String, [f64; 2])], axes: &[String; 2]) -> Canvas {
    let [of_v, of_n] = axes;
    let names: Vec<String> = groups.iter().map(|g| format!("{} ({})", shortened(&g.name), g.points.len())).collect();
    let mut canvas = Canvas::new(WIDTH, HEIGHT, "Abbe diagram");
    let style = TextStyle::new(14.0);
    let (places, rows) = rows(&names, [92.0, 26.0], WIDTH - 24.0, &style);
    let frame = Rect::new(92.0, 20.0 + 22.4 * rows as f64, WIDTH - 24.0, HEIGHT - 66.0);
    let all = || groups.iter().flat_map(|g| &g.points).chain(named.iter().map(|(_, p)| p)).filter(|p| p[0].is_finite());
    let (v, n) = (span(all().map(|p| p[0]), 5.0, (20.0, 90.0)), span(all().map(|p| p[1]), 0.05, (1.4, 1.9)));
    let axes = Axes::new(frame, Axis::new(of_v, v.1, v.0).ticks(9, 2), Axis::new(of_n, n.0, n.1).ticks(9, 2));
    axes.draw_grid(&mut canvas);
    canvas.clip(Some(frame));
    for (i, group) in groups.iter().enumerate() {
        for [v, n] in &group.points {
            canvas.disc(axes.at(*v, *n), 3.0, palette(i).with_opacity(0.6));
        }
    }
    canvas.clip(None);
    axes.draw_frame(&mut canvas);
    mark(&mut canvas, &axes, named);
    for (i, (name, at)) in names.iter().zip(places).enumerate() {
        entry_disc(&mut canvas, at, name, palette(i), &style);
    }
    canvas
}

/// Returns the range of the values, widened to whole steps; `none` if there are no values.
fn span(values: impl Iterator<Item = f64>, step: f64, none: (f64, f64)) -> (f64, f64) {
    let (low, high) = values.fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), v| (l.min(v), h.max(v)));
    if low > high {
        return none;
    }
    let (low, high) = ((low / step - 0.2).floor() * step, (high / step + 0.2).ceil() * step);
    (low, high.max(low + 2.0 * step))
}

fn mark(canvas: &mut Canvas, axes: &Axes, named: &[(String, [f64; 2])]) {
    let places: Vec<Point> = named.iter().map(|(_, [v, n])| axes.at(*v, *n)).collect();
    let mut labels = Labels::new(axes.frame.grown(-3.0));
    for place in &places {
        canvas.disc(*place, 5.5, Color::WHITE);
        canvas.circle(*place, 5.5, &Stroke::new(Color::INK, 2.0));
        canvas.disc(*place, 2.2, Color::INK);
        let [x, y] = *place;
        labels.keep_clear(Rect::new(x - 7.0, y - 7.0, x + 7.0, y + 7.0));
    }
    let style = TextStyle::new(13.0).weight(1.3).halo(Color::WHITE.with_opacity(0.85));
    for ((name, _), place) in named.iter().zip(places) {
        let name = shortened(name);
        if let Some(at) = labels.place(place, &name, &style, 10.0) {
            canvas.text(at, &name, &style);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Checks that Vd falls to the right and nd rises upward: a crown lies left of and below a flint.
    #[test]
    fn crowns_are_left_and_low() {
        let groups = [
            AbbeGroup { name: "crown".into(), points: vec![[64.17, 1.5168]] },
            AbbeGroup { name: "flint".into(), points: vec![[25.68, 1.78472]] },
        ];
        let pixels = abbe(&groups, &[], &["V".to_owned(), "n".to_owned()]).to_pixels(1.0);
        let place = |is: &dyn Fn([i32; 3]) -> bool| {
            // Search within the frame, below the legend.
            let found: Vec<(usize, usize)> = (60..670)
                .flat_map(|y| (100..950).map(move |x| (x, y)))
                .filter(|(x, y)| is(pixels.rgb[y * pixels.width_px as usize + x].map(i32::from)))
                .collect();
            assert!(found.len() > 10, "{}", found.len());
            let mean = |of: fn(&(usize, usize)) -> usize| found.iter().map(of).sum::<usize>() / found.len();
            (mean(|p| p.0), mean(|p| p.1))
        };
        // The first two colors of the palette: blue and vermilion.
        let (crown, flint) = (place(&|[r, _, b]| b - r > 60), place(&|[r, _, b]| r - b > 60));
        assert!(crown.0 + 100 < flint.0 && crown.1 > flint.1 + 100, "{crown:?} {flint:?}");
    }

    #[test]
    fn spans_are_whole_steps() {
        assert_eq!(span([21.0, 89.0].into_iter(), 5.0, (0.0, 1.0)), (20.0, 90.0));
        assert_eq!(span(std::iter::empty(), 5.0, (20.0, 90.0)), (20.0, 90.0));
    }
}
