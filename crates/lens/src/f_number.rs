//! The aperture: f-number and stop by the real marginal ray.
//!
//! N = 1 / (2 sin theta'), where theta' is the angle at which the marginal ray of an axial object at
//! infinity leaves the lens. With the tangent of a paraxial ray instead, f/1.4 is 11 % off in exposure.

use crate::{Indices, Lens, RayPath, Tracer, Travel};
use glam::DVec3;
use spectra_core::Loss;
use spectra_core::loss::ALIVE;
use spectra_core::surface::Action;
use spectra_core::{Isa, RayBatch, math};
use spectra_glass::DispersionError;

/// The marginal ray of an axial object at infinity.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MarginalRay {
    /// Height in front of the lens, mm: half the real entrance pupil.
    pub height_mm: f64,
    /// Sine of the angle to the axis behind the lens.
    pub sine: f64,
    /// Height at the stop, mm; `None` without one.
    pub stop_height_mm: Option<f64>,
}

impl MarginalRay {
    /// N = 1 / (2 sin theta').
    #[must_use]
    pub fn f_number(&self) -> f64 {
        0.5 / self.sine
    }
}

/// An f-number in words.
fn stop(number: &f64) -> String {
    if (1e-3..1e6).contains(number) { format!("f/{number:.3}") } else { format!("f/{number:e}") }
}

/// Why an f-number cannot be set.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum ApertureError {
    /// The lens passes no axial ray, or nothing limits it.
    #[error("the lens states no clear semi-diameter that limits the axial beam, so its full aperture is unknown")]
    Unlimited,
    /// Faster than the lens is.
    #[error("{} is faster than the lens, which is {} wide open{}", stop(.asked), stop(.widest), limited(.rim, *.asked))]
    TooFast {
        /// Wanted f-number.
        asked: f64,
        /// The lens's own.
        widest: f64,
        /// What limits it, where a rim does.
        rim: Option<LimitingRim>,
    },
    /// No stop to set.
    #[error("the lens has no `stop` surface to set")]
    NoStop,
    /// A medium without an index.
    #[error(transparent)]
    Medium(#[from] DispersionError),
    /// No marginal ray found.
    #[error("no axial ray leaves the lens at {}", stop(.0))]
    NoRay(f64),
}

/// The rim that limits the axial beam.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LimitingRim {
    /// Its surface, from 1.
    pub surface: u32,
    /// Its clear semi-diameter, mm.
    pub semi_diameter_mm: f64,
    /// The one that the f-number asked for would need there, mm; `None` where no ray leaves so steeply whatever the rims.
    pub needed_mm: Option<f64>,
}

/// What limits the aperture, as the end of a sentence.
fn limited(rim: &Option<LimitingRim>, asked: f64) -> String {
    let Some(rim) = rim else { return String::new() };
    let needed = match rim.needed_mm {
        Some(r) => format!("f/{asked:.3} would need r = {r:.2} mm there"),
        None => format!("even without rims no ray would leave the lens at f/{asked:.3}"),
    };
    format!(": the rim of surface {} (r = {:.2} mm) limits it; {needed}", rim.surface, rim.semi_diameter_mm)
}

/// By how much the real f-number of a full aperture may exceed the nominal one: makers round, and a patent's figures are not
/// always those of the lens that was built.
const NOMINAL: f64 = 1.06;
/// By how much an f-number may be faster than the lens and still mean its full aperture: f/1.4 of a lens that is f/1.41.
const ROUNDED: f64 = 1.02;

/// Halvings of the height: an interval of 100 mm ends below 1e-13 mm.
const HALVINGS: usize = 50;
/// Rings of equal area over the pupil.
const RINGS: usize = 256;
/// Rays on each, where the lens is not round.
const SPOKES: usize = 64;

impl Lens {
    fn axial_ray(&self, tracer: &Tracer, height_mm: f64) -> Option<MarginalRay> {
        let path = tracer.path(DVec3::new(0.0, height_mm, 0.0), DVec3::Z, self.reference_nm);
        if path.end.is_some() {
            return None;
        }
        let stop_height_mm = self.stop().and_then(|stop| {
            let local = self.elements[stop].pose.local_point(*path.points.get(stop + 1)?);
            Some(local.truncate().length())
        });
        let behind = self.image_pose.local_direction(path.direction);
        Some(MarginalRay { height_mm, sine: behind.truncate().length(), stop_height_mm })
    }

