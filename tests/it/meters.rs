//! Tests that a camera's meter sees all light on the film: direct light, ghosts and the veil.

use spectra_plugins as _;
use spectra_render::{Control, RenderOptions, Renderer, Rendering, Threads};
use spectra_scene::Scene;

const FILM: &str = "imager: {kind: film, width: 36, height: 24, resolution: [48, 32]}\n\
                    film: {stock: kodak-tri-x-400, metering: average, grain: false}\n";
const EYE: &str = "imager: {kind: xyz, width: 36, height: 24, resolution: [48, 32]}\n";

/// Returns a scene of a source in front of an uncoated Biotar.
fn scene(source: &str, imager: &str, set: &[&str]) -> Scene {
    let text = format!(
        "spectra: 1\n\
         source: {source}\n\
         lens: {{file: zeiss-biotar-50-f1.4, focus: infinity, coating: bare, f-number: 2.8}}\n\
         {imager}\
         render: {{samples: 24, rays: 200000, reflections: {{order: 0, imager: 4 %}}}}\n"
    );
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("scene.yaml");
    std::fs::write(&path, text).expect("written");
    let set: Vec<String> = set.iter().map(|s| (*s).to_owned()).collect();
    spectra_scene::load(&path, &set).unwrap_or_else(|faults| panic!("{faults}"))
}

fn render(scene: Scene) -> Rendering {
    let renderer = Renderer::new(scene, &RenderOptions::default()).expect("ready");
    renderer.run(&Threads(2), &Control::new()).expect("rendered")
}

/// Returns the light that the meter of a film saw, up to a factor: the inverse of the exposure time.
fn metered(source: &str, set: &[&str]) -> f64 {
    let times = scene(source, FILM, set).film_times(&render(scene(source, FILM, set)).exposure);
    assert!(times[0].is_metered);
    1.0 / times[0].time_s
}

/// Returns the light that a photometer in place of the film sees.
fn seen(source: &str, set: &[&str]) -> f64 {
    let exposure = render(scene(source, EYE, set)).exposure;
    exposure.channel("Y").expect("an XYZ imager").values.iter().map(|v| f64::from(*v)).sum()
}

/// Checks that the meter reports the same relative increase of light over direct light alone as the photometer.
fn agree(source: &str, all: &[&str], base: &[&str], least: f64) {
    let all = [base, all].concat();
    let more = |light: fn(&str, &[&str]) -> f64| light(source, &all) / light(source, base) - 1.0;
    let (meter, is) = (more(metered), more(seen));
    println!("increase {is:.5}, by the meter {meter:.5}");
    assert!(is > least, "{is}");
    assert!((meter / is - 1.0).abs() < 0.05, "{meter} {is}");
}

const WHITE: &str = "{kind: chart, chart: gray-card, distance: 1 m, width: 300 m, illuminant: D55, luminance: 100}";
const POINT: &str =
    "{kind: point, distance: 20 m, field: [11 deg, 6 deg], spectrum: 'blackbody:5400', intensity: 1000}";

#[test]
fn a_meter_sees_the_veil() {
    agree(WHITE, &["render.glare=true"], &["render.direction=backward"], 0.01);
}

#[test]
fn a_meter_sees_ghosts() {
    agree(POINT, &["render.reflections.order=2"], &[], 0.005);
    agree(POINT, &["render.reflections.order=2", "render.glare=true"], &[], 0.01);
}

/// The metered time does not depend on the number of threads.
#[test]
fn threads_change_no_time() {
    let set = ["render.reflections.order=2", "render.glare=true", "render.samples=8"];
    let time = |threads: usize| {
        let renderer = Renderer::new(scene(POINT, FILM, &set), &RenderOptions::default()).expect("ready");
        let rendering = renderer.run(&Threads(threads), &Control::new()).expect("rendered");
        scene(POINT, FILM, &set).film_times(&rendering.exposure)[0].time_s.to_bits()
    };
    assert_eq!(time(1), time(3));
}
