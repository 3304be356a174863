//! A picture with depth as a source: what comes against a ray from the lens, and what goes toward it.
//!
//! Both are the same light: a ray that is emitted carries the light that [`HeightField::hit`] finds along it, and none where
//! something else stands before the place that it starts from. What can be met are the plane of each pixel and the step between
//! a pixel and one that stands nearer: where a ray passes there it meets the step, or what is guessed behind it. So rays start on
//! both, and each ray that meets anything can be drawn in one way.

use super::field::{HeightField, Hit, Wall};
use super::map::PictureMap;
use super::narrowing::{Line, Lines, SIDE_BY_SIDE};
use crate::flat::Texture;
use crate::halves::Half;
use spectra_core::isa::Vectorized;
use spectra_core::loss::{ALIVE, Loss};
use spectra_core::spectral::SpectralPower;
use spectra_core::stage::{Emit, Radiance, Source};
use spectra_core::{Isa, RayBatch};
use std::sync::{Arc, OnceLock};

/// A picture whose pixels stand at their depths.
pub(super) struct DeepPicture {
    /// Colors; its size is that on the plane at `plane_mm`.
    map: PictureMap,
    field: Arc<HeightField>,
    /// Distance of the plane from the center of projection, mm.
    plane_mm: f64,
    /// The center of projection on the axis, mm behind the first vertex.
    eye_mm: f64,
    nearest_mm: f64,
    farthest_mm: f64,
    /// What its depths were taken for.
    meaning: Arc<str>,
    /// The steps that rays start on, found when the first does.
    walls: OnceLock<Walls>,
}

impl Source for DeepPicture {
    fn spectrum(&self) -> &SpectralPower {
        &self.map.mean
    }
    fn peak_over_mean(&self) -> f64 {
        self.map.peak_over_mean
    }
    fn distance_mm(&self) -> f64 {
        self.nearest_mm - self.eye_mm
    }
    fn emit(&self) -> Option<&dyn Emit> {
        (self.field.cells() <= MOST_CELLS && self.map.is_bounded()).then_some(self as &dyn Emit)
    }
    fn radiance(&self) -> Option<&dyn Radiance> {
        Some(self)
    }
    fn meaning(&self) -> Option<String> {
        Some(format!("depth {}", self.meaning))
    }
    fn describe(&self) -> String {
        let [near, far] = [self.nearest_mm, self.farthest_mm].map(|d| d - self.eye_mm);
        let (name, meaning) = (&self.map.name, &self.meaning);
        format!("picture {name} with depth from {near:.0} to {far:.0} mm in front of the lens ({meaning})")
    }
}

impl DeepPicture {
    /// Places the pixels of a map at the depths of a field, of which the nearest and the farthest are `ends_mm`; `meaning` says for the
    /// summary what the depths were taken for.
    pub(super) fn new(
        map: PictureMap,
        field: Arc<HeightField>,
        plane_mm: f64,
        eye_mm: f64,
        [nearest_mm, farthest_mm]: [f64; 2],
        meaning: Arc<str>,
    ) -> Self {
        Self { map, field, plane_mm, eye_mm, nearest_mm, farthest_mm, meaning, walls: OnceLock::new() }
    }

    /// Pixels a mm on the plane, to the right and up (rows count down), and the middle of the picture in pixels.
    #[inline(always)]
    fn lattice(&self) -> [[f64; 2]; 2] {
        let map = &self.map;
        let per_mm = [map.width_px as f64 / map.width_mm, -(map.height_px as f64) / map.height_mm];
        [per_mm, [0.5 * map.width_px as f64, 0.5 * map.height_px as f64]]
    }

    /// The ray through a point in a direction, over the picture.
    #[inline(always)]
    fn line(&self, [x, y, z]: [f64; 3], [l, m, n]: [f64; 3]) -> Line {
        let t = (self.eye_mm - z) / n;
        let [[per_x, per_y], [middle_x, middle_y]] = self.lattice();
        let (slope_x, slope_y) = (l / -n, m / -n);
        let (per_x, per_y) = (per_x * self.plane_mm, per_y * self.plane_mm);
        Line {
            at_infinity: [middle_x + per_x * slope_x, middle_y + per_y * slope_y],
            per_w: [per_x * (x + t * l), per_y * (y + t * m)],
        }
    }

    /// How far right and up of the axis a place of the picture is seen, per unit of depth.
    #[inline(always)]
    fn slopes(&self, [column, row]: [f64; 2]) -> [f64; 2] {
        let [[per_x, per_y], [middle_x, middle_y]] = self.lattice();
        [(column - middle_x) / (per_x * self.plane_mm), (row - middle_y) / (per_y * self.plane_mm)]
    }

