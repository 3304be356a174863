//! What the channels see of the source.

use crate::{Mixture, Shares};
use spectra_core::spectral::{Grid, SystemResponse};

/// The source through the sum of all channels' responses.
pub(crate) struct Seen {
    /// Sum of the responses, each scaled to a peak of 1.
    pub response: Vec<f64>,
    /// Integral of it, nm.
    pub of_response: f64,
    /// The continuum (its absolute value) times the response, per nanometre.
    pub product: Vec<f64>,
    /// Integral of that.
    pub of_continuum: f64,
    /// The same of each line.
    pub lines: Vec<f64>,
    /// Sum of those.
    pub of_lines: f64,
    /// Whether there is a continuum, seen or not.
    pub has_continuum: bool,
    /// Number of channels that see anything.
    pub channels: usize,
}

/// The least that lines or continuum get of the samples where there are both: what is dim on the whole
/// may be all there is in some place of a picture.
const LEAST: f64 = 0.05;

impl Seen {
    /// Fails where no channel sees anything.
    pub fn of(system: &SystemResponse) -> Result<Self, String> {
        let grid = system.grid;
        let response = system.summed_response();
        let of_response = grid.integrate(&response);
        if of_response.is_nan() || of_response <= 0.0 {
            return Err("no channel sees anything in the band".to_owned());
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

    /// Whether a continuum is to be drawn: one that is seen nowhere is dark, but it may be lit elsewhere on the
    /// source, so it is kept if it is there.
    pub fn draws_continuum(&self) -> bool {
        self.has_continuum || self.of_lines == 0.0
    }

    /// The lines' share of the samples where there is a continuum too.
    pub fn line_share(&self) -> f64 {
        let all = self.of_lines + self.of_continuum;
        if all > 0.0 { (self.of_lines / all).clamp(LEAST, 1.0 - LEAST) } else { 0.5 }
    }

    /// A density of integral 1: `shape` (in any scale), but for `floor` of it, which is the summed response.
    pub fn with_floor(&self, shape: &[f64], of_shape: f64, floor: f64) -> Vec<f64> {
        let scale = if of_shape > 0.0 { (1.0 - floor) / of_shape } else { 0.0 };
        let floor = floor / self.of_response;
        shape.iter().zip(&self.response).map(|(s, r)| s * scale + r * floor).collect()
    }

    /// The lines by what is seen of them, beside `continuum`.
    pub fn mixture<C>(&self, system: &SystemResponse, continuum: Option<C>) -> Result<Mixture<C>, String> {
        // Rounding would take from one channel the exactness that it has by itself.
        let shares = if self.channels > 1 { Shares::WholeStrata } else { Shares::Proportional };
        Mixture::new(&system.source.lines, &self.lines, shares, self.line_share(), continuum)
            .ok_or_else(|| "the imager sees none of the source's light".to_owned())
    }

    /// Wavelengths (nm) at which a channel sees, sixteen in each cell of the grid, its ends not among them.
    pub fn wavelengths_nm<'a>(&'a self, grid: &'a Grid) -> impl Iterator<Item = f64> + 'a {
        const IN_CELL: u32 = 16;
        let cells = (0..grid.count - 1).filter(|i| self.response[*i] > 0.0 || self.response[*i + 1] > 0.0);
        cells.flat_map(move |i| {
            (0..IN_CELL).map(move |k| grid.wavelength_nm(i) + grid.step_nm * (f64::from(k) + 0.5) / f64::from(IN_CELL))
        })
    }
}
