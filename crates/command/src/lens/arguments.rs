//! Command-line arguments of `spectra lens`.

use crate::glass::OwnCatalogues;
use crate::quantity::wavelength;
use crate::report::JsonReport;
use clap::{Args, Subcommand};
use spectra_core::params::{FNumber, Fault, Length, OrInfinity, Positive, Quantity, Ratio, Wavelength};
use spectra_optics::Criterion;
use std::path::PathBuf;

/// Arguments of `spectra lens`.
#[derive(Debug, Args)]
#[command(after_long_help = "Example:\n  spectra lens info zeiss-biotar-50-f1.4")]
pub(crate) struct LensArguments {
    /// The command to run.
    #[command(subcommand)]
    pub command: LensCommand,
}

/// The commands of `spectra lens`.
#[derive(Debug, Subcommand)]
pub(crate) enum LensCommand {
    /// Show the data of a lens: focal lengths, pupils, f-number, prescription.
    Info(LensInfo),
    /// Compare lenses side by side: focal length, f-number, field, contrast, distortion.
    Compare(LensCompare),
    /// Draw a lens: glass, stop, and rays from several field angles in their spectral colors.
    Draw(LensDraw),
    /// List the ghosts of a lens: energy, focus, size and color for each pair of reflections.
    Ghosts(LensGhosts),
    /// Trace rays through a lens: CSV in, CSV out.
    Trace(LensTrace),
    /// Convert a lens file from another program, or a table as printed in patents: .zmx, .seq, .csv or .txt.
    Import(LensImport),
    /// Write a lens at another size, for example a patent with a focal length of 100 as a 50 mm lens.
    Scale(LensScale),
    /// Export a lens to other programs, as .zmx.
    Export(LensExport),
}

/// Arguments of `spectra lens scale`.
#[derive(Debug, Args)]
#[command(
    long_about = "Write a lens at another size: all lengths are multiplied by a factor; f-number, angles and glasses stay the same.\n\n\
        Many patents state lenses for a focal length of 1 or 100.",
    after_long_help = "Examples:\n  spectra lens scale zeiss-biotar-100-f1.4 --to 50mm -o biotar.yaml\n  \
        spectra lens scale cooke-triplet-50-f5 --by 0.5"
)]
pub(crate) struct LensScale {
    /// A lens file in any supported format, or the name of a bundled lens.
    #[arg(value_name = "LENS")]
    pub lens: String,
    /// Focal length of the scaled lens (85mm).
    #[arg(long, value_name = "LENGTH", value_parser = Positive::<Length>::from_text, conflicts_with = "by", required_unless_present = "by")]
    pub to: Option<Positive<Length>>,
    /// Factor that all lengths are multiplied by.
    #[arg(long, value_name = "FACTOR")]
    pub by: Option<f64>,
    /// Output file, .yaml; standard output if not given.
    #[arg(short, long, value_name = "FILE")]
    pub output: Option<PathBuf>,
    /// Overwrite the output file if it exists.
    #[arg(long)]
    pub force: bool,
    #[command(flatten)]
    pub report: JsonReport,
}

/// Arguments of `spectra lens compare`.
#[derive(Debug, Args)]
#[command(
    long_about = "Compare lenses side by side: focal length, f-number, T-number, field, size, contrast on axis and \
        off axis, distortion.\n\n\
        Contrast is geometrical, at 30 lp/mm, in the plane where it is highest on axis. The off-axis field is the \
        same for all lenses: 0.7 of the field of the narrowest one. A lens that cannot reach --f-number stays wide \
        open, with a note.",
    after_long_help = "Example: two lenses, both at f/2\n  spectra lens compare zeiss-biotar-50-f1.4 helios-44-58-f2 --f-number f/2"
)]
pub(crate) struct LensCompare {
    /// Two or more lens files, or names of bundled lenses (see `spectra list lens`).
    #[arg(value_name = "LENS", num_args = 2.., required = true)]
    pub lenses: Vec<String>,
    #[command(flatten)]
    pub options: LensOptions,
    #[command(flatten)]
    pub light: OneLight,
    #[command(flatten)]
    pub report: JsonReport,
}

