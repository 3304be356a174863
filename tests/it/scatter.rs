//! Haze, dust and scratches on a lens: the same picture from the source and from the imager, lit card and halo; clean lenses keep
//! their bits; the books of a scene with ghosts close.

use crate::common::repository;
use crate::common::statistics::{self, Estimate, estimates, over_seeds, pixels as y, ready, rendered};
use spectra_render::{Renderer, Rendering};

const SEEDS: u64 = 24;
/// Of the halo few rays bring most of the light: fewer seeds do not know the error of a pixel.
const SEEDS_OF_PIXELS: u64 = 48;

fn card(overrides: &[&str]) -> Renderer {
    let common = [
        "source={kind: chart, chart: white, distance: 1 m, width: 10 cm, illuminant: D65, luminance: 300 cd/m2}",
        "lens.focus={distance: 1 m, by: paraxial}",
        "lens.f-number=f/4",
        "imager={kind: xyz, width: 15, height: 10, resolution: [15, 10]}",
        // Unbiased pixel by pixel, which footprints are not.
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

/// Illuminance of each pixel.
fn estimate(seeds: u64, overrides: &[&str]) -> Vec<Estimate> {
    estimates(&over_seeds(&card(&[&SOILED[..], overrides].concat()), 1..1 + seeds, y))
}

#[test]
fn both_directions_are_equal() {
    are_equal(SEEDS);
}

/// The same with more seeds, pixel by pixel.
#[test]
#[ignore = "half a minute: `.ci/run --all thorough`"]
fn both_directions_are_equal_thoroughly() {
    are_equal(SEEDS_OF_PIXELS);
}

/// Sums over card and halo agree within 3 standard errors; of many seeds, the pixels' differences have the spread of their errors
/// (Student's t of 94 degrees of freedom: a mean square of 94/92).
fn are_equal(seeds: u64) {
    let backward = estimate(seeds, &["render.direction=backward", "render.samples=512"]);
    let forward = estimate(seeds, &["render.direction=forward", "render.rays=400000"]);
    let middle = backward.iter().map(|b| b.mean).fold(0.0, f64::max);
    let (mut squares, mut most) = (0.0, 0.0_f64);
    // Difference, its variance, and light: card, halo.
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
    assert!(parts[1][2] > 0.02 * parts[0][2], "no halo");
    assert!(seeds < SEEDS_OF_PIXELS || (0.7..1.6).contains(&mean_square) && most < 5.5);
}

/// Of nothing that lies there the bits are those of a clean lens; what lies there is another estimator, and has the same bits in
/// batches of any size.
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

/// The middle of a card through dust on the eight outer surfaces of the lens.
#[test]
fn dust_takes_what_it_covers() {
    let of = |set: &[&str]| render(&[&["render.samples=2048"], set].concat());
    let dust = of(&["lens.dust={coverage: 2 %, diameter: 5 mm, spread: 0}"]);
    let clean = of(&[]);
    // Grains this large scatter by less than a pixel: the light that they stop is gone, the light that they diffract stays.
    let middle = |of: &Rendering| {
        (3..6).flat_map(|row| (6..9).map(move |column| row * 15 + column)).map(|p| y(of)[p]).sum::<f64>()
    };
    let (got, want) = (middle(&dust) / middle(&clean), 0.98_f64.powi(8));
    assert!((got / want - 1.0).abs() < 0.01, "{got} {want}");
}

/// Of a sun whose ghosts are traced every watt is booked once, what is scattered apart.
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

/// The glow of the sun through haze: spread over footprints it has as much light, its neighbors differ by a fifth of what they did at most, and
/// parts of the frame have the light of unspread rays within a hundredth, and 4 standard errors of both.
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
    // Away from the sun's own image: the lower half.
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
