//! Snell's law in vector form: d' = mu d + push N, with the unit direction d, the unit normal N pointing either way, and mu the
//! index before over the index after. A mirror has mu = 1, push = -2 d . N.

/// Returns the push along the normal for a ray that arrives at `cosine` = d . N, and the square of the cosine after the
/// surface. The square is negative (or NaN) if the ray is totally reflected.
///
/// `POSITIVE` states the sign of the cosine, which refraction keeps.
#[inline(always)]
pub(super) fn snell<const POSITIVE: bool>(cosine: f64, mu: f64) -> (f64, f64) {
    let along = mu * cosine;
    let k = (1.0 - mu * mu) + along * along;
    let root = k.sqrt();
    (if POSITIVE { root - along } else { -root - along }, k)
}

/// Computes [`snell`] for a normal whose squared length is `length2`: `along` is d . N, and the returned square of the cosine
/// is multiplied by `length2`.
#[inline(always)]
pub(super) fn snell_of_length<const POSITIVE: bool>(along: f64, mu: f64, length2: f64) -> (f64, f64) {
    let along = mu * along;
    let k = (1.0 - mu * mu) * length2 + along * along;
    let root = k.sqrt();
    ((if POSITIVE { root - along } else { -root - along }) / length2, k)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Snell's law at n = 1.0016: 20 deg gives 19.96669 deg, 35 deg gives 34.93594 deg (closed form,
    /// asin(sin i / n)); the same with the normal turned round.
    #[test]
    fn snell_by_angle() {
        for (incidence, want) in [(20.0_f64, 19.96669), (35.0, 34.93594)] {
            for sense in [1.0, -1.0] {
                let i = incidence.to_radians();
                let (s, c) = (crate::math::sin(i), crate::math::cos(i));
                let mu = 1.0 / 1.0016;
                let (push, k) = if sense > 0.0 { snell::<true>(c, mu) } else { snell::<false>(-c, mu) };
                assert!(k > 0.0);
                let (y, z) = (mu * s, mu * c + push * sense);
                let angle = crate::math::atan2(y, z).to_degrees();
                assert!((angle - want).abs() < 5e-6, "{angle}");
                assert!((y * y + z * z - 1.0).abs() < 1e-15);
            }
        }
    }

    /// A longer normal gets a shorter push, and bends alike.
    #[test]
    fn length_of_the_normal_does_not_matter() {
        let (c, mu, length) = (0.8, 1.0 / 1.5, 3.7);
        let (push, k) = snell::<true>(c, mu);
        let (long_push, long_k) = snell_of_length::<true>(c * length, mu, length * length);
        assert!((long_push * length - push).abs() < 1e-15 && (long_k - k * length * length).abs() < 1e-14);
    }

    #[test]
    fn total_reflection_is_a_negative_square() {
        assert!(snell::<true>(0.6, 1.5).1 < 0.0);
        // At the critical angle, sin i = 1/n, it is zero.
        let s: f64 = 1.0 / 1.5;
        assert!(snell::<true>((1.0 - s * s).sqrt(), 1.5).1.abs() < 1e-15);
    }
}
