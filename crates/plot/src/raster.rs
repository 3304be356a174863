//! Rasterization of areas: scan lines with exact coverage along them.

use crate::color::Color;
use crate::geometry::{Point, Rect};
use crate::paint::Paint;

/// Number of scan lines in a row of pixels.
const LINES: usize = 16;

/// A canvas rendered to pixels.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Pixels {
    /// Width in pixels.
    pub width_px: u32,
    /// Height in pixels.
    pub height_px: u32,
    /// sRGB code values, row by row from the upper left.
    pub rgb: Vec<[u8; 3]>,
}

impl Pixels {
    /// Reduces the picture: each pixel is the mean of `by` by `by` pixels. A remainder at the right and lower edge is dropped.
    pub(crate) fn shrunk(&self, by: u32) -> Self {
        let (width_px, height_px) = ((self.width_px / by).max(1), (self.height_px / by).max(1));
        let mean = |i: u32| {
            let (column, row) = (i % width_px * by, i / width_px * by);
            let mut sum = [0_u32; 3];
            let mut count = 0;
            for r in row..(row + by).min(self.height_px) {
                for c in column..(column + by).min(self.width_px) {
                    let pixel = self.rgb[r as usize * self.width_px as usize + c as usize];
                    sum.iter_mut().zip(pixel).for_each(|(sum, v)| *sum += u32::from(v));
                    count += 1;
                }
            }
            sum.map(|v| ((v + count / 2) / count) as u8)
        };
        Self { width_px, height_px, rgb: (0..width_px * height_px).map(mean).collect() }
    }
}

/// A picture being drawn. Code values are kept as floats, so that many thin layers do not round away.
pub(crate) struct Raster {
    width: usize,
    height: usize,
    /// Number of pixels per canvas unit.
    scale: f64,
    rgb: Vec<[f32; 3]>,
}

impl Raster {
    pub(crate) fn new(width: f64, height: f64, scale: f64, background: Color) -> Self {
        let pixels = |length: f64| (length * scale).round_ties_even().max(1.0) as usize;
        let (width, height) = (pixels(width), pixels(height));
        Self { width, height, scale, rgb: vec![background.rgb.map(f32::from); width * height] }
    }

    /// Fills the polygons (wherever their winding number is not 0), within `clip`.
    pub(crate) fn fill(&mut self, polygons: &[Vec<Point>], paint: &Paint, clip: Option<Rect>) {
        self.put(polygons, paint, clip, false);
    }

    /// Adds light in the polygons, within `clip`.
    pub(crate) fn shine(&mut self, polygons: &[Vec<Point>], paint: &Paint, clip: Option<Rect>) {
        self.put(polygons, paint, clip, true);
    }

    fn put(&mut self, polygons: &[Vec<Point>], paint: &Paint, clip: Option<Rect>, light: bool) {
        let scale = self.scale;
        let whole = Rect::new(0.0, 0.0, self.width as f64 / scale, self.height as f64 / scale);
        let edge = |value: f64, largest: usize| (value * scale).round_ties_even().clamp(0.0, largest as f64) as usize;
        let clip = clip.unwrap_or(whole);
        let columns = edge(clip.left, self.width)..edge(clip.right, self.width);
        let rows = edge(clip.top, self.height)..edge(clip.bottom, self.height);
        let mut crossings = Crossings::new(rows.start * LINES, rows.end * LINES);
        for polygon in polygons {
            for i in 0..polygon.len() {
                let (a, b) = (polygon[i], polygon[(i + 1) % polygon.len()]);
                let pixels = |p: Point| [p[0] * scale, p[1] * scale * LINES as f64];
                crossings.add(pixels(a), pixels(b));
            }
        }
        let mut steps = vec![0.0_f32; self.width + 2];
        for (row, lines) in crossings.rows() {
            if cover(lines, &columns, &mut steps) {
                self.blend(row, &columns, &mut steps, paint, light);
            }
        }
    }

