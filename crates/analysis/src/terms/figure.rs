//! Figure of a chain of Gaussian terms: the product and its terms, and the scatter of estimates of its integral.

use super::{Chain, Scatter};
use spectra_plot::{Axes, Axis, Canvas, Color, Rect, Stroke, TextStyle, text_width};
use spectra_spectrum::SpectralFunction;

const WIDTH: f64 = 1080.0;
const HEIGHT: f64 = 500.0;
const LEFT: Rect = Rect { left: 84.0, top: 96.0, right: 520.0, bottom: 432.0 };
const RIGHT: Rect = Rect { left: 640.0, top: 96.0, right: 1050.0, bottom: 432.0 };
/// Number of terms of the product that are shown: the largest ones.
const SHOWN: usize = 16;
const POINTS: u32 = 961;
const POSITIVE: Color = Color::PALETTE[2];
const NEGATIVE: Color = Color::PALETTE[1];

/// Draws a chain. The left plot shows the product of the spectra, the product of their Gaussian sums, and the largest of its
/// terms by sign.
///
/// The right plot shows the relative error of estimates against the number of samples: with one term of every factor, as measured
/// (dots) and as computed, and with sampled wavelengths.
#[must_use]
pub fn figure(chain: &Chain) -> Canvas {
    let names: Vec<&str> = chain.factors.iter().map(|f| f.name.as_str()).collect();
    let title = names.join(" x ");
    let mut canvas = Canvas::new(WIDTH, HEIGHT, &format!("Gaussian terms of {title}"));
    let mut shown: String = title.chars().take(110).collect();
    if shown.len() < title.len() {
        shown.push_str("...");
    }
    canvas.text([LEFT.left, 30.0], &shown, &TextStyle::new(15.0).weight(1.4));
    product(&mut canvas, chain);
    scatter(&mut canvas, chain);
    canvas
}

fn product(canvas: &mut Canvas, chain: &Chain) {
    let [from, to] = chain.band_nm;
    let nm = |i: u32| from + (to - from) * f64::from(i) / f64::from(POINTS - 1);
    let curve = |f: &dyn Fn(f64) -> f64| -> Vec<f64> { (0..POINTS).map(|i| f(nm(i))).collect() };
    let shape =
        chain.factors[1..].iter().fold(chain.factors[0].shape.clone(), |all: SpectralFunction, f| all.times(&f.shape));
    let spectra = curve(&|w| shape.at(w));
    // Evaluate factor by factor: that takes as many evaluations as the factors have terms, not as the product has.
    let terms = curve(&|w| chain.factors.iter().map(|f| f.mixture.at(w)).product());
    let height = spectra.iter().chain(&terms).copied().fold(0.0, f64::max);
    let mut largest: Vec<_> = chain.product.terms().to_vec();
    let size = |t: &spectra_spectrum::GaussianTerm| t.band_integral(from, to).abs();
    largest.sort_by(|a, b| size(b).total_cmp(&size(a)));
    largest.truncate(SHOWN);
    let values: Vec<Vec<f64>> = largest.iter().map(|t| curve(&|w| t.at(w) / height)).collect();
    let all = || values.iter().flatten().copied();
    // Clip the scale: terms that cancel may be far higher than their sum.
    let (low, high) = (all().fold(0.0, f64::min).max(-4.0), all().fold(1.0, f64::max).min(4.0));
    let room = 0.06 * (high - low);
    let y = Axis::new("relative to the product's peak", low - room, high + room).ticks(6, 2);
    let axes = Axes::new(LEFT, Axis::new("wavelength / nm", from, to).ticks(6, 5), y);
    axes.draw_grid(canvas);
    canvas.clip(Some(LEFT));
    let draw = |canvas: &mut Canvas, values: &[f64], stroke: &Stroke| {
        let points: Vec<_> = values.iter().enumerate().map(|(i, v)| axes.at(nm(i as u32), *v)).collect();
        canvas.polyline(&points, stroke);
    };
    for (term, values) in largest.iter().zip(&values) {
        let color = if term.sign() > 0.0 { POSITIVE } else { NEGATIVE };
        draw(canvas, values, &Stroke::new(color.with_opacity(0.75), 1.0).round());
    }
    let share = |values: &[f64]| values.iter().map(|v| v / height).collect::<Vec<_>>();
    draw(canvas, &share(&spectra), &Stroke::new(Color::INK, 2.4).round());
    draw(canvas, &share(&terms), &Stroke::new(Color::PALETTE[6], 1.6).dashed(&[6.0, 4.0]));
    canvas.clip(None);
    axes.draw_frame(canvas);
    let count = largest.len().min(chain.terms);
    legend(
        canvas,
        [LEFT.left, 56.0],
        &[
            ("spectra", Stroke::new(Color::INK, 2.4)),
            (&format!("{} terms", chain.terms), Stroke::new(Color::PALETTE[6], 1.6).dashed(&[6.0, 4.0])),
        ],
    );
    legend(
        canvas,
        [LEFT.left, 78.0],
        &[
            (&format!("largest {count} of them: positive"), Stroke::new(POSITIVE, 1.6)),
            ("negative", Stroke::new(NEGATIVE, 1.6)),
        ],
    );
}

