//! An opening by its edges, and its transform.

use spectra_core::math;
use std::f64::consts::TAU;

/// A flat opening bounded by straight edges, holes included.
///
/// Its places have any unit; of a lens they are direction cosines, which have none.
#[derive(Clone, Debug, PartialEq)]
pub struct Polygon {
    /// Closed rings, corners in order about the centroid; what passes lies to the left of each edge.
    rings: Vec<Vec<[f64; 2]>>,
    center: [f64; 2],
    area: f64,
}

impl Polygon {
    /// Of closed rings of corners: the opening lies to the left of their edges, so that outer rings run counter-clockwise and holes
    /// clockwise. `None` where they enclose nothing.
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

    /// A regular polygon with its corners at `radius`, one of them on +y before it is turned by `rotation_rad`.
    ///
    /// # Panics
    /// Of fewer than three corners, or of no size.
    #[must_use]
    pub fn regular(corners: u32, radius: f64, rotation_rad: f64) -> Self {
        let corner = |k: u32| {
            let a = rotation_rad + TAU * (0.25 + f64::from(k) / f64::from(corners));
            [radius * math::cos(a), radius * math::sin(a)]
        };
        Self::new(vec![(0..corners).map(corner).collect()]).expect("a polygon of some size")
    }

    /// Its rings, about [`Polygon::center`].
    #[must_use]
    pub fn rings(&self) -> &[Vec<[f64; 2]>] {
        &self.rings
    }

    /// Its centroid.
    #[must_use]
    pub fn center(&self) -> [f64; 2] {
        self.center
    }

    /// Its area.
    #[must_use]
    pub fn area(&self) -> f64 {
        self.area
    }

    /// The largest distance of a corner from the centroid.
    #[must_use]
    pub fn reach(&self) -> f64 {
        self.rings.iter().flatten().map(|[x, y]| (x * x + y * y).sqrt()).fold(0.0, f64::max)
    }

    /// The mean over the opening of exp(i k r), r from its centroid: real and imaginary part, 1 at the origin. `k` is in radians per
    /// unit of its places.
    ///
    /// By Gauss's theorem a sum over edges of (k x d) sinc(k d / 2) exp(i k m) / (i k^2), with d along an edge and m its middle (S.-W.
    /// Lee and R. Mittra, "Fourier transform of a polygonal shape function", IEEE Trans. Antennas Propag. 31, 1983). The d of a ring
    /// sum to 0, so 1 may be taken off each sinc exp: then nothing cancels toward the origin, nor where k is perpendicular to an edge.
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
                // Half of the phase of the middle.
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

    /// The square of [`Polygon::amplitude`].
    #[must_use]
    pub fn intensity(&self, k: [f64; 2]) -> f64 {
        let [re, im] = self.amplitude(k);
        re * re + im * im
    }

    /// What of it lies inside of a convex polygon whose corners run counter-clockwise, both as they were given to [`Polygon::new`]
    /// (I. E. Sutherland and G. W. Hodgman, "Reentrant polygon clipping", Commun. ACM 17, 1974). `None` where nothing does.
    #[must_use]
    pub fn within(&self, convex: &[[f64; 2]]) -> Option<Self> {
        let mut rings: Vec<Vec<[f64; 2]>> = self.rings.clone();
        for ring in &mut rings {
            ring.iter_mut().for_each(|p| (0..2).for_each(|k| p[k] += self.center[k]));
            for i in 0..convex.len() {
                let (a, b) = (convex[i], convex[(i + 1) % convex.len()]);
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

/// sin(x) / x - 1, also near 0.
fn sinc_less_one(x: f64) -> f64 {
    if x.abs() > 0.5 {
        return math::sin(x) / x - 1.0;
    }
    let x2 = x * x;
    // The series to x^14: the next term is below 1e-17 of the first.
    let mut sum = 0.0;
    for n in (1..8).rev() {
        let n = f64::from(n);
        sum = -x2 / (2.0 * n * (2.0 * n + 1.0)) * (1.0 + sum);
    }
    sum
}
