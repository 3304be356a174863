//! The logarithmic ACEScct curve for color grading.

use libm::{exp2, log2};

/// Linear light at which the curve changes from straight to logarithmic, and slope and offset of its straight part (Academy S-2016-001).
const BREAK: f64 = 0.007_812_5;
const SLOPE: f64 = 10.540_237_741_654_5;
const OFFSET: f64 = 0.072_905_534_195_835_5;

/// Encodes linear light in AP1 primaries as an ACEScct value (Academy S-2016-001): 0.18 gives 0.4136, 1 gives 0.5548 and 222 gives 1.
#[must_use]
pub fn aces_cct(linear: f64) -> f64 {
    if linear <= BREAK { SLOPE * linear + OFFSET } else { (log2(linear) + 9.72) / 17.52 }
}

/// Decodes an ACEScct value to linear light: the inverse of [`aces_cct`].
#[must_use]
pub fn from_aces_cct(value: f64) -> f64 {
    let straight = SLOPE * BREAK + OFFSET;
    if value <= straight { (value - OFFSET) / SLOPE } else { exp2(value * 17.52 - 9.72) }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Reference values from colour-science 0.4.7, `log_encoding_ACEScct`.
    #[test]
    fn the_curve_is_that_of_the_standard() {
        for (linear, want) in [
            (-0.002, 0.051_825_058_7),
            (0.0, 0.072_905_534_2),
            (0.007_812_5, 0.155_251_141_6),
            (0.18, 0.413_588_402_5),
            (1.0, 0.554_794_520_5),
            (100.0, 0.934_010_056_5),
        ] {
            assert!((aces_cct(linear) - want).abs() < 1e-9, "{linear}: {}", aces_cct(linear));
            assert!((from_aces_cct(want) - linear).abs() < 1e-6 * (1.0 + linear.abs()), "{linear}");
        }
    }
}
