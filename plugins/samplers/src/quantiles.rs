//! A continuous density by its quantiles.

use spectra_core::spectral::Grid;

/// Number of quantile intervals: 8 kB, fine enough that an interval which straddles the edge of a
/// response holds a thousandth of the samples.
pub const INTERVALS: usize = 1024;

/// A density that is constant between neighboring quantiles and positive on its whole range. The
/// draw is monotone in its number, so strata stay strata, and its density is known exactly.
#[derive(Clone, Debug)]
pub struct Quantiles {
    edges: Box<[f64; INTERVALS + 1]>,
}

/// Finer steps in which the density is summed, per point of the grid.
const STEPS: usize = 16;

impl Quantiles {
    /// Quantiles of a density given on a grid, linear between points, in any scale; its zeros at
    /// either end are cut off. `None` where it is zero everywhere (or not finite, or negative).
    #[must_use]
    pub fn of(grid: Grid, density: &[f64]) -> Option<Self> {
        if density.iter().any(|d| !(d.is_finite() && *d >= 0.0)) {
            return None;
        }
        let first = density.iter().position(|d| *d > 0.0)?.saturating_sub(1);
        let last = (density.iter().rposition(|d| *d > 0.0)? + 1).min(grid.count - 1);
        let cells = (last - first) * STEPS;
        let at = |i: usize| grid.wavelength_nm(first) + grid.step_nm * i as f64 / STEPS as f64;
        let mut cumulative = Vec::with_capacity(cells + 1);
        let mut sum = 0.0;
        cumulative.push(0.0);
        for i in 0..cells {
            sum += grid.interpolate(density, 0.5 * (at(i) + at(i + 1)));
            cumulative.push(sum);
        }
        let mut edges = Box::new([0.0; INTERVALS + 1]);
        let mut cell = 0;
        for (k, edge) in edges.iter_mut().enumerate() {
            let want = sum * k as f64 / INTERVALS as f64;
            while cell + 1 < cells && cumulative[cell + 1] < want {
                cell += 1;
            }
            let mass = cumulative[cell + 1] - cumulative[cell];
            let part = if mass > 0.0 { ((want - cumulative[cell]) / mass).clamp(0.0, 1.0) } else { 0.0 };
            *edge = at(cell) + part * (at(cell + 1) - at(cell));
        }
        edges[0] = at(0);
        edges[INTERVALS] = at(cells);
        Some(Self { edges })
    }

    /// The wavelength (nm) at `u` in [0, 1), and one over the density there (nm).
    #[inline(always)]
    #[must_use]
    pub fn draw(&self, u: f64) -> (f64, f64) {
        let p = u * INTERVALS as f64;
        let i = (p as i32 as usize).min(INTERVALS - 1);
        let (a, b) = (self.edges[i], self.edges[i + 1]);
        let width = b - a;
        (a + (p - i as f64) * width, width * INTERVALS as f64)
    }

    /// Density at a wavelength, 1/nm.
    #[must_use]
    pub fn density_per_nm(&self, wavelength_nm: f64) -> f64 {
        if !(wavelength_nm >= self.edges[0] && wavelength_nm <= self.edges[INTERVALS]) {
            return 0.0;
        }
        let i = self.edges.partition_point(|e| *e <= wavelength_nm).clamp(1, INTERVALS);
        1.0 / ((self.edges[i] - self.edges[i - 1]) * INTERVALS as f64)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use spectra_core::spectral::BAND;

    #[test]
    fn uniform_density_gives_uniform_quantiles() {
        let q = Quantiles::of(BAND, &vec![3.0; BAND.count]).unwrap();
        for u in [0.0, 0.25, 0.5, 0.999] {
            let (w, inverse) = q.draw(u);
            assert!((w - (350.0 + 480.0 * u)).abs() < 1e-9);
            assert!((inverse - 480.0).abs() < 1e-6);
        }
    }

    /// A density with a gap in its middle: nothing is forgotten beside the gap, and every draw's
    /// weight is one over the stated density.
    #[test]
    fn gaps_and_edges_keep_a_positive_density() {
        let density: Vec<f64> =
            BAND.wavelengths_nm().map(|w| if (400.0..450.0).contains(&w) || w > 700.0 { 1.0 } else { 0.0 }).collect();
        let q = Quantiles::of(BAND, &density).unwrap();
        for i in 0..10_000 {
            let (w, inverse) = q.draw((f64::from(i) + 0.5) / 10_000.0);
            assert!((inverse * q.density_per_nm(w) - 1.0).abs() < 1e-9, "{w}");
        }
        for w in [400.0, 425.0, 575.0, 701.0, 830.0] {
            assert!(q.density_per_nm(w) > 0.0, "{w}");
        }
        assert_eq!(q.density_per_nm(398.0), 0.0);
    }

    #[test]
    fn no_light_has_no_quantiles() {
        assert!(Quantiles::of(BAND, &vec![0.0; BAND.count]).is_none());
        assert!(Quantiles::of(BAND, &vec![f64::NAN; BAND.count]).is_none());
    }
}
