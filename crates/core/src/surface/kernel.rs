//! The fast tier: a branch-free intersection, vectorised over the batch.

use super::{Action, Interface, Surface, Travel, bend};
use crate::RayBatch;
use crate::isa::{Isa, Vectorized};
use crate::loss::{ALIVE, Loss};
use std::ops::{Add, Div, Mul, Neg, Sub};

/// The numbers that a kernel computes with: `f64` in the tracer; any other type that has these
/// operations (single precision, a dual number for derivatives) may take its place.
pub trait Real:
    Copy + Add<Output = Self> + Sub<Output = Self> + Mul<Output = Self> + Div<Output = Self> + Neg<Output = Self>
{
    /// A constant.
    fn constant(value: f64) -> Self;
    /// Square root; of a negative number NaN.
    fn sqrt(self) -> Self;
    /// Its size.
    fn abs(self) -> Self;
    /// The smaller; `other` if this one is NaN.
    fn min(self, other: Self) -> Self;
    /// `chosen` where this is zero or more, `otherwise` where it is negative or NaN.
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

/// A ray in the frame of the surface, of a batch that travels toward the imager (`FORWARD`) or away from it.
#[derive(Clone, Copy, Debug)]
pub struct Ray<R, const FORWARD: bool> {
    /// A point of it, mm.
    pub position: [R; 3],
    /// Unit direction.
    pub direction: [R; 3],
    /// Square of the position's distance from the axis, mm^2: already at hand.
    pub radius2: R,
}

impl<R: Real, const FORWARD: bool> Ray<R, FORWARD> {
    /// A size with the sign of the sense of travel: positive forward. Two square roots of opposite sign solve most
    /// intersections; this one is on the side that the light comes from.
    #[inline(always)]
    pub fn along(&self, size: R) -> R {
        if FORWARD { size } else { -size }
    }
}

/// Where a ray meets a surface.
#[derive(Clone, Copy, Debug)]
pub struct Hit<R> {
    /// Distance along the ray, mm; may be negative.
    pub distance: R,
    /// Direction . normal, for the normal that points toward +z at the vertex: positive forward, negative backward.
    /// Read only of shapes whose normal is of unit length.
    pub cosine: R,
    /// Negative or NaN where the ray does not meet the surface, or runs against the sense of travel.
    pub valid: R,
}

/// A surface by branch-free code. Mark the methods `#[inline(always)]`.
pub trait KernelShape: Send + Sync + std::fmt::Debug {
    /// Where the ray meets the surface: for a ray along the axis, the vertex.
    fn hit<R: Real, const FORWARD: bool>(&self, ray: Ray<R, FORWARD>) -> Hit<R>;
    /// How many times [`KernelShape::refine`] runs over the batch between `hit` and `finish`: for a shape that is met by
    /// iteration, whose `hit` is a first guess. Each step is a loop over the batch of its own: in one loop the steps of a
    /// ray wait for each other, apart those of several rays are under way at once. Such a shape has no `UNIT_NORMAL`, and
    /// `cosine` carries what it likes from step to step.
    const ROUNDS: usize = 0;
    /// A better hit, from the one before.
    #[inline(always)]
    fn refine<R: Real, const FORWARD: bool>(&self, _ray: Ray<R, FORWARD>, hit: Hit<R>) -> Hit<R> {
        hit
    }
    /// The last one.
    #[inline(always)]
    fn finish<R: Real, const FORWARD: bool>(&self, _ray: Ray<R, FORWARD>, hit: Hit<R>) -> Hit<R> {
        hit
    }
    /// Normal at a point of the surface, toward +z at the vertex; of unit length unless [`KernelShape::UNIT_NORMAL`]
    /// says that it is not.
    fn normal<R: Real>(&self, point: [R; 3]) -> [R; 3];
    /// Whether the normal is of unit length. Where that would cost a square root it need not be: Snell's law holds for
    /// a normal of any length, at the price of a division.
    const UNIT_NORMAL: bool = true;
    /// Whether rays that [`KernelShape::hit`] calls invalid are asked for again, by [`KernelShape::search`]. Then the
    /// distance of an invalid hit must be 0.
    const SEARCHES: bool = false;
    /// The distance, mm, along a ray of which `hit` was not sure: by slow and patient code. `None` where it misses.
    fn search(&self, _position: [f64; 3], _direction: [f64; 3], _travel: Travel) -> Option<f64> {
        None
    }
    /// `mu * direction + push * normal(point)`: the direction behind the surface. A shape whose normal
    /// is linear in the point may save a few operations here. Used of unit normals only.
    #[inline(always)]
    fn bend<R: Real>(&self, point: [R; 3], direction: [R; 3], mu: R, push: R) -> [R; 3] {
        let normal = self.normal(point);
        [
            mu * direction[0] + push * normal[0],
            mu * direction[1] + push * normal[1],
            mu * direction[2] + push * normal[2],
        ]
    }
    /// As [`Surface::sag_mm`].
    fn sag_mm(&self, x_mm: f64, y_mm: f64) -> Option<f64>;
    /// As [`Surface::vertex_curvature_per_mm`].
    fn vertex_curvature_per_mm(&self) -> (f64, f64);
    /// As [`Surface::is_stop`].
    fn is_stop(&self) -> bool {
        false
    }
}

/// Makes a [`Surface`] of a [`KernelShape`].
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
    fn interact(&self, rays: &mut RayBatch, interface: &Interface<'_>, isa: Isa) -> usize {
        match interface.action {
            Action::Refract => interact::<S, REFRACT>(&self.0, rays, interface, isa),
            Action::Reflect => interact::<S, REFLECT>(&self.0, rays, interface, isa),
            Action::Pass => interact::<S, PASS>(&self.0, rays, interface, isa),
        }
    }
}

