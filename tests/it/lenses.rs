//! Tests the lens library: every lens of `lenses/` agrees with its patent, can be drawn and renders.

use crate::common::{good, run, shown, text};
use spectra_lens::{Lens, Section};
use spectra_optics::Optics;
use spectra_plugins as _;
use spectra_render::{Control, RenderOptions, Renderer, Threads};
use spectra_scene::FileResources;
use std::path::Path;

fn load(name: &str) -> Lens {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    spectra_lens::load(name, &FileResources::beside(&root.join("tests"))).unwrap_or_else(|faults| panic!("{faults}"))
}

/// Returns the bundled lenses that take pictures, which are those with a stop; prisms and the like have none.
fn library() -> Vec<(String, Lens)> {
    let names = spectra_data::list("lenses/")
        .filter_map(|path| path.strip_prefix("lenses/").and_then(|name| name.strip_suffix(".yaml")).map(str::to_owned));
    // Lenses in subfolders are studies of surfaces.
    let names = names.filter(|name| !name.contains('/'));
    names.map(|name| (name.clone(), load(&name))).filter(|(_, lens)| lens.stop().is_some()).collect()
}

/// Effective and back focal length at the stated nd, mm, computed twice independently of this program, after the scale of the
/// library.
const FIRST_ORDER: [(&str, f64, f64, f64); 12] = [
    ("zeiss-biotar-50-f1.4", 1.0, 49.7840216, 32.4742387),
    ("nikkor-100-f1.4", 1.0, 99.7587028, 73.8850697),
    ("angenieux-100-f1.1", 1.0, 99.9397423, 55.9770988),
    ("meyer-primoplan-100-f1.5", 1.0, 100.1594988, 52.0203810),
    ("helios-44-58-f2", 1.0, 58.5994243, 38.0786709),
    ("canon-fd-50-f1.8", 1.0, 48.9143984, 32.8584359),
    ("asahi-takumar-100-f1.2", 1.0, 100.0053067, 63.4361147),
    ("nikon-retrofocus-100-f2.8", 1.0, 99.8308935, 130.9214531),
    ("zeiss-hologon-15-f8", 1.0, 15.0015340, 4.5454768),
    ("kodak-petzval-100-f2.2", 1.0, 99.9837619, 56.4526508),
    ("cooke-triplet-50-f5", 1.0, 50.0215525, 42.4366489),
    ("minolta-fisheye-16-f2.7", 16.0, 1.0001638, 2.3245931),
];

#[test]
fn first_order_is_that_of_the_prescriptions() {
    for (name, scale, efl_mm, bfl_mm) in FIRST_ORDER {
        let found = load(name).first_order_at_stated_nd();
        // One unit of the last digit, times the scale.
        let tolerance = scale * 1.5e-7;
        assert!((found.efl_mm - scale * efl_mm).abs() < tolerance, "{name}: {}", found.efl_mm);
        assert!((found.bfl_mm - scale * bfl_mm).abs() < tolerance, "{name}: {}", found.bfl_mm);
    }
}

/// Values that the patents state: focal length (mm, with the tolerance of its digits in per cent) and f-number; then the largest
/// distance, mm, of the image plane from the paraxial focus. `None`: the stop has no stated size, or no f-number is stated.
const STATED: [(&str, f64, f64, Option<f64>, f64); 17] = [
    ("zeiss-biotar-50-f1.4", 50.0, 0.5, None, 0.2),
    ("zeiss-biotar-100-f1.4", 100.0, 0.5, Some(1.4), 0.2),
    ("nikkor-100-f1.4", 100.0, 0.5, Some(1.4), 0.2),
    ("angenieux-100-f1.1", 100.0, 0.5, Some(1.11), 0.3),
    ("meyer-primoplan-100-f1.5", 100.0, 0.5, Some(1.5), 0.2),
    // No patent; the name on the lens barrel.
    ("helios-44-58-f2", 58.0, 1.5, None, 0.1),
    ("canon-fd-50-f1.8", 50.0, 2.5, None, 0.2),
    ("canon-35-f1.8", 35.0, 0.5, Some(1.84), 0.2),
    ("asahi-takumar-100-f1.2", 100.0, 0.5, Some(1.24), 0.2),
    ("nikon-retrofocus-100-f2.8", 100.0, 0.5, Some(2.75), 1.0),
    ("canon-ef-70-200-f2.8-at-72", 72.0, 0.5, Some(2.923), 0.2),
    ("kodak-petzval-100-f2.2", 100.0, 0.5, Some(2.2), 0.1),
    ("zeiss-hologon-15-f8", 15.0, 0.5, Some(8.0), 0.3),
    ("cooke-triplet-50-f5", 50.0, 0.5, Some(5.0), 0.3),
    ("tessar-50-f4.5", 50.0, 0.5, Some(4.5), 0.3),
    ("double-gauss-100-f5", 100.0, 0.5, Some(5.0), 0.01),
    ("minolta-fisheye-16-f2.7", 16.0, 0.5, Some(2.66), 0.1),
];

