//! Licenses of the program, its crates and its bundled data.

use crate::console;
use crate::outcome::{DONE, Outcome};
use std::fmt::Write;

/// Licenses of the crates linked into the program; the file is written by `xtask/notices.py`.
const NOTICES: &str = include_str!("notices.txt");

/// Whether this version of a crate is linked into every build of the program.
pub(crate) fn has(name: &str, version: &str) -> bool {
    let head = format!("{name} {version}:");
    NOTICES.lines().take_while(|line| !line.starts_with("----")).any(|line| line.starts_with(&head))
}

/// Writes all licenses to standard output, those of plugins (`of_plugins`) last.
pub(crate) fn show(of_plugins: &str) -> Outcome {
    console::out(&text(of_plugins))?;
    Ok(DONE)
}

fn text(of_plugins: &str) -> String {
    let mut out = format!(
        "spectra {}: {}\n\nBundled data, by license and source:\n",
        crate::version::VERSION,
        env!("CARGO_PKG_LICENSE")
    );
    for entry in spectra_data::licenses() {
        // Writing to a String cannot fail.
        let _ = write!(out, "\n{}\n  {}\n", entry.license, entry.source);
        for file in &entry.files {
            let _ = writeln!(out, "    {file}");
        }
    }
    let _ = write!(
        out,
        "\nThe Rust standard library: MIT OR Apache-2.0, https://www.rust-lang.org\n\nCrates in this program, with their \
         notices:\n\n{}",
        NOTICES.split_once('\n').map_or(NOTICES, |(_, rest)| rest.trim_start())
    );
    if !of_plugins.is_empty() {
        let _ =
            write!(out, "\nPlugins in this program and the crates they depend on, with their notices:\n\n{of_plugins}");
    }
    out
}
