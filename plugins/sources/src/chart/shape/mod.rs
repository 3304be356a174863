//! Shapes of a chart. Each is exact at a point and conservative over a cell.
//!
//! Coordinates are millimeters on the chart: origin at its center, +x to the right as a person sees the upright chart, +y up.
//! Angles are measured counterclockwise from +x. Borders belong to the shape, except for the far sides of wedge lines and star
//! sectors, which are half open.

mod polygon;
mod rectangle;
mod ring;
mod star;
mod stroke;
mod wedge;

pub use polygon::Polygon;
pub use rectangle::Rectangle;
pub use ring::Ring;
pub use star::SiemensStar;
pub use stroke::{Arc, Stroke};
pub use wedge::Wedge;

use super::cell::{Cell, Coverage};

/// One shape of a chart.
#[derive(Clone, Debug)]
pub enum Shape {
    /// A rectangle at any angle: panels, lines, slanted edges.
    Rectangle(Rectangle),
    /// A disk or a ring.
    Ring(Ring),
    /// A polygon given by its corners.
    Polygon(Polygon),
    /// A hyperbolic resolution wedge, or parallel lines.
    Wedge(Wedge),
    /// A Siemens star.
    SiemensStar(SiemensStar),
    /// A straight pen stroke.
    Stroke(Stroke),
    /// A pen stroke along an arc.
    Arc(Arc),
}

/// Forwards a call to the variant's shape.
macro_rules! each {
    ($shape:expr, $inner:ident => $call:expr) => {
        match $shape {
            Shape::Rectangle($inner) => $call,
            Shape::Ring($inner) => $call,
            Shape::Polygon($inner) => $call,
            Shape::Wedge($inner) => $call,
            Shape::SiemensStar($inner) => $call,
            Shape::Stroke($inner) => $call,
            Shape::Arc($inner) => $call,
        }
    };
}

impl Shape {
    /// Returns whether the point lies in the shape.
    #[inline]
    #[must_use]
    pub fn contains(&self, x_mm: f64, y_mm: f64) -> bool {
        each!(self, shape => shape.contains(x_mm, y_mm))
    }

    /// Returns how much of `cell` the shape covers.
    #[must_use]
    pub fn coverage(&self, cell: &Cell) -> Coverage {
        each!(self, shape => shape.coverage(cell))
    }

    /// Scales the shape by `factor` about the center of the chart.
    #[must_use]
    pub fn scaled(self, factor: f64) -> Self {
        match self {
            Self::Rectangle(shape) => Self::Rectangle(shape.scaled(factor)),
            Self::Ring(shape) => Self::Ring(shape.scaled(factor)),
            Self::Polygon(shape) => Self::Polygon(shape.scaled(factor)),
            Self::Wedge(shape) => Self::Wedge(shape.scaled(factor)),
            Self::SiemensStar(shape) => Self::SiemensStar(shape.scaled(factor)),
            Self::Stroke(shape) => Self::Stroke(shape.scaled(factor)),
            Self::Arc(shape) => Self::Arc(shape.scaled(factor)),
        }
    }
}

macro_rules! from_shape {
    ($($name:ident),*) => {
        $(impl From<$name> for Shape {
            fn from(shape: $name) -> Self {
                Self::$name(shape)
            }
        })*
    };
}

from_shape!(Rectangle, Ring, Polygon, Wedge, SiemensStar, Stroke, Arc);

/// Multiplies a point by a factor.
fn times(point_mm: [f64; 2], factor: f64) -> [f64; 2] {
    [point_mm[0] * factor, point_mm[1] * factor]
}

#[cfg(test)]
mod tests;
