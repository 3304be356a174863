//! Source code that plugins are built against, and the user's cache folder that it is unpacked into.

use crate::outcome::Failure;
use spectra_core::params::Fault;
use std::io;
use std::path::{Path, PathBuf};

/// Unpacks the source code embedded in a program into a folder of a cache, together with the given data files (name and content).
/// Leaves a folder that is already unpacked as it is. Returns the folder of the sources, or [`io::ErrorKind::NotFound`] if the
/// program contains no sources.
pub type Unpack = fn(&Path, &mut dyn Iterator<Item = (&'static str, &'static [u8])>) -> io::Result<PathBuf>;

/// Folder of the sources of `spectra`: a checkout, or the unpacked sources of this program.
#[derive(Clone, Debug)]
pub(crate) struct Sources {
    folder: PathBuf,
}

impl Sources {
    /// Finds the sources at `core`, which is a checkout or its folder `crates/core`. Without `core`, unpacks the sources of this
    /// program to the cache.
    pub(crate) fn find(core: Option<&Path>, unpack: Unpack) -> Result<Self, Failure> {
        let Some(core) = core else { return Self::unpacked(unpack) };
        let no_sources = |text: &str| {
            let fault = Fault::new(format!("--core {}: {text}", core.display()));
            Failure::from(fault.hint("give a checkout of spectra, or its folder crates/core"))
        };
        let core = core.canonicalize().map_err(|error| no_sources(&error.to_string()))?;
        let folder = [core.clone(), core.join("../..")].into_iter().find(|root| root.join(CORE_MANIFEST).is_file());
        let folder = folder.ok_or_else(|| no_sources("no sources of spectra"))?;
        Ok(Self { folder: plain(&folder) })
    }

    fn unpacked(unpack: Unpack) -> Result<Self, Failure> {
        let cache = cache()?;
        let mut data = spectra_data::list("").filter_map(|name| Some((name, spectra_data::get(name)?)));
        let folder = unpack(&cache, &mut data).map_err(|error| {
            // A folder that cannot be created gives the same error kind, but with an error number of the system.
            if error.kind() == io::ErrorKind::NotFound && error.raw_os_error().is_none() {
                let fault = Fault::new(error.to_string());
                return Failure::from(fault.hint("name a checkout of the same version: --core PATH"));
            }
            Failure::Failed(format!(
                "{}: the sources cannot be unpacked: {error} (set SPECTRA_CACHE to use another folder)",
                cache.display()
            ))
        })?;
        Ok(Self { folder: plain(&folder) })
    }

    /// Absolute path of the sources.
    pub(crate) fn folder(&self) -> &Path {
        &self.folder
    }

    /// Returns the path of a crate in the sources, such as `crates/core`.
    pub(crate) fn crate_folder(&self, inside: &str) -> PathBuf {
        self.folder.join(inside)
    }

    /// Lists all crates of the sources as (package name, folder), sorted by package name.
    pub(crate) fn packages(&self) -> Result<Vec<(String, PathBuf)>, Failure> {
        let mut found = Vec::new();
        for family in ["crates", "plugins"] {
            let folder = self.folder.join(family);
            let entries = std::fs::read_dir(&folder).map_err(|error| unreadable(&folder, &error))?;
            for entry in entries.flatten() {
                let Ok(manifest) = std::fs::read_to_string(entry.path().join("Cargo.toml")) else { continue };
                let name = manifest.lines().find_map(|line| line.strip_prefix("name = \"")?.strip_suffix('"'));
                found.extend(name.map(|name| (name.to_owned(), entry.path())));
            }
        }
        found.sort();
        Ok(found)
    }

    /// Reads a text file of the root folder, such as `Cargo.lock`.
    pub(crate) fn read(&self, name: &str) -> Result<String, Failure> {
        let path = self.folder.join(name);
        std::fs::read_to_string(&path).map_err(|error| unreadable(&path, &error))
    }
}

const CORE_MANIFEST: &str = "crates/core/Cargo.toml";

fn unreadable(path: &Path, error: &io::Error) -> Failure {
    Failure::Failed(format!("{}: {error}", path.display()))
}

