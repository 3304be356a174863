//! Finds the object point in front of a lens that is in focus at a given image point.

use crate::AnalysisLight;
use glam::DVec3;
use spectra_core::loss::ALIVE;
use spectra_glass::DispersionError;
use spectra_lens::Lens;
use spectra_optics::{Bundle, Optics, RayPattern};
use spectra_tracer::Indices;

/// The object point that is in focus at an image point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Conjugate {
    /// Point of least RMS distance of the rays, in mm, in the frame of the lens; infinite coordinates if the rays are parallel.
    pub point_mm: DVec3,
    /// Distance of the point in front of the first vertex along the axis, mm. Infinite if the rays are parallel. Negative if the rays
    /// diverge in front of the lens and only seem to meet behind it: the focus is then beyond infinity.
    pub distance_mm: f64,
    /// Unit direction from the lens toward the object: the mean direction of the rays.
    pub direction: DVec3,
    /// RMS distance of the rays from their centroid at the point, measured across that direction, mm.
    pub rms_mm: f64,
}

/// Rays per side of the grid over the rear of the lens: a first pass to find the light, a second to measure it.
const CELLS: [usize; 2] = [64, 96];
/// Rays whose slopes have an RMS spread below this are parallel.
const PARALLEL: f64 = 1e-14;

/// Finds the object point that a lens images best (least RMS distance of real rays) at the image point `image_mm`, and the
/// direction from the lens toward it.
///
/// `image_mm` is in the frame of the image plane; its z is not 0 on an imager that is tilted or shifted. Cover plates in front of
/// the frame are included; they are parallel to the image plane. Returns `None` if no light reaches the image point.
///
/// # Errors
/// A medium has no usable index in this light.
pub fn conjugate(lens: &Lens, light: AnalysisLight, image_mm: DVec3) -> Result<Option<Conjugate>, DispersionError> {
    let held = Optics::new(light.with_fixed_indices(lens));
    if held.largest_semi_diameter_mm().is_none() {
        return Ok(None);
    }
    let Some(bundle) = Bundle::behind(&held, image_mm, Indices::At(held.reference_nm))? else { return Ok(None) };
    let Ok(extent) = bundle.extent() else { return Ok(None) };
    let extent = bundle.extent_within(extent, CELLS[0]).unwrap_or(extent);
    let rays = bundle.trace(&RayPattern::Grid(CELLS[1]).places(extent).collect::<Vec<_>>());
    let ([x, y, z], [l, m, n]) = (rays.positions(), rays.directions());
    let lines: Vec<(DVec3, DVec3, f64)> = (0..rays.len())
        .filter(|i| rays.states()[*i] == ALIVE)
        .map(|i| (DVec3::new(x[i], y[i], z[i]), DVec3::new(l[i], m[i], n[i]), rays.weights()[i]))
        .collect();
    Ok(most_together(&lines))
}

/// A line relative to the mean direction: transverse position, transverse slope per distance along that direction, and weight (part of the
/// light).
type FlatLine = ([f64; 2], [f64; 2], f64);

/// Finds the point where lines (point, unit direction, weight) have the least RMS distance.
fn most_together(lines: &[(DVec3, DVec3, f64)]) -> Option<Conjugate> {
    let total: f64 = lines.iter().map(|(.., w)| w).sum();
    let direction = lines.iter().map(|(_, d, w)| *w * *d).sum::<DVec3>().try_normalize()?;
    let aside = if direction.x.abs() < 0.9 { DVec3::X } else { DVec3::Y };
    let a = (aside - aside.dot(direction) * direction).normalize();
    let b = direction.cross(a);
    // Write each line as transverse position and slope, as functions of the distance s along the direction.
    let flat: Vec<FlatLine> = lines
        .iter()
        .map(|(p, d, w)| {
            let (s, along) = (p.dot(direction), d.dot(direction));
            let slope = [d.dot(a) / along, d.dot(b) / along];
            ([p.dot(a) - slope[0] * s, p.dot(b) - slope[1] * s], slope, w / total)
        })
        .collect();
    let mean = |of: &dyn Fn(&FlatLine) -> f64| flat.iter().map(|line| line.2 * of(line)).sum::<f64>();
    let place = [0, 1].map(|k| mean(&|line| line.0[k]));
    let slope = [0, 1].map(|k| mean(&|line| line.1[k]));
    let product = |of: &dyn Fn(&FlatLine, usize) -> f64| mean(&|line| of(line, 0) + of(line, 1));
    let places = product(&|l, k| (l.0[k] - place[k]) * (l.0[k] - place[k]));
    let mixed = product(&|l, k| (l.0[k] - place[k]) * (l.1[k] - slope[k]));
    let slopes = product(&|l, k| (l.1[k] - slope[k]) * (l.1[k] - slope[k]));
    if slopes < PARALLEL * PARALLEL {
        let far = DVec3::new(f64::INFINITY * direction.x, f64::INFINITY * direction.y, -f64::INFINITY);
        return Some(Conjugate {
            point_mm: far,
            distance_mm: f64::INFINITY,
            direction,
            rms_mm: places.max(0.0).sqrt(),
        });
    }
    let s = -mixed / slopes;
    let point_mm = s * direction + (place[0] + slope[0] * s) * a + (place[1] + slope[1] * s) * b;
    let rms_mm = (places + s * (2.0 * mixed + s * slopes)).max(0.0).sqrt();
    Some(Conjugate { point_mm, distance_mm: -point_mm.z, direction, rms_mm })
}
