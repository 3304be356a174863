//! A mixed pixel, separated into foreground and background.

/// A mixed pixel, separated into foreground and background.
#[derive(Clone, Copy, Debug)]
pub(super) struct Parted {
    /// Fraction of the pixel that the foreground covers, 0 to 1.
    pub opacity: f32,
    pub near: [f32; 3],
    pub far: [f32; 3],
    pub near_mm: f32,
    pub far_mm: f32,
}
