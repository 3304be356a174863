//! The registry: name -> typed parameters -> stage.
//!
//! A plugin crate registers each of its stages next to the function that builds it:
//!
//! ```
//! use schemars::JsonSchema;
//! use serde::Deserialize;
//! use spectra_core::params::{Faults, Length, Params};
//! use spectra_core::registry::Context;
//! use spectra_core::surface::{FromSag, PerRay, SagShape, Surface};
//!
//! /// A paraboloid.
//! ///
//! /// # Example
//! /// ```yaml
//! /// {kind: paraboloid, focal-length: 100 mm, thickness: 50, mirror: true}
//! /// ```
//! #[derive(Debug, Deserialize, JsonSchema)]
//! #[serde(deny_unknown_fields, rename_all = "kebab-case")]
//! struct ParaboloidParams {
//!     /// Focal length as a mirror, mm if bare.
//!     focal_length: Length,
//! }
//!
//! spectra_core::register!(surface "paraboloid": ParaboloidParams, build);
//!
//! #[derive(Debug)]
//! struct Paraboloid(f64);
//!
//! impl SagShape for Paraboloid {
//!     fn sag_mm(&self, x_mm: f64, y_mm: f64) -> Option<f64> {
//!         Some((x_mm * x_mm + y_mm * y_mm) / (4.0 * self.0))
//!     }
//! }
//!
//! fn build(params: &Params, _: &Context<'_>) -> Result<Box<dyn Surface>, Faults> {
//!     let p: ParaboloidParams = params.parse()?;
//!     Ok(Box::new(PerRay(FromSag(Paraboloid(p.focal_length.mm())))))
//! }
//! # assert_eq!(spectra_core::registry::list()[0].documentation().summary, "A paraboloid.");
//! ```
//!
//! The documentation of a stage comes from the doc comments of its parameters ([`Documentation`]). Completion in editors comes
//! from their types ([`definitions`]). `tests/it/documentation.rs` builds every example where a stage of its kind stands, and again
//! with a key that must be refused. `xtask/validate_schemas.py` checks the schemas against every file of the repository by an
//! independent validator.
//!
//! # Registries
//!
//! Everything that a file names by a kind is an entry of a registry: a name, the schema of its parameters, and a builder. A registry
//! belongs to the crate that owns the trait (or the type) that every kind becomes, and is declared there by
//! [`declare!`](crate::declare):
//!
//! | registry | declared in | a kind becomes | named by |
//! |---|---|---|---|
//! | `source`, `color`, `wavelengths`, `surface`, `imager`, `response`, `film` | `core` | the stage | `kind` |
//! | `output` | `scene` | `dyn Output` | `kind`, or its name alone |
//! | `spectrum` | `spectrum` | `dyn SpectrumKind`, which makes a spectrum of others and of what is wanted | `kind` |
//! | `coating` | `lens` | a `Coating`: layers, or a measured curve | `kind`, or its name alone; a map with `layer` or `layers` |
//! | `aperture` | `lens` | a `Shape` | `shape` |
//! | `formula` | `glass` | a `Formula`: a function of coefficients | `formula`, beside the other keys of a glass |
//!
//! A kind is looked up once, when a file is read. What is traced afterwards are concrete types (`Coating`, `Shape`, the rational fit
//! of a `Formula`), so a kind from a plugin costs no time per ray. [`list`] goes over everything that is declared. `spectra list`,
//! `spectra doc`, `spectra schema`, the check for duplicates and the tests therefore know no kind by name. Keys that all kinds share
//! (`assumed` of a coating, `center` of an aperture) are a separate struct, split off by `params::keys_of` before a kind reads the
//! others. Lists of words that no plugin may extend are enums.
//!
//! Two versions of a crate that declares a registry would be two registries in one program, one of them silently empty. `links` in
//! the manifest of each such crate (`core`, `spectrum`, `glass`, `lens`, `scene`) makes that an error of cargo.
//!
//! The order of registration differs between builds, and two crates may register the same name. [`check`] refuses duplicate
//! names; the command calls it before anything else.

mod documentation;
mod form;
mod schema;

pub use documentation::{Documentation, Parameter};
pub use form::{ValueForm, ValueRange};
pub use schema::{NameOf, StageOf, definitions, kinds};

