//! `spectra glass fit`.

use super::arguments::{GlassFit, Model};
use super::read;
use crate::console;
use crate::outcome::{DONE, Failure, Outcome};
use serde::Serialize;
use serde_json::{Map, Value};
use spectra_glass::fit::{
    Fit, FitError, NamedSamples, Sample, cauchy_by_rows, cauchy_least_squares, conrady_least_squares,
    herzberger_least_squares, read_csv, schott_least_squares, sellmeier_least_squares,
};
use std::fmt::Write;

/// The fits of one material.
#[derive(Debug, Serialize)]
struct Report {
    material: Option<String>,
    samples: usize,
    /// First and last wavelength.
    range_nm: [f64; 2],
    fits: Vec<FitReport>,
}

/// One formula.
#[derive(Debug, Serialize)]
struct FitReport {
    /// As `--model` has it.
    model: &'static str,
    /// n as a function of the wavelength L in micrometres.
    formula: &'static str,
    /// By name; wavelengths in nm where the name says so, in micrometres otherwise.
    #[serde(skip_serializing_if = "Map::is_empty")]
    coefficients: Map<String, Value>,
    mean_deviation: Option<f64>,
    rms_deviation: Option<f64>,
    max_deviation: Option<f64>,
    /// Why there are no coefficients.
    #[serde(skip_serializing_if = "Option::is_none")]
    error: Option<String>,
    #[serde(skip)]
    shown: Vec<(String, f64)>,
}

/// Fits formulas to tables.
pub(crate) fn fit(arguments: &GlassFit) -> Outcome {
    let name = arguments.file.display().to_string();
    let bytes = read(&arguments.file)?;
    let text = String::from_utf8_lossy(&bytes);
    let materials = read_csv(&text).map_err(|e| Failure::Input(format!("{name}:{}: {}", e.line, e.message)))?;
    let models =
        if arguments.models.is_empty() { vec![Model::Cauchy, Model::CauchyLs] } else { arguments.models.clone() };
    let reports: Vec<Report> = materials.iter().map(|m| report(m, &models, arguments.terms)).collect();
    if arguments.json {
        console::pretty_json(&reports)?;
    } else {
        console::out(&reports.iter().map(show).collect::<Vec<_>>().join("\n"))?;
    }
    let failed = |r: &Report| r.fits.iter().any(|f| f.error.is_some());
    match reports.iter().find(|r| failed(r)) {
        None => Ok(DONE),
        Some(report) => {
            let of = report.material.as_ref().map_or(String::new(), |m| format!(" of {m}"));
            let text = report.fits.iter().find_map(|f| Some(format!("{}: {}", f.model, f.error.as_ref()?)));
            Err(Failure::Input(format!("{name}: no fit{of} by {}", text.unwrap_or_default())))
        }
    }
}

fn report(material: &NamedSamples, models: &[Model], terms: Option<u8>) -> Report {
    let wavelengths = || material.samples.iter().map(|s| s.wavelength_nm);
    Report {
        material: material.name.clone(),
        samples: material.samples.len(),
        range_nm: [wavelengths().fold(f64::INFINITY, f64::min), wavelengths().fold(0.0, f64::max)],
        fits: models.iter().map(|model| one(*model, &material.samples, terms.map(usize::from))).collect(),
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
    };
    let result: Result<Fit, FitError> = match model {
        Model::Cauchy => cauchy_by_rows(samples).map(|rows| {
            report.coefficients.insert("b_rows_nm2".into(), rows.b_rows_nm2.clone().into());
            report.coefficients.insert("a_rows".into(), rows.a_rows.clone().into());
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

/// The coefficients with their names. Cauchy's are those of wavelengths in nm, as tables have them.
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
            // One and two terms come with the constant of their form, which is 0.
            let c = if c.len() % 2 == 1 { &c[1..] } else { c };
            let name =
                |k: usize| if k.is_multiple_of(2) { format!("k{}", k / 2 + 1) } else { format!("m{}_um2", k / 2 + 1) };
            c.iter().enumerate().map(|(k, v)| (name(k), *v)).collect()
        }
        Model::Schott => c.iter().enumerate().map(|(k, v)| (format!("a{k}"), *v)).collect(),
        Model::Conrady | Model::Herzberger => c.iter().zip(LETTERS).map(|(v, name)| (name.to_owned(), *v)).collect(),
    }
}

fn show(report: &Report) -> String {
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
    out
}