#[test]
fn focal_lengths_and_f_numbers_are_the_stated_ones() {
    for (name, focal_mm, percent, f_number, gap_mm) in STATED {
        let lens = load(name);
        let first_order = lens.first_order_at_stated_nd();
        let off = 100.0 * (first_order.efl_mm / focal_mm - 1.0);
        assert!(off.abs() <= percent, "{name}: {} mm, {off:.2} %", first_order.efl_mm);
        let gap = lens.image_gap_mm() - first_order.bfl_mm;
        assert!(gap.abs() <= gap_mm, "{name}: the image plane is {gap:.3} mm behind the focus");
        // The catalog glasses change the focal length by less than their index tolerance implies.
        let own = lens.first_order(lens.reference_nm);
        assert!((own.efl_mm / first_order.efl_mm - 1.0).abs() < 2e-3, "{name}: {} mm by its glasses", own.efl_mm);
        assert!(lens.warnings.is_empty(), "{name}: {:?}", lens.warnings);
        let Some(f_number) = f_number else { continue };
        let found = Optics::new(lens.clone()).marginal_ray().unwrap_or_else(|e| panic!("{name}: {e}")).f_number();
        println!("{name}: EFL {:.3} mm, f/{found:.3}, stated f/{f_number}", first_order.efl_mm);
        // The Hologon is stopped by its middle planes, whose size has one digit: f/7.4.
        assert!((found / f_number - 1.0).abs() < 0.07, "{name}: f/{found:.3}, stated f/{f_number}");
    }
}

/// Every lens states its source, and every surface its size, except stops without a published size.
#[test]
fn every_lens_is_documented() {
    let library = library();
    assert!(library.len() >= 18, "{}", library.len());
    let unsized_stops = ["zeiss-biotar-50-f1.4", "helios-44-58-f2", "canon-fd-50-f1.8", "zeiss-hologon-15-f8"];
    for (name, lens) in library {
        assert!(lens.source.is_some() && lens.remark.is_some() && lens.rims.is_some(), "{name}");
        let dated = lens.year.is_some() && lens.maker.is_some();
        let textbook = lens.source.as_deref().is_some_and(|s| s.contains("textbook") || s.contains("Lens Design"));
        assert!(dated || textbook, "{name}");
        for (i, element) in lens.elements.iter().enumerate() {
            let known = element.semi_diameter_mm.is_some();
            let excused = element.stop && unsized_stops.contains(&name.as_str());
            assert!(known || excused, "{name}: surface {} has no size", i + 1);
        }
        assert!(
            STATED.iter().any(|row| row.0 == name) || name.contains("anamorphic"),
            "{name} is compared with nothing"
        );
    }
}

/// Lenses whose glasses look misread, the figure in the warning, and the reason why the figures are kept.
const DOUBTED: [(&str, &str, &str); 4] = [
    ("zeiss-hologon-15-f8", "0.40 % of the focal length", "0.06 mm, small compared with the depth of focus at f/8"),
    (
        "canon-fd-50-f1.8",
        "0.56 % of the focal length",
        "very likely misread, and the patent was not seen, as the remark says",
    ),
    ("nikon-retrofocus-100-f2.8", "0.47 % of the focal length", "as the patent prints it"),
    (
        "minolta-fisheye-16-f2.7",
        "1.03 % of the focal length",
        "0.17 mm, like a normal lens of 1927: large only relative to its short focal length",
    ),
];

