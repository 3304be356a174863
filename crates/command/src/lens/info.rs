//! `spectra lens info`.

use super::arguments::LensInfo;
use super::{load, one_light};
use crate::outcome::{DONE, Failure, Outcome};
use crate::{console, limits};
use spectra_analysis::Light;
use spectra_analysis::glare::{GlareTask, glare};
use spectra_analysis::info::LensReport;
use spectra_session::Threads;

/// Shows a lens in figures.
pub(crate) fn info(arguments: &LensInfo) -> Outcome {
    let lens = load(&arguments.setting)?;
    let light = one_light(&arguments.light).unwrap_or(Light::Wavelength(lens.reference_nm));
    if let Some(nm) = light.wavelength_nm() {
        let none = |n: f64| !(n.is_finite() && n > 0.0);
        if let Some(medium) = lens.media.iter().find(|medium| none(medium.medium.index(nm))) {
            return Err(Failure::Input(format!("{} has no refractive index at {nm} nm", medium.label)));
        }
    }
    let mut report = LensReport::of(&lens, light);
    report.every_mount = arguments.mounts;
    if arguments.glare {
        let mut task = GlareTask::new(light.wavelength_nm().unwrap_or(lens.reference_nm));
        task.matter.paint = arguments.paint.unwrap_or(task.matter.paint);
        task.matter.imager = arguments.film_reflectance.unwrap_or(task.matter.imager);
        let found = glare(&lens, &task, &Threads(limits::processors()));
        report.glare = Some(found.map_err(|e| Failure::Input(format!("{}: --glare: {e}", arguments.setting.lens)))?);
    }
    if arguments.json {
        console::pretty_json(&report)?;
    } else {
        console::out(&report.to_string())?;
    }
    Ok(DONE)
}
