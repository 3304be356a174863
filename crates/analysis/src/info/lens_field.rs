//! The field of a lens in figures: field angle, image height, distortion, astigmatism, illuminance.

use super::illuminance::relative_illuminance;
use serde::Serialize;
use spectra_core::math::atan2;
use spectra_optics::{ChiefRay, Criterion, FocusSearch, Optics};
use spectra_tracer::Indices;

/// Figures of one field point: its chief ray, where it is in focus, and how bright it is.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct FieldReport {
    /// Field angle, degrees.
    pub field_deg: f64,
    /// Angle of the chief ray behind the lens to the normal of the image plane, degrees; 0 all over the field if the lens is telecentric
    /// there.
    pub angle_deg: f64,
    /// Distance from the center at which the chief ray meets the image plane, mm.
    pub image_height_mm: f64,
    /// Distortion: image height divided by the height without distortion, less one. The height without distortion has the image
    /// scale of the center everywhere. `None` on the axis, and at 90 degrees and beyond.
    pub distortion: Option<f64>,
    /// Sagittal focus: distance behind the image plane at which rays close to the chief ray meet in the x-z section, mm. `None` if they are
    /// parallel.
    pub sagittal_focus_mm: Option<f64>,
    /// Tangential focus: distance behind the image plane at which rays close to the chief ray meet in the y-z section, mm. `None` if they
    /// are parallel.
    pub tangential_focus_mm: Option<f64>,
    /// Relative illuminance: illuminance of the film at this point divided by that at the center, for a uniformly bright field, by real
    /// rays through every rim. `None` if no light reaches the center.
    pub relative_illuminance: Option<f64>,
}

impl FieldReport {
    fn new(held: &Optics, ray: &ChiefRay, near: Option<&ChiefRay>, relative_illuminance: Option<f64>) -> Self {
        let [sagittal_focus_mm, tangential_focus_mm] = ray.foci_mm;
        Self {
            field_deg: ray.field_rad.to_degrees(),
            angle_deg: ray.exit_angle_rad().to_degrees(),
            image_height_mm: ray.image_mm[1],
            distortion: near.and_then(|near| distortion(held, ray, near)),
            sagittal_focus_mm,
            tangential_focus_mm,
            relative_illuminance,
        }
    }
}

/// Field angle (rad) so small that distortion, which grows with its square, is below a millionth.
pub(super) const NEAR_AXIS_RAD: f64 = 1e-3;

/// Returns image height divided by that of a distortion-free picture, less one. The chief ray `near` the axis sets the scale of that
/// picture.
pub(super) fn distortion(held: &Optics, ray: &ChiefRay, near: &ChiefRay) -> Option<f64> {
    // Object coordinate: the tangent of the field angle, or the height on the object plane.
    let ahead = |ray: &ChiefRay| match held.focused_mm.is_finite() {
        true => ray.start_mm.y - (held.focused_mm + ray.start_mm.z) * ray.direction.y / ray.direction.z,
        false => ray.direction.y / ray.direction.z,
    };
    let scale = |ray: &ChiefRay| ray.image_mm[1] / ahead(ray);
    let before = ray.field_rad > NEAR_AXIS_RAD && ray.direction.z > 1e-9;
    before.then(|| scale(ray) / scale(near) - 1.0).filter(|d| d.is_finite())
}

/// The surface that limits the field, and how.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct LimitReport {
    /// Why the last rays end.
    pub cause: &'static str,
    /// Number of the surface at which they end, from 1.
    pub surface: u32,
}

/// Number of field points from the axis to the largest field.
const FIELDS: usize = 11;
/// Largest field shown if nothing limits it, degrees: that of a normal lens.
const NORMAL_FIELD_DEG: f64 = 20.0;
/// Fractions of a requested image height at which the field is shown.
pub(super) const PARTS: [f64; 4] = [0.0, 0.5, 0.7, 1.0];
/// Largest field searched for an image height if nothing limits the field: 80 degrees.
const UNLIMITED_FIELD_RAD: f64 = 1.4;
/// Number of fields in one search step for an image height, and number of refining steps: to 1e-9 rad.
const LOOKED_AT: usize = 60;
const CLOSER: usize = 6;
/// Spatial frequency of the focus by contrast, line pairs per mm.
pub(super) const FREQUENCY_PER_MM: f64 = 30.0;

/// A field of this angle or more is not what the lens was made for if its picture reaches beyond twice the corner of 135 film: only the
/// size of its surfaces ends it.
const WIDE_DEG: f64 = 80.0;
/// Distance from the center of 135 film to its corner, mm.
const CORNER_MM: f64 = 21.633;

