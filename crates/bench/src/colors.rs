//! How far apart two exposures look, where the channels are X, Y and Z.

use spectra_color::{ciede2000, lab};

/// The channels that are X, Y and Z, by their names; `None` where one is missing.
pub(crate) fn xyz_channels(names: &[String]) -> Option<[usize; 3]> {
    let at = |name: &str| names.iter().position(|n| n == name);
    Some([at("X")?, at("Y")?, at("Z")?])
}

/// A white, and the scale that takes exposure to it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct White {
    xyz: [f64; 3],
    scale: f64,
}

impl White {
    /// The color of `light` as white, and an exposure of Y = `lightest` as its luminance of 100; `None` in the dark.
    pub(crate) fn new(light: [f64; 3], lightest: f64) -> Option<Self> {
        let good = light[1] > 0.0 && lightest > 0.0;
        good.then(|| Self { xyz: light.map(|v| 100.0 * v / light[1]), scale: 100.0 / lightest })
    }

    /// CIEDE2000 between two exposures.
    pub(crate) fn difference(&self, a: [f64; 3], b: [f64; 3]) -> f64 {
        let of = |xyz: [f64; 3]| lab(xyz.map(|v| v * self.scale), self.xyz);
        ciede2000(of(a), of(b))
    }
}
