//! Command-line arguments of `spectra spectrum`.

use crate::eye::EyeName;
use crate::report::JsonReport;
use clap::{Args, Subcommand, ValueEnum};
use std::path::PathBuf;

/// Arguments of `spectra spectrum`.
#[derive(Debug, Args)]
#[command(
    long_about = "Inspect spectra: color values, plots, fits, color models.\n\n\
        NAME is a bundled spectrum (see `spectra list spectrum`), a column of one (`colorchecker#red`), a table \
        (.csv, .txt, .dat, .tsv) or YAML file, or an expression: blackbody:5800, daylight:5500 and 5600K (K), line:C' \
        or line:632.8, lines:404.66=1,e=2 (with powers), gaussian:550,20 (center and standard deviation, nm), \
        rectangle:500,600 (nm), constant:1, FdC and F'eC' (sets of lines), rgb-lines (three lines that make white), \
        rgb:#ff8040 (a color by the default color model, or by another one: 'rgb:#ff8040 by gaussians'), srgb-r, srgb-g, \
        srgb-b and srgb-w, function:exp(-((w-550)/20)^4) (a formula of the wavelength w in nm). These can be combined with \
        + - * / ^ and parentheses, with spaces around + - and /: 'D65 + 5000 * line:e', '1 - wratten-25', 'D65 / A / 10', \
        'wratten-12^2'.",
    after_long_help = "Examples:\n  spectra spectrum info D65\n  \
        spectra spectrum plot A D65 blackbody:5800 -o lights.svg\n  \
        spectra spectrum plot D50 LED-B3 line:e --chromaticity -o diagram.png\n  \
        spectra spectrum fit ilford-ortho-plus --terms 6 -o ortho.yaml\n  \
        spectra spectrum color 255 128 64"
)]
pub(crate) struct SpectrumArguments {
    /// The command to run.
    #[command(subcommand)]
    pub command: SpectrumCommand,
}

/// The commands of `spectra spectrum`.
#[derive(Debug, Subcommand)]
pub(crate) enum SpectrumCommand {
    /// Show the color values of a spectrum: color, temperature, dominant wavelength.
    Info(SpectrumInfo),
    /// Plot spectra or their chromaticities.
    Plot(SpectrumPlot),
    /// Fit signed Gaussian terms to a spectrum.
    Fit(SpectrumFit),
    /// Multiply spectra as sums of Gaussian terms: exact integrals, and estimates from one term of each.
    Product(SpectrumProduct),
    /// Draw wavelengths of a light in the same way as a render, each with its weight.
    Draw(SpectrumDraw),
    /// Convert a color to a spectrum with each color model, and back to a color.
    Color(SpectrumColor),
    /// Measure how well each color model preserves colors.
    Models(SpectrumModels),
    /// List the bundled spectra.
    List(SpectrumList),
}

/// Standard observer.
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

/// Coordinates of the chromaticity diagram.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum DiagramName {
    /// CIE 1931 x, y.
    #[value(name = "1931")]
    Cie1931,
    /// CIE 1976 u', v'.
    #[value(name = "1976")]
    Cie1976,
}

/// Kind of spectrum.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum KindName {
    /// Spectrum of a light source.
    Emission,
    /// Transmittance of a filter.
    Transmittance,
    /// Reflectance of a surface.
    Reflectance,
    /// Sensitivity of a detector.
    Sensitivity,
}

