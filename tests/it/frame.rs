//! Tests that a source with `width: fill` fills the frame and is not much larger, and what lies beyond its border.

use spectra_core::frame::ExposureFrame;
use spectra_plugins as _;
use spectra_render::{Control, RenderOptions, Renderer, Threads};
use spectra_scene::Scene;
use std::path::Path;

fn load(overrides: &[&str]) -> Scene {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes/gray-card.yaml");
    let small = ["imager.resolution=[36, 24]", "render.samples=64"];
    let overrides: Vec<String> = small.iter().chain(overrides).map(|o| (*o).to_owned()).collect();
    spectra_scene::load(&path, &overrides).unwrap_or_else(|faults| panic!("{overrides:?}\n{faults}"))
}

fn render(scene: &Scene) -> ExposureFrame {
    Renderer::new(scene.clone(), &RenderOptions::default())
        .expect("ready")
        .run(&Threads(2), &Control::new())
        .expect("rendered")
        .exposure
}

/// A card that fills the frame makes the same picture as a far larger one, bit for bit. No border is seen at any aperture, out of
/// focus, on a tilted frame or through a wide-angle lens. A card one tenth narrower causes a warning.
#[test]
fn what_fills_the_frame_shows_no_border_and_is_not_much_larger() {
    for set in [
        &["lens.focus=2 m"][..],
        &["lens.f-number=f/8"],
        &["lens.focus=0.7 m"],
        &["imager.tilt=[8 deg, 0]"],
        &["imager.shift=[6 mm, 4 mm]", "lens.f-number=f/8"],
        &["lens.file=cooke-triplet-50-f5"],
        &["lens.file=zeiss-hologon-15-f8"],
    ] {
        let filled = load(&[set, &["source.width=fill"]].concat());
        let large = load(&[set, &["source.width=500 m"]].concat());
        assert!(filled.warnings.iter().all(|w| w.0.path != "source.width"), "{set:?}: {:?}", filled.warnings);
        assert_eq!(render(&filled), render(&large), "{set:?}");
        let described = filled.source.describe();
        let width_mm = described.split_once('(').and_then(|(_, rest)| rest.split(' ').next()?.parse::<f64>().ok());
        let narrower = format!("source.width={} mm", 0.9 * width_mm.expect("it says its width"));
        let narrower = load(&[set, &[narrower.as_str()]].concat());
        assert!(narrower.warnings.iter().any(|w| w.0.path == "source.width"), "{set:?}");
    }
}

/// A chart of one color continues beyond its border with `clamp` and `mirror`, and ends with `black`.
#[test]
fn beyond_the_border_is_what_the_edge_says() {
    let large = render(&load(&["source.width=500 m"]));
    for (edge, same) in [("clamp", true), ("mirror", true), ("black", false)] {
        let scene = load(&["source.width=0.5 m", &format!("source.edge={edge}")]);
        assert!(scene.warnings.is_empty(), "{edge}: {:?}", scene.warnings);
        assert_eq!(render(&scene) == large, same, "{edge}");
    }
}

/// `null` removes a section on the command line as in a file.
#[test]
fn null_takes_a_section_away() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes/biotar-ortho.yaml");
    let set = ["imager={kind: xyz, format: 135, resolution: 36}", "film=null"].map(str::to_owned);
    let scene = spectra_scene::load(&path, &set).unwrap_or_else(|faults| panic!("{faults}"));
    assert!(scene.films.is_empty());
    assert_eq!((scene.imager.size().width_px, scene.imager.size().height_px), (36, 24));
}

/// A `resolution` of one number makes square pixels, for a part of the frame too.
#[test]
fn a_crop_has_the_shape_that_is_asked() {
    let scene = load(&["imager.crop=16:9", "imager.resolution=1920"]);
    let size = scene.imager.size();
    assert_eq!((size.width_px, size.height_px, size.width_mm, size.height_mm), (1920, 1080, 36.0, 20.25));
    assert!(scene.warnings.is_empty(), "{:?}", scene.warnings);
    let tall = load(&["imager.crop=1", "imager.resolution=100"]).imager.size();
    assert_eq!((tall.width_px, tall.height_px, tall.width_mm, tall.height_mm), (100, 100, 24.0, 24.0));
}
