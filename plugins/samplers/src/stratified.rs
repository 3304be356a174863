//! `kind: stratified`: the band in strata of equal width, each drawn equally often, with a jitter of its own.
//!
//! The number says which stratum; where in it is decided by a hash of all of the number's bits. As many
//! evenly spread numbers as there are strata put one draw into each, at independent places: the textbook's
//! jittered sampling. `uniform` takes the place in the stratum from the number too, and so hands on all of
//! the evenness that Sobol points have: at as many samples as strata both are alike, with more samples
//! `uniform` goes on to fill the strata evenly, while here the draws in a stratum stay independent. It is a
//! yardstick for the strategies, not one to render with. With independent numbers it is `uniform`.
//!
//! A Sobol number has 32 bits, so a stratum of 64 has 2^26 places: their mean is off its middle by
//! about 1e-4 of the stratum's own spread, and that of all strata together by 2e-5.

use crate::{Continuum, Mixture, Shares};
use schemars::JsonSchema;
use serde::Deserialize;
use spectra_core::isa::{Isa, Vectorized};
use spectra_core::numbers::mix64;
use spectra_core::params::{Faults, Params};
use spectra_core::registry::Context;
use spectra_core::spectral::SystemResponse;
use spectra_core::stage::{WavelengthDensity, WavelengthSampler};

/// Strata of the band of equal width, jittered independently.
///
/// The textbook's jittered sampling, as a yardstick: the number of a sample says which stratum, a hash of it where in
/// the stratum. `kind: uniform` hands on all of the evenness of Sobol points and is the better one beyond as many
/// samples as strata. Where the source has lines beside a continuum, they get half of the samples.
///
/// # Example
/// ```yaml
/// {kind: stratified, strata: 128}
/// ```
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
pub struct StratifiedParams {
    /// Number of strata of the band, 1 to 65536; 64 if left out.
    #[serde(default = "usual_strata")]
    #[schemars(range(min = 1, max = 65536))]
    pub strata: u32,
}

const MOST: u32 = 65_536;

fn usual_strata() -> u32 {
    64
}

/// The strategy.
#[derive(Clone, Copy, Debug)]
pub struct Stratified {
    strata: u32,
}

impl Stratified {
    /// A band cut into `strata` parts; `None` for none or more than 65 536.
    #[must_use]
    pub fn new(strata: u32) -> Option<Self> {
        (1..=MOST).contains(&strata).then_some(Self { strata })
    }
}

impl WavelengthSampler for Stratified {
    fn prepare(&self, system: &SystemResponse) -> Result<Box<dyn WavelengthDensity>, String> {
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
            .ok_or_else(|| "the source emits nothing".to_owned())
    }
}

/// Equal strata from one wavelength to another.
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
    let stratified = Stratified::new(strata).ok_or_else(|| {
        params.fault("strata", format!("{strata} is not a valid number of strata")).hint(format!("1 to {MOST}"))
    })?;
    Ok(Box::new(stratified))
}

spectra_core::register!(wavelengths "stratified": StratifiedParams, build);
