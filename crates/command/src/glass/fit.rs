//! `spectra glass fit`: fits dispersion formulas to tables.

use super::arguments::{GlassFit, Model};
use super::read;
use crate::console;
use crate::formatting::is_yaml;
use crate::outcome::{DONE, Failure, Outcome};
use serde_json::{Map, Value, json};
use spectra_analysis::figure::{FittedCurve, glass_fit};
use spectra_core::params::Fault;
use spectra_files::write_atomically;
use spectra_glass::fit::{
    CauchyRows, Fit, FitError, NamedSamples, Sample, cauchy_by_rows, cauchy_least_squares, conrady_least_squares,
    herzberger_least_squares, read_csv, schott_least_squares, sellmeier_least_squares,
};
use spectra_plot::Format;
use spectra_sheet::{Column, Sheet, Table};
use std::io::Write;
use std::path::{Path, PathBuf};

/// A formula fitted to the rows of a material, or the reason why it could not be.
struct FittedFormula {
    model: Model,
    fit: Result<Fit, FitError>,
    /// Cauchy's A and B of each row, if the formula is their mean.
    by_rows: Option<CauchyRows>,
}

/// Fits formulas to the materials of a table, writes the requested files, and prints the results.
pub(crate) fn fit(arguments: &GlassFit) -> Outcome {
    if let Some(plot) = &arguments.plot {
        // A wrong extension is reported before anything is read.
        Format::of(plot)?;
    }
    if let Some(output) = arguments.output.as_ref().filter(|path| !is_yaml(path)) {
        return Err(Failure::Input(format!("{}: the name of a glass file must end in .yaml", output.display())));
    }
    let (file, material) = one_of(&arguments.file);
    let name = arguments.file.display().to_string();
    let bytes = read(&file)?;
    let text = String::from_utf8_lossy(&bytes);
    let mut materials =
        read_csv(&text).map_err(|e| Failure::Input(format!("{}:{}: {}", file.display(), e.line, e.message)))?;
    if let Some(wanted) = material {
        let known: Vec<String> = materials.iter().filter_map(|m| m.name.clone()).collect();
        materials.retain(|m| m.name.as_deref() == Some(wanted.as_str()));
        if materials.is_empty() {
            let listed =
                if known.is_empty() { "the file has no column `material`".to_owned() } else { known.join(", ") };
            return Err(Fault::new(format!("{}: there is no material `{wanted}`", file.display())).hint(listed).into());
        }
    }
    let alone = arguments.output.is_some() || arguments.plot.is_some();
    if alone && materials.len() > 1 {
        let named: Vec<&str> = materials.iter().filter_map(|m| m.name.as_deref()).collect();
        let first = named.first().unwrap_or(&"");
        let hint = format!("name one, such as `{name}#{first}`; there are {}", named.join(", "));
        let count = materials.len();
        let text = format!("{name}: the table holds {count} materials, but -o and --plot take only one");
        return Err(Fault::new(text).hint(hint).into());
    }
    let models =
        if arguments.models.is_empty() { vec![Model::Cauchy, Model::CauchyLs] } else { arguments.models.clone() };
    let terms = arguments.terms.map(usize::from);
    let fits_of = |m: &NamedSamples| models.iter().map(|model| fit_formula(*model, &m.samples, terms)).collect();
    let fits: Vec<Vec<FittedFormula>> = materials.iter().map(fits_of).collect();
    let failure = |(material, fits): (&NamedSamples, &Vec<FittedFormula>)| {
        let (fitted, error) = fits.iter().find_map(|f| Some((f, f.fit.as_ref().err()?)))?;
        let of = material.name.as_ref().map_or(String::new(), |m| format!(" of {m}"));
        Some(Failure::Input(format!("{name}: no fit{of} by {}: {error}", describe(fitted.model).0)))
    };
    let failure = materials.iter().zip(&fits).find_map(failure);
    if let (true, None, [material], [fits]) = (alone, &failure, materials.as_slice(), fits.as_slice()) {
        write_files(arguments, &file, material, fits)?;
    }
    let sheets: Vec<Sheet> = materials.iter().zip(&fits).map(|(m, fits)| sheet(m, fits, arguments.rows)).collect();
    console::sheets(&sheets, arguments.json)?;
    failure.map_or(Ok(DONE), Err)
}

