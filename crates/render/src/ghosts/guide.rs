//! Finds where on the front of the lens the light of a path that reaches the frame enters.
//!
//! The first rays go all over the front, the next ones only to where light came through. If none came through, they go to where rays got
//! furthest along the path: what passes a surface is a part of what passes the one before it. A path that enters by one part in 20 000 of a
//! fisheye's front, totally reflected at the first surface, is found in a few rounds this way. Without this step such a path was found by
//! one ray of the final picture, which then carried a tenth of the region's light.

use super::density::{ABREAST, Density, Each};

/// Number of cells, across and up, in which the first rounds look for the part of the front through which light of a path comes.
const SIDE: usize = 24;
/// Number of rays that got furthest and tell where to look, if no light came through.
const FURTHEST: usize = 8;
/// Fraction of the rays that goes all over the front, whatever was found. The estimate therefore has no bias, and light that was overlooked
/// weighs at most ten times as much.
const EVEN: f64 = 0.1;

/// A density over the square [-1, 1]^2 around the front disk: uniform over all of it, plus a part given by cells.
#[derive(Clone, Debug)]
pub(super) struct Guide {
    part: FrontRect,
    /// Fraction of the rays that goes all over the square.
    even: f64,
    cells: Density,
}

/// A place on the front and the ray density there, per unit area of the square.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Aim {
    pub place: [f64; 2],
    pub density: f64,
}

/// A rectangular part of the square, given by two corners.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct FrontRect {
    pub low: [f64; 2],
    pub high: [f64; 2],
}

impl FrontRect {
    pub const ALL: Self = Self { low: [-1.0; 2], high: [1.0; 2] };

    #[inline(always)]
    pub fn area(&self) -> f64 {
        (self.high[0] - self.low[0]) * (self.high[1] - self.low[1])
    }

    /// Converts a place on the front, in the square [-1, 1]^2, to coordinates in this rectangle (0 at `low`, 1 at `high`). `None`
    /// if the place lies outside the rectangle.
    #[inline]
    pub fn inside(&self, place: [f64; 2]) -> Option<[f64; 2]> {
        let at = |axis: usize| (place[axis] - self.low[axis]) / (self.high[axis] - self.low[axis]);
        let at = [at(0), at(1)];
        at.iter().all(|at| (0.0..1.0).contains(at)).then_some(at)
    }

    /// Converts coordinates in this rectangle (0 at `low`, 1 at `high`) to a place on the front, in the square [-1, 1]^2. The
    /// inverse of [`Self::inside`].
    #[inline(always)]
    pub fn place(&self, [x, y]: [f64; 2]) -> [f64; 2] {
        let ([low_x, low_y], [high_x, high_y]) = (self.low, self.high);
        [low_x + (high_x - low_x) * x, low_y + (high_y - low_y) * y]
    }

    /// Returns the smallest rectangle that contains this one and all `places`, points of the square [-1, 1]^2 around the front
    /// disk of the lens.
    pub fn with(mut self, places: impl Iterator<Item = [f64; 2]>) -> Self {
        for place in places {
            for axis in 0..2 {
                self.low[axis] = self.low[axis].min(place[axis]);
                self.high[axis] = self.high[axis].max(place[axis]);
            }
        }
        self
    }
}

impl Guide {
    /// Creates the guide of a search that has not found any light yet: its part is the whole square, with a uniform density.
    pub fn everywhere() -> Self {
        Self::of(FrontRect::ALL, Density::even())
    }

    /// Creates a guide that ignores its cells and sends all rays uniformly over the square.
    pub fn blind() -> Self {
        Self { even: 1.0, ..Self::everywhere() }
    }

    /// Creates a guide that sends rays into the rectangle `part` with the density `cells`, and the fraction `EVEN` of them all
    /// over the square.
    pub fn of(part: FrontRect, cells: Density) -> Self {
        Self { part, even: EVEN, cells }
    }

    pub fn part(&self) -> FrontRect {
        self.part
    }

    /// Draws a place by two numbers in [0, 1).
    #[inline]
    pub fn draw(&self, u: f64, v: f64) -> Aim {
        if u < self.even {
            let place = [2.0 * (u / self.even) - 1.0, 2.0 * v - 1.0];
            return Aim { place, density: self.density(place) };
        }
        let (at, dense) = self.cells.draw((u - self.even) / (1.0 - self.even), v);
        Aim { place: self.part.place(at), density: self.mixed(dense) }
    }

