//! Tests `spectra film develop`, which puts pictures on film without a scene file.

use crate::common::{run, run_in, shown, spectra, text};
use exr::prelude::{ReadChannels, ReadLayers};
use image::{Rgb, RgbImage};
#[cfg(unix)]
use std::io::{BufRead, BufReader, Read};
use std::path::{Path, PathBuf};
use std::process::Output;

fn in_folder(folder: &Path, arguments: &[&str]) -> Output {
    run_in(folder, &[&["film", "develop"], arguments].concat())
}

/// Returns the standard error of a run that must succeed.
fn good(folder: &Path, arguments: &[&str]) -> String {
    let output = in_folder(folder, arguments);
    assert!(output.status.success(), "{arguments:?}: {}", text(&output.stderr));
    text(&output.stderr)
}

fn refused(folder: &Path, arguments: &[&str], code: i32) -> String {
    let output = in_folder(folder, arguments);
    let said = text(&output.stderr);
    assert_eq!(output.status.code(), Some(code), "{arguments:?}: {said}");
    assert!(!said.contains("panicked"), "{said}");
    said
}

fn put(path: PathBuf, width: u32, height: u32, color: impl Fn(u32, u32) -> [u8; 3]) {
    std::fs::create_dir_all(path.parent().expect("a folder")).expect("a folder");
    RgbImage::from_fn(width, height, |x, y| Rgb(color(x, y))).save(path).expect("written");
}

/// Returns the color of a pixel: all kinds of color, with a gray ramp in the lower part.
fn colors(x: u32, y: u32) -> [u8; 3] {
    if y % 40 < 24 { [(x * 4) as u8, (y * 10) as u8, ((x * 7 + y * 3) % 256) as u8] } else { [(x * 4) as u8; 3] }
}

fn read(path: PathBuf) -> RgbImage {
    image::open(&path).unwrap_or_else(|e| panic!("{}: {e}", path.display())).to_rgb8()
}

/// Returns the mean of all code values.
fn mean(picture: &RgbImage) -> f64 {
    picture.as_raw().iter().map(|v| f64::from(*v)).sum::<f64>() / picture.as_raw().len() as f64
}

/// Returns the channels of an EXR file with their names.
fn channels(path: PathBuf) -> Vec<(String, Vec<f32>)> {
    let reader = exr::prelude::read().no_deep_data().largest_resolution_level().all_channels().first_valid_layer();
    let image = reader.all_attributes().from_file(path).expect("an EXR");
    let all = image.layer_data.channel_data.list;
    all.iter().map(|c| (c.name.to_string(), c.sample_data.values_as_f32().collect())).collect()
}

#[test]
fn a_photograph_is_developed_on_every_kind_of_film() {
    let folder = tempfile::tempdir().expect("a folder");
    let at = |name: &str| folder.path().join(name);
    put(at("photo.png"), 60, 40, colors);
    let said = good(folder.path(), &["photo.png", "--stock", "tri-x", "--push", "1", "--grade", "3"]);
    assert!(said.contains("60 x 40 pixels on 36 x 24 mm, no lens, Kodak Tri-X 400"), "{said}");
    let gray = read(at("photo-kodak-tri-x-400.png"));
    assert_eq!(gray.dimensions(), (60, 40));
    assert!(gray.pixels().all(|p| p[0] == p[1] && p[1] == p[2]));
    for (stock, name) in [("5207", "negative.tiff"), ("ektachrome", "slide.png")] {
        good(folder.path(), &["photo.png", "--stock", stock, "-o", name]);
        let picture = read(at(name));
        assert!(picture.pixels().any(|p| p[0].abs_diff(p[2]) > 40), "{stock} has no colors");
    }
    // The longest development time of the data sheet is a push of 1.96 stops.
    good(folder.path(), &["photo.png", "--stock", "tri-x", "--push", "2", "-o", "pushed.png"]);
    // The options set the film settings of a scene.
    let plain = mean(&gray);
    for (more, brighter) in [(["--exposure", "+1"], true), (["--exposure", "-1"], false)] {
        good(folder.path(), &[&["photo.png", "--stock", "tri-x", "-o", "other.png"][..], &more].concat());
        assert_eq!(mean(&read(at("other.png"))) > plain, brighter, "{more:?}");
    }
    // A picture of any shape fills the frame, upright or not.
    put(at("tall.png"), 30, 60, colors);
    let said = good(folder.path(), &["tall.png", "--stock", "tri-x", "--format", "6x7", "-o", "t.png"]);
    assert!(said.contains("30 x 60 pixels on 34.75 x 69.5 mm"), "{said}");
    let said = good(folder.path(), &["tall.png", "--stock", "tri-x", "--side", "20", "-o", "t.png"]);
    assert!(said.contains("10 x 20 pixels") && read(at("t.png")).dimensions() == (10, 20), "{said}");
}

