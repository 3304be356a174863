use super::drawing::{Align, Drawing, text_width_mm};
use super::*;
use spectra_core::Isa;

/// A linear congruential generator, which is random enough to place points.
struct Dice(u64);

impl Dice {
    /// Draws a uniform random number in [-1, 1).
    fn throw(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
    }
}

fn built(name: &str) -> Chart {
    chart(name, None, 1).expect("the chart is listed")
}

fn ink(chart: &Chart, x: f64, y: f64) -> Ink {
    chart.inks()[usize::from(chart.ink_at(x, y))]
}

/// Finds where the ink changes between two points of different ink, as a fraction of the distance, within 1e-12.
fn change(chart: &Chart, from: [f64; 2], to: [f64; 2]) -> f64 {
    let at = |t: f64| chart.ink_at(from[0] + t * (to[0] - from[0]), from[1] + t * (to[1] - from[1]));
    let first = at(0.0);
    assert_ne!(first, at(1.0), "no change between {from:?} and {to:?}");
    let (mut low, mut high) = (0.0, 1.0);
    while high - low > 1e-12 {
        let middle = 0.5 * (low + high);
        if at(middle) == first { low = middle } else { high = middle }
    }
    0.5 * (low + high)
}

#[test]
fn grid_answers_as_all_shapes_do() {
    for entry in CHARTS {
        let chart = entry.build(None, 7).expect("every chart can be built");
        let half = [0.5 * chart.width_mm(), 0.5 * chart.height_mm()];
        let mut dice = Dice(5);
        for _ in 0..100_000 {
            let [x, y] = [1.001 * half[0] * dice.throw(), 1.001 * half[1] * dice.throw()];
            assert_eq!(chart.ink_at(x, y), chart.ink_by_all_shapes(x, y), "{} ({x}, {y})", entry.name);
        }
        // Test points on and next to borders of cells, where rounding decides.
        let cell = 2.0 * half[0].max(half[1]) / 1024.0;
        for _ in 0..20_000 {
            let on = |dice: &mut Dice, half: f64| {
                let border = (512.0 * dice.throw()).round() * cell + if dice.throw() > 0.0 { half } else { -half };
                border * (1.0 + f64::EPSILON * (3.0 * dice.throw()).round())
            };
            let (x, y) = (on(&mut dice, half[0]), half[1] * dice.throw());
            let (x, y) = if dice.throw() > 0.0 { (x, y) } else { (half[0] * dice.throw(), on(&mut dice, half[1])) };
            assert_eq!(chart.ink_at(x, y), chart.ink_by_all_shapes(x, y), "{} ({x}, {y})", entry.name);
        }
    }
}

#[test]
fn grid_answers_as_all_shapes_do_around_small_things() {
    // Random points seldom hit a star 1 mm wide, so test many points close to every landmark.
    for name in ["resolution", "star-field", "siemens", "text"] {
        let chart = built(name);
        let mut dice = Dice(6);
        let centers: Vec<[f64; 2]> = chart.landmarks().iter().map(|l| l.center_mm).collect();
        assert!(!centers.is_empty() || name == "text");
        for center in centers {
            for _ in 0..200 {
                let (x, y) = (center[0] + 3.0 * dice.throw(), center[1] + 3.0 * dice.throw());
                assert_eq!(chart.ink_at(x, y), chart.ink_by_all_shapes(x, y), "{name} ({x}, {y})");
            }
        }
    }
}

#[test]
fn batch_answers_as_points_do() {
    let chart = built("resolution");
    let mut dice = Dice(8);
    let x: Vec<f64> = (0..3000).map(|_| 760.0 * dice.throw()).collect();
    let y: Vec<f64> = (0..3000).map(|_| 510.0 * dice.throw()).collect();
    let mut inks = vec![1234; 3000];
    for isa in Isa::available() {
        inks.fill(1234);
        chart.ink_at_batch(&x, &y, &mut inks, isa);
        assert!((0..3000).all(|i| inks[i] == chart.ink_at(x[i], y[i])), "{}", isa.name());
        assert!(inks.contains(&NO_INK));
    }
}

#[test]
fn outside_there_is_no_ink() {
    let chart = built("white");
    for (x, y) in [(750.1, 0.0), (-750.1, 0.0), (0.0, 500.1), (0.0, -500.1), (f64::NAN, 0.0), (0.0, f64::INFINITY)] {
        assert_eq!(chart.ink_at(x, y), NO_INK, "({x}, {y})");
    }
    for (x, y) in [(750.0, 500.0), (-750.0, -500.0), (750.0, -500.0), (0.0, 0.0)] {
        assert_eq!(ink(&chart, x, y), Ink::Gray(1.0), "({x}, {y})");
    }
}

