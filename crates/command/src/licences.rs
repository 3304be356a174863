//! Terms of the program and of what is bundled in it.

use crate::console;
use crate::outcome::{DONE, Outcome};
use std::fmt::Write;

/// The crates that are linked in, and their licences; written by `xtask/notices.py`.
const NOTICES: &str = include_str!("notices.txt");

/// Shows them.
pub(crate) fn show() -> Outcome {
    console::out(&text())?;
    Ok(DONE)
}

fn text() -> String {
    let mut out = format!(
        "spectra {}: {}\n\nBundled data, by licence and source:\n",
        crate::version::VERSION,
        env!("CARGO_PKG_LICENSE")
    );
    for entry in spectra_data::licences() {
        // Writing to a String cannot fail.
        let _ = write!(out, "\n{}\n  {}\n", entry.licence, entry.source);
        for file in &entry.files {
            let _ = writeln!(out, "    {file}");
        }
    }
    let _ = write!(
        out,
        "\nThe Rust standard library: MIT OR Apache-2.0, https://www.rust-lang.org\n\nCrates in this program, with their \
         notices (a program made by `spectra build` holds its plugins beside them, under their own terms):\n\n{}",
        NOTICES.split_once('\n').map_or(NOTICES, |(_, rest)| rest.trim_start())
    );
    out
}