/// By default an EXR file holds the finished picture as linear light, like that of a scene; an `output` that the user sets is
/// followed.
#[test]
fn an_exr_holds_the_developed_picture() {
    let folder = tempfile::tempdir().expect("a folder");
    let at = |name: &str| folder.path().join(name);
    put(at("photo.png"), 30, 20, colors);
    let names = |file: &str| channels(at(file)).into_iter().map(|(name, _)| name).collect::<Vec<_>>();
    let plain = ["photo.png", "--stock", "tri-x", "--grain", "off", "--halation", "off"];
    good(folder.path(), &[&plain[..], &["-o", "normal.exr"]].concat());
    assert_eq!(names("normal.exr"), ["B", "G", "R"]);
    // Changes of the film settings are visible: paper of grade 5 is white and black where paper of grade 0 is gray.
    let spread = |file: &str| {
        let all = channels(at(file)).swap_remove(1).1;
        let mean = all.iter().sum::<f32>() / all.len() as f32;
        (all.iter().map(|v| (v - mean).powi(2)).sum::<f32>() / all.len() as f32).sqrt()
    };
    good(folder.path(), &[&plain[..], &["--grade", "0", "-o", "soft.exr"]].concat());
    good(folder.path(), &[&plain[..], &["--grade", "5", "-o", "hard.EXR"]].concat());
    let (soft, hard) = (spread("soft.exr"), spread("hard.EXR"));
    assert!(hard > 1.2 * soft, "{soft} {hard}");
    // White is the white of the print, as in a PNG.
    good(folder.path(), &[&plain[..], &["-o", "normal.png"]].concat());
    let encoded = |v: f32| 255.0 * if v <= 0.003_130_8 { 12.92 * v } else { 1.055 * v.powf(1.0 / 2.4) - 0.055 };
    let png = read(at("normal.png"));
    for (linear, pixel) in channels(at("normal.exr")).swap_remove(1).1.iter().zip(png.pixels()) {
        assert!((encoded(*linear) - f32::from(pixel[1])).abs() < 1.5, "{linear} {pixel:?}");
    }
    good(folder.path(), &[&plain[..], &["--set", "output=[exr]", "-o", "light.exr"]].concat());
    assert!(names("light.exr").iter().any(|name| name.contains("meter")), "{:?}", names("light.exr"));
    // Files in a folder follow the same rule.
    let set = ["--set", "output=[{kind: exr, holds: picture, space: acescg}]"];
    put(at("photos/a.png"), 30, 20, colors);
    good(folder.path(), &[&plain[..], &set, &["photos", "-o", "folder"]].concat());
    for (file, arguments) in [("alone/photo.exr", &["-o", "alone/"][..]), ("photo-kodak-tri-x-400.exr", &[])] {
        good(folder.path(), &[&plain[..], &set, arguments].concat());
        assert_eq!(names(file), ["B", "G", "R"], "{file}");
    }
    for file in ["folder/photo.exr", "folder/a.exr"] {
        assert_eq!(names(file), ["B", "G", "R"], "{file}");
    }
    let two = ["--set", "output=[exr, png]", "-o", "two/"];
    let said = refused(folder.path(), &[&plain[..], &two].concat(), 2);
    assert!(said.contains("one file is written for each picture, but these are .exr, .png"), "{said}");
    let layers = "output=[{kind: exr, holds: picture, layers: [densities]}]";
    good(folder.path(), &[&plain[..], &["--set", layers, "-o", "layers.exr"]].concat());
    assert!(names("layers.exr").iter().any(|name| name.starts_with("density.")), "{:?}", names("layers.exr"));
}

/// A warning about pixels names the picture file, because the user did not write a scene file. An alpha channel that is opaque
/// everywhere causes no warning.
#[test]
fn what_is_not_opaque_is_told() {
    let folder = tempfile::tempdir().expect("a folder");
    let of = |x: u32| image::Rgba([200, 120, 60, if x < 15 { 0 } else { 255 }]);
    image::RgbaImage::from_fn(60, 40, |x, _| of(x)).save(folder.path().join("cut.png")).expect("written");
    let said = good(folder.path(), &["cut.png", "--stock", "tri-x"]);
    assert!(said.contains("picture `cut.png`: 600 of its 2400 pixels are not opaque"), "{said}");
    assert!(!said.contains("--made"), "{said}");
    image::RgbaImage::from_fn(60, 40, |_, _| of(20)).save(folder.path().join("whole.png")).expect("written");
    assert!(!good(folder.path(), &["whole.png", "--stock", "tri-x"]).contains("opaque"));
}

/// The scene recorded in a developed picture can be rendered, with the same bits.
#[test]
fn the_recorded_scene_gives_the_same_picture() {
    let folder = tempfile::tempdir().expect("a folder");
    let at = |name: &str| folder.path().join(name);
    put(at("photo.png"), 30, 20, colors);
    for format in ["135", "6x7"] {
        good(folder.path(), &["photo.png", "--stock", "ektachrome", "--format", format, "-o", "own.exr"]);
        let header = exr::meta::MetaData::read_from_file(at("own.exr"), false).expect("an EXR").headers.remove(0);
        let recorded = header.own_attributes.other.iter().chain(&header.shared_attributes.other);
        let scene = recorded.into_iter().find(|(name, _)| *name == "spectra:scene").expect("recorded").1;
        let exr::meta::attribute::AttributeValue::Text(scene) = scene else { panic!("no text: {scene:?}") };
        assert!(scene.to_string().contains("no-lens"), "{scene}");
        std::fs::write(at("recorded.yaml"), scene.to_string()).expect("written");
        let output = run_in(folder.path(), &["run", "recorded.yaml", "-o", "again.exr"]);
        assert!(output.status.success(), "{}", text(&output.stderr));
        assert!(channels(at("own.exr")) == channels(at("again.exr")), "{format}");
    }
}

