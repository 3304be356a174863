//! What can be written after `spectra film`.

use crate::quantity::percent;
use crate::set::Set;
use clap::{Args, Subcommand, ValueEnum};
use std::path::PathBuf;

/// `spectra film`.
#[derive(Debug, Args)]
#[command(
    long_about = "Inspect film stocks: spectral sensitivities, characteristic curves and dyes; and develop pictures on them.\n\n\
        NAME is a bundled stock (see `spectra list stock`), a part of its name (`tri-x`), or a YAML file.",
    after_long_help = "Examples:\n  spectra film info kodak-tri-x-400\n  \
        spectra film plot kodak-vision3-250d-5207 -o 5207.svg\n\n\
        A photograph of yours on Tri-X, printed on grade 3:\n\n    \
        spectra film develop photo.jpg --stock tri-x --grade 3 -o photo-tri-x.png"
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
    /// Compare two lights by what they make of colors, to the eye and on a film.
    Lamp(FilmLamp),
    /// Develop a picture, or a sequence of them, on a film stock.
    Develop(FilmDevelop),
    /// Write a stock as a look-up table (.cube) for other programs.
    Cube(FilmCube),
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

/// `spectra film lamp`.
#[derive(Debug, Args)]
#[command(
    long_about = "Compare a lamp with a reference light by what both make of the 24 patches of the ColorChecker, to the eye and on a \
        color film: which colors part. Shown are the lamp's color rendering (CIE Ra and TM-30 Rf) and, of each patch, the \
        difference between both lights as CIEDE2000: to an eye that has adapted to either, to the layers of the film, and in the \
        finished picture. `fidelity` says the same in one figure, on the scale of TM-30 (100: nothing parts): of its 99 samples in \
        the lamp against the reference, to the eye and in the picture.\n\n\
        On the camera, filters take the cast of either light away, so that a gray exposes the layers alike. `layers` are these \
        exposures, brought to the eye's colors in the reference light by the best matrix: what the sensitivities alone do. `film` \
        is the picture after curves, dyes, what layers do to each other, and print or projection; grain and light that spreads take \
        no part. A film of high contrast drives colors further apart than the eye has them.",
    after_long_help = "Example: a fluorescent lamp on a daylight film\n  \
        spectra film lamp kodak-portra-400 FL2 --reference D50 -o fl2.png"
)]
pub(crate) struct FilmLamp {
    /// A bundled color stock, or a YAML file.
    #[arg(value_name = "STOCK")]
    pub stock: String,
    /// The lamp: a bundled spectrum, a file or an expression.
    #[arg(value_name = "LAMP")]
    pub lamp: String,
    /// The light that it is compared with.
    #[arg(long, value_name = "NAME", default_value = "D55")]
    pub reference: String,
    /// How the film is viewed: print, negative, scan, projection; as suits the stock if not given.
    #[arg(long, value_name = "VIEW")]
    pub view: Option<String>,
    /// The print stock or color paper; that of the stock's maker if not given.
    #[arg(long, value_name = "NAME")]
    pub print: Option<String>,
    /// Output figure, FILE.svg or FILE.png.
    #[arg(short, long, value_name = "FILE")]
    pub output: Option<PathBuf>,
    /// Write a JSON object to standard output.
    #[arg(long)]
    pub json: bool,
}

/// `spectra film develop`.
#[derive(Debug, Args)]
#[command(
    long_about = "Develop a picture, or a sequence of them, on a film stock.\n\n\
        The picture fills the frame, whatever its shape. A photograph (a file of integers) is exposed as it was taken, light in \
        floating point is metered as a camera does, and --exposure shifts either. Scatter, halation, adjacency, grain and the print, scan or projection are those of a scene with this stock. Without --lens no ray \
        is traced: each pixel of the picture exposes the same pixel of the film. With --lens the picture stands 3 m in \
        front of that lens, wide open unless --f-number says otherwise, and is rendered to 1 % of noise.\n\n\
        PICTURE is an OpenEXR, PNG, JPEG, TIFF, WebP, BMP or Radiance HDR file. Several pictures, a folder, or a numbered sequence \
        (plate.####.exr, plate.%04d.exr) are developed one by one, with other grain in each, exposed as the first is \
        unless --meter each meters every one; -o is then a folder, or a sequence such as out/####.tiff. A picture that fails does not \
        stop the others. Existing files are replaced.\n\n\
        An .exr file holds the picture in linear light (R, G, B, the primaries of sRGB). --set 'output=[{kind: exr, holds: picture, \
        space: acescg}]' takes another space, --set output=[exr] the light that exposes the film, before any of this.\n\n\
        The values of --stock, --push and so on are those of the keys of a scene's `film` (see `spectra doc film/stock`); \
        --set sets any other key of the scene that this makes, such as source.illuminant or film.optics.",
    after_long_help = "Examples, where photo.jpg and the folder plates/ are yours:\n\n    \
        spectra film develop photo.jpg --stock tri-x --push 1 --grade 3 -o tri-x.png\n    \
        spectra film develop photo.jpg --stock tri-x --lens helios-44-58-f2 -o helios.png\n    \
        spectra film develop plates/ --stock 5207 -o developed/"
)]
pub(crate) struct FilmDevelop {
    /// Picture files, a folder of them, or a numbered sequence: plate.####.exr.
    #[arg(value_name = "PICTURE", required = true)]
    pub pictures: Vec<String>,
    /// The film stock: a bundled one (see `spectra list stock`), a part of its name, or a YAML file.
    #[arg(long, value_name = "NAME")]
    pub stock: String,
    /// Output file (.png, .tiff, .exr); of several pictures a folder or a numbered sequence. PICTURE-STOCK.png in the
    /// working folder if not given, or the folder `out`. In a folder files are of the kind that --set output=[...] names, or .png.
    #[arg(short, long, value_name = "FILE|DIR")]
    pub output: Option<String>,
    /// A lens to render the picture through: a bundled one (see `spectra list lens`), a part of its name, or a file.
    #[arg(long, value_name = "NAME")]
    pub lens: Option<String>,
    /// Aperture of the lens (f/4); wide open if not given.
    #[arg(long, value_name = "F", requires = "lens")]
    pub f_number: Option<String>,
    /// Noise at which a render through the lens ends; 1% if not given.
    #[arg(long, value_name = "PERCENT", requires = "lens", value_parser = percent)]
    pub noise: Option<String>,
    #[command(flatten)]
    pub keys: FilmKeys,
    /// Of several pictures, which are metered.
    #[arg(long, value_name = "WHICH", default_value = "first")]
    pub meter: MeterWhich,
    /// Grain.
    #[arg(long, value_name = "on|off")]
    pub grain: Option<Switch>,
    /// Halation.
    #[arg(long, value_name = "on|off")]
    pub halation: Option<Switch>,
    /// The frame, by the name of its format (see `spectra list format`); 135 if not given.
    #[arg(long, value_name = "FORMAT")]
    pub format: Option<String>,
    /// Pixels along the longer side; the picture's own if not given, through a lens at most 1920.
    #[arg(long, value_name = "PIXELS", value_parser = clap::value_parser!(u32).range(1..=32768))]
    pub side: Option<u32>,
    /// Seed of the grain, and of the render.
    #[arg(long, value_name = "N")]
    pub seed: Option<u64>,
    #[command(flatten)]
    pub set: Set,
    /// Skip pictures whose output exists and is not empty.
    #[arg(long)]
    pub skip_existing: bool,
    /// Number of render threads; all processors if not given. It does not affect the picture.
    #[arg(short, long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024))]
    pub threads: Option<u16>,
    /// Write one JSON object per line to standard output for each event.
    #[arg(long, conflicts_with = "quiet")]
    pub json: bool,
    /// Print errors only.
    #[arg(short, long)]
    pub quiet: bool,
}

