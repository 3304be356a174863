//! Light spread over pixels: contrast, energy, and the picture of a point against the pattern itself.

use spectra_core::frame::FrameSize;
use spectra_diffraction::{ChannelLight, PixelSpread, Polygon, Spread, Wings};
use std::f64::consts::{PI, TAU};

const GREEN_NM: f64 = 550.0;
const GREEN_MM: f64 = 550e-6;

fn stop(blades: u32, f_number: f64) -> Polygon {
    let half = PI / f64::from(blades);
    let radius = 0.5 / f_number * (half / (half.sin() * half.cos())).sqrt();
    Polygon::regular(blades, radius, 0.1)
}

/// Contrast of a grating with this many cycles per pixel across and down.
fn contrast(kernel: &PixelSpread, [across, down]: [f64; 2]) -> f64 {
    let r = kernel.radius() as isize;
    let mut sum = 0.0;
    for j in -r..r + 1 {
        for i in -r..r + 1 {
            sum += kernel.weight(i, j) * (TAU * (across * i as f64 + down * j as f64)).cos();
        }
    }
    sum
}

/// Checks the contrast (2 / pi) (acos s - s sqrt(1 - s^2)), with s relative to the cutoff frequency, one over wavelength times f-number (J.
/// W. Goodman, "Introduction to Fourier optics", 6.4).
#[test]
fn a_perfect_lens_has_the_contrast_of_the_closed_form() {
    for (f_number, pitch_mm) in [(8.0, 0.002), (16.0, 0.004), (16.0, 0.002)] {
        let opening = Polygon::regular(360, 0.5 / f_number, 0.0);
        // The fade toward the edge of the kernel does not blur anything this fine.
        let elsewhere = Wings::new(&opening).fraction_beyond(0.78 * 128.0 * pitch_mm, GREEN_MM);
        let kernel = PixelSpread::new(&opening, &ChannelLight::line(GREEN_NM), [pitch_mm; 2], 128, elsewhere);
        let mut worst = 0.0_f64;
        for k in 1..20 {
            let per_mm = f64::from(k) / 20.0 * (0.45 / pitch_mm).min(1.0 / (GREEN_MM * f_number));
            let s = per_mm * GREEN_MM * f_number;
            let want = 2.0 / PI * (s.acos() - s * (1.0 - s * s).sqrt());
            for way in [[1.0, 0.0], [0.6, 0.8]] {
                let found = contrast(&kernel, way.map(|w| w * per_mm * pitch_mm));
                worst = worst.max((found - want).abs());
            }
        }
        println!("f/{f_number}, {pitch_mm} mm: contrast within {worst:.4}");
        assert!(worst < 0.005, "f/{f_number}: {worst}");
    }
}

/// The light left for the middle pixel of a square of 20 mm, when all others have their share of the pattern, is its own share.
#[test]
fn pixels_of_a_square_of_20_mm_hold_all_light() {
    for (blades, f_number) in [(7, 16.0), (8, 5.6)] {
        let opening = stop(blades, f_number);
        let pitch = 0.04;
        let kernel = PixelSpread::new(&opening, &ChannelLight::line(GREEN_NM), [pitch; 2], 250, 0.0);
        let n = 400;
        let mut sum = 0.0;
        for k in 0..n * n {
            let at = |i: i32| ((f64::from(i) + 0.5) / f64::from(n) - 0.5) * pitch;
            sum += opening.intensity([TAU / GREEN_MM * at(k % n), TAU / GREEN_MM * at(k / n)]);
        }
        let middle = sum / f64::from(n * n) * pitch * pitch * opening.area() / GREEN_MM.powi(2);
        println!("{blades} blades, f/{f_number}: {:.5} and the middle {middle:.5}", kernel.weight(0, 0));
        assert!((kernel.weight(0, 0) - middle).abs() < 0.005, "{} {middle}", kernel.weight(0, 0));
    }
}

const SIZE: FrameSize = FrameSize { width_px: 900, height_px: 600, width_mm: 10.8, height_mm: 7.2 };

fn point(column: usize, row: usize) -> Vec<f32> {
    let mut plane = vec![0.0_f32; SIZE.pixels()];
    plane[row * 900 + column] = 1e6;
    plane
}

