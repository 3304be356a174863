//! The aperture: f-number and size of the stop, by the real marginal ray.
//!
//! The f-number is N = 1 / (2 sin theta'), where theta' is the angle at which the marginal ray of an axial object at
//! infinity leaves the lens. With the tangent of a paraxial ray instead, the exposure at f/1.4 would be 11 % off.

use crate::aperture_error::{ApertureError, LimitingRim};
use crate::marginal::{AxialRay, MarginalRay, axial_bundle, is_round_but_for_apertures};
use crate::{Clipping, Optics};
use spectra_core::Loss;
use spectra_core::surface::Action;
use spectra_lens::Lens;
use spectra_tracer::RayPath;

/// Factor by which the real f-number at full aperture may exceed the nominal one: makers round, and a patent's figures are not
/// always those of the lens that was built.
const NOMINAL: f64 = 1.06;
/// Factor by which an f-number may be faster than the lens and still mean its full aperture: f/1.4 for a lens that is f/1.41.
const ROUNDED: f64 = 1.02;

/// Number of halvings of the ray height: an interval of 100 mm ends below 1e-13 mm.
const HALVINGS: usize = 50;
/// Largest number of secant steps to the stop for an f-number, for a lens that is not round. The sine is nearly proportional to the stop.
const SECANTS: usize = 40;
/// Relative error of the sine at which the search stops.
const NEAR: f64 = 1e-11;
/// Largest relative error of the sine that is accepted.
const NEAR_ENOUGH: f64 = 1e-9;

impl Optics {
    /// Returns the rim that limits the axial beam of the lens as it is set; `None` if no rim does, or the lens is not round.
    #[must_use]
    pub fn axial_rim(&self) -> Option<LimitingRim> {
        limiting_rim(self, self.marginal_ray().ok()?, None)
    }
}

/// Returns the rim that ends the first ray above the marginal one; `open` is the ray of the requested f-number without any rims.
fn limiting_rim(optics: &Optics, widest: MarginalRay, open: Option<&RayPath>) -> Option<LimitingRim> {
    if !is_round_but_for_apertures(optics) {
        return None;
    }
    let bundle = axial_bundle(optics, Clipping::RoundIris).ok()?;
    let (cause, surface) = bundle.path([0.0, widest.height_mm * (1.0 + 1e-9) + 1e-9]).end?;
    let element = optics.elements.get((surface as usize).checked_sub(1)?)?;
    let semi_diameter_mm = element.semi_diameter_mm.filter(|_| cause == Loss::Vignetted)?;
    let needed_mm = open.and_then(|path| {
        let local = element.pose.local_point(*path.points.get(surface as usize)?);
        Some(local.truncate().length())
    });
    Some(LimitingRim { surface, semi_diameter_mm, needed_mm })
}

