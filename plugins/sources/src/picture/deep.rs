//! A picture with depth as a source: its radiance along rays from the lens, and the rays that it emits toward the lens.
//!
//! Both describe the same light: an emitted ray carries the light that [`HeightField::hit`] finds along it, and none if another surface
//! hides its start. A ray can meet the plane of a pixel, or the step between a pixel and a nearer neighbor. At a step it meets the step
//! itself, or the background that is guessed behind it. Rays therefore start on planes and on steps, and each ray that meets a surface
//! can be drawn in exactly one way.
//!
//! A mixed pixel at an edge covers only a fraction of its area ([`super::edges`]). A ray that meets one gets this fraction of its light
//! from the front, and the rest from the same ray in the background picture ([`Backdrop`]), where no mixed pixel is in front.

use super::backdrop::Backdrop;
use super::height_field::{HeightField, Hit};
use super::narrowing::{Line, Lines, SIDE_BY_SIDE};
use super::picture_texture::PictureTexture;
use super::starts::{MOST_CELLS, Starts};
use crate::plane_source::Texture;
use crate::split_source::LightPart;
use spectra_core::RayBatch;
use spectra_core::isa::Vectorized;
use spectra_core::loss::{ALIVE, Loss};
use spectra_core::spectral::SpectralPower;
use spectra_core::stage::{Emit, Radiance, Source};
use std::sync::{Arc, OnceLock};

/// A picture source whose pixels lie at their depths.
pub(super) struct DeepPicture {
    /// Colors of the picture. Its size is that on the plane at `plane_mm`.
    pub(super) map: PictureTexture,
    pub(super) field: Arc<HeightField>,
    /// Background behind mixed pixels, if there are any.
    pub(super) behind: Option<Arc<Backdrop>>,
    /// Distance of the plane from the center of projection, mm.
    pub(super) plane_mm: f64,
    /// Position of the center of projection on the axis, mm behind the first vertex.
    eye_mm: f64,
    nearest_mm: f64,
    farthest_mm: f64,
    /// Description of how the depths were read.
    meaning: Arc<str>,
    /// Surfaces on which rays start besides the planes in front; found when the first ray starts.
    pub(super) starts: OnceLock<Starts>,
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
    /// Places the pixels of a map at the depths of a field, with the background of mixed pixels. `ends_mm` are the nearest and the farthest
    /// depth. `meaning` describes for the summary how the depths were read.
    pub(super) fn new(
        map: PictureTexture,
        (field, behind): (Arc<HeightField>, Option<Arc<Backdrop>>),
        plane_mm: f64,
        eye_mm: f64,
        [nearest_mm, farthest_mm]: [f64; 2],
        meaning: Arc<str>,
    ) -> Self {
        Self { map, field, behind, plane_mm, eye_mm, nearest_mm, farthest_mm, meaning, starts: OnceLock::new() }
    }

    /// Returns the number of pixels per mm on the plane, to the right and up (negative, since row numbers rise downward), and the center of
    /// the picture in pixels.
    #[inline(always)]
    pub(super) fn lattice(&self) -> [[f64; 2]; 2] {
        let map = &self.map;
        let per_mm = [map.width_px as f64 / map.width_mm, -(map.height_px as f64) / map.height_mm];
        [per_mm, [0.5 * map.width_px as f64, 0.5 * map.height_px as f64]]
    }

    /// Returns the line over the picture of a ray through a point in a direction.
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

    /// Returns the slopes to the right and up under which a point of the picture is seen, per unit of depth.
    #[inline(always)]
    pub(super) fn slopes(&self, [column, row]: [f64; 2]) -> [f64; 2] {
        let [[per_x, per_y], [middle_x, middle_y]] = self.lattice();
        [(column - middle_x) / (per_x * self.plane_mm), (row - middle_y) / (per_y * self.plane_mm)]
    }

    /// Returns the point in space, mm in the frame of the lens, for a point of the picture and a depth.
    pub(super) fn point(&self, place: [f64; 2], depth_mm: f64) -> [f64; 3] {
        let [x, y] = self.slopes(place);
        [x * depth_mm, y * depth_mm, self.eye_mm - depth_mm]
    }

    /// Returns the color that a ray meets, and the fraction of its light that belongs to this part of the picture.
    #[inline(always)]
    pub(super) fn color(&self, hit: &Hit) -> ([f32; 3], f32) {
        // Interpolate colors only between pixels of the same object.
        let spot = self.map.spot(hit.place);
        if !hit.guessed && self.field.is_smooth(hit.cell) {
            return self.map.color(&spot);
        }
        let is_whole = self.map.half == LightPart::Whole;
        if hit.guessed {
            let cell = self.field.goes_on(hit);
            // A light is not continued behind the foreground: it would shine over the whole guessed background.
            if self.map.is_light(cell) {
                return ([0.0; 3], 0.0);
            }
            let share = if is_whole { 1.0 } else { self.map.share(&spot, |_| cell) };
            return (self.map.coefficients[cell], share);
        }
        let own = self.map.coefficients[hit.cell];
        let of = |cell| if self.field.together(hit.cell, cell) { cell } else { hit.cell };
        let color =
            spot.mix(|cell| if self.field.together(hit.cell, cell) { self.map.coefficients[cell] } else { own });
        (color, if is_whole { 1.0 } else { self.map.share(&spot, of) })
    }