fn legend(canvas: &mut Canvas, from: [f64; 2], entries: &[(&str, Stroke)]) {
    let style = TextStyle::new(13.0);
    let mut x = from[0];
    for (name, stroke) in entries {
        let y = from[1] - style.half_cap();
        canvas.line([x, y], [x + 23.0, y], stroke);
        canvas.text([x + 30.0, from[1]], name, &style);
        x += 30.0 + text_width(name, style.size) + 24.0;
    }
}

fn scatter(canvas: &mut Canvas, chain: &Chain) {
    type Column = fn(&Scatter) -> f64;
    let computed: [(&str, Column, Stroke); 3] = [
        ("one term of every factor", |s| s.one_term, Stroke::new(Color::PALETTE[0], 1.8)),
        ("wavelengths, even", |s| s.even, Stroke::new(Color::PALETTE[1], 1.8).dashed(&[7.0, 4.0])),
        ("by the first factor", |s| s.first_factor, Stroke::new(Color::PALETTE[2], 1.8).dashed(&[2.0, 3.0])),
    ];
    let log = libm::log10;
    let good = |v: &f64| v.is_finite() && *v > 1e-12;
    let all: Vec<f64> = (chain.scatter.iter())
        .flat_map(|s| [s.one_term_measured, s.one_term, s.even, s.first_factor])
        .filter(good)
        .map(log)
        .collect();
    let samples = |s: &Scatter| log(s.samples as f64);
    let (Some(first), Some(last), false) = (chain.scatter.first(), chain.scatter.last(), all.is_empty()) else {
        canvas.outline(&RIGHT.corners(), &Stroke::new(Color::INK, 1.0));
        let middle = [0.5 * (RIGHT.left + RIGHT.right), 0.5 * (RIGHT.top + RIGHT.bottom)];
        canvas.text(middle, "all exact", &TextStyle::new(14.0).middle());
        return;
    };
    let (low, high) = all.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), v| (l.min(*v), h.max(*v)));
    let (x0, x1) = (samples(first) - 0.15, samples(last) + 0.15);
    let (y0, y1) = (low - 0.2, high + 0.2);
    let at = |x: f64, y: f64| {
        let share = |v: f64, a: f64, b: f64| (v - a) / (b - a);
        [RIGHT.left + share(x, x0, x1) * RIGHT.width(), RIGHT.bottom - share(y, y0, y1) * RIGHT.height()]
    };
    let (pale, small) = (Stroke::new(Color::PALE, 0.8), TextStyle::new(12.5));
    for s in &chain.scatter {
        let [x, _] = at(samples(s), y0);
        canvas.line([x, RIGHT.top], [x, RIGHT.bottom], &pale);
        canvas.text([x, RIGHT.bottom + 18.0], &s.samples.to_string(), &small.clone().middle());
    }
    for decade in y0.ceil() as i32..=y1.floor() as i32 {
        let [_, y] = at(x0, f64::from(decade));
        canvas.line([RIGHT.left, y], [RIGHT.right, y], &pale);
        canvas.text([RIGHT.left - 6.0, y + 4.0], &format!("10^{{{decade}}}"), &small.clone().end());
    }
    for (_, column, stroke) in &computed {
        let points: Vec<_> =
            (chain.scatter.iter()).filter(|s| good(&column(s))).map(|s| at(samples(s), log(column(s)))).collect();
        if points.len() > 1 {
            canvas.polyline(&points, stroke);
        }
    }
    for s in chain.scatter.iter().filter(|s| good(&s.one_term_measured)) {
        canvas.disc(at(samples(s), log(s.one_term_measured)), 3.6, Color::PALETTE[0]);
    }
    canvas.outline(&RIGHT.corners(), &Stroke::new(Color::INK, 1.1));
    let name = TextStyle::new(15.0).middle();
    canvas.text([0.5 * (RIGHT.left + RIGHT.right), RIGHT.bottom + 46.0], "samples", &name);
    let middle = [RIGHT.left - 58.0, 0.5 * (RIGHT.top + RIGHT.bottom)];
    canvas.text(middle, "relative error of the integral", &name.turned_deg(90.0));
    let entries: Vec<(&str, Stroke)> = computed.iter().map(|(name, _, stroke)| (*name, stroke.clone())).collect();
    legend(canvas, [RIGHT.left - 30.0, 56.0], &entries[..1]);
    canvas.disc([RIGHT.left - 18.5, 51.5], 3.6, Color::PALETTE[0]);
    legend(canvas, [RIGHT.left - 30.0, 78.0], &entries[1..]);
}
