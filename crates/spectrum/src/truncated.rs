//! Gaussian cut off at the ends of a band, sampled by inverse transform.
//!
//! Two algorithms share one type; the choice is made when it is created. Near the middle it is the inverse of the normal
//! distribution by M. J. Wichura's AS 241 (Applied Statistics 37, 477, 1988). If the whole band lies more than 25 standard
//! deviations out, where erfc is about to underflow, it is Newton's method on the logarithm of the tail, whose hazard is one
//! over Mills' ratio. None of it uses branches, fused operations or the system's functions, so that it fills vectors and gives
//! the same bits on every instruction set.

use spectra_core::isa::{Isa, Vectorized};

use crate::cell;
use crate::error::{SpectrumError, check};
use crate::normal::{Mass, SQRT_TAU};
use spectra_numerics::normal::{self, exp_of_negative, far_mills, inverse_survival, log};

/// Distance from the center, in standard deviations, at which the algorithm for the tail takes over.
const FAR: f64 = normal::FAR;

/// Probability density exp(-(x - center)^2 / (2 sigma^2)) between two wavelengths, 0 outside, normalized to an integral of 1.
///
/// ```
/// use spectra_spectrum::TruncatedGaussian;
/// let density = TruncatedGaussian::new(550.0, 50.0, 380.0, 780.0)?;
/// assert!((density.quantile(0.5) - 550.0210).abs() < 1e-4);
/// # Ok::<(), spectra_spectrum::SpectrumError>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct TruncatedGaussian {
    center_nm: f64,
    sigma_nm: f64,
    min_nm: f64,
    max_nm: f64,
    /// Ends of the band in standard deviations from the center.
    low: f64,
    high: f64,
    mass: Mass,
    draw: Draw,
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Draw {
    Central(Central),
    Tail(Tail),
}

impl TruncatedGaussian {
    /// Creates the Gaussian around `center_nm` with standard deviation `sigma_nm` (before it is cut), on `min_nm` to `max_nm`.
    ///
    /// The center may lie anywhere, even far outside of the band.
    ///
    /// # Errors
    /// [`SpectrumError::OutOfRange`] unless the center is within 1e9 nm of 0, sigma is from 1e-6 to 1e6 nm, and 0 <= min < max
    /// <= 1e9 nm.
    pub fn new(center_nm: f64, sigma_nm: f64, min_nm: f64, max_nm: f64) -> Result<Self, SpectrumError> {
        check("center, nm", "within 1e9 of 0", center_nm, |c| c.abs() <= 1e9)?;
        check("standard deviation, nm", "between 1e-6 and 1e6", sigma_nm, |s| (1e-6..=1e6).contains(&s))?;
        check("lower end of the band, nm", "0 or more", min_nm, |w| w >= 0.0)?;
        check("upper end of the band, nm", "above the lower one and at most 1e9", max_nm, |w| w > min_nm && w <= 1e9)?;
        let (low, high) = ((min_nm - center_nm) / sigma_nm, (max_nm - center_nm) / sigma_nm);
        let mass = Mass::of_width(low, high, (max_nm - min_nm) / sigma_nm);
        let span = Span { min_nm, max_nm, sigma_nm };
        let draw = if low > FAR {
            Draw::Tail(Tail::new(span, min_nm, 1.0, low, mass))
        } else if high < -FAR {
            Draw::Tail(Tail::new(span, max_nm, -1.0, -high, mass))
        } else {
            let root = std::f64::consts::FRAC_1_SQRT_2;
            Draw::Central(Central {
                span,
                center_nm,
                below: 0.5 * libm::erfc(-low * root),
                above: 0.5 * libm::erfc(high * root),
                mass: mass.value() / SQRT_TAU,
            })
        };
        Ok(Self { center_nm, sigma_nm, min_nm, max_nm, low, high, mass, draw })
    }

    /// Center before the Gaussian was cut, nm.
    #[must_use]
    pub fn center_nm(&self) -> f64 {
        self.center_nm
    }

    /// Standard deviation before the Gaussian was cut, nm.
    #[must_use]
    pub fn sigma_nm(&self) -> f64 {
        self.sigma_nm
    }

    /// Lower and upper end of the band, nm.
    #[must_use]
    pub fn band_nm(&self) -> (f64, f64) {
        (self.min_nm, self.max_nm)
    }

    /// Share of the whole Gaussian that lies on the band; 0 if it underflows.
    #[must_use]
    pub fn mass(&self) -> f64 {
        self.mass.value() / SQRT_TAU
    }

    /// Returns the probability density at `wavelength_nm`, 1/nm; 0 outside of the band, and for NaN.
    #[must_use]
    pub fn density(&self, wavelength_nm: f64) -> f64 {
        if !(self.min_nm..=self.max_nm).contains(&wavelength_nm) {
            return 0.0;
        }
        // Relative to the point of the band nearest to the center: nothing that matters underflows.
        let from = self.distance_from_nearest(wavelength_nm);
        let exponent = -0.5 * from * (from + 2.0 * self.mass.nearest);
        libm::exp(exponent) / (self.sigma_nm * self.mass.scaled)
    }

