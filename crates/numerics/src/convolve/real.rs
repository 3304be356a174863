//! The precision that a convolution is computed in.

use std::ops::{Add, AddAssign, Mul, MulAssign, Neg, Sub};

/// `f32`, or `f64`.
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
    /// The nearest number of this precision.
    fn of(value: f64) -> Self;
    /// A number of a picture.
    fn of_single(value: f32) -> Self;
    /// The same number.
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
