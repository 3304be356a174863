use super::super::cell::{Cell, Coverage};
use super::times;

/// A hyperbolic resolution wedge, as in ISO 12233: lines whose frequency changes linearly along the wedge. Each border is a
/// hyperbola, and a reading is linear in position. The same frequency at both ends gives parallel lines.
#[derive(Clone, Copy, Debug)]
pub struct Wedge {
    start_mm: [f64; 2],
    cos: f64,
    sin: f64,
    length_mm: f64,
    /// Frequency at the start, cycles (one line and one gap) per mm.
    frequency_per_mm: f64,
    /// Change of the frequency along the wedge, cycles per mm^2.
    gain_per_mm2: f64,
    /// Total number of lines and of the gaps between them.
    stripes: f64,
}

impl Wedge {
    /// Creates a wedge of `lines` filled lines whose axis runs from `start_mm` to `end_mm`. The frequencies, cycles per mm, are
    /// those at these two points; both must be positive.
    #[must_use]
    pub fn new(start_mm: [f64; 2], end_mm: [f64; 2], lines: u32, frequencies_per_mm: [f64; 2]) -> Self {
        let (dx, dy) = (end_mm[0] - start_mm[0], end_mm[1] - start_mm[1]);
        let length_mm = (dx * dx + dy * dy).sqrt();
        let [first, last] = frequencies_per_mm;
        Self {
            start_mm,
            cos: dx / length_mm,
            sin: dy / length_mm,
            length_mm,
            frequency_per_mm: first,
            gain_per_mm2: (last - first) / length_mm,
            stripes: 2.0 * f64::from(lines) - 1.0,
        }
    }

    /// Creates parallel lines, each `pitch_mm` / 2 wide, along the axis from `start_mm` to `end_mm`.
    #[must_use]
    pub fn lines(start_mm: [f64; 2], end_mm: [f64; 2], lines: u32, pitch_mm: f64) -> Self {
        Self::new(start_mm, end_mm, lines, [1.0 / pitch_mm, 1.0 / pitch_mm])
    }

    /// Returns the coordinates of a point along the axis and across it, mm.
    fn local(&self, x_mm: f64, y_mm: f64) -> [f64; 2] {
        let (dx, dy) = (x_mm - self.start_mm[0], y_mm - self.start_mm[1]);
        [dx * self.cos + dy * self.sin, dy * self.cos - dx * self.sin]
    }

    /// Returns the number of the stripe, with fraction, at a point: counted from 0 at one side, even for lines, odd for gaps.
    fn stripe(&self, along: f64, across: f64) -> f64 {
        2.0 * across * (self.frequency_per_mm + self.gain_per_mm2 * along) + 0.5 * self.stripes
    }

    /// Returns whether the point lies on a line.
    #[inline]
    #[must_use]
    pub fn contains(&self, x_mm: f64, y_mm: f64) -> bool {
        let [along, across] = self.local(x_mm, y_mm);
        let stripe = self.stripe(along, across);
        // Truncation rounds down, since the stripe is not negative where it matters.
        along >= 0.0 && along <= self.length_mm && stripe >= 0.0 && stripe < self.stripes && (stripe as i64) & 1 == 0
    }

    /// Returns how much of `cell` lies on lines, by interval arithmetic in the axes of the wedge.
    #[must_use]
    pub fn coverage(&self, cell: &Cell) -> Coverage {
        let [along, across] = self.local(cell.center_mm[0], cell.center_mm[1]);
        let [ea, ec] = cell.half_along(self.cos, self.sin);
        if along + ea < 0.0 || along - ea > self.length_mm {
            return Coverage::None;
        }
        let within = along - ea >= 0.0 && along + ea <= self.length_mm;
        let ends = [(along - ea).max(0.0), (along + ea).min(self.length_mm)];
        let mut low = f64::INFINITY;
        let mut high = f64::NEG_INFINITY;
        // The stripe is bilinear in both coordinates, so its extremes lie at the corners.
        for along in ends {
            for across in [across - ec, across + ec] {
                let stripe = self.stripe(along, across);
                low = low.min(stripe);
                high = high.max(stripe);
            }
        }
        if high < 0.0 || low >= self.stripes {
            Coverage::None
        } else if low.floor() != high.floor() {
            Coverage::Partial
        } else if (low.floor() as i64) & 1 == 1 {
            Coverage::None
        } else if within {
            Coverage::Full
        } else {
            Coverage::Partial
        }
    }

    pub(super) fn scaled(self, factor: f64) -> Self {
        Self {
            start_mm: times(self.start_mm, factor),
            length_mm: self.length_mm * factor,
            frequency_per_mm: self.frequency_per_mm / factor,
            gain_per_mm2: self.gain_per_mm2 / (factor * factor),
            ..self
        }
    }
}
