//! `spectra film lamp`: compares how colors change from one light to another, on film and to the eye.

use super::arguments::FilmLamp;
use super::keys::set;
use super::{called, failure, load};
use crate::console;
use crate::outcome::{DONE, Failure, Outcome};
use serde_json::json;
use spectra_analysis::figure::{LampPatch, lamp as figure};
use spectra_color::{
    Adaptation, Gamut, RgbSpace, cam02_ucs, ciede2000, color_evaluation_samples, color_rendering, fidelity,
    fidelity_index, into_gamut, lab, matrix, to_u8, xyz_of_light, xyz_of_reflectance,
};
use spectra_core::params::Fault;
use spectra_core::spectral::BAND;
use spectra_darkroom::FilmInLight;
use spectra_film::stock::Stock;
use spectra_plot::Format;
use spectra_scene::FileResources;
use spectra_sheet::{Column, Sheet, Table};
use spectra_spectrum::{Emission, Observer, Reflectance, find_emission_in, find_reflectance_in};
use std::iter::once;
use std::path::Path;

/// Bundled table of the ColorChecker patches that are compared.
const CHART: &str = "colorchecker";

/// Colors of a surface in a light: to the eye, in the layers of the film, and in the picture. All are XYZ under D65 with Y = 1 for white.
struct PatchColors {
    eye: [f64; 3],
    layers: [f64; 3],
    film: [f64; 3],
}

/// A light source with its name.
struct Named<'a> {
    light: Emission,
    name: &'a str,
}

impl Named<'_> {
    fn dark(&self) -> Failure {
        Failure::Input(format!("`{}` has no light that both the film and the eye can see", self.name))
    }
}

/// Compares how the colors of a chart look in two lights, to the eye and on a film, and prints the result.
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
    let light = |name| -> Result<Named<'_>, Failure> {
        let light = find_emission_in(name, &files).map_err(|e| Failure::Faults(e.faults(Fault::new)))?;
        Ok(Named { light, name: name.trim() })
    };
    let (test, reference) = (light(&arguments.lamp)?, light(&arguments.reference)?);
    let patches = patches(&files)?;
    let film = film(arguments, &stock)?;
    let chart: Vec<&Reflectance> = patches.iter().map(|(_, surface)| surface).collect();
    let samples: Vec<&Reflectance> = color_evaluation_samples().iter().collect();
    let xyz_of_layers = layers_matrix(&stock, &reference, &chart)?;
    let seen = |light: &Named<'_>| patch_colors(light, &stock, &film, &xyz_of_layers, &chart);
    let (in_test, in_reference) = (seen(&test)?, seen(&reference)?);
    let rows: Vec<LampPatch> = patches
        .iter()
        .zip(in_reference.iter().zip(&in_test))
        .map(|((name, _), (a, b))| LampPatch {
            name: name.clone(),
            eye: [shown(a.eye), shown(b.eye)],
            film: [shown(a.film), shown(b.film)],
            apart: [apart(a.eye, b.eye), apart(a.layers, b.layers), apart(a.film, b.film)],
        })
        .collect();
    let pictures = |light: &Named<'_>| film.pictures(&light.light, &samples)?.ok_or_else(|| light.dark());
    let film_rf = fidelity_of(&pictures(&test)?, &pictures(&reference)?);
    let eye = |light: &Named<'_>| samples.iter().map(|sample| to_eye(light, sample)).collect::<Result<Vec<_>, _>>();
    let eye_rf = fidelity_of(&eye(&test)?, &eye(&reference)?);
    let (ra, rf) = (color_rendering(&test.light).map(|r| r.ra), fidelity(&test.light).map(|f| f.rf));
    let mean = [0, 1, 2].map(|which| rows.iter().map(|r| r.apart[which]).sum::<f64>() / rows.len().max(1) as f64);
    let index = |value: Option<f64>| value.map_or("-".to_owned(), |v| format!("{v:.1}"));
    let indices = format!("CIE Ra {}, TM-30 Rf {}", index(ra), index(rf));
    let against = format!("fidelity against {}", reference.name);
    let fidelities = format!("eye {eye_rf:.1}, film {film_rf:.1}");
    let means = format!("eye {:.2}, layers {:.2}, film {:.2}", mean[0], mean[1], mean[2]);
    let title = format!("{} against {} on {}", test.name, reference.name, stock.name);
    if let Some(path) = &arguments.output {
        let first = format!("left half: {}, right half: {}. {}: {indices}", reference.name, test.name, test.name);
        let second = format!("{against}: {fidelities}; mean CIEDE2000: {means}");
        figure(&title, [&first, &second], &rows).write(path).map_err(failure)?;
        console::note(&format!("wrote {}", path.display()));
    }
    let mut sheet = Sheet::new(&title);
    sheet.data("stock", &arguments.stock);
    sheet.data("lamp", &arguments.lamp);
    sheet.data("reference", &arguments.reference);
    sheet.data("cie_ra", ra);
    sheet.data("tm30_rf", rf);
    sheet.line(test.name, Some(indices));
    sheet.data("fidelity", json!({ "eye": eye_rf, "film": film_rf }));
    sheet.line(&against, Some(format!("{fidelities} (99 samples, scale of TM-30)")));
    for (key, mean) in ["mean_eye", "mean_layers", "mean_film"].into_iter().zip(mean) {
        sheet.data(key, mean);
    }
    sheet.line("mean CIEDE2000", Some(means));
    differences(&mut sheet, &rows);
    console::sheet(&sheet, arguments.report.json)?;
    Ok(DONE)
}

