//! `spectra lens info`: shows the data of a lens.

use super::arguments::LensInfo;
use super::{load, one_light};
use crate::outcome::{DONE, Failure, Outcome};
use crate::{console, limits};
use spectra_analysis::AnalysisLight;
use spectra_analysis::glare::{GlareTask, glare};
use spectra_analysis::info::LensReport;
use spectra_glass::Medium;
use spectra_optics::Optics;
use spectra_scene::stop_hint_of;
use spectra_session::Threads;

/// Writes the report on a lens to standard output, as text or JSON.
pub(crate) fn info(arguments: &LensInfo) -> Outcome {
    let lens = load(&arguments.setting)?;
    let light = one_light(&arguments.light).unwrap_or(AnalysisLight::Wavelength(lens.reference_nm));
    if let Some(nm) = light.wavelength_nm() {
        let none = |n: f64| !(n.is_finite() && n > 0.0);
        if let Some(medium) = lens.media.iter().find(|medium| none(medium.medium.index(nm))) {
            return Err(Failure::Input(format!("{} has no refractive index at {nm} nm", medium.label)));
        }
    }
    let mut report = LensReport::of(&lens, light);
    if let Some(height) = arguments.image_height {
        let farthest = |mm: f64| {
            let reason = match mm > 0.0 {
                true => format!("the field of the lens ends at {mm:.2} mm"),
                false => format!("without a stop there are no chief rays: {}", stop_hint_of(&arguments.setting.lens)),
            };
            Failure::Input(format!("{}: --image-height: {reason}", arguments.setting.lens))
        };
        report = report.to_image_height(&lens, light, height.mm()).map_err(farthest)?;
    }
    report.every_mount = arguments.mounts;
    report.notes.extend(light.wavelength_nm().map(|nm| extrapolated(&lens, nm)).unwrap_or_default());
    if let Some((medium, lender, stops)) = lens.darkened_by_assumption() {
        let by = lender.full_name;
        report.notes.push(format!(
            "the absorption of {medium} is not known; that of {by} is assumed, which darkens the lens by {stops:.1} stops \
             at {:.0} nm (`--absorption false` leaves out absorption)",
            lens.reference_nm
        ));
    }
    report.notes.extend(no_stop(&lens, &arguments.setting.lens));
    if arguments.glare {
        let mut task = GlareTask::new(light.wavelength_nm().unwrap_or(lens.reference_nm));
        task.matter.paint = arguments.paint.unwrap_or(task.matter.paint);
        task.matter.imager = arguments.film_reflectance.unwrap_or(task.matter.imager);
        let found = glare(&lens, &task, &Threads(limits::processors()));
        report.glare = Some(found.map_err(|e| Failure::Input(format!("{}: --glare: {e}", arguments.setting.lens)))?);
    }
    console::sheet(&report.sheet(), arguments.report.json)?;
    Ok(DONE)
}

/// Range of wavelengths in nm, from the line h to the line r. Within it, glasses with the same index and Abbe number have nearly
/// the same dispersion.
const MODEL_NM: std::ops::RangeInclusive<f64> = 404.0..=707.0;

/// Returns a note for each medium whose index at a wavelength (nm) is extrapolated.
fn extrapolated(lens: &Optics, nm: f64) -> Vec<String> {
    let mut notes = Vec::new();
    for medium in &lens.media {
        let label = &medium.label;
        let note = match (medium.medium.range_nm(), &medium.medium) {
            (Some((from, to)), _) if !(from..=to).contains(&nm) => {
                format!("{label} was measured from {from:.0} to {to:.0} nm: its index at {nm} nm is extrapolated")
            }
            (None, Medium::Model(_)) if !MODEL_NM.contains(&nm) => {
                format!("{label} is known only by an index and an Abbe number: its index at {nm} nm is extrapolated")
            }
            _ => continue,
        };
        if !notes.contains(&note) {
            notes.push(note);
        }
    }
    notes
}

/// Returns a note for a lens without a stop: what is assumed, and what to add to its file. `None` for a lens with a stop, and for one
/// without power, such as a prism or a grating.
fn no_stop(lens: &Optics, name: &str) -> Option<String> {
    if lens.stop().is_some() || !lens.first_order(lens.reference_nm).efl_mm.is_finite() {
        return None;
    }
    let limit = match lens.axial_rim() {
        Some(rim) => {
            format!("the f-number is that of the rim of surface {} (r = {:.2} mm), ", rim.surface, rim.semi_diameter_mm)
        }
        None => String::new(),
    };
    let hint = stop_hint_of(name);
    Some(format!(
        "no surface is the stop: {limit}pupils and field points are unknown, and no f-number can be set; {hint}"
    ))
}
