//! Figures made of lines, areas and text, written as SVG or PNG.
//!
//! Both file formats show the same drawing. Text is drawn with the strokes of a built-in [`font`], so no font of the machine is needed, and
//! areas and lines are rasterized as an SVG viewer does it.
//!
//! - [`Canvas`]: lines, polygons, gradients, pictures and text, in CSS pixels, y downward;
//! - [`Axes`]: a frame with ticks, labels and a grid, which maps values to points on the canvas;
//! - [`legend`]: names beside pieces of their lines;
//! - [`Page`]: figures, pictures, tables and texts in one HTML file.
//!
//! ```
//! use spectra_plot::{Axes, Axis, Canvas, Color, Rect, Stroke};
//! let mut canvas = Canvas::new(400.0, 300.0, "A straight line");
//! let axes = Axes::new(Rect::new(60.0, 20.0, 380.0, 250.0), Axis::new("time / s", 0.0, 4.0), Axis::new("distance / m", 0.0, 8.0));
//! axes.draw_frame(&mut canvas);
//! canvas.polyline(&[axes.at(0.0, 0.0), axes.at(4.0, 8.0)], &Stroke::new(Color::BLUE, 1.8));
//! assert!(canvas.to_svg().starts_with("<svg"));
//! ```

#![cfg_attr(not(test), warn(clippy::disallowed_methods))]

mod axes;
mod canvas;
mod color;
pub mod font;
mod geometry;
mod labels;
pub mod legend;
mod page;
mod paint;
mod raster;
mod stroke;
mod svg;
mod text;
mod ticks;
mod write;

pub use axes::{Axes, Axis};
pub use canvas::Canvas;
pub use color::Color;
pub use geometry::{Point, Rect};
pub use labels::Labels;
pub use page::{Cell, Page};
pub use paint::{Paint, Picture, Stop};
pub use raster::Pixels;
pub use stroke::{Cap, Stroke};
pub use text::{Anchor, TextStyle, text_width};
pub use ticks::{Ticks, nice_ticks};
pub use write::{Format, PlotError};
