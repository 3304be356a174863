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
//! A ray stays where it has arrived, so its bits do not depend on its neighbors. A ray whose steps do not clearly shrink is passed to a
//! bracketed search. Every ray therefore lands on its sheet or is booked as missed.

use super::{Action, Interface, Surface, Travel, bend};
use crate::RayBatch;
use crate::isa::Vectorized;
use crate::loss::{ALIVE, Loss};
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
    /// Gives `size` the sign of the direction of travel: positive forward. Most intersections are solved by a square root of
    /// either sign; this picks the one on the side that the light comes from.
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
    /// Direction . normal, with the normal that points toward +z at the vertex: positive forward, negative backward.
    /// Read only for shapes whose normal has unit length.
    pub cosine: R,
    /// Negative or NaN where the ray misses the surface or runs against the direction of travel.
    pub valid: R,
}

/// State of a ray on its steps toward a surface.
#[derive(Clone, Copy, Debug)]
pub struct Near<R> {
    /// Distance along the ray, mm.
    pub distance: R,
    /// Values that the shape keeps for the next step.
    pub kept: [R; 2],
    /// Size of the last step, mm; 0 once the ray has arrived.
    pub step: R,
    /// Negative or NaN if the ray misses; see [`Hit::valid`].
    pub valid: R,
}

/// Largest number of times that [`KernelShape::settle`] runs. A ray that has not arrived by then is searched for.
const MOST_SETTLING: usize = 4;

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
    /// Returns what [`KernelShape::settle`] keeps, for a point of the surface.
    #[inline(always)]
    fn keep<R: Real>(&self, _point: [R; 3]) -> [R; 2] {
        [R::constant(0.0); 2]
    }
    /// Computes the normal from the values that were kept.
    #[inline(always)]
    fn normal_kept<R: Real>(&self, point: [R; 3], _kept: [R; 2]) -> [R; 3] {
        self.normal(point)
    }
    /// Normal at a point of the surface, toward +z at the vertex; of unit length if [`KernelShape::UNIT_NORMAL`] says so.
    fn normal<R: Real>(&self, point: [R; 3]) -> [R; 3];
    /// Whether the normal has unit length. Set this to false if unit length would cost a square root: Snell's law works with
    /// any length, at the price of a division.
    const UNIT_NORMAL: bool = true;
    /// Whether [`KernelShape::search`] tries again for rays that [`KernelShape::hit`] calls invalid. The distance of an invalid
    /// hit must then be 0.
    const SEARCHES: bool = false;
    /// Finds the distance, mm, along a ray that `hit` could not settle, with slower and safer code; `None` if the ray misses.
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
            Action::Refract => interact::<S, REFRACT>(&self.0, rays, interface),
            Action::Reflect => interact::<S, REFLECT>(&self.0, rays, interface),
            Action::Pass => interact::<S, PASS>(&self.0, rays, interface),
        }
    }
}

fn interact<S: KernelShape, const ACTION: u8>(shape: &S, rays: &mut RayBatch, interface: &Interface<'_>) -> usize {
    match interface.travel {
        Travel::Forward => interact_along::<S, ACTION, true>(shape, rays, interface),
        Travel::Backward => interact_along::<S, ACTION, false>(shape, rays, interface),
    }
}

const REFRACT: u8 = 0;
const REFLECT: u8 = 1;
const PASS: u8 = 2;

/// Runs intersection and bending as two loops over the batch. In a single loop the two square roots and the division wait for
/// each other, and the work behind them fills the processor's schedulers. In separate loops the roots of several rays overlap
/// (measured: 1.3 times the rays per second). Values that both loops need go through scratch columns: loads and stores are free
/// here, arithmetic is not. The cause of a loss is worked out only for rays that ended.
#[inline]
fn interact_along<S: KernelShape, const ACTION: u8, const FORWARD: bool>(
    shape: &S,
    rays: &mut RayBatch,
    interface: &Interface<'_>,
) -> usize {
    let isa = rays.isa();
    let unsure = isa.run(Intersect::<S, FORWARD> { shape, rays, shift_mm: interface.shift_mm });
    if S::SEARCHES && unsure {
        search(shape, rays, interface.travel);
    }
    isa.run(Bend::<S, ACTION, FORWARD> { shape, rays, interface })
}

/// Moves every ray to the surface and leaves cosine and validity in the scratch columns. For shapes that search, returns
/// whether any living ray may have missed.
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
        if S::STEPS {
            return step_loops::<S, FORWARD>(
                self.shape,
                self.shift_mm,
                [c.l, c.m, c.n],
                [s.radius2, s.cosine_then_margin, s.kept_then_versine, s.step_then_way, s.valid],
                c.state,
                c.x,
                c.y,
                c.z,
            );
        }
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
            s.step_then_way,
        )
    }
}

/// Bends every ray at its point on the surface and records those that end.
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

