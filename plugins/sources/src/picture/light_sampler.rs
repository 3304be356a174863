//! Draws points on the lights of a picture.
//!
//! The fewer rays a light sends to a pixel of the frame, the noisier its light there is. A small lamp that is as far out of focus as a
//! large one fills an equally large disk with less light. Drawn by power alone, it would be grainy beside a smooth disk. Therefore some
//! rays are drawn by power, some by area, and most equally on all lights, whatever their size ([`PARTS`]). This mixture is never far from
//! the best choice, whether lamps are sharp, far out of focus, or large and uneven. A lit window that touches a lamp a thousand times as
//! bright is a separate light ([`MUCH_DIMMER`]): as a part of the lamp it would get no rays.
//!
//! Like [`super::picture_texture::Importance`], this draws a pixel and a point under its tent: between a lamp of one pixel and its dark neighbors
//! the density falls like the light.

use super::pixel_quad::{PixelQuad, tent};

/// Fractions of the rays that are drawn by power, by area, and equally on all lights.
const PARTS: [f64; 3] = [0.3, 0.3, 0.4];
/// Pixels that are at least as bright as this fraction of the brightest one of their light count with their full area.
const BRIGHT: f32 = 0.25;
/// Pixels below this fraction of the brightest one of their light are a separate light, if they are bright enough to be lights at all.
const MUCH_DIMMER: f32 = 1.0 / 64.0;
/// Number of pixels from which such a separate light counts as much as others. A smaller one may be the soft edge of a lamp.
const WINDOW: f64 = 32.0;

/// The pixels of all lights, one light after the other, with their probabilities.
pub(crate) struct LightSampler {
    size: [usize; 2],
    cells: Vec<u32>,
    /// Cumulative probabilities up to and including each pixel, times `total`.
    sums: Vec<f64>,
    /// Guide table: [0, 1) is divided into as many equal parts as there are pixels of lights. Each entry is the pixel at the lower end of
    /// its part.
    guide: Vec<u32>,
    /// Probabilities of all pixels of the picture, times `total`; 0 for pixels that are not lights.
    masses: Vec<f32>,
    total: f64,
}

impl LightSampler {
    /// Creates the sampling from the level of each pixel as a light ([`super::lights::Lights::level`]). Pixels that are not brighter than
    /// `limit` are lights only as neighbors of others.
    pub(super) fn new(width: usize, level: &[f32], limit: f32) -> Self {
        let height = level.len() / width;
        let mut groups = Groups::new(width, height);
        for cell in (0..level.len()).filter(|cell| level[*cell] > 0.0) {
            groups.add(cell);
        }
        let (mut all, mut alike) = (Vec::new(), 0.0);
        let lights = groups.ordered(0..level.len());
        let mut left: Vec<(Vec<usize>, bool)> = lights.into_iter().rev().map(|group| (group, false)).collect();
        while let Some((group, is_dimmer)) = left.pop() {
            let peak = group.iter().fold(0.0_f32, |peak, cell| peak.max(level[*cell]));
            let is_apart = |cell: &usize| level[*cell] > limit && level[*cell] < MUCH_DIMMER * peak;
            let (dimmer, group): (Vec<usize>, Vec<usize>) = group.into_iter().partition(is_apart);
            dimmer.iter().for_each(|cell| groups.inside[*cell] = true);
            left.extend(groups.ordered(dimmer.into_iter()).into_iter().rev().map(|group| (group, true)));
            let weight = if is_dimmer { (group.len() as f64 / WINDOW).min(1.0) } else { 1.0 };
            alike += weight;
            let power: f64 = group.iter().map(|cell| f64::from(level[*cell])).sum();
            for &cell in group.iter().filter(|cell| level[**cell] > 0.0) {
                let own = f64::from(level[cell]);
                let part = f64::from((level[cell] / (BRIGHT * peak)).min(1.0));
                all.push((cell, own, part, weight * own / power));
            }
        }
        let (power, area) = all.iter().fold((0.0, 0.0), |(a, b), (_, power, part, _)| (a + power, b + part));
        let (mut sums, mut masses, mut total) = (Vec::with_capacity(all.len()), vec![0.0_f32; level.len()], 0.0);
        for (cell, own, part, of_all) in &all {
            let [by_power, by_area, on_all] = PARTS;
            let mass = by_power * own / power + by_area * part / area + on_all * of_all / alike;
            masses[*cell] = mass as f32;
            total += f64::from(masses[*cell]);
            sums.push(total);
        }
        let mut guide = Vec::with_capacity(sums.len());
        let mut at = 0;
        for part in 0..sums.len() {
            while at + 1 < sums.len() && sums[at] <= part as f64 / sums.len() as f64 * total {
                at += 1;
            }
            guide.push(at as u32);
        }
        let cells = all.iter().map(|(cell, ..)| *cell as u32).collect();
        Self { size: [width, height], cells, sums, guide, masses, total }
    }

