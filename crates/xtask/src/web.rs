//! The folder of the page without a server: the page of `spectra view`, the engine as a WebAssembly module, and the scripts that connect
//! them.

use crate::{TaskResult, link};
use serde_json::{Map, Value, json};
use std::fs;
use std::path::Path;
use std::process::Command;

const TARGET: &str = "wasm32-unknown-unknown";
/// Files of the page that are copied unchanged.
const PAGE: [&str; 4] = ["view/page/page.js", "view/page/page.css", "web/page/serverless.js", "web/page/worker.js"];
/// Scenes of the page whose bits are compared with those of the command.
const SCENES: [&str; 14] = [
    "biotar-ortho",
    "biotar-color",
    "biotar-color-negative",
    "biotar-double-x",
    "biotar-panchromatic-plate",
    "biotar-reversal",
    "biotar-three-strip",
    "biotar-trix",
    "bokeh-star",
    "depth-still-life",
    "gray-card",
    "low-pass",
    "sensor-biotar",
    "tilted",
];
/// Settings with which these scenes are rendered for the comparison.
const SET: [&str; 2] = ["imager.resolution=[300, 200]", "render.samples=32"];
const SAMPLES: u32 = 32;

/// Builds the folder of the page without a server.
///
/// # Errors
/// Cargo fails, the toolchain lacks the WebAssembly target, a scene does not render, or a file cannot be written.
pub fn web(folder: &Path) -> TaskResult {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let target = std::env::var_os("CARGO_TARGET_DIR").map_or_else(|| root.join("target"), Into::into);
    let module = module(&root, &target)?;
    let known = fingerprints(&root, &target)?;
    fs::create_dir_all(folder).map_err(|error| said(folder, &error))?;
    let write = |name: &str, bytes: &[u8]| {
        let path = folder.join(name);
        fs::write(&path, bytes).map_err(|error| said(&path, &error))
    };
    for name in PAGE {
        let name = Path::new(name);
        write(&name.file_name().unwrap_or_default().to_string_lossy(), &read(&root.join("crates").join(name))?)?;
    }
    let page = String::from_utf8_lossy(&read(&root.join("crates/view/page/index.html"))?).into_owned();
    let joined = page.replace("<script type=\"module\" src=\"page.js\">", JOINED);
    if joined == page {
        return Err("the page has no script `page.js` before which the engine's script could be inserted".into());
    }
    write("index.html", joined.as_bytes())?;
    write("fingerprints.json", known.to_string().as_bytes())?;
    write("spectra.wasm", &module)?;
    println!("{}: {:.1} MB of engine; any web server can serve it", folder.display(), module.len() as f64 / 1e6);
    Ok(())
}

/// Scripts of the page without a server: the one that stands in for the server comes before the page's own.
const JOINED: &str =
    "<script type=\"module\" src=\"serverless.js\"></script>\n<script type=\"module\" src=\"page.js\">";

fn said(path: &Path, error: &std::io::Error) -> String {
    format!("{}: {error}", path.display())
}

fn read(path: &Path) -> TaskResult<Vec<u8>> {
    Ok(fs::read(path).map_err(|error| said(path, &error))?)
}

fn run(command: &mut Command) -> TaskResult {
    let name = command.get_program().to_string_lossy().into_owned();
    let status = command.status().map_err(|error| format!("{name}: {error}"))?;
    if status.success() { Ok(()) } else { Err(format!("{name} failed: {status}").into()) }
}

fn cargo(root: &Path) -> Command {
    let mut cargo = Command::new(std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into()));
    cargo.current_dir(root);
    cargo
}

/// Builds the engine as a WebAssembly module and returns its bytes.
fn module(root: &Path, target: &Path) -> TaskResult<Vec<u8>> {
    let own = std::env::current_exe().map_err(|error| format!("cannot find the path of this program: {error}"))?;
    let mut cargo = cargo(root);
    cargo.env(link::ASKED, link::own()?).env("CARGO_PROFILE_RELEASE_STRIP", "true");
    cargo.args(["rustc", "--locked", "--release", "--package", "spectra-web", "--lib", "--target", TARGET]);
    cargo.args(["--crate-type", "cdylib", "--", &format!("-Clinker={}", own.display()), "-Clinker-flavor=wasm-ld"]);
    run(&mut cargo).map_err(|why| format!("{why}; if the target is missing: rustup target add {TARGET}"))?;
    read(&target.join(TARGET).join("release/spectra_web.wasm"))
}

/// Renders the scenes with the command and returns their fingerprints by name, the settings `set` and `samples` to render them with, and
/// the number of stages.
fn fingerprints(root: &Path, target: &Path) -> TaskResult<Value> {
    run(cargo(root).args(["build", "--locked", "--release", "--bin", "spectra"]))?;
    let program = target.join("release/spectra").with_extension(std::env::consts::EXE_EXTENSION);
    let folder = target.join("web-fingerprints");
    fs::create_dir_all(&folder).map_err(|error| said(&folder, &error))?;
    let mut scenes = Map::new();
    for scene in SCENES {
        let mut command = Command::new(&program);
        command.args(["run", scene, "--quiet", "--output"]).arg(&folder);
        for text in SET {
            command.args(["--set", text]);
        }
        run(&mut command)?;
        let report = folder.join(scene).with_extension("json");
        let report: Value = serde_json::from_slice(&read(&report)?).map_err(|error| said(&report, &error.into()))?;
        scenes.insert(scene.to_owned(), report["fingerprint"].clone());
    }
    let listed = Command::new(&program).args(["list", "--json"]).output().map_err(|error| said(&program, &error))?;
    let listed: Vec<Value> = serde_json::from_slice(&listed.stdout).map_err(|error| said(&program, &error.into()))?;
    // Every registered stage has documentation; data that can be named has none.
    let stages = listed.iter().filter(|item| !item["documentation"].is_null()).count();
    Ok(json!({"set": SET, "samples": SAMPLES, "scenes": scenes, "stages": stages}))
}
