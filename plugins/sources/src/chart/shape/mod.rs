//! Shapes of a chart. Each is exact at a point and conservative over a cell.
//!
//! Coordinates are millimetres on the chart: origin at its center, +x to the right as a person sees
//! the upright chart, +y up; angles run counter-clockwise from +x. Borders belong to the shape,
//! but for the far sides of wedge lines and star sectors, which are half open.

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

/// One shape.
#[derive(Clone, Debug)]
pub enum Shape {
    /// Rectangle at any angle: panels, lines, slanted edges.
    Rectangle(Rectangle),
    /// Disk or ring.
    Ring(Ring),
    /// Polygon by its corners.
    Polygon(Polygon),
    /// Hyperbolic resolution wedge, or parallel lines.
    Wedge(Wedge),
    /// Siemens star.
    SiemensStar(SiemensStar),
    /// Straight pen stroke.
    Stroke(Stroke),
    /// Pen stroke along an arc.
    Arc(Arc),
}

/// Passes a call on to whichever shape it is.
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
    /// Whether the point lies in the shape.
    #[inline]
    #[must_use]
    pub fn contains(&self, x_mm: f64, y_mm: f64) -> bool {
        each!(self, shape => shape.contains(x_mm, y_mm))
    }

    /// How much of `cell` the shape covers.
    #[must_use]
    pub fn coverage(&self, cell: &Cell) -> Coverage {
        each!(self, shape => shape.coverage(cell))
    }

    /// The shape `factor` times as large, about the center of the chart.
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

/// Point times factor.
fn times(point_mm: [f64; 2], factor: f64) -> [f64; 2] {
    [point_mm[0] * factor, point_mm[1] * factor]
}

#[cfg(test)]
mod tests;