/// Returns the cache folder, absolute: `$SPECTRA_CACHE`, or `spectra` in the system's folder for caches.
pub(crate) fn cache() -> Result<PathBuf, Failure> {
    let stated = |name: &str| std::env::var_os(name).filter(|value| !value.is_empty()).map(PathBuf::from);
    let home = |inside: &str| std::env::home_dir().map(|home| home.join(inside));
    let platform = || match std::env::consts::OS {
        "macos" => home("Library/Caches"),
        "windows" => stated("LOCALAPPDATA"),
        _ => stated("XDG_CACHE_HOME").filter(|path| path.is_absolute()).or_else(|| home(".cache")),
    };
    let folder = stated("SPECTRA_CACHE").or_else(|| platform().map(|cache| cache.join("spectra")));
    let folder = folder.ok_or_else(|| {
        Failure::from(
            Fault::new("the system has no known cache folder").hint("set the environment variable SPECTRA_CACHE"),
        )
    })?;
    std::path::absolute(&folder).map_err(|error| unreadable(&folder, &error))
}

/// Returns the target folder of cargo for `spectra build` and for the tests of new plugins. They share one folder, so that crates
/// with the same features are compiled only once.
pub(crate) fn target() -> Result<PathBuf, Failure> {
    Ok(cache()?.join("target"))
}

/// Returns the `[profile...]` sections of a manifest, without comments.
pub(crate) fn profiles(manifest: &str) -> String {
    let mut kept = String::new();
    let mut in_profile = false;
    for line in manifest.lines() {
        if line.starts_with('[') {
            in_profile = line.starts_with("[profile.");
        }
        if in_profile && !line.starts_with('#') {
            kept.push_str(line);
            kept.push('\n');
        }
    }
    kept
}

/// Returns a path as cargo writes it: absolute, without `..`, and without the `\\?\` prefix of Windows.
pub(crate) fn plain(path: &Path) -> PathBuf {
    let path = path.canonicalize().unwrap_or_else(|_| path.to_owned());
    match path.to_str().and_then(|text| text.strip_prefix(r"\\?\")) {
        Some(short) if !short.starts_with("UNC") => PathBuf::from(short),
        _ => path,
    }
}

/// Quotes a text as a TOML string.
pub(crate) fn toml(text: &str) -> String {
    let mut out = String::from('"');
    for c in text.chars() {
        match c {
            '"' | '\\' => out.extend(['\\', c]),
            c if c.is_control() => out.push_str(&format!("\\u{:04X}", u32::from(c))),
            c => out.push(c),
        }
    }
    out.push('"');
    out
}

/// Quotes a path as a TOML string. Fails if the path is not valid Unicode.
pub(crate) fn toml_path(path: &Path) -> Result<String, Failure> {
    let text =
        path.to_str().ok_or_else(|| Failure::Input(format!("{}: the path is not valid Unicode", path.display())))?;
    Ok(toml(text))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn texts_are_quoted_for_toml() {
        assert_eq!(toml("C:\\a \"b\"\n"), "\"C:\\\\a \\\"b\\\"\\u000A\"");
    }

    #[test]
    fn a_checkout_is_found_by_itself_and_by_its_core() {
        let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
        let never: Unpack = |_, _| Err(io::Error::other("not asked for"));
        for path in [root.clone(), root.join("crates/core")] {
            let sources = Sources::find(Some(&path), never).unwrap();
            assert_eq!(sources.folder(), plain(&root));
            let packages = sources.packages().unwrap();
            assert!(packages.iter().any(|(name, path)| name == "spectra-core" && path.ends_with("crates/core")));
            assert!(packages.iter().any(|(name, path)| name == "spectra-plugins" && path.ends_with("plugins/all")));
        }
        assert!(Sources::find(Some(&root.join("crates")), never).is_err());
        assert!(Sources::find(Some(Path::new("no/such/folder")), never).is_err());
    }

    #[test]
    fn profiles_are_taken_over_and_nothing_else() {
        let manifest = "[package]\nname = \"x\"\n[profile.dev]\n# why\nopt-level = 1\n\n[profile.dev.package.\"*\"]\nopt-level = 2\n[lints]\nworkspace = true\n[profile.release]\ndebug = false\n";
        let wanted = "[profile.dev]\nopt-level = 1\n\n[profile.dev.package.\"*\"]\nopt-level = 2\n[profile.release]\ndebug = false\n";
        assert_eq!(profiles(manifest), wanted);
    }
}
