//! Tells the program which commit, compiler and target it was built with.

use std::path::Path;
use std::process::Command;

fn main() {
    println!("cargo::rerun-if-changed=build.rs");
    let rustc = std::env::var("RUSTC").ok().and_then(|rustc| output(&rustc, &["--version"]));
    println!("cargo::rustc-env=SPECTRA_RUSTC={}", rustc.as_deref().unwrap_or("unknown"));
    let target = std::env::var("TARGET").unwrap_or_else(|_| "unknown".to_owned());
    println!("cargo::rustc-env=SPECTRA_TARGET={target}");
    // A build from a package has no repository, so no commit is named.
    if let Some(commit) = commit() {
        println!("cargo::rustc-env=SPECTRA_COMMIT={commit}");
    }
}

fn commit() -> Option<String> {
    let top = output("git", &["rev-parse", "--show-toplevel"])?;
    // Only the repository of this file counts, not one that happens to contain a vendored copy.
    if !Path::new(&top).join("crates/command/build.rs").is_file() {
        return None;
    }
    // Each commit, including those on the current branch, adds a line to this file.
    let log = output("git", &["rev-parse", "--git-path", "logs/HEAD"])?;
    if Path::new(&log).is_file() {
        println!("cargo::rerun-if-changed={log}");
    }
    output("git", &["rev-parse", "--short=12", "HEAD"])
}

fn output(program: &str, arguments: &[&str]) -> Option<String> {
    let output = Command::new(program).args(arguments).output().ok().filter(|o| o.status.success())?;
    let text = String::from_utf8(output.stdout).ok()?;
    Some(text.trim().to_owned()).filter(|text| !text.is_empty())
}