/// The word of `--meter`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum MeterWhich {
    First,
    Each,
}

/// On or off.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum Switch {
    On,
    Off,
}

/// The keys of a scene's film.
#[derive(Debug, Args)]
pub(crate) struct FilmKeys {
    /// Stops by which the picture is exposed more than the meter says, or more than it was taken (+1, -0.5).
    #[arg(long, value_name = "STOPS", allow_hyphen_values = true)]
    pub exposure: Option<String>,
    /// The speed that the meter is set to; the stock's if not given.
    #[arg(long, value_name = "ISO")]
    pub iso: Option<String>,
    /// How the film is developed: a name from the stock's file.
    #[arg(long, value_name = "NAME")]
    pub development: Option<String>,
    /// Stops of push, or of pull if negative.
    #[arg(long, value_name = "STOPS", allow_hyphen_values = true)]
    pub push: Option<String>,
    /// How the film is viewed: print, negative, scan, projection; as suits the stock if not given.
    #[arg(long, value_name = "VIEW")]
    pub view: Option<String>,
    /// The print stock or color paper; that of the stock's maker if not given.
    #[arg(long, value_name = "NAME")]
    pub print: Option<String>,
    /// Grade of the black-and-white paper, 0 to 5 or auto; 2 if not given.
    #[arg(long, value_name = "GRADE")]
    pub grade: Option<String>,
    /// What a scan gives: picture, log or density.
    #[arg(long, value_name = "SCALE")]
    pub scan: Option<String>,
    /// The light in which the picture was taken, by name; the one that the stock is made for if not given.
    #[arg(long, value_name = "NAME")]
    pub illuminant: Option<String>,
}

/// `spectra film cube`.
#[derive(Debug, Args)]
#[command(
    long_about = "Write a film stock as a 3-D look-up table (.cube) for grading and editing programs.\n\n\
        The table takes linear light of the scene, in sRGB primaries and a logarithm to base 2 that its header states, to \
        the picture, sRGB encoded; a mid gray of 0.18 is exposed as a meter would. What needs a pixel's neighbors is left \
        out: scatter, halation, adjacency, grain, and the lens of printer or scanner. What the table differs from the film \
        otherwise is computed, printed, and written into its header: CIEDE2000 of 10000 random colors, read as pictures are, \
        and of a ColorChecker by its measured reflectances.",
    after_long_help = "Example:\n  spectra film cube kodak-vision3-250d-5207 --print kodak-vision-2383 -o 5207.cube"
)]
pub(crate) struct FilmCube {
    /// A bundled stock, or a YAML file.
    #[arg(value_name = "NAME")]
    pub stock: String,
    /// Output file; NAME.cube if not given.
    #[arg(short, long, value_name = "FILE")]
    pub output: Option<PathBuf>,
    /// Points along each side, 2 to 129.
    #[arg(long, value_name = "N", default_value_t = 65, value_parser = clap::value_parser!(u32).range(2..=129))]
    pub size: u32,
    /// Stops from end to end, half of them above mid gray, 2 to 40.
    #[arg(long, value_name = "STOPS", default_value_t = 14.0, value_parser = stops)]
    pub stops: f64,
    #[command(flatten)]
    pub keys: FilmKeys,
    /// Write a JSON object to standard output.
    #[arg(long)]
    pub json: bool,
}

/// The number of `--stops`.
fn stops(text: &str) -> Result<f64, String> {
    let wanted = || "expected a number from 2 to 40, such as 14".to_owned();
    text.trim().parse().ok().filter(|stops| (2.0..=40.0).contains(stops)).ok_or_else(wanted)
}
