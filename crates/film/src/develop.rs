//! Development: turns the exposure of a film into the densities of its layers, with the effects of the film itself.
//!
//! [`develop`] is the order that every film process follows. Scatter and halation spread the light in the film while it lies in the gate
//! of the camera. The characteristic curve turns exposure into silver or dye. Adjacency moves the edges, grain roughens the result, and
//! dirt comes last. A film leaves out the steps that its [`Effects`] leave out.

use crate::adjacency::{Adjacency, Edges};
use crate::emulsion::Emulsion;
use crate::grain::{ColorGrain, FOG, Grain, GrainError, usual_half_power};
use crate::halation::{Halation, HalationBase};
use crate::raster::Raster;
use crate::scatter::{Mtf, Scatter};
use spectra_core::grain_noise::GrainNoise;
use spectra_core::math::log10;
use spectra_core::numbers::seed_of_frame;
use spectra_core::params::Fault;
use std::f64::consts::LOG10_E;

/// Granularity of a film's layers.
#[derive(Clone, Debug, PartialEq)]
pub enum Granularity {
    /// RMS granularity of silver times 1000, through an aperture of 48 um at density 1.
    Silver(f64),
    /// Granularity of each dye layer as a function of its amount.
    Dyes(ColorGrain),
}

impl Granularity {
    /// Returns the amount at which a layer has no grain, if `clear` is its least amount.
    fn base(&self, clear: f64) -> f64 {
        match self {
            Self::Silver(_) => clear,
            Self::Dyes(_) => clear - FOG,
        }
    }

    /// Builds the grain of layer number `layer` of the film, which is number `first_layer + layer` among all layers of the
    /// picture. `seed` selects the grains.
    ///
    /// The grain of a dye layer gets the half-power frequency that is usual for its granularity in the middle of its range.
    ///
    /// # Errors
    /// [`GrainError`]: no grain has this granularity.
    pub fn grain(&self, layer: usize, first_layer: u32, seed: u64) -> Result<Grain, GrainError> {
        let number = first_layer + layer as u32;
        match self {
            Self::Silver(rms) => Grain::calibrated(*rms, usual_half_power(*rms), seed, number),
            Self::Dyes(color) => {
                let most = color.most(layer);
                let half_power = usual_half_power(color.rms(layer, most / 2.0).max(1.0));
                Grain::by_density(|amount| color.rms(layer, amount), most, half_power, seed, number)
            }
        }
    }
}

/// Scatter, halation, adjacency and grain of one film. Each vector has an element per layer, in the order of the emulsion.
#[derive(Clone, Debug, PartialEq)]
pub struct Effects {
    /// MTF of the scatter in each layer; `None` if it is unknown or switched off.
    pub mtf: Vec<Option<Mtf>>,
    /// Adjacency effect of each layer; `None` if edges do not stand out or the effect is switched off.
    pub adjacency: Vec<Option<Adjacency>>,
    /// Halation of each layer; `None` if no light comes back to it.
    pub halation: Vec<Option<HalationBase>>,
    /// Granularity of all layers; `None` if there is no grain.
    pub granularity: Option<Granularity>,
    /// Names of the effects that rest on assumed figures.
    pub assumed: Vec<&'static str>,
    /// Seed that identifies the piece of film, the same for all frames.
    pub piece: u64,
    /// Seed of the grains, derived from the piece and the frame.
    pub seed: u64,
    /// Number of the first layer among all layers of the picture; each layer has its own grains.
    pub first_layer: u32,
}

impl Effects {
    /// Gives frame `frame` of an animation its own grains.
    pub fn set_frame(&mut self, frame: u64) {
        self.seed = seed_of_frame(self.piece, frame);
    }

    /// Returns whether any effect is computed on a raster, whose pixels are square.
    #[must_use]
    pub fn need_raster(&self) -> bool {
        self.adjacency.iter().any(Option::is_some)
            || self.halation.iter().any(Option::is_some)
            || self.granularity.is_some()
            || self.mtf.iter().any(Option::is_some)
    }

    /// Returns what `plane`, the exposure of layer number `layer` on `raster`, becomes by scatter in the emulsion.
    ///
    /// # Errors
    /// A message: the scatter cannot be computed at this size of pixels.
    pub fn scattered(&self, layer: usize, plane: &[f32], raster: &Raster) -> Result<Vec<f32>, Fault> {
        match &self.mtf[layer] {
            Some(mtf) => Ok(Scatter::new(mtf, raster).map_err(|e| e.to_string())?.applied(plane)),
            None => Ok(plane.to_vec()),
        }
    }

