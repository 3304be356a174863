//! Scratches along the film, which last for some frames.

use super::random_seed::RandomSeed;
use rayon::prelude::*;
use spectra_core::math::{cos, sin};
use spectra_film::raster::Raster;
use std::f64::consts::TAU;

/// One scratch on one frame.
#[derive(Clone, Copy, Debug)]
pub(super) struct Scratch {
    chance: RandomSeed,
    /// Position across the film, mm.
    place: f64,
    width: f64,
    /// Density that the scratch adds where it is deepest.
    depth: f64,
    /// Length of film before this frame, in mm. It lets variation along a scratch continue from frame to frame.
    way: f64,
}

/// Possible scratches per scratch of the mean number.
const SLOTS: f64 = 3.0;
/// Least and largest number of frames for which a scratch lasts.
const FRAMES: (f64, f64) = (12.0, 240.0);
/// Smallest and largest width of a scratch, in mm. `DEPTH` holds the smallest and largest density.
const WIDTH_MM: (f64, f64) = (0.004, 0.02);
const DEPTH: (f64, f64) = (0.15, 0.7);

/// Draws the scratches of a frame. `mean` is their mean number, `extent_mm` the left, top, right and bottom edges of the film, and
/// `vertical` says whether the film runs down.
pub(super) fn of(chance: RandomSeed, frame: u64, mean: f64, extent_mm: [f64; 4], vertical: bool) -> Vec<Scratch> {
    let slots = (SLOTS * mean).ceil().max(1.0);
    let [left, top, right, bottom] = extent_mm;
    let ((low, high), length) = if vertical { ((left, right), bottom - top) } else { ((top, bottom), right - left) };
    let one = |slot: u64| {
        let own = chance.with(slot);
        let period = own.between(0, FRAMES.0, FRAMES.1);
        let since = frame as f64 / period + own.uniform(1);
        let epoch = own.with(2 + since.floor() as u64);
        if epoch.uniform(0) >= mean / slots {
            return None;
        }
        let wander = 0.05 * sin(TAU * (0.7 * since + epoch.uniform(1)));
        Some(Scratch {
            chance: epoch,
            place: epoch.between(2, low, high) + wander,
            width: epoch.between(3, WIDTH_MM.0, WIDTH_MM.1),
            depth: epoch.between(4, DEPTH.0, DEPTH.1),
            way: frame as f64 * length,
        })
    };
    (0..slots as u64).filter_map(one).collect()
}

/// Applies scratches to a plane of amounts. `away` is 1 if they add density and -1 if they remove emulsion; amounts do not fall below
/// `least`.
pub(super) fn apply(all: &[Scratch], plane: &mut [f32], raster: &Raster, vertical: bool, away: f64, least: f64) {
    let pitch = raster.pitch_mm;
    let (along, across) = if vertical { (1, 0) } else { (0, 1) };
    plane.par_chunks_mut(raster.width.max(1)).enumerate().for_each(|(row, values)| {
        for scratch in all {
            let place = |px: usize, axis: usize| (px as f64 + 0.5 + raster.offset_px[axis] as f64) * pitch;
            let mut add = |column: usize| {
                let px = [column, row];
                let (at, line) = (place(px[across], across), place(px[along], along));
                let share = scratch.share(at - 0.5 * pitch, at + 0.5 * pitch, line) * scratch.depth * away;
                if share != 0.0 {
                    let amount = f64::from(values[column]);
                    values[column] = (amount + share).max(least.min(amount)) as f32;
                }
            };
            if vertical {
                let first = ((scratch.place - 0.2) / pitch - raster.offset_px[0] as f64).floor().max(0.0) as usize;
                let last = ((scratch.place + 0.2) / pitch - raster.offset_px[0] as f64).ceil().max(0.0) as usize;
                (first..=last).filter(|column| *column < raster.width).for_each(&mut add);
            } else {
                let near = (place(row, 1) - scratch.place).abs() < 0.2 + pitch;
                (0..raster.width).filter(|_| near).for_each(&mut add);
            }
        }
    });
}

impl Scratch {
    /// Returns the fraction of a pixel that the scratch covers, times its pressure there. The pixel lies from `low` to `high` across the
    /// film and at `along` along it, all in mm.
    fn share(&self, low: f64, high: f64, along: f64) -> f64 {
        let way = self.way + along;
        // The scratch wavers like a trembling hand, with a few wavelengths.
        let wave = |k: u64, mm: f64| cos(TAU * (way / mm + self.chance.uniform(10 + k)));
        let place = self.place + 0.006 * wave(0, 31.0) + 0.002 * wave(1, 4.3);
        let pressed = (0.75 + 0.6 * wave(2, 53.0) + 0.5 * wave(3, 7.7)).clamp(0.0, 1.0);
        let (left, right) = (place - 0.5 * self.width, place + 0.5 * self.width);
        (high.min(right) - low.max(left)).max(0.0) / (high - low) * pressed
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Over many frames the mean number of scratches is as stated. Most scratches of a frame are still there on the next, and they look
    /// alike on pixels of other sizes.
    #[test]
    fn scratches_stay_and_scale() {
        let chance = RandomSeed::new(9, "scratches");
        let frame = |k: u64| of(chance, k, 3.0, [0.0, 0.0, 22.0, 16.0], true);
        let mean = (0..4000).map(|k| frame(k).len()).sum::<usize>() as f64 / 4000.0;
        assert!((mean / 3.0 - 1.0).abs() < 0.25, "{mean}");
        let kept = (0..400).filter(|k| frame(*k).len() == frame(k + 1).len()).count();
        assert!(kept > 300, "{kept}");
        let all = (0..).map(frame).find(|all| !all.is_empty()).expect("one");
        let mean = |pixels: usize| {
            let raster = Raster::new(pixels, pixels * 16 / 22, 22.0 / pixels as f64);
            let mut plane = vec![1.0_f32; raster.pixels()];
            apply(&all, &mut plane, &raster, true, 1.0, 0.0);
            plane.iter().map(|d| f64::from(*d) - 1.0).sum::<f64>() / plane.len() as f64
        };
        let (coarse, fine) = (mean(220), mean(880));
        assert!(fine > 0.0 && (coarse / fine - 1.0).abs() < 0.05, "{coarse} {fine}");
    }
}