    /// The point at a place of the picture and a depth, in the frame of the lens.
    fn point(&self, place: [f64; 2], depth_mm: f64) -> [f64; 3] {
        let [x, y] = self.slopes(place);
        [x * depth_mm, y * depth_mm, self.eye_mm - depth_mm]
    }

    /// The color that a ray meets, and which part of the light there is this picture's.
    #[inline(always)]
    fn color(&self, hit: &Hit) -> ([f32; 3], f32) {
        // Between pixels of the same thing colors are smooth; others do not count.
        let spot = self.map.spot(hit.place);
        if !hit.guessed && self.field.is_smooth(hit.cell) {
            return self.map.color(&spot);
        }
        let own = self.map.coefficients[hit.cell];
        let is_whole = self.map.half == Half::Whole;
        if hit.guessed {
            // A light does not go on behind what stands before it: as far as the guess goes it would shine in place of a background.
            if self.map.is_light(hit.cell) {
                return ([0.0; 3], 0.0);
            }
            let share = if is_whole { 1.0 } else { self.map.share(&spot, |_| hit.cell) };
            return (own, share);
        }
        let of = |cell| if self.field.together(hit.cell, cell) { cell } else { hit.cell };
        let color =
            spot.mix(|cell| if self.field.together(hit.cell, cell) { self.map.coefficients[cell] } else { own });
        (color, if is_whole { 1.0 } else { self.map.share(&spot, of) })
    }
}

impl Radiance for DeepPicture {
    fn radiance(&self, rays: &mut RayBatch, isa: Isa) {
        let c = rays.columns_mut();
        let mut looked = Looked::new();
        for start in (0..c.x.len()).step_by(CHUNK) {
            let r = start..(start + CHUNK).min(c.x.len());
            isa.run(See {
                deep: self,
                position: [&c.x[r.clone()], &c.y[r.clone()], &c.z[r.clone()]],
                direction: [&c.l[r.clone()], &c.m[r.clone()], &c.n[r.clone()]],
                state: &mut c.state[r.clone()],
                weight: &mut c.weight[r.clone()],
                looked: &mut looked,
            });
            let (wavelength, line) = (&c.wavelength_nm[r.clone()], &c.line[r.clone()]);
            self.map.model.evaluate(&looked.colors[..r.len()], wavelength, line, &mut c.weight[r]);
        }
    }
}

/// Rays that are worked on at a time.
const CHUNK: usize = SIDE_BY_SIDE;

/// What is known of a chunk of rays: their lines over the picture, what they meet, and its colors.
struct Looked {
    lines: Lines,
    hits: [Option<Hit>; CHUNK],
    colors: [[f32; 3]; CHUNK],
}

impl Looked {
    fn new() -> Self {
        Self { lines: Lines::new(), hits: [None; CHUNK], colors: [[0.0; 3]; CHUNK] }
    }

    /// Finds what rays meet that have not ended.
    #[inline(always)]
    fn look(&mut self, deep: &DeepPicture, [x, y, z]: [&[f64]; 3], [l, m, n]: [&[f64]; 3], state: &[u64]) {
        let len = x.len().min(CHUNK);
        let (x, y, z, l, m, n) = (&x[..len], &y[..len], &z[..len], &l[..len], &m[..len], &n[..len]);
        let lines = &mut self.lines;
        for i in 0..len {
            let Line { at_infinity, per_w } = deep.line([x[i], y[i], z[i]], [l[i], m[i], n[i]]);
            (lines.at_infinity[0][i], lines.at_infinity[1][i]) = (at_infinity[0], at_infinity[1]);
            (lines.per_w[0][i], lines.per_w[1][i]) = (per_w[0], per_w[1]);
        }
        let mut wanted = [false; CHUNK];
        for (wanted, state) in wanted.iter_mut().zip(state) {
            *wanted = *state == ALIVE;
        }
        deep.field.hits(lines, len, &wanted, &mut self.hits);
    }
}

/// Finds what a chunk of rays from the lens meets.
struct See<'a> {
    deep: &'a DeepPicture,
    position: [&'a [f64]; 3],
    direction: [&'a [f64]; 3],
    state: &'a mut [u64],
    weight: &'a mut [f64],
    looked: &'a mut Looked,
}

impl Vectorized for See<'_> {
    type Output = ();
    #[inline(always)]
    fn run(self) {
        let Self { deep, position, direction, state, weight, looked } = self;
        for (state, n) in state.iter_mut().zip(direction[2]) {
            if *state == ALIVE && !(*n < 0.0) {
                *state = Loss::Absorbed.state(0);
            }
        }
        looked.look(deep, position, direction, state);
        for i in 0..weight.len() {
            let mut share = 1.0;
            looked.colors[i] = [0.0; 3];
            // Black beside the picture.
            if let Some(hit) = &looked.hits[i] {
                (looked.colors[i], share) = deep.color(hit);
            }
            weight[i] *= deep.map.scale * f64::from(share);
        }
    }
}

