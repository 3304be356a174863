//! Rays that interact with a single surface.

use glam::DVec3;
use spectra_core::batch::Column;
use spectra_core::loss::ALIVE;
use spectra_core::numbers::{Numbers, StageKey};
use spectra_core::surface::{Action, IndexColumns, Interface, Surface, Travel};
use spectra_core::{Isa, Loss, RayBatch};

/// A ray: a point on it, in mm, and its unit direction.
pub type Ray = (DVec3, DVec3);

/// Traces a ray of 550 nm through a surface whose vertex is the origin, and returns the ray behind the surface. `indices` are the
/// refractive indices of the media (before, after), in the order in which the ray passes them.
///
/// # Errors
/// The cause of the loss, if the ray ends at the surface.
pub fn ray(surface: &dyn Surface, ray: Ray, indices: (f64, f64), action: Action) -> Result<Ray, Loss> {
    Rays { indices, action, ..Rays::default() }.meet(surface, &[ray])[0]
}

/// Conditions under which rays meet a surface, in a coordinate frame whose origin is the surface's vertex.
#[derive(Clone, Copy, Debug)]
pub struct Rays {
    /// Refractive indices of the media before and after the surface, in the order in which the rays pass them.
    pub indices: (f64, f64),
    /// Interaction at the surface: refraction, reflection or passage.
    pub action: Action,
    /// Clear semi-diameter of the surface, mm.
    pub clip_mm: f64,
    /// Wavelength of the rays, nm.
    pub wavelength_nm: f64,
    /// Largest number of rays in a batch.
    pub batch: usize,
    /// Seed of the random numbers that a surface may draw; each ray is one sample, in order. Without a seed the batch has no numbers.
    pub seed: Option<u64>,
    /// Instruction set of the batches.
    pub isa: Isa,
}

impl Default for Rays {
    /// Returns refraction from air into glass of index 1.5 at 550 nm, without clipping or random numbers, in batches of 256.
    fn default() -> Self {
        Self {
            indices: (1.0, 1.5),
            action: Action::Refract,
            clip_mm: f64::INFINITY,
            wavelength_nm: 550.0,
            batch: 256,
            seed: None,
            isa: Isa::Baseline,
        }
    }
}

/// Number given to the surface; losses are recorded with it.
pub(crate) const NUMBER: u32 = 7;
/// Distance of the vertex behind the origin of the frame in which rays arrive, mm.
const SHIFT_MM: f64 = 1.25;

impl Rays {
    /// Traces rays, which must all travel in the same sense, through a surface. Returns, in order, each ray behind the surface or the
    /// cause of its loss.
    ///
    /// # Panics
    /// If the number of losses that the surface returns is not the number of rays that ended.
    #[must_use]
    pub fn meet(&self, surface: &dyn Surface, rays: &[Ray]) -> Vec<Result<Ray, Loss>> {
        let mut out = Vec::with_capacity(rays.len());
        for (first, part) in (0..).step_by(self.batch.max(1)).zip(rays.chunks(self.batch.max(1))) {
            let mut batch = self.send(part, first);
            let lost = self.interact(surface, &mut batch);
            assert_eq!(lost, batch.len() - batch.alive(), "`interact` returns {lost}, another number of rays ended");
            out.extend((0..part.len()).map(|i| outcome(&batch, i)));
        }
        out
    }

    /// Returns a batch of these rays in front of the surface; their samples are numbered from `first`.
    pub(crate) fn send(&self, rays: &[Ray], first: u64) -> RayBatch {
        let mut batch = RayBatch::new(rays.len()).on(self.isa).with_numbers();
        batch.restart(rays.len());
        batch.set_stage(StageKey::new("surface", 0));
        if let Some(seed) = self.seed {
            batch.number(0, &Numbers::sobol(seed), "laws", 0, first);
        }
        let c = batch.columns_mut();
        for (i, (p, d)) in rays.iter().enumerate() {
            (c.x[i], c.y[i], c.z[i]) = (p.x, p.y, p.z + SHIFT_MM);
            (c.l[i], c.m[i], c.n[i]) = (*d).into();
            c.wavelength_nm[i] = self.wavelength_nm;
            c.index[i] = self.indices.0;
            c.tag[i] = i as u32;
        }
        batch
    }

    /// Lets a batch made by [`Rays::send`] interact with the surface, and returns the number of losses that the surface counts.
    pub(crate) fn interact(&self, surface: &dyn Surface, batch: &mut RayBatch) -> usize {
        let len = batch.len();
        let column = |value: f64| {
            let mut column = Column::<f64>::new(len);
            column.slice_mut(len).fill(value);
            column
        };
        let (n, m) = self.indices;
        let [before, before_inverse, after, after_inverse] = [n, 1.0 / n, m, 1.0 / m].map(column);
        let forward = batch.directions()[2].iter().zip(batch.states()).any(|(n, s)| *s == ALIVE && *n > 0.0);
        let interface = Interface {
            number: NUMBER,
            shift_mm: SHIFT_MM,
            clip_radius2_mm2: self.clip_mm * self.clip_mm,
            action: self.action,
            travel: if forward { Travel::Forward } else { Travel::Backward },
            before: IndexColumns { n: before.slice(len), inverse: before_inverse.slice(len) },
            after: IndexColumns { n: after.slice(len), inverse: after_inverse.slice(len) },
        };
        surface.interact(batch, &interface)
    }
}

/// Returns ray `i` behind the surface, or the cause of its loss.
pub(crate) fn outcome(batch: &RayBatch, i: usize) -> Result<Ray, Loss> {
    match batch.loss(i) {
        Some((loss, number)) => {
            assert_eq!(number, NUMBER, "a ray ended as {} at surface {number}; this is number {NUMBER}", loss.name());
            Err(loss)
        }
        None => {
            let ([x, y, z], [l, m, n]) = (batch.positions(), batch.directions());
            Ok((DVec3::new(x[i], y[i], z[i]), DVec3::new(l[i], m[i], n[i])))
        }
    }
}
