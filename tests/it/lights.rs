//! Tests tracing bright parts of a source forward and the rest backward: the exposure equals that of one direction alone, for flat
//! pictures, pictures with depth and layers.

use crate::common::statistics::{self, Estimate, bits, estimates, over_seeds, ready, rendered};
use exr::prelude::{AnyChannel, AnyChannels, Encoding, FlatSamples, Image, Layer, LayerAttributes, WritableImage};
use spectra_core::Isa;
use spectra_render::{Control, RenderOptions, Renderer, Rendering, SingleThread, Threads};
use std::path::Path;

const COLUMNS: usize = 5;
const ROWS: usize = 4;
const SEEDS: u64 = 12;
const SIZE: (usize, usize) = (48, 32);

/// Lamps: column, row, radius and brightness. The second and third are at the edge of the foreground.
const LAMPS: [(f64, f64, f64, f32); 5] = [
    (8.0, 8.0, 1.5, 60.0),
    (24.5, 12.5, 1.2, 90.0),
    (25.5, 22.5, 2.0, 40.0),
    (40.0, 9.0, 1.0, 120.0),
    (36.0, 26.0, 0.6, 80.0),
];

fn brightness(column: usize, row: usize) -> f32 {
    let at = |c: f64, r: f64| (column as f64 + 0.5 - c).hypot(row as f64 + 0.5 - r);
    let lamp = LAMPS.iter().find(|(c, r, radius, _)| at(*c, *r) < *radius);
    lamp.map_or(0.1 + 0.01 * ((column * 7 + row * 3) % 11) as f32, |lamp| lamp.3)
}

/// Returns whether a pixel belongs to the foreground, a dim post with a lamp of its own.
fn is_in_front(column: usize, row: usize) -> bool {
    (12..24).contains(&column) && row >= 6
}

/// Returns the depth, m: the post in front of a wall that recedes to the right in small steps.
fn depth(column: usize, row: usize) -> f32 {
    if is_in_front(column, row) { 0.9 } else { 1.8 + 0.006 * (column as f32) }
}

/// A channel: its name, and its value by column and row.
type Plane<'a> = (&'a str, &'a dyn Fn(usize, usize) -> f32);

