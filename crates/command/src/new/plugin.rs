//! `spectra new plugin`.

use super::arguments::{NewPlugin, Stage};
use super::files::{Folder, filled, typed};
use super::name;
use crate::console;
use crate::outcome::{DONE, Failure, Outcome};
use crate::sources::{Sources, Unpack, toml_path};
use spectra_core::params::Fault;

const README: &str = include_str!("templates/README.md");

/// Source, scene, and, where the scene needs one of its own, lens.
fn templates(stage: Stage) -> (&'static str, &'static str, Option<&'static str>) {
    match stage {
        Stage::Surface => (
            include_str!("templates/surface/lib.rs"),
            include_str!("templates/surface/scene.yaml"),
            Some(include_str!("templates/surface/lens.yaml")),
        ),
        Stage::Film => (include_str!("templates/film/lib.rs"), include_str!("templates/film/scene.yaml"), None),
        Stage::Source => (include_str!("templates/source/lib.rs"), include_str!("templates/source/scene.yaml"), None),
        Stage::Sampler => {
            (include_str!("templates/wavelengths/lib.rs"), include_str!("templates/wavelengths/scene.yaml"), None)
        }
        Stage::Response => {
            (include_str!("templates/response/lib.rs"), include_str!("templates/response/scene.yaml"), None)
        }
        Stage::Imager => (include_str!("templates/imager/lib.rs"), include_str!("templates/imager/scene.yaml"), None),
    }
}

/// Makes it.
pub(super) fn plugin(arguments: &NewPlugin, unpack: Unpack) -> Outcome {
    let NewPlugin { name, stage, path, core } = arguments;
    name::check_plugin(name, stage.word())?;
    Folder::must_exist(path)?;
    let folder = path.join(name);
    if folder.symlink_metadata().is_ok() {
        let fault = Fault::new(format!("{} is there already", folder.display()));
        return Err(fault.hint("choose another name, or another folder by --path").into());
    }
    let sources = Sources::find(core.as_deref(), unpack)?;
    let (source, scene, lens) = templates(*stage);
    let mut files = Folder::new(folder.clone());
    files.file("Cargo.toml", manifest(name, *stage, &sources)?);
    files.file("Cargo.lock", sources.read("Cargo.lock")?);
    files.file(".gitignore", "/target\n/out\n/spectra-mine\n".to_owned());
    let readme = filled(README, name)
        .replace("{{noun}}", stage.noun())
        .replace("{{Noun}}", &name::camel_case(stage.noun()))
        .replace("{{stage}}", stage.word());
    files.file("README.md", readme);
    files.file("rustfmt.toml", "use_small_heuristics = \"Max\"\n".to_owned());
    files.file("src/lib.rs", filled(source, name));
    files.file("scene.yaml", filled(scene, name));
    if let Some(lens) = lens {
        files.file("lens.yaml", filled(lens, name));
    }
    files.write()?;
    console::out(&format!(
        "{} is ready: its {} is src/lib.rs; next:\n  cd {}\n  cargo test\n  spectra build --with . -o ./spectra-mine\n  \
         ./spectra-mine run scene.yaml\n",
        typed(&folder),
        stage.noun(),
        typed(&folder)
    ))?;
    Ok(DONE)
}

fn manifest(name: &str, stage: Stage, sources: &Sources) -> Result<String, Failure> {
    let version = semver::Version::parse(crate::version::VERSION).expect("cargo checks the version of a package");
    let wanted = match (version.major, version.minor) {
        (0, minor) => format!("0.{minor}"),
        (major, _) => major.to_string(),
    };
    let core = toml_path(&sources.crate_folder("crates/core"))?;
    let testing = toml_path(&sources.crate_folder("crates/testing"))?;
    Ok(format!(
        "[package]\n\
         name = \"{name}\"\n\
         version = \"0.1.0\"\n\
         edition = \"2024\"\n\
         rust-version = \"{rust}\"\n\
         description = \"{title} for spectra, the open spectral camera\"\n\
         publish = false\n\
         \n\
         [dependencies]\n\
         schemars = \"1\"\n\
         serde = {{ version = \"1\", features = [\"derive\"] }}\n\
         spectra-core = \"{wanted}\"\n\
         \n\
         [dev-dependencies]\n\
         spectra-testing = \"{wanted}\"\n\
         \n\
         # Where this crate's own tests find spectra on this machine: another path on another one. `spectra build` brings its\n\
         # own sources and does not look here.\n\
         [patch.crates-io]\n\
         spectra-core = {{ path = {core} }}\n\
         spectra-testing = {{ path = {testing} }}\n\
         \n\
         # Numerical tests are slow where nothing is optimized.\n\
         [profile.dev]\n\
         opt-level = 1\n\
         debug = \"line-tables-only\"\n",
        rust = env!("CARGO_PKG_RUST_VERSION"),
        title = super::name::camel_case(stage.noun()),
    ))
}