use crate::frame_view::FrameView;
use crate::params::{Fault, Faults, Params, Warning, Warnings};
use crate::resources::Resources;
use crate::spectral::{Grid, SpectralPower};
use crate::stage::{ColorModel, Film, Imager, Response, Source, WavelengthSampler};
use crate::surface::Surface;
use schemars::{Schema, SchemaGenerator};

#[doc(hidden)] // for `register!` and `declare!`
pub use {inventory, schemars::JsonSchema};

/// The context that a builder may use besides its parameters.
#[derive(Clone, Copy)]
pub struct Context<'a> {
    /// Access to files by name.
    pub resources: &'a dyn Resources,
    /// Band on which light is computed.
    pub grid: Grid,
    /// Light under which the colors of the source are seen, for a color model; `None` for other stages.
    pub illuminant: Option<&'a SpectralPower>,
    /// View of the frame in front of the lens, for a source; `None` if the scene has no valid lens.
    pub view: Option<&'a FrameView>,
    /// Point of the image plane at which the light of the source lands, in mm, for an imager. `None` if that is not known yet.
    pub landing_mm: Option<[f64; 2]>,
    /// Collector of warnings, if there is one; see [`Context::warn`].
    pub warnings: Option<&'a Warnings>,
}

impl<'a> Context<'a> {
    /// Creates a context with access to files and a spectral band; all optional fields are `None`.
    #[must_use]
    pub const fn new(resources: &'a dyn Resources, grid: Grid) -> Self {
        Self { resources, grid, illuminant: None, view: None, landing_mm: None, warnings: None }
    }

    /// Warns of something that makes the picture doubtful: a [`Fault`] with its place and a hint, or a text.
    pub fn warn(&self, warning: impl Into<Warning>) {
        if let Some(warnings) = self.warnings {
            warnings.push(warning);
        }
    }
}

/// Function that builds a stage from its parameters.
pub type Build<S> = fn(&Params, &Context<'_>) -> Result<Box<S>, Faults>;

/// Function that returns the JSON Schema of a stage's own parameters: a map without `kind`.
pub type SchemaOf = fn(&mut SchemaGenerator) -> Schema;

/// One registered stage; see [`crate::register!`].
pub struct Entry<S: ?Sized + 'static> {
    /// Name of the stage in a scene (`kind: name`), kebab-case.
    pub name: &'static str,
    /// Crate that registers the stage.
    pub package: &'static str,
    /// Version of that crate.
    pub version: &'static str,
    /// Whether this stage is the default if a scene names no kind.
    pub default: bool,
    /// Schema of the stage's parameters, with their documentation.
    pub schema: SchemaOf,
    /// Function that builds the stage from its parameters.
    pub build: Build<S>,
}

impl<S: ?Sized> Entry<S> {
    /// Creates an entry whose parameters have the type `P`; see the fields.
    #[must_use]
    pub const fn new<P: JsonSchema>(
        name: &'static str,
        package: &'static str,
        version: &'static str,
        default: bool,
        build: Build<S>,
    ) -> Self {
        Self { name, package, version, default, schema: P::json_schema, build }
    }
}

