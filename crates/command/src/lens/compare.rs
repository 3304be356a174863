//! `spectra lens compare`: compares lenses side by side.

use super::arguments::LensCompare;
use super::{LensRequest, one_light, set};
use crate::console;
use crate::outcome::{DONE, Failure, Outcome};
use spectra_analysis::info::Comparison;
use spectra_optics::{ApertureError, Optics, stop_down};

/// Writes the comparison of lenses to standard output, as a table or JSON.
pub(crate) fn compare(arguments: &LensCompare) -> Outcome {
    let lenses = arguments.lenses.iter().map(|name| one(arguments, name)).collect::<Result<Vec<_>, _>>()?;
    let comparison = Comparison::of(&lenses, one_light(&arguments.light));
    console::sheet(&comparison.sheet(), arguments.report.json)?;
    Ok(DONE)
}

/// Loads one of the lenses. A lens that cannot reach the f-number stays wide open, with a note, and does not stop the comparison.
fn one(arguments: &LensCompare, name: &str) -> Result<Optics, Failure> {
    let mut lens = super::load_file(name)?;
    if let Some(f_number) = arguments.options.f_number {
        match stop_down(lens.clone(), f_number.number()) {
            Ok(stopped) => lens = stopped,
            Err(error @ ApertureError::TooFast { .. }) => lens.notes.push(format!("wide open: {error}")),
            Err(error) => return Err(super::aperture_fault(name, &error)),
        }
    }
    let rest = LensRequest { f_number: None, ..LensRequest::of(&arguments.options) };
    set(lens, name, &rest).map(Optics::new)
}
