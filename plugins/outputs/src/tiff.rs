//! `kind: tiff`: finished pictures as TIFF files.

use crate::screen::{Screen, Space};
use schemars::JsonSchema;
use serde::Deserialize;
use spectra_core::frame::ExtraRequest;
use spectra_core::params::{Faults, Params};
use spectra_core::registry::Context;
use spectra_core::sink::{Out, WriteFault};
use spectra_core::stage::Film;
use spectra_pictures::write::tiff16;
use spectra_scene::{FileContent, Output, Shot};

/// The picture as a TIFF file with 16 bits per channel.
///
/// sRGB, uncompressed, with an ICC profile. Several films side by side get a file each. For photo editors: there are enough steps to
/// lighten shadows without banding. The scans `log`, `adx` and `density` write values that are not colors, and have no profile.
///
/// # Example
/// ```yaml
/// {kind: tiff}
/// ```
/// ```yaml
/// {kind: tiff, space: acescct}
/// ```
///
/// # References
/// - ICC.1:2022, Image technology colour management: architecture, profile format and data structure.
/// - Academy S-2016-001, ACEScct.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
struct TiffParams {
    /// Color space of the file: `srgb` (the default), `display-p3`, `rec2020` (its primaries with the curve of sRGB), or `acescct`, the
    /// logarithmic space of ACES, which holds light far beyond white.
    #[serde(default)]
    space: Space,
    /// Whether pixels that are not square, because of an anamorphic lens with a `squeeze` or of the imager, are made square.
    #[serde(default)]
    desqueeze: bool,
}

spectra_core::register!(spectra_scene::OutputEntry, "tiff": TiffParams, build);

struct Tiff(Screen);

fn build(params: &Params, _: &Context<'_>) -> Result<Box<dyn Output>, Faults> {
    let TiffParams { space, desqueeze } = params.parse()?;
    Ok(Box::new(Tiff(Screen { space, desqueeze })))
}

impl Output for Tiff {
    fn kind(&self) -> &'static str {
        "tiff"
    }

    fn ending(&self) -> [&'static str; 2] {
        ["", ".tiff"]
    }

    fn content(&self) -> FileContent {
        FileContent::Picture
    }

    fn check_film(&self, film: &dyn Film) -> Result<(), [String; 2]> {
        self.0.check_film(film)
    }

    fn extra_request(&self) -> ExtraRequest {
        self.0.wanted()
    }

    fn write(&self, shot: &Shot<'_>, film: usize, out: &mut dyn Out) -> Result<(), WriteFault> {
        let (picture, space, _) = self.0.of(shot, film)?;
        tiff16(out, &picture, space)
    }
}
