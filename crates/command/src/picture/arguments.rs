//! Command-line arguments of `spectra picture`.

use crate::eye::EyeName;
use crate::report::JsonReport;
use clap::{Args, Subcommand};
use spectra_analysis::picture::Rectangle;
use spectra_core::params::Fault;
use std::path::PathBuf;

/// Arguments of `spectra picture`.
#[derive(Debug, Args)]
#[command(
    long_about = "Measure pictures: power and flux, false-color views, cuts, spectra, differences.\n\n\
        FILE is an OpenEXR file, usually one written by `spectra run`: the linear exposure (XYZ in lx or lx s, bands of the \
        spectrum, the layers of a film) or the finished picture. PNG, TIFF and JPEG files are read as sRGB.",
    after_long_help = "Examples, with your own a.exr and b.exr:\n\n    \
        spectra picture info a.exr\n    \
        spectra picture plot a.exr --quantity illuminance --log -o a-lux.png\n    \
        spectra picture cut a.exr --row 120 -o a-row.svg\n    \
        spectra picture spectrum a.exr --area 10,10,20,20 --diagram a-xy.svg\n    \
        spectra picture compare a.exr b.exr -o difference.png"
)]
pub(crate) struct PictureArguments {
    /// The command to run.
    #[command(subcommand)]
    pub command: PictureCommand,
}

/// The commands of `spectra picture`.
#[derive(Debug, Subcommand)]
pub(crate) enum PictureCommand {
    /// Show the figures of a picture: channels, power, luminous flux, illuminance, gamut, and its origin.
    Info(PictureInfo),
    /// Plot one quantity of a picture in false color, with its scale.
    Plot(PicturePlot),
    /// Plot quantities along a row, a column or a line.
    Cut(PictureCut),
    /// Show the mean color of an area, and write its spectrum if bands were recorded.
    Spectrum(PictureSpectrum),
    /// Compare two pictures: difference, noise, CIEDE2000.
    Compare(PictureCompare),
}

/// Arguments of `spectra picture info`.
#[derive(Debug, Args)]
#[command(
    long_about = "Show the figures of a picture: channels, power, luminous flux, illuminance, gamut, and its origin.\n\n\
        Luminous flux (lm) is illuminance times the area of the frame; exposures in lx s are divided by the exposure time that the \
        file states. Radiant power (W) is shown only for a spectral picture (`imager: {kind: spectral}`), and counts only its bands. \
        `out of sRGB` is the fraction of the lit pixels whose color has a negative component in that space. --json includes the scene.",
    after_long_help = "Example, with your own a.exr:\n\n    spectra picture info a.exr --json"
)]
pub(crate) struct PictureInfo {
    /// The picture.
    #[arg(value_name = "FILE")]
    pub file: PathBuf,
    /// Write a JSON object to standard output, with all texts of the header.
    #[arg(long)]
    pub json: bool,
}

/// Option for the reference white of a picture.
#[derive(Debug, Args)]
pub(crate) struct White {
    /// The Y that counts as white for lightness, chroma, hue, clipping and CIEDE2000, in the unit of the picture. If not given, 1 for a
    /// finished picture; for linear exposure, the value that automatic exposure shows as white.
    #[arg(long, value_name = "Y", value_parser = positive)]
    pub white: Option<f64>,
}