    /// Draws a point. Returns its column and row (pixels, fractional), and the inverse of its density relative to a uniform one.
    #[inline]
    pub(crate) fn draw(&self, u: f64, v: f64) -> (f64, f64, f64) {
        let many = self.sums.len();
        let mut at = self.guide[((u * many as f64) as usize).min(many - 1)] as usize;
        let u = u * self.total;
        while at + 1 < many && self.sums[at] <= u {
            at += 1;
        }
        let from = if at > 0 { self.sums[at - 1] } else { 0.0 };
        let mass = self.sums[at] - from;
        let part = if mass > 0.0 { ((u - from) / mass).clamp(0.0, 1.0) } else { 0.5 };
        let [width, height] = self.size;
        let cell = self.cells[at] as usize;
        let place = [tent(cell % width, part, width), tent(cell / width, v, height)];
        let density = f64::from(PixelQuad::of(place, self.size).mix(|cell| [self.masses[cell]])[0]);
        (place[0], place[1], self.total / (density * (width * height) as f64))
    }
}

/// A set of pixels with all pixels that touch them, split into connected groups.
struct Groups {
    width: usize,
    height: usize,
    /// Whether a pixel belongs to the set.
    inside: Vec<bool>,
}

impl Groups {
    fn new(width: usize, height: usize) -> Self {
        Self { width, height, inside: vec![false; width * height] }
    }

    /// Returns a pixel and all pixels that touch it.
    fn around(&self, cell: usize) -> impl Iterator<Item = usize> + use<> {
        let (column, row, width) = (cell % self.width, cell / self.width, self.width);
        let columns = column.saturating_sub(1)..=(column + 1).min(width - 1);
        let rows = row.saturating_sub(1)..=(row + 1).min(self.height - 1);
        rows.flat_map(move |row| columns.clone().map(move |column| row * width + column))
    }

    fn add(&mut self, cell: usize) {
        for beside in self.around(cell) {
            self.inside[beside] = true;
        }
    }

