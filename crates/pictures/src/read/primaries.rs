//! Conversion from the primaries of a file to those of sRGB.

use super::profile::keeping_white;
use spectra_color::matrix::{Matrix, product};
use spectra_color::{Adaptation, RgbSpace};

/// Returns the matrix from linear light of a space to linear sRGB, white to white (CAT02, as pictures are written). `None` if primaries and
/// white are those of sRGB.
pub(super) fn to_srgb(space: &RgbSpace) -> Option<Matrix> {
    let srgb = RgbSpace::srgb();
    let near = |a: &[f64; 2], b: &[f64; 2]| (a[0] - b[0]).abs() < 1e-3 && (a[1] - b[1]).abs() < 1e-3;
    if near(&space.white_xy, &srgb.white_xy)
        && space.primaries_xy.iter().zip(&srgb.primaries_xy).all(|(a, b)| near(a, b))
    {
        return None;
    }
    let adapted = Adaptation::Cat02.matrix(space.white_xyz(), srgb.white_xyz());
    Some(keeping_white(product(&srgb.rgb_from_xyz, &product(&adapted, &space.xyz_from_rgb))))
}
