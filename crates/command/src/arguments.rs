//! What can be written after `spectra`.

use crate::build::BuildArguments;
use crate::film::FilmArguments;
use crate::glass::GlassArguments;
use crate::new::NewArguments;
use crate::quantity::parse;
use crate::run::Frames;
use crate::spectrum::SpectrumArguments;
use crate::version;
use clap::{Args, Parser, Subcommand};
use spectra_core::params::{FNumber, Length, OrInfinity, Positive, Time, Wavelength};
use spectra_lens::Criterion;
use std::path::PathBuf;

/// The open spectral camera: light with a spectrum, through real glass, onto a measured film.
#[derive(Debug, Parser)]
#[command(
    name = "spectra",
    version = version::VERSION,
    long_version = version::long(),
    arg_required_else_help = true,
    after_help = "Start with: spectra run biotar-ortho (`spectra list scene` shows what else comes with the program)",
    after_long_help = "Start with:\n  spectra run biotar-ortho\n  spectra list scene\n\n\
        Exit codes: 0 done, or stopped by --time-limit; 1 something failed (a full disk, a render error); \
        2 the input is wrong; 130 interrupted by Ctrl-C, 143 by SIGTERM, 129 by SIGHUP.\n\n\
        Environment: SPECTRA_ISA=baseline|avx2|avx512 forces an instruction set (the picture is the same bit by bit); \
        NO_COLOR turns colors off."
)]
pub(crate) struct Arguments {
    /// What to do.
    #[command(subcommand)]
    pub command: Option<Command>,
    /// Show the terms of the program and of the data in it.
    #[arg(long, exclusive = true)]
    pub licenses: bool,
    /// Say on standard error what is going on inside.
    #[arg(short, long, global = true)]
    pub verbose: bool,
}

/// The commands.
#[derive(Debug, Subcommand)]
pub(crate) enum Command {
    /// Render a scene: the picture, and the light behind it.
    Run(Run),
    /// Find every fault of scenes without rendering them.
    Check(Check),
    /// List what can be written in a scene.
    List(List),
    /// Show what a stage does, and what is written in it.
    Doc(Doc),
    /// Write the JSON Schema of scenes, lenses, stocks or spectra.
    Schema(SchemaOf),
    /// Look at a lens as an optical engineer does.
    Lens(LensArguments),
    /// Look at film stocks: sensitivities, curves, dyes.
    Film(FilmArguments),
    /// Compare ways to draw wavelengths: error against samples and time.
    Bench(Bench),
    /// Look at spectra: their color in figures, and pictures of them.
    Spectrum(SpectrumArguments),
    /// Look at glass: refractive index, Abbe diagram, nearest glass, fits.
    Glass(GlassArguments),
    /// Start a plugin, a scene or a lens of your own.
    New(NewArguments),
    /// Build a program with your plugins in it.
    Build(BuildArguments),
    /// Write the completions of commands and options for a shell.
    Completions(Completions),
    /// Write the man page.
    Man,
}

/// `spectra completions`.
#[derive(Debug, Args)]
#[command(
    long_about = "Write the completions of commands and options for a shell to standard output.",
    after_long_help = "Example:\n  spectra completions bash\n\n\
        To have them in every new shell, write them to where it looks: \
        ~/.local/share/bash-completion/completions/spectra for bash, a file _spectra in a folder of $fpath for zsh, \
        ~/.config/fish/completions/spectra.fish for fish."
)]
pub(crate) struct Completions {
    /// Which shell.
    #[arg(value_name = "SHELL", value_enum)]
    pub shell: clap_complete::Shell,
}

