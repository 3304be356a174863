//! A picture in linear light as a texture: smooth between pixels, with rays drawn where it is bright.

use crate::frame::Edge;
use crate::picture::lights::Lights;
use crate::picture::pixel_quad::{PixelQuad, along, tent};
use crate::plane_source::{Places, Texture};
use crate::split_source::LightPart;
use spectra_core::isa::{Isa, Vectorized};
use spectra_core::spectral::SpectralPower;
use spectra_core::stage::ColorModel;
use std::hint::black_box;
use std::ops::Range;
use std::sync::Arc;

/// A picture on its plane. Copies share the pixels.
#[derive(Clone)]
pub(crate) struct PictureTexture {
    pub width_px: usize,
    pub height_px: usize,
    pub width_mm: f64,
    pub height_mm: f64,
    /// Coefficients of the color model for each pixel.
    pub coefficients: Arc<Vec<[f32; 3]>>,
    pub model: Arc<dyn ColorModel>,
    /// Radiance, W m^-2 sr^-1 nm^-1, per unit of the model's spectra.
    pub scale: f64,
    pub mean: SpectralPower,
    pub peak_over_mean: f64,
    pub importance: Arc<Importance>,
    /// Whether all light comes from single pixels surrounded by black.
    pub is_lamps: bool,
    /// Bright pixels of the picture, if there are any.
    pub lights: Option<Arc<Lights>>,
    /// Part of the picture's light that this copy represents.
    pub half: LightPart,
    pub name: String,
    /// Light beyond the border of the picture.
    pub edge: Edge,
}

impl PictureTexture {
    /// Returns the column and row of a point, in pixels from the upper left, as if the picture continued without end.
    #[inline(always)]
    fn unfolded(&self, x_mm: f64, y_mm: f64) -> [f64; 2] {
        let column = (x_mm / self.width_mm + 0.5) * self.width_px as f64;
        let row = (0.5 - y_mm / self.height_mm) * self.height_px as f64;
        [column, row]
    }

    /// Maps a column and row, which may lie outside the picture, into it according to the picture's edge. `None` if there is no
    /// light there.
    #[inline]
    fn folded(&self, [column, row]: [f64; 2]) -> Option<[f64; 2]> {
        Some([self.edge.place(column, self.width_px as f64)?, self.edge.place(row, self.height_px as f64)?])
    }

    /// Returns the column and row of a point of the plane (mm), in pixels from the upper left. `None` if there is no light there.
    pub(crate) fn place(&self, x_mm: f64, y_mm: f64) -> Option<[f64; 2]> {
        self.folded(self.unfolded(x_mm, y_mm))
    }

    /// Loads pixels into the cache ahead of their use: the upper left and the lower right one of each point in `rays`.
    #[inline(always)]
    fn look_ahead(&self, looked: &Looked, rays: Range<usize>) {
        let ([across, down], last) = (&looked.pixel, self.coefficients.len() - 1);
        let mut all = 0;
        for i in rays {
            let first = down[i] as usize * self.width_px + across[i] as usize;
            let beyond = (first + self.width_px + 1).min(last);
            all |= self.coefficients[first][0].to_bits() | self.coefficients[beyond][2].to_bits();
        }
        black_box(all);
    }

    /// Returns the coefficients at point `i`, and the fraction of the light there that this copy represents.
    #[inline(always)]
    fn looked(&self, looked: &Looked, i: usize) -> ([f32; 3], f32) {
        let place = looked.place.each_ref().map(|each| each[i]);
        let size = [self.width_px, self.height_px];
        if place.iter().zip(size).all(|(at, size)| *at >= 0.0 && *at <= size as f64) {
            let (pixel, part) =
                (looked.pixel.each_ref().map(|each| each[i]), looked.part.each_ref().map(|each| each[i]));
            return self.color(&PixelQuad::beside(pixel, part, size));
        }
        self.folded(place).map(|place| self.color(&self.spot(place))).unwrap_or_default()
    }

    /// Returns the four pixels around a point of the picture. Beyond the outermost centers these are the pixels at the rim.
    #[inline(always)]
    pub(crate) fn spot(&self, place: [f64; 2]) -> PixelQuad {
        PixelQuad::of(place, [self.width_px, self.height_px])
    }

