//! Hashed random numbers: the SplitMix64 finalizer, and the generator around it.
//!
//! G. L. Steele, D. Lea, C. H. Flood, "Fast splittable pseudorandom number generators", OOPSLA 2014, with D. Stafford's thirteenth mixer.

/// The increment of the SplitMix64 generator: 2^64 divided by the golden ratio, rounded to an odd integer.
pub const GOLDEN: u64 = 0x9e37_79b9_7f4a_7c15;

/// Hashes 64 bits with the SplitMix64 finalizer. Zero stays zero.
#[inline(always)]
#[must_use]
pub const fn mix64(mut x: u64) -> u64 {
    x = (x ^ (x >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    x = (x ^ (x >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    x ^ (x >> 31)
}

/// Converts the upper 53 bits of `bits` to a number in [0, 1).
#[inline(always)]
#[must_use]
pub fn unit(bits: u64) -> f64 {
    (bits >> 11) as f64 / (1_u64 << 53) as f64
}

/// Converts the upper 52 bits of `bits` to a number in (0, 1), the center of their cell.
#[inline(always)]
#[must_use]
pub fn open_unit(bits: u64) -> f64 {
    ((bits >> 12) as f64 + 0.5) / (1_u64 << 52) as f64
}

/// A stream of random numbers: the n-th is a pure function of the key and n.
#[derive(Clone, Copy, Debug)]
pub struct SplitMix64 {
    state: u64,
}

impl SplitMix64 {
    /// Starts the stream of random numbers of a key.
    #[must_use]
    pub const fn new(key: u64) -> Self {
        Self { state: key }
    }

    /// Draws 64 random bits.
    #[inline(always)]
    pub fn bits(&mut self) -> u64 {
        self.state = self.state.wrapping_add(GOLDEN);
        mix64(self.state)
    }

    /// Draws a uniform number in [0, 1).
    #[inline(always)]
    pub fn unit(&mut self) -> f64 {
        unit(self.bits())
    }

    /// Draws a uniform number in (0, 1).
    #[inline(always)]
    pub fn open_unit(&mut self) -> f64 {
        open_unit(self.bits())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// First outputs of the reference implementation for seed 1234567 (S. Vigna, splitmix64.c, public domain).
    #[test]
    fn the_generator_is_the_published_one() {
        let mut random = SplitMix64::new(1_234_567);
        let first: [u64; 5] = std::array::from_fn(|_| random.bits());
        let published = [
            6_457_827_717_110_365_317,
            3_203_168_211_198_807_973,
            9_817_491_932_198_370_423,
            4_593_380_528_125_082_431,
            16_408_922_859_458_223_821,
        ];
        assert_eq!(first, published);
    }
}