/// Arguments of `spectra lens draw`.
#[derive(Debug, Args)]
#[command(
    long_about = "Draw a lens: glass tinted by its index and dispersion, stop, image plane, and rays from several \
        field angles in the colors of their wavelengths.\n\n\
        Every ray is traced; the rays of a fan are spaced evenly over the beam that actually passes at that field \
        angle. An element with no size in the prescription is drawn as large as the beam on it.",
    after_long_help = "Example: the Biotar at f/4, three field angles\n  \
        spectra lens draw zeiss-biotar-50-f1.4 --f-number f/4 --fields 0,10,20 -o biotar.svg"
)]
pub(crate) struct LensDraw {
    #[command(flatten)]
    pub setting: LensSetting,
    /// Output file, .svg or .png; LENS.svg if not given.
    #[arg(short, long, value_name = "FILE")]
    pub output: Option<PathBuf>,
    /// Field angles in degrees; if not given, the axis, and 0.6 and 0.95 of the largest field angle that passes (up to
    /// 85).
    #[arg(long, value_name = "DEG,DEG,...", value_delimiter = ',', allow_negative_numbers = true)]
    pub fields: Vec<f64>,
    /// Wavelengths (550nm) or spectral lines (C').
    #[arg(long, value_name = "NM,NM,...", value_delimiter = ',', default_value = "F',e,C'", value_parser = wavelength_or_line)]
    pub wavelengths: Vec<f64>,
    /// Number of rays per fan and wavelength.
    #[arg(long, value_name = "N", default_value = "5", value_parser = clap::value_parser!(u16).range(0..=1001))]
    pub rays: u16,
    /// Distance of the object from the first surface (2m, inf).
    #[arg(long, value_name = "DISTANCE", default_value = "inf", value_parser = OrInfinity::<Positive<Length>>::from_text)]
    pub object: OrInfinity<Positive<Length>>,
    /// Plane of the cross-section: `y` is the y-z plane, `x` the x-z plane.
    #[arg(long, value_enum, default_value_t = CutArgument::Y)]
    pub section: CutArgument,
    /// Width of the drawing; a .png is twice as many pixels wide.
    #[arg(long, value_name = "UNITS", default_value = "900", value_parser = clap::value_parser!(u16).range(100..=8000))]
    pub width: u16,
    /// Draw white glass and additively blended rays on a black background.
    #[arg(long)]
    pub dark: bool,
}

/// Plane of the cross-section in a drawing.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
pub(crate) enum CutArgument {
    /// The y-z plane, y up.
    #[value(alias = "y-z")]
    Y,
    /// The x-z plane, x up.
    #[value(alias = "x-z")]
    X,
}

/// Parses the number of a surface, counted from 1.
fn surface(text: &str) -> Result<usize, Fault> {
    text.trim().parse().map_err(|_| "surfaces are whole numbers, counted from 1, such as 7,3".into())
}

/// Parses a fraction from 0 to 1.
fn share(text: &str) -> Result<f64, Fault> {
    let value = text.parse::<f64>().ok().filter(|v| (0.0..=1.0).contains(v));
    value.ok_or_else(|| "expected a fraction from 0 to 1, such as 1e-8".into())
}

/// Parses a field angle in degrees, between -90 and 90.
fn field(text: &str) -> Result<f64, Fault> {
    let value = text.parse::<f64>().ok().filter(|v| v.abs() < 90.0);
    value.ok_or_else(|| "expected degrees between -90 and 90".into())
}

fn wavelength_or_line(text: &str) -> Result<f64, Fault> {
    match spectra_glass::lines::by_name(text.trim()) {
        Some(line) => Ok(line.wavelength_nm),
        None => wavelength(text).map(|w| w.nm()).map_err(|e| format!("{e}; or a line such as F', e, C'").into()),
    }
}

/// A lens and its settings.
#[derive(Debug, Args)]
pub(crate) struct LensSetting {
    /// A lens file, or the name of a bundled lens (see `spectra list lens`).
    #[arg(value_name = "LENS")]
    pub lens: String,
    #[command(flatten)]
    pub options: LensOptions,
}

/// Settings of a lens: focus, f-number, coating and absorption.
#[derive(Debug, Args)]
pub(crate) struct LensOptions {
    /// Focus at this distance from the first surface (2m, 77cm, inf); as in the file if not given.
    #[arg(long, value_name = "DISTANCE", value_parser = OrInfinity::<Positive<Length>>::from_text)]
    pub focus: Option<OrInfinity<Positive<Length>>>,
    /// Focus distance as a plain number in millimeters.
    #[arg(long, value_name = "MM", value_parser = OrInfinity::<Positive<Length>>::from_text, conflicts_with = "focus")]
    pub focus_mm: Option<OrInfinity<Positive<Length>>>,
    /// Measure that --focus optimizes, at the lens's reference line, on axis and at the chosen aperture.
    #[arg(long, value_name = "MEASURE", value_enum, default_value_t = FocusMeasure::Contrast)]
    pub focus_by: FocusMeasure,
    /// Set the stop to this f-number (f/2), which is measured with the real marginal ray; as in the file if not given.
    #[arg(long, value_name = "F/N", value_parser = FNumber::from_text)]
    pub f_number: Option<FNumber>,
    /// Coating of all surfaces: ideal (no reflection), bare, single-layer, three-layer, any other of `spectra list coating` without
    /// required parameters, or a file; as in the lens file if not given.
    #[arg(long, value_name = "COATING")]
    pub coating: Option<String>,
    /// Whether glass absorbs light: true or false; as in the file if not given.
    #[arg(long, value_name = "BOOL")]
    pub absorption: Option<bool>,
}

