//! Tests guarantees of the engine for any scene: numbers are taken as written, memory is checked before it is used, a broken stage is
//! named at once, every ray is accounted for, and an empty or infinite picture causes a warning.

use crate::common::statistics::{bits, ready, rendered};
use crate::common::{repository, run, shown, text};
use serde_json::Value;
use spectra_core::spectral::SpectralPower;
use spectra_core::stage::{Radiance, Source};
use spectra_core::{Loss, RayBatch};
use spectra_plugins as _;
use spectra_render::{Control, Effort, RenderError, RenderOptions, Renderer, Rendering, Threads};
use spectra_scene::Scene;
use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering::Relaxed};

const SMALL: &str = "imager.resolution=[24, 16]";

fn load(scene: &str, overrides: &[&str]) -> Scene {
    let overrides: Vec<String> = overrides.iter().map(|s| (*s).to_owned()).collect();
    spectra_scene::load(&repository("scenes").join(scene), &overrides).unwrap_or_else(|faults| panic!("{faults}"))
}

fn render(scene: &Scene) -> Rendering {
    Renderer::new(scene.clone(), &RenderOptions::default())
        .expect("ready")
        .run(&Threads(2), &Control::new())
        .expect("rendered")
}

fn json(path: &Path) -> Value {
    serde_json::from_slice(&std::fs::read(path).expect("a file")).expect("JSON")
}

/// Renders the gray card with these settings. Returns its report and the standard error.
fn card(overrides: &[&str]) -> (Value, String) {
    let folder = tempfile::tempdir().expect("a folder");
    let scene = repository("scenes/gray-card.yaml");
    let mut arguments = vec!["run", shown(&scene), "--samples", "4", "--output", shown(folder.path()), "--set", SMALL];
    arguments.extend(overrides.iter().flat_map(|set| ["--set", set]));
    let output = run(&arguments);
    let said = text(&output.stderr);
    assert!(output.status.success(), "{said}");
    (json(&folder.path().join("gray-card.json")), said)
}

#[test]
fn a_seed_is_taken_to_its_last_digit() {
    let light = |seed: &str| {
        let folder = tempfile::tempdir().expect("a folder");
        let scene = repository("scenes/gray-card.yaml");
        let output = shown(folder.path());
        let run = run(&["run", shown(&scene), "-s", "1", "--seed", seed, "--set", SMALL, "-q", "-o", output]);
        assert!(run.status.success(), "{}", text(&run.stderr));
        let report = json(&folder.path().join("gray-card.json"));
        assert_eq!(report["seed"].as_u64(), seed.parse().ok());
        std::fs::read(folder.path().join("gray-card.png")).expect("a picture")
    };
    // One above 2^53, where an f64 can represent only even numbers.
    assert_ne!(light("9007199254740993"), light("9007199254740992"));
    light("18446744073709551615");
}

#[test]
fn memory_is_asked_for_before_it_is_used() {
    let scene = repository("scenes/spectral-bands.yaml");
    let large = ["--set", "imager.resolution=[16000, 12000]", "--set", "imager.bands=256"];
    for command in ["check", "run"] {
        let output = run(&[&[command, shown(&scene)][..], &large].concat());
        let said = text(&output.stderr);
        assert_eq!(output.status.code(), Some(2), "{said}");
        assert!(said.contains("16000 x 12000 pixels of 256 channels need 590 GB of memory"), "{said}");
        assert!(said.contains("fewer bands"), "{said}");
    }
    let card = repository("scenes/gray-card.yaml");
    let output = run(&["check", "--json", shown(&card), "--set", "imager.resolution=[300, 200]"]);
    let report: Value = serde_json::from_slice(&output.stdout).expect("JSON");
    assert_eq!(report["scenes"][0]["memory_bytes"], 300 * 200 * 36);
}

/// Runs only where the shell can limit the address space of a process.
#[cfg(target_os = "linux")]
#[test]
fn a_limit_of_memory_is_a_sentence_and_no_abort() {
    let limited = |resolution: &str| {
        let program = env!("CARGO_BIN_EXE_spectra");
        let scene = repository("scenes/gray-card.yaml");
        let folder = tempfile::tempdir().expect("a folder");
        let command = format!(
            "ulimit -v 600000; exec {program} run {} -t 1 -s 1 -o {} --set 'imager.resolution={resolution}'",
            shown(&scene),
            shown(folder.path())
        );
        std::process::Command::new("sh").args(["-c", &command]).output().expect("a shell")
    };
    let output = limited("[6000, 4000]");
    let said = text(&output.stderr);
    assert_eq!(output.status.code(), Some(2), "{said}");
    assert!(said.contains("need 864 MB of memory") && said.contains("imager.resolution"), "{said}");
    assert!(limited("[60, 40]").status.success());
}