/// `spectra run`.
#[derive(Debug, Args)]
#[command(
    long_about = "Render a scene: the picture, and the light behind it.\n\n\
        Writes, as the scene's `output` asks, SCENE.exr (linear exposure, one channel each of the imager or film, 32-bit \
        float) and SCENE.png or SCENE.tiff (what a person looks at), named like the scene file, and SCENE.json (time, \
        rays, where light was lost, versions). --output x.png (.tiff, .exr, .dng) writes that picture alone. Files appear under their names only when they are whole.\n\n\
        Ctrl-C stops within a second and writes what there is, marked as partial (exit code 130); a second Ctrl-C gives \
        it up at once.\n\n\
        A scene with a `sweep` gives numbered pictures SCENE-001.png ... and a contact sheet SCENE-contact.png, one with an \
        `animation` frames SCENE.0001.exr ...; SCENE-series.json says of each what it is. All of them are checked before any light \
        is traced; of several pictures only whole ones are written, also when stopped.",
    after_long_help = "Examples: a scene that comes with the program; a quick look at it stopped down, into the folder `try`\n  \
        spectra run biotar-ortho\n  \
        spectra run biotar-ortho --samples 16 --set lens.f-number=f/4 --output try"
)]
pub(crate) struct Run {
    /// A scene file, or the name of a scene that comes with the program (see `spectra list scene`).
    #[arg(value_name = "SCENE")]
    pub scene: PathBuf,
    /// Folder to write to, which is made where it does not exist; or one picture by its name: x.png, .tiff, .exr, .dng.
    #[arg(short, long, value_name = "DIR|FILE", default_value = "out")]
    pub output: PathBuf,
    #[command(flatten)]
    pub set: Set,
    /// Threads to render on: all processors if not given. The picture does not depend on it.
    #[arg(short, long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024))]
    pub threads: Option<u16>,
    /// Seed of the random numbers, in place of the scene's.
    #[arg(long, value_name = "N")]
    pub seed: Option<u64>,
    /// Samples a pixel, in place of the scene's: four times as many make half the noise. A scene that is rendered forward
    /// launches rays in proportion.
    #[arg(short, long, value_name = "N", value_parser = samples)]
    pub samples: Option<u32>,
    /// Stop after this time (30s, 5min), counted from the start of the program, and write what there is; nothing, where the
    /// scene is not ready for light by then.
    #[arg(long, value_name = "TIME", value_parser = parse::<Positive<Time>>)]
    pub time_limit: Option<Positive<Time>>,
    /// Render these frames of an animation only: 17, 10-20, 10-, or several of them with commas.
    #[arg(long, value_name = "FRAMES", value_parser = <Frames as std::str::FromStr>::from_str)]
    pub frames: Option<Frames>,
    /// Leave out pictures of a sweep or an animation whose files are all there, whatever they were made of.
    #[arg(long)]
    pub skip_existing: bool,
    /// One JSON object a line on standard output for each event: start, progress, warning, written, done, error; for
    /// several pictures also check, series and end.
    #[arg(long, conflicts_with = "quiet")]
    pub json: bool,
    /// Say nothing but errors.
    #[arg(short, long, overrides_with = "quiet")]
    pub quiet: bool,
}

/// `--set`.
#[derive(Debug, Args)]
pub(crate) struct Set {
    /// Set a value of the scene, as if it stood in the file; may be given again.
    #[arg(
        long = "set",
        value_name = "PATH=VALUE",
        long_help = "Set a value of the scene, as if it stood in the file; may be given again.\n\
            Examples: --set film.exposure=\"1/125 s\"  --set lens.f-number=f/4  --set output=[exr]"
    )]
    pub overrides: Vec<String>,
}

/// The number of `--samples`.
fn samples(text: &str) -> Result<u32, String> {
    let wanted = "expected a whole number from 1 to 4194304, such as 64";
    match text.trim().parse::<u32>() {
        Ok(samples) if (1..=4_194_304).contains(&samples) => Ok(samples),
        _ => Err(wanted.to_owned()),
    }
}

/// `spectra check`.
#[derive(Debug, Args)]
#[command(
    long_about = "Find every fault of scenes without rendering them.\n\n\
        Each fault is shown with file, line and column and, where there is one, a hint. Exit code 2 if there is any.",
    after_long_help = "Example:\n  spectra check biotar-ortho gray-card"
)]
pub(crate) struct Check {
    /// Scene files, or names of bundled scenes.
    #[arg(value_name = "SCENE", required = true)]
    pub scenes: Vec<PathBuf>,
    #[command(flatten)]
    pub set: Set,
    /// One JSON object on standard output: scenes, each with its faults and warnings.
    #[arg(long)]
    pub json: bool,
}

