//! Frames: what is recorded, and the pictures made from it.

use crate::params::Fault;
use crate::spectral::Channel;

/// Size of the recorded frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FrameSize {
    /// Pixels across.
    pub width_px: u32,
    /// Pixels down.
    pub height_px: u32,
    /// Width, mm.
    pub width_mm: f64,
    /// Height, mm.
    pub height_mm: f64,
}

impl FrameSize {
    /// Number of pixels of the frame.
    #[must_use]
    pub fn pixels(&self) -> usize {
        self.width_px as usize * self.height_px as usize
    }

    /// Area of one pixel, mm^2.
    #[must_use]
    pub fn pixel_area_mm2(&self) -> f64 {
        self.width_mm / f64::from(self.width_px) * (self.height_mm / f64::from(self.height_px))
    }

    /// Returns the index of the pixel at a point on the film (mm), row by row from the top of the upright picture; `None` outside
    /// the frame. A lens rotates its image by half a turn: columns count toward -x and rows toward +y.
    #[inline(always)]
    #[must_use]
    pub fn pixel_at(&self, x_mm: f64, y_mm: f64) -> Option<u32> {
        let column = (0.5 - x_mm / self.width_mm) * f64::from(self.width_px);
        let row = (0.5 + y_mm / self.height_mm) * f64::from(self.height_px);
        let inside =
            column >= 0.0 && row >= 0.0 && column < f64::from(self.width_px) && row < f64::from(self.height_px);
        inside.then(|| row as u32 * self.width_px + column as u32)
    }

    /// Returns the point on the film (x and y, mm) at the position (`u`, `v`) within a pixel. In the upright picture `u` runs
    /// from 0 to 1 to the right, `v` downward. The inverse of [`FrameSize::pixel_at`].
    #[inline(always)]
    #[must_use]
    pub fn point_of(&self, pixel: u32, u: f64, v: f64) -> (f64, f64) {
        let column = f64::from(pixel % self.width_px) + u;
        let row = f64::from(pixel / self.width_px) + v;
        (
            (0.5 - column / f64::from(self.width_px)) * self.width_mm,
            (row / f64::from(self.height_px) - 0.5) * self.height_mm,
        )
    }
}

/// Linear exposure per channel and pixel, before any characteristic curve.
#[derive(Clone, Debug, PartialEq)]
pub struct ExposureFrame {
    /// Size of the frame.
    pub size: FrameSize,
    /// One plane per channel, row-major, upright.
    pub channels: Vec<ExposureChannel>,
}

/// One plane of an [`ExposureFrame`].
#[derive(Clone, Debug, PartialEq)]
pub struct ExposureChannel {
    /// Name, such as `Y` or `ortho`.
    pub name: String,
    /// Unit, such as `lx s`.
    pub unit: String,
    /// Values, `width_px * height_px` of them.
    pub values: Vec<f32>,
}

impl ExposureFrame {
    /// Returns the channel of this name, if there is one.
    #[must_use]
    pub fn channel(&self, name: &str) -> Option<&ExposureChannel> {
        self.channels.iter().find(|c| c.name == name)
    }

    /// Returns the values of the frame's planes for `channels`, found by name, in the order of `channels`; `None` if one is
    /// missing.
    #[must_use]
    pub fn planes(&self, channels: &[Channel]) -> Option<Vec<&[f32]>> {
        channels.iter().map(|c| self.channel(&c.name).map(|plane| &plane.values[..])).collect()
    }

    /// Returns the values of the channel of this name, one per pixel.
    ///
    /// # Errors
    /// A sentence that names the missing channel, in the form that [`crate::stage::Film::develop`] returns.
    pub fn values(&self, name: &str) -> Result<&[f32], Fault> {
        self.channel(name)
            .map(|c| &c.values[..])
            .ok_or_else(|| Fault::new(format!("the exposure has no channel `{name}`")))
    }

    /// Hashes the frame: 64-bit FNV-1a (G. Fowler, L. C. Noll, K.-P. Vo) of the size in pixels, and of each channel's name and
    /// values, little-endian. Two renders with the same hash have the same bits, unless somebody constructed a collision.
    #[must_use]
    pub fn fingerprint(&self) -> u64 {
        let mut hash: u64 = 0xcbf2_9ce4_8422_2325;
        let mut add = |bytes: &[u8]| {
            for byte in bytes {
                hash = (hash ^ u64::from(*byte)).wrapping_mul(0x0000_0100_0000_01b3);
            }
        };
        add(&self.size.width_px.to_le_bytes());
        add(&self.size.height_px.to_le_bytes());
        for channel in &self.channels {
            add(channel.name.as_bytes());
            channel.values.iter().for_each(|value| add(&value.to_le_bytes()));
        }
        hash
    }
}

/// A picture for a screen: linear light in sRGB primaries; 1 is the screen's white.
#[derive(Clone, Debug, PartialEq)]
pub struct DisplayPicture {
    /// Pixels across.
    pub width_px: u32,
    /// Pixels down.
    pub height_px: u32,
    /// Red, green, blue; row-major, upright. Values outside [0, 1] are clipped when written.
    pub rgb: Vec<[f32; 3]>,
}

impl DisplayPicture {
    /// Makes a picture from the values of one channel of a frame, one per pixel. `color` turns each value into linear light in
    /// sRGB primaries.
    #[must_use]
    pub fn of(size: FrameSize, values: &[f32], color: impl FnMut(&f32) -> [f32; 3]) -> Self {
        Self { width_px: size.width_px, height_px: size.height_px, rgb: values.iter().map(color).collect() }
    }
}

