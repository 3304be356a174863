//! Tests ghosts by path: the strongest paths have their own layers and the rest shares one. Together they are all ghosts, whichever
//! layers are requested and however the work is done.

use crate::common::statistics::{Estimate, drafted};
use crate::common::{run, shown, text};
use spectra_analysis::ghosts::{GhostSearch, ghosts};
use spectra_plugins as _;
use spectra_render::{Control, Light, RenderOptions, Renderer, Rendering, Threads};
use spectra_scene::{GhostPaths, LightKind, LightLayer, Scene};

/// The sun beside the axis of an uncoated lens, with ghosts, veiling glare and the star of the blades.
const SUN: &str = "spectra: 1\n\
    source: {kind: sun, field: [9 deg, 5 deg], illuminance: 60000 lx}\n\
    lens: {file: cooke-triplet-50-f5, f-number: f/8, focus: infinity, coating: bare, aperture: {shape: iris, blades: 6}}\n\
    imager: {kind: xyz, width: 36, height: 24, resolution: [72, 48]}\n\
    render: {direction: forward, samples: 2, rays: 20000, reflections: {order: 2}, glare: true, diffraction: true}\n";

/// A far point on the axis in one spectral line, with a frame on which all its ghosts land.
const AXIS: &str = "spectra: 1\n\
    source: {kind: point, distance: 1 km, spectrum: he-ne, intensity: 1e6}\n\
    lens: {file: zeiss-biotar-50-f1.4, f-number: f/4, focus: infinity, coating: bare, absorption: false}\n\
    imager: {kind: xyz, width: 600, height: 600, resolution: [30, 30]}\n\
    render: {direction: forward, samples: 8, rays: 100000, reflections: {order: 2}}\n";
const HE_NE_NM: f64 = 632.816;

fn scene_of(scene: &str, output: &str, set: &[&str]) -> Scene {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("scene.yaml");
    std::fs::write(&path, format!("{scene}output: {output}\n")).expect("written");
    let set: Vec<String> = set.iter().map(|s| (*s).to_owned()).collect();
    spectra_scene::load(&path, &set).unwrap_or_else(|faults| panic!("{faults}"))
}

fn renderer(output: &str, set: &[&str]) -> Renderer {
    drafted(scene_of(SUN, output, set))
}

fn rendered(output: &str, set: &[&str]) -> Rendering {
    renderer(output, set).run(&Threads(2), &Control::new()).expect("rendered")
}

const BY_PATH: &str = "[{kind: exr, layers: [direct, star], ghost-paths: 5}]";
/// Random walks for the veil take most of the time, so most tests do without them.
const CLEAR: &str = "render.glare=false";

fn all_bits(rendering: &Rendering) -> Vec<u32> {
    let layers = rendering.layers.iter().flat_map(|layer| &layer.channels);
    let channels = rendering.exposure.channels.iter().chain(layers);
    channels.flat_map(|c| c.values.iter().map(|v| v.to_bits())).collect()
}

/// Checks that in each pixel of each channel the layers add up to the whole, up to the rounding of each to 32 bits.
fn add_up(layers: &[&LightLayer], whole: &[spectra_core::frame::ExposureChannel]) {
    for (at, channel) in whole.iter().enumerate() {
        for (pixel, whole) in channel.values.iter().enumerate() {
            let own = || layers.iter().map(|layer| f64::from(layer.channels[at].values[pixel]));
            let (sum, size) = (own().sum::<f64>(), own().map(f64::abs).sum::<f64>());
            assert!((sum - f64::from(*whole)).abs() <= 3e-7 * size, "{}: {sum} {whole}", channel.name);
        }
    }
}

#[test]
fn paths_and_the_rest_are_the_ghosts_and_with_the_other_kinds_the_picture() {
    let all = "[{kind: exr, layers: [direct, ghosts, glare, star], ghost-paths: 5}]";
    for set in [&[][..], &[CLEAR, "render.noise=20 %", "render.samples=64"], &[CLEAR, "render.reflections.order=4"]] {
        let rendering = rendered(all, set);
        let of = |wanted: fn(&LightLayer) -> bool| rendering.layers.iter().filter(|l| wanted(l)).collect::<Vec<_>>();
        let paths = of(|layer| layer.paths != GhostPaths::All);
        let kinds = of(|layer| layer.paths == GhostPaths::All);
        assert_eq!((paths.len(), kinds.len()), (6, 4));
        add_up(&paths, &kinds[1].channels);
        let but_ghosts = of(|layer| layer.kind != LightKind::Ghosts);
        add_up(&[but_ghosts, paths.clone()].concat(), &rendering.exposure.channels);
        // Layers are named after the strongest paths of the ledger, in its order, and each has light.
        let ledger = rendering.ledger.as_ref().expect("ghosts are traced");
        for (layer, path) in paths[..5].iter().zip(&ledger.paths) {
            assert_eq!(layer.paths, GhostPaths::One(path.surfaces.clone()));
            let numbers: Vec<String> = path.surfaces.iter().map(usize::to_string).collect();
            assert_eq!(layer.channels[1].name, format!("ghosts.{}.Y", numbers.join("-")));
            assert!(layer.channels.iter().all(|c| c.values.iter().any(|v| *v > 0.0)), "{:?}", layer.paths);
        }
        assert_eq!(paths[5].channels[1].name, "ghosts.other.Y");
        assert!(paths[5].channels[1].values.iter().any(|v| *v > 0.0));
    }
}

