//! Tests of scatter in rendered planes: sine targets, points, and conservation of light.

use spectra_film::raster::Raster;
use spectra_film::scatter::{Modulation, Mtf, Scatter};
use spectra_film::stock::Stock;
use spectra_scene::FileResources;
use std::f64::consts::PI;

/// Contrast of a scattered sine target of about `frequency` cycles/mm, relative to its contrast before. The target is rendered by means
/// over the pixels, and measured by its Fourier component over whole periods in the middle. Also returns its frequency.
fn contrast(mtf: &Mtf, pitch: f64, frequency: f64, slanted: bool) -> (f64, f64) {
    let side = 512;
    let raster = Raster::new(side, side, pitch);
    // Whole periods over the measured middle.
    let middle = 256.0;
    let periods = (frequency * pitch * middle).round().max(1.0);
    let per_pixel = periods / middle;
    let phase = |x: usize, y: usize| 2.0 * PI * per_pixel * (x as f64 + if slanted { y as f64 } else { 0.0 });
    let mut plane: Vec<f32> =
        (0..raster.pixels()).map(|k| (1.0 + 0.6 * phase(k % side, k / side).cos()) as f32).collect();
    Scatter::new(mtf, &raster).expect("a curve").apply(&mut plane);
    let (mut c, mut mean) = (0.0, 0.0);
    for y in 128..384 {
        for x in 128..384 {
            let v = f64::from(plane[y * side + x]);
            c += v * phase(x, y).cos();
            mean += v;
        }
    }
    let slant = if slanted { 2.0_f64.sqrt() } else { 1.0 };
    (2.0 * c / mean / 0.6, per_pixel / pitch * slant)
}

/// Response of a kernel of pixel integrals to samples of a sine of `across` and `down` cycles per pixel: the curve times the pixel's own
/// loss, at that frequency and at all its aliases.
fn of_pixels(mtf: &Mtf, pitch: f64, across: f64, down: f64) -> f64 {
    let loss = |x: f64| if x == 0.0 { 1.0 } else { (PI * x).sin() / (PI * x) };
    let mut sum = 0.0;
    for k in -60..61 {
        for l in -60..61 {
            let (u, v) = (across - f64::from(k), down - f64::from(l));
            let lost = loss(u) * loss(v);
            if lost.abs() > 1e-12 {
                sum += mtf.response((u * u + v * v).sqrt() / pitch) * lost;
            }
        }
    }
    sum
}

#[test]
fn sine_targets_recover_friesers_curve() {
    let mtf = Mtf::frieser(0.0147).expect("a constant");
    for (k, f) in [5.0, 20.0, 60.0, 150.0].into_iter().enumerate() {
        let x = PI * 0.0147 * f / std::f64::consts::LN_10;
        assert!((mtf.response(f) - 1.0 / (1.0 + x * x)).abs() < 1e-6, "{k}: {f}");
    }
    for (pitch, limit) in [(0.002, 150.0), (0.004, 95.0), (0.006, 64.0)] {
        for frequency in [5.0, 10.0, 20.0, 30.0, 50.0, 60.0, 80.0, 100.0] {
            for slanted in [false, true] {
                let (got, at) = contrast(&mtf, pitch, frequency, slanted);
                if at <= limit {
                    let a_pixel = at * pitch / if slanted { 2.0_f64.sqrt() } else { 1.0 };
                    let want = of_pixels(&mtf, pitch, a_pixel, if slanted { a_pixel } else { 0.0 });
                    println!("{pitch} mm, {at:.1} cycles/mm: {got:.4} of {want:.4}");
                    assert!((got - want).abs() < 0.003, "{pitch} {at}: {got} {want}");
                }
            }
        }
    }
}

#[test]
fn sine_targets_recover_a_measured_curve() {
    // A curve of the shape that makers print, without overshoot.
    let points = [[5.0, 0.99], [10.0, 0.965], [20.0, 0.87], [40.0, 0.62], [60.0, 0.43], [100.0, 0.22]];
    let mtf = Mtf::measured(&points).expect("a curve");
    // At the points themselves: 256 pixels hold a whole number of periods of a close frequency; the remaining difference comes from the
    // slope of the curve.
    for [frequency, response] in points {
        let (got, at) = contrast(&mtf, 0.002, frequency, false);
        let lost = (PI * at * 0.002).sin() / (PI * at * 0.002);
        let want = response + mtf.response(at) - mtf.response(frequency);
        println!("{at:.1} cycles/mm: {:.4} of {want:.4}", got / lost);
        assert!((got / lost - want).abs() < 0.01, "{at}: {got} {want}");
    }
}

