//! Tests that all faults of a scene are reported at once, each with place and hint.

use crate::common::{answer_in, run, spectra, text};
use serde_json::Value;

const LENS: &str = "\
name: A lens with two faults
reference-line: d
surfaces:
  - {kind: sphere, radius: 50, thickness: -5, glass: SCHOTT/N-BK7, semi-diameter: 10}
  - {kind: stop, thickness: 1}
  - {kind: sphere, radius: -50, thickness: 3, glass: SCHOTT/N-BKK7, semi-diameter: 10}
  - {kind: sphere, radius: 500, thickness: 48, semi-diameter: 10}
";

/// A scene with six faults, spread over its sections.
const APART: &str = "\
spectra: 1
source:
  kind: picture
  file: no-such-picture.png
  distance: 2 m
  width: 1.5 m
  luminance: 300 cd/m2
wavelengths: {kind: source-times-respnse}
lens: {file: broken.yaml, f-number: f/2, focus: 2 m}
imager: {kind: film, format: 135, resolution: [many, 640]}
film: {stock: ilford-ortho-plus, exposure: 1/60 s}
render: {sampels: 16}
";
const APART_PLACES: [(&str, &str); 6] = [
    ("six.yaml:4:9", "no-such-picture.png"),
    ("six.yaml:8:21", "source-times-respnse"),
    ("broken.yaml:4:43", "negative"),
    ("broken.yaml:6:54", "SCHOTT/N-BKK7"),
    ("six.yaml:10:48", "many"),
    ("six.yaml:12:10", "sampels"),
];

/// A scene with six faults, in which a fault in a section could hide a fault in what the section names.
const TOGETHER: &str = "\
spectra: 1
source:
  kind: picture
  file: no-such-picture.png
  distanse: 2 m
  distance: 2 m
  width: 1.5 m
wavelengths: {kind: source-times-respnse}
lens: {file: broken.yaml, f-number: fast}
imager: {kind: film, format: 135, resolution: [96, 64]}
film: {stock: ilford-ortho-plus, exposure: 1/60 s}
";
const TOGETHER_PLACES: [(&str, &str); 6] = [
    ("six.yaml:4:9", "no-such-picture.png"),
    ("six.yaml:5:3", "distanse"),
    ("six.yaml:8:21", "source-times-respnse"),
    ("six.yaml:9:37", "fast"),
    ("broken.yaml:4:43", "negative"),
    ("broken.yaml:6:54", "SCHOTT/N-BKK7"),
];

fn folder(scene: &str) -> tempfile::TempDir {
    let folder = tempfile::tempdir().expect("a folder");
    std::fs::write(folder.path().join("six.yaml"), scene).expect("written");
    std::fs::write(folder.path().join("broken.yaml"), LENS).expect("written");
    folder
}

fn assert_all_six(scene: &str, places: [(&str, &str); 6]) {
    let folder = folder(scene);
    for command in ["run", "check"] {
        let output = answer_in(folder.path(), &[command, "six.yaml"]);
        let message = text(&output.stderr);
        assert_eq!(output.status.code(), Some(2), "{message}");
        for (place, word) in places {
            assert!(message.contains(place) && message.contains(word), "{place} {word}: {message}");
        }
        assert!(!message.contains('\u{1b}'), "colors in a pipe");
        assert!(!folder.path().join("out").exists(), "something was rendered");
    }
    let output = answer_in(folder.path(), &["check", "six.yaml", "--json"]);
    assert_eq!(output.status.code(), Some(2));
    let report: Value = serde_json::from_slice(&output.stdout).expect("JSON");
    assert_eq!(report["scenes"][0]["ok"], false);
    let faults = report["scenes"][0]["faults"].as_array().expect("a list");
    assert_eq!(faults.len(), 6, "{report:#}");
    for (place, word) in places {
        let fault = faults.iter().find(|fault| {
            let file = fault["file"].as_str().expect("a file").trim_start_matches("./");
            format!("{file}:{}:{}", fault["line"], fault["column"]) == place
        });
        let fault = fault.unwrap_or_else(|| panic!("{place}: {report:#}"));
        assert!(fault["message"].as_str().is_some_and(|message| message.contains(word)), "{fault:#}");
        assert!(fault["hint"].as_str().is_some_and(|hint| !hint.is_empty()), "no hint: {fault:#}");
    }
}