/// Arguments of `spectra spectrum info`.
#[derive(Debug, Args)]
#[command(
    long_about = "Show the figures of a spectrum: peak, centroid, width, color, temperature, dominant wavelength; for a light also \
        power, luminous efficacy and color rendering (CIE Ra and TM-30 Rf).\n\n\
        A light is scaled to Y = 100. A transmittance or a reflectance is shown under an illuminant whose white has \
        Y = 100. A sensitivity has no color. Lab, dominant wavelength and purity are relative to the white of the \
        illuminant, even for lights. Correlated color temperature, dominant wavelength, purity and sRGB always use the \
        CIE 1931 observer, whatever --observer says.",
    after_long_help = "Example: a patch in the light of a lamp\n  spectra spectrum info colorchecker#red --illuminant A"
)]
pub(crate) struct SpectrumInfo {
    /// A bundled spectrum, a CSV file, or an expression (blackbody:5800).
    #[arg(value_name = "NAME")]
    pub name: String,
    /// Kind of spectrum, overriding a header such as `wavelength_nm,transmittance`; a file that states `kind` keeps it.
    #[arg(long = "as", value_enum, value_name = "KIND")]
    pub kind: Option<KindName>,
    /// Observer for XYZ, xy and Lab.
    #[arg(long, value_enum, value_name = "YEAR", default_value = "1931")]
    pub observer: ObserverName,
    /// Light on a surface or behind a filter, and reference white for Lab.
    #[arg(long, value_name = "NAME", default_value = "D65")]
    pub illuminant: String,
    /// Wavelengths at which to show the value of the spectrum, in nm or as letters of lines: 546.07,C'.
    #[arg(long, value_name = "NM", value_delimiter = ',')]
    pub wavelength_nm: Vec<String>,
    /// Write a JSON object to standard output; values that do not apply to the spectrum are null.
    #[arg(long)]
    pub json: bool,
}

/// Arguments of `spectra spectrum plot`.
#[derive(Debug, Args)]
#[command(
    long_about = "Plot spectra over 350-830 nm, with the colors of the wavelengths below the curves.\n\n\
        A table with several curves is plotted with all of them: the matching functions of an observer (cie-1931-2deg), also with \
        negative lobes (srgb-1931-2deg, cie-rgb-1931), and cones (cone-fundamentals-2deg). Up to 28 curves differ in color or dashes.\n\n\
        --chromaticity plots the spectra as points in the CIE 1931 diagram, with the gamuts of sRGB, Rec. 2020 and ACEScg, and the \
        chromaticities of black bodies. --diagram selects the diagram of 1976, --observer another observer. A NAME can then also be \
        a point of your own: xy:0.31,0.33, or uv:0.198,0.468 for CIE 1976.",
    after_long_help = "Examples:\n  spectra spectrum plot mercury -o mercury.png\n  \
        spectra spectrum plot --chromaticity --diagram 1976 D65 FL2 rgb:#ff8040 xy:0.31,0.33 -o diagram.png"
)]
pub(crate) struct SpectrumPlot {
    /// Bundled spectra, CSV files, or expressions (blackbody:5800).
    #[arg(value_name = "NAME", required = true)]
    pub names: Vec<String>,
    /// Output file, FILE.svg or FILE.png; if not given, NAME.svg after the first name.
    #[arg(short, long, value_name = "FILE")]
    pub output: Option<PathBuf>,
    /// Kind of spectrum, for files that do not state it.
    #[arg(long = "as", value_enum, value_name = "KIND")]
    pub kind: Option<KindName>,
    /// Plot the chromaticity diagram instead of the spectra.
    #[arg(long)]
    pub chromaticity: bool,
    /// Light on surfaces and behind filters in the chromaticity diagram.
    #[arg(long, value_name = "NAME", default_value = "D65", requires = "chromaticity")]
    pub illuminant: String,
    /// Coordinates of the chromaticity diagram: x, y of CIE 1931, or u', v' of CIE 1976.
    #[arg(long, value_enum, value_name = "YEAR", default_value = "1931", requires = "chromaticity")]
    pub diagram: DiagramName,
    /// Show the figure in the colors seen by an eye that lacks one kind of cones.
    #[arg(long, value_enum, value_name = "EYE")]
    pub seen_by: Option<EyeName>,
    /// Observer of the chromaticity diagram.
    #[arg(long, value_enum, value_name = "YEAR", default_value = "1931", requires = "chromaticity")]
    pub observer: ObserverName,
}

