//! Corrects the diffraction pattern for the combined effect of a wavefront's aberrations and the edge of the opening.
//!
//! A traced picture already has the aberrations of the rays. Spreading it by the pattern of a perfect lens gives the product of two
//! contrasts, that of the rays and that of the edge. The light really has the contrast of the wavefront, which is higher. The difference is
//! largest if aberrations are of the order of a wavelength. The pattern is corrected by this difference, which sums to zero.
//!
//! At each frequency of a lattice, the wanted contrast is (wave rays + e^2 edge) / (rays^2 + e^2), with the contrasts of wavefront, rays
//! and edge, and e = 0.1. Contrast that the rays lost altogether therefore stays lost. Phases stay those of the rays.

use crate::{ChannelLight, Polygon, Wavefront};
use spectra_core::math;
use std::f64::consts::TAU;

/// Smallest and largest reach of the correction, pixels.
const REACH: [usize; 2] = [6, 40];
/// Reach of the correction beyond the rays, in wavelengths times f-number.
const FRINGES: f64 = 24.0;
/// Smallest and largest number of cells across the opening.
const CELLS: [f64; 2] = [48.0, 256.0];
/// Contrast of rays below which the pattern of the perfect lens is kept, because contrast that the rays lost cannot be restored.
const LEAST: f64 = 0.1;
/// Contrast below which a correction is negligible.
const SEEN: f64 = 2e-3;

/// The weights by which the pixels around one are corrected, `2 reach + 1` per line.
pub(crate) struct Correction {
    pub(crate) reach: usize,
    pub(crate) weights: Vec<f64>,
}

/// Computes the correction to the pattern of a perfect lens with this opening. Rays with the aberrations of `wave`, spread by the corrected
/// pattern, have the contrast of the wavefront. The weights sum to 0. Opposite pixels get the same weight, so phases stay those of the
/// rays. `None` if the correction is negligible, or if aberrations are so large that rays alone describe the light.
pub(crate) fn correction(
    opening: &Polygon,
    wave: &Wavefront,
    light: &ChannelLight,
    pitch_mm: [f64; 2],
) -> Option<Correction> {
    let mean = light.mean_mm();
    let across = 2.0 * opening.reach();
    let pitch = pitch_mm[0].min(pitch_mm[1]);
    let farthest = spots(opening, wave);
    let extent = 3.0 * farthest + FRINGES * mean / across;
    let reach = ((extent / pitch).ceil() as usize).clamp(REACH[0], REACH[1]);
    let side = 2 * reach + 1;
    // Rays that land beyond half of the lattice turn phases faster than it can resolve.
    if farthest > 0.5 * side as f64 * pitch {
        return None;
    }
    let half = (reach + 1) * side;
    let (mut edge, mut waves, mut rays) = (vec![0.0; half], vec![0.0; half], vec![0.0; half]);
    for (number, [mm, share]) in light.coarse().iter().enumerate() {
        let cells = Cells::new(opening, wave, *mm, side, pitch_mm)?;
        for row in 0..reach + 1 {
            for column in 0..side {
                let [passed, amplitude] = cells.overlap([column as isize - reach as isize, row as isize]);
                edge[row * side + column] += share * passed;
                waves[row * side + column] += share * amplitude;
            }
        }
        if number == 0 {
            rays = cells.rays(reach, pitch_mm);
        }
    }
    let missing = |k: usize| {
        let wanted = (waves[k] * rays[k] + LEAST * LEAST * edge[k]) / (rays[k] * rays[k] + LEAST * LEAST);
        wanted - edge[k]
    };
    let missing: Vec<f64> = (0..half).map(missing).collect();
    if missing.iter().all(|m| m.abs() < SEEN) {
        return None;
    }
    Some(Correction { reach, weights: pixels(&missing, reach) })
}

/// Returns the largest distance of the rays' landing points from their mean, mm.
fn spots(opening: &Polygon, wave: &Wavefront) -> f64 {
    let [cx, cy] = opening.center();
    let places =
        opening.rings().iter().flatten().flat_map(|[x, y]| [0.33, 0.67, 1.0].map(|t| [cx + t * x, cy + t * y]));
    let slopes: Vec<[f64; 2]> = std::iter::once([cx, cy]).chain(places).map(|p| wave.at(p).1).collect();
    let mean = [0, 1].map(|k| slopes.iter().map(|s| s[k]).sum::<f64>() / slopes.len() as f64);
    slopes.iter().map(|s| (s[0] - mean[0]).abs().max((s[1] - mean[1]).abs())).fold(0.0, f64::max)
}

