//! The strategy `stratified`: strata of equal width, each drawn equally often and jittered independently.
//!
//! The number of a sample chooses the stratum; a hash of all bits of the number chooses the place in it. As many evenly spread
//! numbers as there are strata put one draw into each, at independent places: the textbook's jittered sampling. `uniform` also
//! takes the place in the stratum from the number, and so keeps all the evenness of Sobol points. With as many samples as strata
//! both are alike. With more samples `uniform` continues to fill the strata evenly, while the draws in a stratum here stay
//! independent. The strategy is a reference for comparisons, not one to render with. With independent numbers it equals
//! `uniform`.
//!
//! A Sobol number has 32 bits, so one of 64 strata has 2^26 places. Their mean is off the stratum's middle by about 1e-4 of the
//! stratum's own spread, and the mean of all strata together by 2e-5.

use crate::{Continuum, Mixture, Shares};
use schemars::JsonSchema;
use serde::Deserialize;
use spectra_core::isa::{Isa, Vectorized};
use spectra_core::numbers::mix64;
use spectra_core::params::{Fault, Faults, Params};
use spectra_core::registry::Context;
use spectra_core::spectral::SystemResponse;
use spectra_core::stage::{WavelengthDensity, WavelengthSampler};

/// The band is divided into strata of equal width, each jittered independently.
///
/// This is the textbook's jittered sampling, as a reference for comparisons. The number of a sample chooses the stratum,
/// and a hash of the number chooses the place in it. `kind: uniform` keeps all the evenness of Sobol points and is better
/// with more samples than strata. If the source has both lines and a continuum, the lines get half of the samples.
///
/// # Example
/// ```yaml
/// {kind: stratified, strata: 128}
/// ```
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
pub struct StratifiedParams {
    /// Number of strata in the band, 1 to 65536; 64 if left out.
    #[serde(default = "usual_strata")]
    #[schemars(range(min = 1, max = MOST))]
    pub strata: u32,
}

const MOST: u32 = 65_536;

fn usual_strata() -> u32 {
    64
}

/// The strategy `stratified`: draws one jittered wavelength per stratum of the band.
#[derive(Clone, Copy, Debug)]
pub struct Stratified {
    strata: u32,
}

impl Stratified {
    /// Creates the strategy with the band cut into `strata` parts; `None` unless there are 1 to 65 536.
    #[must_use]
    pub fn new(strata: u32) -> Option<Self> {
        (1..=MOST).contains(&strata).then_some(Self { strata })
    }
}

impl WavelengthSampler for Stratified {
    fn prepare(&self, system: &SystemResponse) -> Result<Box<dyn WavelengthDensity>, Fault> {
        let has_continuum = system.source.continuum.iter().any(|v| *v != 0.0);
        let (start_nm, end_nm) = (system.grid.start_nm, system.grid.end_nm());
        let continuum = (has_continuum || system.source.lines.is_empty()).then_some(Strata {
            start_nm,
            end_nm,
            count: f64::from(self.strata),
        });
        let weights = vec![1.0; system.source.lines.len()];
        Mixture::new(&system.source.lines, &weights, Shares::WholeStrata, 0.5, continuum)
            .map(|m| Box::new(m) as Box<dyn WavelengthDensity>)
            .ok_or_else(|| Fault::new("the source emits nothing"))
    }
}

/// Strata of equal width from one wavelength to another.
#[derive(Clone, Copy, Debug)]
struct Strata {
    start_nm: f64,
    end_nm: f64,
    count: f64,
}

impl Continuum for Strata {
    fn draw(&self, u: &[f64], wavelength_nm: &mut [f64], weight: &mut [f64], isa: Isa) {
        isa.run(DrawStrata { strata: *self, u, wavelength_nm, weight });
    }

    fn density_per_nm(&self, wavelength_nm: f64) -> f64 {
        let within = wavelength_nm >= self.start_nm && wavelength_nm <= self.end_nm;
        if within { 1.0 / (self.end_nm - self.start_nm) } else { 0.0 }
    }
}

struct DrawStrata<'a> {
    strata: Strata,
    u: &'a [f64],
    wavelength_nm: &'a mut [f64],
    weight: &'a mut [f64],
}

impl Vectorized for DrawStrata<'_> {
    type Output = ();
    #[inline(always)]
    fn run(self) {
        let Strata { start_nm, end_nm, count } = self.strata;
        let width = (end_nm - start_nm) / count;
        for ((u, wavelength), weight) in self.u.iter().zip(self.wavelength_nm).zip(self.weight) {
            let stratum = (u * count).floor();
            // The upper 52 bits of the hash as a number in [0, 1).
            let hash = mix64(u.to_bits());
            let jitter = f64::from_bits((hash >> 12) | 0x3ff0_0000_0000_0000) - 1.0;
            *wavelength = start_nm + (stratum + jitter) * width;
            *weight *= end_nm - start_nm;
        }
    }
}

fn build(params: &Params, _context: &Context<'_>) -> Result<Box<dyn WavelengthSampler>, Faults> {
    let StratifiedParams { strata } = params.parse()?;
    Stratified::new(strata)
        .map(|stratified| Box::new(stratified) as _)
        .ok_or_else(|| params.fault_here("no strata").into())
}

spectra_core::register!(wavelengths "stratified": StratifiedParams, build);
