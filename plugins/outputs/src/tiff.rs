//! `kind: tiff`.

use schemars::JsonSchema;
use serde::Deserialize;
use spectra_core::params::{Faults, Params};
use spectra_core::registry::Context;
use spectra_core::sink::{Out, WriteFault};
use spectra_pictures::write::tiff16;
use spectra_scene::{Holds, Output, Shot};

/// The picture as TIFF with 16 bits a channel.
///
/// sRGB, uncompressed; of films side by side a file each. For photo editors: enough steps to lighten shadows without bands.
///
/// # Example
/// ```yaml
/// {kind: tiff}
/// ```
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
struct TiffParams {}

spectra_core::register!(spectra_scene::OutputEntry, "tiff": TiffParams, build);

struct Tiff;

fn build(params: &Params, _: &Context<'_>) -> Result<Box<dyn Output>, Faults> {
    params.parse::<TiffParams>().map(|_| Box::new(Tiff) as Box<dyn Output>)
}

impl Output for Tiff {
    fn kind(&self) -> &'static str {
        "tiff"
    }

    fn ending(&self) -> [&'static str; 2] {
        ["", ".tiff"]
    }

    fn holds(&self) -> Holds {
        Holds::Picture
    }

    fn write(&self, shot: &Shot<'_>, film: usize, out: &mut dyn Out) -> Result<(), WriteFault> {
        tiff16(out, shot.picture(film)?)
    }
}