/// Light on the pixel `i` across and `j` down from a point, by 16 x 16 Gauss-Legendre points of the radial function in each part of the
/// pixel. Does not use the method that builds the kernel.
fn on_pixel(per_mm2: impl Fn(f64) -> f64, pitch: f64, i: usize, j: usize, finest: f64) -> f64 {
    // Abscissas and weights of eight points (Abramowitz and Stegun, table 25.4), both signs.
    const X: [f64; 4] = [0.183434642495650, 0.525532409916329, 0.796666477413627, 0.960289856497536];
    const W: [f64; 4] = [0.362683783378362, 0.313706645877887, 0.222381034453374, 0.101228536290376];
    let parts = (pitch / finest).ceil().max(1.0) as usize;
    let step = pitch / parts as f64;
    let points = |k: usize| {
        let first = (k as f64 - 0.5) * pitch;
        (0..parts)
            .flat_map(|p| {
                let middle = first + (p as f64 + 0.5) * step;
                (0..8).map(move |n| {
                    let sign = if n < 4 { 1.0 } else { -1.0 };
                    (middle + sign * X[n % 4] * step / 2.0, W[n % 4] * step / 2.0)
                })
            })
            .collect::<Vec<(f64, f64)>>()
    };
    let (across, down) = (points(i), points(j));
    let row =
        |(y, wy): &(f64, f64)| across.iter().map(|(x, wx)| wx * per_mm2((x * x + y * y).sqrt())).sum::<f64>() * wy;
    down.iter().map(row).sum()
}

/// A point on every layer that has a curve, and by Frieser's model, on pixels of any size. Each pixel has the integral of one falling
/// function of the distance, within 3 % down to 1e-6 of the peak. Nothing is negative, and no light is lost.
#[test]
fn a_point_is_one_round_falling_function_on_pixels_of_any_size() {
    let resources = FileResources::beside("/nowhere".as_ref());
    let mut all = vec![("Frieser".to_owned(), Mtf::frieser(0.0147).expect("a constant"))];
    for name in Stock::bundled() {
        for layer in &Stock::load(name, &resources).unwrap_or_else(|faults| panic!("{faults}")).layers {
            if !layer.mtf.is_empty() {
                all.push((format!("{name}, {}", layer.name), Modulation::measured(&layer.mtf).expect("a curve").mtf));
            }
        }
    }
    assert!(all.len() >= 9);
    for (name, mtf) in all {
        let spread = mtf.spread();
        let mut before = f64::INFINITY;
        for k in 0..3000 {
            let now = spread.per_mm2(f64::from(k) * 1e-4);
            assert!(now <= before && now >= 0.0, "{name}: it rises at {k}");
            before = now;
        }
        let narrowest = spread.terms().iter().map(|t| t[0]).fold(f64::INFINITY, f64::min);
        // Sampled once, because it is evaluated at many points.
        let samples: Vec<f64> = (0..60_002).map(|k| spread.per_mm2(f64::from(k) * 2e-5)).collect();
        let sampled = |r: f64| {
            let place = (r * 5e4).min(60_000.0);
            let k = place as usize;
            samples[k] + (samples[k + 1] - samples[k]) * (place - k as f64)
        };
        for pitch in [0.002, 0.006, 0.012, 0.0375, 0.075] {
            let side = 301;
            let raster = Raster::new(side, side, pitch);
            let mut plane = vec![0.0; raster.pixels()];
            plane[150 * side + 150] = 1e5;
            Scatter::new(&mtf, &raster).expect("a curve").apply(&mut plane);
            let sum: f64 = plane.iter().map(|v| f64::from(*v)).sum();
            assert!((sum / 1e5 - 1.0).abs() < 1e-5 && plane.iter().all(|v| *v >= 0.0), "{name} {pitch}: {sum}");
            let got = |i: usize, j: usize| f64::from(plane[(150 + j) * side + 150 + i]) / 1e5;
            let peak = got(0, 0);
            let (mut worst, mut farthest) = (0.0_f64, 0);
            // Along a row, along the diagonal, and between. Near the point, the finest Gaussian needs many parts.
            for (a, b) in [(1, 0), (1, 1), (2, 1)] {
                for n in (0..75).filter(|n| n % 3 == 0 || *n < 9) {
                    let (i, j) = (a * n, b * n);
                    if got(i, j) < 1e-6 * peak {
                        break;
                    }
                    let finest = if n == 0 { narrowest.max(1e-4) } else { 0.003 };
                    let want = on_pixel(sampled, pitch, i, j, finest);
                    worst = worst.max((got(i, j) / want - 1.0).abs());
                    farthest = farthest.max(n);
                }
            }
            println!("{name}, {pitch} mm: center {peak:.4}, to pixel {farthest}, worst {worst:.5}");
            assert!(worst < 0.03, "{name} {pitch}: {worst}");
        }
    }
}