fn exr_file(path: &Path, planes: &[Plane<'_>]) {
    let plane = |value: &dyn Fn(usize, usize) -> f32| -> Vec<f32> {
        (0..SIZE.0 * SIZE.1).map(|i| value(i % SIZE.0, i / SIZE.0)).collect()
    };
    let channels = planes.iter().map(|(name, of)| AnyChannel::new(*name, FlatSamples::F32(plane(*of)))).collect();
    let layer = Layer::new(SIZE, LayerAttributes::default(), Encoding::SMALL_LOSSLESS, AnyChannels::sort(channels));
    Image::from_layer(layer).write().to_file(path).expect("written");
}

fn scene(folder: &Path, source: &str) -> std::path::PathBuf {
    let behind = |c: usize, r: usize| brightness(c, r);
    let all = |c: usize, r: usize| match is_in_front(c, r) {
        true if c == 15 && r == 20 => 70.0,
        true => 0.15,
        false => brightness(c, r),
    };
    let cover = |c: usize, r: usize| if is_in_front(c, r) { 1.0 - 0.02 * (r % 5) as f32 } else { 0.0 };
    let front = |c: usize, r: usize| if is_in_front(c, r) { all(c, r) * cover(c, r) } else { 0.0 };
    exr_file(&folder.join("flat.exr"), &[("R", &behind), ("G", &behind), ("B", &behind)]);
    exr_file(&folder.join("deep.exr"), &[("R", &all), ("G", &all), ("B", &all), ("Z", &depth)]);
    let far = |c: usize, r: usize| depth(if is_in_front(c, r) { 24 } else { c }, r);
    exr_file(&folder.join("open.exr"), &[("R", &all), ("G", &all), ("B", &all), ("Z", &far)]);
    exr_file(&folder.join("front.exr"), &[("R", &front), ("G", &front), ("B", &front), ("A", &cover)]);
    let path = folder.join("scene.yaml");
    let text = format!(
        "spectra: 1\nsource: {source}\nlens: {{file: zeiss-biotar-50-f1.4, focus: {{distance: 1.2 m, by: paraxial}}}}\n\
         imager: {{kind: xyz, width: 12, height: 8, resolution: [30, 20]}}\n\
         render: {{samples: 64, reflections: {{order: 0}}}}\n"
    );
    std::fs::write(&path, text).expect("written");
    path
}

const FLAT: &str = "{kind: picture, file: flat.exr, distance: 2 m, width: 52 cm, edge: black}";
const DEEP: &str = "{kind: picture, file: deep.exr, distance: 2 m, width: 52 cm, depth: {unit: m}, edge: black}";
const LAYERS: &str = "{kind: layers, layers: [{file: front.exr, distance: 0.9 m, width: 23 cm}, \
                      {file: flat.exr, distance: 2 m, width: 52 cm, edge: black}]}";

fn made(path: &Path, set: &[&str]) -> Renderer {
    ready(statistics::load(path, set))
}

/// Returns the mean illuminance of the whole frame and of each of its 20 regions.
fn regions(rendering: &Rendering) -> Vec<f64> {
    let parts = statistics::regions(rendering, COLUMNS, ROWS);
    let whole = parts.iter().sum::<f64>() / parts.len() as f64;
    std::iter::once(whole).chain(parts).collect()
}

fn estimate(path: &Path, set: &[&str]) -> Vec<Estimate> {
    estimates(&over_seeds(&made(path, set), 5..5 + SEEDS, regions))
}

/// Largest difference in standard errors: three, as in `tests/it/directions.rs`, for 21 figures. The errors come from twelve seeds;
/// from six seeds, one error in a hundred would be underestimated to a third.
const ERRORS: f64 = 3.0 * 1.6;

fn agree(source: &str) {
    agree_by(
        source,
        &[("forward", "render.rays=500000"), ("both", "render.samples=32"), ("both", "render.rays=200000")],
    );
}

fn agree_by(source: &str, others: &[(&str, &str)]) {
    let folder = tempfile::tempdir().expect("a folder");
    let path = scene(folder.path(), source);
    let backward = estimate(&path, &["render.direction=backward", "render.samples=400"]);
    for (direction, many) in others {
        let other = estimate(&path, &[&format!("render.direction={direction}"), many]);
        for (region, (backward, other)) in backward.iter().zip(&other).enumerate() {
            let (b, o, error) = (backward.mean, other.mean, backward.error.hypot(other.error));
            println!("{direction} {region}: backward {backward:?}, {other:?}, {:.2}", (o - b) / error);
            assert!(error < 0.01 * b, "region {region}: {b} is known only to {error}");
            assert!((o - b).abs() < ERRORS * error, "{direction}, region {region}: {o} and {b}, +- {error}");
        }
    }
}

#[test]
fn lights_of_a_flat_picture() {
    agree(FLAT);
}

#[test]
fn lights_of_a_picture_with_depth() {
    agree(DEEP);
}

#[test]
fn lights_of_layers() {
    agree(LAYERS);
}

/// A sun over a chart, traced from the film and from the source.
#[test]
fn a_sun_over_a_chart() {
    let sun = "{kind: sun, field: [3 deg, 2 deg], diameter: 2 deg, illuminance: 1 lx, \
               over: {kind: chart, chart: white, distance: 2 m, width: 60 cm}}";
    agree_by(sun, &[("both", "render.samples=64")]);
}

/// A post in front of a lamp takes light from it and adds none: a lamp at its edge does not continue behind it.
#[test]
fn a_lamp_at_an_edge_is_no_brighter_for_it() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = scene(folder.path(), DEEP);
    let sharp = ["render.direction=both", "render.samples=64", "lens.focus.distance=0.9 m", "render.rays=1000000"];
    let seen = regions(&rendered(&made(&path, &sharp)));
    let open = regions(&rendered(&made(&path, &[&sharp[..], &["source.file=open.exr"]].concat())));
    println!("{seen:?} {open:?}");
    // The post is brighter because of its own lamp, which is now in focus; more light of the other lamps is hidden.
    assert!(seen[0] < open[0], "{} {}", seen[0], open[0]);
}

/// By default both directions are used if a picture has lights, and the noise of the areas that they light decreases.
#[test]
fn lights_are_seen_without_being_asked_for() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = scene(folder.path(), DEEP);
    let estimators = |set: &[&str]| rendered(&made(&path, &[&["render.samples=1"], set].concat())).estimators;
    assert_eq!(estimators(&[]), ["backward", "forward"]);
    assert_eq!(estimators(&["render.direction=backward"]), ["backward"]);
    let noise = |set: &[&str]| {
        let frames = over_seeds(&made(&path, set), 0..4, statistics::pixels);
        let variance = |p: usize| {
            let mean = frames.iter().map(|f| f[p]).sum::<f64>() / 4.0;
            frames.iter().map(|f| (f[p] - mean).powi(2)).sum::<f64>() / 3.0
        };
        let mean = frames[0].iter().sum::<f64>() / frames[0].len() as f64;
        ((0..frames[0].len()).map(variance).sum::<f64>() / frames[0].len() as f64).sqrt() / mean
    };
    let (both, backward) = (noise(&["render.samples=32"]), noise(&["render.samples=32", "render.direction=backward"]));
    println!("noise: both {both}, backward {backward}");
    assert!(both < 0.25 * backward, "{both} {backward}");
}

