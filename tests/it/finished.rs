//! Tests files of the finished picture for compositing and grading: OpenEXR, PNG and TIFF that state their colors.

use crate::common::{good, run, shown, text};
use exr::prelude::{AnyChannels, FlatSamples, Image, Layer, ReadChannels, ReadLayers};
use spectra_color::{RgbSpace, Transfer, xyz_of_light, xyz_of_reflectance};
use spectra_core::frame::{ExposureChannel, ExposureFrame, ExtraRequest, FrameSize, ImageState};
use spectra_pictures::write::{LinearSpace, picture_exr};
use spectra_plugins as _;
use spectra_spectrum::{Observer, find_emission, find_reflectance};
use std::io::Cursor;
use std::path::Path;
use std::process::Command;

/// ACEScg values of the ColorChecker (ISO 17321-1) under D55, with the perfect white at 1 and white adapted by CAT02. From
/// colour-science 0.4.7, `XYZ_to_RGB(sd_to_XYZ(SDS_COLOURCHECKERS["ISO 17321-1"][...], illuminant=SDS_ILLUMINANTS["D55"]), "ACEScg",
/// illuminant=<xy of D55>, chromatic_adaptation_transform="CAT02")`.
const ACES_CG: [(&str, [f64; 3]); 24] = [
    ("dark-skin", [0.13920, 0.08510, 0.05599]),
    ("light-skin", [0.46563, 0.32490, 0.24095]),
    ("blue-sky", [0.15085, 0.19511, 0.31557]),
    ("foliage", [0.10984, 0.14272, 0.06210]),
    ("blue-flower", [0.24363, 0.22983, 0.41434]),
    ("bluish-green", [0.27167, 0.48415, 0.41326]),
    ("orange", [0.50745, 0.23534, 0.05676]),
    ("purplish-blue", [0.09474, 0.10782, 0.33973]),
    ("moderate-red", [0.39043, 0.12529, 0.12753]),
    ("purple", [0.08942, 0.05112, 0.13287]),
    ("yellow-green", [0.38366, 0.48296, 0.10622]),
    ("orange-yellow", [0.61708, 0.39337, 0.08080]),
    ("blue", [0.04664, 0.05088, 0.27415]),
    ("green", [0.13905, 0.28279, 0.08893]),
    ("red", [0.29786, 0.05840, 0.04919]),
    ("yellow", [0.72503, 0.59107, 0.09319]),
    ("magenta", [0.36588, 0.12292, 0.27632]),
    ("cyan", [0.07985, 0.22725, 0.36451]),
    ("white", [0.88725, 0.88797, 0.87758]),
    ("neutral-8", [0.58513, 0.58350, 0.58267]),
    ("neutral-6.5", [0.35814, 0.35815, 0.35875]),
    ("neutral-5", [0.20306, 0.20302, 0.20350]),
    ("neutral-3.5", [0.09176, 0.09278, 0.09402]),
    ("black", [0.03310, 0.03360, 0.03501]),
];

/// Reads an EXR file from memory.
fn read(bytes: &[u8]) -> Image<Layer<AnyChannels<FlatSamples>>> {
    let read = exr::prelude::read().no_deep_data().largest_resolution_level().all_channels();
    read.first_valid_layer().all_attributes().from_buffered(Cursor::new(bytes)).expect("an EXR")
}

fn plane(image: &Image<Layer<AnyChannels<FlatSamples>>>, name: &str) -> Vec<f32> {
    let list = &image.layer_data.channel_data.list;
    let channel = list.iter().find(|c| c.name.to_string() == name).unwrap_or_else(|| panic!("no channel {name}"));
    channel.sample_data.values_as_f32().collect()
}

fn said(image: &Image<Layer<AnyChannels<FlatSamples>>>, name: &str) -> String {
    let value = image.layer_data.attributes.other.get(&exr::prelude::Text::from(name));
    match value.unwrap_or_else(|| panic!("no attribute {name}")) {
        exr::meta::attribute::AttributeValue::Text(text) => text.to_string(),
        other => panic!("{name} is {other:?}"),
    }
}

