use super::super::drawing::Drawing;
use super::super::ink::Ink;

/// Draws a uniform sheet of 18 % reflectance.
pub fn gray_card(_seed: u64) -> Drawing {
    Drawing::new(1500.0, 1000.0, Ink::Gray(0.18))
}

/// Draws a uniform sheet of reflectance 1.
pub fn white(_seed: u64) -> Drawing {
    Drawing::new(1500.0, 1000.0, Ink::Gray(1.0))
}
