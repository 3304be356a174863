//! `spectra lens info`, against first-order values computed by others.

mod common;

use common::{good, lens, rows, run, shown, text};
use serde_json::Value;

fn info(lens: &str, options: &[&str]) -> Value {
    let arguments: Vec<&str> = ["lens", "info", lens, "--json"].into_iter().chain(options.iter().copied()).collect();
    serde_json::from_str(&good(&arguments)).expect("JSON")
}

fn figure(info: &Value, key: &str) -> f64 {
    info[key].as_f64().unwrap_or_else(|| panic!("`{key}` is no number: {}", info[key]))
}

/// Values computed twice, independently; printed with seven decimals.
#[test]
fn focal_lengths_of_thirteen_lenses() {
    let wanted = rows("first-order.csv");
    assert_eq!(wanted.len(), 13);
    for row in wanted {
        let info = info(&lens(&row[0]), &["--nd"]);
        for (key, wanted) in [("efl_mm", &row[1]), ("bfl_mm", &row[2])] {
            let wanted: f64 = wanted.parse().expect("a number");
            assert!((figure(&info, key) - wanted).abs() < 1e-7, "{} {key}: {}", row[0], info[key]);
        }
    }
}

/// Exit pupil over entrance pupil diameter, paraxial, within 0.01.
#[test]
fn pupil_magnification_of_nine_lenses() {
    for (name, wanted) in [
        ("angenieux-100-f1.1", 2.38),
        ("nikon-retrofocus-100-f2.8", 1.73),
        ("asahi-takumar-100-f1.2", 1.63),
        ("zeiss-biotar-50-f1.4", 1.32),
        ("nikkor-100-f1.4", 1.32),
        ("canon-fd-50-f1.8", 1.14),
        ("leica-summilux-35-f1.4", 1.09),
        ("helios-44-58-f2", 0.98),
        ("zeiss-hologon-15-f8", 0.98),
    ] {
        let found = figure(&info(&lens(name), &["--nd"]), "pupil_magnification");
        assert!((found - wanted).abs() <= 0.01, "{name}: {found}");
    }
}

/// The thick lens in closed form; the index of N-BK7 at d is the maker's.
#[test]
fn equiconvex_lens_has_its_closed_form() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("equiconvex.yaml");
    let text = "name: Equiconvex\nsurfaces:\n  - {kind: sphere, radius: 50, thickness: 5, glass: SCHOTT/N-BK7}\n  \
                - {kind: sphere, radius: -50, thickness: 47, semi-diameter: 10}\n";
    std::fs::write(&file, text).expect("written");
    let info = info(shown(&file), &["--line", "d"]);
    assert!((figure(&info, "efl_mm") - 49.21300).abs() < 5e-6, "{info}");
    assert!((figure(&info, "bfl_mm") - 47.53622).abs() < 5e-6, "{info}");
    // Symmetric: the front mirrors the rear.
    assert!((figure(&info, "ffl_mm") + figure(&info, "bfl_mm")).abs() < 1e-9);
    let (front, rear) = (figure(&info, "front_principal_z_mm"), figure(&info, "rear_principal_z_mm"));
    assert!((front + rear - 5.0).abs() < 1e-9 && front < rear);
    assert_eq!(figure(&info, "total_track_mm"), 52.0);
    assert_eq!(figure(&info, "image_distance_mm"), 47.0);
    assert_eq!(info["entrance_pupil_z_mm"], Value::Null, "no stop, no pupil");
    assert_eq!(info["surfaces"].as_array().map(Vec::len), Some(2));
    assert_eq!(info["line"], "d");
}

#[test]
fn f_number_and_focus_are_set() {
    let name = "zeiss-biotar-50-f1.4";
    let wide = info(name, &[]);
    let set = info(name, &["--f-number", "f/4", "--focus", "2 m"]);
    assert!((figure(&set, "f_number") - 4.0).abs() < 1e-9);
    // In air the sine condition of a well corrected lens holds to some per cent: D = f / N.
    assert!((figure(&set, "entrance_pupil_diameter_mm") * 4.0 / figure(&set, "efl_mm") - 1.0).abs() < 0.02);
    assert!(figure(&set, "image_distance_mm") > figure(&wide, "image_distance_mm") + 1.0);
    assert_eq!(figure(&set, "efl_mm"), figure(&wide, "efl_mm"));
    // Blue light bends more in every single glass, and the lens is corrected: less than a per cent is left.
    let (blue, red) =
        (figure(&info(name, &["--line", "F"]), "efl_mm"), figure(&info(name, &["--line", "C"]), "efl_mm"));
    assert!(blue != red && (blue / red - 1.0).abs() < 0.01, "{blue} {red}");
}

#[test]
fn people_get_a_table() {
    let table = good(&["lens", "info", "zeiss-biotar-50-f1.4"]);
    for word in ["Biotar", "1927", "US 1786916", "focal length", "SCHOTT/BAF9", "stop", "f/1.4"] {
        assert!(table.contains(word), "{word}: {table}");
    }
    assert!(!table.contains('\u{1b}'));
}

#[test]
fn wrong_settings_are_told() {
    for (arguments, word) in [
        (&["zeiss-biotar-50-f1.5"][..], "zeiss-biotar-50-f1.4"),
        (&["zeiss-biotar-50-f1.4", "--f-number", "f/0.9"], "faster than the lens"),
        (&["zeiss-biotar-50-f1.4", "--focus", "1 mm"], "has a real image"),
        (&["zeiss-biotar-50-f1.4", "--focus", "2 s"], "expected a positive length"),
        (&["zeiss-biotar-50-f1.4", "--line", "q"], "no such spectral line"),
        (&["zeiss-biotar-50-f1.4", "--nd", "--line", "d"], "cannot be used with"),
    ] {
        let output = run(&["lens", "info"].into_iter().chain(arguments.iter().copied()).collect::<Vec<_>>());
        let message = text(&output.stderr);
        assert_eq!(output.status.code(), Some(2), "{message}");
        assert!(message.contains(word), "{arguments:?}: {message}");
    }
}
