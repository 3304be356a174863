//! `spectra glass fit`: fits dispersion formulas to tables.

use super::arguments::{GlassFit, Model};
use super::read;
use crate::console;
use crate::outcome::{DONE, Failure, Outcome};
use serde::Serialize;
use serde_json::{Map, Value};
use spectra_analysis::figure::{FittedCurve, glass_fit};
use spectra_core::params::Fault;
use spectra_files::write_atomically;
use spectra_glass::Formula;
use spectra_glass::fit::{
    Fit, FitError, NamedSamples, Sample, cauchy_by_rows, cauchy_least_squares, conrady_least_squares,
    herzberger_least_squares, read_csv, schott_least_squares, sellmeier_least_squares,
};
use spectra_plot::{Format, PlotError};
use std::fmt::Write;
use std::io::Write as _;
use std::path::{Path, PathBuf};

/// The fits of one material.
#[derive(Debug, Serialize)]
struct Report {
    material: Option<String>,
    samples: usize,
    /// Shortest and longest wavelength.
    range_nm: [f64; 2],
    fits: Vec<FitReport>,
    #[serde(skip)]
    rows: Vec<Sample>,
}

/// Fit of one formula.
#[derive(Debug, Serialize)]
struct FitReport {
    /// Name of the formula as in `--model`.
    model: &'static str,
    /// Formula of n as a function of the wavelength L in micrometers.
    formula: &'static str,
    /// Coefficients by name; for wavelengths in nm if the name says so, in micrometers otherwise.
    #[serde(skip_serializing_if = "Map::is_empty")]
    coefficients: Map<String, Value>,
    mean_deviation: Option<f64>,
    rms_deviation: Option<f64>,
    max_deviation: Option<f64>,
    /// Reason why there are no coefficients.
    #[serde(skip_serializing_if = "Option::is_none")]
    error: Option<String>,
    #[serde(skip)]
    shown: Vec<(String, f64)>,
    /// Index of the formula minus that of the row, for each row.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    deviations: Vec<f64>,
    #[serde(skip)]
    found: Option<Formula>,
    /// Cauchy's A and B (nm^2) of each row, if the formula is their mean.
    #[serde(skip)]
    by_rows: Option<(Vec<f64>, Vec<f64>)>,
}

/// Fits formulas to the materials of a table, writes the requested files, and prints the results.
pub(crate) fn fit(arguments: &GlassFit) -> Outcome {
    if let Some(plot) = &arguments.plot {
        // A wrong extension is reported before anything is read.
        Format::of(plot).map_err(not_drawn)?;
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
        let fault = Fault::new(format!(
            "{name}: the table holds {} materials, but -o and --plot take only one",
            materials.len()
        ));
        return Err(fault
            .hint(format!(
                "name one, such as `{name}#{}`; there are {}",
                named.first().unwrap_or(&""),
                named.join(", ")
            ))
            .into());
    }
    let models =
        if arguments.models.is_empty() { vec![Model::Cauchy, Model::CauchyLs] } else { arguments.models.clone() };
    let reports: Vec<Report> = materials.iter().map(|m| report(m, &models, arguments.terms)).collect();
    let failed = |r: &Report| r.fits.iter().any(|f| f.error.is_some());
    if let (Some(report), false) = (reports.first().filter(|_| alone), reports.iter().any(failed)) {
        write_files(arguments, &file, report)?;
    }
    if arguments.json {
        console::pretty_json(&reports)?;
    } else {
        console::out(&reports.iter().map(|report| show(report, arguments.rows)).collect::<Vec<_>>().join("\n"))?;
    }
    match reports.iter().find(|r| failed(r)) {
        None => Ok(DONE),
        Some(report) => {
            let of = report.material.as_ref().map_or(String::new(), |m| format!(" of {m}"));
            let text = report.fits.iter().find_map(|f| Some(format!("{}: {}", f.model, f.error.as_ref()?)));
            Err(Failure::Input(format!("{name}: no fit{of} by {}", text.unwrap_or_default())))
        }
    }
}

/// Splits FILE#MATERIAL into the file and the material. A path that exists, even with a `#`, is the file itself.
fn one_of(path: &Path) -> (PathBuf, Option<String>) {
    let text = path.to_string_lossy();
    match text.rsplit_once('#') {
        Some((file, material)) if !path.exists() => (PathBuf::from(file), Some(material.trim().to_owned())),
        _ => (path.to_owned(), None),
    }
}

fn is_yaml(path: &Path) -> bool {
    path.extension().is_some_and(|e| e.eq_ignore_ascii_case("yaml") || e.eq_ignore_ascii_case("yml"))
}

