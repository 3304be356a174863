//! Tests layers of light: direct, ghosts, glare and star add up to the picture, in the renderer and in a file. Requesting them
//! changes no bit.

use crate::common::statistics::{self, drafted, ready};
use crate::common::{run, shown, text};
use exr::prelude::FlatSamples;
use spectra_core::frame::ExposureChannel;
use spectra_plugins as _;
use spectra_render::{Renderer, Rendering};
use spectra_scene::{LightKind, Scene};

/// The sun beside the axis of an uncoated lens, with ghosts, veiling glare and the star of the blades.
const SUN: &str = "spectra: 1\n\
    source: {kind: sun, field: [9 deg, 5 deg], illuminance: 60000 lx}\n\
    lens: {file: zeiss-biotar-50-f1.4, f-number: f/8, focus: infinity, coating: bare, aperture: {shape: iris, blades: 6}}\n\
    imager: {kind: xyz, width: 36, height: 24, resolution: [72, 48]}\n\
    render: {direction: forward, samples: 2, rays: 20000, reflections: {order: 2}, glare: true, diffraction: true}\n";

fn rendered(output: &str, set: &[&str]) -> Rendering {
    rendered_by(drafted, output, set)
}

fn rendered_by(made: fn(Scene) -> Renderer, output: &str, set: &[&str]) -> Rendering {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("sun.yaml");
    std::fs::write(&path, format!("{SUN}output: {output}\n")).expect("written");
    statistics::rendered(&made(statistics::load(&path, set)))
}

const ALL: &str = "[{kind: exr, layers: [direct, ghosts, glare, star]}]";

#[test]
fn kinds_of_light_are_the_whole() {
    let rendering = rendered(ALL, &[]);
    let kinds: Vec<LightKind> = rendering.layers.iter().map(|layer| layer.kind).collect();
    assert_eq!(kinds, LightKind::ALL);
    for (at, channel) in rendering.exposure.channels.iter().enumerate() {
        let parts: Vec<&ExposureChannel> = rendering.layers.iter().map(|layer| &layer.channels[at]).collect();
        for (part, kind) in parts.iter().zip(kinds.iter()) {
            assert_eq!((&part.unit, part.name.clone()), (&channel.unit, format!("{}.{}", kind.name(), channel.name)));
            assert!(part.values.iter().any(|v| *v != 0.0), "{}", part.name);
        }
        for (pixel, whole) in channel.values.iter().enumerate() {
            let own = || parts.iter().map(|part| f64::from(part.values[pixel]));
            let (sum, size) = (own().sum::<f64>(), own().map(f64::abs).sum::<f64>());
            assert!((sum - f64::from(*whole)).abs() <= 3e-7 * size, "{}: {sum} {whole}", channel.name);
        }
    }
    // Light that diffraction moves out of the frame is missing from the sum.
    let star: f64 = rendering.layers[3].channels[1].values.iter().map(|v| f64::from(*v)).sum();
    assert!(star < 0.0, "{star}");
}

#[test]
fn asking_for_them_changes_no_bit() {
    let bits = |rendering: &Rendering| -> Vec<u32> {
        rendering.exposure.channels.iter().flat_map(|c| c.values.iter().map(|v| v.to_bits())).collect()
    };
    let plain = rendered("[exr]", &[]);
    assert!(plain.layers.is_empty());
    let layered = rendered(ALL, &[]);
    assert_eq!(bits(&plain), bits(&layered));
    // A layer holds the light of its estimator: without ghosts and glare everything else is direct.
    let bare = ["render.reflections.order=0", "render.glare=false", "render.diffraction=false"];
    let direct = rendered(ALL, &bare);
    assert_eq!(direct.exposure.channels[1].values, layered.layers[0].channels[1].values);
    assert_eq!(direct.exposure.channels[1].values, direct.layers[0].channels[1].values);
    assert!(direct.layers[1..].iter().flat_map(|l| &l.channels).flat_map(|c| &c.values).all(|v| v.to_bits() == 0));
}

#[test]
fn a_file_has_them_beside_the_exposure() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("sun.yaml");
    std::fs::write(&path, format!("{SUN}output: [{{kind: exr, layers: [ghosts, star]}}]\n")).expect("written");
    let output = run(&["run", shown(&path), "-o", shown(folder.path())]);
    assert!(output.status.success(), "{}", text(&output.stderr));
    let image = exr::prelude::read_all_flat_layers_from_file(folder.path().join("sun.exr")).expect("an EXR");
    let channels = &image.layer_data[0].channel_data.list;
    let names: Vec<String> = channels.iter().map(|channel| channel.name.to_string()).collect();
    assert_eq!(names, ["X", "Y", "Z", "ghosts.X", "ghosts.Y", "ghosts.Z", "star.X", "star.Y", "star.Z"]);
    let want = rendered_by(ready, ALL, &[]);
    let FlatSamples::F32(values) = &channels[4].sample_data else { panic!("32-bit floats") };
    assert_eq!(values, &want.layers[1].channels[1].values);
    // The picture itself is read as before, with or without layers.
    let said = run(&["picture", "info", shown(&folder.path().join("sun.exr"))]);
    assert!(said.status.success(), "{}", text(&said.stderr));
}

#[test]
fn layers_of_the_picture_are_told_from_those_of_light() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("sun.yaml");
    for (layers, words) in [
        ("layers: [ghosts, densities]", "`holds: picture`"),
        ("layers: [ghosts, ghosts]", "listed twice"),
        ("holds: picture, layers: [ghosts]", "layers of the exposure"),
    ] {
        std::fs::write(&path, format!("{SUN}output: [{{kind: exr, {layers}}}]\n")).expect("written");
        let output = run(&["check", shown(&path)]);
        assert!(!output.status.success() && text(&output.stderr).contains(words), "{}", text(&output.stderr));
    }
}
