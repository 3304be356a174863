//! Lines drawn as lines, and a continuum beside them.

use crate::Quantiles;
use spectra_core::batch::CONTINUUM;
use spectra_core::isa::{Isa, Vectorized};
use spectra_core::spectral::Line;
use spectra_core::stage::WavelengthDensity;

/// A density made of lines with probabilities and a continuum.
#[derive(Clone, Debug)]
pub struct Mixture {
    /// Lines that can be drawn: (number in the source, wavelength nm, probability).
    lines: Vec<(u32, f64, f64)>,
    /// Upper ends of the lines' parts of [0, 1).
    upper: Vec<f64>,
    line_share: f64,
    continuum: Option<Quantiles>,
}

impl Mixture {
    /// A mixture of the source's `lines`, drawn in proportion to `weights`, and a continuum; the
    /// lines together get `line_share` of the samples. `None` where nothing can be drawn.
    #[must_use]
    pub fn new(lines: &[Line], weights: &[f64], line_share: f64, continuum: Option<Quantiles>) -> Option<Self> {
        let sum: f64 = weights.iter().filter(|w| **w > 0.0).sum();
        let line_share = match (sum > 0.0, &continuum) {
            (true, Some(_)) => line_share,
            (true, None) => 1.0,
            (false, Some(_)) => 0.0,
            (false, None) => return None,
        };
        let mut kept = Vec::new();
        let mut upper = Vec::new();
        let mut part = 0.0;
        if line_share > 0.0 {
            for (i, (line, weight)) in lines.iter().zip(weights).enumerate() {
                if *weight > 0.0 {
                    let probability = weight / sum * line_share;
                    part += probability;
                    kept.push((i as u32, line.wavelength_nm, probability));
                    upper.push(part);
                }
            }
        }
        if let Some(last) = upper.last_mut() {
            *last = line_share; // the sum may have been rounded below it
        }
        Some(Self { lines: kept, upper, line_share, continuum })
    }
}

impl WavelengthDensity for Mixture {
    fn draw(&self, u: &[f64], wavelength_nm: &mut [f64], line: &mut [u32], weight: &mut [f64], isa: Isa) {
        if self.line_share > 0.0 {
            for i in 0..u.len() {
                if u[i] < self.line_share {
                    let at = self.upper.partition_point(|p| *p <= u[i]).min(self.lines.len() - 1);
                    let (number, nm, probability) = self.lines[at];
                    (wavelength_nm[i], line[i]) = (nm, number);
                    weight[i] /= probability;
                } else if let Some(continuum) = &self.continuum {
                    let rest = 1.0 - self.line_share;
                    let (nm, inverse) = continuum.draw((u[i] - self.line_share) / rest);
                    (wavelength_nm[i], line[i]) = (nm, CONTINUUM);
                    weight[i] *= inverse / rest;
                }
            }
        } else if let Some(continuum) = &self.continuum {
            isa.run(DrawContinuum { continuum, u, wavelength_nm, weight });
            line.fill(CONTINUUM);
        }
    }

    fn density_per_nm(&self, wavelength_nm: f64) -> f64 {
        self.continuum.as_ref().map_or(0.0, |c| c.density_per_nm(wavelength_nm) * (1.0 - self.line_share))
    }

    fn line_probability(&self, line: usize) -> f64 {
        self.lines.iter().find(|l| l.0 as usize == line).map_or(0.0, |l| l.2)
    }
}

struct DrawContinuum<'a> {
    continuum: &'a Quantiles,
    u: &'a [f64],
    wavelength_nm: &'a mut [f64],
    weight: &'a mut [f64],
}

impl Vectorized for DrawContinuum<'_> {
    type Output = ();
    #[inline(always)]
    fn run(self) {
        for ((u, wavelength), weight) in self.u.iter().zip(self.wavelength_nm).zip(self.weight) {
            let (nm, inverse) = self.continuum.draw(*u);
            *wavelength = nm;
            *weight *= inverse;
        }
    }
}