/// Measure that focusing optimizes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
pub(crate) enum FocusMeasure {
    /// Highest contrast at 30 line pairs per mm, with real rays. Scenes on a 135 frame are focused in this way.
    Contrast,
    /// Smallest RMS spot, with real rays.
    #[value(alias = "rms")]
    Spot,
    /// First-order optics without a search. The distance between image plane and paraxial image stays as in the file, at infinity.
    Paraxial,
}

impl FocusMeasure {
    /// Returns the criterion of the search with real rays; `None` for paraxial focus.
    pub(crate) fn criterion(self) -> Option<Criterion> {
        match self {
            Self::Contrast => Some(Criterion::Contrast { per_mm: 30.0 }),
            Self::Spot => Some(Criterion::Rms),
            Self::Paraxial => None,
        }
    }
}

/// Options that select one wavelength for all glasses.
#[derive(Debug, Args)]
#[group(multiple = false)]
pub(crate) struct OneLight {
    /// Use this spectral line: i, h, g, F', F, e, d, D, C', C, r, A', s or t.
    #[arg(long, value_name = "LINE", value_parser = line)]
    pub line: Option<f64>,
    /// Use this wavelength in air.
    #[arg(long, value_name = "NM", value_parser = wavelength)]
    pub wavelength_nm: Option<Wavelength>,
    /// Use the index stated in the prescription for every glass.
    #[arg(long)]
    pub nd: bool,
}

/// Parses the name of a spectral line; returns its wavelength, nm.
fn line(name: &str) -> Result<f64, Fault> {
    spectra_glass::lines::by_name(name).map(|line| line.wavelength_nm).ok_or_else(|| {
        let known: Vec<&str> = spectra_glass::lines::ALL.iter().map(|line| line.name).collect();
        format!("no such spectral line; {}", spectra_core::names::hint(name, &known, "")).into()
    })
}

/// Parses a fraction of the light: `4 %`, `0.04`.
fn part(text: &str) -> Result<f64, Fault> {
    let part = Ratio::from_text(text)?.number();
    if (0.0..=1.0).contains(&part) { Ok(part) } else { Err("expected a value from 0 to 100 %".into()) }
}

/// Arguments of `spectra lens info`.
#[derive(Debug, Args)]
#[command(
    long_about = "Show the data of a lens: focal lengths, principal planes, pupils, f-number, T-number, focus, field, \
        the mounts that it leaves room for, and prescription.\n\n\
        Values are for the reference line of the lens's patent, unless a line or wavelength is given. The f-number \
        and pupil diameters come from the real marginal ray; the positions of planes and pupils are paraxial; focus \
        shifts, the largest field and the field points come from real rays. The T-number includes coatings, mirrors and \
        absorption. A note lists these and what is assumed: coatings typical of the lens's time, unless the lens file or \
        --coating says otherwise.\n\n\
        Each field point has its chief ray (through the center of the stop), the distortion, the sagittal and tangential foci, and \
        the relative illuminance. The foci are where rays close to the chief ray meet, measured from the image plane; they show \
        field curvature and astigmatism. The illuminance is that on the film under an evenly bright field relative to the middle, \
        with all rims, coatings and glass.\n\n\
        --glare adds the veiling glare index by the integral method of ISO 9358: the light in the middle of a black disk \
        within an endless white field, relative to the light there without the disk. The image of the disk is a tenth as large as \
        the diagonal of a 36 x 24 mm frame; its middle half is measured, at the wavelength of the report. Light is reflected any \
        number of times by every surface, and scattered by black paint on the barrel, the rims, the edges of the glass and the blades.",
    after_long_help = "Examples: a lens in blue light; its field to the corner of a 36 x 24 mm frame; its veiling glare with a \
        single-layer coating on each surface\n  \
        spectra lens info zeiss-biotar-50-f1.4 --line g\n  \
        spectra lens info zeiss-biotar-50-f1.4 --f-number f/4 --image-height 21.6mm\n  \
        spectra lens info zeiss-biotar-50-f1.4 --f-number f/2 --coating single-layer --glare"
)]
pub(crate) struct LensInfo {
    #[command(flatten)]
    pub setting: LensSetting,
    #[command(flatten)]
    pub light: OneLight,
    /// Show the field in the middle and at 0.5, 0.7 and 1 of this image height (21.6mm), instead of in ten steps to the largest field.
    #[arg(long, value_name = "LENGTH", value_parser = Positive::<Length>::from_text)]
    pub image_height: Option<Positive<Length>>,
    /// List every mount that the lens fits, not only the common ones.
    #[arg(long)]
    pub mounts: bool,
    /// Compute the veiling glare index (takes some seconds).
    #[arg(long)]
    pub glare: bool,
    /// Diffuse reflectance of the black paint, for --glare; 4 % if not given.
    #[arg(long, value_name = "PART", value_parser = part, requires = "glare")]
    pub paint: Option<f64>,
    /// Diffuse reflectance of the film or sensor, for --glare; 0 if not given, because ISO 9358 measures the lens alone.
    #[arg(long, value_name = "PART", value_parser = part, requires = "glare")]
    pub film_reflectance: Option<f64>,
    #[command(flatten)]
    pub report: JsonReport,
}

