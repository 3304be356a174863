use super::svg::{Open, read};
use super::*;
use spectra_core::math;

const PI: f64 = std::f64::consts::PI;

fn drawing(body: &str, open: Option<Open>) -> Drawing {
    let text = format!(
        r#"<svg xmlns="http://www.w3.org/2000/svg" width="20mm" height="10mm" viewBox="0 0 20 10">{body}</svg>"#
    );
    read("test.svg", text.as_bytes(), None, open).unwrap_or_else(|faults| panic!("{faults}"))
}

/// Measures the open area from rows of points, whose ends are found with the drawing itself; exact to about 1e-3 mm^2.
fn area(drawing: &Drawing) -> f64 {
    let (columns, rows) = (4000, 2000);
    let at = |i: usize, count: usize, half: f64| ((i as f64 + 0.5) / count as f64 * 2.0 - 1.0) * half;
    let mut sum = 0.0;
    for row in 0..rows {
        for column in 0..columns {
            sum += drawing.transmittance(at(column, columns, 10.0), at(row, rows, 5.0));
        }
    }
    sum * 200.0 / (columns * rows) as f64
}

/// Compares areas with closed forms, in mm^2; 8 million points at 5 um leave a relative error of some 1e-4.
#[test]
fn areas_are_those_of_geometry() {
    // A pentagram of radius r has the area 5 r^2 sin(36) sin(18) / sin(54); by the even-odd rule without its pentagon, whose
    // radius is r sin(18) / sin(54).
    let r = 4.0_f64;
    let sin = |deg: f64| math::sin(f64::to_radians(deg));
    let star = 5.0 * r * r * sin(36.0) * sin(18.0) / sin(54.0);
    let inner = r * sin(18.0) / sin(54.0);
    let pentagon = 2.5 * inner * inner * sin(72.0);
    let tips: Vec<String> = (0..5)
        .map(|k| f64::from(k) * 144.0)
        .map(|a| format!("{},{}", 10.0 + r * sin(a), 5.0 - r * math::cos(a.to_radians())))
        .collect();
    let tips = tips.join(" ");
    for (body, want) in [
        (r#"<circle cx="10" cy="5" r="4"/>"#.to_owned(), PI * 16.0),
        (r#"<ellipse cx="10" cy="5" rx="6" ry="2" transform="rotate(30 10 5)"/>"#.into(), PI * 12.0),
        (r#"<rect x="2" y="1" width="10" height="6" rx="1"/>"#.into(), 60.0 - (4.0 - PI)),
        (format!(r#"<polygon points="{tips}"/>"#), star),
        (format!(r#"<polygon points="{tips}" fill-rule="evenodd"/>"#), star - pentagon),
        // The area under a parabola is two thirds of its box. Then half a disk. The area under a cubic is the integral of 24 t (1 - t)
        // times 72 t (1 - t), 1728 / 30.
        (r#"<path d="M2 8 Q10 -4 18 8 Z"/>"#.into(), 2.0 / 3.0 * 16.0 * 6.0),
        (r#"<path d="M6 5 A4 4 0 0 1 14 5 z"/>"#.into(), PI * 8.0),
        (r#"<path d="m4 8 c0-8 12-8 12 0"/>"#.into(), 57.6),
        // A ring as a stroke, a cross of strokes with square caps, and a frame with mitered corners.
        (r#"<circle cx="10" cy="5" r="3" fill="none" stroke="black" stroke-width="1"/>"#.into(), PI * 6.0),
        (r#"<path d="M6 5H14M10 1v8" fill="none" stroke="gray" stroke-linecap="square"/>"#.into(), 18.0 - 1.0),
        (r#"<rect x="4" y="2" width="6" height="6" style="fill:none;stroke:red;stroke-width:2"/>"#.into(), 64.0 - 16.0),
        (r#"<path d="M4 5h6" stroke="black" stroke-width="2" stroke-linecap="round"/>"#.into(), 12.0 + PI),
        // Two overlapping shapes are open together; `use` adds a copy of one.
        (
            r##"<defs><circle id="c" r="2"/></defs><use href="#c" x="6" y="5"/><g transform="translate(7 5)"><use href="#c" x="7"/></g>"##.into(),
            PI * 8.0,
        ),
        (r#"<style>.no{display:none} circle{fill:#123}</style><circle class="no" r="9"/><circle cx="10" cy="5" r="1"/>"#.into(), PI),
    ] {
        let got = area(&drawing(&body, None));
        assert!((got - want).abs() < 4e-4 * want + 1e-3, "{body}: {got} {want}");
    }
}

/// Checks that edges are exact. Points in a star are compared with the half-planes of its five lines if they lie farther than a nanometer
/// from all of them; a circle is exact within its stated flatness.
#[test]
fn edges_are_where_they_are_drawn() {
    let r = 4.0;
    let tip = |k: u32| {
        let a = (f64::from(k) * 144.0_f64).to_radians();
        [r * math::sin(a), r * math::cos(a)]
    };
    let points: Vec<String> = (0..5).map(|k| format!("{} {}", 10.0 + tip(k)[0], 5.0 - tip(k)[1])).collect();
    let star = drawing(&format!(r#"<polygon points="{}"/>"#, points.join(" ")), None);
    let mut compared = 0;
    for i in 0..200_000_u32 {
        // Points evenly spread with the plastic number (M. Roberts, 2018).
        let (u, v) = (f64::from(i) * 0.754_877_666_246_692_7, f64::from(i) * 0.569_840_290_998_053_2);
        let (x, y) = ((u.fract() - 0.5) * 9.0, (v.fract() - 0.5) * 9.0);
        // A point is in the pentagram if it lies on the inner side of at least four of the five lines.
        let side = |k: u32| {
            let (a, b) = (tip(k), tip(k + 1));
            let (dx, dy) = (b[0] - a[0], b[1] - a[1]);
            let cross = |x: f64, y: f64| (dx * (y - a[1]) - dy * (x - a[0])) / (dx * dx + dy * dy).sqrt();
            cross(x, y) * cross(0.0, 0.0).signum()
        };
        let sides: Vec<f64> = (0..5).map(side).collect();
        if sides.iter().any(|d| d.abs() < 1e-6) {
            continue;
        }
        let inside = sides.iter().filter(|d| **d > 0.0).count() >= 4;
        assert_eq!(star.transmittance(x, y), f64::from(inside), "{x} {y}");
        compared += 1;
    }
    assert!(compared > 199_000);
    let circle = drawing(r#"<circle cx="10" cy="5" r="4"/>"#, None);
    for k in 0..10_000 {
        let a = f64::from(k) * 0.01;
        let at = |r: f64| circle.transmittance(r * math::cos(a), r * math::sin(a));
        assert_eq!((at(4.0 - 1.01 * FLATNESS_MM), at(4.0 + 1e-9)), (1.0, 0.0), "{k}");
    }
    assert!((circle.reach_mm() - 4.0).abs() < 1e-4 && (star.reach_mm() - 4.0).abs() < 1e-12);
}

/// Checks orientation (up and right are kept), white on black if requested, and that gray and half opaque shapes pass in part.
#[test]
fn colors_count_when_they_should() {
    let body = r##"<rect width="20" height="10"/><rect x="10" width="10" height="5" fill="white"/>
        <rect x="10" y="5" width="10" height="5" fill="#fff" opacity="0.25"/>"##;
    let white = drawing(body, Some(Open::White));
    let at = |x, y| white.transmittance(x, y);
    assert_eq!((at(5.0, 2.0), at(5.0, -2.0), at(-5.0, 2.0), at(11.0, 0.0)), (1.0, 0.25, 0.0, 0.0));
    assert_eq!(drawing(body, Some(Open::Filled)).transmittance(-5.0, 2.0), 1.0);
}

fn faults(text: &str) -> Vec<String> {
    let faults = read("x.svg", text.as_bytes(), None, None).expect_err(text);
    faults.iter().map(ToString::to_string).collect()
}

#[test]
fn what_is_not_understood_is_said_with_its_place() {
    let svg = |attributes: &str, body: &str| {
        format!("<svg xmlns=\"http://www.w3.org/2000/svg\" {attributes}>\n{body}\n</svg>")
    };
    let good = r#"width="10mm" viewBox="0 0 10 10""#;
    for (attributes, body, said) in [
        (good, "  <text>star</text>", "x.svg:2:3: text is not understood"),
        (good, "<image/>", "x.svg:2:1: `image` is not understood"),
        (good, "<circle r='1' fill='url(#g)'/>", "gradient"),
        (good, "<circle r='1' clip-path='url(#g)'/>", "`clip-path`"),
        (good, "<path d='M0 0 L 1 x'/>", "its path"),
        (good, "<circle r='1e400'/>", "r: not a length"),
        (good, "<circle r='-1'/>", "r is -1"),
        (good, "<circle r='1' transform='scale(1e300)'/>", "extends too far"),
        (good, "", "nothing is painted"),
        (good, "<circle r='1'/><circle r='1' fill='white'/>", "which of them are open"),
        (good, "<use href='#a'/>", "`use` refers to nothing"),
        (good, "<g id='a'><use href='#a'/></g>", "nested elements"),
        (r#"viewBox="0 0 10 10""#, "<circle r='1'/>", "no width in mm"),
        (r#"width="1e9mm" viewBox="0 0 10 10""#, "<circle r='1'/>", "a page of"),
        ("", "<circle r='1'/>", "no viewBox"),
        (good, "<circle", "this is not an SVG"),
    ] {
        let all = faults(&svg(attributes, body));
        assert!(all.iter().any(|f| f.contains(said)), "{body}: {all:?}");
    }
    assert!(faults("<html/>")[0].contains("this is not an SVG"));
}

/// Checks that malicious files end quickly with a message.
#[test]
fn too_much_is_refused() {
    let mut body = String::from(r##"<g id="a0"><circle r="1"/></g>"##);
    for k in 0..12 {
        let uses = format!(r##"<use href="#a{k}"/>"##).repeat(10);
        body.push_str(&format!(r#"<g id="a{}">{uses}</g>"#, k + 1));
    }
    let head = r#"<svg xmlns="http://www.w3.org/2000/svg" width="10mm" viewBox="0 0 10 10">"#;
    assert!(!faults(&format!("{head}{body}</svg>")).is_empty());
    let curves = "C 1e6 1e6 -1e6 1e6 0 0 ".repeat(20_000);
    assert!(faults(&format!("{head}<path d=\"M0 0 {curves}\"/></svg>"))[0].contains("corners"));
    let round = "l 1 1 l -1 1 ".repeat(20_000);
    let line =
        format!("{head}<path stroke='red' stroke-width='9000' stroke-linejoin='round' d=\"M0 0 {round}\"/></svg>");
    assert!(faults(&line)[0].contains("corners"));
}

/// Computes the transmittance from all edges. The grid is a faster way to the same result.
fn by_all_edges(size: [f64; 2], shapes: &[Painted], at: [f64; 2]) -> f64 {
    let paints: Vec<Paint> = shapes.iter().map(|s| (s.rule, s.transmittance, s.opacity)).collect();
    let edges: Vec<Edge> = (0_u32..).zip(shapes).flat_map(|(number, shape)| edges_of(shape, number)).collect();
    let is_on = at[0].abs() <= 0.5 * size[0] && at[1].abs() <= 0.5 * size[1];
    if is_on { passing(&paints, 0.0, edges.iter(), at) } else { 0.0 }
}

/// Checks that the grid gives the same number as all edges, whatever the outlines do: cross themselves, coincide, have level edges and
/// corners on the sides of the page and of the cells, or reach far beyond the page.
#[test]
fn a_cell_says_what_all_edges_say() {
    let mut state = 1_u64;
    let mut number = move || {
        // Random numbers by Marsaglia's shifts (Xorshift RNGs, 2003).
        state ^= state << 13;
        state ^= state >> 7;
        state ^= state << 17;
        (state >> 11) as f64 / (1_u64 << 53) as f64
    };
    for (case, (corners, shapes, reach, snap)) in [
        (3, 1, 1.0, 0.0),
        (400, 1, 1.0, 0.0),
        (60, 12, 1.6, 0.25),
        (12, 80, 0.7, 0.5),
        (5, 40, 30.0, 1.0),
        (200, 3, 1.2, 0.125),
        (2000, 1, 1.0, 0.0),
    ]
    .into_iter()
    .enumerate()
    {
        let size = [8.0, 3.0];
        let mut coordinate = |k: usize| {
            let at: f64 = (number() - 0.5) * size[k] * reach;
            if snap > 0.0 { (at / snap).round() * snap } else { at }
        };
        let painted: Vec<Painted> = (0..shapes)
            .map(|shape: u32| Painted {
                outlines: (0..=shape % 2)
                    .map(|_| (0..corners).map(|_| [coordinate(0), coordinate(1)]).collect())
                    .collect(),
                rule: if shape.is_multiple_of(3) { FillRule::EvenOdd } else { FillRule::NonZero },
                transmittance: f64::from((shape * 7 + 5) % 11) / 10.0,
                opacity: if shape % 4 == 1 { 1.0 } else { 0.4 },
            })
            .collect();
        let drawing = Drawing::new(size[0], size[1], &painted);
        let own = painted.iter().flat_map(|shape| shape.outlines.iter().flatten().copied());
        // The tested points are the corners, points beside them at their heights, and points anywhere.
        let mut points: Vec<[f64; 2]> = own.take(700).flat_map(|[x, y]| [[x, y], [x - 0.01, y], [-x, y]]).collect();
        points.extend((0..3000).map(|_| [coordinate(0), coordinate(1)]));
        points.extend([[4.0, 1.5], [-4.0, -1.5], [4.0, -1.5], [-4.0, 1.5], [4.1, 0.0]]);
        for [x, y] in points {
            let (found, all) = (drawing.transmittance(x, y), by_all_edges(size, &painted, [x, y]));
            assert_eq!(found.to_bits(), all.to_bits(), "{case}: {x} {y}");
        }
    }
}

/// Checks that a cell lists few edges, for long and for short ones, and that all cells together stay within the memory limit.
#[test]
fn few_edges_are_asked() {
    let at = |i: u32| f64::from(i) * 0.754_877_666_246_692_7;
    let long = |i: u32| [(at(i).fract() - 0.5) * 40.0, (at(i * i % 9973).fract() - 0.5) * 40.0];
    let toothed = |i: u32| {
        let (r, a) = (15.0 + f64::from(i % 2), f64::from(i) * std::f64::consts::TAU / 10_000.0);
        [r * math::cos(a), r * math::sin(a)]
    };
    let long_ones = |count: u32| (0..count).map(long).collect::<Vec<_>>();
    for (corners, most) in
        [(long_ones(10_000), 60), ((0..10_000).map(toothed).collect(), 10), (long_ones(60_000), 2000)]
    {
        let count = corners.len();
        let outlines = vec![corners];
        let shape = Painted { outlines, rule: FillRule::EvenOdd, transmittance: 1.0, opacity: 1.0 };
        let drawing = Drawing::new(40.0, 40.0, &[shape]);
        let place = |i: u32, step: f64| ((f64::from(i) * step).fract() - 0.5) * 36.0;
        let asked = |i| drawing.grid.at(place(i, 0.754_877_666), place(i, 0.569_840_291)).1.count();
        let mean = (0..10_000).map(asked).sum::<usize>() / 10_000;
        assert!(mean <= most, "{count}: {mean}");
        assert!(drawing.grid.memory_bytes() < 100_000_000);
    }
}

/// Checks a square with a hole: the outer ring is counter-clockwise, the hole clockwise, whatever their direction in the file.
#[test]
fn rings_have_what_passes_on_their_left() {
    let square = |half: f64, reversed: bool| {
        let mut ring = vec![[-half, -half], [half, -half], [half, half], [-half, half]];
        if reversed {
            ring.reverse();
        }
        ring
    };
    let area = |ring: &Vec<[f64; 2]>| {
        0.5 * ring.iter().zip(ring.iter().cycle().skip(1)).map(|(a, b)| a[0] * b[1] - a[1] * b[0]).sum::<f64>()
    };
    for (a, b) in [(false, false), (true, false), (true, true)] {
        let shape = Painted {
            outlines: vec![square(3.0, a), square(1.0, b)],
            rule: FillRule::EvenOdd,
            transmittance: 1.0,
            opacity: 1.0,
        };
        let rings = Drawing::new(10.0, 10.0, &[shape]).rings().expect("plain rings");
        assert_eq!(rings.iter().map(area).collect::<Vec<_>>(), [36.0, -4.0]);
    }
    // Two squares that overlap.
    let shape = |at: f64| Painted {
        outlines: vec![square(2.0, false).iter().map(|[x, y]| [x + at, y + at]).collect()],
        rule: FillRule::NonZero,
        transmittance: 1.0,
        opacity: 1.0,
    };
    assert_eq!(Drawing::new(10.0, 10.0, &[shape(-0.5), shape(0.5)]).rings(), None);
}
