//! Conversion from electrons to digital numbers, and from digital numbers to a picture.

use super::color::CameraColor;
use super::demosaic::demosaic;
use super::noise::PixelNumbers;
use super::pattern::Pattern;
use glam::DVec3;
use rayon::prelude::*;
use spectra_color::{Adaptation, Gamut, RgbSpace};
use spectra_core::frame::{
    DisplayPicture, ExposureChannel, ExposureFrame, ExtraRequest, FinishedPicture, FrameSize, RawColor, RawFrame,
    RawNoise,
};
use spectra_core::stage::Digitize;
use spectra_film::display::{White, finish_xyz};

/// The electronics of a sensor, from the well to a developed picture.
#[derive(Clone, Debug)]
pub struct Converter {
    /// Color filters of the sensor.
    pub pattern: Pattern,
    /// Exposure time, s.
    pub exposure_time_s: f64,
    /// Largest number of electrons in a well.
    pub full_well: f64,
    /// Standard deviation of the read noise, electrons.
    pub read_noise: f64,
    /// Electrons per digital number.
    pub electrons_per_number: f64,
    /// Digital number without light.
    pub black_level: u16,
    /// Largest digital number.
    pub white_level: u16,
    /// Seed of photon and read noise; `None` without noise.
    pub noise: Option<u64>,
    /// ISO setting of the exposure.
    pub iso: f64,
    /// Color matrices and white; `None` without filters.
    pub color: Option<CameraColor>,
    /// EXIF number (`LightSource`) of the light that is shown as white; 255 is any other.
    pub illuminant: u16,
    /// Color matrices for raw converters, each with the EXIF number of its light. The light of lower color temperature comes first.
    pub calibrations: Vec<(u16, CameraColor)>,
    /// Name of the camera in the raw file.
    pub model: String,
    /// Name that distinguishes cameras with different sensitivities.
    pub unique_model: String,
}

/// Exposure, lx s, that fills the well at ISO 1, from the saturation-based speed of ISO 12232.
const SATURATION_LX_S: f64 = 78.0;

/// Returns the mean number of electrons in each well: the sum of the channels.
#[must_use]
pub fn electrons(exposure: &ExposureFrame) -> Vec<f64> {
    let mut sum = vec![0.0; exposure.size.pixels()];
    for channel in &exposure.channels {
        for (s, v) in sum.iter_mut().zip(&channel.values) {
            *s += f64::from(*v);
        }
    }
    sum
}

impl Digitize for Converter {
    /// Simulates one exposure: photons arrive at random, wells fill, the amplifier adds its noise, the converter rounds.
    fn raw(&self, exposure: &ExposureFrame) -> RawFrame {
        let one = |(pixel, mean): (usize, &f64)| {
            let (counted, read) = match self.noise {
                None => (*mean, 0.0),
                Some(seed) => {
                    let mut numbers = PixelNumbers::new(seed, pixel as u64);
                    (numbers.poisson(*mean), self.read_noise * numbers.normal())
                }
            };
            let value = f64::from(self.black_level) + (counted.min(self.full_well) + read) / self.electrons_per_number;
            // The cast saturates, and turns NaN into 0.
            value.round().min(f64::from(self.white_level)) as u16
        };
        let values = electrons(exposure).par_iter().enumerate().with_min_len(1 << 12).map(one).collect();
        let rows = |matrix: glam::DMat3| [0, 1, 2].map(|row| matrix.row(row).to_array());
        let color = |(illuminant, c): &(u16, CameraColor)| RawColor {
            illuminant: *illuminant,
            camera_from_xyz: rows(c.camera_from_xyz),
            d50_from_balanced: rows(c.d50_from_balanced),
        };
        let FrameSize { width_px, height_px, width_mm, height_mm } = exposure.size;
        RawFrame {
            width_px,
            height_px,
            values,
            pattern: match self.pattern {
                Pattern::Monochrome => None,
                Pattern::Bayer(colors) => Some(colors),
            },
            black_level: self.black_level,
            white_level: self.white_level,
            colors: self.calibrations.iter().map(color).collect(),
            neutral: self.color.as_ref().map_or([1.0; 3], |c| c.neutral.to_array()),
            illuminant: self.illuminant,
            noise: self.noise_profile(),
            baseline_exposure_stops: self.baseline_exposure_stops(),
            pixel_mm: [width_mm / f64::from(width_px), height_mm / f64::from(height_px)],
            maker: "spectra".to_owned(),
            model: self.model.clone(),
            unique_model: self.unique_model.clone(),
            exposure_time_s: self.exposure_time_s,
            iso: self.iso,
        }
    }
}

