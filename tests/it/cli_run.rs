//! Tests `spectra run`, from a scene to files, events and exit codes.

use crate::common::{good, repository, run, shown, spectra, text};
use exr::prelude::{ReadChannels, ReadLayers};
use serde_json::Value;
use spectra_core::Isa;
use std::collections::BTreeMap;
use std::io::{BufRead, BufReader, Read};
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

/// Options that make the main scene small and noisy.
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

/// Returns the text attributes of an EXR file.
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
    assert_eq!(names, ["biotar-ortho.exr", "biotar-ortho.json", "biotar-ortho.png"]);

    let report = json(&out.join("biotar-ortho.json"));
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

/// The EXR is the same for any number of threads, batch size and instruction set, in both directions of light.
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
        // The comparison can fail: another seed gives another file.
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
    assert!(folder.path().join("biotar-ortho.json").is_file());
}

#[test]
fn pipes_get_plain_lines() {
    let folder = tempfile::tempdir().expect("a folder");
    let output = spectra().args(tiny(folder.path(), &[])).output().expect("the program starts");
    for stream in [&output.stdout, &output.stderr] {
        assert!(stream.iter().all(|byte| *byte >= b' ' || *byte == b'\n'), "{}", text(stream));
    }
    assert_eq!(text(&output.stdout).lines().filter(|line| line.starts_with("wrote ")).count(), 1);
    assert!(text(&output.stderr).contains("rays/s"));
}

/// Starts a command and waits until it reports progress. Returns `None` if it ends before.
fn begun(command: &mut Command) -> Option<(Child, BufReader<std::process::ChildStdout>)> {
    let mut child = command.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().expect("the program starts");
    let mut events = BufReader::new(child.stdout.take().expect("piped"));
    let mut line = String::new();
    // The first pass has a ray for each of 960 x 640 pixels.
    let rays = |line: &str| serde_json::from_str::<Value>(line).ok().and_then(|event| event["rays"].as_u64());
    while !(line.contains("\"progress\"") && rays(&line).is_some_and(|rays| rays > 2 * 960 * 640)) {
        line.clear();
        if events.read_line(&mut line).expect("UTF-8") == 0 {
            child.wait().expect("it ends");
            return None;
        }
    }
    Some((child, events))
}

/// Returns a command for a render that would take hours.
fn hours(output: &Path) -> Command {
    let mut command = spectra();
    command.args(["run", &ortho(), "--output", shown(output), "--json", "--samples", "4000000"]);
    command
}

/// Starts a render that would take hours and waits until the first pass over its frame is surely complete.
fn endless(output: &Path, more: &[&str]) -> (Child, BufReader<std::process::ChildStdout>) {
    begun(hours(output).args(more)).expect("progress is told before it ends")
}

/// Starts a command with a time limit, s, and returns the limit: the shortest of a few within which this machine begins to trace.
fn limited(mut with: impl FnMut() -> Command) -> (Child, BufReader<std::process::ChildStdout>, f64) {
    let mut within = |limit_s: f64| {
        let (child, events) = begun(with().args(["--time-limit", &format!("{limit_s} s")]))?;
        Some((child, events, limit_s))
    };
    [2.5, 20.0, 200.0].into_iter().find_map(&mut within).expect("progress within minutes")
}

#[cfg(unix)]
fn signal(child: &Child, name: &str) {
    let killed = std::process::Command::new("sh").args(["-c", &format!("kill -{name} {}", child.id())]).status();
    assert!(killed.expect("a shell").success());
}

/// Temporary files of killed runs are removed by the next run into the folder, whichever files they were writing; other files stay.
#[test]
fn what_killed_runs_left_is_swept() {
    let folder = tempfile::tempdir().expect("a folder");
    // No process has this number.
    let [left, other] =
        [".spectra-4294967290-3.tmp", ".other.0007.png.4294967290-12.tmp"].map(|name| folder.path().join(name));
    let stays = folder.path().join(".notes.tmp");
    for path in [&left, &other, &stays] {
        std::fs::write(path, "half of it").expect("written");
    }
    let set = ["--set", "imager.resolution=[12, 8]", "--samples", "1"];
    let said = run(&[&["run", "gray-card", "--output", shown(folder.path())][..], &set].concat());
    assert!(said.status.success(), "{}", text(&said.stderr));
    assert!(!left.exists() && !other.exists() && stays.exists());
}

