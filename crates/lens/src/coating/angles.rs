//! Directions before and after a surface, and the angles between them.

/// Difference of indices below which a surface passes all light, because its reflectance is below 1e-16.
pub const SAME_INDEX: f64 = 1e-8;

/// Returns the scalar product of two vectors.
#[inline(always)]
#[must_use]
pub fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// Returns the vector product of two vectors.
#[must_use]
pub fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

/// Returns the versine, 1 - cos, of the angle between two unit directions: half the squared length of their difference.
#[inline(always)]
pub fn versine(before: [f64; 3], after: [f64; 3]) -> f64 {
    let turn = [after[0] - before[0], after[1] - before[1], after[2] - before[2]];
    0.5 * dot(turn, turn)
}

/// Returns the cosine of the angle of incidence of a reflected ray from the versine of the angle between its directions before
/// and after. These directions differ by twice the cosine, along the normal.
#[inline(always)]
pub fn cosine_of_mirrored(versine: f64) -> f64 {
    let cosine = (0.5 * versine).sqrt();
    if cosine < 1.0 { cosine } else { 1.0 }
}