impl Converter {
    /// Returns the number of electrons that gives the largest digital number.
    fn largest_electrons(&self) -> f64 {
        self.electrons_per_number * (f64::from(self.white_level) - f64::from(self.black_level))
    }

    /// Returns the noise of photons (the variance equals the mean), of reading, and of rounding (a variance of 1/12 of a digital
    /// number squared); `None` without noise.
    fn noise_profile(&self) -> Option<RawNoise> {
        self.noise?;
        let largest = self.largest_electrons();
        let rounding = self.electrons_per_number * self.electrons_per_number / 12.0;
        let offset = (self.read_noise * self.read_noise + rounding) / (largest * largest);
        Some(RawNoise { scale: 1.0 / largest, offset })
    }

    /// Returns the headroom, in stops: how much more daylight the numbers record than a sensor of this ISO speed does.
    fn baseline_exposure_stops(&self) -> f64 {
        let daylight = self.calibrations.last();
        daylight.map_or(0.0, |(_, color)| {
            let saturation_lx_s = self.largest_electrons() / color.largest_per_lx_s;
            libm::log2(saturation_lx_s * self.iso / SATURATION_LX_S)
        })
    }

    /// Develops a picture from a raw frame: demosaicing, white balance, color matrix, automatic exposure.
    #[must_use]
    pub fn show(&self, raw: &RawFrame) -> Option<DisplayPicture> {
        self.finish(raw, ExtraRequest::default()).map(|finished| finished.display)
    }

    /// Develops a picture from a raw frame as [`Converter::show`] does, with the further outputs that are `wanted`.
    #[must_use]
    pub fn finish(&self, raw: &RawFrame, wanted: ExtraRequest) -> Option<FinishedPicture> {
        let (black, range) = (f32::from(self.black_level), f32::from(self.white_level) - f32::from(self.black_level));
        let linear: Vec<f32> = raw.values.iter().map(|v| (f32::from(*v) - black) / range).collect();
        let (width, height) = (raw.width_px as usize, raw.height_px as usize);
        let rgb = demosaic(&linear, width, height, self.pattern);
        let screen = RgbSpace::srgb();
        let xyz = |[r, g, b]: [f32; 3]| match &self.color {
            None => screen.to_xyz([r, g, b].map(f64::from)),
            Some(color) => {
                // A clipped channel must not tint highlights: clip all channels at the level where the first one saturates.
                let camera = DVec3::new(r.into(), g.into(), b.into());
                let camera = (camera / color.neutral).min(DVec3::ONE) * color.neutral;
                (color.camera_from_xyz.inverse() * camera).to_array()
            }
        };
        let white = self.color.as_ref().map(|c| c.white_xyz.to_array());
        let pixels: Vec<[f64; 3]> = rgb
            .into_iter()
            .map(|p| white.map_or_else(|| xyz(p), |w| Adaptation::Bradford.adapt(xyz(p), w, screen.white_xyz())))
            .collect();
        let plane = |i: usize, name: &str| ExposureChannel {
            name: name.to_owned(),
            unit: String::new(),
            values: pixels.iter().map(|p| p[i] as f32).collect(),
        };
        let size = FrameSize { width_px: raw.width_px, height_px: raw.height_px, width_mm: 1.0, height_mm: 1.0 };
        let frame = ExposureFrame { size, channels: vec![plane(0, "X"), plane(1, "Y"), plane(2, "Z")] };
        finish_xyz(&frame, White::default(), Gamut::Desaturate, None, wanted).ok()
    }
}
