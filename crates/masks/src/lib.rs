//! A drawing as an aperture: outlines, exact at any magnification.

#![cfg_attr(not(test), warn(clippy::disallowed_methods))]

mod outline;
mod style;
mod svg;

pub use svg::{Open, read};

use std::sync::Arc;

/// Largest distance between a curve and the straight pieces that stand for it, mm: 50 nm.
pub const FLATNESS_MM: f64 = 5e-5;

/// Which points of an outline that crosses itself lie inside.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FillRule {
    /// Those that it runs around, whatever the sense.
    NonZero,
    /// Those that are crossed into an odd number of times.
    EvenOdd,
}

/// One painted shape; later ones lie on top.
#[derive(Clone, Debug, PartialEq)]
pub struct Painted {
    /// Closed outlines: corners in order, mm from the center of the drawing, +y up.
    pub outlines: Vec<Vec<[f64; 2]>>,
    /// What lies inside.
    pub rule: FillRule,
    /// What it lets through where it is opaque: 0 to 1.
    pub transmittance: f64,
    /// How much of what lies below it covers: 0 to 1.
    pub opacity: f64,
}

/// A piece of an outline that rises or falls.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Edge {
    /// Lower and upper end in y, mm.
    low: f64,
    high: f64,
    /// x at the lower end, mm, and its change with y.
    x: f64,
    slope: f64,
    /// +1 where it rises, -1 where it falls.
    turn: i32,
    shape: u32,
}

/// Painted shapes on a page, black where nothing is painted. Beside the page nothing passes.
///
/// Which shapes cover a point is told by the edges to its right; the page is cut into bands, each of which knows its edges.
#[derive(Clone, Debug, PartialEq)]
pub struct Drawing {
    half_width_mm: f64,
    half_height_mm: f64,
    /// Per shape: rule, transmittance, opacity.
    paints: Arc<[(FillRule, f64, f64)]>,
    edges: Arc<[Edge]>,
    /// Bands per mm.
    per_mm: f64,
    /// Where the edges of each band begin in `members`, and the end.
    starts: Arc<[u32]>,
    /// Numbers of edges, by band, each band's in the order of the shapes.
    members: Arc<[u32]>,
}

/// Most bands of a page.
const MAX_BANDS: usize = 4096;
/// Most entries of all bands together.
const MAX_MEMBERS: usize = 1 << 23;

impl Drawing {
    /// A page of this width and height, mm, with shapes from the lowest to the topmost.
    #[must_use]
    pub fn new(width_mm: f64, height_mm: f64, shapes: &[Painted]) -> Self {
        let edges: Vec<Edge> = (0_u32..).zip(shapes).flat_map(|(at, shape)| edges_of(shape, at)).collect();
        let mut bands = edges.len().clamp(1, MAX_BANDS);
        let half_height_mm = 0.5 * height_mm;
        let reach = |edge: &Edge, bands: usize| {
            let per_mm = bands as f64 / height_mm;
            let at = |y: f64| band(y, half_height_mm, per_mm, bands);
            // Only what lies on the page is ever asked for.
            (edge.high > -half_height_mm && edge.low < half_height_mm).then(|| at(edge.low)..=at(edge.high))
        };
        let total = |bands: usize| edges.iter().filter_map(|e| reach(e, bands)).map(|r| r.count()).sum::<usize>();
        while bands > 1 && total(bands) > MAX_MEMBERS {
            bands /= 2;
        }
        let mut starts = vec![0_u32; bands + 1];
        for range in edges.iter().filter_map(|e| reach(e, bands)) {
            for at in range {
                starts[at + 1] += 1;
            }
        }
        for at in 0..bands {
            starts[at + 1] += starts[at];
        }
        let (mut next, mut members) = (starts.clone(), vec![0_u32; starts[bands] as usize]);
        for (number, edge) in (0_u32..).zip(&edges) {
            for at in reach(edge, bands).into_iter().flatten() {
                members[next[at] as usize] = number;
                next[at] += 1;
            }
        }
        Self {
            half_width_mm: 0.5 * width_mm,
            half_height_mm,
            paints: shapes.iter().map(|s| (s.rule, s.transmittance, s.opacity)).collect(),
            edges: edges.into(),
            per_mm: bands as f64 / height_mm,
            starts: starts.into(),
            members: members.into(),
        }
    }

    /// What passes at a point, mm from the center of the page; 0 beside it.
    #[must_use]
    pub fn transmittance(&self, x_mm: f64, y_mm: f64) -> f64 {
        if !(x_mm.abs() <= self.half_width_mm && y_mm.abs() <= self.half_height_mm) {
            return 0.0;
        }
        let at = band(y_mm, self.half_height_mm, self.per_mm, self.starts.len() - 1);
        let members = &self.members[self.starts[at] as usize..self.starts[at + 1] as usize];
        let (mut passes, mut shape, mut winding) = (0.0, u32::MAX, 0);
        let settle = |passes: f64, shape: u32, winding: i32| match self.paints.get(shape as usize) {
            Some((FillRule::NonZero, value, opacity)) if winding != 0 => passes + opacity * (value - passes),
            Some((FillRule::EvenOdd, value, opacity)) if winding % 2 != 0 => passes + opacity * (value - passes),
            _ => passes,
        };
        for number in members {
            let edge = &self.edges[*number as usize];
            if edge.shape != shape {
                passes = settle(passes, shape, winding);
                (shape, winding) = (edge.shape, 0);
            }
            if y_mm >= edge.low && y_mm < edge.high && edge.x + edge.slope * (y_mm - edge.low) > x_mm {
                winding += edge.turn;
            }
        }
        settle(passes, shape, winding)
    }

    /// Radius about the center outside of which nothing passes, mm.
    #[must_use]
    pub fn reach_mm(&self) -> f64 {
        let far = |x: f64, y: f64| {
            let (x, y) = (x.abs().min(self.half_width_mm), y.abs().min(self.half_height_mm));
            (x * x + y * y).sqrt()
        };
        let ends = |e: &Edge| far(e.x, e.low).max(far(e.x + e.slope * (e.high - e.low), e.high));
        self.edges.iter().map(ends).fold(0.0, f64::max)
    }
}

/// Number of the band of a height.
fn band(y_mm: f64, half_height_mm: f64, per_mm: f64, bands: usize) -> usize {
    (((y_mm + half_height_mm) * per_mm).max(0.0) as usize).min(bands - 1)
}

fn edges_of(shape: &Painted, number: u32) -> impl Iterator<Item = Edge> + '_ {
    shape.outlines.iter().flat_map(move |outline| {
        outline.iter().zip(outline.iter().cycle().skip(1)).filter(|(a, b)| a[1] != b[1]).map(move |(a, b)| {
            let (turn, low, high) = if b[1] > a[1] { (1, a, b) } else { (-1, b, a) };
            let slope = (high[0] - low[0]) / (high[1] - low[1]);
            Edge { low: low[1], high: high[1], x: low[0], slope, turn, shape: number }
        })
    })
}

#[cfg(test)]
mod tests;