/// `spectra doc`.
#[derive(Debug, Args)]
#[command(
    long_about = "Show what a stage does, and what is written in it: parameters with types, units, ranges and defaults, \
        examples, references.",
    after_long_help = "Examples:\n  spectra doc surface/even-asphere\n  spectra doc surface\n  spectra doc scene\n  \
        spectra doc render\n  spectra doc film.exposure\n  spectra doc f-number\n  spectra doc --search halo"
)]
pub(crate) struct Doc {
    /// A stage (surface/sphere), a kind of stage (surface), a file (scene, lens, stock, spectrum), or any key or path of
    /// these (render, film.exposure, f-number).
    #[arg(value_name = "NAME", required_unless_present = "search")]
    pub name: Option<String>,
    /// Show every stage and key whose name or text holds this word.
    #[arg(long, value_name = "WORD", conflicts_with = "name")]
    pub search: Option<String>,
    /// One JSON object on standard output.
    #[arg(long)]
    pub json: bool,
}

/// `spectra schema`.
#[derive(Debug, Args)]
#[command(
    long_about = "Write the JSON Schema (2020-12) of scenes, lenses, stocks or spectra to standard output.\n\n\
        It has every stage of this program, plugins included. Editors that know YAML complete and check files by it.",
    after_long_help = "Example:\n  spectra schema scene > spectra-scene.json\n\n\
        and as the first line of a scene, for the YAML language server of most editors:\n  \
        # yaml-language-server: $schema=spectra-scene.json"
)]
pub(crate) struct SchemaOf {
    /// Which files.
    #[arg(value_name = "KIND", default_value = "scene", value_parser = ["scene", "lens", "stock", "spectrum"])]
    pub kind: String,
}

/// `spectra bench`.
#[derive(Debug, Args)]
#[command(
    long_about = "Compare ways to draw wavelengths: error against samples and time.\n\n\
        Each strategy draws for the scene's source, channels and lens. Measured are the spectral integral alone (the \
        exposure of each channel, against exact quadrature; 50 times as many seeds, unless it is all that is measured) and the scene itself (every pixel, \
        against a reference of 16 times the most samples). Errors are relative RMS errors of linear exposure over seeds; \
        95 % intervals by bootstrap over the seeds. `= samples` and `= time` relate a strategy to the first one at the \
        most samples; `bias/se` is the mean's largest distance from the truth in standard errors.\n\n\
        Writes SCENE-sampling.csv, .svg and .png; the table goes to standard output.",
    after_long_help = "Example: three strategies under a fluorescent lamp\n  \
        spectra bench bench/sampling-fl11-ortho --seeds 4 --samples 1,4,16 --integral-only --strategies \
        'source-times-response, uniform, truncated-gaussian{center: 500, sigma: 60}'"
)]
pub(crate) struct Bench {
    /// A scene file, or the name of a bundled scene.
    #[arg(value_name = "SCENE")]
    pub scene: PathBuf,
    #[command(flatten)]
    pub set: Set,
    /// Seeds of each render, 20 if not given; where the integral alone is measured, seeds of that, 1000 if not given.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(2..=10_000))]
    pub seeds: Option<u16>,
    /// Numbers of samples, from 1 to 1048576: of the integral, and of a pixel of the scene.
    #[arg(long, value_name = "N,N,...", value_delimiter = ',', default_value = "1,4,16,64,256",
        value_parser = clap::value_parser!(u32).range(1..=1_048_576))]
    pub samples: Vec<u32>,
    /// Strategies, as NAME or NAME{key: value, ...}; the others are related to the first. All registered ones if not
    /// given, with the scene's keys for its own strategy.
    #[arg(long, value_name = "A,B,...")]
    pub strategies: Option<String>,
    /// Record by this sensitivity in place of the scene's imager, and measure the integral only: a bundled spectrum, a
    /// file (of several columns: a channel each), or one written out (gaussian:540,40). Can be given several times.
    #[arg(long, value_name = "NAME")]
    pub response: Vec<String>,
    /// Measure the spectral integral only.
    #[arg(long)]
    pub integral_only: bool,
    /// Threads to render on: all processors if not given.
    #[arg(short, long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024))]
    pub threads: Option<u16>,
    /// Folder to write to; it is made where it does not exist.
    #[arg(short, long, value_name = "DIR", default_value = "out")]
    pub output: PathBuf,
    /// A JSON object on standard output, in place of the table.
    #[arg(long)]
    pub json: bool,
}

