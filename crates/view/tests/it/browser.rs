//! Tests of the page in a real browser: Chromium, driven by `playwright-core`, which `.ci/run` installs if it is available.

use spectra_core::Isa;
use spectra_plugins as _;
use spectra_view::{ViewerSettings, color_tester, view};
use std::process::Command;
use std::sync::mpsc;
use std::time::Duration;

const SCENE: &str = "spectra: 1\nsource: {kind: chart, chart: color-checker, distance: 2 m, luminance: 300 cd/m2, width: fill}\n\
    lens: {file: zeiss-biotar-50-f1.4, f-number: f/2, focus: 2 m}\nimager: {kind: film, format: 135, resolution: [60, 40]}\n\
    film: {stock: kodak-tri-x-400, metering: average}\nrender: {samples: 4}\noutput: [png]\n";

/// Returns the folder with `node_modules/playwright-core` and the path of the browser; the error says what is missing.
fn browser() -> Result<(String, String), String> {
    let folder =
        std::env::var("SPECTRA_PLAYWRIGHT").map_err(|_| "SPECTRA_PLAYWRIGHT names no folder with playwright-core")?;
    if !std::path::Path::new(&folder).join("node_modules/playwright-core").is_dir() {
        return Err(format!("{folder} holds no node_modules/playwright-core"));
    }
    let chromium =
        ["/usr/bin/chromium", "/usr/bin/chromium-browser"].into_iter().find(|path| std::path::Path::new(path).exists());
    let chromium = chromium.ok_or("no Chromium is installed")?;
    Command::new("node").arg("--version").output().map_err(|error| format!("node: {error}"))?;
    Ok((folder, chromium.to_owned()))
}

#[test]
fn a_person_turns_types_saves_and_is_told_what_is_wrong() {
    let scene = tempfile::tempdir().expect("a folder");
    let file = scene.path().join("scene.yaml");
    std::fs::write(&file, SCENE).expect("written");
    let own = ViewerSettings {
        scene: file.clone(),
        stock: None,
        overrides: Vec::new(),
        port: 0,
        isa: Isa::detect(),
        threads: 2,
    };
    if !driven("browser.mjs", |ready| drop(view(own, ready))) {
        return;
    }
    let saved = std::fs::read_to_string(&file).expect("a file");
    assert_eq!(saved, SCENE.replace("f/2, focus: 2 m", "f/5.6, focus: 2 m, aperture: {shape: iris, blades: 6}"));
}

/// Opens a scene and makes this many changes, some with values that are refused.
fn tells_the_truth(scene: &str, changes: u32) {
    let own = ViewerSettings {
        scene: scene.into(),
        stock: None,
        overrides: Vec::new(),
        port: 0,
        isa: Isa::detect(),
        threads: 2,
    };
    driven_with("truth.mjs", &[&changes.to_string()], |ready| drop(view(own, ready)));
}

#[test]
fn no_field_says_what_the_picture_does_not_have() {
    let scene = tempfile::tempdir().expect("a folder");
    let file = scene.path().join("scene.yaml");
    std::fs::write(&file, SCENE).expect("written");
    tells_the_truth(&file.to_string_lossy(), 12);
}

/// Makes 30 changes to each of five scenes, and five to every other one, which takes minutes. `SPECTRA_BROWSER_SCENES`, names separated
/// by commas, restricts it to these scenes.
#[test]
#[ignore = "minutes; a step of .ci/run --all"]
fn no_field_says_what_the_picture_does_not_have_in_any_scene() {
    const MANY: [&str; 5] = ["night-stars", "biotar-ortho", "gray-card", "stops-and-stocks", "portrait-lights"];
    let only = std::env::var("SPECTRA_BROWSER_SCENES").ok();
    let is_asked = |name: &str| only.as_ref().is_none_or(|only| only.split(',').any(|own| own == name));
    let names = spectra_scene::bundled::Bundled::Scene.names();
    for scene in names.iter().filter(|name| !name.contains('/') && is_asked(name)) {
        println!("{scene}");
        tells_the_truth(scene, if MANY.contains(&scene.as_str()) { 30 } else { 5 });
    }
}