/// Arguments of `spectra lens ghosts`.
#[derive(Debug, Args)]
#[command(
    long_about = "List the ghosts of a lens: light that reaches the film after reflections at two surfaces, or at four.\n\n\
        Values are for light from infinity on the axis, at the reference line: the energy relative to the straight light, which is not \
        reflected; the distance of the ghost's focus from the image plane, positive behind it, and its focal length (both paraxial); the \
        diameter of its disk on the image plane; and its energy at C', e and F' relative to that at e. Surfaces are counted from 1 and \
        listed in the order in which they reflect. Coatings are those of the lens file, or typical of its time, unless --coating says \
        otherwise.\n\n\
        Paths of four reflections (--order 4) are found by following the light. A path is cut as soon as it carries less than --share of \
        the straight light, because nothing further on can add to it. The light that is not followed is reported.\n\n\
        With -o the lens is drawn with the rays of a ghost: the one that is brightest on the film, or that of --path.",
    after_long_help = "Examples: the effect of a single-layer coating; the brightest ghost; a chosen ghost with light from 20 degrees\n  \
        spectra lens ghosts zeiss-biotar-50-f1.4 --coating single-layer\n  \
        spectra lens ghosts zeiss-biotar-50-f1.4 -o ghost.svg\n  \
        spectra lens ghosts zeiss-biotar-50-f1.4 -o ghost.svg --path 7,3 --field 20"
)]
pub(crate) struct LensGhosts {
    #[command(flatten)]
    pub setting: LensSetting,
    /// Largest number of reflections: 2 or 4.
    #[arg(long, value_name = "N", default_value = "2", value_parser = ["2", "4"])]
    pub order: String,
    /// Leave out paths of four reflections once they carry less than this fraction of the straight light.
    #[arg(long, value_name = "PART", default_value = "1e-8", value_parser = share)]
    pub share: f64,
    /// Draw the lens with the rays of a ghost to this file, .svg or .png: the ghost brightest on the film, or that of --path.
    #[arg(short, long, value_name = "FILE")]
    pub output: Option<PathBuf>,
    /// The ghost to draw: the surfaces that reflect it, counted from 1, in the order of the light.
    #[arg(long, value_name = "A,B", value_delimiter = ',', value_parser = surface, requires = "output")]
    pub path: Vec<usize>,
    /// Field angle of the light in the drawing, degrees.
    #[arg(long, value_name = "DEG", default_value = "0", allow_negative_numbers = true, requires = "output",
        value_parser = field)]
    pub field: f64,
    /// Number of rays in the drawing.
    #[arg(long, value_name = "N", default_value = "11", requires = "output",
        value_parser = clap::value_parser!(u16).range(1..=1001))]
    pub rays: u16,
    /// Show all ghosts, not only the brightest.
    #[arg(long)]
    pub all: bool,
    /// Write a JSON object with all ghosts to standard output.
    #[arg(long)]
    pub json: bool,
}