/// `spectra list`.
#[derive(Debug, Args)]
#[command(
    long_about = "List what can be named: the registered stages, and what comes with the program.\n\n\
        Lenses are listed with focal length, f-number, half the field and year; film stocks with speed, process and the \
        year of their sheet, print stocks apart; spectra with kind and range; glasses with nd and Vd; formats with their \
        size. Wherever such a name is wanted a part of it that no other name has is enough: `tri-x`, `helios`.",
    after_long_help = "Examples: which sources are there? Which lenses have 50 mm, which glasses BK7 in their name?\n  \
        spectra list source\n  spectra list lens 50\n  spectra list glass BK7"
)]
pub(crate) struct List {
    /// Only these: source, color, wavelengths, surface, imager, response, film; or scene, lens, stock, spectrum, coating,
    /// glass, sensor, format.
    #[arg(value_name = "KIND")]
    pub stage: Option<String>,
    /// Only those that hold all of these words.
    #[arg(value_name = "WORD", requires = "stage")]
    pub words: Vec<String>,
    /// A JSON list on standard output.
    #[arg(long)]
    pub json: bool,
}

/// `spectra lens`.
#[derive(Debug, Args)]
#[command(after_long_help = "Example:\n  spectra lens info zeiss-biotar-50-f1.4")]
pub(crate) struct LensArguments {
    /// What to do with it.
    #[command(subcommand)]
    pub command: LensCommand,
}

/// The commands on lenses.
#[derive(Debug, Subcommand)]
pub(crate) enum LensCommand {
    /// Show a lens in figures: focal lengths, pupils, f-number, prescription.
    Info(LensInfo),
    /// Show lenses side by side: figures, field, contrast, distortion.
    Compare(LensCompare),
    /// Draw a lens: glass, stop, rays of several fields in their spectral colors.
    Draw(LensDraw),
    /// Trace rays through a lens: CSV in, CSV out.
    Trace(LensTrace),
    /// Make a lens file of one of another program: .zmx, .seq or .csv.
    Import(LensImport),
    /// Write a lens for another program, as .zmx.
    Export(LensExport),
}

/// `spectra lens compare`.
#[derive(Debug, Args)]
#[command(
    long_about = "Show lenses side by side: focal length, f-number, T-number, field, size, contrast on the axis and in the field, \
        distortion.\n\n\
        Contrast is that of geometrical optics at 30 lp/mm, in the plane where it is highest on the axis. The field is the same \
        for all: 0.7 of what the narrowest of them covers. A lens that does not reach --f-number stays wide open, and a note says \
        so.",
    after_long_help = "Example: both at f/2\n  spectra lens compare zeiss-biotar-50-f1.4 helios-44-58-f2 --f-number f/2"
)]
pub(crate) struct LensCompare {
    /// Two or more lens files, or names of bundled lenses (see `spectra list lens`).
    #[arg(value_name = "LENS", num_args = 2.., required = true)]
    pub lenses: Vec<String>,
    #[command(flatten)]
    pub options: LensOptions,
    #[command(flatten)]
    pub light: OneLight,
    /// A JSON object on standard output.
    #[arg(long)]
    pub json: bool,
}

