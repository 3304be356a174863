//! What can be written after `spectra glass`.

use crate::quantity::parse;
use clap::{Args, Subcommand, ValueEnum};
use spectra_core::params::Wavelength;
use spectra_glass::{Category, Era, LineTriple};
use std::path::PathBuf;

/// `spectra glass`.
#[derive(Debug, Args)]
#[command(
    long_about = "Look at glass: refractive index, Abbe diagram, nearest glass to a patent's figures, fits.\n\n\
        NAME is MAKER/NAME (SCHOTT/N-BK7), or the name alone where one maker has it; a substance or an everyday name (water, \
        fused silica, PMMA, air); or a file of your own: FILE.yaml (a formula, a table, nd and vd), FILE.csv (wavelength_nm,n,k), \
        FILE.agf#NAME. Indices are relative to air at 20 C and 101 325 Pa, wavelengths are those in air.",
    after_long_help = "Examples:\n  spectra glass info N-BK7\n  \
        spectra glass match --nd 1.64329 --vd 48 --era 1927\n  \
        spectra glass plot SCHOTT/N-BK7 SCHOTT/F2 water -o index.svg\n  \
        spectra glass plot SCHOTT/SK16 --abbe --makers SCHOTT,OHARA -o abbe.png"
)]
pub(crate) struct GlassArguments {
    /// What to do.
    #[command(subcommand)]
    pub command: GlassCommand,
}

/// The commands on glass.
#[derive(Debug, Subcommand)]
pub(crate) enum GlassCommand {
    /// Show a glass in figures: indices, Abbe numbers, transmittance.
    Info(GlassInfo),
    /// List glasses and other media by a fragment of their names, by maker and by category.
    List(GlassList),
    /// Draw n(lambda) of several media, or an Abbe diagram.
    Plot(GlassPlot),
    /// Find the real glass behind an index and an Abbe number.
    Match(GlassMatch),
    /// Fit a dispersion formula to a table of wavelengths and indices.
    Fit(GlassFit),
    /// Hold the catalogue's computed nd and Vd against those that makers list.
    Check(GlassCheck),
}

/// `--catalogue`.
#[derive(Debug, Args)]
pub(crate) struct OwnCatalogues {
    /// A glass catalogue file (AGF) of one's own; its name is the maker of its glasses. May be given again.
    #[arg(long = "catalogue", visible_alias = "catalog", value_name = "FILE.agf")]
    pub files: Vec<PathBuf>,
}

/// `spectra glass info`.
#[derive(Debug, Args)]
#[command(
    long_about = "Show a glass in figures: index at spectral lines, Abbe numbers, internal transmittance of 10 mm, reflection.\n\n\
        With --nd and --vd after a name: the melt of that glass with these figures. Without a name: a glass of which \
        nothing else is known, with the partial dispersions of ordinary glasses of its Abbe number; of ten glasses nine lie within \
        0.0002 of it at r, 0.0004 at g, 0.0009 at h.",
    after_long_help = "Examples:\n  spectra glass info SCHOTT/SF6 --temperature-c 40 --absolute\n  \
        spectra glass info N-BK7 --nd 1.51712 --vd 64.01 --wavelength-nm 632.8 --json"
)]
pub(crate) struct GlassInfo {
    /// Name of the glass or medium.
    #[arg(value_name = "NAME", required_unless_present = "nd")]
    pub name: Option<String>,
    /// Index at the d line, or at that of --line; of a melt at d.
    #[arg(long, visible_alias = "n", value_name = "N", requires = "vd")]
    pub nd: Option<f64>,
    /// Abbe number that belongs to it.
    #[arg(long, visible_alias = "v", value_name = "V", requires = "nd")]
    pub vd: Option<f64>,
    /// Reference line of --nd and --vd without a name: d and D go with F and C, e with F' and C'.
    #[arg(long, value_name = "d|D|e", default_value = "d", value_parser = reference, conflicts_with = "name")]
    pub line: LineTriple,
    /// Show the index at this wavelength in air, too.
    #[arg(long, value_name = "NM", value_parser = parse::<Wavelength>)]
    pub wavelength_nm: Option<Wavelength>,
    /// Temperature of glass and air, degrees Celsius; that of the catalogue if not given.
    #[arg(long, value_name = "C", allow_hyphen_values = true, value_parser = temperature)]
    pub temperature_c: Option<f64>,
    /// Indices relative to vacuum.
    #[arg(long)]
    pub absolute: bool,
    #[command(flatten)]
    pub own: OwnCatalogues,
    /// A JSON object on standard output; what is not known is null.
    #[arg(long)]
    pub json: bool,
}