/// A source that works until it is broken by a factor.
struct Broken {
    sound: Arc<dyn Source>,
    /// Bits of the factor for the radiance above 700 nm.
    factor: Arc<AtomicU64>,
}

impl Source for Broken {
    fn spectrum(&self) -> &SpectralPower {
        self.sound.spectrum()
    }
    fn distance_mm(&self) -> f64 {
        self.sound.distance_mm()
    }
    fn radiance(&self) -> Option<&dyn Radiance> {
        Some(self)
    }
    fn describe(&self) -> String {
        self.sound.describe()
    }
}

impl Radiance for Broken {
    fn radiance(&self, rays: &mut RayBatch) {
        self.sound.radiance().expect("sound").radiance(rays);
        let factor = f64::from_bits(self.factor.load(Relaxed));
        let c = rays.columns_mut();
        for (weight, nm) in c.weight.iter_mut().zip(c.wavelength_nm.iter()) {
            if *nm > 700.0 {
                *weight *= factor;
            }
        }
    }
}

/// Renders the gray card with a source that is broken by this factor, either from the start or only after the pilot run. Returns the
/// result, and the light traced before.
fn broken(factor: f64, at_once: bool) -> (Result<(), RenderError>, Option<Rendering>) {
    let mut scene = load("gray-card.yaml", &["imager.resolution=[96, 64]", "render.samples=4096"]);
    let bits = Arc::new(AtomicU64::new(if at_once { factor } else { 1.0 }.to_bits()));
    let sound = Arc::clone(&scene.source);
    scene.source = Arc::new(Broken { sound, factor: Arc::clone(&bits) });
    let renderer = match Renderer::new(scene.clone(), &RenderOptions::default()) {
        Ok(renderer) => renderer,
        Err(error) => return (Err(error), None),
    };
    bits.store(factor.to_bits(), Relaxed);
    let mut light = renderer.begin().expect("memory");
    let traced = renderer.advance(&mut light, 4096, &Threads(2), &Control::new());
    (traced, Some(renderer.rendering(&scene, &light).expect("memory")))
}

#[test]
fn a_number_that_is_none_is_found_at_once_and_its_stage_named() {
    for at_once in [true, false] {
        for (factor, what) in [(f64::NAN, "not a number"), (f64::INFINITY, "infinite")] {
            let (traced, light) = broken(factor, at_once);
            let (error, rays) = (traced.expect_err("a broken source"), light.map_or(0, |light| light.rays));
            let said = error.to_string();
            assert!(said.starts_with(&format!("source `chart` gave a radiance that is {what}, at 7")), "{said}");
            // The whole render has 25 million rays.
            assert!(rays < 20_000, "{rays} rays");
        }
    }
    // The fault points to the section of the source.
    let scene = load("gray-card.yaml", &[]);
    let error = broken(f64::NAN, false).0.expect_err("a broken source");
    let fault = error.faults(&scene).expect("a fault of the scene").to_string();
    assert!(fault.contains("gray-card.yaml:") && fault.contains("source `chart`"), "{fault}");
}

#[test]
fn an_overflow_stops_at_once_and_keeps_the_light_before_it() {
    let (traced, light) = broken(1e30, false);
    let error = traced.expect_err("too bright");
    let RenderError::Overflow { times } = &error else { panic!("{error}") };
    let light = light.expect("the light before");
    assert!(*times > 1e6 && light.rays < 20_000, "{times} {}", light.rays);
    assert!(light.partial);
    assert!(error.to_string().contains("times as bright as the brightest"), "{error}");
}