    /// Draws a point with light. Returns its column and row (pixels, fractional), and the inverse of its density relative to a uniform
    /// one.
    pub(crate) fn draw_place(&self, u: f64, v: f64) -> (f64, f64, f64) {
        match (&self.lights, self.half) {
            (Some(lights), LightPart::Lights) => lights.places.draw(u, v),
            _ => self.importance.draw(u, v),
        }
    }

    /// Returns the coefficients at a spot, linear between the centers of pixels and constant beyond the outermost ones. Also returns the
    /// fraction of the light there that this copy represents.
    #[inline(always)]
    pub(crate) fn color(&self, spot: &PixelQuad) -> ([f32; 3], f32) {
        let (all, [a, b, d, e]) = (&self.coefficients[..], spot.cells());
        let color = spot.between([all[a], all[b], all[d], all[e]]);
        // Most spots touch no light.
        let share = match (self.half, &self.lights) {
            (LightPart::Whole, _) => 1.0,
            (LightPart::Rest, Some(lights)) if !lights.touched[a] => 1.0,
            (LightPart::Lights, Some(lights)) if !lights.touched[a] => 0.0,
            _ => self.share(spot, |cell| cell),
        };
        (color, share)
    }

    /// Returns whether a pixel is one of the lights.
    #[inline]
    pub(crate) fn is_light(&self, cell: usize) -> bool {
        self.lights.as_ref().and_then(|lights| lights.level.get(cell)).is_some_and(|level| *level > 0.0)
    }

    /// Returns the fraction of the light at a spot that this copy represents. `of` gives, for each of the four pixels, the pixel whose
    /// light is used there.
    #[inline]
    pub(crate) fn share(&self, spot: &PixelQuad, of: impl Fn(usize) -> usize) -> f32 {
        let of_lights = || {
            let lights = self.lights.as_ref().map_or(&[][..], |lights| &lights.level);
            spot.mix(|cell| [f32::from(u8::from(lights.get(of(cell)).is_some_and(|level| *level > 0.0)))])[0]
        };
        match self.half {
            LightPart::Whole => 1.0,
            LightPart::Nothing => 0.0,
            LightPart::Lights => of_lights(),
            LightPart::Rest => 1.0 - of_lights(),
        }
    }

    /// Returns a copy that represents one half of the light.
    pub(crate) fn half(&self, half: LightPart) -> Self {
        let (half, number) = match (&self.lights, half) {
            (Some(_), LightPart::Lights) => (half, 0),
            (Some(_), LightPart::Rest) => (half, 1),
            (None, LightPart::Lights | LightPart::Nothing) => {
                return Self {
                    half: LightPart::Nothing,
                    mean: self.mean.scaled(0.0),
                    peak_over_mean: 1.0,
                    ..self.clone()
                };
            }
            _ => return self.clone(),
        };
        let Some(lights) = &self.lights else { return self.clone() };
        Self { half, mean: lights.mean[number].clone(), peak_over_mean: lights.peak_over_mean[number], ..self.clone() }
    }
}

impl Texture for PictureTexture {
    fn shine(&self, at: Places<'_>, weight: &mut [f64], isa: Isa) {
        let (mut looked, mut colors) = (Looked::new(), [[0.0_f32; 3]; CHUNK]);
        for start in (0..weight.len()).step_by(CHUNK) {
            let end = (start + CHUNK).min(weight.len());
            let (x_mm, y_mm, weight) = (&at.x_mm[start..end], &at.y_mm[start..end], &mut weight[start..end]);
            isa.run(Look { map: self, x_mm, y_mm, looked: &mut looked });
            for first in (0..weight.len()).step_by(AHEAD) {
                let rays = first..(first + AHEAD).min(weight.len());
                self.look_ahead(&looked, rays.clone());
                for i in rays {
                    let (color, share) = self.looked(&looked, i);
                    weight[i] *= self.scale * f64::from(share);
                    colors[i] = color;
                }
            }
            let (wavelength, line) = (&at.wavelength_nm[start..end], &at.line[start..end]);
            self.model.evaluate(&colors[..end - start], wavelength, line, weight);
        }
    }

    fn draw(&self, u: f64, v: f64) -> (f64, f64, f64) {
        self.drawn(self.draw_place(u, v))
    }

