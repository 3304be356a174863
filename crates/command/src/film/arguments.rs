//! Command-line arguments of `spectra film`.

use crate::quantity::percent;
use crate::report::JsonReport;
use crate::set::Set;
use clap::{Args, Subcommand, ValueEnum};
use spectra_core::params::Fault;
use std::path::PathBuf;

/// Arguments of `spectra film`.
#[derive(Debug, Args)]
#[command(
    long_about = "Inspect film stocks: spectral sensitivities, characteristic curves and dyes. Develop pictures on them.\n\n\
        NAME is a bundled stock (see `spectra list stock`), a part of its name (`tri-x`), or a YAML file.",
    after_long_help = "Examples:\n  spectra film info kodak-tri-x-400\n  \
        spectra film plot kodak-vision3-250d-5207 -o 5207.svg\n\n\
        Your photograph on Tri-X, printed on grade 3 paper:\n\n    \
        spectra film develop photo.jpg --stock tri-x --grade 3 -o photo-tri-x.png"
)]
pub(crate) struct FilmArguments {
    /// The command to run.
    #[command(subcommand)]
    pub command: FilmCommand,
}

/// The commands of `spectra film`.
#[derive(Debug, Subcommand)]
pub(crate) enum FilmCommand {
    /// Show the data of a stock: speed, sensitivities, curves, structure, sources.
    Info(FilmInfo),
    /// Plot a stock's sensitivities, curves and dyes.
    Plot(FilmPlot),
    /// Compare how colors look in two lights, to the eye and on a film.
    Lamp(FilmLamp),
    /// Develop a picture or a sequence of pictures on a film stock.
    Develop(FilmDevelop),
    /// Write a stock as a look-up table (.cube) for other programs.
    Cube(FilmCube),
}

/// Arguments of `spectra film info`.
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

/// Arguments of `spectra film plot`.
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

/// Arguments of `spectra film lamp`.
#[derive(Debug, Args)]
#[command(
    long_about = "Compare a lamp with a reference light: how the 24 patches of the ColorChecker differ between them, to the eye and on \
        a color film. The output has the lamp's color rendering (CIE Ra and TM-30 Rf) and, for each patch, the CIEDE2000 difference \
        between the two lights: for an eye adapted to each light, for the layers of the film, and in the finished picture. \
        `fidelity` sums this up in one figure each for the eye and the picture, on the scale of TM-30 (100: no difference), from \
        the 99 samples of TM-30 in the lamp against the reference.\n\n\
        Filters on the camera remove the cast of each light, so that a gray exposes all layers equally. `layers` are these \
        exposures, converted to the eye's colors in the reference light by the best matrix: they show the effect of the \
        sensitivities alone. `film` is the picture after curves, dyes, effects between layers, and print or projection, without \
        grain or scattered light. A film of high contrast makes color differences larger than the eye sees them.",
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
    /// The light that the lamp is compared with.
    #[arg(long, value_name = "NAME", default_value = "D55")]
    pub reference: String,
    #[command(flatten)]
    pub viewing: Viewing,
    /// Output figure, FILE.svg or FILE.png.
    #[arg(short, long, value_name = "FILE")]
    pub output: Option<PathBuf>,
    #[command(flatten)]
    pub report: JsonReport,
}

/// Options for the way from the developed film to a picture.
#[derive(Debug, Args)]
pub(crate) struct Viewing {
    /// How the film is viewed: print, negative, scan, projection; the default of the stock if not given.
    #[arg(long, value_name = "VIEW")]
    pub view: Option<String>,
    /// The print stock or color paper; the one by the stock's maker if not given.
    #[arg(long, value_name = "NAME")]
    pub print: Option<String>,
}

