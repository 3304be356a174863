//! Approximates curves by straight segments, and converts strokes to areas.

use spectra_core::math;

/// A point in the plane, x and y.
pub(super) type Point = [f64; 2];

/// Largest number of corners of one element.
const MAX_CORNERS: usize = 1_000_000;
/// Largest number of segments of one curve.
const MAX_PIECES: f64 = 20_000.0;

/// A path under construction, with parts made of straight segments.
#[derive(Debug, Default)]
pub(super) struct Path {
    /// Points of each part, and whether the part is closed.
    pub(super) parts: Vec<(Vec<Point>, bool)>,
    tolerance: f64,
    corners: usize,
}

impl Path {
    /// Creates an empty path. Curves differ from their segments by at most `tolerance`.
    pub(super) fn new(tolerance: f64) -> Self {
        Self { parts: Vec::new(), tolerance, corners: 0 }
    }

    /// Whether the path has more corners than the limit.
    pub(super) fn is_too_long(&self) -> bool {
        self.corners > MAX_CORNERS
    }

    pub(super) fn begin(&mut self, at: Point) {
        self.corners += 1;
        if !self.is_too_long() {
            self.parts.push((vec![at], false));
        }
    }

    pub(super) fn close(&mut self) {
        if let Some((_, closed)) = self.parts.last_mut() {
            *closed = true;
        }
    }

    /// Returns the end of the last segment.
    pub(super) fn end(&self) -> Point {
        self.parts.last().and_then(|(points, _)| points.last()).copied().unwrap_or_default()
    }

    pub(super) fn line(&mut self, to: Point) {
        self.corners += 1;
        let full = self.is_too_long();
        if let Some((points, _)) = self.parts.last_mut().filter(|_| !full) {
            points.push(to);
        }
    }

    /// Adds a curve as about `pieces` segments, with equal steps of its parameter.
    fn pieces(&mut self, pieces: f64, at: impl Fn(f64) -> Point) {
        let usable = pieces.is_finite() && !self.is_too_long();
        let count = if usable { pieces.ceil().clamp(1.0, MAX_PIECES) as u32 } else { 1 };
        for i in 1..=count {
            self.line(at(f64::from(i) / f64::from(count)));
        }
    }

    /// Adds a cubic Bezier curve. Its second differences bound the error of the segments.
    pub(super) fn cubic(&mut self, b: Point, c: Point, d: Point) {
        let a = self.end();
        let bent = |p: Point, q: Point, r: Point| {
            let (x, y) = (p[0] - 2.0 * q[0] + r[0], p[1] - 2.0 * q[1] + r[1]);
            (x * x + y * y).sqrt()
        };
        let pieces = (0.75 * bent(a, b, c).max(bent(b, c, d)) / self.tolerance).sqrt();
        self.pieces(pieces, |t| {
            let s = 1.0 - t;
            let by = |k: usize| s * s * s * a[k] + 3.0 * s * t * (s * b[k] + t * c[k]) + t * t * t * d[k];
            [by(0), by(1)]
        });
    }

    /// Adds a quadratic Bezier curve.
    pub(super) fn quadratic(&mut self, b: Point, c: Point) {
        let a = self.end();
        let third = |p: f64, q: f64| p + 2.0 / 3.0 * (q - p);
        self.cubic([third(a[0], b[0]), third(a[1], b[1])], [third(c[0], b[0]), third(c[1], b[1])], c);
    }

    /// Adds an arc of an ellipse, after the implementation notes of SVG 1.1, F.6.5 and F.6.6.
    pub(super) fn arc(&mut self, radii: Point, turn_deg: f64, large: bool, sweep: bool, to: Point) {
        let from = self.end();
        let (mut rx, mut ry) = (radii[0].abs(), radii[1].abs());
        if rx == 0.0 || ry == 0.0 || from == to {
            return self.line(to);
        }
        let (sin, cos) = (math::sin(turn_deg.to_radians()), math::cos(turn_deg.to_radians()));
        let (dx, dy) = (0.5 * (from[0] - to[0]), 0.5 * (from[1] - to[1]));
        let (x, y) = (cos * dx + sin * dy, cos * dy - sin * dx);
        let stretch = x * x / (rx * rx) + y * y / (ry * ry);
        if stretch > 1.0 {
            (rx, ry) = (rx * stretch.sqrt(), ry * stretch.sqrt());
        }
        let (rx2, ry2) = (rx * rx, ry * ry);
        let down = rx2 * y * y + ry2 * x * x;
        let root = ((rx2 * ry2 - down) / down).max(0.0).sqrt() * if large == sweep { -1.0 } else { 1.0 };
        let (cx, cy) = (root * rx * y / ry, -root * ry * x / rx);
        let center = [cos * cx - sin * cy + 0.5 * (from[0] + to[0]), sin * cx + cos * cy + 0.5 * (from[1] + to[1])];
        let start = math::atan2((y - cy) / ry, (x - cx) / rx);
        let end = math::atan2((-y - cy) / ry, (-x - cx) / rx);
        let mut swept = end - start;
        if sweep && swept < 0.0 {
            swept += std::f64::consts::TAU;
        } else if !sweep && swept > 0.0 {
            swept -= std::f64::consts::TAU;
        }
        self.ellipse_piece(center, [rx, ry], [cos, sin], start, swept);
        // The arc ends exactly at the requested point, without rounding errors.
        if let Some(last) = self.parts.last_mut().and_then(|(points, _)| points.last_mut()) {
            *last = to;
        }
    }

