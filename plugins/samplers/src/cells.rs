//! A density of wavelengths that is constant on each cell of a grid.

use spectra_core::spectral::Grid;

/// A density of wavelengths that is constant between neighboring points of a grid. One look-up gives the density at any
/// wavelength, whereas [`crate::Quantiles`] have to search for it.
#[derive(Clone, Debug)]
pub struct Cells {
    grid: Grid,
    per_step: f64,
    /// Density of each cell, 1/nm.
    density_per_nm: Vec<f64>,
    /// Probability of a draw below the upper end of each cell.
    upper: Vec<f64>,
}

/// Margin that draws keep from the edges of a cell, as a fraction of the cell; the edges are known to about 1e-13 of it.
const INSIDE: f64 = 1e-9;

impl Cells {
    /// Builds the density from values at the points of a grid, in any scale: each cell gets the mean of the values at its two
    /// ends. `None` if the values are zero everywhere, or if one is negative or not finite.
    #[must_use]
    pub fn of(grid: Grid, density: &[f64]) -> Option<Self> {
        if density.iter().any(|d| !(d.is_finite() && *d >= 0.0)) {
            return None;
        }
        let means: Vec<f64> = density.windows(2).map(|d| 0.5 * (d[0] + d[1])).collect();
        let sum: f64 = means.iter().sum();
        if sum.is_nan() || sum <= 0.0 {
            return None;
        }
        let density_per_nm: Vec<f64> = means.iter().map(|m| m / (sum * grid.step_nm)).collect();
        let mut part = 0.0;
        let upper = means.iter().map(|m| {
            part += m / sum;
            part
        });
        Some(Self { grid, per_step: 1.0 / grid.step_nm, upper: upper.collect(), density_per_nm })
    }

    /// Returns the wavelength (nm) at which the cumulative probability is `u`, from 0 to below 1.
    #[must_use]
    pub fn quantile(&self, u: f64) -> f64 {
        // A last cell of zero density is never drawn: the search ends at the first cell that reaches the whole sum.
        let total = self.upper[self.upper.len() - 1];
        let at = self.upper.partition_point(|p| *p <= u && *p < total);
        let below = if at == 0 { 0.0 } else { self.upper[at - 1] };
        let mass = self.upper[at] - below;
        // The draw stays inside the cell: at its edge, a later look-up might find the density of the neighbor, or zero.
        let part = if mass > 0.0 { ((u - below) / mass).clamp(INSIDE, 1.0 - INSIDE) } else { 0.5 };
        self.grid.start_nm + self.grid.step_nm * (at as f64 + part)
    }

    /// Density at a wavelength, 1/nm; 0 outside the grid.
    #[inline(always)]
    #[must_use]
    pub fn density_per_nm(&self, wavelength_nm: f64) -> f64 {
        let p = (wavelength_nm - self.grid.start_nm) * self.per_step;
        let count = self.density_per_nm.len();
        // Cells are few enough for 32 bits, whose conversion is one instruction.
        if p >= 0.0 && p <= count as f64 { self.density_per_nm[(p as i32 as usize).min(count - 1)] } else { 0.0 }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use spectra_core::spectral::BAND;

    #[test]
    fn quantiles_follow_the_cells() {
        let grid = Grid { start_nm: 400.0, step_nm: 10.0, count: 5 };
        // Masses 1, 0, 0, 3.
        let cells = Cells::of(grid, &[2.0, 0.0, 0.0, 0.0, 6.0]).unwrap();
        for (u, want) in [(0.0, 400.0), (0.125, 405.0), (0.25, 430.0), (0.625, 435.0), (1.0, 440.0)] {
            assert!((cells.quantile(u) - want).abs() < 2e-8, "{u}");
        }
        assert!((cells.density_per_nm(405.0) - 0.025).abs() < 1e-15);
        assert_eq!(cells.density_per_nm(415.0), 0.0);
        assert!((cells.density_per_nm(440.0) - 0.075).abs() < 1e-15);
        for w in [399.9, 440.1, f64::NAN, f64::INFINITY] {
            assert_eq!(cells.density_per_nm(w), 0.0);
        }
    }

    #[test]
    fn dark_ends_are_never_drawn() {
        let density: Vec<f64> =
            BAND.wavelengths_nm().map(|w| if (500.0..=600.0).contains(&w) { 0.1 } else { 0.0 }).collect();
        let cells = Cells::of(BAND, &density).unwrap();
        for u in [0.0, 1e-16, 0.5, 1.0 - 1e-16, 1.0] {
            assert!(cells.density_per_nm(cells.quantile(u)) > 0.0, "{u}");
            assert!((499.0..=601.0).contains(&cells.quantile(u)), "{u}");
        }
        assert!(Cells::of(BAND, &vec![0.0; BAND.count]).is_none());
        assert!(Cells::of(BAND, &vec![f64::NAN; BAND.count]).is_none());
    }
}
