//! The near and the far color of which a pixel beside a step is a mixture.

use super::parted::Parted;
use super::steps::Steps;

/// Distance in pixels within which clean pixels are searched for.
const REACH: usize = 4;
/// Distance in pixels within which, if there is no clean pixel, the one is searched for that differs most from the other side.
const NEARBY: usize = 4;
/// Smallest difference between the colors of two sides that can be distinguished, as a fraction of the brighter one.
const DIFFER: f64 = 0.02;
/// Smallest difference between the colors of two sides that can be distinguished, in spreads of the clean pixels of a side.
const SPREADS: f64 = 2.0;
/// Number of spreads by which a pixel must differ from its own side not to belong to it.
const OUTLIER: f64 = 3.0;
/// Fraction of the color by which a pixel must differ from its own side not to belong to it.
const OUTLIER_PART: f64 = 0.05;
/// Smallest number of pixels for which a spread is computed.
const FEW: usize = 4;
/// Ratio of the standard deviation of a normal distribution to its median absolute deviation.
const OF_MEDIAN: f64 = 1.48;
/// Value of [`DIFFER`] for pixels that decide whether the picture has mixtures.
const TELLS_DIFFER: f64 = 0.1;
/// Value of [`SPREADS`] for pixels that decide whether the picture has mixtures.
const TELLS_SPREADS: f64 = 6.0;
/// Largest distance of a mixture from the line between the two colors, as a fraction of the length of that line.
pub(super) const OFF: f64 = 0.15;

pub(super) type Rgb = [f64; 3];

/// The near and the far side of the step beside a pixel.
#[derive(Clone, Copy, Debug)]
pub(super) struct Sides {
    pub near: Side,
    pub far: Side,
    /// Whether the pixel's own depth belongs to the near side.
    pub is_near: bool,
}

/// One side of a step.
#[derive(Clone, Copy, Debug)]
pub(super) struct Side {
    /// Color of the side: the median of clean pixels, or else that of the pixel that differs most from the other side.
    pub color: Rgb,
    /// Spread of the colors of clean pixels, from their median deviation; `None` if there are too few.
    pub spread: Option<f64>,
    /// Color of the nearby pixel of this side that differs most from the other side.
    pub extreme: Rgb,
    /// Depth of the side, mm.
    pub depth_mm: f32,
}

/// Finds the sides of the step beside a pixel; `None` if the neighboring pixels all belong to one object.
pub(super) fn of(steps: &Steps, rgb: &[[f32; 3]], depth_mm: &[f32], cell: usize) -> Option<Sides> {
    let (mut nearest, mut farthest) = (cell, cell);
    for beside in steps.window(cell, 1) {
        if steps.w(beside) > steps.w(nearest) {
            nearest = beside;
        }
        if steps.w(beside) < steps.w(farthest) {
            farthest = beside;
        }
    }
    // A pixel between two other depths belongs to the side whose depth is closer, so that the step is the larger one.
    let is_near = steps.w(nearest) - steps.w(cell) < steps.w(cell) - steps.w(farthest);
    if is_near {
        nearest = cell;
    } else {
        farthest = cell;
    }
    if steps.together(nearest, farthest) {
        return None;
    }
    let [near, far] = [nearest, farthest].map(|side| clean(steps, rgb, cell, side));
    let guess = |side: usize, other: &Option<Clean>, other_side: usize| {
        let away = other.as_ref().map_or_else(|| mean(steps, rgb, cell, other_side), |clean| clean.color);
        extreme(steps, rgb, cell, side, away)
    };
    let (near_extreme, far_extreme) = (guess(nearest, &far, farthest), guess(farthest, &near, nearest));
    let side = |clean: Option<Clean>, extreme: Rgb, place: usize| Side {
        color: clean.as_ref().map_or(extreme, |clean| clean.color),
        spread: clean.as_ref().and_then(|clean| clean.spread),
        extreme,
        depth_mm: depth_mm[clean.map_or(place, |clean| clean.place)],
    };
    Some(Sides { near: side(near, near_extreme, nearest), far: side(far, far_extreme, farthest), is_near })
}

/// Finds the sides of a pixel on the far side that touches a mixed pixel of a thread; `None` if it does not differ from its surroundings.
pub(super) fn behind(steps: &Steps, rgb: &[[f32; 3]], cell: usize, from: &Parted) -> Option<Sides> {
    if !steps.alike(steps.w(cell), 1.0 / from.far_mm) {
        return None;
    }
    let spread = clean(steps, rgb, cell, cell)?.spread;
    let (near, color) = (from.near.map(f64::from), from.far.map(f64::from));
    let sides = Sides {
        near: Side { color: near, spread: None, extreme: near, depth_mm: from.near_mm },
        far: Side { color, spread, extreme: color, depth_mm: from.far_mm },
        is_near: false,
    };
    let far_off = length(minus(rgb[cell].map(f64::from), color));
    let least = (OUTLIER * spread.unwrap_or(0.0)).min(OFF * length(minus(near, color)));
    (far_off > (OUTLIER_PART * length(color)).max(least)).then_some(sides)
}

