use super::super::drawing::{Align, Drawing};
use super::super::ink::Ink;
use super::super::shape::Rectangle;
use super::parts::{BLACK, WHITE};

/// Draws a 21-step tablet: densities from 0.05 to 3.05 in steps of 0.15 (the nominal densities of the Stouffer T2115), as
/// reflectances 10^-density. Two rows run in opposite directions: what is the same in both is tone, what differs is
/// vignetting or flare.
pub fn step_wedge(_seed: u64) -> Drawing {
    let mut drawing = Drawing::new(1500.0, 750.0, Ink::Gray(0.18));
    let pitch = 66.0;
    for (side, y) in [(1.0, 150.0), (-1.0, -150.0)] {
        drawing.add(Rectangle::new([0.0, y], 21.0 * pitch + 12.0, 200.0 + 12.0), BLACK);
        for step in 0..21_u32 {
            let x = side * pitch * (f64::from(step) - 10.0);
            let density = 0.05 + 0.15 * f64::from(step);
            drawing.add(Rectangle::new([x, y], pitch, 200.0), Ink::density(density));
            drawing.mark(format!("density {density:.2}"), [x, y], 0.5 * pitch);
            drawing.text(&format!("{density:.2}"), [x, y + side * 128.0 - 8.0], 16.0, Align::Center, WHITE);
        }
    }
    drawing.text("DENSITY", [0.0, -8.0], 16.0, Align::Center, WHITE);
    drawing
}
