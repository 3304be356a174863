//! Rays that a picture with depth emits, from the planes of its pixels and from its [`Starts`]. Each carries light only if the surface
//! from which it starts is the first on its line.

use super::deep::{CHUNK, DeepPicture, Looked};
use super::height_field::Hit;
use super::narrowing::Line;
use super::starts::{Start, Starts};
use crate::split_source::LightPart;
use spectra_core::RayBatch;
use spectra_core::isa::Vectorized;
use spectra_core::loss::{ALIVE, Loss};
use spectra_core::stage::Emit;

impl DeepPicture {
    /// Finds the surfaces on which rays start besides the planes in front. `level` returns the brightness of a pixel.
    fn starts(&self, level: impl Fn(usize) -> f32) -> Starts {
        let [per_mm, _] = self.lattice();
        let px_per_slope = self.plane_mm * per_mm[0].abs().max(per_mm[1].abs());
        Starts::of(&self.map, &self.field, self.behind.as_deref(), px_per_slope, level)
    }

    /// Returns the color of the surface on which a ray starts, and the fraction of its light that the ray carries; `None` if another
    /// surface hides it.
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
        // A pixel that is not mixed has the same surface in front and behind.
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
    fn place(&self, rays: &mut RayBatch, u: &[f64], v: &[f64]) {
        let starts = self.starts.get_or_init(|| match (&self.map.lights, self.map.half) {
            (Some(lights), LightPart::Lights) => self.starts(|cell| lights.level[cell]),
            _ => self.starts(|_| 1.0),
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
                    // The area element of the step is depth dD d(slope), and dD is depth^2 dw.
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

    /// Computes the light of rays once their directions are known, since only then is it known what hides their start.
    fn radiate(&self, rays: &mut RayBatch) {
        let isa = rays.isa();
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

/// A job that finds the light of emitted rays. A ray carries light if it starts on the first surface on its line.
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
                // The step contains the lines through the center of projection: its normal is (1, 0, x/depth) or
                // (0, 1, y/depth), and the area above goes with this vector.
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
