//! Draws places on the lights of a picture.
//!
//! What a pixel of the frame owes a light out of focus is as noisy as the rays are few that the light sent there. A small lamp that
//! is as far out of focus as a large one fills as large a disk with less light: drawn by power alone it would be grain beside a
//! smooth disk. So a third of the rays goes by power, a third by area, and a third falls on all lights alike, whatever their size:
//! none of the three is far from the best where lamps are sharp, far out of focus, or large and uneven.

use super::spot::Spot;

/// Places a side of a cell that its light is summed over.
const PLACES: usize = 4;

/// The cells that have light of lights, one light after the other, and how likely each is.
pub(crate) struct LightPlaces {
    width: usize,
    cells: Vec<u32>,
    /// Up to and with each cell; the last is 1.
    sums: Vec<f64>,
    /// For each of as many equal parts of [0, 1) the cell that its lower end lies in.
    guide: Vec<u32>,
    /// Of the picture.
    pixels: f64,
}

impl LightPlaces {
    /// From the brightness of each pixel, and its level as a light ([`super::lights::Lights::level`]).
    pub(super) fn new(width: usize, brightness: &[f32], level: &[f32]) -> Self {
        let height = level.len() / width;
        // A light that is black counts as if it had its level: its neighborhood may have light.
        let bright = |cell: usize| if level[cell] > 0.0 { level[cell] } else { brightness[cell].max(0.0) };
        let mut groups = Groups::new(width, height);
        for cell in (0..level.len()).filter(|cell| level[*cell] > 0.0) {
            groups.add(cell);
        }
        let mut all = Vec::new();
        let groups = groups.ordered();
        for (number, group) in groups.iter().enumerate() {
            for &cell in group {
                let (mut power, mut part) = (0.0, 0.0);
                for at in 0..PLACES * PLACES {
                    let offset = |k: usize| (k as f64 + 0.5) / PLACES as f64;
                    let (column, row) = ((cell % width) as f64, (cell / width) as f64);
                    let place = [column + offset(at % PLACES), row + offset(at / PLACES)];
                    let spot = Spot::of(place, [width, height]);
                    let share = f64::from(spot.mix(|cell| [f32::from(u8::from(level[cell] > 0.0))])[0]);
                    power += share * f64::from(spot.mix(|cell| [bright(cell)])[0]);
                    part += share;
                }
                all.push((cell, number, power, part));
            }
        }
        let mut of_group = vec![0.0; groups.len()];
        all.iter().for_each(|(_, number, power, _)| of_group[*number] += power);
        let (power, area) = all.iter().fold((0.0, 0.0), |(a, b), (_, _, power, part)| (a + power, b + part));
        let mut sum = 0.0;
        let mut sums: Vec<f64> = Vec::with_capacity(all.len());
        for (_, number, own, part) in &all {
            let alike = own / of_group[*number] / groups.len() as f64;
            sum += (own / power + part / area + alike) / 3.0;
            sums.push(sum);
        }
        sums.iter_mut().for_each(|s| *s /= sum);
        if let Some(last) = sums.last_mut() {
            *last = 1.0;
        }
        let mut guide = Vec::with_capacity(sums.len());
        let mut at = 0;
        for part in 0..sums.len() {
            while at + 1 < sums.len() && sums[at] <= part as f64 / sums.len() as f64 {
                at += 1;
            }
            guide.push(at as u32);
        }
        let cells = all.iter().map(|(cell, ..)| *cell as u32).collect();
        Self { width, cells, sums, guide, pixels: level.len() as f64 }
    }

    /// Column and row (pixels, fractional) and one over the density relative to uniform.
    #[inline]
    pub(crate) fn draw(&self, u: f64, v: f64) -> (f64, f64, f64) {
        let many = self.sums.len();
        let mut at = self.guide[((u * many as f64) as usize).min(many - 1)] as usize;
        while at + 1 < many && self.sums[at] <= u {
            at += 1;
        }
        let from = if at > 0 { self.sums[at - 1] } else { 0.0 };
        let mass = self.sums[at] - from;
        let part = if mass > 0.0 { ((u - from) / mass).clamp(0.0, 1.0) } else { 0.5 };
        let cell = self.cells[at] as usize;
        ((cell % self.width) as f64 + part, (cell / self.width) as f64 + v, 1.0 / (mass * self.pixels))
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

    /// Each group row by row, by the first pixel of each.
    fn ordered(mut self) -> Vec<Vec<usize>> {
        let mut groups = Vec::new();
        for first in 0..self.inside.len() {
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

    /// A lamp of one bright pixel and a dim one of sixteen, in a corner.
    fn lamps() -> (Vec<f32>, Vec<f32>) {
        let mut brightness: Vec<f32> = (0..WIDTH * 30).map(|i| 0.1 + 0.05 * (i % 7) as f32).collect();
        brightness[10 * WIDTH + 20] = 50.0;
        for cell in 0..16 {
            brightness[(26 + cell / 4) * WIDTH + 36 + cell % 4] = 20.0;
        }
        let level = super::super::lights::find(WIDTH, &brightness).expect("lamps").level;
        (brightness, level)
    }

    /// What is drawn, each place by one over its density, adds up to the lights' light, in all and of each lamp.
    #[test]
    fn draws_stand_for_all_light() {
        let (brightness, level) = lamps();
        let places = LightPlaces::new(WIDTH, &brightness, &level);
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
}
