//! Tests of the film process `three-strip`, as a scene uses it.

use spectra_core::frame::{ExposureChannel, ExposureFrame, FrameSize};
use spectra_core::params::{Faults, Params};
use spectra_core::registry::Context;
use spectra_core::resources::Resources;
use spectra_core::spectral::BAND;
use spectra_core::stage::Film;
use spectra_plugin_films::ThreeStrip;
use spectra_scene::FileResources;
use spectra_spectrum::illuminant;

fn build(yaml: &str) -> Result<ThreeStrip, Faults> {
    let folder = tempfile::tempdir().expect("a folder");
    std::fs::write(folder.path().join("film.yaml"), yaml).expect("written");
    let resources = FileResources::beside(folder.path());
    let params: Params = resources.document("film.yaml", &[], &[]).expect("YAML");
    ThreeStrip::build(&params, &Context::new(&resources, BAND))
}

fn shown(film: &ThreeStrip, blue: f32, green: f32, red: f32) -> [f32; 3] {
    let size = FrameSize { width_px: 1, height_px: 1, width_mm: 1.0, height_mm: 1.0 };
    let channel =
        |(name, value): (&str, f32)| ExposureChannel { name: name.into(), unit: "lx s".into(), values: vec![value] };
    let channels = [("blue", blue), ("green", green), ("red", red)].map(channel).into();
    film.develop(&ExposureFrame { size, channels }).expect("complete").rgb[0]
}

/// In the light that the camera is balanced for, a mid gray at the meter's exposure prints neutral. More light on one record than on the
/// others gives that record's color.
#[test]
fn a_mid_gray_prints_neutral_and_colors_lead() {
    let film = build("exposure: 1/60 s\n").expect("sound");
    let light = illuminant("D55").expect("bundled").to_power(&BAND);
    let v = spectra_spectrum::v_lambda();
    let luminous: Vec<f64> = BAND.wavelengths_nm().map(|w| 683.0 * v.at(w)).collect();
    // Scales the light to 10/5 lx s, the exposure of a mid gray.
    let scale = 2.0 / light.seen_by(&luminous);
    let [b, g, r] = [0, 1, 2].map(|i| (light.seen_by(&film.channels()[i].response) * scale) as f32);
    let gray = shown(&film, b, g, r);
    assert!(gray.iter().all(|v| (v - 0.18).abs() < 2e-3), "{gray:?}");
    for (i, rgb) in
        [shown(&film, b / 4.0, g / 4.0, r), shown(&film, b / 4.0, g, r / 4.0), shown(&film, b, g / 4.0, r / 4.0)]
            .into_iter()
            .enumerate()
    {
        assert!((0..3).all(|k| k == i || rgb[i] > 1.5 * rgb[k]), "{i}: {rgb:?}");
    }
}

/// Returns the exposures of the three records, blue, green and red, by a mid gray in the balance light, lx s.
fn mid_gray(film: &ThreeStrip) -> [f32; 3] {
    let light = illuminant("D55").expect("bundled").to_power(&BAND);
    let v = spectra_spectrum::v_lambda();
    let luminous: Vec<f64> = BAND.wavelengths_nm().map(|w| 683.0 * v.at(w)).collect();
    // Scales the light to 10/5 lx s, the exposure of a mid gray.
    let scale = 2.0 / light.seen_by(&luminous);
    [0, 1, 2].map(|i| (light.seen_by(&film.channels()[i].response) * scale) as f32)
}

/// From 2 stops under mid gray to 3 over it, a* and b* are within 2 of neutral. The clear print is white.
#[test]
fn a_gray_scale_is_gray_and_reaches_white() {
    let film = build("exposure: 1/60 s\ngrain: false\n").expect("sound");
    let [b, g, r] = mid_gray(&film);
    let srgb = spectra_color::RgbSpace::srgb();
    for half in -4..=10 {
        let stops = f64::from(half) / 2.0;
        let factor = spectra_core::math::pow(2.0, stops) as f32;
        let shown = shown(&film, b * factor, g * factor, r * factor).map(f64::from);
        let [l, a, b] = spectra_color::lab(srgb.to_xyz(shown), srgb.white_xyz());
        println!("{stops:+.1}: {l:.1} {a:+.2} {b:+.2}");
        assert!(stops > 3.0 || (a.abs() <= 2.0 && b.abs() <= 2.0), "{stops:+}: {l:.1} {a:+.2} {b:+.2}");
        assert!(stops < 5.0 || l > 95.0, "{stops:+}: {l:.1}");
    }
    // With the bare light as white, the clear print is a little darker than white.
    let lamp = build("exposure: 1/60 s\ngrain: false\nwhite: lamp\n").expect("sound");
    let (film, lamp) = ([&film, &lamp]).map(|f| shown(f, b * 32.0, g * 32.0, r * 32.0)[1]).into();
    assert!(lamp <= film, "{lamp} {film}");
}

