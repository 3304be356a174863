//! `spectra run`, from a scene to files, events and exit codes.

mod common;

use common::{good, repository, run, shown, spectra, text};
use exr::prelude::{ReadChannels, ReadLayers};
use serde_json::Value;
use spectra_core::Isa;
use std::collections::BTreeMap;
use std::io::{BufRead, BufReader, Read};
use std::path::Path;
use std::process::{Child, Stdio};
use std::time::{Duration, Instant};

/// The main scene, small and noisy.
const TINY: [&str; 4] = ["--set", "imager.resolution=[48, 32]", "--samples", "4"];

fn ortho() -> String {
    shown(&repository("scenes/biotar-ortho.yaml")).to_owned()
}

fn tiny(output: &Path, more: &[&str]) -> Vec<String> {
    let scene = ortho();
    let arguments = ["run", &scene, "--output", shown(output)].into_iter().chain(TINY).chain(more.iter().copied());
    arguments.map(str::to_owned).collect()
}

fn json(path: &Path) -> Value {
    serde_json::from_slice(&std::fs::read(path).expect("a file")).expect("JSON")
}

/// Text attributes of an EXR.
fn attributes(path: &Path) -> BTreeMap<String, String> {
    let reader = exr::prelude::read().no_deep_data().largest_resolution_level().all_channels().first_valid_layer();
    let image = reader.all_attributes().from_file(path).expect("an EXR");
    let all = image.layer_data.attributes.other.iter().filter_map(|(name, value)| match value {
        exr::meta::attribute::AttributeValue::Text(text) => Some((name.to_string(), text.to_string())),
        _ => None,
    });
    all.collect()
}

#[test]
fn three_files_are_written_and_say_what_they_are() {
    let folder = tempfile::tempdir().expect("a folder");
    let out = folder.path().join("new/out");
    let output = spectra().args(tiny(&out, &["--seed", "7", "--threads", "1"])).output().expect("the program starts");
    assert!(output.status.success(), "{}", text(&output.stderr));
    let mut names: Vec<String> = std::fs::read_dir(&out)
        .expect("a folder")
        .map(|entry| entry.expect("an entry").file_name().to_string_lossy().into_owned())
        .collect();
    names.sort();
    assert_eq!(names, ["biotar-ortho.exr", "biotar-ortho.png", "render.json"]);

    let report = json(&out.join("render.json"));
    assert_eq!(report["rays"], 48 * 32 * 4);
    assert_eq!((&report["seed"], &report["threads"], &report["partial"]), (&7.into(), &1.into(), &false.into()));
    assert!(report["seconds"].as_f64().is_some_and(|s| s > 0.0));
    assert!(report["rays_per_second"].as_f64().is_some_and(|r| r > 0.0));
    let lost = &report["lost"];
    let total = lost["total"].as_u64().expect("a count");
    assert!(total > 0 && total < 48 * 32 * 4, "{lost}");
    let by_cause: u64 = lost["by_cause"].as_object().expect("a map").values().filter_map(Value::as_u64).sum();
    assert_eq!(by_cause, total);
    let by_surface = lost["by_surface"].as_array().expect("a list").iter().map(|row| {
        let causes = row.as_object().expect("a map").iter().filter(|(key, _)| lost["by_cause"].get(key).is_some());
        causes.filter_map(|(_, rays)| rays.as_u64()).sum::<u64>()
    });
    assert_eq!(by_surface.sum::<u64>(), total);

    let attributes = attributes(&out.join("biotar-ortho.exr"));
    assert!(attributes["spectra:scene"].contains("kind: chart"));
    assert!(attributes["spectra:lens"].contains("Biotar") && attributes["spectra:lens patent"].contains("1786916"));
    assert!(attributes.contains_key("spectra:film coordinates") && !attributes.contains_key("spectra:partial"));

    let png = std::fs::read(out.join("biotar-ortho.png")).expect("a picture");
    assert_eq!(&png[..8], b"\x89PNG\r\n\x1a\n");
    let size = |at: usize| u32::from_be_bytes(png[at..at + 4].try_into().expect("four bytes"));
    assert_eq!((size(16), size(20)), (48, 32));
}

