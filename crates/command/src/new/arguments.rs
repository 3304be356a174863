//! What can be written after `spectra new`.

use clap::{Args, Subcommand, ValueEnum};
use std::path::PathBuf;

/// `spectra new`.
#[derive(Debug, Args)]
#[command(
    after_long_help = "Example: a surface of your own, in the folder ripple\n  spectra new plugin ripple --stage surface"
)]
pub(crate) struct NewArguments {
    /// What to create.
    #[command(subcommand)]
    pub command: NewCommand,
}

/// What can be made.
#[derive(Debug, Subcommand)]
pub(crate) enum NewCommand {
    /// Create a plugin: a crate with one source file, its tests and a scene.
    Plugin(NewPlugin),
    /// Create a scene file that is ready to render.
    Scene(NewFile),
    /// Create a lens file that is ready to use.
    Lens(NewFile),
    /// Create a film stock that is like another one, to be changed by a data sheet.
    Film(NewFilm),
}

/// `spectra new plugin`.
#[derive(Debug, Args)]
#[command(
    long_about = "Create a plugin: a crate with one source file, its tests and a scene.\n\n\
        The new plugin compiles, passes its tests and renders without changes: a surface is a cubic phase plate, a \
        film a tintype (with --layers, a color film), a source a ring lamp, a sampler an exponential density, an imager a radiometer. Edit it to do \
        what you want. There is no source code to download: the program includes its own.",
    after_long_help = "Example:\n  spectra new plugin ripple --stage surface\n  cd ripple\n  \
        cargo test --release\n  spectra build --with . -o ./spectra-mine\n  ./spectra-mine run scene.yaml\n\n\
        Example: a color film of three layers\n  spectra new plugin tricolor --stage film --layers 3"
)]
pub(crate) struct NewPlugin {
    /// Name of the crate, and its `kind` in a scene: lower-case letters, digits and hyphens.
    #[arg(value_name = "NAME")]
    pub name: String,
    /// Kind of stage to create.
    #[arg(long, value_enum)]
    pub stage: Stage,
    /// For a film: start from one with this many color layers, 1 to 16.
    #[arg(long, value_name = "COUNT", value_parser = clap::value_parser!(u8).range(1..=16))]
    pub layers: Option<u8>,
    /// Folder to create it in.
    #[arg(long, value_name = "FOLDER", default_value = ".")]
    pub path: PathBuf,
    /// A checkout of spectra to test against, instead of the sources included in this program.
    #[arg(long, value_name = "PATH")]
    pub core: Option<PathBuf>,
}

/// `spectra new scene`, `spectra new lens`.
#[derive(Debug, Args)]
pub(crate) struct NewFile {
    /// Name of the file; `.yaml` is added.
    #[arg(value_name = "NAME")]
    pub name: String,
    /// Folder to create it in.
    #[arg(long, value_name = "FOLDER", default_value = ".")]
    pub path: PathBuf,
}

/// `spectra new film`.
#[derive(Debug, Args)]
#[command(
    long_about = "Create a film stock that is like another one, to be changed by a data sheet.\n\n\
        The file takes all its figures from the other stock and has the first curve of each layer written out, so it develops at once. Overwrite what \
        the sheet says otherwise; what is left out stays that of the other stock.",
    after_long_help = "Example: a film to be changed by a data sheet\n  spectra new film my-pan --like tri-x"
)]
pub(crate) struct NewFilm {
    /// Name of the file; `.yaml` is added.
    #[arg(value_name = "NAME")]
    pub name: String,
    /// The stock that it is like: a bundled one, or a file.
    #[arg(long, value_name = "STOCK", default_value = "kodak-tri-x-400")]
    pub like: String,
    /// Folder to create it in.
    #[arg(long, value_name = "FOLDER", default_value = ".")]
    pub path: PathBuf,
}

/// A kind of stage that there is a template for.
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
    /// The section of a scene that it is written in, and the word in `register!`.
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

    /// What people call it.
    pub(super) fn noun(self) -> &'static str {
        match self {
            Self::Sampler => "sampler",
            other => other.word(),
        }
    }
}
