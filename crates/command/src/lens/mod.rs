//! `spectra lens`: analyzes, draws, traces and converts lenses.

mod arguments;
mod compare;
mod conversion;
mod draw;
mod export;
mod ghosts;
mod import;
mod info;
mod scale;
mod trace;

pub(crate) use arguments::LensArguments;

use crate::outcome::{Failure, Outcome};
use arguments::{LensCommand, LensOptions, LensSetting, OneLight};
use spectra_analysis::AnalysisLight;
use spectra_core::params::{FNumber, Fault};
use spectra_lens::{Coating, Lens};
use spectra_optics::{ApertureError, FocusSearch, Optics, stop_down};
use spectra_scene::{FileResources, size_hint_of, stop_hint_of};
use std::path::Path;

/// Runs one of the commands of `spectra lens`.
pub(crate) fn lens(command: &LensCommand) -> Outcome {
    match command {
        LensCommand::Compare(compare) => compare::compare(compare),
        LensCommand::Draw(draw) => draw::draw(draw),
        LensCommand::Ghosts(ghosts) => ghosts::ghosts(ghosts),
        LensCommand::Info(info) => info::info(info),
        LensCommand::Trace(trace) => trace::trace(trace),
        LensCommand::Scale(scale) => scale::scale(scale),
        LensCommand::Import(import) => import::import(import),
        LensCommand::Export(export) => export::export(export),
    }
}

/// Loads a lens and sets its coating, stop and focus as requested.
fn load(setting: &LensSetting) -> Result<Optics, Failure> {
    set(load_file(&setting.lens)?, &setting.lens, &LensRequest::of(&setting.options)).map(Optics::new)
}

/// Loads a lens as it is in its file.
fn load_file(name: &str) -> Result<Lens, Failure> {
    Ok(spectra_lens::load(name, &FileResources::beside(Path::new("")))?)
}

/// Requested settings of a lens; the f-number is separate, so that a command can leave it out.
struct LensRequest<'a> {
    options: &'a LensOptions,
    f_number: Option<FNumber>,
}

impl<'a> LensRequest<'a> {
    fn of(options: &'a LensOptions) -> Self {
        Self { options, f_number: options.f_number }
    }
}

fn set(mut lens: Lens, name: &str, setting: &LensRequest<'_>) -> Result<Lens, Failure> {
    let refuse = |error: String| Failure::Input(format!("{name}: {error}"));
    let options = setting.options;
    if let Some(name) = &options.coating {
        lens = lens.with_coating(Coating::named(name, &FileResources::beside(Path::new("")))?);
    }
    lens.absorption = options.absorption.unwrap_or(lens.absorption);
    if let Some(f_number) = setting.f_number {
        lens = stop_down(lens, f_number.number()).map_err(|e| aperture_fault(name, &e))?;
    }
    if let Some(focus) = options.focus.or(options.focus_mm) {
        let object_mm = focus.mm();
        lens = lens.focused_at(object_mm).map_err(|e| refuse(format!("--focus: {e}")))?;
        if let Some(criterion) = options.focus_by.criterion() {
            let light = vec![(lens.reference_nm, 1.0)];
            let search = FocusSearch { object_mm, field_rad: 0.0, criterion, light };
            let hint = "`--focus-by paraxial` focuses without tracing light";
            lens = search.focus(lens).map_err(|e| refuse(format!("--focus: {e}\nhint: {hint}")))?;
        }
    }
    Ok(lens)
}

/// Returns the error for a lens that cannot be set to `--f-number`, with a hint what to add to its file if that is the cause.
fn aperture_fault(name: &str, error: &ApertureError) -> Failure {
    let fault = Fault::new(format!("{name}: --f-number: {error}"));
    let hint = match error {
        ApertureError::NoStop => stop_hint_of(name),
        ApertureError::Unlimited => size_hint_of(name),
        _ => return Failure::Input(fault.message),
    };
    Failure::Faults(fault.hint(hint).into())
}

/// Returns the requested light; `None` if the options name none.
fn one_light(light: &OneLight) -> Option<AnalysisLight> {
    match (light.line, light.wavelength_nm) {
        _ if light.nd => Some(AnalysisLight::Stated),
        (Some(nm), _) => Some(AnalysisLight::Wavelength(nm)),
        (None, Some(wavelength)) => Some(AnalysisLight::Wavelength(wavelength.nm())),
        (None, None) => None,
    }
}