/// The exit code is 128 plus the number of the signal, as shells and batch systems do it. Every signal keeps the light traced so far.
#[cfg(unix)]
#[test]
fn exit_codes_tell_signals_apart() {
    for (name, code) in [("TERM", 143), ("HUP", 129)] {
        let folder = tempfile::tempdir().expect("a folder");
        let (mut child, mut events) = endless(folder.path(), &[]);
        signal(&child, name);
        let mut rest = String::new();
        events.read_to_string(&mut rest).expect("UTF-8");
        assert_eq!(child.wait().expect("it ends").code(), Some(code), "{name}");
        assert!(folder.path().join("biotar-ortho.exr").is_file());
    }
}

/// A second on each of two threads is enough to save the light traced so far, however long other programs occupy the processors.
#[cfg(unix)]
#[test]
fn ctrl_c_keeps_what_there_is_within_a_second() {
    let folder = tempfile::tempdir().expect("a folder");
    let (mut child, mut events) = endless(folder.path(), &[]);
    let begun = (Instant::now(), processor_s(child.id()));
    signal(&child, "INT");
    let mut rest = String::new();
    events.read_to_string(&mut rest).expect("UTF-8");
    // Measures how long the process worked, without waiting for occupied processors. If the system does not tell, a minute is the
    // limit.
    let worked = processor_s(child.id()).zip(begun.1).map(|(end, begin)| end - begin);
    let status = child.wait().expect("it ends");
    assert_eq!(status.code(), Some(130));
    assert!(worked.is_none_or(|seconds| seconds < 2.0), "{worked:?} s of work on two threads");
    assert!(begun.0.elapsed() < Duration::from_secs(60));
    assert!(rest.contains("\"interrupted\":true"), "{rest}");
    let report = json(&folder.path().join("biotar-ortho.json"));
    assert_eq!(report["partial"], true);
    assert!(report["rays"].as_u64().is_some_and(|rays| rays > 0));
    assert!(attributes(&folder.path().join("biotar-ortho.exr")).contains_key("spectra:partial"));
    assert!(folder.path().join("biotar-ortho.png").is_file());
}

/// Returns the processor time of all threads of a process so far, s, even if it ended and was not waited for. Returns `None` if the
/// system does not tell.
#[cfg(unix)]
fn processor_s(process: u32) -> Option<f64> {
    /// Linux reports times to programs in hundredths of a second (`man 5 proc`).
    const TICKS_PER_S: f64 = 100.0;
    let stat = std::fs::read_to_string(format!("/proc/{process}/stat")).ok()?;
    let figures: Vec<&str> = stat.rsplit_once(')')?.1.split_whitespace().collect();
    let ticks = |at: usize| figures.get(at)?.parse::<f64>().ok();
    Some((ticks(11)? + ticks(12)?) / TICKS_PER_S)
}

/// An incomplete picture does not take the name of a file that may be complete.
#[cfg(unix)]
#[test]
fn ctrl_c_leaves_files_that_are_there() {
    let folder = tempfile::tempdir().expect("a folder");
    let at = |name: &str| folder.path().join(name);
    std::fs::write(at("biotar-ortho.png"), "an hour's work").expect("written");
    let (mut child, mut events) = endless(folder.path(), &[]);
    signal(&child, "INT");
    let mut rest = String::new();
    events.read_to_string(&mut rest).expect("UTF-8");
    assert_eq!(child.wait().expect("it ends").code(), Some(130));
    assert!(rest.contains("biotar-ortho.png` was not overwritten"), "{rest}");
    assert_eq!(std::fs::read(at("biotar-ortho.png")).expect("there"), b"an hour's work");
    for name in ["biotar-ortho.partial.exr", "biotar-ortho.partial.png", "biotar-ortho.partial.json"] {
        assert!(at(name).is_file() && rest.contains(name), "{name}: {rest}");
    }
    assert!(!at("biotar-ortho.exr").exists());
}

#[test]
fn a_time_limit_ends_in_a_partial_picture_and_no_error() {
    let folder = tempfile::tempdir().expect("a folder");
    let (mut child, mut events, limit_s) = limited(|| hours(folder.path()));
    let mut rest = String::new();
    events.read_to_string(&mut rest).expect("UTF-8");
    assert_eq!(child.wait().expect("it ends").code(), Some(0));
    assert!(rest.contains("\"interrupted\":false") && rest.contains("\"partial\":true"), "{rest}");
    let report = json(&folder.path().join("biotar-ortho.json"));
    assert_eq!(report["partial"], true);
    let seconds = report["seconds"].as_f64().expect("a number");
    assert!((0.2..limit_s + 0.1).contains(&seconds), "{seconds}");
}