/// The patches under D55, as an imager records them, are written with the values of colour-science.
#[test]
fn a_color_chart_in_aces_cg() {
    let light = find_emission("D55").expect("bundled");
    let observer = Observer::cie_1931_2deg();
    let white = xyz_of_light(&light, observer).expect("light");
    let patches = ACES_CG.map(|(name, _)| {
        let patch = find_reflectance(&format!("colorchecker#{name}")).unwrap_or_else(|e| panic!("{name}: {e}"));
        xyz_of_reflectance(&patch, &light, observer).expect("light").map(|v| v / white[1])
    });
    let size = FrameSize { width_px: 24, height_px: 1, width_mm: 24.0, height_mm: 1.0 };
    // White has 40 lx.
    let channel = |(k, name): (usize, &str)| ExposureChannel {
        name: name.into(),
        unit: "lx".into(),
        values: patches.iter().map(|xyz| (xyz[k] * 40.0) as f32).collect(),
    };
    let channels = ["X", "Y", "Z"].into_iter().enumerate().map(channel).collect();
    let scene = "{kind: xyz, width: 24 mm, height: 1 mm, resolution: [24, 1], white: 40 lx, white-balance: D55}";
    let imager = spectra_testing::imager(scene);
    let response = imager.response().expect("it records by itself");
    let frame = ExposureFrame { size, channels };
    let finished = response.finish(&frame, ExtraRequest { unclamped: true, layers: false }).expect("a picture");
    assert_eq!((response.image_state(), finished.extra.white.as_deref()), (ImageState::SceneReferred, Some("40 lx")));
    let open = finished.extra.unclamped.expect("asked for");
    for half in [false, true] {
        let mut file = Cursor::new(Vec::new());
        let colors = (LinearSpace::AcesCg, ImageState::SceneReferred);
        picture_exr(&mut file, &open, &[], colors, half, 1.0, &[]).expect("written");
        let image = read(file.get_ref());
        let rgb = ["R", "G", "B"].map(|name| plane(&image, name));
        for (i, (name, wanted)) in ACES_CG.iter().enumerate() {
            for (plane, want) in rgb.iter().zip(wanted) {
                let found = f64::from(plane[i]);
                assert!((found - want).abs() < 1e-3, "{name}: {found}, not {want}");
            }
        }
        let own = image.attributes.chromaticities.expect("chromaticities");
        assert_eq!([own.red.0, own.green.1, own.blue.0, own.white.0], [0.713, 0.83, 0.128, 0.32168]);
        assert_eq!(said(&image, "oiio:ColorSpace"), "ACEScg");
        assert_eq!(said(&image, "colorInteropID"), "lin_ap1_scene");
        assert_eq!(said(&image, "spectra:image state"), "scene-referred");
    }
}

/// Every color space holds the same light: converted to XYZ with the primaries in the file's own header.
#[test]
fn every_space_holds_the_same_light() {
    let rgb = vec![[0.9_f32, 0.2, 0.05], [0.0, 1.0, 0.0], [-0.1, 0.4, 3.0], [1.0, 1.0, 1.0]];
    let picture = spectra_core::frame::DisplayPicture { width_px: 4, height_px: 1, rgb: rgb.clone() };
    for space in [LinearSpace::Srgb, LinearSpace::Rec2020, LinearSpace::P3D65, LinearSpace::Xyz] {
        let mut file = Cursor::new(Vec::new());
        picture_exr(&mut file, &picture, &[], (space, ImageState::DisplayReferred), false, 1.9, &[]).expect("written");
        let image = read(file.get_ref());
        assert_eq!(image.attributes.pixel_aspect, 1.9);
        let own = image.attributes.chromaticities.expect("chromaticities");
        let xy = [own.red, own.green, own.blue].map(|v| [f64::from(v.0), f64::from(v.1)]);
        // X, Y and Z need no matrix.
        let space = (space != LinearSpace::Xyz)
            .then(|| RgbSpace::new("own", xy, [own.white.0, own.white.1].map(f64::from), Transfer::Linear));
        let planes = ["R", "G", "B"].map(|name| plane(&image, name));
        for (i, rgb) in rgb.iter().enumerate() {
            let value = [0, 1, 2].map(|k| f64::from(planes[k][i]));
            let xyz = space.as_ref().map_or(value, |space| space.to_xyz(value));
            let want = RgbSpace::srgb().to_xyz(rgb.map(f64::from));
            assert!((0..3).all(|k| (xyz[k] - want[k]).abs() < 1e-5), "{xyz:?} {want:?}");
        }
    }
}

/// Renders a scene in the given folder.
fn rendered(folder: &Path, scene: &str) {
    std::fs::write(folder.join("s.yaml"), scene).expect("a folder");
    good(&["run", shown(&folder.join("s.yaml")), "-o", shown(folder)]);
}

const CHART: &str = "
spectra: 1
source: {kind: chart, chart: color-checker, distance: 1 m, width: fill, illuminant: D55, luminance: 300 cd/m2}
lens: {file: zeiss-biotar-50-f1.4, f-number: f/4, focus: 1 m}
imager: {kind: film, format: 135, resolution: [48, 32]}
render: {samples: 4, seed: 1}
";