#[test]
fn asking_for_paths_changes_no_bit() {
    let bits = |rendering: &Rendering| -> Vec<u32> {
        rendering.exposure.channels.iter().flat_map(|c| c.values.iter().map(|v| v.to_bits())).collect()
    };
    let (plain, few, many) =
        (rendered("[exr]", &[CLEAR]), rendered("[{kind: exr, ghost-paths: 1}]", &[CLEAR]), rendered(BY_PATH, &[CLEAR]));
    assert!(plain.layers.is_empty() && few.layers.len() == 2);
    assert_eq!(bits(&plain), bits(&many));
    assert_eq!(bits(&plain), bits(&few));
    // A path has the same light, whatever the number of layers.
    let strongest = many.layers.iter().find(|layer| layer.kind == LightKind::Ghosts).expect("a path");
    assert_eq!(few.layers[0], *strongest);
    // Without ghosts the layer of the rest exists, and it is empty.
    let none = rendered(BY_PATH, &[CLEAR, "render.reflections.order=0"]);
    let ghosts: Vec<&LightLayer> = none.layers.iter().filter(|layer| layer.kind == LightKind::Ghosts).collect();
    assert!(ghosts.len() == 1 && ghosts[0].paths == GhostPaths::Others);
    assert!(ghosts[0].channels.iter().flat_map(|c| &c.values).all(|v| v.to_bits() == 0));
}

#[test]
fn threads_batches_and_saved_light_change_no_bit_of_a_path() {
    let whole = renderer(BY_PATH, &[CLEAR]);
    let want = all_bits(&whole.run(&Threads(1), &Control::new()).expect("rendered"));
    assert_eq!(all_bits(&whole.run(&Threads(3), &Control::new()).expect("rendered")), want);
    assert_eq!(all_bits(&rendered(BY_PATH, &[CLEAR, "render.batch=40"])), want);
    // Traces one sample, saves and loads the light, then traces the other sample.
    let (threads, control) = (Threads(2), Control::new());
    let mut light = whole.begin().expect("memory");
    whole.advance(&mut light, 1, &threads, &control).expect("rendered");
    let mut file = Vec::new();
    light.save(&mut file).expect("written");
    let mut light = Light::load(&whole, &mut &file[..]).expect("of this scene");
    whole.advance(&mut light, 2, &threads, &control).expect("rendered");
    assert_eq!(all_bits(&whole.rendering(whole.scene(), &light).expect("memory")), want);
    // Light saved with other ghost paths is refused, and the message says why.
    for (output, has) in [("[exr]", 0), ("[{kind: exr, ghost-paths: 3}]", 3)] {
        let error = Light::load(&renderer(output, &[CLEAR]), &mut &file[..]).err().expect("other sums").to_string();
        let words = format!("separate sums for 5 ghost paths, but this scene has {has}; set `ghost-paths`");
        assert!(error.contains(&words), "{error}");
    }
}

/// On the axis, paths have the energies that `lens ghosts` reports, within 4 standard errors over eight seeds plus the 1 % of its
/// 4096 rays. The strongest path is the same.
#[test]
fn the_strongest_path_is_that_of_lens_ghosts() {
    let output = "[{kind: exr, layers: [direct], ghost-paths: 6}]";
    let scene = scene_of(AXIS, output, &[]);
    let search = GhostSearch { wavelength_nm: HE_NE_NM, order: 2, share: 1e-8 };
    let known = ghosts(&scene.lens, search).expect("indices").paths;
    // All light lands on the frame.
    assert!(known.iter().all(|ghost| ghost.size_mm < 600.0), "{known:?}");
    let renderer = Renderer::new(scene, &RenderOptions::default()).expect("ready");
    let by_seed: Vec<Vec<(GhostPaths, f64)>> = (1..=8)
        .map(|seed| {
            let rendering = renderer.reseeded(seed).run(&Threads(2), &Control::new()).expect("rendered");
            let light = |layer: &LightLayer| layer.channels[1].values.iter().map(|v| f64::from(*v)).sum::<f64>();
            let direct = light(&rendering.layers[0]);
            rendering.layers[1..].iter().map(|layer| (layer.paths.clone(), light(layer) / direct)).collect()
        })
        .collect();
    let mut found = Vec::new();
    for (at, (path, _)) in by_seed[0].iter().enumerate() {
        let GhostPaths::One(surfaces) = path else { continue };
        let energies: Vec<f64> = by_seed.iter().map(|seed| seed[at].1).collect();
        assert!(by_seed.iter().all(|seed| seed[at].0 == *path));
        let Estimate { mean, error } = Estimate::of(&energies);
        let want = known.iter().find(|ghost| ghost.surfaces == *surfaces).expect("the same paths").energy;
        assert!((mean - want).abs() < 4.0 * error + 0.01 * want, "{surfaces:?}: {mean} +- {error}, {want}");
        // The errors are small enough to tell one path from another.
        assert!(error < 0.02 * want, "{surfaces:?}: {mean} +- {error}");
        found.push((mean, surfaces.clone()));
    }
    assert_eq!(found.len(), 6);
    let strongest = found.iter().max_by(|a, b| a.0.total_cmp(&b.0)).expect("six");
    assert_eq!(strongest.1, known[0].surfaces);
}