/// The star of one pixel is the pattern, averaged over fringes: on its spikes, between them, near and far. No light is gained or lost.
#[test]
fn the_star_of_a_point_is_the_pattern() {
    for blades in [7, 8] {
        let opening = stop(blades, 16.0);
        let seen = |_: [f64; 2]| Some(opening.clone());
        let spread = Spread::new(SIZE, ChannelLight::line(GREEN_NM), &seen).unwrap();
        let mut plane = point(450, 300);
        let account = spread.apply(&mut plane);
        assert_eq!(account.stars, 1);
        let all: f64 = plane.iter().map(|v| f64::from(*v)).sum::<f64>() / 1e6;
        assert!((all + account.left - 1.0).abs() < 1e-6, "{all} {}", account.left);
        let wings = Wings::new(&opening);
        // Outside the frame lies what is beyond a circle between its sides.
        let [far, near] = [3.6, 6.5].map(|r| wings.fraction_beyond(r, GREEN_MM));
        assert!((near..far).contains(&account.left), "{near} {} {far}", account.left);
        // Light of a ring along a spike, compared with what the edge sends there.
        let pitch = 0.012;
        for (number, fan) in wings.fans().iter().enumerate() {
            for side in [-1.0, 1.0] {
                for [from, to] in [[0.3, 0.4], [0.5, 0.6], [0.8, 1.0], [2.0, 2.6], [2.8, 3.4]] {
                    let (mut found, mut exact) = (0.0, 0.0);
                    for pixel in 0..SIZE.pixels() {
                        let (dx, dy) = ((pixel % 900) as f64 - 450.0, (pixel / 900) as f64 - 300.0);
                        let (x, y) = (-dx * pitch, dy * pitch);
                        let along = side * (x * fan.normal[0] + y * fan.normal[1]);
                        let aside = x * fan.normal[1] - y * fan.normal[0];
                        if along >= from && along < to && aside.abs() < 0.05 {
                            found += f64::from(plane[pixel]) / 1e6;
                            exact += pitch * pitch * wings.intensity([x, y], [0.5 * pitch; 2], GREEN_MM, false);
                        }
                    }
                    assert!((found / exact - 1.0).abs() < 0.04, "{blades}, {number}, {from} mm: {found:e} {exact:e}");
                }
            }
        }
    }
}

#[test]
fn a_gray_frame_stays_gray() {
    let opening = stop(7, 16.0);
    let seen = |_: [f64; 2]| Some(opening.clone());
    let spread =
        Spread::new(SIZE, ChannelLight::of(&[[450.0, 1.0], [550.0, 2.0], [650.0, 1.0]]).unwrap(), &seen).unwrap();
    let mut plane = vec![0.18_f32; SIZE.pixels()];
    spread.apply(&mut plane);
    let (low, high) = plane.iter().fold((f32::INFINITY, 0.0_f32), |(low, high), v| (low.min(*v), high.max(*v)));
    println!("{low} to {high}");
    assert!(low > 0.18 * 0.998 && high < 0.18 * 1.001, "{low} to {high}");
}

#[test]
fn same_bits_on_any_threads() {
    let opening = stop(7, 16.0);
    let seen = |_: [f64; 2]| Some(opening.clone());
    let run = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads");
        pool.install(|| {
            let mut plane = point(40, 30);
            plane.iter_mut().enumerate().for_each(|(k, v)| *v += ((k * 7919) % 1013) as f32);
            Spread::new(SIZE, ChannelLight::line(GREEN_NM), &seen).unwrap().apply(&mut plane);
            plane
        })
    };
    assert!(run(1) == run(3));
}

#[test]
fn light_is_cut_into_equal_parts() {
    let light = ChannelLight::of(&[[400.0, 1.0], [500.0, 3.0], [600.0, 0.0], [700.0, 4.0]]).unwrap();
    let sum: f64 = light.shares().iter().map(|[_, share]| share).sum();
    assert!((sum - 1.0).abs() < 1e-12 && light.shares().len() == 8, "{light:?}");
    assert!((light.mean_mm() / (1e-6 * (400.0 + 1500.0 + 2800.0) / 8.0) - 1.0).abs() < 1e-12);
    assert_eq!(ChannelLight::of(&[[500.0, 0.0]]), None);
}

/// A frame whose pixels see one opening makes one kernel. The result matches, within a hundredth of the brightest pixel, that of separate
/// zones, in which one corner sees an opening larger by a five-hundredth. An opening that changes over the frame is not merged.
#[test]
fn one_opening_makes_the_picture_of_many() {
    let size = FrameSize { width_px: 64, height_px: 48, width_mm: 0.128, height_mm: 0.096 };
    let points = |view: &dyn spectra_diffraction::LensView| {
        let mut plane = vec![0.0_f32; 64 * 48];
        (plane[20 * 64 + 24], plane[44 * 64 + 60]) = (1000.0, 300.0);
        Spread::new(size, ChannelLight::line(GREEN_NM), view).expect("an opening").apply(&mut plane);
        plane
    };
    let corner =
        |factor: f64| move |[x, y]: [f64; 2]| Some(stop(6, if x > 60.0 && y > 44.0 { 8.0 / factor } else { 8.0 }));
    let merged = points(&corner(1.0));
    let largest = |other: &[f32]| merged.iter().zip(other).map(|(a, b)| (a - b).abs()).fold(0.0, f32::max);
    let brightest = merged.iter().copied().fold(0.0, f32::max);
    let near = largest(&points(&corner(1.002)));
    assert!(near > 0.0 && near < 0.01 * brightest, "{near} of {brightest}");
    let far = largest(&points(&corner(2.0)));
    assert!(far > 0.01 * brightest, "{far} of {brightest}");
}