/// Before the first pass over the frame there is nothing to write: the program says so, fails and leaves no folder behind.
#[test]
fn a_time_limit_that_is_too_short_says_so() {
    let folder = tempfile::tempdir().expect("a folder");
    let out = folder.path().join("out");
    let output = spectra().args(tiny(&out, &["--time-limit", "1 us"])).output().expect("the program starts");
    let said = text(&output.stderr);
    assert_eq!(output.status.code(), Some(1), "{said}");
    assert!(
        said.contains("is too short for a picture: preparation takes longer than that; nothing was written"),
        "{said}"
    );
    assert!(!out.exists());
    // Of a series, nothing is finished either.
    let series = ["run", "focus-pull", "--output", shown(&out), "--time-limit", "1 us"];
    let output = spectra().args(series).output().expect("the program starts");
    assert_eq!(output.status.code(), Some(1), "{}", text(&output.stderr));
    assert!(!out.exists());
}

/// A picture that a time limit ends takes the place of one that an earlier limit ended, but not of a finished one.
#[test]
fn a_time_limit_replaces_partial_pictures_only() {
    let folder = tempfile::tempdir().expect("a folder");
    let at = |name: &str| folder.path().join(name);
    let limit = |limit_s: f64| {
        let mut command = hours(folder.path());
        // Snapshots that are due all the time, in the first pass, too, change nothing about that.
        let options = ["--time-limit", &format!("{limit_s} s"), "--snapshot", "1 ms"];
        command.args(options).output().expect("the program starts")
    };
    // The shortest limit of a few within which this machine has a picture.
    let found = [3.0, 20.0, 200.0].into_iter().find(|limit_s| limit(*limit_s).status.code() == Some(0));
    let limit_s = found.expect("a picture within minutes");
    let first = std::fs::metadata(at("biotar-ortho.png")).expect("a picture").modified().expect("a time");
    assert_eq!(limit(limit_s).status.code(), Some(0));
    assert!(std::fs::metadata(at("biotar-ortho.png")).expect("a picture").modified().expect("a time") > first);
    good(&tiny(folder.path(), &[]).iter().map(String::as_str).collect::<Vec<_>>());
    let finished = std::fs::read(at("biotar-ortho.png")).expect("a picture");
    let output = limit(limit_s);
    assert!(text(&output.stdout).contains("was not overwritten"), "{}", text(&output.stdout));
    assert_eq!(std::fs::read(at("biotar-ortho.png")).expect("there"), finished);
    assert!(at("biotar-ortho.partial.png").is_file() && at("biotar-ortho.partial.json").is_file());
}

/// A snapshot shows the whole frame while it is traced, and is gone when the picture is written.
#[cfg(unix)]
#[test]
fn snapshots_are_written_and_removed() {
    let folder = tempfile::tempdir().expect("a folder");
    let at = |name: &str| folder.path().join(name);
    let (mut child, mut events) = endless(folder.path(), &["--snapshot", "300 ms"]);
    let mut line = String::new();
    while !line.contains("\"snapshot\"") {
        line.clear();
        assert!(events.read_line(&mut line).expect("UTF-8") > 0, "it ended without a snapshot");
    }
    let names = ["biotar-ortho.partial.exr", "biotar-ortho.partial.png", "biotar-ortho.partial.json"];
    assert!(names.iter().all(|name| at(name).is_file() && line.contains(name)), "{line}");
    assert!(attributes(&at(names[0])).contains_key("spectra:partial"));
    signal(&child, "INT");
    let mut rest = String::new();
    events.read_to_string(&mut rest).expect("UTF-8");
    assert_eq!(child.wait().expect("it ends").code(), Some(130));
    assert!(at("biotar-ortho.png").is_file());
    assert!(names.iter().all(|name| !at(name).exists()), "{rest}");
}

/// A folder that is removed while light is traced is created again.
#[test]
fn a_folder_that_vanishes_is_made_again() {
    let folder = tempfile::tempdir().expect("a folder");
    let out = folder.path().join("a/out");
    let (mut child, mut events, _) = limited(|| hours(&out));
    std::fs::remove_dir_all(folder.path().join("a")).expect("removed");
    let mut rest = String::new();
    events.read_to_string(&mut rest).expect("UTF-8");
    assert_eq!(child.wait().expect("it ends").code(), Some(0), "{rest}");
    for name in ["biotar-ortho.exr", "biotar-ortho.png", "biotar-ortho.json"] {
        assert!(out.join(name).is_file(), "{name}");
    }
}