#[test]
fn resolution_has_its_inks_in_their_places() {
    let chart = built("resolution");
    let (white, black) = (Ink::Gray(0.9), Ink::Gray(0.03));
    // Border blocks, grid, slanted squares, ground between rings.
    for (x, y, expected) in [
        (710.0, 490.0, black),
        (660.0, 490.0, white),
        (740.0, 490.0, white),
        (740.0, 450.0, black),
        (740.0, -450.0, black),
        (740.0, 0.0, black),
        (0.0, 490.0, white),
        (710.0, 450.0, black),
        (710.0, 450.59, black),
        (710.0, 450.61, white),
        (-160.0, 8.0, black),
        (285.0, 8.0, Ink::Gray(0.225)),
        (375.0, 25.0, white),
        (0.0, 95.0, white),
        (85.0, 0.0, black),
        (85.0, 85.0 * libm::tan(std::f64::consts::PI / 72.0), white),
    ] {
        assert_eq!(ink(&chart, x, y), expected, "({x}, {y})");
    }
    // The first patch is at the upper left of the block, the last at the lower right; 60 mm wide, 65 mm apart.
    assert_eq!(ink(&chart, -162.5, -154.5), Ink::Patch("dark skin"));
    assert_eq!(ink(&chart, 162.5, -154.5), Ink::Patch("bluish green"));
    assert_eq!(ink(&chart, -162.5, -349.5), Ink::Patch("white 9.5 (.05 D)"));
    assert_eq!(ink(&chart, 162.5, -349.5), Ink::Patch("black 2 (1.5 D)"));
    assert_eq!(ink(&chart, -32.5 + 29.9, -284.5 - 29.9), Ink::Patch("red"));
    assert_eq!(ink(&chart, -32.5 + 30.1, -284.5), Ink::Gray(0.01));
}

#[test]
fn landmarks_lie_alone() {
    for (name, count) in [("resolution", 24), ("color-checker", 24), ("step-wedge", 42)] {
        let chart = built(name);
        let flat = chart.landmarks().iter().filter(|l| PATCHES.contains(&&*l.name) || l.name.starts_with("density "));
        let mut seen = 0;
        for landmark in flat {
            let here = ink(&chart, landmark.center_mm[0], landmark.center_mm[1]);
            if let Ink::Patch(patch) = here {
                assert_eq!(patch, landmark.name);
            } else {
                let Ink::Gray(reflectance) = here else { panic!("{here:?}") };
                assert_eq!(landmark.name, format!("density {:.2}", -libm::log10(reflectance)));
            }
            for k in 0..64 {
                let a = std::f64::consts::TAU * f64::from(k) / 64.0;
                let r = 0.999 * landmark.radius_mm;
                let at = [landmark.center_mm[0] + r * libm::cos(a), landmark.center_mm[1] + r * libm::sin(a)];
                assert_eq!(ink(&chart, at[0], at[1]), here, "{name} {}", landmark.name);
            }
            seen += usize::from(name != "resolution" || matches!(here, Ink::Patch(_)));
        }
        assert_eq!(seen, count, "{name}");
    }
}

#[test]
fn slanted_edges_lean_by_five_degrees() {
    for name in ["resolution", "slanted-edge"] {
        let chart = built(name);
        let edges: Vec<&Landmark> = chart.landmarks().iter().filter(|l| l.name.starts_with("slanted edge")).collect();
        assert_eq!(edges.len(), if name == "resolution" { 16 } else { 35 });
        for edge in edges {
            let [x, y] = edge.center_mm;
            let expected: f64 = if edge.name.ends_with("+5") { 5.0 } else { -5.0 };
            // The right side, at two heights 2 h apart.
            let (reach, h) = (if name == "resolution" { 0.75 } else { 0.9 } * edge.radius_mm, 12.0);
            let cross = |dy: f64| reach * change(&chart, [x, y + dy], [x + reach, y + dy]);
            let lean = libm::atan((cross(-h) - cross(h)) / (2.0 * h)).to_degrees();
            assert!((lean - expected).abs() < 1e-8, "{name} {x} {y}: {lean}");
            // The top side, at two positions 2 h apart.
            let climb = |dx: f64| reach * change(&chart, [x + dx, y], [x + dx, y + reach]);
            let lean = libm::atan((climb(h) - climb(-h)) / (2.0 * h)).to_degrees();
            assert!((lean - expected).abs() < 1e-8, "{name} {x} {y}: {lean}");
        }
    }
}