    /// Returns the fraction of a ray's light that comes from the first surface it meets. The rest comes through a mixed pixel from behind.
    #[inline(always)]
    pub(super) fn opacity(&self, hit: &Hit) -> f32 {
        let Some(behind) = &self.behind else { return 1.0 };
        if behind.shows(hit) {
            return 0.0;
        }
        if !behind.has(hit.cell) {
            return 1.0;
        }
        let opacity =
            if hit.guessed { behind.opacity_of(hit.cell) } else { behind.opacity(hit.cell, &self.map.spot(hit.place)) };
        opacity.unwrap_or(1.0)
    }

    /// Returns the color as [`DeepPicture::color`] does, where a ray meets the background picture.
    pub(super) fn color_behind(&self, behind: &Backdrop, hit: &Hit) -> ([f32; 3], f32) {
        let spot = self.map.spot(hit.place);
        let color = |cell: usize| behind.color(cell).unwrap_or(self.map.coefficients[cell]);
        if hit.guessed {
            let cell = behind.field.goes_on(hit);
            let share = if self.map.is_light(cell) { 0.0 } else { self.map.share(&spot, |_| cell) };
            return (color(cell), share);
        }
        let of = |cell| if behind.field.together(hit.cell, cell) { cell } else { hit.cell };
        (spot.mix(|cell| color(of(cell))), self.map.share(&spot, of))
    }
}

impl Radiance for DeepPicture {
    fn radiance(&self, rays: &mut RayBatch) {
        let isa = rays.isa();
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
            let weight = &mut c.weight[r.clone()];
            self.map.model.evaluate(&looked.colors[..r.len()], wavelength, line, weight);
            looked.through.shine(self, wavelength, line, weight);
        }
    }
}

/// Number of rays that are processed together.
pub(super) const CHUNK: usize = SIDE_BY_SIDE;

/// The results for a chunk of rays: their lines over the picture, what they meet, its colors, and the light from behind.
pub(super) struct Looked {
    pub lines: Lines,
    pub hits: [Option<Hit>; CHUNK],
    pub colors: [[f32; 3]; CHUNK],
    through: Through,
}

/// The rays of a chunk that pass through mixed pixels: their indices, the colors behind, and the weights for these.
struct Through {
    len: usize,
    ray: [u8; CHUNK],
    colors: [[f32; 3]; CHUNK],
    weight: [f64; CHUNK],
}

impl Through {
    /// Adds to the weights of the rays the light that passes through the mixed pixels from behind.
    fn shine(&mut self, deep: &DeepPicture, wavelength_nm: &[f64], line: &[u32], weight: &mut [f64]) {
        if self.len == 0 {
            return;
        }
        let (mut wavelengths, mut lines) = ([0.0; CHUNK], [0; CHUNK]);
        for (k, ray) in self.ray[..self.len].iter().enumerate() {
            (wavelengths[k], lines[k]) = (wavelength_nm[usize::from(*ray)], line[usize::from(*ray)]);
        }
        let own = &mut self.weight[..self.len];
        deep.map.model.evaluate(&self.colors[..own.len()], &wavelengths[..own.len()], &lines[..own.len()], own);
        self.ray.iter().zip(&*own).for_each(|(ray, own)| weight[usize::from(*ray)] += own);
    }
}

impl Looked {
    pub(super) fn new() -> Self {
        let through = Through { len: 0, ray: [0; CHUNK], colors: [[0.0; 3]; CHUNK], weight: [0.0; CHUNK] };
        Self { lines: Lines::new(), hits: [None; CHUNK], colors: [[0.0; 3]; CHUNK], through }
    }

    /// Finds what the rays meet that have not ended.
    #[inline(always)]
    pub(super) fn look(&mut self, deep: &DeepPicture, [x, y, z]: [&[f64]; 3], [l, m, n]: [&[f64]; 3], state: &[u64]) {
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

    /// Finds the light that ray `i` gets through a mixed pixel, with this weight.
    fn look_through(&mut self, deep: &DeepPicture, i: usize, weight: f64) {
        let Some(behind) = &deep.behind else { return };
        let Some(hit) = behind.field.hit(&self.lines.line(i)) else { return };
        let (color, share) = deep.color_behind(behind, &hit);
        let through = &mut self.through;
        let k = through.len;
        (through.ray[k], through.colors[k], through.weight[k]) = (i as u8, color, weight * f64::from(share));
        through.len += 1;
    }
}

/// A job that finds what a chunk of rays from the lens meets.
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
        looked.through.len = 0;
        for i in 0..weight.len() {
            let mut share = 1.0;
            looked.colors[i] = [0.0; 3];
            // A ray that misses the picture gets no light.
            if let Some(hit) = &looked.hits[i] {
                (looked.colors[i], share) = deep.color(hit);
                let opacity = deep.opacity(hit);
                if opacity < 1.0 {
                    let passes = deep.map.scale * f64::from(1.0 - opacity) * weight[i];
                    looked.look_through(deep, i, passes);
                    share *= opacity;
                }
            }
            weight[i] *= deep.map.scale * f64::from(share);
        }
    }
}