/// A mid gray card prints alike when it is developed from its pixels and when a scene renders it through a colorless lens.
#[test]
fn a_metered_gray_card_prints_as_in_a_scene() {
    let folder = tempfile::tempdir().expect("a folder");
    let at = |name: &str| folder.path().join(name);
    put(at("gray.png"), 24, 16, |_, _| [118; 3]);
    for stock in ["kodak-tri-x-400", "kodak-vision3-250d-5207", "kodak-ektachrome-100d"] {
        good(folder.path(), &["gray.png", "--stock", stock, "--grain", "off", "-o", "own.png"]);
        let scene = format!(
            "spectra: 1\n\
             source: {{kind: picture, file: gray.png, distance: 3 m, width: fill, edge: mirror, luminance: 5000 cd/m2, \
             illuminant: iso-7589-sensitometric-daylight}}\n\
             lens: {{file: zeiss-biotar-50-f1.4, f-number: f/8, focus: 3 m, coating: ideal, absorption: false}}\n\
             imager: {{kind: film, format: 135, resolution: [24, 16]}}\n\
             film: {{stock: {stock}, metering: spot, spot: {{diameter: 0.3}}, grain: false}}\n\
             render: {{samples: 1024}}\noutput: [png]\n"
        );
        std::fs::write(at("scene.yaml"), scene).expect("written");
        let output = run(&["run", shown(&at("scene.yaml")), "-o", shown(&at("scene.png")), "--quiet"]);
        assert!(output.status.success(), "{}", text(&output.stderr));
        let (own, scene) = (read(at("own.png")), read(at("scene.png")));
        let (own, scene) = (own.get_pixel(12, 8).0, scene.get_pixel(12, 8).0);
        println!("{stock}: a gray card is {own:?} by its pixels, {scene:?} by a scene");
        // Tolerance in code values of 255: one step of the file and one for the noise of the rays.
        assert!(own.iter().zip(scene).all(|(a, b)| a.abs_diff(b) <= 2), "{stock}: {own:?} {scene:?}");
    }
}

/// Each layer gets the same exposure from a color directly as from traced rays.
#[test]
fn layers_get_of_colors_what_rays_bring_them() {
    let folder = tempfile::tempdir().expect("a folder");
    let at = |name: &str| folder.path().join(name);
    for (i, color) in [[200, 30, 20], [30, 160, 40], [20, 40, 190], [230, 200, 60]].into_iter().enumerate() {
        put(at("color.png"), 6, 4, |_, _| color);
        let plain = ["color.png", "--stock", "5207", "--meter", "each", "--format", "super-8"];
        let light = ["--set", "output=[exr]"];
        good(folder.path(), &[&plain[..], &light, &["-o", "own.exr"]].concat());
        let through = ["--lens", "helios", "--f-number", "f/8", "--noise", "0.3%", "-o", "lens.exr"];
        // A colorless lens.
        let clear = ["--set", "lens.coating=ideal", "--set", "lens.absorption=false"];
        good(folder.path(), &[&plain[..], &light, &through, &clear].concat());
        let (own, lens) = (channels(at("own.exr")), channels(at("lens.exr")));
        for ((name, own), (_, lens)) in own.iter().zip(&lens).filter(|((name, _), _)| !name.contains("meter")) {
            let middle = |values: &[f32]| f64::from(values[2 * 6 + 3]);
            let off = middle(own) / middle(lens) - 1.0;
            println!("color {i}, {name}: {:+.3} % off", 100.0 * off);
            // The metered value is the mean of a small frame, which is as noisy as the pixel.
            assert!(off.abs() < 0.02, "{name}: {off}");
        }
    }
}

#[test]
fn a_jpeg_to_share_is_the_picture() {
    let folder = tempfile::tempdir().expect("a folder");
    let at = |name: &str| folder.path().join(name);
    put(at("photo.png"), 48, 32, colors);
    let plain = ["photo.png", "--stock", "portra-400", "--grain", "off", "-o"];
    for name in ["a.png", "a.jpg", "b.jpeg"] {
        good(folder.path(), &[&plain[..], &[name]].concat());
    }
    let [png, jpg, jpeg] = ["a.png", "a.jpg", "b.jpeg"].map(|name| read(at(name)));
    let off = png.as_raw().iter().zip(jpg.as_raw()).map(|(a, b)| f64::from(a.abs_diff(*b))).sum::<f64>();
    assert!(off / png.as_raw().len() as f64 <= 2.0, "{off}");
    assert_eq!(jpg, jpeg);
    let set = ["--set", "output=[{kind: jpeg, space: acescct}]", "-o", "c.jpg"];
    let said = refused(folder.path(), &[&plain[..5], &set[..]].concat(), 2);
    assert!(said.contains("8 bits are too few") && said.contains("`kind: tiff`, which has 16"), "{said}");
}

/// Writes an EXR file in ACEScg with patches 12 pixels wide, side by side, in the shape of the format 135.
fn put_acescg(path: PathBuf, colors: &[[f32; 3]]) {
    use exr::prelude::{Encoding, Image, IntegerBounds, LayerAttributes, SpecificChannels, Vec2, WritableImage};
    let size = Vec2(12 * colors.len(), 8 * colors.len());
    let of = |at: Vec2<usize>| {
        let [r, g, b] = colors[at.0 / 12];
        (r, g, b)
    };
    let channels = SpecificChannels::rgb(of);
    let mut image = Image::new(
        exr::prelude::ImageAttributes::new(IntegerBounds::new(Vec2(0, 0), size)),
        exr::prelude::Layer::new(size, LayerAttributes::default(), Encoding::FAST_LOSSLESS, channels),
    );
    image.attributes.chromaticities = Some(exr::meta::attribute::Chromaticities {
        red: Vec2(0.713, 0.293),
        green: Vec2(0.165, 0.830),
        blue: Vec2(0.128, 0.044),
        white: Vec2(0.32168, 0.33767),
    });
    image.write().to_file(path).expect("an EXR");
}

