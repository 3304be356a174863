//! `spectra glass match`: finds the glasses nearest to an index and an Abbe number.

use super::arguments::GlassMatch;
use super::{catalogue, makers};
use crate::console;
use crate::outcome::{DONE, Failure, Outcome};
use serde::Serialize;
use spectra_glass::{Catalog, Category, LineTriple, Match, Query};
use spectra_lens::Lens;
use spectra_scene::FileResources;
use std::fmt::Write;
use std::path::Path;

/// The glasses nearest to one index and Abbe number.
#[derive(Debug, Serialize)]
struct Report {
    /// Name of the medium in the lens; null if `--nd` was given.
    medium: Option<String>,
    /// Surfaces of the lens in front of the medium, from 1.
    surfaces: Vec<usize>,
    /// Name or wavelength of the middle line.
    line: String,
    /// Wavelengths of all three lines, from blue to red.
    lines_nm: [f64; 3],
    #[serde(skip)]
    called: [String; 2],
    n: f64,
    v: Option<f64>,
    matches: Vec<GlassMatchRow>,
}

/// A glass of the catalogue and its distance from the wanted values.
#[derive(Debug, Serialize)]
struct GlassMatchRow {
    name: String,
    maker: String,
    n: f64,
    v: f64,
    delta_n: f64,
    /// Difference of the Abbe number; null if none was given.
    delta_v: Option<f64>,
    /// Distance in units of the usual catalogue tolerance.
    distance: f64,
    status: &'static str,
    years: Option<(u16, u16)>,
}

/// Values to match: those of a medium of a lens with its label and surfaces, or those given on the command line.
struct MatchTarget {
    label: Option<String>,
    surfaces: Vec<usize>,
    n: f64,
    v: Option<f64>,
}

/// Finds the nearest glasses and writes them to standard output.
pub(crate) fn nearest(arguments: &GlassMatch) -> Outcome {
    let catalogue = catalogue(&arguments.own)?;
    let (lines, wanted) = match &arguments.lens {
        Some(name) => {
            let lens = spectra_lens::load(name, &FileResources::beside(Path::new("")))?;
            let lines = lens.abbe_lines;
            (lines, media(&lens, lines))
        }
        None => {
            let n = arguments.nd.unwrap_or(f64::NAN);
            let refuse = |what: &str| Err(Failure::Input(what.to_owned()));
            if !(1.0..=4.0).contains(&n) {
                return refuse("--nd: the index must be between 1 and 4");
            }
            if arguments.vd.is_some_and(|v| !(1.0..=1000.0).contains(&v)) {
                return refuse("--vd: the Abbe number must be between 1 and 1000");
            }
            (arguments.line, vec![MatchTarget { label: None, surfaces: Vec::new(), n, v: arguments.vd }])
        }
    };
    let makers = makers(&arguments.makers, &catalogue)?;
    let limit = arguments.limit.map_or(if arguments.lens.is_some() { 3 } else { 10 }, usize::from);
    let reports: Vec<Report> = wanted
        .into_iter()
        .map(|wanted| {
            let mut query = Query::new(wanted.n, wanted.v, lines);
            query.makers.clone_from(&makers);
            query.count = limit;
            if arguments.all_media {
                query.categories.clear();
            } else {
                query.categories.push(Category::User);
            }
            if let Some(era) = arguments.era {
                era.narrow(&mut query);
            }
            report(&catalogue, wanted, &query)
        })
        .collect();
    match (&arguments.lens, arguments.report.json) {
        (None, true) => console::pretty_json(&reports[0])?,
        (Some(_), true) => console::pretty_json(&reports)?,
        (_, false) => console::out(&reports.iter().map(text).collect::<Vec<_>>().join("\n"))?,
    }
    if reports.iter().any(|r| r.matches.is_empty()) {
        console::note("no glass fits; widen --maker or --era");
    }
    Ok(DONE)
}

/// Returns the media of a lens except air, each once, with the numbers of the surfaces in front of them.
fn media(lens: &Lens, lines: LineTriple) -> Vec<MatchTarget> {
    let surfaces = |medium: usize| -> Vec<usize> {
        let after = |(i, e): (usize, &spectra_lens::Element)| {
            (e.medium_after == medium && e.medium_before != medium).then_some(i + 1)
        };
        lens.elements.iter().enumerate().filter_map(after).collect()
    };
    let of = |(at, medium): (usize, &spectra_lens::LensMedium)| {
        let v = medium.medium.abbe_number(lines);
        MatchTarget {
            label: Some(medium.label.clone()),
            surfaces: surfaces(at),
            n: medium.stated_nd.unwrap_or_else(|| medium.medium.index(lines.mid.wavelength_nm)),
            v: (v.is_finite() && v > 0.0).then_some(v),
        }
    };
    lens.media.iter().enumerate().skip(1).map(of).collect()
}

fn report(catalogue: &Catalog, wanted: MatchTarget, query: &Query) -> Report {
    let row = |m: Match| GlassMatchRow {
        name: m.glass.full_name(),
        maker: m.glass.maker.to_string(),
        n: m.n,
        v: m.v,
        delta_n: m.delta_n,
        delta_v: query.v.map(|_| m.delta_v),
        distance: m.distance,
        status: m.glass.status.name(),
        years: m.glass.years,
    };
    Report {
        medium: wanted.label,
        surfaces: wanted.surfaces,
        line: query.lines.mid.label(),
        lines_nm: [query.lines.short, query.lines.mid, query.lines.long].map(|line| line.wavelength_nm),
        called: [query.lines.mid.indexed("n"), query.lines.abbe_label()],
        n: wanted.n,
        v: wanted.v,
        matches: catalogue.nearest(query).into_iter().map(row).collect(),
    }
}

fn text(report: &Report) -> String {
    let [of_n, of_v] = &report.called;
    let mut out = String::new();
    // Writing to a String cannot fail.
    if let Some(medium) = &report.medium {
        let numbers: Vec<String> = report.surfaces.iter().map(ToString::to_string).collect();
        let _ = write!(out, "behind surface {}: {medium}, ", numbers.join(", "));
    }
    let _ = write!(out, "{of_n} {}", report.n);
    let _ = report.v.map(|v| write!(out, ", {of_v} {}", rounded(v)));
    let width = report.matches.iter().map(|row| row.name.len()).max().unwrap_or(0).max(5);
    let _ = writeln!(
        out,
        "\n  {:<width$}  {:>9}  {:>7}  {:>9}  {:>7}  {:>8}  {:<9}  listed",
        "glass",
        if of_n.len() > 9 { "n" } else { of_n },
        if of_v.len() > 7 { "V" } else { of_v },
        "dn",
        "dV",
        "distance",
        "status"
    );
    for row in &report.matches {
        let years = row.years.map_or(String::new(), |(first, last)| match first == last {
            true => first.to_string(),
            false => format!("{first}-{last}"),
        });
        let line = format!(
            "  {:<width$}  {:>9.5}  {:>7.2}  {:>+9.5}  {:>7}  {:>8.2}  {:<9}  {years}",
            row.name,
            row.n,
            row.v,
            row.delta_n,
            row.delta_v.map_or(String::new(), |v| format!("{v:+.2}")),
            row.distance,
            row.status,
        );
        let _ = writeln!(out, "{}", line.trim_end());
    }
    out
}

/// Formats a number with at most two decimals, without trailing zeros.
fn rounded(value: f64) -> String {
    let text = format!("{value:.2}");
    text.trim_end_matches('0').trim_end_matches('.').to_owned()
}
