//! Command-line arguments of `spectra glass`.

use crate::quantity::wavelength;
use crate::report::JsonReport;
use clap::{Args, Subcommand, ValueEnum};
use spectra_core::params::{Fault, Wavelength};
use spectra_glass::{Category, Era, LineTriple};
use std::path::PathBuf;

/// Arguments of `spectra glass`.
#[derive(Debug, Args)]
#[command(
    long_about = "Inspect glass: refractive index, Abbe diagram, nearest glass to the values in a patent, fits.\n\n\
        NAME is MAKER/NAME (SCHOTT/N-BK7), or the name alone if only one maker has it; a substance or a common name \
        (water, fused silica, PMMA, air); or a file of your own: FILE.yaml (a formula, a table, nd and vd), FILE.csv \
        (wavelength_nm,n,k), FILE.agf#NAME. Indices are relative to air at 20 C and 101 325 Pa; wavelengths are in \
        air.",
    after_long_help = "Examples:\n  spectra glass info N-BK7\n  \
        spectra glass match --nd 1.64329 --vd 48 --era 1927\n  \
        spectra glass plot SCHOTT/N-BK7 SCHOTT/F2 water -o index.svg\n  \
        spectra glass plot SCHOTT/SK16 --abbe --makers SCHOTT,OHARA -o abbe.png"
)]
pub(crate) struct GlassArguments {
    /// The command to run.
    #[command(subcommand)]
    pub command: GlassCommand,
}

/// The commands of `spectra glass`.
#[derive(Debug, Subcommand)]
pub(crate) enum GlassCommand {
    /// Show the data of a glass: indices, Abbe numbers, transmittance.
    Info(GlassInfo),
    /// List glasses and other media by part of a name, maker or category.
    List(GlassList),
    /// Plot n(lambda) of several media, or an Abbe diagram.
    Plot(GlassPlot),
    /// Find the real glasses nearest to an index and an Abbe number.
    Match(GlassMatch),
    /// Fit a dispersion formula to a table of wavelengths and indices.
    Fit(GlassFit),
    /// Compare the catalogue's computed nd and Vd with the values that makers list.
    Check(GlassCheck),
}

/// Argument `--catalogue`, shared by several commands.
#[derive(Debug, Args)]
pub(crate) struct OwnCatalogues {
    /// Your own glass catalogue file (AGF); the file name is used as the maker of its glasses. Can be repeated.
    #[arg(long = "catalogue", visible_aliases = ["catalog", "agf"], value_name = "FILE.agf")]
    pub files: Vec<PathBuf>,
}

/// Arguments of `spectra glass info`.
#[derive(Debug, Args)]
#[command(
    long_about = "Show the data of a glass: index at spectral lines, Abbe numbers, internal transmittance of 10 mm, \
        reflection.\n\n\
        With a name, --nd and --vd give the measured values of a melt of that glass. Without a name, they describe an \
        unknown glass, which gets the partial dispersions of an ordinary glass with the same Abbe number. Nine out of \
        ten glasses are within 0.0002 of it in index at r, 0.0004 at g and 0.0009 at h.",
    after_long_help = "Examples:\n  spectra glass info SCHOTT/SF6 --temperature-c 40 --absolute\n  \
        spectra glass info N-BK7 --nd 1.51712 --vd 64.01 --wavelength-nm 632.8 --json"
)]
pub(crate) struct GlassInfo {
    /// Name of the glass or medium.
    #[arg(value_name = "NAME", required_unless_present = "nd")]
    pub name: Option<String>,
    /// Index at the d line, or at the line given by --line; for a melt always at d.
    #[arg(long, visible_alias = "n", value_name = "N", requires = "vd")]
    pub nd: Option<f64>,
    /// Abbe number that goes with --nd.
    #[arg(long, visible_alias = "v", value_name = "V", requires = "nd")]
    pub vd: Option<f64>,
    /// Reference line of --nd and --vd if no name is given: d and D go with F and C, e with F' and C'. Or three lines from blue to red
    /// (F,e,C or 450,580,680), with the index at the middle one.
    #[arg(long, value_name = "LINE|BLUE,MIDDLE,RED", default_value = "d", value_parser = reference, conflicts_with = "name")]
    pub line: LineTriple,
    /// Show the index at this wavelength in air, too.
    #[arg(long, value_name = "NM", value_parser = wavelength)]
    pub wavelength_nm: Option<Wavelength>,
    /// Show the Abbe number for these three lines, too, with the index at the middle one: names or wavelengths in nm (F',e,C' or
    /// 450,580,680).
    #[arg(long, value_name = "BLUE,MIDDLE,RED", value_parser = three_lines)]
    pub lines: Option<LineTriple>,
    /// Temperature of glass and air in degrees Celsius; that of the catalogue if not given.
    #[arg(long, value_name = "C", allow_hyphen_values = true, value_parser = temperature)]
    pub temperature_c: Option<f64>,
    /// Show indices relative to vacuum.
    #[arg(long)]
    pub absolute: bool,
    #[command(flatten)]
    pub own: OwnCatalogues,
    /// Write a JSON object to standard output; unknown values are null.
    #[arg(long)]
    pub json: bool,
}

