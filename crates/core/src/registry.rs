//! The registry: name -> typed parameters -> stage.
//!
//! A plugin crate submits one [`Entry`] a stage:
//!
//! ```ignore
//! inventory::submit! {
//!     SurfaceEntry::new("sphere", "Part of a sphere.", env!("CARGO_PKG_NAME"), env!("CARGO_PKG_VERSION"), build)
//! }
//! ```
//!
//! The order of submission differs between builds and a name could come twice: [`check`] sorts and
//! refuses, and the command calls it before anything else.

use crate::params::{Fault, Faults, Params};
use crate::resources::Resources;
use crate::spectral::{Grid, SpectralPower};
use crate::stage::{ColorModel, Film, Imager, Source, WavelengthSampler};
use crate::surface::Surface;

/// What a builder may ask for.
#[derive(Clone, Copy)]
pub struct Context<'a> {
    /// Files.
    pub resources: &'a dyn Resources,
    /// The band that light is computed on.
    pub grid: Grid,
    /// For a color model: the light that the source's colors are seen under.
    pub illuminant: Option<&'a SpectralPower>,
}

/// How a stage is built from its parameters.
pub type Build<S> = fn(&Params, &Context<'_>) -> Result<Box<S>, Faults>;

/// One registered stage.
pub struct Entry<S: ?Sized + 'static> {
    /// Name in a scene (`kind: name`), kebab-case.
    pub name: &'static str,
    /// One line for a person.
    pub summary: &'static str,
    /// The crate that it comes from.
    pub package: &'static str,
    /// That crate's version.
    pub version: &'static str,
    /// Whether it is taken where a scene names no kind.
    pub default: bool,
    /// Builds it.
    pub build: Build<S>,
}

impl<S: ?Sized> Entry<S> {
    /// An entry; see the fields.
    #[must_use]
    pub const fn new(
        name: &'static str,
        summary: &'static str,
        package: &'static str,
        version: &'static str,
        build: Build<S>,
    ) -> Self {
        Self { name, summary, package, version, default: false, build }
    }

    /// The same, taken where a scene names no kind.
    #[must_use]
    pub const fn or_default(self) -> Self {
        Self { default: true, ..self }
    }
}

/// A kind of stage, as the registry knows it.
pub trait Stage: 'static {
    /// Its name in messages and in `spectra list`.
    const NAME: &'static str;
    /// All entries, in the order of the link.
    fn entries() -> Vec<&'static Entry<Self>>;
}

macro_rules! stages {
    ($($alias:ident, $stage:ty, $name:literal, $doc:literal;)*) => {
        $(
            #[doc = $doc]
            pub type $alias = Entry<$stage>;
            inventory::collect!($alias);
            impl Stage for $stage {
                const NAME: &'static str = $name;
                fn entries() -> Vec<&'static Entry<Self>> {
                    inventory::iter::<$alias>.into_iter().collect()
                }
            }
        )*

        /// Every stage that is registered, sorted by stage and name.
        #[must_use]
        pub fn list() -> Vec<Listed> {
            let mut all = Vec::new();
            $(all.extend(<$stage as Stage>::entries().into_iter().map(Listed::of));)*
            all.sort_by_key(|l| (l.stage, l.name, l.package));
            all
        }
    };
}

stages! {
    SourceEntry, dyn Source, "source", "A registered source.";
    ColorEntry, dyn ColorModel, "color", "A registered color model.";
    SamplerEntry, dyn WavelengthSampler, "wavelengths", "A registered wavelength sampler.";
    SurfaceEntry, dyn Surface, "surface", "A registered surface.";
    ImagerEntry, dyn Imager, "imager", "A registered imager.";
    FilmEntry, dyn Film, "film", "A registered film process.";
}

/// What `spectra list` shows of a stage.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Listed {
    /// Kind of stage.
    pub stage: &'static str,
    /// Name in a scene.
    pub name: &'static str,
    /// One line.
    pub summary: &'static str,
    /// Crate.
    pub package: &'static str,
    /// Version of the crate.
    pub version: &'static str,
    /// Whether it is taken where a scene names no kind.
    pub default: bool,
}

