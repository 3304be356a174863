//! Color difference of two exposures, if the channels are X, Y and Z.

use spectra_color::{ciede2000, lab};

/// Returns the indices of the channels named X, Y and Z; `None` if one is missing.
pub(crate) fn xyz_channels(names: &[String]) -> Option<[usize; 3]> {
    let at = |name: &str| names.iter().position(|n| n == name);
    Some([at("X")?, at("Y")?, at("Z")?])
}

/// A reference white, and the scale from exposure to CIE XYZ.
#[derive(Clone, Copy, Debug)]
pub(crate) struct White {
    xyz: [f64; 3],
    scale: f64,
}

impl White {
    /// Creates a white of the color of `light`. An exposure of Y = `lightest` gets the luminance 100. `None` if one of them is dark.
    pub(crate) fn new(light: [f64; 3], lightest: f64) -> Option<Self> {
        let good = light[1] > 0.0 && lightest > 0.0;
        good.then(|| Self { xyz: light.map(|v| 100.0 * v / light[1]), scale: 100.0 / lightest })
    }

    /// CIEDE2000 color difference between two exposures.
    pub(crate) fn difference(&self, a: [f64; 3], b: [f64; 3]) -> f64 {
        let of = |xyz: [f64; 3]| lab(xyz.map(|v| v * self.scale), self.xyz);
        ciede2000(of(a), of(b))
    }
}
