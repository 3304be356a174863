//! Which program this is.

use serde_json::{Map, Value, json};
use spectra_core::{Isa, registry};
use std::sync::LazyLock;

/// Its version.
pub(crate) const VERSION: &str = env!("CARGO_PKG_VERSION");

/// What `--version` shows: version, commit, compiler, target and the widest instruction set of this machine.
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

/// Crates in this program that are not its own, with the stages that they bring.
fn plugins() -> String {
    let mut text = String::new();
    for one in registry::list().iter().filter(|l| !BUILT_IN.contains(&l.package)) {
        text.push_str(&format!("\nplugin: {} {}: {} `{}`", one.package, one.version, one.stage, one.name));
    }
    text
}

/// The crates of the built-in stages.
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

/// Commit that it was built from, where that is known.
const COMMIT: Option<&str> = option_env!("SPECTRA_COMMIT");

/// The versions that a result depends on.
pub(crate) fn to_json() -> Value {
    let plugins: Map<String, Value> =
        registry::list().iter().map(|l| (l.package.to_owned(), l.version.into())).collect();
    json!({ "spectra": VERSION, "commit": COMMIT, "compiler": env!("SPECTRA_RUSTC"), "target": env!("SPECTRA_TARGET"), "plugins": plugins })
}
