//! A mixed pixel, taken apart.

/// A pixel taken apart: what is in front, and what is behind.
#[derive(Clone, Copy, Debug)]
pub(super) struct Parted {
    /// The part of the pixel that what is in front covers.
    pub opacity: f32,
    pub near: [f32; 3],
    pub far: [f32; 3],
    pub near_mm: f32,
    pub far_mm: f32,
}