/// Returns the chunks of a PNG with their names, up to the pixels.
fn chunks(bytes: &[u8]) -> Vec<(String, Vec<u8>)> {
    let mut all = Vec::new();
    let mut at = 8;
    while at + 12 <= bytes.len() {
        let length = u32::from_be_bytes([bytes[at], bytes[at + 1], bytes[at + 2], bytes[at + 3]]) as usize;
        let name = String::from_utf8(bytes[at + 4..at + 8].to_vec()).expect("letters");
        if name == "IDAT" {
            break;
        }
        all.push((name, bytes[at + 8..at + 8 + length].to_vec()));
        at += 12 + length;
    }
    all
}

#[test]
fn a_print_in_every_file() {
    let folder = tempfile::tempdir().expect("a folder");
    let film = "film: {stock: kodak-vision3-250d-5207, metering: average, surround: dark}\n";
    let output = "output: [exr, {kind: exr, holds: picture, layers: [exposures, densities]}, \
                  {kind: png, bits: 16, space: display-p3}, {kind: tiff, space: acescct}]\n";
    rendered(folder.path(), &format!("{CHART}{film}{output}"));
    let file = |name: &str| std::fs::read(folder.path().join(name)).unwrap_or_else(|e| panic!("{name}: {e}"));
    let image = read(&file("s-picture.exr"));
    let names: Vec<String> = image.layer_data.channel_data.list.iter().map(|c| c.name.to_string()).collect();
    let wanted = [
        "B",
        "G",
        "R",
        "density.blue",
        "density.green",
        "density.red",
        "exposure.blue",
        "exposure.green",
        "exposure.red",
        "print.blue",
        "print.green",
        "print.red",
    ];
    assert_eq!(names, wanted);
    assert_eq!(said(&image, "spectra:image state"), "display-referred");
    assert_eq!(said(&image, "unit exposure.red"), "lx s");
    // A metered gray gets 10 / 250 lx s; the densities of a negative rise from a base above zero.
    let exposure = plane(&image, "exposure.green");
    let mean = exposure.iter().map(|v| f64::from(*v)).sum::<f64>() / exposure.len() as f64;
    assert!((mean / 0.04 - 1.0).abs() < 0.1, "{mean}");
    let density = plane(&image, "density.green");
    let at = |extreme: &dyn Fn(f32, f32) -> bool| {
        (0..exposure.len()).reduce(|a, b| if extreme(exposure[b], exposure[a]) { b } else { a }).expect("pixels")
    };
    let (dark, light) = (at(&|a, b| a < b), at(&|a, b| a > b));
    assert!(density[dark] > 0.4 && density[light] > density[dark] + 0.4, "{} {}", density[dark], density[light]);
    // A print is denser where its negative is thinner. A metered gray has Kodak's aim densities for 2383 in a dark room, 1.09, 1.06
    // and 1.03, within 0.05, and the chart's patch of 0.18 is close to that gray.
    let printed = plane(&image, "print.green");
    assert!(printed[dark] > printed[light] + 1.0, "{} {}", printed[dark], printed[light]);
    let gray = at(&|a, b| (a - 0.04).abs() < (b - 0.04).abs());
    let printed = ["red", "green", "blue"].map(|layer| plane(&image, &format!("print.{layer}"))[gray]);
    println!("a metered gray prints at {printed:?}");
    assert!((printed[1] - 1.06).abs() < 0.15, "{printed:?}");
    // The same picture in another encoding.
    let png = file("s.png");
    let found = chunks(&png);
    let names: Vec<&str> = found.iter().map(|(name, _)| name.as_str()).collect();
    assert_eq!(names, ["IHDR", "cICP", "iCCP"]);
    assert_eq!(found[1].1, [12, 13, 0, 1]);
    let codes = image::load_from_memory(&png).expect("a PNG").into_rgb16();
    let planes = ["R", "G", "B"].map(|name| plane(&image, name));
    let to_p3 = LinearSpace::P3D65.from_srgb();
    let mut compared = 0;
    for (i, pixel) in codes.pixels().enumerate() {
        let rgb = spectra_color::matrix::apply(&to_p3, [0, 1, 2].map(|k| f64::from(planes[k][i])));
        if rgb.iter().all(|v| (0.0..=1.0).contains(v)) {
            compared += 1;
            let light = pixel.0.map(|code| Transfer::Srgb.decode(f64::from(code) / 65_535.0));
            assert!((0..3).all(|k| (light[k] - rgb[k]).abs() < 2e-4), "{light:?} {rgb:?}");
        }
    }
    // The border of the chart is blacker than the black of the print and is left out.
    assert!(compared > 200, "{compared}");
    // ACEScct encodes the white of the print, 1, as 0.5548.
    let codes = image::load_from_memory(&file("s.tiff")).expect("a TIFF").into_rgb16();
    let most = codes.pixels().flat_map(|p| p.0).max().expect("pixels");
    assert!((0.5..0.57).contains(&(f64::from(most) / 65_535.0)), "{most}");
    // A single file with a given name.
    let one = folder.path().join("one.exr");
    good(&[
        "run",
        shown(&folder.path().join("s.yaml")),
        "-o",
        shown(&one),
        "--set",
        "output=[{kind: exr, holds: picture}]",
    ]);
    assert!(read(&std::fs::read(&one).expect("one file")).layer_data.channel_data.list.len() == 3);
    opens_in_openimageio(&one);
}

