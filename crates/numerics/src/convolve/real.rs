//! Precision in which a convolution is computed.

use std::ops::{Add, AddAssign, Mul, MulAssign, Neg, Sub};

/// A floating-point number: `f32` or `f64`.
pub trait Real:
    Copy
    + Default
    + Send
    + Sync
    + Add<Output = Self>
    + AddAssign
    + Sub<Output = Self>
    + Mul<Output = Self>
    + MulAssign
    + Neg<Output = Self>
{
    /// Returns the nearest number of this precision.
    fn of(value: f64) -> Self;
    /// Converts a number of a picture.
    fn of_single(value: f32) -> Self;
    /// Returns the number as an `f64`.
    fn value(self) -> f64;
}

impl Real for f32 {
    #[inline(always)]
    fn of(value: f64) -> Self {
        value as f32
    }

    #[inline(always)]
    fn of_single(value: f32) -> Self {
        value
    }

    #[inline(always)]
    fn value(self) -> f64 {
        f64::from(self)
    }
}

impl Real for f64 {
    #[inline(always)]
    fn of(value: f64) -> Self {
        value
    }

    #[inline(always)]
    fn of_single(value: f32) -> Self {
        Self::from(value)
    }

    #[inline(always)]
    fn value(self) -> f64 {
        self
    }
}
