//! Tests imagers placed where the light of the source lands (`imager: {around: source}`), and points with a color.

use spectra_color::{RgbSpace, to_u8};
use spectra_core::frame::ExposureFrame;
use spectra_plugins as _;
use spectra_render::{Control, RenderOptions, Renderer, Threads};
use std::path::Path;

/// Focal length of the ideal lens, mm.
const FOCAL_MM: f64 = 50.0;
/// Focus distance of the ideal lens, mm.
const DISTANCE_MM: f64 = 2000.0;

fn scene(folder: &Path, source: &str, imager: &str) -> Result<spectra_scene::Scene, String> {
    let lens = "name: ideal\nsource: geometry\nsurfaces:\n  - {kind: thin-lens, focal-length: 50, thickness: 50, semi-diameter: 6}\n";
    std::fs::write(folder.join("ideal.yaml"), lens).expect("written");
    let path = folder.join("scene.yaml");
    let text = format!(
        "spectra: 1\nsource: {source}\nlens: {{file: ideal.yaml, focus: 2 m}}\nimager: {imager}\n\
         render: {{direction: forward, rays: 40000, seed: 1}}\n"
    );
    std::fs::write(&path, text).expect("written");
    spectra_scene::load(&path, &[]).map_err(|faults| faults.to_string())
}

fn render(scene: spectra_scene::Scene) -> ExposureFrame {
    let renderer = Renderer::new(scene, &RenderOptions::default()).expect("ready");
    renderer.run(&Threads(2), &Control::new()).expect("rendered").exposure
}

/// Returns the column and row of the center of the light, in pixels, and the sum of Y.
fn middle(frame: &ExposureFrame) -> ([f64; 2], f64) {
    let y = frame.values("Y").expect("of an xyz imager");
    let width = frame.size.width_px as usize;
    let (mut sum, mut places) = (0.0, [0.0; 2]);
    for (i, value) in y.iter().map(|v| f64::from(*v)).enumerate() {
        sum += value;
        places[0] += value * ((i % width) as f64 + 0.5);
        places[1] += value * ((i / width) as f64 + 0.5);
    }
    (places.map(|v| v / sum), sum)
}

/// The image of a point far off the axis lies at the magnification times its position, and a frame of 1 mm is placed there.
#[test]
fn a_frame_of_a_millimeter_finds_the_spot() {
    let folder = tempfile::tempdir().expect("a folder");
    let source = "{kind: point, distance: 2 m, position: [300 mm, -120 mm], spectrum: D65}";
    let frame = |more: &str| format!("{{kind: xyz, width: 1 mm, height: 1 mm, resolution: [101, 101]{more}}}");
    let around = render(scene(folder.path(), source, &frame(", around: source")).expect("valid"));
    let ([column, row], light) = middle(&around);
    assert!(light > 0.0 && (column - 50.5).abs() < 0.51 && (row - 50.5).abs() < 0.51, "{column} {row}");
    // The position of the image by hand: x and y have the opposite sign, because the image is upside down.
    let magnification = FOCAL_MM / (DISTANCE_MM - FOCAL_MM);
    let [x, y] = [-300.0 * magnification, 120.0 * magnification];
    let by_hand = render(scene(folder.path(), source, &frame(&format!(", shift: [{x} mm, {y} mm]"))).expect("valid"));
    let ([by_column, by_row], by_light) = middle(&by_hand);
    assert!((column - by_column).abs() < 0.51 && (row - by_row).abs() < 0.51, "{by_column} {by_row}");
    assert!((light / by_light - 1.0).abs() < 1e-6, "{light} {by_light}");
    // A shift is relative to that position: 0.2 mm along x and y is 20.2 pixels to the right and up.
    let shifted =
        render(scene(folder.path(), source, &frame(", around: source, shift: [0.2 mm, 0.2 mm]")).expect("valid"));
    let ([shifted_column, shifted_row], _) = middle(&shifted);
    assert!(
        (shifted_column - column - 20.2).abs() < 0.7 && (shifted_row - row + 20.2).abs() < 0.7,
        "{shifted_column} {shifted_row}"
    );
    // Without `around` and `shift` the light misses the frame.
    assert_eq!(middle(&render(scene(folder.path(), source, &frame("")).expect("valid"))).1, 0.0);
}

/// A narrow screen on the axis misses a line that a prism deflects; placed around the source, it finds the line.
#[test]
fn a_screen_finds_the_line_behind_a_prism() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes/prism-hydrogen.yaml");
    let landing = |around: &str| {
        let overrides = [
            "render.rays=20000",
            "source.spectrum=\"line:435.83\"",
            "imager.shift=[0, 0]",
            "imager.height=6 mm",
            "imager.resolution=[120, 60]",
            &format!("imager.around={around}"),
        ];
        let scene =
            spectra_scene::load(&path, &overrides.map(str::to_owned)).unwrap_or_else(|faults| panic!("{faults}"));
        Renderer::new(scene, &RenderOptions::default()).expect("ready").landing().expect("light")
    };
    let (axis, source) = (landing("axis"), landing("source"));
    assert!(axis.on_frame < 0.1 && source.on_frame > 0.9, "{axis:?} {source:?}");
}

