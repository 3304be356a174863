//! Search for the point where a ray crosses a surface given by its sag: a few steps of Newton's method where they clearly
//! converge, a bracketed search where they do not.

use super::Travel;
use glam::DVec3;

/// Steps of Newton's method before the search takes over; each about doubles the digits.
const NEWTON_STEPS: usize = 12;
/// A step counts as converging if it is at most this fraction of the step before. Below one half, no other crossing can lie
/// between the start and the limit of the steps (the condition of Kantorovich's theorem on Newton's method).
pub(super) const SHORTER: f64 = 0.4;
/// Steps below this (mm) may be rounding, or the noise of slopes taken from differences.
pub(super) const NOISE_MM: f64 = 1e-8;
/// Once a step is smaller than this (mm), the ray has arrived.
pub(super) const ARRIVED_MM: f64 = 1e-13;

/// First step of the search, as a fraction of the distance between ray and vertex.
const FIRST_STEP: f64 = 0.01;
/// Smallest distance between ray and vertex that counts for the first step, mm.
const SMALLEST_MM: f64 = 0.1;
/// Each step is longer than the one before by this factor.
const GROWTH: f64 = 1.1;
/// Number of steps to either side; the last ones end 45 such distances away.
const RINGS: usize = 64;
/// Halvings toward the rim of a surface: 1e-9 of a step.
const RIM_HALVINGS: usize = 30;
/// Halvings toward the summit or the valley between two points.
const EXTREMUM_HALVINGS: usize = 30;
/// Steps within a bracket, each at least a halving.
const BRACKET_STEPS: usize = 120;

/// Returns the distance (mm) at which the ray crosses z = sag(x, y) in its direction of travel (forward: from smaller z to
/// larger). Of several crossings it is the one nearest to `start_mm`. If the search has to start elsewhere, it is the one nearest
/// to the point of the ray that is closest to the vertex.
///
/// `height` returns z - sag at a distance along the ray and the derivative of this along the ray; `None` where the surface does
/// not reach.
pub fn nearest_crossing(
    height: impl Fn(f64) -> Option<(f64, f64)>,
    position: DVec3,
    direction: DVec3,
    travel: Travel,
    start_mm: f64,
) -> Option<f64> {
    let sense = if travel == Travel::Forward { 1.0 } else { -1.0 };
    newton(&height, start_mm, sense).or_else(|| {
        let middle = -position.dot(direction);
        let scale = (position + middle * direction).length();
        if !(scale.is_finite() && middle.is_finite()) {
            return None;
        }
        march(
            &|t| height(t).map(|(value, slope)| (sense * value, sense * slope)),
            middle,
            FIRST_STEP * scale.max(SMALLEST_MM),
        )
        .and_then(|(below, above)| within(&height, below, above, sense))
    })
}

/// Runs Newton's method, as long as every step is well below the one before.
fn newton(height: &impl Fn(f64) -> Option<(f64, f64)>, start: f64, sense: f64) -> Option<f64> {
    if !start.is_finite() {
        return None;
    }
    let (mut t, mut last) = (start, f64::INFINITY);
    for _ in 0..NEWTON_STEPS {
        let (value, slope) = height(t)?;
        let step = value / slope;
        if !(step.abs() <= SHORTER * last + NOISE_MM) {
            return None;
        }
        t -= step;
        last = step.abs();
        if last <= ARRIVED_MM + 2.0 * f64::EPSILON * t.abs() {
            return (slope * sense > 0.0).then_some(t);
        }
    }
    // With slopes from differences the steps end in rounding noise, which is as good as arrived.
    let (_, slope) = height(t)?;
    (last <= 10.0 * ARRIVED_MM + 10.0 * f64::EPSILON * t.abs() && slope * sense > 0.0).then_some(t)
}

/// A place along the ray, the height there, and its derivative.
type HeightSample = (f64, f64, f64);

/// Finds two points, (below, above), between which the ray crosses the surface once from below to above. Searches outward from
/// the middle, to both sides in turn.
fn march(height: &impl Fn(f64) -> Option<(f64, f64)>, middle: f64, first: f64) -> Option<(f64, f64)> {
    let place = |t: f64| height(t).map(|(value, slope)| (t, value, slope));
    let here = place(middle);
    // For each side: the place reached, and what is there.
    let mut sides = [(middle, here), (middle, here)];
    let mut step = first;
    for _ in 0..RINGS {
        for (side, outward) in sides.iter_mut().zip([-1.0, 1.0]) {
            let (at, was) = *side;
            let next = at + outward * step;
            let is = place(next);
            *side = (next, is);
            // Where only one of the two points has surface, the interval ends at its rim.
            let (from, to) = match (was, is) {
                (Some(a), Some(b)) => (a, b),
                (Some(a), None) => (a, rim(&place, a, next)),
                (None, Some(b)) => (rim(&place, b, at), b),
                (None, None) => continue,
            };
            let (low, high) = if outward > 0.0 { (from, to) } else { (to, from) };
            if let Some(found) = between(&place, low, high) {
                return Some(found);
            }
        }
        step *= GROWTH;
    }
    None
}

/// Brackets the crossing from below to above between two places. If both have the same sign, the crossing may lie beside a
/// summit or a valley between them.
fn between(place: &impl Fn(f64) -> Option<HeightSample>, low: HeightSample, high: HeightSample) -> Option<(f64, f64)> {
    if low.1 < 0.0 && high.1 >= 0.0 {
        return Some((low.0, high.0));
    }
    let summit = low.1 < 0.0 && high.1 < 0.0 && low.2 > 0.0 && high.2 < 0.0;
    let valley = low.1 >= 0.0 && high.1 >= 0.0 && low.2 < 0.0 && high.2 > 0.0;
    if !summit && !valley {
        return None;
    }
    let (mut a, mut b) = (low.0, high.0);
    for _ in 0..EXTREMUM_HALVINGS {
        let (t, value, slope) = place(0.5 * (a + b))?;
        if summit && value >= 0.0 {
            return Some((low.0, t));
        }
        if valley && value < 0.0 {
            return Some((t, high.0));
        }
        if (slope > 0.0) == summit { a = t } else { b = t }
    }
    None
}

/// Finds the last place with surface between `on`, which has surface, and `off`, which has none.
fn rim(place: &impl Fn(f64) -> Option<HeightSample>, on: HeightSample, off: f64) -> HeightSample {
    let (mut on, mut off) = (on, off);
    for _ in 0..RIM_HALVINGS {
        let middle = 0.5 * (on.0 + off);
        match place(middle) {
            Some(found) => on = found,
            None => off = middle,
        }
    }
    on
}

/// Runs Newton's method in a bracket: a step that leaves it, or is not below half of the one before, becomes a bisection.
fn within(height: &impl Fn(f64) -> Option<(f64, f64)>, below: f64, above: f64, sense: f64) -> Option<f64> {
    let (mut below, mut above) = (below, above);
    let mut t = 0.5 * (below + above);
    let mut last = (above - below).abs();
    for _ in 0..BRACKET_STEPS {
        let (value, slope) = height(t)?;
        if sense * value < 0.0 {
            below = t;
        } else {
            above = t;
        }
        let newton = t - value / slope;
        let inside = (newton - below) * (newton - above) <= 0.0 && (newton - t).abs() < 0.5 * last;
        let next = if inside { newton } else { 0.5 * (below + above) };
        last = (next - t).abs();
        t = next;
        if last <= ARRIVED_MM + 2.0 * f64::EPSILON * t.abs() {
            let (_, slope) = height(t)?;
            return (slope * sense > 0.0).then_some(t);
        }
    }
    None
}
