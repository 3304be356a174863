//! Functions that give the same bits on every machine and at every vector width.
//!
//! `exp`, `sin` and the like differ between the libraries of platforms, so everything uses the pure-Rust `libm`, re-exported
//! here. The few functions that run once per ray have branch-free forms of our own.

pub use libm::{
    acos, asin, atan, atan2, cbrt, cos, erf, erfc, exp, expm1, j0, j1, lgamma, log, log1p, log2, log10, pow, sin, tan,
};

/// Splits off the whole part of `at`, and returns it as an index and as a number. `at` is first clamped to 0 to `last`, a whole
/// number below 2^32; NaN counts as 0. Branch-free.
///
/// A cast to an integer would be done number by number. Adding 2^52 instead leaves a whole number in the last bits of the f64.
#[inline(always)]
#[must_use]
pub fn floor_index(at: f64, last: f64) -> (u32, f64) {
    const WHOLE: f64 = (1_u64 << 52) as f64;
    let at = if at > 0.0 { at } else { 0.0 };
    let at = if at < last { at } else { last };
    let nearest = (at + WHOLE) - WHOLE;
    let below = if nearest > at { nearest - 1.0 } else { nearest };
    ((below + WHOLE).to_bits() as u32, below)
}

/// Computes sine and cosine of `x` in [-pi/4, pi/4] rad, within 1.2e-16; branch-free.
///
/// Taylor series to x^15 and x^16: the first term left out is below 5e-17 and 3e-18 there.
#[inline(always)]
#[must_use]
pub fn sin_cos_octant(x: f64) -> (f64, f64) {
    let s = x * x;
    // The series is split into parts, because a formatter takes long for many nested brackets.
    let high =
        1.0 / 362_880.0 + s * (-1.0 / 39_916_800.0 + s * (1.0 / 6_227_020_800.0 + s * (-1.0 / 1_307_674_368_000.0)));
    let sin = x * (1.0 + s * (-1.0 / 6.0 + s * (1.0 / 120.0 + s * (-1.0 / 5040.0 + s * high))));
    let high = -1.0 / 3_628_800.0
        + s * (1.0 / 479_001_600.0 + s * (-1.0 / 87_178_291_200.0 + s * (1.0 / 20_922_789_888_000.0)));
    let cos = 1.0 + s * (-0.5 + s * (1.0 / 24.0 + s * (-1.0 / 720.0 + s * (1.0 / 40_320.0 + s * high))));
    (sin, cos)
}

/// Computes sine and cosine of `turns` whole turns, for `turns` in [0, 1]; branch-free.
#[inline(always)]
#[must_use]
pub fn sin_cos_turns(turns: f64) -> (f64, f64) {
    // Round to the nearest quarter by adding and subtracting 1.5 * 2^52: the same on every tier.
    const ROUND: f64 = 6_755_399_441_055_744.0;
    let quarter = (turns * 4.0 + ROUND) - ROUND;
    let (s, c) = sin_cos_octant((turns * 4.0 - quarter) * std::f64::consts::FRAC_PI_2);
    let odd = quarter == 1.0 || quarter == 3.0;
    let (a, b) = if odd { (c, s) } else { (s, c) };
    let sin = if quarter == 2.0 || quarter == 3.0 { -a } else { a };
    let cos = if quarter == 1.0 || quarter == 2.0 { -b } else { b };
    (sin, cos)
}

/// Computes `e` to the power of `x`, for `x` from -700 to 700, with a relative error of at most 4e-16; branch-free. Beyond that
/// range `x` counts as the nearer end.
///
/// The result is a power of two times the Taylor series to r^13 of the remainder r, |r| <= ln(2) / 2. The first omitted term is
/// below 5e-18.
#[inline(always)]
#[must_use]
pub fn exp_within_700(x: f64) -> f64 {
    // Adding 1.5 * 2^52 rounds to whole numbers, and leaves the number in the lowest bits.
    const ROUND: f64 = 6_755_399_441_055_744.0;
    // The upper 32 bits of ln(2), so that whole numbers times it are exact, and the rest.
    const LN2_HIGH: f64 = 6.931_471_803_691_238e-1;
    const LN2_LOW: f64 = 1.908_214_929_270_587_7e-10;
    let x = if x > -700.0 { x } else { -700.0 };
    let x = if x < 700.0 { x } else { 700.0 };
    let shifted = x * std::f64::consts::LOG2_E + ROUND;
    let whole = shifted - ROUND;
    let r = (x - whole * LN2_HIGH) - whole * LN2_LOW;
    let end = 1.0 / 3_628_800.0 + r * (1.0 / 39_916_800.0 + r * (1.0 / 479_001_600.0 + r * (1.0 / 6_227_020_800.0)));
    let middle =
        1.0 / 120.0 + r * (1.0 / 720.0 + r * (1.0 / 5040.0 + r * (1.0 / 40_320.0 + r * (1.0 / 362_880.0 + r * end))));
    let series = 1.0 + r * (1.0 + r * (1.0 / 2.0 + r * (1.0 / 6.0 + r * (1.0 / 24.0 + r * middle))));
    let power = f64::from_bits(shifted.to_bits().wrapping_add(1023) << 52);
    series * power
}

