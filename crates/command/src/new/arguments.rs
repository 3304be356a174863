//! Command-line arguments of `spectra new`.

use clap::{Args, Subcommand, ValueEnum};
use std::path::PathBuf;

/// Arguments of `spectra new`.
#[derive(Debug, Args)]
#[command(
    after_long_help = "Example: a surface of your own, in the folder ripple\n  spectra new plugin ripple --stage surface"
)]
pub(crate) struct NewArguments {
    /// The command to run.
    #[command(subcommand)]
    pub command: NewCommand,
}

/// The commands of `spectra new`.
#[derive(Debug, Subcommand)]
pub(crate) enum NewCommand {
    /// Create a plugin: a crate with one source file, its tests and a scene.
    Plugin(NewPlugin),
    /// Create a scene file that is ready to render.
    Scene(NewFile),
    /// Create a lens file that is ready to use.
    Lens(NewFile),
    /// Create a film stock based on another one, to be edited to match a data sheet.
    Film(NewFilm),
}

/// Arguments of `spectra new plugin`.
#[derive(Debug, Args)]
#[command(
    long_about = "Create a plugin: a crate with one source file, its tests and a scene.\n\n\
        The new plugin compiles, passes its tests and renders without changes. A surface is a cubic phase plate, a film a \
        tintype (with --layers, a color film), a source a ring lamp, a sampler an exponential density, an imager a radiometer, a \
        response the eye of a honey bee. Edit it to do what you want. You need not download the source code of spectra: this \
        program includes it.",
    after_long_help = "Example:\n  spectra new plugin ripple --stage surface\n  cd ripple\n  \
        cargo test --release\n  spectra build --with . -o ./spectra-mine\n  ./spectra-mine run scene.yaml\n\n\
        Example: a color film of three layers\n  spectra new plugin tricolor --stage film --layers 3"
)]
pub(crate) struct NewPlugin {
    /// Name of the crate, and of its `kind` in a scene: lower-case letters, digits and hyphens.
    #[arg(value_name = "NAME")]
    pub name: String,
    /// Kind of stage to create.
    #[arg(long, value_enum)]
    pub stage: Stage,
    /// Start from a film with this many color layers, 1 to 16; only with --stage film.
    #[arg(long, value_name = "COUNT", value_parser = clap::value_parser!(u8).range(1..=16))]
    pub layers: Option<u8>,
    /// Folder to create the plugin in.
    #[arg(long, value_name = "FOLDER", default_value = ".")]
    pub path: PathBuf,
    /// A checkout of spectra to test against, instead of the sources included in this program.
    #[arg(long, value_name = "PATH")]
    pub core: Option<PathBuf>,
}

/// Arguments of `spectra new scene` and `spectra new lens`, and of other commands that create a file.
#[derive(Debug, Args)]
pub(crate) struct NewFile {
    /// Name of the file; `.yaml` is added.
    #[arg(value_name = "NAME")]
    pub name: String,
    /// Folder to create the file in.
    #[arg(long, value_name = "FOLDER", default_value = ".")]
    pub path: PathBuf,
}

/// Arguments of `spectra new film`.
#[derive(Debug, Args)]
#[command(
    long_about = "Create a film stock based on another one, to be edited to match a data sheet.\n\n\
        The file takes all its values from the other stock and has the first curve of each layer written out, so it can be used at \
        once. Overwrite the values that the sheet gives; values that are left out stay those of the other stock.",
    after_long_help = "Example: a film based on Tri-X\n  spectra new film my-pan --like tri-x"
)]
pub(crate) struct NewFilm {
    /// The stock to start from: a bundled one, or a file.
    #[arg(long, value_name = "STOCK", default_value = "kodak-tri-x-400")]
    pub like: String,
    #[command(flatten)]
    pub file: NewFile,
}

/// Kind of stage that has a template for plugins.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum Stage {
    /// An optical surface.
    Surface,
    /// A film process.
    Film,
    /// A light source.
    Source,
    /// A wavelength sampling strategy.
    Sampler,
    /// An imager, which records light.
    Imager,
    /// The spectral response of a detector, per channel.
    Response,
}

impl Stage {
    /// Returns the section of a scene that this stage belongs to, which is also its word in `register!`.
    pub(super) fn word(self) -> &'static str {
        match self {
            Self::Surface => "surface",
            Self::Film => "film",
            Self::Source => "source",
            Self::Sampler => "wavelengths",
            Self::Imager => "imager",
            Self::Response => "response",
        }
    }

    /// Returns the usual name of this stage.
    pub(super) fn noun(self) -> &'static str {
        match self {
            Self::Sampler => "sampler",
            other => other.word(),
        }
    }
}
