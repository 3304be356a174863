//! Tests veiling glare in pictures: its amount agrees with random walks to a white field and is the same from the source and from the
//! imager. Added to ghosts, no light is counted twice, and the bits do not depend on how the work is done.

use spectra_core::Isa;
use spectra_core::frame::ExposureFrame;
use spectra_plugins as _;
use spectra_render::{Control, Light, RenderOptions, Renderer, Rendering, Threads};
use spectra_scene::Scene;
use spectra_tracer::{Interior, StrayReflectances, WalkNumbers, Walker};

const HE_NE_NM: f64 = 632.816;

/// Returns a scene of a source with one spectral line in front of an uncoated Biotar.
fn scene(source: &str, set: &[&str]) -> Result<Scene, String> {
    let text = format!(
        "spectra: 1\n\
         source: {source}\n\
         lens: {{file: zeiss-biotar-50-f1.4, focus: infinity, coating: bare, absorption: false, f-number: 2}}\n\
         imager: {{kind: xyz, width: 36, height: 24, resolution: [48, 32]}}\n\
         render: {{samples: 24, rays: 60000, reflections: {{imager: 0}}}}\n"
    );
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("scene.yaml");
    std::fs::write(&path, text).expect("written");
    let set: Vec<String> = set.iter().map(|s| (*s).to_owned()).collect();
    spectra_scene::load(&path, &set).map_err(|faults| faults.to_string())
}

fn render(source: &str, set: &[&str]) -> Rendering {
    let scene = scene(source, set).unwrap_or_else(|faults| panic!("{faults}"));
    let renderer = Renderer::new(scene, &RenderOptions::default()).expect("ready");
    renderer.run(&Threads(2), &Control::new()).expect("rendered")
}

const WHITE: &str = "{kind: chart, chart: gray-card, distance: 1 m, width: 300 m, illuminant: he-ne, luminance: 100}";
const POINT: &str = "{kind: point, distance: 20 m, field: [11 deg, 6 deg], spectrum: he-ne, intensity: 1000}";

/// Returns the mean of Y over the frame.
fn mean(frame: &ExposureFrame) -> f64 {
    let y = &frame.channel("Y").expect("an XYZ imager").values;
    y.iter().map(|v| f64::from(*v)).sum::<f64>() / y.len() as f64
}

/// Returns the veil alone: the mean with glare minus the mean without.
fn veil(source: &str, set: &[&str]) -> f64 {
    mean(&render(source, &[set, &["render.glare=true"]].concat()).exposure) - mean(&render(source, set).exposure)
}

/// A white wall fills the field of the lens. Its veil relative to direct light agrees with walks from the imager to a white field.
#[test]
fn the_veil_of_a_white_wall_is_that_of_a_white_field() {
    let rendering = render(WHITE, &["render.glare={paint: 20 %, imager: 30 %}"]);
    assert_eq!(rendering.estimators, ["backward", "glare"]);
    let share = rendering.glare.expect("asked for");
    let scene = scene(WHITE, &[]).expect("a scene");
    let matter = StrayReflectances { paint: 0.2, imager: 0.3, imager_mirror: 0.0 };
    let interior = Interior::new(&scene.lens, [36.0, 24.0], [HE_NE_NM; 2], matter).expect("straight");
    let mut walker = Walker::new(&interior);
    walker.set_wavelength(HE_NE_NM);
    let (mut stray, mut all, mut squares) = (0.0, 0.0, 0.0);
    for walk in 0..300_000 {
        let mut chance = WalkNumbers::new(77, walk);
        let at = [36.0 * (chance.number() - 0.5), 24.0 * (chance.number() - 0.5)];
        if let Some(out) = walker.from_imager(at, &mut chance) {
            let own = if out.is_straight() { 0.0 } else { out.weight };
            (stray, all, squares) = (stray + own, all + out.weight, squares + own * own);
        }
    }
    let (want, error) = (stray / all, f64::sqrt(squares) / all);
    println!("veil {share:.5}, of walks {want:.5} +- {error:.5}");
    assert!(want > 0.02 && error < 0.03 * want && (share - want).abs() < 4.0 * error, "{share} {want} {error}");
}

/// A small bright plate has the same veil in both directions.
#[test]
fn both_directions_have_the_same_veil() {
    let plate = "{kind: chart, chart: gray-card, distance: 1 m, width: 500 mm, illuminant: he-ne, luminance: 100}";
    let each = |direction: &str| {
        let direction = format!("render.direction={direction}");
        let runs: Vec<f64> = (1..=3).map(|seed| veil(plate, &[&direction, &format!("render.seed={seed}")])).collect();
        let mean = runs.iter().sum::<f64>() / 3.0;
        (mean, (runs.iter().map(|r| (r - mean) * (r - mean)).sum::<f64>() / 6.0).sqrt())
    };
    let ((a, ea), (b, eb)) = (each("forward"), each("backward"));
    println!("forward {a:.6} +- {ea:.6}, backward {b:.6} +- {eb:.6}");
    // Three seeds determine their own error only up to a factor.
    assert!((a / b - 1.0).abs() < 0.05 && (a - b).abs() < 8.0 * f64::hypot(ea, eb).max(1e-3 * a), "{a} {b}");
}

