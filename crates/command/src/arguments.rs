//! What can be written after `spectra`.

use crate::build::BuildArguments;
use crate::film::FilmArguments;
use crate::frames::Frames;
use crate::glass::GlassArguments;
use crate::new::NewArguments;
use crate::picture::PictureArguments;
use crate::quantity::parse;
use crate::spectrum::SpectrumArguments;
use crate::version;
use clap::{Args, Parser, Subcommand};
use spectra_core::params::{FNumber, Length, OrInfinity, Positive, Ratio, Time, Wavelength};
use spectra_lens::Criterion;
use std::path::PathBuf;

/// The open spectral camera: light of every wavelength, through real glass, onto measured film.
#[derive(Debug, Parser)]
#[command(
    name = "spectra",
    version = version::VERSION,
    long_version = version::long(),
    arg_required_else_help = true,
    after_help = "Start with: spectra run biotar-ortho (`spectra list scene` lists the other bundled scenes)",
    after_long_help = "Start with:\n  spectra run biotar-ortho\n  spectra list scene\n\n\
        Exit codes: 0 success, or stopped by --time-limit; 1 failure (a full disk, a render error); \
        2 invalid input; 130 interrupted by Ctrl-C, 143 by SIGTERM, 129 by SIGHUP.\n\n\
        Environment: SPECTRA_ISA=baseline|avx2|avx512 forces an instruction set (the picture is bit-for-bit the same); \
        NO_COLOR turns colors off."
)]
pub(crate) struct Arguments {
    /// The command to run.
    #[command(subcommand)]
    pub command: Option<Command>,
    /// Show the licenses of the program and of its bundled data.
    #[arg(long, exclusive = true)]
    pub licenses: bool,
    /// Log details to standard error.
    #[arg(short, long, global = true)]
    pub verbose: bool,
}

/// The commands.
#[derive(Debug, Subcommand)]
pub(crate) enum Command {
    /// Render a scene to a picture and to linear exposure data.
    Run(Run),
    /// Check scenes for errors without rendering them.
    Check(Check),
    /// View a scene in the browser: the picture follows every change.
    View(View),
    /// List the stages, lenses, film stocks and other data that scenes can use.
    List(List),
    /// Show what a stage does and which parameters it takes.
    Doc(Doc),
    /// Write the JSON Schema of scenes, lenses, stocks or spectra.
    Schema(SchemaOf),
    /// Analyze, compare, draw, trace, import and export lenses.
    Lens(LensArguments),
    /// Inspect film stocks: sensitivities, curves, dyes.
    Film(FilmArguments),
    /// Compare wavelength sampling strategies: error against samples and time.
    Bench(Bench),
    /// Inspect spectra: color values, plots, fits, color models.
    Spectrum(SpectrumArguments),
    /// Inspect glass: refractive index, Abbe diagram, nearest glass, fits.
    Glass(GlassArguments),
    /// Measure pictures: power and flux, false-color views, cuts, spectra, differences.
    Picture(PictureArguments),
    /// Create a plugin, a scene or a lens of your own.
    New(NewArguments),
    /// Build a version of the program that includes your plugins.
    Build(BuildArguments),
    /// Write a shell completion script.
    Completions(Completions),
    /// Write the man page.
    Man,
}

/// `spectra completions`.
#[derive(Debug, Args)]
#[command(
    long_about = "Write a shell completion script for the commands and options to standard output.",
    after_long_help = "Example:\n  spectra completions bash\n\n\
        To load it in every new shell, save it where the shell looks for completions: \
        ~/.local/share/bash-completion/completions/spectra for bash, a file named _spectra in a folder of $fpath for \
        zsh, ~/.config/fish/completions/spectra.fish for fish."
)]
pub(crate) struct Completions {
    /// The shell to write completions for.
    #[arg(value_name = "SHELL", value_enum)]
    pub shell: clap_complete::Shell,
}

