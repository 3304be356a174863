//! The plain tier: one ray at a time, in ordinary scalar code.

use super::{Action, BentRay, Interface, Surface, Travel, bend};
use crate::RayBatch;
use crate::loss::{ALIVE, Loss};
use crate::numbers::RayNumbers;
use glam::DVec3;
use std::sync::Arc;

/// The intersection of a ray with a surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Intersection {
    /// Distance along the ray, mm; may be negative.
    pub distance_mm: f64,
    /// Normal of the surface, of any length but zero, pointing either way.
    pub normal: DVec3,
}

/// A ray at its intersection with a surface, before it is bent.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bending {
    /// Point on the surface, in mm, in the frame of the surface.
    pub point: DVec3,
    /// Unit direction before the surface.
    pub direction: DVec3,
    /// Unit normal on the side that the ray goes to (`direction . normal` is not negative).
    pub normal: DVec3,
    /// Wavelength in air, nm.
    pub wavelength_nm: f64,
    /// Refractive index of the medium that the ray comes from.
    pub n_before: f64,
    /// Refractive index of the medium that the ray would enter.
    pub n_after: f64,
    /// Action of the surface; never [`Action::Pass`], which leaves the direction alone.
    pub action: Action,
    /// Direction of travel along z.
    pub travel: Travel,
    /// Random numbers for this ray, for a shape that [draws](ScalarShape::draws). `None` if nothing is left to chance, as in
    /// drawings and in the search for focus. The shape then does what it does to most of the light.
    pub numbers: Option<RayNumbers>,
}

/// A surface in scalar code, which handles one ray at a time.
pub trait ScalarShape: Send + Sync + std::fmt::Debug + 'static {
    /// Intersects the ray through `position` (mm, frame of the surface) along the unit `direction` with the surface; `None` if
    /// they do not meet.
    fn intersect(&self, position: DVec3, direction: DVec3) -> Option<Intersection>;
    /// Sag at a point, mm from the vertex plane; see [`Surface::sag_mm`].
    fn sag_mm(&self, x_mm: f64, y_mm: f64) -> Option<f64>;
    /// Curvature at the vertex along x and y, 1/mm; see [`Surface::vertex_curvature_per_mm`].
    fn vertex_curvature_per_mm(&self) -> (f64, f64);
    /// Power for paraxial optics, 1/mm; see [`Surface::paraxial_power_per_mm`].
    fn paraxial_power_per_mm(&self, n_before: f64, n_after: f64) -> (f64, f64) {
        let (x, y) = self.vertex_curvature_per_mm();
        ((n_after - n_before) * x, (n_after - n_before) * y)
    }
    /// Returns the smallest and largest sag (mm) within `radius_mm` of the axis, or bounds of them. Rays that do not cross this
    /// slab within the radius end as vignetted, without a search for their intersection. `None` (the default) if no bounds are
    /// known.
    fn extent_mm(&self, _radius_mm: f64) -> Option<[f64; 2]> {
        None
    }
    /// Returns the unit direction behind the surface, or why the ray ends. It is for surfaces that bend light by a law other than
    /// Snell's, such as an ideal lens or a grating. The default, `None`, means that the ray is refracted or reflected as the
    /// action says. A surface with its own law also has a [phase](ScalarShape::phase_mm).
    fn redirect(&self, _at: &Bending) -> Option<Result<DVec3, Loss>> {
        None
    }
    /// Returns whether the surface adds to the optical path; see [`Surface::has_phase`].
    fn has_phase(&self) -> bool {
        false
    }
    /// Optical path (mm) that the surface adds to a ray; see [`Surface::phase_mm`].
    fn phase_mm(&self, _ray: &BentRay) -> f64 {
        0.0
    }
    /// Returns whether this is the aperture stop; see [`Surface::is_stop`].
    fn is_stop(&self) -> bool {
        false
    }
    /// Returns whether the surface acts differently by azimuth; see [`Surface::is_directional`].
    fn is_directional(&self) -> bool {
        false
    }
    /// Returns whether the surface draws random numbers; see [`Surface::draws`].
    fn draws(&self) -> bool {
        false
    }
    /// Returns this shape with all lengths times `factor`; see [`Surface::scaled`].
    fn scaled(&self, _factor: f64) -> Option<Self>
    where
        Self: Sized,
    {
        None
    }
    /// Does the work of [`Surface::interact`] on a whole batch, for shapes that can do it faster than ray by ray, and returns how
    /// many rays ended. The default, `None`, means that rays are handled one by one.
    #[doc(hidden)]
    fn by_batch(&self, _rays: &mut RayBatch, _interface: &Interface<'_>) -> Option<usize> {
        None
    }
}

/// Turns a [`ScalarShape`] into a [`Surface`].
#[derive(Clone, Debug)]
pub struct PerRay<S>(pub S);

