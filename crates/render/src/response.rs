//! What the channels see of each ray.

use spectra_core::isa::Vectorized;
use spectra_core::spectral::{Channel, Grid};

/// The responses of all channels, one table after the other, each linear between points.
#[derive(Clone, Debug)]
pub(crate) struct Responses {
    grid: Grid,
    inverse_step: f64,
    tables: Vec<Vec<f64>>,
}

impl Responses {
    pub(crate) fn new(grid: Grid, channels: &[Channel]) -> Self {
        Self { grid, inverse_step: 1.0 / grid.step_nm, tables: channels.iter().map(|c| c.response.clone()).collect() }
    }

    pub(crate) fn channels(&self) -> usize {
        self.tables.len()
    }

    /// Work that writes weight times response of one channel for each ray; 0 outside of the band.
    pub(crate) fn weigh<'a>(
        &'a self,
        channel: usize,
        wavelength_nm: &'a [f64],
        weight: &'a [f64],
        out: &'a mut [f64],
    ) -> Weigh<'a> {
        Weigh { responses: self, table: &self.tables[channel], wavelength_nm, weight, out }
    }
}

pub(crate) struct Weigh<'a> {
    responses: &'a Responses,
    table: &'a [f64],
    wavelength_nm: &'a [f64],
    weight: &'a [f64],
    out: &'a mut [f64],
}

impl Vectorized for Weigh<'_> {
    type Output = ();
    #[inline(always)]
    fn run(self) {
        let last = self.table.len() - 2;
        let top = (self.table.len() - 1) as f64;
        for ((wavelength, weight), out) in self.wavelength_nm.iter().zip(self.weight).zip(self.out) {
            let p = (wavelength - self.responses.grid.start_nm) * self.responses.inverse_step;
            let inside = p >= 0.0 && p <= top;
            let i = (if inside { p } else { 0.0 } as usize).min(last);
            let f = p - i as f64;
            let (a, b) = (self.table[i], self.table[i + 1]);
            *out = if inside { weight * (a + (b - a) * f) } else { 0.0 };
        }
    }
}