/// `spectra glass list`.
#[derive(Debug, Args)]
#[command(
    long_about = "List glasses and other media, by name: nd, Vd, what they are, years of the catalogues they stand in.\n\n\
        FRAGMENT is a part of a name, a maker or an everyday name; upper and lower case, hyphens and blanks do not count.",
    after_long_help = "Examples:\n  spectra glass list bk7\n  spectra glass list --category plastic\n  \
        spectra glass list schott/sf"
)]
pub(crate) struct GlassList {
    /// Part of a name, or MAKER/PART.
    #[arg(value_name = "FRAGMENT")]
    pub fragment: Option<String>,
    /// Only media of this category: optical, technical, infrared or filter (glass), crystal, plastic, organic, inorganic,
    /// mixed.
    #[arg(long, value_name = "CATEGORY", value_parser = category)]
    pub category: Option<Category>,
    /// Only media of this maker; may be given again.
    #[arg(long = "maker", value_name = "MAKER", value_delimiter = ',')]
    pub makers: Vec<String>,
    #[command(flatten)]
    pub own: OwnCatalogues,
    /// A JSON list on standard output.
    #[arg(long)]
    pub json: bool,
}

/// `spectra glass plot`.
#[derive(Debug, Args)]
#[command(
    long_about = "Draw n(lambda) of several media; with --abbe, nd against Vd of all optical glasses, the named ones marked.\n\n\
        Outside of a glass's measured range its curve is dashed.",
    after_long_help = "Example:\n  spectra glass plot --abbe --makers SCHOTT,LZOS --era 1983 -o abbe.svg"
)]
pub(crate) struct GlassPlot {
    /// Names of glasses or media.
    #[arg(value_name = "NAME", required_unless_present = "abbe")]
    pub names: Vec<String>,
    /// File to write: FILE.svg or FILE.png; dispersion.svg or abbe.svg if not given.
    #[arg(short, long, value_name = "FILE")]
    pub output: Option<PathBuf>,
    /// The Abbe diagram.
    #[arg(long)]
    pub abbe: bool,
    /// Only these makers in the Abbe diagram, each in its color.
    #[arg(long, value_name = "A,B,...", value_delimiter = ',', requires = "abbe")]
    pub makers: Vec<String>,
    /// Only glasses of this time in the Abbe diagram: historical, modern, or a year.
    #[arg(long, value_name = "ERA", requires = "abbe")]
    pub era: Option<Era>,
    /// Wavelengths of the drawing, nm.
    #[arg(long, value_name = "FROM,TO", default_value = "350,830", value_parser = range, conflicts_with = "abbe")]
    pub range_nm: (f64, f64),
    #[command(flatten)]
    pub own: OwnCatalogues,
}

/// `spectra glass match`.
#[derive(Debug, Args)]
#[command(
    long_about = "Find the real glass behind an index and an Abbe number, the nearest first.\n\n\
        The distance is in units of a catalogue's usual tolerance: 1 is 0.0005 in n, or 0.5 % in V. With --lens, the \
        nearest glasses to each medium of a lens.",
    after_long_help = "Examples:\n  spectra glass match --nd 1.64329 --vd 48 --maker SCHOTT --era 1927\n  \
        spectra glass match --nd 1.6242 --vd 53.1 --line e --era modern\n  \
        spectra glass match --lens zeiss-biotar-50-f1.4 --limit 3"
)]
pub(crate) struct GlassMatch {
    /// Index at the reference line.
    #[arg(long, visible_alias = "n", value_name = "N", required_unless_present = "lens")]
    pub nd: Option<f64>,
    /// Abbe number; without it the index alone decides.
    #[arg(long, visible_alias = "v", value_name = "V")]
    pub vd: Option<f64>,
    /// Every medium of a lens, by its stated index and Abbe number.
    #[arg(long, value_name = "LENS", conflicts_with_all = ["nd", "vd", "line"])]
    pub lens: Option<String>,
    /// Reference line of both: d and D go with F and C, e with F' and C'.
    #[arg(long, value_name = "d|D|e", default_value = "d", value_parser = reference)]
    pub line: LineTriple,
    /// Only glasses of this maker; may be given again.
    #[arg(long = "maker", value_name = "MAKER", value_delimiter = ',')]
    pub makers: Vec<String>,
    /// Only glasses of this time: historical (listed by 1983), modern, or a year; before 1940 without rare earths.
    #[arg(long, value_name = "ERA")]
    pub era: Option<Era>,
    /// Plastics, crystals, filters and other media too.
    #[arg(long)]
    pub all_media: bool,
    /// How many to list: 10 if not given, 3 a medium of a lens.
    #[arg(long, value_name = "COUNT", value_parser = clap::value_parser!(u16).range(1..=10_000))]
    pub limit: Option<u16>,
    #[command(flatten)]
    pub own: OwnCatalogues,
    /// A JSON object on standard output.
    #[arg(long)]
    pub json: bool,
}

