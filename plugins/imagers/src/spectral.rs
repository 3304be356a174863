//! `imager: spectral`: a plane that records the spectrum itself, one channel per band.

use crate::balance::{Balance, WhiteBalance};
use crate::detector::DetectorPlane;
use crate::params::Frame;
use crate::plane::Plane;
use schemars::JsonSchema;
use serde::Deserialize;
use spectra_color::Gamut;
use spectra_core::frame::{DisplayPicture, ExposureChannel, ExposureFrame, ExtraRequest, FinishedPicture};
use spectra_core::params::{Faults, Params, Wavelength, Whole};
use spectra_core::registry::Context;
use spectra_core::spectral::{Channel, Grid};
use spectra_core::stage::{Imager, Response};
use spectra_film::display::{White, finish_xyz};
use spectra_spectrum::Observer;
use spectra_spectrum::constants::LUMINOUS_EFFICACY_LM_PER_W;

/// A frame that records the spectrum itself: one channel per band, in W m^-2 nm^-1.
///
/// Use it to apply any film, sensor or observer afterwards, and for hyperspectral test data. The value of a channel is the
/// mean spectral irradiance of its band. In the OpenEXR file each channel is named after the middle of its band, as the
/// spectral OpenEXR layout prescribes: `S0.550,0nm`. The picture shows the colors that an eye sees.
///
/// `resolution` is the number of pixels across and down. If its aspect ratio differs from that of the frame, the pixels
/// are not square. The frame lies in the image plane of the lens unless you shift it, tilt it (as on a view camera) or
/// curve it.
///
/// # Example
/// ```yaml
/// {kind: spectral, format: 135, resolution: [480, 320], bands: 40}
/// ```
/// ```yaml
/// {kind: spectral, format: 6x6, resolution: [256, 256], bands: 16, range: [400 nm, 720 nm]}
/// ```
/// # References
/// - A. Fichet, R. Pacanowski and A. Wilkie, "An OpenEXR layout for spectral images", J. Computer Graphics
///   Techniques 10 (2021).
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
#[schemars(deny_unknown_fields)]
pub struct SpectralParams {
    #[serde(flatten)]
    frame: Frame,
    /// Number of bands of equal width, a whole number from 1 to 256.
    bands: Whole<1, MAX_BANDS>,
    /// First and last wavelength, nm if bare; 380 to 780 nm if left out.
    #[serde(default)]
    range: Option<[Wavelength; 2]>,
    /// Light that the picture shows as white, as for the imager `xyz`: a light by name, `{temperature: 3200 K}` or `auto-gray`.
    /// The channels do not change. If it is left out, the picture has the tint of its light.
    #[serde(default)]
    white_balance: Option<WhiteBalance>,
}

/// Largest number of bands.
const MAX_BANDS: u64 = 256;

/// The response of a spectrograph, one channel per band. The value of a channel is the mean spectral irradiance of its band,
/// W m^-2 nm^-1. Its name is the middle of the band, as the spectral OpenEXR convention prescribes: `S0.550,0nm` (A. Fichet,
/// R. Pacanowski, A. Wilkie, "An OpenEXR layout for spectral images", J. Computer Graphics Techniques 10, 2021).
#[derive(Clone, Debug)]
pub struct Bands {
    channels: Vec<Channel>,
    /// CIE XYZ, lux, for 1 W m^-2 nm^-1 in each band.
    xyz: Vec<[f64; 3]>,
    balance: Balance,
}

/// A plane imager with a spectrograph at each pixel.
pub type SpectralPlane = DetectorPlane<Bands>;

impl SpectralPlane {
    /// Creates an imager on the frame `plane` with `bands` bands of equal width from `first_nm` to `last_nm`, on `grid`.
    #[must_use]
    pub fn new(plane: Plane, grid: &Grid, bands: usize, first_nm: f64, last_nm: f64) -> Self {
        let width_nm = (last_nm - first_nm) / bands as f64;
        let functions = Observer::cie_1931_2deg().on_grid(grid);
        let (mut channels, mut xyz) = (Vec::new(), Vec::new());
        for band in 0..bands {
            let low = first_nm + width_nm * band as f64;
            let response: Vec<f64> = (0..grid.count).map(|i| share(i, low, width_nm, grid)).collect();
            xyz.push([0, 1, 2].map(|k| {
                let seen: Vec<f64> = functions[k].iter().zip(&response).map(|(f, r)| f * r * width_nm).collect();
                grid.integrate(&seen) * LUMINOUS_EFFICACY_LM_PER_W
            }));
            let middle = format!("{:.1}", low + 0.5 * width_nm).replace('.', ",");
            channels.push(Channel { name: format!("S0.{middle}nm"), unit: "W.m^-2.nm^-1".into(), response });
        }
        Self::of(plane, Bands { channels, xyz, balance: Balance::Screen }, None)
    }

    /// Returns this imager with another light shown as white in its picture.
    #[must_use]
    pub fn with_balance(mut self, balance: Balance) -> Self {
        self.response.balance = balance;
        self
    }
}

