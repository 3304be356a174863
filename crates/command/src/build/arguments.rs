//! What can be written after `spectra build`.

use clap::{Args, ValueEnum};
use std::path::PathBuf;

/// `spectra build`.
#[derive(Debug, Args)]
#[command(
    long_about = "Build a program of your own: spectra with your plugins in it.\n\n\
        Each plugin is a crate, as `spectra new plugin` makes one. Cargo builds a generated program that holds the built-in \
        stages and those of the plugins; afterwards it is asked what it knows, and the stages that each plugin added are \
        shown. The sources of spectra itself come out of this program; cargo fetches other crates where it does not have \
        them.\n\n\
        The first build compiles everything (a few minutes), later ones only what has changed. Built files are kept in \
        CARGO_TARGET_DIR, or else in the cache: SPECTRA_CACHE, or the system's folder for caches.",
    after_long_help = "Example: two plugins\n  \
        spectra build --with axicon --with cyanotype -o spectra-mine\n  \
        ./spectra-mine run axicon/scene.yaml"
)]
pub(crate) struct BuildArguments {
    /// Folder of a plugin's crate, or its Cargo.toml; may be given again.
    #[arg(long, value_name = "PATH", required = true)]
    pub with: Vec<PathBuf>,
    /// The program to write.
    #[arg(short, long, value_name = "FILE", default_value = "./spectra-mine")]
    pub output: PathBuf,
    /// Write over a file that is no program with spectra in it.
    #[arg(long)]
    pub force: bool,
    /// A checkout of spectra to build with, in place of the sources in this program.
    #[arg(long, value_name = "PATH")]
    pub core: Option<PathBuf>,
    /// Fetch nothing: use the crates that cargo has already.
    #[arg(long)]
    pub offline: bool,
    /// How much the compiler optimizes; dev is built sooner and renders slower.
    #[arg(long, value_enum, default_value_t = Profile::Release)]
    pub profile: Profile,
}

/// A profile of cargo.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum Profile {
    /// For pictures.
    Release,
    /// For a quick look whether it works.
    Dev,
}

impl Profile {
    /// Cargo's name of it.
    pub(crate) fn name(self) -> &'static str {
        match self {
            Self::Release => "release",
            Self::Dev => "dev",
        }
    }
}