    /// Returns the exposure that layer number `layer` receives if `plane` falls on it, on `raster`: scattered in its emulsion,
    /// with halation added. `spare` is a work buffer that successive layers share.
    ///
    /// # Errors
    /// A message: scatter or halation cannot be computed at this size of pixels.
    pub fn spread(
        &self,
        layer: usize,
        plane: &[f32],
        raster: &Raster,
        spare: &mut Vec<f32>,
    ) -> Result<Vec<f32>, Fault> {
        let Some(base) = &self.halation[layer] else { return self.scattered(layer, plane, raster) };
        let halation = Halation::new(base, raster).map_err(|e| e.to_string())?;
        let Some(mtf) = &self.mtf[layer] else { return Ok(halation.applied(plane)) };
        spare.resize(plane.len(), 0.0);
        Scatter::new(mtf, raster).map_err(|e| e.to_string())?.apply_to(plane, spare);
        Ok(halation.applied(spare))
    }

    /// Applies the adjacency effect to the developed amounts of a layer.
    fn edges(&self, layer: usize, plane: &mut [f32], emulsion: &Emulsion, raster: &Raster) {
        if let Some(adjacency) = &self.adjacency[layer] {
            let unexposed = emulsion.amount(layer, f64::NEG_INFINITY);
            Edges::new(adjacency, raster).apply(plane, unexposed, emulsion.range(layer));
        }
    }

    /// Returns the grain of layer number `layer` on pixels with the side `pitch_mm`, as an unevenness of the exposure; `None` if there is
    /// none. `factor` converts exposures to those that take effect, as in [`develop`].
    #[must_use]
    pub fn grain_noise(&self, layer: usize, emulsion: &Emulsion, factor: f64, pitch_mm: f64) -> Option<GrainNoise> {
        /// Log10 of the exposures (lx s) that take effect, and the step between samples: a curve is nearly straight over a sixth of a stop.
        const SPAN: [f64; 2] = [-6.0, 6.0];
        const STEP: f64 = 0.05;
        /// Largest fraction that is told: no noise is visible where the curve is flat.
        const MOST: f64 = 1e3;
        let granularity = self.granularity.as_ref()?;
        let grain = granularity.grain(layer, self.first_layer, self.seed).ok()?;
        let base = granularity.base(emulsion.range(layer).0);
        let fraction = |step: usize| {
            let log10_exposure = SPAN[0] + step as f64 * STEP;
            let deviation = grain.deviation(emulsion.amount(layer, log10_exposure) - base, pitch_mm);
            // The exposure changes by the factor e where its log10 changes by log10(e).
            let fraction = deviation / (emulsion.gradient(layer, log10_exposure).abs() * LOG10_E);
            fraction.min(MOST)
        };
        let count = ((SPAN[1] - SPAN[0]) / STEP).round() as usize;
        Some(GrainNoise::new(SPAN[0] - log10(factor), STEP, (0..=count).map(fraction).collect()))
    }

    /// Adds grain to the amounts of a layer. `clear` is its least amount, at which there is no grain except fog.
    fn roughen(&self, layer: usize, plane: &mut [f32], clear: f64, raster: &Raster) -> Result<(), Fault> {
        let Some(granularity) = &self.granularity else { return Ok(()) };
        let base = granularity.base(clear) as f32;
        plane.iter_mut().for_each(|d| *d -= base);
        let grain = granularity.grain(layer, self.first_layer, self.seed);
        grain.map_err(|e| e.to_string())?.apply(plane, raster);
        plane.iter_mut().for_each(|d| *d += base);
        Ok(())
    }
}

/// Develops a film and returns one plane of amounts per layer (see [`crate::deposit::Deposit`]), in the order of the emulsion.
///
/// `light` has a plane of exposure per layer on the raster `gate`, the camera's frame. `factor` converts it to the exposure,
/// lx s, that takes effect; it includes the exposure time and reciprocity failure.
///
/// After scatter and halation, `lay` receives the index and plane of a layer, and places the plane on the raster `film`. That
/// raster is larger than the gate if the picture has a border. Last, `soil` adds dirt and damage to the amounts of a layer.
///
/// # Errors
/// A message: an effect cannot be computed at this size of pixels.
pub fn develop(
    emulsion: &Emulsion,
    effects: &Effects,
    light: &[&[f32]],
    factor: f64,
    [gate, film]: [&Raster; 2],
    mut lay: impl FnMut(usize, Vec<f32>) -> Vec<f32>,
    soil: impl Fn(usize, &mut [f32]),
) -> Result<Vec<Vec<f32>>, Fault> {
    let mut spare = Vec::new();
    let spread = light.iter().enumerate();
    let spread = spread.map(|(i, plane)| Ok(lay(i, effects.spread(i, plane, gate, &mut spare)?)));
    let mut planes = spread.collect::<Result<Vec<_>, Fault>>()?;
    drop(spare);
    emulsion.develop_all(&mut planes, factor);
    for (i, plane) in planes.iter_mut().enumerate() {
        effects.edges(i, plane, emulsion, film);
        effects.roughen(i, plane, emulsion.range(i).0, film)?;
        soil(i, plane);
    }
    Ok(planes)
}
