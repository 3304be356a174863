//! Sampled spectra over the band, as one stage passes them to the next.

use spectra_numerics::table;
use std::sync::Arc;

/// The default band: 350 to 830 nm in steps of 1 nm.
pub const BAND: Grid = Grid { start_nm: 350.0, step_nm: 1.0, count: 481 };

/// A uniform grid of wavelengths.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Grid {
    /// First wavelength, nm.
    pub start_nm: f64,
    /// Step between neighbors, nm.
    pub step_nm: f64,
    /// Number of wavelengths, at least 2.
    pub count: usize,
}

impl Grid {
    /// Last wavelength of the grid, nm.
    #[inline]
    #[must_use]
    pub fn end_nm(&self) -> f64 {
        self.start_nm + self.step_nm * (self.count - 1) as f64
    }

    /// Wavelength `i` of the grid, nm.
    #[inline]
    #[must_use]
    pub fn wavelength_nm(&self, i: usize) -> f64 {
        self.start_nm + self.step_nm * i as f64
    }

    /// Iterates over all wavelengths, nm.
    #[inline]
    pub fn wavelengths_nm(&self) -> impl Iterator<Item = f64> + '_ {
        (0..self.count).map(|i| self.wavelength_nm(i))
    }

    /// Returns whether `wavelength_nm` lies on the band, ends included.
    #[inline]
    #[must_use]
    pub fn contains(&self, wavelength_nm: f64) -> bool {
        wavelength_nm >= self.start_nm && wavelength_nm <= self.end_nm()
    }

    /// Returns the value at `wavelength_nm` of `table`, which has one value per point of this grid: linear between points, 0
    /// outside the band.
    #[inline(always)]
    #[must_use]
    pub fn interpolate(&self, table: &[f64], wavelength_nm: f64) -> f64 {
        let p = (wavelength_nm - self.start_nm) / self.step_nm;
        let last = self.count - 1;
        if !(p >= 0.0 && p <= last as f64) {
            return 0.0;
        }
        table::linear(&table[..self.count], p)
    }

    /// Integrates the product of two tables over the band. Each table is linear between points; the result is exact.
    #[must_use]
    pub fn integrate_product(&self, a: &[f64], b: &[f64]) -> f64 {
        let mut sum = 0.0;
        for i in 0..self.count - 1 {
            // Simpson's rule is exact, because the product of two lines is a quadratic.
            let mid = 0.25 * (a[i] + a[i + 1]) * (b[i] + b[i + 1]);
            sum += a[i] * b[i] + 4.0 * mid + a[i + 1] * b[i + 1];
        }
        sum * self.step_nm / 6.0
    }

    /// Integrates a table over the band. The table is linear between points; the result is exact.
    #[must_use]
    pub fn integrate(&self, a: &[f64]) -> f64 {
        let inner: f64 = a[1..self.count - 1].iter().sum();
        (inner + 0.5 * (a[0] + a[self.count - 1])) * self.step_nm
    }
}

/// A spectral line with its power.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Line {
    /// Wavelength in air, nm.
    pub wavelength_nm: f64,
    /// Power (or radiance) in the line; the unit is that of the continuum times nm.
    pub power: f64,
}

/// Emitted light: a continuum per nanometer on a grid, plus spectral lines.
#[derive(Clone, Debug, PartialEq)]
pub struct SpectralPower {
    /// The grid of the continuum.
    pub grid: Grid,
    /// Power per nanometer at each point, linear between points.
    pub continuum: Vec<f64>,
    /// Spectral lines; those outside the band are ignored.
    pub lines: Vec<Line>,
}

impl SpectralPower {
    /// Returns a spectrum without any light.
    #[must_use]
    pub fn dark(grid: Grid) -> Self {
        Self { grid, continuum: vec![0.0; grid.count], lines: Vec::new() }
    }

