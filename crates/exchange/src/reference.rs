//! The reference wavelength: the one at which the other program states focal lengths and focus.

use crate::prescription::{AxisItem, Medium, Prescription};
use spectra_glass::{Catalog, Line, lines};

/// Makes the primary wavelength the reference line of the lens, if all of its glasses are known there by name. Indices stated at d next to
/// such a name are then removed.
pub(crate) fn set(lens: &mut Prescription) {
    // If there are several wavelengths and the file names none, none is the primary one.
    let at = lens.primary.or((lens.wavelengths.len() == 1).then_some(0));
    let Some(line) = at.and_then(|at| lens.wavelengths.get(at)).and_then(|w| near(w.nm)) else { return };
    let media = || lens.surfaces().map(|surface| &surface.medium);
    if line == lines::D || !media().all(|medium| is_known(medium, line)) {
        return;
    }
    lens.reference_line = Some(line.label());
    for item in &mut lens.items {
        if let AxisItem::Surface(surface) = item
            && let Medium::Glass { nd, vd, .. } = &mut surface.medium
        {
            (*nd, *vd) = (None, None);
        }
    }
}

/// Returns the spectral line nearest to a wavelength within the precision of lens files, or the exact wavelength as a line.
fn near(nm: f64) -> Option<Line> {
    const DIGITS_NM: f64 = 0.06;
    let named = ["d", "D", "e", "F", "F'", "C", "C'", "g", "h"].into_iter().filter_map(lines::by_name);
    let close = named.into_iter().find(|line| (line.wavelength_nm - nm).abs() <= DIGITS_NM);
    close.or_else(|| Line::at(nm))
}

/// Whether the index of a medium at a line follows from its name.
fn is_known(medium: &Medium, line: Line) -> bool {
    let covers = |(from, to): (f64, f64)| (from..=to).contains(&line.wavelength_nm);
    match medium {
        Medium::Air => true,
        Medium::Glass { name, nd, .. } => {
            Catalog::bundled().find(name).map_or(nd.is_none(), |glass| covers(glass.range_nm))
        }
        Medium::Model { .. } | Medium::Unknown { .. } => false,
    }
}