/// `spectra lens draw`.
#[derive(Debug, Args)]
#[command(
    long_about = "Draw a lens: glass tinted by its index and dispersion, stop, image plane, and rays of several fields in the \
        colors of their wavelengths.\n\n\
        Every ray is traced; a fan holds rays evenly over what really passes at its field. An element whose prescription \
        states no size is drawn as large as the light on it.",
    after_long_help = "Example: the Biotar at f/4, three fields\n  \
        spectra lens draw zeiss-biotar-50-f1.4 --f-number f/4 --fields 0,10,20 -o biotar.svg"
)]
pub(crate) struct LensDraw {
    #[command(flatten)]
    pub setting: LensSetting,
    /// File to write: .svg or .png; LENS.svg if not given.
    #[arg(short, long, value_name = "FILE")]
    pub output: Option<PathBuf>,
    /// Field angles in degrees; if not given, the axis, and 0.6 and 0.95 of the largest field that passes (up to 85).
    #[arg(long, value_name = "DEG,DEG,...", value_delimiter = ',', allow_negative_numbers = true)]
    pub fields: Vec<f64>,
    /// Wavelengths (550nm) or lines (C').
    #[arg(long, value_name = "NM,NM,...", value_delimiter = ',', default_value = "F',e,C'", value_parser = wavelength_or_line)]
    pub wavelengths: Vec<f64>,
    /// Rays a fan and wavelength.
    #[arg(long, value_name = "N", default_value = "5", value_parser = clap::value_parser!(u16).range(0..=1001))]
    pub rays: u16,
    /// Distance of the object from the first surface (2m, inf).
    #[arg(long, value_name = "DISTANCE", default_value = "inf", value_parser = parse::<OrInfinity<Positive<Length>>>)]
    pub object: OrInfinity<Positive<Length>>,
    /// The cut: y-z or x-z.
    #[arg(long, value_enum, default_value_t = CutArgument::Y)]
    pub section: CutArgument,
    /// Width of the drawing (of a .png, in half pixels).
    #[arg(long, value_name = "UNITS", default_value = "900", value_parser = clap::value_parser!(u16).range(100..=8000))]
    pub width: u16,
    /// White glass and added light on a black ground.
    #[arg(long)]
    pub dark: bool,
}

/// The plane of a drawing.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
pub(crate) enum CutArgument {
    /// y upward.
    Y,
    /// x upward.
    X,
}

fn wavelength_or_line(text: &str) -> Result<f64, String> {
    match spectra_glass::lines::by_name(text.trim()) {
        Some(line) => Ok(line.wavelength_nm),
        None => parse::<Wavelength>(text).map(|w| w.nm()).map_err(|e| format!("{e}; or a line such as F', e, C'")),
    }
}

/// A lens, and how it is set.
#[derive(Debug, Args)]
pub(crate) struct LensSetting {
    /// A lens file, or the name of a bundled lens (see `spectra list lens`).
    #[arg(value_name = "LENS")]
    pub lens: String,
    #[command(flatten)]
    pub options: LensOptions,
}

/// How a lens is set.
#[derive(Debug, Args)]
pub(crate) struct LensOptions {
    /// Focus at this distance from the first surface (2m, 77cm, inf); as the file has it if not given.
    #[arg(long, value_name = "DISTANCE", value_parser = parse::<OrInfinity<Positive<Length>>>)]
    pub focus: Option<OrInfinity<Positive<Length>>>,
    /// The same, as a bare number of millimeters.
    #[arg(long, value_name = "MM", value_parser = parse::<OrInfinity<Positive<Length>>>, conflicts_with = "focus")]
    pub focus_mm: Option<OrInfinity<Positive<Length>>>,
    /// What --focus makes best, in the light of the lens's reference line, on the axis and at the aperture set.
    #[arg(long, value_name = "MEASURE", value_enum, default_value_t = FocusMeasure::Contrast)]
    pub focus_by: FocusMeasure,
    /// Set the stop to this f-number (f/2), by the real marginal ray; as the file has it if not given.
    #[arg(long, value_name = "F/N", value_parser = parse::<FNumber>)]
    pub f_number: Option<FNumber>,
    /// Coating of all surfaces: ideal (nothing is reflected), bare, single-layer or three-layer; as the file has it if not given.
    #[arg(long, value_name = "COATING", value_parser = ["ideal", "bare", "single-layer", "three-layer"])]
    pub coating: Option<String>,
    /// Whether glass absorbs: true or false; as the file has it if not given.
    #[arg(long, value_name = "BOOL")]
    pub absorption: Option<bool>,
}