/// A short run of random use; `SPECTRA_BROWSER_SECONDS` makes it longer.
#[test]
fn random_use_leaves_neither_errors_nor_threads_behind() {
    let (folder, chromium) = match browser() {
        Ok(found) => found,
        Err(why) => return println!("skipped: {why}"),
    };
    let program = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../../target/debug/spectra");
    // The server runs in a separate process, so that its threads and its memory are the server's alone.
    if !program.exists() {
        return println!("skipped: {} is not built", program.display());
    }
    let scene = tempfile::tempdir().expect("a folder");
    let file = scene.path().join("scene.yaml");
    std::fs::write(&file, SCENE).expect("written");
    let mut server = Command::new(program)
        .args(["view", "--no-open"])
        .arg(&file)
        .stdout(std::process::Stdio::piped())
        .stderr(std::process::Stdio::null())
        .spawn()
        .expect("a server");
    let mut address = String::new();
    let out = server.stdout.take().expect("a pipe");
    std::io::BufRead::read_line(&mut std::io::BufReader::new(out), &mut address).expect("an address");
    let script = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/random.mjs");
    let process = server.id().to_string();
    let seconds = std::env::var("SPECTRA_BROWSER_SECONDS").unwrap_or_else(|_| "10".to_owned());
    let random = [script, &folder, &chromium, address.trim(), &process, &seconds];
    let output = Command::new("node").args(random).output().expect("node");
    let ended = server.try_wait().expect("asked");
    let _ = server.kill();
    let _ = server.wait();
    let said = String::from_utf8_lossy(&output.stdout).into_owned() + &String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success() && ended.is_none(), "{said}");
    println!("{said}");
}

/// Drives a page of what `serve` serves with a script in the folder `tests`, which reports failures. Returns false if there is no browser.
fn driven(script: &str, serve: impl FnOnce(Box<dyn FnOnce(&str)>) + Send + 'static) -> bool {
    driven_with(script, &[], serve)
}

/// Drives a page like [`driven`], with more arguments for the script.
fn driven_with(script: &str, more: &[&str], serve: impl FnOnce(Box<dyn FnOnce(&str)>) + Send + 'static) -> bool {
    let (folder, chromium) = match browser() {
        Ok(found) => found,
        Err(why) => {
            println!("skipped: {why}");
            return false;
        }
    };
    let (tell, hear) = mpsc::channel();
    // The thread ends with the process.
    std::thread::spawn(move || serve(Box::new(move |address: &str| tell.send(address.to_owned()).expect("heard"))));
    let address = hear.recv_timeout(Duration::from_secs(60)).expect("an address");
    let script = format!("{}/tests/{script}", env!("CARGO_MANIFEST_DIR"));
    let output = Command::new("node").args([&script, &folder, &chromium, &address]).args(more).output().expect("node");
    let said = String::from_utf8_lossy(&output.stdout).into_owned() + &String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{said}");
    println!("{said}");
    true
}

/// Checks the types in the comments of the pages' code with `typescript`.
#[test]
fn the_code_of_the_pages_keeps_its_types() {
    let Ok(folder) = std::env::var("SPECTRA_PLAYWRIGHT") else {
        return println!("skipped: SPECTRA_PLAYWRIGHT names no folder with typescript");
    };
    let compiler = std::path::Path::new(&folder).join("node_modules/typescript/bin/tsc");
    if !compiler.is_file() {
        return println!("skipped: {folder} holds no node_modules/typescript");
    }
    let pages = concat!(env!("CARGO_MANIFEST_DIR"), "/page");
    let output = Command::new("node").arg(compiler).args(["--project", pages]).output().expect("node");
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stdout));
}

#[test]
fn the_color_tester_has_the_figures_of_the_command_line_and_labels_that_do_not_overlap() {
    driven("tester.mjs", |ready| drop(color_tester(0, ready)));
}

#[test]
fn a_prism_is_dragged_and_its_rays_grow_and_stop() {
    // The study is served whatever is shown.
    driven("study.mjs", |ready| drop(color_tester(0, ready)));
}
