//! Spreads a frame by diffraction.
//!
//! Near its core, each pixel's light is spread by the opening as seen from its part of the frame, in zones that blend into each other.
//! Farther out, the spikes of bright pixels are drawn line by line to the edge of the frame; the pixels of a square of 48 x 48 share an
//! opening. The light that other pixels send there, and the light between spikes, is smooth and is spread on coarse cells. All light is
//! accounted for: it is spread, or counted as leaving the frame.
//!
//! **Borders.** The frame continues beyond its border as in a mirror, so that a gray frame stays gray. Lamps are not mirrored: a mirrored
//! lamp would send spikes in.

use crate::kernel::{fade, near_mm};
use crate::star::{Spike, Spikes, fading};
use crate::{ChannelLight, PixelSpread, Polygon, Wavefront, Wings};
use rayon::prelude::*;
use spectra_core::frame::FrameSize;
use spectra_numerics::convolve::Convolver;
use std::f64::consts::TAU;

/// Number of zones across the longer side of the frame.
const ZONES: usize = 4;
/// Smallest and largest radius (pixels) within which the light of a pixel is spread pixel by pixel.
const RADIUS: [usize; 2] = [48, 160];
/// Number of cells per radius for light that is spread smoothly.
const CELLS: usize = 8;
/// Side (pixels) of the squares whose bright pixels share the spikes of the middle of the square.
const SQUARE: usize = 48;
/// Smallest excess of a spike that is drawn, as a fraction of the median pixel.
const SEEN: f64 = 2e-3;
/// Smallest excess of a spike that is drawn, as a fraction of the brightest spike.
const OF_BRIGHTEST: f64 = 1e-4;
/// Largest number of pixels of a channel whose spikes are drawn.
const MOST: usize = 6000;

/// View of the lens from places of a frame. A place is a column and a row, in pixels from the upper left corner of the picture.
pub trait LensView: Sync {
    /// Returns the opening as seen from a place, in direction cosines; `None` if no opening is visible there.
    fn opening(&self, at: [f64; 2]) -> Option<Polygon>;

    /// Returns the wavefront over `opening`, the opening seen from the place `at`. `None` for a perfect lens, or if the wavefront
    /// is not known.
    fn wave(&self, at: [f64; 2], opening: &Polygon) -> Option<Wavefront>;
}

/// The view of a perfect lens, whose openings the closure returns.
impl<F: Fn([f64; 2]) -> Option<Polygon> + Sync> LensView for F {
    fn opening(&self, at: [f64; 2]) -> Option<Polygon> {
        self(at)
    }

    fn wave(&self, _: [f64; 2], _: &Polygon) -> Option<Wavefront> {
        None
    }
}

/// Summary of what diffraction did to one channel.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SpreadReport {
    /// Fraction of the channel's light that diffraction sends outside the frame.
    pub left: f64,
    /// Fraction of the light of a pixel in the middle of the frame that stays in that pixel.
    pub stays: f64,
    /// Number of pixels whose spikes were drawn.
    pub stars: usize,
}

/// Returns the largest fraction of a pixel's light that its star (its diffraction spikes) sends to a single pixel beyond the core
/// of the pattern. `None` if no opening is visible from the middle of the frame.
#[must_use]
pub fn star_of_pixel(size: FrameSize, light: &ChannelLight, seen: &dyn LensView) -> Option<f64> {
    let pitch_mm = [size.width_mm / f64::from(size.width_px), size.height_mm / f64::from(size.height_px)];
    let middle = seen.opening([0.5 * f64::from(size.width_px), 0.5 * f64::from(size.height_px)])?;
    let pitch = pitch_mm[0].min(pitch_mm[1]);
    let end = radius(near_mm(&middle, light), pitch) as f64 * pitch;
    Some(star_peak(&middle, light.mean_mm(), pitch_mm, end))
}