    fn spots_mm(&self) -> Option<[f64; 2]> {
        let pixel_mm = [self.width_mm / self.width_px as f64, self.height_mm / self.height_px as f64];
        (self.is_lamps && self.half == LightPart::Whole).then_some(pixel_mm)
    }

    fn draw_middle(&self, u: f64, v: f64) -> (f64, f64, f64) {
        self.drawn(self.importance.draw_middle(u, v))
    }

    fn is_bounded(&self) -> bool {
        self.edge == Edge::Black
    }

    fn spectrum(&self) -> &SpectralPower {
        &self.mean
    }

    fn peak_over_mean(&self) -> f64 {
        self.peak_over_mean
    }

    fn describe(&self) -> String {
        format!(
            "picture {} ({} x {} pixels, {:.1} x {:.1} mm)",
            self.name, self.width_px, self.height_px, self.width_mm, self.height_mm
        )
    }
}

impl PictureTexture {
    /// Converts a drawn point: returns its position on the plane (mm) and the area that it represents (mm^2).
    fn drawn(&self, (column, row, inverse): (f64, f64, f64)) -> (f64, f64, f64) {
        let x = (column / self.width_px as f64 - 0.5) * self.width_mm;
        let y = (0.5 - row / self.height_px as f64) * self.height_mm;
        (x, y, inverse * self.width_mm * self.height_mm)
    }
}

/// Number of rays whose pixels are loaded ahead. In a large picture each load would otherwise be waited for.
const AHEAD: usize = 32;
/// Number of rays that are processed together.
const CHUNK: usize = 256;
type Each<T> = [T; CHUNK];

/// Positions of the points of a chunk among the pixels.
struct Looked {
    /// Column and row of each point, pixels from the upper left.
    place: [Each<f64>; 2],
    /// Column and row of the pixel at the upper left of each point.
    pixel: [Each<u32>; 2],
    /// Distance of each point from the center of that pixel, as a fraction of the distance to the next ones.
    part: [Each<f32>; 2],
}

impl Looked {
    fn new() -> Self {
        Self { place: [[0.0; CHUNK]; 2], pixel: [[0; CHUNK]; 2], part: [[0.0; CHUNK]; 2] }
    }
}

/// A job that locates up to [`CHUNK`] points among the pixels, as [`PictureTexture::spot`] does for one.
struct Look<'a> {
    map: &'a PictureTexture,
    x_mm: &'a [f64],
    y_mm: &'a [f64],
    looked: &'a mut Looked,
}

impl Vectorized for Look<'_> {
    type Output = ();
    #[inline(always)]
    fn run(self) {
        let Self { map, x_mm, y_mm, looked } = self;
        let len = x_mm.len().min(CHUNK);
        let (x_mm, y_mm) = (&x_mm[..len], &y_mm[..len]);
        let [columns, rows] = &mut looked.place;
        let ([across, down], [right, below]) = (&mut looked.pixel, &mut looked.part);
        for i in 0..len {
            let [column, row] = map.unfolded(x_mm[i], y_mm[i]);
            (columns[i], rows[i]) = (column, row);
            (across[i], right[i]) = along(column, map.width_px);
            (down[i], below[i]) = along(row, map.height_px);
        }
    }
}

/// Largest number of cells of an [`Importance`]. In a larger picture a cell contains several pixels.
const MAX_CELLS: usize = 1 << 22;

/// Importance sampling of a picture: draws points in proportion to light, first the row, then the column. The mapping is monotone from
/// cell to cell, so strata stay strata.
///
/// Light is linear between the centers of cells. This is a sum of tents, one over each cell, whose height is the cell's brightness.
/// A cell is drawn by its weight, and a point under its tent, so the density is linear between cells like the light. A ray from a lamp
/// of one cell therefore carries the same light wherever on the lamp it starts.
pub(crate) struct Importance {
    /// Number of pixels of the picture, across and down.
    size_px: [f64; 2],
    /// Number of pixels along a side of a cell.
    cell_px: f64,
    rows: Cumulative,
    columns: Vec<Cumulative>,
}