/// What a focused lens is best at.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
pub(crate) enum FocusMeasure {
    /// Contrast at 30 line pairs a mm, by real rays, as a scene focuses a 135 frame.
    Contrast,
    /// The smallest spot, root mean square, by real rays.
    #[value(alias = "rms")]
    Spot,
    /// The image of first-order optics.
    Paraxial,
}

impl FocusMeasure {
    /// What real rays are searched by.
    pub(crate) fn criterion(self) -> Option<Criterion> {
        match self {
            Self::Contrast => Some(Criterion::Contrast { per_mm: 30.0 }),
            Self::Spot => Some(Criterion::Rms),
            Self::Paraxial => None,
        }
    }
}

/// One light for all.
#[derive(Debug, Args)]
#[group(multiple = false)]
pub(crate) struct OneLight {
    /// Look at this spectral line: i, h, g, F', F, e, d, D, C', C, r, A', s or t.
    #[arg(long, value_name = "LINE", value_parser = line)]
    pub line: Option<f64>,
    /// Look at this wavelength in air.
    #[arg(long, value_name = "NM", value_parser = parse::<Wavelength>)]
    pub wavelength_nm: Option<Wavelength>,
    /// Hold every glass at the index that the prescription states.
    #[arg(long)]
    pub nd: bool,
}

/// Wavelength of a spectral line, nm.
fn line(name: &str) -> Result<f64, String> {
    spectra_glass::lines::by_name(name).map(|line| line.wavelength_nm).ok_or_else(|| {
        let known: Vec<&str> = spectra_glass::lines::ALL.iter().map(|line| line.name).collect();
        format!("no such spectral line; known: {}", known.join(", "))
    })
}

/// `spectra lens info`.
#[derive(Debug, Args)]
#[command(
    long_about = "Show a lens in figures: focal lengths, principal planes, pupils, f-number, T-number, focus, field, the \
        mounts that it leaves room for, and prescription.\n\n\
        At the reference line of its patent unless a light is given. f-number and pupil diameters are those of the real \
        marginal ray; the places of planes and pupils are paraxial; focus shifts, the largest field and the chief rays \
        are those of real rays. The T-number counts coatings, mirrors and absorption, and says beside it which, and what of it is \
        assumed: coatings of the lens's time, unless its file or --coating says otherwise.",
    after_long_help = "Example: the same lens in blue light\n  spectra lens info zeiss-biotar-50-f1.4 --line g"
)]
pub(crate) struct LensInfo {
    #[command(flatten)]
    pub setting: LensSetting,
    #[command(flatten)]
    pub light: OneLight,
    /// A JSON object on standard output.
    #[arg(long)]
    pub json: bool,
}

/// `spectra lens trace`.
#[derive(Debug, Args)]
#[command(
    long_about = "Trace rays through a lens: CSV in, CSV out.\n\n\
        In: columns x_mm,y_mm,z_mm (a point of the ray before the first surface, whose vertex is the origin; +z runs toward \
        the image), l,m,n (unit direction) and, unless one light is given for all, wavelength_nm; found by name, in any \
        order.\n\n\
        Out, a row for each: status,surface,x_mm,y_mm,z_mm,l,m,n. A `hit` is where the ray meets the image plane, in the \
        same frame; a ray that ended on the way is `missed`, `vignetted`, `tir` or `absorbed`, with the number of the \
        surface from 1. Surfaces clip at stated semi-diameters only, unless --f-number sets the stop; nothing is \
        refocused unless --focus is given.",
    after_long_help = "Example:\n  spectra lens trace zeiss-biotar-50-f1.4 --rays rays.csv --nd -o hits.csv"
)]
pub(crate) struct LensTrace {
    #[command(flatten)]
    pub setting: LensSetting,
    #[command(flatten)]
    pub light: OneLight,
    /// The rays; `-` reads standard input.
    #[arg(long, value_name = "FILE")]
    pub rays: PathBuf,
    /// File to write to; standard output if not given, or `-`.
    #[arg(short, long, value_name = "FILE")]
    pub output: Option<PathBuf>,
    /// One JSON object a ray and line, in place of CSV.
    #[arg(long)]
    pub json: bool,
}

