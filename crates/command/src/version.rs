//! Version of this program: number, commit, compiler, plugins.

use serde_json::{Map, Value, json};
use spectra_core::{Isa, registry};
use std::sync::LazyLock;

/// Version number of this program.
pub(crate) const VERSION: &str = env!("CARGO_PKG_VERSION");

/// Returns the text of `--version`: version, commit, compiler, target, build profile, the widest instruction set of this machine,
/// and plugins.
pub(crate) fn long() -> &'static str {
    static TEXT: LazyLock<String> = LazyLock::new(|| {
        format!(
            "{VERSION}\ncommit: {}\ncompiler: {}\ntarget: {}\nprofile: {}\ninstruction set: {}{}",
            COMMIT.unwrap_or("unknown"),
            env!("SPECTRA_RUSTC"),
            env!("SPECTRA_TARGET"),
            if cfg!(debug_assertions) { "debug" } else { "release" },
            Isa::detect().name(),
            plugins()
        )
    });
    &TEXT
}

/// Commit that this program was built from, or `unknown`.
pub(crate) fn commit() -> &'static str {
    COMMIT.unwrap_or("unknown")
}

/// Returns one line per stage that a plugin adds to this program, with the crate of the plugin.
fn plugins() -> String {
    let mut text = String::new();
    for one in registry::list().iter().filter(|l| !BUILT_IN.contains(&l.package)) {
        text.push_str(&format!("\nplugin: {} {}: {} `{}`", one.package, one.version, one.stage, one.name));
    }
    text
}

/// Names of the crates that hold the built-in stages.
const BUILT_IN: [&str; 12] = [
    "spectra-glass",
    "spectra-lens",
    "spectra-plugin-colors",
    "spectra-plugin-films",
    "spectra-plugin-imagers",
    "spectra-plugin-oiio",
    "spectra-plugin-outputs",
    "spectra-plugin-responses",
    "spectra-plugin-samplers",
    "spectra-plugin-sources",
    "spectra-plugin-surfaces",
    "spectra-spectrum",
];

/// Commit that this program was built from, if known.
const COMMIT: Option<&str> = option_env!("SPECTRA_COMMIT");

/// Returns the versions that a result depends on: program, commit, compiler, target and crates of all stages.
pub(crate) fn to_json() -> Value {
    let plugins: Map<String, Value> =
        registry::list().iter().map(|l| (l.package.to_owned(), l.version.into())).collect();
    json!({ "spectra": VERSION, "commit": COMMIT, "compiler": env!("SPECTRA_RUSTC"), "target": env!("SPECTRA_TARGET"), "plugins": plugins })
}
