//! Over the field: how far it reaches, and the chief ray of each of its points.

use crate::beam::{Cut, ObjectPoint, Window};
use crate::{Indices, Lens, Tracer};
use glam::DVec3;
use spectra_core::{Isa, Loss};
use spectra_glass::DispersionError;

/// How far the field reaches.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FieldLimit {
    /// The largest field angle from which any light passes, rad.
    pub field_rad: f64,
    /// Why and at which surface (from 1) the last light beyond it ends; `None` where it reaches all round.
    pub limit: Option<(Loss, u32)>,
}

/// The ray of a field point through the center of the stop.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ChiefRay {
    /// Field angle, rad: see [`ObjectPoint::on_plane`].
    pub field_rad: f64,
    /// A point of it in front of the lens, mm, frame of the lens.
    pub start_mm: DVec3,
    /// Its direction there.
    pub direction: DVec3,
    /// Where it meets the image plane, mm, in the plane's frame.
    pub image_mm: [f64; 2],
    /// Its direction behind the lens, in the frame of the image plane.
    pub exit_direction: DVec3,
    /// How far behind the image plane the rays close to it meet, mm along the plane's z: in the x-z section (sagittal) and in the y-z
    /// section (tangential). By real rays, not by formulas of surfaces. Where the lens is not the same on both sides of the y-z plane: where
    /// the pencil is narrowest in x, and in y. `None` where they are parallel.
    pub foci_mm: [Option<f64>; 2],
}

impl ChiefRay {
    /// Angle to the normal of the image plane in the y-z section, rad: positive where it runs toward +y.
    #[must_use]
    pub fn exit_angle_rad(&self) -> f64 {
        spectra_core::math::atan2(self.exit_direction.y, self.exit_direction.z.abs())
    }
}

/// Step of the field, rad: from one point to the next the pupil wanders by less than itself.
const STEP_RAD: f64 = std::f64::consts::PI / 180.0;
/// How far the light may wander over the front of the lens, in radii of it for a radian of field.
const WANDER: f64 = 2.0;
/// Field angles that differ by less, rad, are the same: 0.001 degrees.
const NEAR_RAD: f64 = 1.7e-5;
/// Newton's steps: a handful each, with halvings where the light is lost.
const NEWTON_STEPS: usize = 40;
/// How far beside the chief ray the rays of its foci run, in radii of the front of the lens: what is left of aberrations goes by its square.
const CLOSE: f64 = 1e-4;
/// Rays that meet farther away than this, mm, are parallel: rounding leaves no more.
const PARALLEL_MM: f64 = 1e7;
/// How near to its center the chief ray passes the stop, mm.
const AT_CENTER_MM: f64 = 1e-10;

impl Lens {
    /// The largest field angle from which any real ray passes, for objects at this distance (mm; infinity allowed), at the
    /// reference line. `None` where nothing passes on the axis, or no surface states a size.
    ///
    /// # Errors
    /// A medium has no usable index.
    pub fn field_limit(&self, object_mm: f64) -> Result<Option<FieldLimit>, DispersionError> {
        let nm = self.reference_nm;
        if self.largest_semi_diameter_mm().is_none() {
            return Ok(None);
        }
        let tracer = Tracer::new(self, Indices::At(nm), Isa::detect())?;
        let window = |field_rad: f64| Window::new(self, ObjectPoint::on_sphere(self, object_mm, field_rad));
        let Some(mut cut) = window(0.0).and_then(|w| w.search(&tracer, nm).ok()) else { return Ok(None) };
        // Near the limit what passes is a sliver beside where it was just before: it wanders by no more than the lens is
        // large for a radian of field, and is looked for that far around.
        let passes = |field_rad: f64, from_rad: f64, near: Cut| {
            let window = window(field_rad).ok_or(None)?;
            let wander_mm = WANDER * window.reach_mm * (field_rad - from_rad);
            let mut seen = window.passing(&tracer, near.grown(0.5, wander_mm), 48, nm);
            if seen.is_err() {
                seen = window.passing(&tracer, near.grown(0.1, wander_mm), 240, nm);
            }
            // Seen with few rays: look closer.
            seen.map(|cut| window.passing(&tracer, cut, 48, nm).unwrap_or(cut))
        };
        let (mut low, mut high) = (0.0, std::f64::consts::PI);
        let mut limit = None;
        while low + STEP_RAD < high {
            match passes(low + STEP_RAD, low, cut) {
                Ok(found) => (low, cut) = (low + STEP_RAD, found),
                Err(why) => (high, limit) = (low + STEP_RAD, why),
            }
        }
        if limit.is_none() {
            return Ok(Some(FieldLimit { field_rad: std::f64::consts::PI, limit: None }));
        }
        while high - low > NEAR_RAD {
            let middle = 0.5 * (low + high);
            match passes(middle, low, cut) {
                Ok(found) => (low, cut) = (middle, found),
                Err(why) => (high, limit) = (middle, why),
            }
        }
        Ok(Some(FieldLimit { field_rad: low, limit }))
    }

