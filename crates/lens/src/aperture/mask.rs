//! Masks: pictures used as apertures.

use std::sync::Arc;

/// A picture in the plane of a surface that works as an aperture: white passes light, black stops it.
#[derive(Clone, Debug, PartialEq)]
pub struct Mask {
    width_px: usize,
    height_px: usize,
    pitch_mm: f64,
    /// Transmittances, 0 to 1: rows from the top (+y), each from the left (-x).
    transmittances: Arc<[f32]>,
}

impl Mask {
    /// Creates a mask from `width_px` by `height_px` pixels that is `width_mm` wide. Rows of `transmittances` (0 to 1) run from
    /// the top, each from the left.
    ///
    /// # Panics
    /// If `transmittances` does not have `width_px * height_px` values.
    #[must_use]
    pub fn new(width_px: usize, height_px: usize, width_mm: f64, transmittances: Arc<[f32]>) -> Self {
        assert_eq!(transmittances.len(), width_px * height_px);
        Self { width_px, height_px, pitch_mm: width_mm / width_px as f64, transmittances }
    }

    /// Returns the mask with all lengths multiplied by `factor`.
    pub(crate) fn scaled(&self, factor: f64) -> Self {
        Self { pitch_mm: self.pitch_mm * factor, ..self.clone() }
    }

    /// Transmittance of the pixel at a point (x and y in mm from the center of the picture); 0 outside the picture.
    #[must_use]
    pub fn transmittance(&self, x_mm: f64, y_mm: f64) -> f64 {
        let column = x_mm / self.pitch_mm + 0.5 * self.width_px as f64;
        let row = 0.5 * self.height_px as f64 - y_mm / self.pitch_mm;
        if !(column >= 0.0 && row >= 0.0 && column < self.width_px as f64 && row < self.height_px as f64) {
            return 0.0;
        }
        f64::from(self.transmittances[row as usize * self.width_px + column as usize])
    }

    /// Half the diagonal of the picture, mm.
    #[must_use]
    pub fn reach_mm(&self) -> f64 {
        let (w, h) = (self.width_px as f64, self.height_px as f64);
        0.5 * self.pitch_mm * (w * w + h * h).sqrt()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn up_is_up_and_left_is_left() {
        let mask = Mask::new(2, 2, 4.0, Arc::from([1.0, 0.25, 0.0, 0.5]));
        assert_eq!(mask.transmittance(-1.0, 1.0), 1.0);
        assert_eq!(mask.transmittance(1.0, 1.0), 0.25);
        assert_eq!(mask.transmittance(-1.0, -1.0), 0.0);
        assert_eq!(mask.transmittance(1.0, -1.0), 0.5);
        assert_eq!(mask.transmittance(2.1, 0.0), 0.0);
    }
}
