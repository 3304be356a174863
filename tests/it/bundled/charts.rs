//! Charts through lenses: where they are imaged, how bright and how sharp.

use super::colors::{Block, reflected};
use super::plane::{Plane, edge, mean};
use super::taken::{Taken, first, member};
use super::{Found, Promise, hold};
use std::f64::consts::PI;

const SMALL: &[&str] = &["imager.resolution=96", "render.samples=64"];

/// Checks the middle square of the slanted-edge chart. It is 100 mm of the design's 1500 mm wide and has reflectance 0.2 on 0.8, so
/// it must have a quarter of the light around it, its size, and its place in the middle. One mm of the design is `design_mm` mm of
/// the chart.
fn square(taken: &Taken, plane: &Plane, [distance_mm, design_mm]: [f64; 2]) -> Vec<Found> {
    let mm = taken.magnification(distance_mm) * design_mm;
    let found = middle_square(plane, mm, [0.0, 84.0]);
    vec![
        Found::within("dark over bright", found.0, 0.25, 0.01),
        Found::near("side of the square", found.1, 100.0, 0.03),
        Found::within("horizontal center of the square", found.2[0], 0.0, 2.0),
        Found::within("vertical center of the square", found.2[1], 0.0, 2.0),
    ]
}

/// Returns the light of the middle square over that of the ground, its side and its center, in mm of the design. One mm of the design
/// is `mm` mm on the film. The search starts at height `up` and reaches `half` above and below it.
fn middle_square(plane: &Plane, mm: f64, [up, half]: [f64; 2]) -> (f64, f64, [f64; 2]) {
    let beside = |x: f64| plane.mean(([x * mm, 0.0], [28.0 * mm; 2]));
    let ground = 0.5 * (beside(-100.0) + beside(100.0));
    let (area, center) = plane.dark(([0.0, up * mm], [95.0 * mm, half * mm]), ground, 0.75);
    let dark = plane.mean((center, [28.0 * mm; 2]));
    (dark / ground, area.sqrt() / mm, center.map(|at| at / mm))
}

const BIOTAR: [f64; 2] = [2000.0, 1.0];

