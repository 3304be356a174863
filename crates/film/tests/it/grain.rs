//! Tests of grain in rendered planes: RMS granularity, Selwyn's law, the same film at every zoom, no lattice.

use spectra_film::grain::{Grain, usual_half_power};
use spectra_film::raster::Raster;

/// Returns a plane of even density.
fn patch(grain: &Grain, raster: &Raster, density: f32) -> Vec<f32> {
    let mut plane = vec![density; raster.pixels()];
    grain.apply(&mut plane, raster);
    plane
}

/// Means over round apertures of `diameter_mm` in a square grid of that spacing; pixels at the edge count by their area inside (8 by 8
/// points).
fn apertures(plane: &[f32], raster: &Raster, diameter_mm: f64) -> Vec<f64> {
    let pitch = raster.pitch_mm;
    let many = (raster.width as f64 * pitch / diameter_mm + 1e-9).floor() as usize;
    let down = (raster.height as f64 * pitch / diameter_mm + 1e-9).floor() as usize;
    let mut means = Vec::new();
    for b in 0..down {
        for a in 0..many {
            let center = [(a as f64 + 0.5) * diameter_mm / pitch, (b as f64 + 0.5) * diameter_mm / pitch];
            let radius = diameter_mm / 2.0 / pitch;
            let range = |c: f64, end: usize| (c - radius).max(0.0) as usize..((c + radius).ceil() as usize).min(end);
            let (mut sum, mut area) = (0.0, 0.0);
            for y in range(center[1], raster.height) {
                for x in range(center[0], raster.width) {
                    let mut inside = 0;
                    for k in 0..64 {
                        let dx = x as f64 + (f64::from(k % 8) + 0.5) / 8.0 - center[0];
                        let dy = y as f64 + (f64::from(k / 8) + 0.5) / 8.0 - center[1];
                        inside += i32::from(dx * dx + dy * dy <= radius * radius);
                    }
                    sum += f64::from(inside) * f64::from(plane[y * raster.width + x]);
                    area += f64::from(inside);
                }
            }
            means.push(sum / area);
        }
    }
    means
}

fn mean_and_deviation(values: &[f64]) -> (f64, f64) {
    let n = values.len() as f64;
    let mean = values.iter().sum::<f64>() / n;
    (mean, (values.iter().map(|v| (v - mean) * (v - mean)).sum::<f64>() / (n - 1.0)).sqrt())
}

/// Kodak Tri-X 400: 17 (F-4017); Eastman Double-X 5222: 14 (H-1-5222). 3600 apertures give a standard error of 1.2 %.
#[test]
fn rms_granularity_is_the_sheets() {
    for (rms, seed) in [(17.0, 1), (14.0, 2), (5.0, 3)] {
        let grain = Grain::calibrated(rms, usual_half_power(rms), seed, 0).expect("a granularity");
        for pitch in [0.002, 0.004, 0.006, 0.008] {
            let side = (60.0 * 0.048 / pitch) as usize;
            let raster = Raster::new(side, side, pitch);
            let (mean, deviation) = mean_and_deviation(&apertures(&patch(&grain, &raster, 1.0), &raster, 0.048));
            println!("RMS {rms} at {:.0} um pixels: {:.2}, mean {mean:.5}", pitch * 1e3, deviation * 1e3);
            assert!((deviation * 1e3 / rms - 1.0).abs() < 0.05, "{pitch}: {}", deviation * 1e3);
            assert!((mean - 1.0).abs() < 4.0 * rms / 1e3 / 60.0, "{mean}");
        }
    }
}

/// Bessel function of order 1, by its integral (Abramowitz and Stegun 9.1.21).
fn j1(x: f64) -> f64 {
    let steps = 400;
    let at = |k: i32| (f64::from(k) + 0.5) / f64::from(steps) * std::f64::consts::PI;
    (0..steps).map(at).map(|t| (t - x * t.sin()).cos()).sum::<f64>() / f64::from(steps)
}

