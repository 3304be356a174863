//! `spectra spectrum`: light and matter by wavelength.

mod arguments;
mod color;
mod describe;
mod fit;
mod info;
mod list;
mod plot;

pub(crate) use arguments::SpectrumArguments;

use crate::outcome::{Failure, Outcome};
use arguments::SpectrumCommand;
use spectra_core::params::Fault;
use spectra_scene::FileResources;
use spectra_spectrum::{Emission, Found, SpectrumError, find_emission_in, find_in};
use std::path::Path;

/// Runs a command on spectra.
pub(crate) fn spectrum(command: &SpectrumCommand) -> Outcome {
    match command {
        SpectrumCommand::Info(arguments) => info::info(arguments),
        SpectrumCommand::Plot(arguments) => plot::plot(arguments),
        SpectrumCommand::Fit(arguments) => fit::fit(arguments),
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
    find_in(name, &files()).map_err(refuse)
}

fn load_illuminant(name: &str) -> Result<Emission, Failure> {
    find_emission_in(name, &files())
        .map_err(|e| Failure::Faults(e.faults(|text| Fault::new(format!("--illuminant: {text}")))))
}

fn refuse(error: SpectrumError) -> Failure {
    Failure::Faults(error.faults(Fault::new))
}