/// `spectra run`.
#[derive(Debug, Args)]
#[command(
    long_about = "Render a scene to a picture and to linear exposure data.\n\n\
        The scene's `output` selects the files: SCENE.exr (linear exposure, one image channel for each channel of the \
        imager or film, 32-bit float) and SCENE.png or SCENE.tiff (the picture for viewing), named after the scene \
        file. SCENE.json holds the time, rays, light losses and versions. --output x.png (.tiff, .exr, .dng, .html) writes \
        only that picture. A file appears under its final name only once it is complete.\n\n\
        Ctrl-C stops within a second and writes the picture so far, marked as partial (exit code 130); a second \
        Ctrl-C quits immediately.\n\n\
        A scene with a `sweep` produces numbered pictures SCENE-001.png ... and a contact sheet SCENE-contact.png; a \
        scene with an `animation` produces frames SCENE.0001.exr ...; SCENE-series.json describes each of them. All \
        are checked before rendering starts. In a sweep or an animation only complete pictures are written, even if \
        it is stopped early.",
    after_long_help = "Examples: a bundled scene; a quick preview of it stopped down, written to the folder `try`\n  \
        spectra run biotar-ortho\n  \
        spectra run biotar-ortho --quality preview --set lens.f-number=f/4 --output try"
)]
pub(crate) struct Run {
    /// A scene file, or the name of a bundled scene (see `spectra list scene`).
    #[arg(value_name = "SCENE")]
    pub scene: PathBuf,
    /// Output folder, created if it does not exist; or the name of a single picture file: x.png, .tiff, .exr, .dng, .html.
    #[arg(short, long, value_name = "DIR|FILE", default_value = "out")]
    pub output: PathBuf,
    #[command(flatten)]
    pub set: Set,
    /// Number of render threads; all processors if not given. It does not affect the picture.
    #[arg(short, long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024))]
    pub threads: Option<u16>,
    /// Random seed, overriding the scene's.
    #[arg(long, value_name = "N")]
    pub seed: Option<u64>,
    /// Samples per pixel, overriding the scene's; four times as many halve the noise. For a scene rendered forward, the
    /// number of rays scales in proportion.
    #[arg(short, long, value_name = "N", value_parser = samples)]
    pub samples: Option<u32>,
    /// Stop when the picture is clean: relative noise of a pixel (1%), of its luminance or of the noisiest film layer,
    /// overriding the scene's. --samples is then the most that a pixel gets.
    #[arg(long, value_name = "PERCENT")]
    pub noise: Option<String>,
    /// Stop at 5 % noise or 256 samples per pixel (`preview`), or at 1 % or 8192 (`final`), whichever comes first; --noise and
    /// --samples override these.
    #[arg(long, value_name = "QUALITY")]
    pub quality: Option<Quality>,
    /// Stop after this time (30s, 5min), counted from the start of the program, and write the picture so far; nothing
    /// is written if the scene is not ready to render by then.
    #[arg(long, value_name = "TIME", value_parser = parse::<Positive<Time>>)]
    pub time_limit: Option<Positive<Time>>,
    /// Render only these frames of an animation: 17, 10-20, 10-, or several of these separated by commas.
    #[arg(long, value_name = "FRAMES", value_parser = <Frames as std::str::FromStr>::from_str)]
    pub frames: Option<Frames>,
    /// Skip pictures of a sweep or an animation whose files all exist, without checking what they were made from.
    #[arg(long)]
    pub skip_existing: bool,
    /// Write one JSON object per line to standard output for each event: start, progress, warning, written, done,
    /// error; for several pictures also check, series and end.
    #[arg(long, conflicts_with = "quiet")]
    pub json: bool,
    /// Print errors only.
    #[arg(short, long, overrides_with = "quiet")]
    pub quiet: bool,
}

/// `--set`.
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

/// The word of `--quality`.
#[derive(Clone, Copy, Debug, clap::ValueEnum)]
pub(crate) enum Quality {
    Preview,
    Final,
}

impl Quality {
    /// Noise, and the most samples a pixel.
    pub fn figures(self) -> (&'static str, u32) {
        match self {
            Self::Preview => ("5 %", 256),
            Self::Final => ("1 %", 8192),
        }
    }
}

/// The number of `--samples`.
fn samples(text: &str) -> Result<u32, String> {
    let wanted = "expected a whole number from 1 to 4194304, such as 64";
    match text.trim().parse::<u32>() {
        Ok(samples) if (1..=4_194_304).contains(&samples) => Ok(samples),
        _ => Err(wanted.to_owned()),
    }
}

