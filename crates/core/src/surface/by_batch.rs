//! Intersection of whole batches with surfaces given by their sag. The rays of a chunk take each step side by side. The sag is
//! then vectorized where the compiler can do it; elsewhere divisions and roots of many rays are in flight at once.
//!
//! The search of a single ray ([`super::FromSag`]) asks for slopes at every step. This one uses secants: one sag per step, and
//! the slopes once, where the ray arrives. A ray whose steps do not clearly converge is searched alone. The result for a ray
//! does not depend on its neighbors: once it has arrived it stays where it is.

use super::search::{ARRIVED_MM, NOISE_MM, SHORTER};
use super::{Action, Interface, SagShape, ScalarShape, bend};
use crate::RayBatch;
use crate::isa::Vectorized;
use crate::loss::{ALIVE, Loss};
use glam::DVec3;

/// Number of rays that step side by side; their data fit into the first-level cache.
const CHUNK: usize = 64;
/// Largest number of steps.
const STEPS: usize = 12;
/// A ray has arrived once the square of its step, over the step before, is at most this, mm. About so much distance would be
/// left if the steps kept shrinking at the last rate; steps of secants shrink faster and faster.
const LEFT_MM: f64 = 1e-13;

type Column = [f64; CHUNK];

/// Intersections of the rays of a chunk with the surface.
struct Intersections {
    /// Distance from the vertex plane, mm; NaN where a ray misses.
    t: Column,
    slope: [Column; 2],
    /// Positive where the steps converged.
    found: Column,
    /// Margin of a ray against clipping at the rim, mm^2, and against total reflection; negative if it ends.
    margin: [Column; 2],
}

/// Columns of some rays in the frame of the surface.
struct ChunkColumns<'a> {
    x: &'a mut [f64],
    y: &'a mut [f64],
    z: &'a mut [f64],
    l: &'a mut [f64],
    m: &'a mut [f64],
    n: &'a mut [f64],
    state: &'a mut [u64],
}

impl ChunkColumns<'_> {
    fn ray(&self, i: usize) -> [DVec3; 2] {
        [DVec3::new(self.x[i], self.y[i], self.z[i]), DVec3::new(self.l[i], self.m[i], self.n[i])]
    }
}

/// Does the work of [`super::Surface::interact`] with the sag. `alone` searches a single ray. `beside` tells which rays, by
/// position and direction, pass beside the surface; they end as vignetted.
pub(super) fn interact<S: SagShape>(
    shape: &S,
    alone: &impl ScalarShape,
    rays: &mut RayBatch,
    at: &Interface<'_>,
    beside: Option<impl Fn(DVec3, DVec3) -> bool>,
) -> usize {
    let isa = rays.isa();
    let c = rays.columns_mut();
    let mut lost = 0;
    for first in (0..c.x.len()).step_by(CHUNK) {
        let span = first..(first + CHUNK).min(c.x.len());
        let part = &mut ChunkColumns {
            x: &mut c.x[span.clone()],
            y: &mut c.y[span.clone()],
            z: &mut c.z[span.clone()],
            l: &mut c.l[span.clone()],
            m: &mut c.m[span.clone()],
            n: &mut c.n[span.clone()],
            state: &mut c.state[span.clone()],
        };
        part.z.iter_mut().for_each(|z| *z -= at.shift_mm);
        if let Some(beside) = &beside {
            for i in 0..part.x.len() {
                let [position, direction] = part.ray(i);
                if part.state[i] == ALIVE && beside(position, direction) {
                    part.state[i] = Loss::Vignetted.state(at.number);
                    lost += 1;
                }
            }
        }
        const ZERO: Column = [0.0; CHUNK];
        let met = &mut Intersections { t: ZERO, slope: [ZERO; 2], found: ZERO, margin: [ZERO; 2] };
        isa.run(Meet { shape, part, met });
        for i in 0..part.x.len() {
            if part.state[i] == ALIVE && !(met.found[i] > 0.0) {
                let [position, direction] = part.ray(i);
                let hit = alone.intersect(position, direction);
                met.t[i] = hit.map_or(f64::NAN, |hit| hit.distance_mm);
                [met.slope[0][i], met.slope[1][i]] = hit.map_or([0.0; 2], |hit| [-hit.normal.x, -hit.normal.y]);
            }
        }
        let mu = [&at.before.n[span.clone()], &at.after.inverse[span]];
        let turn = Turn { part, met, mu };
        let any = match at.action {
            Action::Refract => isa.run(TurnBy::<REFRACT> { turn, clip_radius2_mm2: at.clip_radius2_mm2 }),
            Action::Reflect => isa.run(TurnBy::<REFLECT> { turn, clip_radius2_mm2: at.clip_radius2_mm2 }),
            Action::Pass => isa.run(TurnBy::<PASS> { turn, clip_radius2_mm2: at.clip_radius2_mm2 }),
        };
        if any {
            lost += book(part.state, met, at.number);
        }
    }
    lost
}