/// Arguments of `spectra picture plot`.
#[derive(Debug, Args)]
#[command(
    long_about = "Plot one quantity of a picture in false color, with its scale, or the picture in its colors.\n\n\
        QUANTITY is illuminance (lx), exposure (lx s), irradiance (W/m2, of spectral pictures), luminance, lightness (L*), chroma (C*), \
        hue, clipping, color, or the name of a channel, such as Y or ortho. `color` is the picture as a screen shows it. `clipping` \
        shows brightness in gray, and marks pixels beyond white, outside sRGB, or without a finite value. Lightness, chroma and hue are \
        CIE Lab with a white of D65. --seen-by shows the picture as seen by an eye that lacks one kind of cones (Machado, Oliveira and \
        Fernandes 2009, in full); with another --quantity it converts the false colors.",
    after_long_help = "Examples, with your own a.exr:\n\n    \
        spectra picture plot a.exr --log\n    spectra picture plot a.exr --quantity hue -o a-hue.png\n    \
        spectra picture plot a.exr --seen-by deutan -o a-deutan.png"
)]
pub(crate) struct PicturePlot {
    /// The picture.
    #[arg(value_name = "FILE")]
    pub file: PathBuf,
    /// Quantity to show. If not given, illuminance or the quantity nearest to it; with --seen-by, color.
    #[arg(long, value_name = "QUANTITY")]
    pub quantity: Option<String>,
    /// Use a logarithmic scale.
    #[arg(long)]
    pub log: bool,
    /// Ends of the scale; the smallest (or 0) and the largest value if not given.
    #[arg(long, value_name = "FROM,TO", allow_hyphen_values = true, value_parser = range)]
    pub range: Option<[f64; 2]>,
    /// Show the figure as seen by an eye that lacks one kind of cones.
    #[arg(long, value_enum, value_name = "EYE")]
    pub seen_by: Option<EyeName>,
    #[command(flatten)]
    pub white: White,
    /// Output file, FILE.png or FILE.svg; NAME-QUANTITY.png in the working folder if not given.
    #[arg(short, long, value_name = "FILE")]
    pub output: Option<PathBuf>,
}

/// Arguments of `spectra picture cut`.
#[derive(Debug, Args)]
#[command(
    long_about = "Plot quantities along a row, a column or a line through a picture, or write them as a table.\n\n\
        Rows and columns count from 0 at the upper left. A line is given in columns and rows (0.5,0.5 is the middle of the first \
        pixel); values between pixels are interpolated. Distances are in mm on the film if the file states its size.",
    after_long_help = "Examples, with your own a.exr:\n\n    \
        spectra picture cut a.exr --row 120 -o a-row.svg\n    \
        spectra picture cut a.exr --line 10,10,200,90 --quantity X,Y,Z --log -o a-line.csv"
)]
pub(crate) struct PictureCut {
    /// The picture.
    #[arg(value_name = "FILE")]
    pub file: PathBuf,
    #[command(flatten)]
    pub way: WayArguments,
    /// Quantities or channels to show, named as for `spectra picture plot`.
    #[arg(long, value_name = "A,B,...", value_delimiter = ',')]
    pub quantity: Vec<String>,
    /// Use a logarithmic scale; a table always holds the values themselves.
    #[arg(long)]
    pub log: bool,
    #[command(flatten)]
    pub white: White,
    /// Output file, FILE.svg, FILE.png or a table FILE.csv; NAME-cut.svg in the working folder if not given.
    #[arg(short, long, value_name = "FILE")]
    pub output: Option<PathBuf>,
}

/// Options for the path of a cut.
#[derive(Debug, Args)]
#[group(required = true, multiple = false)]
pub(crate) struct WayArguments {
    /// Cut along this row.
    #[arg(long, value_name = "ROW")]
    pub row: Option<u32>,
    /// Cut along this column.
    #[arg(long, value_name = "COLUMN")]
    pub column: Option<u32>,
    /// Cut from one point to another.
    #[arg(long, value_name = "COLUMN,ROW,COLUMN,ROW", value_parser = line)]
    pub line: Option<[f64; 4]>,
}