    /// Blends paint onto a row. `steps` are the differences of coverage from pixel to pixel; they are reset to 0.
    fn blend(&mut self, row: usize, columns: &std::ops::Range<usize>, steps: &mut [f32], paint: &Paint, light: bool) {
        let mut covered = 0.0;
        for column in columns.clone() {
            covered += steps[column];
            if covered > 1e-4 {
                let center = [(column as f64 + 0.5) / self.scale, (row as f64 + 0.5) / self.scale];
                let color = paint.at(center);
                let share = covered.min(1.0) * color.opacity as f32;
                let pixel = &mut self.rgb[row * self.width + column];
                for (old, new) in pixel.iter_mut().zip(color.rgb) {
                    *old = if light {
                        encoded(linear(*old) + share * linear(f32::from(new)))
                    } else {
                        *old + share * (f32::from(new) - *old)
                    };
                }
            }
        }
        steps.fill(0.0);
    }

    pub(crate) fn finish(self) -> Pixels {
        let code = |v: f32| v.round_ties_even().clamp(0.0, 255.0) as u8;
        let rgb = self.rgb.into_iter().map(|p| p.map(code)).collect();
        Pixels { width_px: self.width as u32, height_px: self.height as u32, rgb }
    }
}

/// Decodes an sRGB code value of 0 to 255 (IEC 61966-2-1) to linear light; white is 1.
fn linear(code: f32) -> f32 {
    let v = code / 255.0;
    if v <= 0.04045 { v / 12.92 } else { libm::powf((v + 0.055) / 1.055, 2.4) }
}

/// Encodes linear light as an sRGB code value; light above white is clipped.
fn encoded(light: f32) -> f32 {
    let v = light.min(1.0);
    255.0 * if v <= 0.003_130_8 { 12.92 * v } else { 1.055 * libm::powf(v, 1.0 / 2.4) - 0.055 }
}

/// Crossings of polygon edges with the scan lines: x and direction.
struct Crossings {
    /// Scan lines of the area that may be drawn on.
    first: usize,
    end: usize,
    lines: Vec<Vec<(f32, i32)>>,
}

impl Crossings {
    fn new(first: usize, end: usize) -> Self {
        Self { first, end, lines: vec![Vec::new(); end.saturating_sub(first)] }
    }

    /// Adds an edge, with y in scan lines; line `i` lies at `i` + 0.5.
    fn add(&mut self, a: Point, b: Point) {
        let (top, bottom, sense) = if a[1] < b[1] { (a, b, 1) } else { (b, a, -1) };
        if !(top[1] < bottom[1] && top.iter().chain(&bottom).all(|c| c.is_finite())) {
            return;
        }
        let line = |y: f64| (y - 0.5).ceil().clamp(self.first as f64, self.end as f64) as usize;
        let slope = (bottom[0] - top[0]) / (bottom[1] - top[1]);
        for i in line(top[1])..line(bottom[1]) {
            let x = top[0] + (i as f64 + 0.5 - top[1]) * slope;
            self.lines[i - self.first].push((x as f32, sense));
        }
    }

    /// Iterates over the rows of pixels, each with its scan lines.
    fn rows(&mut self) -> impl Iterator<Item = (usize, &mut [Vec<(f32, i32)>])> {
        let first = self.first / LINES;
        self.lines.chunks_mut(LINES).enumerate().map(move |(i, lines)| (first + i, lines))
    }
}

