//! Tests haze, dust and scratches on a lens: card and halo are the same from the source and from the imager, clean lenses keep their
//! bits, and the ledger of a scene with ghosts balances.

use crate::common::repository;
use crate::common::statistics::{self, Estimate, estimates, over_seeds, pixels as y, ready, rendered};
use spectra_render::{Renderer, Rendering};

const SEEDS: u64 = 24;
/// Number of seeds for comparing pixels: few rays carry most of the halo's light, so fewer seeds underestimate the error of a pixel.
const SEEDS_OF_PIXELS: u64 = 48;

fn card(overrides: &[&str]) -> Renderer {
    let common = [
        "source={kind: chart, chart: white, distance: 1 m, width: 10 cm, illuminant: D65, luminance: 300 cd/m2}",
        "lens.focus={distance: 1 m, by: paraxial}",
        "lens.f-number=f/4",
        "imager={kind: xyz, width: 15, height: 10, resolution: [15, 10]}",
        // Spread `none` is unbiased in every pixel, unlike footprints.
        "render.reflections.spread=none",
    ];
    ready(statistics::load(&repository("scenes/gray-card.yaml"), &[&common[..], overrides].concat()))
}

fn render(overrides: &[&str]) -> Rendering {
    rendered(&card(overrides))
}

const SOILED: [&str; 3] = [
    "lens.haze={share: 4 %, shoulder: 2 deg}",
    "lens.dust={coverage: 1 %, diameter: 20 um}",
    "lens.scratches={coverage: 1 %, width: 6 um, direction: 30 deg, where: {shape: ring, inner: 2, outer: 12}}",
];

/// Returns the illuminance of each pixel.
fn estimate(seeds: u64, overrides: &[&str]) -> Vec<Estimate> {
    estimates(&over_seeds(&card(&[&SOILED[..], overrides].concat()), 1..1 + seeds, y))
}

#[test]
fn both_directions_are_equal() {
    are_equal(SEEDS);
}

/// Compares both directions pixel by pixel, with more seeds.
#[test]
#[ignore = "half a minute: `.ci/run --all thorough`"]
fn both_directions_are_equal_thoroughly() {
    are_equal(SEEDS_OF_PIXELS);
}

/// Checks that sums over card and halo agree within 3 standard errors. With many seeds, the differences of pixels must also scatter
/// as their errors predict (Student's t of 94 degrees of freedom: a mean square of 94/92).
fn are_equal(seeds: u64) {
    let backward = estimate(seeds, &["render.direction=backward", "render.samples=512"]);
    let forward = estimate(seeds, &["render.direction=forward", "render.rays=400000"]);
    let middle = backward.iter().map(|b| b.mean).fold(0.0, f64::max);
    let (mut squares, mut most) = (0.0, 0.0_f64);
    // Difference, its variance, and light, for card and halo.
    let mut parts = [[0.0; 3]; 2];
    for (backward, forward) in backward.iter().zip(&forward) {
        let (b, f) = (backward.mean, forward.mean);
        let variance = backward.error * backward.error + forward.error * forward.error;
        squares += (f - b) * (f - b) / variance;
        most = most.max((f - b).abs() / variance.sqrt());
        let part = &mut parts[usize::from(b < 0.1 * middle)];
        for (sum, add) in part.iter_mut().zip([f - b, variance, b]) {
            *sum += add;
        }
    }
    let mean_square = squares / backward.len() as f64;
    println!("mean square {mean_square:.3}, at most {most:.2} standard errors");
    for (name, [difference, variance, light]) in ["card", "halo"].into_iter().zip(parts) {
        let errors = difference / variance.sqrt();
        let part = difference / light;
        println!("{name}: {part:+.5} of the light, {errors:+.2} standard errors of {:.5}", variance.sqrt() / light);
        assert!(errors.abs() < 3.0 && light > 0.0, "{name}");
    }
    assert!(parts[1][2] > 0.02 * parts[0][2], "the halo is missing");
    assert!(seeds < SEEDS_OF_PIXELS || (0.7..1.6).contains(&mean_square) && most < 5.5);
}

/// A lens without haze gives the bits of a clean lens. A soiled lens has one more estimator, and its bits do not depend on the batch
/// size.
#[test]
fn bits_stay() {
    let of = |set: &[&str]| render(&[&["render.samples=32"], set].concat());
    let (clean, none) = (of(&[]), of(&["lens.haze={share: 0}"]));
    assert_eq!((y(&clean), clean.rays, clean.estimators), (y(&none), none.rays, none.estimators));
    let soiled = of(&SOILED);
    assert_eq!(soiled.estimators, ["backward", "scatter"]);
    assert_eq!(soiled.detected + soiled.losses.total(), soiled.rays);
    let cut = of(&[&SOILED[..], &["render.batch=100"]].concat());
    assert_eq!(y(&soiled), y(&cut));
}

