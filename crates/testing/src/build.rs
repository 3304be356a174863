//! Stages built from YAML text, as a scene builds them.

use spectra_core::params::{Fault, Faults, Params, SourceFile};
use spectra_core::registry::{self, Context, Stage};
use spectra_core::resources::{Resource, ResourceError, Resources};
use spectra_core::spectral::BAND;
use spectra_core::stage::{ColorModel, Film, Imager, Response, Source, WavelengthSampler};
use spectra_core::surface::Surface;
use std::borrow::Cow;
use std::path::Path;

/// Resources that look for files in the folder of the crate under test, then among the bundled ones.
struct Files;

impl Resources for Files {
    fn read(
        &self,
        path: &str,
        folders: &[&str],
        endings: &[&str],
        limit_bytes: u64,
    ) -> Result<Resource, ResourceError> {
        let endings = || std::iter::once("").chain(endings.iter().copied());
        let mut beside = endings().map(|ending| format!("{path}{ending}"));
        if let Some(name) = beside.find(|name| Path::new(name).is_file()) {
            let bytes = std::fs::read(&name).map_err(|error| ResourceError::Io(error.to_string()))?;
            if bytes.len() as u64 > limit_bytes {
                return Err(ResourceError::TooLarge(bytes.len() as u64, limit_bytes));
            }
            let folder = Path::new(&name).parent().map(Path::to_owned);
            return Ok(Resource { name, folder, bytes: Cow::Owned(bytes) });
        }
        for folder in folders {
            for name in endings().map(|ending| format!("{folder}/{path}{ending}")) {
                if let Some(bytes) = spectra_data::get(&name) {
                    return Ok(Resource { name: format!("bundled:{name}"), folder: None, bytes: Cow::Borrowed(bytes) });
                }
            }
        }
        Err(ResourceError::NotFound(Vec::new()))
    }

    fn document(&self, path: &str, folders: &[&str], endings: &[&str]) -> Result<Params, Faults> {
        let found = self.read(path, folders, endings, spectra_yaml::MAX_BYTES as u64);
        let found = found.map_err(|error| Fault::new(format!("`{path}`: {error}")))?;
        Params::section(spectra_yaml::parse_bytes(&found.name, &found.bytes)?, "")
    }
}

fn try_build<S: Stage + ?Sized>(yaml: &str) -> Result<Box<S>, Faults> {
    let node = spectra_yaml::parse(SourceFile::new("test.yaml", yaml))?;
    let context = Context::new(&Files, BAND);
    registry::build(&Params::stage(node, S::NAME)?, &context)
}

fn build<S: Stage + ?Sized>(yaml: &str) -> Box<S> {
    try_build(yaml).unwrap_or_else(|faults| panic!("{yaml}\n{faults}"))
}

macro_rules! builders {
    ($($name:ident, $stage:ty, $what:literal, $example:literal;)*) => {$(
        #[doc = concat!("Builds the ", $what, " described by a YAML text such as `", $example, "`, through the registry, \
            which knows the stages linked into the test. Files are looked for in the folder of the crate, then among the \
            bundled ones; the band is 350 to 830 nm.")]
        ///
        /// # Panics
        /// If the stage cannot be built; the message lists all faults.
        #[must_use]
        pub fn $name(yaml: &str) -> Box<$stage> {
            build(yaml)
        }
    )*};
}

builders! {
    source, dyn Source, "source", "{kind: point, distance: 2 m}";
    color, dyn ColorModel, "color model", "{kind: smooth}";
    wavelengths, dyn WavelengthSampler, "wavelength sampler", "{kind: uniform}";
    surface, dyn Surface, "surface", "{kind: sphere, radius: 50}";
    imager, dyn Imager, "imager", "{kind: xyz, format: 135, resolution: [96, 64]}";
    response, dyn Response, "response", "{kind: photopic}";
    film, dyn Film, "film", "{stock: ilford-ortho-plus, exposure: 1/60 s}";
}

/// Asserts that building a stage from a YAML text fails with a fault at `key` (such as `radius` or `color.R`), as a user who makes
/// this mistake would see it. `stage` is the kind of stage, such as `surface`.
///
/// # Panics
/// If the stage is built, if all faults are at other keys, or if there is no such kind of stage.
pub fn assert_fault(stage: &str, yaml: &str, key: &str) {
    let faults = match stage {
        "source" => try_build::<dyn Source>(yaml).err(),
        "color" => try_build::<dyn ColorModel>(yaml).err(),
        "wavelengths" => try_build::<dyn WavelengthSampler>(yaml).err(),
        "surface" => try_build::<dyn Surface>(yaml).err(),
        "imager" => try_build::<dyn Imager>(yaml).err(),
        "response" => try_build::<dyn Response>(yaml).err(),
        "film" => try_build::<dyn Film>(yaml).err(),
        other => panic!("no stage is called `{other}`"),
    };
    let Some(faults) = faults else { panic!("{stage} {yaml}: expected a fault at `{key}`, but it was built") };
    let path = format!("{stage}.{key}");
    // A missing or unknown key is named in the message; the fault's path is that of the map.
    let quoted = format!("`{key}`");
    let found = faults.iter().any(|fault| fault.path == path || fault.message.contains(&quoted));
    assert!(found, "{stage} {yaml}: expected a fault at `{key}`, found\n{faults}");
}
