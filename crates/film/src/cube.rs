//! A smooth function of three amounts, sampled once and looked up for every pixel of a frame.

use rayon::prelude::*;

/// Three functions of three arguments, sampled at equal steps, linear in each argument between samples, constant beyond the ends.
#[derive(Clone, Debug)]
pub(crate) struct Cube {
    low: [f32; 3],
    per_step: [f32; 3],
    steps: usize,
    /// Samples; the fourth value only makes them load together.
    values: Vec<[f32; 4]>,
}

impl Cube {
    /// Samples at `steps + 1` places of each argument between the ends in `ranges`. `slab` gets the index of the first argument and writes
    /// the samples of the other two; the last one varies fastest.
    pub(crate) fn by_slabs(
        ranges: [(f64, f64); 3],
        steps: usize,
        slab: impl Fn(usize, &mut [[f32; 4]]) + Sync,
    ) -> Self {
        let places = steps + 1;
        let mut values = vec![[0.0; 4]; places * places * places];
        values.par_chunks_mut(places * places).enumerate().for_each(|(i, to)| slab(i, to));
        let per_step = ranges.map(|(low, high)| (steps as f64 / (high - low)) as f32);
        Self { low: ranges.map(|r| r.0 as f32), per_step, steps, values }
    }

    /// Interpolates the three functions at `x`. The fourth value has no meaning: four are computed as fast as three.
    #[inline(always)]
    pub(crate) fn at(&self, x: [f32; 3]) -> [f32; 4] {
        let last = self.steps as f32;
        let mut index = [0; 3];
        let mut part = [0.0; 3];
        for k in 0..3 {
            let p = ((x[k] - self.low[k]) * self.per_step[k]).max(0.0).min(last);
            // There are at most a few hundred steps.
            let i = (p as i32).min(self.steps as i32 - 1);
            (index[k], part[k]) = (i as usize, p - i as f32);
        }
        let places = self.steps + 1;
        let at = (index[0] * places + index[1]) * places + index[2];
        let near = edge(&self.values[at..], places, part[1]);
        let far = edge(&self.values[at + places * places..], places, part[1]);
        let both = mix(near, far, part[0]);
        std::array::from_fn(|k| both[k] + (both[4 + k] - both[k]) * part[2])
    }
}

/// Two consecutive samples along the last argument.
type Two = [f32; 8];

// These run for every pixel and are functions, because closures over arrays are not inlined.
#[inline(always)]
fn mix(mut a: Two, b: Two, t: f32) -> Two {
    for (a, b) in a.iter_mut().zip(b) {
        *a += (b - *a) * t;
    }
    a
}

/// Interpolates along the second argument, between the samples at the start and those one step on.
#[inline(always)]
fn edge(values: &[[f32; 4]], places: usize, part: f32) -> Two {
    let values = values[..places + 2].as_flattened();
    let two = |at: usize| -> Two { std::array::from_fn(|k| values[4 * at + k]) };
    mix(two(0), two(places), part)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Multilinear functions are reproduced exactly, and held constant beyond the ends.
    #[test]
    fn multilinear_functions_are_exact() {
        let f = |x: f32, y: f32, z: f32| [x, 1.0 + x * y, x * y * z - z];
        let place = |i: usize| i as f32 / 4.0 * 2.0 - 1.0;
        let cube = Cube::by_slabs([(-1.0, 1.0); 3], 4, |i, to| {
            for (n, value) in to.iter_mut().enumerate() {
                let [a, b, c] = f(place(i), place(n / 5), place(n % 5));
                *value = [a, b, c, 0.0];
            }
        });
        for x in [[-1.0, -1.0, -1.0], [0.3, -0.7, 0.9], [1.0, 1.0, 1.0], [0.0, 0.25, 0.26]] {
            let (got, want) = (cube.at(x), f(x[0], x[1], x[2]));
            assert!((0..3).all(|c| (got[c] - want[c]).abs() < 1e-6), "{x:?} {got:?} {want:?}");
        }
        assert_eq!(cube.at([5.0, -9.0, f32::NAN])[..3], f(1.0, -1.0, -1.0));
    }
}
