//! A picture file as stored: every channel with its values, and the header, for measurements.

use super::linear_picture::FileProblem;

/// One channel of a picture file.
#[derive(Clone, Debug, PartialEq)]
pub struct ChannelData {
    /// Name of the channel, preceded by the name of its part if the part has one.
    pub name: String,
    /// Unit of the values, from the header attribute `unit NAME` that this program writes for the channel `NAME`. Empty if the
    /// file has no such attribute.
    pub unit: String,
    /// Values, row by row from the top, as stored: possibly negative, infinite or NaN.
    pub values: Vec<f32>,
}

/// All channels of a picture, upright, and its header.
#[derive(Clone, Debug, PartialEq)]
pub struct PictureChannels {
    /// Name of the format, for display.
    pub format: &'static str,
    /// Width, pixels.
    pub width: u32,
    /// Height, pixels.
    pub height: u32,
    /// Width over height of a pixel.
    pub pixel_aspect: f64,
    /// Channels in the order of the file. A file of integers has linear `R`, `G` and `B` in sRGB primaries.
    pub channels: Vec<ChannelData>,
    /// Chromaticities x, y of red, green, blue and white, if the header states them or names a space that has them.
    pub chromaticities: Option<[[f64; 2]; 4]>,
    /// Name and text of each text attribute of the header.
    pub attributes: Vec<(String, String)>,
    /// Linear light at which integer code values clip; `None` for floating point.
    pub clipped_at: Option<f32>,
    /// Warnings about the colors that a user should know.
    pub warnings: Vec<FileProblem>,
}

/// Returns whether chromaticities of red, green, blue and white are those of CIE XYZ: then X is stored in R, Y in G and Z in B.
pub(super) fn are_of_xyz(xy: &[[f64; 2]; 4]) -> bool {
    let primaries = [[1.0, 0.0], [0.0, 1.0], [0.0, 0.0]];
    xy.iter().zip(primaries).all(|(a, b)| (a[0] - b[0]).abs() < 1e-4 && (a[1] - b[1]).abs() < 1e-4)
}

impl PictureChannels {
    /// Returns whether `R`, `G` and `B` hold CIE XYZ, according to the chromaticities.
    #[must_use]
    pub fn holds_xyz(&self) -> bool {
        self.chromaticities.as_ref().is_some_and(are_of_xyz)
    }

    /// Returns the channel with this name.
    #[must_use]
    pub fn channel(&self, name: &str) -> Option<&ChannelData> {
        self.channels.iter().find(|c| c.name == name)
    }

    /// Returns the text of the attribute with this name.
    #[must_use]
    pub fn attribute(&self, name: &str) -> Option<&str> {
        self.attributes.iter().find(|(own, _)| own == name).map(|(_, text)| text.as_str())
    }

    /// Number of pixels of a channel.
    #[must_use]
    pub fn pixels(&self) -> usize {
        self.width as usize * self.height as usize
    }
}
