//! Haze without noise: light of lamps that haze on the lens scatters, spread as it lands.
//!
//! Model: each ray of a lamp is traced twice, once as haze scatters it and once as it goes without. The farther
//! apart the two land, the smoother the glow is there: what glass scatters falls off as a power of the angle. So the scattered light is spread
//! over a square whose half side is a fixed part of that distance ([`OF_WAY`]). For a glow that falls with the power n of the distance
//! that changes its light by about (n - 2)^2 / 6 times the square of that part: 1.5 % for n = 4. A later sample has smaller squares, so
//! both noise and blur go to nothing. No light is lost: the shares of a ray add up to it, and those beyond the frame are folded back.
//!
//! A ray that without haze is lost at a rim would have landed where a linear map says that holds for the others; how far the map is off them
//! is taken off its distance.
//!
//! Limits: the rings of dust and the streaks of scratches are not smooth; where either lies on the lens nothing is spread. The plate itself is traced from the imager and needs none of this.

use crate::error::RenderError;
use crate::footprint::Footprint;
use crate::pipeline::Pipeline;
use crate::spreader::Spreader;
use spectra_core::RayBatch;
use spectra_core::linear::least_squares;
use spectra_core::loss::ALIVE;
use spectra_lens::{Tracer, Travel};
use spectra_scene::GhostSpread;

/// Half the side of a footprint, as a part of how far the ray was moved.
const OF_WAY: f64 = 0.15;
/// Rays that have to land to say how others would.
const LEAST: usize = 128;
/// Samples after which the largest footprints begin to shrink.
const SAMPLES: f64 = 64.0;

/// What spreading scattered light needs, found once for a scene.
#[derive(Debug)]
pub(crate) struct Haze {
    pub spreader: Spreader,
    /// The lens as if nothing lay on it.
    clean: Tracer,
    /// Pixels, and mm, across and up.
    frame: [[f64; 2]; 2],
    /// Where rays land by where they are aimed at, roughly: for columns and rows. `None` where too few of them do to say so.
    map: Option<[Linear; 2]>,
}

/// A linear map of aimed rays, and how far it is off those it was fitted to: root mean square, pixels.
#[derive(Clone, Copy, Debug)]
struct Linear {
    terms: [f64; TERMS],
    off_px: f64,
}

/// 1, a place on the plane of the imager as if there were no lens, and slopes.
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

/// Where a ray lands without haze: columns to the left and rows down from the middle.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Landing {
    place: [f64; 2],
    /// How far that may be off, pixels; 0 where the ray was traced to it.
    off_px: f64,
}

impl Haze {
    /// Whether the light of rays is spread.
    pub fn suits(pipeline: &Pipeline) -> bool {
        let scene = &pipeline.scene;
        let is_asked_for = scene.render.reflections.spread == GhostSpread::Footprint;
        pipeline.scattered && is_asked_for && scene.lens.scatters_smoothly()
    }

    /// For a scene whose lens scatters, by some rays that are aimed at it; `None` where its light is not smooth, or the scene wants all
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

    /// Where on the frame a ray lands that left the lens: columns to the left and rows down from the middle.
    fn landed(&self, rays: &RayBatch, i: usize) -> [f64; 2] {
        let ([x, y, z], [l, m, n]) = (rays.positions(), rays.directions());
        let ([columns, rows], [width, height]) = (self.frame[0], self.frame[1]);
        let way = -z[i] / n[i];
        [(x[i] + way * l[i]) / width * columns, (y[i] + way * m[i]) / height * rows]
    }

    /// Where aimed rays land through a lens without haze.
    pub fn unscattered(&self, aimed: &RayBatch) -> Vec<Landing> {
        let mut rays = aimed.clone();
        self.clean.trace(&mut rays, &mut self.clean.work_in_place(aimed.len()), Travel::Forward);
        let landing = |i: usize| match (rays.states()[i] == ALIVE, &self.map) {
            (true, _) => Landing { place: self.landed(&rays, i), off_px: 0.0 },
            (false, Some(map)) => {
                let terms = terms(aimed, i);
                Landing { place: map.map(|axis| axis.at(&terms)), off_px: map[0].off_px.max(map[1].off_px) }
            }
            (false, None) => Landing { place: [0.0; 2], off_px: f64::INFINITY },
        };
        (0..aimed.len()).map(landing).collect()
    }

    /// How far scattering moved each ray that left the lens, pixels; 0 where that is not known.
    pub fn moved_px(&self, rays: &RayBatch, unscattered: &[Landing]) -> Vec<f64> {
        let moved = |(i, number): (usize, &u32)| {
            let ([x, y], Landing { place, off_px }) = (self.landed(rays, i), unscattered[*number as usize]);
            ((x - place[0]).abs().max((y - place[1]).abs()) - off_px).max(0.0)
        };
        rays.tags().iter().enumerate().map(moved).collect()
    }

    /// The footprint of a ray that was moved so far, in a sample of this number.
    #[inline]
    pub fn footprint(&self, moved_px: f64, sample: u64) -> Footprint {
        let smaller = (SAMPLES / (sample + 1) as f64).sqrt().sqrt().min(1.0);
        Footprint::new((OF_WAY * moved_px).min(self.spreader.most_half * smaller), [None; 2])
    }
}
