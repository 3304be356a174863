use super::super::drawing::Drawing;
use super::parts::{FRAME, patch_block};

/// Draws the 24 patches of a ColorChecker: squares of 40 mm with gaps of 6 mm.
pub fn color_checker(_seed: u64) -> Drawing {
    let mut drawing = Drawing::new(6.0 * 46.0 + 6.0, 4.0 * 46.0 + 6.0, FRAME);
    patch_block(&mut drawing, [0.0, 0.0], 40.0, 46.0);
    drawing
}