/// Adds the coverage of a row's scan lines to `steps`, whose running sum is the coverage; returns whether there is any.
fn cover(lines: &mut [Vec<(f32, i32)>], columns: &std::ops::Range<usize>, steps: &mut [f32]) -> bool {
    let (low, high) = (columns.start as f32, columns.end as f32);
    let mut any = false;
    for line in lines {
        line.sort_unstable_by(|a, b| a.0.total_cmp(&b.0));
        let (mut winding, mut start) = (0, 0.0);
        for (x, sense) in line {
            let before = winding;
            winding += *sense;
            if before == 0 {
                start = *x;
            } else if winding == 0 && *x > start {
                any = true;
                for (at, sign) in [(start, 1.0), (*x, -1.0)] {
                    let at = at.clamp(low, high);
                    let column = at.floor();
                    let weight = sign / LINES as f32;
                    steps[column as usize] += weight * (1.0 - (at - column));
                    steps[column as usize + 1] += weight * (at - column);
                }
            }
        }
    }
    any
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::stroke::Stroke;

    fn drawn(polygons: &[Vec<Point>], color: Color, clip: Option<Rect>) -> Pixels {
        let mut raster = Raster::new(10.0, 10.0, 1.0, Color::WHITE);
        raster.fill(polygons, &color.into(), clip);
        raster.finish()
    }

    /// Sum of the ink in units of whole pixels.
    fn ink(pixels: &Pixels) -> f64 {
        pixels.rgb.iter().map(|p| (255.0 - f64::from(p[0])) / 255.0).sum()
    }

    #[test]
    fn coverage_is_area() {
        let corners = |r: Rect| r.corners().to_vec();
        let pixels = drawn(&[corners(Rect::new(2.25, 3.0, 5.5, 4.5))], Color::BLACK, None);
        assert!((ink(&pixels) - 3.25 * 1.5).abs() < 0.02);
        assert_eq!([pixels.rgb[32][0], pixels.rgb[33][0], pixels.rgb[35][0], pixels.rgb[45][0]], [64, 0, 128, 191]);
        let disc = crate::geometry::circle([5.0, 5.0], 4.0);
        // Compare with the area of a regular polygon within a circle of radius 4.
        let sides = disc.len() as f64;
        let area = 0.5 * sides * 16.0 * libm::sin(std::f64::consts::TAU / sides);
        assert!((ink(&drawn(&[disc], Color::BLACK, None)) - area).abs() < 0.05);
    }

    /// Red and green light on one pixel make yellow, half of white twice is white, and paper cannot get brighter.
    #[test]
    fn light_adds() {
        let all = Rect::new(0.0, 0.0, 10.0, 10.0).corners().to_vec();
        let shone = |ground: Color, colors: &[Color]| {
            let mut raster = Raster::new(10.0, 10.0, 1.0, ground);
            colors.iter().for_each(|c| raster.shine(std::slice::from_ref(&all), &(*c).into(), None));
            raster.finish().rgb[55]
        };
        let half = Color::WHITE.with_opacity(0.5);
        assert_eq!(shone(Color::BLACK, &[Color::new(255, 0, 0), Color::new(0, 255, 0)]), [255, 255, 0]);
        assert_eq!(shone(Color::BLACK, &[half]), [188; 3]);
        assert_eq!(shone(Color::BLACK, &[half, half]), [255; 3]);
        assert_eq!(shone(Color::WHITE, &[half]), [255; 3]);
    }

    #[test]
    fn overlap_counts_once_and_the_clip_holds() {
        let corners = |r: Rect| r.corners().to_vec();
        let twice = [corners(Rect::new(1.0, 1.0, 5.0, 5.0)), corners(Rect::new(3.0, 3.0, 7.0, 7.0))];
        let half = Color::BLACK.with_opacity(0.5);
        assert!((ink(&drawn(&twice, half, None)) - 14.0).abs() < 0.1);
        let clip = Rect::new(4.0, 0.0, 6.0, 4.0);
        assert!((ink(&drawn(&twice, Color::BLACK, Some(clip))) - 4.0).abs() < 0.02);
    }

    #[test]
    fn a_line_has_its_width_and_what_lies_outside_does_no_harm() {
        let stroke = Stroke::new(Color::BLACK, 1.5);
        let line = stroke.outline(&[[1.0, 2.0], [8.0, 6.0]], false);
        assert!((ink(&drawn(&line, Color::BLACK, None)) - 1.5 * libm::hypot(7.0, 4.0)).abs() < 0.1);
        let far = stroke.outline(&[[-1e9, -1e9], [f64::NAN, 2.0], [1e9, 1e9]], false);
        assert!(ink(&drawn(&far, Color::BLACK, None)) > 10.0);
        assert_eq!(ink(&drawn(&[vec![], vec![[1.0, 1.0]]], Color::BLACK, None)), 0.0);
    }
}
