//! Development: turns exposure into density.
//!
//! The chain is exposure in lx s -> reciprocity -> amounts in each layer. Effects on the light inside the film come before the curve,
//! effects on the silver after it, each on the whole frame.

use crate::display::{MissingChannel, channel};
use crate::emulsion::Emulsion;
use crate::stock::Stock;
use spectra_core::frame::{ExposureFrame, FrameSize};
use spectra_core::params::Fault;

/// Density of one layer, pixel by pixel.
#[derive(Clone, Debug, PartialEq)]
pub struct DensityLayer {
    /// Name of the layer.
    pub name: String,
    /// Silver: optical density (diffuse, transmission). Dye: amount in units of the stock's table. Row-major, upright.
    pub density: Vec<f32>,
}

/// A developed film: the densities of its layers.
#[derive(Clone, Debug, PartialEq)]
pub struct Developed {
    /// Size of the frame in pixels and mm.
    pub size: FrameSize,
    /// Densities of the layers, in the order of the stock.
    pub layers: Vec<DensityLayer>,
}

/// Develops a frame whose channels are the stock's layers, in lx s, exposed for `exposure_time_s`, with the development named
/// `development`.
///
/// # Errors
/// A text: the frame has no channel for a layer, the stock has no such development, or its layers cannot be developed.
pub fn develop(
    stock: &Stock,
    development: &str,
    exposure: &ExposureFrame,
    exposure_time_s: f64,
) -> Result<Developed, Fault> {
    let emulsion = Emulsion::new(stock, development).map_err(|e| e.to_string())?;
    let effect = stock.reciprocity.as_ref().map_or(1.0, |r| r.effect(exposure_time_s));
    let planes = stock.layers.iter().map(|layer| {
        let seen = channel(exposure, &layer.name).map_err(|e: MissingChannel| e.to_string())?;
        Ok(seen.values.clone())
    });
    let mut planes = planes.collect::<Result<Vec<_>, Fault>>()?;
    emulsion.develop_all(&mut planes, effect);
    let layers = stock.layers.iter().zip(planes);
    let layers = layers.map(|(layer, density)| DensityLayer { name: layer.name.clone(), density }).collect();
    Ok(Developed { size: exposure.size, layers })
}
