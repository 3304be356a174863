//! Spreads the light of lamps that haze on the lens scatters, as it lands, to remove its noise.
//!
//! Model: each ray of a lamp is traced twice, once with the scattering by haze and once without. The farther apart the two rays land, the
//! smoother the glow is there, because light scattered by glass falls off as a power of the angle. The scattered light is therefore spread
//! over a square whose half side is a fixed fraction of that distance ([`OF_WAY`]). If the glow falls with the power n of the distance,
//! this changes its light by about (n - 2)^2 / 6 times the square of that fraction: 1.5 % for n = 4. Later samples have smaller squares, so
//! both noise and blur tend to zero. No light is lost: the shares of a ray add up to its light, and shares beyond the frame are folded
//! back.
//!
//! A ray that is lost at a rim when traced without haze still needs a landing point. A linear map, fitted to the other rays, gives it. The
//! error of the map is subtracted from the distance.
//!
//! Limits: the rings of dust and the streaks of scratches are not smooth. If either lies on the lens, nothing is spread. The plate itself
//! is traced from the imager and needs none of this.

use crate::error::RenderError;
use crate::footprint::Footprint;
use crate::footprint_sums::Spreader;
use crate::pipeline::Pipeline;
use spectra_core::RayBatch;
use spectra_core::linear::least_squares;
use spectra_core::loss::ALIVE;
use spectra_scene::GhostSpread;
use spectra_tracer::{Tracer, Travel};
use std::sync::Arc;

/// Half side of a footprint, as a fraction of the distance by which scattering moved the ray.
const OF_WAY: f64 = 0.15;
/// Smallest number of landed rays that the map is fitted to.
const LEAST: usize = 128;
/// Number of samples after which the largest footprints begin to shrink.
const SAMPLES: f64 = 64.0;

/// The data for spreading scattered light, computed once per scene.
#[derive(Debug)]
pub(crate) struct Haze {
    pub spreader: Spreader,
    /// Tracer for the lens with nothing on its surfaces.
    clean: Arc<Tracer>,
    /// Size of the frame, across and up: first in pixels, then in mm.
    frame: [[f64; 2]; 2],
    /// Rough linear map from aimed rays to the column and row where they land; `None` if too few rays land to fit it.
    map: Option<[Linear; 2]>,
}

/// A linear map from aimed rays to one landing coordinate, and its root mean square error over the fitted rays, pixels.
#[derive(Clone, Copy, Debug)]
struct Linear {
    terms: [f64; TERMS],
    off_px: f64,
}

/// Number of terms: 1, the two coordinates where the ray would meet the plane of the imager without a lens, and its two slopes.
const TERMS: usize = 5;

fn terms(rays: &RayBatch, i: usize) -> [f64; TERMS] {
    let ([x, y, z], [l, m, n]) = (rays.positions(), rays.directions());
    let slopes = [l[i] / n[i], m[i] / n[i]];
    [1.0, x[i] - z[i] * slopes[0], y[i] - z[i] * slopes[1], slopes[0], slopes[1]]
}

impl Linear {
    fn fitted(rows: &[f64], landed: &[f64]) -> Option<Self> {
        let terms: [f64; TERMS] = least_squares(rows, landed, TERMS)?.try_into().ok()?;
        let map = Self { terms, off_px: 0.0 };
        let off = |(row, landed): (&[f64], &f64)| (map.at(row) - landed) * (map.at(row) - landed);
        let squares: f64 = rows.chunks_exact(TERMS).zip(landed).map(off).sum();
        Some(Self { off_px: (squares / landed.len() as f64).sqrt(), ..map })
    }

    fn at(&self, terms: &[f64]) -> f64 {
        self.terms.iter().zip(terms).map(|(own, term)| own * term).sum()
    }
}

/// The point where a ray lands without haze, in pixels from the middle of the frame: columns to the left, rows down.
#[derive(Clone, Copy, Debug)]
pub(crate) struct UnscatteredPoint {
    place: [f64; 2],
    /// Uncertainty of the point, pixels; 0 if the ray was traced to it.
    off_px: f64,
}

