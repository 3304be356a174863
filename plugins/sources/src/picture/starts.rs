//! What rays start on that a picture with depth emits: the planes of pixels, the steps between them, and what lies behind mixed pixels.

use super::deep::{CHUNK, DeepPicture, Looked};
use super::field::{HeightField, Hit, Wall};
use super::narrowing::Line;
use crate::halves::Half;
use spectra_core::isa::Vectorized;
use spectra_core::loss::{ALIVE, Loss};
use spectra_core::stage::Emit;
use spectra_core::{Isa, RayBatch};

/// Pixels that a tag has room for beside side and kind.
pub(super) const MOST_CELLS: usize = 1 << 28;
/// In a tag: the ray starts on a step, on this side of the pixel.
const IS_WALL: u32 = 1 << 31;
/// In a tag: the ray starts on what lies behind mixed pixels.
const IS_BEHIND: u32 = 1 << 30;
const SIDE_BITS: u32 = 28;
/// How far from the axis light enters a lens, mm, as a guess: it decides how many rays start on steps, not what they carry.
const OFF_AXIS_MM: f64 = 6.0;
/// At most this part of the rays starts on these, where planes in front shine as well.
const MOST: f64 = 0.5;

/// The steps of a picture, and the planes and steps behind its mixed pixels, in proportion to how much light is expected to pass them.
pub(super) struct Starts {
    /// The tags of rays that start on each.
    all: Vec<u32>,
    /// Up to and with each; the last is 1.
    sums: Vec<f64>,
    /// For each of as many equal parts of [0, 1) the start that its lower end lies in.
    guide: Vec<u32>,
    /// Which part of the rays starts on them.
    share: f64,
}

