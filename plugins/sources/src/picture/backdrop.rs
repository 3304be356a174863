//! The background behind the mixed pixels of a picture with depth, for rays that pass through them.

use super::edges::{Mixed, Sparse};
use super::height_field::{HeightField, Hit};
use super::pixel_quad::PixelQuad;
use spectra_core::stage::ColorModel;

/// A copy of the picture in which mixed pixels have the depth and color of their background, with the opacity of the foreground there.
pub(super) struct Backdrop {
    cells: Sparse,
    opacity: Vec<f32>,
    /// Coefficients of the color model for the background of each mixed pixel.
    colors: Vec<[f32; 3]>,
    pub field: HeightField,
}

impl Backdrop {
    /// Creates the background for the mixed pixels of a picture whose depths in front are `depth_mm`, mm.
    pub(super) fn new(mixed: Mixed, model: &dyn ColorModel, depth_mm: &[f32], width: usize, edge: f64) -> Self {
        let mut all = depth_mm.to_vec();
        mixed.cells.cells().zip(&mixed.behind).for_each(|(cell, behind)| all[cell] = behind.depth_mm);
        let field = HeightField::new(width, depth_mm.len() / width, &all, edge);
        let opacity = mixed.behind.iter().map(|behind| behind.opacity).collect();
        let colors = mixed.behind.iter().map(|behind| model.coefficients(behind.rgb.map(f64::from))).collect();
        Self { cells: mixed.cells, opacity, colors, field }
    }

    /// Returns the mixed pixels, in ascending order.
    pub(super) fn cells(&self) -> impl Iterator<Item = usize> {
        self.cells.cells()
    }

    /// Returns whether a pixel is mixed.
    #[inline(always)]
    pub(super) fn has(&self, cell: usize) -> bool {
        self.cells.has(cell)
    }

    /// Returns whether the background is known where a ray passes behind the edge of a near object, so that it need not be guessed. It is
    /// known if the ray ends at a mixed pixel or at one that touches it. A lamp of which only the rim is visible beside hair therefore
    /// keeps its light.
    #[inline(always)]
    pub(super) fn shows(&self, hit: &Hit) -> bool {
        if !hit.guessed {
            return false;
        }
        let cell = self.field.cell(hit.place);
        self.has(cell) && self.field.together(hit.cell, cell)
    }

    /// Returns the coefficients of the color behind a pixel; `None` if the pixel is not mixed.
    #[inline(always)]
    pub(super) fn color(&self, cell: usize) -> Option<[f32; 3]> {
        self.cells.place(cell).map(|place| self.colors[place])
    }

    /// Returns the opacity of the foreground at a point of a mixed pixel, linear between the centers of pixels; `None` in any other pixel.
    #[inline(always)]
    pub(super) fn opacity(&self, cell: usize, spot: &PixelQuad) -> Option<f32> {
        let own = self.opacity[self.cells.place(cell)?];
        Some(spot.mix(|cell| [self.cells.place(cell).map_or(own, |place| self.opacity[place])])[0])
    }

    /// Returns the opacity of the foreground of a whole pixel; `None` if the pixel is not mixed.
    #[inline(always)]
    pub(super) fn opacity_of(&self, cell: usize) -> Option<f32> {
        self.cells.place(cell).map(|place| self.opacity[place])
    }
}
