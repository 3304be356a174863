//! Plane-parallel plates directly in front of a frame, and how they shift the focus.

use crate::spectral::Grid;

/// A plane-parallel plate in front of a frame.
#[derive(Clone, Debug, PartialEq)]
pub struct CoverPlate {
    /// Thickness, mm.
    pub thickness_mm: f64,
    /// Refractive index at each wavelength of the stack's grid.
    pub index: Vec<f64>,
}

/// A stack of plane-parallel plates in front of a frame, such as cover glass, filters and low-pass plates. The gaps between the
/// plates and their order make no difference.
///
/// A plate of thickness t and index n leaves the direction of a ray unchanged. On the frame, the ray lands t (tan i - tan i')
/// away from the point that it would reach without the plate, on the side that it comes from. Here i is the angle of incidence,
/// and i' the angle in the plate by Snell's law. Near the axis the image moves t (1 - 1/n) away from the lens.
#[derive(Clone, Debug, PartialEq)]
pub struct CoverStack {
    grid: Grid,
    plates: Vec<CoverPlate>,
}

impl CoverStack {
    /// Creates a stack of plates, whose indices are given at the wavelengths of `grid`.
    #[must_use]
    pub fn new(grid: &Grid, plates: Vec<CoverPlate>) -> Self {
        Self { grid: *grid, plates }
    }

    /// Returns a stack of the same plates whose index no longer varies: it is the index at `wavelength_nm` everywhere.
    #[must_use]
    pub fn at_wavelength(&self, wavelength_nm: f64) -> Self {
        let held = |p: &CoverPlate| CoverPlate { index: vec![self.index(p, wavelength_nm); self.grid.count], ..*p };
        Self { grid: self.grid, plates: self.plates.iter().map(held).collect() }
    }

    /// Returns how far (mm) the plates move the image near the axis away from the lens, at `wavelength_nm`.
    #[must_use]
    pub fn shift_mm(&self, wavelength_nm: f64) -> f64 {
        self.depth_mm(0.0, wavelength_nm)
    }

    /// Returns how far (mm) the plates move the point at which light of a given slope meets the frame, along the normal and away
    /// from the lens. `slope` is the tangent of the angle between the light and the normal. On the frame, the light lands `slope`
    /// times this distance to the side, toward where it came from.
    #[must_use]
    pub fn depth_mm(&self, slope: f64, wavelength_nm: f64) -> f64 {
        let cos2 = 1.0 / (1.0 + slope * slope);
        let (cos, sin2) = (cos2.sqrt(), 1.0 - cos2);
        let one = |p: &CoverPlate| {
            let n = self.index(p, wavelength_nm);
            p.thickness_mm * (1.0 - cos / (n * n - sin2).sqrt())
        };
        self.plates.iter().map(one).sum()
    }

    /// Index of a plate at a wavelength, at least 1; outside the band the value at its end.
    fn index(&self, plate: &CoverPlate, wavelength_nm: f64) -> f64 {
        let inside = wavelength_nm.clamp(self.grid.start_nm, self.grid.end_nm());
        self.grid.interpolate(&plate.index, inside).max(1.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// 2 mm of index 1.5: two thirds of a millimeter; at 45 degrees by Snell's law; a second plate adds.
    #[test]
    fn a_plate_moves_the_image_as_snell_says() {
        let grid = Grid { start_nm: 400.0, step_nm: 100.0, count: 3 };
        let plate = |thickness_mm: f64, n: f64| CoverPlate { thickness_mm, index: vec![n, n, n] };
        let one = CoverStack::new(&grid, vec![plate(2.0, 1.5)]);
        assert!((one.shift_mm(500.0) - 2.0 / 3.0).abs() < 1e-15);
        let inside = libm::asin(libm::sin(std::f64::consts::FRAC_PI_4) / 1.5);
        assert!((one.depth_mm(1.0, 500.0) - 2.0 * (1.0 - libm::tan(inside))).abs() < 1e-14);
        let two = CoverStack::new(&grid, vec![plate(2.0, 1.5), plate(1.0, 1.6)]);
        assert!((two.shift_mm(500.0) - 2.0 / 3.0 - 0.375).abs() < 1e-15);
        let colored = CoverStack::new(&grid, vec![CoverPlate { thickness_mm: 1.0, index: vec![1.6, 1.5, 1.45] }]);
        assert_eq!(colored.shift_mm(300.0).to_bits(), colored.shift_mm(400.0).to_bits(), "held beyond the band");
        assert_eq!(colored.at_wavelength(450.0).shift_mm(600.0).to_bits(), colored.shift_mm(450.0).to_bits());
    }
}
