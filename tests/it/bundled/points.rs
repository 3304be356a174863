//! Scenes with points of light: where they are imaged, and as which shape.

use super::taken::{Taken, first};
use super::{Found, Promise, hold};

/// Checks that a point 2 m away, 6 degrees beside the axis and 4 above it, is imaged small and at the right place.
fn spot(taken: &Taken) -> Vec<Found> {
    let light = taken.light();
    let brightest = light.brightest();
    let center = light.center((brightest, [2.0; 2]));
    let near: f64 = light.part((brightest, [0.9; 2])).map(|(_, value)| value).sum();
    let at = |degrees: f64| taken.magnification(2000.0) * 2000.0 * degrees.to_radians().tan();
    vec![
        Found::near("mm to the right", center[0], at(6.0), 0.03),
        Found::near("mm above", center[1], at(4.0), 0.03),
        Found::above("light within 0.9 mm", near / light.sum(), 0.95),
    ]
}

/// Promises of scenes with points of light.
pub const POINTS: &[Promise] = &[
    Promise {
        scene: "bench/sampling-point-d65-xyz",
        pictures: &[first(&["imager.resolution=240", "render.rays=100000"])],
        says: "a point of daylight off the axis, in XYZ color",
        held: |t| {
            let [x, y, z] = ["X", "Y", "Z"].map(|name| t[0].channel(name).sum());
            let mut all = spot(&t[0]);
            // White is that of D65; the glass absorbs part of the violet.
            all.extend([Found::near("X over Y", x / y, 0.9505, 0.03), Found::near("Z over Y", z / y, 1.089, 0.06)]);
            all
        },
    },
    Promise {
        scene: "bench/sampling-point-fl11-ortho",
        pictures: &[first(&["imager.resolution=240", "render.rays=100000"])],
        says: "a point of fluorescent light off the axis, on orthochromatic film",
        held: |t| spot(&t[0]),
    },
    Promise {
        scene: "biotar-spot",
        pictures: &[first(&["imager.resolution=96", "render.rays=200000"])],
        says: "a cat's eye 2.4 mm long",
        held: |t| {
            let y = t[0].channel("Y");
            let spots = y.spots(0.1 * y.most(), 100);
            let [eye] = &spots[..] else { return vec![Found::is("one spot", false)] };
            let long = |degrees: u32| {
                let (sin, cos) = f64::from(degrees).to_radians().sin_cos();
                let along = eye.places.iter().map(|[x, y]| x * cos + y * sin);
                let ends = along.fold([f64::MAX, f64::MIN], |[low, high], at| [low.min(at), high.max(at)]);
                ends[1] - ends[0] + y.pixel_mm[0]
            };
            let lengths: Vec<f64> = (0..180).step_by(5).map(long).collect();
            let [short, most] = lengths.iter().fold([f64::MAX, 0.0_f64], |[a, b], l| [a.min(*l), b.max(*l)]);
            // Its height is 2.4 mm; along its own long axis it is longer.
            vec![
                Found::within("height, mm", long(90), 2.4, 0.1),
                Found::within("length, mm", most, 2.8, 0.1),
                Found::below("width over length", short / most, 0.8),
            ]
        },
    },
    Promise {
        scene: "low-pass",
        pictures: &[first(&["imager.resolution=96", "render.samples=256"])],
        says: "each point becomes four, 5 um apart",
        held: |t| {
            // Products of the picture with a shifted copy. Of four points, two coincide after a shift along one side, and one after a
            // shift along both; without plates none does.
            let y = t[0].channel("Y");
            // Leaves out the upper rows, where a bright point is cut in two.
            let meets = |dx: usize, dy: usize| -> f64 {
                let (width, height) = (96, y.values.len() / 96);
                let rows = (14..height - dy).flat_map(|row| (0..width - dx).map(move |column| (column, row)));
                rows.map(|(c, r)| y.values[r * width + c] * y.values[(r + dy) * width + c + dx]).sum()
            };
            let whole = meets(0, 0);
            // Separation by 0.85 mm of quartz: (ne^2 - no^2) / (ne^2 + no^2) of the thickness, with 1.5462 and 1.5553 at 546 nm.
            let (o, e) = (1.5462_f64.powi(2), 1.5553_f64.powi(2));
            let apart = 850.0 * (e - o) / (e + o);
            let pixel = 1e3 * y.pixel_mm[0];
            let step = (apart / pixel).round() as usize;
            vec![
                Found::within("separation, um", apart, 5.0, 0.1),
                Found::above("coincidence after a horizontal shift", meets(step, 0) / whole, 0.3),
                Found::within("vertical over horizontal", meets(0, step) / meets(step, 0), 1.0, 0.2),
                Found::within("diagonal over horizontal", meets(step, step) / meets(step, 0), 0.5, 0.12),
                Found::below("coincidence after half the shift", meets(step / 2, 0) / whole, 0.08),
            ]
        },
    },
];

#[test]
fn points_of_light() {
    hold(POINTS);
}