/// Returns the field angle, in rad, up to which field points of a lens are useful to list. `largest_rad` is the largest field at
/// which it passes light. The result is that field, or the field at the corner of 135 film if no rim limits the field to a useful
/// size.
#[must_use]
pub fn useful_field_rad(lens: &Optics, largest_rad: f64) -> f64 {
    if largest_rad < WIDE_DEG.to_radians() {
        return largest_rad;
    }
    match fields_at_heights(lens, &[CORNER_MM, 2.0 * CORNER_MM]) {
        Ok(fields) => fields.first().map_or(largest_rad, |corner| corner.min(largest_rad)),
        // Chief rays exist, but none lands so far from the center: a fisheye.
        Err(height_mm) if height_mm > 0.0 => largest_rad,
        Err(_) => {
            let efl_mm = lens.first_order(lens.reference_nm).efl_mm.abs();
            let reach_mm = if efl_mm.is_finite() { efl_mm } else { lens.image_gap_mm().abs() };
            atan2(CORNER_MM, reach_mm.max(1e-3)).min(largest_rad)
        }
    }
}

/// The field of a lens: its size and its field points.
pub(super) struct LensField {
    /// Largest field angle, degrees; `None` if it is not known.
    pub largest_deg: Option<f64>,
    /// Surface that limits the field.
    pub limit: Option<LimitReport>,
    /// Field points from the axis to the largest field, or to the corner of 135 film if no rim limits the field.
    pub points: Vec<FieldReport>,
    /// Whether the field points end before the largest field.
    pub is_cut: bool,
}

/// Computes the field of a lens in one light; `held` is the same lens with its indices fixed for that light.
pub(super) fn field(lens: &Optics, held: &Optics, indices: Indices) -> LensField {
    let reach = held.field_limit(held.focused_mm).ok().flatten();
    let limit = reach.and_then(|r| r.limit).map(|(cause, surface)| LimitReport { cause: cause.name(), surface });
    let largest_rad = reach.map_or(NORMAL_FIELD_DEG.to_radians(), |r| useful_field_rad(held, r.field_rad));
    let fields: Vec<f64> = (0..FIELDS).map(|i| largest_rad * i as f64 / (FIELDS - 1) as f64).collect();
    let points = field_points(lens, held, indices, &fields);
    let is_cut = reach.is_some_and(|r| largest_rad < r.field_rad);
    LensField { largest_deg: reach.map(|r| r.field_rad.to_degrees()), limit, points, is_cut }
}

/// Computes field points at these field angles (rad, in ascending order from 0). Fields without a chief ray are left out.
pub(super) fn field_points(lens: &Optics, held: &Optics, indices: Indices, fields_rad: &[f64]) -> Vec<FieldReport> {
    let rays = held.chief_rays(held.focused_mm, fields_rad).unwrap_or_default();
    let rays: Vec<ChiefRay> = rays.into_iter().flatten().collect();
    let near = held.chief_rays(held.focused_mm, &[NEAR_AXIS_RAD]).ok().and_then(|mut rays| rays.pop()?);
    let landed: Vec<[f64; 2]> = rays.iter().map(|ray| ray.image_mm).collect();
    let light = relative_illuminance(lens, indices, &landed);
    let at = |i: usize| light.as_ref().and_then(|all| all.get(i).copied());
    rays.iter().enumerate().map(|(i, ray)| FieldReport::new(held, ray, near.as_ref(), at(i))).collect()
}

/// Returns the fields (rad) whose chief rays land at these image heights, mm. If one of them is not reached, the error is the largest
/// height at which a chief ray lands, mm.
pub(super) fn fields_at_heights(held: &Optics, heights_mm: &[f64]) -> Result<Vec<f64>, f64> {
    let reach = held.field_limit(held.focused_mm).ok().flatten();
    let largest_rad = reach.map_or(UNLIMITED_FIELD_RAD, |r| r.field_rad);
    let looked_at = |low: f64, high: f64| -> Vec<(f64, f64)> {
        let fields: Vec<f64> = (0..=LOOKED_AT).map(|i| low + (high - low) * i as f64 / LOOKED_AT as f64).collect();
        let rays = held.chief_rays(held.focused_mm, &fields).unwrap_or_default();
        rays.into_iter().flatten().map(|ray| (ray.field_rad, ray.image_mm[1].abs())).collect()
    };
    let all = looked_at(0.0, largest_rad);
    let at_height = |height: f64| {
        let mut seen = all.clone();
        for _ in 0..CLOSER {
            let outside = seen.iter().position(|(_, h)| *h >= height)?;
            let (inside, outside) = (seen[outside.max(1) - 1], seen.get(outside.max(1)).copied()?);
            seen = looked_at(inside.0, outside.0);
        }
        seen.first().map(|(field, _)| *field)
    };
    let largest_mm = || all.iter().map(|(_, h)| *h).fold(0.0, f64::max);
    heights_mm
        .iter()
        .map(|height| if *height == 0.0 { Some(0.0) } else { at_height(*height) }.ok_or_else(largest_mm))
        .collect()
}

/// Distance of the axial image behind the image plane by this criterion, mm.
pub(super) fn focus_shift_mm(held: &Optics, criterion: Criterion) -> Option<f64> {
    let light = vec![(held.reference_nm, 1.0)];
    let search = FocusSearch { object_mm: held.focused_mm, field_rad: 0.0, criterion, light };
    search.shift_mm(held).ok().filter(|z| z.is_finite())
}
