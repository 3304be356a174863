//! Spectra of a few inks, tabulated for fast look-up by ink and wavelength.

use crate::flat::Places;
use spectra_core::batch::CONTINUUM;
use spectra_core::isa::Vectorized;
use spectra_core::spectral::{Grid, Line, SpectralPower};

/// Radiance spectra of numbered inks; number `len` and beyond is dark.
#[derive(Clone, Debug)]
pub(crate) struct Palette {
    grid: Grid,
    /// One row of `grid.count` an ink, and a dark one at the end.
    tables: Vec<f64>,
    lines_nm: Vec<f64>,
    /// One row of `lines_nm.len()` an ink, and a dark one at the end.
    powers: Vec<f64>,
    inks: usize,
}

impl Palette {
    /// Tabulates the spectra, which share a grid. Lines at the same wavelength become one.
    pub(crate) fn new(grid: Grid, spectra: &[SpectralPower]) -> Self {
        let mut lines_nm: Vec<f64> = spectra.iter().flat_map(|s| &s.lines).map(|l| l.wavelength_nm).collect();
        lines_nm.sort_by(f64::total_cmp);
        lines_nm.dedup();
        let mut tables = Vec::with_capacity((spectra.len() + 1) * grid.count);
        let mut powers = vec![0.0; (spectra.len() + 1) * lines_nm.len()];
        for (ink, spectrum) in spectra.iter().enumerate() {
            tables.extend_from_slice(&spectrum.continuum);
            for line in &spectrum.lines {
                if let Some(at) = lines_nm.iter().position(|nm| *nm == line.wavelength_nm) {
                    powers[ink * lines_nm.len() + at] += line.power;
                }
            }
        }
        tables.resize((spectra.len() + 1) * grid.count, 0.0);
        Self { grid, tables, lines_nm, powers, inks: spectra.len() }
    }

    /// The sum of the inks' spectra, weighted.
    pub(crate) fn mean(&self, weights: &[f64]) -> SpectralPower {
        let count = self.grid.count;
        let sum = |rows: &[f64], width: usize, column: usize| -> f64 {
            weights.iter().enumerate().map(|(ink, w)| w * rows[ink * width + column]).sum()
        };
        SpectralPower {
            grid: self.grid,
            continuum: (0..count).map(|i| sum(&self.tables, count, i)).collect(),
            lines: (self.lines_nm.iter().enumerate())
                .map(|(at, nm)| Line { wavelength_nm: *nm, power: sum(&self.powers, self.lines_nm.len(), at) })
                .collect(),
        }
    }

    /// Work that multiplies each weight by the radiance of its ink.
    pub(crate) fn shine<'a>(&'a self, ink: &'a [u16], at: Places<'a>, weight: &'a mut [f64]) -> Shine<'a> {
        Shine { palette: self, ink, at, weight }
    }
}

pub(crate) struct Shine<'a> {
    palette: &'a Palette,
    ink: &'a [u16],
    at: Places<'a>,
    weight: &'a mut [f64],
}

impl Vectorized for Shine<'_> {
    type Output = ();
    #[inline(always)]
    fn run(self) {
        let p = self.palette;
        let (grid, width) = (p.grid, p.lines_nm.len());
        let inverse_step = 1.0 / grid.step_nm;
        let (last, top) = (grid.count - 2, (grid.count - 1) as f64);
        for i in 0..self.weight.len() {
            let ink = (self.ink[i] as usize).min(p.inks);
            let line = self.at.line[i];
            if line == CONTINUUM {
                let place = (self.at.wavelength_nm[i] - grid.start_nm) * inverse_step;
                let inside = place >= 0.0 && place <= top;
                let cell = (if inside { place } else { 0.0 } as usize).min(last);
                let f = place - cell as f64;
                let row = ink * grid.count + cell;
                let (a, b) = (p.tables[row], p.tables[row + 1]);
                self.weight[i] *= if inside { a + (b - a) * f } else { 0.0 };
            } else {
                let at = line as usize;
                self.weight[i] *= if at < width { p.powers[ink * width + at] } else { 0.0 };
            }
        }
    }
}
