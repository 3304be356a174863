//! The field: how far it reaches, and the chief ray of each of its points.

use crate::bundle::{Bundle, Extent, ObjectPoint};
use crate::{Clipping, Optics};
use glam::{DVec2, DVec3};
use spectra_core::Loss;
use spectra_glass::DispersionError;
use spectra_tracer::Indices;

/// The limit of the field of a lens.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FieldLimit {
    /// Largest field angle from which any light passes, rad.
    pub field_rad: f64,
    /// Cause and surface (from 1) that end the last light beyond this angle; `None` if the field has no limit at any angle.
    pub limit: Option<(Loss, u32)>,
}

/// The chief ray of a field point: the ray through the center of the stop.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ChiefRay {
    /// Field angle in rad, measured as for [`ObjectPoint::on_plane`].
    pub field_rad: f64,
    /// Starting point of the ray in front of the lens, mm in the frame of the lens.
    pub start_mm: DVec3,
    /// Unit direction of the ray in front of the lens.
    pub direction: DVec3,
    /// Point where the ray meets the image plane, mm in the plane's frame.
    pub image_mm: [f64; 2],
    /// Unit direction of the ray behind the lens, in the frame of the image plane.
    pub exit_direction: DVec3,
    /// Distances behind the image plane at which rays close to the chief ray meet, mm along the plane's z: in the x-z section
    /// (sagittal) and in the y-z section (tangential). They come from real rays, not from formulas for each surface. If the lens
    /// is not symmetric about the y-z plane, they say where the pencil is narrowest in x and in y. `None` if the rays are
    /// parallel.
    pub foci_mm: [Option<f64>; 2],
}

impl ChiefRay {
    /// Angle between the ray and the normal of the image plane in the y-z section, rad: positive if the ray runs toward +y.
    #[must_use]
    pub fn exit_angle_rad(&self) -> f64 {
        spectra_core::math::atan2(self.exit_direction.y, self.exit_direction.z.abs())
    }
}

/// Step of the field, rad. From one point to the next the pupil moves by less than its own size.
const STEP_RAD: f64 = std::f64::consts::PI / 180.0;
/// Largest shift of the light over the front of the lens, in radii of the front per radian of field.
const WANDER: f64 = 2.0;
/// Difference of field angles (rad) at which the search stops: 0.001 degrees.
const NEAR_RAD: f64 = 1.7e-5;
/// Distance of the neighboring rays from the chief ray, in radii of the front of the lens. The error from aberrations goes with its square.
const CLOSE: f64 = 1e-4;
/// Rays that meet farther away than this (mm) count as parallel: rounding allows no more.
const PARALLEL_MM: f64 = 1e7;
impl Optics {
    /// Returns the largest field angle from which any real ray passes the lens at the reference line. Objects are at the distance
    /// `object_mm` (infinity allowed). Returns `None` if no light passes on the axis, or no surface states a size.
    ///
    /// # Errors
    /// A medium has no usable index.
    pub fn field_limit(&self, object_mm: f64) -> Result<Option<FieldLimit>, DispersionError> {
        if self.largest_semi_diameter_mm().is_none() {
            return Ok(None);
        }
        let indices = Indices::At(self.reference_nm);
        let bundle = |field_rad: f64| Bundle::before(self, ObjectPoint::on_sphere(self, object_mm, field_rad), indices);
        let Some(Ok(mut extent)) = bundle(0.0)?.map(|axial| axial.extent()) else { return Ok(None) };
        // Near the limit only a sliver passes, next to where it was in the step before. It moves by no more than [`WANDER`] allows, so it
        // is searched that far around.
        let passing = |field_rad: f64, from_rad: f64, near: Extent| {
            let bundle = bundle(field_rad).ok().flatten().ok_or(None)?;
            let wander_mm = WANDER * bundle.reach_mm() * (field_rad - from_rad);
            let mut found = bundle.extent_within(near.grown(0.5, wander_mm), 48);
            if found.is_err() {
                found = bundle.extent_within(near.grown(0.1, wander_mm), 240);
            }
            // Found with few rays: refine.
            found.map(|extent| bundle.extent_within(extent, 48).unwrap_or(extent))
        };
        let (mut low, mut high) = (0.0, std::f64::consts::PI);
        let mut limit = None;
        while low + STEP_RAD < high {
            match passing(low + STEP_RAD, low, extent) {
                Ok(found) => (low, extent) = (low + STEP_RAD, found),
                Err(why) => (high, limit) = (low + STEP_RAD, why),
            }
        }
        if limit.is_none() {
            return Ok(Some(FieldLimit { field_rad: std::f64::consts::PI, limit: None }));
        }
        while high - low > NEAR_RAD {
            let middle = 0.5 * (low + high);
            match passing(middle, low, extent) {
                Ok(found) => (low, extent) = (middle, found),
                Err(why) => (high, limit) = (middle, why),
            }
        }
        Ok(Some(FieldLimit { field_rad: low, limit }))
    }
}