/// Adds the color difference of each patch, CIEDE2000, and the patches that change more on film than to the eye.
fn differences(sheet: &mut Sheet, rows: &[LampPatch]) {
    let kinds = ["eye", "layers", "film"].map(|kind| Column::fixed(kind, kind, 2));
    let mut table = Table::new("ciede2000", once(Column::text("name", "CIEDE2000")).chain(kinds));
    for LampPatch { name, apart: [eye, layers, film], .. } in rows {
        table.push((name, eye, layers, film));
    }
    sheet.table(table);
    let parting = parting(rows);
    let named =
        |row: &&LampPatch| format!("{} ({:.1} on film, {:.1} to the eye)", row.name, row.apart[2], row.apart[0]);
    if !parting.is_empty() {
        let all: Vec<String> = parting.iter().map(named).collect();
        sheet.note(&format!("colors that differ more on film than to the eye: {}", all.join(", ")));
    }
    sheet.data("parting", parting.iter().map(|row| &row.name).collect::<Vec<_>>());
}

/// Largest number of patches named in the summary.
const NAMED: usize = 5;

/// Returns the patches that change on film by at least one CIEDE2000 more than to the eye, the worst first, at most [`NAMED`].
fn parting(rows: &[LampPatch]) -> Vec<&LampPatch> {
    let by = |row: &&LampPatch| row.apart[2] - row.apart[0];
    let mut parting: Vec<&LampPatch> = rows.iter().filter(|row| by(row) >= 1.0).collect();
    parting.sort_by(|a, b| by(b).total_cmp(&by(a)));
    parting.truncate(NAMED);
    parting
}

/// Returns the film with its development and view.
fn film(arguments: &FilmLamp, stock: &Stock) -> Result<FilmInLight, Failure> {
    let called = called(&arguments.stock)?;
    let mut settings = vec![set("film.stock", "STOCK", &called)];
    settings.extend(arguments.viewing.view.as_ref().map(|view| set("film.view", "--view", view)));
    settings.extend(arguments.viewing.print.as_ref().map(|print| set("film.print", "--print", print)));
    let made_for = set("source.illuminant", "STOCK", &stock.reference_illuminant);
    Ok(FilmInLight::new(&settings, &made_for)?)
}

/// Computes how surfaces look in a light to the eye, to the layers and in the picture.
fn patch_colors(
    light: &Named<'_>,
    stock: &Stock,
    film: &FilmInLight,
    xyz_of_layers: &[[f64; 3]; 3],
    surfaces: &[&Reflectance],
) -> Result<Vec<PatchColors>, Failure> {
    let white = white_exposures(stock, light)?;
    let pictures = film.pictures(&light.light, surfaces).map_err(Failure::of_stage)?.ok_or_else(|| light.dark())?;
    let one = |(surface, film): (&&Reflectance, [f64; 3])| {
        let exposed = exposures(stock, &(&light.light * *surface));
        let layers = matrix::apply(xyz_of_layers, [0, 1, 2].map(|i| exposed[i] / white[i]));
        Ok(PatchColors { eye: to_eye(light, surface)?, layers, film })
    };
    surfaces.iter().zip(pictures).map(one).collect()
}