/// Arguments of `spectra picture spectrum`.
#[derive(Debug, Args)]
#[command(
    long_about = "Show the mean color of areas of a picture, and write their spectrum if bands were recorded.\n\n\
        A spectral picture (`imager: {kind: spectral}`) holds the spectrum. -o writes that of one area as a spectrum file \
        (`kind: histogram`), which a scene can use as a light by its file name. --diagram marks the chromaticities of the areas in the \
        CIE 1931 diagram.",
    after_long_help = "Examples, with your own spectral.exr:\n\n    \
        spectra picture spectrum spectral.exr --area 10,10,20,20 -o measured.yaml\n    \
        spectra picture spectrum spectral.exr --area 0,0,8,8 --area 40,20,8,8 --diagram areas.svg"
)]
pub(crate) struct PictureSpectrum {
    /// The picture.
    #[arg(value_name = "FILE")]
    pub file: PathBuf,
    /// Area to measure: first column and row, width and height in pixels; can be repeated. The whole picture if not given.
    #[arg(long = "area", value_name = "COLUMN,ROW,WIDTH,HEIGHT", value_parser = rectangle)]
    pub areas: Vec<Rectangle>,
    /// Spectrum file to write, FILE.yaml, for one area.
    #[arg(short, long, value_name = "FILE")]
    pub output: Option<PathBuf>,
    /// Chromaticity diagram to write, FILE.svg or FILE.png.
    #[arg(long, value_name = "FILE")]
    pub diagram: Option<PathBuf>,
    #[command(flatten)]
    pub report: JsonReport,
}

/// Arguments of `spectra picture compare`.
#[derive(Debug, Args)]
#[command(
    long_about = "Compare two pictures of the same size: difference, noise, CIEDE2000.\n\n\
        Differences are second minus first, relative to the mean of both. `noise` is the noise of each picture if both show the same \
        scene with the same number of samples (the standard deviation of the differences divided by the square root of 2). If they \
        differ only by noise, the means differ by a few standard errors at most, and about 0.3 % of the blocks of 16 x 16 pixels by \
        more than 3. CIEDE2000 is computed from CIE Lab with the same white of D65 for both.",
    after_long_help = "Example, with your own a.exr and b.exr:\n\n    \
        spectra picture compare a.exr b.exr -o difference.png"
)]
pub(crate) struct PictureCompare {
    /// The first picture.
    #[arg(value_name = "FIRST")]
    pub first: PathBuf,
    /// The second picture.
    #[arg(value_name = "SECOND")]
    pub second: PathBuf,
    #[command(flatten)]
    pub white: White,
    /// Map of CIEDE2000 to write, FILE.png or FILE.svg.
    #[arg(short, long, value_name = "FILE")]
    pub output: Option<PathBuf>,
    #[command(flatten)]
    pub report: JsonReport,
}

fn numbers<const N: usize>(text: &str) -> Option<[f64; N]> {
    let all: Option<Vec<f64>> =
        text.split(',').map(|v| v.trim().parse().ok().filter(|v: &f64| v.is_finite())).collect();
    all?.try_into().ok()
}

/// Parses the number of `--white`.
fn positive(text: &str) -> Result<f64, Fault> {
    let [value] = numbers(text).filter(|[v]| *v > 0.0).ok_or("expected a number above 0, such as 0.4")?;
    Ok(value)
}

/// Parses the numbers of `--range`.
fn range(text: &str) -> Result<[f64; 2], Fault> {
    let rises = |[from, to]: &[f64; 2]| from < to;
    numbers(text).filter(rises).ok_or_else(|| "expected two increasing numbers, such as 0.1,100".into())
}

/// Parses the numbers of `--line`.
fn line(text: &str) -> Result<[f64; 4], Fault> {
    numbers(text).ok_or_else(|| "expected four numbers: column and row of each end, such as 10,10,200,90".into())
}

/// Parses the numbers of `--area`.
fn rectangle(text: &str) -> Result<Rectangle, Fault> {
    let all: Option<Vec<u32>> = text.split(',').map(|v| v.trim().parse().ok()).collect();
    match all.as_deref() {
        Some(&[x, y, width, height]) if width > 0 && height > 0 => {
            Ok(Rectangle { from: [x, y], size: [width, height] })
        }
        _ => Err("expected four whole numbers: column, row, width and height, such as 10,10,20,20".into()),
    }
}
