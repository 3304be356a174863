//! A picture in linear light, and what can be wrong with a picture file.

/// Largest side of a picture, pixels.
pub(super) const MAX_SIDE: u32 = 65_535;
/// Largest picture, pixels: as linear light it takes 12 bytes each.
pub(super) const MAX_PIXELS: u64 = 120_000_000;

/// A picture in linear light, sRGB primaries, upright, row by row from the top.
#[derive(Clone, Debug, PartialEq)]
pub struct Linear {
    /// Pixels across.
    pub width: u32,
    /// Pixels down.
    pub height: u32,
    /// Width over height of a pixel.
    pub pixel_aspect: f64,
    /// Light; where the picture is not opaque, times alpha. A color beyond sRGB has negative values.
    pub rgb: Vec<[f32; 3]>,
    /// Cover, 0 to 1; `None` where all of it is opaque, or none was asked for.
    pub alpha: Option<Vec<f32>>,
    /// The depth channel as the file has it, if one was asked for.
    pub depth: Option<Vec<f32>>,
    /// The code value from which on integers are clipped, in linear light; `None` for floating point.
    pub clipped_at: Option<f32>,
    /// What of its pixels a person should know before believing them.
    pub doubts: Vec<Trouble>,
}

/// What is known of a file, and chosen of one of several layers.
#[derive(Clone, Copy, Debug, Default)]
pub struct Choice<'a> {
    /// What the file is called: its ending tells formats that its content does not.
    pub name: &'a str,
    /// How its code values are encoded, by name; as the file says, or else as its format has it, if absent.
    pub transfer: Option<&'a str>,
    /// Whether cover is wanted beside light.
    pub cover: bool,
    /// The layer; the file's plain R, G, B if absent.
    pub layer: Option<&'a str>,
    /// The channel that holds depth, where depth is wanted.
    pub depth: Option<&'a str>,
    /// How many pixels beyond the picture are wanted on the left and the right, and above and below; at most as many as the header's
    /// `overscan`.
    pub overscan: [u32; 2],
    /// Whether its numbers are no light: no color space is followed, no cover multiplied in, and none is made finite.
    pub is_plain: bool,
}

/// What is wrong with a picture file, or doubtful in it.
#[derive(Clone, Debug, PartialEq)]
pub struct Trouble {
    /// The key whose value is to be changed: `file`, `layer`, `depth` or `transfer`.
    pub key: &'static str,
    /// What is wrong.
    pub text: String,
    /// What to do about it.
    pub hint: Option<String>,
}

impl Trouble {
    pub(super) fn file(text: impl Into<String>) -> Self {
        Self { key: "file", text: text.into(), hint: None }
    }

    pub(super) fn at(key: &'static str, text: impl Into<String>) -> Self {
        Self { key, text: text.into(), hint: None }
    }

    /// What to do about it, also where nothing but the file's bytes is to blame.
    #[must_use]
    pub fn advice(&self) -> &str {
        self.hint.as_deref().unwrap_or("is the file complete? Save it again as OpenEXR, PNG, JPEG, TIFF or HDR")
    }

    pub(super) fn hint(self, hint: impl Into<String>) -> Self {
        Self { hint: Some(hint.into()), ..self }
    }
}

/// Whether a picture of that size is read at all.
pub(super) fn check_size(width: u64, height: u64) -> Result<(), Trouble> {
    if width == 0 || height == 0 {
        return Err(Trouble::file("the picture has no pixels"));
    }
    if width > u64::from(MAX_SIDE) || height > u64::from(MAX_SIDE) || width * height > MAX_PIXELS {
        let text = format!("{width} x {height} pixels; at most {MAX_PIXELS} in all and {MAX_SIDE} a side are read");
        return Err(Trouble::file(text));
    }
    Ok(())
}

/// Makes light of values that are none, and says of how many pixels: an infinite value counts as the largest finite one of
/// the picture, or as white where that is more; a pixel with a value that is no number is black.
pub(super) fn mend(rgb: &mut [[f32; 3]]) -> Option<Trouble> {
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
        (undefined > 0).then(|| format!("{} with values that are no numbers, taken as black", pixels(undefined)));
    let all: Vec<String> = infinite.into_iter().chain(undefined).collect();
    let trouble = Trouble::file(format!("it has {}", all.join(", and ")));
    Some(trouble.hint("repair them in the program that wrote the file"))
}

/// Cover from which on a pixel counts as opaque: files of 16 bits do not always hold 1 to its last digit.
pub(super) const OPAQUE: f32 = 0.999;

/// What to say where `thin` of all pixels are not opaque and nothing is known of what lies behind them.
pub(super) fn over_black(thin: usize, pixels: usize) -> Option<Trouble> {
    if thin == 0 {
        return None;
    }
    let text = format!(
        "{thin} of its {pixels} pixels are not opaque: they are laid over black, which a meter of the whole frame counts, too"
    );
    Some(Trouble::file(text).hint("lay it over a background first, or save it without alpha"))
}

/// A value of light as the sources take it: infinite and undefined ones are none, negative ones belong to colors beyond sRGB.
pub(super) fn finite(value: f32) -> f32 {
    if value.is_finite() { value } else { 0.0 }
}

/// A value that cannot be negative, such as cover or a code: infinite and undefined ones are 0, too.
pub(super) fn positive(value: f32) -> f32 {
    finite(value).max(0.0)
}