#[test]
fn a_file_has_a_layer_for_each_path() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("sun.yaml");
    std::fs::write(&path, format!("{SUN}output: [{{kind: exr, layers: [star], ghost-paths: 2}}]\n")).expect("written");
    let output = run(&["run", shown(&path), "-o", shown(folder.path())]);
    assert!(output.status.success(), "{}", text(&output.stderr));
    let image = exr::prelude::read_all_flat_layers_from_file(folder.path().join("sun.exr")).expect("an EXR");
    let channels = &image.layer_data[0].channel_data.list;
    let names: Vec<String> = channels.iter().map(|channel| channel.name.to_string()).collect();
    let report: serde_json::Value = {
        let text = std::fs::read_to_string(folder.path().join("sun.json")).expect("a report");
        serde_json::from_str(&text).expect("JSON")
    };
    let named = |at: usize| {
        let surfaces = report["ledger"]["paths"][at]["surfaces"].as_array().expect("paths");
        surfaces.iter().map(ToString::to_string).collect::<Vec<_>>().join("-")
    };
    let layers = [named(0), named(1), "other".to_owned()].map(|name| format!("ghosts.{name}"));
    let mut want: Vec<String> = ["X", "Y", "Z", "star.X", "star.Y", "star.Z"].map(str::to_owned).to_vec();
    want.extend(layers.iter().flat_map(|layer| ["X", "Y", "Z"].map(|channel| format!("{layer}.{channel}"))));
    want.sort();
    assert_eq!(names, want);
    // The picture itself is read as before, with or without layers.
    let said = run(&["picture", "info", shown(&folder.path().join("sun.exr"))]);
    assert!(said.status.success(), "{}", text(&said.stderr));
}

/// Sums and layers of paths are counted before they are allocated. If there are too many, the message says how many fit.
#[test]
fn memory_is_counted() {
    let needed = |output: &str, set: &[&str]| spectra_render::memory_needed(&scene_of(SUN, output, set));
    let (pixels, channels) = (72 * 48, 3);
    let step = needed("[{kind: exr, ghost-paths: 8}]", &[]) - needed("[{kind: exr, ghost-paths: 7}]", &[]);
    // A sum of eight bytes and a value of four, or two values of four in the copy for the file.
    assert_eq!(step, pixels * channels * 12);
    // A veil has a sum too, and eight more bytes per pixel.
    assert_eq!(needed("[exr]", &[]) - needed("[exr]", &["render.glare=false"]), pixels * (channels * 8 + 8));
    let scene = scene_of(SUN, "[png, {kind: exr, ghost-paths: 32}]", &[]);
    let fits = needed("[png, {kind: exr, ghost-paths: 20}]", &[]);
    assert!(spectra_render::fits(&scene, spectra_render::memory_needed(&scene)).is_ok());
    let said = spectra_render::fits(&scene, fits).expect_err("too many").to_string();
    assert!(said.contains("layers of 32 ghost paths, 72 x 48 pixels of 3 channels each"), "{said}");
    assert!(said.contains("scene.yaml:6:40") && said.contains("`ghost-paths: 20`"), "{said}");
    // If the picture itself is too large, the message is about the picture.
    let said = spectra_render::fits(&scene, 1000).expect_err("too large").to_string();
    assert!(said.contains("72 x 48 pixels of 3 channels need"), "{said}");
}

#[test]
fn paths_are_layers_of_light() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("sun.yaml");
    std::fs::write(&path, format!("{SUN}output: [{{kind: exr, holds: picture, ghost-paths: 3}}]\n")).expect("written");
    let output = run(&["check", shown(&path)]);
    assert!(!output.status.success() && text(&output.stderr).contains("layers of the exposure"));
}
