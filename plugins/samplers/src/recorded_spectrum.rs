//! The light of the source as the channels see it.

use crate::{Mixture, Shares};
use spectra_core::params::Fault;
use spectra_core::spectral::{Grid, SystemResponse};

/// The source multiplied by the sum of all channels' responses.
pub(crate) struct RecordedSpectrum {
    /// Sum of the responses, each scaled to a peak of 1, at the points of the grid.
    pub response: Vec<f64>,
    /// Integral of `response`, nm.
    pub of_response: f64,
    /// Absolute value of the continuum times `response`, per nanometer.
    pub product: Vec<f64>,
    /// Integral of `product` over the band.
    pub of_continuum: f64,
    /// Absolute power of each line times the response at its wavelength.
    pub lines: Vec<f64>,
    /// Sum of the values in `lines`.
    pub of_lines: f64,
    /// Whether the source has a continuum, whether or not a channel responds to it.
    pub has_continuum: bool,
    /// Number of channels with any response.
    pub channels: usize,
}

/// Least fraction of the samples that lines or continuum get if there are both: light that is dim on the whole may be the only light in
/// some part of a picture.
const LEAST: f64 = 0.05;

impl RecordedSpectrum {
    /// Multiplies the source by the channels' responses. Fails if no channel has any response.
    pub fn of(system: &SystemResponse) -> Result<Self, Fault> {
        let grid = system.grid;
        let response = system.summed_response();
        let of_response = grid.integrate(&response);
        if of_response.is_nan() || of_response <= 0.0 {
            return Err(Fault::new("no channel sees anything in the band"));
        }
        let product: Vec<f64> = system.source.continuum.iter().zip(&response).map(|(s, r)| s.abs() * r).collect();
        let lines: Vec<f64> =
            system.source.lines.iter().map(|l| l.power.abs() * grid.interpolate(&response, l.wavelength_nm)).collect();
        Ok(Self {
            of_continuum: grid.integrate(&product),
            of_lines: lines.iter().sum(),
            has_continuum: system.source.continuum.iter().any(|v| *v != 0.0),
            channels: system.channels.iter().filter(|c| c.response.iter().any(|r| *r != 0.0)).count(),
            response,
            of_response,
            product,
            lines,
        })
    }

    /// Returns whether a continuum must be drawn. A continuum to which no channel responds is drawn, too, because the spectrum may differ
    /// elsewhere on the source.
    pub fn draws_continuum(&self) -> bool {
        self.has_continuum || self.of_lines == 0.0
    }

    /// Returns the fraction of the samples for the lines if there is also a continuum.
    pub fn line_share(&self) -> f64 {
        let all = self.of_lines + self.of_continuum;
        if all > 0.0 { (self.of_lines / all).clamp(LEAST, 1.0 - LEAST) } else { 0.5 }
    }

    /// Returns a density of integral 1 at the points of the grid that mixes two shapes. The fraction `floor` of it is the summed
    /// response, and the rest is `shape`, given in any scale with its integral `of_shape`.
    pub fn with_floor(&self, shape: &[f64], of_shape: f64, floor: f64) -> Vec<f64> {
        let scale = if of_shape > 0.0 { (1.0 - floor) / of_shape } else { 0.0 };
        let floor = floor / self.of_response;
        shape.iter().zip(&self.response).map(|(s, r)| s * scale + r * floor).collect()
    }

    /// Builds the mixture of the lines, weighted by the channels' response to them, and `continuum`. Fails if there is nothing to draw.
    pub fn mixture<C>(&self, system: &SystemResponse, continuum: Option<C>) -> Result<Mixture<C>, Fault> {
        // A single channel is exact with proportional shares; rounding to strata would spoil that.
        let shares = if self.channels > 1 { Shares::WholeStrata } else { Shares::Proportional };
        Mixture::new(&system.source.lines, &self.lines, shares, self.line_share(), continuum)
            .ok_or_else(|| Fault::new("the imager sees none of the source's light"))
    }

    /// Returns closely spaced wavelengths (nm) within the cells of the grid in which a channel is sensitive, sixteen for each
    /// cell.
    pub fn wavelengths_nm<'a>(&'a self, grid: &'a Grid) -> impl Iterator<Item = f64> + 'a {
        const IN_CELL: u32 = 16;
        let cells = (0..grid.count - 1).filter(|i| self.response[*i] > 0.0 || self.response[*i + 1] > 0.0);
        cells.flat_map(move |i| {
            (0..IN_CELL).map(move |k| grid.wavelength_nm(i) + grid.step_nm * (f64::from(k) + 0.5) / f64::from(IN_CELL))
        })
    }
}
