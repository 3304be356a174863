//! Command-line arguments of `spectra`. The doc comments of the fields are the help texts.

use crate::build::BuildArguments;
use crate::film::FilmArguments;
use crate::frames::Frames;
use crate::glass::GlassArguments;
use crate::lens::LensArguments;
use crate::new::NewArguments;
use crate::picture::PictureArguments;
use crate::quantity::percent;
use crate::report::JsonReport;
use crate::set::Set;
use crate::spectrum::SpectrumArguments;
use crate::version;
use clap::{Args, Parser, Subcommand};
use spectra_core::params::{Fault, Positive, Quantity, Time};
use std::path::PathBuf;

/// The open spectral camera: light of every wavelength, through real glass, onto measured film.
#[derive(Debug, Parser)]
#[command(
    name = "spectra",
    version = version::VERSION,
    long_version = version::long(),
    arg_required_else_help = true,
    after_help = "Start with: spectra run biotar-ortho (`spectra list scene` lists the other bundled scenes); \
        to develop a photograph: spectra film develop photo.jpg --stock tri-x",
    after_long_help = "Start with:\n  spectra run biotar-ortho\n  spectra list scene\n  \
        spectra film develop photo.jpg --stock tri-x\n\n\
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

/// The commands of `spectra`.
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
    /// Develop photographs on film (`film develop`) and inspect film stocks: sensitivities, curves, dyes.
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

/// Arguments of `spectra completions`.
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

/// Arguments of `spectra run`.
#[derive(Debug, Args)]
#[command(
    long_about = "Render a scene to a picture and to linear exposure data.\n\n\
        The scene's `output` selects the files: SCENE.exr (linear exposure, one image channel for each channel of the \
        imager or film, 32-bit float) and SCENE.png or SCENE.tiff (the picture for viewing), named after the scene \
        file. SCENE.json holds the time, rays, light losses and versions. --output x.png (.tiff, .exr, .dng, .html) writes \
        only that picture. A file appears under its final name only once it is complete.\n\n\
        Light is traced in passes over the whole frame. Ctrl-C stops within a second and writes the whole frame, noisier, \
        marked as partial (exit code 130). If a complete file exists, it is kept and the partial one is named \
        NAME.partial.png. A second Ctrl-C quits immediately.\n\n\
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
    /// overriding the scene's; `auto` is a third of the film's grain, and 1 % without grain. --samples is then the largest number
    /// of samples that a pixel gets.
    #[arg(long, value_name = "NOISE", value_parser = percent)]
    pub noise: Option<String>,
    /// Stop at 5 % noise or 256 samples per pixel (`preview`), or at 1 % or 8192 (`final`), whichever comes first; --noise and
    /// --samples override these.
    #[arg(long, value_name = "QUALITY")]
    pub quality: Option<Quality>,
    /// Be done this long (30s, 5min) after the start of the program: write the whole frame as it is by then, noisier. A time that
    /// does not suffice for a first pass over the frame ends with exit code 1. In a series, finished pictures are kept.
    #[arg(long, value_name = "TIME", value_parser = Positive::<Time>::from_text)]
    pub time_limit: Option<Positive<Time>>,
    /// Write the picture as it stands this often (10s, 5min), as SCENE.partial.png and so on; removed at the end.
    #[arg(long, value_name = "TIME", value_parser = Positive::<Time>::from_text)]
    pub snapshot: Option<Positive<Time>>,
    /// Render only these frames of an animation: 17, 10-20, 10-, or several of these separated by commas.
    #[arg(long, value_name = "FRAMES", value_parser = <Frames as std::str::FromStr>::from_str)]
    pub frames: Option<Frames>,
    /// Skip pictures of a sweep or an animation whose files all exist and are not empty. What they were made from is not checked.
    #[arg(long)]
    pub skip_existing: bool,
    /// Write one JSON object per line to standard output for each event: start, progress, snapshot, warning, written, done,
    /// error; for several pictures also check, series and end.
    #[arg(long, conflicts_with = "quiet")]
    pub json: bool,
    /// Print errors only.
    #[arg(short, long, overrides_with = "quiet")]
    pub quiet: bool,
}

/// Quality preset chosen with `--quality`.
#[derive(Clone, Copy, Debug, clap::ValueEnum)]
pub(crate) enum Quality {
    Preview,
    Final,
}

impl Quality {
    /// Returns the noise target and the largest number of samples per pixel.
    pub fn figures(self) -> (&'static str, u32) {
        match self {
            Self::Preview => ("5 %", 256),
            Self::Final => ("1 %", 8192),
        }
    }
}

