//! Pictures from linear light in sRGB primaries.

use spectra_color::{Gamut, RgbSpace};
use spectra_core::frame::{ExposureChannel, ExposureFrame, ExtraRequest, FinishedPicture};
use spectra_film::display::{White, finish_xyz};

/// Makes a picture from linear red, green and blue values of each pixel. A luminance of `white` is shown as white; without `white`,
/// automatic exposure shows the 99th percentile as 0.9.
pub(crate) fn finish(
    exposure: &ExposureFrame,
    white: Option<f64>,
    wanted: ExtraRequest,
    rgb: impl Fn(usize) -> [f64; 3],
) -> Option<FinishedPicture> {
    let space = RgbSpace::srgb();
    let xyz: Vec<[f64; 3]> = (0..exposure.size.pixels()).map(|pixel| space.to_xyz(rgb(pixel))).collect();
    let channel = |(k, name): (usize, &str)| ExposureChannel {
        name: name.into(),
        unit: String::new(),
        values: xyz.iter().map(|v| v[k] as f32).collect(),
    };
    let channels = ["X", "Y", "Z"].into_iter().enumerate().map(channel).collect();
    let frame = ExposureFrame { size: exposure.size, channels };
    finish_xyz(&frame, white.map_or_else(White::default, White::Stated), Gamut::Desaturate, None, wanted).ok()
}
