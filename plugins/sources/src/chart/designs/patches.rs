use super::super::drawing::Drawing;
use super::super::ink::Ink;
use super::super::shape::Rectangle;
use super::parts::FRAME;

/// Draws `count` patches with the user's reflectances, row by row from the top left: squares of 40 mm with gaps of 6 mm, about
/// three columns for every two rows.
pub fn patches(count: u16) -> Drawing {
    let count = count.max(1);
    let columns = (1..=count).find(|c| u32::from(*c) * u32::from(*c) * 2 >= u32::from(count) * 3).unwrap_or(count);
    let rows = count.div_ceil(columns);
    let side = |n: u16| f64::from(n) * 46.0 + 6.0;
    let mut drawing = Drawing::new(side(columns), side(rows), FRAME);
    for i in 0..count {
        let (column, row) = (f64::from(i % columns), f64::from(i / columns));
        let middle = |n: u16| 0.5 * f64::from(n - 1);
        let place = [46.0 * (column - middle(columns)), 46.0 * (middle(rows) - row)];
        drawing.add(Rectangle::new(place, 40.0, 40.0), Ink::Own(i));
        drawing.mark(format!("patch {}", i + 1), place, 20.0);
    }
    drawing
}