    /// Draws several places side by side, like [`Guide::draw`]. Writes the places over the numbers, and the densities.
    #[inline(always)]
    pub fn draw_abreast(own: [&Self; ABREAST], numbers: &mut [Each; 2], density: &mut Each) {
        let (before, mut cells) = (*numbers, [&own[0].cells; ABREAST]);
        for k in 0..ABREAST {
            cells[k] = &own[k].cells;
            numbers[0][k] = (numbers[0][k] - own[k].even) / (1.0 - own[k].even);
        }
        Density::draw_abreast(cells, numbers, density);
        for k in 0..ABREAST {
            let aim = if before[0][k] < own[k].even {
                own[k].draw(before[0][k], before[1][k])
            } else {
                Aim { place: own[k].part.place([numbers[0][k], numbers[1][k]]), density: own[k].mixed(density[k]) }
            };
            ([numbers[0][k], numbers[1][k]], density[k]) = (aim.place, aim.density);
        }
    }

    /// Returns the ray density at a place, per unit area of the square.
    #[inline]
    pub fn density(&self, place: [f64; 2]) -> f64 {
        self.mixed(self.part.inside(place).map_or(0.0, |at| self.cells.at(at)))
    }

    #[inline(always)]
    fn mixed(&self, dense: f64) -> f64 {
        0.25 * self.even + (1.0 - self.even) * dense / self.part.area()
    }
}

/// The cells of a guide's part through which light came, and how far along the path the other rays got.
#[derive(Clone, Debug)]
pub(super) struct Lit {
    part: FrontRect,
    cells: [bool; SIDE * SIDE],
    /// Number of surfaces that each ray passed, and the cell of the ray.
    went: Vec<(u16, u16)>,
}

impl Lit {
    /// Starts an empty record for a guide.
    pub fn of(guide: &Guide) -> Self {
        Self { part: guide.part, cells: [false; SIDE * SIDE], went: Vec::new() }
    }

    fn cell(&self, place: [f64; 2]) -> Option<usize> {
        let [x, y] = self.part.inside(place)?.map(|at| (at * SIDE as f64) as usize);
        Some(y * SIDE + x)
    }

    /// Records that a ray came through `place`.
    pub fn add(&mut self, place: [f64; 2]) {
        if let Some(cell) = self.cell(place) {
            self.cells[cell] = true;
        }
    }

    /// Records that a ray from `place` passed this many surfaces of the path.
    pub fn went(&mut self, place: [f64; 2], surfaces: u16) {
        if let Some(cell) = self.cell(place).filter(|_| surfaces > 0) {
            self.went.push((surfaces, cell as u16));
        }
    }

    /// Whether no light came through in any of these zones, but rays passed some surfaces.
    pub fn are_on_the_way(zones: &[Self]) -> bool {
        zones.iter().any(|zone| !zone.went.is_empty()) && !zones.iter().any(|zone| zone.cells.contains(&true))
    }