/// Returns the color of a surface to an eye adapted to the light, as XYZ under D65 with Y = 1 for white.
fn to_eye(light: &Named<'_>, surface: &Reflectance) -> Result<[f64; 3], Failure> {
    let observer = Observer::cie_1931_2deg();
    let white = xyz_of_light(&light.light, observer).ok_or_else(|| light.dark())?;
    let xyz = xyz_of_reflectance(surface, &light.light, observer).ok_or_else(|| light.dark())?;
    Ok(to_d65(xyz, white))
}

/// Returns the fidelity index between two renderings of the samples, on the scale of TM-30, from their mean difference in CAM02-UCS.
fn fidelity_of(test: &[[f64; 3]], reference: &[[f64; 3]]) -> f64 {
    let white = RgbSpace::srgb().white_xyz().map(|v| 100.0 * v);
    // Values slightly below 0, which the data of a film can give, count as black.
    let place = |xyz: &[f64; 3]| cam02_ucs(xyz.map(|v| (100.0 * v).max(0.0)), white);
    let apart = |(a, b): (&[f64; 3], &[f64; 3])| {
        let (a, b) = (place(a), place(b));
        (0..3).map(|i| (a[i] - b[i]) * (a[i] - b[i])).sum::<f64>().sqrt()
    };
    let all: f64 = test.iter().zip(reference).map(apart).sum();
    fidelity_index(all / test.len().max(1) as f64)
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

/// Returns the exposure of each layer by a light itself. Fails if a layer does not respond to it.
fn white_exposures(stock: &Stock, light: &Named<'_>) -> Result<[f64; 3], Failure> {
    let white = exposures(stock, &light.light);
    if white.iter().all(|e| *e > 0.0 && e.is_finite()) { Ok(white) } else { Err(light.dark()) }
}

/// Returns the exposure of each layer by a light.
fn exposures(stock: &Stock, light: &Emission) -> [f64; 3] {
    let power = light.to_power(&BAND);
    [0, 1, 2].map(|i| {
        let layer = &stock.layers[i].sensitivity;
        let response: Vec<f64> = BAND.wavelengths_nm().map(|nm| layer.at(nm)).collect();
        power.seen_by(&response)
    })
}

/// Converts a surface's XYZ in a light to the XYZ that looks the same to an eye adapted to D65, with Y = 1 for white.
fn to_d65(xyz: [f64; 3], white: [f64; 3]) -> [f64; 3] {
    let unit = |xyz: [f64; 3]| xyz.map(|v| v / white[1]);
    Adaptation::Cat16.adapt(unit(xyz), unit(white), RgbSpace::srgb().white_xyz())
}

/// Fits the matrix that converts the layers' exposures, relative to white, to XYZ under D65. The fit minimizes the error of the
/// chart in the reference light, and keeps white. The matrix stands for a laboratory's timing and masks, so that only the changes
/// due to the lamp are left. Fails if the layers do not separate colors.
fn layers_matrix(stock: &Stock, reference: &Named<'_>, chart: &[&Reflectance]) -> Result<[[f64; 3]; 3], Failure> {
    let white = white_exposures(stock, reference)?;
    let (mut squares, mut products) = ([[0.0; 3]; 3], [[0.0; 3]; 3]);
    let mut add = |from: [f64; 3], to: [f64; 3], weight: f64| {
        for i in 0..3 {
            for j in 0..3 {
                squares[i][j] += weight * from[i] * from[j];
                products[i][j] += weight * to[i] * from[j];
            }
        }
    };
    for surface in chart {
        let exposed = exposures(stock, &(&reference.light * *surface));
        let from = [0, 1, 2].map(|i| exposed[i] / white[i]);
        // Dark patches count as much as light ones.
        let weight = 1.0 / from.iter().sum::<f64>().max(1e-3);
        add(from, to_eye(reference, surface)?, weight);
    }
    // White has by far the largest weight.
    add([1.0; 3], RgbSpace::srgb().white_xyz(), 1e4);
    let out = matrix::product(&products, &matrix::inverse(&squares));
    if out.iter().flatten().any(|v| !v.is_finite()) {
        return Err(Failure::Input(format!("the layers of `{}` do not separate colors", stock.name)));
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