/// The primaries of ACEScg are colors that no light has. They keep their luminance relative to gray, as given by CIE XYZ adapted with
/// Bradford's matrix, and are counted. Layers get the same exposure from such colors as from traced rays.
#[test]
fn colors_beyond_srgb_keep_their_light() {
    let folder = tempfile::tempdir().expect("a folder");
    let at = |name: &str| folder.path().join(name);
    put_acescg(at("wide.exr"), &[[0.5, 0.0, 0.0], [0.0, 0.5, 0.0], [0.0, 0.0, 0.5]]);
    put_acescg(at("gray.exr"), &[[0.18; 3]; 3]);
    let scene = "spectra: 1
source: {kind: picture, file: wide.exr, distance: 2 m, width: fill}
lens: {file: surfaces/pinhole-50}
imager: {kind: xyz, format: 135, resolution: [36, 24]}
render: {samples: 256}
output: [exr]
";
    std::fs::write(at("scene.yaml"), scene).expect("written");
    let output = run_in(folder.path(), &["run", "scene.yaml", "-o", "xyz.exr"]);
    let said = text(&output.stderr);
    assert!(output.status.success(), "{said}");
    assert!(said.contains("864 of its 864 pixels have colors that no light has"), "{said}");
    assert!(said.contains("help: convert it to a narrower gamut"), "{said}");
    std::fs::write(at("gray.yaml"), scene.replace("wide.exr", "gray.exr")).expect("written");
    assert!(run_in(folder.path(), &["run", "gray.yaml", "-o", "gray-xyz.exr"]).status.success());
    let [color, gray] = ["xyz.exr", "gray-xyz.exr"].map(|name| {
        let light = channels(at(name));
        let (_, luminance) = light.iter().find(|(name, _)| name == "Y").expect("Y");
        [0, 1, 2].map(|i| luminance.chunks(12).skip(i).step_by(3).map(|row| f64::from(row[6])).sum::<f64>())
    });
    for (primary, want) in [0.7446, 1.868, 0.161].into_iter().enumerate() {
        let got = color[primary] / gray[primary];
        println!("primary {primary}: {got:.4} of gray, {want} wanted");
        // Four standard errors of 24 pixels with 256 samples each.
        assert!((got / want - 1.0).abs() < 0.02, "{primary}: {got} {want}");
    }
    for (i, color) in [[0.0, 0.5, 0.0], [0.1, 0.0, 0.5]].into_iter().enumerate() {
        put_acescg(at("one.exr"), &[color]);
        let plain = ["one.exr", "--stock", "5207", "--meter", "each", "--format", "super-8"];
        let light = ["--set", "output=[exr]"];
        good(folder.path(), &[&plain[..], &light, &["-o", "own.exr"]].concat());
        let through = ["--lens", "helios", "--f-number", "f/8", "--noise", "1%", "-o", "lens.exr"];
        let clear = ["--set", "lens.coating=ideal", "--set", "lens.absorption=false"];
        good(folder.path(), &[&plain[..], &light, &through, &clear].concat());
        let (own, lens) = (channels(at("own.exr")), channels(at("lens.exr")));
        for ((name, own), (_, lens)) in own.iter().zip(&lens).filter(|((name, _), _)| !name.contains("meter")) {
            let sum = |values: &[f32]| values.iter().map(|v| f64::from(*v)).sum::<f64>();
            let off = sum(own) / sum(lens) - 1.0;
            println!("color {i}, {name}: {:+.3} % off", 100.0 * off);
            assert!(off.abs() < 0.02, "{name}: {off}");
        }
    }
    // A color model for sRGB only keeps the luminance, and its warning says what to write.
    std::fs::write(at("scene.yaml"), scene.replace("width: fill}", "width: fill, color: primaries}")).expect("written");
    let said = text(&run_in(folder.path(), &["run", "scene.yaml", "-o", "xyz.exr"]).stderr);
    assert!(said.contains("colors outside sRGB, for which this color model has no spectrum"), "{said}");
    assert!(said.contains("write `color: {kind: smooth}`"), "{said}");
}