/// Splits FILE#MATERIAL into the file and the material. A path that exists, even with a `#`, is the file itself.
fn one_of(path: &Path) -> (PathBuf, Option<String>) {
    let text = path.to_string_lossy();
    match text.rsplit_once('#') {
        Some((file, material)) if !path.exists() => (PathBuf::from(file), Some(material.trim().to_owned())),
        _ => (path.to_owned(), None),
    }
}

/// Writes the glass file and the figure, if requested.
fn write_files(
    arguments: &GlassFit,
    file: &Path,
    material: &NamedSamples,
    fits: &[FittedFormula],
) -> Result<(), Failure> {
    let stem = file.file_stem().map_or_else(|| "glass".to_owned(), |stem| stem.to_string_lossy().into_owned());
    let called = material.name.clone().unwrap_or(stem);
    let found: Vec<(Model, &Fit)> = fits.iter().filter_map(|f| Some((f.model, f.fit.as_ref().ok()?))).collect();
    if let (Some(output), Some((model, fit))) = (&arguments.output, found.first()) {
        let text = glass_file(&called, &file.display().to_string(), &material.samples, *model, fit);
        write_atomically(output, |out| Ok(out.write_all(text.as_bytes())?))?;
        console::note(&format!("wrote {}", output.display()));
    }
    if let Some(plot) = &arguments.plot {
        const POINTS: usize = 300;
        let [from, to] = range_nm(&material.samples);
        let at = |i: usize| from + (to - from) * i as f64 / POINTS as f64;
        let curve = |(model, fit): &(Model, &Fit)| FittedCurve {
            name: describe(*model).0.to_owned(),
            points: (0..=POINTS).map(|i| [at(i), fit.formula.index(at(i))]).collect(),
            deviations: deviations(fit, &material.samples),
        };
        let curves: Vec<FittedCurve> = found.iter().map(curve).collect();
        let measured: Vec<[f64; 2]> = material.samples.iter().map(|row| [row.wavelength_nm, row.n]).collect();
        let canvas = glass_fit(&format!("{called}: fitted dispersion"), &measured, &curves);
        canvas.write(plot)?;
        console::note(&format!("wrote {}", plot.display()));
    }
    Ok(())
}

/// Returns the text of a glass file with the fit, with all digits. Cauchy's coefficients are in nm, as usual in tables.
fn glass_file(called: &str, from: &str, samples: &[Sample], model: Model, fit: &Fit) -> String {
    let quoted = |text: &str| Value::String(text.to_owned()).to_string();
    let (name, description) = describe(model);
    let mut numbers = fit.formula.coefficients();
    let (formula, unit) = match model {
        Model::Cauchy | Model::CauchyLs => {
            numbers = named(model, &numbers).into_iter().map(|(_, v)| v).collect();
            ("cauchy", "unit: nm\n")
        }
        Model::Sellmeier => {
            // Fits with one and two terms include a constant, which is 0. The form with three terms takes them without it, padded with
            // zeros.
            if numbers.len() % 2 == 1 {
                numbers.remove(0);
            }
            numbers.resize(6, 0.0);
            ("sellmeier-1", "")
        }
        Model::Conrady | Model::Schott | Model::Herzberger => (name, ""),
    };
    let numbers: Vec<String> = numbers.iter().map(f64::to_string).collect();
    let [from_nm, to_nm] = range_nm(samples);
    format!(
        "# {description}\n# Deviation from {} rows: {}.\nspectra: 1\nname: {}\nsource: {}\n\
         formula: {formula}\n{unit}coefficients: [{}]\nrange: [{from_nm} nm, {to_nm} nm]\n",
        samples.len(),
        deviation_text(fit),
        quoted(called),
        quoted(&format!("fitted to {from}")),
        numbers.join(", "),
    )
}

