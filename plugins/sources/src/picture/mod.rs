//! `kind: picture`: a picture file on a plane at a distance.

mod decode;
mod map;

use crate::flat::Flat;
use crate::white;
use decode::Linear;
use map::{Importance, PictureMap};
use serde::Deserialize;
use spectra_core::params::{Fault, Faults, Length, Luminance, Params, Positive, Quantity, StageNode};
use spectra_core::registry::{Context, SourceEntry, build as build_stage};
use spectra_core::resources::{Resource, ResourceError};
use spectra_core::stage::{ColorModel, Source};

/// Largest picture file, bytes.
const MAX_BYTES: u64 = 1 << 30;

/// Parameters of `kind: picture`.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
struct PictureParams {
    /// A PNG, JPEG, TIFF or Radiance HDR file, beside the scene.
    file: String,
    /// Distance of its plane from the first vertex, mm if bare.
    distance: Positive<Length>,
    /// Width of the picture on that plane, mm if bare; the height follows.
    width: Positive<Length>,
    /// The light that white has the chromaticity of.
    #[serde(default = "daylight")]
    illuminant: String,
    /// Luminance of white (255 of 8 bits, 1.0 of floating point), cd/m2 if bare.
    #[serde(default = "luminance")]
    luminance: Positive<Luminance>,
    /// How RGB becomes a spectrum; the registry's default if absent.
    color: Option<StageNode>,
}

fn daylight() -> String {
    "D65".to_owned()
}

fn luminance() -> Positive<Luminance> {
    Positive::from_bare(100.0)
}

inventory::submit! {
    SourceEntry::new(
        "picture",
        "A picture file (PNG, JPEG, TIFF, HDR) on a plane at a distance.",
        env!("CARGO_PKG_NAME"),
        env!("CARGO_PKG_VERSION"),
        build,
    )
}

fn build(params: &Params, context: &Context<'_>) -> Result<Box<dyn Source>, Faults> {
    let mut faults = Faults::new();
    let Some(p) = faults.take(params.parse::<PictureParams>()) else {
        // Whatever else is wrong, a missing picture is said in the same go.
        if let Some(file) = params.get("file").and_then(|node| node.as_str()) {
            faults.take(find(file, params, context));
        }
        return Err(faults);
    };
    let light = faults.take(white::illuminant(&p.illuminant, params, context));
    let resource = faults.take(find(&p.file, params, context));
    let linear = resource.and_then(|file| {
        faults.take(decode::decode(&file.bytes).map_err(|e| params.fault("file", format!("picture `{}`: {e}", p.file))))
    });
    let model = light.and_then(|light| {
        let color = p.color.map_or_else(|| Ok(params.nothing_said("color")), |node| node.params());
        let inner = Context { illuminant: Some(&light), ..*context };
        faults.take(color.and_then(|color| build_stage::<dyn ColorModel>(&color, &inner)))
    });
    let parts = faults.into_result((linear, model))?;
    let (Some(linear), Some(model)) = parts else { return Err(Faults::new()) };
    let texture = assemble(&linear, &p.file, p.width.mm(), model, p.luminance.cd_per_m2());
    Ok(Box::new(Flat { texture, distance_mm: p.distance.mm() }))
}

fn find(file: &str, params: &Params, context: &Context<'_>) -> Result<Resource, Fault> {
    context.resources.read(file, &[], &[], MAX_BYTES).map_err(|e| {
        let hint = match &e {
            ResourceError::NotFound(near) if !near.is_empty() => format!("did you mean `{}`?", near.join("` or `")),
            ResourceError::NotFound(_) => "paths are relative to the folder of the scene".to_owned(),
            _ => "PNG, JPEG, TIFF and Radiance HDR files are read".to_owned(),
        };
        params.fault("file", format!("picture `{file}`: {e}")).hint(hint)
    })
}

/// Luminance weights of linear sRGB (IEC 61966-2-1): good enough to say where a picture is bright.
fn brightness([r, g, b]: [f32; 3]) -> f32 {
    0.2126 * r + 0.7152 * g + 0.0722 * b
}

fn assemble(
    linear: &Linear,
    name: &str,
    width_mm: f64,
    model: Box<dyn ColorModel>,
    luminance_cd_m2: f64,
) -> PictureMap {
    let (width, height) = (linear.width as usize, linear.height as usize);
    let scale = luminance_cd_m2 / white::luminance_cd_m2(&model.spectrum([1.0; 3]));
    let bright: Vec<f32> = linear.rgb.iter().map(|p| brightness(*p)).collect();
    let pixels = linear.rgb.len() as f64;
    let mut mean = [0.0_f64; 3];
    for pixel in &linear.rgb {
        for (sum, value) in mean.iter_mut().zip(pixel) {
            *sum += f64::from(*value) / pixels;
        }
    }
    let mean_brightness = bright.iter().map(|b| f64::from(*b)).sum::<f64>() / pixels;
    let peak = bright.iter().fold(0.0_f32, |a, b| a.max(*b));
    PictureMap {
        width_px: width,
        height_px: height,
        width_mm,
        height_mm: width_mm * height as f64 / width as f64,
        coefficients: linear.rgb.iter().map(|p| model.coefficients(p.map(f64::from))).collect(),
        mean: model.spectrum(mean).scaled(scale),
        peak_over_mean: if mean_brightness > 0.0 { f64::from(peak) / mean_brightness } else { 1.0 },
        importance: Importance::new(width, height, &bright),
        scale,
        model,
        name: name.to_owned(),
    }
}