pub const EDGES: &[Promise] = &[
    Promise {
        scene: "bench/sampling-d65-ortho",
        pictures: &[first(SMALL)],
        says: "a slanted edge in daylight, on orthochromatic film",
        held: |t| square(&t[0], &t[0].light(), BIOTAR),
    },
    Promise {
        scene: "bench/sampling-d65-xyz",
        pictures: &[first(SMALL)],
        says: "a slanted edge in daylight, in XYZ color",
        held: |t| square(&t[0], &t[0].light(), BIOTAR),
    },
    Promise {
        scene: "bench/sampling-fl11-ortho",
        pictures: &[first(SMALL)],
        says: "a slanted edge under a fluorescent lamp, on orthochromatic film",
        held: |t| square(&t[0], &t[0].light(), BIOTAR),
    },
    Promise {
        scene: "bench/sampling-fl11-xyz",
        pictures: &[first(SMALL)],
        says: "a slanted edge under a fluorescent lamp, in XYZ color",
        held: |t| square(&t[0], &t[0].light(), BIOTAR),
    },
    Promise {
        scene: "bench/sampling-mercury-ortho",
        pictures: &[first(SMALL)],
        says: "a slanted edge under a mercury lamp, on orthochromatic film",
        held: |t| square(&t[0], &t[0].light(), BIOTAR),
    },
    Promise {
        scene: "bench/sampling-mirror-ortho",
        pictures: &[first(SMALL)],
        says: "a slanted edge through mirrors only",
        held: |t| {
            // The chart is 9 m wide. The vertical position of the square is not checked: in focusing at 100 m the film moves along
            // the axis of the last mirror, which is at 45 degrees, and this shifts the picture by 0.37 mm.
            let mm = 200.0 / (100_000.0 - 200.0) * 6.0;
            let (ratio, side, [x, _]) = middle_square(&t[0].light(), mm, [16.0, 105.0]);
            vec![
                Found::within("dark over bright", ratio, 0.25, 0.01),
                Found::near("side of the square", side, 100.0, 0.05),
                Found::within("horizontal center of the square", x, 0.0, 2.0),
            ]
        },
    },
    Promise {
        scene: "bench/sampling-pinhole-ortho",
        pictures: &[first(SMALL)],
        says: "a slanted edge through a pinhole",
        held: |t| {
            // The chart is 1.2 m wide at 1 m, and the film is 50 mm behind the pinhole.
            let (ratio, side, [x, y]) = middle_square(&t[0].light(), 0.05 * 1.2 / 1.5, [0.0, 84.0]);
            vec![
                Found::within("dark over bright", ratio, 0.25, 0.01),
                Found::near("side of the square", side, 100.0, 0.03),
                Found::within("distance of the center from the axis", x.hypot(y), 0.0, 2.0),
            ]
        },
    },
    Promise {
        scene: "bench/sampling-d65-sensor",
        // Such a small frame lies inside the dark square of the chart, so the edge that the scene mentions is not in it.
        pictures: &[first(&["render.samples=64"]), first(&["render.samples=64", "source.chart=white"])],
        says: "a chart under D65 behind the color filters of a camera",
        held: |t| {
            let all = ([0.0; 2], [0.6, 0.4]);
            let channels = t.iter().map(Taken::channels).collect::<Vec<_>>();
            let light = t[0].scene.source.spectrum();
            let [red, green, blue] = [0, 1, 2].map(|k| channels[0][k].0.mean_of_lit(all));
            let [r, g, b] = [0, 1, 2].map(|k| light.seen_by(channels[0][k].1));
            let white = channels[1][1].0.mean_of_lit(all);
            vec![
                Found::near("red over green", red / green, r / g, 0.05),
                Found::near("blue over green", blue / green, b / g, 0.05),
                Found::within("green over the green of a white chart", green / white, 0.2, 0.01),
            ]
        },
    },
    Promise {
        scene: "bench/sampling-frame-d65-ortho",
        pictures: &[first(&["imager.resolution=192", "render.samples=32"])],
        says: "a whole frame: a resolution chart in daylight",
        held: |t| {
            let mm = t[0].magnification(2000.0);
            let block = Block { middle: [0.0, -252.0 * mm], pitch: 65.0 * mm, half: 0.5 };
            // Fourteen grays of density 0.05 to 1.48 from left to right, slightly closer to the middle because of the lens's
            // distortion.
            let light = t[0].light();
            let gray = |step: f64| light.mean(([45.0 * (step - 6.5) * 0.99 * mm, 412.5 * 0.99 * mm], [0.35, 0.35]));
            vec![
                reflected(&t[0], &block, "D65"),
                Found::within(
                    "density from the first gray to the eleventh",
                    (gray(0.0) / gray(10.0)).log10(),
                    1.1,
                    0.1,
                ),
                Found::within(
                    "density from the first gray to the seventh",
                    (gray(0.0) / gray(6.0)).log10(),
                    0.66,
                    0.06,
                ),
            ]
        },
    },
    Promise {
        scene: "bench/forward-190m",
        pictures: &[first(&["imager.resolution=96", "render.rays=600000"])],
        says: "a chart at 2 m, the Biotar wide open, traced forward",
        held: |t| {
            let (mm, light) = (t[0].magnification(2000.0), t[0].light());
            let at = |x: f64| light.mean(([x * mm, 8.0 * mm], [30.0 * mm; 2]));
            let ground = mean([-222.0, 222.0].into_iter().map(|x| light.mean(([x * mm, 0.0], [10.0 * mm, 40.0 * mm]))));
            // Squares of reflectance 0.03 and 0.225 on 0.9. At the outer squares the lens loses 8 % of the light.
            vec![
                Found::is("forward", t[0].rendering.estimators == ["forward"]),
                Found::within("black", 0.5 * (at(-160.0) + at(160.0)) / ground, 0.033, 0.01),
                Found::within("gray", 0.5 * (at(-285.0) + at(285.0)) / ground, 0.25, 0.03),
            ]
        },
    },
];

