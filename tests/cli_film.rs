//! `spectra film`: stocks in figures and pictures.

mod common;

use common::{good, run, text};
use serde_json::Value;

#[test]
fn info_shows_what_the_sheet_says() {
    let tri_x: Value = serde_json::from_str(&good(&["film", "info", "kodak-tri-x-400", "--json"])).expect("JSON");
    assert_eq!((tri_x["iso"].as_f64(), tri_x["granularity"]["rms"].as_f64()), (Some(400.0), Some(17.0)));
    assert_eq!(tri_x["mid_gray_lx_s"].as_f64(), Some(0.025));
    let developments = tri_x["layers"][0]["developments"].as_array().expect("a list");
    assert_eq!(developments.len(), 4);
    assert!(developments[0]["speed_point_log10_lx_s"].as_f64().is_some_and(|x| (x + 2.72).abs() < 0.01));
    let ortho: Value = serde_json::from_str(&good(&["film", "info", "ilford-ortho-plus", "--json"])).expect("JSON");
    assert!(ortho["granularity"]["assumed"] == true && ortho["assumed"]["mtf"].is_string());
    let speed = ortho["layers"][0]["daylight_over_tungsten_speed"].as_f64().expect("a number");
    assert!((speed - 1.73).abs() < 0.01, "{speed}");
    assert_eq!(tri_x["speed_kind"], "iso");
    assert!(good(&["film", "info", "kodak-tri-x-400"]).contains("stops from the stated speed"));
    assert!(
        good(&["film", "info", "kodak-double-x-5222"])
            .contains("EI 250, in tungsten light 200; the maker's exposure index")
    );
    assert!(good(&["film", "info", "blue-sensitive-plate"]).contains("ISO 25 (assumed)"));
    for name in ["kodak-vision3-250d-5207", "kodak-vision-2383", "technicolor-iv", "panchromatic-plate"] {
        assert!(good(&["film", "info", name]).contains("log10 sensitivity"), "{name}");
    }
}

#[test]
fn plots_are_written_as_their_ending_says() {
    let folder = tempfile::tempdir().expect("a folder");
    for (name, ending) in
        [("kodak-vision3-250d-5207", "svg"), ("kodak-tri-x-400", "png"), ("kodak-ektachrome-100d", "svg")]
    {
        let path = folder.path().join(format!("film.{ending}"));
        good(&["film", "plot", name, "-o", &path.to_string_lossy()]);
        let bytes = std::fs::read(&path).expect("written");
        assert!(bytes.starts_with(if ending == "svg" { b"<svg" } else { b"\x89PNG" }) && bytes.len() > 4000);
    }
}

#[test]
fn what_is_wrong_is_said() {
    for (arguments, word) in [
        (["film", "info", "kodak-try-x-400", "--json"], "did you mean `kodak-tri-x-400`?"),
        (["film", "plot", "kodak-tri-x-400", "-o=x.pdf"], ".svg or .png"),
        (["film", "info", "none.yaml", "--json"], "none.yaml"),
    ] {
        let output = run(&arguments);
        assert_eq!(output.status.code(), Some(2), "{arguments:?}");
        assert!(text(&output.stderr).contains(word), "{}", text(&output.stderr));
    }
}
