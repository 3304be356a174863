//! Columns of numbers, aligned to cache lines.

/// Eight values on one cache line.
#[derive(Clone, Copy, Debug, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C, align(64))]
struct CacheLine([u64; 8]);

/// A column of 8-byte numbers that starts on a cache line, so that wide loads never straddle two lines.
#[derive(Clone, Debug)]
pub struct Column<T> {
    lines: Vec<CacheLine>,
    of: std::marker::PhantomData<T>,
}

impl<T: bytemuck::Pod> Column<T> {
    /// Creates a column of zeros with room for `capacity` numbers.
    #[must_use]
    pub fn new(capacity: usize) -> Self {
        const { assert!(size_of::<T>() == 8) };
        Self { lines: vec![CacheLine([0; 8]); capacity.div_ceil(8)], of: std::marker::PhantomData }
    }

    /// Returns the first `len` numbers.
    #[inline(always)]
    #[must_use]
    pub fn slice(&self, len: usize) -> &[T] {
        &bytemuck::cast_slice(&self.lines)[..len]
    }

    /// Returns the first `len` numbers, writable.
    #[inline(always)]
    pub fn slice_mut(&mut self, len: usize) -> &mut [T] {
        &mut bytemuck::cast_slice_mut(&mut self.lines)[..len]
    }
}