/// Whether two openings with their wavefronts spread light alike. Their shapes must agree within a thousandth of their size, wherever they
/// lie, and their wavefronts within a hundredth of a wavelength.
fn are_alike(a: &(Polygon, Option<Wavefront>), b: &(Polygon, Option<Wavefront>), mean_mm: f64) -> bool {
    let [(a, wave_a), (b, wave_b)] = [a, b];
    let size = b.reach();
    let about_center = |p: &Polygon| {
        let [[x0, y0], [x1, y1]] = p.bounds();
        let [x, y] = p.center();
        [x0 - x, y0 - y, x1 - x, y1 - y]
    };
    let near = |a: f64, b: f64, one: f64| (a - b).abs() < 1e-3 * one;
    let shapes = about_center(a).into_iter().zip(about_center(b)).all(|(a, b)| near(a, b, size))
        && near(a.reach(), b.reach(), size)
        && near(a.area(), b.area(), b.area());
    let (Some(wave_a), Some(wave_b)) = (wave_a, wave_b) else {
        return shapes && wave_a.is_some() == wave_b.is_some();
    };
    let [ca, cb] = [a.center(), b.center()];
    let places = b.rings().iter().flatten().flat_map(|[x, y]| [0.5, 1.0].map(|t| [t * x, t * y]));
    // Optical path of each wavefront relative to its own center.
    let path = |wave: &Wavefront, c: [f64; 2], p: [f64; 2]| wave.at([c[0] + p[0], c[1] + p[1]]).0 - wave.at(c).0;
    shapes && places.into_iter().all(|p| (path(wave_a, ca, p) - path(wave_b, cb, p)).abs() < 0.01 * mean_mm)
}

/// Returns the radius (pixels) within which light is spread pixel by pixel, if the pattern itself reaches `near_mm`.
fn radius(near_mm: f64, pitch_mm: f64) -> usize {
    ((near_mm / pitch_mm / 0.6).ceil() as usize + 2).clamp(RADIUS[0], RADIUS[1])
}

/// Returns the largest fraction of a pixel's light that its star brings to another pixel at a distance, at least that of a round opening.
fn star_peak(opening: &Polygon, mean_mm: f64, pitch_mm: [f64; 2], end_mm: f64) -> f64 {
    let wings = Wings::new(opening);
    let around = wings.fraction_beyond(end_mm, mean_mm) / (TAU * end_mm * end_mm) * pitch_mm[0] * pitch_mm[1];
    Spike::all(&wings, mean_mm, pitch_mm).iter().map(|spike| spike.peak(end_mm)).fold(around, f64::max)
}

fn median(plane: &[f32]) -> f32 {
    let mut sorted = plane.to_vec();
    let (_, median, _) = sorted.select_nth_unstable_by(plane.len() / 2, f32::total_cmp);
    *median
}

/// The kernels that spread one channel of a frame by diffraction.
pub struct Spread<'a> {
    size: FrameSize,
    pitch_mm: [f64; 2],
    seen: &'a dyn LensView,
    light: ChannelLight,
    radius: usize,
    middle: Polygon,
    /// Light that goes farther than the pixels around, cell by cell, as seen from the middle of the frame: all of it, and without spikes.
    cells: [Vec<f64>; 2],
    cell_px: usize,
    reach: [usize; 2],
    /// Part of this light beyond the reach of the cells: of all of it, and without spikes.
    beyond: [f64; 2],
    zones: [usize; 2],
    kernels: Vec<PixelSpread>,
}

/// Removes negative values and takes their sum off the rest, because a star darkens nothing. Kernels of lenses with aberrations are the
/// difference of two kernels. They become negative around their middle where the difference is not exact. Next to a sun the sky would
/// otherwise turn black.
fn lighten(light: &mut [f64]) {
    let (mut above, mut below) = (0.0, 0.0);
    light.iter().for_each(|v| *(if *v > 0.0 { &mut above } else { &mut below }) += v);
    let part = if above > 0.0 { f64::max((above + below) / above, 0.0) } else { 0.0 };
    light.iter_mut().for_each(|v| *v = part * v.max(0.0));
}

