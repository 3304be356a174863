use super::super::drawing::Drawing;
use super::super::ink::Ink;

/// Sheet of 18 % reflectance.
pub fn gray_card(_seed: u64) -> Drawing {
    Drawing::new(1500.0, 1000.0, Ink::Gray(0.18))
}

/// Sheet of reflectance 1.
pub fn white(_seed: u64) -> Drawing {
    Drawing::new(1500.0, 1000.0, Ink::Gray(1.0))
}