/// Returns the transmittance of all surfaces by Fresnel's equations at normal incidence, at the d line.
pub fn fresnel(taken: &Taken) -> f64 {
    let lens = &taken.scene.lens;
    let part = |element: &spectra_lens::Element| {
        let [n, m] = [element.medium_before, element.medium_after].map(|medium| lens.index(medium, 587.56));
        1.0 - ((n - m) / (n + m)).powi(2)
    };
    lens.elements.iter().map(part).product()
}

/// Checks a gray card of 18 %: pi L T / (4 N^2 (1 + m)^2) in the middle, falling toward the corners. There a lens of 1927 wide open
/// has far less light than the fourth power of the cosine.
fn vignetting(taken: &[Taken]) -> Vec<Found> {
    let y = taken[0].channel("Y");
    let ring = |from: f64, to: f64| {
        let is_in = |p: [f64; 2]| (from..to).contains(&p[0].hypot(p[1]));
        mean(y.all().filter(|(p, _)| is_in(*p)).map(|(_, value)| value))
    };
    let rings = [ring(0.0, 3.0), ring(6.0, 9.0), ring(12.0, 15.0), ring(17.0, 19.0), ring(20.0, 22.0)];
    let n = taken[0].scene.lens.marginal_ray().expect("the lens has sizes").f_number();
    let m = taken[0].magnification(2000.0);
    let wanted = PI * 0.18 * 300.0 * fresnel(&taken[0]) / (4.0 * n * n * (1.0 + m) * (1.0 + m));
    let falls = rings.windows(2).map(|pair| pair[1] / pair[0]).fold(0.0, f64::max);
    vec![
        // At f/1.4, oblique rays lose slightly more at the surfaces.
        Found::near("lx in the middle", rings[0], wanted, 0.06),
        Found::below("each ring over the one inside", falls, 0.9),
        Found::below("corner over middle", rings[4] / rings[0], 0.35),
    ]
}

/// Returns the contrast of a Siemens star inside a crop. The star is located by its darkness and measured where its spokes are 7 mm
/// of the design apart.
fn star(light: &Plane, mm: f64, cycles: f64) -> f64 {
    let half = if cycles > 40.0 { 95.0 } else { 58.0 } * mm;
    let mut center = [0.0; 2];
    for _ in 0..4 {
        center = light.dark_middle((center, [half; 2]));
    }
    light.spokes(center, cycles * 7.0 * mm / (2.0 * PI), cycles, None)
}

/// Returns the widths from a quarter to three quarters of three horizontal edges: top, middle and bottom.
fn level_edges(taken: &Taken) -> [f64; 3] {
    let y = taken.channel("Y");
    [[10.3, 0.75], [1.45, 0.5], [-10.3, 0.6]].map(|[at, half]| edge(&y.along(1, ([0.0, at], [0.7, half])))[1])
}

