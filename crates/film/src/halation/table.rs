//! Tables of functions that are too costly to evaluate often.

/// A function of the radius, linear between samples.
pub(super) struct Table {
    per_step: f64,
    values: Vec<f64>,
}

impl Table {
    pub(super) fn new(end: f64, f: &impl Fn(f64) -> f64) -> Self {
        const STEPS: usize = 65_536;
        let step = end / STEPS as f64;
        Self { per_step: 1.0 / step, values: (0..STEPS + 2).map(|k| f(k as f64 * step)).collect() }
    }

    pub(super) fn at(&self, r: f64) -> f64 {
        let p = r * self.per_step;
        let i = (p as usize).min(self.values.len() - 2);
        self.values[i] + (self.values[i + 1] - self.values[i]) * (p - i as f64)
    }
}