/// Dust on the eight outer surfaces of the lens dims the middle of a card by its coverage.
#[test]
fn dust_takes_what_it_covers() {
    let of = |set: &[&str]| render(&[&["render.samples=2048"], set].concat());
    let dust = of(&["lens.dust={coverage: 2 %, diameter: 5 mm, spread: 0}"]);
    let clean = of(&[]);
    // Grains this large scatter by less than a pixel: the light that they stop is lost, and the light that they diffract stays.
    let middle = |of: &Rendering| {
        (3..6).flat_map(|row| (6..9).map(move |column| row * 15 + column)).map(|p| y(of)[p]).sum::<f64>()
    };
    let (got, want) = (middle(&dust) / middle(&clean), 0.98_f64.powi(8));
    assert!((got / want - 1.0).abs() < 0.01, "{got} {want}");
}

/// The ledger of a sun with ghosts books every watt once, with scattered light in an entry of its own.
#[test]
fn the_books_of_a_sun_close() {
    let sun = "source={kind: sun, field: [5 deg, 3 deg], illuminance: 60000 lx, spectrum: \"blackbody:5400\"}";
    let set =
        [sun, "render.reflections.order=2", "render.direction=forward", "render.rays=2000", "lens.focus=infinity"];
    let rendering = render(&[&SOILED[..], &set].concat());
    let ledger = rendering.ledger.expect("ghosts are traced");
    let booked = ledger.detected_w() + ledger.lost_w() + ledger.not_traced_w;
    assert!((booked / ledger.emitted_w - 1.0).abs() < 1e-9, "{ledger:?}");
    assert!(ledger.scattered_w > 0.05 * ledger.emitted_w && ledger.absorbed_w > 0.0, "{ledger:?}");
}

/// The glow of the sun through haze has as much light when it is spread over footprints. Its neighboring pixels differ by at most a
/// fifth as much, and parts of the frame have the light of unspread rays within a hundredth plus 4 standard errors of both.
#[test]
fn glow_is_smooth_and_true() {
    const PIXELS: usize = 120;
    const SEEDS: u64 = 8;
    let glow = |spread: &str, rays: &str| {
        let settings = [
            "source={kind: sun, field: [9 deg, 5 deg], illuminance: 60000 lx, spectrum: 'blackbody:5400'}",
            "lens.focus=infinity",
            "lens.f-number=f/4",
            "lens.haze={share: 2 %}",
            "imager={kind: xyz, width: 36, height: 24, resolution: [120, 80]}",
            "render.direction=forward",
            "render.samples=64",
            spread,
            rays,
        ];
        ready(statistics::load(&repository("scenes/gray-card.yaml"), &settings))
    };
    let spread = glow("render.reflections.spread=footprint", "render.rays=200000");
    let plain = glow("render.reflections.spread=none", "render.rays=200000");
    let [a, b] = [&spread, &plain].map(|renderer| y(&rendered(renderer)));
    let sum = |values: &[f64]| values.iter().sum::<f64>();
    assert!((sum(&a) / sum(&b) - 1.0).abs() < 1e-6, "{} {}", sum(&a), sum(&b));
    // The lower half of the frame is away from the image of the sun.
    let rough = |values: &[f64]| {
        let rows = values[values.len() / 2..].chunks_exact(PIXELS);
        rows.flat_map(|row| row.windows(3).map(|at| (at[1] - 0.5 * (at[0] + at[2])).abs())).sum::<f64>()
    };
    println!("neighbors differ by {:.4} of what they do unspread", rough(&a) / rough(&b));
    assert!(rough(&a) < 0.2 * rough(&b), "{} {}", rough(&a), rough(&b));
    let parts =
        |renderer: &Renderer| estimates(&over_seeds(renderer, 1..1 + SEEDS, |run| statistics::regions(run, 12, 8)));
    let many = glow("render.reflections.spread=none", "render.rays=1600000");
    for (at, (own, plain)) in parts(&spread).iter().zip(parts(&many)).enumerate() {
        let bound = 0.01 * plain.mean + 4.0 * own.error.hypot(plain.error);
        println!(
            "{at}: {:.3e}, {:+.4}, known to {:.4}",
            plain.mean,
            own.mean / plain.mean - 1.0,
            plain.error / plain.mean
        );
        assert!((own.mean - plain.mean).abs() < bound, "part {at}: {own:?} {plain:?}");
    }
}