impl<'a> Spread<'a> {
    /// Prepares the spreading of a channel's light on a frame. `None` if no opening is visible from the middle of the frame.
    #[must_use]
    pub fn new(size: FrameSize, light: ChannelLight, seen: &'a dyn LensView) -> Option<Self> {
        let (width, height) = (size.width_px as usize, size.height_px as usize);
        let pitch_mm = [size.width_mm / width as f64, size.height_mm / height as f64];
        let middle = seen.opening([0.5 * width as f64, 0.5 * height as f64])?;
        let longer = width.max(height) as f64;
        let zones = [width, height].map(|side| ((ZONES as f64 * side as f64 / longer).round() as usize).max(1));
        let node = |k: usize| {
            let [i, j] = [k % (zones[0] + 1), k / (zones[0] + 1)];
            let at = [width as f64 * i as f64 / zones[0] as f64, height as f64 * j as f64 / zones[1] as f64];
            let opening = seen.opening(at).unwrap_or_else(|| middle.clone());
            let wave = seen.wave(at, &opening);
            (opening, wave)
        };
        let count = (zones[0] + 1) * (zones[1] + 1);
        let mut openings: Vec<(Polygon, Option<Wavefront>)> = (0..count).into_par_iter().map(node).collect();
        // A small part of a frame sees the same opening everywhere: compute its kernel only once.
        let mut zones = zones;
        let center = openings.len() / 2;
        if openings.iter().all(|other| are_alike(other, &openings[center], light.mean_mm())) {
            openings = vec![openings.swap_remove(center)];
            zones = [0; 2];
        }
        let pitch = pitch_mm[0].min(pitch_mm[1]);
        let near = openings.iter().map(|(o, _)| near_mm(o, &light)).fold(0.0, f64::max);
        let radius = radius(near, pitch);
        let cell_px = (radius / CELLS).max(1);
        let reach = [width.div_ceil(cell_px), height.div_ceil(cell_px)];
        let mut own = Self {
            size,
            pitch_mm,
            seen,
            light,
            radius,
            middle,
            cells: [Vec::new(), Vec::new()],
            cell_px,
            reach,
            beyond: [0.0; 2],
            zones,
            kernels: Vec::new(),
        };
        let wings = Wings::new(&own.middle);
        own.cells = [false, true].map(|without| own.smooth(&wings, without));
        let (mean, end) = (own.light.mean_mm(), own.end_mm());
        let sums = own.cells.each_ref().map(|cells| cells.iter().sum::<f64>());
        let spikes: f64 = Spike::all(&wings, mean, pitch_mm).iter().map(|s| s.light(end)).sum();
        own.beyond[0] = (wings.fraction_beyond(1.0, mean) * fading(end) - sums[0]).max(0.0);
        own.beyond[1] = (wings.fraction_beyond(1.0, mean) * fading(end) - spikes - sums[1]).max(0.0);
        let elsewhere = sums[0] + own.beyond[0];
        own.kernels = openings
            .par_iter()
            .map(|(opening, wave)| {
                let kernel = PixelSpread::new(opening, &own.light, pitch_mm, radius, elsewhere);
                match wave {
                    Some(wave) => kernel.with_wave(opening, wave, &own.light, pitch_mm),
                    None => kernel,
                }
            })
            .collect();
        Some(own)
    }

    /// Returns the distance at which light has left the pixels around, mm.
    fn end_mm(&self) -> f64 {
        self.radius as f64 * self.pitch_mm[0].min(self.pitch_mm[1])
    }

