//! The two colors that a pixel beside a step is a mixture of.

use super::parted::Parted;
use super::steps::Steps;

/// Pixels within which a clean one is looked for.
const REACH: usize = 4;
/// Pixels within which the one is looked for that is most unlike the other side, where there is no clean one.
const NEARBY: usize = 4;
/// Two sides can be told apart where their colors differ by this part of the brighter one, and by so many times as much as clean
/// pixels of a side do among themselves.
const DIFFER: f64 = 0.02;
const SPREADS: f64 = 2.0;
/// A pixel that differs from its own side by so many spreads, and by this part of its color, is none of it.
const OUTLIER: f64 = 3.0;
const OUTLIER_PART: f64 = 0.05;
/// Pixels that a spread takes.
const FEW: usize = 4;
/// The spread of a normal law over the median of how far its values are off.
const OF_MEDIAN: f64 = 1.48;
/// The same for a pixel that tells whether the picture holds mixtures.
const TELLS_DIFFER: f64 = 0.1;
const TELLS_SPREADS: f64 = 6.0;
/// What is off the line between the two sides by less than this part of its length is a mixture.
pub(super) const OFF: f64 = 0.15;

pub(super) type Rgb = [f64; 3];

/// The sides of the step beside a pixel.
#[derive(Clone, Copy, Debug)]
pub(super) struct Sides {
    pub near: Side,
    pub far: Side,
    /// Whether the pixel's own depth is that of the near side.
    pub is_near: bool,
}

/// One of them.
#[derive(Clone, Copy, Debug)]
pub(super) struct Side {
    /// Its color, the median of clean pixels, or else of the pixel that is most unlike the other side.
    pub color: Rgb,
    /// How much clean pixels differ, by the median; none where there are too few.
    pub spread: Option<f64>,
    /// The pixel of the side close by that is most unlike the other side.
    pub extreme: Rgb,
    /// Its depth, mm.
    pub depth_mm: f32,
}

/// The sides of the step beside a pixel; `None` where a color of one of them is not to be had.
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
    // Between two others it is of the larger step.
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

/// The sides of a pixel on the far side that touches a mixed one of a thread; `None` where it does not differ from what lies around it.
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

/// The clean pixels of a side.
struct Clean {
    /// The median of those that lie closest.
    color: Rgb,
    /// See [`Side::spread`].
    spread: Option<f64>,
    /// The closest.
    place: usize,
}

/// The clean pixels of a side close by.
fn clean(steps: &Steps, rgb: &[[f32; 3]], cell: usize, side: usize) -> Option<Clean> {
    let is_clean = |other: &usize| !steps.is_beside(*other) && steps.together(*other, side);
    let all = || steps.window(cell, REACH).filter(is_clean);
    let closest = all().map(|other| steps.distance(cell, other)).min()?;
    // The median of each channel: what is taken for clean may hold some of a thread that is thinner than its samples.
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

/// The mean of the pixels of a side close by.
fn mean(steps: &Steps, rgb: &[[f32; 3]], cell: usize, side: usize) -> Rgb {
    let (mut sum, mut count) = ([0.0; 3], 0.0);
    for other in steps.window(cell, NEARBY).filter(|other| steps.together(*other, side)) {
        (0..3).for_each(|k| sum[k] += f64::from(rgb[other][k]));
        count += 1.0;
    }
    sum.map(|s| s / f64::max(count, 1.0))
}

/// The color of a pixel of a side close by that is most unlike another color.
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
    /// How much the two colors have to differ to be told apart.
    fn room(&self, part: f64, spreads: f64) -> f64 {
        let spread = self.near.spread.unwrap_or(0.0).max(self.far.spread.unwrap_or(0.0));
        (part * length(self.near.color).max(length(self.far.color))).max(spreads * spread)
    }

    /// Whether it can be told which part of a pixel of this color is of which side.
    pub(super) fn tell_apart(&self, color: Rgb) -> bool {
        self.is_outlier(color) || length(minus(self.near.color, self.far.color)) > self.room(DIFFER, SPREADS)
    }

    /// Whether a pixel's color is a mixture, where that shows beyond doubt: beside clean sides, or on the far side of a thread.
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

    /// Whether a color is none of the side that the depth says.
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