fn deviation_text(fit: &Fit) -> String {
    let Fit { mean_deviation, rms_deviation, max_deviation, .. } = fit;
    format!("mean {mean_deviation:.2e}, rms {rms_deviation:.2e}, largest {max_deviation:.2e}")
}

/// Returns the shortest and the longest wavelength.
fn range_nm(samples: &[Sample]) -> [f64; 2] {
    let wavelengths = || samples.iter().map(|s| s.wavelength_nm);
    [wavelengths().fold(f64::INFINITY, f64::min), wavelengths().fold(0.0, f64::max)]
}

/// Returns the index of the formula minus that of the row, for each row.
fn deviations(fit: &Fit, samples: &[Sample]) -> Vec<f64> {
    samples.iter().map(|s| fit.formula.index(s.wavelength_nm) - s.n).collect()
}

fn fit_formula(model: Model, samples: &[Sample], terms: Option<usize>) -> FittedFormula {
    let mut by_rows = None;
    let fit = match model {
        Model::Cauchy => cauchy_by_rows(samples).map(|rows| by_rows.insert(rows).fit.clone()),
        Model::CauchyLs => cauchy_least_squares(samples, terms.unwrap_or(2)),
        Model::Sellmeier => sellmeier_least_squares(samples, terms.unwrap_or(3)),
        Model::Conrady => conrady_least_squares(samples),
        Model::Schott => schott_least_squares(samples),
        Model::Herzberger => herzberger_least_squares(samples),
    };
    FittedFormula { model, fit, by_rows }
}

fn describe(model: Model) -> (&'static str, &'static str) {
    match model {
        Model::Cauchy => ("cauchy", "n = A + B / L^2 (means over neighboring rows)"),
        Model::CauchyLs => ("cauchy-ls", "n = A + B / L^2 + C / L^4 ... (least squares)"),
        Model::Sellmeier => ("sellmeier", "n^2 = 1 + sum of K L^2 / (L^2 - M)"),
        Model::Conrady => ("conrady", "n = A + B / L + C / L^3.5"),
        Model::Schott => ("schott", "n^2 = A0 + A1 L^2 + A2 L^-2 + A3 L^-4 + A4 L^-6 + A5 L^-8"),
        Model::Herzberger => ("herzberger", "n = A + B l + C l^2 + D L^2 + E L^4 + F L^6, l = 1 / (L^2 - 0.028)"),
    }
}

/// Returns the coefficients with their names. Cauchy's are for wavelengths in nm, as usual in tables.
fn named(model: Model, c: &[f64]) -> Vec<(String, f64)> {
    const LETTERS: [&str; 6] = ["a", "b", "c", "d", "e", "f"];
    match model {
        Model::Cauchy | Model::CauchyLs => {
            let mut nm = 1.0;
            let mut out = Vec::new();
            for (k, value) in c.iter().enumerate() {
                let unit = if k == 0 { String::new() } else { format!("_nm{}", 2 * k) };
                out.push((format!("{}{unit}", LETTERS[k.min(5)]), value * nm));
                nm *= 1e6;
            }
            out
        }
        Model::Sellmeier => {
            // Fits with one and two terms include a constant, which is 0.
            let c = if c.len() % 2 == 1 { &c[1..] } else { c };
            let name =
                |k: usize| if k.is_multiple_of(2) { format!("k{}", k / 2 + 1) } else { format!("m{}_um2", k / 2 + 1) };
            c.iter().enumerate().map(|(k, v)| (name(k), *v)).collect()
        }
        Model::Schott => c.iter().enumerate().map(|(k, v)| (format!("a{k}"), *v)).collect(),
        Model::Conrady | Model::Herzberger => c.iter().zip(LETTERS).map(|(v, name)| (name.to_owned(), *v)).collect(),
    }
}

