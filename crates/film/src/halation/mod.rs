//! Halation: light that passes the emulsion, is reflected at the back of the film and returns.
//!
//! A point of the picture scatters light into the base (thickness t, index n) with constant radiance (Lambert's law inside the base), as
//! turbid gelatin of about the base's index does.
//! A ray at the angle theta to the normal meets the back and is reflected by Fresnel's law (totally beyond the critical angle asin(1/n)).
//! It returns to the emulsion at the distance r = 2 t tan(theta). Backing and base absorb on both passes, each longer by 1/cos(theta).
//! So the ring that photographers see around a lamp begins at r = 2 t tan(asin(1/n)), as A. Cornu found ("Sur le halo photographique",
//! Comptes rendus 110, 1890; C. E. K. Mees, "The Theory of the Photographic Process", 1942, chapter on halation).
//!
//! With sin^2(theta) = r^2 / (r^2 + 4 t^2), the light that returns per area is
//!
//! f(r) = R(theta) T^(2/cos(theta)) 4 t^2 / (pi (r^2 + 4 t^2)^2),
//!
//! whose integral is the fraction that returns. The emulsion reflects a share of it down again, evenly as before, and so on: [`ReturnedLight`] sums
//! all trips. The second trip adds a faint ring at twice the distance.
//!
//! **Names.** A stock's file calls `entering` `scattered`, and the base's `transmittance` `backing`; the film effects of a scene translate.
//!
//! **Layers.** A layer gets a smaller share of the returning light the farther it lies from the base (`halation.layers` of a stock).
//!
//! **Energy.** A stock's speed is measured with even light, halation included. So the arriving light is divided by one plus the returned
//! fraction: an even, endless exposure does not change.
//! In general, the sum of the plane falls by the light that lands outside the frame. The film outside the frame is taken as unexposed.

mod base;
mod kernel;
mod returned_light;
mod spread;
mod table;

pub use base::{HalationBase, HalationError};
pub use returned_light::ReturnedLight;

use crate::cache::Cache;
use crate::raster::Raster;
use kernel::Level;
use spread::Spread;
use std::sync::Arc;

/// Caches of the returned light of a point, by the base, and of its kernels on a plane.
static TRIPS: Cache<HalationBase, ReturnedLight> = Cache::new();
static SPREADS: Cache<(HalationBase, Raster), Spread> = Cache::new();

/// The halation of one layer on planes of one size.
///
/// ```
/// use spectra_film::halation::{Halation, HalationBase};
/// use spectra_film::raster::Raster;
/// let base = HalationBase { thickness_mm: 0.125, index: 1.48, entering: 0.3, transmittance: 0.9, reflected: 0.2 };
/// assert!((base.ring_radius_mm() - 0.2291).abs() < 5e-5);
/// let raster = Raster::new(60, 40, 0.012);
/// let mut exposure = vec![0.0; raster.pixels()];
/// exposure[20 * 60 + 30] = 1000.0;
/// Halation::new(&base, &raster)?.apply(&mut exposure);
/// assert!(exposure[20 * 60 + 30 + 19] > 2.0 * exposure[20 * 60 + 30 + 9]);
/// # Ok::<(), spectra_film::halation::HalationError>(())
/// ```
pub struct Halation {
    raster: Raster,
    spread: Option<Arc<Spread>>,
}

impl Halation {
    /// Prepares the halation of `base` for planes of the size and pitch of `raster`.
    ///
    /// # Errors
    /// [`HalationError`] for values out of range, and for a pitch that is not positive and finite.
    pub fn new(base: &HalationBase, raster: &Raster) -> Result<Self, HalationError> {
        base.check()?;
        if !(raster.pitch_mm > 0.0 && raster.pitch_mm.is_finite()) {
            return Err(HalationError::OutOfRange { what: "pitch", value: raster.pitch_mm, range: "more than 0 mm" });
        }
        let trips = TRIPS.get_or_compute(*base, || ReturnedLight::new(base));
        let none = trips.returned() == 0.0 || raster.pixels() == 0;
        let made = || Spread::new(Level::all(base, &trips, raster), 1.0 / (1.0 + trips.returned()), raster);
        let spread = (!none).then(|| SPREADS.get_or_compute((*base, *raster), made));
        Ok(Self { raster: *raster, spread })
    }

    /// Spreads the light of a plane of exposure (linear; any unit), in place.
    ///
    /// The plane must be a whole frame: light from parts that are not given is missing. NaN counts as 0. Needs memory for about one more
    /// plane.
    ///
    /// # Panics
    /// If the number of pixels of the plane differs from that of the raster.
    pub fn apply(&self, exposure: &mut [f32]) {
        exposure.copy_from_slice(&self.applied(exposure));
    }

    /// Returns the plane that [`Halation::apply`] makes of `exposure`.
    ///
    /// # Panics
    /// If the number of pixels of the plane differs from that of the raster.
    #[must_use]
    pub fn applied(&self, exposure: &[f32]) -> Vec<f32> {
        assert_eq!(exposure.len(), self.raster.pixels(), "the plane has the size that was prepared for");
        let Some(spread) = &self.spread else { return exposure.to_vec() };
        let mut plane = vec![0.0; exposure.len()];
        spread.apply(exposure, &mut plane);
        plane
    }
}