/// `spectra view`.
#[derive(Debug, Args)]
#[command(
    long_about = "View a scene in the browser: the picture follows every change.\n\n\
        A page opens with the picture, which grows as light is traced, the lens with its rays, and a control for each number and \
        choice of the scene. What changes development alone (print, push, grain) traces no light again. `Save to the scene` \
        writes what was changed into the scene file, where it stands, and leaves the rest of the file as it is.\n\n\
        The address is printed to standard output. It opens once, in one browser, and only on this machine. Ctrl-C ends the \
        viewer.",
    after_long_help = "Examples: a bundled scene; another film, and the address alone; wavelengths as a screen shows them\n  \
        spectra view biotar-ortho\n  \
        spectra view biotar-ortho --set film.stock=tri-x --no-open\n  \
        spectra view --color-tester"
)]
pub(crate) struct View {
    /// A scene file, or the name of a bundled scene (see `spectra list scene`).
    #[arg(value_name = "SCENE", required_unless_present = "color_tester")]
    pub scene: Option<PathBuf>,
    /// In place of a scene: light of one wavelength or a narrow band, as a screen can show it.
    #[arg(long, conflicts_with_all = ["scene", "overrides", "threads"])]
    pub color_tester: bool,
    /// Port of this machine to serve the page at; 0 takes a free one.
    #[arg(long, value_name = "PORT", default_value_t = 0)]
    pub port: u16,
    /// Print the address without opening a browser.
    #[arg(long)]
    pub no_open: bool,
    #[command(flatten)]
    pub set: Set,
    /// Number of render threads; all processors if not given. It does not affect the picture.
    #[arg(short, long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024))]
    pub threads: Option<u16>,
}

/// `spectra check`.
#[derive(Debug, Args)]
#[command(
    long_about = "Check scenes for errors without rendering them.\n\n\
        Each error is shown with file, line, column and, if available, a hint. The exit code is 2 if there are any.",
    after_long_help = "Example:\n  spectra check biotar-ortho gray-card"
)]
pub(crate) struct Check {
    /// Scene files, or names of bundled scenes.
    #[arg(value_name = "SCENE", required = true)]
    pub scenes: Vec<PathBuf>,
    #[command(flatten)]
    pub set: Set,
    /// Write a JSON object to standard output: scenes, each with its faults and warnings.
    #[arg(long)]
    pub json: bool,
}

/// `spectra doc`.
#[derive(Debug, Args)]
#[command(
    long_about = "Show what a stage does and which parameters it takes, with types, units, ranges and defaults, \
        examples, references.",
    after_long_help = "Examples:\n  spectra doc surface/even-asphere\n  spectra doc surface\n  spectra doc scene\n  \
        spectra doc render\n  spectra doc film.exposure\n  spectra doc f-number\n  spectra doc --search halo"
)]
pub(crate) struct Doc {
    /// A stage (surface/sphere), a kind of stage (surface), a file (scene, lens, stock, spectrum), or any key or path
    /// in one of these (render, film.exposure, f-number).
    #[arg(value_name = "NAME", required_unless_present = "search")]
    pub name: Option<String>,
    /// Show every stage and key whose name or description contains this word.
    #[arg(long, value_name = "WORD", conflicts_with = "name")]
    pub search: Option<String>,
    /// Write a JSON object to standard output.
    #[arg(long)]
    pub json: bool,
}

/// `spectra schema`.
#[derive(Debug, Args)]
#[command(
    long_about = "Write the JSON Schema (2020-12) of scenes, lenses, stocks or spectra to standard output.\n\n\
        It covers every stage of this program, including plugins. Editors with YAML support use it to complete and \
        check files.",
    after_long_help = "Example:\n  spectra schema scene > spectra-scene.json\n\n\
        Then put this in the first line of a scene, for the YAML language server used by most editors:\n  \
        # yaml-language-server: $schema=spectra-scene.json"
)]
pub(crate) struct SchemaOf {
    /// The kind of file.
    #[arg(value_name = "KIND", default_value = "scene", value_parser = ["scene", "lens", "stock", "spectrum"])]
    pub kind: String,
}

