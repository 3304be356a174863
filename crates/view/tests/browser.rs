//! The page in a real browser: Chromium, driven by `playwright-core`, which `.ci/run` installs where it can be had.

use spectra_core::Isa;
use spectra_plugins as _;
use spectra_view::{View, view};
use std::process::Command;
use std::sync::mpsc;
use std::time::Duration;

const SCENE: &str = "spectra: 1\nsource: {kind: chart, chart: color-checker, distance: 2 m, luminance: 300 cd/m2, width: fill}\n\
    lens: {file: zeiss-biotar-50-f1.4, f-number: f/2, focus: 2 m}\nimager: {kind: film, format: 135, resolution: [60, 40]}\n\
    film: {stock: kodak-tri-x-400, metering: average}\nrender: {samples: 4}\noutput: [png]\n";

/// The folder with `node_modules/playwright-core`, and the browser; else what is missing.
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
    let (folder, chromium) = match browser() {
        Ok(found) => found,
        Err(why) => return println!("skipped: {why}"),
    };
    let scene = tempfile::tempdir().expect("a folder");
    let file = scene.path().join("scene.yaml");
    std::fs::write(&file, SCENE).expect("written");
    let (tell, hear) = mpsc::channel();
    let own = View { scene: file.clone(), overrides: Vec::new(), port: 0, isa: Isa::detect(), threads: 2 };
    // The thread ends with the process.
    std::thread::spawn(move || view(own, |address| tell.send(address.to_owned()).expect("heard")));
    let address = hear.recv_timeout(Duration::from_secs(60)).expect("an address");
    let script = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/browser.mjs");
    let output = Command::new("node").args([script, &folder, &chromium, &address]).output().expect("node");
    let said = String::from_utf8_lossy(&output.stdout).into_owned() + &String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{said}");
    println!("{said}");
    let saved = std::fs::read_to_string(&file).expect("a file");
    assert_eq!(saved, SCENE.replace("f/2, focus: 2 m", "f/5.6, focus: 2 m, aperture: {shape: iris, blades: 6}"));
}
