//! `kind: png`.

use schemars::JsonSchema;
use serde::Deserialize;
use spectra_core::params::{Faults, Params};
use spectra_core::registry::Context;
use spectra_core::sink::{Out, WriteFault};
use spectra_pictures::write::png8;
use spectra_scene::{Holds, Output, Shot};

/// The picture as PNG.
///
/// 8 bits a channel in sRGB, as any viewer and web page shows it; of films side by side a file each. For grading take `tiff`, for numbers
/// `exr`.
///
/// # Example
/// ```yaml
/// {kind: png}
/// ```
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
struct PngParams {}

spectra_core::register!(spectra_scene::OutputEntry, "png": PngParams, build);

struct Png;

fn build(params: &Params, _: &Context<'_>) -> Result<Box<dyn Output>, Faults> {
    params.parse::<PngParams>().map(|_| Box::new(Png) as Box<dyn Output>)
}

impl Output for Png {
    fn kind(&self) -> &'static str {
        "png"
    }

    fn ending(&self) -> [&'static str; 2] {
        ["", ".png"]
    }

    fn holds(&self) -> Holds {
        Holds::Picture
    }

    fn write(&self, shot: &Shot<'_>, film: usize, out: &mut dyn Out) -> Result<(), WriteFault> {
        png8(out, shot.picture(film)?, shot.pixel_aspect())
    }
}