    /// Computes the light that goes farther than the pixels around, cell by cell. With `without_boxes`, only the part of spikes beside
    /// their boxes is included.
    fn smooth(&self, wings: &Wings, without_boxes: bool) -> Vec<f64> {
        let [across, down] = self.reach.map(|r| r as isize);
        let side = self.pitch_mm.map(|p| p * self.cell_px as f64);
        let (end, colors, mean) = (self.end_mm(), self.light.coarse(), [[self.light.mean_mm(), 1.0]]);
        let row = |j: isize| -> Vec<f64> {
            let cell = |i: isize| -> f64 {
                let at = [-(i as f64) * side[0], j as f64 * side[1]];
                let r = (at[0] * at[0] + at[1] * at[1]).sqrt();
                let diagonal = (side[0] * side[0] + side[1] * side[1]).sqrt();
                if r + diagonal < 0.6 * end {
                    return 0.0;
                }
                // Near the middle a cell is too large for a single sample.
                let (parts, colors): (usize, _) = if r < 3.0 * end { (4, &colors[..]) } else { (1, &mean[..]) };
                let mut sum = 0.0;
                for k in 0..parts * parts {
                    let place = |n: usize, side: f64| ((n as f64 + 0.5) / parts as f64 - 0.5) * side;
                    let p = [at[0] + place(k % parts, side[0]), at[1] + place(k / parts, side[1])];
                    let half = side.map(|s| 0.5 * s / parts as f64);
                    let faded = fade((p[0] * p[0] + p[1] * p[1]).sqrt(), end);
                    if faded > 0.0 {
                        let of = |[mm, share]: &[f64; 2]| share * wings.intensity(p, half, *mm, without_boxes);
                        sum += faded * colors.iter().map(of).sum::<f64>();
                    }
                }
                let light = sum * side[0] * side[1] / (parts * parts) as f64;
                if without_boxes { light.max(0.0) } else { light }
            };
            (-across..across + 1).map(cell).collect()
        };
        // The light is the same at opposite places.
        let lower: Vec<f64> = (0..down + 1).into_par_iter().flat_map_iter(row).collect();
        let line = 2 * across as usize + 1;
        lower[line..].iter().rev().chain(&lower).copied().collect()
    }

    /// Spreads a plane of exposures, one value per pixel, by diffraction, in place.
    ///
    /// # Panics
    /// Panics if the plane does not have the size of the frame.
    pub fn apply(&self, plane: &mut [f32]) -> SpreadReport {
        let (width, height) = (self.size.width_px as usize, self.size.height_px as usize);
        assert_eq!(plane.len(), width * height, "the plane has the frame's size");
        let before: f64 = plane.iter().map(|v| f64::from(*v)).sum();
        // No light, or too much for a finite number.
        if !(before > 0.0 && before.is_finite()) {
            return SpreadReport::default();
        }
        let bright = self.bright(plane);
        let mut rest = plane.to_vec();
        let mut stars = vec![0.0_f32; rest.len()];
        for at in &bright {
            std::mem::swap(&mut rest[*at], &mut stars[*at]);
        }
        let mut spread = self.cores(&rest, &bright);
        self.cells(&rest, true, &self.cells[0], &mut spread);
        if !bright.is_empty() {
            let mut of_stars = self.cores(&stars, &bright);
            self.stars(plane, &bright, &mut of_stars);
            self.cells(&stars, false, &self.cells[1], &mut of_stars);
            lighten(&mut of_stars);
            spread.par_iter_mut().zip(&of_stars).for_each(|(to, star)| *to += star);
        }
        plane.par_iter_mut().zip(&spread).for_each(|(to, v)| *to = v.max(0.0) as f32);
        let after: f64 = spread.iter().sum();
        let center = self.kernels.len() / 2;
        let stays = self.kernels.get(center).map_or(1.0, |kernel| kernel.weight(0, 0));
        SpreadReport { left: 1.0 - after / before, stays, stars: bright.len() }
    }

    /// Returns the pixels whose spikes are drawn.
    fn bright(&self, plane: &[f32]) -> Vec<usize> {
        let peak = star_peak(&self.middle, self.light.mean_mm(), self.pitch_mm, self.end_mm());
        let brightest = plane.iter().fold(0.0_f32, |a, b| a.max(*b));
        if peak <= 0.0 {
            return Vec::new();
        }
        let mut least = (SEEN * f64::from(median(plane)) / peak).max(OF_BRIGHTEST * f64::from(brightest)) as f32;
        let mut above: Vec<f32> = plane.iter().copied().filter(|v| *v > least).collect();
        if above.len() > MOST {
            let (_, next, _) = above.select_nth_unstable_by(MOST, |a, b| b.total_cmp(a));
            least = *next;
        }
        (0..plane.len()).filter(|at| plane[*at] > least).collect()
    }

