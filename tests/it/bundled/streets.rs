//! Streets at night: brightness, width and halo of a lamp, and the effect of haze.

use super::charts::fresnel;
use super::plane::{Plane, mean};
use super::taken::{Taken, first, member};
use super::{Found, Promise, hold};
use std::f64::consts::PI;

/// Returns the illuminance of a white sheet of this luminance in the middle of the frame, lx.
fn white_lx(taken: &Taken, luminance: f64, distance_mm: f64) -> f64 {
    let n = taken.scene.lens.marginal_ray().expect("the lens has sizes").f_number();
    let m = taken.magnification(distance_mm);
    PI * luminance * fresnel(taken) / (4.0 * n * n * (1.0 + m) * (1.0 + m))
}

const HEADLAMP: &[&str] = &[
    "source.width=5.9 m",
    "imager={kind: film, width: 3.2 mm, height: 1.8 mm, shift: [5.4 mm, 2.3 mm], resolution: 96}",
    "render.samples=4",
    "render.rays=300000",
    "render.reflections.order=0",
];

/// Returns the center of the brightest lamp and its variance, averaged over both axes.
fn brightest(light: &Plane) -> ([f64; 2], f64) {
    let mut center = light.brightest();
    for _ in 0..4 {
        center = light.center((center, [0.3; 2]));
    }
    let (_, [across, up]) = light.moments((center, [0.3; 2]));
    (center, 0.5 * (across + up))
}

pub const STREETS: &[Promise] = &[
    Promise {
        scene: "night-street",
        // The Helios as in the scene, and focused at the lamps.
        pictures: &[
            member(1, HEADLAMP),
            member(
                1,
                &[
                    "source.width=5.9 m",
                    "imager={kind: film, width: 3.2 mm, height: 1.8 mm, shift: [5.4 mm, 2.3 mm], resolution: 96}",
                    "render.samples=4",
                    "render.rays=300000",
                    "render.reflections.order=0",
                    "lens.focus=8 m",
                ],
            ),
        ],
        says: "focused nearer than the lamps: disks; and on color film the red halo of lamps",
        held: |t| {
            let lamps = [&t[0], &t[1]].map(|taken| brightest(&taken.channel("green")));
            // The variance of a disk is a sixteenth of its squared diameter.
            let disk = 4.0 * (lamps[0].1 - lamps[1].1).max(0.0).sqrt();
            let center = lamps[0].0;
            let around = |plane: &Plane, from: f64, to: f64| {
                let is_in = |p: [f64; 2]| (from..to).contains(&(p[0] - center[0]).hypot(p[1] - center[1]));
                mean(plane.all().filter(|(p, _)| is_in(*p)).map(|(_, value)| value))
            };
            let [red, green, blue] = t[0].colors(0);
            let halo = |plane: &Plane| around(plane, 0.26, 0.34);
            vec![
                Found::near("blur diameter, mm", disk, t[0].blur_mm(5000.0, 8000.0), 0.3),
                Found::above("lamp: blue over red", around(&blue, 0.0, 0.1) / around(&red, 0.0, 0.1), 0.8),
                Found::above("halo: red over green", halo(&red) / halo(&green), 1.4),
                Found::above("halo: red over blue", halo(&red) / halo(&blue), 2.0),
            ]
        },
    },
    Promise {
        scene: "bench/noise-night",
        pictures: &[first(&[
            "source.width=5.9 m",
            "imager={kind: xyz, width: 3.2 mm, height: 1.8 mm, shift: [5.4 mm, 2.3 mm], resolution: 96}",
            "render.samples=4",
            "render.rays=300000",
            "lens.focus=8 m",
        ])],
        says: "headlamps 3000 times as bright as white, the Biotar wide open",
        held: |t| {
            let y = t[0].channel("Y");
            let (center, _) = brightest(&y);
            // The color of the lamps has 0.937 of the luminance of its red. At 6 mm from the axis the lens has 0.9 of the light of
            // the middle.
            let wanted = 3000.0 * 0.937 * 0.9 * white_lx(&t[0], 100.0, 8000.0);
            vec![Found::near("lx in the middle of a lamp", y.mean((center, [0.06; 2])), wanted, 0.1)]
        },
    },
    Promise {
        scene: "hazy-street",
        pictures: &[member(0, HAZE), member(2, HAZE)],
        says: "a lens fresh from the factory, and hazy: lamps glow, and blacks turn gray",
        held: |t| {
            let lights = [&t[0], &t[1]].map(Taken::light);
            let black = lights[0].quantile(0.15);
            let of_black = |light: &Plane| {
                let dark = light.values.iter().zip(&lights[0].values).filter(|(_, clean)| **clean <= black);
                mean(dark.map(|(value, _)| *value)) / lights[0].quantile(0.5)
            };
            let [clean, hazy] = [&lights[0], &lights[1]].map(of_black);
            vec![
                Found::below("blacks over the median, clean", clean, 0.02),
                Found::above("blacks over the median, with 2 % of haze", hazy, 1.0),
            ]
        },
    },
];

const HAZE: &[&str] = &["imager.resolution=48", "render.samples=2", "render.reflections.order=0"];

#[test]
fn streets_at_night() {
    hold(STREETS);
}