/// Registers a stage: `register!(surface "axicon": AxiconParams, build);`.
///
/// The stages are `source`, `color`, `wavelengths`, `surface`, `imager`, `response` and `film`. The type of the parameters
/// implements `Deserialize` and `JsonSchema`; its doc comment is what `spectra doc` shows: a summary, more text, and optionally
/// `# Example` with a block of YAML and `# References`. `build` is a [`registry::Build`](crate::registry::Build). Write
/// `(default)` after the name of the kind that a scene gets if it names none. A kind of stage that another crate declares (see
/// [`declare!`](crate::declare)) is named by its entry: `register!(spectra_scene::OutputEntry, "spots": SpotsParams, build);`.
#[macro_export]
macro_rules! register {
    ($stage:ident $name:literal (default): $params:ty, $build:expr) => {
        $crate::register!(@entry $stage, $name, true, $params, $build);
    };
    ($stage:ident $name:literal: $params:ty, $build:expr) => {
        $crate::register!(@entry $stage, $name, false, $params, $build);
    };
    ($kind:ty, $name:literal (default): $params:ty, $build:expr) => {
        $crate::register!(@of $kind, $name, true, $params, $build);
    };
    ($kind:ty, $name:literal: $params:ty, $build:expr) => {
        $crate::register!(@of $kind, $name, false, $params, $build);
    };
    (@entry $stage:ident, $name:literal, $default:literal, $params:ty, $build:expr) => {
        $crate::register!(@of $crate::register!(@type $stage), $name, $default, $params, $build);
    };
    (@of $kind:ty, $name:literal, $default:literal, $params:ty, $build:expr) => {
        $crate::registry::inventory::submit! {
            <$kind>::new::<$params>(
                $name,
                env!("CARGO_PKG_NAME"),
                env!("CARGO_PKG_VERSION"),
                $default,
                $build,
            )
        }
    };
    (@type source) => { $crate::registry::SourceEntry };
    (@type color) => { $crate::registry::ColorEntry };
    (@type wavelengths) => { $crate::registry::SamplerEntry };
    (@type surface) => { $crate::registry::SurfaceEntry };
    (@type imager) => { $crate::registry::ImagerEntry };
    (@type response) => { $crate::registry::ResponseEntry };
    (@type film) => { $crate::registry::FilmEntry };
    (@type $other:ident) => {
        compile_error!(concat!(
            "no stage is called `",
            stringify!($other),
            "`: source, color, wavelengths, surface, imager, response or film"
        ))
    };
}

/// A kind of stage, as the registry knows it: the trait that its stages implement, or the type that they build.
pub trait Stage: 'static {
    /// Name of this kind of stage in messages and in `spectra list`.
    const NAME: &'static str;
    /// Key that names one of the registered stages in a file.
    const KEY: &'static str;
    /// Returns all entries, in the order in which the linker placed them.
    fn entries() -> Vec<&'static Entry<Self>>;
}

/// Declares a kind of stage: `declare!(SourceEntry, dyn Source, "source", "A registered source.");`. The crate that owns the
/// trait (or the type that every stage builds) does so, once. Its stages are then registered by
/// `register!(path::SourceEntry, "name": Params, build)`. The key that names a stage is `kind`, unless the last argument states
/// another one. The manifest of that crate states `links`: two versions of it in one program would be two registries.
#[macro_export]
macro_rules! declare {
    ($entry:ident, $stage:ty, $name:literal, $doc:literal) => {
        $crate::declare!($entry, $stage, $name, $doc, "kind");
    };
    ($entry:ident, $stage:ty, $name:literal, $doc:literal, $key:literal) => {
        #[doc = $doc]
        pub struct $entry($crate::registry::Entry<$stage>);

        impl $entry {
            /// Creates an entry whose parameters have the type `P`; see the fields of [`Entry`]($crate::registry::Entry).
            #[must_use]
            pub const fn new<P: $crate::registry::JsonSchema>(
                name: &'static str,
                package: &'static str,
                version: &'static str,
                default: bool,
                build: $crate::registry::Build<$stage>,
            ) -> Self {
                Self($crate::registry::Entry::new::<P>(name, package, version, default, build))
            }
        }

        $crate::registry::inventory::collect!($entry);

        impl $crate::registry::Stage for $stage {
            const NAME: &'static str = $name;
            const KEY: &'static str = $key;
            fn entries() -> Vec<&'static $crate::registry::Entry<Self>> {
                $crate::registry::inventory::iter::<$entry>.into_iter().map(|entry| &entry.0).collect()
            }
        }

        $crate::registry::inventory::submit! { $crate::registry::Declared::of::<$stage>() }
    };
}

/// A declared kind of stage; see [`crate::declare!`].
pub struct Declared(fn() -> Vec<Listed>);

impl Declared {
    /// Declares the kind of stage `S`, for the list of all registries.
    #[must_use]
    pub const fn of<S: Stage + ?Sized>() -> Self {
        Self(|| S::entries().into_iter().map(Listed::of).collect())
    }
}

inventory::collect!(Declared);

/// Lists every registered stage, sorted by kind of stage and name.
#[must_use]
pub fn list() -> Vec<Listed> {
    let mut all: Vec<Listed> = inventory::iter::<Declared>.into_iter().flat_map(|kind| (kind.0)()).collect();
    all.sort_by_key(|l| (l.stage, l.name, l.package));
    all
}

