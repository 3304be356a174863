//! Surfaces on a developed film, in one light or another.

use crate::cube::Chain;
use crate::{SessionError, Setting};
use spectra_color::RgbSpace;
use spectra_core::spectral::BAND;
use spectra_spectrum::{Emission, Reflectance};

/// Part of the light that a mid gray reflects.
const GRAY: f64 = 0.18;

/// A film that is developed and printed, scanned or projected as it always is, whatever light its pictures are taken in.
pub struct FilmInLight(Chain);

impl FilmInLight {
    /// The film of these settings (`film.stock` and what else a scene's film may say); `made_for` names the light that it is made for.
    ///
    /// # Errors
    /// What is wrong with the settings.
    pub fn new(settings: &[Setting], made_for: &Setting) -> Result<Self, SessionError> {
        Ok(Self(Chain::of(settings, made_for)?))
    }

    /// What the picture shows of surfaces in `light`: XYZ under D65, 1 for the Y of a screen's white. Filters on the camera take the cast
    /// of the light away: a mid gray exposes each layer as it does in the light that the film is made for.
    ///
    /// `None` where a layer sees nothing of the light.
    ///
    /// # Errors
    /// The film cannot be developed.
    pub fn pictures(&self, light: &Emission, surfaces: &[&Reflectance]) -> Result<Option<Vec<[f64; 3]>>, SessionError> {
        let chain = &self.0;
        let white = chain.seen(&light.to_power(&BAND));
        let filters: Vec<f64> = chain.metered.iter().zip(&white).map(|(gray, white)| gray / (GRAY * white)).collect();
        if filters.iter().any(|f| !(*f > 0.0 && f.is_finite())) {
            return Ok(None);
        }
        let exposed = |surface: &&Reflectance| -> Vec<f64> {
            let seen = chain.seen(&(light * *surface).to_power(&BAND));
            seen.iter().zip(&filters).map(|(seen, filter)| seen * filter).collect()
        };
        let exposures: Vec<Vec<f64>> = surfaces.iter().map(exposed).collect();
        let shown = chain.open(&exposures)?;
        Ok(Some(shown.into_iter().map(|rgb| RgbSpace::srgb().to_xyz(rgb)).collect()))
    }
}