impl Optics {
    /// Returns the chief rays of field points at the reference line: real rays through the center of the stop, whether or not the
    /// rims let them pass. The angles in `fields_rad` ascend from 0, because each ray is found from the one before. An entry is
    /// `None` if there is no such ray; all entries are `None` if the lens has no stop.
    ///
    /// # Errors
    /// A medium has no usable index.
    pub fn chief_rays(&self, object_mm: f64, fields_rad: &[f64]) -> Result<Vec<Option<ChiefRay>>, DispersionError> {
        let Some(stop) = self.stop() else { return Ok(vec![None; fields_rad.len()]) };
        let bundle = |field_rad: f64| {
            let point = ObjectPoint::on_sphere(self, object_mm, field_rad);
            let bundle = Bundle::before(self, point, Indices::At(self.reference_nm))?;
            bundle.map(|bundle| bundle.clipped(Clipping::None)).transpose()
        };
        // The last two chief rays: the field and the point of the window.
        let mut last: Option<(f64, [f64; 2])> = None;
        let mut before: Option<(f64, [f64; 2])> = None;
        let mut rays = Vec::new();
        for &field_rad in fields_rad {
            let mut found = None;
            loop {
                let from = last.map_or(0.0, |(field, _)| field);
                let at = if last.is_none() { field_rad.min(0.0) } else { field_rad.min(from + STEP_RAD) };
                let Some(bundle) = bundle(at)? else { break };
                let Some(place) = bundle.through(stop, DVec2::ZERO, guess(at, last, before)) else { break };
                if last.is_none_or(|(field, _)| field != at) {
                    (before, last) = (last, Some((at, place)));
                }
                if at >= field_rad {
                    found = chief_ray(self, &bundle, field_rad, place);
                    break;
                }
            }
            rays.push(found);
        }
        Ok(rays)
    }
}

/// Returns the point of the window where the next chief ray is expected.
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

fn chief_ray(optics: &Optics, bundle: &Bundle<'_>, field_rad: f64, place: [f64; 2]) -> Option<ChiefRay> {
    let (start_mm, direction) = bundle.ray(place);
    let ImageHit { image_mm, direction: exit_direction } = landing(optics, bundle, place)?;
    let foci_mm = foci_mm(optics, bundle, place).unwrap_or_default();
    Some(ChiefRay { field_rad, start_mm, direction, image_mm, exit_direction, foci_mm })
}

/// The point and direction in which a ray meets the image plane, in its frame.
struct ImageHit {
    image_mm: [f64; 2],
    direction: DVec3,
}

/// Returns where the ray through a point of the window lands. Plates in front of the frame act as if the frame were nearer.
fn landing(optics: &Optics, bundle: &Bundle<'_>, place: [f64; 2]) -> Option<ImageHit> {
    let path = bundle.path(place);
    let last = *path.points.last().filter(|_| path.end.is_none())?;
    let image = &optics.image_pose;
    let (p, d) = (image.local_point(last), image.local_direction(path.direction));
    let slope = (d.x * d.x + d.y * d.y).sqrt() / d.z.abs();
    let depth_mm = optics.cover.as_ref().map_or(0.0, |c| c.depth_mm(slope, optics.reference_nm));
    let t = -p.z / d.z - depth_mm / d.z;
    let image_mm = [p.x + t * d.x, p.y + t * d.y];
    image_mm.iter().all(|c| c.is_finite()).then_some(ImageHit { image_mm, direction: d })
}

/// Returns where rays close to the one through a point of the window meet. At z behind the image plane they are at x + z u. Position x and
/// slope u are both linear in the window point: dx = A da, du = B da, so that dx = (A B^-1 + z) du.
fn foci_mm(optics: &Optics, bundle: &Bundle<'_>, place: [f64; 2]) -> Option<[Option<f64>; 2]> {
    let h = CLOSE * bundle.reach_mm();
    let beside = |k: usize| {
        let moved = |by: f64| {
            let mut place = place;
            place[k] += by;
            landing(optics, bundle, place)
        };
        let (a, b) = (moved(-h)?, moved(h)?);
        let slope = |l: &ImageHit| [l.direction.x / l.direction.z, l.direction.y / l.direction.z];
        let (ua, ub) = (slope(&a), slope(&b));
        let by = |i: usize| (b.image_mm[i] - a.image_mm[i], ub[i] - ua[i]);
        Some([by(0), by(1)])
    };
    // [k][i]: the change of x (0) or y (1) by a step across (0) or along (1).
    let steps = [beside(0)?, beside(1)?];
    let (a, b) = (steps.map(|by| by.map(|c| c.0)), steps.map(|by| by.map(|c| c.1)));
    let focus = |i: usize| {
        let j = 1 - i;
        // A step in the other section keeps the slope there constant; none is needed if the sections are independent.
        let other = if b[j][j] == 0.0 { 0.0 } else { b[i][j] / b[j][j] };
        let z_mm = -(a[i][i] - other * a[j][i]) / (b[i][i] - other * b[j][i]);
        (z_mm.abs() < PARALLEL_MM).then_some(z_mm)
    };
    Some([focus(0), focus(1)])
}