/// Checks the file with OpenImageIO if its tools are installed.
fn opens_in_openimageio(file: &Path) {
    let Ok(found) = Command::new("iinfo").arg("-v").arg(file).output() else {
        eprintln!("skipped: `iinfo` of OpenImageIO is not installed");
        return;
    };
    let told = text(&found.stdout);
    assert!(found.status.success() && told.contains("channel list: R, G, B"), "{told}");
    assert!(told.contains("chromaticities: 0.64, 0.33, 0.3, 0.6, 0.15, 0.06, 0.3127, 0.329"), "{told}");
}

/// A PNG in sRGB states its color space for new and old programs; a picture that is not color states none.
#[test]
fn pictures_say_their_colors_and_densities_none() {
    let folder = tempfile::tempdir().expect("a folder");
    let film =
        |scan: &str| format!("film: {{stock: kodak-vision3-250d-5207, metering: average, view: scan, scan: {scan}}}\n");
    let output = "output: [{kind: exr, holds: picture, layers: [densities]}, {kind: png, bits: 16}]\n";
    for (scan, wanted) in [("picture", &["IHDR", "cICP", "sRGB", "gAMA", "cHRM"][..]), ("adx", &["IHDR"])] {
        rendered(folder.path(), &format!("{CHART}{}{output}", film(scan)));
        let png = std::fs::read(folder.path().join("s.png")).expect("a PNG");
        let found = chunks(&png);
        assert_eq!(found.iter().map(|(name, _)| name.as_str()).collect::<Vec<_>>(), wanted);
        let image = read(&std::fs::read(folder.path().join("s-picture.exr")).expect("an EXR"));
        let is_data = scan == "adx";
        assert_eq!(said(&image, "spectra:image state"), if is_data { "data" } else { "display-referred" });
        assert_eq!(image.attributes.chromaticities.is_none(), is_data);
        if is_data {
            // ADX16 has 1520 at unexposed film and 8000 per unit of density. The lens of the scanner blurs the density of the layer,
            // which is sharp.
            let (value, density) = (plane(&image, "R"), plane(&image, "density.red"));
            let mean = |values: &[f32]| values.iter().map(|v| f64::from(*v)).sum::<f64>() / values.len() as f64;
            let clear = mean(&density) - (mean(&value) * 65_535.0 - 1520.0) / 8000.0;
            assert!((0.05..0.5).contains(&clear), "{clear}");
            let code = image::load_from_memory(&png).expect("a PNG").into_rgb16();
            for (i, pixel) in code.pixels().enumerate() {
                assert!((f64::from(pixel.0[0]) / 65_535.0 - f64::from(value[i])).abs() < 1e-4, "{i}");
            }
        }
    }
}

