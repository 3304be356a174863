//! `kind: png`: finished pictures as PNG files.

use crate::screen::{Screen, Space};
use schemars::JsonSchema;
use serde::Deserialize;
use spectra_core::frame::ExtraRequest;
use spectra_core::params::{Faults, Params, Whole};
use spectra_core::registry::Context;
use spectra_core::sink::{Out, WriteFault};
use spectra_core::stage::Film;
use spectra_pictures::write::{png8, png16};
use spectra_scene::{FileContent, Output, Shot};

/// The picture as a PNG file.
///
/// 8 bits per channel in sRGB, which any viewer and web page shows. Several films side by side get a file each. The file states its colors:
/// by cICP, and for older programs by sRGB with gAMA and cHRM, or by an ICC profile. The scans `log`, `adx` and `density` write values that
/// are not colors, and are not tagged.
///
/// # Example
/// ```yaml
/// {kind: png}
/// ```
/// ```yaml
/// {kind: png, bits: 16, space: display-p3}
/// ```
///
/// # References
/// - W3C, Portable Network Graphics (PNG) Specification, third edition, 2025.
/// - ITU-T H.273, Coding-independent code points.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
struct PngParams {
    /// Bits per channel: 8 (the default) or 16.
    #[serde(default = "eight")]
    bits: Whole<8, 16>,
    /// Color space of the file: `srgb` (the default), `display-p3`, `rec2020` (its primaries with the curve of sRGB), or with 16 bits
    /// `acescct`, the logarithmic space of ACES, which holds light far beyond white.
    #[serde(default)]
    space: Space,
    /// Whether pixels that are not square, because of an anamorphic lens with a `squeeze` or of the imager, are made square. Otherwise the
    /// file only states their shape (pHYs), which few viewers respect.
    #[serde(default)]
    desqueeze: bool,
}

fn eight() -> Whole<8, 16> {
    Whole::known(8)
}

spectra_core::register!(spectra_scene::OutputEntry, "png": PngParams, build);

struct Png {
    is_deep: bool,
    screen: Screen,
}

fn build(params: &Params, _: &Context<'_>) -> Result<Box<dyn Output>, Faults> {
    let PngParams { bits, space, desqueeze } = params.parse()?;
    let bits = bits.get();
    if !matches!(bits, 8 | 16) {
        return Err(params
            .fault("bits", format!("a PNG cannot have {bits} bits per channel"))
            .hint("write `bits: 8` or `bits: 16`")
            .into());
    }
    if space == Space::AcesCct && bits == 8 {
        let fault = params.fault("space", "8 bits are too few for a logarithmic space");
        return Err(fault.hint("also write `bits: 16`").into());
    }
    Ok(Box::new(Png { is_deep: bits == 16, screen: Screen { space, desqueeze } }))
}

impl Output for Png {
    fn kind(&self) -> &'static str {
        "png"
    }

    fn ending(&self) -> [&'static str; 2] {
        ["", ".png"]
    }

    fn content(&self) -> FileContent {
        FileContent::Picture
    }

    fn check_film(&self, film: &dyn Film) -> Result<(), [String; 2]> {
        self.screen.check_film(film)
    }

    fn extra_request(&self) -> ExtraRequest {
        self.screen.wanted()
    }

    fn write(&self, shot: &Shot<'_>, film: usize, out: &mut dyn Out) -> Result<(), WriteFault> {
        let (picture, space, aspect) = self.screen.of(shot, film)?;
        let write = if self.is_deep { png16 } else { png8 };
        write(out, &picture, space, aspect)
    }
}
