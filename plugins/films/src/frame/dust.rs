//! Dust on the film: specks and fibers, which block light.

use super::random_seed::RandomSeed;
use super::shape::{Capsule, cover};
use spectra_core::math::{cos, exp, log10, pow, sin};
use spectra_film::raster::Raster;
use std::f64::consts::TAU;

/// Side of the square cells for which dust is drawn, mm.
const CELL_MM: f64 = 2.0;
const MM2_PER_CM2: f64 = 100.0;
/// Median radius of a speck in mm, standard deviation of its natural logarithm, and largest radius in mm. Assumed: particles that
/// pass the filter of a clean room are smaller, and particles that hands leave are larger.
const SPECK: (f64, f64, f64) = (0.008, 0.7, 0.08);
/// Fraction of the dust particles that are fibers.
const FIBERS: f64 = 0.1;
/// Optical density of dust.
const OPAQUE: f64 = 2.0;

/// Adds dust to a plane of amounts. `per_cm2` is the mean number of particles per square centimeter, and `most` is the largest amount that
/// the layer can have.
pub(super) fn apply(chance: RandomSeed, per_cm2: f64, plane: &mut [f32], raster: &Raster, most: f64) {
    let mean = per_cm2 * CELL_MM * CELL_MM / MM2_PER_CM2;
    let cells = |axis: usize, count: usize| {
        let cell = |px: i64| (px as f64 * raster.pitch_mm / CELL_MM).floor() as i64;
        // One more cell on each side, since fibers reach into the next one.
        cell(raster.offset_px[axis]) - 1..=cell(raster.offset_px[axis] + count as i64) + 1
    };
    for y in cells(1, raster.height) {
        for x in cells(0, raster.width) {
            let cell = chance.with(x as u64).with(y as u64);
            for speck in 0..poisson(cell, mean) {
                let own = cell.with(1 + speck);
                let at =
                    [x, y].into_iter().zip(0..).map(|(c, k)| (c as f64 + own.uniform(k)) * CELL_MM).collect::<Vec<_>>();
                let capsules = grain(own.with(7), [at[0], at[1]]);
                let opacity = own.between(3, 0.4, 1.0);
                cover(&capsules, raster, |pixel, share| {
                    let held = share * opacity;
                    let passes = |amount: f64| pow(10.0, -amount);
                    let amount = f64::from(plane[pixel]);
                    let light = (1.0 - held) * passes(amount) + held * passes((amount + OPAQUE).min(most.max(amount)));
                    plane[pixel] = -log10(light) as f32;
                });
            }
        }
    }
}

/// Draws a number with a Poisson distribution of the given mean, by Knuth's product of uniform numbers, which is fast for small means.
fn poisson(chance: RandomSeed, mean: f64) -> u64 {
    let least = exp(-mean);
    let mut product = 1.0;
    (0..)
        .find(|k| {
            product *= chance.with(0).uniform(*k);
            product < least
        })
        .unwrap_or(0)
}

/// Draws a speck or a fiber at a place, mm.
fn grain(chance: RandomSeed, at: [f64; 2]) -> Vec<Capsule> {
    if chance.uniform(0) < FIBERS {
        return fiber(chance, at);
    }
    let (median, spread, largest) = SPECK;
    let radius = (median * exp(spread * chance.normal(40))).clamp(0.25 * median, largest);
    // Four overlapping disks make an irregular shape that differs from speck to speck.
    let disk = |k: u64| {
        let place = |axis: usize| at[axis] + radius * chance.between(10 + 3 * k + axis as u64, -0.7, 0.7);
        let center = [place(0), place(1)];
        Capsule { from: center, to: center, radius: radius * chance.between(12 + 3 * k, 0.4, 0.9) }
    };
    (0..4).map(disk).collect()
}

/// Draws a fiber: a chain of short pieces, each turned a little from the one before.
fn fiber(chance: RandomSeed, at: [f64; 2]) -> Vec<Capsule> {
    const PIECES: u64 = 14;
    let (radius, step) = (chance.between(1, 0.003, 0.007), chance.between(2, 0.2, 1.4) / PIECES as f64);
    let (mut place, mut turn) = (at, chance.between(3, 0.0, TAU));
    let mut bend = chance.between(4, -0.25, 0.25);
    (0..PIECES)
        .map(|k| {
            bend += 0.12 * chance.normal(20 + k);
            turn += bend;
            let next = [place[0] + step * cos(turn), place[1] + step * sin(turn)];
            let piece = Capsule { from: place, to: next, radius };
            place = next;
            piece
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The number of particles is as stated. Dust is the same on pixels of half the size, and on a part of the film.
    #[test]
    fn dust_lies_on_the_film_and_not_on_pixels() {
        let counts: u64 = (0..20_000).map(|k| poisson(RandomSeed::new(k, "count"), 0.7)).sum();
        assert!((counts as f64 / 14_000.0 - 1.0).abs() < 0.03, "{counts}");
        let chance = RandomSeed::new(5, "dust");
        let film = |pixels: usize, offset: i64, size: usize| {
            let raster = Raster { offset_px: [offset; 2], ..Raster::new(size, size, 10.0 / pixels as f64) };
            let mut plane = vec![0.5_f32; size * size];
            apply(chance, 60.0, &mut plane, &raster, 2.5);
            plane
        };
        let held =
            |plane: &[f32]| plane.iter().map(|d| pow(10.0, 0.5 - f64::from(*d))).sum::<f64>() / plane.len() as f64;
        let (coarse, fine) = (film(200, 0, 200), film(400, 0, 400));
        assert!(
            held(&coarse) < 0.9999 && (held(&coarse) - held(&fine)).abs() < 0.03 * (1.0 - held(&fine)),
            "{}",
            held(&fine)
        );
        // There are 0.6 particles per mm^2. A speck is four disks of about 0.65 of a radius whose mean square is 1.7e-4 mm^2; a third of
        // their area overlaps. A fiber is 0.8 mm long and 0.01 mm wide. Both block 0.7 of the light.
        let want = 0.6 * 0.7 * (0.9 * 6.6e-4 + 0.1 * 8e-3);
        let ratio = (1.0 - held(&fine)) / want;
        assert!((0.4..2.5).contains(&ratio), "{ratio}");
        let part = film(400, 100, 200);
        for y in 0..200 {
            assert_eq!(part[y * 200..(y + 1) * 200], fine[(y + 100) * 400 + 100..(y + 100) * 400 + 300], "{y}");
        }
    }
}