    /// Removes and returns the groups that contain any of `pixels`, which are in ascending order. The groups are ordered by their
    /// first pixel, and the pixels of a group row by row.
    fn ordered(&mut self, pixels: impl Iterator<Item = usize>) -> Vec<Vec<usize>> {
        let mut groups = Vec::new();
        for first in pixels {
            if !std::mem::take(&mut self.inside[first]) {
                continue;
            }
            let (mut group, mut done) = (vec![first], 0);
            while done < group.len() {
                for beside in self.around(group[done]) {
                    if std::mem::take(&mut self.inside[beside]) {
                        group.push(beside);
                    }
                }
                done += 1;
            }
            group.sort_unstable();
            groups.push(group);
        }
        groups
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const WIDTH: usize = 40;

    fn places(brightness: &[f32]) -> (LightSampler, Vec<f32>) {
        let found = super::super::lights::find(WIDTH, brightness).expect("lamps");
        (LightSampler::new(WIDTH, &found.level, found.limit), found.level)
    }

    /// A picture with a lamp of one bright pixel, and a dimmer one of sixteen in a corner.
    fn lamps() -> Vec<f32> {
        let mut brightness: Vec<f32> = (0..WIDTH * 30).map(|i| 0.1 + 0.05 * (i % 7) as f32).collect();
        brightness[10 * WIDTH + 20] = 50.0;
        for cell in 0..16 {
            brightness[(26 + cell / 4) * WIDTH + 36 + cell % 4] = 20.0;
        }
        brightness
    }

    /// A window that touches a lamp a thousand times as bright is drawn about as often as a separate one.
    #[test]
    fn a_window_beside_a_lamp_is_drawn() {
        let drawn = |first: usize| {
            let mut brightness = vec![0.01_f32; WIDTH * 30];
            (0..4).for_each(|cell| brightness[(10 + cell / 2) * WIDTH + 20 + cell % 2] = 400.0);
            let window: Vec<usize> = (0..48).map(|cell| (12 + cell / 6) * WIDTH + first + cell % 6).collect();
            window.iter().for_each(|cell| brightness[*cell] = 0.4);
            let (places, _) = places(&brightness);
            let least = window.iter().map(|cell| places.masses[*cell]).fold(f32::INFINITY, f32::min);
            f64::from(least) / places.total
        };
        let (touching, alone) = (drawn(18), drawn(30));
        assert!(touching > 0.7 * alone && touching > 0.3 / 48.0, "{touching} {alone}");
    }

    /// Drawn points, each weighted by the inverse of its density, add up to the light of all lights and of each lamp.
    #[test]
    fn draws_stand_for_all_light() {
        let brightness = lamps();
        let (places, level) = places(&brightness);
        let light = |column: f64, row: f64| {
            let spot = PixelQuad::of([column, row], [WIDTH, 30]);
            let share = spot.mix(|cell| [f32::from(u8::from(level[cell] > 0.0))])[0];
            f64::from(share * spot.mix(|cell| [brightness[cell]])[0])
        };
        let n = 2000;
        // Sums by lamp and their expected values, draws on the small lamp, and draws without light.
        let (mut sums, mut wants, mut drawn, mut dark) = ([0.0; 2], [0.0; 2], 0, 0);
        for k in 0..n * n {
            let at = |k: usize| (k as f64 + 0.5) / n as f64;
            let (column, row, inverse) = places.draw(at(k % n), at(k / n));
            let one = light(column, row);
            sums[usize::from(row < 20.0)] += one * inverse / (n * n) as f64;
            drawn += usize::from(row < 20.0);
            dark += usize::from(one == 0.0);
            let (column, row) = (at(k % n) * WIDTH as f64, at(k / n) * 30.0);
            wants[usize::from(row < 20.0)] += light(column, row) / (n * n) as f64;
        }
        for (sum, want) in sums.iter().zip(wants) {
            assert!((sum / want - 1.0).abs() < 2e-3, "{sums:?} {wants:?}");
        }
        // The small lamp has a seventh of the light and a sixth of the area, but gets more rays.
        let part = drawn as f64 / (n * n) as f64;
        assert!(part > 0.25 && part < 0.45, "{part}");
        assert!((dark as f64) < 0.1 * (n * n) as f64, "{dark}");
    }

    /// The light of a ray from a lamp of one pixel does not depend on where on the lamp it starts, except for its dim neighbors. When
    /// points were drawn evenly over pixels, rays differed so much that the noise was that of fewer than half of them.
    #[test]
    fn rays_from_a_lamp_of_one_pixel_carry_alike() {
        let mut brightness = vec![0.01_f32; WIDTH * 30];
        brightness[10 * WIDTH + 20] = 50.0;
        let (places, level) = places(&brightness);
        let (mut first, mut second, n) = (0.0, 0.0, 64);
        for k in 0..n * n {
            let at = |k: usize| (k as f64 + 0.5) / n as f64;
            let (column, row, inverse) = places.draw(at(k % n), at(k / n));
            let spot = PixelQuad::of([column, row], [WIDTH, 30]);
            let share = spot.mix(|cell| [f32::from(u8::from(level[cell] > 0.0))])[0];
            let carried = f64::from(share * spot.mix(|cell| [brightness[cell]])[0]) * inverse;
            (first, second) = (first + carried, second + carried * carried);
        }
        let times = second * (n * n) as f64 / (first * first);
        assert!(times < 1.05, "the variance of all over that of equal ones {times}");
    }
}
