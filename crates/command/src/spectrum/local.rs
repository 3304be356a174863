//! `spectra spectrum fit --at`: the Gaussian that touches a spectrum at a wavelength.

use super::arguments::SpectrumFit;
use crate::console;
use crate::outcome::{DONE, Failure, Outcome};
use serde::Serialize;
use spectra_core::quantity::light_nm;
use spectra_spectrum::{GaussianTerm, SpectralFunction};
use std::fmt::Write as _;

/// Relative error up to which the Gaussian counts as close to the spectrum.
const CLOSE: f64 = 0.01;

/// A spectrum at a wavelength, and its local Gaussian there.
#[derive(Debug, Serialize)]
struct Report {
    name: String,
    wavelength_nm: f64,
    /// Step of the finite differences for slope and curvature.
    step_nm: f64,
    value: f64,
    slope_per_nm: f64,
    curvature_per_nm2: f64,
    /// Second derivative of the logarithm.
    log_curvature_per_nm2: f64,
    amplitude: Option<f64>,
    center_nm: Option<f64>,
    sigma_nm: Option<f64>,
    /// Range in which the Gaussian is within 1 % of the spectrum.
    close_nm: Option<[f64; 2]>,
    none_because: Option<String>,
}

/// Writes the local Gaussian of a spectrum to standard output, or the reason why there is none.
pub(super) fn local(arguments: &SpectrumFit, at_nm: f64, shape: &SpectralFunction) -> Outcome {
    // A table is linear between its points, so the step must be at least their spacing to see its curvature.
    let step_nm = arguments.step.unwrap_or_else(|| shape.spacing_nm().max(1.0));
    if !(step_nm.is_finite() && step_nm > 0.0 && step_nm <= 100.0) {
        return Err(Failure::Input(format!("--step {step_nm}: expected a step of up to 100 nm, such as 5")));
    }
    if !(at_nm.is_finite() && at_nm > step_nm && at_nm <= 1e5) {
        return Err(Failure::Input(format!("--at {at_nm}: expected a wavelength in nm, such as 550")));
    }
    light_nm(at_nm).map_err(|wrong| Failure::Input(format!("--at: {wrong}: {}", wrong.hint())))?;
    let [below, value, above] = [-step_nm, 0.0, step_nm].map(|d| shape.at(at_nm + d));
    let slope = (above - below) / (2.0 * step_nm);
    let curvature = (above - 2.0 * value + below) / (step_nm * step_nm);
    let term = GaussianTerm::local(at_nm, value, slope, curvature);
    let good = term.as_ref().ok();
    let report = Report {
        name: arguments.name.trim().to_owned(),
        wavelength_nm: at_nm,
        step_nm,
        value,
        slope_per_nm: slope,
        curvature_per_nm2: curvature,
        log_curvature_per_nm2: curvature / value - (slope / value) * (slope / value),
        amplitude: good.map(GaussianTerm::peak),
        center_nm: good.map(GaussianTerm::center_nm),
        sigma_nm: good.map(GaussianTerm::sigma_nm),
        close_nm: good.map(|term| close(shape, term, at_nm)),
        none_because: term.as_ref().err().map(ToString::to_string),
    };
    if arguments.report.json {
        console::pretty_json(&report)?;
    } else {
        console::out(&text(&report))?;
    }
    Ok(DONE)
}

/// Returns the range of wavelengths around `at_nm` in which the term is close to the spectrum, nm.
fn close(shape: &SpectralFunction, term: &GaussianTerm, at_nm: f64) -> [f64; 2] {
    const STEP_NM: f64 = 0.1;
    const FARTHEST: u32 = 5000;
    let is_close = |nm: f64| (term.at(nm) - shape.at(nm)).abs() <= CLOSE * shape.at(nm).abs();
    let reach = |direction: f64| {
        let at = |i: u32| at_nm + direction * STEP_NM * f64::from(i);
        at((1..=FARTHEST).take_while(|i| is_close(at(*i))).last().unwrap_or(0))
    };
    [reach(-1.0), reach(1.0)]
}

fn text(report: &Report) -> String {
    let mut out = format!("{} at {} nm\n\n", report.name, report.wavelength_nm);
    let mut row = |name: &str, value: String| {
        // Writing to a String cannot fail.
        let _ = writeln!(out, "  {name:<22}{value}");
    };
    row("f", format!("{:.6e}", report.value));
    row("f'", format!("{:.6e} per nm, by differences over {} nm to each side", report.slope_per_nm, report.step_nm));
    row("f''", format!("{:.6e} per nm^2", report.curvature_per_nm2));
    row("(ln f)''", format!("{:.6e} per nm^2", report.log_curvature_per_nm2));
    match (&report.none_because, report.amplitude, report.center_nm, report.sigma_nm, report.close_nm) {
        (None, Some(amplitude), Some(center), Some(sigma), Some([from, to])) => {
            row("local Gaussian", format!("{amplitude:.6e} exp(-(w - {center:.3})^2 / (2 * {sigma:.3}^2))"));
            row("within 1 %", format!("from {from:.1} to {to:.1} nm"));
        }
        (why, ..) => row("local Gaussian", why.clone().unwrap_or_else(|| "none".to_owned())),
    }
    out
}
