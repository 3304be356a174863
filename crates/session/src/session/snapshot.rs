//! Changes of a session: which results remain valid, and the way back to an earlier state.

use super::Session;
use spectra_scene::{Scene, Series};
use std::sync::Arc;

/// The results that remain valid after a change of the scene.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ValidResults {
    /// Whether the light is kept, so that nothing is traced again.
    pub light: bool,
    /// Whether the wavelength density is kept.
    pub density: bool,
    /// Whether the focused lens is kept.
    pub lens: bool,
    /// Whether the source is kept, with its files.
    pub source: bool,
}

/// A saved state of a session: its values, its picture of the series and its stages, without the light.
#[derive(Clone)]
pub struct Snapshot {
    series: Series,
    index: usize,
    scene: Arc<Scene>,
}

impl Snapshot {
    /// The pictures that the scene stands for in this state.
    #[must_use]
    pub fn series(&self) -> &Series {
        &self.series
    }

    /// Index of the picture in the series, from 0.
    #[must_use]
    pub fn index(&self) -> usize {
        self.index
    }
}

impl Session {
    /// Returns the current state, for [`Session::restore`].
    #[must_use]
    pub fn snapshot(&self) -> Snapshot {
        Snapshot { series: self.series.clone(), index: self.options.picture, scene: Arc::clone(&self.scene) }
    }

    /// Returns to an earlier state, and keeps the light if it is still valid. This cannot fail, because the state was valid
    /// before.
    pub fn restore(&mut self, moment: &Snapshot) -> ValidResults {
        let Snapshot { series, index, scene } = moment.clone();
        let kept = self.valid_results(&scene);
        if !kept.light {
            let known = self.ready.take().map(|(renderer, _)| Arc::clone(renderer.density())).or(self.density.take());
            self.density = known.filter(|_| kept.density);
        }
        (self.series, self.options.picture, self.scene) = (series, index, scene);
        kept
    }

    /// Returns which results for the current scene remain valid for another one.
    pub(super) fn valid_results(&self, scene: &Scene) -> ValidResults {
        let before = &*self.scene;
        let responses = |scene: &Scene, which: Vec<usize>| -> Vec<Vec<f64>> {
            which.iter().filter_map(|at| scene.channels.get(*at)).map(|c| c.response.clone()).collect()
        };
        let same_channels = responses(before, before.picture_channels()) == responses(scene, scene.picture_channels());
        let same_meters = responses(before, before.meter_channels()) == responses(scene, scene.meter_channels())
            && before.metered_pixels() == scene.metered_pixels();
        let source = Arc::ptr_eq(&before.source, &scene.source);
        let lens = Arc::ptr_eq(&before.lens, &scene.lens);
        // A source that fills the frame is rebuilt for every lens, but the spectrum of its light stays the same.
        let system = before.source.spectrum() == scene.source.spectrum()
            && same_channels
            && before.grid == scene.grid
            && Arc::ptr_eq(&before.sampler, &scene.sampler);
        let same_light = system
            && source
            && same_meters
            && lens
            && before.imager.size() == scene.imager.size()
            && Arc::ptr_eq(&before.imager, &scene.imager)
            && before.ghost_paths() == scene.ghost_paths()
            && before.render.traces_as(&scene.render);
        ValidResults { light: same_light, density: system, lens, source }
    }
}