/// Result for the clean pixels of a side.
struct Clean {
    /// Median color of the closest clean pixels.
    color: Rgb,
    /// Spread of their colors, see [`Side::spread`].
    spread: Option<f64>,
    /// Index of the closest clean pixel.
    place: usize,
}

/// Finds the clean pixels of a side nearby; `None` if there are none.
fn clean(steps: &Steps, rgb: &[[f32; 3]], cell: usize, side: usize) -> Option<Clean> {
    let is_clean = |other: &usize| !steps.is_beside(*other) && steps.together(*other, side);
    let all = || steps.window(cell, REACH).filter(is_clean);
    let closest = all().map(|other| steps.distance(cell, other)).min()?;
    // Use the median of each channel, since a pixel counted as clean may contain part of a thread thinner than a sample.
    let mut channels = [const { Vec::new() }; 3];
    for other in all().filter(|other| steps.distance(cell, *other) <= closest + 1) {
        channels.iter_mut().zip(rgb[other]).for_each(|(channel, value)| channel.push(value));
    }
    let color = channels.map(|mut channel| {
        let middle = channel.len() / 2;
        f64::from(*channel.select_nth_unstable_by(middle, f32::total_cmp).1)
    });
    let mut off: Vec<f64> = all().map(|other| length(minus(rgb[other].map(f64::from), color))).collect();
    let (count, middle) = (off.len(), off.len() / 2);
    let spread = OF_MEDIAN * *off.select_nth_unstable_by(middle, f64::total_cmp).1;
    let place = all().find(|other| steps.distance(cell, *other) == closest)?;
    Some(Clean { color, spread: (count >= FEW).then_some(spread), place })
}

/// Returns the mean color of the nearby pixels of a side.
fn mean(steps: &Steps, rgb: &[[f32; 3]], cell: usize, side: usize) -> Rgb {
    let (mut sum, mut count) = ([0.0; 3], 0.0);
    for other in steps.window(cell, NEARBY).filter(|other| steps.together(*other, side)) {
        (0..3).for_each(|k| sum[k] += f64::from(rgb[other][k]));
        count += 1.0;
    }
    sum.map(|s| s / f64::max(count, 1.0))
}

/// Returns the color of the nearby pixel of a side that differs most from the color `away`.
fn extreme(steps: &Steps, rgb: &[[f32; 3]], cell: usize, side: usize, away: Rgb) -> Rgb {
    let mut best = (rgb[side].map(f64::from), -1.0);
    for other in steps.window(cell, NEARBY).filter(|other| steps.together(*other, side)) {
        let color = rgb[other].map(f64::from);
        let off = minus(color, away);
        let far = dot(off, off);
        if far > best.1 {
            best = (color, far);
        }
    }
    best.0
}

impl Sides {
    /// Returns by how much the two colors must differ to be distinguished.
    fn room(&self, part: f64, spreads: f64) -> f64 {
        let spread = self.near.spread.unwrap_or(0.0).max(self.far.spread.unwrap_or(0.0));
        (part * length(self.near.color).max(length(self.far.color))).max(spreads * spread)
    }

    /// Returns whether a pixel of this color can be divided between the sides.
    pub(super) fn tell_apart(&self, color: Rgb) -> bool {
        self.is_outlier(color) || length(minus(self.near.color, self.far.color)) > self.room(DIFFER, SPREADS)
    }

    /// Returns whether a pixel's color is a mixture; `None` if that cannot be decided safely. It can be decided beside clean sides, or
    /// on the far side of a thread.
    pub(super) fn tells(&self, color: &[f32; 3]) -> Option<bool> {
        let can = self.far.spread.is_some() && (self.near.spread.is_some() || !self.is_near);
        let way = minus(self.near.color, self.far.color);
        let long = length(way);
        if !can || !(long > self.room(TELLS_DIFFER, TELLS_SPREADS)) {
            return None;
        }
        let color = color.map(f64::from);
        let from = minus(color, self.far.color);
        let share = dot(from, way) / (long * long);
        let off = length(minus(from, way.map(|v| v * share)));
        Some(share > 0.1 && share < 0.9 && off < OFF * long && self.is_outlier(color))
    }

    /// Returns whether a color does not belong to the side of the pixel's depth.
    fn is_outlier(&self, color: Rgb) -> bool {
        let own = if self.is_near { &self.near } else { &self.far };
        own.spread.is_some_and(|spread| {
            length(minus(color, own.color)) > (OUTLIER_PART * length(own.color)).max(OUTLIER * spread)
        })
    }
}

pub(super) fn minus(a: Rgb, b: Rgb) -> Rgb {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

pub(super) fn dot(a: Rgb, b: Rgb) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

pub(super) fn length(a: Rgb) -> f64 {
    dot(a, a).sqrt()
}
