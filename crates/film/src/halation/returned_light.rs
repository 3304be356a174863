//! Light that makes several trips: the emulsion reflects it down again, and it meets the back once more.

use super::base::HalationBase;
use super::table::Table;
use spectra_numerics::convolve::{Grid, Kernel};
use std::f64::consts::PI;

/// Grid on which trips are chained: cells per radius of the ring, number of cells along a side, and number of cells up to which the result
/// is read.
const FINENESS: f64 = 8.0;
const SIDE: usize = 512;
const READ: usize = 128;

/// Subdivisions of a cell along a side over which the first trip is averaged.
const PARTS: usize = 3;

/// All light that returns from a point, over all trips.
pub struct ReturnedLight {
    base: HalationBase,
    /// Light that returns after the first trip, relative to the light that exposes the layer.
    once: f64,
    /// Light of further trips: the sampling step (mm) and the density at each sample, per unit of light that enters. `None`
    /// without further trips.
    again: Option<(f64, Vec<f64>)>,
    /// Ratio of further trips to the first one, from the last sample on.
    beyond: f64,
}

impl ReturnedLight {
    /// Computes all trips in `base`.
    ///
    /// Each trip spreads light as the first does, and the share `reflected` of the arriving light starts the next one. With b(r) for one
    /// trip, the sum is b + reflected b * b + reflected^2 b * b * b and so on, computed as a geometric series of transforms.
    #[must_use]
    pub fn new(base: &HalationBase) -> Self {
        let mut trips = Self { base: *base, once: base.returned(), again: None, beyond: 0.0 };
        let unit = HalationBase { entering: 1.0, reflected: 0.0, ..*base };
        let once = unit.returned();
        if base.reflected == 0.0 || base.entering == 0.0 || once == 0.0 {
            return trips;
        }
        let cell = base.ring_radius_mm() / FINENESS;
        let table = Table::new(cell * SIDE as f64, &|r| unit.density_per_mm2(r));
        let first = Kernel::new(SIDE / 2, |i, j| {
            let part = |k: usize| (k as f64 + 0.5) / PARTS as f64 - 0.5;
            let mut sum = 0.0;
            for y in 0..PARTS {
                for x in 0..PARTS {
                    let (x, y) = ((i as f64 + part(x)) * cell, (j as f64 + part(y)) * cell);
                    sum += table.at((x * x + y * y).sqrt());
                }
            }
            sum / (PARTS * PARTS) as f64 * cell * cell
        });
        let mut grid = Grid::new(SIDE);
        let first = grid.transform(&first);
        // Light beyond the grid and between its cells is missing in the sum; the known total corrects the scale.
        let scale = once / first.weight(0, 0);
        let series = Kernel::new(SIDE / 2, |u, v| {
            let b = scale * first.weight(u, v);
            base.reflected * b * b / (1.0 - base.reflected * b)
        });
        let again = grid.transform(&series);
        let points = (SIDE * SIDE) as f64;
        let mut values: Vec<f64> = (0..=READ).map(|i| (again.weight(i, 0) / points / (cell * cell)).max(0.0)).collect();
        let end = unit.density_per_mm2(READ as f64 * cell);
        let beyond = if end > 0.0 { values[READ] / end } else { 0.0 };
        // The integral must equal that of the series.
        trips.again = Some((cell, values.clone()));
        trips.beyond = beyond;
        let want = base.reflected * once * once / (1.0 - base.reflected * once);
        let correction = want / trips.again_weighted(|_| 1.0);
        values.iter_mut().for_each(|v| *v *= correction);
        trips.again = Some((cell, values));
        trips.beyond *= correction;
        trips
    }

    /// Returns the light that comes back at the distance `r_mm` from an exposed point, relative to the light that exposes the
    /// point, per mm^2.
    #[must_use]
    pub fn density_per_mm2(&self, r_mm: f64) -> f64 {
        self.base.density_per_mm2(r_mm) + self.again(r_mm)
    }

    fn again(&self, r_mm: f64) -> f64 {
        let Some((cell, values)) = &self.again else { return 0.0 };
        let place = r_mm / cell;
        let k = place as usize;
        if k >= READ {
            return self.beyond * self.base.density_per_mm2(r_mm);
        }
        self.base.entering * (values[k] + (values[k + 1] - values[k]) * (place - k as f64))
    }