/// The color management of another program reads the profile and converts a color as the tables say.
#[test]
fn littlecms_reads_the_profiles() {
    let folder = tempfile::tempdir().expect("a folder");
    let script = r#"
import sys
try:
    from PIL import Image, ImageCms
except ImportError:
    sys.exit(77)
own = ImageCms.getOpenProfile(sys.argv[1])
there = ImageCms.createProfile("sRGB")
transform = ImageCms.buildTransform(own, there, "RGB", "RGB", renderingIntent=1)
image = Image.new("RGB", (3, 1))
image.putdata([(128, 128, 128), (200, 150, 100), (90, 120, 160)])
print(ImageCms.getProfileDescription(own).strip())
print(list(ImageCms.applyTransform(image, transform).getdata()))
"#;
    for (space, name) in
        [(RgbSpace::srgb(), "sRGB"), (RgbSpace::display_p3(), "Display P3"), (RgbSpace::rec2020(), "wide")]
    {
        let file = folder.path().join("p.icc");
        std::fs::write(&file, spectra_pictures::write::display_profile(space, name, Transfer::Srgb)).expect("written");
        let found = Command::new("python3").args(["-c", script, shown(&file)]).output();
        let Some(found) = found.ok().filter(|found| found.status.code() != Some(77)) else {
            eprintln!("skipped: python3 with Pillow and its ImageCms is not installed");
            return;
        };
        let told = text(&found.stdout);
        let mut lines = told.lines();
        assert_eq!(lines.next(), Some(name), "{}", text(&found.stderr));
        let codes: Vec<f64> =
            lines.next().expect("codes").split(|c: char| !c.is_ascii_digit()).filter_map(|v| v.parse().ok()).collect();
        let wanted = [[128.0; 3], [200.0, 150.0, 100.0], [90.0, 120.0, 160.0]].map(|code: [f64; 3]| {
            let linear = code.map(|v| Transfer::Srgb.decode(v / 255.0));
            RgbSpace::srgb().from_xyz(space.to_xyz(linear)).map(|v| Transfer::Srgb.encode(v) * 255.0)
        });
        for (code, want) in codes.iter().zip(wanted.as_flattened()) {
            assert!((code - want.clamp(0.0, 255.0)).abs() < 1.1, "{name}: {codes:?} {wanted:?}");
        }
    }
}

/// White balance makes a gray card under tungsten light gray, given the lamp's name, its color temperature or the frame itself; the
/// exposure channels do not change.
#[test]
fn white_balance_makes_gray_gray() {
    let light = find_emission("A").expect("bundled");
    let white = xyz_of_light(&light, Observer::cie_1931_2deg()).expect("light");
    let size = FrameSize { width_px: 8, height_px: 1, width_mm: 8.0, height_mm: 1.0 };
    let channel = |(k, name): (usize, &str)| ExposureChannel {
        name: name.into(),
        unit: "lx".into(),
        values: (1..=8).map(|i| (white[k] / white[1] * f64::from(i)) as f32).collect(),
    };
    let frame = ExposureFrame { size, channels: ["X", "Y", "Z"].into_iter().enumerate().map(channel).collect() };
    let shown = |balance: &str| {
        let imager = format!("{{kind: xyz, width: 8 mm, height: 1 mm, resolution: [8, 1], white: 10 lx{balance}}}");
        spectra_testing::imager(&imager).response().expect("by itself").display(&frame).expect("a picture").rgb
    };
    let spread = |rgb: &[f32; 3]| (rgb[0] - rgb[2]) / rgb[1];
    assert!(shown("").iter().all(|rgb| spread(rgb) > 0.5), "{:?}", shown(""));
    for (balance, most) in
        [("A", 1e-5), ("auto-gray", 1e-5), ("\"blackbody:2856\"", 2e-3), ("{temperature: 2856 K}", 2e-3)]
    {
        let rgb = shown(&format!(", white-balance: {balance}"));
        for (i, rgb) in rgb.iter().enumerate() {
            assert!(spread(rgb).abs() < most && (rgb[1] - (i + 1) as f32 / 10.0).abs() < 2e-3, "{balance}: {rgb:?}");
        }
    }
}

/// Each mistake causes a message that says what to write.
#[test]
fn slips_are_said() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("s.yaml");
    for (scene, output, wanted) in [
        ("film: {stock: kodak-tri-x-400, metering: average}", "{kind: exr, space: acescg}", "holds: picture"),
        ("film: {stock: kodak-tri-x-400, metering: average}", "{kind: png, bits: 12}", "`bits: 16`"),
        ("film: {stock: kodak-tri-x-400, metering: average}", "{kind: png, space: acescct}", "bits: 16"),
        (
            "film: {stock: kodak-tri-x-400, metering: average, view: scan, scan: log}",
            "{kind: tiff, space: display-p3}",
            "scan: picture",
        ),
        (
            "imager: {kind: xyz, format: 135, resolution: [48, 32]}",
            "{kind: exr, holds: picture, layers: [densities]}",
            "layers: [exposures]",
        ),
        ("imager: {kind: xyz, format: 135, resolution: [48, 32], white-balance: D5}", "png", "D50"),
    ] {
        let chart = if scene.starts_with("imager") {
            CHART.replace("imager: {kind: film, format: 135, resolution: [48, 32]}", "")
        } else {
            CHART.to_owned()
        };
        std::fs::write(&path, format!("{chart}{scene}\noutput: [{output}]\n")).expect("a folder");
        let told = run(&["check", shown(&path)]);
        let told = format!("{}{}", text(&told.stdout), text(&told.stderr));
        assert!(told.contains(wanted), "{scene} {output}: {told}");
    }
}
