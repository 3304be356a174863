//! Tests how film records a scene, through the whole camera.

use spectra_core::Isa;
use spectra_core::frame::{ExposureFrame, FrameSize};
use spectra_film::emulsion::Emulsion;
use spectra_film::stock::Stock;
use spectra_plugins as _;
use spectra_render::{Control, RenderOptions, Renderer, Threads};
use spectra_scene::{FileResources, Negatives, Scene, Shot};
use std::path::Path;

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

fn load(scene: &str, overrides: &[&str]) -> Scene {
    let overrides: Vec<String> = overrides.iter().map(|s| (*s).to_owned()).collect();
    spectra_scene::load(&root().join("scenes").join(scene), &overrides).unwrap_or_else(|faults| panic!("{faults}"))
}

fn render(scene: &Scene) -> ExposureFrame {
    let renderer = Renderer::new(scene.clone(), &RenderOptions::default()).expect("the scene can be rendered");
    renderer.run(&Threads(2), &Control::new()).expect("rendered").exposure
}

/// Returns the mean over the middle of a patch of the ColorChecker in scenes like `biotar-trix.yaml`. The chart is 0.6 m wide at 1 m,
/// 282 units with patches 46 apart, and the frame of 36 mm sees 685 mm, known to one or two per cent.
fn patch(plane: &[f32], size: FrameSize, column: usize, row: usize) -> f64 {
    let (width, height) = (size.width_px as usize, size.height_px as usize);
    let apart = 46.0 / 282.0 * 600.0;
    let x = 0.5 + (column as f64 - 2.5) * apart / 685.0;
    let y = 0.5 + (row as f64 - 1.5) * apart / (685.0 / 1.5);
    let (x, y) = ((x * width as f64) as usize, (y * height as f64) as usize);
    let around = |dy: usize| (0..5).map(move |dx| f64::from(plane[(y + dy - 2) * width + x + dx - 2]));
    (0..5).flat_map(around).sum::<f64>() / 25.0
}

/// `grade: auto` on a chart through the whole camera puts the darkest and the lightest 0.5 % at the ends of the paper's range.
#[test]
fn an_automatic_print_of_a_chart_has_black_and_white() {
    for name in ["biotar-trix.yaml", "biotar-ortho.yaml"] {
        let overrides = ["imager.resolution=[150, 100]", "render.samples=64", "film.paper={grade: auto}"];
        let scene = load(name, &overrides);
        let frame = render(&scene);
        let picture = scene.films.first().expect("a film").film.develop(&frame).expect("complete");
        let mut shown: Vec<f32> = picture.rgb.iter().map(|p| p[1]).collect();
        shown.sort_by(f32::total_cmp);
        let few = shown.len() / 200;
        let mean = |of: &[f32]| of.iter().map(|v| f64::from(*v)).sum::<f64>() / of.len() as f64;
        let lightness = |y: f64| spectra_color::lab([y; 3], [1.0; 3])[0];
        let (black, white) = (lightness(mean(&shown[..few])), lightness(mean(&shown[shown.len() - few..])));
        println!("{name}: {black:.2} {white:.2}");
        // The ends of the paper's exposure range by ISO 6846: nine tenths of its density of 2.1, under a flare of 0.5 %, and 0.04.
        let [dark, light] = [0.9 * 2.1, 0.04].map(|d| lightness((libm::pow(10.0, -d) + 0.005) / 1.005));
        assert!(black <= dark && white >= light - 0.5, "{name}: {black} {dark}, {white} {light}");
    }
}

/// Compares orthochromatic with panchromatic film through lens, film and development, using densities. In daylight the ColorChecker's
/// red is at least a stop darker and its blue at least 0.2 lighter; in tungsten light, 1.6 and 0.4.
#[test]
fn orthochromatic_negatives_have_dark_reds_and_light_blues() {
    let stops = |stock: &str, illuminant: &str| -> [f64; 2] {
        let scene = load(
            "biotar-trix.yaml",
            &[
                &format!("film.stock={stock}"),
                &format!("source.illuminant={illuminant}"),
                "source.width=0.6 m",
                "imager.resolution=[150, 100]",
                "render.samples=64",
            ],
        );
        let frame = render(&scene);
        let film = Stock::load(stock, &FileResources::beside(root())).expect("bundled");
        let emulsion = Emulsion::new(&film, film.developments().next().expect("has one")).expect("sound");
        let mut plane = frame.channel(&film.layers[0].name).expect("its channel").values.clone();
        // The scene's metered exposure puts the densities on the straight part of the curve.
        let factor = scene.films.first().expect("a film").film.metered_time_s(&frame) / scene.exposure_time_s();
        emulsion.develop(0, &mut plane, factor);
        let exposure = |column, row| {
            let density = patch(&plane, frame.size, column, row);
            emulsion.log10_exposure_at(0, density).expect("between fog and shoulder") / libm::log10(2.0)
        };
        let white = exposure(0, 3);
        [exposure(2, 2) - white, exposure(0, 2) - white]
    };
    for (light, red, blue) in
        [("iso-7589-sensitometric-daylight", 1.0, 0.2), ("iso-7589-sensitometric-studio-tungsten", 1.6, 0.4)]
    {
        let (ortho, pan) = (stops("ilford-ortho-plus", light), stops("kodak-tri-x-400", light));
        println!("{light}: red {:.3}, blue {:.3}", ortho[0] - pan[0], ortho[1] - pan[1]);
        assert!(ortho[0] - pan[0] <= -red, "{light}, red: {ortho:?} {pan:?}");
        assert!(ortho[1] - pan[1] >= blue, "{light}, blue: {ortho:?} {pan:?}");
    }
}

