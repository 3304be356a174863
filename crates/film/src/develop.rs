//! From exposure to density: the latent image, made visible.
//!
//! The chain is exposure in lx s -> reciprocity -> amounts of each layer. What happens to the light inside of
//! the film comes before the curve, what happens to the silver after it, each on the whole frame.

use crate::display::{MissingChannel, channel};
use crate::emulsion::Emulsion;
use crate::stock::Stock;
use spectra_core::frame::{ExposureFrame, FrameSize};

/// What is in one layer, pixel by pixel.
#[derive(Clone, Debug, PartialEq)]
pub struct DensityLayer {
    /// The layer's name.
    pub name: String,
    /// Silver: optical density (diffuse, transmission). Dye: its amount in units of the stock's table. Row-major, upright.
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

/// Develops a frame whose channels are the stock's layers, exposed for `exposure_time_s`, by the development called
/// `development`.
///
/// # Errors
/// A text: the frame has no channel for a layer, or the stock no such development.
pub fn develop(
    stock: &Stock,
    development: &str,
    exposure: &ExposureFrame,
    exposure_time_s: f64,
) -> Result<Developed, String> {
    let emulsion = Emulsion::new(stock, development).map_err(|e| e.to_string())?;
    let effect = stock.reciprocity.as_ref().map_or(1.0, |r| r.effect(exposure_time_s));
    let planes = stock.layers.iter().map(|layer| {
        let seen = channel(exposure, &layer.name).map_err(|e: MissingChannel| e.to_string())?;
        Ok(seen.values.clone())
    });
    let mut planes = planes.collect::<Result<Vec<_>, String>>()?;
    emulsion.develop_all(&mut planes, effect);
    let layers = stock.layers.iter().zip(planes);
    let layers = layers.map(|(layer, density)| DensityLayer { name: layer.name.clone(), density }).collect();
    Ok(Developed { size: exposure.size, layers })
}
