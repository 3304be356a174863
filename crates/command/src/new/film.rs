//! `spectra new film`: creates a stock file based on another stock.

use super::arguments::NewFilm;
use super::written;
use crate::console;
use crate::film::stock_called;
use crate::outcome::{DONE, Outcome};
use spectra_film::stock::{Process, Stock};
use std::fmt::Write;

/// Writes the stock file and prints the next steps.
pub(super) fn film(arguments: &NewFilm) -> Outcome {
    let (like, stock) = stock_called(&arguments.like)?;
    let name = arguments.file.name.strip_suffix(".yaml").unwrap_or(&arguments.file.name);
    let path = written(name, &arguments.file.path, &text(name, &like, &stock))?;
    let figure = path.replace(".yaml", ".svg");
    console::out(&format!(
        "{path} is ready; next:\n  spectra film info {path}\n  spectra film plot {path} -o {figure}\n"
    ))?;
    Ok(DONE)
}

/// Returns the text of the file: the other stock's values that most data sheets state, to be overwritten, and further keys as comments.
fn text(name: &str, like: &str, stock: &Stock) -> String {
    let mut out = format!(
        "# A film of your own: overwrite the values that its data sheet gives, and delete the rest; values that are left out are\n\
         # those of {like}. Look at it with\n#   spectra film info {name}.yaml\n#   spectra film plot {name}.yaml -o {name}.svg\n\
         # and name it in a scene: film: {{kind: stock, stock: {name}.yaml}}. All keys: spectra doc stock\n\
         spectra: 1\nname: {name}\nlike: {like}\n"
    );
    // Writing to a String cannot fail.
    if let Some(iso) = stock.iso {
        let _ = writeln!(out, "iso: {iso}");
    }
    if stock.process != Process::Print {
        out.push_str(
            "# exposure: relative   # for a sheet with an axis of relative log exposure: the curves are slid to the speed\n\
             # granularity: {rms: 11}   # for silver film; 1000 times the standard deviation at density 1 through a 48 um aperture\n",
        );
    }
    out.push_str("layers:\n");
    for layer in &stock.layers {
        let _ = writeln!(out, "  - name: {}", layer.name);
        out.push_str(
            "    # sensitivity:\n    #   file: sensitivity.csv   # two columns: wavelength, value\n\
             \x20   #   reading: log10          # or linear\n    #   measured-under: equal-energy\n",
        );
        let Some(first) = layer.developments.first() else { continue };
        let _ = writeln!(out, "    curves:\n      - development: {}", first.name);
        if let Some(minutes) = first.minutes {
            let _ = writeln!(out, "        minutes: {minutes}");
        }
        out.push_str("        # log10 of the exposure in lux-seconds, and density\n        points:\n");
        let (low, high) = first.curve.exposure_range();
        const STEPS: usize = 16;
        for i in 0..=STEPS {
            let x = low + (high - low) * i as f64 / STEPS as f64;
            let _ = writeln!(out, "          - [{x:.2}, {:.2}]", first.curve.density(x));
        }
    }
    out
}
