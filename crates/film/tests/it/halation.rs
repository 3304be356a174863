//! Tests of halation in rendered planes: the ring, conservation of light, and light that falls outside the frame.

use spectra_film::halation::{Halation, HalationBase};
use spectra_film::raster::Raster;
use spectra_film::stock::Backing;

const ACETATE: HalationBase =
    HalationBase { thickness_mm: 0.125, index: 1.48, entering: 0.4, transmittance: 0.9, reflected: 0.0 };

/// Returns a plane with a point of `light` in the pixel (`x`, `y`).
fn point(base: &HalationBase, raster: &Raster, x: usize, y: usize, light: f32) -> Vec<f32> {
    let mut plane = vec![0.0; raster.pixels()];
    plane[y * raster.width + x] = light;
    Halation::new(base, raster).expect("a base").apply(&mut plane);
    plane
}

fn sum(plane: &[f32]) -> f64 {
    plane.iter().map(|v| f64::from(*v)).sum()
}

/// 2 t tan(asin(1/n)) = .2291 mm for t = 0.125 mm, n = 1.48: the profile rises to half of the ring there, and is highest.
#[test]
fn ring_begins_where_total_reflection_does() {
    for pitch in [0.002, 0.004, 0.006] {
        let side = (1.0 / pitch) as usize | 1;
        let raster = Raster::new(side, side, pitch);
        let plane = point(&ACETATE, &raster, side / 2, side / 2, 1e6);
        // Mean over rings one pixel wide.
        let mut rings = vec![(0.0, 0); side];
        for (k, v) in plane.iter().enumerate() {
            let (dx, dy) = ((k % side) as f64 - (side / 2) as f64, (k / side) as f64 - (side / 2) as f64);
            let ring = &mut rings[(dx * dx + dy * dy).sqrt().round() as usize];
            *ring = (ring.0 + f64::from(*v), ring.1 + 1);
        }
        let profile: Vec<f64> = rings[..side / 2].iter().map(|(s, n)| s / f64::from(*n)).collect();
        // Starts well inside the ring; the point itself is far brighter.
        let inside = (0.1 / pitch) as usize;
        let peak = (inside..profile.len()).max_by(|a, b| profile[*a].total_cmp(&profile[*b])).expect("a profile");
        let half = profile[peak] / 2.0;
        let rise = (inside..=peak).rev().find(|r| profile[*r] < half).expect("a rise");
        let begin = (rise as f64 + (half - profile[rise]) / (profile[rise + 1] - profile[rise])) * pitch;
        println!("pitch {pitch}: half of the ring at {begin:.4} mm, highest at {:.4} mm", peak as f64 * pitch);
        assert!((begin / 0.2291 - 1.0).abs() < 0.03, "{begin}");
        assert!((peak as f64 * pitch / 0.2291 - 1.0).abs() < 0.03, "{}", peak as f64 * pitch);
    }
}

/// The rendered plane agrees with the closed form at some distances.
#[test]
fn profile_is_the_closed_form() {
    let pitch = 0.006;
    let raster = Raster::new(1601, 1201, pitch);
    let plane = point(&ACETATE, &raster, 800, 600, 1e6);
    let even = 1.0 + ACETATE.returned();
    for (x, y, within) in [
        (20, 0, 0.01),
        (30, 10, 0.01),
        (45, 0, 0.01),
        (40, 30, 0.01),
        (70, 0, 0.01),
        (150, 100, 0.01),
        (600, 333, 0.01),
    ] {
        let r = f64::from(x * x + y * y).sqrt() * pitch;
        let want = 1e6 * pitch * pitch * ACETATE.density_per_mm2(r) / even;
        let got = f64::from(plane[(600 + y as usize) * 1601 + 800 + x as usize]);
        println!("{r:.3} mm: {got:.5e}, closed form {want:.5e}");
        assert!((got / want - 1.0).abs() < within, "{r} mm: {got} {want}");
    }
}