    /// Returns this spectrum times `factor`, lines included.
    #[must_use]
    pub fn scaled(&self, factor: f64) -> Self {
        Self {
            grid: self.grid,
            continuum: self.continuum.iter().map(|v| v * factor).collect(),
            lines: self.lines.iter().map(|l| Line { power: l.power * factor, ..*l }).collect(),
        }
    }

    /// Returns the integral of the spectrum times `response`, a table on the same grid, lines included.
    #[must_use]
    pub fn seen_by(&self, response: &[f64]) -> f64 {
        let lines: f64 = self.lines.iter().map(|l| l.power * self.grid.interpolate(response, l.wavelength_nm)).sum();
        self.grid.integrate_product(&self.continuum, response) + lines
    }

    /// Returns whether there is no power at all.
    #[must_use]
    pub fn is_dark(&self) -> bool {
        self.continuum.iter().all(|v| *v == 0.0) && self.lines.iter().all(|l| l.power == 0.0)
    }
}

/// One recorded channel, such as X of XYZ or a layer of a film.
#[derive(Clone, Debug, PartialEq)]
pub struct Channel {
    /// Short name of the channel, also its name in the EXR.
    pub name: String,
    /// Unit of the recorded exposure, such as `lx s`.
    pub unit: String,
    /// Response per unit of spectral irradiance (W m^-2 nm^-1) at each point of the grid. The integral of irradiance times
    /// response is in `unit` (after multiplication by the exposure time, if the unit contains a time).
    pub response: Vec<f64>,
}

/// The system as a wavelength sampler needs to know it: band, source and channels.
#[derive(Clone, Debug)]
pub struct SystemResponse {
    /// The band and its grid.
    pub grid: Grid,
    /// Light that the source emits into the lens, on an arbitrary scale.
    pub source: SpectralPower,
    /// The recorded channels.
    pub channels: Arc<[Channel]>,
}

impl SystemResponse {
    /// Returns the sum of the absolute responses of all channels, each scaled to a peak of 1 so that every channel counts.
    #[must_use]
    pub fn summed_response(&self) -> Vec<f64> {
        let mut sum = vec![0.0; self.grid.count];
        for channel in self.channels.iter() {
            let peak = channel.response.iter().fold(0.0_f64, |a, b| a.max(b.abs()));
            if peak > 0.0 {
                for (s, r) in sum.iter_mut().zip(&channel.response) {
                    *s += r.abs() / peak;
                }
            }
        }
        sum
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn integrals_of_lines_and_parabolas_are_exact() {
        let grid = Grid { start_nm: 400.0, step_nm: 10.0, count: 11 };
        let ramp: Vec<f64> = grid.wavelengths_nm().map(|w| w - 400.0).collect();
        // Integral of x and x^2 from 0 to 100.
        assert!((grid.integrate(&ramp) - 5000.0).abs() < 1e-9);
        assert!((grid.integrate_product(&ramp, &ramp) - 1e6 / 3.0).abs() < 1e-6);
    }

    #[test]
    fn tables_are_linear_inside_and_zero_outside() {
        let grid = Grid { start_nm: 400.0, step_nm: 10.0, count: 3 };
        let table = [1.0, 3.0, 7.0];
        for (w, want) in [(399.9, 0.0), (400.0, 1.0), (405.0, 2.0), (420.0, 7.0), (420.1, 0.0), (f64::NAN, 0.0)] {
            assert_eq!(grid.interpolate(&table, w), want, "{w}");
        }
    }

    #[test]
    fn lines_count_beside_the_continuum() {
        let grid = Grid { start_nm: 400.0, step_nm: 10.0, count: 3 };
        let light =
            SpectralPower { grid, continuum: vec![2.0; 3], lines: vec![Line { wavelength_nm: 405.0, power: 3.0 }] };
        assert!((light.seen_by(&[1.0, 1.0, 1.0]) - 43.0).abs() < 1e-12);
    }
}
