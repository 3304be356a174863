//! Builder of a chart: a drawing of shapes and text.

use super::font::{self, Pen};
use super::ink::Ink;
use super::shape::{Arc, Shape, Stroke};
use super::test_chart::{Chart, Landmark};

/// Alignment of a line of text with its anchor.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Align {
    /// The text begins at the anchor.
    Left,
    /// The text is centered on the anchor.
    Center,
    /// The text ends at the anchor.
    Right,
}

/// Shapes on a ground, later ones on top, in millimeters of the drawing (origin at the center, +x right, +y up). The finished
/// chart can be scaled to any size.
#[derive(Debug)]
pub struct Drawing {
    width_mm: f64,
    height_mm: f64,
    inks: Vec<Ink>,
    shapes: Vec<(Shape, u16)>,
    landmarks: Vec<Landmark>,
}

impl Drawing {
    /// Creates an empty sheet in the ink `ground`, `width_mm` x `height_mm`, both positive.
    #[must_use]
    pub fn new(width_mm: f64, height_mm: f64, ground: Ink) -> Self {
        Self { width_mm, height_mm, inks: vec![ground], shapes: Vec::new(), landmarks: Vec::new() }
    }

    /// Draws a shape in `ink`.
    pub fn add(&mut self, shape: impl Into<Shape>, ink: Ink) {
        let index = match self.inks.iter().position(|&known| known == ink) {
            Some(index) => index,
            None => {
                self.inks.push(ink);
                self.inks.len() - 1
            }
        };
        let index = u16::try_from(index).expect("a design has a few hundred inks at most");
        self.shapes.push((shape.into(), index));
    }

    /// Adds a landmark called `name` with its center, and the radius around it within which nothing else is drawn.
    pub fn mark(&mut self, name: impl Into<String>, center_mm: [f64; 2], radius_mm: f64) {
        self.landmarks.push(Landmark { name: name.into(), center_mm, radius_mm });
    }

    /// Writes a line of text in `ink`. `anchor_mm` lies on its lower edge, and capitals are `height_mm` tall from edge to
    /// edge.
    pub fn text(&mut self, text: &str, anchor_mm: [f64; 2], height_mm: f64, align: Align, ink: Ink) {
        let unit_mm = height_mm / font::CAPITAL_HEIGHT;
        let width_mm = text_width_mm(text, height_mm);
        let left_mm = match align {
            Align::Left => anchor_mm[0],
            Align::Center => anchor_mm[0] - 0.5 * width_mm,
            Align::Right => anchor_mm[0] - width_mm,
        };
        // The pen is one unit wide: its center runs half a unit inside the edges.
        let mut x_mm = left_mm + 0.5 * unit_mm;
        let y_mm = anchor_mm[1] + 0.5 * unit_mm;
        for character in text.chars() {
            let (_, width, pens) = font::glyph(character);
            let place = |x: f64, y: f64| [x_mm + x * unit_mm, y_mm + y * unit_mm];
            for pen in *pens {
                match *pen {
                    Pen::Path([(x, y)]) => self.add(Stroke::new(place(*x, *y), place(*x, *y), unit_mm), ink),
                    Pen::Path(points) => {
                        for ends in points.windows(2) {
                            let [from, to] = [place(ends[0].0, ends[0].1), place(ends[1].0, ends[1].1)];
                            self.add(Stroke::new(from, to, unit_mm), ink);
                        }
                    }
                    Pen::Turn(x, y, radius, start, sweep) => {
                        let [start_rad, sweep_rad] = [start.to_radians(), sweep.to_radians()];
                        self.add(Arc::new(place(x, y), radius * unit_mm, start_rad, sweep_rad, unit_mm), ink);
                    }
                }
            }
            x_mm += (width + font::SPACING) * unit_mm;
        }
    }

    /// Returns the finished chart, in the size of the drawing.
    #[must_use]
    pub fn finish(self, name: &'static str) -> Chart {
        Chart::new(name, self.width_mm, self.height_mm, self.inks, self.shapes, self.landmarks)
    }
}

/// Returns the width in mm, from edge to edge, of a line of text whose capitals are `height_mm` high.
#[must_use]
pub fn text_width_mm(text: &str, height_mm: f64) -> f64 {
    let unit_mm = height_mm / font::CAPITAL_HEIGHT;
    let letters: f64 = text.chars().map(|c| font::glyph(c).1 + font::SPACING).sum();
    (letters - font::SPACING + 1.0).max(0.0) * unit_mm
}
