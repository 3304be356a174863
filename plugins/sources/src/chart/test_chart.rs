//! A finished chart, which knows the ink at every point.

use super::grid::Grid;
use super::ink::Ink;
use super::shape::Shape;
use spectra_core::Isa;

/// A named part of the chart that a measurement may need to find.
#[derive(Clone, Debug, PartialEq)]
pub struct Landmark {
    /// Name of the part, such as that of a patch, `siemens star` or `slanted edge +5`.
    pub name: String,
    /// Center of the part on the chart, mm.
    pub center_mm: [f64; 2],
    /// Radius about the center within which there is nothing else, mm.
    pub radius_mm: f64,
}

impl Landmark {
    fn scaled(&self, factor: f64) -> Self {
        let [x, y] = self.center_mm;
        Self { name: self.name.clone(), center_mm: [x * factor, y * factor], radius_mm: self.radius_mm * factor }
    }
}

/// A test chart: gives the ink at any point, exactly at any magnification.
///
/// Coordinates are millimeters: origin at the center, +x to the right as a person sees the upright chart, +y up.
#[derive(Clone, Debug)]
pub struct Chart {
    name: &'static str,
    width_mm: f64,
    height_mm: f64,
    inks: Vec<Ink>,
    shapes: Vec<(Shape, u16)>,
    landmarks: Vec<Landmark>,
    /// Fraction of the chart that each ink covers.
    areas: Vec<f64>,
    grid: Grid,
}

/// Number of sample points along a side with which the areas of the inks are counted.
const CENSUS: usize = 512;

impl Chart {
    pub(super) fn new(
        name: &'static str,
        width_mm: f64,
        height_mm: f64,
        inks: Vec<Ink>,
        shapes: Vec<(Shape, u16)>,
        landmarks: Vec<Landmark>,
    ) -> Self {
        let grid = Grid::new(width_mm, height_mm, &shapes);
        let mut areas = vec![0.0; inks.len()];
        let step = |i: usize| (i as f64 + 0.5) / CENSUS as f64 - 0.5;
        for i in 0..CENSUS {
            for j in 0..CENSUS {
                let ink = grid.ink_at(&shapes, step(i) * width_mm, step(j) * height_mm);
                if let Some(area) = areas.get_mut(usize::from(ink)) {
                    *area += 1.0 / (CENSUS * CENSUS) as f64;
                }
            }
        }
        Self { name, width_mm, height_mm, inks, shapes, landmarks, areas, grid }
    }

    /// Returns the chart scaled to `width_mm`.
    pub(super) fn scaled(&self, width_mm: f64) -> Self {
        let factor = width_mm / self.width_mm;
        let height_mm = self.height_mm * factor;
        Self {
            name: self.name,
            width_mm,
            height_mm,
            inks: self.inks.clone(),
            shapes: self.shapes.iter().map(|(shape, ink)| (shape.clone().scaled(factor), *ink)).collect(),
            landmarks: self.landmarks.iter().map(|landmark| landmark.scaled(factor)).collect(),
            areas: self.areas.clone(),
            grid: self.grid.scaled(width_mm, height_mm),
        }
    }

    /// Name of the chart in [`CHARTS`](super::CHARTS).
    #[must_use]
    pub fn name(&self) -> &'static str {
        self.name
    }

    /// Width of the chart, mm.
    #[must_use]
    pub fn width_mm(&self) -> f64 {
        self.width_mm
    }

    /// Height of the chart, mm.
    #[must_use]
    pub fn height_mm(&self) -> f64 {
        self.height_mm
    }

    /// Inks of the chart, by the index that [`Chart::ink_at`] returns; 0 is the ground.
    #[must_use]
    pub fn inks(&self) -> &[Ink] {
        &self.inks
    }

    /// Fraction of the chart that each ink covers, in the order of [`Chart::inks`], counted at 512 x 512 points. The sum is 1,
    /// and the values do not depend on the width.
    #[must_use]
    pub fn areas(&self) -> &[f64] {
        &self.areas
    }

    /// Landmarks of the chart, in the order in which they were drawn.
    #[must_use]
    pub fn landmarks(&self) -> &[Landmark] {
        &self.landmarks
    }

    /// Returns the index of the ink at a point, mm; [`NO_INK`](super::NO_INK) outside the chart and for NaN coordinates.
    #[inline]
    #[must_use]
    pub fn ink_at(&self, x_mm: f64, y_mm: f64) -> u16 {
        self.grid.ink_at(&self.shapes, x_mm, y_mm)
    }

    /// Writes [`Chart::ink_at`] of each point (`x_mm[i]`, `y_mm[i]`) to `ink[i]`; stops at the end of the shortest slice.
    pub fn ink_at_batch(&self, x_mm: &[f64], y_mm: &[f64], ink: &mut [u16], isa: Isa) {
        self.grid.ink_at_batch(&self.shapes, x_mm, y_mm, ink, isa);
    }

    /// Number of shapes on the chart.
    #[must_use]
    pub fn shape_count(&self) -> usize {
        self.shapes.len()
    }

    /// Memory used by the acceleration grid, bytes.
    #[must_use]
    pub fn grid_bytes(&self) -> usize {
        self.grid.bytes()
    }

    /// Returns the ink at a point by testing every shape, as a reference for [`Chart::ink_at`].
    #[cfg(test)]
    pub(super) fn ink_by_all_shapes(&self, x_mm: f64, y_mm: f64) -> u16 {
        if !(x_mm.abs() <= 0.5 * self.width_mm && y_mm.abs() <= 0.5 * self.height_mm) {
            return super::NO_INK;
        }
        let top = self.shapes.iter().rev().find(|(shape, _)| shape.contains(x_mm, y_mm));
        top.map_or(0, |&(_, ink)| ink)
    }
}