impl Starts {
    /// `level` says how bright a pixel is, 0 if it is none of this picture's.
    fn of(deep: &DeepPicture, level: impl Fn(usize) -> f32) -> Self {
        let map = &deep.map;
        let [per_mm, _] = deep.lattice();
        // Places of the background that a step hides, in pixels, for each unit of 1/depth between.
        let hidden = deep.plane_mm * per_mm[0].abs().max(per_mm[1].abs()) * OFF_AXIS_MM;
        let around = |cell: usize| {
            let (column, row) = (cell % map.width_px, cell / map.width_px);
            let rows = row.saturating_sub(1)..=(row + 1).min(map.height_px - 1);
            let columns = column.saturating_sub(1)..=(column + 1).min(map.width_px - 1);
            rows.flat_map(|r| columns.clone().map(move |c| r * map.width_px + c)).map(&level).fold(0.0_f32, f32::max)
        };
        let (mut all, mut sums, mut sum) = (Vec::new(), Vec::new(), 0.0);
        let mut take = |tag: u32, part: f64| {
            if part > 0.0 {
                sum += part;
                all.push(tag);
                sums.push(sum);
            }
        };
        let mut walls = |field: &HeightField, cell: usize, kind: u32, wanted: &dyn Fn(usize) -> bool| {
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
                if wanted(nearer) {
                    let range = field.w(nearer) - field.w(cell);
                    take(
                        kind | IS_WALL | u32::from(side) << SIDE_BITS | cell as u32,
                        f64::from(level) * hidden * range,
                    );
                }
            }
        };
        let mut planes = 0.0;
        for cell in 0..deep.field.cells() {
            planes += f64::from(level(cell));
            walls(&deep.field, cell, 0, &|_| true);
        }
        if let Some(behind) = &deep.behind {
            for cell in 0..deep.field.cells() {
                walls(&behind.field, cell, IS_BEHIND, &|nearer| behind.has(cell) || behind.has(nearer));
            }
            behind.cells().for_each(|cell| take(IS_BEHIND | cell as u32, f64::from(around(cell))));
        }
        let share = if sum > 0.0 { (sum / (sum + planes)).min(MOST) } else { 0.0 };
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
            at as u32 // there are nine a pixel at most
        });
        let guide = guide.collect();
        Self { all, sums, guide, share }
    }

    /// One of them, what is left of the number, and one over its probability.
    fn draw(&self, u: f64) -> (u32, f64, f64) {
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

/// What a ray starts on.
struct Start {
    cell: usize,
    /// The step, if it is none of the planes.
    wall: Option<Wall>,
    is_behind: bool,
}

impl Start {
    fn of(tag: u32) -> Self {
        let cell = tag & (MOST_CELLS as u32 - 1);
        let wall = (tag & IS_WALL != 0).then_some(Wall { cell, side: (tag >> SIDE_BITS & 3) as u8 });
        Self { cell: cell as usize, wall, is_behind: tag & IS_BEHIND != 0 }
    }

    /// Whether it is what a ray meets.
    #[inline(always)]
    fn is(&self, hit: &Hit) -> bool {
        match self.wall {
            Some(_) => hit.wall == self.wall,
            None => hit.wall.is_none() && hit.cell == self.cell,
        }
    }
}

impl DeepPicture {
    /// The color of what a ray starts on, and which part of the light there it carries; `None` where something else stands before it.
    #[inline(always)]
    fn carried(&self, start: &Start, first: Option<Hit>, line: impl FnOnce() -> Line) -> Option<([f32; 3], f32)> {
        let first = first?;
        let opacity = self.opacity(&first);
        if !start.is_behind && start.is(&first) {
            let (color, share) = self.color(&first);
            return Some((color, share * opacity));
        }
        if opacity == 1.0 {
            return None;
        }
        // What is no mixed pixel is the same in front and behind.
        let behind = self.behind.as_ref()?;
        let beside = start.wall.and_then(|wall| behind.field.beside(start.cell, wall.side));
        if !start.is_behind && (behind.has(start.cell) || beside.is_some_and(|beside| behind.has(beside))) {
            return None;
        }
        let second = behind.field.hit(&line()).filter(|second| start.is(second))?;
        let (color, share) = self.color_behind(behind, &second);
        Some((color, share * (1.0 - opacity)))
    }
}

impl Emit for DeepPicture {
    fn place(&self, rays: &mut RayBatch, u: &[f64], v: &[f64], _: Isa) {
        let starts = self.starts.get_or_init(|| match (&self.map.lights, self.map.half) {
            (Some(lights), Half::Lights) => Starts::of(self, |cell| lights.level[cell]),
            _ => Starts::of(self, |_| 1.0),
        });
        let picture_mm2 = self.map.width_mm * self.map.height_mm / (self.plane_mm * self.plane_mm);
        let pixel_mm2 = picture_mm2 / self.field.cells() as f64;
        let [per_mm, _] = self.lattice();
        let last = [self.map.width_px - 1, self.map.height_px - 1];
        let c = rays.columns_mut();
        for i in 0..c.x.len() {
            let (place, depth_mm, area_mm2, tag);
            if u[i] < starts.share {
                let (drawn, part, inverse) = starts.draw(u[i] / starts.share);
                let start = Start::of(drawn);
                let field = match &self.behind {
                    Some(behind) if start.is_behind => &behind.field,
                    _ => &*self.field,
                };
                let w = field.w(start.cell);
                let corner = [start.cell % self.map.width_px, start.cell / self.map.width_px].map(|at| at as f64);
                if let Some(wall) = start.wall {
                    let axis = usize::from(wall.side / 2);
                    let range = field.beside(start.cell, wall.side).map_or(0.0, |nearer| field.w(nearer) - w);
                    let mut at = [corner[0] + v[i], corner[1] + v[i]];
                    at[axis] = corner[axis] + f64::from(wall.side % 2);
                    depth_mm = 1.0 / (w + part * range);
                    // Along the step its area grows by depth dD d(slope), and dD is depth^2 dw.
                    let slope = 1.0 / (per_mm[1 - axis].abs() * self.plane_mm);
                    area_mm2 = depth_mm * depth_mm * depth_mm * range * slope * inverse / starts.share;
                    place = at;
                } else {
                    depth_mm = 1.0 / w;
                    area_mm2 = pixel_mm2 * depth_mm * depth_mm * inverse / starts.share;
                    place = [corner[0] + part, corner[1] + v[i]];
                }
                tag = drawn;
            } else {
                let (column, row, inverse) = self.map.draw_place((u[i] - starts.share) / (1.0 - starts.share), v[i]);
                let cell = (row as usize).min(last[1]) * self.map.width_px + (column as usize).min(last[0]);
                depth_mm = 1.0 / self.field.w(cell);
                area_mm2 = picture_mm2 * depth_mm * depth_mm * inverse / (1.0 - starts.share);
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
            let (start, way) = (Start::of(tag[i]), [direction[0][i], direction[1][i], direction[2][i]]);
            let share;
            match deep.carried(&start, looked.hits[i], || looked.lines.line(i)) {
                Some(carried) => (looked.colors[i], share) = carried,
                None => {
                    state[i] = Loss::Absorbed.state(0);
                    continue;
                }
            }
            let cosine = if let Some(wall) = start.wall {
                // The step lies along the lines through the center of projection: its normal is (1, 0, x/depth) or
                // (0, 1, y/depth), and the area counts by that vector.
                let axis = usize::from(wall.side / 2);
                let (cell, beyond, width) = (start.cell, usize::from(wall.side % 2), deep.map.width_px);
                let border = [(cell % width + beyond) as f64, (cell / width + beyond) as f64];
                way[axis] + deep.slopes(border)[axis] * way[2]
            } else {
                way[2]
            };
            weight[i] *= cosine.abs() * f64::from(share);
        }
    }
}
