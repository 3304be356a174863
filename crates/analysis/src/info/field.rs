//! The field of a lens in figures.

use serde::Serialize;
use spectra_lens::{ChiefRay, Criterion, FocusSearch, Lens};

/// The chief ray of one field point.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct FieldReport {
    /// Field angle.
    pub field_deg: f64,
    /// Angle behind the lens to the normal of the image plane; 0 all over the field in a lens that is telecentric there.
    pub angle_deg: f64,
    /// Where it meets the image plane, from the middle.
    pub image_height_mm: f64,
}

impl From<ChiefRay> for FieldReport {
    fn from(ray: ChiefRay) -> Self {
        Self {
            field_deg: ray.field_rad.to_degrees(),
            angle_deg: ray.exit_angle_rad().to_degrees(),
            image_height_mm: ray.image_mm[1],
        }
    }
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
/// Spatial frequency of the focus by contrast, line pairs a mm.
pub(super) const FREQUENCY_PER_MM: f64 = 30.0;

/// Largest field angle (degrees), what limits it, and chief rays from the axis to there.
pub(super) fn field(held: &Lens) -> (Option<f64>, Option<LimitReport>, Vec<FieldReport>) {
    let reach = held.field_limit(held.focused_mm).ok().flatten();
    let limit = reach.and_then(|r| r.limit).map(|(cause, surface)| LimitReport { cause: cause.name(), surface });
    let largest_rad = reach.map_or(NORMAL_FIELD_DEG.to_radians(), |r| r.field_rad);
    let fields: Vec<f64> = (0..FIELDS).map(|i| largest_rad * i as f64 / (FIELDS - 1) as f64).collect();
    let rays = held.chief_rays(held.focused_mm, &fields).unwrap_or_default();
    (reach.map(|r| r.field_rad.to_degrees()), limit, rays.into_iter().flatten().map(FieldReport::from).collect())
}

/// How far behind the image plane the axial image is by this measure, mm.
pub(super) fn focus_shift_mm(held: &Lens, criterion: Criterion) -> Option<f64> {
    let light = vec![(held.reference_nm, 1.0)];
    let search = FocusSearch { object_mm: held.focused_mm, field_rad: 0.0, criterion, light };
    held.best_focus_shift_mm(&search).ok().filter(|z| z.is_finite())
}
