//! The film process `stock`, as a scene uses it.

use spectra_core::frame::{ExposureChannel, ExposureFrame, FrameSize};
use spectra_core::params::{Faults, Params};
use spectra_core::registry::{Context, FilmEntry, Stage};
use spectra_core::resources::Resources;
use spectra_core::spectral::BAND;
use spectra_core::stage::Film;
use spectra_plugin_films::StockFilm;
use spectra_scene::FileResources;

fn with_params<T>(yaml: &str, use_them: impl FnOnce(&Params, &Context<'_>) -> T) -> T {
    let folder = tempfile::tempdir().expect("a folder");
    std::fs::write(folder.path().join("film.yaml"), yaml).expect("written");
    let resources = FileResources::beside(folder.path());
    let params = resources.document("film.yaml", &[], &[]).expect("YAML");
    use_them(&params, &Context { resources: &resources, grid: BAND, illuminant: None })
}

fn build(yaml: &str) -> Result<StockFilm, Faults> {
    with_params(yaml, StockFilm::build)
}

fn frame(values: &[f32]) -> ExposureFrame {
    let size = FrameSize { width_px: values.len() as u32, height_px: 1, width_mm: 1.0, height_mm: 1.0 };
    let channel = ExposureChannel { name: "ortho".into(), unit: "lx s".into(), values: values.to_vec() };
    ExposureFrame { size, channels: vec![channel] }
}

#[test]
fn is_registered_as_the_default() {
    let entries = <dyn Film as Stage>::entries();
    let entry: &&FilmEntry = entries.iter().find(|e| e.name == "stock").expect("registered");
    assert!(entry.default);
    let film = with_params("stock: ilford-ortho-plus\nexposure: 1/60 s\n", entry.build).map_err(|e| e.to_string());
    let film = film.expect("sound");
    assert!((film.exposure_time_s() - 1.0 / 60.0).abs() < 1e-15);
    assert_eq!(film.channels().len(), 1);
    assert_eq!(film.channels()[0].response.len(), BAND.count);
    assert!(film.describe().contains("Ilford Ortho Plus, ISO 80"));
}

/// A mid gray subject at the meter's exposure, 10/S lx s, is 18 % of the screen's white; a red patch, which leaves no
/// exposure on this film, is black; all of it is neutral.
#[test]
fn gray_is_gray_and_red_is_black() {
    let film = build("stock: ilford-ortho-plus\nexposure: 1/60 s\n").expect("sound");
    let picture = film.develop(&frame(&[0.125, 0.0, 0.125 * 5.0, 100.0])).expect("complete");
    assert!(picture.rgb.iter().all(|p| p[0] == p[1] && p[1] == p[2]));
    let [gray, black, white, burnt] = [0, 1, 2, 3].map(|i| picture.rgb[i][0]);
    assert!((gray - 0.18).abs() < 1e-5, "{gray}");
    assert_eq!(black, 0.0);
    assert!(white > 0.75 && white < burnt && burnt <= 1.0, "{white} {burnt}");
    // The line of a red patch (C', 643.85 nm) is beyond what the film sees.
    let response = &film.channels()[0].response;
    assert_eq!(BAND.interpolate(response, 643.85), 0.0);
    assert!(BAND.interpolate(response, 546.07) > 0.0 && BAND.interpolate(response, 435.84) > 0.0);
}

#[test]
fn an_unknown_stock_is_told_with_near_names() {
    let text = build("stock: ilford-orto-plus\nexposure: 1/60 s\n").unwrap_err().to_string();
    assert!(text.contains("film.yaml:1:8:") && text.contains("did you mean `ilford-ortho-plus`?"), "{text}");
    let text = build("stock: zzz\nexposure: 1/60 s\n").unwrap_err().to_string();
    assert!(text.contains("film.yaml:1:8:") && text.contains("ilford-ortho-plus"), "{text}");
}

#[test]
fn parameters_are_checked() {
    for (yaml, word) in [
        ("stock: ilford-ortho-plus\n", "exposure"),
        ("stock: ilford-ortho-plus\nexposure: 0 s\n", "positive"),
        ("stock: ilford-ortho-plus\nexposure: 3 mm\n", "time"),
        ("stock: ilford-ortho-plus\nexposure: 1 s\niso: 3\n", "iso"),
        ("stock: ilford-ortho-plus\nexposure: 1 s\ndevelopment: lith\n", "pictorial"),
    ] {
        let text = build(yaml).unwrap_err().to_string();
        assert!(text.contains(word), "{yaml}: {text}");
    }
}

#[test]
fn a_frame_without_its_channel_is_refused() {
    let film = build("stock: ilford-ortho-plus\nexposure: 1/60 s\n").expect("sound");
    let mut other = frame(&[1.0]);
    other.channels[0].name = "Y".into();
    assert!(film.develop(&other).unwrap_err().contains("ortho"));
}
