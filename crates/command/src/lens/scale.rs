//! `spectra lens scale`: writes a lens at another size.

use super::arguments::LensScale;
use super::conversion::{deliver, target};
use crate::console;
use crate::outcome::{Failure, Outcome};
use spectra_core::resources::Resources;
use spectra_exchange::{ApertureShape, SurfaceShape, yaml};
use spectra_scene::FileResources;
use std::path::Path;

/// Writes a lens with all lengths multiplied by a factor.
pub(crate) fn scale(arguments: &LensScale) -> Outcome {
    let output = target(arguments.output.as_deref(), Path::new(&arguments.lens), arguments.force)?;
    let resources = FileResources::beside(Path::new(""));
    let document = resources.document(&arguments.lens, &["lenses"], &[".yaml"])?;
    let real = spectra_lens::parse(&document, &resources)?;
    let lens = yaml::read(&document)?;
    let unknown = lens.surfaces().find_map(|surface| match &surface.shape {
        SurfaceShape::Other { kind } => Some(kind.clone()),
        _ => surface.apertures.iter().find_map(|aperture| match &aperture.shape {
            ApertureShape::Other { name } => Some(name.clone()),
            _ => None,
        }),
    });
    if let Some(kind) = unknown {
        let text = format!("{}: it is not known how a `{kind}` scales; scale the file by hand", arguments.lens);
        return Err(Failure::Input(text));
    }
    let efl_mm = real.first_order(real.reference_nm).efl_mm;
    let factor = match (&arguments.to, arguments.by) {
        (Some(to), _) => {
            if !efl_mm.is_finite() {
                return Err(Failure::Input(format!(
                    "{}: the lens has no focal length; use --by FACTOR",
                    arguments.lens
                )));
            }
            to.mm() / efl_mm.abs()
        }
        (None, Some(by)) => by,
        (None, None) => return Err(Failure::Input("use --to LENGTH, such as --to 85mm, or --by FACTOR".to_owned())),
    };
    if !(factor.is_finite() && (1e-4..=1e4).contains(&factor)) {
        return Err(Failure::Input(format!("a factor of {factor} is out of range: 0.0001 to 10000")));
    }
    let mut scaled = lens.scaled(factor);
    let [before, after] = [efl_mm, efl_mm * factor].map(|mm| format!("{mm:.4} mm"));
    scaled.remarks.push(format!("scaled by {factor:.6}: the focal length was {before} and is {after}"));
    let text = yaml::write(&scaled, None);
    if output.is_some() {
        console::note(&format!("focal length {before} -> {after}, all lengths multiplied by {factor:.6}"));
    }
    deliver(&scaled.name, scaled.surfaces().count(), output, text.as_bytes(), &scaled.left_out, arguments.report.json)
}