/// Arguments of `spectra spectrum fit`.
#[derive(Debug, Args)]
#[command(
    long_about = "Fit signed Gaussian terms to a spectrum by least squares, and show how good the fit is: relative L2 \
        error, largest error, error of the integral, smallest value, and kappa, the sum of the terms' absolute \
        integrals divided by the sum of their signed ones.\n\nThe file that -o writes is an ordinary spectrum: \
        scenes, strategies and these commands accept it by name. Spectral lines are not fitted; the file lists them \
        along with the terms.\n\n--at shows the one Gaussian that touches the spectrum at a wavelength, or the reason why there is \
        none: if the logarithm of the spectrum does not curve downward, no Gaussian has its slope and curvature.",
    after_long_help = "Example:\n  spectra spectrum fit D65 --terms 8 -o d65-terms.yaml\n  \
        spectra spectrum plot D65 d65-terms.yaml -o both.png"
)]
pub(crate) struct SpectrumFit {
    /// A bundled spectrum, a file, or an expression (blackbody:5800).
    #[arg(value_name = "NAME")]
    pub name: String,
    /// Number of terms, 1 to 32.
    #[arg(long, value_name = "N", default_value_t = 6, value_parser = clap::value_parser!(u8).range(1..=32))]
    pub terms: u8,
    /// Wavelength range of the fit, nm.
    #[arg(long, value_name = "FROM,TO", value_delimiter = ',', num_args = 1..=2, default_value = "350,830")]
    pub band: Vec<f64>,
    /// Spacing of the fitted points, nm; 1 if not given. With --at, step of the finite differences; the spacing of the table, or 1, if
    /// not given.
    #[arg(long, value_name = "NM")]
    pub step: Option<f64>,
    /// Show only the Gaussian that has the spectrum's value, slope and curvature at this wavelength, nm.
    #[arg(long, value_name = "NM", allow_negative_numbers = true, conflicts_with_all = ["terms", "band"])]
    pub at: Option<f64>,
    /// Output file, FILE.yaml.
    #[arg(short, long, value_name = "FILE")]
    pub output: Option<PathBuf>,
    #[command(flatten)]
    pub report: JsonReport,
}

/// Arguments of `spectra spectrum product`.
#[derive(Debug, Args)]
#[command(
    long_about = "Multiply spectra as sums of signed Gaussian terms: a light, filters, surfaces, a film.\n\n\
        Factors that are not made of Gaussians are fitted. The product has a term for each choice of one term of every factor. Its \
        integral is exact; it is compared with a quadrature. The output has kappa (how much the terms cancel), and the errors of \
        estimates of the integral. One estimate follows one term of every factor and needs no wavelength; its error is computed from \
        all choices and also measured. The others draw wavelengths evenly, or by the first factor.\n\n\
        A factor that can be of any kind (a Gaussian, a constant) is a light if it comes first, and a filter elsewhere.",
    after_long_help = "Example:\n  spectra spectrum product D65 colorchecker#red wratten-12 ilford-ortho-plus --terms 6 -o terms.svg -o terms.csv"
)]
pub(crate) struct SpectrumProduct {
    /// The factors: bundled spectra, files or expressions.
    #[arg(value_name = "NAME", required = true)]
    pub names: Vec<String>,
    /// Number of terms of each fitted factor, 1 to 32.
    #[arg(long, value_name = "N", default_value_t = 6, value_parser = clap::value_parser!(u8).range(1..=32))]
    pub terms: u8,
    /// Wavelength range, nm.
    #[arg(long, value_name = "FROM,TO", value_delimiter = ',', num_args = 1..=2, default_value = "350,830")]
    pub band: Vec<f64>,
    /// Output file: FILE.svg or FILE.png for a figure, FILE.csv for the errors. Can be repeated.
    #[arg(short, long, value_name = "FILE")]
    pub output: Vec<PathBuf>,
    #[command(flatten)]
    pub report: JsonReport,
}

/// Kind of random numbers.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum NumbersName {
    /// Independent numbers.
    Random,
    /// The scrambled Sobol sequence of renders.
    Sobol,
    /// A rank-1 lattice with a random shift.
    Lattice,
    /// One random number in each of N equal intervals, for N numbers.
    Stratified,
}