/// Compares with `reference/spread.py`, which integrates in polar coordinates: every pixel down to 1e-6 of the peak, within 3 %.
#[test]
fn points_are_those_of_an_independent_program() {
    let resources = FileResources::beside("/nowhere".as_ref());
    let all: serde_json::Value = serde_json::from_str(include_str!("../reference/spread.json")).expect("JSON");
    let entries = all.as_array().expect("a list");
    assert_eq!(entries.len(), 8 * 5);
    for entry in entries {
        let (name, layer) = (entry["stock"].as_str().expect("a name"), entry["layer"].as_str().expect("a name"));
        let pitch = entry["pitch_um"].as_f64().expect("a pitch") / 1e3;
        let stock = Stock::load(name, &resources).unwrap_or_else(|faults| panic!("{faults}"));
        let layer = stock.layers.iter().find(|l| l.name == layer).expect("a layer");
        let mtf = Modulation::measured(&layer.mtf).expect("a curve").mtf;
        let raster = Raster::new(161, 161, pitch);
        let mut plane = vec![0.0; raster.pixels()];
        plane[80 * 161 + 80] = 1.0;
        Scatter::new(&mtf, &raster).expect("a curve").apply(&mut plane);
        for point in entry["points"].as_array().expect("points") {
            let [i, j, want] = [0, 1, 2].map(|k| point[k].as_f64().expect("a number"));
            let got = f64::from(plane[(80 + j as usize) * 161 + 80 + i as usize]);
            assert!((got / want - 1.0).abs() < 0.03, "{name} {} {pitch} {i} {j}: {got} {want}", layer.name);
        }
    }
}

/// On fine pixels, equal distances along rows and obliquely have equal light: (3, 4) and 5, (5, 12) and 13, (8, 15) and 17.
#[test]
fn a_point_is_round() {
    let resources = FileResources::beside("/nowhere".as_ref());
    for (name, pitch) in [("kodak-tri-x-400", 0.002), ("kodak-tri-x-400", 0.001), ("kodak-vision3-250d-5207", 0.002)] {
        let stock = Stock::load(name, &resources).unwrap_or_else(|faults| panic!("{faults}"));
        let mtf = Modulation::measured(&stock.layers[0].mtf).expect("a curve").mtf;
        let raster = Raster::new(61, 61, pitch);
        let mut plane = vec![0.0; raster.pixels()];
        plane[30 * 61 + 30] = 1.0;
        Scatter::new(&mtf, &raster).expect("a curve").apply(&mut plane);
        let at = |i: usize, j: usize| f64::from(plane[(30 + j) * 61 + 30 + i]);
        for (i, j, r) in [(3, 4, 5), (4, 3, 5), (5, 12, 13), (8, 15, 17)] {
            if at(r, 0) < 1e-6 * at(0, 0) {
                continue;
            }
            let off = at(i, j) / at(r, 0) - 1.0;
            println!("{name} {pitch}: {i} {j} against {r}: {off:+.5}");
            assert!(off.abs() < 0.03, "{name} {i} {j}: {off}");
        }
    }
}

#[test]
fn even_light_stays_and_bad_pitches_are_refused() {
    let mtf = Mtf::frieser(0.02).expect("a constant");
    let raster = Raster::new(200, 150, 0.005);
    let mut plane = vec![3.0; raster.pixels()];
    Scatter::new(&mtf, &raster).expect("a curve").apply(&mut plane);
    assert!((plane[75 * 200 + 100] - 3.0).abs() < 1e-6);
    for pitch in [0.0, -1.0, f64::NAN, 1e-7] {
        assert!(Scatter::new(&mtf, &Raster::new(200, 150, pitch)).is_err(), "{pitch}");
    }
}