    /// Returns the probability of a draw at or below `wavelength_nm`; 0 for NaN.
    #[must_use]
    pub fn cumulative(&self, wavelength_nm: f64) -> f64 {
        if wavelength_nm.is_nan() || wavelength_nm <= self.min_nm {
            return 0.0;
        }
        if wavelength_nm >= self.max_nm {
            return 1.0;
        }
        let nearest = self.mass.nearest;
        let from = self.distance_from_nearest(wavelength_nm);
        let z = (nearest + from).clamp(self.low, self.high);
        // The point of a part that is nearest to the center is either that of the band, or z.
        let part = |mass: Mass, is_z: bool| {
            let from = if is_z { from } else { 0.0 };
            mass.scaled / self.mass.scaled * libm::exp(-0.5 * from * (from + 2.0 * nearest))
        };
        let width_below = (wavelength_nm - self.min_nm) / self.sigma_nm;
        let width_above = (self.max_nm - wavelength_nm) / self.sigma_nm;
        // The smaller part keeps its digits.
        let below = part(Mass::of_width(self.low, z, width_below), z <= 0.0);
        if below < 0.5 { below } else { 1.0 - part(Mass::of_width(z, self.high, width_above), z > 0.0) }
    }

    /// Returns the distance from the point of the band that is nearest to the center, in standard deviations.
    fn distance_from_nearest(&self, wavelength_nm: f64) -> f64 {
        let nearest_nm = self.center_nm.clamp(self.min_nm, self.max_nm);
        (wavelength_nm - nearest_nm) / self.sigma_nm
    }

    /// Returns the wavelength (nm) below which the share `u` of all draws lies. It lies within the band for every `u`, NaN
    /// included.
    ///
    /// The cumulative probability at the result equals `u` within 1e-13, apart from the rounding of `u` and the wavelength. A
    /// sigma that is much wider than the band adds 2e-16 of it.
    #[must_use]
    pub fn quantile(&self, u: f64) -> f64 {
        match &self.draw {
            Draw::Central(central) => central.quantile(u),
            Draw::Tail(tail) => tail.quantile(u),
        }
    }

    /// Draws a wavelength (nm) for each number of `u` in [0, 1): the quantile of that number, with the same bits on every `isa`.
    ///
    /// The shorter of the two slices sets the number of draws.
    pub fn draw(&self, u: &[f64], wavelength_nm: &mut [f64], isa: Isa) {
        match self.draw {
            Draw::Central(central) => isa.run(Fill { quantile: central, u, wavelength_nm }),
            Draw::Tail(tail) => isa.run(Fill { quantile: tail, u, wavelength_nm }),
        }
    }

    /// Writes the density, 1/nm, at each of `wavelength_nm`, which must lie within the band. The values are those of
    /// [`TruncatedGaussian::density`] within a few roundings, with the same bits on every `isa`.
    ///
    /// The shorter of the two slices sets the number of values.
    pub fn densities(&self, wavelength_nm: &[f64], density_per_nm: &mut [f64], isa: Isa) {
        let fill = FillDensity {
            nearest_nm: self.center_nm.clamp(self.min_nm, self.max_nm),
            twice_nearest: 2.0 * self.mass.nearest,
            per_sigma: 1.0 / self.sigma_nm,
            largest_per_nm: 1.0 / (self.sigma_nm * self.mass.scaled),
            wavelength_nm,
            density_per_nm,
        };
        isa.run(fill);
    }

    /// Mean of the draws, nm.
    #[must_use]
    pub fn mean(&self) -> f64 {
        let nearest_nm = self.center_nm.clamp(self.min_nm, self.max_nm);
        nearest_nm + self.sigma_nm * self.moments().0
    }

    /// Standard deviation of the draws, nm.
    #[must_use]
    pub fn standard_deviation(&self) -> f64 {
        self.sigma_nm * self.moments().1
    }

    /// Returns mean, from the point nearest to the center, and standard deviation, both in standard deviations of the whole Gaussian.
    ///
    /// It uses quadrature, because the closed forms subtract nearly equal numbers in the tails and on narrow bands.
    fn moments(&self) -> (f64, f64) {
        /// Below exp(-45) no contribution reaches the last digit.
        const DEEPEST: f64 = 45.0;
        const PANELS: u32 = 64;
        let nearest = self.mass.nearest;
        // Distance at which the density has fallen that far, on the side that leads away from the center.
        let reach = 2.0 * DEEPEST / (nearest.abs() + (nearest * nearest + 2.0 * DEEPEST).sqrt());
        let from = (self.low - nearest).max(-reach);
        let to = (self.high - nearest).min(reach);
        let breaks: Vec<f64> = (0..=PANELS).map(|i| from + (to - from) * f64::from(i) / f64::from(PANELS)).collect();
        let weight = |t: f64| libm::exp(-0.5 * t * (t + 2.0 * nearest));
        let mass = cell::integral(weight, &breaks);
        let mean = cell::integral(|t| t * weight(t), &breaks) / mass;
        let variance = cell::integral(|t| (t - mean) * (t - mean) * weight(t), &breaks) / mass;
        (mean, variance.sqrt())
    }
}

