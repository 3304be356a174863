//! Bundled scenes that each show one kind of surface.

use super::plane::{Plane, mean};
use super::taken::{Taken, first};
use super::{Found, Promise, hold};
use std::f64::consts::FRAC_PI_2;

const CHART: &[&str] = &["imager.resolution=192", "render.samples=32"];

/// Returns the mean index of a glass, weighted with the scene's light and a channel's response.
fn index(taken: &Taken, medium: usize, response: &[f64]) -> f64 {
    let (grid, light) = (&taken.scene.grid, taken.scene.source.spectrum());
    let n: Vec<f64> =
        grid.wavelengths_nm().zip(response).map(|(nm, r)| taken.scene.lens.index(medium, nm) * r).collect();
    light.seen_by(&n) / light.seen_by(response)
}

/// Returns the centers of two black squares of the resolution chart, in X and in Z.
fn squares(taken: &Taken, places: [[f64; 2]; 2], half: [f64; 2]) -> [[[f64; 2]; 2]; 2] {
    ["X", "Z"].map(|name| {
        let plane = taken.channel(name);
        places.map(|place| {
            let ground = mean([-1.0, 1.0].into_iter().map(|side| {
                plane.mean(([place[0], place[1] + 0.93 * side * half[1]], [0.8 * half[0], 0.06 * half[1]]))
            }));
            plane.dark((place, half), ground, 0.967).1
        })
    })
}

/// Returns the contrast of a Siemens star of 72 spokes at a radius of 6 mm, for the horizontal and for the vertical spokes.
fn astigmatism(taken: &Taken) -> [f64; 2] {
    let y = taken.channel("Y");
    [0.0, FRAC_PI_2].map(|at| y.spokes([0.0; 2], 6.0, 72.0, Some([at, 0.26])))
}

/// Returns how far a vertical line of the grid departs from a straight line, mm RMS. The line crosses the middle of the frame at
/// `across`.
fn wave(light: &Plane, across: f64) -> f64 {
    let middles: Vec<[f64; 2]> = (-9..=9)
        .map(|k| {
            let y = 0.9 * f64::from(k);
            let line = light.along(0, ([across, y], [0.55, 0.45]));
            let ground = line.iter().map(|[_, v]| *v).fold(f64::MAX, f64::min);
            let sum: f64 = line.iter().map(|[_, v]| v - ground).sum();
            [y, line.iter().map(|[x, v]| x * (v - ground)).sum::<f64>() / sum]
        })
        .collect();
    let x = mean(middles.iter().map(|m| m[1]));
    let slope =
        middles.iter().map(|m| m[0] * (m[1] - x)).sum::<f64>() / middles.iter().map(|m| m[0] * m[0]).sum::<f64>();
    mean(middles.iter().map(|m| (m[1] - x - slope * m[0]).powi(2))).sqrt()
}

/// Checks the image of a point behind a plate with (n - 1) 0.004 mm of coma over 12 mm, 50 mm in front of the film. Rays land at a (3
/// r^2 (2 + cos 2t) - 2) along the comet and at 3 a r^2 sin 2t across it, where a is the coma times 50 / 12. Over the whole aperture
/// the variances are 4.5 a^2 and 1.5 a^2 about a center at distance a from the axis. The tip of the comet lies at -2 a.
fn coma(taken: &[Taken]) -> Vec<Found> {
    let y = taken[0].channel("Y");
    let n = taken[0].scene.lens.index(taken[0].scene.lens.elements[0].medium_after, 546.07);
    let a = (n - 1.0) * 0.004 * 50.0 / 12.0;
    let ([x, up], [along, across]) = y.moments(([0.0; 2], [0.3, 0.3]));
    vec![
        Found::near("center of the light along the comet, mm", x, a, 0.03),
        Found::within("center across the comet, mm", up, 0.0, 2e-4),
        Found::near("spread along the comet, mm", along.sqrt(), (4.5 * a * a).sqrt(), 0.03),
        Found::near("spread across the comet, mm", across.sqrt(), (1.5 * a * a).sqrt(), 0.03),
        Found::within("tip of the comet, mm", y.brightest()[0], -2.0 * a, 0.006),
    ]
}