#[test]
fn wedges_read_in_line_widths_per_picture_height() {
    let chart = built("resolution");
    // The coarse vertical wedge: 2 at y = 345, 10 at y = 140, axis at x = -48; 9 lines and 8 gaps.
    for figure in [3.0, 5.0, 9.0] {
        let y = 345.0 - 205.0 * (figure - 2.0) / 8.0;
        let stripe = 1000.0 / (100.0 * figure);
        // The center line is 4 line pairs away from the outermost line.
        assert_eq!(ink(&chart, -48.0, y), Ink::Gray(0.03));
        let border = change(&chart, [-48.0 - 8.0 * stripe, y], [-48.0 - 8.0 * stripe - 2.0 * stripe, y]);
        assert!((2.0 * border - 0.5).abs() < 1e-9, "{figure}: {border}");
        let inks: Vec<Ink> = (-8..=8).map(|k| ink(&chart, -48.0 + stripe * f64::from(k), y)).collect();
        assert!(inks.windows(2).all(|pair| pair[0] != pair[1]), "{figure}");
    }
}

#[test]
fn siemens_star_has_its_sectors() {
    let chart = built("siemens");
    for radius in [440.0, 200.0, 20.0, 1.0] {
        let inks: Vec<u16> = (0..14_400)
            .map(|k| {
                let a = std::f64::consts::TAU * (f64::from(k) + 0.5) / 14_400.0;
                chart.ink_at(radius * libm::cos(a), radius * libm::sin(a))
            })
            .collect();
        let borders = (0..inks.len()).filter(|&k| inks[k] != inks[(k + 1) % inks.len()]).count();
        assert_eq!(borders, 144, "radius {radius}");
    }
}

#[test]
fn letters_read_left_to_right_and_stand_upright() {
    let mut drawing = Drawing::new(100.0, 50.0, Ink::Gray(1.0));
    drawing.text("FR", [-20.0, -20.0], 40.0, Align::Left, Ink::Gray(0.0));
    let chart = drawing.finish("test");
    let black = |x: f64, y: f64| ink(&chart, x, y) == Ink::Gray(0.0);
    // Units of 5 mm; the center of the pen that draws the F runs from (-17.5, -17.5) up to y = 17.5.
    let unit = 5.0;
    let f = |x: f64, y: f64| black(-17.5 + x * unit, -17.5 + y * unit);
    assert!(f(0.0, 0.0) && f(0.0, 7.0) && f(3.5, 7.0) && f(2.9, 3.5), "stem and two bars");
    assert!(!f(2.5, 0.0) && !f(3.5, 3.5) && !f(2.0, 5.25), "open at the lower right");
    // The R follows on the right, its bowl on top, its leg below.
    let r = |x: f64, y: f64| f(3.5 + 2.2 + x, y);
    assert!(r(0.0, 0.0) && r(0.0, 7.0) && r(4.0, 5.1) && r(4.1, 0.0), "stem, bowl and leg");
    assert!(!r(2.1, 5.1) && !r(4.0, 2.2) && !r(1.5, 1.0), "eye of the bowl, below it, between stem and leg");
    // From edge to edge, capitals have the requested height.
    assert!(black(-17.5, 19.99) && !black(-17.5, 20.01) && black(-17.5, -19.99) && !black(-17.5, -20.01));
    assert!((change(&chart, [-25.0, 0.0], [-17.5, 0.0]) * 7.5 - 5.0).abs() < 1e-9, "starts at its anchor");
}

#[test]
fn title_of_the_resolution_chart_reads_from_the_left() {
    // "SPECTRA", 16 mm tall, starts at (-330, -432): the P begins 3.8 + 2.2 units of 2 mm after the S.
    let chart = built("resolution");
    let p = |x: f64, y: f64| ink(&chart, -330.0 + 1.0 + 2.0 * (6.0 + x), -432.0 + 1.0 + 2.0 * y) == Ink::Gray(0.03);
    assert!(p(0.0, 0.0) && p(0.0, 7.0) && p(2.0, 7.0) && p(4.0, 5.05));
    assert!(!p(4.0, 0.0) && !p(2.0, 0.0) && !p(2.0, 5.05) && !p(4.0, 1.5));
}

#[test]
fn text_is_aligned_to_its_anchor() {
    let width = text_width_mm("LENS 58", 8.0);
    for (align, left) in [(Align::Left, 0.0), (Align::Center, -0.5 * width), (Align::Right, -width)] {
        let mut drawing = Drawing::new(200.0, 50.0, Ink::Gray(1.0));
        drawing.text("LENS 58", [0.0, -4.0], 8.0, align, Ink::Gray(0.0));
        let chart = drawing.finish("test");
        let start = -90.0 + 200.0 * change(&chart, [-90.0, 0.0], [left + 0.1, 0.0]) * (left + 90.1) / 200.0;
        assert!((start - left).abs() < 1e-9, "{align:?}: {start} {left}");
    }
}