/// Forward and backward, every ray is detected, or lost with a recorded cause.
#[test]
fn every_ray_is_detected_or_lost() {
    for overrides in [
        // A card of 20 cm at 2 m: most of the frame looks past it.
        &["source.width=0.2 m", "render.direction=backward"][..],
        &["source.width=0.2 m", "render.direction=forward", "render.rays=200000"],
        // A card larger than what the frame sees.
        &["source.width=6 m", "render.direction=backward"],
        &["source.width=6 m", "render.direction=forward", "render.rays=200000"],
    ] {
        let set = [&["imager.resolution=[48, 32]", "render.samples=64"], overrides].concat();
        let rendering = render(&load("gray-card.yaml", &set));
        let lost = rendering.losses.total();
        assert_eq!(rendering.detected + lost, rendering.rays, "{overrides:?}");
        assert!(rendering.detected > 0 && lost > 0, "{overrides:?}");
        if overrides == ["source.width=0.2 m", "render.direction=backward"] {
            // The card covers about 4.9 x 3.3 of 36 x 24 mm. The rest is dark, apart from some blur.
            let unlit = rendering.losses.of_cause(Loss::Unlit) as f64;
            let passed = rendering.rays as f64 - (lost as f64 - unlit);
            let covered = 1.0 - unlit / passed;
            assert!((covered / (4.9 * 3.3 / (36.0 * 24.0)) - 1.0).abs() < 0.35, "{covered}");
        }
    }
}

#[test]
fn empty_and_infinite_pictures_are_said_so() {
    let (report, said) = card(&[]);
    let own = ["no light", "all pixels", "32-bit"];
    assert!(!own.iter().any(|words| said.contains(words)), "{said}");
    assert_eq!(report["rays"], report["detected"].as_u64().unwrap() + report["lost"]["total"].as_u64().unwrap());
    for (set, words) in [
        (&["source.luminance=1e308"][..], "have more light than a 32-bit float can hold"),
        (&["source.luminance=1e-60"], "all pixels are 0: light arrived, but less than a 32-bit float can hold"),
        // A small card, and a frame that looks past it.
        (&["imager.shift=[0, 90 mm]", "source.width=0.1 m"], "no light reaches the frame: "),
    ] {
        let (report, said) = card(set);
        assert!(said.contains(words), "{set:?}: {said}");
        let warnings = report["warnings"].to_string();
        assert!(warnings.contains(words), "{set:?}: {warnings}");
    }
}

/// The warning about a point off the axis whose light misses a small frame says where the light lands. A frame at that place receives
/// it.
#[test]
fn light_beside_the_frame_is_said_where_it_lands() {
    let small = "imager={kind: xyz, width: 2 mm, height: 2 mm, resolution: [32, 32]}";
    let few = "render={direction: forward, rays: 20000}";
    let rendering = render(&load("biotar-spot.yaml", &[small, few, "source.distance=20 m"]));
    assert_eq!(rendering.detected, 0);
    let [warning] = &rendering.warnings[..] else { panic!("{:?}", rendering.warnings) };
    let shift = warning.split("`imager.shift: ").nth(1).and_then(|rest| rest.split('`').next());
    let shift = shift.unwrap_or_else(|| panic!("{warning}"));
    let seen =
        render(&load("biotar-spot.yaml", &[small, few, "source.distance=20 m", &format!("imager.shift={shift}")]));
    assert!(seen.detected > 1000 && seen.warnings.is_empty(), "{shift}: {} {:?}", seen.detected, seen.warnings);
}

/// A renderer reseeded for another seed, without a new search, has the same bits as a renderer made for that seed. Checked for both
/// directions, for the halves that judge noise, for meters, for lights with ghosts, and for veiling glare.
#[test]
fn a_reseeded_renderer_has_the_bits_of_a_new_one() {
    let sun = "source={kind: sun, field: [9 deg, 5 deg], illuminance: 60000 lx}";
    for (scene, settings) in [
        ("gray-card.yaml", &["render.samples=8", "render.direction=forward", "render.rays=5000"][..]),
        ("gray-card.yaml", &["render.samples=64", "render.noise=5 %"]),
        (
            "gray-card.yaml",
            &["render.samples=2", sun, "lens.focus=infinity", "render.rays=2000", "render.reflections.order=2"],
        ),
        ("gray-card.yaml", &["render.samples=2", "render.glare=true"]),
        ("biotar-trix.yaml", &["render.samples=4"]),
        ("bench/noise-lights.yaml", &["render.samples=2", "lens.file=zeiss-biotar-50-f1.4"]),
    ] {
        let of = |seed: u64| {
            let seed = format!("render.seed={seed}");
            ready(load(scene, &[&[SMALL, &seed], settings].concat()))
        };
        let (first, third) = (of(1), of(3));
        let (again, want) = (rendered(&first.reseeded(3)), rendered(&third));
        assert!(bits(&again) == bits(&want), "{scene} {settings:?}");
        assert_eq!((again.rays, &again.estimators), (want.rays, &want.estimators));
        assert_eq!(first.reseeded(3).scene().render.seed, 3);
        assert!(bits(&rendered(&first)) != bits(&want), "{scene} {settings:?}: the seed has no effect");
    }
}

