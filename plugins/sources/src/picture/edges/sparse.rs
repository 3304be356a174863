//! Some of the pixels of a picture, by a bit each and a count for each 64 of them.

/// A set of pixels that knows the place of each among them.
pub(in super::super) struct Sparse {
    bits: Vec<u64>,
    /// How many come before each word.
    before: Vec<u32>,
}

impl Sparse {
    /// From `len` pixels those in `cells`, in rising order.
    pub(super) fn new(len: usize, cells: impl Iterator<Item = usize>) -> Self {
        let mut bits = vec![0_u64; len.div_ceil(64)];
        cells.for_each(|cell| bits[cell / 64] |= 1 << (cell % 64));
        let mut sum = 0;
        let before = bits.iter().map(|word| {
            let before = sum;
            sum += word.count_ones();
            before
        });
        let before = before.collect();
        Self { bits, before }
    }

    /// Whether a pixel is one of them.
    #[inline(always)]
    pub(in super::super) fn has(&self, cell: usize) -> bool {
        self.bits[cell / 64] >> (cell % 64) & 1 == 1
    }

    /// The place of a pixel among them.
    #[inline(always)]
    pub(in super::super) fn place(&self, cell: usize) -> Option<usize> {
        let word = self.bits[cell / 64];
        let bit = 1 << (cell % 64);
        (word & bit != 0).then(|| self.before[cell / 64] as usize + (word & (bit - 1)).count_ones() as usize)
    }

    /// All of them, in rising order.
    pub(in super::super) fn cells(&self) -> impl Iterator<Item = usize> {
        (0..64 * self.bits.len()).filter(|cell| self.has(*cell))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn places_count_what_comes_before() {
        let cells = [0, 3, 63, 64, 127, 200];
        let sparse = Sparse::new(201, cells.into_iter());
        let places: Vec<_> = (0..201).filter_map(|cell| Some((cell, sparse.place(cell)?))).collect();
        assert_eq!(places, cells.into_iter().enumerate().map(|(k, cell)| (cell, k)).collect::<Vec<_>>());
        assert_eq!(sparse.cells().collect::<Vec<_>>(), cells);
        assert!(!sparse.has(1) && sparse.has(200));
    }
}