/// Searches again for the living rays that the fast code could not settle.
#[cold]
fn search<S: KernelShape>(shape: &S, rays: &mut RayBatch, travel: Travel) {
    let (c, s) = rays.columns_and_scratch_mut();
    for i in 0..c.x.len() {
        if c.state[i] == ALIVE && ends(s.valid[i]) {
            let (p, d) = ([c.x[i], c.y[i], c.z[i]], [c.l[i], c.m[i], c.n[i]]);
            if let Some(t) = shape.search(p, d, travel) {
                let q = [p[0] + t * d[0], p[1] + t * d[1], p[2] + t * d[2]];
                (c.x[i], c.y[i], c.z[i]) = q.into();
                (s.valid[i], s.step_then_way[i]) = (0.0, t);
                if S::STEPS {
                    [s.cosine_then_margin[i], s.kept_then_versine[i]] = shape.keep(q);
                }
            }
        }
    }
}

/// Intersects all rays with the surface. Columns are separate arguments, so the compiler knows that none overlaps another and
/// need not compare addresses at every call.
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
    way: &mut [f64],
) -> bool {
    let len = x.len();
    // Stating the equal lengths once removes the bounds checks from the loop.
    let (y, z, cosine, valid) = (&mut y[..len], &mut z[..len], &mut cosine[..len], &mut valid[..len]);
    let (l, m, n, radius2, state) = (&l[..len], &m[..len], &n[..len], &mut radius2[..len], &state[..len]);
    let way = &mut way[..len];
    let mut unsure = false;
    for i in 0..len {
        let p = [x[i], y[i], z[i] - shift];
        let d = [l[i], m[i], n[i]];
        let hit = shape.hit(Ray::<f64, FORWARD> { position: p, direction: d, radius2: radius2[i] });
        let t = hit.distance;
        (x[i], y[i], z[i]) = (p[0] + t * d[0], p[1] + t * d[1], p[2] + t * d[2]);
        (cosine[i], valid[i], way[i]) = (hit.cosine, hit.valid, t);
        if S::SEARCHES {
            unsure |= ends(hit.valid) & (state[i] == ALIVE);
        }
    }
    unsure
}

/// Intersects all rays with a shape that they come to in steps. Between the steps, the column of x^2 + y^2, which bending
/// rewrites, holds the distance. The result for a ray does not depend on its neighbors: once it has arrived it stays where it
/// is.
#[inline(always)]
fn step_loops<S: KernelShape, const FORWARD: bool>(
    shape: &S,
    shift: f64,
    [l, m, n]: [&[f64]; 3],
    [distance, first, second, step, valid]: [&mut [f64]; 5],
    state: &[u64],
    x: &mut [f64],
    y: &mut [f64],
    z: &mut [f64],
) -> bool {
    let len = x.len();
    guess_loop::<S, FORWARD>(shape, shift, [x, y, l, m, n], z, distance, first, valid);
    let (x, y, z) = (&mut x[..len], &mut y[..len], &mut z[..len]);
    let place: [&[f64]; 6] = [x, y, z, l, m, n];
    near_loop::<S, FORWARD, APPROACH>(shape, place, distance, first, second, step, valid);
    near_loop::<S, FORWARD, CORRECT>(shape, place, distance, first, second, step, valid);
    near_loop::<S, FORWARD, SETTLE>(shape, place, distance, first, second, step, valid);
    for _ in 1..MOST_SETTLING {
        let under_way = |i: usize| (step[i] > 0.0) & (valid[i] >= 0.0) & (state[i] == ALIVE);
        if !(0..len).any(under_way) {
            break;
        }
        near_loop::<S, FORWARD, SETTLE_ON>(shape, place, distance, first, second, step, valid);
    }
    move_loop(x, y, z, [l, m, n], distance, step, valid, state)
}

#[inline(always)]
fn guess_loop<S: KernelShape, const FORWARD: bool>(
    shape: &S,
    shift: f64,
    [x, y, l, m, n]: [&[f64]; 5],
    z: &mut [f64],
    radius2_then_distance: &mut [f64],
    cosine: &mut [f64],
    valid: &mut [f64],
) {
    let len = x.len();
    let (y, z, l, m, n) = (&y[..len], &mut z[..len], &l[..len], &m[..len], &n[..len]);
    let (distance, cosine, valid) = (&mut radius2_then_distance[..len], &mut cosine[..len], &mut valid[..len]);
    for i in 0..len {
        z[i] -= shift;
        let (position, direction) = ([x[i], y[i], z[i]], [l[i], m[i], n[i]]);
        let hit = shape.hit(Ray::<f64, FORWARD> { position, direction, radius2: distance[i] });
        (distance[i], cosine[i], valid[i]) = (hit.distance, hit.cosine, hit.valid);
    }
}