/// `spectra bench`.
#[derive(Debug, Args)]
#[command(
    long_about = "Compare wavelength sampling strategies: error against samples and time.\n\n\
        Each strategy samples wavelengths for the scene's source, channels and lens. Two things are measured: the \
        spectral integral alone (the exposure of each channel, against exact quadrature; with 50 times as many seeds, \
        unless only the integral is measured) and the scene itself (every pixel, against a reference with 16 times \
        the largest number of samples). Errors are relative RMS errors of linear exposure over seeds, with 95 % \
        intervals by bootstrap over the seeds. `= samples` and `= time` compare a strategy with the first one at the \
        largest number of samples; `bias/se` is the largest deviation of the mean from the true value, in standard \
        errors.\n\n\
        Writes SCENE-sampling.csv, .svg and .png; the table goes to standard output.",
    after_long_help = "Example: three strategies under a fluorescent lamp\n  \
        spectra bench bench/sampling-fl11-ortho --seeds 4 --samples 1,4,16 --integral-only --strategies \
        'source-times-response, uniform, truncated-gaussian{center: 500, sigma: 60}'"
)]
#[command(args_conflicts_with_subcommands = true, subcommand_negates_reqs = true)]
pub(crate) struct Bench {
    /// Something else to measure.
    #[command(subcommand)]
    pub other: Option<OtherBench>,
    /// A scene file, or the name of a bundled scene.
    #[arg(value_name = "SCENE", required = true)]
    pub scene: Option<PathBuf>,
    #[command(flatten)]
    pub set: Set,
    /// Number of seeds per render, 20 if not given; if only the integral is measured, seeds for that, 1000 if not
    /// given.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(2..=10_000))]
    pub seeds: Option<u16>,
    /// Numbers of samples to test, from 1 to 1048576: for the integral, and per pixel for the scene.
    #[arg(long, value_name = "N,N,...", value_delimiter = ',', default_value = "1,4,16,64,256",
        value_parser = clap::value_parser!(u32).range(1..=1_048_576))]
    pub samples: Vec<u32>,
    /// Strategies, as NAME or NAME{key: value, ...}; the first is the baseline for the others. If not given, all
    /// registered ones; the scene's own strategy keeps its keys.
    #[arg(long, value_name = "A,B,...")]
    pub strategies: Option<String>,
    /// Record with this sensitivity instead of the scene's imager, and measure only the integral: a bundled spectrum, a
    /// file (one channel per column), or an expression (gaussian:540,40). Can be repeated.
    #[arg(long, value_name = "NAME")]
    pub response: Vec<String>,
    /// Measure only the spectral integral.
    #[arg(long)]
    pub integral_only: bool,
    /// Number of render threads; all processors if not given.
    #[arg(short, long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024))]
    pub threads: Option<u16>,
    /// Output folder, created if it does not exist.
    #[arg(short, long, value_name = "DIR", default_value = "out")]
    pub output: PathBuf,
    /// Write a JSON object to standard output instead of the table.
    #[arg(long)]
    pub json: bool,
}

/// What else `spectra bench` measures.
#[derive(Debug, Subcommand)]
pub(crate) enum OtherBench {
    /// Measure how long scenes take until they are clean: time to 1 % noise.
    Noise(BenchNoise),
    /// Measure how clean ghosts are after how much time, and what the search for their rays gains.
    Ghosts(BenchGhosts),
}

/// `spectra bench ghosts`.
#[derive(Debug, Args)]
#[command(
    long_about = "Measure how clean ghosts are after how much time, and what the search for their rays gains.\n\n\
        Of each scene nothing but the ghosts is rendered, several times with different seeds: as its pictures have them, and with \
        as many rays for each path all over the front of the lens. Noise is the standard deviation between the seeds of blocks of \
        32 x 32 pixels, relative to their mean, where ghosts have more than 1e-4 of the brightest block; and that of single pixels. \
        The gain is how many times longer the even rays take to the same noise.\n\n\
        The table (Markdown) goes to standard output.",
    after_long_help = "Example: one sun through a bare lens of 1927\n  spectra bench ghosts bench/ghosts-sun --seeds 8"
)]
pub(crate) struct BenchGhosts {
    /// Scene files, or names of bundled scenes.
    #[arg(value_name = "SCENE", required = true)]
    pub scenes: Vec<PathBuf>,
    #[command(flatten)]
    pub set: Set,
    /// Number of seeds, at least 2.
    #[arg(long, value_name = "N", default_value = "4", value_parser = clap::value_parser!(u16).range(2..=1000))]
    pub seeds: u16,
    /// Number of render threads; all processors if not given.
    #[arg(short, long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024))]
    pub threads: Option<u16>,
    /// Write a JSON list to standard output instead of the table.
    #[arg(long)]
    pub json: bool,
}