/// No lens of the library has a glass that looks misread, except the listed ones, for which `lens info` warns.
#[test]
fn glasses_are_plausible() {
    for (name, lens) in library() {
        let doubts = lens.glass_warnings();
        match DOUBTED.iter().find(|(doubted, ..)| *doubted == name) {
            None => assert!(doubts.is_empty(), "{name}: {doubts:?}"),
            Some((_, wanted, reason)) => {
                assert!(doubts.len() == 1 && doubts[0].contains(wanted), "{name}, {reason}: {doubts:?}");
            }
        }
    }
    let said = good(&["lens", "info", "canon-fd-50-f1.8"]);
    assert!(said.contains("warning: the foci of F and C lie 0.272 mm apart, 0.56 % of the focal length"), "{said}");
    assert!(said.contains("A glass is very likely misread"), "{said}");
}

/// The retrofocus lens in its original transcription has a misread glass: the Abbe number 46.2 was read as the 27.5 of the line
/// below. Imported lenses are checked as well. A singlet, and glasses of one index that all exist, cause no warning.
#[test]
fn misread_glasses_are_doubted() {
    let transcribed = load("data/lenses/nikon-retrofocus-100-f2.8.yaml").glass_warnings();
    assert_eq!(transcribed.len(), 2, "{transcribed:?}");
    assert!(transcribed[0].contains("0.83 % of the focal length"), "{transcribed:?}");
    let twins = "the media behind surfaces 5 and 7 have the same index, 1.76684, but Abbe numbers of 46.2 and 27.5, and no glass of the \
                 catalogue is near that of 46.2, nor near that of 27.5";
    assert!(transcribed[1].contains(twins), "{transcribed:?}");
    let folder = tempfile::tempdir().expect("a folder");
    let at = |name: &str| folder.path().join(name);
    let zmx = |first: &str, second: &str| {
        let path = at("lens.zmx");
        let records = format!(
            "UNIT MM\nSURF 0\n  DISZ INFINITY\nSURF 1\n  STOP\n  CURV 0.02\n  DISZ 5\n  GLAS ___BLANK 1 0 {first}\n  DIAM 10 1\n\
             SURF 2\n  CURV -0.02\n  DISZ 1\n  DIAM 10 1\nSURF 3\n  CURV -0.005\n  DISZ 2\n  GLAS ___BLANK 1 0 {second}\n  DIAM 10 1\n\
             SURF 4\n  CURV 0\n  DISZ 60\n  DIAM 10 1\nSURF 5\n  DISZ 0\n"
        );
        std::fs::write(&path, records).expect("written");
        let done = run(&["lens", "import", shown(&path), "-o", shown(&at("lens.yaml")), "--force"]);
        assert_eq!(done.status.code(), Some(0));
        text(&done.stderr)
    };
    let said = zmx("1.76684 46.2", "1.76684 27.5");
    assert!(said.contains("warning: the media behind surfaces 1 and 3 have the same index"), "{said}");
    assert!(said.contains("warning: the foci of F and C lie"), "{said}");
    let written = std::fs::read_to_string(at("lens.yaml")).expect("written");
    assert!(written.contains("\nrims: stated\n"), "{written}");

    let singlet = "name: singlet\nsurfaces:\n  - {radius: 50, thickness: 5, nd: 1.5168, vd: 64.2, semi-diameter: 8, stop: true}\n  \
                   - {radius: -50, thickness: 47, semi-diameter: 8}\n";
    std::fs::write(at("singlet.yaml"), singlet).expect("written");
    assert!(load(shown(&at("singlet.yaml"))).glass_warnings().is_empty());
}

/// Each lens states the origin of its semi-diameters, in the file and in `lens info`.
#[test]
fn rims_have_an_origin() {
    for (name, words) in [
        ("tessar-50-f4.5", "computed from rays that were meant to pass"),
        ("zeiss-biotar-50-f1.4", "guessed"),
        ("meyer-primoplan-100-f1.5", "stated by the source"),
        ("helios-44-58-f2", "fitted to the light of a Helios-44 58 mm f/2 at f/2 and f/2.8"),
        ("canon-ef-70-200-f2.8-at-72", "fitted to the light of a Canon EF 70-200 mm f/2.8L"),
    ] {
        let said = good(&["lens", "info", name]);
        let rims = said.lines().find_map(|line| line.trim().strip_prefix("rims")).unwrap_or_default();
        assert!(rims.trim().starts_with(words), "{name}: {said}");
    }
    let said = good(&["lens", "info", "helios-44-58-f2", "--json"]);
    let json: serde_json::Value = serde_json::from_str(&said).expect("JSON");
    assert!(json["rims"]["fitted"].as_str().is_some_and(|text| text.contains("Lensfun")), "{said}");
}