    /// Returns the halation of all trips: the light that comes back from the base, relative to the light that exposes the layer.
    /// It is the integral of [`ReturnedLight::density_per_mm2`] over the plane.
    #[must_use]
    pub fn returned(&self) -> f64 {
        let once = self.once;
        if self.again.is_none() {
            return once;
        }
        let part = self.base.reflected * once / self.base.entering;
        once / (1.0 - part)
    }

    /// Integral of `weight(r_mm)` times the light that returns at r, for a smooth weight.
    pub(super) fn returned_weighted(&self, weight: impl Fn(f64) -> f64) -> f64 {
        let again = if self.again.is_some() { self.base.entering * self.again_weighted(&weight) } else { 0.0 };
        self.base.returned_weighted(weight) + again
    }

    /// Integral of the light of further trips, per unit of light that enters.
    fn again_weighted(&self, weight: impl Fn(f64) -> f64) -> f64 {
        const STEPS: usize = 8;
        let Some((cell, _)) = &self.again else { return 0.0 };
        let end = READ as f64 * cell;
        let step = cell / STEPS as f64;
        let near: f64 = (0..READ * STEPS)
            .map(|k| (k as f64 + 0.5) * step)
            .map(|r| self.again(r) / self.base.entering * weight(r) * 2.0 * PI * r * step)
            .sum();
        let far = |r: f64| if r >= end { weight(r) } else { 0.0 };
        near + self.beyond * self.base.returned_weighted(far) / self.base.entering
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use spectra_core::math::cos;

    const ACETATE: HalationBase =
        HalationBase { thickness_mm: 0.125, index: 1.48, entering: 0.4, transmittance: 0.9, reflected: 0.0 };

    /// Two trips, by quadrature over the plane: around the point of the first landing, in rings.
    #[test]
    fn the_second_trip_is_the_first_convolved_with_itself() {
        let reflected = 0.01;
        let trips = ReturnedLight::new(&HalationBase { reflected, ..ACETATE });
        let unit = HalationBase { entering: 1.0, ..ACETATE };
        for r in [0.06, 0.2, 0.35, 0.46, 0.7, 1.5] {
            // b * b at r: rings of radius s around one end, in s = x / (1 - x), and the angle.
            let mut sum = 0.0;
            let (rings, angles) = (3000, 400);
            for k in 0..rings {
                let x = (f64::from(k) + 0.5) / f64::from(rings);
                let s = 0.3 * x / (1.0 - x);
                let ds = 0.3 / ((1.0 - x) * (1.0 - x)) / f64::from(rings);
                let mut around = 0.0;
                for a in 0..angles {
                    let angle = (f64::from(a) + 0.5) * PI / f64::from(angles);
                    around += unit.density_per_mm2((r * r + s * s - 2.0 * r * s * cos(angle)).max(0.0).sqrt());
                }
                sum += unit.density_per_mm2(s) * 2.0 * PI * s * ds * around / f64::from(angles);
            }
            // The third trip adds about 1 % of the second here.
            let want = ACETATE.entering * reflected * sum / (1.0 - reflected * unit.returned());
            let got = trips.density_per_mm2(r) - ACETATE.density_per_mm2(r);
            println!("{r} mm: {got:.5e}, by quadrature {want:.5e}");
            assert!((got / want - 1.0).abs() < 0.03, "{r}: {got} {want}");
        }
    }

    /// All trips together are the geometric series, and the density sums to it.
    #[test]
    fn all_trips_are_a_geometric_series() {
        for (reflected, transmittance) in [(0.3, 1.0), (0.5, 0.6), (0.3, 0.05)] {
            let base = HalationBase { reflected, transmittance, ..ACETATE };
            let once = HalationBase { reflected: 0.0, ..base }.returned();
            let trips = ReturnedLight::new(&base);
            let want = once / (1.0 - reflected * once / base.entering);
            assert!((trips.returned() / want - 1.0).abs() < 1e-9);
            assert!((trips.returned_weighted(|_| 1.0) / want - 1.0).abs() < 1e-6);
        }
        assert_eq!(ReturnedLight::new(&ACETATE).returned(), ACETATE.returned());
    }
}
