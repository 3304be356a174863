//! Changes from frame to frame: the picture moves in the gate, and its exposure flickers.

use super::random_seed::RandomSeed;
use rayon::prelude::*;
use spectra_core::math::pow;

/// Weights of neighboring frames in a moving average, so that a movement lasts for a few frames.
const NEIGHBORS: [f64; 5] = [1.0, 3.0, 5.0, 3.0, 1.0];

/// Returns a normal number of variance 1 that changes smoothly from frame to frame.
fn wandering(chance: RandomSeed, frame: u64) -> f64 {
    let norm = NEIGHBORS.iter().map(|w| w * w).sum::<f64>().sqrt();
    (0..).zip(NEIGHBORS).map(|(k, weight)| weight * chance.normal(frame.wrapping_add(k))).sum::<f64>() / norm
}

/// Returns the shift of the picture by gate weave: across and down, in mm.
pub(super) fn weave(chance: RandomSeed, frame: u64, rms_mm: f64) -> [f64; 2] {
    [0, 1].map(|axis| rms_mm * wandering(chance.with(axis), frame))
}

/// Returns the factor by which the exposure of a frame flickers.
pub(super) fn flicker(chance: RandomSeed, frame: u64, rms_stops: f64) -> f64 {
    pow(2.0, rms_stops * wandering(chance, frame))
}

/// Shifts a plane by fractions of a pixel, by Catmull-Rom cubic interpolation. Each value is clamped between its two nearest neighbors, so
/// that lamps get no dark ring. Pixels outside the plane repeat its edge.
pub(super) fn shifted(plane: &[f32], width: usize, height: usize, by_px: [f64; 2]) -> Vec<f32> {
    let [across, down] =
        by_px.map(|by| (-by).floor() as i64).into_iter().zip(by_px).map(Tap::new).collect::<Vec<_>>()[..]
    else {
        return plane.to_vec();
    };
    let mut rows = vec![0.0_f32; plane.len()];
    rows.par_chunks_mut(width.max(1)).zip(plane.par_chunks(width.max(1))).for_each(|(to, from)| {
        for (x, v) in to.iter_mut().enumerate() {
            *v = across.of(x, width, |at| from[at]);
        }
    });
    let mut out = vec![0.0_f32; plane.len()];
    out.par_chunks_mut(width.max(1)).enumerate().for_each(|(y, to)| {
        for (x, v) in to.iter_mut().enumerate() {
            *v = down.of(y, height, |at| rows[at * width + x]);
        }
    });
    out
}

/// The four neighbors of a place between pixels, with their weights.
#[derive(Clone, Copy)]
struct Tap {
    first: i64,
    weight: [f64; 4],
}

impl Tap {
    fn new((whole, by): (i64, f64)) -> Self {
        let t = -by - whole as f64;
        let weight = [
            0.5 * t * (-1.0 + t * (2.0 - t)),
            1.0 + 0.5 * t * t * (-5.0 + 3.0 * t),
            0.5 * t * (1.0 + t * (4.0 - 3.0 * t)),
            0.5 * t * t * (-1.0 + t),
        ];
        Self { first: whole - 1, weight }
    }

    fn of(&self, at: usize, count: usize, value: impl Fn(usize) -> f32) -> f32 {
        let place = |k: i64| (at as i64 + self.first + k).clamp(0, count as i64 - 1) as usize;
        let values = [0, 1, 2, 3].map(|k| f64::from(value(place(k))));
        let sum: f64 = values.iter().zip(&self.weight).map(|(v, w)| v * w).sum();
        sum.clamp(values[1].min(values[2]), values[1].max(values[2])) as f32
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Over many frames the shift has the stated root mean square. A frame always has the same shift, and neighboring frames similar ones.
    #[test]
    fn weave_is_as_wide_as_stated() {
        let chance = RandomSeed::new(3, "weave");
        let all: Vec<[f64; 2]> = (0..4000).map(|frame| weave(chance, frame, 0.02)).collect();
        for axis in 0..2 {
            let square: f64 = all.iter().map(|v| v[axis] * v[axis]).sum::<f64>() / 4000.0;
            assert!((square.sqrt() / 0.02 - 1.0).abs() < 0.06, "{}", square.sqrt());
            let step: f64 = all.windows(2).map(|w| (w[1][axis] - w[0][axis]) * (w[1][axis] - w[0][axis])).sum::<f64>();
            assert!((step / 3999.0).sqrt() < 0.02, "{step}");
        }
        assert_eq!(weave(chance, 7, 0.02), all[7]);
    }

    /// A ramp moves by exactly the shift, to the right and down.
    #[test]
    fn a_shift_moves_a_ramp() {
        let (width, height) = (20, 16);
        let plane: Vec<f32> = (0..width * height).map(|i| (i % width) as f32 + 10.0 * (i / width) as f32).collect();
        let moved = shifted(&plane, width, height, [1.25, -2.5]);
        for (x, y) in [(6, 5), (12, 9)] {
            let want = x as f32 - 1.25 + 10.0 * (y as f32 + 2.5);
            assert!((moved[y * width + x] - want).abs() < 1e-4, "{} {want}", moved[y * width + x]);
        }
        assert_eq!(shifted(&plane, width, height, [0.0; 2]), plane);
    }
}
