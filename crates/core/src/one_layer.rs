//! The simplest film: one layer, and a color for each exposure.

use crate::frame::{DisplayPicture, ExposureFrame};
use crate::params::Fault;
use crate::registry::Context;
use crate::spectral::Channel;
use crate::stage::Film;

/// A pixel of a frame, from which a film can derive noise that differs from pixel to pixel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pixel {
    /// Number of the pixel, row-major from the top left of the upright picture.
    pub index: u64,
    /// Area of the pixel on the film, mm^2.
    pub area_mm2: f64,
    /// Frame number in an animation; 0 for a single picture.
    pub frame: u64,
}

/// A film of one layer: a spectral response, an exposure time, and the color that an exposure becomes.
///
/// ```
/// # use spectra_core::{one_layer::OneLayer, registry::Context, stage::Film};
/// # fn build(context: &Context<'_>) -> Box<dyn Film> {
/// // Sees 400 to 500 nm; an exposure of 1e-3 J m^-2 gives half the greatest brightness.
/// let sees = |nm: f64| if (nm - 450.0).abs() < 50.0 { 1.0 } else { 0.0 };
/// let tone = |joule_per_m2: f64, _| [joule_per_m2 / (joule_per_m2 + 1e-3); 3];
/// Box::new(OneLayer::new("blue film", "J m^-2", context, sees, 1.0 / 60.0, tone))
/// # }
/// ```
pub struct OneLayer<T> {
    channel: Channel,
    exposure_time_s: f64,
    tone: T,
    frame: u64,
}

impl<T: Fn(f64, Pixel) -> [f64; 3] + Send + Sync> OneLayer<T> {
    /// Creates a film called `name`. `sees` is its response to spectral irradiance (W m^-2 nm^-1) at a wavelength (nm). Its
    /// exposure, in `unit`, is the integral of irradiance times response, times `exposure_time_s`. `tone` turns the exposure of a
    /// pixel into linear light (sRGB primaries; 1 is the screen's white).
    #[must_use]
    pub fn new(
        name: &str,
        unit: &str,
        context: &Context<'_>,
        sees: impl Fn(f64) -> f64,
        exposure_time_s: f64,
        tone: T,
    ) -> Self {
        let response = context.grid.wavelengths_nm().map(sees).collect();
        let channel = Channel { name: name.to_owned(), unit: unit.to_owned(), response };
        Self { channel, exposure_time_s, tone, frame: 0 }
    }
}

impl<T: Fn(f64, Pixel) -> [f64; 3] + Send + Sync + 'static> Film for OneLayer<T> {
    fn channels(&self) -> Vec<Channel> {
        vec![self.channel.clone()]
    }

    fn exposure_time_s(&self) -> f64 {
        self.exposure_time_s
    }

    fn develop(&self, exposure: &ExposureFrame) -> Result<DisplayPicture, Fault> {
        let (size, values) = (exposure.size, exposure.values(&self.channel.name)?);
        let area_mm2 = size.pixel_area_mm2();
        let color = |(index, value): (usize, &f32)| {
            let pixel = Pixel { index: index as u64, area_mm2, frame: self.frame };
            (self.tone)(f64::from(*value), pixel).map(|c| c as f32)
        };
        let rgb = values.iter().enumerate().map(color).collect();
        Ok(DisplayPicture { width_px: size.width_px, height_px: size.height_px, rgb })
    }

    fn set_frame(&mut self, frame: u64) {
        self.frame = frame;
    }

    fn describe(&self) -> String {
        format!("{}, exposed for {}", self.channel.name, crate::shutter::format_time(self.exposure_time_s))
    }
}