/// If the output cannot be written any more, the light is saved in the folder for temporary files, and the error says where.
#[test]
fn light_that_cannot_be_written_is_kept_elsewhere() {
    let folder = tempfile::tempdir().expect("a folder");
    let kept = folder.path().join("kept");
    std::fs::create_dir(&kept).expect("made");
    let out = folder.path().join("out");
    let (mut child, mut events, _) = limited(|| {
        let mut command = hours(&out);
        command.env("TMPDIR", &kept).env("TEMP", &kept).env("TMP", &kept);
        command
    });
    // A file takes the place of the folder, so the folder cannot be created again.
    std::fs::remove_dir_all(&out).expect("removed");
    std::fs::write(&out, "").expect("written");
    let mut rest = String::new();
    events.read_to_string(&mut rest).expect("UTF-8");
    assert_eq!(child.wait().expect("it ends").code(), Some(1), "{rest}");
    let files: Vec<_> = std::fs::read_dir(&kept).expect("a folder").map(|e| e.expect("an entry").path()).collect();
    let [file] = &files[..] else { panic!("{files:?}") };
    assert!(rest.contains(shown(file)), "{rest}");
    assert!(attributes(file).contains_key("spectra:partial"));
}

/// A limit on file sizes stands for a full disk. Light that fits as half floats is saved in this form at its own place. If it does
/// not fit at all, the run ends with a message, and no partial file stays.
#[cfg(unix)]
#[test]
fn a_full_disk_leaves_half_floats_or_nothing() {
    let folder = tempfile::tempdir().expect("a folder");
    let elsewhere = folder.path().join("elsewhere");
    std::fs::create_dir(&elsewhere).expect("made");
    let scene = ortho();
    let more = ["--samples", "4", "--set", "imager.resolution=[192, 128]", "--set", "output=[exr]"];
    let run = |name: &str, blocks: Option<u64>| {
        let out = folder.path().join(name);
        // The unit is blocks of 512 bytes.
        let limit = blocks.map_or_else(String::new, |blocks| format!("ulimit -f {blocks}; "));
        let output = std::process::Command::new("sh")
            .args(["-c", &format!("{limit}exec \"$@\""), "sh", env!("CARGO_BIN_EXE_spectra"), "run", &scene])
            .args(["-o", shown(&out)])
            .args(more)
            .env("TMPDIR", &elsewhere)
            .output()
            .expect("a shell");
        (output, out)
    };
    let names = |folder: &Path| {
        let entries = std::fs::read_dir(folder).expect("a folder").map(|entry| entry.expect("an entry").file_name());
        entries.map(|name| name.to_string_lossy().into_owned()).collect::<Vec<_>>()
    };
    let (output, out) = run("whole", None);
    assert!(output.status.success(), "{}", text(&output.stderr));
    let file = out.join("biotar-ortho.exr");
    let (whole, bytes) = (planes(&file), std::fs::metadata(&file).expect("there").len());
    let (output, out) = run("half", Some(bytes * 8 / 10 / 512));
    let file = out.join("biotar-ortho.exr");
    let said = text(&output.stderr);
    assert_eq!(output.status.code(), Some(1), "{said}");
    assert!(said.contains(&format!("the light was saved in {}, in half floats", shown(&file))), "{said}");
    assert_eq!((names(&out), names(&elsewhere)), (vec!["biotar-ortho.exr".to_owned()], vec![]));
    for (name, plane) in planes(&file) {
        for (kept, was) in plane.iter().zip(&whole[&name]) {
            assert!((kept - was).abs() <= 1e-3 * was.abs() + 1e-7, "{name}: {kept} of {was}");
        }
    }
    let (output, out) = run("nothing", Some(4));
    let said = text(&output.stderr);
    assert_eq!(output.status.code(), Some(1), "{said}");
    assert!(said.contains("cannot be written") && said.contains("the light could not be saved"), "{said}");
    assert_eq!((names(&out), names(&elsewhere)), (vec![], vec![]));
}

