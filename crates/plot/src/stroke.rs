//! Lines with a width.

use crate::color::Color;
use crate::geometry::{Point, circle};

/// The shape of the ends of a line.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Cap {
    /// Ends exactly at the last point.
    Flat,
    /// Ends in a half circle beyond the last point.
    Round,
}

/// Style of a line; its corners are round.
#[derive(Clone, Debug, PartialEq)]
pub struct Stroke {
    /// Color.
    pub color: Color,
    /// Width, canvas units.
    pub width: f64,
    /// Shape of the ends.
    pub cap: Cap,
    /// Lengths of dashes and gaps in turn, canvas units; empty for a solid line.
    pub dashes: Vec<f64>,
    /// Whether the line adds its light to what is below instead of covering it, as rays that cross on a dark background do.
    pub is_light: bool,
}

impl Stroke {
    /// Creates a solid line style with flat ends.
    #[must_use]
    pub fn new(color: Color, width: f64) -> Self {
        Self { color, width, cap: Cap::Flat, dashes: Vec::new(), is_light: false }
    }

    /// Returns this style with round ends.
    #[must_use]
    pub fn round(self) -> Self {
        Self { cap: Cap::Round, ..self }
    }

    /// Returns this style as light that is added to what is below.
    #[must_use]
    pub fn as_light(self) -> Self {
        Self { is_light: true, ..self }
    }

    /// Returns this style with dashes and gaps of these lengths.
    #[must_use]
    pub fn dashed(self, dashes: &[f64]) -> Self {
        Self { dashes: dashes.to_vec(), ..self }
    }

    /// Returns the area of a line as polygons of the same orientation; their union is covered.
    pub(crate) fn outline(&self, points: &[Point], closed: bool) -> Vec<Vec<Point>> {
        let mut points: Vec<Point> = points.iter().copied().filter(|p| p.iter().all(|c| c.is_finite())).collect();
        points.dedup();
        if closed && points.len() > 1 && points.first() != points.last() {
            points.push(points[0]);
        }
        let closed = closed && points.len() > 2;
        let mut out = Vec::new();
        if self.dashes.iter().sum::<f64>() > 0.0 && self.dashes.iter().all(|d| *d >= 0.0) {
            dashes(&points, &self.dashes).iter().for_each(|dash| self.solid(dash, false, &mut out));
        } else {
            self.solid(&points, closed, &mut out);
        }
        out
    }

    fn solid(&self, points: &[Point], closed: bool, out: &mut Vec<Vec<Point>>) {
        let half = 0.5 * self.width;
        for (a, b) in points.iter().zip(points.iter().skip(1)) {
            let along = [b[0] - a[0], b[1] - a[1]];
            let length = libm::hypot(along[0], along[1]);
            if length > 0.0 {
                let n = [-along[1] / length * half, along[0] / length * half];
                let corner = |p: &Point, s: f64| [p[0] + s * n[0], p[1] + s * n[1]];
                // Use the same orientation as `circle`.
                out.push(vec![corner(a, -1.0), corner(b, -1.0), corner(b, 1.0), corner(a, 1.0)]);
            }
        }
        let last = points.len().saturating_sub(1);
        for (i, point) in points.iter().enumerate() {
            if self.cap == Cap::Round || closed || (i > 0 && i < last) {
                out.push(circle(*point, half));
            }
        }
    }
}

fn dashes(points: &[Point], pattern: &[f64]) -> Vec<Vec<Point>> {
    /// Largest number of dashes: a line with more is drawn solid, because its dashes would be too fine to see.
    const MOST: usize = 100_000;
    let mut out: Vec<Vec<Point>> = Vec::new();
    let (mut turn, mut left) = (0, pattern[0]);
    let mut current: Vec<Point> = points.first().copied().into_iter().collect();
    for (a, b) in points.iter().zip(points.iter().skip(1)) {
        let along = [b[0] - a[0], b[1] - a[1]];
        let length = libm::hypot(along[0], along[1]);
        let mut done = 0.0;
        while length - done > left {
            done += left;
            let place = [a[0] + along[0] * done / length, a[1] + along[1] * done / length];
            // An odd pattern swaps dashes and gaps on each repetition, as in SVG.
            if turn % 2 == 0 {
                current.push(place);
                out.push(std::mem::take(&mut current));
            }
            turn += 1;
            left = pattern[turn % pattern.len()];
            if turn % 2 == 0 {
                current = vec![place];
            }
            if turn > MOST {
                return vec![points.to_vec()];
            }
        }
        left -= length - done;
        if turn % 2 == 0 {
            current.push(*b);
        }
    }
    if current.len() > 1 {
        out.push(current);
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn dashes_go_round_corners_and_keep_their_lengths() {
        let dashes = dashes(&[[0.0, 0.0], [5.0, 0.0], [5.0, 5.0]], &[4.0, 2.0]);
        assert_eq!(dashes, [vec![[0.0, 0.0], [4.0, 0.0]], vec![[5.0, 1.0], [5.0, 5.0]]]);
        let odd = super::dashes(&[[0.0, 0.0], [10.0, 0.0]], &[3.0]);
        assert_eq!(odd, [vec![[0.0, 0.0], [3.0, 0.0]], vec![[6.0, 0.0], [9.0, 0.0]]]);
    }

    #[test]
    fn all_parts_turn_the_same_way() {
        let stroke = Stroke::new(Color::INK, 3.0).round();
        let area = |p: &Vec<Point>| {
            (0..p.len()).map(|i| (p[i], p[(i + 1) % p.len()])).map(|(a, b)| a[0] * b[1] - b[0] * a[1]).sum::<f64>()
        };
        let parts = stroke.outline(&[[0.0, 0.0], [9.0, 3.0], [2.0, 8.0], [-4.0, -7.0]], true);
        assert!(parts.iter().all(|p| area(p) > 0.0), "{parts:?}");
    }
}
