//! The program as its users run it.
#![allow(dead_code, reason = "each test binary uses its part of this module")]

use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};

/// A command line that starts with `spectra`, with no setting of the tester's own.
pub fn spectra() -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_spectra"));
    command.env_remove("SPECTRA_ISA").env_remove("NO_COLOR").stdin(Stdio::null());
    command
}

/// Runs `spectra` with these arguments.
pub fn run(arguments: &[&str]) -> Output {
    spectra().args(arguments).output().expect("the program starts")
}

/// Standard output of a run that must succeed.
pub fn good(arguments: &[&str]) -> String {
    let output = run(arguments);
    assert!(output.status.success(), "{arguments:?}: {}", text(&output.stderr));
    text(&output.stdout)
}

/// A stream as text.
pub fn text(bytes: &[u8]) -> String {
    String::from_utf8(bytes.to_vec()).expect("the program writes UTF-8")
}

/// A file of the repository.
pub fn repository(path: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join(path)
}

/// A path as an argument.
pub fn shown(path: &Path) -> &str {
    path.to_str().expect("a path of plain letters")
}

/// A lens of the test data, as an argument.
pub fn lens(name: &str) -> String {
    shown(&repository(&format!("tests/data/lenses/{name}.yaml"))).to_owned()
}

/// Rows of a CSV file of the test data, which has no quotes, without the first one.
pub fn rows(name: &str) -> Vec<Vec<String>> {
    let text = std::fs::read_to_string(repository(&format!("tests/data/{name}"))).expect("test data");
    text.lines().skip(1).map(|row| row.split(',').map(str::to_owned).collect()).collect()
}
