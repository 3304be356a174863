//! Applies a point spread to planes of one size by the cheaper method: products of profiles, or Fourier transforms.

use super::PointSpread;
use crate::raster::Raster;
use spectra_numerics::convolve::{Convolver, Products};

/// Each Gaussian may lose this fraction of the light that the whole kernel may lose: where one Gaussian ends, others are a hundred times as
/// bright.
const OF_A_TERM: f64 = 0.01;

/// A point spread prepared for planes of one size.
pub(crate) enum PreparedSpread {
    Products(Products),
    Transforms(Convolver),
}

impl PreparedSpread {
    /// Prepares a spread, except for the fraction `beyond` and light beyond `most` pixels.
    pub(crate) fn new(spread: &PointSpread, raster: &Raster, beyond: f64, most: usize) -> Self {
        let (width, height) = (raster.width, raster.height);
        let most = most.min(width.max(height)).max(1);
        let profiles = spread.profiles(raster.pitch_mm, beyond, most);
        let radius = profiles[0].1.len() - 1;
        let products = Products::new(&profiles, OF_A_TERM * beyond, width, height);
        if products.pairs() <= Convolver::operations(radius, width, height) {
            return Self::Products(products);
        }
        Self::Transforms(Convolver::new(&spread.over_pixels(raster.pitch_mm, beyond, most), width, height))
    }

    /// Spreads the plane `source`; calls `write` with each target pixel and its value.
    pub(crate) fn apply(&self, source: &[f32], target: &mut [f32], write: impl Fn(&mut f32, f64) + Sync) {
        match self {
            Self::Products(products) => products.apply(source, target, |to, v| write(to, f64::from(v))),
            Self::Transforms(convolver) => convolver.apply(source, target, write),
        }
    }
}
