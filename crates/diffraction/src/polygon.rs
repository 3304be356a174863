//! An opening bounded by straight edges, and its Fourier transform.

use spectra_core::math;
use std::f64::consts::TAU;

/// A flat opening bounded by straight edges, holes included.
///
/// Coordinates may have any unit. For a lens they are direction cosines, which have no unit.
#[derive(Clone, Debug, PartialEq)]
pub struct Polygon {
    /// Closed rings, with corners in order, relative to the centroid. The opening lies to the left of each edge.
    rings: Vec<Vec<[f64; 2]>>,
    center: [f64; 2],
    area: f64,
}

impl Polygon {
    /// Creates an opening from closed rings of corners. The opening lies to the left of the edges, so outer rings run
    /// counterclockwise and holes clockwise. `None` if the rings enclose no area.
    #[must_use]
    pub fn new(rings: Vec<Vec<[f64; 2]>>) -> Option<Self> {
        let edges = |ring: &[[f64; 2]], sum: &mut dyn FnMut([f64; 2], [f64; 2])| {
            (0..ring.len()).for_each(|i| sum(ring[i], ring[(i + 1) % ring.len()]));
        };
        let origin = *rings.iter().flatten().next()?;
        let (mut twice, mut moment) = (0.0, [0.0; 2]);
        for ring in &rings {
            edges(ring, &mut |a, b| {
                let [a, b] = [a, b].map(|p| [p[0] - origin[0], p[1] - origin[1]]);
                let cross = a[0] * b[1] - a[1] * b[0];
                twice += cross;
                (0..2).for_each(|k| moment[k] += cross * (a[k] + b[k]));
            });
        }
        if !(twice > 0.0 && twice.is_finite()) {
            return None;
        }
        let center = [0, 1].map(|k| origin[k] + moment[k] / (3.0 * twice));
        let about = |p: [f64; 2]| [p[0] - center[0], p[1] - center[1]];
        let rings = rings.into_iter().map(|ring| ring.into_iter().map(about).collect()).collect();
        Some(Self { rings, center, area: 0.5 * twice })
    }

    /// Creates a regular polygon with its corners at `radius` from the origin. One corner lies on +y before the polygon is turned by
    /// `rotation_rad`.
    ///
    /// # Panics
    /// Panics with fewer than three corners, or if the polygon has no area.
    #[must_use]
    pub fn regular(corners: u32, radius: f64, rotation_rad: f64) -> Self {
        let corner = |k: u32| {
            let a = rotation_rad + TAU * (0.25 + f64::from(k) / f64::from(corners));
            [radius * math::cos(a), radius * math::sin(a)]
        };
        Self::new(vec![(0..corners).map(corner).collect()]).expect("a polygon of some size")
    }

    /// Rings of the opening: corners relative to [`Polygon::center`].
    #[must_use]
    pub fn rings(&self) -> &[Vec<[f64; 2]>] {
        &self.rings
    }

    /// Centroid of the opening, in the coordinates given to [`Polygon::new`].
    #[must_use]
    pub fn center(&self) -> [f64; 2] {
        self.center
    }

    /// Area of the opening, in squared units of the coordinates.
    #[must_use]
    pub fn area(&self) -> f64 {
        self.area
    }

    /// Largest distance of a corner from the centroid.
    #[must_use]
    pub fn reach(&self) -> f64 {
        self.rings.iter().flatten().map(|[x, y]| (x * x + y * y).sqrt()).fold(0.0, f64::max)
    }

    /// Returns the bounding box `[[min x, min y], [max x, max y]]`, in the coordinates given to [`Polygon::new`].
    #[must_use]
    pub fn bounds(&self) -> [[f64; 2]; 2] {
        let mut bounds = [[f64::INFINITY; 2], [f64::NEG_INFINITY; 2]];
        for p in self.rings.iter().flatten() {
            for k in 0..2 {
                bounds[0][k] = bounds[0][k].min(p[k] + self.center[k]);
                bounds[1][k] = bounds[1][k].max(p[k] + self.center[k]);
            }
        }
        bounds
    }

    /// Returns the intervals of `x` in which a line of constant `y` lies in the opening, in the coordinates given to [`Polygon::new`].
    #[must_use]
    pub fn spans(&self, y: f64) -> Vec<[f64; 2]> {
        let y = y - self.center[1];
        let mut crossed = Vec::new();
        for ring in &self.rings {
            for (i, a) in ring.iter().enumerate() {
                let b = ring[(i + 1) % ring.len()];
                if (a[1] > y) != (b[1] > y) {
                    crossed.push(self.center[0] + a[0] + (y - a[1]) / (b[1] - a[1]) * (b[0] - a[0]));
                }
            }
        }
        crossed.sort_by(f64::total_cmp);
        crossed.chunks_exact(2).map(|pair| [pair[0], pair[1]]).collect()
    }