/// Notes about a scene appear in `check`, `run` and series alike: once, and on one line if several films or lamps share them.
#[test]
fn notes_are_said_once_by_check_run_and_series() {
    let folder = tempfile::tempdir().expect("a folder");
    let scene = folder.path().join("notes.yaml");
    let said = "\
spectra: 1
source: {kind: chart, chart: resolution, distance: 2 m, width: fill, illuminant: 0.5 * helium + argon, luminance: 300 cd/m2}
lens: {file: zeiss-biotar-50-f1.4, f-number: f/1.4, focus: 2 m}
imager: {kind: film, format: 135, resolution: [24, 16]}
film:
  - {name: ortho, stock: ilford-ortho-plus, metering: average, exposure: 1/60 s}
  - {name: pan, stock: kodak-tri-x-400, metering: average, exposure: 1/60 s}
render: {samples: 1}
output: [exr]
";
    let sweep = "sweep: {render.seed: [1, 2]}\n";
    for (command, more) in [("check", ""), ("run", ""), ("check", sweep), ("run", sweep)] {
        std::fs::write(&scene, format!("{said}{more}")).expect("written");
        let out = folder.path().join("out");
        let to: &[&str] = if command == "run" { &["-o", shown(&out)] } else { &[] };
        let output = spectra().args([command, shown(&scene)]).args(to).output().expect("the program starts");
        let said = text(&output.stderr);
        assert!(output.status.success(), "{said}");
        let once = |words: &str| said.matches(words).count() == 1;
        assert!(once("f/1.4 is taken as wide open"), "{command}: {said}");
        assert!(once("the line strengths of `helium` and `argon` were estimated"), "{command}: {said}");
        assert!(once("ortho, pan: the camera meters"), "{command}: {said}");
    }
    let output = spectra().args(["check", "--json", shown(&scene)]).output().expect("the program starts");
    let report: Value = serde_json::from_slice(&output.stdout).expect("JSON");
    assert_eq!(report["scenes"][0]["notes"].as_array().expect("a list").len(), 2, "{report}");
}

/// Two scenes in one folder keep their files apart. An output named as a file writes that file only.
#[test]
fn outputs_bear_the_name_of_their_scene_or_their_own() {
    let folder = tempfile::tempdir().expect("a folder");
    let at = folder.path();
    let names = |folder: &Path| {
        let entries = std::fs::read_dir(folder).expect("a folder");
        let mut names: Vec<String> =
            entries.map(|e| e.expect("an entry").file_name().to_string_lossy().into_owned()).collect();
        names.sort();
        names
    };
    for name in ["a.yaml", "b.yaml"] {
        std::fs::copy(ortho(), at.join(name)).expect("copied");
        let scene = at.join(name);
        let out = at.join("out");
        let more = ["run", shown(&scene), "-o", shown(&out), "-q", "-q"];
        good(&more.into_iter().chain(TINY).collect::<Vec<_>>());
    }
    assert_eq!(names(&at.join("out")), ["a.exr", "a.json", "a.png", "b.exr", "b.json", "b.png"]);
    for name in ["x.png", "x.exr", "x.tif"] {
        let file = at.join("new/folder").join(name);
        let said = spectra().args(tiny(&file, &[])).output().expect("the program starts");
        assert!(said.status.success(), "{}", text(&said.stderr));
        assert!(text(&said.stdout).contains(shown(&file)), "{}", text(&said.stdout));
    }
    assert_eq!(names(&at.join("new/folder")), ["x.exr", "x.png", "x.tif"]);
    let raw = spectra().args(tiny(&at.join("x.dng"), &[])).output().expect("the program starts");
    assert!(raw.status.code() == Some(2) && text(&raw.stderr).contains("no A/D converter"), "{}", text(&raw.stderr));
    let taken = spectra().args(tiny(&at.join("a.yaml"), &[])).output().expect("the program starts");
    assert!(
        taken.status.code() == Some(2) && text(&taken.stderr).contains("written as `.yaml`"),
        "{}",
        text(&taken.stderr)
    );
    std::fs::write(at.join("notes"), "").expect("written");
    let taken = spectra().args(tiny(&at.join("notes"), &[])).output().expect("the program starts");
    assert!(taken.status.code() == Some(1) && text(&taken.stderr).contains("is a file"), "{}", text(&taken.stderr));
    assert_eq!(std::fs::read(at.join("a.yaml")).expect("there"), std::fs::read(ortho()).expect("there"));
}

