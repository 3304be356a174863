//! Measures what a frame costs besides the surfaces of its lens: samples a second of five small scenes, and rays a second of the bare trace
//! through the same lens, in turns, on one thread.
//!
//! The bare trace follows rays that were aimed beforehand, in the same direction through the same lens and stop. It knows indices, surfaces
//! and rims, but no coatings, no absorption, no source and no film. The ratio of the two rates is the share of a frame's time that is spent
//! on surfaces. Figures are medians over the turns. The last line is JSON.

use spectra_core::workers::SingleThread;
use spectra_core::{Isa, RayBatch};
use spectra_optics::{AimPattern, FrontPupil, RearPupil};
use spectra_plugins as _;
use spectra_render::{Control, RenderOptions, Renderer, Rendering};
use spectra_scene::{Direction, NumberFamily, Scene};
use spectra_tracer::{Indices, Tracer, Travel};
use std::path::{Path, PathBuf};
use std::time::Instant;

const TURNS: usize = 5;
const BATCH: usize = 256;
/// Number of aimed batches that the bare trace repeats, and how often.
const BATCHES: usize = 256;
const REPEATS: usize = 150;

/// The scenes: name, file, and settings that make them take about a second.
const SCENES: [(&str, &str, &[&str]); 5] = [
    ("forward-190m", "bench/forward-190m.yaml", &["render.rays=6e6"]),
    ("biotar-ortho", "biotar-ortho.yaml", &["imager.resolution=[240, 160]", "render.samples=128"]),
    ("photograph", "photograph.yaml", &["render.samples=128"]),
    ("noise-portrait", "bench/noise-portrait.yaml", &["imager.resolution=[240, 135]", "render.samples=128"]),
    ("noise-night", "bench/noise-night.yaml", &["imager.resolution=[240, 135]", "render.samples=32"]),
];

/// A photograph through the Helios-44 on color negative film, as `spectra film develop` renders it.
const PHOTOGRAPH: &str = "spectra: 1\n\
    source: {kind: picture, file: noise-street.exr, distance: 3 m, illuminant: D65, luminance: 200 cd/m2, width: 1.9 m}\n\
    lens: {file: helios-44-58-f2, focus: 3 m}\n\
    imager: {kind: film, format: 135, resolution: [240, 160]}\n\
    film: {stock: kodak-vision3-250d-5207, exposure: metered}\n\
    render: {direction: backward}\n";

/// Processor time of this thread, s; the time that passes where the system does not say it.
fn now_s(begun: Instant) -> f64 {
    let said = std::fs::read_to_string("/proc/thread-self/schedstat").ok();
    let nanoseconds = said.and_then(|text| text.split(' ').next()?.parse::<f64>().ok());
    nanoseconds.map_or_else(|| begun.elapsed().as_secs_f64(), |ns| 1e-9 * ns)
}

/// A scene with its renderer, and what was measured.
struct Measured {
    name: &'static str,
    renderer: Renderer,
    bare: Bare,
    /// Processor seconds until the first pass over the frame is complete.
    first_pass_s: f64,
    /// Samples a second, bare rays a second, and their ratio in each turn.
    turns: Vec<[f64; 3]>,
    /// Processor seconds of a picture times its squared noise.
    cost: f64,
}

/// The bare trace of a scene: its lens without coatings and absorption, and rays that are aimed at it.
struct Bare {
    tracer: Tracer,
    travel: Travel,
    rays: Vec<RayBatch>,
}