    /// Returns the Fourier transform of the opening: the mean of exp(i k r) over it, with r measured from its centroid. The
    /// result is the real and the imaginary part, and 1 at k = 0. `k` is in radians per unit of the coordinates.
    ///
    /// By Gauss's theorem it is a sum over edges of (k x d) sinc(k d / 2) exp(i k m) / (i k^2), with d along an edge and m its middle
    /// (S.-W. Lee and R. Mittra, "Fourier transform of a polygonal shape function", IEEE Trans. Antennas Propag. 31, 1983). The vectors d
    /// of a ring sum to 0, so 1 may be subtracted from each sinc exp. This avoids cancellation toward the origin, and where k is
    /// perpendicular to an edge.
    #[must_use]
    pub fn amplitude(&self, k: [f64; 2]) -> [f64; 2] {
        let k2 = k[0] * k[0] + k[1] * k[1];
        if k2 * self.area < 1e-30 {
            return [1.0, 0.0];
        }
        let (mut re, mut im) = (0.0, 0.0);
        for ring in &self.rings {
            let mut from = ring[ring.len() - 1];
            for &to in ring {
                let d = [to[0] - from[0], to[1] - from[1]];
                let cross = k[0] * d[1] - k[1] * d[0];
                // Half of the phase at the middle.
                let half = 0.25 * (k[0] * (from[0] + to[0]) + k[1] * (from[1] + to[1]));
                let less = sinc_less_one(0.5 * (k[0] * d[0] + k[1] * d[1]));
                let (sin, cos) = (math::sin(half), math::cos(half));
                let sinc = 1.0 + less;
                re += cross * (less - 2.0 * sin * sin * sinc);
                im += cross * (2.0 * sin * cos * sinc);
                from = to;
            }
        }
        let scale = 1.0 / (k2 * self.area);
        [im * scale, -re * scale]
    }

    /// Returns the squared modulus of [`Polygon::amplitude`].
    #[must_use]
    pub fn intensity(&self, k: [f64; 2]) -> f64 {
        let [re, im] = self.amplitude(k);
        re * re + im * im
    }

    /// Returns [`Polygon::intensity`] on a lattice of `step` radians per unit, row by row. There are `count` + 1 rows, from the
    /// origin on. Each has `count` columns on both sides of the origin and one through it.
    ///
    /// Far from the origin and from an edge's normal, the term of the edge is the difference of the phases at its ends. Each phase is the
    /// product of one factor for the column and one for the row.
    #[must_use]
    pub fn lattice(&self, step: f64, count: usize) -> Vec<f64> {
        let columns = 2 * count + 1;
        let turn = |phase: f64| [math::cos(phase), math::sin(phase)];
        let at = |i: usize| (i as f64 - count as f64) * step;
        let phases: Vec<Vec<[Vec<[f64; 2]>; 2]>> = self
            .rings
            .iter()
            .map(|ring| {
                let corner = |[x, y]: &[f64; 2]| {
                    [
                        (0..columns).map(|i| turn(at(i) * x)).collect(),
                        (0..count + 1).map(|j| turn(j as f64 * step * y)).collect(),
                    ]
                };
                ring.iter().map(corner).collect()
            })
            .collect();
        let far2 = 1.0 / self.area;
        let value = |i: usize, j: usize| {
            let k = [at(i), j as f64 * step];
            let k2 = k[0] * k[0] + k[1] * k[1];
            if k2 < far2 {
                return self.intensity(k);
            }
            let (mut re, mut im) = (0.0, 0.0);
            for (ring, phases) in self.rings.iter().zip(&phases) {
                let end = |c: usize| {
                    let ([a, b], [c, d]) = (phases[c][0][i], phases[c][1][j]);
                    [a * c - b * d, a * d + b * c]
                };
                let mut from = ring.len() - 1;
                let mut before = end(from);
                for to in 0..ring.len() {
                    let d = [ring[to][0] - ring[from][0], ring[to][1] - ring[from][1]];
                    let cross = k[0] * d[1] - k[1] * d[0];
                    let along = k[0] * d[0] + k[1] * d[1];
                    let after = end(to);
                    // The term (k x d) sinc exp(i k m); the division by i k^2 comes last.
                    if along.abs() > 0.2 {
                        let part = cross / along;
                        re += part * (after[1] - before[1]);
                        im -= part * (after[0] - before[0]);
                    } else {
                        // The phase at the middle is that at the first end, advanced by half of the edge.
                        let sinc = cross * (1.0 + sinc_less_one(0.5 * along));
                        let [c, s] = turn(0.5 * along);
                        re += sinc * (before[0] * c - before[1] * s);
                        im += sinc * (before[1] * c + before[0] * s);
                    }
                    (from, before) = (to, after);
                }
            }
            let scale = 1.0 / (k2 * self.area);
            (re * re + im * im) * scale * scale
        };
        (0..count + 1).flat_map(|j| (0..columns).map(move |i| (i, j))).map(|(i, j)| value(i, j)).collect()
    }