    fn ellipse_piece(&mut self, center: Point, [rx, ry]: Point, [cos, sin]: Point, start: f64, swept: f64) {
        // A chord over the angle a of a circle has the error r (1 - cos(a / 2)), less than r a^2 / 8.
        let pieces = swept.abs() * (rx.max(ry) / (8.0 * self.tolerance)).sqrt();
        self.pieces(pieces, |t| {
            let a = start + t * swept;
            let (x, y) = (rx * math::cos(a), ry * math::sin(a));
            [center[0] + cos * x - sin * y, center[1] + sin * x + cos * y]
        });
    }

    /// Adds a whole ellipse with axes along x and y.
    pub(super) fn ellipse(&mut self, center: Point, radii: Point) {
        self.begin([center[0] + radii[0], center[1]]);
        self.ellipse_piece(center, radii, [1.0, 0.0], 0.0, std::f64::consts::TAU);
        if let Some((points, _)) = self.parts.last_mut() {
            points.pop();
        }
        self.close();
    }
}

/// Style of a stroke: width, joins and caps.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Pen {
    pub(super) width: f64,
    pub(super) join: Join,
    pub(super) cap: Cap,
    pub(super) miter_limit: f64,
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Join {
    Miter,
    Round,
    Bevel,
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Cap {
    Butt,
    Round,
    Square,
}

/// Returns the area of a stroke: a rectangle for each segment, a wedge for each corner, and caps. All are counter-clockwise, so that they
/// form one area by the nonzero rule. `None` if there are more corners than the limit.
pub(super) fn stroked(path: &Path, pen: Pen) -> Option<Vec<Vec<Point>>> {
    let mut areas: Vec<Vec<Point>> = Vec::new();
    let mut counted = (0, 0);
    let half = 0.5 * pen.width;
    for (points, closed) in &path.parts {
        let mut points: Vec<Point> = points.clone();
        points.dedup();
        if *closed && points.len() > 1 && points.first() == points.last() {
            points.pop();
        }
        if points.len() < 2 {
            match (points.first(), pen.cap) {
                (Some(at), Cap::Round) => areas.push(disk(*at, half, path.tolerance)),
                (Some([x, y]), Cap::Square) => {
                    areas.push(vec![
                        [x - half, y - half],
                        [x + half, y - half],
                        [x + half, y + half],
                        [x - half, y + half],
                    ]);
                }
                _ => {}
            }
            continue;
        }
        let count = points.len();
        let pieces = if *closed { count } else { count - 1 };
        let way = |i: usize| {
            let (a, b) = (points[i % count], points[(i + 1) % count]);
            let (x, y) = (b[0] - a[0], b[1] - a[1]);
            let length = (x * x + y * y).sqrt();
            [x / length, y / length]
        };
        for i in 0..pieces {
            counted.1 += areas[counted.0..].iter().map(Vec::len).sum::<usize>();
            counted.0 = areas.len();
            if counted.1 > MAX_CORNERS {
                return None;
            }
            let (mut a, mut b, [x, y]) = (points[i], points[(i + 1) % count], way(i));
            if pen.cap == Cap::Square && !closed {
                if i == 0 {
                    a = [a[0] - half * x, a[1] - half * y];
                }
                if i + 1 == pieces {
                    b = [b[0] + half * x, b[1] + half * y];
                }
            }
            let (u, v) = (half * y, half * x);
            areas.push(vec![[a[0] + u, a[1] - v], [b[0] + u, b[1] - v], [b[0] - u, b[1] + v], [a[0] - u, a[1] + v]]);
            if i + 1 < pieces || *closed {
                corner(&mut areas, points[(i + 1) % count], way(i), way(i + 1), half, pen, path.tolerance);
            }
        }
        if pen.cap == Cap::Round && !closed {
            areas.push(disk(points[0], half, path.tolerance));
            areas.push(disk(points[count - 1], half, path.tolerance));
        }
    }
    Some(areas)
}

fn disk(at: Point, radius: f64, tolerance: f64) -> Vec<Point> {
    let mut path = Path::new(tolerance);
    path.ellipse(at, [radius, radius]);
    path.parts.remove(0).0
}

/// Adds the area that the rectangles of two segments leave open on the outer side of their corner.
fn corner(areas: &mut Vec<Vec<Point>>, at: Point, before: Point, after: Point, half: f64, pen: Pen, tolerance: f64) {
    let cross = before[0] * after[1] - before[1] * after[0];
    let dot = before[0] * after[0] + before[1] * after[1];
    if cross == 0.0 && dot > 0.0 {
        return;
    }
    if pen.join == Join::Round {
        // Almost straight corners of an approximated curve need no disk, because the wedge is within the tolerance of it.
        if !(dot > 0.0 && half * cross * cross < 8.0 * tolerance) {
            areas.push(disk(at, half, tolerance));
            return;
        }
    }
    // If the line turns left, the outer side is the right one.
    let side = if cross > 0.0 { half } else { -half };
    let a = [at[0] + side * before[1], at[1] - side * before[0]];
    let b = [at[0] + side * after[1], at[1] - side * after[0]];
    let mut wedge = vec![at, a, b];
    // The length of a miter over its width is one over the sine of half the angle between the segments: sqrt(2 / (1 + dot)).
    if pen.join == Join::Miter && 2.0 <= pen.miter_limit * pen.miter_limit * (1.0 + dot) {
        let out = side / (1.0 + dot);
        let tip = [at[0] + out * (before[1] + after[1]), at[1] - out * (before[0] + after[0])];
        wedge.insert(2, tip);
    }
    if cross < 0.0 {
        wedge.reverse();
    }
    areas.push(wedge);
}
