//! `spectra film lamp`: how colors change on film and to the eye from one light to another.

use super::arguments::FilmLamp;
use super::{failure, load};
use crate::console;
use crate::outcome::{DONE, Failure, Outcome};
use serde_json::json;
use spectra_analysis::figure::{LampPatch, lamp as figure};
use spectra_color::{
    Adaptation, Gamut, RgbSpace, ciede2000, color_rendering, fidelity, into_gamut, lab, matrix, to_u8, xyz_of_light,
    xyz_of_reflectance,
};
use spectra_core::params::Fault;
use spectra_core::spectral::BAND;
use spectra_film::stock::Stock;
use spectra_plot::Format;
use spectra_scene::FileResources;
use spectra_spectrum::{Emission, Observer, Reflectance, find_emission_in, find_reflectance_in};
use std::fmt::Write;
use std::path::Path;

/// The ColorChecker's patches that are compared.
const CHART: &str = "colorchecker";

/// A patch in a light: as the eye has it, and as the film does, XYZ under D65 with 1 for white.
struct Seen {
    eye: [f64; 3],
    film: [f64; 3],
}

/// Compares two lights by what they make of a chart, for the eye and on a film.
pub(crate) fn lamp(arguments: &FilmLamp) -> Outcome {
    if let Some(path) = &arguments.output {
        Format::of(path).map_err(failure)?;
    }
    let stock = load(&arguments.stock)?;
    if stock.layers.len() != 3 {
        let text =
            format!("`{}` has {} layers: only a color film tells colors apart", arguments.stock, stock.layers.len());
        return Err(Failure::Input(text));
    }
    let files = FileResources::beside(Path::new(""));
    let light = |name: &str| find_emission_in(name, &files).map_err(|e| Failure::Faults(e.faults(Fault::new)));
    let (test, reference) = (light(&arguments.lamp)?, light(&arguments.reference)?);
    let patches = patches(&files)?;
    let xyz_of_film = film_matrix(&stock, &reference, &patches, &arguments.reference)?;
    let seen = |light: &Emission, name: &str| -> Result<Vec<Seen>, Failure> {
        let none = || Failure::Input(format!("`{name}` has no light that the film and the eye see"));
        let white = exposures(&stock, light, None);
        if white.iter().any(|e| !(*e > 0.0 && e.is_finite())) {
            return Err(none());
        }
        let eye_white = xyz_of_light(light, Observer::cie_1931_2deg()).ok_or_else(none)?;
        let one = |(_, surface): &(String, Reflectance)| {
            let exposed = exposures(&stock, light, Some(surface));
            let film = matrix::apply(&xyz_of_film, [0, 1, 2].map(|i| exposed[i] / white[i]));
            let xyz = xyz_of_reflectance(surface, light, Observer::cie_1931_2deg()).ok_or_else(none)?;
            Ok(Seen { eye: to_d65(xyz, eye_white), film })
        };
        patches.iter().map(one).collect()
    };
    let (in_test, in_reference) = (seen(&test, &arguments.lamp)?, seen(&reference, &arguments.reference)?);
    let rows: Vec<LampPatch> = patches
        .iter()
        .zip(in_reference.iter().zip(&in_test))
        .map(|((name, _), (a, b))| LampPatch {
            name: name.clone(),
            eye: [shown(a.eye), shown(b.eye)],
            film: [shown(a.film), shown(b.film)],
            apart: [apart(a.eye, b.eye), apart(a.film, b.film)],
        })
        .collect();
    let (ra, rf) = (color_rendering(&test).map(|r| r.ra), fidelity(&test).map(|f| f.rf));
    let mean = |which: usize| rows.iter().map(|r| r.apart[which]).sum::<f64>() / rows.len().max(1) as f64;
    let (eye, film) = (mean(0), mean(1));
    let index = |value: Option<f64>| value.map_or("-".to_owned(), |v| format!("{v:.1}"));
    let figures =
        format!("CIE Ra {}, TM-30 Rf {}; mean CIEDE2000 to the eye {eye:.2}, on film {film:.2}", index(ra), index(rf));
    let title = format!("{} against {} on {}", arguments.lamp.trim(), arguments.reference.trim(), stock.name);
    if let Some(path) = &arguments.output {
        figure(
            &title,
            &format!("left half: {}, right half: {}. {figures}", arguments.reference.trim(), arguments.lamp.trim()),
            &rows,
        )
        .write(path)
        .map_err(failure)?;
        console::note(&format!("wrote {}", path.display()));
    }
    if arguments.json {
        let patches: Vec<_> =
            rows.iter().map(|r| json!({ "name": r.name, "eye": r.apart[0], "film": r.apart[1] })).collect();
        console::pretty_json(&json!({
            "stock": arguments.stock, "lamp": arguments.lamp, "reference": arguments.reference, "cie_ra": ra, "tm30_rf": rf,
            "mean_eye": eye, "mean_film": film, "ciede2000": patches,
        }))?;
        return Ok(DONE);
    }
    let mut out = format!("{title}\n\n  {figures}\n\n  {:<16}  {:>6}  {:>6}\n", "CIEDE2000", "eye", "film");
    for row in &rows {
        // Writing to a String cannot fail.
        let _ = writeln!(out, "  {:<16}  {:>6.2}  {:>6.2}", row.name, row.apart[0], row.apart[1]);
    }
    let parts = rows.iter().max_by(|a, b| (a.apart[1] - a.apart[0]).total_cmp(&(b.apart[1] - b.apart[0])));
    if let Some(row) = parts.filter(|row| row.apart[1] > row.apart[0]) {
        let _ = writeln!(
            out,
            "\n  {} parts most from what the eye expects: {:.2} on film, {:.2} to the eye",
            row.name, row.apart[1], row.apart[0]
        );
    }
    console::out(&out)?;
    Ok(DONE)
}