/// Arguments of `spectra lens trace`.
#[derive(Debug, Args)]
#[command(
    long_about = "Trace rays through a lens: CSV in, CSV out.\n\n\
        Input columns: x_mm,y_mm,z_mm (a point on the ray before the first surface, whose vertex is the origin; +z \
        runs toward the image), l,m,n (unit direction) and wavelength_nm, unless one line or wavelength is given for \
        all rays. Columns are found by name, in any order.\n\n\
        Output, one row per ray: status,surface,x_mm,y_mm,z_mm,l,m,n,wavelength_nm,transmittance,optical_path_mm. A \
        `hit` is where the ray meets the image plane, in the same coordinates; a ray that ends earlier is `missed`, \
        `vignetted`, `tir` or `absorbed`, with the number of the surface, counted from 1. `transmittance` is the fraction \
        of the light that coatings and glass leave. `optical_path_mm` is the index times the length from the start of the ray, \
        including what gratings and ideal lenses add. --every-surface adds a row `passed` for each surface, with the \
        direction behind it, and puts the number of the ray first. Surfaces clip only at stated semi-diameters, unless \
        --f-number sets the stop; the lens is not refocused unless --focus is given.",
    after_long_help = "Example:\n  spectra lens trace zeiss-biotar-50-f1.4 --rays rays.csv --nd -o hits.csv"
)]
pub(crate) struct LensTrace {
    #[command(flatten)]
    pub setting: LensSetting,
    #[command(flatten)]
    pub light: OneLight,
    /// CSV file of rays; `-` reads standard input.
    #[arg(long, value_name = "FILE")]
    pub rays: PathBuf,
    /// Follow the path that reflects at these surfaces, counted from 1, in the order of the light: 7,3 is a ghost.
    #[arg(long, value_name = "A,B", value_delimiter = ',', value_parser = surface)]
    pub path: Vec<usize>,
    /// Write a row for every surface that a ray passes.
    #[arg(long)]
    pub every_surface: bool,
    /// Output file; standard output if not given, or if `-`.
    #[arg(short, long, value_name = "FILE")]
    pub output: Option<PathBuf>,
    /// Write one JSON object per line for each ray, instead of CSV.
    #[arg(long)]
    pub json: bool,
}

/// Arguments of `spectra lens import`.
#[derive(Debug, Args)]
#[command(
    long_about = "Convert a lens file from another program: .zmx (Zemax OpticStudio, sequential), .seq (CODE V) or \
        .csv (one row per surface).\n\n\
        Anything that cannot be converted is listed on standard error and kept in the file as comments; anything that \
        changes the path of light is marked with `!`. The entrance pupil or f-number gives the stop its size; fields and \
        wavelengths become a remark. Every command that takes a lens also reads these files directly, without importing \
        them first.\n\n\
        The columns of a .csv are radius (or curvature), thickness, glass, nd, vd, semi-diameter (or diameter), type, conic, \
        a2, a4 and so on, surface, lens and comment; lengths are in mm unless a unit follows, as in `radius [in]`.\n\n\
        A glass that is not in a bundled catalogue is taken from a catalogue file of a maker or a design program (--agf); the lens \
        file then refers to that file.",
    after_long_help = "Examples:\n  spectra lens import tessar.zmx -o tessar.yaml\n  \
        spectra lens import tessar.zmx --agf old-glasses.agf -o old.yaml"
)]
pub(crate) struct LensImport {
    /// The file to convert.
    #[arg(value_name = "FILE")]
    pub file: PathBuf,
    #[command(flatten)]
    pub own: OwnCatalogues,
    /// Output lens file; standard output if not given, or if `-`.
    #[arg(short, long, value_name = "FILE")]
    pub output: Option<PathBuf>,
    /// Overwrite an existing file.
    #[arg(long)]
    pub force: bool,
    /// Write a JSON object to standard output: what was read, and what was left out; needs -o.
    #[arg(long, requires = "output")]
    pub json: bool,
}

/// Arguments of `spectra lens export`.
#[derive(Debug, Args)]
#[command(
    long_about = "Export a lens to other programs, as .zmx (Zemax OpticStudio and programs that read its files).\n\n\
        Catalogue glasses are written by name, others by nd and Vd. Anything that cannot be converted is listed on \
        standard error.",
    after_long_help = "Example:\n  spectra lens export zeiss-biotar-50-f1.4 -o biotar.zmx"
)]
pub(crate) struct LensExport {
    /// A lens file, or the name of a bundled lens.
    #[arg(value_name = "LENS")]
    pub lens: String,
    /// Output file, with a name ending in .zmx; standard output if not given, or if `-`.
    #[arg(short, long, value_name = "FILE")]
    pub output: Option<PathBuf>,
    /// Overwrite an existing file.
    #[arg(long)]
    pub force: bool,
    /// Write a JSON object to standard output: what was written, and what was left out; needs -o.
    #[arg(long, requires = "output")]
    pub json: bool,
}