/// One EXR, whatever the number of threads, the batch and the instruction set; in both directions of light.
#[test]
fn bits_do_not_depend_on_how_the_work_is_done() {
    let folder = tempfile::tempdir().expect("a folder");
    for direction in ["render.direction=backward", "render.direction=forward"] {
        let render = |name: &str, more: &[&str], isa: &str| {
            let out = folder.path().join(name);
            let mut command = spectra();
            command.args(tiny(&out, &["--set", direction])).args(more).env("SPECTRA_ISA", isa);
            let output = command.output().expect("the program starts");
            assert!(output.status.success(), "{}", text(&output.stderr));
            std::fs::read(out.join("biotar-ortho.exr")).expect("an EXR")
        };
        let wanted = render("reference", &["--threads", "1"], "baseline");
        for isa in Isa::available() {
            assert!(render(isa.name(), &["--threads", "2"], isa.name()) == wanted, "{direction}: {}", isa.name());
        }
        for batch in ["render.batch=64", "render.batch=1000"] {
            assert!(render("batch", &["--threads", "2", "--set", batch], "") == wanted, "{direction}: {batch}");
        }
        // And that the comparison can tell.
        assert!(render("seed", &["--threads", "1", "--seed", "2"], "baseline") != wanted, "{direction}");
    }
}

#[test]
fn json_is_one_event_a_line() {
    let folder = tempfile::tempdir().expect("a folder");
    let output = spectra().args(tiny(folder.path(), &["--json"])).output().expect("the program starts");
    assert!(output.status.success());
    let stdout = text(&output.stdout);
    let events: Vec<Value> = stdout.lines().map(|line| serde_json::from_str(line).expect("JSON")).collect();
    let named = |name: &str| events.iter().filter(|event| event["event"] == name).collect::<Vec<_>>();
    assert_eq!((named("start").len(), named("done").len()), (1, 1));
    let written: Vec<&str> = named("written").iter().filter_map(|event| event["path"].as_str()).collect();
    assert_eq!(written.len(), 3);
    assert!(written.iter().all(|path| Path::new(path).is_file()), "{written:?}");
    assert_eq!(events.last().map(|event| &event["event"]), Some(&"done".into()));
    assert!(output.stderr.is_empty(), "{}", text(&output.stderr));
}

#[test]
fn quiet_is_quiet() {
    let folder = tempfile::tempdir().expect("a folder");
    let output = spectra().args(tiny(folder.path(), &["--quiet"])).output().expect("the program starts");
    assert!(output.status.success());
    assert!(output.stdout.is_empty() && output.stderr.is_empty(), "{}", text(&output.stderr));
    assert!(folder.path().join("render.json").is_file());
}

#[test]
fn pipes_get_plain_lines() {
    let folder = tempfile::tempdir().expect("a folder");
    let output = spectra().args(tiny(folder.path(), &[])).output().expect("the program starts");
    for stream in [&output.stdout, &output.stderr] {
        assert!(stream.iter().all(|byte| *byte >= b' ' || *byte == b'\n'), "{}", text(stream));
    }
    assert_eq!(text(&output.stdout).lines().filter(|line| line.starts_with("wrote ")).count(), 3);
    assert!(text(&output.stderr).contains("rays/s"));
}

/// A render that would take hours, once it has begun.
fn endless(output: &Path, more: &[&str]) -> (Child, BufReader<std::process::ChildStdout>) {
    let scene = ortho();
    let mut child = spectra()
        .args(["run", &scene, "--output", shown(output), "--json", "--samples", "4000000"])
        .args(more)
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .expect("the program starts");
    let mut events = BufReader::new(child.stdout.take().expect("piped"));
    let mut line = String::new();
    while !line.contains("\"progress\"") {
        line.clear();
        assert!(events.read_line(&mut line).expect("UTF-8") > 0, "ended before any progress");
    }
    (child, events)
}

#[cfg(unix)]
#[test]
fn ctrl_c_keeps_what_there_is_within_a_second() {
    let folder = tempfile::tempdir().expect("a folder");
    let (mut child, mut events) = endless(folder.path(), &[]);
    let begun = Instant::now();
    let killed = std::process::Command::new("sh").args(["-c", &format!("kill -INT {}", child.id())]).status();
    assert!(killed.expect("a shell").success());
    let mut rest = String::new();
    events.read_to_string(&mut rest).expect("UTF-8");
    let status = child.wait().expect("it ends");
    assert!(begun.elapsed() < Duration::from_secs(1), "{:?}", begun.elapsed());
    assert_eq!(status.code(), Some(130));
    assert!(rest.contains("\"interrupted\":true"), "{rest}");
    let report = json(&folder.path().join("render.json"));
    assert_eq!(report["partial"], true);
    assert!(report["rays"].as_u64().is_some_and(|rays| rays > 0));
    assert!(attributes(&folder.path().join("biotar-ortho.exr")).contains_key("spectra:partial"));
    assert!(folder.path().join("biotar-ortho.png").is_file());
}

