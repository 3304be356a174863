//! From exposure to density: the latent image, made visible.
//!
//! The chain is exposure in lx s -> reciprocity -> density of each layer. What happens to the light inside of
//! the film comes before the curve, what happens to the silver after it, each on the whole frame.

use crate::curve::CharacteristicCurve;
use crate::display::{MissingChannel, channel};
use crate::lookup::{Lookup, PIXELS_A_TASK, from_octaves, octaves};
use crate::stock::{Reciprocity, Stock};
use rayon::prelude::*;
use spectra_core::frame::{ExposureFrame, FrameSize};
use spectra_core::math::log10;

/// Optical density of one layer, pixel by pixel.
#[derive(Clone, Debug, PartialEq)]
pub struct DensityLayer {
    /// The layer's name.
    pub name: String,
    /// Optical density (diffuse, transmission), row-major, upright.
    pub density: Vec<f32>,
}

/// A developed film.
#[derive(Clone, Debug, PartialEq)]
pub struct Developed {
    /// Size.
    pub size: FrameSize,
    /// Layers, in the order of the stock.
    pub layers: Vec<DensityLayer>,
}

/// Develops a frame whose channels are the stock's layers, exposed for `exposure_time_s`, each layer by the
/// development called `development`.
///
/// # Errors
/// [`MissingChannel`] for a layer that the frame has no channel for, or that has no such development.
pub fn develop(
    stock: &Stock,
    development: &str,
    exposure: &ExposureFrame,
    exposure_time_s: f64,
) -> Result<Developed, MissingChannel> {
    let effect = stock.reciprocity.map_or(1.0, |r| r.effect(exposure_time_s));
    let layers = stock.layers.iter().map(|layer| {
        let exposed = channel(exposure, &layer.name)?;
        let curve = &layer.development(development).ok_or_else(|| MissingChannel(layer.name.clone()))?.curve;
        Ok(DensityLayer { name: layer.name.clone(), density: densities(curve, &exposed.values, effect) })
    });
    Ok(Developed { size: exposure.size, layers: layers.collect::<Result<_, _>>()? })
}

/// Steps of the sampled curve an octave of exposure. With a second derivative of the density below 1 in octaves
/// (a film of gradient 3 at most), linear interpolation is within 1 / 8 / 512^2 = 5e-7 of the curve.
const STEPS_AN_OCTAVE: usize = 512;

/// Octaves over the smallest normal `f32` that are sampled: 2^-40 to 2^40 lx s, some 1e-12 to 1e12.
const OCTAVES: (usize, usize) = (126 - 40, 126 + 40);

fn densities(curve: &CharacteristicCurve, exposure_lx_s: &[f32], effect: f64) -> Vec<f32> {
    let (low, high) = OCTAVES;
    let at = |octaves: f64| curve.density(log10(from_octaves(octaves) * effect));
    let sampled = Lookup::new(low as f64, high as f64, (high - low) * STEPS_AN_OCTAVE, at);
    let unexposed = curve.unexposed_density() as f32;
    // Less than no exposure, and no number, are taken as none.
    let one = |h: &f32| if *h > 0.0 { sampled.at(octaves(*h)) as f32 } else { unexposed };
    exposure_lx_s.par_iter().with_min_len(PIXELS_A_TASK).map(one).collect()
}

impl Reciprocity {
    /// How much an exposure of `time_s` counts, relative to a short one of the same lx s: 1 up to the
    /// threshold, less beyond (K. Schwarzschild, 1900).
    ///
    /// The sheet gives the time Ta to expose for when the meter says Tm, Ta = Tm^p (in seconds); an exposure of Ta
    /// then does what Tm would without the effect.
    #[must_use]
    pub fn effect(&self, time_s: f64) -> f64 {
        if time_s > self.above_s {
            spectra_core::math::pow(time_s / self.above_s, 1.0 / self.exponent - 1.0)
        } else {
            1.0
        }
    }
}