    /// Spreads the cores of all pixels. The frame is continued beyond its edges by mirroring, except for stars, so that as much light comes
    /// in as leaves.
    fn cores(&self, plane: &[f32], bright: &[usize]) -> Vec<f64> {
        let (width, height) = (self.size.width_px as usize, self.size.height_px as usize);
        let r = self.radius;
        let mut is_star = vec![false; plane.len()];
        bright.iter().for_each(|at| is_star[*at] = true);
        let mut spread = vec![0.0; plane.len()];
        for (at, kernel) in self.kernels.iter().enumerate() {
            let node = [at % (self.zones[0] + 1), at / (self.zones[0] + 1)];
            // Returns the first and last pixel with a share in this zone, including a margin beyond the frame.
            let span = |k: usize, side: usize| -> [isize; 2] {
                let (zones, node) = (self.zones[k], node[k]);
                let place = |n: usize| side as f64 * n as f64 / zones as f64;
                let first = if node == 0 { -(r as isize) } else { place(node - 1).floor() as isize };
                let last = if node == zones { (side + r) as isize } else { place(node + 1).ceil() as isize };
                [first, last]
            };
            let [xs, ys] = [span(0, width), span(1, height)];
            let share = |k: usize, at: isize, side: usize| {
                let p = (at as f64 + 0.5).clamp(0.0, side as f64) * self.zones[k] as f64 / side as f64;
                (1.0 - (p - node[k] as f64).abs()).max(0.0)
            };
            // The buffer has room for light that is spread beyond the zone.
            let (w, h) = ((xs[1] - xs[0]) as usize + 2 * r, (ys[1] - ys[0]) as usize + 2 * r);
            let mut part = vec![0.0_f32; w * h];
            let columns: Vec<(usize, bool, f64)> = (xs[0]..xs[1])
                .map(|x| (mirrored(x, width), x >= 0 && x < width as isize, share(0, x, width)))
                .collect();
            part.par_chunks_mut(w).enumerate().skip(r).take(h - 2 * r).for_each(|(row, line)| {
                let y = ys[0] + (row - r) as isize;
                let (from, inside, share) =
                    (mirrored(y, height) * width, y >= 0 && y < height as isize, share(1, y, height));
                for (to, (column, within, own)) in line[r..].iter_mut().zip(&columns) {
                    let at = from + column;
                    if (inside && *within) || !is_star[at] {
                        *to = (f64::from(plane[at]) * share * own) as f32;
                    }
                }
            });
            let mut light = vec![0.0_f32; w * h];
            Convolver::<f64>::of(r, |i, j| kernel.weight(i, j), w, h).apply(&part, &mut light, |to, v| *to = v as f32);
            let origin = [xs[0] - r as isize, ys[0] - r as isize];
            spread.par_chunks_mut(width).enumerate().for_each(|(y, to)| {
                let Some(row) = usize::try_from(y as isize - origin[1]).ok().filter(|row| *row < h) else { return };
                for (x, to) in to.iter_mut().enumerate() {
                    if let Some(column) = usize::try_from(x as isize - origin[0]).ok().filter(|column| *column < w) {
                        *to += f64::from(light[row * w + column]);
                    }
                }
            });
        }
        spread
    }

    /// Draws the spikes of bright pixels, and corrects the pixels themselves for what their spikes hold more or less than others.
    fn stars(&self, plane: &[f32], bright: &[usize], spread: &mut [f64]) {
        if bright.is_empty() {
            return;
        }
        let (width, height) = (self.size.width_px as usize, self.size.height_px as usize);
        let across = width.div_ceil(SQUARE);
        let square = |at: usize| at / width / SQUARE * across + at % width / SQUARE;
        let mut squares: Vec<usize> = bright.iter().map(|at| square(*at)).collect();
        squares.sort_unstable();
        squares.dedup();
        let (mean, end) = (self.light.mean_mm(), self.end_mm());
        let of_square = |k: &usize| {
            let at = [k % across, k / across].map(|n| (n as f64 + 0.5) * SQUARE as f64);
            let seen = self.seen.opening([at[0].min(width as f64), at[1].min(height as f64)]);
            let wings = Wings::new(&seen.unwrap_or_else(|| self.middle.clone()));
            Spike::all(&wings, mean, self.pitch_mm)
        };
        let known: Vec<Vec<Spike>> = squares.par_iter().map(of_square).collect();
        let usual: f64 = self.cells[0].iter().sum::<f64>() + self.beyond[0];
        let between: f64 = self.cells[1].iter().sum::<f64>() + self.beyond[1];
        let mut spikes = Spikes::new(width, height);
        for at in bright {
            let Ok(own) = squares.binary_search(&square(*at)) else { continue };
            let light = f64::from(plane[*at]);
            let mut taken = between;
            for spike in &known[own] {
                spikes.add(spike, at % width, at / width, light, end);
                taken += spike.light(end);
            }
            spread[*at] += light * (usual - taken);
        }
        spikes.add_to(spread);
    }