impl Importance {
    /// Creates the sampling from the brightness of each pixel.
    pub(super) fn new(width: usize, height: usize, brightness: impl Fn(usize) -> f32) -> Self {
        let mut cell = 1;
        while width.div_ceil(cell) * height.div_ceil(cell) > MAX_CELLS {
            cell += 1;
        }
        let cells = [width.div_ceil(cell), height.div_ceil(cell)];
        let mut sums = vec![0.0_f32; cells[0] * cells[1]];
        for i in 0..width * height {
            sums[i / width / cell * cells[0] + i % width / cell] += brightness(i);
        }
        let size_px = [width as f64, height as f64];
        Self { size_px, cell_px: cell as f64, ..Self::of_cells(cells, &sums) }
    }

    /// Creates the sampling from the brightness of each cell. Half of the weight is proportional to brightness. The other half is the
    /// same for all cells with light, so that dark parts get rays, too.
    fn of_cells([width, height]: [usize; 2], brightness: &[f32]) -> Self {
        let lit = brightness.iter().filter(|cell| **cell > 0.0).count();
        let all = brightness.iter().map(|cell| f64::from(cell.max(0.0))).sum::<f64>();
        let even = if lit > 0 { all / lit as f64 } else { 0.0 };
        let mut columns = Vec::with_capacity(height);
        let mut sums = Vec::with_capacity(height);
        let mut line = vec![0.0_f64; width];
        for row in brightness.chunks_exact(width) {
            for (cell, bright) in line.iter_mut().zip(row) {
                *cell = if *bright > 0.0 { f64::from(*bright) + even } else { 0.0 };
            }
            sums.push(line.iter().sum());
            columns.push(Cumulative::new(&line));
        }
        Self { size_px: [width as f64, height as f64], cell_px: 1.0, rows: Cumulative::new(&sums), columns }
    }

    /// Draws a point. Returns its column and row (pixels, fractional), and the inverse of its density relative to a uniform one.
    pub(crate) fn draw(&self, u: f64, v: f64) -> (f64, f64, f64) {
        self.place(u, v, tent)
    }

    /// Draws a point as [`Importance::draw`] does, but at the center of a cell.
    pub(crate) fn draw_middle(&self, u: f64, v: f64) -> (f64, f64, f64) {
        self.place(u, v, |cell, _, _| cell as f64 + 0.5)
    }

    #[inline(always)]
    fn place(&self, u: f64, v: f64, under: impl Fn(usize, f64, usize) -> f64) -> (f64, f64, f64) {
        let cells = [self.columns[0].cells(), self.columns.len()];
        let (row, down) = self.rows.draw(v);
        let (column, across) = self.columns[row].draw(u);
        let place = [under(column, across, cells[0]), under(row, down, cells[1])];
        let density = PixelQuad::of(place, cells).mix(|cell| {
            let (column, row) = (cell % cells[0], cell / cells[0]);
            [(self.rows.mass(row) * self.columns[row].mass(column)) as f32]
        });
        // Cells at the right and lower rim may extend beyond the picture, where there is no light. Densities refer to whole cells.
        let share = self.cell_px * self.cell_px / (self.size_px[0] * self.size_px[1]);
        (place[0] * self.cell_px, place[1] * self.cell_px, share / f64::from(density[0]))
    }
}

/// Returns whether all light of a picture of this width comes from single pixels surrounded by black, none of them at the rim.
pub(super) fn are_lamps(width: usize, brightness: impl Fn(usize) -> f32, pixels: usize) -> bool {
    let height = pixels / width;
    let is_lamp = |cell: usize| {
        let (column, row) = (cell % width, cell / width);
        let inside = column > 0 && row > 0 && column + 1 < width && row + 1 < height;
        let dark = |at: usize| at == cell || brightness(at) == 0.0;
        inside && (row - 1..=row + 1).all(|r| (column - 1..=column + 1).all(|c| dark(r * width + c)))
    };
    pixels <= MAX_CELLS && (0..pixels).all(|cell| brightness(cell) == 0.0 || is_lamp(cell))
}

/// A piecewise constant density over cells of width 1, stored as cumulative sums with a guide table.
struct Cumulative {
    sums: Vec<f32>,
    /// Guide table: [0, 1) is divided into as many equal parts as there are cells. Each entry is the cell at the lower end of its part,
    /// where a search starts.
    guide: Vec<u16>,
}