/// Computes 2 to the power of `x`, for `x` from -126 to 127, with a relative error of at most 1.5e-7; branch-free, in single
/// precision. Beyond that range `x` counts as the nearer end.
///
/// The result is a power of two times the Taylor series to r^7 of the remainder r, |r| <= ln(2) / 2. The first omitted term is
/// below 6e-9.
#[inline(always)]
#[must_use]
pub fn exp2_single(x: f32) -> f32 {
    // Adding 1.5 * 2^23 rounds to whole numbers, and leaves the number in the lowest bits.
    const ROUND: f32 = 12_582_912.0;
    let x = if x > -126.0 { x } else { -126.0 };
    let x = if x < 127.0 { x } else { 127.0 };
    let shifted = x + ROUND;
    let r = (x - (shifted - ROUND)) * std::f32::consts::LN_2;
    let end = 1.0 / 24.0 + r * (1.0 / 120.0 + r * (1.0 / 720.0 + r * (1.0 / 5040.0)));
    let series = 1.0 + r * (1.0 + r * (1.0 / 2.0 + r * (1.0 / 6.0 + r * end)));
    series * f32::from_bits(shifted.to_bits().wrapping_add(127) << 23)
}

/// Computes the logarithm to base 2 of a normal positive `x`; branch-free, in single precision. The error is at most 1e-7 times
/// the larger of 1 and the absolute value of the result.
///
/// For the mantissa m, from sqrt(1/2) to sqrt(2), it takes the series of 2 artanh((m - 1) / (m + 1)) to the ninth power. The
/// first omitted term is below 1e-9.
#[inline(always)]
#[must_use]
pub fn log2_single(x: f32) -> f32 {
    // Bits of sqrt(1/2).
    const LEAST: u32 = 0x3f35_04f3;
    let whole = x.to_bits().wrapping_sub(LEAST) as i32 >> 23;
    let m = f32::from_bits(x.to_bits().wrapping_sub((whole << 23) as u32));
    let s = (m - 1.0) / (m + 1.0);
    let t = s * s;
    let series = s + s * t * (1.0 / 3.0 + t * (1.0 / 5.0 + t * (1.0 / 7.0 + t * (1.0 / 9.0))));
    whole as f32 + series * (2.0 * std::f32::consts::LOG2_E)
}

/// Maps the unit square onto the unit disk: equal areas stay equal, and neighbors stay neighbors. Returns x and y.
///
/// P. Shirley and K. Chiu, "A low distortion map between disk and square", J. Graphics Tools 2
/// (1997); branch-free.
#[inline(always)]
#[must_use]
pub fn concentric_disk(u: f64, v: f64) -> (f64, f64) {
    let a = 2.0 * u - 1.0;
    let b = 2.0 * v - 1.0;
    let wide = a.abs() > b.abs();
    let (r, other) = if wide { (a, b) } else { (b, a) };
    let safe = if r == 0.0 { 1.0 } else { r };
    let (s, c) = sin_cos_octant(std::f64::consts::FRAC_PI_4 * (other / safe));
    if wide { (r * c, r * s) } else { (r * s, r * c) }
}

