//! The sources that plugins are built against, and the user's cache that they are unpacked into.

use crate::outcome::Failure;
use spectra_core::params::Fault;
use std::io;
use std::path::{Path, PathBuf};

/// Unpacks the sources that a program holds into a folder of a cache, with these data files (name and content) beside
/// them, unless they are there already; returns their folder. [`io::ErrorKind::NotFound`] says that the program holds none.
pub type Unpack = fn(&Path, &mut dyn Iterator<Item = (&'static str, &'static [u8])>) -> io::Result<PathBuf>;

/// Folder of the sources: a checkout, or the unpacked ones of this program.
#[derive(Clone, Debug)]
pub(crate) struct Sources {
    folder: PathBuf,
}

impl Sources {
    /// Those at `core`, which is a checkout or its `crates/core`; or this program's own, unpacked to the cache.
    pub(crate) fn find(core: Option<&Path>, unpack: Unpack) -> Result<Self, Failure> {
        let Some(core) = core else { return Self::unpacked(unpack) };
        let no_sources = |text: &str| {
            let fault = Fault::new(format!("--core {}: {text}", core.display()));
            Failure::from(fault.hint("a checkout of spectra, or its folder crates/core"))
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
            // The system's own word for a folder that cannot be made is the same, and comes with a number.
            if error.kind() == io::ErrorKind::NotFound && error.raw_os_error().is_none() {
                let fault = Fault::new(error.to_string());
                return Failure::from(fault.hint("name a checkout of the same version: --core PATH"));
            }
            Failure::Failed(format!(
                "{}: the sources cannot be unpacked: {error} (SPECTRA_CACHE names another folder)",
                cache.display()
            ))
        })?;
        Ok(Self { folder: plain(&folder) })
    }

    /// Their folder, absolute.
    pub(crate) fn folder(&self) -> &Path {
        &self.folder
    }

    /// A crate among them, such as `crates/core`.
    pub(crate) fn crate_folder(&self, inside: &str) -> PathBuf {
        self.folder.join(inside)
    }

    /// All crates: package and folder, by package.
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

    /// A file of the root, such as `Cargo.lock`.
    pub(crate) fn read(&self, name: &str) -> Result<String, Failure> {
        let path = self.folder.join(name);
        std::fs::read_to_string(&path).map_err(|error| unreadable(&path, &error))
    }
}

const CORE_MANIFEST: &str = "crates/core/Cargo.toml";

fn unreadable(path: &Path, error: &io::Error) -> Failure {
    Failure::Failed(format!("{}: {error}", path.display()))
}

/// The folder for what can be made again: `$SPECTRA_CACHE`, or `spectra` in the place that the system has for such things.
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
        Failure::from(Fault::new("no cache folder is known").hint("set the environment variable SPECTRA_CACHE"))
    })?;
    std::path::absolute(&folder).map_err(|error| unreadable(&folder, &error))
}

/// Where cargo puts what `spectra build` and the tests of new plugins compile: one folder for all, so that
/// crates with the same features are compiled once.
pub(crate) fn target() -> Result<PathBuf, Failure> {
    Ok(cache()?.join("target"))
}

/// The sections of a manifest that say how to compile.
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

/// A path as cargo writes it: absolute, without `..`, and without the `\\?\` that Windows puts before it.
pub(crate) fn plain(path: &Path) -> PathBuf {
    let path = path.canonicalize().unwrap_or_else(|_| path.to_owned());
    match path.to_str().and_then(|text| text.strip_prefix(r"\\?\")) {
        Some(short) if !short.starts_with("UNC") => PathBuf::from(short),
        _ => path,
    }
}

/// A text as a string of TOML.
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

/// A path as a string of TOML.
pub(crate) fn toml_path(path: &Path) -> Result<String, Failure> {
    let text =
        path.to_str().ok_or_else(|| Failure::Input(format!("{}: a path that is not Unicode", path.display())))?;
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