/// Through an aperture of any size, the deviation follows from the Wiener spectrum: the integral of the spectrum times that of the
/// aperture, 2 J1(pi d f) / (pi d f) squared.
/// Selwyn's law, a constant deviation times diameter, holds for large apertures; at 24 um, clumps reduce it by a sixth.
#[test]
fn apertures_read_what_the_wiener_spectrum_says() {
    let grain = Grain::calibrated(17.0, 35.0, 11, 0).expect("a granularity");
    let raster = Raster::new(3600, 3600, 0.002);
    let plane = patch(&grain, &raster, 1.0);
    let expected = |diameter: f64| {
        let step = 0.25;
        let ring = |k: i32| {
            let f = (f64::from(k) + 0.5) * step;
            let x = std::f64::consts::PI * diameter * f;
            let aperture = 2.0 * j1(x) / x;
            grain.wiener(f) * aperture * aperture * std::f64::consts::TAU * f * step
        };
        (0..2000).map(ring).sum::<f64>().sqrt()
    };
    let at48 = 0.017 / expected(0.048);
    for diameter in [0.024, 0.036, 0.048, 0.072, 0.096] {
        let found = mean_and_deviation(&apertures(&plane, &raster, diameter)).1;
        let ratio = found / (at48 * expected(diameter));
        println!("{:.0} um: {ratio:.4}, over Selwyn's {:.4}", diameter * 1e3, found * diameter / 0.017 / 0.048);
        assert!((ratio - 1.0).abs() < 0.05, "{diameter}: {ratio}");
    }
}

/// Wiener spectrum of an even negative at the density 1, with 1 um pixels, averaged over 256 blocks of 256 x 256 pixels. It falls to half
/// of its value at low frequencies between 20 and 60 cycles/mm, along rows, columns and diagonals, and has a foot of crystals.
#[test]
fn wiener_spectrum_falls_to_half_where_clumps_end() {
    let grain = |seed: u64| Grain::calibrated(17.0, usual_half_power(17.0), seed, 0).expect("a granularity");
    let (side, block, pitch) = (2048, 256, 0.001);
    let planes: Vec<Vec<f32>> = (0..4).map(|seed| patch(&grain(seed), &Raster::new(side, side, pitch), 1.0)).collect();
    let grain = grain(0);
    let turns = |k: usize| std::f64::consts::TAU * k as f64 / block as f64;
    let (cosines, sines): (Vec<f64>, Vec<f64>) = (0..block).map(|k| (turns(k).cos(), turns(k).sin())).unzip();
    // Power at whole cycles per block.
    let power = |u: i32, v: i32| {
        let mut sum = 0.0;
        for (plane, by) in planes.iter().flat_map(|plane| (0..side / block).map(move |by| (plane, by))) {
            for bx in 0..side / block {
                let (mut re, mut im) = (0.0, 0.0);
                for y in 0..block {
                    let row = &plane[(by * block + y) * side + bx * block..][..block];
                    for (x, d) in row.iter().enumerate() {
                        let cycles = (u * x as i32 + v * y as i32).rem_euclid(block as i32);
                        re += (f64::from(*d) - 1.0) * cosines[cycles as usize];
                        im += (f64::from(*d) - 1.0) * sines[cycles as usize];
                    }
                }
                sum += re * re + im * im;
            }
        }
        sum
    };
    // Each is known to 1 / 16; frequencies of a band are averaged. One cycle per block is 3.9 cycles/mm.
    let mean = |places: &[(i32, i32)]| places.iter().map(|(u, v)| power(*u, *v)).sum::<f64>() / places.len() as f64;
    let low = mean(&[(1, 0), (0, 1), (1, 1), (1, -1), (2, 0), (0, 2)]);
    let around = |n: i32, m: i32| mean(&[(n, 0), (0, n), (m, m), (m, -m)]) / low;
    let (at20, at60, at150) = (around(5, 4), around(15, 11), around(38, 27));
    println!("at 20 cycles/mm {at20:.3}, at 60 {at60:.3}, at 150 {at150:.3}");
    assert!(at20 > 0.5 && at60 < 0.5, "{at20} {at60}");
    assert!((0.02..0.2).contains(&at150), "{at150}");
    for (n, m) in [(5, 4), (9, 6), (15, 11)] {
        let (straight, aslant) = (mean(&[(n, 0), (0, n)]) / low, mean(&[(m, m), (m, -m)]) / low);
        let want = grain.wiener(f64::from(n) / 0.256);
        println!("{:.0} cycles/mm: {straight:.3}, aslant {aslant:.3}, stated {want:.3}", f64::from(n) / 0.256);
        // 512 blocks each: a standard error of 4.4 %, and of `low` 2.5 %; diagonal frequencies are whole numbers, so up to 6 % off.
        assert!((straight / want - 1.0).abs() < 0.2 && (aslant / want - 1.0).abs() < 0.3, "{straight} {aslant} {want}");
    }
}