    /// The chief rays of field points, at the reference line: real rays through the center of the stop, whether the rims
    /// let them pass or not. Fields (rad) rise from 0 on; each is found from its neighbor. An entry is `None` where there
    /// is none, and all are without a stop.
    ///
    /// # Errors
    /// A medium has no usable index.
    pub fn chief_rays(&self, object_mm: f64, fields_rad: &[f64]) -> Result<Vec<Option<ChiefRay>>, DispersionError> {
        let Some(stop) = self.stop() else { return Ok(vec![None; fields_rad.len()]) };
        let mut open = self.clone();
        for e in &mut open.elements {
            e.semi_diameter_mm = None;
            e.apertures.clear();
        }
        let tracer = Tracer::new(&open, Indices::At(self.reference_nm), Isa::Baseline)?;
        let chief = Chief { lens: self, tracer, stop, object_mm };
        // Place of the chief ray in its window, with the field that it belongs to: the last two.
        let mut last: Option<(f64, [f64; 2])> = None;
        let mut before: Option<(f64, [f64; 2])> = None;
        let mut rays = Vec::new();
        for &field_rad in fields_rad {
            let mut found = None;
            loop {
                let from = last.map_or(0.0, |(field, _)| field);
                let at = if last.is_none() { field_rad.min(0.0) } else { field_rad.min(from + STEP_RAD) };
                let guess = guess(at, last, before);
                let Some(place) = chief.find(at, guess) else { break };
                if last.is_none_or(|(field, _)| field != at) {
                    (before, last) = (last, Some((at, place)));
                }
                if at >= field_rad {
                    found = chief.ray(field_rad, place);
                    break;
                }
            }
            rays.push(found);
        }
        Ok(rays)
    }
}

/// Where the next chief ray is expected.
fn guess(at: f64, last: Option<(f64, [f64; 2])>, before: Option<(f64, [f64; 2])>) -> [f64; 2] {
    match (last, before) {
        (Some((f1, p1)), Some((f0, p0))) if f1 != f0 => {
            let t = (at - f1) / (f1 - f0);
            [0, 1].map(|k| p1[k] + t * (p1[k] - p0[k]))
        }
        (Some((_, p)), _) => p,
        (None, _) => [0.0; 2],
    }
}

struct Chief<'a> {
    lens: &'a Lens,
    tracer: Tracer,
    stop: usize,
    object_mm: f64,
}

