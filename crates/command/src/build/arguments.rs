//! Command-line arguments of `spectra build`.

use clap::{Args, ValueEnum};
use std::path::PathBuf;

/// Arguments of `spectra build`.
#[derive(Debug, Args)]
#[command(
    long_about = "Build a version of the program that includes your plugins.\n\n\
        Each plugin is a crate like the ones that `spectra new plugin` creates. Cargo builds a generated program with \
        the built-in stages and those of the plugins, and the stages that each plugin added are listed. The sources of \
        `spectra` itself are included in this program; cargo downloads any other crates that it does not have yet.\n\n\
        The first build compiles everything (a few minutes), later ones only the changes. Build files are kept in \
        CARGO_TARGET_DIR, or else in the cache: SPECTRA_CACHE, or the system's cache folder.",
    after_long_help = "Example: two plugins\n  \
        spectra build --with axicon --with cyanotype -o spectra-mine\n  \
        ./spectra-mine run axicon/scene.yaml"
)]
pub(crate) struct BuildArguments {
    /// Folder of a plugin's crate, or its Cargo.toml; can be repeated.
    #[arg(long, value_name = "PATH", required = true)]
    pub with: Vec<PathBuf>,
    /// The program to write.
    #[arg(short, long, value_name = "FILE", default_value = "./spectra-mine")]
    pub output: PathBuf,
    /// Overwrite a file even if it is not a build of spectra.
    #[arg(long)]
    pub force: bool,
    /// A checkout of spectra to build with, instead of the sources included in this program.
    #[arg(long, value_name = "PATH")]
    pub core: Option<PathBuf>,
    /// Download nothing: use only the crates that cargo already has.
    #[arg(long)]
    pub offline: bool,
    /// How much the compiler optimizes; dev builds faster and renders slower.
    #[arg(long, value_enum, default_value_t = Profile::Release)]
    pub profile: Profile,
}

/// Build profile of cargo.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum Profile {
    /// Optimized, for rendering.
    Release,
    /// Quick to build, to check that it works.
    Dev,
}

impl Profile {
    /// Name of this profile for cargo.
    pub(crate) fn name(self) -> &'static str {
        match self {
            Self::Release => "release",
            Self::Dev => "dev",
        }
    }
}
