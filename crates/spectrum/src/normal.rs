//! Integrals of the normal distribution where its usual functions underflow or cancel.

use crate::cell;

/// From this z on, the continued fraction of Mills' ratio needs no more than [`LEVELS`] levels.
const FRACTION_FROM: f64 = 4.0;
const LEVELS: u32 = 40;

pub(crate) const SQRT_TAU: f64 = 2.506_628_274_631_000_5;
pub(crate) const SQRT_HALF_PI: f64 = 1.253_314_137_315_500_3;

/// Returns Mills' ratio for `z` of 0 or more: the integral of exp(-(t^2 - z^2) / 2) over t from z to infinity. It is about 1/z
/// for large z, where the integral of exp(-t^2 / 2) itself underflows.
///
/// It uses erfc near 0, and the continued fraction of Laplace (Abramowitz and Stegun 26.2.14) from 4 on.
pub(crate) fn mills(z: f64) -> f64 {
    if z < FRACTION_FROM {
        return SQRT_HALF_PI * libm::exp(0.5 * z * z) * libm::erfc(z * std::f64::consts::FRAC_1_SQRT_2);
    }
    let mut below = z;
    for k in (1..LEVELS).rev() {
        below = z + f64::from(k) / below;
    }
    1.0 / below
}

/// Integral of exp(-z^2 / 2) over an interval, stored as exp(-nearest^2 / 2) times `scaled` so that it never underflows.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Mass {
    /// The point of the interval nearest to 0.
    pub nearest: f64,
    /// Integral divided by exp(-nearest^2 / 2).
    pub scaled: f64,
}

impl Mass {
    /// Integrates from `a` to `b`. `width` is their distance, known to more digits than their difference, which loses them far
    /// from 0. The result is 0 unless the width is positive. The relative error is about 1e-14.
    ///
    /// The method is erf if the interval contains 0, and Mills' ratio (erfc without its underflow) in the tails. If the ends
    /// are so close that the difference of those would cancel, it is Gauss-Legendre quadrature.
    pub fn of_width(a: f64, b: f64, width: f64) -> Self {
        if b <= 0.0 && width > 0.0 {
            let mirrored = Self::of_width(-b, -a, width);
            return Self { nearest: -mirrored.nearest, ..mirrored };
        }
        let nearest = a.max(0.0);
        let scaled = if width.is_nan() || width <= 0.0 {
            0.0
        } else if width * nearest.max(1.0) < 1.0 {
            let start = a - nearest;
            let f = |t: f64| libm::exp(-0.5 * (start + t) * (start + t + 2.0 * nearest));
            cell::integral(f, &[0.0, width])
        } else if a < 0.0 {
            let root = std::f64::consts::FRAC_1_SQRT_2;
            SQRT_HALF_PI * (libm::erf(b * root) - libm::erf(a * root))
        } else {
            mills(a) - libm::exp(-0.5 * width * (b + a)) * mills(b)
        };
        Self { nearest, scaled }
    }

    /// Returns the integral itself; 0 if it underflows.
    pub fn value(self) -> f64 {
        self.scaled * libm::exp(-0.5 * self.nearest * self.nearest)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn between(a: f64, b: f64) -> Mass {
        Mass::of_width(a, b, b - a)
    }

    /// Mills' ratio to 16 digits, computed with 40 digits by mpmath: sqrt(pi/2) exp(z^2/2) erfc(z/sqrt 2).
    #[test]
    fn mills_ratio() {
        for (z, want) in [
            (0.0, 1.253_314_137_315_500_3),
            (1.0, 0.655_679_542_418_798_47),
            (3.999, 0.236_705_784_929_564_83),
            (4.0, 0.236_652_382_913_560_67),
            (4.001, 0.236_599_003_988_067_01),
            (10.0, 0.099_028_596_471_731_921),
            (100.0, 0.009_999_000_299_850_104_906),
            (1e8, 1e-8),
        ] {
            assert!((mills(z) / want - 1.0).abs() < 2e-15, "{z} {} {want}", mills(z));
        }
    }

    #[test]
    fn masses_add_up_across_all_branches() {
        for (a, b) in [(-9.0, 7.0), (-0.4, 0.5), (0.0, 3.0), (2.0, 2.3), (6.0, 40.0), (-50.0, -30.0), (60.0, 61.0)] {
            let whole = between(a, b);
            for share in [1e-3, 0.1, 0.5, 0.93] {
                let middle = a + (b - a) * share;
                let sum: f64 = [between(a, middle), between(middle, b)]
                    .iter()
                    .map(|m| m.scaled * libm::exp(-0.5 * (m.nearest - whole.nearest) * (m.nearest + whole.nearest)))
                    .sum();
                assert!((sum / whole.scaled - 1.0).abs() < 3e-14, "{a} {b} {share}: {}", sum / whole.scaled - 1.0);
            }
        }
        assert_eq!(between(1.0, 1.0).value(), 0.0);
        assert!((between(f64::NEG_INFINITY, f64::INFINITY).value() - SQRT_TAU).abs() < 1e-15);
        assert_eq!(between(f64::NAN, 1.0).scaled, 0.0);
    }
}
