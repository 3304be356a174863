//! `spectra lens`: the lens as an optical engineer looks at it.

mod arguments;
mod compare;
mod draw;
mod exchanged;
mod export;
mod ghosts;
mod import;
mod info;
mod scale;
mod trace;

pub(crate) use arguments::LensArguments;

use crate::outcome::{Failure, Outcome};
use arguments::{LensCommand, LensOptions, LensSetting, OneLight};
use spectra_analysis::Light;
use spectra_core::Isa;
use spectra_core::params::{FNumber, Fault};
use spectra_lens::{ApertureError, Coating, FocusSearch, Lens};
use spectra_scene::{FileResources, size_hint_of, stop_hint_of};
use std::path::Path;

/// Runs a command on a lens.
pub(crate) fn lens(command: &LensCommand, isa: Isa) -> Outcome {
    match command {
        LensCommand::Compare(compare) => compare::compare(compare),
        LensCommand::Draw(draw) => draw::draw(draw),
        LensCommand::Ghosts(ghosts) => ghosts::ghosts(ghosts, isa),
        LensCommand::Info(info) => info::info(info),
        LensCommand::Trace(trace) => trace::trace(trace, isa),
        LensCommand::Scale(scale) => scale::scale(scale),
        LensCommand::Import(import) => import::import(import),
        LensCommand::Export(export) => export::export(export),
    }
}

/// The lens, coated, stopped and focused as asked.
fn load(setting: &LensSetting) -> Result<Lens, Failure> {
    set(load_file(&setting.lens)?, &setting.lens, &Setting::of(&setting.options))
}

/// The lens as its file has it.
fn load_file(name: &str) -> Result<Lens, Failure> {
    Ok(spectra_lens::load(name, &FileResources::beside(Path::new("")))?)
}

/// What is asked of a lens.
struct Setting<'a> {
    options: &'a LensOptions,
    f_number: Option<FNumber>,
}

impl<'a> Setting<'a> {
    fn of(options: &'a LensOptions) -> Self {
        Self { options, f_number: options.f_number }
    }
}

fn set(mut lens: Lens, name: &str, setting: &Setting<'_>) -> Result<Lens, Failure> {
    let refuse = |error: String| Failure::Input(format!("{name}: {error}"));
    let options = setting.options;
    if let Some(name) = &options.coating {
        lens = lens.with_coating(Coating::named(name, &FileResources::beside(Path::new("")))?);
    }
    lens.absorption = options.absorption.unwrap_or(lens.absorption);
    if let Some(f_number) = setting.f_number {
        lens = lens.at_f_number(f_number.number()).map_err(|e| aperture_fault(name, &e))?;
    }
    if let Some(focus) = options.focus.or(options.focus_mm) {
        let object_mm = focus.mm();
        lens = lens.focused_at(object_mm).map_err(|e| refuse(format!("--focus: {e}")))?;
        if let Some(criterion) = options.focus_by.criterion() {
            let light = vec![(lens.reference_nm, 1.0)];
            let search = FocusSearch { object_mm, field_rad: 0.0, criterion, light };
            let hint = "`--focus-by paraxial` needs no light";
            lens = lens.focused_by(&search).map_err(|e| refuse(format!("--focus: {e}\nhint: {hint}")))?;
        }
    }
    Ok(lens)
}

/// Why a lens is not set to `--f-number`, and what to write in its file where that says too little.
fn aperture_fault(name: &str, error: &ApertureError) -> Failure {
    let fault = Fault::new(format!("{name}: --f-number: {error}"));
    let hint = match error {
        ApertureError::NoStop => stop_hint_of(name),
        ApertureError::Unlimited => size_hint_of(name),
        _ => return Failure::Input(fault.message),
    };
    Failure::Faults(fault.hint(hint).into())
}

/// The light asked for, if one is.
fn one_light(light: &OneLight) -> Option<Light> {
    match (light.line, light.wavelength_nm) {
        _ if light.nd => Some(Light::Stated),
        (Some(nm), _) => Some(Light::Wavelength(nm)),
        (None, Some(wavelength)) => Some(Light::Wavelength(wavelength.nm())),
        (None, None) => None,
    }
}
