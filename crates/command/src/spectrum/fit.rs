//! `spectra spectrum fit`: fits Gaussian terms to a spectrum.

use super::arguments::SpectrumFit;
use super::info::{on_grid, shape_of};
use super::load;
use super::local::local;
use crate::console;
use crate::outcome::{DONE, Failure, Outcome};
use serde_json::json;
use spectra_files::write_atomically;
use spectra_sheet::{Column, Sheet, Table, percent};
use spectra_spectrum::{AnySpectrum, GaussianFit, GaussianTerm, Grid, Kind, Line, fit_gaussians};
use std::fmt::Write as _;
use std::io::Write as _;
use std::path::Path;

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
        let none = || Failure::Input(format!("`{name}` has only spectral lines, which have no local Gaussian"));
        return local(arguments, at_nm, shape_of(&found).ok_or_else(none)?);
    }
    let grid = grid(&arguments.band, arguments.step.unwrap_or(1.0))?;
    if shape_of(&found).is_none() {
        let text = format!("`{name}` has only spectral lines, which are not fitted by Gaussians");
        return Err(Failure::Input(text));
    }
    let lines = if let AnySpectrum::Emission(light) = &found { light.lines() } else { &[] };
    let fit = fit_gaussians(&grid, &on_grid(&found, &grid), usize::from(arguments.terms))
        .map_err(|e| Failure::Input(format!("`{name}` cannot be fitted: {e}")))?;
    if let Some(path) = &arguments.output {
        let text = file(name, found.kind(), &grid, &fit, lines);
        write_atomically(path, |out| Ok(out.write_all(text.as_bytes())?))?;
        console::note(&format!("wrote {}", path.display()));
    }
    let smallest = fit.report.smallest;
    if smallest < 0.0 {
        let below = format!("the terms fall to {} of the peak below 0", percent(-smallest, 2));
        let then = if smallest < -0.1 {
            "this is beyond the 10 % up to which a scene counts them as 0: use more terms or another band"
        } else {
            "a scene counts them as 0 there"
        };
        console::warning(&format!("{below}; {then}"));
    }
    console::sheet(&sheet(name, found.kind(), &grid, &fit, lines.len()), arguments.report.json)?;
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

/// Returns the terms of a fit and its errors. `lines` is the number of spectral lines, which are not fitted.
fn sheet(name: &str, kind: Kind, grid: &Grid, fit: &GaussianFit, lines: usize) -> Sheet {
    let (terms, [from, to]) = (fit.mixture.terms(), [grid.start_nm, grid.end_nm()]);
    let title = format!("{name}: {}, {} Gaussian terms on {from}-{to} nm", kind.word(), terms.len());
    let mut sheet = Sheet::new(&title);
    sheet.data("name", name);
    sheet.data("kind", kind.word());
    sheet.data("band_nm", [from, to]);
    let labels = ["amplitude", "center/nm", "sigma/nm", "integral"];
    let mut table = Table::new("terms", labels.map(|label| Column::plain(label, label)));
    let mut data = Vec::new();
    for term in terms {
        let (amplitude, center, sigma) = (term.peak(), term.center_nm(), term.sigma_nm());
        let integral = term.band_integral(from, to);
        table.push([
            format!("{amplitude:.6e}"),
            format!("{center:.3}"),
            format!("{sigma:.3}"),
            format!("{integral:.6e}"),
        ]);
        data.push(json!({ "amplitude": amplitude, "center_nm": center, "sigma_nm": sigma, "integral": integral }));
    }
    sheet.show(table);
    sheet.data("terms", data);
    let errors = fit.report;
    let of_peak = |v: &f64| format!("{v:.6} of the peak");
    sheet.fact("relative_l2", "relative L2 error", Some(errors.relative_l2), |v| format!("{v:.6}"));
    sheet.fact("maximum", "largest error", Some(errors.maximum), of_peak);
    sheet.fact("integral", "error of the integral", Some(errors.integral), |v| format!("{v:+.2e}"));
    sheet.fact("smallest", "smallest value", Some(errors.smallest), of_peak);
    sheet.fact("kappa", "kappa", Some(errors.kappa), |v| {
        format!("{v:.4}  (sum |w| / |sum w|: how much the terms cancel)")
    });
    sheet.data("lines", lines);
    sheet.line("spectral lines", (lines > 0).then(|| lines.to_string()));
    sheet
}

/// Returns the terms and lines as a spectrum file for scenes, with all digits.
fn file(name: &str, kind: Kind, grid: &Grid, fit: &GaussianFit, lines: &[Line]) -> String {
    let (terms, errors) = (fit.mixture.terms(), fit.report);
    let mut out = format!(
        "# {} Gaussian terms, fitted on {}-{} nm.\n# Relative L2 error {:.6}, largest {:.6} of the peak, integral \
         {:+.2e}, kappa {:.4}.\nspectra: 1\nname: {}\nof: {}\n",
        terms.len(),
        grid.start_nm,
        grid.end_nm(),
        errors.relative_l2,
        errors.maximum,
        errors.integral,
        errors.kappa,
        json!(format!("{name}, {} Gaussian terms", terms.len())),
        kind.word()
    );
    let term = |indent: &str, t: &GaussianTerm| {
        format!("{indent}- {{amplitude: {}, center: {}, sigma: {}}}\n", t.peak(), t.center_nm(), t.sigma_nm())
    };
    if lines.is_empty() {
        out.push_str("kind: mixture\nterms:\n");
        terms.iter().for_each(|t| out.push_str(&term("  ", t)));
        return out;
    }
    out.push_str("kind: sum\nparts:\n  - kind: mixture\n    terms:\n");
    terms.iter().for_each(|t| out.push_str(&term("      ", t)));
    out.push_str("  - kind: lines\n    lines:\n");
    for line in lines {
        let _ = writeln!(out, "      - {{wavelength: {}, power: {}}}", line.wavelength_nm, line.power);
    }
    out
}