/// Relative illuminance at 5.4, 10.8, 16.2 and 21.6 mm agrees with Lensfun's measurements (CC BY-SA 3.0) of a Helios-44 at f/2.8 and
/// of an EF 70-200 mm f/2.8L at f/8, interpolated to 72 mm. `xtask/measured_light.py` compares more stops with the original tables.
#[test]
fn measured_lenses_have_their_light() {
    for (name, f_number, measured) in [
        ("helios-44-58-f2", "f/2.8", [0.995, 0.948, 0.801, 0.556]),
        ("canon-ef-70-200-f2.8-at-72", "f/8", [0.996, 0.987, 0.977, 0.965]),
    ] {
        for (height, wanted) in ["5.4 mm", "10.8 mm", "16.2 mm", "21.6 mm"].into_iter().zip(measured) {
            let said = good(&[
                "lens",
                "info",
                name,
                "--f-number",
                f_number,
                "--coating",
                "ideal",
                "--absorption",
                "false",
                "--image-height",
                height,
                "--json",
            ]);
            let json: serde_json::Value = serde_json::from_str(&said).expect("JSON");
            let points = json["chief_ray_exit_angle_deg"].as_array().expect("a list");
            let light = points.last().and_then(|p| p["relative_illuminance"].as_f64()).expect("a number");
            let within = if height == "21.6 mm" { 0.06 } else { 0.03 };
            assert!((light - wanted).abs() < within, "{name} at {f_number}, {height}: {light:.3}, measured {wanted}");
        }
    }
}

/// Afocal cylinders in front of a prime lens shorten the focal length across by the squeeze, and the images of both sections lie in
/// one plane.
#[test]
fn the_anamorphic_squeezes() {
    let lens = load("schneider-anamorphic-60");
    let [x, y] = [Section::X, Section::Y].map(|section| lens.first_order_in(section, lens.reference_nm));
    // From ray-transfer matrices at the stated indices, multiplied independently: 31.4876 and 60.5546 mm; back focus 43.3304 and
    // 43.3545 mm.
    for (found, wanted) in [(x.efl_mm, 31.4876), (y.efl_mm, 60.5546), (x.bfl_mm, 43.3304), (y.bfl_mm, 43.3545)] {
        assert!((found / wanted - 1.0).abs() < 2e-3, "{found} {wanted}");
    }
    assert!((y.efl_mm / x.efl_mm - 1.923).abs() < 0.01 && (x.bfl_mm - y.bfl_mm).abs() < 0.1);
}

#[test]
fn every_lens_draws() {
    let folder = tempfile::tempdir().expect("a folder");
    for (name, _) in library() {
        let file = folder.path().join(format!("{name}.svg"));
        good(&["lens", "draw", &name, "-o", shown(&file)]);
        let svg = std::fs::read_to_string(&file).expect("written");
        assert!(svg.trim_end().ends_with("</svg>") && !svg.contains("NaN"), "{name}");
        assert!(svg.len() > 10_000, "{name}: {} bytes", svg.len());
    }
}

/// Returns the illuminance on the axis behind a lens at f/8, without losses, relative to pi L / (4 N^2).
fn of_the_camera_equation(lens: &str) -> f64 {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let overrides = [
        &format!("lens.file={lens}"),
        // Focus as for a 135 frame, of which this small frame is the middle. Focused for its own size, a lens with spherical
        // aberration would be far behind the focus of the marginal rays that define its f-number.
        "lens.focus={distance: infinity, frequency: 30 lp/mm}",
        "lens.f-number=f/8",
        "lens.coating=ideal",
        "lens.absorption=false",
        "source.distance=5 m",
        "source.width=20 m",
        "imager={kind: xyz, width: 0.9, height: 0.6, resolution: [6, 4]}",
        "render.samples=512",
    ]
    .map(str::to_owned);
    let scene = spectra_scene::load(&root.join("scenes/gray-card.yaml"), &overrides)
        .unwrap_or_else(|faults| panic!("{lens}: {faults}"));
    let n = scene.lens.marginal_ray().unwrap_or_else(|e| panic!("{lens}: {e}")).f_number();
    assert!((n - 8.0).abs() < 1e-6, "{lens}: f/{n}");
    let renderer = Renderer::new(scene.clone(), &RenderOptions::default()).expect("the scene can be rendered");
    let frame = renderer.run(&Threads(2), &Control::new()).expect("rendered").exposure;
    let y = &frame.channel("Y").expect("XYZ").values;
    let mean = y.iter().map(|v| f64::from(*v)).sum::<f64>() / y.len() as f64;
    // The card has 18 % and its white 300 cd/m2.
    let part = mean / (std::f64::consts::PI * 300.0 * 0.18 / (4.0 * 64.0));
    println!("{lens}: {part:.4} of the camera equation");
    part
}

