//! Spectra of a few inks, tabulated for fast lookup by ink and wavelength.

use crate::plane_source::Places;
use spectra_core::batch::CONTINUUM;
use spectra_core::isa::Vectorized;
use spectra_core::math::floor_index;
use spectra_core::spectral::{Grid, Line, SpectralPower};

/// Radiance spectra of numbered inks. Numbers beyond the last ink are dark.
#[derive(Clone, Debug)]
pub(crate) struct Palette {
    grid: Grid,
    /// One row of `grid.count` values per ink, and a dark one at the end.
    tables: Vec<f64>,
    lines_nm: Vec<f64>,
    /// One row of `lines_nm.len()` powers per ink, and a dark one at the end.
    powers: Vec<f64>,
    inks: usize,
}

impl Palette {
    /// Tabulates the spectra, which share a grid. Lines at the same wavelength are merged.
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

    /// Returns the weighted sum of the inks' spectra.
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

    /// Returns a job that multiplies each weight by the radiance of its ink.
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
        let Self { palette, ink, at: Places { wavelength_nm, line, .. }, weight } = self;
        for start in (0..weight.len()).step_by(CHUNK) {
            let part = start..(start + CHUNK).min(weight.len());
            let (ink, nm, line) = (&ink[part.clone()], &wavelength_nm[part.clone()], &line[part.clone()]);
            let weight = &mut weight[part];
            if line.iter().all(|line| *line == CONTINUUM) {
                palette.shine_smoothly(ink, nm, weight);
            } else {
                for i in 0..weight.len() {
                    weight[i] *= palette.at(ink[i], nm[i], line[i]);
                }
            }
        }
    }
}

/// Number of rays that are processed together.
const CHUNK: usize = 64;

impl Palette {
    /// Returns the radiance of an ink at a wavelength or on a line.
    #[inline(always)]
    fn at(&self, ink: u16, wavelength_nm: f64, line: u32) -> f64 {
        let (grid, width) = (self.grid, self.lines_nm.len());
        let ink = (ink as usize).min(self.inks);
        if line == CONTINUUM {
            let (last, top) = (grid.count - 2, (grid.count - 1) as f64);
            let place = (wavelength_nm - grid.start_nm) * (1.0 / grid.step_nm);
            let inside = place >= 0.0 && place <= top;
            let cell = (if inside { place } else { 0.0 } as usize).min(last);
            let f = place - cell as f64;
            let row = ink * grid.count + cell;
            let (a, b) = (self.tables[row], self.tables[row + 1]);
            if inside { a + (b - a) * f } else { 0.0 }
        } else {
            let at = line as usize;
            if at < width { self.powers[ink * width + at] } else { 0.0 }
        }
    }

    /// Multiplies up to [`CHUNK`] weights by [`Palette::at`], none of them on a line. The parts without a table lookup are vectorized.
    #[inline(always)]
    fn shine_smoothly(&self, ink: &[u16], wavelength_nm: &[f64], weight: &mut [f64]) {
        let grid = self.grid;
        let len = weight.len().min(CHUNK);
        let (ink, wavelength_nm, weight) = (&ink[..len], &wavelength_nm[..len], &mut weight[..len]);
        let (inverse_step, inks, count) = (1.0 / grid.step_nm, self.inks as u32, grid.count as u32);
        let (last, top) = ((grid.count - 2) as f64, (grid.count - 1) as f64);
        let (mut row, mut part, mut ends) = ([0_u32; CHUNK], [0.0; CHUNK], [[0.0; CHUNK]; 2]);
        for i in 0..len {
            let place = (wavelength_nm[i] - grid.start_nm) * inverse_step;
            let inside = (place >= 0.0) & (place <= top);
            let (cell, below) = floor_index(if inside { place } else { 0.0 }, last);
            part[i] = place - below;
            // The last row is dark.
            row[i] = if inside { u32::from(ink[i]).min(inks) } else { inks } * count + cell;
        }
        for i in 0..len {
            let at = row[i] as usize;
            let pair = &self.tables[at..at + 2];
            (ends[0][i], ends[1][i]) = (pair[0], pair[1]);
        }
        let [from, to] = &ends;
        for i in 0..len {
            let place = part[i];
            // Outside the band it may be NaN.
            let radiance = from[i] + (to[i] - from[i]) * place;
            weight[i] *= if (0.0..=1.0).contains(&place) { radiance } else { 0.0 };
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use spectra_core::Isa;

    /// Vectorized lookups give the same bits as single ones, on every instruction set. Outside the band and beyond the last ink the
    /// result is 0.
    #[test]
    fn side_by_side_is_as_alone() {
        let grid = Grid { start_nm: 380.0, step_nm: 5.0, count: 71 };
        let spectrum = |k: usize| SpectralPower {
            grid,
            continuum: (0..grid.count).map(|i| 0.1 + ((i * 37 + k * 11) % 29) as f64).collect(),
            lines: vec![Line { wavelength_nm: 546.0 + k as f64, power: 2.0 }],
        };
        let palette = Palette::new(grid, &[0, 1, 2].map(spectrum));
        let many = 3 * CHUNK + 5;
        let mut nm: Vec<f64> = (0..many).map(|i| 370.0 + 1.93 * i as f64).collect();
        (nm[0], nm[1], nm[2], nm[3]) = (380.0, grid.end_nm(), f64::NAN, f64::INFINITY);
        let ink: Vec<u16> = (0..many).map(|i| [0, 1, 2, 3, u16::MAX][i % 5]).collect();
        let mut line = vec![CONTINUUM; many];
        line[2 * CHUNK + 3] = 1;
        line[2 * CHUNK + 4] = 9;
        for isa in Isa::available() {
            let mut weight = vec![1.5; many];
            let at = Places { x_mm: &nm, y_mm: &nm, wavelength_nm: &nm, line: &line };
            isa.run(palette.shine(&ink, at, &mut weight));
            for i in 0..many {
                let want = 1.5 * palette.at(ink[i], nm[i], line[i]);
                assert_eq!(weight[i].to_bits(), want.to_bits(), "{} at {}", ink[i], nm[i]);
            }
        }
    }
}
