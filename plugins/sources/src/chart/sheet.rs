//! A finished chart.

use super::grid::Grid;
use super::ink::Ink;
use super::shape::Shape;
use spectra_core::Isa;

/// A place of the chart that a measurement may want to find again.
#[derive(Clone, Debug, PartialEq)]
pub struct Landmark {
    /// What is there: the name of a patch, `siemens star`, `slanted edge +5` ...
    pub name: String,
    /// Its center on the chart, mm.
    pub center_mm: [f64; 2],
    /// Radius about the center within which it lies alone, mm.
    pub radius_mm: f64,
}

impl Landmark {
    fn scaled(&self, factor: f64) -> Self {
        let [x, y] = self.center_mm;
        Self { name: self.name.clone(), center_mm: [x * factor, y * factor], radius_mm: self.radius_mm * factor }
    }
}

/// A test chart: which ink lies at which point, exact at any magnification.
///
/// Coordinates are millimetres: origin at the center, +x to the right as a person sees the upright
/// chart, +y up.
#[derive(Clone, Debug)]
pub struct Chart {
    name: &'static str,
    width_mm: f64,
    height_mm: f64,
    inks: Vec<Ink>,
    shapes: Vec<(Shape, u16)>,
    landmarks: Vec<Landmark>,
    /// Part of the chart that each ink covers.
    areas: Vec<f64>,
    grid: Grid,
}

/// Points a side at which a chart is looked at to weigh its inks.
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

    /// The same `width_mm` wide, everything in proportion.
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

    /// Name in the list of charts.
    #[must_use]
    pub fn name(&self) -> &'static str {
        self.name
    }

    /// Width, mm.
    #[must_use]
    pub fn width_mm(&self) -> f64 {
        self.width_mm
    }

    /// Height, mm.
    #[must_use]
    pub fn height_mm(&self) -> f64 {
        self.height_mm
    }

    /// The inks, by the index that [`Chart::ink_at`] answers; 0 is the ground.
    #[must_use]
    pub fn inks(&self) -> &[Ink] {
        &self.inks
    }

    /// The part of the chart that each ink covers, in all 1, by a count of 512 x 512 points: whatever the width, the same.
    #[must_use]
    pub fn areas(&self) -> &[f64] {
        &self.areas
    }

    /// Named places, in the order in which they were drawn.
    #[must_use]
    pub fn landmarks(&self) -> &[Landmark] {
        &self.landmarks
    }

    /// Index of the ink at a point; [`NO_INK`](super::NO_INK) outside of the chart, and for coordinates that are not numbers.
    #[inline]
    #[must_use]
    pub fn ink_at(&self, x_mm: f64, y_mm: f64) -> u16 {
        self.grid.ink_at(&self.shapes, x_mm, y_mm)
    }

    /// [`Chart::ink_at`] for each point (`x_mm[i]`, `y_mm[i]`), into `ink[i]`; stops at the shortest slice.
    pub fn ink_at_batch(&self, x_mm: &[f64], y_mm: &[f64], ink: &mut [u16], isa: Isa) {
        self.grid.ink_at_batch(&self.shapes, x_mm, y_mm, ink, isa);
    }

    /// Number of shapes.
    #[must_use]
    pub fn shape_count(&self) -> usize {
        self.shapes.len()
    }

    /// Bytes that the acceleration grid takes.
    #[must_use]
    pub fn grid_bytes(&self) -> usize {
        self.grid.bytes()
    }

    /// What [`Chart::ink_at`] must answer, found by asking every shape.
    #[cfg(test)]
    pub(super) fn ink_by_all_shapes(&self, x_mm: f64, y_mm: f64) -> u16 {
        if !(x_mm.abs() <= 0.5 * self.width_mm && y_mm.abs() <= 0.5 * self.height_mm) {
            return super::NO_INK;
        }
        let top = self.shapes.iter().rev().find(|(shape, _)| shape.contains(x_mm, y_mm));
        top.map_or(0, |&(_, ink)| ink)
    }
}