/// Arguments of `spectra glass list`.
#[derive(Debug, Args)]
#[command(
    long_about = "List glasses and other media by name, with nd, Vd, kind, and the years of the catalogues that list \
        them.\n\n\
        FRAGMENT is part of a name, a maker or a common name; case, hyphens and spaces are ignored.",
    after_long_help = "Examples:\n  spectra glass list bk7\n  spectra glass list --category plastic\n  \
        spectra glass list schott/sf"
)]
pub(crate) struct GlassList {
    /// Part of a name, or MAKER/PART.
    #[arg(value_name = "FRAGMENT")]
    pub fragment: Option<String>,
    /// List only media of this category: optical, technical, infrared or filter (glass), crystal, plastic, organic,
    /// inorganic, mixed.
    #[arg(long, value_name = "CATEGORY", value_parser = category)]
    pub category: Option<Category>,
    /// List only media of this maker; can be repeated.
    #[arg(long = "maker", value_name = "MAKER", value_delimiter = ',')]
    pub makers: Vec<String>,
    #[command(flatten)]
    pub own: OwnCatalogues,
    /// Write a JSON list to standard output.
    #[arg(long)]
    pub json: bool,
}

/// Arguments of `spectra glass plot`.
#[derive(Debug, Args)]
#[command(
    long_about = "Plot n(lambda) of several media; with --abbe, plot nd against Vd for all optical glasses and mark \
        the named ones.\n\n\
        A curve is dashed outside the glass's measured range.",
    after_long_help = "Example:\n  spectra glass plot --abbe --makers SCHOTT,LZOS --era 1983 -o abbe.svg"
)]
pub(crate) struct GlassPlot {
    /// Names of glasses or media.
    #[arg(value_name = "NAME", required_unless_present = "abbe")]
    pub names: Vec<String>,
    /// Output file, FILE.svg or FILE.png; dispersion.svg or abbe.svg if not given.
    #[arg(short, long, value_name = "FILE")]
    pub output: Option<PathBuf>,
    /// Plot the Abbe diagram.
    #[arg(long)]
    pub abbe: bool,
    /// Spectral lines of the Abbe diagram: d, D or e, or three lines from blue to red (F',e,C' or 450,580,680).
    #[arg(long, value_name = "LINE|BLUE,MIDDLE,RED", default_value = "d", value_parser = reference, requires = "abbe")]
    pub lines: LineTriple,
    /// Show only these makers in the Abbe diagram, each in its own color.
    #[arg(long, value_name = "A,B,...", value_delimiter = ',', requires = "abbe")]
    pub makers: Vec<String>,
    /// Show only glasses of this era in the Abbe diagram: historical, modern, or a year.
    #[arg(long, value_name = "ERA", requires = "abbe")]
    pub era: Option<Era>,
    /// Wavelength range of the plot, nm.
    #[arg(long, value_name = "FROM,TO", default_value = "350,830", value_parser = range, conflicts_with = "abbe")]
    pub range_nm: (f64, f64),
    #[command(flatten)]
    pub own: OwnCatalogues,
}

/// Arguments of `spectra glass match`.
#[derive(Debug, Args)]
#[command(
    long_about = "Find the real glasses nearest to an index and an Abbe number, nearest first.\n\n\
        The distance is in units of the usual catalogue tolerance: 1 is 0.0005 in n, or 0.5 % in V. With --lens, the \
        nearest glasses are listed for each medium of a lens.",
    after_long_help = "Examples:\n  spectra glass match --nd 1.64329 --vd 48 --maker SCHOTT --era 1927\n  \
        spectra glass match --nd 1.6242 --vd 53.1 --line e --era modern\n  \
        spectra glass match --nd 1.6200 --vd 36.0 --line 450,580,680\n  \
        spectra glass match --lens zeiss-biotar-50-f1.4 --limit 3"
)]
pub(crate) struct GlassMatch {
    /// Index at the reference line.
    #[arg(long, visible_alias = "n", value_name = "N", required_unless_present = "lens")]
    pub nd: Option<f64>,
    /// Abbe number; if not given, only the index is compared.
    #[arg(long, visible_alias = "v", value_name = "V")]
    pub vd: Option<f64>,
    /// Match every medium of this lens, by its stated index and Abbe number.
    #[arg(long, value_name = "LENS", conflicts_with_all = ["nd", "vd", "line"])]
    pub lens: Option<String>,
    /// Reference line of --nd and --vd: d and D go with F and C, e with F' and C'. Or three lines from blue to red (F,e,C or
    /// 450,580,680), with the index at the middle one.
    #[arg(long, value_name = "LINE|BLUE,MIDDLE,RED", default_value = "d", value_parser = reference)]
    pub line: LineTriple,
    /// List only glasses of this maker; can be repeated.
    #[arg(long = "maker", value_name = "MAKER", value_delimiter = ',')]
    pub makers: Vec<String>,
    /// List only glasses of this era: historical (listed by 1983), modern, or a year; before 1940 without rare earths.
    #[arg(long, value_name = "ERA")]
    pub era: Option<Era>,
    /// Include plastics, crystals, filters and other media.
    #[arg(long)]
    pub all_media: bool,
    /// Number of glasses to list; if not given 10, or with --lens 3 per medium.
    #[arg(long, value_name = "COUNT", value_parser = clap::value_parser!(u16).range(1..=10_000))]
    pub limit: Option<u16>,
    #[command(flatten)]
    pub own: OwnCatalogues,
    #[command(flatten)]
    pub report: JsonReport,
}