const APPROACH: u8 = 0;
const CORRECT: u8 = 1;
const SETTLE: u8 = 2;
const SETTLE_ON: u8 = 3;

/// Takes one step with all rays; [`SETTLE_ON`] moves only those that have not arrived.
#[inline(always)]
fn near_loop<S: KernelShape, const FORWARD: bool, const STEP: u8>(
    shape: &S,
    [x, y, z, l, m, n]: [&[f64]; 6],
    distance: &mut [f64],
    first: &mut [f64],
    second: &mut [f64],
    step: &mut [f64],
    valid: &mut [f64],
) {
    let len = x.len();
    let (y, z, l, m, n) = (&y[..len], &z[..len], &l[..len], &m[..len], &n[..len]);
    let (distance, first, second) = (&mut distance[..len], &mut first[..len], &mut second[..len]);
    let (step, valid) = (&mut step[..len], &mut valid[..len]);
    for i in 0..len {
        let (position, direction) = ([x[i], y[i], z[i]], [l[i], m[i], n[i]]);
        let radius2 = position[0] * position[0] + position[1] * position[1];
        let ray = Ray::<f64, FORWARD> { position, direction, radius2 };
        let near = Near { distance: distance[i], kept: [first[i], second[i]], step: step[i], valid: valid[i] };
        let next = match STEP {
            APPROACH => shape.approach(ray, Hit { distance: distance[i], cosine: first[i], valid: valid[i] }),
            CORRECT => shape.correct(ray, near),
            _ => shape.settle(ray, near),
        };
        let near = if STEP != SETTLE_ON || near.step > 0.0 { next } else { near };
        (distance[i], [first[i], second[i]], step[i], valid[i]) = (near.distance, near.kept, near.step, near.valid);
    }
}

/// Moves the rays that have arrived, and replaces the last step by the distance traveled. Returns whether any living ray has
/// not arrived.
#[inline(always)]
fn move_loop(
    x: &mut [f64],
    y: &mut [f64],
    z: &mut [f64],
    [l, m, n]: [&[f64]; 3],
    distance: &[f64],
    step_then_way: &mut [f64],
    valid: &mut [f64],
    state: &[u64],
) -> bool {
    let len = x.len();
    let (y, z, l, m, n) = (&mut y[..len], &mut z[..len], &l[..len], &m[..len], &n[..len]);
    let (distance, step, valid, state) =
        (&distance[..len], &mut step_then_way[..len], &mut valid[..len], &state[..len]);
    let mut unsure = false;
    for i in 0..len {
        valid[i] = if step[i] > 0.0 { -1.0 } else { valid[i] };
        let t = if valid[i] >= 0.0 { distance[i] } else { 0.0 };
        step[i] = t;
        (x[i], y[i], z[i]) = (x[i] + t * l[i], y[i] + t * m[i], z[i] + t * n[i]);
        unsure |= ends(valid[i]) & (state[i] == ALIVE);
    }
    unsure
}

/// Bends every ray at its point on the surface; returns whether any living ray ended.
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
        s.kept_then_versine,
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
    kept_then_versine: &mut [f64],
) -> bool {
    let len = x.len();
    let (y, z, valid, state) = (&y[..len], &z[..len], &valid[..len], &state[..len]);
    let (before, inverse_after) = (&before[..len], &inverse_after[..len]);
    let (l, m, n) = (&mut l[..len], &mut m[..len], &mut n[..len]);
    let (radius2, cosine_then_margin) = (&mut radius2[..len], &mut cosine_then_margin[..len]);
    let kept_then_versine = &mut kept_then_versine[..len];
    let mut any = false;
    for i in 0..len {
        let q = [x[i], y[i], z[i]];
        let d = [l[i], m[i], n[i]];
        let r2 = q[0] * q[0] + q[1] * q[1];
        radius2[i] = r2;
        // NaN if the ray missed: `min` then takes the validity.
        let mut margin = clip2 - r2;
        if ACTION != PASS && !S::UNIT_NORMAL {
            let g = if S::STEPS {
                shape.normal_kept(q, [cosine_then_margin[i], kept_then_versine[i]])
            } else {
                shape.normal(q)
            };
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
        if ACTION != PASS {
            let turn = [l[i] - d[0], m[i] - d[1], n[i] - d[2]];
            kept_then_versine[i] = 0.5 * (turn[0] * turn[0] + turn[1] * turn[1] + turn[2] * turn[2]);
        }
        margin = Real::min(margin, valid[i]);
        cosine_then_margin[i] = margin;
        any |= ends(margin) & (state[i] == ALIVE);
    }
    any
}

/// Returns whether a margin is negative, or NaN.
#[inline(always)]
fn ends(margin: f64) -> bool {
    !(margin >= 0.0)
}

/// Records the rays that ended here, and returns how many. Causes are tested in the order in which light meets them: a ray that
/// misses cannot be clipped, and a clipped one cannot be totally reflected.
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
