//! Weights of the cells that a pixel covers.

/// Integral from minus infinity to `t` of the quadratic B-spline around 0 (width 3, integral 1). It spreads a cell's number, so that a
/// picture finer than the cells shows no edges, and cells together cover evenly.
fn integral(t: f64) -> f64 {
    if t <= -1.5 {
        0.0
    } else if t < -0.5 {
        (t + 1.5) * (t + 1.5) * (t + 1.5) / 6.0
    } else if t <= 0.5 {
        0.5 + t * (0.75 - t * t / 3.0)
    } else if t < 1.5 {
        1.0 - (1.5 - t) * (1.5 - t) * (1.5 - t) / 6.0
    } else {
        1.0
    }
}

/// Cells of each pixel along one axis, with their weights; a pixel's weights sum to 1.
pub(super) struct Taps {
    taps: usize,
    first: Vec<i64>,
    weights: Vec<f32>,
    /// Factor for each pixel that gives it the variance of the mean pixel. Pixels finer than cells have more variance in the middle of a
    /// cell than between two.
    evening: Vec<f32>,
    mean_square: f32,
}

/// Returns the sum of the squared weights of the pixel from `begin` to `end`, in units of cells. Its cells begin at `first`.
fn squares(begin: f64, end: f64, first: f64, taps: usize, mut each: impl FnMut(f64)) -> f64 {
    let mut sum = 0.0;
    for t in 0..taps {
        // Cell i has its center at i + 0.5 and reaches from i - 1 to i + 2.
        let center = first + t as f64 + 0.5;
        let weight = (integral(end - center) - integral(begin - center)) / (end - begin);
        sum += weight * weight;
        each(weight);
    }
    sum
}

impl Taps {
    /// Computes the weights of `pixels` pixels from the pixel `offset` on; pixel 0 and cell 0 begin at the same place.
    pub(super) fn new(offset: i64, pixels: usize, cells_a_pixel: f64) -> Self {
        // From the cell before the pixel's first one to the cell after its last one.
        let taps = cells_a_pixel.ceil() as usize + 3;
        let mut all = Self {
            taps,
            first: Vec::with_capacity(pixels),
            weights: Vec::with_capacity(pixels * taps),
            evening: Vec::with_capacity(pixels),
            mean_square: 0.0,
        };
        // Averages over all positions that a pixel can have on the cells.
        const PHASES: usize = 64;
        let at = |k: usize| (k as f64 + 0.5) / PHASES as f64;
        let mean =
            (0..PHASES).map(|k| squares(at(k), at(k) + cells_a_pixel, -1.0, taps, |_| {})).sum::<f64>() / PHASES as f64;
        all.mean_square = mean as f32;
        for pixel in 0..pixels as i64 {
            let begin = (offset + pixel) as f64 * cells_a_pixel;
            let end = (offset + pixel + 1) as f64 * cells_a_pixel;
            let first = begin.floor() - 1.0;
            let square = squares(begin, end, first, taps, |weight| all.weights.push(weight as f32));
            all.first.push(first as i64);
            all.evening.push((mean / square).sqrt() as f32);
        }
        all
    }

    pub(super) fn len(&self) -> usize {
        self.first.len()
    }

    /// First cell of a pixel, and the weights from there on.
    #[inline(always)]
    pub(super) fn of(&self, pixel: usize) -> (i64, &[f32]) {
        (self.first[pixel], &self.weights[pixel * self.taps..(pixel + 1) * self.taps])
    }

    /// Number of cells per pixel.
    pub(super) fn taps(&self) -> usize {
        self.taps
    }

    /// Factor for a pixel's sum that gives every pixel the variance of the mean pixel.
    #[inline(always)]
    pub(super) fn evening(&self, pixel: usize) -> f32 {
        self.evening[pixel]
    }

    /// Sum of a pixel's squared weights, averaged over all positions on the cells.
    pub(super) fn mean_square(&self) -> f32 {
        self.mean_square
    }

    /// First cell, and number of cells, of the pixels from `from` up to but not including `to`.
    pub(super) fn cells(&self, from: usize, to: usize) -> (i64, usize) {
        let first = self.first[from];
        (first, (self.first[to - 1] - first) as usize + self.taps)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Weights are positive, sum to 1, and have their mean at the pixel's center. The spline's integral is that of its three pieces.
    #[test]
    fn weights_are_exact_areas() {
        for cells_a_pixel in [0.03, 0.5, 1.0, 3.3, 4.0, 7.99] {
            for offset in [-17_i64, 0, 123_456] {
                let taps = Taps::new(offset, 9, cells_a_pixel);
                for pixel in 0..9 {
                    let (first, weights) = taps.of(pixel);
                    let sum: f64 = weights.iter().map(|w| f64::from(*w)).sum();
                    assert!((sum - 1.0).abs() < 1e-5, "{cells_a_pixel} {offset}: {sum}");
                    assert!(weights.iter().all(|w| *w >= -1e-6));
                    let mean: f64 =
                        weights.iter().enumerate().map(|(t, w)| f64::from(*w) * (t as f64 + 0.5)).sum::<f64>();
                    let center = ((offset + pixel as i64) as f64 + 0.5) * cells_a_pixel - first as f64;
                    assert!((mean - center).abs() < 1e-4, "{mean} {center}");
                }
            }
        }
        // The spline itself is the convolution of three unit boxes.
        let box3 = |t: f64| {
            let steps = 400;
            let mut inside = 0.0;
            for i in 0..steps {
                for j in 0..steps {
                    let (a, b) = ((f64::from(i) + 0.5) / 400.0 - 0.5, (f64::from(j) + 0.5) / 400.0 - 0.5);
                    inside += (t - a - b + 0.5).clamp(0.0, 1.0);
                }
            }
            inside / f64::from(steps * steps)
        };
        for t in [-1.4, -0.7, -0.1, 0.3, 0.9, 1.2] {
            assert!((integral(t) - box3(t)).abs() < 1e-5, "{t}");
        }
    }
}