/// The deviation grows with the square root of the density, the mean stays, and no density is negative.
#[test]
fn deviation_grows_with_the_root_of_the_density() {
    let grain = Grain::calibrated(17.0, 35.0, 4, 0).expect("a granularity");
    for pitch in [0.0015, 0.006] {
        let side = (50.0 * 0.048 / pitch) as usize;
        let raster = Raster::new(side, side, pitch);
        for density in [0.02, 0.1, 0.4, 1.0, 2.5] {
            let plane = patch(&grain, &raster, density);
            let (mean, deviation) = mean_and_deviation(&apertures(&plane, &raster, 0.048));
            let (density, want) = (f64::from(density), 0.017 * f64::from(density).sqrt());
            println!("{pitch} mm, D {density}: mean {mean:.5}, deviation over the root {:.4}", deviation / want);
            assert!((mean - density).abs() < 4.0 * want / 50.0, "{density}: {mean}");
            // 2500 apertures: a standard error of 1.4 %.
            assert!((deviation / want - 1.0).abs() < 0.06, "{density}: {}", deviation / want);
            assert!(plane.iter().all(|d| *d >= 0.0));
        }
    }
}

/// Means over the same 48 um squares of the same film, from pixels of different sizes (each a whole fraction of the square), agree; those
/// of a different seed do not.
#[test]
fn same_film_at_every_zoom() {
    let grain = Grain::calibrated(17.0, 35.0, 5, 0).expect("a granularity");
    let many = 40;
    let means = |grain: &Grain, pixels: usize, density: f32| -> Vec<f64> {
        let side = many * pixels;
        let plane = patch(grain, &Raster::new(side, side, 0.048 / pixels as f64), density);
        let mut sums = vec![0.0; many * many];
        for (k, v) in plane.iter().enumerate() {
            sums[k / side / pixels * many + k % side / pixels] += f64::from(*v) / (pixels * pixels) as f64;
        }
        sums
    };
    for (density, least) in [(0.1, [0.96, 0.96, 0.96, 0.96]), (1.0, [0.998, 0.998, 0.998, 0.998])] {
        let fine = means(&grain, 48, density);
        let (middle, deviation) = mean_and_deviation(&fine);
        for (pixels, least) in [24, 16, 8, 5].into_iter().zip(least) {
            let coarse = means(&grain, pixels, density);
            let (mean, other) = mean_and_deviation(&coarse);
            let both: f64 = fine.iter().zip(&coarse).map(|(a, b)| (a - middle) * (b - mean)).sum();
            let correlation = both / (fine.len() as f64 - 1.0) / deviation / other;
            println!("D {density}, {pixels} pixels: correlation {correlation:.4}, deviation {:.4}", other / deviation);
            assert!(correlation > least, "{density} {pixels}: {correlation}");
            assert!((other / deviation - 1.0).abs() < 0.05, "{density} {pixels}: {}", other / deviation);
        }
        let stranger = means(&Grain::calibrated(17.0, 35.0, 6, 0).expect("a granularity"), 24, density);
        let (mean, other) = mean_and_deviation(&stranger);
        let both: f64 = fine.iter().zip(&stranger).map(|(a, b)| (a - middle) * (b - mean)).sum();
        assert!((both / 1599.0 / deviation / other).abs() < 4.0 / 40.0);
    }
}

#[test]
fn same_bits_for_any_tile_and_threads() {
    let grain = Grain::calibrated(17.0, 35.0, 7, 1).expect("a granularity");
    let raster = Raster { offset_px: [-130, 4000], ..Raster::new(500, 300, 0.0061) };
    let picture = |raster: &Raster| -> Vec<f32> {
        (0..raster.pixels())
            .map(|k| {
                let x = raster.offset_px[0] + (k % raster.width) as i64;
                let y = raster.offset_px[1] + (k / raster.width) as i64;
                ((x * 31 + y * 17).rem_euclid(97)) as f32 / 40.0
            })
            .collect()
    };
    let mut whole = picture(&raster);
    let pool = rayon::ThreadPoolBuilder::new().num_threads(3).build().expect("threads");
    pool.install(|| grain.apply(&mut whole, &raster));
    for (x, y, width, height) in [(0, 0, 500, 300), (33, 70, 101, 77), (499, 299, 1, 1), (64, 128, 64, 64)] {
        let part = raster.part(x, y, width, height);
        let mut plane = picture(&part);
        let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build().expect("threads");
        pool.install(|| grain.apply(&mut plane, &part));
        for row in 0..height {
            let want = &whole[(y + row) * 500 + x..][..width];
            assert!(plane[row * width..][..width] == *want, "{x} {y} row {row}");
        }
    }
}

