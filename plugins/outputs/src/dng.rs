//! `kind: dng`: raw files of a sensor, as DNG.

use schemars::JsonSchema;
use serde::Deserialize;
use spectra_core::params::{Faults, Params};
use spectra_core::registry::Context;
use spectra_core::sink::{Out, WriteFault};
use spectra_core::stage::{Digitize, Imager};
use spectra_pictures::write::{RawLens, dng};
use spectra_scene::{FileContent, Output, Scene, Shot};

/// The raw numbers of a sensor, as converted from analog to digital, as a DNG file.
///
/// For raw converters: the file holds the mosaic, black and white level, color matrices for two illuminants, the noise profile and the
/// exposure. Only an imager with an A/D converter (`imager: {kind: sensor, ...}`) has such numbers.
///
/// # Example
/// ```yaml
/// {kind: dng}
/// ```
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
struct DngParams {}

spectra_core::register!(spectra_scene::OutputEntry, "dng": DngParams, build);

struct Dng;

fn build(params: &Params, _: &Context<'_>) -> Result<Box<dyn Output>, Faults> {
    params.parse::<DngParams>().map(|_| Box::new(Dng) as Box<dyn Output>)
}

/// Message about an imager without raw numbers.
const WITHOUT: &str = "this imager has no A/D converter, so there is no raw data";

impl Output for Dng {
    fn kind(&self) -> &'static str {
        "dng"
    }

    fn ending(&self) -> [&'static str; 2] {
        ["", ".dng"]
    }

    fn content(&self) -> FileContent {
        FileContent::Numbers
    }

    fn check(&self, imager: &dyn Imager) -> Result<(), [String; 2]> {
        let hint = "use `imager: {kind: sensor, ...}`, or leave out `dng`";
        converter(imager).map(drop).ok_or_else(|| [WITHOUT.to_owned(), hint.to_owned()])
    }

    fn write(&self, shot: &Shot<'_>, _: usize, out: &mut dyn Out) -> Result<(), WriteFault> {
        let converter = converter(&*shot.scene.imager).ok_or_else(|| WriteFault::Format(WITHOUT.to_owned()))?;
        dng(out, &converter.raw(shot.exposure), &lens(shot.scene))
    }
}

fn converter(imager: &dyn Imager) -> Option<&dyn Digitize> {
    imager.response()?.digitize()
}

/// Returns the lens as a raw file names it, with focal length and f-number as currently set.
fn lens(scene: &Scene) -> RawLens {
    let lens = &scene.lens;
    RawLens {
        model: Some(lens.name.clone()),
        maker: lens.maker.clone(),
        focal_length_mm: Some(lens.first_order(lens.reference_nm).efl_mm.abs()),
        f_number: lens.marginal_ray().ok().map(|ray| ray.f_number()),
    }
}
