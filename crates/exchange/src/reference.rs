//! The wavelength at which a file's program states focal lengths and focus.

use crate::prescription::{Item, Medium, Prescription};
use spectra_glass::{Catalogue, Line, lines};

/// The primary wavelength becomes the reference line of the lens, where all of its glasses are known there by name: figures that are
/// stated at d beside such a name are left out.
pub(crate) fn set(lens: &mut Prescription) {
    // Of several wavelengths none is the primary one where the file does not say it.
    let at = lens.primary.or((lens.wavelengths.len() == 1).then_some(0));
    let Some(line) = at.and_then(|at| lens.wavelengths.get(at)).and_then(|w| near(w.nm)) else { return };
    let media = || lens.surfaces().map(|surface| &surface.medium);
    if line == lines::D || !media().all(|medium| is_known(medium, line)) {
        return;
    }
    lens.reference_line = Some(line.label());
    for item in &mut lens.items {
        if let Item::Surface(surface) = item
            && let Medium::Glass { nd, vd, .. } = &mut surface.medium
        {
            (*nd, *vd) = (None, None);
        }
    }
}

/// The spectral line that a file means, to the digits that files have; any other wavelength as it is.
fn near(nm: f64) -> Option<Line> {
    const DIGITS_NM: f64 = 0.06;
    let named = ["d", "D", "e", "F", "F'", "C", "C'", "g", "h"].into_iter().filter_map(lines::by_name);
    let close = named.into_iter().find(|line| (line.wavelength_nm - nm).abs() <= DIGITS_NM);
    close.or_else(|| Line::at(nm))
}

/// Whether the index of a medium at a line is that of its name.
fn is_known(medium: &Medium, line: Line) -> bool {
    let covers = |(from, to): (f64, f64)| (from..=to).contains(&line.wavelength_nm);
    match medium {
        Medium::Air => true,
        Medium::Glass { name, nd, .. } => {
            Catalogue::bundled().find(name).map_or(nd.is_none(), |glass| covers(glass.range_nm))
        }
        Medium::Model { .. } | Medium::Unknown { .. } => false,
    }
}