/// On pixels much finer than the ring, the light around a point follows the closed form, except on the steep inner side of the ring. It is
/// never negative.
#[test]
fn fine_pixels_have_the_same_halo() {
    for pitch in [0.006, 0.003, 0.0017] {
        let side = (1.6 / pitch) as usize;
        let raster = Raster::new(side, side, pitch);
        for (dx, dy) in [(0, 0), (1, 0), (1, 3), (2, 1)] {
            let [x0, y0] = [side / 2 + dx, side / 2 + dy];
            let plane = point(&ACETATE, &raster, x0, y0, 1e6);
            let even = 1.0 + ACETATE.returned();
            let mut worst: f64 = 0.0;
            for (k, got) in plane.iter().enumerate() {
                let [x, y] = [k % side, k / side].map(|v| v as f64);
                let r = ((x - x0 as f64) * (x - x0 as f64) + (y - y0 as f64) * (y - y0 as f64)).sqrt() * pitch;
                assert!(*got >= 0.0, "{pitch} {r}: {got}");
                if r > 0.05 && (r - ACETATE.ring_radius_mm()).abs() > 0.025 && r < 0.75 {
                    let want = 1e6 * pitch * pitch * ACETATE.density_per_mm2(r) / even;
                    worst = worst.max((f64::from(*got) / want - 1.0).abs());
                }
            }
            println!("pitch {pitch}, {dx} {dy}: within {worst:.4}");
            assert!(worst < 0.03, "{pitch}: {worst}");
        }
    }
}

/// The light that leaves the frame is what the closed form puts outside it; all other light is kept, to 1e-6.
#[test]
fn light_is_kept() {
    for (width, height, pitch, at, transmittance) in [
        (601, 401, 0.006, (300, 200), 0.9),
        (601, 401, 0.006, (20, 390), 0.6),
        (601, 401, 0.06, (300, 200), 1.0),
        (121, 81, 0.3, (60, 40), 0.9),
        (1001, 701, 0.0005, (500, 350), 0.9),
    ] {
        let base = HalationBase { transmittance, ..ACETATE };
        let raster = Raster::new(width, height, pitch);
        let plane = point(&base, &raster, at.0, at.1, 1e6);
        // Outside the frame, by angles around the point: beyond the distance to the border.
        let border = |angle: f64| {
            let (s, c) = (spectra_core::math::sin(angle), spectra_core::math::cos(angle));
            let x = if c > 0.0 { width as f64 - at.0 as f64 - 0.5 } else { at.0 as f64 + 0.5 } * pitch / c.abs();
            let y = if s > 0.0 { height as f64 - at.1 as f64 - 0.5 } else { at.1 as f64 + 0.5 } * pitch / s.abs();
            x.min(y)
        };
        let returned = base.returned();
        let angles = 720;
        let beside: f64 = (0..angles)
            .map(|k| (f64::from(k) + 0.5) * std::f64::consts::TAU / f64::from(angles))
            .map(|angle| (returned - base.returned_within(border(angle))) / f64::from(angles))
            .sum();
        let want = 1.0 - beside / (1.0 + returned);
        let got = sum(&plane) / 1e6;
        println!("{width} x {height} of {pitch} mm: {got:.9}, want {want:.9}, beside {:.3e}", 1.0 - want);
        assert!((got - want).abs() < 1e-6, "{got} {want}");
    }
}

/// Far from every border no light leaves: the sum is kept to 1e-6.
#[test]
fn absorbing_base_keeps_all_light_in_the_frame() {
    // Grazing light is absorbed, so nothing reaches 2 mm.
    let base = HalationBase { transmittance: 0.05, ..ACETATE };
    let raster = Raster::new(2001, 2001, 0.006);
    let plane = point(&base, &raster, 1000, 1000, 1e6);
    assert!((sum(&plane) / 1e6 - 1.0).abs() < 1e-6, "{}", sum(&plane));
}

/// An even exposure keeps its level away from the borders, and falls toward them as the closed form says.
#[test]
fn even_light_stays_even() {
    let raster = Raster::new(1500, 1000, 0.012);
    let mut plane = vec![2.0; raster.pixels()];
    Halation::new(&ACETATE, &raster).expect("a base").apply(&mut plane);
    let center = f64::from(plane[500 * 1500 + 750]);
    // At 6 mm from the border, at most the returned light from farther away is missing.
    let missing = (ACETATE.returned() - ACETATE.returned_within(6.0)) / (1.0 + ACETATE.returned());
    assert!(center <= 2.0 + 1e-6 && center >= 2.0 * (1.0 - missing) - 1e-6, "{center}, missing {missing}");
    // In the middle of the border, half of the returned light is missing (the pixel is half a pixel inside).
    let edge = f64::from(plane[750]);
    let want = 2.0 * (1.0 - ACETATE.returned() / 2.0 / (1.0 + ACETATE.returned()));
    assert!((edge / want - 1.0).abs() < 0.005, "{edge} {want}");
}

/// No light wraps around from the other side of the frame.
#[test]
fn nothing_wraps_around() {
    let raster = Raster::new(300, 200, 0.006);
    let plane = point(&ACETATE, &raster, 0, 100, 1e6);
    let row = &plane[100 * 300..101 * 300];
    assert!(row[299] < row[250], "{} {}", row[299], row[250]);
    let even = 1.0 + ACETATE.returned();
    let want = 1e6 * 0.006 * 0.006 * ACETATE.density_per_mm2(299.0 * 0.006) / even;
    assert!((f64::from(row[299]) / want - 1.0).abs() < 0.01, "{} {want}", row[299]);
}