/// Makes the sheet of the fits of one material.
fn sheet(material: &NamedSamples, fits: &[FittedFormula], with_rows: bool) -> Sheet {
    let [from, to] = range_nm(&material.samples);
    let title = material.name.as_deref().unwrap_or("samples");
    let mut sheet = Sheet::new(&format!("{title}: {} rows, {from} to {to} nm", material.samples.len()));
    sheet.data("material", &material.name);
    sheet.data("samples", material.samples.len());
    sheet.data("range_nm", [from, to]);
    sheet.data("fits", fits.iter().map(|fitted| to_json(fitted, &material.samples)).collect::<Vec<_>>());
    for fitted in fits {
        let (name, formula) = describe(fitted.model);
        sheet.line(name, Some(formula.to_owned()));
        match &fitted.fit {
            Err(error) => sheet.line("  none:", Some(error.to_string())),
            Ok(fit) => {
                for (name, value) in named(fitted.model, &fit.formula.coefficients()) {
                    let (name, unit) = name.split_once('_').unwrap_or((&name, ""));
                    let unit = if unit == "um2" { " um^2".to_owned() } else { unit.replacen("nm", " nm^", 1) };
                    sheet.line(&format!("  {}", name.to_uppercase()), Some(format!("{value:>16.9}{unit}")));
                }
                sheet.line("  deviation:", Some(deviation_text(fit)));
            }
        }
    }
    if with_rows {
        sheet.show(rows(&material.samples, fits));
    }
    sheet
}

/// Returns the data of a fit. Coefficients are for wavelengths in nm if their name says so, in micrometers otherwise.
fn to_json(fitted: &FittedFormula, samples: &[Sample]) -> Value {
    let (model, formula) = describe(fitted.model);
    let fit = match &fitted.fit {
        Ok(fit) => fit,
        Err(error) => {
            return json!({
                "model": model, "formula": formula, "mean_deviation": null, "rms_deviation": null, "max_deviation": null,
                "error": error.to_string(),
            });
        }
    };
    let coefficients = named(fitted.model, &fit.formula.coefficients());
    let mut coefficients: Map<_, _> = coefficients.into_iter().map(|(name, value)| (name, json!(value))).collect();
    if let Some(rows) = &fitted.by_rows {
        coefficients.insert("b_rows_nm2".to_owned(), json!(rows.b_rows_nm2));
        coefficients.insert("a_rows".to_owned(), json!(rows.a_rows));
    }
    json!({
        "model": model, "formula": formula, "coefficients": coefficients, "mean_deviation": fit.mean_deviation,
        "rms_deviation": fit.rms_deviation, "max_deviation": fit.max_deviation, "deviations": deviations(fit, samples),
    })
}

/// Makes the table of the rows: wavelength, index, Cauchy's A and B, and the deviation of each formula.
fn rows(samples: &[Sample], fits: &[FittedFormula]) -> Table {
    let cauchy = fits.iter().find_map(|fitted| fitted.by_rows.as_ref());
    let found: Vec<_> = fits.iter().filter_map(|f| Some((describe(f.model).0, f.fit.as_ref().ok()?))).collect();
    let cauchy_labels = cauchy.map_or(&[][..], |_| &["A", "B / nm^2"]);
    let labels = ["nm", "n"].iter().chain(cauchy_labels).chain(found.iter().map(|(name, _)| name));
    let mut table = Table::new("rows", labels.map(|label| Column::plain(label, label)));
    for (i, Sample { wavelength_nm, n }) in samples.iter().enumerate() {
        let mut row = vec![format!("{wavelength_nm:.4}"), format!("{n:.6}")];
        if let Some(CauchyRows { a_rows, b_rows_nm2, .. }) = cauchy {
            row.extend([format!("{:.6}", a_rows[i]), format!("{:.3}", b_rows_nm2[i])]);
        }
        row.extend(found.iter().map(|(_, fit)| format!("{:+.2e}", fit.formula.index(*wavelength_nm) - n)));
        table.push(row);
    }
    if let Some(CauchyRows { a, b_nm2, .. }) = cauchy {
        let mut means = vec!["mean".to_owned(), String::new(), format!("{a:.6}"), format!("{b_nm2:.3}")];
        means.extend(found.iter().map(|(_, fit)| format!("{:.2e}", fit.mean_deviation)));
        table.push(means);
    }
    table
}