/// Moves rays to the vertex plane, so that a far source costs no precision, and steps from there to the surface.
struct Meet<'a, 'b, S> {
    shape: &'a S,
    part: &'a mut ChunkColumns<'b>,
    met: &'a mut Intersections,
}

impl<S: SagShape> Vectorized for Meet<'_, '_, S> {
    type Output = ();

    #[inline(always)]
    fn run(self) {
        let Self { shape, part, met } = self;
        let len = part.x.len().min(CHUNK);
        let (x, y, z, state) = (&mut part.x[..len], &mut part.y[..len], &mut part.z[..len], &part.state[..len]);
        let (l, m, n) = (&part.l[..len], &part.m[..len], &part.n[..len]);
        let (t, found) = (&mut met.t[..len], &mut met.found[..len]);
        // 1 while a ray is under way.
        let mut open = [0.0; CHUNK];
        let (mut height, mut before, mut step, mut last) = ([0.0; CHUNK], [0.0; CHUNK], [0.0; CHUNK], [0.0; CHUNK]);
        for i in 0..len {
            let to_plane = -z[i] / n[i];
            (x[i], y[i], z[i]) = (x[i] + to_plane * l[i], y[i] + to_plane * m[i], z[i] + to_plane * n[i]);
            open[i] = if (state[i] == ALIVE) & to_plane.is_finite() { 1.0 } else { 0.0 };
            // The first step is the one to a flat surface.
            (before[i], step[i], last[i]) = (0.0, -1.0, f64::INFINITY);
            t[i] = 0.0;
        }
        for number in 0..STEPS {
            for i in 0..len {
                // A plugin's code never sees the position of a ray that has ended.
                let (at_x, at_y) = if open[i] > 0.0 { (x[i] + t[i] * l[i], y[i] + t[i] * m[i]) } else { (0.0, 0.0) };
                let sag = shape.sag_mm(at_x, at_y);
                height[i] = z[i] + t[i] * n[i] - sag.unwrap_or(f64::NAN);
            }
            let mut under_way = 0.0;
            for i in 0..len {
                let slope_times_step = if number == 0 { -n[i] } else { height[i] - before[i] };
                let next = -height[i] * step[i] / slope_times_step;
                let size = next.abs();
                let arrived = (size <= ARRIVED_MM + 2.0 * f64::EPSILON * t[i].abs())
                    | ((number > 0) & (size * size <= LEFT_MM * last[i]));
                let leads_home = size <= SHORTER * last[i] + NOISE_MM;
                let is_open = open[i] > 0.0;
                t[i] += if is_open & leads_home { next } else { 0.0 };
                found[i] = if is_open & leads_home & arrived { 1.0 } else { found[i] };
                open[i] = if is_open & leads_home & !arrived { 1.0 } else { 0.0 };
                under_way += open[i];
                (before[i], step[i], last[i]) = (height[i], next, size);
            }
            if !(under_way > 0.0) {
                break;
            }
        }
        let [slope_x, slope_y] = met.slope.each_mut().map(|column| &mut column[..len]);
        for i in 0..len {
            let (at_x, at_y) = if found[i] > 0.0 { (x[i] + t[i] * l[i], y[i] + t[i] * m[i]) } else { (0.0, 0.0) };
            let slope = shape.slope(at_x, at_y);
            (slope_x[i], slope_y[i]) = slope.unwrap_or((f64::NAN, f64::NAN));
        }
        for i in 0..len {
            // The ray must cross the surface in its direction of travel.
            let slope = 1.0 - (l[i] * slope_x[i] + m[i] * slope_y[i]) / n[i];
            found[i] = if slope > 0.0 { found[i] } else { 0.0 };
        }
    }
}