/// Checks the image of a point through a glass cone of 5 degrees, 150 mm in front of the film: a ring, wider in blue than in red.
fn ring(taken: &[Taken]) -> Vec<Found> {
    let cone = 0.0874887_f64.atan();
    let medium = taken[0].scene.lens.elements[1].medium_after;
    let both = [0, 2].map(|k: usize| {
        let (plane, response) = &taken[0].channels()[k];
        let radius = plane.all().map(|([x, y], value)| x.hypot(y) * value).sum::<f64>() / plane.sum();
        let bent = (index(&taken[0], medium, response) * cone.sin()).asin() - cone;
        [radius, 150.0 * bent.tan()]
    });
    let [[red, red_wanted], [blue, blue_wanted]] = both;
    vec![
        Found::near("radius in X, mm", red, red_wanted, 0.02),
        Found::near("blue outside of red by", blue - red, blue_wanted - red_wanted, 0.15),
        Found::above("light in the ring", in_ring(&taken[0].light(), red), 0.98),
    ]
}

fn in_ring(light: &Plane, radius: f64) -> f64 {
    let is_in = |p: [f64; 2]| (p[0].hypot(p[1]) / radius - 1.0).abs() < 0.08;
    light.all().filter(|(p, _)| is_in(*p)).map(|(_, value)| value).sum::<f64>() / light.sum()
}

/// Checks that the lines g, e and C make a star each, with 600 lines per mm in order 1 and a lens of 150 mm whose axis is the
/// direction of e.
fn stars(taken: &[Taken]) -> Vec<Found> {
    let [x, y, z] = ["X", "Y", "Z"].map(|name| taken[0].channel(name));
    let turned = |nm: f64| (nm * 1e-6 * 600.0).asin();
    let mut all = Vec::new();
    let light = taken[0].light();
    let mut sum = 0.0;
    for (nm, main, other) in [(435.84, &z, &y), (546.07, &y, &z), (656.27, &x, &y)] {
        let at = 150.0 * (turned(nm) - turned(546.07)).tan();
        // The chart is 9 mm wide, and white beside its star.
        let window = ([at, 0.0], [5.0, 6.0]);
        let of = |plane: &Plane| plane.part(window).map(|(_, value)| value).sum::<f64>();
        sum += of(&light);
        all.push(Found::within(&format!("{nm} nm at mm"), light.center(window)[0], at, 0.06));
        all.push(Found::above(
            &format!("{nm} nm, light of its own channel over that of the next one"),
            of(main) / of(other),
            2.0,
        ));
    }
    all.push(Found::above("of the light in three stars", sum / light.sum(), 0.999));
    all
}

