//! A smooth function of three amounts, sampled once and read off for every pixel of a frame.

use rayon::prelude::*;

/// Three functions of three arguments, sampled on equal steps, linear in each argument between samples, held beyond the ends.
#[derive(Clone, Debug)]
pub(crate) struct Cube {
    low: [f32; 3],
    per_step: [f32; 3],
    steps: usize,
    /// The fourth is there to be loaded with the others.
    values: Vec<[f32; 4]>,
}

impl Cube {
    /// Samples on `steps + 1` places of each argument between the ends in `ranges`. `slab` gets the index of the first
    /// argument and writes the samples of the other two, the last one running fastest.
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

    /// The three functions at `x`.
    #[inline(always)]
    pub(crate) fn at(&self, x: [f32; 3]) -> [f32; 3] {
        let last = self.steps as f32;
        let mut index = [0; 3];
        let mut part = [0.0; 3];
        for k in 0..3 {
            let p = ((x[k] - self.low[k]) * self.per_step[k]).max(0.0).min(last);
            index[k] = (p as usize).min(self.steps - 1);
            part[k] = p - index[k] as f32;
        }
        let places = self.steps + 1;
        let at = (index[0] * places + index[1]) * places + index[2];
        let near = face(&self.values[at..], places, part);
        let far = face(&self.values[at + places * places..], places, part);
        let [a, b, c, _] = mix(near, far, part[0]);
        [a, b, c]
    }
}

// Every pixel comes by here: functions, since closures over arrays are left uninlined.
#[inline(always)]
fn mix(a: [f32; 4], b: [f32; 4], t: f32) -> [f32; 4] {
    [a[0] + (b[0] - a[0]) * t, a[1] + (b[1] - a[1]) * t, a[2] + (b[2] - a[2]) * t, a[3] + (b[3] - a[3]) * t]
}

#[inline(always)]
fn face(values: &[[f32; 4]], places: usize, part: [f32; 3]) -> [f32; 4] {
    let values = &values[..places + 2];
    let upper = mix(values[0], values[1], part[2]);
    let lower = mix(values[places], values[places + 1], part[2]);
    mix(upper, lower, part[1])
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Multilinear functions are met exactly, also beyond the ends, where they are held.
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
        assert_eq!(cube.at([5.0, -9.0, f32::NAN]), f(1.0, -1.0, -1.0));
    }
}
