//! Counts of grains: quantiles of Poisson's law as a function of a standard normal number.

use spectra_core::math::exp;
use spectra_numerics::normal;
use std::sync::LazyLock;

/// Nodes of the square root of the mean: steps per unit, and the end of the table.
const STEPS: usize = 16;
const END: usize = 8;

/// Nodes of the normal number: from -LIMIT to LIMIT, FINENESS steps per unit.
pub(super) const LIMIT: usize = 5;
pub(super) const FINENESS: usize = 32;
pub(super) const NODES: usize = 2 * LIMIT * FINENESS + 1;

/// Sampled quantiles of Poisson's law.
pub(super) struct Counts {
    table: Vec<f32>,
    /// Correlation of the counts of each mean; see [`row`].
    ties: Vec<f32>,
}

impl Counts {
    /// Returns the shared table, which is the same for all grain and is computed once.
    pub(super) fn all() -> &'static Self {
        static ALL: LazyLock<Counts> = LazyLock::new(Counts::new);
        &ALL
    }

    fn new() -> Self {
        let means = (0..=STEPS * END).map(|k| (k as f64 / STEPS as f64) * (k as f64 / STEPS as f64));
        let (rows, ties): (Vec<_>, Vec<_>) = means.map(row).unzip();
        Self { table: rows.concat(), ties }
    }

    /// Corrects the mean count, so that large areas keep their variance. `mean` grains are expected in a pixel, and `alone` is the fraction
    /// of large-area variance that a pixel has on its own. The rest comes from its correlation with its neighbors.
    ///
    /// Counts are less correlated than the normal numbers from which they come, so larger areas would lose variance where pixels are finer
    /// than grains. Interpolation between the nodes of [`Counts::quantile`] loses some too. Fewer and larger grains compensate for both.
    #[inline(always)]
    pub(super) fn evened(&self, mean: f32, alone: f32) -> f32 {
        if mean >= (END * END) as f32 {
            return mean;
        }
        let kept = |mean: f32| {
            let place = mean.sqrt() * STEPS as f32;
            let k = (place as usize).min(STEPS * END - 1);
            let tie = self.ties[k] + (self.ties[k + 1] - self.ties[k]) * (place - k as f32);
            // Between two nodes, counts that differ by one for a part of the numbers are averaged.
            let step = (2 * k + 1) as f32 / (STEPS * STEPS) as f32;
            let part = (place * place - (k * k) as f32) / (2 * k + 1) as f32;
            let averaged = 1.0 - part * (1.0 - part) * step / mean.max(step);
            (alone + (1.0 - alone) * tie) * averaged
        };
        let first = mean * kept(mean);
        mean * kept(mean * kept(first))
    }

    /// Returns the number of grains if `mean` are expected and the normal number is `z`. Its mean and its variance over z are both `mean`,
    /// and it rises with z.
    ///
    /// Counts between nodes are interpolated, so they need not be whole. From 64 on, uses the expansion of E. A. Cornish and R. A. Fisher
    /// (1938) to the third order, whose variance is exact.
    #[inline(always)]
    pub(super) fn quantile(&self, mean: f32, z: f32) -> f32 {
        let root = mean.sqrt();
        if root >= END as f32 {
            return mean + root * z + (z * z - 1.0) / 6.0 + (z - z * z * z) / (72.0 * root);
        }
        let k = (root * STEPS as f32) as usize;
        // Linear in the mean between nodes, so that the mean is kept.
        let part = (mean * (STEPS * STEPS) as f32 - (k * k) as f32) / (2 * k + 1) as f32;
        let place = ((z + LIMIT as f32) * FINENESS as f32).max(0.0).min((NODES - 1) as f32);
        let i = (place as usize).min(NODES - 2);
        let t = place - i as f32;
        let node = |k: usize| {
            let at = k * NODES + i;
            self.table[at] + (self.table[at + 1] - self.table[at]) * t
        };
        let (a, b) = (node(k), node((k + 1).min(STEPS * END)));
        a + (b - a) * part
    }
}