pub const SURFACES: &[Promise] = &[
    Promise {
        scene: "surfaces/biconic",
        pictures: &[first(CHART)],
        says: "two ellipses crossed at right angles: astigmatism on the axis",
        held: |t| {
            // The spokes are 0.52 mm apart. The film is 1.3 mm off the focus of one section and 3.8 mm off the focus of the other.
            let [level, upright] = astigmatism(&t[0]);
            vec![Found::above("upright spokes", upright, 0.4), Found::below("level spokes", level, 0.15)]
        },
    },
    Promise {
        scene: "surfaces/toroid",
        pictures: &[first(CHART)],
        says: "a spectacle lens with a cylinder: horizontal lines are sharp where vertical lines are not",
        held: |t| {
            let [level, upright] = astigmatism(&t[0]);
            vec![Found::above("level spokes", level, 0.6), Found::below("upright spokes", upright, 0.2)]
        },
    },
    Promise {
        scene: "surfaces/cylinder",
        pictures: &[first(&["imager.resolution=128", "render.samples=32"])],
        says: "an anamorphic attachment squeezes the chart horizontally by about half",
        held: |t| {
            // Two black squares are 320 mm apart horizontally on the chart, and two others 188 mm apart vertically.
            let y = t[0].channel("Y");
            let middle = |at: [f64; 2], half: [f64; 2]| y.dark_middle((at, half));
            let across = [-2.66, 2.66].map(|x| middle([x, 0.29], [1.05, 2.1])[0]);
            let up = [-8.76, 8.76].map(|x| [-2.9, 2.9].map(|y| middle([x, y], [0.6, 1.1])[1]));
            let squeeze = mean(up.iter().map(|[low, high]| high - low)) / 188.0 / ((across[1] - across[0]) / 320.0);
            vec![Found::near("vertical over horizontal scale", squeeze, 1.9, 0.05)]
        },
    },
    Promise {
        scene: "surfaces/mirrors",
        pictures: &[first(&["imager.resolution=192", "render.samples=96"])],
        says: "a Newtonian reflector: upright, and free of color errors",
        held: |t| {
            let [x, z] = squares(&t[0], [[-2.6, 0.13], [2.6, 0.13]], [1.0, 1.1]);
            let apart = (0..2).map(|k| (x[k][0] - z[k][0]).hypot(x[k][1] - z[k][1])).fold(0.0, f64::max);
            // The patches are at the bottom: in their last row, white is on the left and black on the right.
            let y = t[0].channel("Y");
            let patch = |column: f64| y.mean(([1.06 * (column - 2.5), -4.1 - 1.5 * 1.06], [0.3; 2]));
            vec![
                // Behind a wedge of flint this is 0.1 mm.
                Found::below("distance between squares in X and in Z, mm", apart, 0.045),
                Found::above("white on the left over black on the right", patch(0.0) / patch(5.0), 10.0),
            ]
        },
    },
    Promise {
        scene: "surfaces/tilted-plane",
        pictures: &[first(&["imager.resolution=192", "render.samples=64"])],
        says: "a wedge of flint: everything has a color fringe at its top and bottom",
        held: |t| {
            let medium = t[0].scene.lens.elements[0].medium_after;
            let wedge = 4_f64.to_radians();
            let bent = |response: &[f64]| (index(&t[0], medium, response) * wedge.sin()).asin() - wedge;
            let channels = t[0].channels();
            let wanted = 50.0 * (bent(channels[2].1).tan() - bent(channels[0].1).tan());
            let [x, z] = squares(&t[0], [[-5.05, -2.55], [5.05, -2.55]], [1.85, 2.0]);
            let apart = |k: usize| mean((0..2).map(|i| x[i][k] - z[i][k]));
            vec![
                Found::near("X above Z, mm", apart(1), wanted, 0.15),
                Found::within("X beside Z, mm", apart(0), 0.0, 0.02),
            ]
        },
    },
    Promise {
        scene: "surfaces/porro",
        pictures: &[first(&["imager.resolution=128", "render.samples=32"])],
        says: "a pair of Porro prisms rotates the picture by half a turn",
        held: |t| {
            // The patches are at the top now. In their first row, which is the lower one, bluish green is on the left and dark skin
            // on the right.
            let [x, y, z] = ["X", "Y", "Z"].map(|name| t[0].channel(name));
            let at = |plane: &Plane, column: f64, row: f64| plane.mean(([1.05 * column, 4.05 + 1.05 * row], [0.3; 2]));
            vec![
                Found::above("bluish green over dark skin", at(&y, -2.5, -1.5) / at(&y, 2.5, -1.5), 2.0),
                Found::above("blue: Z over X", at(&z, 2.5, 0.5) / at(&x, 2.5, 0.5), 1.5),
                Found::above("red: X over Z", at(&x, 0.5, 0.5) / at(&z, 0.5, 0.5), 2.0),
            ]
        },
    },
    Promise {
        scene: "surfaces/sag-table",
        pictures: &[first(&["imager.resolution=180", "render.samples=32"])],
        says: "a grid behind a window of drawn glass: its lines are wavy",
        held: |t| {
            let light = t[0].light();
            let lines = [-2.42, -1.21, 0.0, 1.21, 2.42].map(|across| wave(&light, across));
            vec![Found::above(
                "waviness of the straightest line, um",
                1e3 * lines.into_iter().fold(f64::MAX, f64::min),
                50.0,
            )]
        },
    },
    Promise {
        scene: "surfaces/odd-asphere",
        pictures: &[first(&["imager.resolution=192", "render.rays=200000"])],
        says: "a point through an axicon: a ring, blue outside, red inside",
        held: ring,
    },
    Promise {
        scene: "surfaces/zernike",
        pictures: &[first(&["imager.resolution=192", "render.rays=100000"])],
        says: "a point behind a plate with coma",
        held: coma,
    },
    Promise {
        scene: "surfaces/grating",
        pictures: &[first(&["imager.resolution=144", "render.samples=64"])],
        says: "three spectral lines through a grating: a star for each line",
        held: stars,
    },
];

#[test]
fn surfaces_do_what_they_are_for() {
    hold(SURFACES);
}