/// Light that glass reflects twice belongs to the ghosts if they are traced, and otherwise to the veil: the sum is the same.
#[test]
fn ghosts_are_not_counted_twice() {
    let own = |set: &[&str]| mean(&render(POINT, &[set, &["render.glare=true"]].concat()).exposure);
    let straight = mean(&render(POINT, &[]).exposure);
    let with_ghosts = render(POINT, &["render.glare=true", "render.reflections.order=2"]);
    assert_eq!(with_ghosts.estimators, ["forward", "ghosts", "glare"]);
    let (apart, together) = (mean(&with_ghosts.exposure) - straight, own(&[]) - straight);
    let ghosts = mean(&render(POINT, &["render.reflections.order=2"]).exposure) - straight;
    println!("straight {straight:.4e}, ghosts {ghosts:.4e}, ghosts and veil {apart:.4e}, veil alone {together:.4e}");
    assert!(ghosts > 0.3 * together, "less than a third is reflected twice");
    assert!((apart / together - 1.0).abs() < 0.03, "{apart} {together}");
    // Counted twice, the light would exceed this.
    assert!((together + ghosts) / apart > 1.2);
}

/// There is no veil if nothing reflects, and `false` equals leaving the key out.
#[test]
fn no_veil_without_reflections() {
    let dark = render(WHITE, &["render.glare.paint=0", "lens.coating=ideal"]);
    assert!(dark.glare.is_some_and(|share| share < 1e-6), "{:?}", dark.glare);
    let bits = |r: &Rendering| {
        r.exposure.channels.iter().flat_map(|c| c.values.iter().map(|v| v.to_bits())).collect::<Vec<_>>()
    };
    assert_eq!(bits(&render(WHITE, &["render.glare=false"])), bits(&render(WHITE, &[])));
}

#[test]
fn threads_batches_and_steps_change_no_bit() {
    let bits = |r: &Rendering| {
        r.exposure.channels.iter().flat_map(|c| c.values.iter().map(|v| v.to_bits())).collect::<Vec<_>>()
    };
    for source in [WHITE, POINT] {
        let renderer = |isa, set: &[&str]| {
            let set = [set, &["render.glare.imager=20 %", "render.samples=5", "render.rays=5000"]].concat();
            Renderer::new(scene(source, &set).expect("a scene"), &RenderOptions { isa, ..RenderOptions::default() })
                .expect("ready")
        };
        let whole = renderer(Isa::detect(), &[]);
        let run = |r: &Renderer, threads| bits(&r.run(&Threads(threads), &Control::new()).expect("rendered"));
        let want = run(&whole, 1);
        assert_eq!(run(&whole, 3), want);
        assert_eq!(run(&renderer(Isa::detect(), &["render.batch=40"]), 2), want);
        assert_eq!(run(&renderer(Isa::Baseline, &[]), 2), want);
        let (threads, control) = (Threads(2), Control::new());
        let mut light = whole.begin().expect("memory");
        whole.advance(&mut light, 2, &threads, &control).expect("rendered");
        let mut file = Vec::new();
        light.save(&mut file).expect("written");
        let mut light = Light::load(&whole, &mut &file[..]).expect("of this scene");
        whole.advance(&mut light, 5, &threads, &control).expect("rendered");
        assert_eq!(bits(&whole.rendering(whole.scene(), &light).expect("memory")), want);
    }
}

#[test]
fn what_cannot_be_is_told() {
    let told = |set: &[&str]| scene(WHITE, set).map(|_| ()).expect_err("refused");
    let message = told(&["render.glare.imager=0.8", "render.reflections.imager=0.5"]);
    assert!(message.contains("sends back more light than reaches it"), "{message}");
    assert!(told(&["render.glare.paint=1.5"]).contains("out of range"));
    let prism = scene(
        POINT,
        &[
            "lens={file: prism-60-sf11}",
            "render.glare=true",
            "source={kind: beam, distance: 60 mm, slit: [6 mm, 1 mm], spectrum: he-ne}",
        ],
    );
    let error = Renderer::new(prism.expect("a scene"), &RenderOptions::default()).map(|_| ()).expect_err("refused");
    assert!(error.to_string().contains("surface 1 is tilted"), "{error}");
}