fn interact<S: KernelShape, const ACTION: u8>(
    shape: &S,
    rays: &mut RayBatch,
    interface: &Interface<'_>,
    isa: Isa,
) -> usize {
    match interface.travel {
        Travel::Forward => interact_along::<S, ACTION, true>(shape, rays, interface, isa),
        Travel::Backward => interact_along::<S, ACTION, false>(shape, rays, interface, isa),
    }
}

const REFRACT: u8 = 0;
const REFLECT: u8 = 1;
const PASS: u8 = 2;

/// Intersection and bending run as two loops over the batch. In one loop the two square roots and the
/// division wait for each other, and what waits behind them fills the processor's schedulers; apart,
/// several rays' roots are under way at once (measured: 1.3 times the rays a second). What both need
/// travels in scratch columns: loads and stores are free here, arithmetic is not. Why a ray ended is
/// asked only where one did.
#[inline]
fn interact_along<S: KernelShape, const ACTION: u8, const FORWARD: bool>(
    shape: &S,
    rays: &mut RayBatch,
    interface: &Interface<'_>,
    isa: Isa,
) -> usize {
    let unsure = isa.run(Intersect::<S, FORWARD> { shape, rays, shift_mm: interface.shift_mm });
    if S::SEARCHES && unsure {
        search(shape, rays, interface.travel);
    }
    isa.run(Bend::<S, ACTION, FORWARD> { shape, rays, interface })
}

/// Moves every ray to the surface; leaves cosine and validity behind. Says, of shapes that search, whether any living
/// ray may have missed.
struct Intersect<'a, S, const FORWARD: bool> {
    shape: &'a S,
    rays: &'a mut RayBatch,
    shift_mm: f64,
}

impl<S: KernelShape, const FORWARD: bool> Vectorized for Intersect<'_, S, FORWARD> {
    type Output = bool;

    #[inline(always)]
    fn run(self) -> bool {
        let (c, s) = self.rays.columns_and_scratch_mut();
        intersect_loop::<S, FORWARD>(
            self.shape,
            self.shift_mm,
            [c.l, c.m, c.n],
            s.radius2,
            c.state,
            c.x,
            c.y,
            c.z,
            s.cosine_then_margin,
            s.valid,
        )
    }
}

/// Bends every ray at its point of the surface and books those that end.
struct Bend<'a, S, const ACTION: u8, const FORWARD: bool> {
    shape: &'a S,
    rays: &'a mut RayBatch,
    interface: &'a Interface<'a>,
}

impl<S: KernelShape, const ACTION: u8, const FORWARD: bool> Vectorized for Bend<'_, S, ACTION, FORWARD> {
    type Output = usize;

    #[inline(always)]
    fn run(self) -> usize {
        if bend_all::<S, ACTION, FORWARD>(self.shape, self.rays, self.interface) {
            book(self.rays, self.interface)
        } else {
            0
        }
    }
}

