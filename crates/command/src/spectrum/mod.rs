//! `spectra spectrum`: light and matter by wavelength.

mod arguments;
mod color;
mod describe;
mod draw;
mod fit;
mod info;
mod list;
mod local;
mod plot;
mod product;

pub(crate) use arguments::SpectrumArguments;

use crate::console;
use crate::outcome::{Failure, Outcome};
use arguments::{KindName, SpectrumCommand};
use spectra_core::params::Fault;
use spectra_scene::FileResources;
use spectra_scene::bundled::{Bundled, meanings, other_kind};
use spectra_spectrum::{Emission, Found, Kind, SpectrumError, find_as_in, find_emission_in, find_in, notes_in};
use std::path::Path;

/// Runs a command on spectra.
pub(crate) fn spectrum(command: &SpectrumCommand) -> Outcome {
    match command {
        SpectrumCommand::Info(arguments) => info::info(arguments),
        SpectrumCommand::Plot(arguments) => plot::plot(arguments),
        SpectrumCommand::Fit(arguments) => fit::fit(arguments),
        SpectrumCommand::Product(arguments) => product::product(arguments),
        SpectrumCommand::Draw(arguments) => draw::draw(arguments),
        SpectrumCommand::Color(arguments) => color::color(arguments),
        SpectrumCommand::Models(arguments) => color::measure(arguments),
        SpectrumCommand::List(arguments) => list::list(arguments),
    }
}

/// Files are named from the working directory.
fn files() -> FileResources {
    FileResources::beside(Path::new(""))
}

fn load(name: &str) -> Result<Found, Failure> {
    find_in(name, &files()).map_err(|error| refuse_name(name, error))
}

/// As what it is said to be on the command line, if anything is.
fn load_as(name: &str, kind: Option<KindName>) -> Result<Found, Failure> {
    let Some(kind) = kind else { return load(name) };
    let kind = match kind {
        KindName::Emission => Kind::Emission,
        KindName::Transmittance => Kind::Transmittance,
        KindName::Reflectance => Kind::Reflectance,
        KindName::Sensitivity => Kind::Sensitivity,
    };
    find_as_in(name, kind, &files()).map_err(|error| refuse_name(name, error))
}

/// Says what was made of a table that is not written as the bundled ones are.
fn tell_reading(name: &str) {
    let notes = notes_in(name, &files());
    if !notes.is_empty() {
        console::note(&format!("{}: {}", name.trim(), notes.join(", ")));
    }
}

/// A name that is no spectrum's may be that of something else.
fn refuse_name(name: &str, error: SpectrumError) -> Failure {
    let other = match &error {
        SpectrumError::Unknown { candidates, .. } => {
            // Names of glasses are short: a near spectrum is the likelier one.
            let is_glass = meanings(name).first().is_some_and(|(kind, _)| *kind == Bundled::Glass);
            other_kind(name, Bundled::Spectrum).filter(|_| candidates.is_empty() || !is_glass)
        }
        _ => None,
    };
    match other {
        Some(hint) => Failure::Faults(Fault::new(format!("no spectrum is called `{name}`")).hint(hint).into()),
        None => refuse(error),
    }
}

fn load_illuminant(name: &str) -> Result<Emission, Failure> {
    find_emission_in(name, &files())
        .map_err(|e| Failure::Faults(e.faults(|text| Fault::new(format!("--illuminant: {text}")))))
}

fn refuse(error: SpectrumError) -> Failure {
    Failure::Faults(error.faults(Fault::new))
}
