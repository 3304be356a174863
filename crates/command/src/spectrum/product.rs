//! `spectra spectrum product`: multiplies spectra as sums of Gaussian terms.

use super::arguments::SpectrumProduct;
use super::{files, refuse_name, tell_reading};
use crate::console;
use crate::outcome::{DONE, Failure, Outcome};
use spectra_analysis::terms::{Chain, ChainError, Scatter, figure};
use spectra_core::Isa;
use spectra_files::write_atomically;
use spectra_plot::Format;
use spectra_spectrum::{AnySpectrum, Kind, find_as_in, find_in};
use std::fmt::Write as _;
use std::io::Write as _;
use std::path::Path;

/// Multiplies spectra as sums of Gaussian terms. Shows how exact the product is, and the errors of estimates of its integral.
pub(crate) fn product(arguments: &SpectrumProduct) -> Outcome {
    for path in &arguments.output {
        if !is_csv(path) {
            Format::of(path).map_err(|e| Failure::Input(format!("{e}, or .csv for the errors as a table")))?;
        }
    }
    let grid = super::fit::grid(&arguments.band, 1.0)?;
    let mut factors = Vec::new();
    for (i, name) in arguments.names.iter().enumerate() {
        factors.push((name.trim().to_owned(), factor(name, i == 0)?));
        tell_reading(name);
    }
    let chain = Chain::new(&factors, usize::from(arguments.terms), &grid, Isa::detect()).map_err(failure)?;
    for path in &arguments.output {
        if is_csv(path) {
            let text = chain.csv();
            write_atomically(path, |out| Ok(out.write_all(text.as_bytes())?))?;
        } else {
            figure(&chain).write(path).map_err(|e| Failure::Failed(e.to_string()))?;
        }
        console::note(&format!("wrote {}", path.display()));
    }
    if arguments.report.json {
        console::pretty_json(&chain)?;
    } else {
        console::out(&text(&chain))?;
    }
    Ok(DONE)
}

fn is_csv(path: &Path) -> bool {
    path.extension().is_some_and(|e| e.eq_ignore_ascii_case("csv"))
}

/// Loads a factor. One that can be of any kind is a light if it comes first, and a filter otherwise.
fn factor(name: &str, is_first: bool) -> Result<AnySpectrum, Failure> {
    if is_first {
        return find_in(name, &files()).map_err(|error| refuse_name(name, error));
    }
    match find_as_in(name, Kind::Transmittance, &files()) {
        Err(spectra_spectrum::SpectrumError::WrongKind { .. }) => find_in(name, &files()),
        other => other,
    }
    .map_err(|error| refuse_name(name, error))
}

fn failure(error: ChainError) -> Failure {
    let hint = match &error {
        ChainError::TooMany { .. } => "; use fewer terms (--terms) or fewer factors",
        ChainError::Lines(_) => "; use a light without lines, such as D65",
        ChainError::Dark => "; use another band (--band) or other factors",
        ChainError::Fit { .. } | ChainError::Twice { .. } => "",
    };
    Failure::Input(format!("{error}{hint}"))
}

/// Formats the product of the factors as text.
fn text(chain: &Chain) -> String {
    let [from, to] = chain.band_nm;
    let width = chain.factors.iter().map(|f| f.name.chars().count()).max().unwrap_or(0).max(6);
    let mut out = format!("{} factors on {from}-{to} nm\n\n", chain.factors.len());
    // Writing to a String cannot fail.
    let _ = writeln!(
        out,
        "  {:<width$}  {:<13}  {:>5}  {:>10}  {:>12}  {:>8}",
        "factor", "kind", "terms", "L2 error", "of integral", "kappa"
    );
    for f in &chain.factors {
        let (l2, integral) = if f.exact {
            ("exact".to_owned(), "exact".to_owned())
        } else {
            (format!("{:.5}", f.relative_l2), format!("{:+.2e}", f.integral_error))
        };
        let (name, kind, terms, kappa) = (&f.name, f.kind, f.terms, f.kappa);
        let _ = writeln!(out, "  {name:<width$}  {kind:<13}  {terms:>5}  {l2:>10}  {integral:>12}  {kappa:>8.3}");
    }
    out.push('\n');
    let mut row = |name: &str, value: String| {
        let _ = writeln!(out, "  {name:<24}{value}");
    };
    row("terms of the product", chain.terms.to_string());
    row("integral, exact", format!("{:.12e}", chain.integral));
    let relative = format!("differs by {:.1e} of the sum of the terms' sizes", chain.difference);
    row("by quadrature", format!("{:.12e}  ({relative})", chain.quadrature));
    row(
        "of the spectra",
        format!("{:.12e}  (the fits change it by {:+.3} %)", chain.of_spectra, 100.0 * chain.fit_error),
    );
    row("kappa", format!("{:.4}  (sum |w| / |sum w|: how much the terms cancel)", chain.kappa));
    row(
        "one term of each",
        format!("{:.4} of the integral is the standard deviation of one sample", chain.one_term_deviation),
    );
    out.push_str("\n  relative error of the integral by samples\n");
    let _ = writeln!(
        out,
        "  {:>7}  {:>13}  {:>13}  {:>13}  {:>13}",
        "samples", "one term", "as computed", "even nm", "by 1st factor"
    );
    for Scatter { samples, one_term_measured, one_term, even, first_factor } in &chain.scatter {
        let shown = |v: f64| if v.is_finite() { format!("{v:.5}") } else { "-".to_owned() };
        let (a, b, c, d) = (shown(*one_term_measured), shown(*one_term), shown(*even), shown(*first_factor));
        let _ = writeln!(out, "  {samples:>7}  {a:>13}  {b:>13}  {c:>13}  {d:>13}");
    }
    let _ = writeln!(
        out,
        "\n  one term: follows one term of every factor, root mean square over {} seeds; as computed: its expected error\n  \
         even nm, by 1st factor: wavelengths drawn evenly, or in proportion to the first factor; expected errors",
        chain.seeds
    );
    out
}
