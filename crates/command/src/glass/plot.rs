//! `spectra glass plot`: plots indices or an Abbe diagram.

use super::arguments::GlassPlot;
use super::{catalogue, makers, named};
use crate::console;
use crate::outcome::{DONE, Failure, Outcome};
use spectra_analysis::figure::{self, AbbeGroup, IndexCurve};
use spectra_glass::{Catalog, Category, LineTriple, Medium, Query, lines};
use spectra_plot::{Canvas, Format};
use std::path::PathBuf;

/// Spectral lines that are marked in the plot.
const MARKED: [&str; 9] = ["i", "h", "g", "F", "e", "d", "C", "r", "s"];
/// Number of steps of a curve.
const POINTS: usize = 600;

/// Plots the indices of media, or an Abbe diagram, and writes the figure to a file.
pub(crate) fn plot(arguments: &GlassPlot) -> Outcome {
    let default = || PathBuf::from(if arguments.abbe { "abbe.svg" } else { "dispersion.svg" });
    let output = arguments.output.clone().unwrap_or_else(default);
    // A wrong extension is reported before anything is computed.
    Format::of(&output)?;
    let catalogue = catalogue(&arguments.own)?;
    // A material of a file with several is labeled by its own name.
    let label = |name: &str| match name.rsplit_once('#') {
        Some((_, material)) if spectra_glass::file::is_file(name) => material.trim().to_owned(),
        _ => name.trim().to_owned(),
    };
    let find = |name: &String| Ok((label(name), named(name, &catalogue)?));
    let media = arguments.names.iter().map(find).collect::<Result<Vec<_>, Failure>>()?;
    let canvas =
        if arguments.abbe { abbe(arguments, &catalogue, &media)? } else { dispersion(&media, arguments.range_nm)? };
    canvas.write(&output)?;
    console::note(&format!("wrote {}", output.display()));
    Ok(DONE)
}

fn dispersion(media: &[(String, Medium)], band_nm: (f64, f64)) -> Result<Canvas, Failure> {
    let step = (band_nm.1 - band_nm.0) / POINTS as f64;
    let mut curves = Vec::new();
    for (name, medium) in media {
        let at = |i: usize| band_nm.0 + step * i as f64;
        let points: Vec<[f64; 2]> = (0..=POINTS).map(|i| [at(i), medium.index(at(i))]).collect();
        if points.iter().all(|p| !p[1].is_finite()) {
            let (from, to) = band_nm;
            return Err(Failure::Input(format!("{name} has no index from {from} to {to} nm")));
        }
        curves.push(IndexCurve { name: name.clone(), points, range_nm: medium.range_nm() });
    }
    let marks: Vec<(&str, f64)> =
        lines::ALL.iter().filter(|line| MARKED.contains(&line.name)).map(|l| (l.name, l.wavelength_nm)).collect();
    Ok(figure::dispersion(&curves, band_nm, &marks))
}

fn abbe(arguments: &GlassPlot, catalogue: &Catalog, media: &[(String, Medium)]) -> Result<Canvas, Failure> {
    let lines = arguments.lines;
    let makers = makers(&arguments.makers, catalogue)?;
    let glasses = |maker: Option<&String>| {
        let mut query = Query::new(1.5, None, lines);
        query.count = usize::MAX;
        query.makers.extend(maker.cloned());
        query.categories.push(Category::User);
        if let Some(era) = arguments.era {
            era.narrow(&mut query);
        }
        let points = catalogue.nearest(&query).iter().map(|m| [m.v, m.n]).filter(visible).collect();
        AbbeGroup { name: maker.map_or("all makers", String::as_str).to_owned(), points }
    };
    let groups: Vec<AbbeGroup> =
        if makers.is_empty() { vec![glasses(None)] } else { makers.iter().map(|m| glasses(Some(m))).collect() };
    let mut named = Vec::new();
    for (name, medium) in media {
        let (n, v) = (medium.index(lines.mid.wavelength_nm), medium.abbe_number(lines));
        if !visible(&[v, n]) {
            return Err(Failure::Input(format!("{name} has no Abbe number that the diagram can show")));
        }
        named.push((name.clone(), [v, n]));
    }
    for group in groups.iter().filter(|g| g.points.is_empty()) {
        console::warning(&format!("no optical glass matches for {}", group.name));
    }
    Ok(figure::abbe(&groups, &named, &axes(lines)))
}

/// Returns the labels of the axes of an Abbe diagram: the Abbe number and the index.
fn axes(lines: LineTriple) -> [String; 2] {
    let of = |symbol: &str| format!("{symbol}_{{{}}}", lines.mid.label());
    let usual = LineTriple::of_reference(lines.mid) == Some(lines);
    let for_lines = if usual { String::new() } else { format!(" for {}", lines.label()) };
    [format!("Abbe number {}{for_lines}", of("V")), format!("refractive index {}", of("n"))]
}

/// Whether a point (Abbe number, index) lies inside the Abbe diagram.
fn visible([v, n]: &[f64; 2]) -> bool {
    (1.0..=4.0).contains(n) && (5.0..=130.0).contains(v)
}
