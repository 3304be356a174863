use super::super::drawing::Drawing;
use super::super::shape::{Rectangle, Ring};
use super::parts::{BLACK, WHITE};

/// Draws white lines of 2 mm, 50 mm apart; the two through the center are twice as wide. Each crossing of the coarse grid
/// has a dot.
pub fn grid(_seed: u64) -> Drawing {
    let mut drawing = Drawing::new(1500.0, 1000.0, BLACK);
    let width = |k: i32| if k == 0 { 4.0 } else { 2.0 };
    for k in -14..=14 {
        let x = 50.0 * f64::from(k);
        drawing.add(Rectangle::new([x, 0.0], width(k), 900.0 + 2.0), WHITE);
    }
    for k in -9..=9 {
        let y = 50.0 * f64::from(k);
        drawing.add(Rectangle::new([0.0, y], 1400.0 + 2.0, width(k)), WHITE);
    }
    for column in -2..=2 {
        for row in -1..=1 {
            let center = [300.0 * f64::from(column), 300.0 * f64::from(row)];
            drawing.add(Ring::disk(center, if column == 0 && row == 0 { 10.0 } else { 7.0 }), WHITE);
            drawing.mark("crossing", center, 25.0);
        }
    }
    drawing
}