/// Returns the channels of an EXR file by their names.
fn planes(path: &Path) -> BTreeMap<String, Vec<f32>> {
    let reader = exr::prelude::read().no_deep_data().largest_resolution_level().all_channels().first_valid_layer();
    let image = reader.all_attributes().from_file(path).expect("an EXR");
    let all = image.layer_data.channel_data.list.into_iter();
    all.map(|c| (c.name.to_string(), c.sample_data.values_as_f32().collect())).collect()
}

/// A metered scene writes the exposure that the film got: sample by sample the same light as with that time stated and without a
/// meter. Checked for a plate that sees no red, for panchromatic film and for color film.
#[test]
fn a_metered_scene_is_that_of_the_metered_time() {
    let folder = tempfile::tempdir().expect("a folder");
    for (name, lx_s) in
        [("biotar-blue-plate", None), ("biotar-trix", Some(0.025)), ("biotar-color-negative", Some(0.04))]
    {
        let scene = shown(&repository(&format!("scenes/{name}.yaml"))).to_owned();
        let render = |film: &[&str]| {
            let out = folder.path().join(name);
            let sets = film.iter().flat_map(|set| ["--set", *set]);
            let common = ["run", &scene, "-o", shown(&out)];
            let output = spectra().args(common).args(TINY).args(sets).output().expect("the program starts");
            assert!(output.status.success(), "{}", text(&output.stderr));
            let report = json(&out.join(format!("{name}.json")));
            let exr = out.join(format!("{name}.exr"));
            (report, planes(&exr), attributes(&exr), text(&output.stderr))
        };
        let (report, metered, header, said) = render(&[]);
        let time_s = report["metered_time_s"].as_f64().expect("a number");
        assert_eq!(report["exposure_time_s"].as_f64(), Some(time_s));
        // Compares with the text of the report: parsing it could change the last digit.
        let written = std::fs::read_to_string(folder.path().join(name).join(format!("{name}.json"))).expect("a report");
        let exact = header["spectra:exposure time"].clone();
        assert!(
            written.contains(&format!("\"metered_time_s\": {}", exact.trim_end_matches(" s"))),
            "{exact}: {written}"
        );
        let words = spectra_core::shutter::format_time(time_s);
        assert!(said.contains(&format!("at {words} (metered, average)")), "{words}: {said}");
        // The mean of the meter is 10/S lx s, that of a mid gray.
        let mean = metered["meter"].iter().map(|v| f64::from(*v)).sum::<f64>() / metered["meter"].len() as f64;
        assert!(lx_s.is_none_or(|lx_s| (mean / lx_s - 1.0).abs() < 1e-6), "{mean}");
        let exposure = format!("film.exposure={exact}");
        for film in [&[exposure.as_str(), "film.metering=manual"][..], &[exposure.as_str()]] {
            let (_, stated, header, said) = render(film);
            assert_eq!(header["spectra:exposure time"], exact);
            // With a meter, an exposure time has no effect, and a warning says so.
            assert_eq!(said.contains("`exposure` has no effect"), film.len() == 1, "{said}");
            assert_eq!(stated.len() + film.len() - 1, metered.len());
            for (name, plane) in &stated {
                for (a, b) in plane.iter().zip(&metered[name]) {
                    assert!((a - b).abs() <= 1e-6 * a.abs(), "{name}: {a} against {b}");
                }
            }
        }
    }
}

/// The meter reads the same for any number of threads, batch size and instruction set. It is correct to 1/50 stop in the smallest
/// picture with the fewest samples, for the whole frame and for a spot, backward and forward.
#[test]
fn a_meter_needs_no_samples_of_the_picture() {
    let folder = tempfile::tempdir().expect("a folder");
    let scene = shown(&repository("scenes/biotar-trix.yaml")).to_owned();
    let metered = |isa: &str, more: &[&str]| {
        let common = ["run", &scene, "-q", "-q", "-o", shown(folder.path()), "--set", "output=[exr]"];
        let output = spectra().env("SPECTRA_ISA", isa).args(common).args(more).output().expect("the program starts");
        assert!(output.status.success(), "{}", text(&output.stderr));
        json(&folder.path().join("biotar-trix.json"))["metered_time_s"].as_f64().expect("a number")
    };
    let small = ["--set", "imager.resolution=[48, 32]", "--samples"];
    let cases: [&[&str]; 3] = [&[], &["--set", "film.metering=spot"], &["--set", "render.direction=forward"]];
    for film in cases {
        let with = |isa: &str, more: &[&str]| metered(isa, &[film, &small, more].concat());
        let few = with("", &["1", "--threads", "2"]);
        assert_eq!(few, with("baseline", &["1", "--threads", "1", "--set", "render.batch=40"]));
        let many = with("", &["1024", "--seed", "7"]);
        let stops = (few / many).log2().abs();
        assert!(stops < 0.02, "{film:?}: {stops} stops apart");
    }
    // A spot between the centers of pixels sees nothing, and a warning says so.
    let nowhere = ["--set", "film.metering=spot", "--set", "film.spot={diameter: 0.001}", "-o", shown(folder.path())];
    let output = spectra().args(["run", &scene]).args(TINY).args(nowhere).output().expect("the program starts");
    assert!(text(&output.stderr).contains("meter sees no light where it looks, so the film is exposed for 1 s"));
}

