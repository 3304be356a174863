//! Packs the sources that a build of the program or of a plugin needs: manifests, the lock file, `src/` and `build.rs` of every
//! crate. Tests, benches, examples and documents are left out. The data is left out, too, because the program holds it already.
//!
//! The archive depends only on names and contents, so the same sources give the same bytes anywhere, even if they were unpacked
//! from such an archive.

use std::fs;
use std::io::{self, Write};
use std::path::{Path, PathBuf};

/// Files packed from the root of the repository.
const ROOT: [&str; 5] = ["Cargo.toml", "Cargo.lock", "LICENSE-APACHE", "LICENSE-MIT", "NOTICE"];
/// Folders that hold crates.
const FOLDERS: [&str; 2] = ["crates", "plugins"];
/// Folders inside a crate, and inside `plugins`, that a build does not need.
const LEFT_OUT: [&str; 5] = ["tests", "benches", "examples", "docs", "target"];

fn main() -> io::Result<()> {
    println!("cargo:rerun-if-changed=build.rs");
    // The canonical path is the same through any link to this crate, so the crate is not built once more.
    let root = fs::canonicalize("../..")?;
    let mut files = Vec::new();
    // In a build from a registry nothing surrounds this crate. The archive stays empty, and users of it get an error.
    if root.join("crates/core/Cargo.toml").is_file() && root.join("Cargo.lock").is_file() {
        files.extend(ROOT.map(|name| root.join(name)).into_iter().filter(|path| path.is_file()));
        collect(&root.join("src"), &mut files)?;
        for folder in FOLDERS {
            collect(&root.join(folder), &mut files)?;
        }
    }
    let mut named: Vec<(String, PathBuf)> = files.into_iter().map(|path| (name(&root, &path), path)).collect();
    named.sort();
    let out = PathBuf::from(std::env::var_os("OUT_DIR").expect("cargo sets it"));
    fs::write(out.join("sources.tar.zz"), if named.is_empty() { Vec::new() } else { pack(&named)? })
}

/// Returns the path below the root, with forward slashes.
fn name(root: &Path, path: &Path) -> String {
    let inside = path.strip_prefix(root).expect("collected below the root");
    inside
        .components()
        .map(|c| c.as_os_str().to_str().expect("names of sources are UTF-8"))
        .collect::<Vec<_>>()
        .join("/")
}

/// Collects all files of a folder except hidden files, editors' backups and folders that are left out.
fn collect(folder: &Path, files: &mut Vec<PathBuf>) -> io::Result<()> {
    println!("cargo:rerun-if-changed={}", folder.display());
    for entry in fs::read_dir(folder)? {
        let entry = entry?;
        let name = entry.file_name().to_string_lossy().into_owned();
        let editors = name.starts_with(['.', '#']) || name.ends_with(['~', '#']);
        let endings = [".tmp", ".swp", ".swo", ".orig", ".rej", ".bak"];
        if editors || endings.iter().any(|ending| name.ends_with(ending)) {
            continue;
        }
        let path = entry.path();
        if !path.is_dir() {
            println!("cargo:rerun-if-changed={}", path.display());
            files.push(path);
        } else if !(LEFT_OUT.contains(&name.as_str()) && is_beside_sources(folder)) {
            collect(&path, files)?;
        }
    }
    Ok(())
}

/// Returns whether a folder is the root of a crate, or `plugins`. Deeper inside, a module may be called `tests`.
fn is_beside_sources(folder: &Path) -> bool {
    folder.join("Cargo.toml").is_file() || folder.file_name().is_some_and(|name| name == "plugins")
}

fn pack(files: &[(String, PathBuf)]) -> io::Result<Vec<u8>> {
    let packer = flate2::write::ZlibEncoder::new(Vec::new(), flate2::Compression::new(6));
    let mut archive = tar::Builder::new(packer);
    for (name, path) in files {
        println!("cargo:rerun-if-changed={}", path.display());
        let mut bytes = fs::read(path)?;
        if name == "Cargo.toml" {
            bytes = without_benches(&String::from_utf8(bytes).map_err(io::Error::other)?).into_bytes();
        }
        let mut header = tar::Header::new_gnu();
        header.set_size(bytes.len() as u64);
        header.set_mode(0o644);
        header.set_mtime(0);
        archive.append_data(&mut header, name, &bytes[..])?;
    }
    let mut packer = archive.into_inner()?;
    packer.flush()?;
    packer.finish()
}

/// Returns the manifest without `[[bench]]` sections, because cargo refuses those whose file is missing.
fn without_benches(manifest: &str) -> String {
    let mut kept = String::new();
    let mut in_bench = false;
    for line in manifest.lines() {
        if line.starts_with('[') {
            in_bench = line.trim_end() == "[[bench]]";
        }
        if !in_bench {
            kept.push_str(line);
            kept.push('\n');
        }
    }
    kept
}
