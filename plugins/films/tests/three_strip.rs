//! The film process `three-strip`, as a scene uses it.

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

/// In the light that the camera is balanced for, a mid gray leaves on each record what the meter says, and prints neutral.
#[test]
fn a_mid_gray_prints_neutral_and_colors_lead() {
    let film = build("exposure: 1/60 s\n").expect("sound");
    let light = illuminant("D55").expect("bundled").to_power(&BAND);
    let v = spectra_spectrum::v_lambda();
    let luminous: Vec<f64> = BAND.wavelengths_nm().map(|w| 683.0 * v.at(w)).collect();
    // 10/5 lx s of a mid gray.
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
