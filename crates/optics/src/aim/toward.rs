//! Directions from points to the places that rays are aimed at.

/// Returns the direction from a point to a target, a unit vector, and the solid angle (sr) of an area there. The normal of the
/// area is radial and axial, in the azimuth `out`. Backward, the solid angle is weighted by the cosine with `facing`, the normal
/// of the imager.
#[inline(always)]
pub(super) fn toward<const BACKWARD: bool>(
    [x, y, z]: [f64; 3],
    [tx, ty, tz]: [f64; 3],
    [ex, ey]: [f64; 2],
    [radial, axial]: [f64; 2],
    mm2: f64,
    [l, m, n]: [f64; 3],
) -> ([f64; 3], f64) {
    let (dx, dy, dz) = (tx - x, ty - y, tz - z);
    let inverse = 1.0 / (dx * dx + dy * dy + dz * dz).sqrt();
    let (dl, dm, dn) = (dx * inverse, dy * inverse, dz * inverse);
    let cosine = ((dl * ex + dm * ey) * radial + dn * axial).abs();
    let mut solid_angle = mm2 * cosine * inverse * inverse;
    if BACKWARD {
        let cosine = dl * l + dm * m + dn * n;
        // The comparison is one instruction on every tier.
        solid_angle *= if cosine > 0.0 { cosine } else { 0.0 };
    }
    ([dl, dm, dn], solid_angle)
}