const REFRACT: u8 = 0;
const REFLECT: u8 = 1;
const PASS: u8 = 2;

/// Moves rays to their points on the surface, and bends them there.
struct Turn<'a, 'b> {
    part: &'a mut ChunkColumns<'b>,
    met: &'a mut Intersections,
    /// Index before the surface, and one over the index after it.
    mu: [&'a [f64]; 2],
}

struct TurnBy<'a, 'b, const ACTION: u8> {
    turn: Turn<'a, 'b>,
    clip_radius2_mm2: f64,
}

impl<const ACTION: u8> Vectorized for TurnBy<'_, '_, ACTION> {
    /// Whether any living ray ends.
    type Output = bool;

    #[inline(always)]
    fn run(self) -> bool {
        let Turn { part, met, mu: [n_before, per_n_after] } = self.turn;
        let len = part.x.len().min(CHUNK);
        let (x, y, z, state) = (&mut part.x[..len], &mut part.y[..len], &mut part.z[..len], &part.state[..len]);
        let (l, m, n) = (&mut part.l[..len], &mut part.m[..len], &mut part.n[..len]);
        let (n_before, per_n_after) = (&n_before[..len], &per_n_after[..len]);
        let (t, [sx, sy]) = (&met.t[..len], met.slope.each_ref().map(|column| &column[..len]));
        let [inside, refracts] = met.margin.each_mut().map(|column| &mut column[..len]);
        let mut any = false;
        for i in 0..len {
            (x[i], y[i], z[i]) = (x[i] + t[i] * l[i], y[i] + t[i] * m[i], z[i] + t[i] * n[i]);
            inside[i] = self.clip_radius2_mm2 - (x[i] * x[i] + y[i] * y[i]);
            refracts[i] = 0.0;
            if ACTION != PASS {
                let length2 = 1.0 + sx[i] * sx[i] + sy[i] * sy[i];
                let along = n[i] - (l[i] * sx[i] + m[i] * sy[i]);
                let (mut mu, mut push) = (1.0, -2.0 * along / length2);
                if ACTION == REFRACT {
                    mu = n_before[i] * per_n_after[i];
                    let (away, k) = bend::snell_of_length::<true>(along.abs(), mu, length2);
                    push = away * 1_f64.copysign(along);
                    refracts[i] = k;
                }
                (l[i], m[i], n[i]) = (mu * l[i] - push * sx[i], mu * m[i] - push * sy[i], mu * n[i] + push);
            }
            any |= !((inside[i] >= 0.0) & (refracts[i] >= 0.0)) & (state[i] == ALIVE);
        }
        any
    }
}

/// Records the rays that ended, in the order in which light meets the causes; returns how many.
fn book(state: &mut [u64], met: &Intersections, number: u32) -> usize {
    let mut lost = 0;
    for (i, state) in state.iter_mut().enumerate().filter(|(_, state)| **state == ALIVE) {
        let cause = if met.margin[0][i].is_nan() {
            Loss::Missed
        } else if met.margin[0][i] < 0.0 {
            Loss::Vignetted
        } else if !(met.margin[1][i] >= 0.0) {
            Loss::TotalReflection
        } else {
            continue;
        };
        *state = cause.state(number);
        lost += 1;
    }
    lost
}