#[test]
fn frames_have_grain_of_their_own_and_one_exposure() {
    let folder = tempfile::tempdir().expect("a folder");
    let at = |name: &str| folder.path().join(name);
    for frame in 7..9 {
        put(at(&format!("plates/plate.{frame:04}.png")), 120, 80, |_, _| [118; 3]);
    }
    put(at("plates/plate.0009.png"), 120, 80, |_, _| [60; 3]);
    std::fs::write(at("plates/plate.0010.png"), b"broken").expect("written");
    let said = refused(folder.path(), &["plates", "--stock", "tri-x", "--format", "super-8", "-o", "out/"], 1);
    assert!(said.contains("exposed like the first") && said.contains("3 of 4 pictures"), "{said}");
    assert!(said.contains("`plates/plate.0010.png` was not developed"), "{said}");
    let frames = [7, 8, 9].map(|n| read(at(&format!("out/plate.{n:04}.png"))));
    let [a, b, dark] = frames.each_ref().map(mean);
    println!("means of the frames: {a:.2} {b:.2} {dark:.2}");
    let differ = frames[0].as_raw().iter().zip(frames[1].as_raw()).filter(|(a, b)| a != b).count();
    assert!(differ * 2 > frames[0].as_raw().len(), "{differ} values differ");
    assert!((a - b).abs() < 1.0 && dark < a - 20.0, "{a} {b} {dark}");

    // Existing files stay, and missing ones still get the exposure of the first picture.
    std::fs::remove_file(at("out/plate.0009.png")).expect("removed");
    let rest = ["plates/plate.000#.png", "--stock", "tri-x", "--format", "super-8", "--skip-existing", "-o", "out/"];
    // An empty file does not count as a picture.
    std::fs::write(at("out/plate.0008.png"), "").expect("written");
    let said = good(folder.path(), &rest);
    assert!(said.contains("out/plate.0007.png already exists") && !said.contains("instead of the first"), "{said}");
    assert_eq!(read(at("out/plate.0009.png")), frames[2]);
    assert_eq!(read(at("out/plate.0008.png")), frames[1]);

    // With `--meter each` the dark frame becomes as light. A sequence is named like its inputs, and numbers stay.
    let each = ["plates/plate.000#.png", "--stock", "tri-x", "--format", "super-8", "--meter", "each"];
    good(folder.path(), &[&each[..], &["-o", "each/d.%03d.tiff"]].concat());
    let again = mean(&read(at("each/d.009.tiff")));
    assert!((again - a).abs() < 1.5, "{again} {a}");
    // A gap is reported to people and programs; pictures that the user lists make no gap.
    put(at("gaps/plate.0003.png"), 6, 4, colors);
    put(at("gaps/plate.0007.png"), 6, 4, colors);
    for pictures in ["gaps", "gaps/plate.####.png"] {
        let said = good(folder.path(), &[pictures, "--stock", "tri-x", "-o", "gap"]);
        assert!(said.contains("note: frames 4 to 6 are missing"), "{said}");
    }
    let output = in_folder(folder.path(), &["gaps", "--stock", "tri-x", "-o", "gap", "--json"]);
    assert!(text(&output.stdout).lines().any(|l| l.contains("\"note\"") && l.contains("frames 4 to 6 are missing")));
    let chosen = ["gaps/plate.0003.png", "gaps/plate.0007.png", "--stock", "tri-x", "-o", "gap"];
    assert!(!good(folder.path(), &chosen).contains("missing"));
    // A single frame has the same grain as within its sequence.
    good(
        folder.path(),
        &["plates/plate.0007.png", "plates/plate.0008.png", "--stock", "tri-x", "--format", "super-8", "-o", "two"],
    );
    assert!(read(at("two/plate.0008.png")) == frames[1], "frame 8 has other grain than in its sequence");
    // Existing files are kept with `--skip-existing`.
    put(at("two/plate.0007.png"), 2, 2, |_, _| [1; 3]);
    good(folder.path(), &["plates/plate.000#.png", "--stock", "tri-x", "-o", "two", "--skip-existing"]);
    assert_eq!(read(at("two/plate.0007.png")).dimensions(), (2, 2));
}

/// Interrupts a run that would take hours, after it began to trace light, and returns what it prints from then on.
#[cfg(unix)]
fn interrupted(folder: &Path, arguments: &[&str]) -> String {
    let endless = ["--json", "--noise", "0.01%", "--set", "render.samples=4000000"];
    let mut child = spectra()
        .current_dir(folder)
        .args(["film", "develop", "--stock", "tri-x", "--lens", "helios-44-58-f2", "--side", "240"])
        .args(endless)
        .args(arguments)
        .stdout(std::process::Stdio::piped())
        .stderr(std::process::Stdio::piped())
        .spawn()
        .expect("the program starts");
    let mut events = BufReader::new(child.stdout.take().expect("piped"));
    let mut line = String::new();
    while !line.contains("\"progress\"") {
        line.clear();
        assert!(events.read_line(&mut line).expect("UTF-8") > 0, "ended before any progress");
    }
    let killed = std::process::Command::new("sh").args(["-c", &format!("kill -INT {}", child.id())]).status();
    assert!(killed.expect("a shell").success());
    let mut rest = String::new();
    events.read_to_string(&mut rest).expect("UTF-8");
    assert_eq!(child.wait().expect("it ends").code(), Some(130), "{rest}");
    rest
}

/// Returns the sorted names in a folder.
#[cfg(unix)]
fn names_in(folder: &Path) -> Vec<String> {
    let entries = std::fs::read_dir(folder).expect("a folder");
    let mut names: Vec<String> =
        entries.map(|entry| entry.expect("an entry").file_name().into_string().expect("plain")).collect();
    names.sort();
    names
}

