//! Exact sums: 64-bit fixed point, so that the order of adding cannot matter.

use spectra_core::isa::Vectorized;
use std::sync::atomic::{AtomicBool, AtomicI64, Ordering::Relaxed};

/// Bits given to the largest contribution that a pilot run saw. With 2^32 of them in one pixel the
/// sum stays inside of 62 bits; rounding is 2^-30 of that contribution.
const BITS_OF_LARGEST: i32 = 29;
/// The largest contribution that is expected, scaled.
pub(crate) const LARGEST_EXPECTED: f64 = (1_u64 << BITS_OF_LARGEST) as f64;
/// The sum of a cell must stay below this.
const LIMIT: u64 = 1 << 62;
/// One contribution must stay below this for its rounding to be exact.
pub(crate) const LARGEST_CONTRIBUTION: f64 = (1_u64 << 50) as f64;

/// The scale for contributions whose largest is about `largest`: a power of two, so that scaling is exact.
pub(crate) fn scale_for(largest: f64) -> f64 {
    if !(largest.is_finite() && largest > 0.0) {
        return 1.0;
    }
    let exponent = libm::ilogb(largest) + 1;
    libm::ldexp(1.0, BITS_OF_LARGEST - exponent)
}

/// Rounds scaled values to integers, ties to even, by the same operations on every tier.
pub(crate) struct Round<'a> {
    pub values: &'a [f64],
    pub scale: f64,
    pub out: &'a mut [i64],
}

impl Vectorized for Round<'_> {
    /// Whether every value fits.
    type Output = bool;
    #[inline(always)]
    fn run(self) -> bool {
        // Adding 1.5 * 2^52 leaves the integer in the low bits.
        const MAGIC: f64 = 6_755_399_441_055_744.0;
        const BITS: i64 = MAGIC.to_bits() as i64;
        let mut bad = 0_u64;
        for (value, out) in self.values.iter().zip(self.out) {
            let scaled = value * self.scale;
            bad |= u64::from(!(scaled.abs() < LARGEST_CONTRIBUTION));
            *out = (scaled + MAGIC).to_bits() as i64 - BITS;
        }
        bad == 0
    }
}

/// One integer a pixel and channel, shared by all threads.
pub struct ExactSums {
    cells: Vec<AtomicI64>,
    overflow: AtomicBool,
}

impl ExactSums {
    /// `None` where memory does not suffice.
    pub(crate) fn new(cells: usize) -> Option<Self> {
        let mut all = Vec::new();
        all.try_reserve_exact(cells).ok()?;
        all.extend((0..cells).map(|_| AtomicI64::new(0)));
        Some(Self { cells: all, overflow: AtomicBool::new(false) })
    }

    #[inline(always)]
    pub(crate) fn add(&self, cell: usize, value: i64) {
        let old = self.cells[cell].fetch_add(value, Relaxed);
        if old.unsigned_abs() >= LIMIT {
            self.overflow.store(true, Relaxed);
        }
    }

    pub(crate) fn get(&self, cell: usize) -> i64 {
        self.cells[cell].load(Relaxed)
    }

    /// How many there are.
    pub(crate) fn cells(&self) -> usize {
        self.cells.len()
    }

    pub(crate) fn overflowed(&self) -> bool {
        self.overflow.load(Relaxed)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use spectra_core::Isa;

    #[test]
    fn rounding_is_to_nearest_even_on_every_tier() {
        let values = [0.0, 0.4, 0.5, 1.5, 2.5, -0.5, -1.5, 1e9 + 0.3, -7e13];
        for isa in Isa::available() {
            let mut out = [0; 9];
            assert!(isa.run(Round { values: &values, scale: 1.0, out: &mut out }));
            assert_eq!(out, [0, 0, 0, 2, 2, 0, -2, 1_000_000_000, -70_000_000_000_000]);
        }
        let mut out = [0; 1];
        for bad in [f64::NAN, f64::INFINITY, 1e300] {
            assert!(!Isa::detect().run(Round { values: &[bad], scale: 1.0, out: &mut out }));
        }
    }

    #[test]
    fn scale_leaves_room_and_is_a_power_of_two() {
        for largest in [1e-20, 0.3, 1.0, 77.0, 1e12] {
            let scale = scale_for(largest);
            assert_eq!(libm::frexp(scale).0, 0.5);
            let top = largest * scale;
            assert!((2_f64.powi(28)..=2_f64.powi(29)).contains(&top), "{top}");
        }
        assert_eq!(scale_for(0.0), 1.0);
    }

    #[test]
    fn overflow_is_noticed() {
        let sums = ExactSums::new(1).expect("memory");
        // Four of them reach the limit exactly; the next one finds the sum there.
        for _ in 0..4 {
            sums.add(0, 1 << 60);
        }
        assert!(!sums.overflowed());
        sums.add(0, 1);
        assert!(sums.overflowed());
    }
}