/// Band and width that every draw uses to get its wavelength.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Span {
    min_nm: f64,
    max_nm: f64,
    sigma_nm: f64,
}

impl Span {
    /// Clamps a wavelength to the band; NaN becomes its lower end.
    #[inline(always)]
    fn clamp(self, wavelength_nm: f64) -> f64 {
        let at_least = if wavelength_nm > self.min_nm { wavelength_nm } else { self.min_nm };
        if at_least < self.max_nm { at_least } else { self.max_nm }
    }
}

/// Maps a share of the draws to the wavelength below which it lies.
trait Quantile: Copy {
    fn quantile(&self, u: f64) -> f64;
}

struct Fill<'a, Q> {
    quantile: Q,
    u: &'a [f64],
    wavelength_nm: &'a mut [f64],
}

impl<Q: Quantile> Vectorized for Fill<'_, Q> {
    type Output = ();
    #[inline(always)]
    fn run(self) {
        for (wavelength, u) in self.wavelength_nm.iter_mut().zip(self.u) {
            *wavelength = self.quantile.quantile(*u);
        }
    }
}

struct FillDensity<'a> {
    nearest_nm: f64,
    twice_nearest: f64,
    per_sigma: f64,
    largest_per_nm: f64,
    wavelength_nm: &'a [f64],
    density_per_nm: &'a mut [f64],
}

impl Vectorized for FillDensity<'_> {
    type Output = ();
    #[inline(always)]
    fn run(self) {
        let Self { nearest_nm, twice_nearest, per_sigma, largest_per_nm, .. } = self;
        for (density, wavelength) in self.density_per_nm.iter_mut().zip(self.wavelength_nm) {
            let from = (wavelength - nearest_nm) * per_sigma;
            *density = largest_per_nm * exp_of_negative(-0.5 * from * (from + twice_nearest));
        }
    }
}

/// Sampling of a band that reaches to within [`FAR`] of the center.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Central {
    span: Span,
    center_nm: f64,
    /// Shares of the whole Gaussian below the band, above it, and on it.
    below: f64,
    above: f64,
    mass: f64,
}

impl Quantile for Central {
    #[inline(always)]
    fn quantile(&self, u: f64) -> f64 {
        // From whichever end is nearer, because a share close to 1 has lost its digits.
        let lower = self.below + u * self.mass;
        let upper = self.above + (1.0 - u) * self.mass;
        let (share, side) = if lower < upper { (lower, -1.0) } else { (upper, 1.0) };
        // Also covers u = 1 with nothing above the band.
        let share = if share > 1e-300 { share } else { 1e-300 };
        let z = side * inverse_survival(share);
        self.span.clamp(self.center_nm + self.span.sigma_nm * z)
    }
}

/// Sampling of a band that lies beyond [`FAR`].
#[derive(Clone, Copy, Debug, PartialEq)]
struct Tail {
    span: Span,
    /// End of the band near the center (nm), and the direction away from the center, 1 or -1.
    from_nm: f64,
    direction: f64,
    /// Distance of that end from the center, in standard deviations.
    start: f64,
    mills: f64,
    /// Share of the whole tail that lies on the band.
    share: f64,
}

impl Tail {
    fn new(span: Span, from_nm: f64, direction: f64, start: f64, mass: Mass) -> Self {
        let mills = far_mills(start);
        Self { span, from_nm, direction, start, mills, share: mass.scaled / mills }
    }
}

impl Quantile for Tail {
    #[inline(always)]
    fn quantile(&self, u: f64) -> f64 {
        let u = if self.direction > 0.0 { u } else { 1.0 - u };
        let left = 1.0 - u * self.share;
        let left = if left > 1e-300 { left } else { 1e-300 };
        let wanted = -log(left);
        // The share beyond a point falls as exp(-start d - d^2/2) times a ratio of Mills' ratios, which is near 1 here. Without
        // that ratio it is a quadratic equation; two steps of Newton's method then reach the last digits.
        let start = self.start;
        let mut d = 2.0 * wanted / (start + (start * start + 2.0 * wanted).sqrt());
        let mut step = 0;
        while step < 2 {
            let mills = far_mills(start + d);
            let fallen = d * (start + 0.5 * d) - log(mills / self.mills);
            d -= (fallen - wanted) * mills;
            step += 1;
        }
        self.span.clamp(self.from_nm + self.direction * self.span.sigma_nm * d)
    }
}

#[cfg(test)]
mod tests;
