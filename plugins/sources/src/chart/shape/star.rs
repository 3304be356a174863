use std::sync::Arc;

use super::super::cell::{Cell, Coverage};
use super::times;

/// A Siemens star: alternating filled and empty sectors of equal angle.
#[derive(Clone, Debug)]
pub struct SiemensStar {
    center_mm: [f64; 2],
    radius_mm: f64,
    sectors: Arc<Sectors>,
}

impl SiemensStar {
    /// Creates a star with `cycles` filled sectors (at least 2) and as many empty ones. The first filled one is centered at
    /// `angle_rad` from +x, counterclockwise.
    #[must_use]
    pub fn new(center_mm: [f64; 2], radius_mm: f64, cycles: u32, angle_rad: f64) -> Self {
        Self { center_mm, radius_mm, sectors: Arc::new(Sectors::new(cycles, angle_rad)) }
    }

    /// Returns whether the point lies in a filled sector.
    #[inline]
    #[must_use]
    pub fn contains(&self, x_mm: f64, y_mm: f64) -> bool {
        let (dx, dy) = (x_mm - self.center_mm[0], y_mm - self.center_mm[1]);
        dx * dx + dy * dy <= self.radius_mm * self.radius_mm && self.sectors.at(turn(dx, dy)).1
    }

    /// Returns how much of `cell` lies in filled sectors.
    #[must_use]
    pub fn coverage(&self, cell: &Cell) -> Coverage {
        let [near, far] = cell.distance_squared(self.center_mm);
        let limit = self.radius_mm * self.radius_mm;
        if near > limit {
            return Coverage::None;
        }
        if near == 0.0 {
            return Coverage::Partial;
        }
        // The center is outside the cell, so the cell spans less than half a turn, between two of its corners. If it
        // crosses the start of the turn, add one turn to the low values.
        let turns = cell.corners().map(|[x, y]| turn(x - self.center_mm[0], y - self.center_mm[1]));
        let over = turns.iter().any(|&t| t > 3.0) && turns.iter().any(|&t| t < 1.0);
        let unwrapped = turns.map(|t| if over && t < 2.0 { t + 4.0 } else { t });
        let low = unwrapped.iter().copied().fold(f64::INFINITY, f64::min);
        let high = unwrapped.iter().copied().fold(0.0, f64::max);
        let (first, filled) = self.sectors.at(low);
        let (last, _) = self.sectors.at(if high >= 4.0 { high - 4.0 } else { high });
        if first != last {
            Coverage::Partial
        } else if !filled {
            Coverage::None
        } else if far <= limit {
            Coverage::Full
        } else {
            Coverage::Partial
        }
    }

    pub(super) fn scaled(self, factor: f64) -> Self {
        Self { center_mm: times(self.center_mm, factor), radius_mm: self.radius_mm * factor, ..self }
    }
}

/// Returns a direction as a number in [0, 4) that grows with the angle, one unit per quadrant: the position on the square
/// |x| + |y| = 1. This needs no arc tangent.
#[inline]
fn turn(dx: f64, dy: f64) -> f64 {
    let sum = dx.abs() + dy.abs();
    let p = if sum > 0.0 { dx / sum } else { 1.0 };
    let turn = if dy >= 0.0 { 1.0 - p } else { 3.0 + p };
    // 3 + p rounds to 4 just below the +x axis.
    if turn >= 4.0 { 0.0 } else { turn }
}

/// The borders of the sectors in order of [`turn`], with equal bins for a fast search.
#[derive(Debug)]
struct Sectors {
    borders: Vec<f64>,
    /// Whether the sector that begins at each border is filled.
    filled: Vec<bool>,
    /// Index of the last border at or before the start of each bin, plus one.
    bins: Vec<u32>,
    bins_per_unit: f64,
}

impl Sectors {
    fn new(cycles: u32, angle_rad: f64) -> Self {
        let cycles = cycles.max(2);
        let step_rad = std::f64::consts::PI / f64::from(cycles);
        let mut sectors: Vec<(f64, bool)> = (0..2 * cycles)
            .map(|k| {
                let a = angle_rad + step_rad * (f64::from(k) - 0.5);
                (turn(libm::cos(a), libm::sin(a)), k % 2 == 0)
            })
            .collect();
        sectors.sort_by(|a, b| a.0.total_cmp(&b.0));
        let bins_per_unit = f64::from(cycles);
        let borders: Vec<f64> = sectors.iter().map(|s| s.0).collect();
        let bins = (0..4 * cycles)
            .map(|bin| borders.partition_point(|&b| b <= f64::from(bin) / bins_per_unit) as u32)
            .collect();
        Self { borders, filled: sectors.iter().map(|s| s.1).collect(), bins, bins_per_unit }
    }

    /// Returns the index of the sector at `turn` in [0, 4), and whether it is filled.
    #[inline]
    fn at(&self, turn: f64) -> (usize, bool) {
        let bin = ((turn * self.bins_per_unit) as usize).min(self.bins.len() - 1);
        let mut next = self.bins[bin] as usize;
        // If the product rounds up to the next bin, the search starts at most one border too far.
        while next > 0 && self.borders[next - 1] > turn {
            next -= 1;
        }
        while next < self.borders.len() && self.borders[next] <= turn {
            next += 1;
        }
        let index = if next == 0 { self.borders.len() - 1 } else { next - 1 };
        (index, self.filled[index])
    }
}
