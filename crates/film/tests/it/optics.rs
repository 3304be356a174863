//! Tests of the lens between film and picture: contrast over frequency, conservation of light, even areas.

use spectra_film::optics::Optics;
use std::f64::consts::TAU;

/// Faint sines across and down keep the stated Gaussian response: one half at the stated frequency.
#[test]
fn half_of_the_contrast_is_left_where_stated() {
    let (side, pitch) = (300_usize, 0.003);
    for (mtf50, frequencies) in [(60.0, [10.0, 30.0, 60.0, 90.0]), (40.0, [10.0, 20.0, 40.0, 60.0])] {
        let lens = Optics::new(mtf50, [pitch; 2]);
        for frequency in frequencies {
            // Whole periods over the measured 200 pixels.
            let cycles = (frequency * pitch * 200.0_f64).round() / 200.0;
            for down in [false, true] {
                let phase = |k: usize| TAU * cycles * if down { k / side } else { k % side } as f64;
                let mut plane: Vec<f32> = (0..side * side).map(|k| (0.8 + 0.02 * phase(k).cos()) as f32).collect();
                lens.apply(&mut plane, side);
                let mut sum = 0.0;
                for y in 50..250 {
                    for x in 50..250 {
                        sum += f64::from(plane[y * side + x]) * phase(y * side + x).cos();
                    }
                }
                let left = 2.0 * sum / 200.0 / 200.0 / 0.02;
                let f = cycles / pitch;
                let want = 0.5_f64.powf(f * f / mtf50 / mtf50);
                println!("{mtf50}: at {f:.1} {left:.4}, want {want:.4}");
                assert!((left - want).abs() < 0.01, "{mtf50} {f}: {left} {want}");
            }
        }
    }
}

/// Light is conserved: a dense grain on clear film passes as much light after the lens as before. Even film does not change, up to its
/// border.
#[test]
fn light_is_kept_and_even_film_stays() {
    let lens = Optics::new(50.0, [0.002, 0.003]);
    let light = |plane: &[f32]| plane.iter().map(|d| 10_f64.powf(-f64::from(*d))).sum::<f64>();
    let mut plane = vec![0.1_f32; 101 * 81];
    plane[40 * 101 + 50] = 2.5;
    let before = light(&plane);
    lens.apply(&mut plane, 101);
    assert!((light(&plane) / before - 1.0).abs() < 1e-6);
    assert!(plane[40 * 101 + 50] < 0.2 && plane[40 * 101 + 51] > 0.101);
    let mut even = vec![1.7_f32; 40 * 30];
    lens.apply(&mut even, 40);
    assert!(even.iter().all(|d| (d - 1.7).abs() < 2e-5));
}

#[test]
fn coarse_pixels_feel_no_lens_and_threads_change_nothing() {
    assert!(!Optics::new(60.0, [0.012; 2]).is_felt());
    let plane: Vec<f32> = (0..700 * 300).map(|k| ((k * 7919) % 1013) as f32 / 500.0).collect();
    let run = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads");
        let mut plane = plane.clone();
        pool.install(|| Optics::new(60.0, [0.004; 2]).apply(&mut plane, 700));
        plane
    };
    assert!(run(1) == run(3));
}
