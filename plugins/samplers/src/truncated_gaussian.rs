//! `kind: truncated-gaussian`: one Gaussian, cut off at the ends of the band.
//!
//! Drawn by the inverse of the normal distribution ([`TruncatedGaussian`]), safe however far out its center lies. A
//! share of the samples (see [`Floor`]) follows what the channels see, and all are weighed by the density of both
//! together: far from the center the Gaussian is as good as zero.

use crate::mixture::CHUNK;
use crate::seen::Seen;
use crate::{Cells, Continuum, Floor};
use serde::Deserialize;
use spectra_core::isa::Isa;
use spectra_core::params::{Faults, Params, Wavelength};
use spectra_core::registry::{Context, SamplerEntry};
use spectra_core::spectral::SystemResponse;
use spectra_core::stage::{WavelengthDensity, WavelengthSampler};
use spectra_spectrum::{SpectrumError, TruncatedGaussian};

/// Parameters of `kind: truncated-gaussian` as written in a scene.
#[derive(Clone, Copy, Debug, Deserialize)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
pub struct TruncatedGaussianParams {
    /// Center, nm if bare; it may lie outside of the band.
    pub center: Wavelength,
    /// Standard deviation before the ends are cut off, nm if bare; 1e-6 to 1e6 nm.
    pub sigma: Wavelength,
    /// Share of the samples that follow the summed response of all channels instead; 1/16 if left out.
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
}

impl WavelengthSampler for TruncatedGaussianSampler {
    fn prepare(&self, system: &SystemResponse) -> Result<Box<dyn WavelengthDensity>, String> {
        let seen = Seen::of(system)?;
        let (min_nm, max_nm) = (system.grid.start_nm, system.grid.end_nm());
        let gaussian = TruncatedGaussian::new(self.center_nm, self.sigma_nm, min_nm, max_nm)
            .map_err(|e| format!("truncated-gaussian: {e}"))?;
        let floor = self.floor.cells(system.grid, &seen).map(|cells| (self.floor.share(), cells));
        if floor.is_none()
            && let Some(nm) = seen.wavelengths_nm(&system.grid).find(|w| !is_drawn(gaussian.density(*w)))
        {
            return Err(format!(
                "at {nm} nm, where a channel sees, the Gaussian is too far from its center to be drawn; give it a floor"
            ));
        }
        let continuum = seen.draws_continuum().then(|| WithFloor { density: Density::of(&gaussian), gaussian, floor });
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

/// The density of a [`TruncatedGaussian`] within its band, with all divisions done before.
#[derive(Clone, Copy, Debug)]
struct Density {
    /// The point of the band nearest to the center, nm, and in standard deviations from it.
    nearest_nm: f64,
    nearest: f64,
    per_sigma: f64,
    /// Density there, 1/nm.
    largest_per_nm: f64,
}

impl Density {
    fn of(gaussian: &TruncatedGaussian) -> Self {
        let (min_nm, max_nm) = gaussian.band_nm();
        let nearest_nm = gaussian.center_nm().clamp(min_nm, max_nm);
        Self {
            nearest_nm,
            nearest: (nearest_nm - gaussian.center_nm()) / gaussian.sigma_nm(),
            per_sigma: 1.0 / gaussian.sigma_nm(),
            largest_per_nm: gaussian.density(nearest_nm),
        }
    }

    #[inline(always)]
    fn at(self, wavelength_nm: f64) -> f64 {
        let from = (wavelength_nm - self.nearest_nm) * self.per_sigma;
        self.largest_per_nm * libm::exp(-0.5 * from * (from + 2.0 * self.nearest))
    }
}

/// A Gaussian, and the share and the density of the floor beside it.
#[derive(Clone, Debug)]
struct WithFloor {
    gaussian: TruncatedGaussian,
    density: Density,
    floor: Option<(f64, Cells)>,
}

impl Continuum for WithFloor {
    fn draw(&self, u: &[f64], wavelength_nm: &mut [f64], weight: &mut [f64], isa: Isa) {
        let Some((share, cells)) = &self.floor else {
            return self.draw_with(0.0, |_| 0.0, u, wavelength_nm, weight, isa);
        };
        self.draw_with(*share, |part| cells.quantile(part), u, wavelength_nm, weight, isa);
    }

    fn density_per_nm(&self, wavelength_nm: f64) -> f64 {
        let (min_nm, max_nm) = self.gaussian.band_nm();
        if (min_nm..=max_nm).contains(&wavelength_nm) { self.within(wavelength_nm) } else { 0.0 }
    }
}

impl WithFloor {
    /// Density at a wavelength of the band, 1/nm.
    #[inline(always)]
    fn within(&self, wavelength_nm: f64) -> f64 {
        let gaussian = self.density.at(wavelength_nm);
        match &self.floor {
            Some((share, cells)) => share * cells.density_per_nm(wavelength_nm) + (1.0 - share) * gaussian,
            None => gaussian,
        }
    }

    #[inline(always)]
    fn draw_with(
        &self,
        share: f64,
        of_floor: impl Fn(f64) -> f64,
        u: &[f64],
        wavelength_nm: &mut [f64],
        weight: &mut [f64],
        isa: Isa,
    ) {
        let rest = 1.0 - share;
        let mut rescaled = [0.0; CHUNK];
        for first in (0..u.len()).step_by(CHUNK) {
            let part = first..u.len().min(first + CHUNK);
            let (u, nm) = (&u[part.clone()], &mut wavelength_nm[part.clone()]);
            let numbers = &mut rescaled[..part.len()];
            for (number, u) in numbers.iter_mut().zip(u) {
                *number = ((u - share) / rest).clamp(EDGE, 1.0 - EDGE);
            }
            self.gaussian.draw(numbers, nm, isa);
            for ((nm, weight), u) in nm.iter_mut().zip(&mut weight[part]).zip(u) {
                if *u < share {
                    *nm = of_floor(u / share);
                }
                *weight /= self.within(*nm);
            }
        }
    }
}

fn build(params: &Params, _context: &Context<'_>) -> Result<Box<dyn WavelengthSampler>, Faults> {
    let TruncatedGaussianParams { center, sigma, floor } = params.parse()?;
    let sampler = TruncatedGaussianSampler::new(center.nm(), sigma.nm(), floor)
        .map_err(|e| params.fault("sigma", e.to_string()))?;
    Ok(Box::new(sampler))
}

inventory::submit! {
    SamplerEntry::new(
        "truncated-gaussian",
        "One Gaussian, cut off at the ends of the band.",
        env!("CARGO_PKG_NAME"),
        env!("CARGO_PKG_VERSION"),
        build,
    )
}
