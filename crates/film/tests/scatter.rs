//! Scatter in rendered planes: sine targets, points, and the light that is kept.

use spectra_film::raster::Raster;
use spectra_film::scatter::{Mtf, Scatter};
use std::f64::consts::PI;

/// Contrast of a sine target of about `frequency` cycles/mm, rendered by the means over the pixels and scattered, over
/// its contrast before; measured by its Fourier component over whole periods in the middle. Also its frequency.
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

#[test]
fn sine_targets_recover_friesers_curve() {
    let mtf = Mtf::frieser(0.0147).expect("a constant");
    for (pitch, limit) in [(0.002, 150.0), (0.004, 95.0), (0.006, 64.0)] {
        for frequency in [5.0, 10.0, 20.0, 30.0, 50.0, 60.0, 80.0, 100.0] {
            for slanted in [false, true] {
                let (got, at) = contrast(&mtf, pitch, frequency, slanted);
                if at <= limit {
                    let want = mtf.response(at);
                    println!("{pitch} mm, {at:.1} cycles/mm: {got:.4} of {want:.4}");
                    assert!((got - want).abs() < 0.01 * want, "{pitch} {at}: {got} {want}");
                }
            }
        }
    }
}

#[test]
fn sine_targets_recover_a_measured_curve() {
    // A curve of the shape that makers print, no overshoot.
    let points = [[5.0, 0.99], [10.0, 0.965], [20.0, 0.87], [40.0, 0.62], [60.0, 0.43], [100.0, 0.22]];
    let mtf = Mtf::measured(&points).expect("a curve");
    // At the points themselves: 256 pixels hold a whole number of periods of a frequency that is close; what is left
    // is the slope of the curve.
    for [frequency, response] in points {
        let (got, at) = contrast(&mtf, 0.004, frequency, false);
        let want = response + mtf.response(at) - mtf.response(frequency);
        println!("{at:.1} cycles/mm: {got:.4} of {want:.4}");
        assert!((got - want).abs() < 0.01, "{at}: {got} {want}");
    }
}

/// On pixels of any size: nothing negative, all light kept, and the kernel says how well it follows.
#[test]
fn point_stays_positive_and_whole() {
    let mtf = Mtf::frieser(0.0147).expect("a constant");
    for (pitch, residual) in [(0.001, 1e-3), (0.006, 2e-3), (0.012, 0.04), (0.1, 0.01)] {
        let raster = Raster::new(301, 301, pitch);
        let mut plane = vec![0.0; raster.pixels()];
        plane[150 * 301 + 150] = 1e5;
        let scatter = Scatter::new(&mtf, &raster).expect("a curve");
        scatter.apply(&mut plane);
        let sum: f64 = plane.iter().map(|v| f64::from(*v)).sum();
        println!(
            "{pitch} mm: sum {:.9}, center {:.4}, residual {:.5}",
            sum / 1e5,
            plane[150 * 301 + 150] / 1e5,
            scatter.residual()
        );
        assert!((sum / 1e5 - 1.0).abs() < 1e-6, "{pitch}: {sum}");
        assert!(plane.iter().all(|v| *v >= 0.0));
        assert!(scatter.residual() <= residual, "{pitch}: {}", scatter.residual());
    }
}

/// The spread of a point is round: as much at 45 degrees as along the rows, K0(r / a) on fine pixels.
#[test]
fn point_is_friesers() {
    let mtf = Mtf::frieser(0.0147).expect("a constant");
    let pitch = 0.0005;
    let raster = Raster::new(401, 401, pitch);
    let mut plane = vec![0.0; raster.pixels()];
    plane[200 * 401 + 200] = 1.0;
    Scatter::new(&mtf, &raster).expect("a curve").apply(&mut plane);
    let a = 0.0147 / (2.0 * std::f64::consts::LN_10);
    // K0(x) = integral of exp(-x cosh t) over t from 0 on (Abramowitz and Stegun 9.6.24).
    let k0 = |x: f64| (0..40_000).map(|i| (-x * ((f64::from(i) + 0.5) * 5e-4).cosh()).exp() * 5e-4).sum::<f64>();
    for (x, y) in [(6, 0), (12, 0), (9, 9), (20, 0), (14, 14)] {
        let r = f64::from(x * x + y * y).sqrt() * pitch;
        let want = k0(r / a) / (2.0 * PI * a * a) * pitch * pitch;
        let got = f64::from(plane[(200 + y as usize) * 401 + 200 + x as usize]);
        assert!((got / want - 1.0).abs() < 0.02, "{x} {y}: {got} {want}");
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
