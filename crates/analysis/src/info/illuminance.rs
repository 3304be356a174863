//! How bright a lens draws an evenly bright field on the image plane.

use glam::DVec3;
use spectra_core::loss::ALIVE;
use spectra_core::workers::Alone;
use spectra_core::{Isa, RayBatch};
use spectra_lens::{Effort, Indices, Lens, RearPupil, Tracer, Travel};

/// Rays to each point: a square of so many by so many, evenly over the pupil as the point sees it. It is right within 0.3 %.
const CELLS: usize = 320;
/// Rays that are traced at a time, so that their columns stay in the caches.
const BATCH: usize = 1024;

/// The illuminance at each point of the image plane (mm, frame of the plane) over that at the first one, from a field that is equally
/// bright all over. The integral of the radiance over projected solid angle, by real rays from each point back through the lens: the exit pupil as
/// it is seen from there, cut by every rim, with what coatings and glass leave. `None` where no light comes to the first point, or no
/// surface states a size.
pub(super) fn relative_illuminance(lens: &Lens, indices: Indices, points_mm: &[[f64; 2]]) -> Option<Vec<f64>> {
    let wavelength_nm = match indices {
        Indices::At(nm) => nm,
        Indices::Band { .. } | Indices::Stated => lens.reference_nm,
    };
    let isa = Isa::detect();
    let tracer = Tracer::new(lens, indices, isa).ok()?;
    let points: Vec<DVec3> = points_mm.iter().map(|[x, y]| DVec3::new(*x, *y, 0.0)).collect();
    let pupil = RearPupil::search_by(lens, &tracer, &points, [wavelength_nm; 2], &Alone, Effort::Draft)?;
    let middle = |i: usize| (i as f64 + 0.5) / CELLS as f64;
    let u: Vec<f64> = (0..CELLS * CELLS).map(|i| middle(i / CELLS)).collect();
    let v: Vec<f64> = (0..CELLS * CELLS).map(|i| middle(i % CELLS)).collect();
    let rays = RayBatch::new(BATCH);
    let mut rays = if tracer.polarizes() { rays.with_polarization() } else { rays };
    let mut work = tracer.work_in_place(BATCH);
    let mut illuminance = |point: &DVec3| {
        let mut sum = 0.0;
        for (u, v) in u.chunks(BATCH).zip(v.chunks(BATCH)) {
            rays.restart(u.len());
            let c = rays.columns_mut();
            c.x.fill(point.x);
            c.y.fill(point.y);
            c.z.fill(point.z);
            c.l.fill(0.0);
            c.m.fill(0.0);
            c.n.fill(-1.0);
            c.weight.fill(1.0);
            c.wavelength_nm.fill(wavelength_nm);
            pupil.aim(&mut rays, u, v, isa);
            tracer.trace(&mut rays, &mut work, Travel::Backward);
            let passed = rays.weights().iter().zip(rays.states()).filter(|(_, state)| **state == ALIVE);
            sum = passed.fold(sum, |sum, (weight, _)| sum + weight);
        }
        sum
    };
    let all: Vec<f64> = points.iter().map(&mut illuminance).collect();
    let first = all.first().copied().filter(|e| *e > 0.0)?;
    Some(all.into_iter().map(|e| e / first).collect())
}