/// `spectra bench noise`.
#[derive(Debug, Args)]
#[command(
    long_about = "Measure how long scenes take until they are clean: time to 1 % noise, and noise after some time.\n\n\
        Each scene is rendered several times with different seeds, in each direction that is possible, with as many samples \
        as the time allows. Noise is the standard deviation between the seeds, relative to the mean, of luminance (or of the \
        first channel of an imager without luminance) in squares of 8 x 8 pixels. The table has the median of the squares \
        and the value that 95 % of them stay below. Times to other noise levels are extrapolated: noise falls with the \
        square root of the time.\n\n\
        The table (Markdown) goes to standard output.",
    after_long_help = "Example: the bundled scenes for this measurement, with the direction that the program chooses\n  \
        spectra bench noise bench/noise-flat bench/noise-portrait bench/noise-lights bench/noise-night --directions auto"
)]
pub(crate) struct BenchNoise {
    /// Scene files, or names of bundled scenes.
    #[arg(value_name = "SCENE", required = true)]
    pub scenes: Vec<PathBuf>,
    #[command(flatten)]
    pub set: Set,
    /// Number of seeds, at least 2.
    #[arg(long, value_name = "N", default_value = "4", value_parser = clap::value_parser!(u16).range(2..=1000))]
    pub seeds: u16,
    /// Seconds of tracing for each seed at most.
    #[arg(long, value_name = "S", default_value = "10", value_parser = clap::value_parser!(u16).range(1..=36000))]
    pub seconds: u16,
    /// Values of `render.direction` to try.
    #[arg(long, value_name = "A,B,...", value_delimiter = ',', default_value = "auto,backward,forward",
        value_parser = ["auto", "backward", "forward", "both"])]
    pub directions: Vec<String>,
    /// Number of render threads; all processors if not given.
    #[arg(short, long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024))]
    pub threads: Option<u16>,
    /// Write a JSON list to standard output instead of the table.
    #[arg(long)]
    pub json: bool,
}

/// `spectra list`.
#[derive(Debug, Args)]
#[command(
    long_about = "List the names that can be used: the registered stages and the bundled data.\n\n\
        Lenses are listed with focal length, f-number, half field angle and year; film stocks with speed, process and \
        the year of their data sheet, print stocks separately; spectra with kind and range; glasses with nd and Vd; \
        formats with their size. Wherever a name is expected, any part of it that is unique is enough: `tri-x`, \
        `helios`.",
    after_long_help = "Examples: all light sources; lenses with 50 and glasses with BK7 in their names\n  \
        spectra list source\n  spectra list lens 50\n  spectra list glass BK7"
)]
pub(crate) struct List {
    /// List only this kind: source, color, wavelengths, surface, imager, response, film, output, coating,
    /// aperture, formula; or scene, lens, stock, spectrum, glass, sensor, format.
    #[arg(value_name = "KIND")]
    pub stage: Option<String>,
    /// List only entries that contain all of these words.
    #[arg(value_name = "WORD", requires = "stage")]
    pub words: Vec<String>,
    /// Write a JSON list to standard output.
    #[arg(long)]
    pub json: bool,
}

/// `spectra lens`.
#[derive(Debug, Args)]
#[command(after_long_help = "Example:\n  spectra lens info zeiss-biotar-50-f1.4")]
pub(crate) struct LensArguments {
    /// The command to run.
    #[command(subcommand)]
    pub command: LensCommand,
}

/// The commands on lenses.
#[derive(Debug, Subcommand)]
pub(crate) enum LensCommand {
    /// Show the data of a lens: focal lengths, pupils, f-number, prescription.
    Info(LensInfo),
    /// Compare lenses side by side: focal length, f-number, field, contrast, distortion.
    Compare(LensCompare),
    /// Draw a lens: glass, stop, and rays from several field angles in their spectral colors.
    Draw(LensDraw),
    /// List the ghosts of a lens: energy, focus, size and color of each pair of reflections.
    Ghosts(LensGhosts),
    /// Trace rays through a lens: CSV in, CSV out.
    Trace(LensTrace),
    /// Convert a lens file from another program: .zmx, .seq or .csv.
    Import(LensImport),
    /// Export a lens for other programs, as .zmx.
    Export(LensExport),
}

