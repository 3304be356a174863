//! Traces one ray, or many, to one surface.
#![allow(dead_code)] // Each test file uses what it needs.

use glam::DVec3;
use spectra_core::batch::Column;
use spectra_core::surface::{Action, IndexColumns, Interface, Surface, Travel};
use spectra_core::{Isa, Loss, RayBatch};

/// A ray: a point on it, in mm, and its unit direction.
pub type Line = (DVec3, DVec3);

/// Traces rays of one wavelength to a surface whose vertex is the origin.
pub fn meet_all(
    surface: &dyn Surface,
    rays: &[Line],
    (n_before, n_after): (f64, f64),
    action: Action,
    wavelength_nm: f64,
    travel: Travel,
    isa: Isa,
) -> Vec<Result<Line, Loss>> {
    let len = rays.len();
    let column = |value: f64| {
        let mut column = Column::<f64>::new(len);
        column.slice_mut(len).fill(value);
        column
    };
    let (b, bi, a, ai) = (column(n_before), column(1.0 / n_before), column(n_after), column(1.0 / n_after));
    let interface = Interface {
        number: 1,
        shift_mm: 0.0,
        clip_radius2_mm2: f64::INFINITY,
        action,
        travel,
        before: IndexColumns { n: b.slice(len), inverse: bi.slice(len) },
        after: IndexColumns { n: a.slice(len), inverse: ai.slice(len) },
    };
    let mut batch = RayBatch::new(len).on(isa);
    batch.restart(len);
    let c = batch.columns_mut();
    for (i, (p, d)) in rays.iter().enumerate() {
        (c.x[i], c.y[i], c.z[i]) = (*p).into();
        (c.l[i], c.m[i], c.n[i]) = (*d).into();
        c.wavelength_nm[i] = wavelength_nm;
    }
    let lost = surface.interact(&mut batch, &interface);
    assert_eq!(lost, len - batch.alive());
    let ([x, y, z], [l, m, n]) = (batch.positions(), batch.directions());
    (0..len)
        .map(|i| match batch.loss(i) {
            Some((loss, _)) => Err(loss),
            None => Ok((DVec3::new(x[i], y[i], z[i]), DVec3::new(l[i], m[i], n[i]))),
        })
        .collect()
}

/// Returns the direction of travel of a ray with direction `d`.
pub fn sense(d: DVec3) -> Travel {
    if d.z > 0.0 { Travel::Forward } else { Travel::Backward }
}

/// Traces one ray of 550 nm.
pub fn meet(surface: &dyn Surface, ray: Line, indices: (f64, f64), action: Action) -> Result<Line, Loss> {
    meet_all(surface, &[ray], indices, action, 550.0, sense(ray.1), Isa::detect())[0]
}