impl<S: ScalarShape> Surface for PerRay<S> {
    fn sag_mm(&self, x_mm: f64, y_mm: f64) -> Option<f64> {
        self.0.sag_mm(x_mm, y_mm)
    }
    fn vertex_curvature_per_mm(&self) -> (f64, f64) {
        self.0.vertex_curvature_per_mm()
    }
    fn paraxial_power_per_mm(&self, n_before: f64, n_after: f64) -> (f64, f64) {
        self.0.paraxial_power_per_mm(n_before, n_after)
    }
    fn is_stop(&self) -> bool {
        self.0.is_stop()
    }
    fn is_directional(&self) -> bool {
        self.0.is_directional()
    }
    fn draws(&self) -> bool {
        self.0.draws()
    }
    fn has_phase(&self) -> bool {
        self.0.has_phase()
    }
    fn phase_mm(&self, ray: &BentRay) -> f64 {
        self.0.phase_mm(ray)
    }
    fn scaled(&self, factor: f64) -> Option<Arc<dyn Surface>> {
        self.0.scaled(factor).map(|shape| Arc::new(Self(shape)) as Arc<dyn Surface>)
    }
    fn interact(&self, rays: &mut RayBatch, interface: &Interface<'_>) -> usize {
        if let Some(lost) = self.0.by_batch(rays, interface) {
            return lost;
        }
        let c = rays.columns_mut();
        let mut lost = 0;
        let clip2 = interface.clip_radius2_mm2;
        let draws = self.0.draws();
        let extent = if clip2.is_finite() { self.0.extent_mm(clip2.sqrt()) } else { None };
        for i in 0..c.x.len() {
            if c.state[i] != ALIVE {
                continue;
            }
            let position = DVec3::new(c.x[i], c.y[i], c.z[i] - interface.shift_mm);
            let direction = DVec3::new(c.l[i], c.m[i], c.n[i]);
            if extent.is_some_and(|extent| passes_beside(position, direction, clip2, extent)) {
                c.state[i] = Loss::Vignetted.state(interface.number);
                lost += 1;
                continue;
            }
            let numbers = if draws { c.numbers.of(i) } else { None };
            match one(&self.0, position, direction, c.wavelength_nm[i], numbers, interface, i) {
                Ok((at, toward)) => {
                    (c.x[i], c.y[i], c.z[i]) = (at.x, at.y, at.z);
                    (c.l[i], c.m[i], c.n[i]) = (toward.x, toward.y, toward.z);
                }
                Err(loss) => {
                    c.state[i] = loss.state(interface.number);
                    lost += 1;
                }
            }
        }
        lost
    }
}

/// Returns whether a ray passes beside the cylinder around the axis that holds the clear part of a surface.
#[inline]
pub(super) fn passes_beside(p: DVec3, d: DVec3, clip_radius2_mm2: f64, [low, high]: [f64; 2]) -> bool {
    /// Allowance for rounding of the bounds.
    const SLACK: f64 = 1e-9;
    if d.z == 0.0 {
        return false;
    }
    let slack = SLACK * (1.0 + low.abs().max(high.abs()));
    let (a, b) = ((low - slack - p.z) / d.z, (high + slack - p.z) / d.z);
    let across2 = d.x * d.x + d.y * d.y;
    // The point nearest to the axis between the two ends.
    let nearest = -(p.x * d.x + p.y * d.y) / across2;
    let t = if across2 > 0.0 { nearest.clamp(a.min(b), a.max(b)) } else { a };
    let (x, y) = (p.x + t * d.x, p.y + t * d.y);
    x * x + y * y > clip_radius2_mm2 * (1.0 + SLACK) + SLACK
}

#[inline]
fn one<S: ScalarShape>(
    shape: &S,
    p: DVec3,
    d: DVec3,
    wavelength_nm: f64,
    numbers: Option<RayNumbers>,
    at: &Interface<'_>,
    i: usize,
) -> Result<(DVec3, DVec3), Loss> {
    let hit = shape.intersect(p, d).ok_or(Loss::Missed)?;
    let q = p + hit.distance_mm * d;
    if !q.is_finite() {
        return Err(Loss::Missed);
    }
    if q.x * q.x + q.y * q.y > at.clip_radius2_mm2 {
        return Err(Loss::Vignetted);
    }
    if at.action == Action::Pass {
        return Ok((q, d));
    }
    let normal = hit.normal / hit.normal.length();
    let normal = if d.dot(normal) < 0.0 { -normal } else { normal };
    let bending = Bending {
        point: q,
        direction: d,
        normal,
        wavelength_nm,
        n_before: at.before.n[i],
        n_after: at.after.n[i],
        action: at.action,
        travel: at.travel,
        numbers,
    };
    if let Some(toward) = shape.redirect(&bending) {
        return toward.map(|toward| (q, toward));
    }
    let cosine = d.dot(normal);
    if at.action == Action::Reflect {
        return Ok((q, d - 2.0 * cosine * normal));
    }
    let mu = at.before.n[i] * at.after.inverse[i];
    let (push, k) = bend::snell::<true>(cosine, mu);
    if k >= 0.0 { Ok((q, mu * d + push * normal)) } else { Err(Loss::TotalReflection) }
}