/// The renderer of a frame serves the next one if lens and lights stand still, and gives it the bits that it has alone. It does not serve a
/// picture whose rays differ in more than the seed.
#[test]
fn the_search_of_a_frame_serves_the_next() {
    let options = RenderOptions::default();
    let set = [SMALL, "render.samples=2", "lens.file=zeiss-biotar-50-f1.4"];
    let first = ready(load("bench/noise-lights.yaml", &set));
    let mut next = first.scene().with_seed(9);
    next.render.frame = Some(17);
    let (next, mut other) = (Arc::new(next.clone()), next);
    let is_served = |picture: &Scene| first.scene().differs_in_seed_only(picture);
    assert!(is_served(&next));
    let taken = first.for_picture(Arc::clone(&next), &options).expect("renders");
    assert!(bits(&rendered(&taken)) == bits(&rendered(&ready(Scene::clone(&next)))));
    other.render.reflections.order = Some(4);
    assert!(!is_served(&other));
    // A scene that is loaded anew does not share the stages.
    assert!(!is_served(&load("bench/noise-lights.yaml", &set)));
    let draft = RenderOptions { effort: Effort::Draft, ..RenderOptions::default() };
    let (taken, alone) = (first.for_picture(Arc::clone(&next), &draft), Renderer::new(next, &draft));
    assert!(bits(&rendered(&taken.expect("renders"))) == bits(&rendered(&alone.expect("renders"))));
}

/// A picture with another source takes over the pupil that the imager sees, and keeps the bits that it has alone.
#[test]
fn the_pupil_of_a_frame_serves_one_with_another_source() {
    let set = [SMALL, "render.samples=2", "lens.file=zeiss-biotar-50-f1.4"];
    let first = ready(load("bench/noise-portrait.yaml", &set));
    let mut next = first.scene().with_seed(1);
    next.source = load("bench/noise-night.yaml", &set).source.clone();
    let (next, mut beside) = (Arc::new(next.clone()), next);
    beside.lens = load("bench/noise-portrait.yaml", &set).lens.clone();
    assert!(next.has_the_view_of(first.scene()) && !beside.has_the_view_of(first.scene()));
    assert!(!first.scene().differs_in_seed_only(&next));
    let taken = first.for_picture(Arc::clone(&next), &RenderOptions::default()).expect("renders");
    assert!(bits(&rendered(&taken)) == bits(&rendered(&ready(Scene::clone(&next)))));
}

/// Film with few rays causes a warning: empty pixels among others are a bias, not a picture.
#[test]
fn film_with_too_few_rays_is_said_so() {
    let sparse = |rays: &str| {
        let rays = format!("render={{direction: forward, rays: {rays}}}");
        render(&load("biotar-ortho.yaml", &["imager.resolution=[96, 64]", &rays])).warnings
    };
    let few = sparse("3000");
    assert!(few.len() == 1 && few[0].contains("of the pixels got no ray") && few[0].contains("backward"), "{few:?}");
    assert_eq!(sparse("2e6"), Vec::<String>::new());
}

/// A lamp in focus lights one pixel with all its rays, and its ghosts get their rays by `samples`: more `render.rays` would fill no
/// pixel, so there is no warning.
#[test]
fn a_lamp_in_the_dark_needs_no_more_rays() {
    let of = |order: &str, rays: &str| {
        let few = ["imager.resolution=44", "render.samples=1", order, rays];
        render(&load("streak-anamorphic.yaml", &few)).warnings
    };
    for (order, rays) in
        [("render.reflections.order=0", "render.rays=40000"), ("render.reflections.order=2", "render.rays=2000")]
    {
        assert_eq!(of(order, rays), Vec::<String>::new(), "{order} {rays}");
    }
}

/// A benchmark of the integral alone uses the requested number of seeds.
#[test]
fn seeds_of_a_benchmark_are_those_asked_for() {
    let folder = tempfile::tempdir().expect("a folder");
    let scene = repository("scenes/bench/sampling-d65-xyz.yaml");
    let strategies = ["--samples", "1,4", "--strategies", "uniform", "--output", shown(folder.path())];
    let output = run(&[&["bench", shown(&scene), "--seeds", "10", "--integral-only"][..], &strategies].concat());
    let said = text(&output.stdout);
    assert!(output.status.success() && said.contains(" 10 seeds"), "{said}{}", text(&output.stderr));
}
