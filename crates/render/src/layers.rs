//! The exposure of a render so far: of all light, of one kind of light, or of one ghost path.
//!
//! Each estimator has sums of its own, so the light of a kind is the exposure of its estimators. What diffraction moves is the difference
//! that it makes to the sum. Of the strongest ghost paths, as many as an output asks for, the estimator adds the same integers once more,
//! to sums behind those of all paths. The sums of all paths do not change by that, and the light of the other paths is their exact
//! difference. Saved light holds all of these sums.

use crate::estimator::Estimator;
use crate::light::EstimatorSums;
use crate::parts::Part;
use crate::{Light, RenderError, Renderer};
use spectra_core::frame::ExposureChannel;
use spectra_scene::{GhostPaths, LightKind, LightLayer, Scene};
use std::ops::Range;

/// Selects some of an estimator's sums: one set of sums, less some others.
#[derive(Clone, Debug)]
struct SumSelection {
    from: usize,
    less: Range<usize>,
}

impl SumSelection {
    /// Selects the sums of `paths` in an estimator with separate sums for the paths `apart`; `None` if it does not have that path.
    fn of(paths: &GhostPaths, apart: &[Vec<usize>]) -> Option<Self> {
        match paths {
            GhostPaths::All => Some(Self { from: 0, less: 0..0 }),
            GhostPaths::One(surfaces) => {
                let at = apart.iter().position(|path| path == surfaces)?;
                Some(Self { from: 1 + at, less: 0..0 })
            }
            // The sums are integers, so the subtraction is exact.
            GhostPaths::Others => Some(Self { from: 0, less: 1..1 + apart.len() }),
        }
    }
}

impl Renderer {
    /// Ghost paths that have separate sums, strongest first.
    fn paths_apart(&self) -> &[Vec<usize>] {
        self.estimators().map(Estimator::paths).find(|paths| !paths.is_empty()).unwrap_or_default()
    }

    /// Computes the layers of light that the outputs of a scene hold, before diffraction. `weights` are those of the estimators.
    pub(crate) fn layers(
        &self,
        scene: &Scene,
        light: &Light,
        weights: &[Vec<f64>],
    ) -> Result<Vec<LightLayer>, RenderError> {
        let mut wanted: Vec<_> = scene.light_layers().into_iter().map(|kind| (kind, GhostPaths::All)).collect();
        if scene.ghost_paths() > 0 {
            let apart = self.paths_apart().iter().cloned().map(GhostPaths::One);
            wanted.extend(apart.chain([GhostPaths::Others]).map(|paths| (LightKind::Ghosts, paths)));
        }
        let layer = |(kind, paths): (LightKind, GhostPaths)| {
            let channels = self.planes(scene, light, weights, Some((kind, &paths)))?;
            Ok(LightLayer { kind, paths, channels })
        };
        wanted.into_iter().map(layer).collect()
    }

    /// Computes the exposure before diffraction, of all light or of one layer. `weights` are those of the estimators. The layer of direct
    /// light also holds what the meters see of all light.
    pub(crate) fn planes(
        &self,
        scene: &Scene,
        light: &Light,
        weights: &[Vec<f64>],
        layer: Option<(LightKind, &GhostPaths)>,
    ) -> Result<Vec<ExposureChannel>, RenderError> {
        let pixels = scene.imager.size().pixels();
        let recorded = self.recorded();
        let (channels, of_meters) = (recorded.len(), scene.meter_channels());
        let metered = light.metered.as_deref().unwrap_or_default();
        let time_s = scene.exposure_time_s();
        let own = self.parts().all.iter().zip(&light.parts).zip(weights.iter().cycle());
        let own = own.filter(|((part, _), _)| layer.is_none_or(|(kind, _)| kind == part.estimator.light()));
        let paths = layer.map_or(&GhostPaths::All, |(_, paths)| paths);
        let taken = |part: &Part| SumSelection::of(paths, part.estimator.paths());
        let parts: Vec<(&Part, &EstimatorSums, &Vec<f64>, SumSelection)> =
            own.filter_map(|((part, sums), w)| Some((part, sums, w, taken(part)?))).collect();
        let cells = self.cells();
        let sum = |part: &EstimatorSums, taken: &SumSelection, cell: usize| -> i64 {
            let all = part.sums.get(taken.from * cells + cell);
            taken.less.clone().fold(all, |left, of| left - part.sums.get(of * cells + cell))
        };
        let is_straight = layer.is_none_or(|(kind, _)| kind == LightKind::Direct);
        let mut planes = Vec::with_capacity(scene.channels.len());
        for (number, channel) in scene.channels.iter().enumerate() {
            let mut values = Vec::new();
            values.try_reserve_exact(pixels).map_err(|_| self.too_large())?;
            let seen = of_meters.iter().position(|meter| *meter == number).and_then(|at| metered.get(at));
            if let Some(at) = recorded.iter().position(|r| *r == number).filter(|_| !parts.is_empty()) {
                let of_pixel = |p: usize| {
                    let own = parts.iter().filter_map(|(part, sums, w, taken)| {
                        let place = self.parts().place(part, p)?;
                        Some(sum(sums, taken, place * channels + at) as f64 * w[p])
                    });
                    own.sum::<f64>() as f32
                };
                values.extend((0..pixels).map(of_pixel));
            } else if let Some(seen) = seen.filter(|_| is_straight) {
                values.extend(seen.iter().map(|value| (value * time_s) as f32));
            } else {
                // No light of this kind, or a meter that sees none of the source's light.
                values.resize(pixels, 0.0);
            }
            let named =
                |(kind, paths): (LightKind, &GhostPaths)| format!("{}.{}", LightLayer::name(kind, paths), channel.name);
            let name = layer.map_or_else(|| channel.name.clone(), named);
            planes.push(ExposureChannel { name, unit: channel.unit.clone(), values });
        }
        Ok(planes)
    }
}
