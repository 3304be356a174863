use super::super::drawing::{Align, Drawing};
use super::super::ink::Ink;
use super::super::shape::{Rectangle, Ring, SiemensStar};
use super::parts::{BLACK, WHITE};

/// Draws a star of 72 cycles, 900 mm across, on a square sheet. Black, two grays and white in the corners relate its tones to
/// reflectance.
pub fn siemens(_seed: u64) -> Drawing {
    let mut drawing = Drawing::new(1000.0, 1000.0, WHITE);
    drawing.add(Ring::new([0.0, 0.0], 462.0, 3.0), BLACK);
    drawing.add(SiemensStar::new([0.0, 0.0], 450.0, 72, 0.0), BLACK);
    drawing.mark("siemens star", [0.0, 0.0], 450.0);
    let corners = [([-1.0, 1.0], 0.03), ([1.0, 1.0], 0.18), ([1.0, -1.0], 0.45), ([-1.0, -1.0], 0.9)];
    for ([x, y], reflectance) in corners {
        let center = [428.0 * x, 428.0 * y];
        drawing.add(Rectangle::new(center, 84.0, 84.0), BLACK);
        drawing.add(Rectangle::new(center, 80.0, 80.0), Ink::Gray(reflectance));
        let name = format!("{}%", (100.0 * reflectance).round());
        drawing.text(&name, [428.0 * x, 428.0 * y - y * 60.0 - 5.0], 10.0, Align::Center, BLACK);
        drawing.mark(format!("gray {name}"), center, 38.0);
    }
    drawing
}
