//! Tests the transform of polygons against quadratures, and that of round ones against Airy's pattern.

use spectra_diffraction::{Polygon, Wings};
use std::f64::consts::{PI, TAU};

/// Abscissas and weights of Gauss's rule over [0, 1].
fn gauss(n: usize) -> Vec<[f64; 2]> {
    (0..n)
        .map(|i| {
            let mut x = (PI * (i as f64 + 0.75) / (n as f64 + 0.5)).cos();
            let mut slope = 1.0;
            for _ in 0..50 {
                let (mut p, mut before) = (1.0, 0.0);
                for k in 0..n {
                    let k = k as f64;
                    (p, before) = (((2.0 * k + 1.0) * x * p - k * before) / (k + 1.0), p);
                }
                slope = n as f64 * (x * p - before) / (x * x - 1.0);
                x -= p / slope;
            }
            [0.5 * (1.0 - x), 1.0 / ((1.0 - x * x) * slope * slope)]
        })
        .collect()
}

/// The mean of exp(i k r) over the triangles from the centroid to each edge.
fn quadrature(opening: &Polygon, k: [f64; 2]) -> [f64; 2] {
    let rule = gauss(48);
    let mut sum = [0.0; 2];
    for ring in opening.rings() {
        for (a, b) in ring.iter().zip(ring.iter().cycle().skip(1)) {
            let twice = a[0] * b[1] - a[1] * b[0];
            for [u, wu] in &rule {
                for [v, wv] in &rule {
                    let p = [0, 1].map(|i| u * (a[i] + v * (b[i] - a[i])));
                    let phase = k[0] * p[0] + k[1] * p[1];
                    let weight = wu * wv * u * twice / opening.area();
                    sum[0] += weight * phase.cos();
                    sum[1] += weight * phase.sin();
                }
            }
        }
    }
    sum
}

fn l_shape() -> Polygon {
    let outer = vec![[0.0, 0.0], [3.0, 0.0], [3.0, 1.0], [1.0, 1.0], [1.0, 2.5], [0.0, 2.5]];
    let hole = vec![[0.2, 0.2], [0.2, 0.6], [0.7, 0.4]];
    Polygon::new(vec![outer, hole]).unwrap()
}

#[test]
fn amplitudes_are_those_of_a_quadrature() {
    for opening in [Polygon::regular(7, 1.0, 0.2), Polygon::regular(8, 1.0, 0.0), l_shape()] {
        let mut worst = 0.0_f64;
        let normals: Vec<f64> = Wings::new(&opening).fans().iter().map(|f| f.normal[1].atan2(f.normal[0])).collect();
        for far in [0.0, 1e-18, 1e-12, 1e-7, 1e-4, 1e-2, 0.3, 1.0, 3.7, 11.0, 24.0] {
            let random = (0..12).map(|i| 0.37 + f64::from(i) * 0.61);
            // Exactly across an edge, and next to that.
            let across = normals.iter().flat_map(|a| [0.0, 1e-14, 1e-9, 1e-5, 1e-2].map(|off| a + off));
            for angle in random.chain(across) {
                let k = [far * angle.cos(), far * angle.sin()];
                let (found, want) = (opening.amplitude(k), quadrature(&opening, k));
                worst = worst.max((found[0] - want[0]).abs()).max((found[1] - want[1]).abs());
            }
        }
        println!("worst difference {worst:.1e} of the peak");
        assert!(worst < 1e-12, "{worst:e}");
    }
}

/// An opening in direction cosines with the area of the circle of this f-number.
fn stop(blades: u32, f_number: f64) -> Polygon {
    let half = PI / f64::from(blades);
    let radius = 0.5 / f_number * (half / (half.sin() * half.cos())).sqrt();
    Polygon::regular(blades, radius, 0.0)
}

const GREEN_MM: f64 = 550e-6;

#[test]
fn seven_blades_make_fourteen_spikes_and_eight_make_eight() {
    for (blades, spikes) in [(7, 14), (8, 8)] {
        for f_number in [16.0, 5.6] {
            let wings = Wings::new(&stop(blades, f_number));
            let around: Vec<f64> = (0..3600)
                .map(|i| {
                    let a = TAU * f64::from(i) / 3600.0;
                    wings.intensity([3.0 * a.cos(), 3.0 * a.sin()], [0.03; 2], GREEN_MM, false)
                })
                .collect();
            let mean = around.iter().sum::<f64>() / 3600.0;
            let begins = (0..3600).filter(|i| around[*i] > mean && around[(*i + 3599) % 3600] <= mean).count();
            assert_eq!(begins, spikes, "{blades} blades at f/{f_number}");
        }
    }
}