/// A gray card behind every lens at f/8 has the illuminance of the camera equation within 2 %. The remaining difference is that of
/// the exit pupil seen from the film from the marginal ray of a lens with spherical aberration, over all wavelengths.
#[test]
fn every_lens_renders_the_illuminance_of_its_f_number() {
    for (name, _) in library() {
        let part = of_the_camera_equation(&name);
        assert!((part - 1.0).abs() < 0.02, "{name}: {part}");
    }
}

/// A lens and its mirror images have one f-number, by the solid angle of the cone: 2.743 by another program's rays if the first
/// surface is decentered by 2 mm, and 2.761 if not. By the upper marginal ray alone they would be f/3.90, f/2.10 and f/2.65, and gray
/// cards would differ by a factor of five.
#[test]
fn a_decentered_lens_has_the_f_number_of_its_cone() {
    let folder = tempfile::tempdir().expect("a folder");
    let lens = |decenter: [i32; 2]| {
        let [x, y] = decenter;
        let path = folder.path().join(format!("decentered-{x}-{y}.yaml"));
        let text = format!(
            "name: decentered\nsurfaces:\n  - {{kind: stop, thickness: 0, semi-diameter: 5}}\n\
             \x20 - {{radius: 20, thickness: 5, nd: 1.5168, vd: 64.2, semi-diameter: 10, decenter: [{x}, {y}]}}\n\
             \x20 - {{radius: -50, thickness: 30, semi-diameter: 10}}\n"
        );
        std::fs::write(&path, text).expect("written");
        path
    };
    for (decenter, wanted) in [([0, 2], 2.743), ([0, -2], 2.743), ([2, 0], 2.743), ([0, 0], 2.761)] {
        let path = lens(decenter);
        let found = Optics::new(load(shown(&path))).marginal_ray().expect("open").f_number();
        assert!((found - wanted).abs() < 1e-3, "{decenter:?}: f/{found}");
        let part = of_the_camera_equation(shown(&path));
        assert!((part - 1.0).abs() < 0.02, "{decenter:?}: {part}");
    }
}

/// Sign errors are noticed: signs of another convention, or a thickness after a mirror on the side away from the light. `lens info`
/// also notices a lost sign in the prescription.
#[test]
fn slips_of_signs_are_doubted() {
    let folder = tempfile::tempdir().expect("a folder");
    let warnings = |surfaces: &str| {
        let path = folder.path().join("lens.yaml");
        std::fs::write(&path, format!("name: slip\nsurfaces:\n{surfaces}")).expect("written");
        load(shown(&path)).warnings.join("; ")
    };
    let singlet = |front: &str, rear: &str| {
        format!(
            "  - {{radius: {front}, thickness: 5, nd: 1.5168, vd: 64.2, semi-diameter: 8}}\n\
             \x20 - {{radius: {rear}, thickness: 2, semi-diameter: 8}}\n  - {{kind: stop, thickness: 45, semi-diameter: 4}}\n"
        )
    };
    let mirrors = |thickness: &str| {
        format!(
            "  - {{kind: stop, thickness: 0, semi-diameter: 20}}\n\
             \x20 - {{radius: -200, thickness: {thickness}, mirror: true, semi-diameter: 20}}\n"
        )
    };
    for (surfaces, wanted) in [
        (singlet("50", "-50"), None),
        (singlet("-50", "50"), Some("the lens spreads light")),
        (mirrors("-100"), None),
        (mirrors("100"), Some("the mirror of surface 2 sends light toward -z")),
    ] {
        let found = warnings(&surfaces);
        match wanted {
            Some(wanted) => assert!(found.contains(wanted), "{surfaces}{found}"),
            None => assert_eq!(found, "", "{surfaces}"),
        }
    }
    let lost = folder.path().join("lost.yaml");
    for (rear, doubted) in [("-50", false), ("-500", true)] {
        std::fs::write(&lost, format!("name: slip\nsurfaces:\n{}", singlet("50", rear))).expect("written");
        let said = good(&["lens", "info", shown(&lost)]);
        assert_eq!(said.contains("mm behind the image plane"), doubted, "{said}");
    }
}
