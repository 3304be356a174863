//! Writes the generated crate: manifest, lock file, `main.rs`.

use super::plugin::Plugin;
use crate::outcome::Failure;
use crate::sources::{Sources, cache, profiles, target, toml, toml_path};
use std::fmt::Write as _;
use std::path::{Path, PathBuf};

/// A generated crate whose program contains the built-in stages and those of some plugins.
#[derive(Debug)]
pub(super) struct Program {
    /// Name of the package and the program, unique for a set of plugins.
    pub name: String,
    /// Path of the manifest.
    pub manifest: PathBuf,
    /// Target folder for cargo, unless the user sets another one.
    pub target: PathBuf,
}

/// Crates of `spectra` that the program depends on, with their folders.
const OURS: [(&str, &str); 3] = [
    ("spectra-command", "crates/command"),
    ("spectra-plugins", "plugins/all"),
    ("spectra-workspace", "crates/workspace"),
];

/// Crates that no program contains. A patch for them would make cargo warn that it is unused.
const NOT_IN_PROGRAMS: [&str; 2] = ["spectra-testing", "spectra-plugin-oiio"];

/// File in the folder of `main.rs` with the licenses of the crates that the plugins add.
const NOTICES: &str = "notices.txt";

impl Program {
    /// Writes the crate to the cache, in one folder per set of plugins. Files that are already the same are not touched, so that
    /// cargo sees no change.
    pub(super) fn write(sources: &Sources, plugins: &[Plugin]) -> Result<Self, Failure> {
        let mut key = sources.folder().display().to_string();
        for plugin in plugins {
            // Writing to a String cannot fail.
            let _ = write!(key, "\n{}\n{}", plugin.package, plugin.folder.display());
        }
        let name = format!("spectra-built-{:016x}", fnv1a(key.as_bytes()));
        let cache = cache()?;
        let folder = cache.join("programs").join(&name);
        let source = folder.join("src");
        std::fs::create_dir_all(&source).map_err(|error| Failure::Failed(format!("{}: {error}", source.display())))?;
        let manifest = folder.join("Cargo.toml");
        let lock = folder.join("Cargo.lock");
        write_if_other(&manifest, &manifest_text(&name, sources, plugins)?)?;
        write_if_other(&source.join("main.rs"), &main_text(plugins))?;
        let notices = source.join(NOTICES);
        if !notices.is_file() {
            write_if_other(&notices, "")?;
        }
        if !lock.is_file() {
            write_if_other(&lock, &sources.read("Cargo.lock")?)?;
        }
        Ok(Self { name, manifest, target: target()? })
    }

    /// Writes the licenses of the crates that the plugins add.
    pub(super) fn set_notices(&self, text: &str) -> Result<(), Failure> {
        write_if_other(&self.manifest.with_file_name("src").join(NOTICES), text)
    }
}

fn manifest_text(name: &str, sources: &Sources, plugins: &[Plugin]) -> Result<String, Failure> {
    let mut text = format!(
        "# Written by `spectra build`; changes are lost.\n\
         [package]\nname = \"{name}\"\nversion = \"{}\"\nedition = \"2024\"\npublish = false\n\n\
         [workspace]\n\n[dependencies]\n",
        crate::version::VERSION
    );
    for (package, inside) in OURS {
        let _ = writeln!(text, "{package} = {{ path = {} }}", toml_path(&sources.crate_folder(inside))?);
    }
    for plugin in plugins {
        let _ = writeln!(text, "{} = {{ path = {} }}", toml(&plugin.package), toml_path(&plugin.folder)?);
    }
    text.push_str("\n[patch.crates-io]\n");
    for (package, folder) in sources.packages()? {
        if !NOT_IN_PROGRAMS.contains(&package.as_str()) {
            let _ = writeln!(text, "{package} = {{ path = {} }}", toml_path(&folder)?);
        }
    }
    text.push('\n');
    text.push_str(&profiles(&sources.read("Cargo.toml")?));
    Ok(text)
}

fn main_text(plugins: &[Plugin]) -> String {
    let mut text = String::from("//! Written by `spectra build`; changes are lost.\n\nuse spectra_plugins as _;\n");
    for plugin in plugins {
        let _ = writeln!(text, "use {} as _;", plugin.library);
    }
    let _ = write!(
        text,
        "\nfn main() -> std::process::ExitCode {{\n    \
         spectra_command::main_with_notices(spectra_workspace::unpack, include_str!(\"{NOTICES}\"))\n}}\n"
    );
    text
}

/// Writes a file atomically, unless it already holds that text.
fn write_if_other(path: &Path, text: &str) -> Result<(), Failure> {
    if std::fs::read_to_string(path).is_ok_and(|old| old == text) {
        return Ok(());
    }
    spectra_files::write_atomically(path, |file| Ok(std::io::Write::write_all(file, text.as_bytes())?))?;
    Ok(())
}

fn fnv1a(bytes: &[u8]) -> u64 {
    bytes.iter().fold(0xcbf2_9ce4_8422_2325, |hash, byte| (hash ^ u64::from(*byte)).wrapping_mul(0x0100_0000_01b3))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Test vectors by the function's authors: <http://www.isthe.com/chongo/tech/comp/fnv/>.
    #[test]
    fn hashes_are_fnv1a() {
        assert_eq!([fnv1a(b""), fnv1a(b"a")], [0xcbf2_9ce4_8422_2325, 0xaf63_dc4c_8601_ec8c]);
        assert_eq!(fnv1a(b"foobar"), 0x8594_4171_f739_67e8);
    }
}