/// Compares the wings with the mean of the exact intensity over square cells of some fringes, out to 10 mm.
#[test]
fn wings_are_the_mean_over_fringes() {
    for (blades, f_number) in [(7, 16.0), (8, 16.0), (7, 5.6)] {
        let opening = stop(blades, f_number);
        let wings = Wings::new(&opening);
        // Along a spike: a square of fringes, each sampled ten times.
        let fringe = GREEN_MM * f_number;
        let normal = wings.fans()[0].normal;
        for r in [0.5, 1.0, 3.0, 10.0] {
            for (name, off) in [("spike", 0.0), ("between", PI / f64::from(blades) / 2.0)] {
                let angle = f64::atan2(normal[1], normal[0]) + off;
                let center = [r * angle.cos(), r * angle.sin()];
                let (half, n) = (12.0 * fringe, 240);
                let mut sum = 0.0;
                for i in 0..n * n {
                    let at = |k: i32| (f64::from(k) + 0.5) / f64::from(n) * 2.0 - 1.0;
                    let [x, y] = [center[0] + half * at(i % n), center[1] + half * at(i / n)];
                    sum += opening.intensity([TAU / GREEN_MM * x, TAU / GREEN_MM * y]);
                }
                let exact = sum / f64::from(n * n) * opening.area() / GREEN_MM.powi(2);
                // The wings fall by a few percent across the square.
                let part = |i: i32| {
                    let at = |k: i32| half * ((f64::from(k) + 0.5) / 8.0 - 1.0);
                    let place = [center[0] + at(i % 16), center[1] + at(i / 16)];
                    wings.intensity(place, [half / 16.0; 2], GREEN_MM, false)
                };
                let found = (0..256).map(part).sum::<f64>() / 256.0;
                println!(
                    "{blades} blades f/{f_number} {name} at {r} mm: {found:.4e} {exact:.4e}, {:.4}",
                    found / exact
                );
                assert!((found / exact - 1.0).abs() < 0.01, "{found:e} {exact:e}");
            }
        }
    }
}

/// First zero at 1.21967 wavelengths times f-number, and 83.78 % of the light within it (Born and Wolf, 8.5.2).
#[test]
fn a_round_opening_makes_airys_pattern() {
    let opening = Polygon::regular(360, 1.0 / 32.0, 0.0);
    let at = |r: f64| opening.intensity([TAU / GREEN_MM * r, 0.0]);
    let step = GREEN_MM * 16.0 * 1e-4;
    let zero = (10_000..14_000).map(|i| f64::from(i) * step).min_by(|a, b| at(*a).total_cmp(&at(*b))).unwrap();
    let want = 1.219_669_891 * GREEN_MM * 16.0;
    assert!((zero / want - 1.0).abs() < 0.005, "{zero} {want}");
    for (radius, share) in [(1.219_67, 0.837_785), (2.233_13, 0.909_903)] {
        let end = radius * GREEN_MM * 16.0;
        let n = 4000;
        let ring = |i: i32| {
            let r = (f64::from(i) + 0.5) / f64::from(n) * end;
            at(r) * TAU * r * end / f64::from(n)
        };
        let inside: f64 = (0..n).map(ring).sum::<f64>() * opening.area() / GREEN_MM.powi(2);
        assert!((inside / share - 1.0).abs() < 0.005, "{inside} {share}");
    }
    let wings = Wings::new(&opening);
    // The fraction beyond r is 2 / (pi^2 r), with r in wavelengths times f-number.
    let r = 100.0 * GREEN_MM * 16.0;
    assert!((wings.fraction_beyond(r, GREEN_MM) / (2.0 / (PI * PI * 100.0)) - 1.0).abs() < 1e-3);
}

#[test]
fn what_lies_within_a_convex_polygon_is_cut_out() {
    let square = Polygon::new(vec![vec![[0.0, 0.0], [2.0, 0.0], [2.0, 2.0], [0.0, 2.0]]]).unwrap();
    let cut = square.within(&[[1.0, -1.0], [5.0, -1.0], [5.0, 5.0], [1.0, 5.0]]).unwrap();
    assert!((cut.area() - 2.0).abs() < 1e-12 && (cut.center()[0] - 1.5).abs() < 1e-12, "{cut:?}");
    assert!(square.within(&[[3.0, 0.0], [4.0, 0.0], [4.0, 1.0]]).is_none());
}

/// The lattice has the values at its places, and corners on a line may be removed.
#[test]
fn the_lattice_is_the_closed_form() {
    let sides = |opening: &Polygon| {
        let ring = &opening.rings()[0];
        let cut = ring.iter().zip(ring.iter().cycle().skip(1));
        Polygon::new(vec![
            cut.flat_map(|(a, b)| (0..5).map(move |i| [0, 1].map(|k| a[k] + (b[k] - a[k]) * f64::from(i) / 5.0)))
                .collect(),
        ])
    };
    for opening in [Polygon::regular(7, 1.0, 0.2), Polygon::regular(8, 1.0, PI / 8.0), l_shape()] {
        let (step, count) = (0.37, 40);
        for (k, found) in opening.lattice(step, count).into_iter().enumerate() {
            let at = [(k % 81) as f64 - 40.0, (k / 81) as f64];
            let want = opening.intensity(at.map(|v| v * step));
            assert!((found - want).abs() < 1e-14, "{at:?}: {found:e} {want:e}");
        }
    }
    let seven = Polygon::regular(7, 1.0, 0.2);
    let simple = sides(&seven).unwrap().simplified(1e-9);
    assert_eq!(simple.rings()[0].len(), 7);
    assert!((simple.area() / seven.area() - 1.0).abs() < 1e-12);
}
