//! What can be written after `spectra film`.

use clap::{Args, Subcommand};
use std::path::PathBuf;

/// `spectra film`.
#[derive(Debug, Args)]
#[command(
    long_about = "Inspect film stocks: spectral sensitivities, characteristic curves and dyes.\n\n\
        NAME is a bundled stock (see `spectra list stock`), a part of its name (`tri-x`), or a YAML file.",
    after_long_help = "Examples:\n  spectra film info kodak-tri-x-400\n  \
        spectra film plot kodak-vision3-250d-5207 -o 5207.svg"
)]
pub(crate) struct FilmArguments {
    /// The command to run.
    #[command(subcommand)]
    pub command: FilmCommand,
}

/// The commands on film stocks.
#[derive(Debug, Subcommand)]
pub(crate) enum FilmCommand {
    /// Show the data of a stock: speed, sensitivities, curves, structure, sources.
    Info(FilmInfo),
    /// Plot a stock's sensitivities, curves and dyes.
    Plot(FilmPlot),
}

/// `spectra film info`.
#[derive(Debug, Args)]
#[command(
    long_about = "Show the data of a stock: speed, sensitivities, curves, structure, and the source of each.\n\n\
        Sensitivities are relative to equal energy; the logarithm at the peak of each layer is 0. Anything the \
        stock's source does not state is absent (null).",
    after_long_help = "Example:\n  spectra film info kodak-tri-x-400 --json"
)]
pub(crate) struct FilmInfo {
    /// A bundled stock, or a YAML file.
    #[arg(value_name = "NAME")]
    pub name: String,
    /// Write a JSON object to standard output, with the full tables.
    #[arg(long)]
    pub json: bool,
}

/// `spectra film plot`.
#[derive(Debug, Args)]
#[command(
    long_about = "Plot a stock as its maker's data sheet does: spectral sensitivities, characteristic curves, and for \
        color film the spectral densities of its dyes.",
    after_long_help = "Example:\n  spectra film plot kodak-tri-x-400 -o tri-x.png"
)]
pub(crate) struct FilmPlot {
    /// A bundled stock, or a YAML file.
    #[arg(value_name = "NAME")]
    pub name: String,
    /// Output file, FILE.svg or FILE.png; NAME.svg if not given.
    #[arg(short, long, value_name = "FILE")]
    pub output: Option<PathBuf>,
}
