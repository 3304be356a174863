//! Writes a sorted table of the repository's data files, with their bytes compiled in.
//!
//! Bundled are all files under `spectra/`, all under `lenses/`, and the YAML files under `scenes/` with their pictures. Hidden
//! files and editors' backups are left out. Builds for WebAssembly also leave out large pictures, because a page must load before
//! anything is visible, and the scenes that it offers have none.

use std::env;
use std::fmt::Write as _;
use std::fs;
use std::path::{Path, PathBuf};

/// Largest picture bundled for a web page, bytes.
const MOST_OF_A_PAGE: u64 = 200_000;
/// Folders of the repository, and the extensions taken from each (none: every file).
const FOLDERS: [(&str, &[&str]); 3] = [("spectra", &[]), ("lenses", &[]), ("scenes", &["yaml", "yml", "exr", "svg"])];

fn collect(folder: &Path, endings: &[&str], found: &mut Vec<PathBuf>) {
    println!("cargo:rerun-if-changed={}", folder.display());
    let Ok(entries) = fs::read_dir(folder) else {
        return; // a checkout without this folder bundles nothing from it
    };
    for entry in entries.filter_map(Result::ok) {
        let path = entry.path();
        let name = entry.file_name().to_string_lossy().into_owned();
        if name.starts_with('.') || name.ends_with('~') || name.ends_with(".tmp") {
            continue;
        }
        if path.is_dir() {
            collect(&path, endings, found);
            continue;
        }
        let ending = path.extension().and_then(|e| e.to_str()).unwrap_or_default();
        if endings.is_empty() || endings.contains(&ending) {
            println!("cargo:rerun-if-changed={}", path.display());
            found.push(path);
        }
    }
}

fn main() {
    println!("cargo:rerun-if-changed=build.rs");
    // The canonical path is the same through any link to this crate, so the crate is not built once more.
    let root = fs::canonicalize("../..").expect("this crate lies in a repository");
    let mut files = Vec::new();
    for (folder, endings) in FOLDERS {
        let mut found = Vec::new();
        collect(&root.join(folder), endings, &mut found);
        if env::var("CARGO_CFG_TARGET_FAMILY").is_ok_and(|family| family == "wasm") {
            let is_picture = |path: &PathBuf| path.extension().is_some_and(|ending| ending == "exr");
            found.retain(|path| !is_picture(path) || fs::metadata(path).is_ok_and(|of| of.len() <= MOST_OF_A_PAGE));
        }
        for path in found {
            let inside = path.strip_prefix(&root).expect("collected below the root");
            let name: Vec<String> = inside.components().map(|c| c.as_os_str().to_string_lossy().into_owned()).collect();
            files.push((name.join("/"), path));
        }
    }
    files.sort();

    let mut code = String::from("static FILES: &[(&str, &[u8])] = &[\n");
    for (name, path) in &files {
        let path = path.to_str().expect("paths of the repository are UTF-8");
        writeln!(code, "    ({name:?}, include_bytes!({path:?})),").expect("writing to a string");
    }
    code.push_str("];\n");
    let out = PathBuf::from(env::var_os("OUT_DIR").expect("cargo sets it"));
    fs::write(out.join("files.rs"), code).expect("OUT_DIR can be written");
}
