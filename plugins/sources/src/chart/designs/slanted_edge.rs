use super::super::drawing::{Align, Drawing};
use super::super::ink::Ink;
use super::super::shape::Rectangle;
use super::parts::BLACK;

/// Draws squares of reflectance 0.2 on a ground of 0.8: the contrast of 4:1 that ISO 12233 (2014 and later) requires, which
/// neither clips nor rings in a picture. The squares lean alternately by +5 and -5 degrees.
pub fn slanted_edge(_seed: u64) -> Drawing {
    let ground = Ink::Gray(0.8);
    let mut drawing = Drawing::new(1500.0, 1000.0, ground);
    for column in -3..=3_i32 {
        for row in -2..=2_i32 {
            let center = [200.0 * f64::from(column), 172.0 * f64::from(row)];
            let degrees: f64 = if (column + row) % 2 == 0 { 5.0 } else { -5.0 };
            drawing.add(Rectangle::new(center, 100.0, 100.0).turned(degrees.to_radians()), Ink::Gray(0.2));
            drawing.mark(format!("slanted edge {degrees:+}"), center, 87.0);
        }
    }
    for side in [-1.0, 1.0] {
        drawing.add(Rectangle::new([0.0, 455.0 * side], 1400.0, 30.0), BLACK);
    }
    drawing.text("SPECTRA", [-688.0, -462.0], 14.0, Align::Left, ground);
    drawing.text("SLANTED EDGES 5\u{b0}  4:1", [688.0, -462.0], 14.0, Align::Right, ground);
    drawing
}