#[test]
fn a_time_limit_ends_in_a_partial_picture_and_no_error() {
    let folder = tempfile::tempdir().expect("a folder");
    let (mut child, mut events) = endless(folder.path(), &["--time-limit", "1500 ms"]);
    let mut rest = String::new();
    events.read_to_string(&mut rest).expect("UTF-8");
    assert_eq!(child.wait().expect("it ends").code(), Some(0));
    assert!(rest.contains("\"interrupted\":false") && rest.contains("\"partial\":true"), "{rest}");
    let report = json(&folder.path().join("render.json"));
    assert_eq!(report["partial"], true);
    let seconds = report["seconds"].as_f64().expect("a number");
    assert!((0.2..1.6).contains(&seconds), "{seconds}");
}

#[test]
fn a_reader_that_leaves_costs_no_picture() {
    let folder = tempfile::tempdir().expect("a folder");
    let (mut child, events) = endless(folder.path(), &["--time-limit", "1500 ms"]);
    drop(events);
    let mut stderr = String::new();
    child.stderr.take().expect("piped").read_to_string(&mut stderr).expect("UTF-8");
    assert_eq!(child.wait().expect("it ends").code(), Some(0), "{stderr}");
    assert!(!stderr.contains("panicked"), "{stderr}");
    assert!(folder.path().join("biotar-ortho.exr").is_file());
}

#[test]
fn a_closed_pipe_ends_lists_quietly() {
    for arguments in [&["list"][..], &["--licenses"], &["lens", "info", "zeiss-biotar-50-f1.4"], &["--help"]] {
        let mut child =
            spectra().args(arguments).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().expect("it starts");
        drop(child.stdout.take());
        let output = child.wait_with_output().expect("it ends");
        assert_eq!((output.status.code(), text(&output.stderr)), (Some(0), String::new()), "{arguments:?}");
    }
}

#[test]
fn a_folder_that_takes_no_files_is_told_before_rendering() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("file");
    std::fs::write(&file, "").expect("written");
    std::fs::create_dir_all(folder.path().join("taken/biotar-ortho.exr")).expect("made");
    for out in [file.join("out"), folder.path().join("taken")] {
        let output = spectra().args(tiny(&out, &["--json"])).output().expect("the program starts");
        assert_eq!(output.status.code(), Some(1));
        assert!(text(&output.stderr).contains("cannot write to"), "{}", text(&output.stderr));
        let stdout = text(&output.stdout);
        assert!(!stdout.contains("\"start\"") && stdout.contains("\"error\""), "{stdout}");
    }
}

#[test]
fn list_and_licenses_show_what_is_there() {
    let stages: Value = serde_json::from_str(&good(&["list", "--json"])).expect("JSON");
    let names: Vec<(&str, &str)> = stages
        .as_array()
        .expect("a list")
        .iter()
        .map(|item| (item["stage"].as_str().expect("text"), item["name"].as_str().expect("text")))
        .collect();
    for wanted in [
        ("source", "chart"),
        ("source", "picture"),
        ("source", "point"),
        ("wavelengths", "source-times-response"),
        ("surface", "sphere"),
        ("imager", "xyz"),
        ("film", "stock"),
        ("lens", "zeiss-biotar-50-f1.4"),
        ("stock", "ilford-ortho-plus"),
    ] {
        assert!(names.contains(&wanted), "{wanted:?}: {names:?}");
    }
    let surfaces = good(&["list", "surface"]);
    assert!(surfaces.contains("sphere") && !surfaces.contains("chart"));
    let licenses = good(&["--licenses"]);
    assert!(licenses.contains("MIT OR Apache-2.0") && licenses.contains("spectra/illuminants/D65.csv"));
}

#[test]
fn help_has_an_example_for_every_command() {
    for command in [&["run"][..], &["check"], &["list"], &["lens", "info"], &["lens", "trace"], &["lens"]] {
        let help = good(&command.iter().copied().chain(["--help"]).collect::<Vec<_>>());
        assert!(help.contains("Example") && help.contains("spectra "), "{help}");
    }
    let version = run(&["--version"]);
    assert!(text(&version.stdout).starts_with("spectra ") && text(&version.stdout).contains("target: "));
}

#[test]
fn the_scenes_of_the_repository_are_good() {
    let folder = repository("scenes");
    let scenes = std::fs::read_dir(&folder).expect("a folder").map(|entry| entry.expect("an entry").path());
    let scenes: Vec<String> = scenes
        .filter(|path| path.extension().is_some_and(|e| e == "yaml"))
        .map(|path| shown(&path).to_owned())
        .collect();
    assert!(scenes.len() >= 4);
    let arguments: Vec<&str> = std::iter::once("check").chain(scenes.iter().map(String::as_str)).collect();
    assert_eq!(good(&arguments).lines().count(), scenes.len());
}