/// Arguments of `spectra spectrum draw`.
#[derive(Debug, Args)]
#[command(
    long_about = "Draw wavelengths of a light with a sampling strategy, from the same density that a render uses.\n\n\
        The output is a CSV table with these columns: `wavelength_nm`; `line`, the number of the spectral line, empty for the continuum; \
        `weight`, one over the density per nm, or over the probability of the line; `light`, the power of the light there, per nm or of \
        the line; `response`, the sensitivity of --on, or 1; `density`, per nm, or the probability of the line. The mean of \
        weight x light x response is the integral of light and response, whatever the strategy.",
    after_long_help = "Examples:\n  spectra spectrum draw D65 --strategy uniform -n 5\n  \
        spectra spectrum draw FdC --strategy lines -n 5 --seed 7\n  \
        spectra spectrum draw D65 --on ilford-ortho-plus --strategy 'truncated-gaussian{center: 540, sigma: 60}' -n 100000 -o draws.csv"
)]
pub(crate) struct SpectrumDraw {
    /// The light: a bundled spectrum, a file or an expression.
    #[arg(value_name = "SPECTRUM")]
    pub name: String,
    /// The strategy, as NAME or NAME{key: value, ...}; `spectra list wavelengths` lists them.
    #[arg(long, value_name = "NAME", default_value = "source-times-response")]
    pub strategy: String,
    /// Sensitivity that records the light; equal at all wavelengths if not given.
    #[arg(long, value_name = "NAME")]
    pub on: Option<String>,
    /// Number of wavelengths to draw, 1 to 10000000.
    #[arg(short, long, value_name = "N", default_value_t = 1000, value_parser = clap::value_parser!(u32).range(1..=10_000_000))]
    pub number: u32,
    /// Seed of the random numbers.
    #[arg(long, value_name = "SEED", default_value_t = 1)]
    pub seed: u64,
    /// Kind of random numbers.
    #[arg(long, value_name = "KIND", value_enum, default_value = "random")]
    pub numbers: NumbersName,
    /// Wavelength range, nm.
    #[arg(long, value_name = "FROM,TO", value_delimiter = ',', num_args = 1..=2, default_value = "350,830")]
    pub band: Vec<f64>,
    /// Output file, FILE.csv; standard output if not given.
    #[arg(short, long, value_name = "FILE", conflicts_with = "json")]
    pub output: Option<PathBuf>,
    #[command(flatten)]
    pub report: JsonReport,
}

/// Color models, and the light that they take as white.
#[derive(Debug, Args)]
pub(crate) struct ColorModels {
    /// A color model, with its keys in braces if it has any; all models if not given. Can be repeated.
    #[arg(long, value_name = "NAME", default_value = "all")]
    pub model: Vec<String>,
    /// The light that counts as white.
    #[arg(long, value_name = "NAME", default_value = "D65")]
    pub illuminant: String,
}

/// Arguments of `spectra spectrum color`.
#[derive(Debug, Args)]
#[command(
    long_about = "Convert a color to a spectrum with each color model, and back to a color: that of the spectrum for the \
        CIE 1931 observer, as sRGB.",
    after_long_help = "Examples:\n  spectra spectrum color 255 128 64\n  \
        spectra spectrum color '#ff8040' --model 'fraunhofer{secondary: [F, D]}'"
)]
pub(crate) struct SpectrumColor {
    /// Red, green and blue from 0 to 255, or #ff8040.
    #[arg(value_name = "COLOR", required = true, num_args = 1..=3)]
    pub color: Vec<String>,
    #[command(flatten)]
    pub models: ColorModels,
    #[command(flatten)]
    pub report: JsonReport,
}

/// Arguments of `spectra spectrum models`.
#[derive(Debug, Args)]
#[command(
    long_about = "Measure how well each color model preserves colors: the largest and the mean difference after \
        conversion to a spectrum and back, over a grid of 8-bit colors, and how much green a pure red has afterwards. \
        -o plots the original colors next to the result of each model.",
    after_long_help = "Example:\n  spectra spectrum models --model smooth --model 'fraunhofer{secondary: [F, D]}' -o colors.png"
)]
pub(crate) struct SpectrumModels {
    #[command(flatten)]
    pub models: ColorModels,
    /// Step between colors, 1 to 255.
    #[arg(long, value_name = "N", default_value_t = 15, value_parser = clap::value_parser!(u8).range(1..=255))]
    pub step: u8,
    /// Output picture, FILE.svg or FILE.png.
    #[arg(short, long, value_name = "FILE")]
    pub output: Option<PathBuf>,
    #[command(flatten)]
    pub report: JsonReport,
}

/// Arguments of `spectra spectrum list`.
#[derive(Debug, Args)]
#[command(long_about = "List the bundled spectra, by kind of data.\n\n\
        A name after # is a column of the file: `colorchecker#red`. For a file with many columns only the first and the last are \
        shown, unless --all is given.")]
pub(crate) struct SpectrumList {
    /// Show every column of files that have many, such as the 99 samples of TM-30.
    #[arg(long)]
    pub all: bool,
    /// Write a JSON list to standard output.
    #[arg(long)]
    pub json: bool,
}
