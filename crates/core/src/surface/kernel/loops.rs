//! The loops of a kernel over a batch. What happens to one ray is in `one_ray`.

use super::one_ray::{self, APPROACH, CORRECT, PASS, SETTLE, SETTLE_ON, ends};
use super::{KernelShape, Near, Ray, Real};
use crate::RayBatch;
use crate::isa::Vectorized;
use crate::loss::{ALIVE, Loss};
use crate::surface::{Interface, Travel};

/// Largest number of times that [`KernelShape::settle`] runs. A ray that has not arrived by then is searched for.
const MOST_SETTLING: usize = 4;

/// Intersects and bends a batch of rays; returns how many ended here.
pub(super) fn interact<S: KernelShape, const ACTION: u8>(
    shape: &S,
    rays: &mut RayBatch,
    interface: &Interface<'_>,
) -> usize {
    match interface.travel {
        Travel::Forward => interact_along::<S, ACTION, true>(shape, rays, interface),
        Travel::Backward => interact_along::<S, ACTION, false>(shape, rays, interface),
    }
}

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
        let near = one_ray::step::<S, FORWARD, STEP>(shape, ray, near);
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
        let bent = one_ray::bend::<S, ACTION, FORWARD>(
            shape,
            [x[i], y[i], z[i]],
            [l[i], m[i], n[i]],
            [before[i], inverse_after[i]],
            [cosine_then_margin[i], kept_then_versine[i]],
        );
        radius2[i] = bent.radius2;
        if ACTION != PASS {
            (l[i], m[i], n[i]) = bent.direction.into();
            kept_then_versine[i] = bent.versine;
        }
        // NaN if the ray missed: `min` then takes the validity.
        let margin = Real::min(Real::min(bent.inside, clip2 - bent.radius2), valid[i]);
        cosine_then_margin[i] = margin;
        any |= ends(margin) & (state[i] == ALIVE);
    }
    any
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
        let cause =
            if valid[i] >= 0.0 { if radius2[i] <= at.clip_radius2_mm2 { total } else { vignetted } } else { missed };
        let ends = ends(margin[i]) & (state[i] == ALIVE);
        state[i] = if ends { cause } else { state[i] };
        lost += u64::from(ends);
    }
    lost as usize
}
