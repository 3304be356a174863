//! Pictures in linear light, and errors and warnings about picture files.

use image::ImageError;

/// Largest side of a picture, pixels.
pub(super) const MAX_SIDE: u32 = 65_535;
/// Largest picture, pixels: linear light takes 12 bytes for each.
pub(super) const MAX_PIXELS: u64 = 120_000_000;

/// A picture in linear light, sRGB primaries, upright, row by row from the top.
#[derive(Clone, Debug, PartialEq)]
pub struct LinearPicture {
    /// Width, pixels.
    pub width: u32,
    /// Height, pixels.
    pub height: u32,
    /// Width over height of a pixel.
    pub pixel_aspect: f64,
    /// Linear light, multiplied by alpha where the picture is not opaque. A color outside sRGB has negative values.
    pub rgb: Vec<[f32; 3]>,
    /// Opacity, 0 to 1; `None` if the whole picture is opaque, or if alpha was not requested.
    pub alpha: Option<Vec<f32>>,
    /// Depth channel as the file stores it, if requested.
    pub depth: Option<Vec<f32>>,
    /// Linear light at which integer code values clip; `None` for floating point.
    pub clipped_at: Option<f32>,
    /// Warnings about the pixels that a user should know.
    pub warnings: Vec<FileProblem>,
}

/// Options for reading a picture file.
#[derive(Clone, Copy, Debug, Default)]
pub struct ReadOptions<'a> {
    /// Name of the file: its extension selects formats that the content does not reveal.
    pub name: &'a str,
    /// Name of the encoding of the code values. `None` uses the one that the file states, or else the default encoding of its
    /// format.
    pub transfer: Option<&'a str>,
    /// Whether alpha is requested in addition to light.
    pub alpha: bool,
    /// Name of the layer; `None` for the plain R, G, B of the file.
    pub layer: Option<&'a str>,
    /// Name of the depth channel, if depth is requested.
    pub depth: Option<&'a str>,
    /// Number of pixels requested beyond the picture on each side, horizontally and vertically; at most the header's `overscan`.
    pub overscan: [u32; 2],
    /// Whether the values are not light: no color space is applied, alpha is not multiplied in, and values are not made finite.
    pub is_plain: bool,
}

/// An error in a picture file, or a warning about it.
#[derive(Clone, Debug, PartialEq)]
pub struct FileProblem {
    /// Key whose value the user should change: `file`, `layer`, `depth` or `transfer`.
    pub key: &'static str,
    /// Description of the problem.
    pub text: String,
    /// What the user can do about the problem.
    pub hint: Option<String>,
}

impl FileProblem {
    pub(super) fn file(text: impl Into<String>) -> Self {
        Self { key: "file", text: text.into(), hint: None }
    }

    pub(super) fn at(key: &'static str, text: impl Into<String>) -> Self {
        Self { key, text: text.into(), hint: None }
    }

    /// Returns what the user can do; general advice if only the bytes of the file are wrong.
    #[must_use]
    pub fn advice(&self) -> &str {
        self.hint.as_deref().unwrap_or("is the file complete? Save it again as OpenEXR, PNG, JPEG, TIFF or HDR")
    }

    pub(super) fn hint(self, hint: impl Into<String>) -> Self {
        Self { hint: Some(hint.into()), ..self }
    }
}

/// Reasons why a file of a known kind is not read.
pub(super) enum NotRead {
    /// The file is faulty.
    Trouble(FileProblem),
    /// A sound variant of the kind that this crate does not support.
    Unsupported(String),
}

impl From<FileProblem> for NotRead {
    fn from(trouble: FileProblem) -> Self {
        Self::Trouble(trouble)
    }
}

impl From<ImageError> for NotRead {
    fn from(error: ImageError) -> Self {
        match error {
            ImageError::Unsupported(why) => Self::Unsupported(why.to_string()),
            other => Self::Trouble(FileProblem::file(other.to_string())),
        }
    }
}

/// Returns an error if a picture of this size is empty or exceeds the limits.
pub(super) fn check_size(width: u64, height: u64) -> Result<(), FileProblem> {
    if width == 0 || height == 0 {
        return Err(FileProblem::file("the picture has no pixels"));
    }
    if width > u64::from(MAX_SIDE) || height > u64::from(MAX_SIDE) || width * height > MAX_PIXELS {
        let text = format!(
            "the picture is too large: {width} x {height} pixels; at most {MAX_PIXELS} in total and {MAX_SIDE} per side"
        );
        return Err(FileProblem::file(text));
    }
    Ok(())
}

/// Repairs values that are not finite, and returns a warning with the number of pixels.
/// An infinite value becomes the largest finite value of the picture, or white if that is more. A pixel with NaN or negative infinity
/// becomes black.
pub(super) fn mend(rgb: &mut [[f32; 3]]) -> Option<FileProblem> {
    let (mut largest, mut is_sound) = (1.0_f32, true);
    for value in rgb.iter().flatten() {
        if value.is_finite() {
            largest = largest.max(*value);
        } else {
            is_sound = false;
        }
    }
    if is_sound {
        return None;
    }
    let (mut infinite, mut undefined) = (0_usize, 0_usize);
    for pixel in rgb.iter_mut().filter(|pixel| pixel.iter().any(|v| !v.is_finite())) {
        if pixel.iter().any(|v| v.is_nan() || *v == f32::NEG_INFINITY) {
            undefined += 1;
            *pixel = [0.0; 3];
        } else {
            infinite += 1;
            *pixel = pixel.map(|v| v.min(largest));
        }
    }
    let pixels = |n: usize| if n == 1 { "1 pixel".to_owned() } else { format!("{n} pixels") };
    let infinite =
        (infinite > 0).then(|| format!("{} with infinite values, which count as {largest}", pixels(infinite)));
    let undefined =
        (undefined > 0).then(|| format!("{} with values that are not numbers, taken as black", pixels(undefined)));
    let all: Vec<String> = infinite.into_iter().chain(undefined).collect();
    let trouble = FileProblem::file(format!("it has {}", all.join(", and ")));
    Some(trouble.hint("repair them in the program that wrote the file"))
}

/// Alpha from which a pixel counts as opaque: files of 16 bits do not always hold 1 to its last digit.
pub(super) const OPAQUE: f32 = 0.999;

/// Returns a warning if `thin` of `pixels` pixels are not opaque and the background is unknown.
pub(super) fn over_black(thin: usize, pixels: usize) -> Option<FileProblem> {
    if thin == 0 {
        return None;
    }
    let text = format!(
        "{thin} of its {pixels} pixels are not opaque: they are laid over black, which a meter of the whole frame also counts"
    );
    Some(FileProblem::file(text).hint("lay it over a background first, or save it without alpha"))
}

/// Replaces infinite and NaN values of light by 0. Negative values stay, because colors outside sRGB have them.
pub(super) fn finite(value: f32) -> f32 {
    if value.is_finite() { value } else { 0.0 }
}

/// Replaces negative, infinite and NaN values by 0, for quantities that cannot be negative (alpha, codes).
pub(super) fn positive(value: f32) -> f32 {
    finite(value).max(0.0)
}
