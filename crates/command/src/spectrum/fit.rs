//! `spectra spectrum fit`: fits Gaussian terms to a spectrum.

use super::arguments::SpectrumFit;
use super::load;
use super::local::local;
use crate::console;
use crate::outcome::{DONE, Failure, Outcome};
use serde::Serialize;
use spectra_files::write_atomically;
use spectra_spectrum::{AnySpectrum, GaussianFit, GaussianMixture, Grid, Line, fit_gaussians};
use std::fmt::Write as _;
use std::io::Write as _;
use std::path::Path;

/// A Gaussian term of the fit.
#[derive(Debug, Serialize)]
struct Term {
    amplitude: f64,
    center_nm: f64,
    sigma_nm: f64,
    /// Integral over the band.
    integral: f64,
}

/// Terms of a fit and their errors.
#[derive(Debug, Serialize)]
struct Report {
    name: String,
    kind: &'static str,
    band_nm: [f64; 2],
    terms: Vec<Term>,
    relative_l2: f64,
    maximum: f64,
    integral: f64,
    smallest: f64,
    kappa: f64,
    /// Number of spectral lines, which are not fitted; the written file lists them after the terms.
    lines: usize,
}

/// Largest number of points to fit.
const MOST_POINTS: f64 = 10_000.0;

/// Fits Gaussian terms to a spectrum, shows the quality of the fit, and writes the terms if requested.
pub(crate) fn fit(arguments: &SpectrumFit) -> Outcome {
    if let Some(path) = &arguments.output {
        yaml_ending(path)?;
    }
    let found = load(&arguments.name)?;
    let name = arguments.name.trim();
    if let Some(at_nm) = arguments.at {
        if arguments.output.is_some() {
            let text = "--at shows a Gaussian and writes no file: leave out --output".to_owned();
            return Err(Failure::Input(text));
        }
        let shape = match &found {
            AnySpectrum::Emission(light) => light.continuum(),
            AnySpectrum::Transmittance(filter) => Some(filter.shape()),
            AnySpectrum::Reflectance(surface) => Some(surface.shape()),
            AnySpectrum::Sensitivity(detector) => Some(detector.shape()),
        };
        let none = || Failure::Input(format!("`{name}` has only spectral lines, which have no local Gaussian"));
        return local(arguments, at_nm, shape.ok_or_else(none)?);
    }
    let grid = grid(&arguments.band, arguments.step.unwrap_or(1.0))?;
    let (values, lines) = match &found {
        AnySpectrum::Emission(light) if light.continuum().is_none() => {
            let text = format!("`{name}` has only spectral lines, which are not fitted by Gaussians");
            return Err(Failure::Input(text));
        }
        AnySpectrum::Emission(light) => (light.on_grid(&grid), light.lines().to_vec()),
        AnySpectrum::Transmittance(filter) => (filter.on_grid(&grid), Vec::new()),
        AnySpectrum::Reflectance(surface) => (surface.on_grid(&grid), Vec::new()),
        AnySpectrum::Sensitivity(detector) => (detector.on_grid(&grid), Vec::new()),
    };
    let fit = fit_gaussians(&grid, &values, usize::from(arguments.terms))
        .map_err(|e| Failure::Input(format!("`{name}` cannot be fitted: {e}")))?;
    let report = report(name, &found, &grid, &fit, lines.len());
    if let Some(path) = &arguments.output {
        let text = file(&report, &fit.mixture, &lines);
        write_atomically(path, |out| Ok(out.write_all(text.as_bytes())?))?;
        console::note(&format!("wrote {}", path.display()));
    }
    if report.smallest < 0.0 {
        let below = format!("the terms fall to {:.2} % of the peak below 0", -100.0 * report.smallest);
        let then = if report.smallest < -0.1 {
            "this is beyond the 10 % up to which a scene counts them as 0: use more terms or another band"
        } else {
            "a scene counts them as 0 there"
        };
        console::warning(&format!("{below}; {then}"));
    }
    if arguments.report.json {
        console::pretty_json(&report)?;
    } else {
        console::out(&text(&report))?;
    }
    Ok(DONE)
}

fn yaml_ending(path: &Path) -> Result<(), Failure> {
    match path.extension().map(|e| e.to_string_lossy().to_lowercase()).as_deref() {
        Some("yaml" | "yml") => Ok(()),
        _ => Err(Failure::Input(format!("{}: the name of a file of terms must end in .yaml", path.display()))),
    }
}

