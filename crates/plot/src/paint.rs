//! Paints: the fill of an area.

use crate::color::Color;
use crate::geometry::{Point, Rect};

/// A color at a position of a gradient.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stop {
    /// Position: 0 at the start of the gradient, 1 at its end.
    pub at: f64,
    /// Color at this position.
    pub color: Color,
}

/// A picture that fills an area, interpolated between the centers of its pixels.
#[derive(Clone, Debug, PartialEq)]
pub struct Picture {
    /// Rectangle of the whole picture on the canvas.
    pub place: Rect,
    /// Width in pixels.
    pub width_px: u32,
    /// Height in pixels.
    pub height_px: u32,
    /// Pixels row by row from the upper left, sRGB code values.
    pub rgb: Vec<[u8; 3]>,
}

/// The fill of an area.
#[derive(Clone, Debug, PartialEq)]
pub enum Paint {
    /// A single color.
    Solid(Color),
    /// Colors along a straight line, constant across it and beyond its ends.
    Gradient {
        /// Start of the gradient, position 0.
        from: Point,
        /// End of the gradient, position 1.
        to: Point,
        /// Colors, at least one, in ascending order of position.
        stops: Vec<Stop>,
    },
    /// A picture, clipped to the area.
    Picture(Picture),
}

impl From<Color> for Paint {
    fn from(color: Color) -> Self {
        Self::Solid(color)
    }
}

impl Paint {
    /// Returns the color at a point of the canvas.
    #[must_use]
    pub fn at(&self, place: Point) -> Color {
        match self {
            Self::Solid(color) => *color,
            Self::Gradient { from, to, stops } => {
                let along = [to[0] - from[0], to[1] - from[1]];
                let square = along[0] * along[0] + along[1] * along[1];
                let done = (place[0] - from[0]) * along[0] + (place[1] - from[1]) * along[1];
                between(stops, if square > 0.0 { done / square } else { 0.0 })
            }
            Self::Picture(picture) => picture.at(place),
        }
    }
}

fn between(stops: &[Stop], at: f64) -> Color {
    let next = stops.partition_point(|s| s.at <= at);
    match (next.checked_sub(1).map(|i| stops[i]), stops.get(next)) {
        (Some(a), Some(b)) => a.color.toward(b.color, (at - a.at) / (b.at - a.at)),
        (Some(a), None) => a.color,
        (None, Some(b)) => b.color,
        (None, None) => Color::BLACK.with_opacity(0.0),
    }
}

impl Picture {
    fn at(&self, place: Point) -> Color {
        let (width, height) = (self.width_px as usize, self.height_px as usize);
        if width * height == 0 || self.rgb.len() != width * height {
            return Color::BLACK.with_opacity(0.0);
        }
        let (x, x_share) = cell(place[0], self.place.left, self.place.width(), width);
        let (y, y_share) = cell(place[1], self.place.top, self.place.height(), height);
        let pixel = |x: usize, y: usize| Color::from(self.rgb[y.min(height - 1) * width + x.min(width - 1)]);
        let row = |y| pixel(x, y).toward(pixel(x + 1, y), x_share);
        row(y).toward(row(y + 1), y_share)
    }
}

/// Returns the pixel whose center lies before `at`, and the fraction of the distance to the next.
fn cell(at: f64, start: f64, length: f64, count: usize) -> (usize, f64) {
    let pixels = ((at - start) / length * count as f64 - 0.5).clamp(0.0, count as f64 - 1.0);
    (pixels as usize, pixels - pixels.floor())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_gradient_runs_along_its_way_only() {
        let stops = vec![Stop { at: 0.0, color: Color::BLACK }, Stop { at: 1.0, color: Color::new(200, 100, 0) }];
        let paint = Paint::Gradient { from: [10.0, 0.0], to: [20.0, 0.0], stops };
        assert_eq!([paint.at([15.0, 7.0]).rgb, paint.at([0.0, 0.0]).rgb], [[100, 50, 0], [0, 0, 0]]);
        assert_eq!(paint.at([99.0, 0.0]).rgb, [200, 100, 0]);
    }

    #[test]
    fn a_picture_is_exact_at_the_centers_of_its_pixels() {
        let rgb = vec![[0, 0, 0], [100, 0, 0], [0, 100, 0], [100, 100, 0]];
        let picture = Picture { place: Rect::new(0.0, 0.0, 2.0, 2.0), width_px: 2, height_px: 2, rgb };
        let paint = Paint::Picture(picture);
        assert_eq!(paint.at([1.5, 0.5]).rgb, [100, 0, 0]);
        assert_eq!(paint.at([1.0, 1.0]).rgb, [50, 50, 0]);
        assert_eq!(paint.at([-5.0, 9.0]).rgb, [0, 100, 0]);
    }
}
