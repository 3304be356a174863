//! Where in front of a lens the object lies that a given image point is sharp for.

use crate::Light;
use glam::DVec3;
use spectra_core::loss::ALIVE;
use spectra_core::{Isa, RayBatch};
use spectra_glass::DispersionError;
use spectra_lens::{Indices, Lens, Tracer, Travel};

/// The object of an image point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Conjugate {
    /// Where the rays are most together, mm, frame of the lens; infinite coordinates where they are parallel.
    pub point_mm: DVec3,
    /// Its distance in front of the first vertex along the axis, mm. Infinite where the rays are parallel; negative where
    /// they only seem to come together, behind the lens: beyond infinity.
    pub distance_mm: f64,
    /// Unit direction from the lens toward the object: the mean of the rays'.
    pub direction: DVec3,
    /// RMS distance of the rays from their centroid there, across that direction, mm.
    pub rms_mm: f64,
}

/// Rays across the rear of the lens: to find the light, then to measure it.
const CELLS: [usize; 2] = [64, 96];
/// How far beyond the last surface's rim rays can cross its vertex plane.
const REACH: f64 = 1.6;
/// Directions that vary by less are parallel.
const PARALLEL: f64 = 1e-14;

/// The object that is in best focus (least RMS distance of real rays) at an image point, in the direction that belongs to
/// it: `image_mm` is in the frame of the image plane, so that z is not 0 on an imager that is tilted or shifted. Plates
/// before the frame are looked through; they stand parallel to the image plane.
/// `None` where no light reaches that point.
///
/// # Errors
/// A medium has no usable index in this light.
pub fn conjugate(lens: &Lens, light: Light, image_mm: DVec3) -> Result<Option<Conjugate>, DispersionError> {
    let held = light.hold(lens.clone());
    let tracer = Tracer::new(&held, Indices::At(held.reference_nm), Isa::detect())?;
    let Some(last) = held.elements.last() else { return Ok(None) };
    let Some(rim_mm) = last.semi_diameter_mm.or_else(|| held.largest_semi_diameter_mm()) else { return Ok(None) };
    let vertex = held.image_pose.local_point(last.pose.origin_mm);
    let reach_mm = REACH * rim_mm;
    let mut cut = [[vertex.x - reach_mm, vertex.x + reach_mm], [vertex.y - reach_mm, vertex.y + reach_mm]];
    let mut lines = Vec::new();
    for cells in CELLS {
        let mut rays = RayBatch::new(cells * cells);
        rays.restart(cells * cells);
        let place = |k: usize, i: usize| cut[k][0] + (cut[k][1] - cut[k][0]) * (i as f64 + 0.5) / cells as f64;
        let places: Vec<_> = (0..cells * cells).map(|i| [place(0, i % cells), place(1, i / cells)]).collect();
        let c = rays.columns_mut();
        for (i, [x, y]) in places.iter().enumerate() {
            let way = DVec3::new(*x, *y, vertex.z) - image_mm;
            let d = way.normalize();
            // Before the plates the ray runs as if it had started nearer to the lens.
            let slope = (d.x * d.x + d.y * d.y).sqrt() / d.z.abs();
            let depth_mm = held.cover.as_ref().map_or(0.0, |c| c.depth_mm(slope, held.reference_nm));
            let nearer = depth_mm / d.z.abs();
            (c.x[i], c.y[i], c.z[i]) = (*x - d.x * nearer, *y - d.y * nearer, vertex.z);
            (c.l[i], c.m[i], c.n[i]) = d.into();
            c.wavelength_nm[i] = held.reference_nm;
            // Solid angle of the cell.
            c.weight[i] = d.z.abs() / way.length_squared();
        }
        tracer.trace(&mut rays, &mut tracer.work_in_place(cells * cells), Travel::Backward);
        let ([x, y, z], [l, m, n]) = (rays.positions(), rays.directions());
        let alive = |i: &usize| rays.states()[*i] == ALIVE;
        lines = (0..rays.len())
            .filter(alive)
            .map(|i| (DVec3::new(x[i], y[i], z[i]), DVec3::new(l[i], m[i], n[i]), rays.weights()[i]))
            .collect();
        let passed: Vec<_> = (0..rays.len()).filter(alive).map(|i| places[i]).collect();
        if passed.is_empty() {
            return Ok(None);
        }
        cut = [0, 1].map(|k| {
            let cell = (cut[k][1] - cut[k][0]) / cells as f64;
            let low = passed.iter().map(|p| p[k]).fold(f64::INFINITY, f64::min);
            let high = passed.iter().map(|p| p[k]).fold(-f64::INFINITY, f64::max);
            [low - cell, high + cell]
        });
    }
    Ok(most_together(&lines))
}

/// A line across which the direction runs: place and slope there by the distance along it, and its part of the light.
type FlatLine = ([f64; 2], [f64; 2], f64);

/// Where lines (a point, a unit direction, a weight) are most together.
fn most_together(lines: &[(DVec3, DVec3, f64)]) -> Option<Conjugate> {
    let total: f64 = lines.iter().map(|(.., w)| w).sum();
    let direction = lines.iter().map(|(_, d, w)| *w * *d).sum::<DVec3>().try_normalize()?;
    let aside = if direction.x.abs() < 0.9 { DVec3::X } else { DVec3::Y };
    let a = (aside - aside.dot(direction) * direction).normalize();
    let b = direction.cross(a);
    // Each line as place and slope across the direction, by the distance s along it.
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