impl Listed {
    fn of<S: Stage + ?Sized>(entry: &Entry<S>) -> Self {
        Self {
            stage: S::NAME,
            name: entry.name,
            summary: entry.summary,
            package: entry.package,
            version: entry.version,
            default: entry.default,
        }
    }
}

/// Tests the registry: no name twice, none ill-formed, each with a summary, one default at most.
///
/// # Errors
/// One text a fault; a duplicate names both crates.
pub fn check() -> Result<(), Vec<String>> {
    check_list(&list())
}

fn check_list(all: &[Listed]) -> Result<(), Vec<String>> {
    let mut faults = Vec::new();
    for (i, a) in all.iter().enumerate() {
        let well_formed = a.name.starts_with(|c: char| c.is_ascii_lowercase())
            && a.name.chars().all(|c| c.is_ascii_lowercase() || c.is_ascii_digit() || c == '-')
            && !a.name.ends_with('-');
        if !well_formed {
            faults.push(format!("{} `{}` of crate {} {}: names are kebab-case", a.stage, a.name, a.package, a.version));
        }
        if a.summary.trim().is_empty() {
            faults.push(format!("{} `{}` of crate {} {}: the summary is empty", a.stage, a.name, a.package, a.version));
        }
        for b in &all[i + 1..] {
            if a.stage == b.stage && a.name == b.name {
                faults.push(format!(
                    "{} `{}` is registered twice: by crate {} {} and by crate {} {}",
                    a.stage, a.name, a.package, a.version, b.package, b.version
                ));
            } else if a.stage == b.stage && a.default && b.default {
                faults.push(format!(
                    "{}: both `{}` of crate {} and `{}` of crate {} want to be the default",
                    a.stage, a.name, a.package, b.name, b.package
                ));
            }
        }
    }
    if faults.is_empty() { Ok(()) } else { Err(faults) }
}

/// Builds the stage that `params` name by their `kind` (or the default one).
///
/// # Errors
/// Unknown kind, with the nearest known ones; or what the stage's own parameters have wrong.
pub fn build<S: Stage + ?Sized>(params: &Params, context: &Context<'_>) -> Result<Box<S>, Faults> {
    let mut entries = S::entries();
    entries.sort_by_key(|e| e.name);
    let found = match params.kind() {
        Some(kind) => entries.iter().find(|e| e.name == kind),
        None => entries.iter().find(|e| e.default),
    };
    let Some(entry) = found else {
        let names: Vec<&str> = entries.iter().map(|e| e.name).collect();
        return Err(unknown_kind(params, S::NAME, &names).into());
    };
    (entry.build)(params, context)
}

fn unknown_kind(params: &Params, stage: &str, names: &[&str]) -> Fault {
    let known = names.join(", ");
    match params.kind() {
        Some(kind) => {
            let near = crate::params::nearest(kind, names.iter().copied());
            let hint = match near {
                Some(near) => format!("did you mean `{near}`? Known: {known}"),
                None => format!("known: {known}"),
            };
            params.fault("kind", format!("unknown {stage} `{kind}`")).hint(hint)
        }
        None => params.fault("kind", format!("which {stage}? `kind` is missing")).hint(format!("known: {known}")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn listed(name: &'static str, package: &'static str) -> Listed {
        Listed { stage: "surface", name, summary: "x", package, version: "1.2.3", default: false }
    }

    #[test]
    fn duplicates_name_both_crates() {
        let faults = check_list(&[listed("sphere", "crate-a"), listed("sphere", "crate-b")]).unwrap_err();
        assert_eq!(faults, ["surface `sphere` is registered twice: by crate crate-a 1.2.3 and by crate crate-b 1.2.3"]);
    }

    #[test]
    fn ill_formed_names_are_refused() {
        for name in ["Sphere", "even_asphere", "-x", "x-", ""] {
            assert!(check_list(&[listed(name, "a")]).is_err(), "{name}");
        }
        assert!(check_list(&[listed("even-asphere", "a"), listed("ring2", "a")]).is_ok());
    }

    #[test]
    fn two_defaults_are_refused() {
        let a = Listed { default: true, ..listed("a", "p") };
        let b = Listed { default: true, ..listed("b", "q") };
        assert!(check_list(&[a, b]).is_err());
    }
}