    /// Returns a uniform guide for the smallest part that holds the cells through which light came, and their neighbors. If none came, it
    /// takes the cells of the rays that got furthest. Rays that pass a surface also passed all surfaces before it. A place that one ray in
    /// a million would hit is therefore found in a few steps.
    pub fn closer(&self) -> Guide {
        let mut lit: Vec<usize> = (0..SIDE * SIDE).filter(|at| self.cells[*at]).collect();
        if lit.is_empty() {
            let mut went = self.went.clone();
            went.sort_unstable_by(|a, b| b.cmp(a));
            let Some((least, _)) = went.get(FURTHEST - 1).or(went.last()).copied() else { return Guide::everywhere() };
            lit.extend(went.iter().take_while(|(surfaces, _)| *surfaces >= least).map(|(_, cell)| usize::from(*cell)));
        }
        let ends = |of: fn(usize) -> usize| {
            let first = lit.iter().map(|at| of(*at)).min().unwrap_or(0).saturating_sub(1);
            let last = lit.iter().map(|at| of(*at)).max().unwrap_or(0) + 2;
            [first, last.min(SIDE)].map(|k| k as f64 / SIDE as f64)
        };
        let (columns, rows) = (ends(|at| at % SIDE), ends(|at| at / SIDE));
        let corner = |k: usize| self.part.place([columns[k], rows[k]]);
        Guide::of(FrontRect { low: corner(0), high: corner(1) }, Density::even())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ghosts::pilot_hit::{Contribution, PilotHit};
    use crate::ghosts::pilot_rays::PilotRays;
    use spectra_core::math::sin_cos_turns;
    use spectra_core::numbers::Numbers;

    /// The mean of one over the density is the area, and the mean of a function over the density is its integral, however little of it the
    /// guide has found.
    #[test]
    fn a_guide_has_no_bias() {
        let disk = |[x, y]: [f64; 2]| f64::from((x - 0.3) * (x - 0.3) + (y + 0.2) * (y + 0.2) < 0.01);
        let mut guide = Guide::everywhere();
        let mut sight = PilotRays::default();
        let numbers = Numbers::sobol(5);
        let n = 1 << 14;
        for round in 0..5 {
            let (mut lit, mut came) = (Lit::of(&guide), Vec::new());
            let (mut area, mut integral, mut square) = (0.0, 0.0, 0.0);
            for i in 0..n {
                let aim = guide.draw(numbers.one(round, i, 3), numbers.one(round, i, 4));
                assert!((guide.density(aim.place) / aim.density - 1.0).abs() < 1e-9, "{aim:?}");
                let value = disk(aim.place);
                area += 1.0 / aim.density / n as f64;
                integral += value / aim.density / n as f64;
                square += value / aim.density / aim.density / n as f64;
                if value > 0.0 {
                    lit.add(aim.place);
                    came.push(PilotHit { zone: 0, aim, block: 0, brought: Contribution { all: value, judged: value } });
                }
            }
            let sigma = (square / n as f64).sqrt();
            let want = 0.01 * std::f64::consts::PI;
            assert!((area / 4.0 - 1.0).abs() < 0.02, "{round}: {area}");
            assert!((integral - want).abs() < 4.0 * sigma, "{round}: {integral} {want} {sigma}");
            if round == 4 {
                // Nearly all rays of the guided part come through.
                assert!(square < 1.4 * want * want, "{}", square / want / want);
            }
            if round < 2 {
                guide = lit.closer();
            } else {
                sight.add(vec![guide], n as f64, came);
                let light: f64 = sight.light(Contribution::judged).map(|(_, part)| part).sum();
                assert!((light - want).abs() < 0.01 * want, "{round}: {light} {want}");
                guide = sight.sorted(&[1.0]).guides(&[1.0]).0.remove(0);
            }
        }
    }

    /// Ten nested disks, each with three tenths of the area of the one before, down to eight places in a million. Rays that pass some of
    /// them lead to the innermost one.
    #[test]
    fn rays_that_go_further_lead_to_the_light() {
        let passed = |[x, y]: [f64; 2]| {
            let away2 = (x - 0.4) * (x - 0.4) + (y + 0.3) * (y + 0.3);
            (0..10).filter(|at| away2 < 0.5 * 0.3_f64.powi(*at)).count() as u16
        };
        let (mut guide, numbers, n) = (Guide::everywhere(), Numbers::sobol(5), 4096);
        let mut came = Vec::new();
        for round in 0..5 {
            let mut lit = Lit::of(&guide);
            came.push(0);
            for i in 0..n {
                let aim = guide.draw(numbers.one(round, i, 3), numbers.one(round, i, 4));
                let surfaces = passed(aim.place);
                lit.went(aim.place, surfaces);
                if surfaces == 10 {
                    lit.add(aim.place);
                    came[round as usize] += 1;
                }
            }
            assert_eq!(Lit::are_on_the_way(std::slice::from_ref(&lit)), came[round as usize] == 0);
            guide = lit.closer();
        }
        assert!(came[0] == 0 && came[4] > n / 4, "{came:?}");
        // No ray passed anything, so it is unknown where to look.
        let blocked = Lit::of(&guide);
        assert!(!Lit::are_on_the_way(std::slice::from_ref(&blocked)));
        assert_eq!(blocked.closer().part(), FrontRect::ALL);
    }

    #[test]
    fn what_was_not_found_is_looked_for_everywhere() {
        let mut sight = PilotRays::default();
        sight.add(vec![Guide::everywhere()], 100.0, Vec::new());
        let guide = sight.sorted(&[]).guides(&[]).0.remove(0);
        let (sin, _) = sin_cos_turns(0.1);
        let aim = guide.draw(0.5 * sin, 0.75);
        assert_eq!((aim.place, aim.density), ([sin - 1.0, 0.5], 0.25));
    }

    #[test]
    fn side_by_side_they_are_as_one_by_one() {
        let part = FrontRect { low: [-0.3, 0.1], high: [0.2, 0.7] };
        let all = [Guide::of(part, Density::of(&[(1, 0.0), (0, 1.0), (0, 0.0), (0, 3.0), (0, 0.5)])), Guide::blind()];
        let numbers = Numbers::sobol(2);
        for i in 0..256 {
            let own: [&Guide; ABREAST] = std::array::from_fn(|k| &all[usize::from(k % 3 == 0)]);
            let of = |dimension: u32| std::array::from_fn(|k| numbers.one(k as u64, i, dimension));
            let (mut places, mut density): ([Each; 2], Each) = ([of(0), of(1)], [0.0; ABREAST]);
            let want: [_; ABREAST] = std::array::from_fn(|k| own[k].draw(places[0][k], places[1][k]));
            Guide::draw_abreast(own, &mut places, &mut density);
            let aim = |k: usize| Aim { place: [places[0][k], places[1][k]], density: density[k] };
            assert_eq!(std::array::from_fn(aim), want);
        }
    }
}
