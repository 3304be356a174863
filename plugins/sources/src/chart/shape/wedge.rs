use super::super::cell::{Cell, Coverage};
use super::times;

/// Hyperbolic resolution wedge: lines whose frequency runs linearly along the wedge, so that each border
/// is a hyperbola and a reading is linear in position (the wedges of ISO 12233). With the same
/// frequency at both ends: parallel lines.
#[derive(Clone, Copy, Debug)]
pub struct Wedge {
    start_mm: [f64; 2],
    cos: f64,
    sin: f64,
    length_mm: f64,
    /// Cycles (one line and one gap) per mm at the start, and what it gains per mm.
    frequency_per_mm: f64,
    gain_per_mm2: f64,
    /// Lines and the gaps between them, together.
    stripes: f64,
}

impl Wedge {
    /// Wedge of `lines` filled lines whose axis runs from `start_mm` to `end_mm`, with frequencies, cycles
    /// per mm, at these two points; both must be positive.
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

    /// Parallel lines, each `pitch_mm` / 2 wide, along the axis from `start_mm` to `end_mm`.
    #[must_use]
    pub fn lines(start_mm: [f64; 2], end_mm: [f64; 2], lines: u32, pitch_mm: f64) -> Self {
        Self::new(start_mm, end_mm, lines, [1.0 / pitch_mm, 1.0 / pitch_mm])
    }

    /// Along the axis and across it, mm.
    fn local(&self, x_mm: f64, y_mm: f64) -> [f64; 2] {
        let (dx, dy) = (x_mm - self.start_mm[0], y_mm - self.start_mm[1]);
        [dx * self.cos + dy * self.sin, dy * self.cos - dx * self.sin]
    }

    /// Stripe, counted from 0 at one side (even: a line, odd: a gap), at the place `across` from the axis.
    fn stripe(&self, along: f64, across: f64) -> f64 {
        2.0 * across * (self.frequency_per_mm + self.gain_per_mm2 * along) + 0.5 * self.stripes
    }

    /// Whether the point lies on a line.
    #[inline]
    #[must_use]
    pub fn contains(&self, x_mm: f64, y_mm: f64) -> bool {
        let [along, across] = self.local(x_mm, y_mm);
        let stripe = self.stripe(along, across);
        // Toward 0 is down, as the stripe is not negative where it counts.
        along >= 0.0 && along <= self.length_mm && stripe >= 0.0 && stripe < self.stripes && (stripe as i64) & 1 == 0
    }

    /// How much of `cell` lies on lines, by interval arithmetic in the wedge's own axes.
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
        // Bilinear in both, so the extremes lie at the corners.
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