fn not_drawn(error: PlotError) -> Failure {
    match error {
        PlotError::Ending { .. } => Failure::Input(error.to_string()),
        PlotError::Write(error) => error.into(),
    }
}

/// Writes the glass file and the figure, if requested.
fn write_files(arguments: &GlassFit, file: &Path, report: &Report) -> Result<(), Failure> {
    let stem = file.file_stem().map_or_else(|| "glass".to_owned(), |stem| stem.to_string_lossy().into_owned());
    let called = report.material.clone().unwrap_or(stem);
    if let (Some(output), Some(fit)) = (&arguments.output, report.fits.first()) {
        let text = glass_file(&called, &file.display().to_string(), report, fit);
        write_atomically(output, |out| Ok(out.write_all(text.as_bytes())?))?;
        console::note(&format!("wrote {}", output.display()));
    }
    if let Some(plot) = &arguments.plot {
        const POINTS: usize = 300;
        let [from, to] = report.range_nm;
        let at = |i: usize| from + (to - from) * i as f64 / POINTS as f64;
        let curve = |fit: &FitReport| {
            let formula = fit.found.as_ref()?;
            let points = (0..=POINTS).map(|i| [at(i), formula.index(at(i))]).collect();
            Some(FittedCurve { name: fit.model.to_owned(), points, deviations: fit.deviations.clone() })
        };
        let curves: Vec<FittedCurve> = report.fits.iter().filter_map(curve).collect();
        let measured: Vec<[f64; 2]> = report.rows.iter().map(|row| [row.wavelength_nm, row.n]).collect();
        let canvas = glass_fit(&format!("{called}: fitted dispersion"), &measured, &curves);
        canvas.write(plot).map_err(not_drawn)?;
        console::note(&format!("wrote {}", plot.display()));
    }
    Ok(())
}

/// Returns the text of a glass file with the fit, with all digits. Cauchy's coefficients are in nm, as usual in tables.
fn glass_file(called: &str, from: &str, report: &Report, fit: &FitReport) -> String {
    let quoted = |text: &str| Value::String(text.to_owned()).to_string();
    let formula = match fit.model {
        "cauchy" | "cauchy-ls" => "cauchy",
        "sellmeier" => "sellmeier-1",
        other => other,
    };
    let is_cauchy = formula == "cauchy";
    let mut micrometers = fit.found.as_ref().map(Formula::coefficients).unwrap_or_default();
    if fit.model == "sellmeier" {
        // Fits with one and two terms include a constant, which is 0. The form with three terms takes them without it, padded with zeros.
        if micrometers.len() % 2 == 1 {
            micrometers.remove(0);
        }
        micrometers.resize(6, 0.0);
    }
    let numbers: Vec<f64> = if is_cauchy { fit.shown.iter().map(|(_, v)| *v).collect() } else { micrometers };
    let numbers: Vec<String> = numbers.iter().map(f64::to_string).collect();
    let [from_nm, to_nm] = report.range_nm;
    let deviation = |d: Option<f64>| d.unwrap_or(f64::NAN);
    format!(
        "# {}\n# Deviation from {} rows: mean {:.2e}, rms {:.2e}, largest {:.2e}.\nspectra: 1\nname: {}\nsource: {}\n\
         formula: {formula}\n{}coefficients: [{}]\nrange: [{from_nm} nm, {to_nm} nm]\n",
        fit.formula,
        report.samples,
        deviation(fit.mean_deviation),
        deviation(fit.rms_deviation),
        deviation(fit.max_deviation),
        quoted(called),
        quoted(&format!("fitted to {from}")),
        if is_cauchy { "unit: nm\n" } else { "" },
        numbers.join(", "),
    )
}

fn report(material: &NamedSamples, models: &[Model], terms: Option<u8>) -> Report {
    let wavelengths = || material.samples.iter().map(|s| s.wavelength_nm);
    Report {
        material: material.name.clone(),
        samples: material.samples.len(),
        range_nm: [wavelengths().fold(f64::INFINITY, f64::min), wavelengths().fold(0.0, f64::max)],
        fits: models.iter().map(|model| one(*model, &material.samples, terms.map(usize::from))).collect(),
        rows: material.samples.clone(),
    }
}

