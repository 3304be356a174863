//! Cheap measures of angles, which take one division, and the zones that they are sorted into.

use spectra_core::math::{self, atan2};

/// Returns a measure of the angle at which a point is seen from the reference point, `radius` beside the axis
/// and `ahead` in front of it: 0 on the axis, 1 at 90 degrees, 2 straight behind. It grows with the
/// angle and takes one division.
#[inline(always)]
pub(super) fn measure(radius: f64, ahead: f64) -> f64 {
    let share = radius / (radius + ahead.abs());
    if ahead < 0.0 { 2.0 - share } else { share }
}

/// Returns [`math::floor_index`] of a number as an index.
#[inline(always)]
pub(super) fn whole(at: f64, last: f64) -> usize {
    math::floor_index(at, last).0 as usize
}

/// Returns a measure like [`measure`] for the azimuth of (x, y): in [0, 4), one unit per quarter turn.
#[inline(always)]
pub(super) fn azimuth_measure(x: f64, y: f64) -> f64 {
    let share = y / (x.abs() + y.abs());
    if x < 0.0 {
        2.0 - share
    } else if y < 0.0 {
        4.0 + share
    } else {
        share
    }
}

/// Converts a fraction of the azimuth's measure to turns, both 1 for a full turn.
pub(super) fn turns(share: f64) -> f64 {
    let measure = 4.0 * (share - share.floor());
    let quarter = measure.floor();
    let part = measure - quarter;
    (quarter + atan2(part, 1.0 - part) * std::f64::consts::FRAC_2_PI) * 0.25
}
