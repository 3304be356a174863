//! What can be written after `spectra spectrum`.

use clap::{Args, Subcommand, ValueEnum};
use std::path::PathBuf;

/// `spectra spectrum`.
#[derive(Debug, Args)]
#[command(
    long_about = "Look at spectra: their color in figures, and pictures of them.\n\n\
        NAME is a bundled spectrum (see `spectra spectrum list`), a column of one (`colorchecker#red`), a CSV file, or is \
        written out: blackbody:5800 and daylight:5500 (K), line:C' or line:632.8, gaussian:550,20 (center and standard \
        deviation, nm), rectangle:500,600 (nm), constant:1.",
    after_long_help = "Examples:\n  spectra spectrum info D65\n  \
        spectra spectrum plot A D65 blackbody:5800 -o lights.svg\n  \
        spectra spectrum plot D50 LED-B3 line:e --chromaticity -o diagram.png"
)]
pub(crate) struct SpectrumArguments {
    /// What to do.
    #[command(subcommand)]
    pub command: SpectrumCommand,
}

/// The commands on spectra.
#[derive(Debug, Subcommand)]
pub(crate) enum SpectrumCommand {
    /// Show a spectrum in figures: color, temperature, dominant wavelength.
    Info(SpectrumInfo),
    /// Draw spectra, or their chromaticities.
    Plot(SpectrumPlot),
    /// List the bundled spectra.
    List(SpectrumList),
}

/// Whose eye sees.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum ObserverName {
    /// CIE 1931, 2 degrees.
    #[value(name = "1931")]
    Cie1931,
    /// CIE 1964, 10 degrees.
    #[value(name = "1964")]
    Cie1964,
    /// CIE 2015 (170-2), 2 degrees.
    #[value(name = "2015-2")]
    Cie2015Narrow,
    /// CIE 2015 (170-2), 10 degrees.
    #[value(name = "2015-10")]
    Cie2015Wide,
}

/// `spectra spectrum info`.
#[derive(Debug, Args)]
#[command(
    long_about = "Show a spectrum in figures: color, temperature, dominant wavelength.\n\n\
        A light is shown at Y = 100; a transmittance or a reflectance under an illuminant whose white has Y = 100; a \
        sensitivity has no color. Lab, dominant wavelength and purity are against the white of the illuminant, for lights \
        too. Correlated color temperature, dominant wavelength, purity and sRGB are those of the CIE 1931 observer, \
        whichever is asked for.",
    after_long_help = "Example: a patch in the light of a lamp\n  spectra spectrum info colorchecker#red --illuminant A"
)]
pub(crate) struct SpectrumInfo {
    /// A bundled spectrum, a CSV file, or a spectrum written out (blackbody:5800).
    #[arg(value_name = "NAME")]
    pub name: String,
    /// The observer of XYZ, xy and Lab.
    #[arg(long, value_enum, value_name = "YEAR", default_value = "1931")]
    pub observer: ObserverName,
    /// The light on a surface or behind a filter, and the white that Lab refers to.
    #[arg(long, value_name = "NAME", default_value = "D65")]
    pub illuminant: String,
    /// A JSON object on standard output; what a spectrum does not have is null.
    #[arg(long)]
    pub json: bool,
}

/// `spectra spectrum plot`.
#[derive(Debug, Args)]
#[command(
    long_about = "Draw spectra over 350-830 nm, with the colors of the wavelengths under them.\n\n\
        With --chromaticity, draw the CIE 1931 diagram with the points of the spectra, the gamuts of sRGB, Rec. 2020 and \
        ACEScg, and the chromaticities of black bodies.",
    after_long_help = "Example:\n  spectra spectrum plot mercury -o mercury.png"
)]
pub(crate) struct SpectrumPlot {
    /// Bundled spectra, CSV files, or spectra written out (blackbody:5800).
    #[arg(value_name = "NAME", required = true)]
    pub names: Vec<String>,
    /// File to write: FILE.svg or FILE.png.
    #[arg(short, long, value_name = "FILE")]
    pub output: PathBuf,
    /// The chromaticity diagram, not the spectra.
    #[arg(long)]
    pub chromaticity: bool,
    /// The light on surfaces and behind filters in the chromaticity diagram.
    #[arg(long, value_name = "NAME", default_value = "D65", requires = "chromaticity")]
    pub illuminant: String,
}

/// `spectra spectrum list`.
#[derive(Debug, Args)]
pub(crate) struct SpectrumList {
    /// A JSON list on standard output.
    #[arg(long)]
    pub json: bool,
}