#[test]
fn parameters_are_checked() {
    for (yaml, word) in [
        ("iso: 5\n", "exposure"),
        ("metering: average\nred: {stock: kodak-vision3-250d-5207}\n", "one layer"),
        ("metering: average\nred: {stock: blue-sensitive-plate, filters: [wratten-99]}\n", "wratten-99"),
        ("metering: average\nblue: {stock: kodak-double-x-5222, development: lith}\n", "6-min"),
        ("metering: average\nprint: kodak-2302\n", "three records"),
        ("metering: average\nbalance: moonlight\n", "moonlight"),
    ] {
        let text = build(yaml).expect_err(yaml).to_string();
        assert!(text.contains(word), "{yaml}: {text}");
    }
}

/// Each record spreads a white point in the dark as its stock does; the red one, behind the blue one, spreads it most. Green and red have
/// halation; blue has none, because no base lies behind it.
#[test]
fn records_spread_light_and_have_grain() {
    let plain = "exposure: 1/60 s\noptics: off\n";
    let size = FrameSize { width_px: 101, height_px: 101, width_mm: 0.606, height_mm: 0.606 };
    let frame = |film: &ThreeStrip, at: f32, around: f32| {
        let [b, g, r] = mid_gray(film);
        let plane =
            |level: f32| (0..101 * 101).map(move |k| if k == 50 * 101 + 50 { at * level } else { around * level });
        let channel = |(name, level): (&str, f32)| ExposureChannel {
            name: name.into(),
            unit: "lx s".into(),
            values: plane(level).collect(),
        };
        ExposureFrame { size, channels: [("blue", b), ("green", g), ("red", r)].map(channel).into() }
    };
    let off = "scatter: false\nadjacency: false\nhalation: off\ngrain: false\n";
    let lamp = |yaml: &str, level: f32| {
        let film = build(&format!("{plain}{yaml}")).expect("sound");
        film.negatives(&frame(&film, level, 0.0)).expect("complete")
    };
    let point = |yaml: &str| lamp(yaml, 3e3);
    let along = |planes: &[Vec<f32>], record: usize, k: usize| planes[record][50 * 101 + 50 + k];
    let none = point(off);
    let clear = along(&none, 0, 30);
    assert!((0..3).all(|i| along(&none, i, 1) == clear && along(&none, i, 0) > clear + 1.0));
    let scattered = point("adjacency: false\nhalation: off\ngrain: false\n");
    assert!(along(&scattered, 2, 5) > along(&scattered, 1, 5) + 0.01 && along(&scattered, 1, 2) > clear);
    assert!((along(&scattered, 0, 5) - along(&scattered, 1, 5)).abs() < 0.01);
    let halo = lamp("scatter: false\nadjacency: false\ngrain: false\n", 1e6);
    assert!(along(&halo, 0, 40) == clear && along(&halo, 1, 40) > clear && along(&halo, 2, 40) > clear);
    // Each record has its own grain, which `grain: false` removes.
    let even = |yaml: &str| {
        let film = build(&format!("{plain}{yaml}")).expect("sound");
        film.negatives(&frame(&film, 1.0, 1.0)).expect("complete")
    };
    let grainy = even("scatter: false\nadjacency: false\nhalation: off\n");
    assert!((0..3).all(|i| grainy[i].iter().any(|d| (d - grainy[i][0]).abs() > 0.01)) && grainy[0] != grainy[1]);
    let plane = &even(off)[2];
    assert!(plane.iter().all(|d| *d == plane[0]));
    let film = build(plain).expect("sound");
    assert!(film.describe().contains("halation assumed"), "{}", film.describe());
}

/// Reciprocity failure makes a long exposure less effective than a short one with the same lux-seconds. All three records are Tri-X, whose
/// sheet gives 50 s for a metered time of 10 s.
#[test]
fn long_exposures_lose_speed() {
    let record = "{stock: kodak-tri-x-400, filters: []}";
    let film = |time: &str| {
        build(&format!("exposure: {time}\nblue: {record}\ngreen: {record}\nred: {record}\n")).expect("sound")
    };
    let size = FrameSize { width_px: 1, height_px: 1, width_mm: 1.0, height_mm: 1.0 };
    let density = |film: &ThreeStrip, lx_s: f32| {
        let channel = |name: &str| ExposureChannel { name: name.into(), unit: "lx s".into(), values: vec![lx_s] };
        let channels = ["blue", "green", "red"].map(channel).into();
        film.negatives(&ExposureFrame { size, channels }).expect("complete")[1][0]
    };
    let (short, long) = (film("1/100 s"), film("50 s"));
    let lx_s = mid_gray(&short)[1];
    let (quick, slow) = (density(&short, lx_s), density(&long, 5.0 * lx_s));
    assert!((quick - slow).abs() < 0.02, "{quick} {slow}");
    assert!(density(&long, lx_s) < quick - 0.2);
}