impl Cumulative {
    fn new(weights: &[f64]) -> Self {
        // Every cell with light gets at least a little of the mean, or single precision could lose it.
        let floor = 1e-4 * weights.iter().sum::<f64>() / weights.len() as f64;
        let weights: Vec<f64> = weights.iter().map(|w| if *w > 0.0 { w + floor } else { 0.0 }).collect();
        let total: f64 = weights.iter().sum();
        let mut sum = 0.0;
        let mut sums = Vec::with_capacity(weights.len() + 1);
        sums.push(0.0);
        for (i, w) in weights.iter().enumerate() {
            // A dark row is never drawn, but its sums must be valid.
            sum += if total > 0.0 { w / total } else { 1.0 / weights.len() as f64 };
            sums.push(if i + 1 == weights.len() { 1.0 } else { (sum as f32).min(1.0) });
        }
        let mut guide = Vec::with_capacity(weights.len());
        let mut cell = 0;
        for part in 0..weights.len() {
            let from = part as f64 / weights.len() as f64;
            while cell + 1 < weights.len() && f64::from(sums[cell + 1]) <= from {
                cell += 1;
            }
            guide.push(cell as u16); // the sides of a picture have at most 65 535 pixels
        }
        Self { sums, guide }
    }

    fn cells(&self) -> usize {
        self.sums.len() - 1
    }

    /// Returns the probability of a cell.
    #[inline(always)]
    fn mass(&self, cell: usize) -> f64 {
        f64::from(self.sums[cell + 1]) - f64::from(self.sums[cell])
    }

    /// Draws a cell with `u`. Also returns the position of `u` within the cell's interval, rescaled to 0 to 1.
    fn draw(&self, u: f64) -> (usize, f64) {
        let cells = self.sums.len() - 1;
        let mut cell = usize::from(self.guide[((u * cells as f64) as usize).min(cells - 1)]);
        while cell + 1 < cells && f64::from(self.sums[cell + 1]) <= u {
            cell += 1;
        }
        let (from, mass) = (f64::from(self.sums[cell]), self.mass(cell));
        (cell, if mass > 0.0 { ((u - from) / mass).clamp(0.0, 1.0) } else { 0.5 })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Drawing integrates any light over the picture without bias: the mean of f / density must be the mean of f over the pixels, even
    /// with dark rows and columns.
    #[test]
    fn importance_is_unbiased() {
        let (width, height) = (7, 5);
        let mut brightness = vec![0.0_f32; width * height];
        brightness[3] = 5.0;
        brightness[2 * width + 6] = 0.01;
        brightness[4 * width] = 1.0;
        let importance = Importance::new(width, height, |i| brightness[i]);
        let f = |column: f64, row: f64| {
            let spot = PixelQuad::of([column, row], [width, height]);
            f64::from(spot.mix(|cell| [brightness[cell].sqrt()])[0])
        };
        let n = 400;
        let mut sum = 0.0;
        for i in 0..n {
            for j in 0..n {
                let (column, row, inverse) =
                    importance.draw((f64::from(i) + 0.5) / f64::from(n), (f64::from(j) + 0.5) / f64::from(n));
                sum += f(column, row) * inverse;
            }
        }
        let mean = sum / f64::from(n * n);
        let want = brightness.iter().map(|b| f64::from(b.sqrt())).sum::<f64>() / (width * height) as f64;
        assert!((mean / want - 1.0).abs() < 0.01, "{mean} {want}");
    }

    /// A ray from a lamp of one pixel on black carries the same light wherever it starts, and no ray starts where there is no light. When
    /// rays were drawn evenly over the surrounding pixels, four of nine carried light, with four times the noise expected of their number.
    #[test]
    fn rays_from_a_lamp_of_one_pixel_carry_alike() {
        let (width, height) = (9, 7);
        let brightness = |cell: usize| if cell == 3 * width + 4 { 2.0_f32 } else { 0.0 };
        let importance = Importance::new(width, height, brightness);
        for k in 0..64 * 64 {
            let at = |k: usize| (k as f64 + 0.5) / 64.0;
            let (column, row, inverse) = importance.draw(at(k % 64), at(k / 64));
            let light = f64::from(PixelQuad::of([column, row], [width, height]).mix(|cell| [brightness(cell)])[0]);
            let mean = 2.0 / (width * height) as f64;
            assert!((light * inverse / mean - 1.0).abs() < 1e-5, "{column} {row}: {}", light * inverse);
        }
    }
}
