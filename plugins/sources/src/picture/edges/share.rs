//! The share of the near side in a mixed pixel, and its front and back colors.

use super::parted::Parted;
use super::sides::{OFF, Rgb, Side, Sides, dot, length, minus};

/// Largest difference, as a fraction of the brighter color, within which a pixel belongs wholly to one side. Within the spread of its own
/// side it does, too.
const PURE: f64 = 0.03;

/// Separates a pixel between two sides; `None` if it belongs wholly to the side of its depth.
///
/// The share is fitted by least squares over the channels. The part of the color that is off the line between the two colors is assigned
/// to the side with the larger share. Both together then give the pixel's color, so that the picture does not change where all of it is
/// sharp. If a pixel is far off the line, its true color may be one of the extremes, such as a lamp that is too small to have clean
/// pixels.
pub(super) fn part(sides: &Sides, color: [f32; 3]) -> Option<Parted> {
    let (near, far) = (&sides.near, &sides.far);
    let own = color.map(f64::from);
    if !sides.tell_apart(own) {
        return None;
    }
    let pairs =
        [(near.color, far.color), (near.color, far.extreme), (near.extreme, far.color), (near.extreme, far.extreme)];
    let (n, f, share) = pairs.into_iter().find_map(|(n, f)| Some((n, f, fitted(own, n, f)?)))?;
    // A texture on the pixel's own side must not be taken for a mixture.
    let is_as = |other: Rgb, side: &Side, is_own: bool| {
        let spread = side.spread.filter(|_| is_own).unwrap_or(0.0).min(OFF * length(minus(n, f)));
        length(minus(own, other)) <= (PURE * length(own).max(length(other))).max(spread)
    };
    let share = if is_as(n, near, sides.is_near) {
        1.0
    } else if is_as(f, far, !sides.is_near) {
        0.0
    } else {
        share
    };
    if share == if sides.is_near { 1.0 } else { 0.0 } {
        return None;
    }
    let mixed = [0, 1, 2].map(|k| share * n[k] + (1.0 - share) * f[k]);
    let rest = minus(own, mixed);
    let with_rest = |color: Rgb, part: f64| [0, 1, 2].map(|k| (color[k] + rest[k] / part).max(0.0) as f32);
    let plain = |color: Rgb| color.map(|v| v as f32);
    let (n, f) = if share >= 0.5 { (with_rest(n, share), plain(f)) } else { (plain(n), with_rest(f, 1.0 - share)) };
    Some(Parted { opacity: share as f32, near: n, far: f, near_mm: near.depth_mm, far_mm: far.depth_mm })
}

/// Fits the share of the near color; `None` if the color is not a mixture of the two.
fn fitted(own: Rgb, near: Rgb, far: Rgb) -> Option<f64> {
    let (way, from) = (minus(near, far), minus(own, far));
    let long = length(way);
    let share = (dot(from, way) / (long * long)).clamp(0.0, 1.0);
    let off = length(minus(from, way.map(|v| v * share)));
    (off <= OFF * long).then_some(share)
}
