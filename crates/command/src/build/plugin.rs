//! Reads and checks the manifest of a plugin.

use super::cargo::Cargo;
use super::metadata::{Dependency, Metadata, Target};
use crate::sources::{Sources, plain};
use semver::{Version, VersionReq};
use spectra_core::params::{Fault, Faults};
use std::path::{Path, PathBuf};

/// The crate of a plugin.
#[derive(Debug)]
pub(crate) struct Plugin {
    /// Name of the package.
    pub package: String,
    /// Version of the package.
    pub version: String,
    /// Name of the library in Rust code, with underscores.
    pub library: String,
    /// Absolute path of the crate's folder.
    pub folder: PathBuf,
}

/// Prefix of a dependency's source if it comes from a registry, as `spectra-core` should.
const REGISTRY: &str = "registry+";

impl Plugin {
    /// Reads the plugin at a folder or a `Cargo.toml`. Fails with all that is wrong with it.
    pub(super) fn read(path: &Path, cargo: &Cargo, sources: &Sources) -> Result<Self, Faults> {
        let manifest = manifest(path)?;
        let metadata = cargo.metadata_alone(&manifest).map_err(|text| {
            let fault = Fault::new(format!("{}: cargo cannot read it: {text}", manifest.display()));
            fault.hint("a plugin is a crate such as `spectra new plugin NAME --stage surface` creates")
        })?;
        Self::of(&manifest, metadata, sources)
    }

    fn of(manifest: &Path, metadata: Metadata, sources: &Sources) -> Result<Self, Faults> {
        let here = plain(manifest);
        let shown = manifest.display();
        let mut names: Vec<String> = metadata.packages.iter().map(|p| format!("`{}`", p.name)).collect();
        let Some(package) = metadata.packages.into_iter().find(|p| plain(&p.manifest_path) == here) else {
            names.sort();
            let fault = Fault::new(format!("{shown}: this is a workspace, not a crate"));
            return Err(fault.hint(format!("name the folder of one of its crates: {}", names.join(", "))).into());
        };
        let is_library =
            |target: &&Target| target.crate_types.iter().any(|t| matches!(t.as_str(), "lib" | "rlib" | "dylib"));
        let Some(library) = package.targets.iter().find(is_library) else {
            let fault = Fault::new(format!("{shown}: the crate `{}` has no library", package.name));
            return Err(fault.hint("a plugin registers its stages in src/lib.rs").into());
        };
        if sources.packages().is_ok_and(|ours| ours.iter().any(|(name, _)| *name == package.name)) {
            let fault = Fault::new(format!("{shown}: `{}` is the name of a crate of spectra itself", package.name));
            return Err(fault.hint("rename it in its Cargo.toml").into());
        }
        let core = package.dependencies.iter().find(|d| d.name == "spectra-core" && d.kind.is_none());
        if let Some(core) = core {
            check_core(core, &shown.to_string(), sources)?;
        }
        Ok(Self {
            library: library.name.replace('-', "_"),
            package: package.name,
            version: package.version,
            folder: here.parent().unwrap_or(Path::new("/")).to_owned(),
        })
    }
}

/// Returns the manifest for a path that is either the manifest or its folder.
fn manifest(path: &Path) -> Result<PathBuf, Fault> {
    let hint = "give the folder of a plugin's crate, or its Cargo.toml";
    if path.is_dir() {
        let manifest = path.join("Cargo.toml");
        return if manifest.is_file() {
            Ok(manifest)
        } else {
            Err(Fault::new(format!("--with {}: not a crate: there is no Cargo.toml", path.display())).hint(hint))
        };
    }
    match path.file_name() {
        Some(name) if name == "Cargo.toml" && path.is_file() => Ok(path.to_owned()),
        _ if path.exists() => Err(Fault::new(format!("--with {}: not a crate", path.display())).hint(hint)),
        _ => Err(Fault::new(format!("--with {}: no such folder", path.display())).hint(hint)),
    }
}

/// Checks that the plugin uses the `spectra-core` that the program is built with.
fn check_core(core: &Dependency, manifest: &str, sources: &Sources) -> Result<(), Fault> {
    let ours = Version::parse(crate::version::VERSION).expect("cargo checks the version of a package");
    let write = format!("write `spectra-core = \"{}.{}\"` among its dependencies", ours.major, ours.minor);
    if let Some(path) = &core.path {
        if plain(path) == plain(&sources.crate_folder("crates/core")) {
            return Ok(());
        }
        let text = format!("{manifest}: its spectra-core comes from {}, unlike the program's", path.display());
        return Err(Fault::new(text).hint(format!("{write}, or build with that one too: --core {}", path.display())));
    }
    if !core.source.as_deref().is_some_and(|source| source.starts_with(REGISTRY)) {
        let from = core.source.as_deref().unwrap_or("somewhere else");
        let text = format!("{manifest}: its spectra-core comes from {from}, unlike the program's");
        return Err(Fault::new(text).hint(write));
    }
    let wanted = VersionReq::parse(&core.req).map_err(|error| Fault::new(format!("{manifest}: {error}")))?;
    if wanted.matches(&ours) {
        return Ok(());
    }
    let text = format!("{manifest}: it was written for spectra-core {}, this program has {ours}", core.req);
    Err(Fault::new(text)
        .hint(format!("{write} and fix what the compiler reports, or build with that version: --core PATH")))
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::io;

    fn sources() -> Sources {
        let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
        Sources::find(Some(&root), |_, _| Err(io::Error::other("not asked for"))).unwrap()
    }

    fn dependency(req: &str, source: Option<&str>, path: Option<&str>) -> Dependency {
        Dependency {
            name: "spectra-core".into(),
            req: req.into(),
            kind: None,
            source: source.map(Into::into),
            path: path.map(Into::into),
        }
    }

    #[test]
    fn cores_of_another_version_or_place_are_refused() {
        let registry = Some("registry+https://github.com/rust-lang/crates.io-index");
        let check = |d: Dependency| check_core(&d, "a/Cargo.toml", &sources()).map_err(|f| f.to_string());
        let ours = crate::version::VERSION;
        assert_eq!(check(dependency(&format!("^{ours}"), registry, None)), Ok(()));
        assert_eq!(check(dependency("*", registry, None)), Ok(()));
        let core = sources().crate_folder("crates/core");
        assert_eq!(check(dependency("*", None, core.to_str())), Ok(()));
        let text = check(dependency("^77.1", registry, None)).unwrap_err();
        assert!(text.contains("spectra-core ^77.1") && text.contains(ours), "{text}");
        let text = check(dependency("*", Some("git+https://example.org/x"), None)).unwrap_err();
        assert!(text.contains("comes from git+https://example.org/x"), "{text}");
        let text = check(dependency("*", None, Some("/elsewhere/core"))).unwrap_err();
        assert!(text.contains("--core /elsewhere/core"), "{text}");
    }
}