/// Asks again for the living rays that the fast code was not sure of.
#[cold]
fn search<S: KernelShape>(shape: &S, rays: &mut RayBatch, travel: Travel) {
    let (c, s) = rays.columns_and_scratch_mut();
    for i in 0..c.x.len() {
        if c.state[i] == ALIVE && ends(s.valid[i]) {
            let (p, d) = ([c.x[i], c.y[i], c.z[i]], [c.l[i], c.m[i], c.n[i]]);
            if let Some(t) = shape.search(p, d, travel) {
                (c.x[i], c.y[i], c.z[i]) = (p[0] + t * d[0], p[1] + t * d[1], p[2] + t * d[2]);
                s.valid[i] = 0.0;
            }
        }
    }
}

/// Columns come as arguments of their own: so the compiler knows that none overlaps another, and
/// need not compare their addresses at every call.
#[inline(always)]
fn intersect_loop<S: KernelShape, const FORWARD: bool>(
    shape: &S,
    shift: f64,
    [l, m, n]: [&[f64]; 3],
    radius2: &mut [f64],
    state: &[u64],
    x: &mut [f64],
    y: &mut [f64],
    z: &mut [f64],
    cosine: &mut [f64],
    valid: &mut [f64],
) -> bool {
    let len = x.len();
    // Equal lengths, said once, take the bounds checks out of the loop.
    let (y, z, cosine, valid) = (&mut y[..len], &mut z[..len], &mut cosine[..len], &mut valid[..len]);
    let (l, m, n, radius2, state) = (&l[..len], &m[..len], &n[..len], &mut radius2[..len], &state[..len]);
    if S::ROUNDS > 0 {
        return iterate::<S, FORWARD>(shape, shift, [l, m, n], radius2, state, x, y, z, cosine, valid);
    }
    let mut unsure = false;
    for i in 0..len {
        let p = [x[i], y[i], z[i] - shift];
        let d = [l[i], m[i], n[i]];
        let hit = shape.hit(Ray::<f64, FORWARD> { position: p, direction: d, radius2: radius2[i] });
        let t = hit.distance;
        (x[i], y[i], z[i]) = (p[0] + t * d[0], p[1] + t * d[1], p[2] + t * d[2]);
        cosine[i] = hit.cosine;
        valid[i] = hit.valid;
        if S::SEARCHES {
            unsure |= ends(hit.valid) & (state[i] == ALIVE);
        }
    }
    unsure
}

/// The same for a shape that is met by iteration. The column of x^2 + y^2, which bending writes anew, holds the distance
/// between the steps.
#[inline(always)]
fn iterate<S: KernelShape, const FORWARD: bool>(
    shape: &S,
    shift: f64,
    [l, m, n]: [&[f64]; 3],
    radius2_then_distance: &mut [f64],
    state: &[u64],
    x: &mut [f64],
    y: &mut [f64],
    z: &mut [f64],
    cosine: &mut [f64],
    valid: &mut [f64],
) -> bool {
    let len = x.len();
    let (y, z, cosine, valid) = (&mut y[..len], &mut z[..len], &mut cosine[..len], &mut valid[..len]);
    let (l, m, n, state) = (&l[..len], &m[..len], &n[..len], &state[..len]);
    let distance = &mut radius2_then_distance[..len];
    for i in 0..len {
        z[i] -= shift;
        let (position, direction) = ([x[i], y[i], z[i]], [l[i], m[i], n[i]]);
        let hit = shape.hit(Ray::<f64, FORWARD> { position, direction, radius2: distance[i] });
        (distance[i], cosine[i], valid[i]) = (hit.distance, hit.cosine, hit.valid);
    }
    for _ in 0..S::ROUNDS {
        for i in 0..len {
            let (position, direction) = ([x[i], y[i], z[i]], [l[i], m[i], n[i]]);
            let radius2 = position[0] * position[0] + position[1] * position[1];
            let hit = Hit { distance: distance[i], cosine: cosine[i], valid: valid[i] };
            let hit = shape.refine(Ray::<f64, FORWARD> { position, direction, radius2 }, hit);
            (distance[i], cosine[i], valid[i]) = (hit.distance, hit.cosine, hit.valid);
        }
    }
    let mut unsure = false;
    for i in 0..len {
        let (p, d) = ([x[i], y[i], z[i]], [l[i], m[i], n[i]]);
        let radius2 = p[0] * p[0] + p[1] * p[1];
        let hit = Hit { distance: distance[i], cosine: cosine[i], valid: valid[i] };
        let hit = shape.finish(Ray::<f64, FORWARD> { position: p, direction: d, radius2 }, hit);
        let t = hit.distance;
        (x[i], y[i], z[i]) = (p[0] + t * d[0], p[1] + t * d[1], p[2] + t * d[2]);
        valid[i] = hit.valid;
        if S::SEARCHES {
            unsure |= ends(hit.valid) & (state[i] == ALIVE);
        }
    }
    unsure
}

