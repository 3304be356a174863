//! Scene values that the program writes by itself. Messages about them cannot show a place, because the user did not write them.

use spectra_core::params::{Fault, Faults, Warning};

/// Name of the generated scene, as the place of values that the user did not write.
pub(crate) const MADE: &str = "--made";

/// Returns the faults without their places, where the place is a value that the user did not write.
#[must_use]
pub fn without_generated_places(faults: Faults) -> Faults {
    faults.into_iter().map(without_made).collect::<Vec<_>>().into()
}

/// Returns a warning as it is shown: without its place if the user did not write the value there.
#[must_use]
pub fn without_generated_place(warning: &Warning) -> Warning {
    Warning(without_made(warning.0.clone()))
}

/// Returns whether a warning is about a value that the user did not write.
#[must_use]
pub fn is_generated(warning: &Warning) -> bool {
    at_made(&warning.0)
}

fn at_made(fault: &Fault) -> bool {
    fault.place.as_ref().is_some_and(|(file, _)| file.name == MADE)
}

fn without_made(fault: Fault) -> Fault {
    if at_made(&fault) { Fault { place: None, ..fault } } else { fault }
}