/// A single frame equals the frame in its sequence: its number determines its grain and the name of its file.
#[test]
fn a_frame_alone_is_that_of_its_sequence() {
    let folder = tempfile::tempdir().expect("a folder");
    let at = |name: &str| folder.path().join(name);
    for frame in 7..9 {
        put(at(&format!("plates/plate.{frame:04}.png")), 60, 40, |_, _| [118; 3]);
    }
    let film = ["--stock", "tri-x", "--format", "super-8", "--meter", "each", "-o"];
    good(folder.path(), &[&["plates"][..], &film, &["all"]].concat());
    let [seven, eight] = ["all/plate.0007.png", "all/plate.0008.png"].map(|name| std::fs::read(at(name)).expect(name));
    assert!(seven != eight, "both frames have the same grain");
    let one = ["plates/plate.0008.png"];
    for (output, file) in
        [("alone/f.####.png", "alone/f.0008.png"), ("folder/", "folder/plate.0008.png"), ("file.png", "file.png")]
    {
        good(folder.path(), &[&one[..], &film, &[output]].concat());
        assert!(std::fs::read(at(file)).expect(file) == eight, "{file}");
    }
    assert!(!at("alone/f.####.png").exists());
    put(at("photo.png"), 60, 40, colors);
    let said = refused(folder.path(), &[&["photo.png"][..], &film, &["alone/f.%04d.png"]].concat(), 2);
    assert!(said.contains("`photo.png` has no number to put into") && said.contains("-o alone/f.0001.png"), "{said}");
}

/// When a sequence through a lens is resumed, missing pictures get the exposure of the first picture, which already exists.
#[test]
fn a_resumed_sequence_through_a_lens_is_metered_on_its_first_picture() {
    let folder = tempfile::tempdir().expect("a folder");
    let at = |name: &str| folder.path().join(name);
    put(at("plates/plate.0001.png"), 60, 40, |_, _| [150; 3]);
    put(at("plates/plate.0002.png"), 60, 40, |_, _| [60; 3]);
    let lens = ["--lens", "helios-44-58-f2", "--side", "24", "--noise", "5%"];
    let all = [&["plates", "--stock", "tri-x", "-o", "out"][..], &lens].concat();
    good(folder.path(), &all);
    let dark = std::fs::read(at("out/plate.0002.png")).expect("there");
    std::fs::remove_file(at("out/plate.0002.png")).expect("removed");
    let said = good(folder.path(), &[&all[..], &["--skip-existing"]].concat());
    assert!(said.contains("`plates/plate.0001.png` is traced once more") && !said.contains("instead of"), "{said}");
    assert!(std::fs::read(at("out/plate.0002.png")).expect("there") == dark, "the exposure changed");
}

/// An incomplete frame of a sequence is not written. A single incomplete picture is written under another name than the existing
/// file.
#[cfg(unix)]
#[test]
fn an_interrupt_leaves_whole_pictures() {
    let folder = tempfile::tempdir().expect("a folder");
    let at = |name: &str| folder.path().join(name);
    for frame in 1..3 {
        put(at(&format!("plates/plate.{frame:04}.png")), 60, 40, colors);
    }
    std::fs::create_dir(at("out")).expect("made");
    std::fs::write(at("out/plate.0001.png"), "a good frame").expect("written");
    let said = interrupted(folder.path(), &["plates", "-o", "out"]);
    assert!(said.contains("\"done\":0") && said.contains("\"interrupted\":true"), "{said}");
    assert_eq!(names_in(&at("out")), ["plate.0001.png"]);
    let said = interrupted(folder.path(), &["plates/plate.0001.png", "-o", "out/plate.0001.png"]);
    assert!(said.contains("out/plate.0001.png` was not overwritten"), "{said}");
    assert_eq!(names_in(&at("out")), ["plate.0001.partial.png", "plate.0001.png"]);
    assert_eq!(std::fs::read(at("out/plate.0001.png")).expect("there"), b"a good frame");
    // With `--skip-existing` an incomplete picture would be skipped the next time, so none is written.
    interrupted(folder.path(), &["plates/plate.0002.png", "-o", "out/plate.0002.png", "--skip-existing"]);
    assert_eq!(names_in(&at("out")), ["plate.0001.partial.png", "plate.0001.png"]);
}