fn patches(files: &FileResources) -> Result<Vec<(String, Reflectance)>, Failure> {
    let columns = match find_reflectance_in(CHART, files) {
        Err(spectra_spectrum::SpectrumError::Ambiguous { columns, .. }) => columns,
        _ => Vec::new(),
    };
    let one = |name: String| {
        let found = find_reflectance_in(&format!("{CHART}#{name}"), files);
        found.map(|surface| (name, surface)).map_err(|e| Failure::Faults(e.faults(Fault::new)))
    };
    columns.into_iter().map(one).collect()
}

/// What each layer gets of a surface in a light; of the light itself without one.
fn exposures(stock: &Stock, light: &Emission, surface: Option<&Reflectance>) -> [f64; 3] {
    let light = surface.map_or_else(|| light.clone(), |surface| light * surface);
    let power = light.to_power(&BAND);
    [0, 1, 2].map(|i| {
        let layer = &stock.layers[i].sensitivity;
        let response: Vec<f64> = BAND.wavelengths_nm().map(|nm| layer.at(nm)).collect();
        power.seen_by(&response)
    })
}

/// From a surface's XYZ in a light to what an eye adapted to D65 would see alike, 1 for white.
fn to_d65(xyz: [f64; 3], white: [f64; 3]) -> [f64; 3] {
    let unit = |xyz: [f64; 3]| xyz.map(|v| v / white[1]);
    Adaptation::Cat16.adapt(unit(xyz), unit(white), RgbSpace::srgb().white_xyz())
}

/// The matrix from the layers' exposures over white's to XYZ under D65 that is best for the chart in the reference light, with white kept:
/// what a laboratory's timing and masks come to, so that only what the lamp changes is left.
fn film_matrix(
    stock: &Stock,
    reference: &Emission,
    patches: &[(String, Reflectance)],
    name: &str,
) -> Result<[[f64; 3]; 3], Failure> {
    let none = || Failure::Input(format!("`{name}` has no light that the film and the eye see"));
    let white = exposures(stock, reference, None);
    let eye_white = xyz_of_light(reference, Observer::cie_1931_2deg()).ok_or_else(none)?;
    if white.iter().any(|e| !(*e > 0.0 && e.is_finite())) {
        return Err(none());
    }
    let (mut squares, mut products) = ([[0.0; 3]; 3], [[0.0; 3]; 3]);
    let mut add = |from: [f64; 3], to: [f64; 3], weight: f64| {
        for i in 0..3 {
            for j in 0..3 {
                squares[i][j] += weight * from[i] * from[j];
                products[i][j] += weight * to[i] * from[j];
            }
        }
    };
    for (_, surface) in patches {
        let exposed = exposures(stock, reference, Some(surface));
        let xyz = xyz_of_reflectance(surface, reference, Observer::cie_1931_2deg()).ok_or_else(none)?;
        let from = [0, 1, 2].map(|i| exposed[i] / white[i]);
        // Dark patches count as light ones do.
        let weight = 1.0 / from.iter().sum::<f64>().max(1e-3);
        add(from, to_d65(xyz, eye_white), weight);
    }
    // White by far the most.
    add([1.0; 3], RgbSpace::srgb().white_xyz(), 1e4);
    let inverse = matrix::inverse(&squares);
    let mut out = [[0.0; 3]; 3];
    for i in 0..3 {
        for j in 0..3 {
            out[i][j] = (0..3).map(|k| products[i][k] * inverse[k][j]).sum();
        }
    }
    if out.iter().flatten().any(|v| !v.is_finite()) {
        return Err(Failure::Input(format!("the layers of `{}` see colors alike", stock.name)));
    }
    Ok(out)
}

fn apart(a: [f64; 3], b: [f64; 3]) -> f64 {
    let white = RgbSpace::srgb().white_xyz();
    ciede2000(lab(a, white), lab(b, white))
}

fn shown(xyz: [f64; 3]) -> [u8; 3] {
    let srgb = RgbSpace::srgb();
    srgb.encode(into_gamut(srgb.from_xyz(xyz), srgb, Gamut::Perceptual)).map(to_u8)
}
