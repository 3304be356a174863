//! `spectra lens compare`.

use super::arguments::LensCompare;
use super::{Setting, one_light, set};
use crate::console;
use crate::outcome::{DONE, Failure, Outcome};
use spectra_analysis::info::Comparison;
use spectra_lens::{ApertureError, Lens};

/// Shows lenses side by side.
pub(crate) fn compare(arguments: &LensCompare) -> Outcome {
    let lenses = arguments.lenses.iter().map(|name| one(arguments, name)).collect::<Result<Vec<_>, _>>()?;
    let comparison = Comparison::of(&lenses, one_light(&arguments.light));
    if arguments.json {
        console::pretty_json(&comparison)?;
    } else {
        console::out(&comparison.to_string())?;
    }
    Ok(DONE)
}

/// One of them: an f-number that it does not reach does not stop the others.
fn one(arguments: &LensCompare, name: &str) -> Result<Lens, Failure> {
    let mut lens = super::load_file(name)?;
    if let Some(f_number) = arguments.options.f_number {
        match lens.clone().at_f_number(f_number.number()) {
            Ok(stopped) => lens = stopped,
            Err(error @ ApertureError::TooFast { .. }) => lens.notes.push(format!("wide open: {error}")),
            Err(error) => return Err(super::aperture_fault(name, &error)),
        }
    }
    let rest = Setting { f_number: None, ..Setting::of(&arguments.options) };
    set(lens, name, &rest)
}
