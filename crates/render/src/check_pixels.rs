//! The pixels that are traced a second time to judge the noise of light that is traced backward.
//!
//! The samples of a pixel are one sequence, because two halves with independent scrambling are noisier than one sequence of the same
//! length: with 128 samples 1.96 % against 1.61 %, measured on `noise-portrait`. The error of one sequence cannot be told from the sequence
//! itself. One pixel in eight therefore has a second sequence, scrambled independently. The difference of the two is known to be noise, and
//! the light of both is in the picture.
//!
//! The pixel is drawn at random for each group of 4 x 2 pixels, so that every color of a mosaic is judged and no row or column of pixels is
//! preferred. It depends on the seed: otherwise a place whose noise lies in a few pixels would be judged wrong in every picture.

use spectra_core::frame::FrameSize;
use spectra_core::numbers::mix64;

/// Columns and rows of a group, pixels. A tile holds whole groups.
const GROUP: [u32; 2] = [4, 2];
/// Turns the seed of the picture into that of its check pixels.
const SEED: u64 = 0x6368_6563_6b73;
/// Number of pixels for each check pixel.
pub(crate) const PIXELS_A_CHECK: usize = (GROUP[0] * GROUP[1]) as usize;

/// The check pixels of a frame, numbered by their groups, row by row. Groups at the right and lower border of the frame may be smaller.
#[derive(Clone, Copy, Debug)]
pub(crate) struct CheckPixels {
    width: u32,
    height: u32,
    /// Number of groups in a row of groups.
    across: u32,
    seed: u64,
}

impl CheckPixels {
    /// Draws the check pixels of the picture with this seed.
    pub fn of(size: FrameSize, seed: u64) -> Self {
        let across = size.width_px.div_ceil(GROUP[0]);
        Self { width: size.width_px, height: size.height_px, across, seed: mix64(seed ^ SEED) }
    }

    /// Number of groups, and so of check pixels.
    pub fn count(self) -> usize {
        self.across as usize * self.height.div_ceil(GROUP[1]) as usize
    }

    /// Returns the group that a pixel of the frame is the check pixel of; `None` if it is not a check pixel.
    pub fn group_of(self, pixel: usize) -> Option<usize> {
        let (column, row) = (pixel as u32 % self.width, pixel as u32 / self.width);
        let [group_column, group_row] = [column / GROUP[0], row / GROUP[1]];
        let columns = GROUP[0].min(self.width - group_column * GROUP[0]);
        let rows = GROUP[1].min(self.height - group_row * GROUP[1]);
        let group = group_row * self.across + group_column;
        let drawn = (mix64(self.seed ^ u64::from(group)) % u64::from(columns * rows)) as u32;
        let own = row % GROUP[1] * columns + column % GROUP[0];
        (own == drawn).then_some(group as usize)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_group_has_one_check_pixel() {
        for (width_px, height_px) in [(64, 64), (33, 7), (1, 1), (30, 31)] {
            let size = FrameSize { width_px, height_px, width_mm: 36.0, height_mm: 24.0 };
            let checks = CheckPixels::of(size, 1);
            let mut found: Vec<usize> = (0..size.pixels()).filter_map(|pixel| checks.group_of(pixel)).collect();
            found.sort_unstable();
            assert!(found.into_iter().eq(0..checks.count()), "{width_px} x {height_px}");
        }
    }

    /// Each of the four colors of a mosaic has a quarter of the check pixels, to within 4 standard errors.
    #[test]
    fn check_pixels_lie_on_all_colors_of_a_mosaic() {
        let size = FrameSize { width_px: 256, height_px: 256, width_mm: 36.0, height_mm: 36.0 };
        let checks = CheckPixels::of(size, 1);
        let mut of_color = [0_u32; 4];
        let pixels = (0..size.pixels()).filter(|pixel| checks.group_of(*pixel).is_some());
        pixels.for_each(|pixel| of_color[pixel / 256 % 2 * 2 + pixel % 2] += 1);
        let error = (8192.0_f64 * 0.25 * 0.75).sqrt();
        assert!(of_color.iter().all(|n| (f64::from(*n) - 2048.0).abs() < 4.0 * error), "{of_color:?}");
    }
}