pub const SHARP: &[Promise] = &[
    Promise {
        scene: "gray-card",
        pictures: &[first(&["imager.resolution=48", "render.samples=64"])],
        says: "vignetting and absolute exposure",
        held: vignetting,
    },
    Promise {
        scene: "tilted",
        // A strip with horizontal edges, with the tilted back and with an upright one.
        pictures: &[
            first(&[
                "source.width=0.8 m",
                "imager={kind: xyz, width: 1.5 mm, height: 24 mm, shift: [-4.35 mm, 0], tilt: [6 deg, 0], resolution: 20}",
                "render.samples=128",
            ]),
            first(&[
                "source.width=0.8 m",
                "imager={kind: xyz, width: 1.5 mm, height: 24 mm, shift: [-4.35 mm, 0], resolution: 20}",
                "render.samples=128",
            ]),
        ],
        says: "sharp along one horizontal line only",
        held: |t| {
            let [tilted, upright] = [&t[0], &t[1]].map(level_edges);
            // At 10.3 mm from the middle the film is 1.1 mm out of focus and a point becomes a disk: an edge has its middle half
            // within 0.404 of the diameter.
            let disk = 10.3 * 6_f64.to_radians().tan() / 2.0;
            let wide = |upright: f64| (0.404 * disk).hypot(upright);
            vec![
                Found::below("upper edge, upright", upright[0], 0.15),
                Found::below("lower edge, upright", upright[2], 0.15),
                Found::near("upper edge, tilted", tilted[0], wide(upright[0]), 0.25),
                Found::near("lower edge, tilted", tilted[2], wide(upright[2]), 0.25),
                Found::below("middle, tilted over upright", tilted[1] / upright[1], 1.3),
            ]
        },
    },
    Promise {
        scene: "stops-and-stocks",
        // The star in the upper right corner at f/1.5 and f/12, and the red patch on both films at f/3.
        pictures: &[
            member(
                0,
                &[
                    "source.width=1.597 m",
                    "imager={kind: film, width: 3.2 mm, height: 3.2 mm, shift: [-14.4 mm, -8 mm], resolution: 64}",
                    "render.samples=64",
                ],
            ),
            member(
                3,
                &[
                    "source.width=1.597 m",
                    "imager={kind: film, width: 3.2 mm, height: 3.2 mm, shift: [-14.4 mm, -8 mm], resolution: 64}",
                    "render.samples=64",
                ],
            ),
            member(1, &["imager.resolution=144", "render.samples=16"]),
            member(5, &["imager.resolution=144", "render.samples=16"]),
        ],
        says: "corners get sharper as the Biotar is stopped down, and red is black only on the orthochromatic film",
        held: |t| {
            let [open, closed] = [&t[0], &t[1]].map(|taken| star(&taken.light(), 0.0268, 36.0));
            let [ortho, pan] = [&t[2], &t[3]].map(|taken| {
                let tones = taken.tones(0);
                let patch = |column: f64, row: f64| tones.mean(([1.75 * column, -6.79 + 1.75 * row], [0.5; 2]));
                // The red patch and the gray of 9 %.
                patch(-0.5, -0.5) / patch(1.5, -1.5)
            });
            vec![
                Found::below("contrast in the corner at f/1.5", open, 0.12),
                Found::above("contrast in the corner at f/12", closed, 0.3),
                Found::below("ortho: red over gray of 9 %", ortho, 0.6),
                Found::above("panchromatic: red over gray of 9 %", pan, 1.05),
            ]
        },
    },
    Promise {
        scene: "surfaces/conic",
        pictures: &[
            first(&[
                "source.width=7.85 km",
                "imager={kind: xyz, width: 5.4 mm, height: 5.4 mm, resolution: 90}",
                "render.samples=32",
            ]),
            first(&[
                "source.width=7.85 km",
                "imager={kind: xyz, width: 3.2 mm, height: 3.2 mm, shift: [-14.1 mm, -7.6 mm], resolution: 54}",
                "render.samples=64",
            ]),
        ],
        says: "sharp in the middle, blurred outward by field curvature, astigmatism and coma",
        held: |t| {
            let [middle, corner] = [star(&t[0].light(), 0.02616, 72.0), star(&t[1].light(), 0.02616, 36.0)];
            vec![
                Found::above("contrast in the middle", middle, 0.6),
                Found::below("contrast in the corner", corner, 0.1),
            ]
        },
    },
    Promise {
        scene: "surfaces/even-asphere",
        pictures: &[
            first(&[
                "source.width=1.24 km",
                "imager={kind: xyz, width: 3.2 mm, height: 3.2 mm, resolution: 80}",
                "render.samples=64",
            ]),
            first(&[
                "source.width=1.24 km",
                "imager={kind: xyz, width: 2 mm, height: 2 mm, shift: [-9.09 mm, -4.93 mm], resolution: 50}",
                "render.samples=128",
            ]),
        ],
        says: "a Schmidt camera on a flat film: sharp where the curved field touches it",
        held: |t| {
            let [middle, corner] = [star(&t[0].light(), 0.0165, 72.0), star(&t[1].light(), 0.0165, 36.0)];
            vec![
                Found::above("contrast in the middle", middle, 0.7),
                Found::below("contrast in the corner", corner, 0.2),
            ]
        },
    },
];

#[test]
fn edges_of_charts() {
    hold(EDGES);
}

#[test]
fn charts_are_sharp_where_they_should_be() {
    hold(SHARP);
}