    /// The highest axial ray that the lens passes as it stands; of a lens that is not round, that of the round pencil with the areas
    /// of its own, before and behind the lens.
    ///
    /// # Errors
    /// [`ApertureError::Unlimited`].
    pub fn marginal_ray(&self) -> Result<MarginalRay, ApertureError> {
        if !self.is_round_but_for_apertures() {
            return self.axial_pencil()?.ok_or(ApertureError::Unlimited);
        }
        let largest = self.largest_semi_diameter_mm().ok_or(ApertureError::Unlimited)?;
        let round = self.clone().with_round_stop();
        let tracer = Tracer::new(&round, Indices::At(self.reference_nm), Isa::Baseline)?;
        if self.axial_ray(&tracer, largest * 2.0).is_some() {
            return Err(ApertureError::Unlimited);
        }
        let (mut low, mut high) = (largest * 1e-6, largest * 2.0);
        let mut best = self.axial_ray(&tracer, low).ok_or(ApertureError::Unlimited)?;
        for _ in 0..HALVINGS {
            let middle = 0.5 * (low + high);
            match self.axial_ray(&tracer, middle) {
                Some(ray) => (low, best) = (middle, ray),
                None => high = middle,
            }
        }
        Ok(best)
    }

    /// Part of the light of an axial object at infinity, within the entrance pupil of `marginal`, that reaches the image:
    /// what coatings, mirrors and glass leave, and what an obstruction in the middle lets pass of it. Where the lens
    /// is not round about its axis, of the light that passes at all. Without a `marginal` ray, along the axis.
    ///
    /// # Errors
    /// A medium has no usable index.
    pub fn axial_transmittance(&self, indices: Indices, marginal: Option<MarginalRay>) -> Result<f64, DispersionError> {
        let tracer = Tracer::new(self, indices, Isa::detect())?;
        let radius_mm = marginal.map_or(0.0, |ray| ray.height_mm);
        let round = self.has_axis_of_revolution();
        let spokes = if round { 1 } else { SPOKES };
        let mut rays = RayBatch::new(RINGS * spokes);
        rays.restart(RINGS * spokes);
        let wavelength_nm = match indices {
            Indices::At(nm) => nm,
            Indices::Band { .. } | Indices::Stated => self.reference_nm,
        };
        let c = rays.columns_mut();
        for i in 0..RINGS * spokes {
            // Rings and spokes of equal area.
            let r = radius_mm * (((i / spokes) as f64 + 0.5) / RINGS as f64).sqrt();
            let (sin, cos) = math::sin_cos_turns(((i % spokes) as f64 + 0.5) / spokes as f64);
            (c.x[i], c.y[i], c.z[i]) = (if round { 0.0 } else { r * cos }, if round { r } else { r * sin }, 0.0);
            (c.l[i], c.m[i], c.n[i]) = (0.0, 0.0, 1.0);
            c.wavelength_nm[i] = wavelength_nm;
        }
        tracer.trace(&mut rays, &mut tracer.work_in_place(RINGS * spokes), Travel::Forward);
        let (mut sum, mut passed) = (0.0, 0);
        for (weight, state) in rays.weights().iter().zip(rays.states()) {
            if *state == ALIVE {
                sum += weight;
                passed += 1;
            }
        }
        Ok(sum / if round { RINGS as f64 } else { f64::from(passed.max(1)) })
    }

    /// The rim that limits the axial beam as the lens stands; `None` where none does, or the lens is not round.
    #[must_use]
    pub fn axial_rim(&self) -> Option<LimitingRim> {
        self.limiting_rim(self.marginal_ray().ok()?, None)
    }