pub(super) fn grid(band: &[f64], step: f64) -> Result<Grid, Failure> {
    let [from, to] = *band else {
        return Err(Failure::Input("--band: expected two wavelengths in nm, such as 380,780".to_owned()));
    };
    let good = from.is_finite() && to.is_finite() && step.is_finite() && from > 0.0 && step > 0.0;
    if !good || to <= from || (to - from) / step > MOST_POINTS || to > 1e6 {
        let text = format!(
            "--band {from},{to} in steps of {step} nm: expected increasing wavelengths, at most {MOST_POINTS} of them"
        );
        return Err(Failure::Input(text));
    }
    // The grid has as many whole steps as fit into the band.
    let count = ((to - from) / step + 1e-9).floor() as usize + 1;
    if count < 2 {
        return Err(Failure::Input(format!("--band {from},{to} is narrower than the step of {step} nm")));
    }
    Ok(Grid { start_nm: from, step_nm: step, count })
}

fn report(name: &str, found: &AnySpectrum, grid: &Grid, fit: &GaussianFit, lines: usize) -> Report {
    let band_nm = [grid.start_nm, grid.end_nm()];
    let term = |t: &spectra_spectrum::GaussianTerm| Term {
        amplitude: t.peak(),
        center_nm: t.center_nm(),
        sigma_nm: t.sigma_nm(),
        integral: t.band_integral(band_nm[0], band_nm[1]),
    };
    let r = fit.report;
    Report {
        name: name.to_owned(),
        kind: found.kind().word(),
        band_nm,
        terms: fit.mixture.terms().iter().map(term).collect(),
        relative_l2: r.relative_l2,
        maximum: r.maximum,
        integral: r.integral,
        smallest: r.smallest,
        kappa: r.kappa,
        lines,
    }
}

/// Formats the report as text.
fn text(report: &Report) -> String {
    let [from, to] = report.band_nm;
    let mut out =
        format!("{}: {}, {} Gaussian terms on {from}-{to} nm\n\n", report.name, report.kind, report.terms.len());
    // Writing to a String cannot fail.
    let _ = writeln!(out, "  {:>13}  {:>10}  {:>10}  {:>13}", "amplitude", "center/nm", "sigma/nm", "integral");
    for t in &report.terms {
        let _ = writeln!(
            out,
            "  {:>13.6e}  {:>10.3}  {:>10.3}  {:>13.6e}",
            t.amplitude, t.center_nm, t.sigma_nm, t.integral
        );
    }
    out.push('\n');
    let mut row = |name: &str, value: String| {
        let _ = writeln!(out, "  {name:<24}{value}");
    };
    row("relative L2 error", format!("{:.6}", report.relative_l2));
    row("largest error", format!("{:.6} of the peak", report.maximum));
    row("error of the integral", format!("{:+.2e}", report.integral));
    row("smallest value", format!("{:.6} of the peak", report.smallest));
    row("kappa", format!("{:.4}  (sum |w| / |sum w|: how much the terms cancel)", report.kappa));
    if report.lines > 0 {
        row("spectral lines", report.lines.to_string());
    }
    out
}

/// Returns the terms and lines as a spectrum file for scenes, with all digits.
fn file(report: &Report, mixture: &GaussianMixture, lines: &[Line]) -> String {
    let [from, to] = report.band_nm;
    let mut out = format!(
        "# {} Gaussian terms, fitted on {from}-{to} nm.\n# Relative L2 error {:.6}, largest {:.6} of the peak, integral \
         {:+.2e}, kappa {:.4}.\nspectra: 1\nname: {}\nof: {}\n",
        mixture.terms().len(),
        report.relative_l2,
        report.maximum,
        report.integral,
        report.kappa,
        quoted(&format!("{}, {} Gaussian terms", report.name, mixture.terms().len())),
        report.kind
    );
    let term = |indent: &str, t: &spectra_spectrum::GaussianTerm| {
        format!("{indent}- {{amplitude: {}, center: {}, sigma: {}}}\n", t.peak(), t.center_nm(), t.sigma_nm())
    };
    if lines.is_empty() {
        out.push_str("kind: mixture\nterms:\n");
        mixture.terms().iter().for_each(|t| out.push_str(&term("  ", t)));
        return out;
    }
    out.push_str("kind: sum\nparts:\n  - kind: mixture\n    terms:\n");
    mixture.terms().iter().for_each(|t| out.push_str(&term("      ", t)));
    out.push_str("  - kind: lines\n    lines:\n");
    for line in lines {
        let _ = writeln!(out, "      - {{wavelength: {}, power: {}}}", line.wavelength_nm, line.power);
    }
    out
}

/// Returns a text in double quotes, valid in YAML and JSON.
fn quoted(text: &str) -> String {
    serde_json::Value::String(text.to_owned()).to_string()
}
