//! The strategy `truncated-gaussian`: the density is one Gaussian, cut off at the ends of the band.
//!
//! Wavelengths are drawn by the inverse of the normal distribution ([`TruncatedGaussian`]). The inverse stays accurate if the
//! center lies far outside the band. Far from the center the Gaussian is practically zero, so a fraction of the samples (see
//! [`Floor`]) follows the response of the channels. All samples are weighted by the density of both together.

use crate::mixture::CHUNK;
use crate::recorded_spectrum::RecordedSpectrum;
use crate::{Cells, Continuum, Floor};
use schemars::JsonSchema;
use serde::Deserialize;
use spectra_core::isa::{Isa, Vectorized};
use spectra_core::params::{Fault, Faults, Params, Wavelength};
use spectra_core::registry::Context;
use spectra_core::spectral::{Grid, SystemResponse};
use spectra_core::stage::{WavelengthDensity, WavelengthSampler};
use spectra_spectrum::{SpectrumError, TruncatedGaussian};

/// Wavelengths are drawn from one Gaussian, cut off at the ends of the band.
///
/// Use it for a narrow source or detector, or as a reference. The center may lie far outside the band. Where the Gaussian
/// is practically zero, wavelengths to which a channel is sensitive are drawn only with a `floor`. Without one, a Gaussian
/// that does not cover every such wavelength is an error. A Gaussian that covers none of them is always an error.
///
/// # Example
/// ```yaml
/// {kind: truncated-gaussian, center: 550 nm, sigma: 60 nm}
/// ```
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
pub struct TruncatedGaussianParams {
    /// Center of the Gaussian, nm if bare; it may lie outside the band.
    pub center: Wavelength,
    /// Standard deviation before the ends are cut off, nm if bare; 1e-6 to 1e6 nm.
    pub sigma: Wavelength,
    /// Fraction of the samples that follow the summed response of all channels instead, 0 to below 1, so that every wavelength to which
    /// a channel is sensitive can be drawn; 1/16 if left out.
    #[serde(default)]
    pub floor: Floor,
}

/// The strategy `truncated-gaussian`: draws wavelengths from one Gaussian and a floor.
#[derive(Clone, Copy, Debug)]
pub struct TruncatedGaussianSampler {
    center_nm: f64,
    sigma_nm: f64,
    floor: Floor,
}

impl TruncatedGaussianSampler {
    /// Creates the strategy with a Gaussian centered at `center_nm` with the standard deviation `sigma_nm`, and a floor.
    ///
    /// # Errors
    /// Same as [`TruncatedGaussian::new`]: a center or standard deviation out of range.
    pub fn new(center_nm: f64, sigma_nm: f64, floor: Floor) -> Result<Self, SpectrumError> {
        TruncatedGaussian::new(center_nm, sigma_nm, 350.0, 830.0)?;
        Ok(Self { center_nm, sigma_nm, floor })
    }

    /// Fails if the Gaussian is practically zero from the shortest to the longest wavelength to which a channel is sensitive: then every
    /// ray except those of the floor would be lost. A center written in mm instead of nm ends here.
    fn reaches(&self, gaussian: &TruncatedGaussian, seen: &RecordedSpectrum, grid: &Grid) -> Result<(), Fault> {
        let (low, high) =
            seen.wavelengths_nm(grid).fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), w| (a.min(w), b.max(w)));
        if low > high || is_drawn(gaussian.density(self.center_nm.clamp(low, high))) {
            return Ok(());
        }
        Err(Fault::new(format!(
            "truncated-gaussian: centered at {} nm with a `sigma` of {} nm, it does not reach what the channels see, {low:.0} to {high:.0} nm",
            self.center_nm, self.sigma_nm
        ))
        .hint("set `center` to a wavelength in this range"))
    }
}

impl WavelengthSampler for TruncatedGaussianSampler {
    fn prepare(&self, system: &SystemResponse) -> Result<Box<dyn WavelengthDensity>, Fault> {
        let seen = RecordedSpectrum::of(system)?;
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
            return Err(Fault::new(format!(
                "at {nm} nm, where a channel is sensitive, the Gaussian is too weak to be sampled"
            ))
            .hint("add a `floor`"));
        }
        let continuum = seen.draws_continuum().then_some(WithFloor { gaussian, floor });
        Ok(Box::new(seen.mixture(system, continuum)?))
    }
}

/// Returns whether a density, 1/nm, is high enough to be drawn at all. Below one draw per 1e12 samples and nanometer, the weights would
/// cause unbounded noise.
fn is_drawn(density_per_nm: f64) -> bool {
    density_per_nm > 1e-12
}

/// Margin that numbers keep from 0 and from 1: at 0 and 1 themselves a density may be 0 and a weight infinite.
pub(crate) const EDGE: f64 = 0.5 * f64::EPSILON;

/// A continuum made of a Gaussian and a floor, the latter with its fraction and density.
#[derive(Clone, Debug)]
struct WithFloor {
    gaussian: TruncatedGaussian,
    floor: Option<(f64, Cells)>,
}

impl Continuum for WithFloor {
    /// Draws in passes over small buffers, which separate the vectorized steps from the look-ups.
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

/// Rescales the numbers above the floor's interval to [0, 1).
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

/// Divides weights by the density of floor and Gaussian together.
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