impl Bare {
    fn of(scene: &Scene) -> Self {
        let (min_nm, max_nm) = (scene.grid.start_nm, scene.grid.end_nm());
        let tracer = Tracer::new(&scene.lens, Indices::Band { min_nm, max_nm }).expect("glasses have indices");
        let numbers = spectra_core::numbers::Numbers::sobol(1);
        let travel = if scene.render.direction == Direction::Forward { Travel::Forward } else { Travel::Backward };
        let pixels = scene.imager.size().pixels() as u64;
        let isa = Isa::detect();
        let mut rays: Vec<(RayBatch, [Vec<f64>; 2])> = (0..BATCHES)
            .map(|batch| {
                let mut rays = RayBatch::new(BATCH).on(isa);
                rays.restart(BATCH);
                let first = (batch * BATCH) as u64;
                let column = |dimension: u32| {
                    let mut out = vec![0.0; BATCH];
                    numbers.fill(isa, 0, first, dimension, &mut out);
                    out
                };
                let c = rays.columns_mut();
                c.weight.fill(1.0);
                c.wavelength_nm.iter_mut().zip(column(0)).for_each(|(nm, u)| *nm = min_nm + u * (max_nm - min_nm));
                let spread = BATCHES as u64 * BATCH as u64;
                (first..).zip(c.tag).for_each(|(ray, tag)| *tag = (ray * pixels / spread) as u32);
                let (u, v) = (column(1), column(2));
                match travel {
                    Travel::Forward => scene.source.emit().expect("emits").place(&mut rays, &u, &v),
                    Travel::Backward => scene.imager.launch().expect("launches").place(&mut rays, &u, &v),
                }
                (rays, [column(3), column(4)])
            })
            .collect();
        let points = rays.iter().flat_map(|(rays, _)| {
            let [x, y, z] = rays.positions();
            (0..rays.len()).step_by(16).map(|i| glam::DVec3::new(x[i], y[i], z[i])).collect::<Vec<_>>()
        });
        let points: Vec<glam::DVec3> = points.collect();
        match travel {
            Travel::Forward => {
                let pupil = FrontPupil::search(&scene.lens, &tracer, &points, min_nm, max_nm).expect("a pupil");
                rays.iter_mut().for_each(|(rays, [a, b])| {
                    pupil.aim(rays, a, b, AimPattern::Disk);
                });
            }
            Travel::Backward => {
                let pupil = RearPupil::search(&scene.lens, &tracer, &points, min_nm, max_nm).expect("a pupil");
                rays.iter_mut().for_each(|(rays, [a, b])| {
                    pupil.aim(rays, a, b);
                });
            }
        }
        Self { tracer, travel, rays: rays.into_iter().map(|(rays, _)| rays).collect() }
    }

    /// Traces all rays some times. Returns rays a second.
    fn rate(&self, repeats: usize) -> f64 {
        let mut rays = RayBatch::new(BATCH).on(Isa::detect());
        let mut work = self.tracer.work_unweighed(BATCH);
        let begun = Instant::now();
        let start = now_s(begun);
        for aimed in self.rays.iter().cycle().take(repeats * BATCHES) {
            rays.restart(BATCH);
            let ([x, y, z], [l, m, n]) = (aimed.positions(), aimed.directions());
            let c = rays.columns_mut();
            for (to, from) in [(c.x, x), (c.y, y), (c.z, z), (c.l, l), (c.m, m), (c.n, n)] {
                to.copy_from_slice(from);
            }
            c.wavelength_nm.copy_from_slice(aimed.wavelengths_nm());
            self.tracer.trace(&mut rays, &mut work, self.travel);
            std::hint::black_box(&rays);
        }
        (repeats * BATCHES * BATCH) as f64 / (now_s(begun) - start)
    }
}

/// Renders all samples of a scene. Returns the picture and the processor seconds.
fn rendered(renderer: &Renderer) -> (Rendering, f64) {
    let begun = Instant::now();
    let start = now_s(begun);
    let mut light = renderer.begin().expect("memory");
    let samples = u64::from(renderer.scene().render.samples);
    renderer.advance(&mut light, samples, &SingleThread, &Control::new()).expect("rendered");
    let spent_s = now_s(begun) - start;
    (renderer.rendering(renderer.scene(), &light).expect("a picture"), spent_s)
}

