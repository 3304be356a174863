//! What a kernel does to one ray: the bodies of its loops, without branches.

use super::{Hit, KernelShape, Near, Ray};
use crate::surface::bend;

/// The action of an interface as a constant, so that each has loops of its own.
pub(super) const REFRACT: u8 = 0;
pub(super) const REFLECT: u8 = 1;
pub(super) const PASS: u8 = 2;

/// The first step toward a surface.
pub(super) const APPROACH: u8 = 0;
/// The second step.
pub(super) const CORRECT: u8 = 1;
/// The third step.
pub(super) const SETTLE: u8 = 2;
/// Each step after the third; a ray that has arrived stays where it is.
pub(super) const SETTLE_ON: u8 = 3;

/// Returns whether a margin is negative, or NaN.
#[inline(always)]
pub(super) fn ends(margin: f64) -> bool {
    !(margin >= 0.0)
}

/// Takes one step toward a surface. Before the first one, `kept` starts with the cosine of the guessed hit.
#[inline(always)]
pub(super) fn step<S: KernelShape, const FORWARD: bool, const STEP: u8>(
    shape: &S,
    ray: Ray<f64, FORWARD>,
    near: Near<f64>,
) -> Near<f64> {
    let next = match STEP {
        APPROACH => shape.approach(ray, Hit { distance: near.distance, cosine: near.kept[0], valid: near.valid }),
        CORRECT => shape.correct(ray, near),
        _ => shape.settle(ray, near),
    };
    if STEP != SETTLE_ON || near.step > 0.0 { next } else { near }
}

/// A ray that was bent at a surface.
pub(super) struct Bent {
    /// x^2 + y^2 of the point, mm^2.
    pub(super) radius2: f64,
    /// Unit direction after the surface.
    pub(super) direction: [f64; 3],
    /// 1 - cos of the angle by which the ray turned.
    pub(super) versine: f64,
    /// Negative if the ray is totally reflected; infinite if it cannot be.
    pub(super) inside: f64,
}

/// Bends a ray at a point of a surface. `indices` are the index before the surface and the inverse of that behind it; `kept` is the cosine
/// of incidence, or what a shape that steps has kept for its normal.
#[inline(always)]
pub(super) fn bend<S: KernelShape, const ACTION: u8, const FORWARD: bool>(
    shape: &S,
    point: [f64; 3],
    d: [f64; 3],
    indices: [f64; 2],
    kept: [f64; 2],
) -> Bent {
    let radius2 = point[0] * point[0] + point[1] * point[1];
    let (mut direction, mut inside) = (d, f64::INFINITY);
    if ACTION != PASS && !S::UNIT_NORMAL {
        let g = if S::STEPS { shape.normal_kept(point, kept) } else { shape.normal(point) };
        let length2 = g[0] * g[0] + g[1] * g[1] + g[2] * g[2];
        let along = d[0] * g[0] + d[1] * g[1] + d[2] * g[2];
        let (mut mu, mut push) = (1.0, -2.0 * along / length2);
        if ACTION == REFRACT {
            mu = indices[0] * indices[1];
            (push, inside) = bend::snell_of_length::<FORWARD>(along, mu, length2);
        }
        direction = [mu * d[0] + push * g[0], mu * d[1] + push * g[1], mu * d[2] + push * g[2]];
    } else if ACTION == REFRACT {
        let mu = indices[0] * indices[1];
        let push;
        (push, inside) = bend::snell::<FORWARD>(kept[0], mu);
        direction = shape.bend(point, d, mu, push);
    } else if ACTION == REFLECT {
        direction = shape.bend(point, d, 1.0, -2.0 * kept[0]);
    }
    let turn = [direction[0] - d[0], direction[1] - d[1], direction[2] - d[2]];
    let versine = 0.5 * (turn[0] * turn[0] + turn[1] * turn[1] + turn[2] * turn[2]);
    Bent { radius2, direction, versine, inside }
}