    /// Spreads a plane by cells with the given weights, for light that goes farther than the pixels around. Beyond the frame lies its
    /// mirror image, or nothing.
    fn cells(&self, plane: &[f32], mirror: bool, weights: &[f64], spread: &mut [f64]) {
        let (width, height) = (self.size.width_px as usize, self.size.height_px as usize);
        let cell = self.cell_px;
        let [across, down] = self.reach;
        // The frame of cells has a margin as wide as their reach.
        let (w, h) = (3 * across + 4, 3 * down + 4);
        let first = [across as isize + 2, down as isize + 2];
        let place = |at: isize, k: usize| {
            let p = (at as f64 + 0.5) / cell as f64 - 0.5 + first[k] as f64;
            let low = p.floor();
            (low, p - low)
        };
        let mut sums = vec![0.0_f64; w * h];
        let margin = if mirror { [(across * cell) as isize, (down * cell) as isize] } else { [0; 2] };
        let columns: Vec<(usize, f64, usize)> = (-margin[0]..width as isize + margin[0])
            .map(|x| {
                let (low, part) = place(x, 0);
                (low.max(0.0) as usize, part, mirrored(x, width))
            })
            .collect();
        for y in -margin[1]..height as isize + margin[1] {
            let (low, part) = place(y, 1);
            let from = mirrored(y, height) * width;
            for (row, share) in [(low.max(0.0) as usize, 1.0 - part), (low.max(0.0) as usize + 1, part)] {
                if row >= h {
                    continue;
                }
                let line = &mut sums[row * w..][..w];
                for (column, right, at) in &columns {
                    let light = f64::from(plane[from + at]) * share;
                    if column + 1 < w {
                        line[*column] += light * (1.0 - right);
                        line[column + 1] += light * right;
                    }
                }
            }
        }
        let cells: Vec<f32> = sums.iter().map(|v| *v as f32).collect();
        let mut light = vec![0.0_f32; cells.len()];
        let radius = across.max(down);
        let weight = |i: isize, j: isize| {
            let (i, j) = (i + across as isize, j + down as isize);
            let inside = i >= 0 && j >= 0 && i <= 2 * across as isize && j <= 2 * down as isize;
            if inside { weights[j as usize * (2 * across + 1) + i as usize] } else { 0.0 }
        };
        Convolver::<f64>::of(radius, weight, w, h).apply(&cells, &mut light, |to, v| *to = v as f32);
        let per_pixel = 1.0 / (cell * cell) as f64;
        spread.par_chunks_mut(width).enumerate().for_each(|(y, line)| {
            let (row, down) = place(y as isize, 1);
            let row = row as usize;
            for (x, to) in line.iter_mut().enumerate() {
                let (column, right) = place(x as isize, 0);
                let at = |k: usize| f64::from(light[k]);
                let k = row * w + column as usize;
                let upper = at(k) + (at(k + 1) - at(k)) * right;
                let lower = at(k + w) + (at(k + w + 1) - at(k + w)) * right;
                *to += (upper + (lower - upper) * down) * per_pixel;
            }
        });
    }
}

/// Returns the pixel of a frame that a mirror at its border shows at a place.
fn mirrored(at: isize, side: usize) -> usize {
    let side = side as isize;
    let at = at.rem_euclid(2 * side);
    (if at < side { at } else { 2 * side - 1 - at }) as usize
}