/// Returns the response of a band at a node of the grid, 1/nm: the fraction of the node's cell that lies in the band, divided by
/// the band's width. Adjacent bands together see every wavelength exactly once. The first and the last node have half a cell and
/// count half in an integral.
fn share(node: usize, low_nm: f64, width_nm: f64, grid: &Grid) -> f64 {
    let (nm, half) = (grid.wavelength_nm(node), 0.5 * grid.step_nm);
    let (from, to) = ((nm - half).max(grid.start_nm), (nm + half).min(grid.end_nm()));
    let overlap = to.min(low_nm + width_nm) - from.max(low_nm);
    overlap.max(0.0) / (to - from) / width_nm
}

impl Response for Bands {
    fn channels(&self) -> Vec<Channel> {
        self.channels.clone()
    }

    /// Shows the colors of the bands as an eye sees them, with automatic exposure.
    fn display(&self, exposure: &ExposureFrame) -> Option<DisplayPicture> {
        self.finish(exposure, ExtraRequest::default()).map(|finished| finished.display)
    }

    fn finish(&self, exposure: &ExposureFrame, wanted: ExtraRequest) -> Option<FinishedPicture> {
        let planes = exposure.planes(&self.channels)?;
        let channels = ["X", "Y", "Z"].into_iter().enumerate().map(|(k, name)| ExposureChannel {
            name: name.into(),
            unit: "lx".into(),
            values: (0..exposure.size.pixels())
                .map(|p| {
                    planes.iter().zip(&self.xyz).map(|(plane, xyz)| f64::from(plane[p]) * xyz[k]).sum::<f64>() as f32
                })
                .collect(),
        });
        let frame = ExposureFrame { size: exposure.size, channels: channels.collect() };
        let adapted = self.balance.matrix(&frame);
        finish_xyz(&frame, White::default(), Gamut::Desaturate, adapted.as_ref(), wanted).ok()
    }
}

fn build(params: &Params, context: &Context<'_>) -> Result<Box<dyn Imager>, Faults> {
    let parsed: SpectralParams = params.parse()?;
    let mut faults = Faults::new();
    let plane = faults.take(parsed.frame.plane(params, context));
    let balance = faults.take(WhiteBalance::read(parsed.white_balance.as_ref(), params, context));
    let SpectralParams { bands, range, .. } = parsed;
    let bands = bands.get();
    let [first, last] = range.map_or([380.0, 780.0], |range| range.map(|w| w.nm()));
    let grid = &context.grid;
    if !(first >= grid.start_nm && last <= grid.end_nm() && last - first >= bands as f64 * grid.step_nm) {
        let fault = params.fault("range", format!("{bands} bands do not fit between {first} and {last} nm"));
        faults.push(fault.hint(format!(
            "write a range within the band of the scene, {} to {} nm, with bands at least {} nm wide",
            grid.start_nm,
            grid.end_nm(),
            grid.step_nm
        )));
    }
    let (Some(plane), Some(balance)) = (plane.filter(|_| faults.is_empty()), balance) else { return Err(faults) };
    let imager = SpectralPlane::new(plane, grid, bands as usize, first, last);
    Ok(Box::new(imager.with_balance(balance)))
}

spectra_core::register!(imager "spectral": SpectralParams, build);

#[cfg(test)]
mod tests {
    use super::*;
    use spectra_core::frame::FrameSize;
    use spectra_core::spectral::BAND;

    fn size() -> FrameSize {
        FrameSize { width_px: 2, height_px: 1, width_mm: 2.0, height_mm: 1.0 }
    }

    /// A spectrum of 1 W m^-2 nm^-1 gives 1 in every band, adjacent bands see every wavelength once, and names follow the
    /// convention.
    #[test]
    fn bands_share_the_spectrum() {
        let imager = SpectralPlane::new(Plane::new(size()), &BAND, 16, 400.0, 700.0);
        let channels = imager.channels();
        assert_eq!(channels[0].name.as_str(), "S0.409,4nm");
        for channel in &channels {
            assert!((BAND.integrate(&channel.response) - 1.0).abs() < 1e-12, "{}", channel.name);
        }
        for i in 52..348 {
            let sum: f64 = channels.iter().map(|c| c.response[i]).sum();
            assert!((sum * 300.0 / 16.0 - 1.0).abs() < 1e-12, "{i}: {sum}");
        }
    }

    /// Bands that reach the ends of the grid include all light there: their mean is 1 as in all other bands.
    #[test]
    fn bands_at_the_ends_of_the_grid_are_whole() {
        for bands in [1, 7, 48, 240] {
            let imager = SpectralPlane::new(Plane::new(size()), &BAND, bands, BAND.start_nm, BAND.end_nm());
            for channel in imager.channels() {
                let mean = BAND.integrate(&channel.response);
                assert!((mean - 1.0).abs() < 1e-12, "{bands}, {}: {mean}", channel.name);
            }
        }
    }

    /// The picture of an equal-energy spectrum has the luminance that the sum of y-bar gives, for any number of bands: 106.857 nm
    /// (CIE 1931, 1 nm sums from 360 to 830 nm; 380-780 nm contain all but 1e-4 of it).
    #[test]
    fn the_preview_is_photometric() {
        for bands in [1, 8, 40] {
            let imager = SpectralPlane::new(Plane::new(size()), &BAND, bands, 380.0, 780.0);
            let y: f64 = imager.response.xyz.iter().map(|xyz| xyz[1]).sum();
            assert!((y / (LUMINOUS_EFFICACY_LM_PER_W * 106.857) - 1.0).abs() < 2e-4, "{bands}: {y}");
        }
    }
}
