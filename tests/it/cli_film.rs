//! Tests `spectra film`: figures and plots of stocks.

use crate::common::{good, rows, run, shown, text};
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

/// The effect of a change of lamp on colors, for the eye and for the layers of three films, agrees with an independent computation
/// (xtask/film_lamp.py, with colour-science) within 0.02 CIEDE2000.
#[test]
fn film_lamp_is_that_of_another_program() {
    let rows = rows("film-lamp.csv");
    assert_eq!(rows.len(), 3 * 24);
    for case in rows.chunks(24) {
        let [stock, lamp, reference] = [0, 1, 2].map(|i| case[0][i].as_str());
        let found = good(&["film", "lamp", stock, lamp, "--reference", reference, "--json"]);
        let found: Value = serde_json::from_str(&found).expect("JSON");
        let patches = found["ciede2000"].as_array().expect("patches");
        let mut worst = [0.0_f64; 2];
        for (row, patch) in case.iter().zip(patches) {
            assert_eq!(patch["name"], row[3].as_str());
            for (i, key) in ["eye", "layers"].into_iter().enumerate() {
                let wanted: f64 = row[4 + i].parse().expect("a number");
                let own = patch[key].as_f64().expect("a number");
                worst[i] = worst[i].max((own - wanted).abs());
            }
        }
        println!("{stock} {lamp} {reference}: {worst:?}");
        assert!(worst.iter().all(|off| *off < 0.02), "{stock} {lamp}: {worst:?}");
    }
}

/// A lamp compared with itself, brighter or not, separates no colors. A lamp that separates colors does so in the finished picture
/// too, and a film of higher contrast drives them further apart. The patches listed under `parting` are indeed separated more by the
/// film.
#[test]
fn film_lamp_judges_the_finished_picture() {
    let lamp = |arguments: &[&str]| -> Value {
        serde_json::from_str(&good(&[&["film", "lamp"], arguments, &["--json"]].concat())).expect("JSON")
    };
    let mean = |of: &Value| of["mean_film"].as_f64().expect("a number");
    for same in ["D50", "3 * D50"] {
        let none = lamp(&["kodak-portra-400", same, "--reference", "D50"]);
        for key in ["mean_eye", "mean_layers", "mean_film"] {
            assert!(none[key].as_f64().expect("a number") < 1e-3, "{same}: {none}");
        }
        assert!(none["fidelity"]["film"].as_f64() > Some(99.99) && none["fidelity"]["eye"].as_f64() > Some(99.99));
        assert_eq!(none["parting"], serde_json::json!([]));
    }
    let found = lamp(&["kodak-portra-400", "FL2", "--reference", "D50"]);
    let [eye, film] = ["eye", "film"].map(|key| found["fidelity"][key].as_f64().expect("a number"));
    assert!((0.0..95.0).contains(&eye) && (0.0..95.0).contains(&film), "{found}");
    assert!(mean(&found) > 1.0, "{found}");
    for name in found["parting"].as_array().expect("names") {
        let patch =
            found["ciede2000"].as_array().and_then(|all| all.iter().find(|p| p["name"] == *name)).expect("a patch");
        assert!(patch["film"].as_f64() > patch["eye"].as_f64(), "{patch}");
    }
    // Another print stock makes another picture of the same exposures.
    let print = lamp(&["kodak-vision3-250d-5207", "FL2", "--reference", "D50", "--print", "kodak-vision-premier-2393"]);
    let usual = lamp(&["kodak-vision3-250d-5207", "FL2", "--reference", "D50", "--print", "kodak-vision-2383"]);
    assert_eq!(print["mean_layers"], usual["mean_layers"]);
    assert!(mean(&print) != mean(&usual), "{} {}", mean(&print), mean(&usual));
    // The table shows the same figures, and the plot is written.
    let folder = tempfile::tempdir().expect("a folder");
    let figure = folder.path().join("lamp.svg");
    let table = good(&["film", "lamp", "kodak-portra-400", "FL2", "--reference", "D50", "-o", shown(&figure)]);
    assert!(table.contains(&format!("eye {eye:.1}, film {film:.1}")), "{table}");
    assert!(std::fs::read_to_string(figure).expect("written").contains("layers"));
    let refused = run(&["film", "lamp", "kodak-tri-x-400", "FL2"]);
    assert!(text(&refused.stderr).contains("only a color film"), "{}", text(&refused.stderr));
    let refused = run(&["film", "lamp", "kodak-portra-400", "FL2", "--view", "sideways"]);
    assert!(text(&refused.stderr).contains("--view sideways"), "{}", text(&refused.stderr));
}
