//! What can be written after `spectra new`.

use clap::{Args, Subcommand, ValueEnum};
use std::path::PathBuf;

/// `spectra new`.
#[derive(Debug, Args)]
#[command(
    after_long_help = "Example: a surface of your own, in the folder ripple\n  spectra new plugin ripple --stage surface"
)]
pub(crate) struct NewArguments {
    /// What to make.
    #[command(subcommand)]
    pub command: NewCommand,
}

/// What can be made.
#[derive(Debug, Subcommand)]
pub(crate) enum NewCommand {
    /// Start a plugin: a crate with one source file, its tests and a scene.
    Plugin(NewPlugin),
    /// Start a scene file that renders as it is.
    Scene(NewFile),
    /// Start a lens file that works as it is.
    Lens(NewFile),
}

/// `spectra new plugin`.
#[derive(Debug, Args)]
#[command(
    long_about = "Start a plugin: a crate with one source file, its tests and a scene.\n\n\
        What is made compiles, passes its tests and renders as it is: a surface is a cubic phase plate, a film a tintype, a \
        source a ring lamp, a sampler an exponential density, an imager a radiometer. Change it into what you have in mind. \
        Nothing of spectra has to be downloaded: its sources come out of this program.",
    after_long_help = "Example:\n  spectra new plugin ripple --stage surface\n  cd ripple\n  \
        cargo test\n  spectra build --with . -o ./spectra-mine\n  ./spectra-mine run scene.yaml"
)]
pub(crate) struct NewPlugin {
    /// Its name: that of the crate, and `kind` in a scene. Lower-case letters, digits and hyphens.
    #[arg(value_name = "NAME")]
    pub name: String,
    /// What it is.
    #[arg(long, value_enum)]
    pub stage: Stage,
    /// Folder to make it in.
    #[arg(long, value_name = "FOLDER", default_value = ".")]
    pub path: PathBuf,
    /// A checkout of spectra to test against, in place of the sources in this program.
    #[arg(long, value_name = "PATH")]
    pub core: Option<PathBuf>,
}

/// `spectra new scene`, `spectra new lens`.
#[derive(Debug, Args)]
pub(crate) struct NewFile {
    /// Its name; `.yaml` is added.
    #[arg(value_name = "NAME")]
    pub name: String,
    /// Folder to make it in.
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
    /// What shines.
    Source,
    /// A way to draw wavelengths.
    Sampler,
    /// What records light.
    Imager,
    /// What a detector sees, by channel.
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