/// Sets the stop of a lens so that the real marginal ray leaves at this f-number. The f-number in the lens's name, and any value
/// between it and the real one, means full aperture; a note on the lens then says so.
///
/// # Errors
/// [`ApertureError`] if the lens has no stop or is not fast enough.
pub fn stop_down(mut lens: Lens, f_number: f64) -> Result<Lens, ApertureError> {
    lens.stop().ok_or(ApertureError::NoStop)?;
    let sine = 0.5 / f_number;
    let round = is_round_but_for_apertures(&lens);
    let mut unset = lens.clone();
    // The rim of an optical surface exists, whatever the stop is set to.
    if let Some(stop) = unset.stop().filter(|stop| unset.elements[*stop].action == Action::Pass) {
        unset.elements[stop].semi_diameter_mm = None;
    }
    let unset = Optics::new(unset);
    let search = |highest_mm| {
        let ray = round.then(|| ray_of_sine(&unset, sine, highest_mm)).transpose()?.flatten();
        ray.ok_or(ApertureError::NoRay(f_number))
    };
    let mut ray = search(lens.first_order(lens.reference_nm).efl_mm.abs() * sine * 2.0);
    if let Ok(widest) = unset.marginal_ray() {
        let real = widest.f_number();
        let in_name = lens.nominal_f_number.is_some_and(|n| f_number >= n * (1.0 - 1e-9) && real <= n * NOMINAL);
        if real > f_number * ROUNDED && !in_name {
            let open = axial_bundle(&unset, Clipping::None)?;
            let path = ray.ok().map(|ray| open.path([0.0, ray.height_mm]));
            let rim = limiting_rim(&unset, widest, path.as_ref());
            return Err(ApertureError::TooFast { asked: f_number, widest: real, rim });
        }
        if real >= f_number {
            if real > f_number * ROUNDED {
                lens.notes
                    .push(format!("f/{f_number} is taken as wide open: the lens is f/{real:.3} by its real rays"));
            }
            return match widest.stop_height_mm {
                Some(height) => Ok(lens.with_stop_semi_diameter_mm(height)),
                None => Err(ApertureError::NoStop),
            };
        }
        // Among rays beyond the rims, some leave less steeply the higher they enter.
        ray = ray.or_else(|_| search(widest.height_mm));
    }
    let height = match round {
        true => ray?.stop_height_mm.ok_or(ApertureError::NoStop)?,
        false => stop_of_sine(&lens, sine)?.ok_or(ApertureError::NoRay(f_number))?,
    };
    Ok(lens.with_stop_semi_diameter_mm(height))
}

/// Returns the axial ray of a round lens without any rims that leaves at this sine, for heights up to `highest_mm`; `None` if there is
/// none.
fn ray_of_sine(optics: &Optics, sine: f64, highest_mm: f64) -> Result<Option<MarginalRay>, ApertureError> {
    let bundle = axial_bundle(optics, Clipping::None)?;
    let (mut low, mut high) = (0.0, highest_mm);
    let mut found = None;
    for _ in 0..HALVINGS {
        let middle = 0.5 * (low + high);
        match AxialRay::trace(optics, &bundle, [0.0, middle]).map(|ray| ray.marginal()) {
            Some(ray) if ray.sine <= sine => (low, found) = (middle, Some(ray)),
            _ => high = middle,
        }
    }
    Ok(found.filter(|ray| (ray.sine / sine - 1.0).abs() < NEAR_ENOUGH))
}

/// Returns the radius of the stop (mm) at which the axial pencil of a lens that is not round has this sine. Rims are ignored.
/// `None` if there is no such radius.
fn stop_of_sine(lens: &Lens, sine: f64) -> Result<Option<f64>, ApertureError> {
    let mut open = lens.clone();
    open.remove_rims();
    let sine_of = |radius_mm: f64| match Optics::new(open.clone().with_stop_semi_diameter_mm(radius_mm)).marginal_ray()
    {
        Ok(ray) => Ok(Some(ray.sine)),
        Err(ApertureError::Unlimited) => Ok(None),
        Err(error) => Err(error),
    };
    // Start with a narrow pencil.
    let mut before = 1e-3 * lens.first_order(lens.reference_nm).efl_mm.abs() * sine;
    let Some(mut sine_before) = sine_of(before)? else { return Ok(None) };
    let mut radius = before * sine / sine_before;
    for _ in 0..SECANTS {
        let Some(found) = sine_of(radius)? else {
            // Too steep for the glass: go back toward a radius that passes.
            radius = 0.5 * (radius + before);
            continue;
        };
        if (found / sine - 1.0).abs() < NEAR {
            return Ok(Some(radius));
        }
        let slope = (found - sine_before) / (radius - before);
        (before, sine_before) = (radius, found);
        radius += (sine - found) / slope;
        if !(radius > 0.0 && radius.is_finite()) {
            return Ok(None);
        }
    }
    Ok(Some(radius).filter(|_| (sine_before / sine - 1.0).abs() < NEAR_ENOUGH))
}
