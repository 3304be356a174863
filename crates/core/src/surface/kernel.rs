//! The fast tier: branch-free intersection, vectorized over the batch.
//!
//! Intersection and refraction are two loops over a batch (256 rays unless a scene states otherwise). In one loop the division and the
//! square roots of a ray would wait for each other; in two, those of many rays are under way at once. Columns are separate function
//! arguments, so that the compiler knows that they do not overlap. The cause of a loss is determined only for rays that ended. The
//! reciprocal of the index is evaluated with the index (one division for both), so refraction divides by nothing.
//!
//! Kernels store in the batch how far each ray came and the versine of the angle by which it was bent
//! ([`Weighing`](crate::batch::WeightColumns)). That is all that a glass needs to absorb and a coating to reflect. For other surfaces the tracer
//! computes both from copies of the positions and directions before.
//!
//! A ray stays where it has arrived, so its bits do not depend on its neighbors. A ray whose steps do not clearly shrink is
//! passed to a bracketed search. Every ray therefore lands on its sheet or is counted as missed.

mod loops;
mod one_ray;

use super::{Action, Interface, Surface, Travel};
use crate::RayBatch;
use loops::interact;
use std::ops::{Add, Div, Mul, Neg, Sub};
use std::sync::Arc;

/// The arithmetic that a kernel needs. The tracer uses `f64`; tolerances of the shapes are chosen for it.
pub trait Real:
    Copy + Add<Output = Self> + Sub<Output = Self> + Mul<Output = Self> + Div<Output = Self> + Neg<Output = Self>
{
    /// Returns the constant of this value.
    fn constant(value: f64) -> Self;
    /// Square root; NaN for a negative number.
    fn sqrt(self) -> Self;
    /// Returns the absolute value.
    fn abs(self) -> Self;
    /// Returns the smaller number; `other` if this one is NaN.
    fn min(self, other: Self) -> Self;
    /// Returns `chosen` if this is zero or more, `otherwise` if it is negative or NaN.
    fn choose(self, chosen: Self, otherwise: Self) -> Self;
}

impl Real for f64 {
    #[inline(always)]
    fn constant(value: f64) -> Self {
        value
    }
    #[inline(always)]
    fn sqrt(self) -> Self {
        Self::sqrt(self)
    }
    #[inline(always)]
    fn abs(self) -> Self {
        Self::abs(self)
    }
    #[inline(always)]
    fn min(self, other: Self) -> Self {
        if self < other { self } else { other }
    }
    #[inline(always)]
    fn choose(self, chosen: Self, otherwise: Self) -> Self {
        if self >= 0.0 { chosen } else { otherwise }
    }
}

/// A ray in the frame of the surface, in a batch that travels toward the imager (`FORWARD`) or away from it.
#[derive(Clone, Copy, Debug)]
pub struct Ray<R, const FORWARD: bool> {
    /// A point on the ray, mm.
    pub position: [R; 3],
    /// Unit direction.
    pub direction: [R; 3],
    /// x^2 + y^2 of the position, mm^2.
    pub radius2: R,
}

impl<R: Real, const FORWARD: bool> Ray<R, FORWARD> {
    /// Returns `size` (0 or more) with the sign of the direction of travel: positive forward. Most intersections follow from a
    /// square root of either sign; this one picks the intersection on the side that the light comes from.
    #[inline(always)]
    pub fn along(&self, size: R) -> R {
        if FORWARD { size } else { -size }
    }
}

/// The intersection of a ray with a surface.
#[derive(Clone, Copy, Debug)]
pub struct Hit<R> {
    /// Distance along the ray, mm; may be negative.
    pub distance: R,
    /// Dot product of direction and normal, where the normal points toward +z at the vertex: positive forward, negative backward.
    /// It is read only for shapes whose normal has unit length.
    pub cosine: R,
    /// Sign of validity: negative or NaN if the ray misses the surface or runs against the direction of travel.
    pub valid: R,
}

/// State of a ray on its steps toward a surface.
#[derive(Clone, Copy, Debug)]
pub struct Near<R> {
    /// Distance along the ray that is reached so far, mm.
    pub distance: R,
    /// Values that the shape keeps for the next step.
    pub kept: [R; 2],
    /// Size of the last step, mm; 0 once the ray has arrived.
    pub step: R,
    /// Negative or NaN if the ray misses; see [`Hit::valid`].
    pub valid: R,
}

