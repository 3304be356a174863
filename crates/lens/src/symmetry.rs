//! Tells whether a lens is symmetric about its axis.

use crate::{Element, Pose};

/// Azimuths at which sags are compared, as (cosine, sine). No surface with a symmetry of only a few folds passes at all of them.
const AZIMUTHS: [(f64, f64); 4] = [(1.0, 0.0), (0.0, 1.0), (-0.6, 0.8), (0.28, -0.96)];
/// Radii at which sags are compared, as fractions of the rim.
const RADII: [f64; 3] = [0.3, 0.65, 0.95];
/// Sags that differ by less than this (mm) count as equal.
const SAME_MM: f64 = 1e-12;
/// Rim radius of a surface that states none, mm.
const RIM_MM: f64 = 1.0;

pub(crate) fn has_axis_of_revolution(elements: &[Element], image: &Pose) -> bool {
    (image.is_on_axis() || image.facing_back().is_on_axis()) && elements.iter().all(is_round)
}

fn is_round(e: &Element) -> bool {
    let pose = if e.reversed { e.pose.reversed() } else { e.pose };
    let (cx, cy) = e.surface.vertex_curvature_per_mm();
    if e.solid.is_some()
        || !pose.is_on_axis()
        || cx != cy
        || e.surface.is_directional()
        || !e.apertures.iter().all(|a| a.is_round())
        || !e.separation.as_ref().is_none_or(|s| s.is_round())
    {
        return false;
    }
    let rim = e.semi_diameter_mm.or(e.outer_semi_diameter_mm).unwrap_or(RIM_MM);
    RADII.iter().all(|part| {
        let r = part * rim;
        let sags = AZIMUTHS.map(|(c, s)| e.surface.sag_mm(r * c, r * s));
        sags.iter().all(|sag| match (sag, sags[0]) {
            (Some(a), Some(b)) => (a - b).abs() <= SAME_MM * (1.0 + b.abs()),
            (None, None) => true,
            _ => false,
        })
    })
}