/// `spectra lens compare`.
#[derive(Debug, Args)]
#[command(
    long_about = "Compare lenses side by side: focal length, f-number, T-number, field, size, contrast on axis and \
        off axis, distortion.\n\n\
        Contrast is geometrical, at 30 lp/mm, in the plane where it is highest on axis. The off-axis field is the \
        same for all lenses: 0.7 of the field of the narrowest one. A lens that cannot reach --f-number stays wide \
        open, with a note.",
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
    /// Write a JSON object to standard output.
    #[arg(long)]
    pub json: bool,
}

/// `spectra lens draw`.
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
    #[arg(long, value_name = "DISTANCE", default_value = "inf", value_parser = parse::<OrInfinity<Positive<Length>>>)]
    pub object: OrInfinity<Positive<Length>>,
    /// Plane of the cross-section: `y` is the y-z plane, `x` the x-z plane.
    #[arg(long, value_enum, default_value_t = CutArgument::Y)]
    pub section: CutArgument,
    /// Width of the drawing; a .png is twice as many pixels wide.
    #[arg(long, value_name = "UNITS", default_value = "900", value_parser = clap::value_parser!(u16).range(100..=8000))]
    pub width: u16,
    /// White glass and additively blended rays on a black background.
    #[arg(long)]
    pub dark: bool,
}

/// The plane of a drawing.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
pub(crate) enum CutArgument {
    /// The y-z plane, y up.
    #[value(alias = "y-z")]
    Y,
    /// The x-z plane, x up.
    #[value(alias = "x-z")]
    X,
}

/// A part of something: from 0 to 1.
fn share(text: &str) -> Result<f64, String> {
    let value = text.parse::<f64>().ok().filter(|v| (0.0..=1.0).contains(v));
    value.ok_or_else(|| "a part from 0 to 1, such as 1e-8".to_owned())
}

/// An angle that light can come from in front.
fn field(text: &str) -> Result<f64, String> {
    let value = text.parse::<f64>().ok().filter(|v| v.abs() < 90.0);
    value.ok_or_else(|| "degrees between -90 and 90".to_owned())
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
    /// Focus at this distance from the first surface (2m, 77cm, inf); as in the file if not given.
    #[arg(long, value_name = "DISTANCE", value_parser = parse::<OrInfinity<Positive<Length>>>)]
    pub focus: Option<OrInfinity<Positive<Length>>>,
    /// Focus distance as a plain number in millimeters.
    #[arg(long, value_name = "MM", value_parser = parse::<OrInfinity<Positive<Length>>>, conflicts_with = "focus")]
    pub focus_mm: Option<OrInfinity<Positive<Length>>>,
    /// What --focus optimizes, at the lens's reference line, on axis and at the chosen aperture.
    #[arg(long, value_name = "MEASURE", value_enum, default_value_t = FocusMeasure::Contrast)]
    pub focus_by: FocusMeasure,
    /// Set the stop to this f-number (f/2), measured with the real marginal ray; as in the file if not given.
    #[arg(long, value_name = "F/N", value_parser = parse::<FNumber>)]
    pub f_number: Option<FNumber>,
    /// Coating of all surfaces: ideal (no reflection), bare, single-layer, three-layer, another of `spectra list coating` that
    /// has no required parameters, or a file; as in the lens file if not given.
    #[arg(long, value_name = "COATING")]
    pub coating: Option<String>,
    /// Whether glass absorbs light: true or false; as in the file if not given.
    #[arg(long, value_name = "BOOL")]
    pub absorption: Option<bool>,
}