/// The screens of the bundled prisms catch the light that they are made for: all Balmer lines, and the visible part of a continuous
/// spectrum.
#[test]
fn the_screens_of_the_prisms_catch_every_line() {
    let balmer: &[f64] = &[656.28, 486.13, 434.05, 410.17, 397.01, 388.91, 383.54];
    for (name, lines_nm) in [("prism-hydrogen", balmer), ("prism-5800k", &[400.0, 700.0])] {
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join(format!("scenes/{name}.yaml"));
        for nm in lines_nm {
            let overrides = ["render.rays=20000".to_owned(), format!("source.spectrum=\"line:{nm}\"")];
            let scene = spectra_scene::load(&path, &overrides).unwrap_or_else(|faults| panic!("{faults}"));
            let landing = Renderer::new(scene, &RenderOptions::default()).expect("ready").landing().expect("light");
            assert!(landing.on_frame > 0.9, "{name}, {nm} nm: {landing:?}");
        }
    }
}

/// A point has the color of its `rgb`, within two code values, at any brightness.
#[test]
fn a_point_has_the_color_that_it_is_given() {
    let folder = tempfile::tempdir().expect("a folder");
    for rgb in [[255_u8, 128, 64], [0, 200, 40], [20, 20, 255], [90, 90, 90]] {
        let [r, g, b] = rgb;
        let source = format!("{{kind: point, distance: 2 m, rgb: [{r}, {g}, {b}]}}");
        let imager = "{kind: xyz, width: 1 mm, height: 1 mm, resolution: [9, 9], around: source}";
        let frame = render(scene(folder.path(), &source, imager).expect("valid"));
        let sum = |name: &str| frame.values(name).expect("of an xyz imager").iter().map(|v| f64::from(*v)).sum::<f64>();
        let linear = RgbSpace::srgb().from_xyz([sum("X"), sum("Y"), sum("Z")]);
        // Compares colors without brightness: the largest component is scaled to the requested one.
        let scale = RgbSpace::srgb().decode(rgb.map(|v| f64::from(v) / 255.0)).into_iter().fold(0.0, f64::max)
            / linear.into_iter().fold(0.0, f64::max);
        let found = RgbSpace::srgb().encode(linear.map(|v| v * scale)).map(to_u8);
        assert!(found.iter().zip(rgb).all(|(a, b)| a.abs_diff(b) <= 2), "{rgb:?} {found:?}");
    }
}

#[test]
fn what_cannot_be_is_refused_with_its_place() {
    let folder = tempfile::tempdir().expect("a folder");
    let imager = "{kind: xyz, width: 1 mm, height: 1 mm, resolution: [9, 9], around: source}";
    for (source, imager, words) in [
        (
            "{kind: point, distance: 2 m, rgb: [255, 0, 0], spectrum: D65}",
            imager,
            "`spectrum` and `rgb` exclude each other",
        ),
        ("{kind: point, distance: 2 m, rgb: [0, 0, 0]}", imager, "the color of a light cannot be black"),
        ("{kind: point, distance: 2 m, rgb: [256, 0, 0]}", imager, "256"),
        ("{kind: point, distance: 2 m, color: {kind: smooth}}", imager, "there is no `rgb`"),
        (
            "{kind: point, distance: 2 m, field: [80 deg, 0]}",
            "{kind: xyz, width: 1 mm, height: 1 mm, resolution: [9, 9], around: lamp}",
            "around",
        ),
    ] {
        let faults = scene(folder.path(), source, imager).err().unwrap_or_else(|| panic!("{source} is accepted"));
        assert!(faults.contains(words), "{faults}");
    }
}

/// If no surface states its size, the hint uses the terms of the lens's file format.
#[test]
fn sizes_are_asked_for_in_the_words_of_the_file() {
    let folder = tempfile::tempdir().expect("a folder");
    let yaml = "name: bare\nsurfaces:\n  - {radius: 50, thickness: 5, nd: 1.5168, vd: 64.2}\n  - {radius: -50, thickness: 47}\n";
    let zmx = "SURF 0\n  DISZ INFINITY\nSURF 1\n  CURV 0.02\n  DISZ 5\n  GLAS N-BK7\nSURF 2\n  CURV -0.02\n  DISZ 47\nSURF 3\n";
    for (name, text, words) in [
        ("bare.yaml", yaml, "state `semi-diameter` in the lens file"),
        ("bare.zmx", zmx, "in the .zmx, add an aperture"),
    ] {
        std::fs::write(folder.path().join(name), text).expect("written");
        let path = folder.path().join("scene.yaml");
        let text = format!(
            "spectra: 1\nsource: {{kind: point, distance: 2 m}}\nlens: {{file: {name}, focus: {{distance: 2 m, by: paraxial}}}}\n\
             imager: {{kind: xyz, width: 1 mm, height: 1 mm, resolution: [9, 9], around: source}}\n\
             render: {{direction: forward, rays: 4000, seed: 1}}\n"
        );
        std::fs::write(&path, text).expect("written");
        let faults = spectra_scene::load(&path, &[]).map(drop).expect_err("no size").to_string();
        assert!(faults.contains("states its size") && faults.contains(words), "{faults}");
    }
}