/// Dispersion formula that can be fitted.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum Model {
    /// n = A + B / L^2, from pairs of neighboring rows, averaged.
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

/// Arguments of `spectra glass fit`.
#[derive(Debug, Args)]
#[command(
    long_about = "Fit a dispersion formula to a table of wavelengths and indices.\n\n\
        The table has columns wavelength_nm (or wavelength_um) and n, and `material` if it holds several materials. The \
        output has the coefficients and the deviations of the formula from the rows: mean, root mean square and largest. \
        Without --model, Cauchy's formula is fitted both from neighboring rows and by least squares. --rows adds one line per \
        row: Cauchy's A and B from this row and the next one, and the deviation of each formula. -o writes the first formula as a \
        glass file.",
    after_long_help = "Example:\n  spectra glass fit melt.csv --model sellmeier --terms 2\n\n\
        The results row by row, a plot of the curve, and a glass file:\n\n    \
        spectra glass fit melt.csv --rows --plot melt.svg -o melt.yaml"
)]
pub(crate) struct GlassFit {
    /// CSV file of the table; FILE.csv#MATERIAL selects one of several materials; `-` reads standard input.
    #[arg(value_name = "FILE.csv")]
    pub file: PathBuf,
    /// Glass file to write, FILE.yaml, for one material with the first formula.
    #[arg(short, long, value_name = "FILE.yaml")]
    pub output: Option<PathBuf>,
    /// Figure to write, FILE.svg or FILE.png, with the rows, curves and deviations of one material.
    #[arg(long, value_name = "FILE")]
    pub plot: Option<PathBuf>,
    /// Show every row: wavelength, index, Cauchy's A and B, deviation of each formula.
    #[arg(long)]
    pub rows: bool,
    /// The formula to fit; can be repeated.
    #[arg(long = "model", value_enum, value_name = "MODEL", value_delimiter = ',')]
    pub models: Vec<Model>,
    /// Number of terms: 1 to 6 for Cauchy by least squares (2 if not given), 1 to 3 for Sellmeier (3 if not given).
    #[arg(long, value_name = "COUNT", value_parser = clap::value_parser!(u8).range(1..=6))]
    pub terms: Option<u8>,
    /// Write a JSON list to standard output, one object per material.
    #[arg(long)]
    pub json: bool,
}

/// Arguments of `spectra glass check`.
#[derive(Debug, Args)]
#[command(long_about = "Compare the catalogue's computed nd and Vd with the values that makers list.\n\n\
        All media that differ by more than 1e-4 in nd or 0.1 in Vd are listed.")]
pub(crate) struct GlassCheck {
    #[command(flatten)]
    pub own: OwnCatalogues,
    #[command(flatten)]
    pub report: JsonReport,
}

fn temperature(text: &str) -> Result<f64, Fault> {
    let number = text.trim().trim_end_matches(['C', '\u{b0}', ' ']).parse::<f64>();
    number.ok().filter(|t| (-100.0..=200.0).contains(t)).ok_or_else(|| "expected degrees Celsius, -100 to 200".into())
}

fn range(text: &str) -> Result<(f64, f64), Fault> {
    let parts = text.split_once([',', '-']).map(|(a, b)| (a.trim().parse::<f64>(), b.trim().parse::<f64>()));
    match parts {
        Some((Ok(from), Ok(to))) if 100.0 <= from && from + 1.0 <= to && to <= 50_000.0 => Ok((from, to)),
        _ => Err("expected two wavelengths in nm, such as 350,830".into()),
    }
}

/// Parses the lines of `--lines`.
fn three_lines(text: &str) -> Result<LineTriple, Fault> {
    let expected = "expected three lines or wavelengths in nm from blue to red, such as F',e,C' or 450,580,680";
    LineTriple::read(text).filter(|_| text.contains(',')).ok_or_else(|| expected.into())
}

/// Parses the lines of `--line`.
fn reference(text: &str) -> Result<LineTriple, Fault> {
    let expected =
        "expected d, D or e, or three lines or wavelengths in nm from blue to red, such as F',e,C' or 450,580,680";
    LineTriple::read(text).ok_or_else(|| expected.into())
}

fn category(name: &str) -> Result<Category, Fault> {
    let name = name.trim().to_lowercase();
    let found = Category::by_name(&name).or_else(|| Category::by_name(&format!("{name} glass")));
    found.ok_or_else(|| {
        "expected optical, technical, infrared, filter, crystal, plastic, organic, inorganic, mixed or user".into()
    })
}
