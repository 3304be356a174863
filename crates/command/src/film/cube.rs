//! `spectra film cube`: writes a stock as a look-up table for other programs.

use super::arguments::FilmCube;
use super::{called, keys};
use crate::outcome::{DONE, Failure, Outcome};
use crate::{console, version};
use serde_json::json;
use spectra_core::params::Fault;
use spectra_darkroom::{Cube, FilmPipeline, RANDOM_COLORS};
use spectra_files::write_atomically;
use std::io::Write;
use std::path::PathBuf;

/// Writes the table, and prints its error against the film.
pub(super) fn cube(arguments: &FilmCube) -> Outcome {
    let stock = called(&arguments.stock)?;
    let output = arguments.output.clone().unwrap_or_else(|| PathBuf::from(format!("{}.cube", keys::stem(&stock))));
    // A wrong extension is reported before anything is computed.
    if !output.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("cube")) {
        let text = format!("{}: the name of a look-up table must end in .cube", output.display());
        return Err(Fault::new(text).hint("write `-o film.cube`").into());
    }
    let illuminant = keys::illuminant(&arguments.keys, &arguments.stock, &stock)?;
    let cube = Cube {
        film: FilmPipeline::of(&keys::settings(&arguments.keys, &arguments.stock, &stock), &illuminant)?,
        illuminant: illuminant.value,
        size: arguments.size as usize,
        stops: arguments.stops,
    };
    let file = cube.file(version::VERSION).map_err(Failure::of_stage)?;
    write_atomically(&output, |out| Ok(out.write_all(file.text.as_bytes())?)).map_err(Failure::from)?;
    let ([mean, p95, most], [patches, worst]) = (file.errors.colors, file.errors.reflectances);
    let left_out = ["scatter", "halation", "adjacency", "grain", "optics"];
    if arguments.report.json {
        console::pretty_json(&json!({
            "file": output.display().to_string(),
            "film": file.film,
            "size": arguments.size,
            "stops": arguments.stops,
            "illuminant": cube.illuminant,
            "left_out": left_out,
            "random_colors": { "count": RANDOM_COLORS, "mean_ciede2000": mean, "p95_ciede2000": p95, "largest_ciede2000": most },
            "colorchecker": { "mean_ciede2000": patches, "largest_ciede2000": worst },
        }))?;
        return Ok(DONE);
    }
    console::note(&format!("wrote {}", output.display()));
    console::out(&format!(
        "{}\n\
         without {}, which need a pixel's neighbors\n\
         input 0.5 + log2(x / 0.18) / {} of linear light x with sRGB primaries, output sRGB\n\
         error against the film, CIEDE2000: {RANDOM_COLORS} random colors mean {mean:.2}, 95 % below {p95:.2}, largest {most:.2}; \
         ColorChecker by measured reflectances mean {patches:.2}, largest {worst:.2}\n",
        file.film,
        left_out.join(", "),
        arguments.stops
    ))?;
    Ok(DONE)
}
