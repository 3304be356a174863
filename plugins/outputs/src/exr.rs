//! `kind: exr`.

use schemars::JsonSchema;
use serde::Deserialize;
use spectra_core::params::{Faults, Params};
use spectra_core::registry::Context;
use spectra_core::sink::{Out, WriteFault};
use spectra_pictures::library;
use spectra_pictures::write::{exr, tiled_exr};
use spectra_scene::{Holds, Output, Shot};

/// The linear exposure as OpenEXR: a channel for each that was recorded.
///
/// Nothing that was computed is lost in it: 32-bit floats in lux seconds (or what the channel's unit says), with the scene and how it was
/// rendered in the header. For compositing, for measuring, and to keep the light of a long render.
///
/// # Example
/// ```yaml
/// {kind: exr}
/// ```
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
struct ExrParams {
    /// In tiles, for viewers that read a part of a large file; needs a program built with OpenImageIO.
    #[serde(default)]
    tiled: bool,
}

spectra_core::register!(spectra_scene::OutputEntry, "exr": ExrParams, build);

struct Exr {
    tiled: bool,
}

fn build(params: &Params, _: &Context<'_>) -> Result<Box<dyn Output>, Faults> {
    let ExrParams { tiled } = params.parse()?;
    if tiled && library::library().is_none() {
        let fault = params.fault("tiled", "tiled OpenEXR files are written by OpenImageIO only");
        return Err(fault.hint(library::WITHOUT).into());
    }
    Ok(Box::new(Exr { tiled }))
}

impl Output for Exr {
    fn kind(&self) -> &'static str {
        "exr"
    }

    fn ending(&self) -> [&'static str; 2] {
        ["", ".exr"]
    }

    fn holds(&self) -> Holds {
        Holds::Light
    }

    fn write(&self, shot: &Shot<'_>, _: usize, out: &mut dyn Out) -> Result<(), WriteFault> {
        let write = if self.tiled { tiled_exr } else { exr };
        write(out, shot.exposure, &shot.gains(), shot.attributes)
    }
}