/// Parses one of the numbers of `spectra bench --samples`.
fn sample_count(text: &str) -> Result<u32, Fault> {
    const MOST: u32 = 1_048_576;
    let wanted = "expected whole numbers separated by commas, such as 1,4,16,64";
    let number = text.trim().parse::<u32>().ok().filter(|n| (1..=MOST).contains(n));
    number.ok_or_else(|| match text.parse::<f64>() {
        Ok(_) => format!("expected whole numbers from 1 to {MOST}, such as 1,4,16,64").into(),
        Err(_) => wanted.into(),
    })
}

/// Parses the number of `--samples`.
fn samples(text: &str) -> Result<u32, Fault> {
    let wanted = "expected a whole number from 1 to 4194304, such as 64";
    match text.trim().parse::<u32>() {
        Ok(samples) if (1..=4_194_304).contains(&samples) => Ok(samples),
        _ => Err(wanted.into()),
    }
}

/// Arguments of `spectra view`.
#[derive(Debug, Args)]
#[command(
    long_about = "View a scene, or a photograph on film, in the browser: the picture follows every change.\n\n\
        A page opens with the picture, which becomes cleaner as light is traced, the lens with its rays, and a control for each number \
        and choice of the scene. Changes that affect only the development (print, push, grain) do not trace light again. \
        `Save to the scene` writes the changed values into the scene file and leaves the rest of the file as it is.\n\n\
        A photograph (OpenEXR, PNG, JPEG, TIFF, WebP, BMP or Radiance HDR) is developed as `spectra film develop` would, on the film \
        of --stock; choose a lens on the page to see the photograph through it.\n\n\
        The address is printed to standard output. It works only once, in one browser, and only on this machine. Ctrl-C ends the \
        viewer.",
    after_long_help = "Examples: a bundled scene; a photograph of yours; another film, without opening a browser; wavelengths as a \
        screen shows them\n  \
        spectra view biotar-ortho\n  \
        spectra view photo.jpg --stock tri-x\n  \
        spectra view biotar-ortho --set film.stock=tri-x --no-open\n  \
        spectra view --color-tester"
)]
pub(crate) struct View {
    /// A scene file, the name of a bundled scene (see `spectra list scene`), or a photograph.
    #[arg(value_name = "SCENE|PICTURE", required_unless_present = "color_tester")]
    pub scene: Option<PathBuf>,
    /// Film for a photograph: a bundled stock (see `spectra list stock`), a part of its name, or a YAML file; kodak-portra-400 if
    /// not given.
    #[arg(long, value_name = "NAME", conflicts_with = "color_tester")]
    pub stock: Option<String>,
    /// Show light of one wavelength or a narrow band, as a screen can show it, instead of a scene.
    #[arg(long, conflicts_with_all = ["scene", "overrides", "threads"])]
    pub color_tester: bool,
    /// Port on this machine that serves the page; 0 chooses a free one.
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

/// Arguments of `spectra check`.
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

/// Arguments of `spectra doc`.
#[derive(Debug, Args)]
#[command(
    long_about = "Show what a stage does and which parameters it takes, with types, units, ranges, defaults, \
        examples and references.",
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
    #[command(flatten)]
    pub report: JsonReport,
}

/// Arguments of `spectra schema`.
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
    /// The kind of file to describe.
    #[arg(value_name = "KIND", default_value = "scene", value_parser = ["scene", "lens", "stock", "spectrum"])]
    pub kind: String,
}

/// Arguments of `spectra bench`.
#[derive(Debug, Args)]
#[command(
    long_about = "Compare wavelength sampling strategies: error against samples and time.\n\n\
        Each strategy samples wavelengths for the scene's source, channels and lens. Two things are measured: the \
        spectral integral alone (the exposure of each channel, against exact quadrature; with 50 times as many seeds, \
        unless only the integral is measured) and the scene itself (every pixel, against a reference with 16 times \
        the largest number of samples). Errors are relative RMS errors of linear exposure over the seeds, with 95 % \
        confidence intervals from a bootstrap over the seeds. `= samples` and `= time` compare a strategy with the first \
        one at the largest number of samples; `bias/se` is the largest deviation of the mean from the true value, in \
        standard errors.\n\n\
        Writes SCENE-sampling.csv, .svg and .png, and SCENE-sampling-seeds.csv with the errors of each seed; the table \
        goes to standard output.",
    after_long_help = "Example: three strategies under a fluorescent lamp\n  \
        spectra bench bench/sampling-fl11-ortho --seeds 4 --samples 1,4,16 --integral-only --strategies \
        'source-times-response, uniform, truncated-gaussian{center: 500, sigma: 60}'"
)]
#[command(args_conflicts_with_subcommands = true, subcommand_negates_reqs = true)]
pub(crate) struct Bench {
    /// Another kind of measurement.
    #[command(subcommand)]
    pub other: Option<OtherBench>,
    /// A scene file, or the name of a bundled scene.
    #[arg(value_name = "SCENE", required = true)]
    pub scene: Option<PathBuf>,
    #[command(flatten)]
    pub set: Set,
    /// Number of seeds per render, 20 if not given. If only the integral is measured, the number of seeds for it, 1000 if not given.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(2..=10_000))]
    pub seeds: Option<u16>,
    /// Base seed for all renders and integrals; the scene's seed if not given.
    #[arg(long, value_name = "N")]
    pub seed: Option<u64>,
    /// Numbers of samples to test, from 1 to 1048576: for the integral, and per pixel for the scene.
    #[arg(long, value_name = "N,N,...", value_delimiter = ',', default_value = "1,4,16,64,256",
        value_parser = sample_count)]
    pub samples: Vec<u32>,
    /// Strategies, as NAME or NAME{key: value, ...}; the first is the baseline for the others. If not given, all registered strategies;
    /// the scene's strategy keeps the keys it has there.
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