/// What a focused lens is best at.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
pub(crate) enum FocusMeasure {
    /// Highest contrast at 30 line pairs per mm, with real rays, as scenes on a 135 frame are focused.
    Contrast,
    /// Smallest RMS spot, with real rays.
    #[value(alias = "rms")]
    Spot,
    /// The paraxial (first-order) image.
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
    /// Use this spectral line: i, h, g, F', F, e, d, D, C', C, r, A', s or t.
    #[arg(long, value_name = "LINE", value_parser = line)]
    pub line: Option<f64>,
    /// Use this wavelength in air.
    #[arg(long, value_name = "NM", value_parser = parse::<Wavelength>)]
    pub wavelength_nm: Option<Wavelength>,
    /// Use the index stated in the prescription for every glass.
    #[arg(long)]
    pub nd: bool,
}

/// Wavelength of a spectral line, nm.
fn line(name: &str) -> Result<f64, String> {
    spectra_glass::lines::by_name(name).map(|line| line.wavelength_nm).ok_or_else(|| {
        let known: Vec<&str> = spectra_glass::lines::ALL.iter().map(|line| line.name).collect();
        format!("no such spectral line; {}", spectra_core::names::hint(name, &known, ""))
    })
}

/// A part of the light: `4 %`, `0.04`.
fn part(text: &str) -> Result<f64, String> {
    let part = parse::<Ratio>(text)?.number();
    if (0.0..=1.0).contains(&part) { Ok(part) } else { Err("expected a part from 0 to 100 %".to_owned()) }
}

/// `spectra lens info`.
#[derive(Debug, Args)]
#[command(
    long_about = "Show the data of a lens: focal lengths, principal planes, pupils, f-number, T-number, focus, field, \
        the mounts it leaves room for, and prescription.\n\n\
        Values are for the reference line of the lens's patent, unless a line or wavelength is given. The f-number \
        and pupil diameters come from the real marginal ray; the positions of planes and pupils are paraxial; focus \
        shifts, the largest field and the chief rays come from real rays. The T-number includes coatings, mirrors and \
        absorption; a note beside it lists these and what is assumed: coatings typical of the lens's time, unless its \
        file or --coating says otherwise.\n\n\
        --glare adds the veiling glare index by the integral method of ISO 9358: the light in the middle of a black disk \
        within an endless white field, over that without the disk. The image of the disk is a tenth as large as the diagonal of \
        a 36 x 24 mm frame; its middle half is looked at, in the light of the report. Light is reflected by every surface any number \
        of times, and scattered by black paint on barrel, rims, edges of the glass and blades.",
    after_long_help = "Examples: the same lens in blue light; its veiling glare with a single layer on each surface\n  \
        spectra lens info zeiss-biotar-50-f1.4 --line g\n  \
        spectra lens info zeiss-biotar-50-f1.4 --f-number f/2 --coating single-layer --glare"
)]
pub(crate) struct LensInfo {
    #[command(flatten)]
    pub setting: LensSetting,
    #[command(flatten)]
    pub light: OneLight,
    /// List every mount that the lens fits, not only the common ones.
    #[arg(long)]
    pub mounts: bool,
    /// Work out the veiling glare index (some seconds).
    #[arg(long)]
    pub glare: bool,
    /// Diffuse reflectance of the black paint, for --glare; 4 % if not given.
    #[arg(long, value_name = "PART", value_parser = part, requires = "glare")]
    pub paint: Option<f64>,
    /// Diffuse reflectance of the film or sensor, for --glare; none if not given, as ISO 9358 looks at the lens alone.
    #[arg(long, value_name = "PART", value_parser = part, requires = "glare")]
    pub film_reflectance: Option<f64>,
    /// Write a JSON object to standard output.
    #[arg(long)]
    pub json: bool,
}

