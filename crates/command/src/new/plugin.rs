//! `spectra new plugin`: creates the crate of a plugin.

use super::arguments::{NewPlugin, Stage};
use super::files::{Folder, filled, typed};
use super::name;
use crate::console;
use crate::outcome::{DONE, Failure, Outcome};
use crate::sources::{Sources, Unpack, profiles, target, toml_path};
use spectra_core::params::Fault;

const README: &str = include_str!("templates/README.md");

/// Returns the templates of the source, the scene and, if the scene needs it, the lens. `layers` selects the film with layers.
fn templates(stage: Stage, layers: bool) -> (&'static str, &'static str, Option<&'static str>) {
    match stage {
        Stage::Surface => (
            include_str!("templates/surface/lib.rs"),
            include_str!("templates/surface/scene.yaml"),
            Some(include_str!("templates/surface/lens.yaml")),
        ),
        Stage::Film if layers => {
            (include_str!("templates/film-layers/lib.rs"), include_str!("templates/film-layers/scene.yaml"), None)
        }
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

/// Creates the crate and prints the next steps.
pub(super) fn plugin(arguments: &NewPlugin, unpack: Unpack) -> Outcome {
    let NewPlugin { name, stage, layers, path, core } = arguments;
    if layers.is_some() && *stage != Stage::Film {
        let fault = Fault::new(format!("--layers: a {} has no layers", stage.noun()));
        return Err(fault.hint("use --layers only with --stage film").into());
    }
    name::check_plugin(name, stage.word())?;
    Folder::must_exist(path)?;
    let folder = path.join(name);
    if folder.symlink_metadata().is_ok() {
        let fault = Fault::new(format!("{} already exists", folder.display()));
        return Err(fault.hint("choose another name, or another folder with --path").into());
    }
    let sources = Sources::find(core.as_deref(), unpack)?;
    let (source, scene, lens) = templates(*stage, layers.is_some());
    let mut files = Folder::new(folder.clone());
    files.file("Cargo.toml", manifest(name, *stage, &sources)?);
    files.file("Cargo.lock", sources.read("Cargo.lock")?);
    files.file(".cargo/config.toml", cargo_config()?);
    files.file(".gitignore", "/.cargo\n/target\n/out\n/spectra-mine\n".to_owned());
    let readme = filled(README, name)
        .replace("{{noun}}", stage.noun())
        .replace("{{Noun}}", &name::camel_case(stage.noun()))
        .replace("{{stage}}", stage.word());
    files.file("README.md", readme);
    files.file("rustfmt.toml", "use_small_heuristics = \"Max\"\n".to_owned());
    let count = layers.map_or_else(String::new, |count| count.to_string());
    files.file("src/lib.rs", filled(source, name).replace("{{layers}}", &count));
    files.file("scene.yaml", filled(scene, name));
    if let Some(lens) = lens {
        files.file("lens.yaml", filled(lens, name));
    }
    files.write()?;
    console::out(&format!(
        "{} is ready: its {} is src/lib.rs; next:\n  cd {}\n  cargo test --release\n  spectra build --with . -o ./spectra-mine\n  \
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
         # Choose your own; `spectra build` lists it in the `--licenses` of the program.\n\
         license = \"MIT OR Apache-2.0\"\n\
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
         # Where this crate's own tests find spectra on this machine; other machines need other paths. `spectra build` brings\n\
         # its own sources and ignores this.\n\
         [patch.crates-io]\n\
         spectra-core = {{ path = {core} }}\n\
         spectra-testing = {{ path = {testing} }}\n\
         \n\
         # The settings of spectra itself, so that `spectra build` can use what `cargo test --release` compiles.\n\
         {profiles}",
        profiles = profiles(&sources.read("Cargo.toml")?),
        rust = env!("CARGO_PKG_RUST_VERSION"),
        title = super::name::camel_case(stage.noun()),
    ))
}

/// Returns the cargo configuration of the plugin. It sets the target folder of `spectra build`, so that crates with the same features
/// are compiled only once.
fn cargo_config() -> Result<String, Failure> {
    Ok(format!(
        "# The folder that `spectra build` uses too. It exists on this machine only, so git ignores this file.\n[build]\ntarget-dir = {}\n",
        toml_path(&target()?)?
    ))
}
