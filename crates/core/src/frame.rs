//! Frames: what is recorded, and the pictures made from it.

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
    /// Number of pixels.
    #[must_use]
    pub fn pixels(&self) -> usize {
        self.width_px as usize * self.height_px as usize
    }

    /// Area of one pixel, mm^2.
    #[must_use]
    pub fn pixel_area_mm2(&self) -> f64 {
        self.width_mm / f64::from(self.width_px) * (self.height_mm / f64::from(self.height_px))
    }

    /// The pixel (row-major, from the top row of the upright picture) at a point on the film, or `None` outside the
    /// frame. A lens rotates its image by half a turn, so columns count against x and rows count along y.
    #[inline(always)]
    #[must_use]
    pub fn pixel_at(&self, x_mm: f64, y_mm: f64) -> Option<u32> {
        let column = (0.5 - x_mm / self.width_mm) * f64::from(self.width_px);
        let row = (0.5 + y_mm / self.height_mm) * f64::from(self.height_px);
        let inside =
            column >= 0.0 && row >= 0.0 && column < f64::from(self.width_px) && row < f64::from(self.height_px);
        inside.then(|| row as u32 * self.width_px + column as u32)
    }

    /// The point on the film, mm, at (`u`, `v`) in [0, 1]^2 of a pixel; the inverse of [`FrameSize::pixel_at`].
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
    /// Size.
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
    /// The channel of that name.
    #[must_use]
    pub fn channel(&self, name: &str) -> Option<&ExposureChannel> {
        self.channels.iter().find(|c| c.name == name)
    }

    /// The values of these channels, in this order; `None` if one is missing.
    #[must_use]
    pub fn planes(&self, channels: &[Channel]) -> Option<Vec<&[f32]>> {
        channels.iter().map(|c| self.channel(&c.name).map(|plane| &plane.values[..])).collect()
    }

    /// The values of the channel of that name, one per pixel.
    ///
    /// # Errors
    /// The name of the missing channel, in the form that [`crate::stage::Film::develop`] returns.
    pub fn values(&self, name: &str) -> Result<&[f32], String> {
        self.channel(name).map(|c| &c.values[..]).ok_or_else(|| format!("the exposure has no channel `{name}`"))
    }

    /// A number of its bits: 64-bit FNV-1a (G. Fowler, L. C. Noll, K.-P. Vo) of the size in pixels, and of each channel's name
    /// and values, little-endian. Two renders with the same number have the same bits, unless somebody went out of their way.
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
    /// A picture of one channel of a frame: `color` turns each value into linear light in sRGB primaries.
    #[must_use]
    pub fn of(size: FrameSize, values: &[f32], color: impl FnMut(&f32) -> [f32; 3]) -> Self {
        Self { width_px: size.width_px, height_px: size.height_px, rgb: values.iter().map(color).collect() }
    }
}

/// What the values of a picture stand for (ISO 22028-1 calls it the image state).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum ImageState {
    /// In proportion to the light of the scene.
    SceneReferred,
    /// The light that a print, a projection or a screen sends.
    #[default]
    DisplayReferred,
    /// No light: densities on a scale, which no program should take for a color.
    Data,
}

impl ImageState {
    /// In words, for the header of a file.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::SceneReferred => "scene-referred",
            Self::DisplayReferred => "display-referred",
            Self::Data => "data",
        }
    }
}

/// What is wanted of a picture beside what a screen shows.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Wanted {
    /// The same in no gamut.
    pub open: bool,
    /// Exposure and density, layer by layer.
    pub layers: bool,
}

/// A finished picture: what a screen shows, and what is known beside it.
#[derive(Clone, Debug, PartialEq)]
pub struct Finished {
    /// For a screen.
    pub shown: DisplayPicture,
    /// Beside it.
    pub beside: Beside,
}

/// What is known of a picture beside what a screen shows.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Beside {
    /// The same picture, as far as it is known, brought into no gamut: values below 0 are colors that sRGB cannot have, values above 1
    /// light beyond white. Of [`ImageState::Data`], the values of the scale themselves. `None` where it is not known, or not
    /// wanted.
    pub open: Option<DisplayPicture>,
    /// Layers by their names (`exposure.red`, `density.red`), of the picture's size; none where they are not wanted, or unknown.
    pub layers: Vec<ExposureChannel>,
    /// What the value 1 stands for, such as `0.4 lx s`, where it stands for an amount of light.
    pub white: Option<String>,
}

impl Finished {
    /// Of which only what a screen shows is known.
    #[must_use]
    pub fn of(shown: DisplayPicture) -> Self {
        Self { shown, beside: Beside::default() }
    }
}

/// What a sensor's analog-to-digital converter delivers: one number per pixel, and what a raw converter needs to develop them.
#[derive(Clone, Debug, PartialEq)]
pub struct RawFrame {
    /// Pixels across.
    pub width_px: u32,
    /// Pixels down.
    pub height_px: u32,
    /// Row-major, upright.
    pub values: Vec<u16>,
    /// Colors of the filters, 2 x 2 in rows from the upper left: 0 red, 1 green, 2 blue. `None`: no filters.
    pub pattern: Option<[u8; 4]>,
    /// Value without light.
    pub black_level: u16,
    /// Value at which the converter saturates.
    pub white_level: u16,
    /// What the filters' colors mean, for one light or for two, the one of lower color temperature first; none without
    /// filters.
    pub colors: Vec<RawColor>,
    /// The camera's red, green and blue of white; the largest is 1.
    pub neutral: [f64; 3],
    /// The light of white: its EXIF number (`LightSource`), such as 21 for D65; 255 is any other.
    pub illuminant: u16,
    /// Noise of the values; `None` where there is none.
    pub noise: Option<RawNoise>,
    /// By how many stops a converter should brighten (above 0) or darken the picture, so that an exposure by the meter at
    /// [`RawFrame::iso`] looks as it should.
    pub baseline_exposure_stops: f64,
    /// Width and height of a pixel, mm.
    pub pixel_mm: [f64; 2],
    /// Maker for the file.
    pub maker: String,
    /// Model for the file.
    pub model: String,
    /// What sets cameras of other colors apart, for programs that keep color profiles by name.
    pub unique_model: String,
    /// Exposure time, s.
    pub exposure_time_s: f64,
    /// ISO setting.
    pub iso: f64,
}

/// What a camera's colors mean in one light.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RawColor {
    /// The light: its EXIF number (`LightSource`), such as 17 for A and 21 for D65.
    pub illuminant: u16,
    /// Rows give the camera's red, green and blue from XYZ of the scene.
    pub camera_from_xyz: [[f64; 3]; 3],
    /// Rows give XYZ as it looks the same under D50, white (0.9643, 1, 0.8251), from the camera's red, green and blue,
    /// each divided by that of white.
    pub d50_from_balanced: [[f64; 3]; 3],
}

/// Noise of a raw value. With x = (value - black) / (white - black) on average, x has the variance scale x + offset.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RawNoise {
    /// What photons add.
    pub scale: f64,
    /// What reading and rounding add.
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
