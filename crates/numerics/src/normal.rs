//! The normal distribution and its inverse.

use crate::math::erfc;

/// Distance from the mean, in standard deviations, beyond which [`far_mills`] holds. The tails beyond it are about to underflow.
pub const FAR: f64 = 25.0;

/// Returns the cumulative probability of the standard normal distribution at `z`.
#[must_use]
pub fn cdf(z: f64) -> f64 {
    0.5 * erfc(-z * std::f64::consts::FRAC_1_SQRT_2)
}

/// Returns the quantile of the standard normal distribution: the point below which the probability is `u`, for `u` from 1e-300 to
/// 1 - 1e-16. The relative error is about 1e-15.
#[must_use]
pub fn quantile(u: f64) -> f64 {
    if u < 0.5 { -inverse_survival(u) } else { inverse_survival(1.0 - u) }
}

/// Returns Mills' ratio (tail probability over density) for `z` beyond [`FAR`], to the last digits: the eighth convergent of its
/// continued fraction.
#[inline(always)]
#[must_use]
pub fn far_mills(z: f64) -> f64 {
    let (mut above, mut above_before) = (1.0, 0.0);
    let (mut below, mut below_before) = (z, 1.0);
    let mut k = 1.0;
    while k < 8.0 {
        (above, above_before) = (z * above + k * above_before, above);
        (below, below_before) = (z * below + k * below_before, below);
        k += 1.0;
    }
    above / below
}

/// Computes the natural logarithm of a positive normal number, within two units in the last place; branch-free.
///
/// x = 2^k m with m from sqrt(1/2) to sqrt(2), and log m = 2 artanh((m - 1) / (m + 1)) by its series.
#[inline(always)]
#[must_use]
pub fn log(x: f64) -> f64 {
    /// Bits of sqrt(1/2), and the offset that brings it to 1 in the exponent.
    const ROOT_HALF: u64 = 0x3fe6_a09e_667f_3bcd;
    const TO_ONE: u64 = 0x3ff0_0000_0000_0000 - ROOT_HALF;
    /// 2^52: an integer below it, put into the mantissa, becomes a float without a conversion.
    const INTEGER: u64 = 0x4330_0000_0000_0000;
    const OFFSET: f64 = 4_503_599_627_370_496.0 + 1023.0;
    /// ln 2 in two parts; the first has 21 bits of zeros, so that k times it is exact.
    const LN2_HIGH: f64 = 6.931_471_803_691_238_16e-1;
    const LN2_LOW: f64 = 1.908_214_929_270_587_70e-10;
    let bits = x.to_bits().wrapping_add(TO_ONE);
    let k = f64::from_bits((bits >> 52) | INTEGER) - OFFSET;
    let m = f64::from_bits((bits & 0x000f_ffff_ffff_ffff) + ROOT_HALF);
    let f = m - 1.0;
    let s = f / (2.0 + f);
    let z = s * s;
    // The series is split into parts, because a formatter takes half a minute for ten nested brackets.
    let high = 1.0 / 13.0 + z * (1.0 / 15.0 + z * (1.0 / 17.0 + z * (1.0 / 19.0 + z * (1.0 / 21.0))));
    let series = z * (1.0 / 3.0 + z * (1.0 / 5.0 + z * (1.0 / 7.0 + z * (1.0 / 9.0 + z * (1.0 / 11.0 + z * high)))));
    k * LN2_HIGH + (k * LN2_LOW + (2.0 * s + 2.0 * s * series))
}

/// Computes exp of a number of 0 or less, with a relative error under 4e-16; 0 below -708, where it is about to underflow;
/// branch-free.
///
/// x = k ln 2 + r with |r| <= ln(2) / 2, and the series of exp(r) to r^13, whose next term is below 4e-18.
#[inline(always)]
#[must_use]
pub fn exp_of_negative(x: f64) -> f64 {
    /// 1.5 * 2^52: adding and subtracting it rounds to whole numbers, which stand in the low bits in between.
    const ROUND: f64 = 6_755_399_441_055_744.0;
    const LN2_HIGH: f64 = 6.931_471_803_691_238_16e-1;
    const LN2_LOW: f64 = 1.908_214_929_270_587_70e-10;
    const LOWEST: f64 = -708.0;
    let within = if x > LOWEST { x } else { LOWEST };
    let shifted = within * std::f64::consts::LOG2_E + ROUND;
    let k = shifted - ROUND;
    let r = (within - k * LN2_HIGH) - k * LN2_LOW;
    let s = r * r;
    // Even and odd powers are summed separately, so that two short chains run at once.
    let high = 1.0 / 40_320.0 + s * (1.0 / 3_628_800.0 + s * (1.0 / 479_001_600.0));
    let even = 1.0 + s * (0.5 + s * (1.0 / 24.0 + s * (1.0 / 720.0 + s * high)));
    let high = 1.0 / 362_880.0 + s * (1.0 / 39_916_800.0 + s * (1.0 / 6_227_020_800.0));
    let odd = 1.0 + s * (1.0 / 6.0 + s * (1.0 / 120.0 + s * (1.0 / 5040.0 + s * high)));
    let power = f64::from_bits(shifted.to_bits().wrapping_add(1023) << 52);
    if x > LOWEST { (even + r * odd) * power } else { 0.0 }
}

