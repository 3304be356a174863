//! `kind: jpeg`: finished pictures as JPEG files.

use crate::screen::{Screen, Space};
use schemars::JsonSchema;
use serde::Deserialize;
use spectra_core::frame::ExtraRequest;
use spectra_core::params::{Faults, Params, Whole};
use spectra_core::registry::Context;
use spectra_core::sink::{Out, WriteFault};
use spectra_core::stage::Film;
use spectra_pictures::write::jpeg;
use spectra_scene::{FileContent, Output, Shot};

/// The picture as a JPEG file, to share.
///
/// 8 bits per channel in sRGB, with full color resolution and an ICC profile. Several films side by side get a file each. A JPEG loses a
/// little quality each time it is saved: keep a `png`, `tiff` or `exr` for further work.
///
/// # Example
/// ```yaml
/// {kind: jpeg}
/// ```
/// ```yaml
/// {kind: jpeg, quality: 85, space: display-p3}
/// ```
///
/// # References
/// - ITU-T T.81, Digital compression and coding of continuous-tone still images.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
struct JpegParams {
    /// Quality from 1 (small and coarse) to 100; 95 if absent.
    #[serde(default = "fine")]
    quality: Whole<1, 100>,
    /// Color space of the file: `srgb` (the default), `display-p3`, or `rec2020` (its primaries with the curve of sRGB).
    #[serde(default)]
    space: Space,
    /// Whether pixels that are not square, because of an anamorphic lens with a `squeeze` or of the imager, are made square.
    #[serde(default)]
    desqueeze: bool,
}

fn fine() -> Whole<1, 100> {
    Whole::known(95)
}

spectra_core::register!(spectra_scene::OutputEntry, "jpeg": JpegParams, build);

struct Jpeg {
    quality: u8,
    screen: Screen,
}

fn build(params: &Params, _: &Context<'_>) -> Result<Box<dyn Output>, Faults> {
    let JpegParams { quality, space, desqueeze } = params.parse()?;
    if space == Space::AcesCct {
        let fault = params.fault("space", "8 bits are too few for a logarithmic space");
        return Err(fault.hint("write `srgb`, `display-p3` or `rec2020`; or `kind: tiff`, which has 16").into());
    }
    // The quality is at most 100, so it fits.
    Ok(Box::new(Jpeg { quality: quality.get() as u8, screen: Screen { space, desqueeze } }))
}

impl Output for Jpeg {
    fn kind(&self) -> &'static str {
        "jpeg"
    }

    fn ending(&self) -> [&'static str; 2] {
        ["", ".jpg"]
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
        let (picture, space, _) = self.screen.of(shot, film)?;
        jpeg(out, &picture, space, self.quality)
    }
}