/// Pixels that a tag has room for beside side and kind.
const MOST_CELLS: usize = 1 << 28;
/// In a tag: the ray starts on a step, on this side of the pixel.
const IS_WALL: u32 = 1 << 31;
const SIDE_BITS: u32 = 28;
/// How far from the axis light enters a lens, mm, as a guess: it decides how many rays start on steps, not what they carry.
const OFF_AXIS_MM: f64 = 6.0;
/// At most this part of the rays starts on steps, where planes shine as well.
const MOST_WALLS: f64 = 0.5;

/// The steps of a picture that rays start on, in proportion to how much light is expected to pass them.
struct Walls {
    all: Vec<Wall>,
    /// Up to and with each; the last is 1.
    sums: Vec<f64>,
    /// For each of as many equal parts of [0, 1) the step that its lower end lies in.
    guide: Vec<u32>,
    /// Which part of the rays starts on them.
    share: f64,
}

impl Walls {
    /// `level` says how bright a pixel is, 0 if it is none of this picture's.
    fn of(deep: &DeepPicture, level: impl Fn(usize) -> f32) -> Self {
        let (field, map) = (&deep.field, &deep.map);
        let [per_mm, _] = deep.lattice();
        // Places of the background that a step hides, in pixels, for each unit of 1/depth between.
        let hidden = deep.plane_mm * per_mm[0].abs().max(per_mm[1].abs()) * OFF_AXIS_MM;
        let around = |cell: usize| {
            let (column, row) = (cell % map.width_px, cell / map.width_px);
            let rows = row.saturating_sub(1)..=(row + 1).min(map.height_px - 1);
            let columns = column.saturating_sub(1)..=(column + 1).min(map.width_px - 1);
            rows.flat_map(|r| columns.clone().map(move |c| r * map.width_px + c)).map(&level).fold(0.0_f32, f32::max)
        };
        let (mut all, mut sums, mut sum, mut planes) = (Vec::new(), Vec::new(), 0.0, 0.0);
        for cell in 0..field.cells() {
            planes += f64::from(level(cell));
            for side in 0..4 {
                let Some(nearer) = field.beside(cell, side).filter(|beside| field.w(*beside) > field.w(cell)) else {
                    continue;
                };
                // A step of one thing has the light of its nearer pixel; behind another thing goes on what it hides.
                let level = match field.together(cell, nearer) {
                    true => around(nearer),
                    false if map.is_light(cell) => 0.0,
                    false => level(cell),
                };
                if level > 0.0 {
                    sum += f64::from(level) * hidden * (field.w(nearer) - field.w(cell));
                    all.push(Wall { cell: cell as u32, side });
                    sums.push(sum);
                }
            }
        }
        let share = if sum > 0.0 { (sum / (sum + planes)).min(MOST_WALLS) } else { 0.0 };
        sums.iter_mut().for_each(|s| *s /= sum);
        if let Some(last) = sums.last_mut() {
            *last = 1.0;
        }
        let mut at = 0;
        let guide = (0..sums.len()).map(|part| {
            let from = part as f64 / sums.len() as f64;
            while at + 1 < sums.len() && sums[at] <= from {
                at += 1;
            }
            at as u32 // there are four a pixel at most
        });
        let guide = guide.collect();
        Self { all, sums, guide, share }
    }

    /// One of them, what is left of the number, and one over its probability.
    fn draw(&self, u: f64) -> (Wall, f64, f64) {
        let many = self.sums.len();
        let mut at = self.guide[((u * many as f64) as usize).min(many - 1)] as usize;
        while at + 1 < many && self.sums[at] <= u {
            at += 1;
        }
        let from = if at > 0 { self.sums[at - 1] } else { 0.0 };
        let part = self.sums[at] - from;
        (self.all[at], ((u - from) / part).clamp(0.0, 1.0), 1.0 / part)
    }
}