/// Arguments of `spectra film develop`.
#[derive(Debug, Args)]
#[command(
    long_about = "Develop a picture or a sequence of pictures on a film stock.\n\n\
        The picture fills the frame, whatever its shape. A photograph (a file of integers) is exposed as it was taken. A file in \
        floating point holds light and is metered as by a camera. --exposure shifts either. Scatter, halation, adjacency, grain \
        and the print, scan or projection are the same as in a scene with this stock. Without --lens no ray is traced: each pixel \
        of the picture exposes the same pixel of the film. With --lens the picture stands 3 m in front of that lens, which is wide \
        open unless --f-number says otherwise, and is rendered until the grain of the film hides its noise.\n\n\
        PICTURE is an OpenEXR, PNG, JPEG, TIFF, WebP, BMP or Radiance HDR file. Several pictures, a folder, or a numbered sequence \
        (plate.####.exr, plate.%04d.exr) are developed one by one, each with grain of its own. All are exposed like the first one, \
        unless --meter each meters each of them. -o is then a folder, or a sequence such as out/####.tiff. A picture that fails does \
        not stop the others. Existing files are replaced.\n\n\
        An .exr file holds the picture in linear light (R, G, B with the primaries of sRGB). --set 'output=[{kind: exr, \
        holds: picture, space: acescg}]' selects another color space. --set output=[exr] writes the light that exposes the film, \
        before all of these effects.\n\n\
        --stock, --push and so on take the same values as the keys of `film` in a scene (see `spectra doc film/stock`). \
        --set sets any other key of the scene that is rendered, such as source.illuminant or film.optics.",
    after_long_help = "Examples, with your own photo.jpg and folder plates/:\n\n    \
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
    /// Output file (.png, .tiff, .exr); for several pictures a folder or a numbered sequence. If not given, PICTURE-STOCK.png in
    /// the working folder, or the folder `out` for several pictures. Files in a folder have the format that --set output=[...]
    /// names, or .png.
    #[arg(short, long, value_name = "FILE|DIR")]
    pub output: Option<String>,
    /// A lens to render the picture through: a bundled one (see `spectra list lens`), a part of its name, or a file.
    #[arg(long, value_name = "NAME")]
    pub lens: Option<String>,
    /// Aperture of the lens (f/4); wide open if not given.
    #[arg(long, value_name = "F", requires = "lens")]
    pub f_number: Option<String>,
    /// Noise at which a render through the lens stops (1%), or `auto`, the default: a third of the grain, 1 % without grain.
    #[arg(long, value_name = "NOISE", requires = "lens", value_parser = percent)]
    pub noise: Option<String>,
    #[command(flatten)]
    pub keys: FilmKeys,
    /// Pictures to meter, of several: the first one for all, or each by itself.
    #[arg(long, value_name = "WHICH", default_value = "first")]
    pub meter: MeterWhich,
    /// Turn grain on or off.
    #[arg(long, value_name = "on|off")]
    pub grain: Option<Switch>,
    /// Turn halation on or off.
    #[arg(long, value_name = "on|off")]
    pub halation: Option<Switch>,
    /// Name of the film format that gives the size of the frame (see `spectra list format`); 135 if not given.
    #[arg(long, value_name = "FORMAT")]
    pub format: Option<String>,
    /// Number of pixels along the longer side; that of the picture if not given, but at most 1920 through a lens.
    #[arg(long, value_name = "PIXELS", value_parser = clap::value_parser!(u32).range(1..=32768))]
    pub side: Option<u32>,
    /// Random seed of the grain and of the render.
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

/// Pictures that are metered, chosen with `--meter`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum MeterWhich {
    First,
    Each,
}

/// Switch of an effect: on or off.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum Switch {
    On,
    Off,
}

/// Options that set the keys of `film` in a scene.
#[derive(Debug, Args)]
pub(crate) struct FilmKeys {
    /// Exposure correction in stops, relative to the meter or to how the picture was taken (+1, -0.5).
    #[arg(long, value_name = "STOPS", allow_hyphen_values = true)]
    pub exposure: Option<String>,
    /// Film speed that the meter is set to; the stock's speed if not given.
    #[arg(long, value_name = "ISO")]
    pub iso: Option<String>,
    /// Name of the development, one of those in the stock's file.
    #[arg(long, value_name = "NAME")]
    pub development: Option<String>,
    /// Push processing in stops; pull if negative.
    #[arg(long, value_name = "STOPS", allow_hyphen_values = true)]
    pub push: Option<String>,
    #[command(flatten)]
    pub viewing: Viewing,
    /// Contrast grade of the black-and-white paper, 0 to 5 or auto; 2 if not given.
    #[arg(long, value_name = "GRADE")]
    pub grade: Option<String>,
    /// Scale of the values of a scan: picture, log or density.
    #[arg(long, value_name = "SCALE")]
    pub scan: Option<String>,
    /// Name of the light in which the picture was taken; the light that the stock is made for if not given.
    #[arg(long, value_name = "NAME")]
    pub illuminant: Option<String>,
}

/// Arguments of `spectra film cube`.
#[derive(Debug, Args)]
#[command(
    long_about = "Write a film stock as a 3-D look-up table (.cube) for grading and editing programs.\n\n\
        The table maps linear light of the scene (sRGB primaries, on a scale of log2 that the header states) to the picture in \
        sRGB encoding. A mid gray of 0.18 is exposed as a meter would. Effects that need a pixel's neighbors are left out: \
        scatter, halation, adjacency, grain, and the lens of the printer or scanner. The remaining error against the film is \
        computed, printed, and written into the header. It is the CIEDE2000 difference for 10000 random colors, interpreted as in a \
        picture, and for a ColorChecker by its measured reflectances.",
    after_long_help = "Example:\n  spectra film cube kodak-vision3-250d-5207 --print kodak-vision-2383 -o 5207.cube"
)]
pub(crate) struct FilmCube {
    /// A bundled stock, or a YAML file.
    #[arg(value_name = "NAME")]
    pub stock: String,
    /// Output file; NAME.cube if not given.
    #[arg(short, long, value_name = "FILE")]
    pub output: Option<PathBuf>,
    /// Number of points along each side of the table, 2 to 129.
    #[arg(long, value_name = "N", default_value_t = 65, value_parser = clap::value_parser!(u32).range(2..=129))]
    pub size: u32,
    /// Range of the table in stops, half of them above mid gray, 2 to 40.
    #[arg(long, value_name = "STOPS", default_value_t = 14.0, value_parser = stops)]
    pub stops: f64,
    #[command(flatten)]
    pub keys: FilmKeys,
    #[command(flatten)]
    pub report: JsonReport,
}

/// Parses the number of `--stops`.
fn stops(text: &str) -> Result<f64, Fault> {
    let wanted = || "expected a number from 2 to 40, such as 14".into();
    text.trim().parse().ok().filter(|stops| (2.0..=40.0).contains(stops)).ok_or_else(wanted)
}
