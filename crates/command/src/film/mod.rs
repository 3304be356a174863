//! `spectra film`: shows the data of film stocks, and develops pictures on them.

mod arguments;
mod cube;
mod develop;
mod figure;
mod info;
mod keys;
mod lamp;
mod pictures;

pub(crate) use arguments::FilmArguments;

use crate::console;
use crate::formatting::figure_of;
use crate::outcome::{DONE, Failure, Outcome};
use arguments::{FilmCommand, FilmPlot};
use spectra_core::names::nearest;
use spectra_core::params::Fault;
use spectra_core::{Isa, names};
use spectra_film::stock::Stock;
use spectra_plot::{Format, PlotError};
use spectra_scene::bundled::{Bundled, camera_films, other_kind};
use spectra_scene::{FileResources, other_films};
use std::path::Path;
use std::time::Instant;

/// Runs a command on film stocks.
pub(crate) fn film(command: &FilmCommand, isa: Isa, started: Instant) -> Outcome {
    match command {
        FilmCommand::Info(arguments) => info::info(arguments),
        FilmCommand::Plot(arguments) => plot(arguments),
        FilmCommand::Lamp(arguments) => lamp::lamp(arguments),
        FilmCommand::Cube(arguments) => cube::cube(arguments),
        FilmCommand::Develop(arguments) => develop::develop(arguments, isa, started),
    }
}

/// Loads a stock from a file or a bundled stock.
fn load(name: &str) -> Result<Stock, Failure> {
    Ok(Stock::load(&called(name)?, &FileResources::beside(Path::new("")))?)
}

/// Returns the full name of a stock, or its file, together with the loaded stock.
pub(crate) fn stock_called(name: &str) -> Result<(String, Stock), Failure> {
    Ok((called(name)?, load(name)?))
}

/// Returns the file, or the full name of the bundled stock, that `name` stands for. Fails with a hint if there is none.
pub(crate) fn called(name: &str) -> Result<String, Failure> {
    let is_file = name.ends_with(".yaml") || name.ends_with(".yml") || name.contains(['/', '\\']);
    let found = if is_file { Ok(name.to_owned()) } else { Bundled::Stock.find(name) };
    found.map_err(|several| {
        let known = Bundled::Stock.names();
        let all = Bundled::Stock.listed_by();
        let hint = match nearest(name, known.iter().map(String::as_str)) {
            _ if !several.is_empty() => format!("which one? {}", names::listed(&several, all)),
            Some(near) => format!("did you mean `{near}`?"),
            None if name.ends_with(".csv") => table_hint(name),
            None => other_kind(name, Bundled::Stock).unwrap_or_else(|| other_films(name, &camera_films())),
        };
        Fault::new(format!("no film stock is called `{name}`")).hint(hint).into()
    })
}

/// Returns a hint for a table (`.csv`) that was given as a stock.
fn table_hint(name: &str) -> String {
    let stem = Path::new(name).file_stem().map_or_else(String::new, |stem| stem.to_string_lossy().into_owned());
    format!(
        "a table is part of a stock file: `spectra new film {stem}` writes one, whose layers use it by `sensitivity: {{file: {name}}}`"
    )
}

fn plot(arguments: &FilmPlot) -> Outcome {
    let output = &arguments.output.clone().unwrap_or_else(|| figure_of(&arguments.name));
    // A wrong extension is reported before anything is computed.
    Format::of(output).map_err(failure)?;
    let stock = load(&arguments.name)?;
    figure::sheet(&stock).write(output).map_err(failure)?;
    console::note(&format!("wrote {}", output.display()));
    Ok(DONE)
}

fn failure(error: PlotError) -> Failure {
    match error {
        PlotError::Ending { .. } => Failure::Input(error.to_string()),
        PlotError::Write(error) => error.into(),
    }
}
