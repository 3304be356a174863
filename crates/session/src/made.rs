//! What the program writes into a scene by itself: a value that nobody wrote has no place to show.

use spectra_core::params::{Fault, Faults, Warning};

/// What the made scene is called where a value is nobody's.
pub(crate) const MADE: &str = "--made";

/// Faults, without the places of values that nobody wrote.
pub(crate) fn of_nobody(faults: Faults) -> Faults {
    faults.into_iter().map(without_made).collect::<Vec<_>>().into()
}

/// A warning as it is told: without the place of a value that nobody wrote.
pub(crate) fn told(warning: &Warning) -> Warning {
    Warning(without_made(warning.0.clone()))
}

/// Whether a warning stands at a value that nobody wrote.
pub(crate) fn is_made(warning: &Warning) -> bool {
    at_made(&warning.0)
}

fn at_made(fault: &Fault) -> bool {
    fault.place.as_ref().is_some_and(|(file, _)| file.name == MADE)
}

fn without_made(fault: Fault) -> Fault {
    if at_made(&fault) { Fault { place: None, ..fault } } else { fault }
}
