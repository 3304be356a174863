//! Draws places on the lights of a picture.
//!
//! What a pixel of the frame owes a light out of focus is as noisy as the rays are few that the light sent there. A small lamp that
//! is as far out of focus as a large one fills as large a disk with less light: drawn by power alone it would be grain beside a
//! smooth disk. So some of the rays go by power, some by area, and the most fall on all lights alike, whatever their size ([`PARTS`]):
//! none of the three is far from the best where lamps are sharp, far out of focus, or large and uneven. A lit window that touches a lamp
//! a thousand times as bright is a light of its own ([`MUCH_DIMMER`]): as a part of the lamp it would have no rays.
//!
//! As [`super::map::Importance`] does, it draws a pixel and a place under its tent: between a lamp of one pixel and its dark neighbors
//! the density falls as the light.

use super::spot::{Spot, tent};

/// The parts of the rays that go by power, by area, and on all lights alike.
const PARTS: [f64; 3] = [0.3, 0.3, 0.4];
/// Pixels as bright as this part of the brightest of their light count with all of their area.
const BRIGHT: f32 = 0.25;
/// Pixels dimmer than this part of the brightest of their light, and lights by themselves, are another light.
const MUCH_DIMMER: f32 = 1.0 / 64.0;
/// Pixels that such a light has at least to count as much as others: fewer may be the soft edge of a lamp.
const WINDOW: f64 = 32.0;

/// The pixels of lights, one light after the other, and how likely each is.
pub(crate) struct LightPlaces {
    size: [usize; 2],
    cells: Vec<u32>,
    /// Up to and with each pixel, times `total`.
    sums: Vec<f64>,
    /// For each of as many equal parts of [0, 1) the pixel that its lower end lies in.
    guide: Vec<u32>,
    /// Of all pixels of the picture, times `total`: 0 where none of the lights is.
    masses: Vec<f32>,
    total: f64,
}

impl LightPlaces {
    /// From the level of each pixel as a light ([`super::lights::Lights::level`]); pixels no brighter than `limit` are lights as neighbors
    /// of others alone.
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

    /// Column and row (pixels, fractional) and one over the density relative to uniform.
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
        let density = f64::from(Spot::of(place, self.size).mix(|cell| [self.masses[cell]])[0]);
        (place[0], place[1], self.total / (density * (width * height) as f64))
    }
}

/// Pixels and all that touch them, in groups that touch.
struct Groups {
    width: usize,
    height: usize,
    /// Whether a pixel is one of them.
    inside: Vec<bool>,
}

impl Groups {
    fn new(width: usize, height: usize) -> Self {
        Self { width, height, inside: vec![false; width * height] }
    }

    /// A pixel and all that touch it.
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

    /// Takes out the groups that some pixels, in rising order, belong to: each row by row, by the first pixel of each.
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

    fn places(brightness: &[f32]) -> (LightPlaces, Vec<f32>) {
        let found = super::super::lights::find(WIDTH, brightness).expect("lamps");
        (LightPlaces::new(WIDTH, &found.level, found.limit), found.level)
    }

    /// A lamp of one bright pixel and a dim one of sixteen, in a corner.
    fn lamps() -> Vec<f32> {
        let mut brightness: Vec<f32> = (0..WIDTH * 30).map(|i| 0.1 + 0.05 * (i % 7) as f32).collect();
        brightness[10 * WIDTH + 20] = 50.0;
        for cell in 0..16 {
            brightness[(26 + cell / 4) * WIDTH + 36 + cell % 4] = 20.0;
        }
        brightness
    }

    /// A window that touches a lamp a thousand times as bright is drawn about as often as one that stands alone.
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

    /// What is drawn, each place by one over its density, adds up to the lights' light, in all and of each lamp.
    #[test]
    fn draws_stand_for_all_light() {
        let brightness = lamps();
        let (places, level) = places(&brightness);
        let light = |column: f64, row: f64| {
            let spot = Spot::of([column, row], [WIDTH, 30]);
            let share = spot.mix(|cell| [f32::from(u8::from(level[cell] > 0.0))])[0];
            f64::from(share * spot.mix(|cell| [brightness[cell]])[0])
        };
        let n = 2000;
        // All of it, the part of the small lamp, and draws on it and on nothing.
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
        // The small lamp has a seventh of the light and a sixth of the area; it gets more.
        let part = drawn as f64 / (n * n) as f64;
        assert!(part > 0.25 && part < 0.45, "{part}");
        assert!((dark as f64) < 0.1 * (n * n) as f64, "{dark}");
    }

    /// What a ray from a lamp of one pixel carries does not depend on where in the lamp it starts, but for its dim neighbors. Drawn evenly over
    /// pixels, rays differed so much that their light was as noisy as that of less than half of them.
    #[test]
    fn rays_from_a_lamp_of_one_pixel_carry_alike() {
        let mut brightness = vec![0.01_f32; WIDTH * 30];
        brightness[10 * WIDTH + 20] = 50.0;
        let (places, level) = places(&brightness);
        let (mut first, mut second, n) = (0.0, 0.0, 64);
        for k in 0..n * n {
            let at = |k: usize| (k as f64 + 0.5) / n as f64;
            let (column, row, inverse) = places.draw(at(k % n), at(k / n));
            let spot = Spot::of([column, row], [WIDTH, 30]);
            let share = spot.mix(|cell| [f32::from(u8::from(level[cell] > 0.0))])[0];
            let carried = f64::from(share * spot.mix(|cell| [brightness[cell]])[0]) * inverse;
            (first, second) = (first + carried, second + carried * carried);
        }
        let times = second * (n * n) as f64 / (first * first);
        assert!(times < 1.05, "the variance of all over that of equal ones {times}");
    }
}