/// Returns the point of the standard normal distribution beyond which the probability is `share`, for shares from 1e-300 to 1/2.
/// The relative error is about 1e-15.
///
/// PPND16 of AS 241; all three rational approximations are evaluated side by side.
#[inline(always)]
#[must_use]
pub fn inverse_survival(share: f64) -> f64 {
    let d = 0.5 - share;
    let root = (-log(share)).sqrt();
    let central = d <= 0.425;
    let near = root <= 5.0;
    let (top_c, bottom_c) = rational(&AS241_CENTRAL, 0.180_625 - d * d);
    let (top_n, bottom_n) = rational(&AS241_NEAR, root - 1.6);
    let (top_f, bottom_f) = rational(&AS241_FAR, root - 5.0);
    let top = if near { top_n } else { top_f };
    let bottom = if near { bottom_n } else { bottom_f };
    let top = if central { top_c * d } else { top };
    let bottom = if central { bottom_c } else { bottom };
    top / bottom
}

/// Evaluates numerator and denominator at `x`; coefficients go from the highest power down.
#[inline(always)]
fn rational([top, bottom]: &[[f64; 8]; 2], x: f64) -> (f64, f64) {
    let mut t = top[0];
    let mut b = bottom[0];
    let mut i = 1;
    while i < 8 {
        t = t * x + top[i];
        b = b * x + bottom[i];
        i += 1;
    }
    (t, b)
}

const AS241_CENTRAL: [[f64; 8]; 2] = [
    [
        2.509_080_928_730_122_672_7e3,
        3.343_057_558_358_812_810_5e4,
        6.726_577_092_700_870_085_3e4,
        4.592_195_393_154_987_145_7e4,
        1.373_169_376_550_946_112_5e4,
        1.971_590_950_306_551_442_7e3,
        1.331_416_678_917_843_774_5e2,
        3.387_132_872_796_366_608_0e0,
    ],
    [
        5.226_495_278_852_854_561_0e3,
        2.872_908_573_572_194_267_4e4,
        3.930_789_580_009_271_061_0e4,
        2.121_379_430_158_659_586_7e4,
        5.394_196_021_424_751_107_7e3,
        6.871_870_074_920_579_083_0e2,
        4.231_333_070_160_091_125_2e1,
        1.0,
    ],
];

const AS241_NEAR: [[f64; 8]; 2] = [
    [
        7.745_450_142_783_414_076_40e-4,
        2.272_384_498_926_918_458_33e-2,
        2.417_807_251_774_506_117_70e-1,
        1.270_458_252_452_368_382_58e0,
        3.647_848_324_763_204_605_04e0,
        5.769_497_221_460_691_405_50e0,
        4.630_337_846_156_545_295_90e0,
        1.423_437_110_749_683_577_34e0,
    ],
    [
        1.050_750_071_644_416_843_24e-9,
        5.475_938_084_995_344_946_00e-4,
        1.519_866_656_361_645_719_66e-2,
        1.481_039_764_274_800_745_90e-1,
        6.897_673_349_851_000_045_50e-1,
        1.676_384_830_183_803_849_40e0,
        2.053_191_626_637_758_821_87e0,
        1.0,
    ],
];

const AS241_FAR: [[f64; 8]; 2] = [
    [
        2.010_334_399_292_288_132_65e-7,
        2.711_555_568_743_487_578_15e-5,
        1.242_660_947_388_078_438_60e-3,
        2.653_218_952_657_612_309_30e-2,
        2.965_605_718_285_048_912_30e-1,
        1.784_826_539_917_291_335_80e0,
        5.463_784_911_164_114_369_90e0,
        6.657_904_643_501_103_777_20e0,
    ],
    [
        2.044_263_103_389_939_785_64e-15,
        1.421_511_758_316_445_888_70e-7,
        1.846_318_317_510_054_681_80e-5,
        7.868_691_311_456_132_591_00e-4,
        1.487_536_129_085_061_485_25e-2,
        1.369_298_809_227_358_053_10e-1,
        5.998_322_065_558_879_376_90e-1,
        1.0,
    ],
];

#[cfg(test)]
mod tests {
    use super::*;

    /// Quantiles of the table in Abramowitz and Stegun 26.5.
    #[test]
    fn quantiles_are_the_tables() {
        for (u, z) in [(0.5, 0.0), (0.9, 1.281_551_566), (0.975, 1.959_963_985), (0.001, -3.090_232_306)] {
            assert!((quantile(u) - z).abs() < 1e-9 && (cdf(z) - u).abs() < 1e-9, "{u}");
        }
    }

    #[test]
    fn logarithm_is_that_of_libm() {
        for i in 0..20_000 {
            let x = libm::exp((f64::from(i) - 19_900.0) / 30.0);
            assert!((log(x) / libm::log(x) - 1.0).abs() < 5e-16 || x == 1.0, "{x}");
        }
        assert_eq!(log(1.0), 0.0);
    }

    #[test]
    fn exponential_is_that_of_libm() {
        for i in 0..70_000 {
            let x = -f64::from(i) * 0.010_1;
            let off = exp_of_negative(x) / libm::exp(x) - 1.0;
            assert!(off.abs() < 5e-16, "{x}: {off:e}");
        }
        assert_eq!(
            [exp_of_negative(0.0), exp_of_negative(-709.0), exp_of_negative(f64::NEG_INFINITY)],
            [1.0, 0.0, 0.0]
        );
    }

    /// The share beyond its own quantile, against libm's erfc.
    #[test]
    fn normal_quantile_inverts_erfc() {
        for i in 1..3000 {
            let share = 0.5 * libm::exp(-f64::from(i) * 0.23);
            let z = inverse_survival(share);
            let back = 0.5 * libm::erfc(z * std::f64::consts::FRAC_1_SQRT_2);
            // The share changes by a factor z^2 times the relative rounding of z.
            let tolerance = 8e-16 * (4.0 + z * z);
            assert!((back / share - 1.0).abs() < tolerance, "{share:e}: {:e}", back / share - 1.0);
        }
    }
}
