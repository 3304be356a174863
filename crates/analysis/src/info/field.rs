//! The field of a lens in figures.

use super::illuminance::relative_illuminance;
use serde::Serialize;
use spectra_core::math::atan2;
use spectra_lens::{ChiefRay, Criterion, FocusSearch, Indices, Lens};

/// One field point: its chief ray, where it is sharp, and how bright.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct FieldReport {
    /// Field angle.
    pub field_deg: f64,
    /// Angle behind the lens to the normal of the image plane; 0 all over the field in a lens that is telecentric there.
    pub angle_deg: f64,
    /// Where it meets the image plane, from the middle.
    pub image_height_mm: f64,
    /// Image height over that of a picture as large as the middle of this one without distortion, less one; `None` on the axis, and at 90
    /// degrees and beyond.
    pub distortion: Option<f64>,
    /// How far behind the image plane the rays close to the chief ray meet in the sagittal (x-z) section; `None` where they are parallel.
    pub sagittal_focus_mm: Option<f64>,
    /// The same in the tangential (y-z) section.
    pub tangential_focus_mm: Option<f64>,
    /// Illuminance of the film there over that in the middle, from a field that is equally bright all over, by real rays through every rim;
    /// `None` where no light comes to the middle.
    pub relative_illuminance: Option<f64>,
}

impl FieldReport {
    fn new(held: &Lens, ray: &ChiefRay, near: Option<&ChiefRay>, relative_illuminance: Option<f64>) -> Self {
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

/// A field so near to the axis that distortion, which goes by its square, is below a millionth there, rad.
pub(super) const NEAR_AXIS_RAD: f64 = 1e-3;

/// Image height over that of a picture without distortion, less one; that picture has the scale of a ray `near` the axis.
pub(super) fn distortion(held: &Lens, ray: &ChiefRay, near: &ChiefRay) -> Option<f64> {
    // In front: the tangent of the field, or the height on the object plane.
    let ahead = |ray: &ChiefRay| match held.focused_mm.is_finite() {
        true => ray.start_mm.y - (held.focused_mm + ray.start_mm.z) * ray.direction.y / ray.direction.z,
        false => ray.direction.y / ray.direction.z,
    };
    let scale = |ray: &ChiefRay| ray.image_mm[1] / ahead(ray);
    let before = ray.field_rad > NEAR_AXIS_RAD && ray.direction.z > 1e-9;
    before.then(|| scale(ray) / scale(near) - 1.0).filter(|d| d.is_finite())
}

/// What limits the field.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct LimitReport {
    /// Why the last light ends.
    pub cause: &'static str,
    /// The surface where it does, from 1.
    pub surface: u32,
}

/// Fields shown, from the axis to the largest.
const FIELDS: usize = 11;
/// Largest field shown where nothing limits it: that of a normal lens.
const NORMAL_FIELD_DEG: f64 = 20.0;
/// Parts of an image height that is asked for at which the field is shown.
pub(super) const PARTS: [f64; 4] = [0.0, 0.5, 0.7, 1.0];
/// Where nothing limits the field, an image height is looked for up to this field: 80 degrees.
const UNLIMITED_FIELD_RAD: f64 = 1.4;
/// Fields that are looked at for a height, and how often closer: to 1e-9 rad.
const LOOKED_AT: usize = 60;
const CLOSER: usize = 6;
/// Spatial frequency of the focus by contrast, line pairs a mm.
pub(super) const FREQUENCY_PER_MM: f64 = 30.0;

/// A field as wide as this, of a picture that reaches beyond twice the corner of 135 film, is not what the lens was made for: nothing but
/// the size of its surfaces ends it.
const WIDE_DEG: f64 = 80.0;
/// From the middle of 135 film to its corner, mm.
const CORNER_MM: f64 = 21.633;

/// The largest field that is worth a look, rad, of a lens that passes light up to `largest_rad`: that one, or the corner of 135 film, where no
/// rim keeps the field within what is of use.
#[must_use]
pub fn useful_field_rad(lens: &Lens, largest_rad: f64) -> f64 {
    if largest_rad < WIDE_DEG.to_radians() {
        return largest_rad;
    }
    match fields_at_heights(lens, &[CORNER_MM, 2.0 * CORNER_MM]) {
        Ok(fields) => fields.first().map_or(largest_rad, |corner| corner.min(largest_rad)),
        // Chief rays are there, and none of them lands so far out: a fisheye.
        Err(height_mm) if height_mm > 0.0 => largest_rad,
        Err(_) => {
            let efl_mm = lens.first_order(lens.reference_nm).efl_mm.abs();
            let reach_mm = if efl_mm.is_finite() { efl_mm } else { lens.image_gap_mm().abs() };
            atan2(CORNER_MM, reach_mm.max(1e-3)).min(largest_rad)
        }
    }
}

/// How far a lens sees, and how.
pub(super) struct Field {
    /// Largest field angle, degrees.
    pub largest_deg: Option<f64>,
    /// What limits it.
    pub limit: Option<LimitReport>,
    /// Field points from the axis to there, or to the corner of 135 film, where no rim limits the field.
    pub points: Vec<FieldReport>,
    /// Whether they end before the largest field.
    pub is_cut: bool,
}

/// The field of a lens in one light; `held` is the same lens with the indices of that light.
pub(super) fn field(lens: &Lens, held: &Lens, indices: Indices) -> Field {
    let reach = held.field_limit(held.focused_mm).ok().flatten();
    let limit = reach.and_then(|r| r.limit).map(|(cause, surface)| LimitReport { cause: cause.name(), surface });
    let largest_rad = reach.map_or(NORMAL_FIELD_DEG.to_radians(), |r| useful_field_rad(held, r.field_rad));
    let fields: Vec<f64> = (0..FIELDS).map(|i| largest_rad * i as f64 / (FIELDS - 1) as f64).collect();
    let points = field_points(lens, held, indices, &fields);
    let is_cut = reach.is_some_and(|r| largest_rad < r.field_rad);
    Field { largest_deg: reach.map(|r| r.field_rad.to_degrees()), limit, points, is_cut }
}

/// These fields (rad, rising from 0), those of them that have a chief ray.
pub(super) fn field_points(lens: &Lens, held: &Lens, indices: Indices, fields_rad: &[f64]) -> Vec<FieldReport> {
    let rays = held.chief_rays(held.focused_mm, fields_rad).unwrap_or_default();
    let rays: Vec<ChiefRay> = rays.into_iter().flatten().collect();
    let near = held.chief_rays(held.focused_mm, &[NEAR_AXIS_RAD]).ok().and_then(|mut rays| rays.pop()?);
    let landed: Vec<[f64; 2]> = rays.iter().map(|ray| ray.image_mm).collect();
    let light = relative_illuminance(lens, indices, &landed);
    let at = |i: usize| light.as_ref().and_then(|all| all.get(i).copied());
    rays.iter().enumerate().map(|(i, ray)| FieldReport::new(held, ray, near.as_ref(), at(i))).collect()
}

/// The fields (rad) whose chief rays land at these parts of an image height, mm; else the largest height at which one lands.
pub(super) fn fields_at_heights(held: &Lens, heights_mm: &[f64]) -> Result<Vec<f64>, f64> {
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

/// How far behind the image plane the axial image is by this measure, mm.
pub(super) fn focus_shift_mm(held: &Lens, criterion: Criterion) -> Option<f64> {
    let light = vec![(held.reference_nm, 1.0)];
    let search = FocusSearch { object_mm: held.focused_mm, field_rad: 0.0, criterion, light };
    held.best_focus_shift_mm(&search).ok().filter(|z| z.is_finite())
}