/// A surface in branch-free code. Mark its methods `#[inline(always)]`.
pub trait KernelShape: Send + Sync + std::fmt::Debug + 'static {
    /// Intersects the ray with the surface. A ray along the axis hits the vertex.
    fn hit<R: Real, const FORWARD: bool>(&self, ray: Ray<R, FORWARD>) -> Hit<R>;
    /// Whether rays come to the surface in steps, starting at the distance that `hit` guesses. Then `approach`, `correct` and
    /// `settle` run over the batch one after the other; `settle` runs again while a ray has not arrived. Each step is its own
    /// loop over the batch, which keeps several rays in flight; in a single loop the steps of a ray would wait for each other.
    /// Such a shape sets `UNIT_NORMAL` to false.
    const STEPS: bool = false;
    /// Takes the first step toward the surface, see [`KernelShape::STEPS`].
    #[inline(always)]
    fn approach<R: Real, const FORWARD: bool>(&self, _ray: Ray<R, FORWARD>, hit: Hit<R>) -> Near<R> {
        Near { distance: hit.distance, kept: [hit.cosine; 2], step: R::constant(0.0), valid: hit.valid }
    }
    /// Takes the second step toward the surface.
    #[inline(always)]
    fn correct<R: Real, const FORWARD: bool>(&self, _ray: Ray<R, FORWARD>, near: Near<R>) -> Near<R> {
        near
    }
    /// Takes the last step toward the surface. [`Near::step`] says whether another one is needed. Keeps what
    /// [`KernelShape::normal_kept`] needs.
    #[inline(always)]
    fn settle<R: Real, const FORWARD: bool>(&self, _ray: Ray<R, FORWARD>, near: Near<R>) -> Near<R> {
        near
    }
    /// Returns the values that [`KernelShape::settle`] would keep for a ray that arrives at `point` of the surface.
    #[inline(always)]
    fn keep<R: Real>(&self, _point: [R; 3]) -> [R; 2] {
        [R::constant(0.0); 2]
    }
    /// Returns the normal at `point`, from the values that [`KernelShape::settle`] kept.
    #[inline(always)]
    fn normal_kept<R: Real>(&self, point: [R; 3], _kept: [R; 2]) -> [R; 3] {
        self.normal(point)
    }
    /// Returns the normal at a point of the surface, toward +z at the vertex; of unit length if [`KernelShape::UNIT_NORMAL`] is
    /// true.
    fn normal<R: Real>(&self, point: [R; 3]) -> [R; 3];
    /// Whether the normal has unit length. Set this to false if unit length would cost a square root: Snell's law works with
    /// any length, at the price of a division.
    const UNIT_NORMAL: bool = true;
    /// Whether [`KernelShape::search`] tries again for rays whose [`KernelShape::hit`] is invalid. The distance of an invalid hit
    /// must then be 0.
    const SEARCHES: bool = false;
    /// Finds the distance (mm) along a ray for which `hit` found none, by a slower and safer search. `None` if the ray misses.
    fn search(&self, _position: [f64; 3], _direction: [f64; 3], _travel: Travel) -> Option<f64> {
        None
    }
    /// Returns the direction after the surface, `mu * direction + push * normal(point)`. A shape whose normal is linear in the
    /// point can save a few operations here. Used with unit normals only.
    #[inline(always)]
    fn bend<R: Real>(&self, point: [R; 3], direction: [R; 3], mu: R, push: R) -> [R; 3] {
        let normal = self.normal(point);
        [
            mu * direction[0] + push * normal[0],
            mu * direction[1] + push * normal[1],
            mu * direction[2] + push * normal[2],
        ]
    }
    /// Sag at a point, mm from the vertex plane; see [`Surface::sag_mm`].
    fn sag_mm(&self, x_mm: f64, y_mm: f64) -> Option<f64>;
    /// Curvature at the vertex along x and y, 1/mm; see [`Surface::vertex_curvature_per_mm`].
    fn vertex_curvature_per_mm(&self) -> (f64, f64);
    /// Returns whether this is the aperture stop; see [`Surface::is_stop`].
    fn is_stop(&self) -> bool {
        false
    }
    /// Returns this shape with all lengths times `factor`; see [`Surface::scaled`].
    fn scaled(&self, _factor: f64) -> Option<Self>
    where
        Self: Sized,
    {
        None
    }
}

/// Turns a [`KernelShape`] into a [`Surface`].
#[derive(Clone, Debug)]
pub struct Kernel<S>(pub S);

impl<S: KernelShape> Surface for Kernel<S> {
    fn sag_mm(&self, x_mm: f64, y_mm: f64) -> Option<f64> {
        self.0.sag_mm(x_mm, y_mm)
    }
    fn vertex_curvature_per_mm(&self) -> (f64, f64) {
        self.0.vertex_curvature_per_mm()
    }
    fn is_stop(&self) -> bool {
        self.0.is_stop()
    }
    fn records_intersection(&self) -> bool {
        true
    }
    fn scaled(&self, factor: f64) -> Option<Arc<dyn Surface>> {
        self.0.scaled(factor).map(|shape| Arc::new(Self(shape)) as Arc<dyn Surface>)
    }
    fn interact(&self, rays: &mut RayBatch, interface: &Interface<'_>) -> usize {
        match interface.action {
            Action::Refract => interact::<S, { one_ray::REFRACT }>(&self.0, rays, interface),
            Action::Reflect => interact::<S, { one_ray::REFLECT }>(&self.0, rays, interface),
            Action::Pass => interact::<S, { one_ray::PASS }>(&self.0, rays, interface),
        }
    }
}
