//! Loads the scenes of a comparison.

use spectra_core::params::Faults;
use spectra_scene::{NoiseLimit, Scene};
use std::path::Path;

/// Samples per pixel of a scene that states none.
const SAMPLES: u32 = 64;

/// Loads a scene. Comparisons need the same samples in every pixel, so a scene that leaves them to `render.noise: auto` gets [`SAMPLES`].
///
/// # Errors
/// All faults of the scene.
pub(crate) fn load(path: &Path, overrides: &[String]) -> Result<Scene, Faults> {
    let scene = spectra_scene::load(path, overrides)?;
    if scene.render.noise != Some(NoiseLimit::Auto) {
        return Ok(scene);
    }
    let fixed = ["render.noise=null".to_owned(), format!("render.samples={SAMPLES}")];
    spectra_scene::load(path, &[overrides, &fixed].concat())
}
