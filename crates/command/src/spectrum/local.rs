//! `spectra spectrum fit --at`: the Gaussian that touches a spectrum at a wavelength.

use super::arguments::SpectrumFit;
use crate::console;
use crate::outcome::{DONE, Failure, Outcome};
use spectra_core::quantity::light_nm;
use spectra_sheet::Sheet;
use spectra_spectrum::{GaussianTerm, SpectralFunction};

/// Relative error up to which the Gaussian counts as close to the spectrum.
const CLOSE: f64 = 0.01;

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
    console::sheet(&sheet(arguments.name.trim(), at_nm, step_nm, shape), arguments.report.json)?;
    Ok(DONE)
}

/// Returns value, slope and curvature of a spectrum, by differences over a step to each side, and its local Gaussian.
fn sheet(name: &str, at_nm: f64, step_nm: f64, shape: &SpectralFunction) -> Sheet {
    let [below, value, above] = [-step_nm, 0.0, step_nm].map(|d| shape.at(at_nm + d));
    let slope = (above - below) / (2.0 * step_nm);
    let curvature = (above - 2.0 * value + below) / (step_nm * step_nm);
    let log_curvature = curvature / value - (slope / value) * (slope / value);
    let mut sheet = Sheet::new(&format!("{name} at {at_nm} nm"));
    sheet.data("name", name);
    sheet.data("wavelength_nm", at_nm);
    sheet.data("step_nm", step_nm);
    sheet.fact("value", "f", Some(value), |v| format!("{v:.6e}"));
    let per_nm = |v: &f64| format!("{v:.6e} per nm, by differences over {step_nm} nm to each side");
    sheet.fact("slope_per_nm", "f'", Some(slope), per_nm);
    let per_nm2 = |v: &f64| format!("{v:.6e} per nm^2");
    sheet.fact("curvature_per_nm2", "f''", Some(curvature), per_nm2);
    sheet.fact("log_curvature_per_nm2", "(ln f)''", Some(log_curvature), per_nm2);
    let term = GaussianTerm::local(at_nm, value, slope, curvature);
    let good = term.as_ref().ok();
    let figures = good.map(|term| [term.peak(), term.center_nm(), term.sigma_nm()]);
    let formula = figures
        .map(|[amplitude, center, sigma]| format!("{amplitude:.6e} exp(-(w - {center:.3})^2 / (2 * {sigma:.3}^2))"));
    let why = term.as_ref().err().map(ToString::to_string);
    sheet.line("local Gaussian", formula.or_else(|| why.clone()));
    for (i, key) in ["amplitude", "center_nm", "sigma_nm"].into_iter().enumerate() {
        sheet.data(key, figures.map(|figures| figures[i]));
    }
    sheet.fact("close_nm", "within 1 %", good.map(|term| close(shape, term, at_nm)), |[from, to]| {
        format!("from {from:.1} to {to:.1} nm")
    });
    sheet.data("none_because", why);
    sheet
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