/// Transforms the missing contrast by frequency (rows from 0 on, columns about 0, in cycles per side) to pixel weights, which fade out
/// toward the edge.
fn pixels(missing: &[f64], reach: usize) -> Vec<f64> {
    let side = 2 * reach + 1;
    let turn: Vec<[f64; 2]> = (0..side)
        .map(|k| {
            let angle = TAU * k as f64 / side as f64;
            [math::cos(angle), math::sin(angle)]
        })
        .collect();
    let phase = |a: isize, b: isize| turn[(a * b).rem_euclid(side as isize) as usize];
    let r = reach as isize;
    let mut weights = vec![0.0; side * side];
    for i in -r..r + 1 {
        // Transform along the rows first.
        let lines: Vec<[f64; 2]> = (0..reach + 1)
            .map(|row| {
                let line = &missing[row * side..][..side];
                line.iter().zip(-r..).fold([0.0; 2], |[re, im], (m, a)| {
                    let [c, s] = phase(a, i);
                    [re + m * c, im + m * s]
                })
            })
            .collect();
        for j in -r..r + 1 {
            let sum: f64 = lines.iter().zip(0..).fold(0.0, |sum, ([re, im], b)| {
                let [c, s] = phase(b, j);
                // Each row except the first also stands for the opposite one.
                sum + if b == 0 { *re } else { 2.0 * (re * c - im * s) }
            });
            let fade = |k: isize| {
                let t = (k.unsigned_abs() as f64 / (reach + 1) as f64 - 0.6).max(0.0) / 0.4;
                1.0 - t * t * (3.0 - 2.0 * t)
            };
            weights[((j + r) * side as isize + i + r) as usize] = sum * fade(i) * fade(j) / (side * side) as f64;
        }
    }
    let all: f64 = weights.iter().sum();
    weights[side * side / 2] -= all;
    weights
}

/// The opening divided into cells, of which a whole number makes one step of the frequency lattice.
struct Cells {
    size: [usize; 2],
    /// Number of cells per step, across and down.
    steps: [usize; 2],
    /// Complex amplitude of the light in each cell; 0 outside the opening.
    amplitudes: Vec<[f64; 2]>,
    /// Landing points of the rays, mm.
    spots: Vec<[f64; 2]>,
}

impl Cells {
    fn new(opening: &Polygon, wave: &Wavefront, mm: f64, side: usize, pitch_mm: [f64; 2]) -> Option<Self> {
        let step = pitch_mm.map(|pitch| mm / (side as f64 * pitch));
        let [low, high] = opening.bounds();
        let mut steps = [1; 2];
        let (mut size, mut cell) = ([0; 2], [0.0; 2]);
        for k in 0..2 {
            let across = high[k] - low[k];
            steps[k] = ((CELLS[0] * step[k] / across).ceil() as usize).max(1);
            cell[k] = step[k] / steps[k] as f64;
            let cells = across / cell[k];
            if cells.is_nan() || cells > CELLS[1] {
                return None;
            }
            size[k] = cells.ceil() as usize;
        }
        let mut amplitudes = vec![[0.0; 2]; size[0] * size[1]];
        let mut spots = Vec::new();
        for j in 0..size[1] {
            let y = low[1] + (j as f64 + 0.5) * cell[1];
            for [from, to] in opening.spans(y) {
                let column = |x: f64| ((x - low[0]) / cell[0] - 0.5).ceil().clamp(0.0, size[0] as f64) as usize;
                for i in column(from)..column(to) {
                    let (path, slope) = wave.at([low[0] + (i as f64 + 0.5) * cell[0], y]);
                    let turns = path / mm;
                    let (sin, cos) = math::sin_cos_turns(turns - turns.floor());
                    amplitudes[j * size[0] + i] = [cos, sin];
                    spots.push(slope);
                }
            }
        }
        (!spots.is_empty()).then_some(Self { size, steps, amplitudes, spots })
    }

    /// Computes the overlap of the opening with itself, shifted by this many steps: its area, and the modulus of the product of its
    /// amplitudes, both relative to the whole opening.
    fn overlap(&self, [across, down]: [isize; 2]) -> [f64; 2] {
        let [width, height] = self.size;
        let shift = across * self.steps[0] as isize;
        let (skip, back) = (shift.max(0) as usize, (-shift).max(0) as usize);
        let rows = down as usize * self.steps[1];
        if skip.max(back) >= width || rows >= height {
            return [0.0; 2];
        }
        let len = width - skip - back;
        let (mut passed, mut re, mut im) = (0.0, 0.0, 0.0);
        for row in 0..height - rows {
            let here = &self.amplitudes[row * width + back..][..len];
            let there = &self.amplitudes[(row + rows) * width + skip..][..len];
            for ([a, b], [c, d]) in here.iter().zip(there) {
                re += a * c + b * d;
                im += a * d - b * c;
                passed += (a * a + b * b) * (c * c + d * d);
            }
        }
        let all = self.spots.len() as f64;
        [passed / all, (re * re + im * im).sqrt() / all]
    }

    /// Computes the contrast of the rays on the frequency lattice.
    fn rays(&self, reach: usize, pitch_mm: [f64; 2]) -> Vec<f64> {
        let side = 2 * reach + 1;
        let mut sums = vec![[0.0; 2]; (reach + 1) * side];
        let times = |[a, b]: [f64; 2], [c, d]: [f64; 2]| [a * c - b * d, a * d + b * c];
        let mut line = vec![[0.0; 2]; side];
        for spot in &self.spots {
            let [x, y] = [0, 1].map(|k| {
                let turns = spot[k] / (side as f64 * pitch_mm[k]);
                let (sin, cos) = math::sin_cos_turns(turns - turns.floor());
                [cos, sin]
            });
            line[reach] = [1.0, 0.0];
            for k in 1..reach + 1 {
                let on = times(line[reach + k - 1], x);
                line[reach + k] = on;
                line[reach - k] = [on[0], -on[1]];
            }
            for row in sums.chunks_exact_mut(side) {
                for (sum, phase) in row.iter_mut().zip(&mut line) {
                    *sum = [sum[0] + phase[0], sum[1] + phase[1]];
                    *phase = times(*phase, y);
                }
            }
        }
        let all = self.spots.len() as f64;
        sums.iter().map(|[re, im]| (re * re + im * im).sqrt() / all).collect()
    }
}