/// Computes the quantiles of one mean: at each node, their mean over the node's cell of the normal distribution.
///
/// Also computes how strongly counts are correlated: the variance of a sum of many neighbors relative to that of their normal numbers,
/// whose correlation falls with distance as a Gaussian.
/// The part of order k in Hermite polynomials is correlated by the correlation to the power k. The k-th power of a Gaussian has an area k
/// times as small (F. G. Mehler, 1866).
fn row(mean: f64) -> (Vec<f32>, f32) {
    let mut below = Vec::new(); // the distribution function
    let (mut term, mut sum) = (exp(-mean), 0.0);
    for k in 0..(mean + 12.0 * mean.sqrt()) as u32 + 20 {
        sum += term;
        below.push(sum);
        term *= mean / f64::from(k + 1);
    }
    let place = |i: f64| i / FINENESS as f64 - LIMIT as f64;
    let values: Vec<f64> = (0..NODES)
        .map(|i| {
            let low = if i == 0 { 0.0 } else { normal::cdf(place(i as f64 - 0.5)) };
            let high = if i + 1 == NODES { 1.0 } else { normal::cdf(place(i as f64 + 0.5)) };
            let over: f64 = below.iter().map(|b| (high - b.max(low)).max(0.0)).sum();
            over / (high - low)
        })
        .collect();
    // The mean of the interpolated function, and its Hermite parts, by fine steps.
    const ORDERS: usize = 9;
    let fine = 8;
    let (mut parts, mut square, mut weight) = ([0.0; ORDERS], 0.0, 0.0);
    for i in 0..NODES - 1 {
        for s in 0..fine {
            let t = (f64::from(s) + 0.5) / f64::from(fine);
            let z = place(i as f64 + t);
            let w = exp(-z * z / 2.0);
            let value = values[i] + (values[i + 1] - values[i]) * t;
            let (mut before, mut now) = (0.0, 1.0); // normalized: He_k / sqrt(k!)
            for (k, part) in parts.iter_mut().enumerate() {
                *part += w * value * now;
                let k = k as f64;
                (before, now) = (now, (z * now - k.sqrt() * before) / (k + 1.0).sqrt());
            }
            square += w * value * value;
            weight += w;
        }
    }
    parts.iter_mut().for_each(|p| *p /= weight);
    let (found, variance) = (parts[0], square / weight - parts[0] * parts[0]);
    if !(found > 0.0 && variance > 0.0) {
        return (vec![0.0; NODES], 1.0 / ORDERS as f32);
    }
    let orders: f64 = parts[1..].iter().map(|p| p * p).sum();
    let tied: f64 = parts[1..].iter().enumerate().map(|(k, p)| p * p / (k as f64 + 1.0)).sum();
    let tie = (tied + (variance - orders).max(0.0) / ORDERS as f64) / variance;
    (values.iter().map(|v| (v * mean / found) as f32).collect(), tie as f32)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Compares mean, variance and third moment with those of Poisson's law, by quadrature over the normal number.
    #[test]
    fn moments_are_poissons() {
        let counts = Counts::new();
        for (mean, off_variance, off_skewness) in [
            (0.05_f64, 0.03, 0.15),
            (0.3, 0.02, 0.1),
            (1.0, 0.01, 0.05),
            (1.7, 0.01, 0.05),
            (6.3, 0.005, 0.05),
            (40.0, 0.005, 0.05),
            (63.99, 0.005, 0.05),
            (64.01, 0.005, 0.05),
            (900.0, 0.001, 0.05),
        ] {
            let evened = counts.evened(mean as f32, 1.0);
            let (mut moments, mut weight) = ([0.0; 3], 0.0);
            for i in 0..40_000 {
                let z = (f64::from(i) + 0.5) / 40_000.0 * 12.0 - 6.0;
                let w = exp(-z * z / 2.0);
                let x = f64::from(counts.quantile(evened, z as f32) / evened) * mean - mean;
                weight += w;
                moments[0] += w * x;
                moments[1] += w * x * x;
                moments[2] += w * x * x * x;
            }
            let [m1, m2, m3] = moments.map(|m| m / weight);
            let (variance, skewness) = (m2 / mean, m3 / (m2 * m2.sqrt()) * mean.sqrt());
            println!("{mean}: mean {m1:+.2e}, variance / mean {variance:.5}, skewness over Poisson's {skewness:.4}");
            assert!(m1.abs() < 1e-4 * mean, "{mean}: {m1}");
            assert!((variance - 1.0).abs() < off_variance, "{mean}: {variance}");
            assert!((skewness - 1.0).abs() < off_skewness, "{mean}: {skewness}");
        }
    }

    /// Counts of many grains are as correlated as their numbers; with few grains, a pixel on its own loses nothing.
    #[test]
    fn ties_loosen_where_grains_are_few() {
        let counts = Counts::new();
        assert_eq!(counts.evened(100.0, 0.0), 100.0);
        // To the second order in 1 / sqrt(mean), the quantile's parts are z and (z^2 - 1) / 6: 1 / (18 mean) of the variance is of order 2,
        // half of which is lost. Rounding of counts to whole numbers adds 1 / 12, of high orders.
        for mean in [9.0, 25.0, 49.0] {
            let lost = 1.0 - counts.evened(mean, 0.0) / mean;
            // Between nodes, which are sqrt(mean) / 8 apart, a quarter of that at most.
            let nodes = mean.sqrt() / 8.0 / 4.0;
            let (least, most) = (1.0 / 36.0 / mean, (1.0 / 36.0 + 1.0 / 12.0 + nodes) / mean);
            assert!((least..most).contains(&lost), "{mean}: {least} {lost} {most}");
        }
        assert!((counts.evened(0.25, 1.0) - 0.25).abs() < 1e-6, "a node");
        assert!(counts.evened(0.5, 0.0) < 0.5 && counts.evened(0.5, 0.0) > 0.3);
    }

    #[test]
    fn counts_rise_and_are_not_negative() {
        let counts = Counts::new();
        for mean in [0.0, 1e-6, 0.01, 0.7, 3.0, 63.0, 65.0, 1e4] {
            let mut before = 0.0;
            for i in -60..61 {
                let now = counts.quantile(mean, i as f32 / 10.0);
                assert!(now >= before, "{mean} {i}: {now} {before}");
                before = now;
            }
        }
        assert_eq!(counts.quantile(0.0, 3.0), 0.0);
    }
}