/// `spectra lens import`.
#[derive(Debug, Args)]
#[command(
    long_about = "Make a lens file of one of another program: .zmx (Zemax OpticStudio, sequential), .seq (CODE V) or .csv (a row \
        a surface).\n\n\
        What cannot be carried is listed on standard error and stands in the file as comments; what makes light go another way \
        is marked with `!`. Entrance pupil, f-number, fields and wavelengths become a remark. Every command that takes a \
        lens reads these files too, without importing them first.",
    after_long_help = "Example:\n  spectra lens import tessar.zmx -o tessar.yaml"
)]
pub(crate) struct LensImport {
    /// The file of the other program.
    #[arg(value_name = "FILE")]
    pub file: PathBuf,
    /// Lens file to write; standard output if not given, or `-`.
    #[arg(short, long, value_name = "FILE")]
    pub output: Option<PathBuf>,
    /// Write over a file that exists.
    #[arg(long)]
    pub force: bool,
    /// A JSON object on standard output: what was read, and what was left out; needs -o.
    #[arg(long, requires = "output")]
    pub json: bool,
}

/// `spectra lens export`.
#[derive(Debug, Args)]
#[command(
    long_about = "Write a lens for another program, as .zmx (Zemax OpticStudio and what reads its files).\n\n\
        Glasses go by the names of their catalogues, others by nd and Vd. What cannot be carried is listed on standard error.",
    after_long_help = "Example:\n  spectra lens export zeiss-biotar-50-f1.4 -o biotar.zmx"
)]
pub(crate) struct LensExport {
    /// A lens file, or the name of a bundled lens.
    #[arg(value_name = "LENS")]
    pub lens: String,
    /// File to write, its name ending with .zmx; standard output if not given, or `-`.
    #[arg(short, long, value_name = "FILE")]
    pub output: Option<PathBuf>,
    /// Write over a file that exists.
    #[arg(long)]
    pub force: bool,
    /// A JSON object on standard output: what was written, and what was left out; needs -o.
    #[arg(long, requires = "output")]
    pub json: bool,
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::CommandFactory;

    #[test]
    fn the_grammar_is_sound() {
        Arguments::command().debug_assert();
    }

    #[test]
    fn units_are_read_in_arguments() {
        let arguments = ["spectra", "run", "a.yaml", "--time-limit", "1.5 min", "--set", "film.exposure=1/60 s"];
        let Some(Command::Run(run)) = Arguments::try_parse_from(arguments).expect("good").command else {
            panic!("a run")
        };
        assert_eq!(run.time_limit.map(f64::from), Some(90.0));
        assert_eq!(run.set.overrides, ["film.exposure=1/60 s"]);
        for bad in
            [["--time-limit", "2 m"], ["--time-limit", "-2"], ["--threads", "0"], ["--samples", "0"], ["--seed", "-1"]]
        {
            assert!(Arguments::try_parse_from(["spectra", "run", "a.yaml"].iter().chain(&bad)).is_err(), "{bad:?}");
        }
    }

    #[test]
    fn one_light_at_a_time() {
        let with = |more: &[&str]| Arguments::try_parse_from(["spectra", "lens", "info", "x"].iter().chain(more));
        assert!(with(&["--line", "F'"]).is_ok() && with(&["--nd"]).is_ok());
        assert!(with(&["--nd", "--line", "d"]).is_err());
        assert!(with(&["--line", "q"]).unwrap_err().to_string().contains("no such spectral line"));
    }
}