impl Chief<'_> {
    fn window(&self, field_rad: f64) -> Option<Window> {
        Window::new(self.lens, ObjectPoint::on_sphere(self.lens, self.object_mm, field_rad))
    }

    /// Where the ray through a place of the window meets the stop, mm from its center.
    fn at_stop(&self, window: &Window, place: [f64; 2]) -> Option<[f64; 2]> {
        let (p, d) = window.ray(place);
        let path = self.tracer.path(p, d, self.lens.reference_nm);
        // Light that ended at the stop or behind it has met it all the same.
        let point = path.points.get(self.stop + 1)?;
        let local = self.lens.elements[self.stop].pose.local_point(*point);
        (local.x.is_finite() && local.y.is_finite()).then_some([local.x, local.y])
    }

    /// Newton's method in two dimensions, with steps halved while they lead nowhere.
    fn find(&self, field_rad: f64, guess: [f64; 2]) -> Option<[f64; 2]> {
        let window = self.window(field_rad)?;
        let mut place = guess;
        let mut miss = self.at_stop(&window, place)?;
        let size = |m: [f64; 2]| (m[0] * m[0] + m[1] * m[1]).sqrt();
        let h = 1e-5 * window.reach_mm;
        for _ in 0..NEWTON_STEPS {
            if size(miss) < AT_CENTER_MM {
                return Some(place);
            }
            let slope = |k: usize| {
                let moved = |by: f64| {
                    self.at_stop(
                        &window,
                        [place[0] + if k == 0 { by } else { 0.0 }, place[1] + if k == 1 { by } else { 0.0 }],
                    )
                };
                let (a, b) = (moved(-h)?, moved(h)?);
                Some([(b[0] - a[0]) / (2.0 * h), (b[1] - a[1]) / (2.0 * h)])
            };
            let (dx, dy) = (slope(0)?, slope(1)?);
            let determinant = dx[0] * dy[1] - dy[0] * dx[1];
            let step =
                [(miss[0] * dy[1] - miss[1] * dy[0]) / determinant, (dx[0] * miss[1] - dx[1] * miss[0]) / determinant];
            if !(step[0].is_finite() && step[1].is_finite()) {
                return None;
            }
            let mut part = 1.0;
            let better = loop {
                let next = [place[0] - part * step[0], place[1] - part * step[1]];
                match self.at_stop(&window, next) {
                    Some(m) if size(m) < size(miss) => break Some((next, m)),
                    _ if part < 1e-3 => break None,
                    _ => part *= 0.5,
                }
            };
            match better {
                Some((next, m)) => (place, miss) = (next, m),
                // No better in the last digits: it is there.
                None => break,
            }
        }
        (size(miss) < 1e-6).then_some(place)
    }

    /// Where the ray through a place of the window lands, and how it gets there.
    fn landing(&self, window: &Window, place: [f64; 2]) -> Option<Landing> {
        let (p, d) = window.ray(place);
        let path = self.tracer.path(p, d, self.lens.reference_nm);
        let last = *path.points.last().filter(|_| path.end.is_none())?;
        let image = &self.lens.image_pose;
        let (p, d) = (image.local_point(last), image.local_direction(path.direction));
        let t = -p.z / d.z;
        // Through the plates before the frame it lands as if that lay nearer.
        let slope = (d.x * d.x + d.y * d.y).sqrt() / d.z.abs();
        let depth_mm = self.lens.cover.as_ref().map_or(0.0, |c| c.depth_mm(slope, self.lens.reference_nm));
        let t = t - depth_mm / d.z;
        let image_mm = [p.x + t * d.x, p.y + t * d.y];
        image_mm.iter().all(|c| c.is_finite()).then_some(Landing { image_mm, direction: d })
    }

    fn ray(&self, field_rad: f64, place: [f64; 2]) -> Option<ChiefRay> {
        let window = self.window(field_rad)?;
        let (start_mm, direction) = window.ray(place);
        let Landing { image_mm, direction: exit_direction } = self.landing(&window, place)?;
        let foci_mm = self.foci_mm(&window, place).unwrap_or_default();
        Some(ChiefRay { field_rad, start_mm, direction, image_mm, exit_direction, foci_mm })
    }

    /// Where rays close to the one through a place meet. Behind the image plane by z they are at x + z u, with x and slope u both linear in
    /// the place: dx = A da, du = B da, so that dx = (A B^-1 + z) du.
    fn foci_mm(&self, window: &Window, place: [f64; 2]) -> Option<[Option<f64>; 2]> {
        let h = CLOSE * window.reach_mm;
        let beside = |k: usize| {
            let moved = |by: f64| {
                let mut place = place;
                place[k] += by;
                self.landing(window, place)
            };
            let (a, b) = (moved(-h)?, moved(h)?);
            let slope = |l: &Landing| [l.direction.x / l.direction.z, l.direction.y / l.direction.z];
            let (ua, ub) = (slope(&a), slope(&b));
            let by = |i: usize| (b.image_mm[i] - a.image_mm[i], ub[i] - ua[i]);
            Some([by(0), by(1)])
        };
        // [k][i]: what a step across (0) or along (1) does to x (0) or y (1).
        let steps = [beside(0)?, beside(1)?];
        let (a, b) = (steps.map(|by| by.map(|c| c.0)), steps.map(|by| by.map(|c| c.1)));
        let focus = |i: usize| {
            let j = 1 - i;
            // A step in the other section as well, so that the slope there stays; none where the sections have nothing to do with each other.
            let other = if b[j][j] == 0.0 { 0.0 } else { b[i][j] / b[j][j] };
            let z_mm = -(a[i][i] - other * a[j][i]) / (b[i][i] - other * b[j][i]);
            (z_mm.abs() < PARALLEL_MM).then_some(z_mm)
        };
        Some([focus(0), focus(1)])
    }
}

/// How a ray ends on the image plane, in its frame.
struct Landing {
    image_mm: [f64; 2],
    direction: DVec3,
}
