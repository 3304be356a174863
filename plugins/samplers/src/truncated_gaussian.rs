//! `kind: truncated-gaussian`: one Gaussian, cut off at the ends of the band.
//!
//! Drawn by the inverse of the normal distribution ([`TruncatedGaussian`]), safe however far out its center lies. A
//! share of the samples (see [`Floor`]) follows what the channels see, and all are weighed by the density of both
//! together: far from the center the Gaussian is as good as zero.

use crate::mixture::CHUNK;
use crate::seen::Seen;
use crate::{Cells, Continuum, Floor};
use schemars::JsonSchema;
use serde::Deserialize;
use spectra_core::isa::{Isa, Vectorized};
use spectra_core::params::{Faults, Params, Wavelength};
use spectra_core::registry::Context;
use spectra_core::spectral::{Grid, SystemResponse};
use spectra_core::stage::{WavelengthDensity, WavelengthSampler};
use spectra_spectrum::{SpectrumError, TruncatedGaussian};

/// One Gaussian, cut off at the ends of the band.
///
/// Drawn by the inverse of the normal distribution, safe however far out its center lies. For a narrow source or
/// detector, and as a yardstick. Far from the center the Gaussian is as good as zero: `floor` sees to it that what a
/// channel sees there is drawn nonetheless, and without one a Gaussian that does not reach all of it is refused. One that
/// reaches nothing of it is refused with a floor, too.
///
/// # Example
/// ```yaml
/// {kind: truncated-gaussian, center: 550 nm, sigma: 60 nm}
/// ```
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
pub struct TruncatedGaussianParams {
    /// Center, nm if bare; it may lie outside of the band.
    pub center: Wavelength,
    /// Standard deviation before the ends are cut off, nm if bare; 1e-6 to 1e6 nm.
    pub sigma: Wavelength,
    /// Share of the samples that follow the summed response of all channels instead, 0 to below 1, so that nothing that
    /// is seen is never drawn; 1/16 if left out.
    #[serde(default)]
    pub floor: Floor,
}

/// The strategy.
#[derive(Clone, Copy, Debug)]
pub struct TruncatedGaussianSampler {
    center_nm: f64,
    sigma_nm: f64,
    floor: Floor,
}

impl TruncatedGaussianSampler {
    /// A Gaussian around `center_nm` of standard deviation `sigma_nm`, beside a floor.
    ///
    /// # Errors
    /// As [`TruncatedGaussian::new`].
    pub fn new(center_nm: f64, sigma_nm: f64, floor: Floor) -> Result<Self, SpectrumError> {
        TruncatedGaussian::new(center_nm, sigma_nm, 350.0, 830.0)?;
        Ok(Self { center_nm, sigma_nm, floor })
    }

    /// An error where the Gaussian draws nothing between the least and the greatest wavelength that a channel sees: every
    /// ray but those of the floor would be lost. A center in mm for one in nm ends here.
    fn reaches(&self, gaussian: &TruncatedGaussian, seen: &Seen, grid: &Grid) -> Result<(), String> {
        let (low, high) =
            seen.wavelengths_nm(grid).fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), w| (a.min(w), b.max(w)));
        if low > high || is_drawn(gaussian.density(self.center_nm.clamp(low, high))) {
            return Ok(());
        }
        Err(format!(
            "truncated-gaussian: from its center at {} nm a `sigma` of {} nm does not reach what the channels see, {low:.0} to {high:.0} nm; set `center` within",
            self.center_nm, self.sigma_nm
        ))
    }
}

impl WavelengthSampler for TruncatedGaussianSampler {
    fn prepare(&self, system: &SystemResponse) -> Result<Box<dyn WavelengthDensity>, String> {
        let seen = Seen::of(system)?;
        let (min_nm, max_nm) = (system.grid.start_nm, system.grid.end_nm());
        let gaussian = TruncatedGaussian::new(self.center_nm, self.sigma_nm, min_nm, max_nm)
            .map_err(|e| format!("truncated-gaussian: {e}"))?;
        if seen.draws_continuum() {
            self.reaches(&gaussian, &seen, &system.grid)?;
        }
        let floor = self.floor.cells(system.grid, &seen).map(|cells| (self.floor.share(), cells));
        if floor.is_none()
            && let Some(nm) = seen.wavelengths_nm(&system.grid).find(|w| !is_drawn(gaussian.density(*w)))
        {
            return Err(format!(
                "at {nm} nm, where a channel sees, the Gaussian is too far from its center to be sampled; add a `floor`"
            ));
        }
        let continuum = seen.draws_continuum().then_some(WithFloor { gaussian, floor });
        Ok(Box::new(seen.mixture(system, continuum)?))
    }
}