#[test]
fn slips_are_told_with_what_to_write() {
    let folder = tempfile::tempdir().expect("a folder");
    let at = |name: &str| folder.path().join(name);
    put(at("photo.png"), 6, 4, colors);
    std::fs::write(at("notes.txt"), "no picture").expect("written");
    std::fs::create_dir(at("empty")).expect("made");
    // A file whose header claims 60 000 x 60 000 pixels.
    let huge = "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 60000 +X 60000\n";
    std::fs::write(at("huge.hdr"), huge).expect("written");
    let tri_x = ["--stock", "tri-x"];
    for (arguments, words) in [
        (&["photo.png"][..], &["--stock"][..]),
        (&["photo.png", "--stock", "tri-y"], &["no film stock is called `tri-y`", "help: "]),
        (&["photo.png", "--stock", "2383"], &["is not a camera film"]),
        (&["photo.jpg", "--stock", "tri-x"], &["`photo.jpg`: no such file"]),
        (&["notes.txt", "--stock", "tri-x"], &["not an OpenEXR, PNG, JPEG, TIFF, WebP, BMP or Radiance HDR file"]),
        (&["huge.hdr", "--stock", "tri-x"], &["60000 x 60000"]),
        (&["empty", "--stock", "tri-x"], &["no pictures in `empty`"]),
        (&["plate.####.png", "--stock", "tri-x"], &["no numbered file matches `plate.####.png`", "plate.0001.png"]),
        (&["photo.png", "--stock", "tri-x", "--grade", "7"], &["--grade 7", "0 (soft) to 5 (hard)"]),
        (
            &["photo.png", "--stock", "tri-x", "--push", "9"],
            &["--push 9", "from +0 to +2 stops, not +9", "a smaller `push`"],
        ),
        (&["photo.png", "--stock", "tri-x", "--exposure", "+20"], &["a number from -10 to 10"]),
        (&["photo.png", "--stock", "tri-x", "--format", "6x66"], &["did you mean `6x6`?"]),
        (&["photo.png", "--stock", "tri-x", "--lens", "helyos"], &["helios"]),
        (&["photo.png", "--stock", "tri-x", "--f-number", "f/4"], &["--lens"]),
        (&["photo.png", "--stock", "tri-x", "--set", "film.stok=a"], &["--set film.stok=a", "did you mean `stock`?"]),
        (&["photo.png", "--stock", "tri-x", "--view", "projection"], &["--view projection", "is a negative"]),
        (&["photo.png", "--stock", "tri-x", "--side", "60"], &["or a smaller one"]),
        (&["photo.png", "--stock", "tri-x", "-o", "photo.png"], &["is an input picture and would be overwritten"]),
        (&["photo.png", "--stock", "tri-x", "-o", "photo.gif"], &[".png, .jpg, .tiff or .exr"]),
        (&["photo.png", "photo.png", "--stock", "tri-x", "-o", "a.png"], &["names one picture"]),
        (&["photo.png", "photo.png", "--stock", "tri-x", "-o", "out"], &["would both be written as"]),
    ] {
        let said = refused(folder.path(), arguments, 2);
        for word in words {
            assert!(said.replace("\n        ", "").contains(word), "{arguments:?} lacks `{word}`: {said}");
        }
    }
    // A fault that affects every picture is reported once.
    std::fs::copy(at("photo.png"), at("empty/a.png")).expect("copied");
    std::fs::copy(at("photo.png"), at("empty/b.png")).expect("copied");
    let said = refused(folder.path(), &[&["empty", "--grade", "7"][..], &tri_x].concat(), 2);
    assert_eq!(said.matches("there is no paper of grade").count(), 1, "{said}");
    // Programs get the fault as an event.
    let output = in_folder(folder.path(), &["photo.png", "--stock", "tri-x", "--grade", "7", "--json"]);
    let event: serde_json::Value = serde_json::from_slice(&output.stdout).expect("one line of JSON");
    assert_eq!((event["event"].as_str(), event["faults"].as_array().map(Vec::len)), (Some("error"), Some(1)));
    let output = in_folder(folder.path(), &["photo.png", "--stock", "tri-x", "--json"]);
    let lines = text(&output.stdout);
    assert!(
        lines.lines().any(|l| l.contains("\"written\"")) && lines.lines().any(|l| l.contains("\"done\"")),
        "{lines}"
    );
}

/// Parses a `.cube` file by its format alone. Returns the number of points along a side, and the points, red varying fastest.
fn cube(path: PathBuf) -> (usize, Vec<[f64; 3]>) {
    let content = std::fs::read_to_string(path).expect("a file");
    let lines = || content.lines().filter(|line| !line.starts_with('#') && !line.is_empty());
    let size = lines().find_map(|l| l.strip_prefix("LUT_3D_SIZE ")).expect("a size").parse().expect("a number");
    let rows = lines().filter(|line| line.starts_with(|c: char| c.is_ascii_digit() || c == '-'));
    let rows: Vec<[f64; 3]> = rows
        .map(|row| {
            let values: Vec<f64> = row.split(' ').map(|v| v.parse().expect("a number")).collect();
            values.try_into().expect("three values")
        })
        .collect();
    assert_eq!(rows.len(), size * size * size);
    (size, rows)
}