    /// Returns the opening without those corners that lie closer than `tolerance` to the line between the remaining neighbors.
    #[must_use]
    pub fn simplified(&self, tolerance: f64) -> Self {
        let mut rings = Vec::new();
        for ring in &self.rings {
            let count = ring.len();
            // Begin where the outline turns most, so that a straight side is one piece.
            let turn = |i: usize| {
                let (a, b, c) = (ring[(i + count - 1) % count], ring[i], ring[(i + 1) % count]);
                ((b[0] - a[0]) * (c[1] - b[1]) - (b[1] - a[1]) * (c[0] - b[0])).abs()
            };
            let begin = (0..count).max_by(|a, b| turn(*a).total_cmp(&turn(*b))).unwrap_or(0);
            let at = |i: usize| ring[(begin + i) % count];
            let mut kept = Vec::new();
            let mut from = 0;
            while from < count {
                kept.push(at(from));
                // Continue as long as all corners in between lie on the line.
                let mut to = from + 1;
                while to < count {
                    let (a, b) = (at(from), at(to + 1));
                    let d = [b[0] - a[0], b[1] - a[1]];
                    let length = (d[0] * d[0] + d[1] * d[1]).sqrt();
                    let off = |i: usize| (d[0] * (at(i)[1] - a[1]) - d[1] * (at(i)[0] - a[0])).abs();
                    if (from + 1..to + 1).any(|i| off(i) > tolerance * length) {
                        break;
                    }
                    to += 1;
                }
                from = to;
            }
            rings.push(if kept.len() > 2 { kept } else { ring.clone() });
        }
        let [cx, cy] = self.center;
        rings.iter_mut().flatten().for_each(|p| (p[0], p[1]) = (p[0] + cx, p[1] + cy));
        Self::new(rings).unwrap_or_else(|| self.clone())
    }

    /// Returns the part of the opening inside a convex polygon whose corners run counterclockwise, both in the coordinates given to
    /// [`Polygon::new`] (I. E. Sutherland and G. W. Hodgman, "Reentrant polygon clipping", Commun. ACM 17, 1974). `None` if no part lies
    /// inside.
    #[must_use]
    pub fn within(&self, convex: &[[f64; 2]]) -> Option<Self> {
        let lines: Vec<_> = (0..convex.len()).map(|i| [convex[i], convex[(i + 1) % convex.len()]]).collect();
        self.left_of(&lines)
    }

    /// Returns the part of the opening that lies to the left of each of these lines, given by two points each. `None` if no part
    /// remains.
    #[must_use]
    pub fn left_of(&self, lines: &[[[f64; 2]; 2]]) -> Option<Self> {
        let mut rings: Vec<Vec<[f64; 2]>> = self.rings.clone();
        for ring in &mut rings {
            ring.iter_mut().for_each(|p| (0..2).for_each(|k| p[k] += self.center[k]));
            for [a, b] in lines {
                let side = |p: [f64; 2]| (b[0] - a[0]) * (p[1] - a[1]) - (b[1] - a[1]) * (p[0] - a[0]);
                let mut kept = Vec::with_capacity(ring.len() + 1);
                for j in 0..ring.len() {
                    let (p, q) = (ring[j], ring[(j + 1) % ring.len()]);
                    let (sp, sq) = (side(p), side(q));
                    if sp >= 0.0 {
                        kept.push(p);
                    }
                    if (sp >= 0.0) != (sq >= 0.0) {
                        let t = sp / (sp - sq);
                        kept.push([p[0] + t * (q[0] - p[0]), p[1] + t * (q[1] - p[1])]);
                    }
                }
                *ring = kept;
            }
        }
        rings.retain(|ring| ring.len() > 2);
        Self::new(rings)
    }
}

/// Returns sin(x) / x - 1, accurate also near 0.
fn sinc_less_one(x: f64) -> f64 {
    if x.abs() > 0.5 {
        return math::sin(x) / x - 1.0;
    }
    let x2 = x * x;
    // Series up to x^14: the next term is below 1e-17 of the first.
    let mut sum = 0.0;
    for n in (1..8).rev() {
        let n = f64::from(n);
        sum = -x2 / (2.0 * n * (2.0 * n + 1.0)) * (1.0 + sum);
    }
    sum
}
