//! Writing of figures to files.

use crate::canvas::Canvas;
use image::codecs::png::{CompressionType, FilterType, PngEncoder};
use image::{ExtendedColorType, ImageEncoder, ImageError};
use spectra_files::{WriteError, WriteFault, write_atomically};
use std::io::Write as _;
use std::path::{Path, PathBuf};

/// Number of PNG pixels per canvas unit: sharp on a high-density screen and in print.
const PIXELS_A_UNIT: f64 = 2.0;

/// File format of a figure.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Format {
    /// SVG: lines and areas, sharp at any size.
    Svg,
    /// PNG: two pixels per canvas unit unless another scale is given.
    Png,
}

impl Format {
    /// Returns the format for the extension of a file name, in upper or lower case.
    ///
    /// # Errors
    /// [`PlotError::Ending`] for any other extension.
    pub fn of(path: &Path) -> Result<Self, PlotError> {
        match path.extension().map(|e| e.to_string_lossy().to_lowercase()).as_deref() {
            Some("svg") => Ok(Self::Svg),
            Some("png") => Ok(Self::Png),
            _ => Err(PlotError::Ending { path: path.into() }),
        }
    }
}

/// A figure that could not be written.
#[derive(Debug, thiserror::Error)]
pub enum PlotError {
    /// The extension of the file name is unknown.
    #[error("{}: a figure is written as .svg or .png", path.display())]
    Ending {
        /// Path of the file.
        path: PathBuf,
    },
    /// The operating system refused.
    #[error(transparent)]
    Write(#[from] WriteError),
}

impl Canvas {
    /// Writes the drawing in the format of the file's extension: `.svg`, or `.png` with two pixels per canvas unit. The file appears under
    /// its name only when it is complete.
    ///
    /// # Errors
    /// [`PlotError`].
    pub fn write(&self, path: &Path) -> Result<(), PlotError> {
        self.write_at(path, PIXELS_A_UNIT)
    }

    /// Writes the drawing as [`Canvas::write`] does, but with `scale` pixels per canvas unit in a PNG.
    ///
    /// # Errors
    /// [`PlotError`].
    pub fn write_at(&self, path: &Path, scale: f64) -> Result<(), PlotError> {
        let bytes = self.to_bytes(Format::of(path)?, scale);
        Ok(write_atomically(path, |file| Ok(file.write_all(&bytes?)?))?)
    }

    /// Returns the content of a file in this format, with `scale` pixels per canvas unit in a PNG.
    ///
    /// # Errors
    /// [`WriteFault::Format`]: the picture is too large for the encoder.
    pub fn to_bytes(&self, format: Format, scale: f64) -> Result<Vec<u8>, WriteFault> {
        match format {
            Format::Svg => Ok(self.to_svg().into_bytes()),
            Format::Png => {
                let pixels = self.to_pixels(scale);
                png(pixels.rgb.as_flattened(), pixels.width_px, pixels.height_px).map_err(fault)
            }
        }
    }
}

/// Encodes an 8-bit RGB PNG.
pub(crate) fn png(rgb: &[u8], width_px: u32, height_px: u32) -> Result<Vec<u8>, ImageError> {
    let mut bytes = Vec::new();
    PngEncoder::new_with_quality(&mut bytes, CompressionType::Best, FilterType::Adaptive).write_image(
        rgb,
        width_px,
        height_px,
        ExtendedColorType::Rgb8,
    )?;
    Ok(bytes)
}

fn fault(error: ImageError) -> WriteFault {
    match error {
        ImageError::IoError(cause) => WriteFault::Io(cause),
        other => WriteFault::Format(other.to_string()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Color, Stroke};

    #[test]
    fn the_ending_decides() {
        let folder = tempfile::tempdir().expect("a folder");
        let mut canvas = Canvas::new(30.0, 20.0, "a < b");
        canvas.line([0.0, 10.0], [30.0, 10.0], &Stroke::new(Color::BLACK, 4.0));
        let path = |name: &str| folder.path().join(name);
        canvas.write(&path("a.PNG")).expect("written");
        let picture = image::open(path("a.PNG")).expect("a picture").to_rgb8();
        assert_eq!(
            (picture.dimensions(), picture.get_pixel(30, 20).0, picture.get_pixel(30, 5).0),
            ((60, 40), [0; 3], [255; 3])
        );
        canvas.write(&path("a.svg")).expect("written");
        assert!(std::fs::read_to_string(path("a.svg")).expect("text").contains("<title>a &lt; b</title>"));
        for name in ["a.jpg", "a"] {
            assert!(matches!(canvas.write(&path(name)), Err(PlotError::Ending { .. })));
        }
        assert!(matches!(canvas.write(&path("no/a.png")), Err(PlotError::Write(_))));
    }
}
