//! Color models whose spectrum is a weighted sum of three basis spectra, one per channel.

use spectra_color::{fit_to_gamut, matrix};
use spectra_core::batch::CONTINUUM;
use spectra_core::isa::{Isa, Vectorized};
use spectra_core::spectral::{Grid, Line, SpectralPower};
use spectra_core::stage::{ColorGamut, ColorModel};
use spectra_spectrum::Observer;

/// A color model with red, green and blue basis spectra: a color's spectrum is their sum, weighted by its linear sRGB values.
#[derive(Clone, Debug)]
pub struct Basis {
    grid: Grid,
    continua: [Vec<f64>; 3],
    /// The values of `continua`, side by side at each wavelength.
    powers: Vec<[f64; 3]>,
    lines_nm: Vec<f64>,
    /// Power of each line at full red, green, blue.
    line_powers: Vec<[f64; 3]>,
}

impl Basis {
    /// Builds a basis from three spectra on the same grid. Lines at the same wavelength are merged.
    #[must_use]
    pub fn new(spectra: &[SpectralPower; 3]) -> Self {
        let mut lines_nm: Vec<f64> = Vec::new();
        let mut line_powers: Vec<[f64; 3]> = Vec::new();
        for (channel, spectrum) in spectra.iter().enumerate() {
            for line in &spectrum.lines {
                let at = lines_nm.iter().position(|nm| *nm == line.wavelength_nm).unwrap_or_else(|| {
                    lines_nm.push(line.wavelength_nm);
                    line_powers.push([0.0; 3]);
                    lines_nm.len() - 1
                });
                line_powers[at][channel] += line.power;
            }
        }
        let continua = spectra.clone().map(|s| s.continuum);
        let powers = (0..spectra[0].grid.count).map(|i| continua.each_ref().map(|c| c[i])).collect();
        Self { grid: spectra[0].grid, continua, powers, lines_nm, line_powers }
    }

    /// Builds a basis from three spectra on the same grid, each scaled so that the color (1, 1, 1) has the chromaticity of
    /// `white`. `None` if no positive mixture of the three spectra has this chromaticity.
    #[must_use]
    pub fn balanced(spectra: [SpectralPower; 3], white: &SpectralPower) -> Option<Self> {
        let observer = Observer::cie_1931_2deg();
        let columns = spectra.each_ref().map(|s| observer.xyz_of_power(s));
        let mut xyz_from_rgb = [[0.0; 3]; 3];
        for (row, cells) in xyz_from_rgb.iter_mut().enumerate() {
            for (column, cell) in cells.iter_mut().enumerate() {
                *cell = columns[column][row];
            }
        }
        let amounts = matrix::apply(&matrix::inverse(&xyz_from_rgb), observer.xyz_of_power(white));
        if amounts.iter().any(|a| !(a.is_finite() && *a > 0.0)) {
            return None;
        }
        let [r, g, b] = spectra;
        Some(Self::new(&[r.scaled(amounts[0]), g.scaled(amounts[1]), b.scaled(amounts[2])]))
    }
}

impl ColorModel for Basis {
    fn lines_nm(&self) -> &[f64] {
        &self.lines_nm
    }

    /// Returns the color, moved into sRGB if it lies outside, because a negative amount of a spectrum would be negative light.
    fn coefficients(&self, linear_srgb: [f64; 3]) -> [f32; 3] {
        fit_to_gamut(linear_srgb, ColorGamut::Srgb).rgb.map(|v| v as f32)
    }

    fn spectrum(&self, linear_srgb: [f64; 3]) -> SpectralPower {
        let linear_srgb = fit_to_gamut(linear_srgb, ColorGamut::Srgb).rgb;
        let mix = |powers: [f64; 3]| powers.iter().zip(linear_srgb).map(|(p, c)| p * c).sum::<f64>();
        SpectralPower {
            grid: self.grid,
            continuum: (0..self.grid.count).map(|i| mix([0, 1, 2].map(|c| self.continua[c][i]))).collect(),
            lines: (self.lines_nm.iter().zip(&self.line_powers))
                .map(|(nm, powers)| Line { wavelength_nm: *nm, power: mix(*powers) })
                .collect(),
        }
    }

    fn evaluate(&self, coefficients: &[[f32; 3]], wavelength_nm: &[f64], line: &[u32], weight: &mut [f64]) {
        Isa::detect().run(Mix { basis: self, coefficients, wavelength_nm, line, weight });
    }
}

/// Multiplies ray weights by the spectral power of the rays' colors.
struct Mix<'a> {
    basis: &'a Basis,
    coefficients: &'a [[f32; 3]],
    wavelength_nm: &'a [f64],
    line: &'a [u32],
    weight: &'a mut [f64],
}

impl Vectorized for Mix<'_> {
    type Output = ();
    #[inline(always)]
    fn run(self) {
        let Self { basis, coefficients, wavelength_nm, line, weight } = self;
        let (grid, last) = (basis.grid, basis.grid.count - 1);
        let len = weight.len();
        let (coefficients, wavelength_nm, line) = (&coefficients[..len], &wavelength_nm[..len], &line[..len]);
        for i in 0..len {
            let [r, g, b] = coefficients[i];
            let powers = if line[i] == CONTINUUM {
                // Interpolates like `Grid::interpolate`, for three tables at once.
                let place = (wavelength_nm[i] - grid.start_nm) / grid.step_nm;
                if place >= 0.0 && place <= last as f64 {
                    let at = (place as i32 as usize).min(last.saturating_sub(1));
                    let (low, high, part) = (basis.powers[at], basis.powers[(at + 1).min(last)], place - at as f64);
                    [
                        low[0] + (high[0] - low[0]) * part,
                        low[1] + (high[1] - low[1]) * part,
                        low[2] + (high[2] - low[2]) * part,
                    ]
                } else {
                    [0.0; 3]
                }
            } else {
                basis.line_powers.get(line[i] as usize).copied().unwrap_or_default()
            };
            weight[i] *= f64::from(r) * powers[0] + f64::from(g) * powers[1] + f64::from(b) * powers[2];
        }
    }
}
