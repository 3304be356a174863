//! Draws the spikes of bright pixels, out to the edge of the frame.
//!
//! A spike is a line of boxes across it, one for each column (or row) of pixels. Only the ends of each box are written, and the plane is
//! summed up once for all. A box therefore costs the same however wide it is.

use crate::kernel::fade;
use crate::{Fan, Wings};

/// A spike, represented by boxes on pixels.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Spike {
    /// Whether the spike goes from column to column (rather than from row to row).
    across: bool,
    /// Slope: rows per column (columns per row), signed.
    slope: f64,
    /// Distance on film per column or row, mm.
    step_mm: f64,
    /// Light beyond a distance r, times r, mm.
    light_mm: f64,
    /// Half width of the two boxes in rows (columns): at the start, and its increase per column.
    half: [[f64; 2]; 2],
    /// Fractions of the spike's light in the two boxes.
    parts: [f64; 2],
}

impl Spike {
    /// Returns the spikes of an opening for light of a mean wavelength (mm), on pixels of `pitch_mm`. Each spike extends to both sides.
    pub(crate) fn all(wings: &Wings, wavelength_mm: f64, pitch_mm: [f64; 2]) -> Vec<Self> {
        let one = |fan: &Fan| {
            // Columns count opposite to x.
            let way = [-fan.normal[0] / pitch_mm[0], fan.normal[1] / pitch_mm[1]];
            let across = way[0].abs() >= way[1].abs();
            let (along, aside) = if across { (way[0], way[1]) } else { (way[1], way[0]) };
            let step_mm = 1.0 / along.abs();
            // A width across the spike, in rows: divided by the cosine and by the height of a pixel.
            let cosine = if across { fan.normal[0].abs() } else { fan.normal[1].abs() };
            let pitch = if across { pitch_mm[1] } else { pitch_mm[0] };
            let rows = |mm: f64| mm / cosine / pitch;
            let [a, b] = Wings::boxes();
            let half =
                [a, b].map(|[_, half]| [rows(half * wavelength_mm / fan.line), rows(0.5 * fan.spread_rad * step_mm)]);
            let light_mm = 0.5 * wings.of_fan(fan, 1.0, wavelength_mm);
            Self { across, slope: aside / along, step_mm, light_mm, half, parts: [a[0], b[0]] }
        };
        wings.fans().iter().filter(|fan| fan.is_spike()).map(one).collect()
    }

    /// Returns the fraction of the light that the spike takes to both its sides, beyond the distance `end_mm` at which the pixels around
    /// fade out.
    pub(crate) fn light(&self, end_mm: f64) -> f64 {
        2.0 * self.light_mm * self.parts.iter().sum::<f64>() * fading(end_mm)
    }

    /// Returns the value of the spike's brightest pixel at a distance, as a fraction of the light.
    pub(crate) fn peak(&self, at_mm: f64) -> f64 {
        let boxes = self.half.iter().zip(self.parts);
        let high: f64 =
            boxes.map(|([begin, gain], part)| part / (2.0 * (begin + gain * at_mm / self.step_mm)).max(1.0)).sum();
        self.light_mm / (at_mm * at_mm) * self.step_mm * high
    }
}

/// Returns the integral of 1/r^2 weighted by the fade, 1/mm.
pub(crate) fn fading(end_mm: f64) -> f64 {
    const STEPS: usize = 400;
    let begin = 0.6 * end_mm;
    let step = (end_mm - begin) / STEPS as f64;
    let at = |i: usize| begin + (i as f64 + 0.5) * step;
    (0..STEPS).map(|i| fade(at(i), end_mm) * step / (at(i) * at(i))).sum::<f64>() + 1.0 / end_mm
}

/// The spikes in a plane of pixels, stored by the ends of their boxes.
pub(crate) struct Spikes {
    width: usize,
    height: usize,
    /// Changes down the columns, from spikes that go across.
    down: Vec<f64>,
    /// Changes along the rows, from spikes that go down.
    along: Vec<f64>,
}

impl Spikes {
    pub(crate) fn new(width: usize, height: usize) -> Self {
        Self { width, height, down: vec![0.0; width * (height + 2)], along: vec![0.0; (width + 2) * height] }
    }

    /// Adds a spike of a pixel with this much light.
    pub(crate) fn add(&mut self, spike: &Spike, column: usize, row: usize, light: f64, end_mm: f64) {
        let (from, aside, count, rows) =
            if spike.across { (column, row, self.width, self.height) } else { (row, column, self.height, self.width) };
        let first = ((0.6 * end_mm / spike.step_mm).floor() as usize).max(1);
        for forth in [true, false] {
            let most = if forth { count - 1 - from } else { from };
            for k in first..most + 1 {
                let distance = k as f64;
                let center = aside as f64 + if forth { spike.slope } else { -spike.slope } * distance;
                let r = distance * spike.step_mm;
                let near = r - 0.5 * spike.step_mm;
                // Integrate from one edge of the column to the other.
                let part = spike.light_mm * spike.step_mm / (near * (near + spike.step_mm)) * fade(r, end_mm);
                let widest = spike.half.iter().map(|[begin, gain]| begin + gain * distance).fold(0.0, f64::max);
                if center + widest < -0.5 || center - widest > rows as f64 - 0.5 {
                    if (center > 0.0) == ((spike.slope > 0.0) == forth) {
                        break;
                    }
                    continue;
                }
                let at = if forth { from + k } else { from - k };
                for ([begin, gain], share) in spike.half.iter().zip(spike.parts) {
                    let half = begin + gain * distance;
                    let height = light * part * share / (2.0 * half);
                    self.edge(spike.across, at, center - half, height);
                    self.edge(spike.across, at, center + half, -height);
                }
            }
        }
    }

    /// Raises all pixels of a line by `height` from a place on. The pixel that holds the place gets its fraction.
    fn edge(&mut self, across: bool, line: usize, place: f64, height: f64) {
        let rows = if across { self.height } else { self.width };
        let place = (place + 0.5).clamp(0.0, rows as f64);
        let at = (place as usize).min(rows);
        let part = at as f64 + 1.0 - place;
        let index = |row: usize| if across { row * self.width + line } else { line * (self.width + 2) + row };
        let to = if across { &mut self.down } else { &mut self.along };
        let (a, b) = (index(at), index(at + 1));
        to[a] += height * part;
        to[b] += height * (1.0 - part);
    }

    /// Adds all spikes to a plane.
    pub(crate) fn add_to(mut self, plane: &mut [f64]) {
        for row in 0..self.height {
            let (before, now) = self.down.split_at_mut(row * self.width);
            if row > 0 {
                let before = &before[(row - 1) * self.width..];
                now[..self.width].iter_mut().zip(before).for_each(|(now, before)| *now += before);
            }
            let mut sum = 0.0;
            let along = &self.along[row * (self.width + 2)..][..self.width];
            for ((to, down), change) in plane[row * self.width..][..self.width].iter_mut().zip(&now[..]).zip(along) {
                sum += change;
                *to += down + sum;
            }
        }
    }
}