/// Formulas that can be fitted.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum Model {
    /// n = A + B / L^2, by neighboring rows and their means.
    Cauchy,
    /// n = A + B / L^2 + C / L^4 ..., by least squares.
    CauchyLs,
    /// n^2 = 1 + sum of K L^2 / (L^2 - M), by least squares.
    Sellmeier,
    /// n = A + B / L + C / L^3.5, by least squares.
    Conrady,
    /// n^2 = A0 + A1 L^2 + A2 L^-2 + ... + A5 L^-8, by least squares.
    Schott,
    /// n = A + B l + C l^2 + D L^2 + E L^4 + F L^6, l = 1 / (L^2 - 0.028), by least squares.
    Herzberger,
}

/// `spectra glass fit`.
#[derive(Debug, Args)]
#[command(
    long_about = "Fit a dispersion formula to a table of wavelengths and indices.\n\n\
        The table has columns wavelength_nm (or wavelength_um) and n, and `material` where it holds several. Shown are \
        the coefficients and how far the formula is from the rows: mean, root mean square and largest deviation. Without \
        --model, Cauchy's formula by neighboring rows and by least squares.",
    after_long_help = "Example:\n  spectra glass fit melt.csv --model sellmeier --terms 2"
)]
pub(crate) struct GlassFit {
    /// The table; `-` reads standard input.
    #[arg(value_name = "FILE.csv")]
    pub file: PathBuf,
    /// The formula; may be given again.
    #[arg(long = "model", value_enum, value_name = "MODEL", value_delimiter = ',')]
    pub models: Vec<Model>,
    /// Terms of Cauchy's (1 to 6, by least squares) and of Sellmeier's formula (1 to 3): 2 and 3 if not given.
    #[arg(long, value_name = "COUNT", value_parser = clap::value_parser!(u8).range(1..=6))]
    pub terms: Option<u8>,
    /// A JSON list on standard output, one object a material.
    #[arg(long)]
    pub json: bool,
}

/// `spectra glass check`.
#[derive(Debug, Args)]
#[command(long_about = "Hold the catalogue's computed nd and Vd against those that makers list.\n\n\
        Listed are all media where they differ by more than 1e-4 in nd or 0.1 in Vd.")]
pub(crate) struct GlassCheck {
    #[command(flatten)]
    pub own: OwnCatalogues,
    /// A JSON object on standard output.
    #[arg(long)]
    pub json: bool,
}

fn temperature(text: &str) -> Result<f64, String> {
    let number = text.trim().trim_end_matches(['C', '\u{b0}', ' ']).parse::<f64>();
    number.ok().filter(|t| (-100.0..=200.0).contains(t)).ok_or_else(|| "expected degrees Celsius, -100 to 200".into())
}

fn range(text: &str) -> Result<(f64, f64), String> {
    let parts = text.split_once([',', '-']).map(|(a, b)| (a.trim().parse::<f64>(), b.trim().parse::<f64>()));
    match parts {
        Some((Ok(from), Ok(to))) if 100.0 <= from && from + 1.0 <= to && to <= 50_000.0 => Ok((from, to)),
        _ => Err("expected two wavelengths in nm, such as 350,830".into()),
    }
}

fn reference(name: &str) -> Result<LineTriple, String> {
    let line = spectra_glass::lines::by_name(name);
    line.and_then(LineTriple::of_reference).ok_or_else(|| "expected d, D or e".into())
}

fn category(name: &str) -> Result<Category, String> {
    let name = name.trim().to_lowercase();
    let found = Category::by_name(&name).or_else(|| Category::by_name(&format!("{name} glass")));
    found.ok_or_else(|| {
        "expected optical, technical, infrared, filter, crystal, plastic, organic, inorganic, mixed or user".into()
    })
}