/// Whether a density (1/nm) is more than what never happens: less than once in 1e12 samples and nanometres, its
/// weight would be noise without end.
fn is_drawn(density_per_nm: f64) -> bool {
    density_per_nm > 1e-12
}

/// The least and one less the greatest share that is drawn: at 0 and 1 themselves a density may be 0, and a weight
/// infinite.
pub(crate) const EDGE: f64 = 0.5 * f64::EPSILON;

/// A Gaussian, and the share and the density of the floor beside it.
#[derive(Clone, Debug)]
struct WithFloor {
    gaussian: TruncatedGaussian,
    floor: Option<(f64, Cells)>,
}

impl Continuum for WithFloor {
    /// In passes over small buffers: what fills vectors apart from what looks things up.
    fn draw(&self, u: &[f64], wavelength_nm: &mut [f64], weight: &mut [f64], isa: Isa) {
        let share = self.floor.as_ref().map_or(0.0, |f| f.0);
        let (rest, inverse) = (1.0 - share, 1.0 / (1.0 - share));
        let (mut numbers, mut density, mut of_floor) = ([0.0; CHUNK], [0.0; CHUNK], [0.0; CHUNK]);
        for first in (0..u.len()).step_by(CHUNK) {
            let part = first..u.len().min(first + CHUNK);
            let (u, nm) = (&u[part.clone()], &mut wavelength_nm[part.clone()]);
            let (numbers, density) = (&mut numbers[..u.len()], &mut density[..u.len()]);
            let of_floor = &mut of_floor[..u.len()];
            isa.run(Rescale { u, share, inverse, out: numbers });
            self.gaussian.draw(numbers, nm, isa);
            if let Some((share, cells)) = &self.floor {
                for (nm, u) in nm.iter_mut().zip(u) {
                    if u < share {
                        *nm = cells.quantile(u / share);
                    }
                }
                for (of_floor, nm) in of_floor.iter_mut().zip(&*nm) {
                    *of_floor = share * cells.density_per_nm(*nm);
                }
            }
            self.gaussian.densities(nm, density, isa);
            isa.run(Weigh { of_floor, density, rest, weight: &mut weight[part] });
        }
    }

    fn density_per_nm(&self, wavelength_nm: f64) -> f64 {
        let gaussian = self.gaussian.density(wavelength_nm);
        match &self.floor {
            Some((share, cells)) => share * cells.density_per_nm(wavelength_nm) + (1.0 - share) * gaussian,
            None => gaussian,
        }
    }
}

/// Numbers behind the floor's share, on [0, 1) again.
struct Rescale<'a> {
    u: &'a [f64],
    share: f64,
    inverse: f64,
    out: &'a mut [f64],
}

impl Vectorized for Rescale<'_> {
    type Output = ();
    #[inline(always)]
    fn run(self) {
        for (out, u) in self.out.iter_mut().zip(self.u) {
            *out = ((u - self.share) * self.inverse).clamp(EDGE, 1.0 - EDGE);
        }
    }
}

/// Weights over the density of floor and Gaussian together.
struct Weigh<'a> {
    of_floor: &'a [f64],
    density: &'a [f64],
    rest: f64,
    weight: &'a mut [f64],
}

impl Vectorized for Weigh<'_> {
    type Output = ();
    #[inline(always)]
    fn run(self) {
        for ((weight, of_floor), density) in self.weight.iter_mut().zip(self.of_floor).zip(self.density) {
            *weight /= of_floor + self.rest * density;
        }
    }
}

fn build(params: &Params, _context: &Context<'_>) -> Result<Box<dyn WavelengthSampler>, Faults> {
    let TruncatedGaussianParams { center, sigma, floor } = params.parse()?;
    let sampler = TruncatedGaussianSampler::new(center.nm(), sigma.nm(), floor)
        .map_err(|e| params.fault("sigma", e.to_string()))?;
    Ok(Box::new(sampler))
}

spectra_core::register!(wavelengths "truncated-gaussian": TruncatedGaussianParams, build);