#[test]
fn six_faults_are_shown_at_once_each_with_place_and_hint() {
    assert_all_six(APART, APART_PLACES);
}

#[test]
fn a_fault_in_a_section_hides_no_other() {
    assert_all_six(TOGETHER, TOGETHER_PLACES);
}

#[test]
fn run_gives_the_faults_to_programs_too() {
    let folder = folder(APART);
    let output = answer_in(folder.path(), &["run", "six.yaml", "--json"]);
    assert_eq!(output.status.code(), Some(2));
    let stdout = text(&output.stdout);
    let event: Value = serde_json::from_str(stdout.trim_end()).expect("one line of JSON");
    assert_eq!(event["event"], "error");
    assert_eq!(event["faults"].as_array().map(Vec::len), Some(6));
}

#[test]
fn check_looks_at_every_scene() {
    let folder = folder(APART);
    std::fs::write(folder.path().join("empty.yaml"), "").expect("written");
    let output = answer_in(folder.path(), &["check", "six.yaml", "missing.yaml", "empty.yaml"]);
    let message = text(&output.stderr);
    assert_eq!(output.status.code(), Some(2));
    for word in ["six.yaml:4:9", "missing.yaml", "empty.yaml", "3 of 3"] {
        assert!(message.contains(word), "{word}: {message}");
    }
}

#[test]
fn bad_arguments_are_told_with_code_2() {
    for (arguments, word) in [
        (&["run"][..], "SCENE"),
        (&["run", "a.yaml", "--sampels", "3"], "--samples"),
        (&["run", "a.yaml", "--threads", "0"], "1..=1024"),
        (&["run", "a.yaml", "--time-limit", "3 m"], "expected a positive time"),
        (&["run", "no-such-scene.yaml"], "no-such-scene.yaml"),
        (&["run", "."], "directory"),
        (&["list", "sorce"], "did you mean `source`?"),
        (&["frobnicate"], "frobnicate"),
    ] {
        let output = run(arguments);
        let message = text(&output.stderr);
        assert_eq!(output.status.code(), Some(2), "{arguments:?}: {message}");
        assert!(message.contains(word), "{arguments:?}: {message}");
    }
}

#[test]
fn overrides_are_checked_like_the_scene() {
    let scene = crate::common::repository("scenes/gray-card.yaml");
    for (set, word) in [
        ("render.seed=x", "render.seed"),
        ("render.sede=1", "did you mean `seed`?"),
        ("render.seed", "`=` is missing"),
        ("render.seed=[", "--set render.seed=["),
        ("imager.resolution=[0, 10]", "imager.resolution"),
    ] {
        let output = run(&["check", crate::common::shown(&scene), "--set", set]);
        let message = text(&output.stderr);
        assert_eq!(output.status.code(), Some(2), "{set}: {message}");
        assert!(message.contains(word) && !message.contains("panicked"), "{set}: {message}");
    }
}

#[test]
fn an_unknown_instruction_set_is_told() {
    let output = spectra().env("SPECTRA_ISA", "sse9").args(["list"]).output().expect("the program starts");
    assert_eq!(output.status.code(), Some(2));
    let message = text(&output.stderr);
    assert!(message.contains("SPECTRA_ISA") && message.contains("baseline"), "{message}");
}

/// `null` removes a key wherever it is written, as the guide says; removing a key that does not exist is a fault.
#[test]
fn null_takes_a_key_away() {
    let check = |set: &[&str]| {
        let set = set.iter().flat_map(|set| ["--set", set]);
        run(&["check", "biotar-trix"].into_iter().chain(set).collect::<Vec<_>>())
    };
    let unmetered = check(&["film.metering=null", "film.exposure=1/100 s"]);
    assert!(unmetered.status.success(), "{}", text(&unmetered.stderr));
    for (set, word) in [
        ("film.metering=", "`film.metering` has no value"),
        ("lens.f-number=", "`--set lens.f-number=null` leaves the key out"),
        ("film.metring=null", "unknown key `metring`"),
        ("source.distance=null", "missing key `distance`"),
    ] {
        let output = check(&[set]);
        assert_eq!(output.status.code(), Some(2), "{set}");
        assert!(text(&output.stderr).contains(word), "{set}: {}", text(&output.stderr));
    }
}