fn one(model: Model, samples: &[Sample], terms: Option<usize>) -> FitReport {
    let (name, formula) = describe(model);
    let mut report = FitReport {
        model: name,
        formula,
        coefficients: Map::new(),
        mean_deviation: None,
        rms_deviation: None,
        max_deviation: None,
        error: None,
        shown: Vec::new(),
        deviations: Vec::new(),
        found: None,
        by_rows: None,
    };
    let result: Result<Fit, FitError> = match model {
        Model::Cauchy => cauchy_by_rows(samples).map(|rows| {
            report.coefficients.insert("b_rows_nm2".into(), rows.b_rows_nm2.clone().into());
            report.coefficients.insert("a_rows".into(), rows.a_rows.clone().into());
            report.by_rows = Some((rows.a_rows, rows.b_rows_nm2));
            rows.fit
        }),
        Model::CauchyLs => cauchy_least_squares(samples, terms.unwrap_or(2)),
        Model::Sellmeier => sellmeier_least_squares(samples, terms.unwrap_or(3)),
        Model::Conrady => conrady_least_squares(samples),
        Model::Schott => schott_least_squares(samples),
        Model::Herzberger => herzberger_least_squares(samples),
    };
    match result {
        Ok(fit) => {
            report.shown = named(model, &fit.formula.coefficients());
            for (name, value) in &report.shown {
                report.coefficients.insert(name.clone(), (*value).into());
            }
            report.mean_deviation = Some(fit.mean_deviation);
            report.rms_deviation = Some(fit.rms_deviation);
            report.max_deviation = Some(fit.max_deviation);
            report.deviations = samples.iter().map(|s| fit.formula.index(s.wavelength_nm) - s.n).collect();
            report.found = Some(fit.formula);
        }
        Err(error) => report.error = Some(error.to_string()),
    }
    report
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

/// Formats the rows: wavelength, index, Cauchy's A and B, and the deviation of each formula.
fn show_rows(report: &Report) -> String {
    let by_rows = report.fits.iter().find_map(|fit| fit.by_rows.as_ref());
    let mut out = format!("\n  {:>10}  {:>9}", "nm", "n");
    // Writing to a String cannot fail.
    if by_rows.is_some() {
        let _ = write!(out, "  {:>10}  {:>12}", "A", "B / nm^2");
    }
    let fits = || report.fits.iter().filter(|fit| !fit.deviations.is_empty());
    fits().for_each(|fit| {
        let _ = write!(out, "  {:>10}", fit.model);
    });
    out.push('\n');
    let mut means = (0.0, 0.0);
    for (i, row) in report.rows.iter().enumerate() {
        let _ = write!(out, "  {:>10.4}  {:>9.6}", row.wavelength_nm, row.n);
        if let Some((a, b)) = by_rows {
            let _ = write!(out, "  {:>10.6}  {:>12.3}", a[i], b[i]);
            means = (means.0 + a[i], means.1 + b[i]);
        }
        fits().for_each(|fit| {
            let _ = write!(out, "  {:>+10.2e}", fit.deviations[i]);
        });
        out.push('\n');
    }
    if by_rows.is_some() {
        let count = report.rows.len().max(1) as f64;
        let _ = write!(out, "  {:>10}  {:>9}  {:>10.6}  {:>12.3}", "mean", "", means.0 / count, means.1 / count);
        fits().for_each(|fit| {
            let _ = write!(out, "  {:>10.2e}", fit.mean_deviation.unwrap_or(f64::NAN));
        });
        out.push('\n');
    }
    out
}

fn show(report: &Report, rows: bool) -> String {
    let material = report.material.as_deref().unwrap_or("samples");
    let [from, to] = report.range_nm;
    let mut out = format!("{material}: {} rows, {from} to {to} nm\n", report.samples);
    // Writing to a String cannot fail.
    for fit in &report.fits {
        let _ = writeln!(out, "  {:<11} {}", fit.model, fit.formula);
        if let Some(error) = &fit.error {
            let _ = writeln!(out, "    none: {error}");
            continue;
        }
        for (name, value) in &fit.shown {
            let (name, unit) = match name.split_once('_') {
                Some((name, "um2")) => (name.to_uppercase(), " um^2".to_owned()),
                Some((name, unit)) => (name.to_uppercase(), unit.replacen("nm", " nm^", 1)),
                None => (name.to_uppercase(), String::new()),
            };
            let _ = writeln!(out, "    {name:<4} {value:>16.9}{unit}");
        }
        let deviation = |d: Option<f64>| d.unwrap_or(f64::NAN);
        let _ = writeln!(
            out,
            "    deviation: mean {:.2e}, rms {:.2e}, largest {:.2e}",
            deviation(fit.mean_deviation),
            deviation(fit.rms_deviation),
            deviation(fit.max_deviation)
        );
    }
    if rows {
        out.push_str(&show_rows(report));
    }
    out
}
