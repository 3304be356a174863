//! What lies behind the mixed pixels of a picture with depth, for rays that come through them.

use super::edges::{Mixed, Sparse};
use super::field::{HeightField, Hit};
use super::spot::Spot;
use spectra_core::stage::ColorModel;

/// The picture once more with its mixed pixels at the depth and in the color of what is behind, and how much covers them in front.
pub(super) struct Backdrop {
    cells: Sparse,
    opacity: Vec<f32>,
    /// What the color model needs of each.
    colors: Vec<[f32; 3]>,
    pub field: HeightField,
}

impl Backdrop {
    /// Of the mixed pixels of a picture whose depths in front are `depth_mm`.
    pub(super) fn new(mixed: Mixed, model: &dyn ColorModel, depth_mm: &[f32], width: usize, edge: f64) -> Self {
        let mut all = depth_mm.to_vec();
        mixed.cells.cells().zip(&mixed.behind).for_each(|(cell, behind)| all[cell] = behind.depth_mm);
        let field = HeightField::new(width, depth_mm.len() / width, &all, edge);
        let opacity = mixed.behind.iter().map(|behind| behind.opacity).collect();
        let colors = mixed.behind.iter().map(|behind| model.coefficients(behind.rgb.map(f64::from))).collect();
        Self { cells: mixed.cells, opacity, colors, field }
    }

    /// The mixed pixels.
    pub(super) fn cells(&self) -> impl Iterator<Item = usize> {
        self.cells.cells()
    }

    /// Whether a pixel is one of them.
    #[inline(always)]
    pub(super) fn has(&self, cell: usize) -> bool {
        self.cells.has(cell)
    }

    /// Whether what is guessed for a ray that goes behind the edge of a near thing need not be: where it ends lies a mixed pixel, or one that
    /// touches it, of which it is known what is behind. A lamp whose rim alone is to be seen beside hair shines all the same.
    #[inline(always)]
    pub(super) fn shows(&self, hit: &Hit) -> bool {
        if !hit.guessed {
            return false;
        }
        let cell = self.field.cell(hit.place);
        self.has(cell) && self.field.together(hit.cell, cell)
    }

    /// The color behind a pixel, if it is a mixed one.
    #[inline(always)]
    pub(super) fn color(&self, cell: usize) -> Option<[f32; 3]> {
        self.cells.place(cell).map(|place| self.colors[place])
    }

    /// How much of what is met in a mixed pixel is in front there, linear between the centers of pixels; `None` in any other pixel.
    #[inline(always)]
    pub(super) fn opacity(&self, cell: usize, spot: &Spot) -> Option<f32> {
        let own = self.opacity[self.cells.place(cell)?];
        Some(spot.mix(|cell| [self.cells.place(cell).map_or(own, |place| self.opacity[place])])[0])
    }

    /// The same all over a pixel, wherever it is met.
    #[inline(always)]
    pub(super) fn opacity_of(&self, cell: usize) -> Option<f32> {
        self.cells.place(cell).map(|place| self.opacity[place])
    }
}
