//! `spectra glass match`: finds the glasses nearest to an index and an Abbe number.

use super::arguments::GlassMatch;
use super::{catalogue, makers, period};
use crate::console;
use crate::outcome::{DONE, Failure, Outcome};
use serde_json::json;
use spectra_glass::{Category, LineTriple, Match, Query};
use spectra_lens::Lens;
use spectra_scene::FileResources;
use spectra_sheet::{Column, Sheet, Table};
use std::path::Path;

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
    let count = arguments.limit.map_or(if arguments.lens.is_some() { 3 } else { 10 }, usize::from);
    let makers = makers(&arguments.makers, &catalogue)?;
    let mut query = Query { makers, count, ..Query::new(f64::NAN, None, lines) };
    if arguments.all_media {
        query.categories.clear();
    } else {
        query.categories.push(Category::User);
    }
    if let Some(era) = arguments.era {
        era.narrow(&mut query);
    }
    let mut sheets = Vec::new();
    let mut is_lacking = false;
    for wanted in &wanted {
        (query.n, query.v) = (wanted.n, wanted.v);
        let matches = catalogue.nearest(&query);
        is_lacking |= matches.is_empty();
        sheets.push(sheet(wanted, lines, &matches));
    }
    match sheets.as_slice() {
        [only] if arguments.lens.is_none() => console::sheet(only, arguments.report.json)?,
        all => console::sheets(all, arguments.report.json)?,
    }
    if is_lacking {
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

/// Makes the sheet of the glasses nearest to one index and Abbe number. `distance` is in units of the usual catalogue tolerance.
fn sheet(wanted: &MatchTarget, lines: LineTriple, matches: &[Match]) -> Sheet {
    let [n_label, v_label] = [lines.mid.indexed("n"), lines.abbe_label()];
    let surfaces = wanted.surfaces.iter().map(ToString::to_string).collect::<Vec<_>>().join(", ");
    let place = wanted.label.as_ref().map_or(String::new(), |medium| format!("behind surface {surfaces}: {medium}, "));
    let v = wanted.v.map_or(String::new(), |v| format!(", {v_label} {}", rounded(v)));
    let mut sheet = Sheet::new(&format!("{place}{n_label} {}{v}", wanted.n));
    sheet.data("medium", &wanted.label);
    sheet.data("surfaces", &wanted.surfaces);
    sheet.data("line", lines.mid.label());
    sheet.data("lines_nm", [lines.short, lines.mid, lines.long].map(|line| line.wavelength_nm));
    sheet.data("n", wanted.n);
    sheet.data("v", wanted.v);
    let columns = [
        Column::text("name", "glass"),
        Column::fixed("n", if n_label.len() > 9 { "n" } else { &n_label }, 5),
        Column::fixed("v", if v_label.len() > 7 { "V" } else { &v_label }, 2),
        Column::plain("delta_n", "dn"),
        Column::plain("delta_v", "dV"),
        Column::fixed("distance", "distance", 2),
        Column::text("status", "status"),
        Column::text("years", "listed"),
    ];
    let mut table = Table::new("matches", columns);
    let mut data = Vec::new();
    for Match { glass, n, v, delta_n, delta_v, distance } in matches {
        let (name, status) = (glass.full_name(), glass.status.name());
        let delta_v = wanted.v.map(|_| delta_v);
        let delta_v_text = delta_v.map_or(String::new(), |v| format!("{v:+.2}"));
        let years = glass.years.map_or(String::new(), period);
        table.push((&name, n, v, format!("{delta_n:+.5}"), delta_v_text, distance, status, years));
        data.push(json!({
            "name": name, "maker": &*glass.maker, "n": n, "v": v, "delta_n": delta_n, "delta_v": delta_v,
            "distance": distance, "status": status, "years": glass.years,
        }));
    }
    sheet.show(table);
    sheet.data("matches", data);
    sheet
}

/// Formats a number with at most two decimals, without trailing zeros.
fn rounded(value: f64) -> String {
    let text = format!("{value:.2}");
    text.trim_end_matches('0').trim_end_matches('.').to_owned()
}