/// Maps the unit square onto the unit disk with equal areas: the radius is sqrt(`u`), the angle `v` turns. Returns x and y.
#[inline(always)]
#[must_use]
pub fn polar_disk(u: f64, v: f64) -> (f64, f64) {
    let (s, c) = sin_cos_turns(v);
    let r = u.sqrt();
    (r * c, r * s)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sines_agree_with_libm() {
        for i in -1000..=1000 {
            let x = f64::from(i) / 1000.0 * std::f64::consts::FRAC_PI_4;
            let (s, c) = sin_cos_octant(x);
            assert!((s - sin(x)).abs() < 2.3e-16 && (c - cos(x)).abs() < 2.3e-16, "{x}");
        }
        for i in 0..=4000 {
            let t = f64::from(i) / 4000.0;
            let (s, c) = sin_cos_turns(t);
            let x = t * std::f64::consts::TAU;
            assert!((s - sin(x)).abs() < 1e-15 && (c - cos(x)).abs() < 1e-15, "{t}");
        }
    }

    #[test]
    fn powers_agree_with_libm() {
        for i in -70_000..=70_000 {
            let x = f64::from(i) / 100.0;
            let (got, want) = (exp_within_700(x), exp(x));
            assert!((got - want).abs() <= 4e-16 * want, "{x}: {got} {want}");
            let small = f64::from(i) / 1e6;
            assert!((exp_within_700(small) - exp(small)).abs() <= 4e-16, "{small}");
        }
        assert_eq!(exp_within_700(0.0), 1.0);
        assert_eq!(exp_within_700(-1e9), exp_within_700(-700.0));
        assert_eq!(exp_within_700(1e9), exp_within_700(700.0));
    }

    #[test]
    fn single_powers_and_logarithms_agree_with_libm() {
        for i in -126_000..=127_000 {
            let x = i as f32 / 1000.0;
            let (got, want) = (f64::from(exp2_single(x)), libm::exp2(f64::from(x)));
            assert!((got / want - 1.0).abs() <= 1.5e-7, "{x}: {got} {want}");
            let found = f64::from(log2_single(got as f32));
            let exact = libm::log2(f64::from(got as f32));
            assert!((found - exact).abs() <= 1e-7 * exact.abs().max(1.0), "{x}: {found} {exact}");
        }
        for i in 0..2_000_000_u32 {
            let x = f32::from_bits(0x3f00_0000 + 16 * i);
            let (found, exact) = (f64::from(log2_single(x)), libm::log2(f64::from(x)));
            assert!((found - exact).abs() <= 1e-7 * exact.abs().max(1.0), "{x}: {found} {exact}");
        }
        assert_eq!((exp2_single(0.0), log2_single(1.0), exp2_single(-1e9)), (1.0, 0.0, exp2_single(-126.0)));
    }

    #[test]
    fn whole_parts_are_those_of_a_cast() {
        for i in 0..100_000 {
            let at = f64::from(i) * 0.125 - 100.0;
            let want = (at as u32).min(7777);
            assert_eq!(floor_index(at, 7777.0), (want, f64::from(want)), "{at}");
        }
        let below = |x: f64| f64::from_bits(x.to_bits() - 1);
        for (at, want) in [(below(3.0), 2), (3.0, 3), (f64::NAN, 0), (f64::INFINITY, 9), (-0.0, 0), (below(9.0), 8)] {
            assert_eq!(floor_index(at, 9.0), (want, f64::from(want)), "{at}");
        }
        assert_eq!(floor_index(4e9, 4_294_967_295.0).0, 4_000_000_000);
    }

    /// Moments of a uniform unit disk: E r^2 = 1/2, E r^4 = 1/3, E x = 0, E x^2 = 1/4.
    #[test]
    fn disk_maps_keep_area() {
        for map in [concentric_disk, polar_disk] {
            let n = 1000;
            let (mut r2, mut r4, mut x1, mut x2) = (0.0, 0.0, 0.0, 0.0);
            for i in 0..n {
                for j in 0..n {
                    let (x, y) = map((f64::from(i) + 0.5) / f64::from(n), (f64::from(j) + 0.5) / f64::from(n));
                    let q = x * x + y * y;
                    assert!(q <= 1.0 + 1e-15);
                    r2 += q;
                    r4 += q * q;
                    x1 += x;
                    x2 += x * x;
                }
            }
            let m = f64::from(n) * f64::from(n);
            for (got, want) in [(r2, 0.5), (r4, 1.0 / 3.0), (x1, 0.0), (x2, 0.25)] {
                assert!((got / m - want).abs() < 2e-6, "{} {want}", got / m);
            }
        }
    }
}