#[test]
fn backing_weakens_the_ring() {
    let raster = Raster::new(201, 201, 0.006);
    let ring =
        |transmittance| point(&HalationBase { transmittance, ..ACETATE }, &raster, 100, 100, 1e6)[100 * 201 + 60];
    let (none, some) = (ring(1.0), ring(0.5));
    // Two passes at the critical angle, cos = sqrt(1 - 1/n^2). The two also differ in the light that returns from an even exposure.
    let cosine = (1.0 - 1.0 / (1.48_f64 * 1.48)).sqrt();
    let even = |t| 1.0 + HalationBase { transmittance: t, ..ACETATE }.returned();
    let want = spectra_core::math::pow(0.5, 2.0 / cosine) * even(1.0) / even(0.5);
    assert!((f64::from(some / none) / want - 1.0).abs() < 0.05, "{} {want}", some / none);
}

/// Compares the ring of a lamp for each kind of backing with an integral over angles computed here.
/// Light leaves the emulsion by Lambert's law, is reflected at the back by Fresnel's formulas for air, and passes base and backing twice at
/// its angle. The ring rises from rem-jet to a removed backing; rem-jet leaves 0.03 to 0.1 of what a dye leaves.
#[test]
fn backings_have_the_rings_of_their_kind() {
    const PITCH_MM: f64 = 0.006;
    const AT: usize = 40;
    let raster = Raster::new(201, 201, PITCH_MM);
    let reflects = |cosine: f64| {
        let sine = 1.48 * (1.0 - cosine * cosine).sqrt();
        if sine >= 1.0 {
            return 1.0;
        }
        let out = (1.0 - sine * sine).sqrt();
        let [s, p] = [(1.48 * cosine - out) / (1.48 * cosine + out), (cosine - 1.48 * out) / (cosine + 1.48 * out)];
        0.5 * (s * s + p * p)
    };
    let rings: Vec<f64> = [Backing::RemJet, Backing::Silver, Backing::Dye, Backing::Removed]
        .into_iter()
        .map(|kind| {
            let passed = kind.transmittance();
            let base = HalationBase { transmittance: passed, ..ACETATE };
            let got = f64::from(point(&base, &raster, 100, 100, 1e6)[100 * 201 + 100 + AT]);
            let back = |cosine: f64| reflects(cosine) * passed.powf(2.0 / cosine);
            // Over the square of the cosine: 2 sin cos d(angle).
            let all: f64 =
                (0..200_000).map(|i| back(((f64::from(i) + 0.5) / 200_000.0).sqrt())).sum::<f64>() / 200_000.0;
            let r = AT as f64 * PITCH_MM;
            let twice_mm = 2.0 * base.thickness_mm;
            let cosine = twice_mm / twice_mm.hypot(r);
            let density = base.entering * back(cosine) * cosine.powi(4) / (std::f64::consts::PI * twice_mm * twice_mm);
            let want = 1e6 * PITCH_MM * PITCH_MM * density / (1.0 + base.entering * all);
            println!("{}: {got:.4} {want:.4}", kind.name());
            assert!((got / want - 1.0).abs() < 0.05, "{}: {got} {want}", kind.name());
            got
        })
        .collect();
    assert!(rings.is_sorted(), "{rings:?}");
    assert!((0.03..0.1).contains(&(rings[0] / rings[2])), "{rings:?}");
}

#[test]
fn no_light_and_no_pixels() {
    let none = HalationBase { entering: 0.0, ..ACETATE };
    let raster = Raster::new(3, 2, 0.01);
    let mut plane = vec![1.0, 2.0, 3.0, 4.0, 5.0, 6.0];
    Halation::new(&none, &raster).expect("a base").apply(&mut plane);
    assert_eq!(plane, [1.0, 2.0, 3.0, 4.0, 5.0, 6.0]);
    Halation::new(&ACETATE, &Raster::new(0, 0, 0.01)).expect("a base").apply(&mut []);
    assert!(Halation::new(&ACETATE, &Raster::new(3, 2, f64::NAN)).is_err());
}

#[test]
fn same_bits_on_any_threads() {
    let raster = Raster::new(700, 500, 0.01);
    let run = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads");
        pool.install(|| {
            let mut plane: Vec<f32> = (0..raster.pixels()).map(|k| ((k * 7919) % 1013) as f32).collect();
            Halation::new(&ACETATE, &raster).expect("a base").apply(&mut plane);
            plane
        })
    };
    assert!(run(1) == run(3));
}