impl Emit for DeepPicture {
    fn place(&self, rays: &mut RayBatch, u: &[f64], v: &[f64], _: Isa) {
        let walls = self.walls.get_or_init(|| match (&self.map.lights, self.map.half) {
            (Some(lights), Half::Lights) => Walls::of(self, |cell| lights.level[cell]),
            _ => Walls::of(self, |_| 1.0),
        });
        let pixel_mm2 = self.map.width_mm * self.map.height_mm / (self.plane_mm * self.plane_mm);
        let [per_mm, _] = self.lattice();
        let last = [self.map.width_px - 1, self.map.height_px - 1];
        let c = rays.columns_mut();
        for i in 0..c.x.len() {
            let (place, depth_mm, area_mm2, tag);
            if u[i] < walls.share {
                let (wall, part, inverse) = walls.draw(u[i] / walls.share);
                let (cell, axis) = (wall.cell as usize, usize::from(wall.side / 2));
                let w = self.field.w(cell);
                let range = self.field.beside(cell, wall.side).map_or(0.0, |nearer| self.field.w(nearer) - w);
                let corner = [cell % self.map.width_px, cell / self.map.width_px].map(|at| at as f64);
                let mut at = [corner[0] + v[i], corner[1] + v[i]];
                at[axis] = corner[axis] + f64::from(wall.side % 2);
                depth_mm = 1.0 / (w + part * range);
                // Along the step its area grows by depth dD d(slope), and dD is depth^2 dw.
                let slope = 1.0 / (per_mm[1 - axis].abs() * self.plane_mm);
                area_mm2 = depth_mm * depth_mm * depth_mm * range * slope * inverse / walls.share;
                (place, tag) = (at, IS_WALL | u32::from(wall.side) << SIDE_BITS | wall.cell);
            } else {
                let (column, row, inverse) = self.map.draw_place((u[i] - walls.share) / (1.0 - walls.share), v[i]);
                let cell = (row as usize).min(last[1]) * self.map.width_px + (column as usize).min(last[0]);
                depth_mm = 1.0 / self.field.w(cell);
                area_mm2 = pixel_mm2 * depth_mm * depth_mm * inverse / (1.0 - walls.share);
                (place, tag) = ([column, row], cell as u32);
            }
            [c.x[i], c.y[i], c.z[i]] = self.point(place, depth_mm);
            c.weight[i] *= self.map.scale * area_mm2;
            c.tag[i] = tag;
        }
    }

    /// What a ray carries shows once it has a direction: only then is it known what stands before it.
    fn radiate(&self, rays: &mut RayBatch, isa: Isa) {
        let c = rays.columns_mut();
        let mut looked = Looked::new();
        for start in (0..c.x.len()).step_by(CHUNK) {
            let r = start..(start + CHUNK).min(c.x.len());
            isa.run(Shine {
                deep: self,
                position: [&c.x[r.clone()], &c.y[r.clone()], &c.z[r.clone()]],
                direction: [&c.l[r.clone()], &c.m[r.clone()], &c.n[r.clone()]],
                tag: &c.tag[r.clone()],
                state: &mut c.state[r.clone()],
                weight: &mut c.weight[r.clone()],
                looked: &mut looked,
            });
            let (wavelength, line) = (&c.wavelength_nm[r.clone()], &c.line[r.clone()]);
            self.map.model.evaluate(&looked.colors[..r.len()], wavelength, line, &mut c.weight[r]);
        }
    }
}

/// Finds what rays that were emitted carry: light, if they start from the first thing that stands on their line.
struct Shine<'a> {
    deep: &'a DeepPicture,
    position: [&'a [f64]; 3],
    direction: [&'a [f64]; 3],
    tag: &'a [u32],
    state: &'a mut [u64],
    weight: &'a mut [f64],
    looked: &'a mut Looked,
}

impl Vectorized for Shine<'_> {
    type Output = ();
    #[inline(always)]
    fn run(self) {
        let Self { deep, position, direction, tag, state, weight, looked } = self;
        looked.look(deep, position, direction, state);
        for i in 0..weight.len() {
            looked.colors[i] = [0.0; 3];
            if state[i] != ALIVE {
                continue;
            }
            let (tag, way) = (tag[i], [direction[0][i], direction[1][i], direction[2][i]]);
            let from = Wall { cell: tag & (MOST_CELLS as u32 - 1), side: (tag >> SIDE_BITS & 3) as u8 };
            let is_wall = tag & IS_WALL != 0;
            let hit = match looked.hits[i] {
                Some(hit) if !is_wall && hit.wall.is_none() && hit.cell == tag as usize => hit,
                Some(hit) if is_wall && hit.wall == Some(from) => hit,
                _ => {
                    state[i] = Loss::Absorbed.state(0);
                    continue;
                }
            };
            let cosine = if is_wall {
                // The step lies along the lines through the center of projection: its normal is (1, 0, x/depth) or
                // (0, 1, y/depth), and the area counts by that vector.
                let axis = usize::from(from.side / 2);
                let (cell, beyond, width) = (from.cell as usize, usize::from(from.side % 2), deep.map.width_px);
                let border = [(cell % width + beyond) as f64, (cell / width + beyond) as f64];
                way[axis] + deep.slopes(border)[axis] * way[2]
            } else {
                way[2]
            };
            let share;
            (looked.colors[i], share) = deep.color(&hit);
            weight[i] *= cosine.abs() * f64::from(share);
        }
    }
}