impl Haze {
    /// Whether the pipeline traces scattered light that is smooth, in a scene that asks for footprints.
    pub fn suits(pipeline: &Pipeline) -> bool {
        let scene = &pipeline.scene;
        let is_asked_for = scene.render.reflections.spread == GhostSpread::Footprint;
        pipeline.scattered && is_asked_for && scene.lens.scatters_smoothly()
    }

    /// Prepares the spreading for a scene, from some aimed rays. `None` if the scattered light is not smooth, or if the scene wants all
    /// light of a ray in the pixel that it meets.
    pub fn of(pipeline: &Pipeline, aimed: &RayBatch) -> Result<Option<Self>, RenderError> {
        if !Self::suits(pipeline) {
            return Ok(None);
        }
        let size = pipeline.scene.imager.size();
        let frame = [[f64::from(size.width_px), f64::from(size.height_px)], [size.width_mm, size.height_mm]];
        let clean = pipeline.clean_tracer()?;
        let mut own = Self { spreader: Spreader::of(pipeline), clean, frame, map: None };
        let unscattered = own.unscattered(aimed);
        let known: Vec<usize> = (0..aimed.len()).filter(|i| unscattered[*i].off_px == 0.0).collect();
        if known.len() >= LEAST {
            let rows: Vec<f64> = known.iter().flat_map(|i| terms(aimed, *i)).collect();
            let fitted = |axis: usize| {
                let landed: Vec<f64> = known.iter().map(|i| unscattered[*i].place[axis]).collect();
                Linear::fitted(&rows, &landed)
            };
            own.map = fitted(0).zip(fitted(1)).map(|(columns, rows)| [columns, rows]);
        }
        Ok(Some(own))
    }

    /// Returns the point where a ray that left the lens lands, in pixels from the middle of the frame: columns to the left, rows down.
    fn landed(&self, rays: &RayBatch, i: usize) -> [f64; 2] {
        let ([x, y, z], [l, m, n]) = (rays.positions(), rays.directions());
        let ([columns, rows], [width, height]) = (self.frame[0], self.frame[1]);
        let way = -z[i] / n[i];
        [(x[i] + way * l[i]) / width * columns, (y[i] + way * m[i]) / height * rows]
    }

    /// Computes where aimed rays land through a lens without haze.
    pub fn unscattered(&self, aimed: &RayBatch) -> Vec<UnscatteredPoint> {
        let mut rays = aimed.clone();
        self.clean.trace(&mut rays, &mut self.clean.work_in_place(aimed.len()), Travel::Forward);
        let landing = |i: usize| match (rays.states()[i] == ALIVE, &self.map) {
            (true, _) => UnscatteredPoint { place: self.landed(&rays, i), off_px: 0.0 },
            (false, Some(map)) => {
                let terms = terms(aimed, i);
                UnscatteredPoint { place: map.map(|axis| axis.at(&terms)), off_px: map[0].off_px.max(map[1].off_px) }
            }
            (false, None) => UnscatteredPoint { place: [0.0; 2], off_px: f64::INFINITY },
        };
        (0..aimed.len()).map(landing).collect()
    }

    /// Returns the distance by which scattering moved each ray that left the lens, pixels; 0 if it is not known.
    pub fn moved_px(&self, rays: &RayBatch, unscattered: &[UnscatteredPoint]) -> Vec<f64> {
        let moved = |(i, number): (usize, &u32)| {
            let ([x, y], UnscatteredPoint { place, off_px }) = (self.landed(rays, i), unscattered[*number as usize]);
            ((x - place[0]).abs().max((y - place[1]).abs()) - off_px).max(0.0)
        };
        rays.tags().iter().enumerate().map(moved).collect()
    }

    /// Returns the footprint of a ray that scattering moved by `moved_px`, in a sample of this number.
    #[inline]
    pub fn footprint(&self, moved_px: f64, sample: u64) -> Footprint {
        let smaller = (SAMPLES / (sample + 1) as f64).sqrt().sqrt().min(1.0);
        Footprint::new((OF_WAY * moved_px).min(self.spreader.most_half * smaller), [None; 2])
    }
}
