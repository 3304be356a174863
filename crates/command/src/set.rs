//! `--set`: values that override those of a file.

use clap::Args;

/// Argument `--set`, shared by several commands.
#[derive(Debug, Args)]
pub(crate) struct Set {
    /// Set a value in the scene, as if it were written in the file; can be repeated.
    #[arg(
        long = "set",
        value_name = "PATH=VALUE",
        long_help = "Set a value in the scene, as if it were written in the file; can be repeated.\n\
            Examples: --set film.exposure=\"1/125 s\"  --set lens.f-number=f/4  --set output=[exr]"
    )]
    pub overrides: Vec<String>,
}
