//! A subset of the pixels of a picture, stored as one bit per pixel and one count per 64 pixels.

/// A set of pixels that gives the rank of each of its pixels.
pub(in super::super) struct Sparse {
    bits: Vec<u64>,
    /// Number of pixels of the set before each word.
    before: Vec<u32>,
}

impl Sparse {
    /// Creates the set of `cells`, in ascending order, among `len` pixels.
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

    /// Returns whether a pixel belongs to the set.
    #[inline(always)]
    pub(in super::super) fn has(&self, cell: usize) -> bool {
        self.bits[cell / 64] >> (cell % 64) & 1 == 1
    }

    /// Returns the rank of a pixel in the set; `None` if it does not belong to it.
    #[inline(always)]
    pub(in super::super) fn place(&self, cell: usize) -> Option<usize> {
        let word = self.bits[cell / 64];
        let bit = 1 << (cell % 64);
        (word & bit != 0).then(|| self.before[cell / 64] as usize + (word & (bit - 1)).count_ones() as usize)
    }

    /// Returns all pixels of the set, in ascending order.
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