/// Dark leaves in a photograph keep their hue on film within 8 degrees, because the default model makes smooth reflectances. As sums
/// of the screen's primaries they turn brown, by 21 degrees on Ektachrome.
#[test]
fn leaves_of_a_photograph_stay_green() {
    let leaf = [72_u8, 80, 38];
    let folder = tempfile::tempdir().expect("a folder");
    image::RgbImage::from_pixel(8, 8, image::Rgb(leaf)).save(folder.path().join("leaf.png")).expect("written");
    let srgb = spectra_color::RgbSpace::srgb();
    let hue = |linear: [f64; 3]| {
        let [_, a, b] = spectra_color::lab(srgb.to_xyz(linear), srgb.white_xyz());
        libm::atan2(b, a).to_degrees()
    };
    let wanted = hue(leaf.map(|v| spectra_color::Transfer::Srgb.decode(f64::from(v) / 255.0)));
    let turned = |stock: &str, color: &str| {
        let path = folder.path().join("leaf.yaml");
        let text = format!(
            "spectra: 1\nsource: {{kind: picture, file: leaf.png, distance: 2 m, width: fill, illuminant: D55{color}}}\n\
             lens: {{file: tessar-50-f4.5, f-number: f/8, focus: 2 m}}\n\
             imager: {{kind: film, format: 135, resolution: [6, 4]}}\n\
             film: {{stock: {stock}, metering: average, compensation: -1, grain: false}}\n\
             render: {{samples: 4096, seed: 1}}\n"
        );
        std::fs::write(&path, text).expect("written");
        let scene = spectra_scene::load(&path, &[]).unwrap_or_else(|faults| panic!("{faults}"));
        let picture = scene.films.first().expect("a film").film.develop(&render(&scene)).expect("complete");
        let mean = |c: usize| picture.rgb.iter().map(|p| f64::from(p[c])).sum::<f64>() / picture.rgb.len() as f64;
        hue([mean(0), mean(1), mean(2)]) - wanted
    };
    for stock in ["kodak-vision3-250d-5207", "kodak-ektachrome-100d"] {
        let usual = turned(stock, "");
        println!("{stock}: {usual:+.1}");
        assert!(usual.abs() <= 8.0, "{stock}: {usual:+.1}");
    }
    let brown = turned("kodak-ektachrome-100d", ", color: {kind: primaries}");
    assert!(brown < -15.0, "{brown:+.1}");
}

/// A metered gray card is shown as 18 % on every film that makes a picture, whatever the exposure time in the scene. Its light is
/// what the film is balanced for, so behind a colorless lens it is neutral too.
#[test]
fn a_metered_gray_card_is_a_mid_gray() {
    for (film, mid, most) in [
        ("{stock: kodak-tri-x-400, metering: spot}", 0.18, 0.02),
        ("{stock: kodak-double-x-5222, metering: spot, exposure: 1/8 s, print: kodak-2302}", 0.18, 0.02),
        ("{stock: kodak-vision3-250d-5207, metering: spot}", 0.18, 0.05),
        ("{stock: kodak-vision3-250d-5207, metering: spot, view: scan}", 0.18, 0.05),
    ] {
        let scene = load(
            "gray-card.yaml",
            &[
                "imager={kind: film, format: 135, resolution: [30, 20]}",
                &format!("film={film}"),
                "source.illuminant=iso-7589-sensitometric-daylight",
                "render.samples=1024",
                "lens.coating=ideal",
                "lens.absorption=false",
            ],
        );
        let frame = render(&scene);
        let picture = scene.films.first().expect("a film").film.develop(&frame).expect("complete");
        // The middle of the frame, which the spot meter sees.
        let middle: Vec<[f32; 3]> =
            [9 * 30 + 14, 9 * 30 + 15, 10 * 30 + 14, 10 * 30 + 15].map(|i| picture.rgb[i]).into();
        for c in 0..3 {
            let mean = middle.iter().map(|p| f64::from(p[c])).sum::<f64>() / 4.0;
            assert!((mean / mid - 1.0).abs() < most, "{film}: {middle:?}");
        }
    }
}