/// `spectra lens ghosts`.
#[derive(Debug, Args)]
#[command(
    long_about = "List the ghosts of a lens: light that two surfaces reflect on its way to the film, or four.\n\n\
        For light from infinity on the axis, at the reference line: energy relative to the straight light; distance of the ghost's focus \
        from the image plane, positive beyond it, and its focal length (both paraxial); the diameter of its disk on the image plane; \
        and its energy at C', e and F' over that at e. Surfaces are counted from 1, in the order in which they reflect. Coatings are those \
        of the lens file, or typical of its time, unless --coating says otherwise.\n\n\
        Paths of four reflections (--order 4) are searched by following the light: whatever a path begins with less than --share of the \
        straight light is cut there, since nothing further on can add to it. What is not followed is said.\n\n\
        With -o the lens is drawn with the rays of a ghost: the one that is brightest on the film, or that of --path.",
    after_long_help = "Examples: what a single layer does; the brightest ghost; one of those with the light from 20 degrees\n  \
        spectra lens ghosts zeiss-biotar-50-f1.4 --coating single-layer\n  \
        spectra lens ghosts zeiss-biotar-50-f1.4 -o ghost.svg\n  \
        spectra lens ghosts zeiss-biotar-50-f1.4 -o ghost.svg --path 7,3 --field 20"
)]
pub(crate) struct LensGhosts {
    #[command(flatten)]
    pub setting: LensSetting,
    /// Reflections at most: 2, or 4.
    #[arg(long, value_name = "N", default_value = "2", value_parser = ["2", "4"])]
    pub order: String,
    /// Leave out paths of four reflections that begin with less than this part of the straight light.
    #[arg(long, value_name = "PART", default_value = "1e-8", value_parser = share)]
    pub share: f64,
    /// Draw the lens with the rays of a ghost: the one brightest on the film, or that of --path. To .svg or .png.
    #[arg(short, long, value_name = "FILE")]
    pub output: Option<PathBuf>,
    /// The ghost to draw: the surfaces that reflect it, counted from 1, in the order of the light.
    #[arg(long, value_name = "A,B", value_delimiter = ',', requires = "output")]
    pub path: Vec<usize>,
    /// Field angle of the light that is drawn, degrees.
    #[arg(long, value_name = "DEG", default_value = "0", allow_negative_numbers = true, requires = "output",
        value_parser = field)]
    pub field: f64,
    /// Number of rays that are drawn.
    #[arg(long, value_name = "N", default_value = "11", requires = "output",
        value_parser = clap::value_parser!(u16).range(1..=1001))]
    pub rays: u16,
    /// Show all of them, not only the brightest.
    #[arg(long)]
    pub all: bool,
    /// Write a JSON object to standard output, with all of them.
    #[arg(long)]
    pub json: bool,
}

/// `spectra lens trace`.
#[derive(Debug, Args)]
#[command(
    long_about = "Trace rays through a lens: CSV in, CSV out.\n\n\
        Input columns: x_mm,y_mm,z_mm (a point on the ray before the first surface, whose vertex is the origin; +z \
        runs toward the image), l,m,n (unit direction) and wavelength_nm, unless one line or wavelength is given for \
        all rays. Columns are found by name, in any order.\n\n\
        Output, one row per ray: status,surface,x_mm,y_mm,z_mm,l,m,n,wavelength_nm,transmittance,optical_path_mm. A \
        `hit` is where the ray meets the image plane, in the same coordinates; a ray that ends earlier is `missed`, \
        `vignetted`, `tir` or `absorbed`, with the number of the surface, counted from 1. `transmittance` is what \
        coatings and glass leave of the light, `optical_path_mm` the index times the length from the start of the ray. \
        --every-surface has a row `passed` for each surface as well, with the direction behind it, and the number of the \
        ray first. Surfaces clip only at stated semi-diameters, unless --f-number sets the stop; the lens is not \
        refocused unless --focus is given.",
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
    /// Follow the path that these surfaces reflect, counted from 1, in the order of the light: 7,3 is a ghost.
    #[arg(long, value_name = "A,B", value_delimiter = ',')]
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

/// `spectra lens import`.
#[derive(Debug, Args)]
#[command(
    long_about = "Convert a lens file from another program: .zmx (Zemax OpticStudio, sequential), .seq (CODE V) or \
        .csv (one row per surface).\n\n\
        Anything that cannot be converted is listed on standard error and kept in the file as comments; anything that \
        changes the path of light is marked with `!`. Entrance pupil, f-number, fields and wavelengths become a \
        remark. Every command that takes a lens also reads these files directly, without importing them first.",
    after_long_help = "Example:\n  spectra lens import tessar.zmx -o tessar.yaml"
)]
pub(crate) struct LensImport {
    /// The file to convert.
    #[arg(value_name = "FILE")]
    pub file: PathBuf,
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

/// `spectra lens export`.
#[derive(Debug, Args)]
#[command(
    long_about = "Export a lens for other programs, as .zmx (Zemax OpticStudio and programs that read its files).\n\n\
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