#[test]
fn charts_scale_with_their_width() {
    for entry in CHARTS {
        let design = entry.build(None, 3).expect("every chart can be built");
        let [w, h] = [design.width_mm(), design.height_mm()];
        // Powers of two change no bit of the geometry. The factor 0.317 does, but no point is close enough to a border.
        for factor in [0.25, 4.0, 0.317] {
            let scaled = entry.build(Some(factor * w), 3).expect("every chart can be scaled");
            assert_eq!(scaled.width_mm(), factor * w);
            assert!((scaled.height_mm() - factor * h).abs() < 1e-12 * h);
            assert_eq!(scaled.inks(), design.inks());
            // Equal areas give a chart that fills the frame the same light in front of every lens.
            assert_eq!(scaled.areas(), design.areas());
            assert!((scaled.areas().iter().sum::<f64>() - 1.0).abs() < 1e-9, "{}", entry.name);
            let mut dice = Dice(9);
            for _ in 0..20_000 {
                let [x, y] = [0.5 * w * dice.throw(), 0.5 * h * dice.throw()];
                let ink = scaled.ink_at(factor * x, factor * y);
                assert_eq!(ink, design.ink_at(x, y), "{} ({x}, {y})", entry.name);
                assert_eq!(ink, scaled.ink_by_all_shapes(factor * x, factor * y), "{} ({x}, {y})", entry.name);
            }
            for (large, small) in design.landmarks().iter().zip(scaled.landmarks()) {
                assert_eq!(large.name, small.name);
                assert!((large.center_mm[0] * factor - small.center_mm[0]).abs() < 1e-9);
            }
        }
    }
}

#[test]
fn grids_stay_small() {
    for entry in CHARTS {
        let chart = entry.build(None, 1).expect("every chart can be built");
        assert!(chart.grid_bytes() < 8_000_000, "{}: {} bytes", entry.name, chart.grid_bytes());
    }
}

#[test]
fn stars_follow_their_seed() {
    let places = |seed: u64| {
        let chart = chart("star-field", None, seed).expect("the chart is listed");
        chart.landmarks().iter().map(|l| l.center_mm).collect::<Vec<_>>()
    };
    assert_eq!(places(1), places(1));
    assert_ne!(places(1), places(2));
    assert_eq!(places(1).len(), 600);
}

#[test]
fn names_are_sorted_and_the_nearest_is_told() {
    assert!(CHARTS.windows(2).all(|pair| pair[0].name < pair[1].name));
    assert!(CHARTS.iter().all(|entry| !entry.summary.is_empty() && !entry.summary.contains('\n')));
    for (asked, expected) in [
        ("resolutoin", "resolution"),
        ("Color_Checker", "color-checker"),
        ("colorchecker", "color-checker"),
        ("star", "star-field"),
        ("siemens-star", "siemens"),
        ("grey-card", "gray-card"),
        ("texts", "text"),
        ("", "grid"),
    ] {
        match chart(asked, None, 1) {
            Err(ChartError::Unknown { name, nearest }) => {
                assert_eq!(name, asked);
                if !asked.is_empty() {
                    assert_eq!(nearest, expected, "{asked}");
                }
            }
            other => panic!("{asked}: {other:?}"),
        }
    }
    let message = chart("slant", None, 1).expect_err("no such chart").to_string();
    assert!(message.contains("`slant`") && message.contains("`slanted-edge`") && message.contains("gray-card"));
}

#[test]
fn widths_must_be_lengths() {
    for width in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        assert!(matches!(chart("grid", Some(width), 1), Err(ChartError::Width { .. })), "{width}");
    }
}

#[test]
fn charts_keep_within_their_indices() {
    for entry in CHARTS {
        let chart = entry.build(None, 1).expect("every chart can be built");
        assert!(chart.inks().len() < 1 << 15);
        assert!(chart.shape_count() < usize::from(u16::MAX), "{}", entry.name);
    }
}

#[test]
#[ignore = "prints times; meaningful in a release build on a quiet machine"]
fn times() {
    let mut dice = Dice(10);
    for entry in CHARTS {
        let start = std::time::Instant::now();
        let chart = entry.build(None, 1).expect("every chart can be built");
        let build = start.elapsed();
        let count = 1 << 20;
        let x: Vec<f64> = (0..count).map(|_| 0.5 * chart.width_mm() * dice.throw()).collect();
        let y: Vec<f64> = (0..count).map(|_| 0.5 * chart.height_mm() * dice.throw()).collect();
        let mut inks = vec![0; count];
        let mut best = f64::INFINITY;
        for _ in 0..7 {
            let start = std::time::Instant::now();
            chart.ink_at_batch(&x, &y, &mut inks, Isa::detect());
            best = best.min(start.elapsed().as_secs_f64() * 1e9 / count as f64);
        }
        println!(
            "{:14} {:5} shapes, built in {:6.1} ms, {:7} bytes, {best:5.1} ns a point",
            entry.name,
            chart.shape_count(),
            build.as_secs_f64() * 1e3,
            chart.grid_bytes()
        );
    }
}
