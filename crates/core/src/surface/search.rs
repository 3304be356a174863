//! Where a ray crosses a surface that is given by its sag: a few steps of Newton's method where they plainly lead
//! home, a patient search where they do not.

use super::Travel;
use glam::DVec3;

/// Steps of Newton's method before the search takes over; each about doubles the digits.
const NEWTON_STEPS: usize = 12;
/// A step counts as shorter than the one before if it is this part of it. Below one half, no other crossing can lie
/// between the start and the point that the steps tend to (the condition of Kantorovich's theorem on Newton's method).
const SHORTER: f64 = 0.4;
/// Steps below this, mm, may be rounding, or the noise of slopes taken by differences.
const NOISE_MM: f64 = 1e-8;
/// Where a step is smaller than this, mm, the ray has arrived.
const ARRIVED_MM: f64 = 1e-13;

/// First step of the search, as a part of the distance between ray and vertex.
const FIRST_STEP: f64 = 0.01;
/// Least such distance, mm.
const SMALLEST_MM: f64 = 0.1;
/// Each step is longer than the one before by this factor.
const GROWTH: f64 = 1.1;
/// Steps to either side: the last ones end 45 distances away.
const RINGS: usize = 64;
/// Halvings toward the rim of a surface: 1e-9 of a step.
const RIM_HALVINGS: usize = 30;
/// Steps within a bracket, each at least a halving.
const BRACKET_STEPS: usize = 120;

/// The distance, mm, at which the ray crosses z = sag(x, y) in the sense of travel: forward from smaller z to larger.
/// Where it does so more than once, the crossing nearest to `start_mm` (or, if the search has to begin elsewhere, to
/// the point of the ray nearest to the vertex).
///
/// `height` gives z - sag at a distance along the ray and the derivative of that along the ray; `None` where the
/// surface does not reach.
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
        march(&|t| height(t).map(|(value, _)| sense * value), middle, FIRST_STEP * scale.max(SMALLEST_MM))
            .and_then(|(below, above)| within(&height, below, above, sense))
    })
}

/// Newton's method, as long as every step is well below the one before.
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
    // Slopes by differences end in a dance of rounding, which is as good as arrived.
    let (_, slope) = height(t)?;
    (last <= 10.0 * ARRIVED_MM + 10.0 * f64::EPSILON * t.abs() && slope * sense > 0.0).then_some(t)
}

/// Two neighboring points between which the surface is crossed from below to above, (below, above): looked for outward
/// from the middle, to both sides in turn.
fn march(height: &impl Fn(f64) -> Option<f64>, middle: f64, first: f64) -> Option<(f64, f64)> {
    let here = height(middle);
    // Each side: the place reached, and the height there.
    let mut sides = [(middle, here), (middle, here)];
    let mut step = first;
    for _ in 0..RINGS {
        for (i, outward) in [-1.0, 1.0].into_iter().enumerate() {
            let (at, was) = sides[i];
            let next = at + outward * step;
            let is = height(next);
            // Where only one of the two points has surface, the interval ends at its rim.
            let (from, to) = match (was, is) {
                (Some(a), Some(b)) => ((at, a), (next, b)),
                (Some(a), None) => ((at, a), rim(height, at, a, next)),
                (None, Some(b)) => (rim(height, next, b, at), (next, b)),
                (None, None) => ((at, 0.0), (at, 0.0)),
            };
            let ((low, a), (high, b)) = if outward > 0.0 { (from, to) } else { (to, from) };
            // The sign says which side of the surface, not where the ray came from: along the ray from - to +.
            if a < 0.0 && b >= 0.0 {
                return Some((low, high));
            }
            sides[i] = (next, is);
        }
        step *= GROWTH;
    }
    None
}

/// The last point that has surface between `on`, which has, and `off`, which has not; with the height there.
fn rim(height: &impl Fn(f64) -> Option<f64>, on: f64, value: f64, off: f64) -> (f64, f64) {
    let (mut on, mut value, mut off) = (on, value, off);
    for _ in 0..RIM_HALVINGS {
        let middle = 0.5 * (on + off);
        match height(middle) {
            Some(v) => (on, value) = (middle, v),
            None => off = middle,
        }
    }
    (on, value)
}

/// Newton's method held in a bracket: a step that leaves it, or is not below half of the one before, is a halving.
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
