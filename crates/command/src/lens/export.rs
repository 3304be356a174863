//! `spectra lens export`: writes a lens for another program.

use super::arguments::LensExport;
use super::conversion::{deliver, target};
use crate::outcome::{Failure, Outcome};
use spectra_core::resources::Resources;
use spectra_exchange::{Format, SystemAperture, yaml, zmx};
use spectra_optics::Optics;
use spectra_scene::FileResources;
use std::path::Path;

/// Writes a lens as a .zmx file.
pub(crate) fn export(arguments: &LensExport) -> Outcome {
    let output = target(arguments.output.as_deref(), Path::new(&arguments.lens), arguments.force)?;
    if let Some(path) = output
        && Format::of_name(&path.display().to_string()) != Some(Format::Zmx)
    {
        return Err(Failure::Input(format!("{}: only .zmx can be written", path.display())));
    }
    let resources = FileResources::beside(Path::new(""));
    let document = resources.document(&arguments.lens, &["lenses"], &[".yaml"])?;
    // Parsing finds all faults of the lens.
    let real = spectra_lens::parse(&document, &resources)?;
    let mut lens = yaml::read(&document)?;
    let states_stop = lens.surfaces().any(|surface| surface.stop && surface.semi_diameter_mm.is_some());
    if lens.system_aperture.is_none() && !states_stop {
        // Here only rims limit the light. Other programs define the beam by its width in front of the lens.
        let width = Optics::new(real).marginal_ray().ok().map(|ray| 2.0 * ray.height_mm);
        lens.system_aperture = width.map(SystemAperture::EntrancePupilDiameter);
    }
    let written = zmx::write(&lens);
    let bytes = zmx::encode(&written.text);
    deliver(&lens.name, lens.surfaces().count(), output, &bytes, &written.left_out, arguments.json)
}