/// Bends every ray at its point of the surface; says whether any living one ended.
#[inline(always)]
fn bend_all<S: KernelShape, const ACTION: u8, const FORWARD: bool>(
    shape: &S,
    rays: &mut RayBatch,
    at: &Interface<'_>,
) -> bool {
    let (c, s) = rays.columns_and_scratch_mut();
    bend_loop::<S, ACTION, FORWARD>(
        shape,
        at.clip_radius2_mm2,
        [c.x, c.y, c.z, s.valid, at.before.n, at.after.inverse],
        c.state,
        c.l,
        c.m,
        c.n,
        s.radius2,
        s.cosine_then_margin,
    )
}

#[inline(always)]
fn bend_loop<S: KernelShape, const ACTION: u8, const FORWARD: bool>(
    shape: &S,
    clip2: f64,
    [x, y, z, valid, before, inverse_after]: [&[f64]; 6],
    state: &[u64],
    l: &mut [f64],
    m: &mut [f64],
    n: &mut [f64],
    radius2: &mut [f64],
    cosine_then_margin: &mut [f64],
) -> bool {
    let len = x.len();
    let (y, z, valid, state) = (&y[..len], &z[..len], &valid[..len], &state[..len]);
    let (before, inverse_after) = (&before[..len], &inverse_after[..len]);
    let (l, m, n) = (&mut l[..len], &mut m[..len], &mut n[..len]);
    let (radius2, cosine_then_margin) = (&mut radius2[..len], &mut cosine_then_margin[..len]);
    let mut any = false;
    for i in 0..len {
        let q = [x[i], y[i], z[i]];
        let d = [l[i], m[i], n[i]];
        let r2 = q[0] * q[0] + q[1] * q[1];
        radius2[i] = r2;
        // NaN where the ray missed: `min` passes over it to the validity.
        let mut margin = clip2 - r2;
        if ACTION != PASS && !S::UNIT_NORMAL {
            let g = shape.normal(q);
            let length2 = g[0] * g[0] + g[1] * g[1] + g[2] * g[2];
            let along = d[0] * g[0] + d[1] * g[1] + d[2] * g[2];
            let (mut mu, mut push) = (1.0, -2.0 * along / length2);
            if ACTION == REFRACT {
                let k;
                mu = before[i] * inverse_after[i];
                (push, k) = bend::snell_of_length::<FORWARD>(along, mu, length2);
                margin = Real::min(k, margin);
            }
            l[i] = mu * d[0] + push * g[0];
            m[i] = mu * d[1] + push * g[1];
            n[i] = mu * d[2] + push * g[2];
        } else if ACTION == REFRACT {
            let mu = before[i] * inverse_after[i];
            let (push, k) = bend::snell::<FORWARD>(cosine_then_margin[i], mu);
            (l[i], m[i], n[i]) = shape.bend(q, d, mu, push).into();
            margin = Real::min(k, margin);
        } else if ACTION == REFLECT {
            (l[i], m[i], n[i]) = shape.bend(q, d, 1.0, -2.0 * cosine_then_margin[i]).into();
        }
        margin = Real::min(margin, valid[i]);
        cosine_then_margin[i] = margin;
        any |= ends(margin) & (state[i] == ALIVE);
    }
    any
}

/// Whether a margin is negative, or NaN.
#[inline(always)]
fn ends(margin: f64) -> bool {
    !(margin >= 0.0)
}

/// Books the rays that ended here, in the order of the light: a ray that misses cannot be clipped,
/// one that is clipped not reflected. Returns how many.
#[inline(always)]
fn book(rays: &mut RayBatch, at: &Interface<'_>) -> usize {
    let missed = Loss::Missed.state(at.number);
    let vignetted = Loss::Vignetted.state(at.number);
    let total = Loss::TotalReflection.state(at.number);
    let (c, s) = rays.columns_and_scratch_mut();
    let len = c.x.len();
    let (radius2, valid, margin) = (&s.radius2[..len], &s.valid[..len], &s.cosine_then_margin[..len]);
    let state = &mut c.state[..len];
    let mut lost = 0_u64;
    for i in 0..len {
        let mut cause = if radius2[i] <= at.clip_radius2_mm2 { total } else { vignetted };
        cause = if valid[i] >= 0.0 { cause } else { missed };
        let ends = ends(margin[i]) & (state[i] == ALIVE);
        state[i] = if ends { cause } else { state[i] };
        lost += u64::from(ends);
    }
    lost as usize
}
