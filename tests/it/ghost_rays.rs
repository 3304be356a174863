//! Tests that sending rays of ghosts to selected places changes only their noise. Each part of the frame gets as much light as from
//! rays all over the front, and no block of the frame has much more noise than the others.

use crate::common::statistics::{estimates, rendered};
use spectra_core::frame::ExposureFrame;
use spectra_render::{GhostRays, RenderOptions, Renderer, Threads, Traced};
use spectra_scene::Scene;
use std::sync::Arc;

/// Returns a scene of the sun near the edge of the frame through an uncoated Biotar. The light of a ray stays in its pixel, because
/// footprints of few samples are as wide as the parts of the frame that these tests compare.
fn scene(pixels: [u32; 2], samples: u32) -> Scene {
    spread_scene(pixels, samples, "none")
}

/// Returns that scene with the light of rays spread in the given way.
fn spread_scene(pixels: [u32; 2], samples: u32, spread: &str) -> Scene {
    let [width, height] = pixels;
    let text = format!(
        "spectra: 1\n\
         source: {{kind: sun, field: [18.5 deg, 11 deg], illuminance: 60000 lx, spectrum: 'blackbody:5400'}}\n\
         lens: {{file: zeiss-biotar-50-f1.4, f-number: 4, focus: infinity, coating: bare, aperture: {{shape: iris, blades: 8}}}}\n\
         imager: {{kind: xyz, width: 36, height: 24, resolution: [{width}, {height}]}}\n\
         render: {{samples: {samples}, rays: 1000, reflections: {{order: 2, spread: {spread}}}}}\n"
    );
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("scene.yaml");
    std::fs::write(&path, text).expect("written");
    spectra_scene::load(&path, &[]).unwrap_or_else(|faults| panic!("{faults}"))
}

/// Renders only ghosts. Returns the light of each block of `side` pixels, for each seed.
fn blocks(scene: Scene, rays: GhostRays, side: usize, seeds: impl Iterator<Item = u64>) -> Vec<Vec<f64>> {
    let renderer = Renderer::new(
        Arc::new(scene),
        &RenderOptions { traced: Traced::Ghosts(rays), workers: &Threads(2), ..RenderOptions::default() },
    )
    .expect("ready");
    assert!(renderer.ledger().is_some(), "it reflects");
    seeds.map(|seed| of(&rendered(&renderer.reseeded(seed)).exposure, side)).collect()
}

fn of(frame: &ExposureFrame, side: usize) -> Vec<f64> {
    let y = &frame.channel("Y").expect("an XYZ imager").values;
    let (width, height) = (frame.size.width_px as usize, frame.size.height_px as usize);
    let across = width.div_ceil(side);
    let mut sums = vec![0.0; across * height.div_ceil(side)];
    for (pixel, value) in y.iter().enumerate() {
        sums[pixel / width / side * across + pixel % width / side] += f64::from(*value);
    }
    sums
}

/// Compares 24 parts of the frame and the whole frame, over seeds of both kinds of rays.
#[test]
fn rays_that_are_sent_have_the_light_of_rays_all_over_the_front() {
    const SIDE: usize = 32;
    const SEEDS: u64 = 32;
    let by = |rays: GhostRays, samples: u32| {
        let runs = blocks(scene([192, 128], samples), rays, SIDE, 1..=SEEDS);
        let with_sum = |run: Vec<f64>| [&run[..], &[run.iter().sum()]].concat();
        estimates(&runs.into_iter().map(with_sum).collect::<Vec<_>>())
    };
    let (found, even) = (by(GhostRays::Found, 2), by(GhostRays::Even, 32));
    for (part, (found, even)) in found.iter().zip(&even).enumerate() {
        println!("{part}: {found:?}, all over {even:?}, {:.2}", found.apart(*even));
        assert!(found.apart(*even) < 4.0, "part {part}: {found:?} {even:?}");
    }
    let (a, b) = (found[24], even[24]);
    assert!(a.error < 0.002 * a.mean && b.error < 0.02 * b.mean, "known to {a:?} and {b:?}");
}

/// Checks the worst of the blocks with more than 1e-4 of the brightest one's light. It has 1.5 %. It had 5.9 % when dim blocks had
/// the weight of others and all cells of the front had one size.
#[test]
fn no_block_is_left_with_much_more_noise_than_others() {
    const SEEDS: u64 = 12;
    let runs = blocks(scene([480, 320], 8), GhostRays::Found, 32, (0..SEEDS).map(|seed| 1 + (seed << 32)));
    let each = estimates(&runs);
    let brightest = each.iter().fold(0.0_f64, |most, block| most.max(block.mean));
    let lit = each.iter().filter(|block| block.mean > 1e-4 * brightest);
    let noise: Vec<f64> = lit.map(|block| block.error * (SEEDS as f64).sqrt() / block.mean).collect();
    let worst = noise.iter().fold(0.0_f64, |most, noise| most.max(*noise));
    println!("{} blocks, the worst has {:.2} %", noise.len(), 100.0 * worst);
    assert!(noise.len() > 140 && worst < 0.03, "{} blocks, {worst}", noise.len());
}

/// Spread over footprints, the light of the same rays has the same sum. Pixels differ from the mean of their two neighbors in the row
/// a tenth as much: independent pixels have noise there, and smooth light has none.
#[test]
fn footprints_keep_all_light_and_smooth_it() {
    const PIXELS: [u32; 2] = [480, 320];
    let of = |spread: &str| {
        let all = blocks(spread_scene(PIXELS, 8, spread), GhostRays::Found, 1, std::iter::once(1));
        all.into_iter().next().expect("one seed")
    };
    let [plain, spread] = ["none", "footprint"].map(of);
    let sum = |values: &[f64]| values.iter().sum::<f64>();
    let (before, after) = (sum(&plain), sum(&spread));
    // Equal up to the last bits of the sums; exposures are rounded to single precision.
    assert!((after / before - 1.0).abs() < 1e-6, "{before} {after}");
    let rough = |values: &[f64]| {
        let rows = values.chunks_exact(PIXELS[0] as usize);
        let bends = rows.flat_map(|row| row.windows(3).map(|at| (at[1] - 0.5 * (at[0] + at[2])).abs()));
        bends.sum::<f64>() / sum(values)
    };
    let (before, after) = (rough(&plain), rough(&spread));
    println!("neighbors differ by {before:.3} of the light, spread by {after:.3}");
    assert!(after < 0.1 * before, "{before} {after}");
}
