//! The strategy `hero`: the samples of a group share one number, which is rotated among them.
//!
//! The method follows A. Wilkie, S. Nawaz, M. Droske, A. Weidlich and J. Hanika, "Hero wavelength spectral sampling", Computer
//! Graphics Forum 33(4), 123 (2014): the hero's wavelength is drawn, and the others of its group lie around it at equal distances.
//! In the paper the wavelengths of a group share a path. A lens disperses them, so here every sample has its own path. The
//! distances are equal in probability, not in nanometers: the number is rotated before the density is inverted, so that each
//! wavelength has exactly the density of the underlying strategy.
//!
//! A group of k is k strata with one common jitter. With independent numbers, the noise of the wavelength falls from that of k
//! independent samples to that of k evenly spaced ones. Sobol points are already more even than that.

use crate::SourceTimesResponse;
use schemars::JsonSchema;
use serde::Deserialize;
use spectra_core::isa::Isa;
use spectra_core::params::{Deferred, Fault, Faults, Params};
use spectra_core::registry::{self, Context, StageOf};
use spectra_core::spectral::SystemResponse;
use spectra_core::stage::{WavelengthDensity, WavelengthSampler};

/// Groups of samples share one number, rotated among them.
///
/// The first wavelength of a group is drawn, and the others lie around it at equal distances in probability. A group of k
/// is thus k strata with one common jitter, and each wavelength has exactly the density of the named strategy. Each
/// sample has its own path, since a lens disperses wavelengths. With `numbers: random`, the noise of the wavelength falls
/// from that of k independent samples to that of k evenly spaced ones. Sobol points are already more even than that.
///
/// # Example
/// ```yaml
/// {kind: hero, group: 4}
/// ```
/// ```yaml
/// {kind: hero, group: 8, density: {kind: uniform}}
/// ```
/// # References
/// - A. Wilkie, S. Nawaz, M. Droske, A. Weidlich and J. Hanika, "Hero wavelength spectral sampling", Computer Graphics
///   Forum 33(4), 123 (2014).
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
pub struct HeroParams {
    /// Number of wavelengths in a group, 2 to 1024; 4 if left out.
    #[serde(default = "usual_group")]
    #[schemars(range(min = 2, max = MOST))]
    pub group: u32,
    /// Strategy whose density is used, any except `hero` itself: a name, or a map with its `kind`; `source-times-response` if left
    /// out.
    pub density: Option<Deferred<StageOf<dyn WavelengthSampler>>>,
}

const MOST: u32 = 1024;

fn usual_group() -> u32 {
    4
}

/// The strategy `hero`: rotates one number among the samples of a group.
pub struct Hero {
    group: u32,
    density: Box<dyn WavelengthSampler>,
}

impl Hero {
    /// Creates the strategy with groups of `group` wavelengths and the density of another strategy; `None` unless `group` is 2 to 1024.
    #[must_use]
    pub fn new(group: u32, density: Box<dyn WavelengthSampler>) -> Option<Self> {
        (2..=MOST).contains(&group).then_some(Self { group, density })
    }
}

impl WavelengthSampler for Hero {
    fn prepare(&self, system: &SystemResponse) -> Result<Box<dyn WavelengthDensity>, Fault> {
        Ok(Box::new(Rotated { group: self.group, density: self.density.prepare(system)? }))
    }
}

/// A density whose numbers are rotated within groups.
struct Rotated {
    group: u32,
    density: Box<dyn WavelengthDensity>,
}

impl WavelengthDensity for Rotated {
    fn draw(&self, u: &[f64], wavelength_nm: &mut [f64], line: &mut [u32], weight: &mut [f64], isa: Isa) {
        self.density.draw(u, wavelength_nm, line, weight, isa);
    }

    fn density_per_nm(&self, wavelength_nm: f64) -> f64 {
        self.density.density_per_nm(wavelength_nm)
    }

    fn line_probability(&self, line: usize) -> f64 {
        self.density.line_probability(line)
    }

    fn group(&self) -> u32 {
        self.group
    }
}

fn build(params: &Params, context: &Context<'_>) -> Result<Box<dyn WavelengthSampler>, Faults> {
    let HeroParams { group, density } = params.parse()?;
    let mut faults = Faults::new();
    let density: Option<Box<dyn WavelengthSampler>> = match &density {
        None => Some(Box::new(SourceTimesResponse)),
        Some(node) => faults.take(node.params()).and_then(|inner| match inner.kind() {
            Some("hero") => {
                faults.push(inner.fault("kind", "a group cannot contain groups").hint("name another strategy"));
                None
            }
            _ => faults.take(registry::build::<dyn WavelengthSampler>(&inner, context)),
        }),
    };
    match density.and_then(|density| Hero::new(group, density)) {
        Some(hero) if faults.is_empty() => Ok(Box::new(hero)),
        _ => Err(faults),
    }
}

spectra_core::register!(wavelengths "hero": HeroParams, build);
