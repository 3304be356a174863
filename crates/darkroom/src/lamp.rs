//! Pictures of surfaces on a developed film, in one light or another.

use crate::photograph::Setting;
use crate::pipeline::{FilmPipeline, GRAY};
use spectra_color::RgbSpace;
use spectra_core::params::{Fault, Faults};
use spectra_core::spectral::BAND;
use spectra_spectrum::{Emission, Reflectance};

/// A film whose development and whose print, scan or projection stay the same, whatever light its pictures are taken in.
pub struct FilmInLight(FilmPipeline);

impl FilmInLight {
    /// Builds the film that `settings` describe (`film.stock` and any other key of a scene's film). `made_for` names the light
    /// that the film is made for.
    ///
    /// # Errors
    /// Faults of the settings.
    pub fn new(settings: &[Setting], made_for: &Setting) -> Result<Self, Faults> {
        Ok(Self(FilmPipeline::of(settings, made_for)?))
    }

    /// Returns the color of each of `surfaces` in the picture taken in `light`: XYZ under D65, where Y of a screen's white is 1.
    /// Filters on the camera remove the color cast of the light. With them, a mid gray exposes each layer as in the light that
    /// the film is made for.
    ///
    /// Returns `None` if a layer does not respond to the light.
    ///
    /// # Errors
    /// A message: the film cannot be developed.
    pub fn pictures(&self, light: &Emission, surfaces: &[&Reflectance]) -> Result<Option<Vec<[f64; 3]>>, Fault> {
        let chain = &self.0;
        let white = chain.exposures(&light.to_power(&BAND));
        let filters: Vec<f64> = chain.metered.iter().zip(&white).map(|(gray, white)| gray / (GRAY * white)).collect();
        if filters.iter().any(|f| !(*f > 0.0 && f.is_finite())) {
            return Ok(None);
        }
        let exposed = |surface: &&Reflectance| -> Vec<f64> {
            let seen = chain.exposures(&(light * *surface).to_power(&BAND));
            seen.iter().zip(&filters).map(|(seen, filter)| seen * filter).collect()
        };
        let exposures: Vec<Vec<f64>> = surfaces.iter().map(exposed).collect();
        let shown = chain.unclamped_pictures(&exposures)?;
        Ok(Some(shown.into_iter().map(|rgb| RgbSpace::srgb().to_xyz(rgb)).collect()))
    }
}
