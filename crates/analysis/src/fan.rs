//! Meridional fans: the rays of one field angle in one section that a lens lets through.

use spectra_glass::DispersionError;
use spectra_lens::Section;
use spectra_optics::{Bundle, ObjectPoint, Optics, WindowLine};
use spectra_tracer::{Indices, RayPath};

/// Rays of a first look across the lens.
const PROBES: usize = 1200;
/// How closely the ends of a fan are found, in parts of the window.
const ACCURACY: f64 = 1e-9;
/// Step of the search for the largest field, and how closely it is found, degrees.
const STEP_DEG: f64 = 1.0;
const ACCURACY_DEG: f64 = 0.01;

/// The rays of one object point in one section that pass a lens. If several bundles pass, it is the widest.
#[derive(Debug)]
pub struct Fan<'o> {
    bundle: Bundle<'o>,
    line: WindowLine,
    /// Where the lowest and the highest ray cross the line, mm along it.
    ends_mm: [f64; 2],
}

/// An object point, and the section in which its rays are traced. The point lies at a field angle on a plane `object_mm` in front
/// of the first vertex. The angle is positive for light that comes from below (or from -x).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FieldPoint {
    /// The section of the lens.
    pub section: Section,
    /// Field angle, rad.
    pub field_rad: f64,
    /// Distance of the object from the first vertex, mm; infinity allowed.
    pub object_mm: f64,
}

impl FieldPoint {
    /// Returns the bundle of the point and the line across its window in the section.
    fn bundle(self, optics: &Optics, wavelength_nm: f64) -> Result<Option<(Bundle<'_>, WindowLine)>, DispersionError> {
        let point = ObjectPoint::on_plane(optics, self.object_mm, self.field_rad).in_section(self.section);
        let Some(bundle) = Bundle::before(optics, point, Indices::At(wavelength_nm))? else { return Ok(None) };
        let way = match self.section {
            Section::X => [1.0, 0.0],
            Section::Y => [0.0, 1.0],
        };
        let reach_mm = bundle.reach_mm();
        let line = WindowLine { from: way.map(|w| -w * reach_mm), way, length_mm: 2.0 * reach_mm };
        Ok(Some((bundle, line)))
    }

    /// Finds the fan of the point at a wavelength, nm; `None` if nothing passes.
    ///
    /// # Errors
    /// A medium has no index there.
    pub fn fan(self, optics: &Optics, wavelength_nm: f64) -> Result<Option<Fan<'_>>, DispersionError> {
        let Some((bundle, line)) = self.bundle(optics, wavelength_nm)? else { return Ok(None) };
        let zones = bundle.zones(&line, PROBES, ACCURACY);
        let widest = zones.into_iter().max_by(|a, b| (a[1] - a[0]).total_cmp(&(b[1] - b[0])));
        Ok(widest.map(|ends_mm| Fan { bundle, line, ends_mm }))
    }

    /// Returns whether any light of the point passes at the reference line.
    fn sees(self, optics: &Optics) -> Result<bool, DispersionError> {
        let Some((bundle, line)) = self.bundle(optics, optics.reference_nm)? else { return Ok(false) };
        let places: Vec<[f64; 2]> = (0..=PROBES).map(|i| line.at(line.length_mm * i as f64 / PROBES as f64)).collect();
        Ok(bundle.passes(&places).contains(&true))
    }
}

impl Fan<'_> {
    /// Traces one ray of the fan through the lens. `part` places it in the fan, from the lowest ray (0) to the highest (1).
    #[must_use]
    pub fn path(&self, part: f64) -> RayPath {
        let [low, high] = self.ends_mm;
        self.bundle.path(self.line.at(low + part * (high - low)))
    }
}

/// Returns the largest field angle, in rad, up to which light passes without a gap in `section`. `object_mm` is the distance of
/// the object from the first vertex (infinity allowed). Angles are tried from the axis outward up to `limit_rad`, with an
/// accuracy of 0.01 degrees. `None` if no light passes on the axis.
///
/// # Errors
/// A medium has no index at the reference line.
pub fn largest_field_rad(
    optics: &Optics,
    section: Section,
    object_mm: f64,
    limit_rad: f64,
) -> Result<Option<f64>, DispersionError> {
    let sees = |field_rad: f64| FieldPoint { section, field_rad, object_mm }.sees(optics);
    if !sees(0.0)? {
        return Ok(None);
    }
    // From the middle outward: a lens may be blind between two bundles, and what lies beyond is not its field.
    let step = STEP_DEG.to_radians();
    let (mut seen, mut next) = (0.0, step);
    while next <= limit_rad && sees(next)? {
        seen = next;
        next += step;
    }
    let mut blind = next.min(limit_rad);
    while blind - seen > ACCURACY_DEG.to_radians() {
        let middle = 0.5 * (seen + blind);
        *(if sees(middle)? { &mut seen } else { &mut blind }) = middle;
    }
    Ok(Some(seen))
}