declare!(SourceEntry, dyn Source, "source", "A registered kind of source.");
declare!(ColorEntry, dyn ColorModel, "color", "A registered color model.");
declare!(SamplerEntry, dyn WavelengthSampler, "wavelengths", "A registered wavelength sampler.");
declare!(SurfaceEntry, dyn Surface, "surface", "A registered kind of surface.");
declare!(ImagerEntry, dyn Imager, "imager", "A registered kind of imager.");
declare!(ResponseEntry, dyn Response, "response", "A registered response of a detector.");
declare!(FilmEntry, dyn Film, "film", "A registered film process.");

/// A registered stage without its build function.
#[derive(Clone, Copy, Debug)]
pub struct Listed {
    /// Kind of stage.
    pub stage: &'static str,
    /// Key that names the stage in a file.
    pub key: &'static str,
    /// Name of the stage in a scene.
    pub name: &'static str,
    /// Crate that registers the stage.
    pub package: &'static str,
    /// Version of that crate.
    pub version: &'static str,
    /// Whether this stage is the default if a scene names no kind.
    pub default: bool,
    /// Schema of the stage's parameters.
    pub schema: SchemaOf,
}

impl Listed {
    fn of<S: Stage + ?Sized>(entry: &Entry<S>) -> Self {
        Self {
            stage: S::NAME,
            key: S::KEY,
            name: entry.name,
            package: entry.package,
            version: entry.version,
            default: entry.default,
            schema: entry.schema,
        }
    }

    /// Returns the documentation of the stage, as `spectra doc` shows it.
    #[must_use]
    pub fn documentation(&self) -> Documentation {
        Documentation::of(self.schema)
    }
}

/// Checks the registry: no name is registered twice, none is malformed, and each kind of stage has at most one default.
///
/// # Errors
/// One line per fault; a duplicate names both crates.
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
        for b in &all[i + 1..] {
            if a.stage == b.stage && a.name == b.name {
                faults.push(format!(
                    "{} `{}` is registered twice: by crate {} {} and by crate {} {}",
                    a.stage, a.name, a.package, a.version, b.package, b.version
                ));
            } else if a.stage == b.stage && a.default && b.default {
                faults.push(format!(
                    "{}: both `{}` of crate {} and `{}` of crate {} are marked as the default",
                    a.stage, a.name, a.package, b.name, b.package
                ));
            }
        }
    }
    if faults.is_empty() { Ok(()) } else { Err(faults) }
}

/// Builds the stage whose kind `params` name, or the default stage if they name none.
///
/// # Errors
/// The kind is unknown (the nearest known ones are named), or the stage's own parameters are wrong.
pub fn build<S: Stage + ?Sized>(params: &Params, context: &Context<'_>) -> Result<Box<S>, Faults> {
    let mut entries = S::entries();
    entries.sort_by_key(|e| e.name);
    let found = match params.kind() {
        Some(kind) => entries.iter().find(|e| e.name == kind),
        None => entries.iter().find(|e| e.default),
    };
    let Some(entry) = found else {
        let names: Vec<&str> = entries.iter().map(|e| e.name).collect();
        return Err(unknown_kind(params, S::NAME, S::KEY, &names).into());
    };
    (entry.build)(params, context)
}

fn unknown_kind(params: &Params, stage: &str, key: &str, names: &[&str]) -> Fault {
    let list = format!("spectra list {stage}");
    let known = crate::names::listed(names, &list);
    match params.kind() {
        Some(kind) => {
            let hint = crate::names::hint(kind, names, &list);
            let hint = if hint.starts_with("known: ") {
                format!("{hint}. If it comes from a plugin, `spectra build --with FOLDER` makes a program that has it")
            } else {
                hint
            };
            params.fault(key, format!("unknown {stage} `{kind}`")).hint(hint)
        }
        None => params
            .fault(key, format!("which {stage}? `{key}` is missing"))
            .hint(format!("add `{key}: ...`, one of {known}")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn listed(name: &'static str, package: &'static str) -> Listed {
        Listed {
            stage: "surface",
            key: "kind",
            name,
            package,
            version: "1.2.3",
            default: false,
            schema: <()>::json_schema,
        }
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