/// Neighboring pixels are correlated only over the width of a clump. Farther ones are not, along the axes, diagonally, and over any
/// distance (a lattice or tiles would show as ridges).
#[test]
fn far_pixels_are_independent() {
    let grain = Grain::calibrated(17.0, 35.0, 8, 0).expect("a granularity");
    for pitch in [0.0062, 0.0099, 0.031] {
        let (width, height) = (1024, 768);
        let plane = patch(&grain, &Raster::new(width, height, pitch), 1.0);
        let values: Vec<f64> = plane.iter().map(|v| f64::from(*v)).collect();
        let (mean, deviation) = mean_and_deviation(&values);
        let at = |dx: usize, dy: usize| {
            let (mut sum, mut pairs) = (0.0, 0.0);
            for y in 0..height - dy {
                for x in 0..width - dx {
                    sum += (values[y * width + x] - mean) * (values[(y + dy) * width + x + dx] - mean);
                    pairs += 1.0;
                }
            }
            (sum / pairs / deviation / deviation, pairs)
        };
        let (next, _) = at(1, 0);
        let (below, _) = at(0, 1);
        println!("{pitch} mm: neighbors {next:.4} {below:.4}");
        assert!((next - below).abs() < 0.01 && (0.0..0.5).contains(&next), "{next} {below}");
        // A clump is 8 um wide, and ends within three pixels.
        let clear = |(dx, dy): &(usize, usize)| *dx.max(dy) as f64 * pitch > 0.033;
        for (dx, dy) in
            [(2, 0), (3, 0), (0, 2), (4, 4), (5, 0), (8, 0), (16, 0), (32, 0), (64, 0), (0, 64), (63, 1), (128, 128)]
                .into_iter()
                .filter(clear)
        {
            let (correlation, pairs) = at(dx, dy);
            assert!(correlation.abs() < 4.5 / pairs.sqrt() + 1e-3, "{pitch}: lag {dx} {dy}: {correlation}");
        }
        // The deviation is the same in every column and row: no moire of pixels and cells.
        let column = |x: usize| mean_and_deviation(&(0..height).map(|y| values[y * width + x]).collect::<Vec<_>>()).1;
        let deviations: Vec<f64> = (0..width).map(|x| column(x) / deviation).collect();
        let (_, spread) = mean_and_deviation(&deviations);
        let expected = (1.0 / (2.0 * height as f64)).sqrt();
        println!("spread of the columns' deviations {spread:.5}, expected {expected:.5}");
        assert!((spread / expected - 1.0).abs() < 0.15, "{spread} {expected}");
    }
}

#[test]
fn layers_are_independent_and_odd_densities_stay() {
    let raster = Raster::new(300, 300, 0.006);
    let planes: Vec<Vec<f32>> =
        (0..2).map(|layer| patch(&Grain::calibrated(10.0, 35.0, 9, layer).expect("one"), &raster, 1.0)).collect();
    let n = raster.pixels() as f64;
    let moments = |p: &[f32]| mean_and_deviation(&p.iter().map(|v| f64::from(*v)).collect::<Vec<_>>());
    let ((a, sa), (b, sb)) = (moments(&planes[0]), moments(&planes[1]));
    let both: f64 = planes[0].iter().zip(&planes[1]).map(|(x, y)| (f64::from(*x) - a) * (f64::from(*y) - b)).sum();
    assert!((both / n / sa / sb).abs() < 5.0 / n.sqrt());
    let mut odd = vec![0.0, -0.1, f32::NAN, f32::INFINITY];
    Grain::calibrated(17.0, 35.0, 9, 0).expect("one").apply(&mut odd, &Raster::new(4, 1, 0.006));
    assert!(odd[0] == 0.0 && odd[1] == -0.1 && odd[2].is_nan() && odd[3] == f32::INFINITY);
    let none = patch(&Grain::calibrated(0.0, 35.0, 9, 0).expect("one"), &raster, 0.7);
    assert!(none.iter().all(|v| *v == 0.7));
}
