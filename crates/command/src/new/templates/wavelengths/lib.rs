//! `kind: my-stage`, a wavelength sampler.

use schemars::JsonSchema;
use serde::Deserialize;
use spectra_core::batch::CONTINUUM;
use spectra_core::math::{exp, expm1, log1p};
use spectra_core::prelude::*;

/// An exponential density with most samples at short wavelengths.
///
/// If the source has lines, they get half of the samples, each in proportion to its power.
///
/// # Example
/// ```yaml
/// {kind: my-stage, length: 200 nm}
/// ```
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
struct MyStageParams {
    /// Distance over which the density falls by e, 20 nm to 1 mm, nm if bare.
    #[schemars(range(min = 20, max = 1e6))]
    length: Wavelength,
}

spectra_core::register!(wavelengths "my-stage": MyStageParams, build);

fn build(params: &Params, _: &Context<'_>) -> Result<Box<dyn WavelengthSampler>, Faults> {
    let p: MyStageParams = params.parse()?;
    Ok(Box::new(MyStage { length_nm: p.length.nm() }))
}

struct MyStage {
    length_nm: f64,
}

impl WavelengthSampler for MyStage {
    fn prepare(&self, system: &SystemResponse) -> Result<Box<dyn WavelengthDensity>, Fault> {
        let (grid, lines) = (system.grid, &system.source.lines);
        let power = |line: &Line| if grid.contains(line.wavelength_nm) { line.power } else { 0.0 };
        let sum: f64 = lines.iter().map(power).sum();
        let has_continuum = system.source.continuum.iter().any(|v| *v > 0.0);
        let of_lines = match (sum > 0.0, has_continuum) {
            (true, true) => 0.5,
            (true, false) => 1.0,
            (false, true) => 0.0,
            (false, false) => return Err("the source emits nothing".into()),
        };
        let probability = |line: &Line| if sum > 0.0 { of_lines * power(line) / sum } else { 0.0 };
        Ok(Box::new(Density {
            length_nm: self.length_nm,
            start_nm: grid.start_nm,
            all: -expm1(-(grid.end_nm() - grid.start_nm) / self.length_nm),
            of_lines,
            lines: lines.iter().map(|l| (l.wavelength_nm, probability(l))).collect(),
        }))
    }
}

struct Density {
    length_nm: f64,
    start_nm: f64,
    /// Fraction of an infinite exponential that lies in the band.
    all: f64,
    /// Probability of all lines together.
    of_lines: f64,
    /// Wavelength (nm) and probability of each line.
    lines: Vec<(f64, f64)>,
}

impl WavelengthDensity for Density {
    fn draw(&self, u: &[f64], nm: &mut [f64], line: &mut [u32], weight: &mut [f64], _: Isa) {
        for i in 0..u.len() {
            let mut rest = u[i];
            let drawn = self.lines.iter().position(|(_, p)| {
                rest -= p;
                rest < 0.0
            });
            if let Some(number) = drawn {
                let (at_nm, p) = self.lines[number];
                (nm[i], line[i]) = (at_nm, number as u32);
                weight[i] /= p;
            } else {
                // What remains of `u` after the lines is rescaled to [0, 1).
                let u = (rest.max(0.0) / (1.0 - self.of_lines)).min(1.0);
                nm[i] = self.start_nm - self.length_nm * log1p(-u * self.all);
                line[i] = CONTINUUM;
                weight[i] /= self.density_per_nm(nm[i]);
            }
        }
    }

    fn density_per_nm(&self, nm: f64) -> f64 {
        let falls = exp(-(nm - self.start_nm) / self.length_nm);
        (1.0 - self.of_lines) * falls / (self.length_nm * self.all)
    }

    fn line_probability(&self, line: usize) -> f64 {
        self.lines.get(line).map_or(0.0, |(_, probability)| *probability)
    }
}

#[cfg(test)]
mod tests {
    use spectra_testing::{SamplerLaws, assert_fault, systems, wavelengths};

    /// Half of the samples lie below start + length ln 2, if the band is long against `length`.
    #[test]
    fn the_median_is_where_it_should_be() {
        let sampler = wavelengths("{kind: my-stage, length: 20}");
        let density = sampler.prepare(&systems()[0].1).unwrap();
        let (mut nm, mut line, mut weight) = ([0.0], [0], [1.0]);
        density.draw(&[0.5], &mut nm, &mut line, &mut weight, spectra_core::Isa::detect());
        assert!((nm[0] - (350.0 + 20.0 * std::f64::consts::LN_2)).abs() < 1e-6, "{} nm", nm[0]);
    }

    #[test]
    fn it_keeps_the_laws_of_samplers() {
        SamplerLaws::default().hold(&*wavelengths("{kind: my-stage, length: 200}"));
        SamplerLaws::default().hold(&*wavelengths("{kind: my-stage, length: 1 mm}"));
    }

    #[test]
    fn what_cannot_be_is_said() {
        assert_fault("wavelengths", "{kind: my-stage, length: 1}", "length");
    }
}