/// Other measurements of `spectra bench`, each a subcommand.
#[derive(Debug, Subcommand)]
pub(crate) enum OtherBench {
    /// Measure how long scenes take to become clean: time to 1 % noise.
    Noise(BenchNoise),
    /// Measure the noise of ghosts over time, and how much the search for their rays gains.
    Ghosts(BenchGhosts),
}

/// Scenes that are rendered several times, each time with another seed.
#[derive(Debug, Args)]
pub(crate) struct SeededScenes {
    /// Scene files, or names of bundled scenes.
    #[arg(value_name = "SCENE", required = true)]
    pub scenes: Vec<PathBuf>,
    #[command(flatten)]
    pub set: Set,
    /// Number of seeds, at least 2.
    #[arg(long, value_name = "N", default_value = "4", value_parser = clap::value_parser!(u16).range(2..=1000))]
    pub seeds: u16,
}

/// Arguments of `spectra bench ghosts`.
#[derive(Debug, Args)]
#[command(
    long_about = "Measure the noise of ghosts over time, and how much the search for their rays gains.\n\n\
        Only the ghosts of each scene are rendered, several times with different seeds: once as in a normal picture, and once with \
        the same number of rays for each path spread evenly over the front of the lens. Noise is the standard deviation between the \
        seeds, relative to the mean. It is measured in blocks of 32 x 32 pixels where ghosts have more than 1e-4 of the brightest \
        block, and for single pixels. The gain is how many times longer the evenly spread rays take to reach the same noise.\n\n\
        The table (Markdown) goes to standard output.",
    after_long_help = "Example: one sun through an uncoated lens of 1927\n  spectra bench ghosts bench/ghosts-sun --seeds 8"
)]
pub(crate) struct BenchGhosts {
    #[command(flatten)]
    pub renders: SeededScenes,
    /// Number of render threads; all processors if not given.
    #[arg(short, long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024))]
    pub threads: Option<u16>,
    /// Write a JSON list to standard output instead of the table.
    #[arg(long)]
    pub json: bool,
}

/// Arguments of `spectra bench noise`.
#[derive(Debug, Args)]
#[command(
    long_about = "Measure how long scenes take to become clean: time to 1 % noise, and noise after some time.\n\n\
        Each scene is rendered several times with different seeds, in each possible direction, with as many samples as the time \
        allows. Noise is the standard deviation between the seeds, relative to the mean, of luminance (or of the first channel of \
        an imager without luminance) in squares of 8 x 8 pixels. The table has the median of the squares and their 95th \
        percentile. Times to other noise levels are extrapolated: noise falls with the square root of the time.\n\n\
        The table (Markdown) goes to standard output.",
    after_long_help = "Example: the bundled scenes for this measurement, in the direction that the program chooses\n  \
        spectra bench noise bench/noise-flat bench/noise-portrait bench/noise-lights bench/noise-night --directions auto"
)]
pub(crate) struct BenchNoise {
    #[command(flatten)]
    pub renders: SeededScenes,
    /// Longest time to trace for each seed, in seconds.
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

/// Arguments of `spectra list`.
#[derive(Debug, Args)]
#[command(
    long_about = "List the names that can be used: the registered stages and the bundled data.\n\n\
        Lenses are listed with focal length, f-number, half field angle and year; film stocks with speed, process and \
        the year of their data sheet, print stocks separately; spectra with kind and range; glasses with nd and Vd; \
        formats with their size. Wherever a name is expected, any unique part of it is enough: `tri-x`, `helios`.",
    after_long_help = "Examples: all light sources; lenses with 50 in their names; glasses with BK7 in their names\n  \
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