    /// The rim that ends the first ray above the marginal one; `open` is the ray of the asked f-number without any rims.
    fn limiting_rim(&self, widest: MarginalRay, open: Option<&RayPath>) -> Option<LimitingRim> {
        if !self.is_round_but_for_apertures() {
            return None;
        }
        let round = self.clone().with_round_stop();
        let tracer = Tracer::new(&round, Indices::At(self.reference_nm), Isa::Baseline).ok()?;
        let above = DVec3::new(0.0, widest.height_mm * (1.0 + 1e-9) + 1e-9, 0.0);
        let (cause, surface) = tracer.path(above, DVec3::Z, self.reference_nm).end?;
        let element = self.elements.get((surface as usize).checked_sub(1)?)?;
        let semi_diameter_mm = element.semi_diameter_mm.filter(|_| cause == Loss::Vignetted)?;
        let needed_mm = open.and_then(|path| {
            let local = element.pose.local_point(*path.points.get(surface as usize)?);
            Some(local.truncate().length())
        });
        Some(LimitingRim { surface, semi_diameter_mm, needed_mm })
    }

    /// The same lens with its stop set so that the real marginal ray leaves at this f-number. The f-number in the lens's
    /// name, and whatever lies between it and the real one, is its full aperture: a note says so.
    ///
    /// # Errors
    /// [`ApertureError`]: no stop, or faster than the lens.
    pub fn at_f_number(mut self, f_number: f64) -> Result<Self, ApertureError> {
        self.stop().ok_or(ApertureError::NoStop)?;
        let sine = 0.5 / f_number;
        let round = self.is_round_but_for_apertures();
        // Without the stop's own size: a lens may state its stop at some other f-number.
        let mut open = self.clone();
        for e in &mut open.elements {
            e.semi_diameter_mm = None;
            e.apertures.clear();
        }
        let tracer = Tracer::new(&open, Indices::At(self.reference_nm), Isa::Baseline)?;
        let search = |mut high: f64| -> Result<MarginalRay, ApertureError> {
            let mut low = 0.0;
            let mut found = None;
            for _ in 0..if round { HALVINGS } else { 0 } {
                let middle = 0.5 * (low + high);
                match self.axial_ray(&tracer, middle) {
                    Some(ray) if ray.sine <= sine => (low, found) = (middle, Some(ray)),
                    _ => high = middle,
                }
            }
            found.filter(|r: &MarginalRay| (r.sine / sine - 1.0).abs() < 1e-9).ok_or(ApertureError::NoRay(f_number))
        };
        let mut ray = search(self.first_order(self.reference_nm).efl_mm.abs() * sine * 2.0);
        let mut unset = self.clone();
        // The rim of an optical surface is there, whatever the stop is set to.
        if let Some(stop) = unset.stop().filter(|stop| unset.elements[*stop].action == Action::Pass) {
            unset.elements[stop].semi_diameter_mm = None;
        }
        if let Ok(widest) = unset.marginal_ray() {
            let real = widest.f_number();
            let in_name = self.nominal_f_number.is_some_and(|n| f_number >= n * (1.0 - 1e-9) && real <= n * NOMINAL);
            if real > f_number * ROUNDED && !in_name {
                let path = ray
                    .as_ref()
                    .ok()
                    .map(|ray| tracer.path(DVec3::new(0.0, ray.height_mm, 0.0), DVec3::Z, self.reference_nm));
                let rim = unset.limiting_rim(widest, path.as_ref());
                return Err(ApertureError::TooFast { asked: f_number, widest: real, rim });
            }
            if real >= f_number {
                if real > f_number * ROUNDED {
                    self.notes
                        .push(format!("f/{f_number} is taken as wide open: the lens is f/{real:.3} by its real rays"));
                }
                return match widest.stop_height_mm {
                    Some(height) => Ok(self.with_stop_semi_diameter_mm(height)),
                    None => Err(ApertureError::NoStop),
                };
            }
            // Of rays that no rim lets pass, some leave less steeply the higher they come in.
            ray = ray.or_else(|_| search(widest.height_mm));
        }
        let height = match round {
            true => ray?.stop_height_mm.ok_or(ApertureError::NoStop)?,
            false => self.stop_of_sine(sine)?.ok_or(ApertureError::NoRay(f_number))?,
        };
        Ok(self.with_stop_semi_diameter_mm(height))
    }
}