/// Returns the squared noise of a picture from two seeds: half the mean square of the difference, over the mean square.
fn squared_noise(a: &Rendering, b: &Rendering) -> f64 {
    let planes = |of: &Rendering| of.exposure.channels[0].values.clone();
    let (a, b) = (planes(a), planes(b));
    let (mut difference, mut square) = (0.0, 0.0);
    for (a, b) in a.into_iter().zip(b).map(|(a, b)| (f64::from(a), f64::from(b))) {
        difference += (a - b) * (a - b);
        square += 0.5 * (a * a + b * b);
    }
    0.5 * difference / square
}

fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    values[values.len() / 2]
}

fn measured(name: &'static str, path: &Path, set: &[&str]) -> Measured {
    let set: Vec<String> = set.iter().chain(&["render.noise=null"]).map(|text| (*text).to_owned()).collect();
    let scene = spectra_scene::load(path, &set).unwrap_or_else(|faults| panic!("{faults}"));
    assert!(scene.render.numbers == NumberFamily::Sobol, "the bench measures the usual numbers");
    let begun = Instant::now();
    let start = now_s(begun);
    let renderer = Renderer::new(scene, &RenderOptions::default()).unwrap_or_else(|error| panic!("{name}: {error}"));
    let mut light = renderer.begin().expect("memory");
    renderer.first_pass(&mut light, &SingleThread, &Control::new()).expect("rendered");
    let first_pass_s = now_s(begun) - start;
    let bare = Bare::of(renderer.scene());
    Measured { name, renderer, bare, first_pass_s, turns: Vec::new(), cost: 0.0 }
}

fn main() {
    // `cargo test --benches` only checks that the benchmark runs, not how fast.
    let quick = !std::env::args().any(|a| a == "--bench");
    let (turns, repeats) = if quick { (1, 1) } else { (TURNS, REPEATS) };
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let folder = tempfile::tempdir().expect("a folder");
    let photograph = folder.path().join("photograph.yaml");
    let picture = root.join("scenes/noise-street.exr");
    let text = PHOTOGRAPH.replace("noise-street.exr", &format!("'{}'", picture.display()));
    std::fs::write(&photograph, text).expect("written");
    let path = |file: &str| -> PathBuf {
        if file == "photograph.yaml" { photograph.clone() } else { root.join("scenes").join(file) }
    };
    let small: &[&str] = if quick { &["render.samples=1", "render.rays=1e4"] } else { &[] };
    let mut all: Vec<Measured> =
        SCENES.iter().map(|(name, file, set)| measured(name, &path(file), &[set, small].concat())).collect();
    for turn in 0..turns {
        for of in &mut all {
            let seed = |seed: u64| rendered(&of.renderer.reseeded(seed));
            let (picture, spent_s) = seed(1);
            let samples = (picture.rays as f64 / spent_s, of.bare.rate(repeats));
            of.turns.push([samples.0, samples.1, samples.0 / samples.1]);
            if turn == 0 {
                of.cost = spent_s * squared_noise(&picture, &seed(2).0);
            }
        }
    }
    println!(
        "{:<16} {:>12} {:>12} {:>8} {:>14} {:>16}",
        "one thread", "M samples/s", "M rays/s", "ratio", "s, first pass", "s x noise^2"
    );
    let mut json = Vec::new();
    for of in &all {
        let [samples, rays, ratio] = [0, 1, 2].map(|at| median(of.turns.iter().map(|turn| turn[at]).collect()));
        println!(
            "{:<16} {:>12.2} {:>12.2} {ratio:>8.3} {:>14.3} {:>16.3e}",
            of.name,
            1e-6 * samples,
            1e-6 * rays,
            of.first_pass_s,
            of.cost
        );
        json.push(format!(
            "\"{}\":{{\"samples_per_second\":{samples:.0},\"rays_per_second\":{rays:.0},\"ratio\":{ratio:.4},\"first_pass_s\":{:.4},\
             \"cost\":{:.4e}}}",
            of.name, of.first_pass_s, of.cost
        ));
    }
    println!("{{\"bench\":\"frame\",\"isa\":\"{}\",{}}}", Isa::detect().name(), json.join(","));
}