/// A film that is only printed in another way is not developed again, and a film that is developed differently is. In both cases the
/// picture equals that of a film developed from scratch.
#[test]
fn negatives_are_kept_while_they_are_printed_otherwise() {
    const SMALL: [&str; 2] = ["imager.resolution=[60, 40]", "render.samples=4"];
    let of = |overrides: &[&str]| load("biotar-ortho.yaml", &[&SMALL, overrides].concat());
    let color = |rest: &[&str]| of(&[&["film.stock=kodak-gold-200"], rest].concat());
    let silver = [
        (of(&["film.paper.grade=1"]), false),
        (of(&["film.paper.grade=4"]), true),
        (of(&["film.paper.grade=4", "film.grain=false"]), false),
        (of(&["film.grain=false"]), true),
        (of(&["film.grain-seed=5"]), false),
        (of(&["film.grain-seed=5", "film.halation=off"]), false),
        (of(&["film.grain-seed=5", "film.halation=off", "film.optics=off"]), false),
    ];
    let dyes = [
        (color(&[]), false),
        (color(&["film.print=kodak-endura-premier"]), true),
        (color(&["film.print=fuji-crystal-archive-dpii", "film.light=D65"]), true),
        (color(&["film.view=scan"]), true),
        (color(&["film.halation=off"]), false),
    ];
    for films in [&silver[..], &dyes] {
        let exposure = render(&films[0].0);
        let kept = Negatives::default();
        let mut before: Option<&Scene> = None;
        for (i, (scene, is_kept)) in films.iter().enumerate() {
            let film = &scene.films[0].film;
            let is_same = before.is_some_and(|before| film.develops_as(&*before.films[0].film));
            assert_eq!(is_same, *is_kept, "{i}");
            let times = scene.film_times(&exposure);
            let shot = || Shot::new(scene, &exposure, &times, &[], Isa::detect());
            let (again, anew) = (shot().with_negatives(&kept), shot());
            assert_eq!(again.pictures().expect("a picture"), anew.pictures().expect("a picture"), "{i}");
            before = Some(scene);
        }
    }
}

/// A warning reports that the data sheet does not cover a long exposure; a film with its own reciprocity law causes none.
#[test]
fn long_exposures_beyond_the_sheet_are_doubted() {
    for (stock, doubted) in [("kodak-portra-400", true), ("ilford-hp5-plus", false)] {
        let scene = load("biotar-trix.yaml", &[&format!("film={{stock: {stock}, exposure: 30 s}}")]);
        let film = &scene.films[0].film;
        assert_eq!(film.long_exposure_warning(30.0).is_some(), doubted, "{stock}");
        assert!(film.long_exposure_warning(1.0).is_none() && film.long_exposure_warning(0.01).is_none());
    }
}

/// The warning about tungsten film in daylight names the filter that corrects the cast, in addition to one that is already there. A
/// strongly colored filter is taken as intended.
#[test]
fn casts_are_mended_by_the_filter_that_is_named() {
    let said = |filters: &str| {
        let film = "film={stock: kodak-vision3-500t-5219, metering: average}";
        let scene = load("biotar-trix.yaml", &[film, "source.illuminant=D55", &format!("lens.filters={filters}")]);
        scene.warnings.iter().map(ToString::to_string).find(|text| text.contains("is balanced for a different light"))
    };
    let alone = said("[]").expect("a cast");
    let mired: f64 = alone
        .split("mired: ")
        .nth(1)
        .and_then(|rest| rest.split('}').next())
        .expect("a filter")
        .parse()
        .expect("mired");
    // The light of D55 is 182 mired, that of 3200 K is 312.
    assert!((mired - 130.0).abs() < 20.0, "{alone}");
    let added = said("[{mired: 40}]").expect("a cast still");
    assert!(added.contains("add `{mired: ") && !added.contains(&format!("mired: {mired:.0}}}")), "{added}");
    assert_eq!(said(&format!("[{{mired: {mired}}}]")), None);
    assert_eq!(said("[wratten-15]"), None);
}