/// A table reproduces the film without its spatial effects: within the requested 0.5 on average, and like the picture that `develop`
/// makes of a uniform color.
#[test]
fn a_table_shows_what_the_film_does() {
    let folder = tempfile::tempdir().expect("a folder");
    let at = |name: &str| folder.path().join(name);
    let made = |arguments: &[&str]| run_in(folder.path(), &[&["film", "cube"], arguments].concat());
    let plain = ["5207", "--print", "2383", "-o", "5207.cube"];
    let output = made(&[&plain[..], &["--json"]].concat());
    assert!(output.status.success(), "{}", text(&output.stderr));
    let report: serde_json::Value = serde_json::from_slice(&output.stdout).expect("JSON");
    let mean = report["random_colors"]["mean_ciede2000"].as_f64().expect("a figure");
    println!("5207 on 2383, 65 points: {report}");
    assert!(mean > 0.0 && mean <= 0.5, "{mean}");
    assert!(report["colorchecker"]["mean_ciede2000"].as_f64().is_some_and(|off| off > 0.1 && off < 6.0), "{report}");
    let (size, points) = cube(at("5207.cube"));
    assert_eq!(size, 65);
    let head = std::fs::read_to_string(at("5207.cube")).expect("there");
    for word in ["TITLE \"Kodak Vision3 250D 5207", "Left out", "AllocationTransform", "log2(x / 0.18) / 14"] {
        assert!(head.contains(word), "{word}");
    }
    // Red varies fastest, and more red in the input makes more red in the output.
    let point = |r: usize, g: usize, b: usize| points[(b * size + g) * size + r];
    assert!(point(48, 16, 16)[0] > point(16, 16, 16)[0] + 0.2 && point(16, 16, 48)[2] > point(16, 16, 16)[2] + 0.2);

    // Mid gray is the center of the table and equals a developed gray card.
    put(at("gray.png"), 24, 16, |_, _| [118; 3]);
    let off = ["--grain", "off", "--halation", "off", "-o", "gray-5207.png"];
    good(folder.path(), &[&["gray.png", "--stock", "5207"][..], &off].concat());
    let card = read(at("gray-5207.png")).get_pixel(12, 8).0.map(f64::from);
    let middle = point(32, 32, 32).map(|v| 255.0 * v);
    println!("a gray card: {card:?} developed, {middle:.1?} in the table");
    // 118 of 255 is 0.1812; the rest of the tolerance is one step of the file.
    assert!(card.iter().zip(middle).all(|(a, b)| (a - b).abs() < 2.0), "{card:?} {middle:?}");

    // A coarser table deviates more.
    let output = made(&["5207", "--size", "9", "-o", "coarse.cube", "--json"]);
    let coarse: serde_json::Value = serde_json::from_slice(&output.stdout).expect("JSON");
    assert!(coarse["random_colors"]["mean_ciede2000"].as_f64().is_some_and(|off| off > 2.0 * mean), "{coarse}");
    for (arguments, word) in [
        (&["tri-x", "--grade", "auto"][..], "a grade from 0 to 5"),
        (&["tri-x", "-o", "a.lut"], ".cube"),
        (&["tri-x", "--stops", "1"], "from 2 to 40"),
        (&["tri-x", "--illuminant", "D66"], "--illuminant D66"),
        (&["tri-y"], "no film stock is called `tri-y`"),
    ] {
        let output = made(arguments);
        let said = text(&output.stderr);
        assert_eq!(output.status.code(), Some(2), "{arguments:?}: {said}");
        assert!(said.contains(word), "{arguments:?} lacks `{word}`: {said}");
    }
}

/// An exposure that leaves the film black or white everywhere still makes a picture. A warning points to the setting and suggests an
/// exposure that causes no warning.
#[test]
fn an_exposure_beyond_the_film_is_told_of() {
    let folder = tempfile::tempdir().expect("a folder");
    let folder = folder.path();
    put(folder.join("a.png"), 60, 40, colors);
    for (time, wanted) in [("80 s", "saturated"), ("1/1000000 s", "unexposed")] {
        let exposure = format!("film.exposure={time}");
        let said = good(folder, &["a.png", "--stock", "tri-x", "--set", &exposure]);
        assert!(said.contains(&format!("warning: --set {exposure}: nearly the whole film is {wanted}")), "{said}");
        assert_eq!(said.matches("warning").count(), 1, "{said}");
        let better = said.split("`exposure: ").nth(1).and_then(|rest| rest.split('`').next()).expect("a time");
        let said = good(folder, &["a.png", "--stock", "tri-x", "--set", &format!("film.exposure={better}")]);
        assert!(!said.contains("warning"), "{said}");
    }
    // A user who sets both an exposure and metering learns that one of them has no effect.
    let both = ["a.png", "--stock", "tri-x", "--set", "film.exposure=80 s", "--set", "film.metering=average"];
    assert!(good(folder, &both).contains("has no effect"));
}

/// A setting that has no effect without a lens is refused, and so is a time instead of stops; the message says what to write.
#[test]
fn what_does_nothing_is_refused() {
    let folder = tempfile::tempdir().expect("a folder");
    let folder = folder.path();
    put(folder.join("a.png"), 60, 40, colors);
    for set in ["lens.f-number=2", "lens.focus=2 m"] {
        let said = refused(folder, &["a.png", "--stock", "tri-x", "--set", set], 2);
        assert!(said.contains("without a lens `lens.f") && said.contains(&format!("--set {set}")), "{said}");
    }
    // Filters work without a lens.
    good(folder, &["a.png", "--stock", "tri-x", "--set", "lens.filters=[wratten-12]"]);
    for (time, in_seconds) in [("1/60", "1/60 s"), ("1/60 s", "1/60 s"), ("2s", "2 s")] {
        let said = refused(folder, &["a.png", "--stock", "tri-x", "--exposure", time], 2);
        assert!(said.contains("takes stops"), "{said}");
        assert!(said.contains(&format!("--set film.exposure=\"{in_seconds}\"")), "{said}");
    }
    let written = ["a.png", "--stock", "tri-x", "--set", "film.exposure=1/60 s"];
    assert!(good(folder, &written).contains("Kodak Tri-X 400 at 1/60 s"));
}

/// The frame number comes before the version in a file name: it names the output, and each frame has its own grain.
#[test]
fn a_version_is_no_number() {
    let folder = tempfile::tempdir().expect("a folder");
    let folder = folder.path();
    for name in ["plate.0007.v2.png", "plate.0008.v2.png"] {
        put(folder.join(name), 60, 40, colors);
        good(folder, &[name, "--stock", "tri-x", "-o", "out/film.####.v2.png"]);
    }
    let frames = ["out/film.0007.v2.png", "out/film.0008.v2.png"].map(|name| read(folder.join(name)));
    assert!(frames[0] != frames[1], "both frames have the same grain");
    // A version is the frame number if the name has no other number.
    put(folder.join("v3.png"), 60, 40, colors);
    good(folder, &["v3.png", "--stock", "tri-x", "-o", "out/only.##.png"]);
    assert!(folder.join("out/only.03.png").exists());
}