/// The meaning of the values of a picture (ISO 22028-1 calls it the image state).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum ImageState {
    /// Values are proportional to the light of the scene.
    SceneReferred,
    /// Values are the light that a print, a projection or a screen sends.
    #[default]
    DisplayReferred,
    /// Values are densities on a scale, not light; no program should take them for a color.
    Data,
}

impl ImageState {
    /// Name of the image state, as written to the header of a file.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::SceneReferred => "scene-referred",
            Self::DisplayReferred => "display-referred",
            Self::Data => "data",
        }
    }
}

/// Data requested of a picture in addition to what a screen shows.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct ExtraRequest {
    /// Whether to return the picture without conversion to a gamut; see [`ExtraData::unclamped`].
    pub unclamped: bool,
    /// Whether to return the exposure and density of each layer; see [`ExtraData::layers`].
    pub layers: bool,
}

/// A finished picture: what a screen shows, and additional data.
#[derive(Clone, Debug, PartialEq)]
pub struct FinishedPicture {
    /// The picture for a screen.
    pub display: DisplayPicture,
    /// Additional data of the picture.
    pub extra: ExtraData,
}

/// Data of a picture in addition to what a screen shows.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ExtraData {
    /// The picture without conversion to a gamut: values below 0 are colors that sRGB cannot have, values above 1 are light
    /// beyond white. For [`ImageState::Data`], the values of the scale themselves. `None` if unknown or not wanted.
    pub unclamped: Option<DisplayPicture>,
    /// Layers by their names (`exposure.red`, `density.red`), of the picture's size; empty if unknown or not wanted.
    pub layers: Vec<ExposureChannel>,
    /// Amount of light that the value 1 stands for, such as `0.4 lx s`; `None` if it stands for no fixed amount.
    pub white: Option<String>,
}

impl FinishedPicture {
    /// Creates a finished picture from a picture for a screen, without additional data.
    #[must_use]
    pub fn of(shown: DisplayPicture) -> Self {
        Self { display: shown, extra: ExtraData::default() }
    }
}

/// The output of a sensor's analog-to-digital converter: one number per pixel, and what a raw converter needs to develop them.
#[derive(Clone, Debug, PartialEq)]
pub struct RawFrame {
    /// Number of pixels across the frame.
    pub width_px: u32,
    /// Number of pixels down the frame.
    pub height_px: u32,
    /// Values, row-major, upright.
    pub values: Vec<u16>,
    /// Colors of the filters, 2 x 2 in rows from the upper left: 0 red, 1 green, 2 blue. `None`: no filters.
    pub pattern: Option<[u8; 4]>,
    /// Value of a pixel that received no light.
    pub black_level: u16,
    /// Value at which the converter saturates.
    pub white_level: u16,
    /// Matrices between the camera's colors and XYZ, for one illuminant or for two, the one of lower color temperature first.
    /// Empty without filters.
    pub colors: Vec<RawColor>,
    /// The camera's response to white in red, green and blue, scaled so that the largest is 1.
    pub neutral: [f64; 3],
    /// Illuminant under which `neutral` is white, as an EXIF number (`LightSource`), such as 21 for D65; 255 is any other.
    pub illuminant: u16,
    /// Noise of the values; `None` if they have none.
    pub noise: Option<RawNoise>,
    /// Exposure compensation, in stops, that a raw converter should apply (above 0 brightens). A picture exposed by the meter at
    /// [`RawFrame::iso`] then has its intended brightness.
    pub baseline_exposure_stops: f64,
    /// Width and height of one pixel, mm.
    pub pixel_mm: [f64; 2],
    /// Name of the maker, for the file.
    pub maker: String,
    /// Name of the model, for the file.
    pub model: String,
    /// Model name that is unique to cameras with these colors, for programs that keep color profiles by name.
    pub unique_model: String,
    /// Exposure time, s.
    pub exposure_time_s: f64,
    /// ISO setting.
    pub iso: f64,
}

/// Matrices between a camera's colors and XYZ, for one illuminant.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RawColor {
    /// Illuminant as an EXIF number (`LightSource`), such as 17 for A and 21 for D65.
    pub illuminant: u16,
    /// Matrix from XYZ of the scene to the camera's red, green and blue.
    pub camera_from_xyz: [[f64; 3]; 3],
    /// Matrix from balanced camera colors to XYZ adapted to D50, with white at (0.9643, 1, 0.8251). Balanced means that red,
    /// green and blue are each divided by their value for white.
    pub d50_from_balanced: [[f64; 3]; 3],
}

/// Noise of a raw value. In relative units x = (value - black level) / (white level - black level), a pixel of mean x has the
/// variance `scale` x + `offset`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RawNoise {
    /// Variance per unit of x, from the statistics of photons.
    pub scale: f64,
    /// Variance without light, from reading and rounding.
    pub offset: f64,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn points_and_pixels_are_inverse_and_upright() {
        let size = FrameSize { width_px: 6, height_px: 4, width_mm: 36.0, height_mm: 24.0 };
        for pixel in 0..24 {
            let (x, y) = size.point_of(pixel, 0.4, 0.6);
            assert_eq!(size.pixel_at(x, y), Some(pixel));
        }
        // The subject's upper left is at film lower right: +x, -y (seen from behind the camera).
        assert_eq!(size.pixel_at(17.9, -11.9), Some(0));
        assert_eq!(size.pixel_at(-17.9, 11.9), Some(23));
        for (x, y) in [(18.1, 0.0), (-18.1, 0.0), (0.0, 12.1), (f64::NAN, 0.0)] {
            assert_eq!(size.pixel_at(x, y), None);
        }
    }
}
