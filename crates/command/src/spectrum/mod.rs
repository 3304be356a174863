//! `spectra spectrum`: inspects spectra of light, filters, surfaces and detectors.

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
use spectra_spectrum::{AnySpectrum, Emission, Kind, SpectrumError, find_as_in, find_emission_in, find_in, notes_in};
use std::path::Path;

/// Runs one of the commands of `spectra spectrum`.
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

/// Returns resources that find files relative to the working folder.
fn files() -> FileResources {
    FileResources::beside(Path::new(""))
}

fn load(name: &str) -> Result<AnySpectrum, Failure> {
    find_in(name, &files()).map_err(|error| refuse_name(name, error))
}

/// Loads a spectrum as the kind given by `--as`, or as its own kind if none is given.
fn load_as(name: &str, kind: Option<KindName>) -> Result<AnySpectrum, Failure> {
    let Some(kind) = kind else { return load(name) };
    let kind = match kind {
        KindName::Emission => Kind::Emission,
        KindName::Transmittance => Kind::Transmittance,
        KindName::Reflectance => Kind::Reflectance,
        KindName::Sensitivity => Kind::Sensitivity,
    };
    find_as_in(name, kind, &files()).map_err(|error| refuse_name(name, error))
}

/// Reports how a table was interpreted if it is not in the format of the bundled ones.
fn tell_reading(name: &str) {
    let notes = notes_in(name, &files());
    if !notes.is_empty() {
        console::note(&format!("{}: {}", name.trim(), notes.join(", ")));
    }
}

/// Converts the error for an unknown spectrum. If the name is that of something else, the hint says so.
fn refuse_name(name: &str, error: SpectrumError) -> Failure {
    let other = match &error {
        SpectrumError::Unknown { candidates, .. } => {
            // Names of glasses are short, so a spectrum with a similar name is the likelier one.
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