/// The bits with both directions do not depend on threads, batches and instruction sets.
#[test]
fn bits_are_the_same_however_it_runs() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = scene(folder.path(), DEEP);
    let run = |threads: usize, isa: Isa, batch: &str| {
        let scene = statistics::load(&path, &["render.samples=3", &format!("render.batch={batch}")]);
        let renderer = Renderer::new(scene, &RenderOptions { isa, ..RenderOptions::default() }).expect("ready");
        bits(&renderer.run(&Threads(threads), &Control::new()).expect("rendered"))
    };
    let want = run(1, Isa::detect(), "256");
    for isa in Isa::available() {
        assert_eq!(run(2, isa, "100"), want);
    }
}

/// A frame that is stopped has the light of all of it, with lamps and ghosts: after the first pass, and in the middle of a later one.
#[test]
fn a_stopped_frame_is_whole() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = scene(folder.path(), DEEP);
    let whole = estimate(&path, &["render.direction=backward", "render.samples=400"]);
    let renderer = made(&path, &["render.direction=both", "render.samples=64"]);
    let stopped = |seed: u64, rays: Option<u64>| {
        let own = renderer.reseeded(seed);
        let mut light = own.begin().expect("memory");
        let control = rays.map_or_else(Control::new, Control::stopping_after);
        own.first_pass(&mut light, &SingleThread, &control).expect("traced");
        assert!(light.covers_frame());
        if rays.is_some() {
            own.advance(&mut light, 64, &SingleThread, &control).expect("traced");
        }
        own.rendering(own.scene(), &light).expect("a picture")
    };
    let all = rendered(&renderer).rays;
    for rays in [None, Some(all / 10), Some(all / 2)] {
        let runs: Vec<Vec<f64>> = (5..5 + SEEDS)
            .map(|seed| {
                let rendering = stopped(seed, rays);
                assert!(rendering.partial, "{rays:?}");
                regions(&rendering)
            })
            .collect();
        for (at, (part, whole)) in estimates(&runs).into_iter().zip(&whole).enumerate() {
            assert!(part.apart(*whole) < ERRORS, "{rays:?} rays, region {at}: {part:?} {whole:?}");
        }
    }
}

/// Pauses do not change a bit, wherever they fall.
#[test]
fn pauses_change_nothing() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = scene(folder.path(), DEEP);
    for set in ["render.noise=null", "render.noise=20 %"] {
        let renderer = made(&path, &["render.direction=both", "render.samples=24", set]);
        let mut light = renderer.begin().expect("memory");
        let mut pauses = 0;
        loop {
            let control = Control::stopping_after(2_000 + 500 * pauses);
            renderer.advance(&mut light, 24, &Threads(2), &control).expect("traced");
            if !control.is_stopped() {
                break;
            }
            pauses += 1;
        }
        assert!(pauses > 3, "{pauses} pauses");
        let paused = renderer.rendering(renderer.scene(), &light).expect("a picture");
        assert_eq!(bits(&paused), bits(&rendered(&renderer)), "{set}");
    }
}

/// Lamps of one pixel on black, far out of focus: the light of each ray is spread over the image of its lamp. The disk equals that of
/// rays from anywhere in the lamp, and the noise between two seeds is at most that of six times as many such rays.
#[test]
fn lamps_of_one_pixel_are_spread_over_their_images() {
    let common = [
        "source.width=5.9 m",
        "imager={kind: xyz, width: 4 mm, height: 4 mm, shift: [1.5 mm, 0.4 mm], resolution: 60}",
        "render.reflections.order=0",
    ];
    let of = |direction: &str, rays: &str| {
        let settings: Vec<&str> = common.iter().copied().chain([direction, rays]).collect();
        let scene = statistics::load(&crate::common::repository("scenes/onion-rings.yaml"), &settings);
        let renderer = ready(scene);
        let runs = [5, 6].map(|seed| rendered(&renderer.reseeded(seed)));
        let [a, b] = runs.each_ref().map(statistics::pixels);
        let lit = |i: &usize| a[*i] + b[*i] > 0.5 * (a[60 * 30 + 30] + b[60 * 30 + 30]);
        let lit: Vec<usize> = (0..a.len()).filter(lit).collect();
        let noise = lit.iter().map(|i| ((a[*i] - b[*i]) / (a[*i] + b[*i])).powi(2)).sum::<f64>() / lit.len() as f64;
        let [a, b] = runs.each_ref().map(|run| statistics::regions(run, 2, 2));
        let means: Vec<f64> = a.iter().zip(b).map(|(a, b)| 0.5 * (a + b)).collect();
        ((2.0 * noise).sqrt(), means)
    };
    let (spread, means) = of("render.direction=forward", "render.rays=400000");
    let (plain, wanted) = of("render.direction=both", "render.rays=2400000");
    println!("noise {spread:.4}, {plain:.4}; {means:?} {wanted:?}");
    assert!(spread < plain, "noise {spread} and {plain}");
    let all = wanted.iter().sum::<f64>() / wanted.len() as f64;
    for (mean, wanted) in means.iter().zip(&wanted) {
        assert!((mean - wanted).abs() < 0.025 * all, "{mean} and {wanted} lx");
    }
}