/// A meter that the sun misleads causes a warning with the exposure to write; with it, the sky around the sun becomes a mid gray.
#[test]
fn a_meter_that_a_light_dazzles_says_so() {
    let folder = tempfile::tempdir().expect("a folder");
    let scene = shown(&repository("scenes/sun-biotar.yaml")).to_owned();
    let common = ["run", &scene, "-o", shown(folder.path()), "--samples", "4", "--set", "imager.resolution=[60, 40]"];
    let one = ["--set", "sweep=null", "--set", "film.metering=average", "--set", "film.exposure=null"];
    let output = spectra().args(common).args(one).output().expect("the program starts");
    let told = text(&output.stderr);
    assert!(told.contains("the brightest hundredth of what the camera's meter sees sets the exposure"), "{told}");
    let (_, rest) = told.split_once("too dark; write `exposure: ").expect("what to write");
    let (time, _) = rest.split_once("` instead of `metering`").expect("what to write");
    let spot = ["--set", "sweep=null", "--set", "film.metering=spot", "--set", "film.exposure=null", "-q", "-q"];
    let output = spectra().args(common).args(spot).output().expect("the program starts");
    assert!(output.status.success() && text(&output.stderr).is_empty(), "{}", text(&output.stderr));
    let spot_s = json(&folder.path().join("sun-biotar.json"))["metered_time_s"].as_f64().expect("a number");
    let below: f64 =
        time.strip_prefix("1/").and_then(|t| t.strip_suffix(" s")).and_then(|n| n.parse().ok()).expect("1/N s");
    // Parts of the picture's sky are half as bright, and others twice as bright.
    assert!((spot_s * below).log2().abs() < 1.0, "{time} {spot_s}");
}

/// Several films in one light: the channels of each film have its own exposure time.
#[test]
fn each_film_gets_its_own_time() {
    let folder = tempfile::tempdir().expect("a folder");
    let scene = shown(&repository("scenes/three-films.yaml")).to_owned();
    let all: Vec<&str> = ["run", &scene, "-o", shown(folder.path()), "-q"].into_iter().chain(TINY).collect();
    good(&all);
    let (report, planes) =
        (json(&folder.path().join("three-films.json")), planes(&folder.path().join("three-films.exr")));
    let times = report["metered_time_s"].as_object().expect("by name");
    assert_eq!(&report["exposure_time_s"], &report["metered_time_s"]);
    for (name, speed) in [("ortho", 80.0), ("panchromatic", 400.0), ("color", 250.0)] {
        let meter = &planes[&format!("{name}.meter")];
        let mean = meter.iter().map(|v| f64::from(*v)).sum::<f64>() / meter.len() as f64;
        assert!((mean / (10.0 / speed) - 1.0).abs() < 1e-5, "{name}: {mean}");
    }
    // The meter sees the same light for all films, so times are inversely proportional to speeds.
    let time = |name: &str| times[name].as_f64().expect("a number");
    assert!((time("panchromatic") / time("color") - 250.0 / 400.0).abs() < 1e-5, "{times:?}");
}

#[test]
fn a_reader_that_leaves_costs_no_picture() {
    let folder = tempfile::tempdir().expect("a folder");
    let (mut child, events, _) = limited(|| hours(folder.path()));
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
    for wanted in ["miette ", "clap ", "exr ", "BSD-3-Clause: ", "Unicode-3.0: ", "Zlib: ", "THE SOFTWARE IS PROVIDED"]
    {
        assert!(licenses.contains(wanted), "{wanted}");
    }
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
