//! Apertures drawn as SVG files: outlines of shapes, exact at any magnification.

#![cfg_attr(not(test), warn(clippy::disallowed_methods))]

mod attribute;
mod grid;
mod outline;
mod style;
mod svg;

pub use svg::{Open, read};

use grid::Grid;
use std::sync::Arc;

/// Largest distance between a curve and the straight segments that approximate it, mm: 50 nm.
pub const FLATNESS_MM: f64 = 5e-5;

/// Rule that says which points lie inside an outline that crosses itself.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FillRule {
    /// Points that the outline winds around, in either direction.
    NonZero,
    /// Points that a ray from outside reaches after an odd number of crossings.
    EvenOdd,
}

/// A painted shape of a drawing. Later shapes lie on top of earlier ones.
#[derive(Clone, Debug, PartialEq)]
pub struct Painted {
    /// Closed outlines: corners in order, mm from the center of the drawing, +y up.
    pub outlines: Vec<Vec<[f64; 2]>>,
    /// Rule for the points inside the outlines.
    pub rule: FillRule,
    /// Transmittance of the shape where it is opaque, 0 to 1.
    pub transmittance: f64,
    /// Fraction by which the shape covers what lies below it, 0 to 1.
    pub opacity: f64,
}

/// A segment of an outline that rises or falls in y.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Edge {
    /// Lower and upper end in y, mm.
    low: f64,
    high: f64,
    /// x at the lower end (mm), and its change with y.
    x: f64,
    slope: f64,
    /// Direction of the segment: +1 if it rises, -1 if it falls.
    turn: i32,
    shape: u32,
}

impl Edge {
    /// Returns x (mm) at a height between its ends.
    fn x_at(&self, y_mm: f64) -> f64 {
        self.x + self.slope * (y_mm - self.low)
    }
}

/// Fill rule, transmittance and opacity of a shape.
type Paint = (FillRule, f64, f64);

/// An aperture made of painted shapes on a page. The page is opaque where no shape is painted, and no light passes outside the
/// page.
#[derive(Clone, Debug, PartialEq)]
pub struct Drawing {
    half_mm: [f64; 2],
    reach_mm: f64,
    paints: Arc<[Paint]>,
    outlines: Arc<[Vec<[f64; 2]>]>,
    grid: Grid,
}

/// Distance from an outline at which the transmittance on its two sides is tested, as a fraction of an edge.
const BESIDE: f64 = 1e-3;
/// Number of edges of an outline that are tested.
const LOOKS: usize = 16;

impl Drawing {
    /// Creates a drawing on a page of this width and height (mm) with shapes from the lowest to the topmost.
    #[must_use]
    pub fn new(width_mm: f64, height_mm: f64, shapes: &[Painted]) -> Self {
        let edges: Vec<Edge> = (0_u32..).zip(shapes).flat_map(|(at, shape)| edges_of(shape, at)).collect();
        let paints: Arc<[Paint]> = shapes.iter().map(|s| (s.rule, s.transmittance, s.opacity)).collect();
        let half_mm = [0.5 * width_mm, 0.5 * height_mm];
        let far = |x: f64, y: f64| {
            let (x, y) = (x.abs().min(half_mm[0]), y.abs().min(half_mm[1]));
            (x * x + y * y).sqrt()
        };
        let ends = |e: &Edge| far(e.x, e.low).max(far(e.x_at(e.high), e.high));
        let reach_mm = edges.iter().map(ends).fold(0.0, f64::max);
        let outlines = shapes.iter().flat_map(|shape| shape.outlines.iter().cloned()).collect();
        Self { half_mm, reach_mm, grid: Grid::new(half_mm, &edges, &paints), paints, outlines }
    }

    /// Returns the open area as closed rings, mm from the center of the page: outer rings counter-clockwise, holes clockwise. `None` if
    /// outlines cross each other or the edge of the page, or if a part of the drawing is gray.
    #[must_use]
    pub fn rings(&self) -> Option<Vec<Vec<[f64; 2]>>> {
        let mut rings = Vec::new();
        for outline in self.outlines.iter().filter(|o| o.len() > 2) {
            let area: f64 =
                outline.iter().zip(outline.iter().cycle().skip(1)).map(|(a, b)| a[0] * b[1] - a[1] * b[0]).sum();
            let mut ring = outline.clone();
            if area < 0.0 {
                ring.reverse();
            }
            let count = ring.len();
            let mut seen: Option<[f64; 2]> = None;
            for i in (0..count).step_by((count / LOOKS).max(1)) {
                let (a, b) = (ring[i], ring[(i + 1) % count]);
                let (dx, dy) = (b[0] - a[0], b[1] - a[1]);
                let middle = [0.5 * (a[0] + b[0]), 0.5 * (a[1] + b[1])];
                let at = |side: f64| self.transmittance(middle[0] - side * BESIDE * dy, middle[1] + side * BESIDE * dx);
                let both = [at(1.0), at(-1.0)];
                if seen.is_some_and(|seen| seen != both) {
                    return None;
                }
                seen = Some(both);
            }
            match seen {
                Some([1.0, 0.0]) => rings.push(ring),
                Some([0.0, 1.0]) => {
                    ring.reverse();
                    rings.push(ring);
                }
                Some([a, b]) if a == b => {}
                _ => return None,
            }
        }
        Some(rings)
    }

    /// Returns the transmittance (0 to 1) at a point, mm from the center of the page; 0 outside the page.
    #[must_use]
    pub fn transmittance(&self, x_mm: f64, y_mm: f64) -> f64 {
        if !(x_mm.abs() <= self.half_mm[0] && y_mm.abs() <= self.half_mm[1]) {
            return 0.0;
        }
        let (below, edges) = self.grid.at(x_mm, y_mm);
        passing(&self.paints, below, edges, [x_mm, y_mm])
    }

    /// Radius around the center of the page (mm) outside which no light passes.
    #[must_use]
    pub fn reach_mm(&self) -> f64 {
        self.reach_mm
    }
}

/// Returns the transmittance at a point (mm) from the edges of shapes in their order. `below` is the transmittance of what lies below them.
fn passing<'a>(paints: &[Paint], below: f64, edges: impl Iterator<Item = &'a Edge>, [x_mm, y_mm]: [f64; 2]) -> f64 {
    let (mut passes, mut shape, mut winding) = (below, u32::MAX, 0);
    for edge in edges {
        if edge.shape != shape {
            passes = settle(paints, passes, shape, winding);
            (shape, winding) = (edge.shape, 0);
        }
        if y_mm >= edge.low && y_mm < edge.high && edge.x_at(y_mm) > x_mm {
            winding += edge.turn;
        }
    }
    settle(paints, passes, shape, winding)
}

/// Returns the transmittance after a shape is painted at a point that it winds around `winding` times; `passes` is that below it.
fn settle(paints: &[Paint], passes: f64, shape: u32, winding: i32) -> f64 {
    match paints.get(shape as usize) {
        Some((FillRule::NonZero, value, opacity)) if winding != 0 => passes + opacity * (value - passes),
        Some((FillRule::EvenOdd, value, opacity)) if winding % 2 != 0 => passes + opacity * (value - passes),
        _ => passes,
    }
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
