//! Terms of the program and of what is bundled in it.

use crate::console;
use crate::outcome::{DONE, Outcome};
use std::fmt::Write;

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
    out
}
