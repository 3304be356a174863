//! `kind: picture`: a picture file on a plane at a distance, or with the depth that it states.

pub(crate) mod decode;
mod deep;
mod depth;
mod encoding;
mod exr;
#[cfg(test)]
mod exr_tests;
mod field;
mod foreign;
#[cfg(all(test, feature = "oiio"))]
mod foreign_tests;
mod highlights;
pub(crate) mod linear;
pub(crate) mod map;

use crate::flat::Flat;
use crate::white;
use deep::DeepPicture;
use depth::Depth;
use field::HeightField;
use linear::{Choice, Linear, Trouble};
use map::{Importance, PictureMap};
use schemars::JsonSchema;
use serde::Deserialize;
use spectra_core::params::{Fault, Faults, Length, Luminance, Params, Positive, Quantity, StageNode};
use spectra_core::registry::{Context, StageOf, build as build_stage};
use spectra_core::resources::{Resource, ResourceError};
use spectra_core::spectral::SpectralPower;
use spectra_core::stage::{ColorModel, Source};
use std::sync::Arc;

/// Largest picture file, bytes.
const MAX_BYTES: u64 = 1 << 30;

/// A picture file (EXR, PNG, JPEG, TIFF, HDR) on a plane at a distance.
///
/// The picture stands across the axis, upright and unmirrored as the photographer sees it, and shines as a Lambertian
/// surface. Integers of 8 and 16 bits are taken as sRGB-encoded (255 of 8 bits is 1), floating point as linear with the
/// primaries of sRGB; a value of 1 is white, of the stated luminance and with the chromaticity of the illuminant.
/// Between pixels light is interpolated, so that no mosaic is seen however near one looks.
///
/// With `depth` each pixel stands at its own distance, in the perspective of the camera that took the picture: what is
/// out of focus is blurred, and edges cover what lies behind them. Where a picture in depth was never seen, behind an
/// edge, there is nothing to show; `kind: layers` knows what is there.
///
/// # Example
/// ```yaml
/// {kind: picture, file: holiday.png, distance: 3 m, width: 4 m, illuminant: D55, luminance: 1000 cd/m2}
/// ```
/// ```yaml
/// kind: picture
/// file: still-life.exr
/// distance: 2 m
/// width: 1.2 m
/// depth: {unit: m, far: 10 m}
/// ```
/// ```yaml
/// kind: picture
/// file: holiday.png
/// distance: 3 m
/// width: 4 m
/// color: {kind: smooth}
/// recover-highlights: {stops: 4}
/// ```
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
struct PictureParams {
    /// An OpenEXR, PNG, JPEG, TIFF or Radiance HDR file, beside the scene; built with OpenImageIO any that it reads. At
    /// most 1 GiB.
    file: String,
    /// How code values are encoded: linear, srgb, rec709 or cineon; as the file says, or else srgb of integers and linear
    /// of floating point, if absent.
    transfer: Option<String>,
    /// The layer of an OpenEXR file; its plain R, G and B if absent.
    layer: Option<String>,
    /// Distance of its plane from the first vertex, mm if bare.
    distance: Positive<Length>,
    /// Width of the picture on that plane, mm if bare; the height follows.
    width: Positive<Length>,
    /// The light that white has the chromaticity of: the name of a spectrum, a file beside the scene, or an expression
    /// such as `blackbody:3200`.
    #[serde(default = "daylight")]
    illuminant: String,
    /// Luminance of white (255 of 8 bits, 1.0 of floating point), cd/m2 if bare.
    #[serde(default = "luminance")]
    luminance: Positive<Luminance>,
    /// How RGB becomes a spectrum: a color model; `primaries` if absent.
    #[schemars(with = "Option<StageOf<dyn ColorModel>>")]
    color: Option<StageNode>,
    /// How far each pixel stands, from a depth channel; all on the plane if absent.
    #[schemars(with = "Option<depth::DepthParams>")]
    depth: Option<StageNode>,
    /// Guesses the light of the clipped highlights of integer files; nothing is guessed if absent.
    recover_highlights: Option<RecoverParams>,
}

/// `recover-highlights`: see [`highlights`].
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
struct RecoverParams {
    /// Stops above white that the middle of a large highlight may reach, above 0 to 12: a clipped pixel d pixels inside
    /// of its highlight gets stops x d / (d + 4) of them.
    #[schemars(extend("exclusiveMinimum" = 0, "maximum" = 12))]
    stops: f64,
}

fn daylight() -> String {
    "D65".to_owned()
}

fn luminance() -> Positive<Luminance> {
    Positive::from_bare(100.0)
}

spectra_core::register!(source "picture": PictureParams, build);

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
    let said = p.depth.is_some();
    let depth = p.depth.as_ref().and_then(|node| faults.take(Depth::read(node)));
    let linear = resource.and_then(|file| {
        let choice = Choice {
            name: &p.file,
            transfer: p.transfer.as_deref(),
            layer: p.layer.as_deref(),
            depth: depth.as_ref().and_then(Depth::channel),
        };
        faults.take(decode::decode(&file.bytes, choice).map_err(|e| trouble(&p.file, &e, params)))
    });
    let linear = linear.and_then(|mut linear| {
        let Some(recover) = &p.recover_highlights else { return Some(linear) };
        let key = "recover-highlights";
        let Some(clipped_at) = linear.clipped_at else {
            let fault = params.fault(key, format!("`{}` holds floating point, which clips nothing", p.file));
            faults.push(fault.hint("leave `recover-highlights` out"));
            return None;
        };
        if !(recover.stops > 0.0 && recover.stops <= 12.0) {
            faults.push(params.fault(key, format!("{} stops", recover.stops)).hint("above 0, at most 12"));
            return None;
        }
        highlights::recover(&mut linear.rgb, linear.width as usize, clipped_at, recover.stops);
        Some(linear)
    });
    let model = light.and_then(|light| faults.take(color_model(p.color, &light, params, context)));
    let (width_mm, distance_mm) = (p.width.mm(), p.distance.mm());
    let deep = match (&linear, depth) {
        (Some(linear), Some(depth)) => {
            let plane_mm = distance_mm + depth.eye_mm;
            if plane_mm > 0.0 {
                let all = faults.take(depth.of(linear, plane_mm, width_mm, context));
                all.map(|all| (depth, plane_mm, all))
            } else {
                faults.push(params.fault("distance", "the center of projection lies behind the picture's plane"));
                None
            }
        }
        _ => None,
    };
    let parts = faults.into_result((linear, model))?;
    let (Some(linear), Some(model)) = parts else { return Err(Faults::new()) };
    let texture = assemble(&linear, &p.file, width_mm, model, p.luminance.cd_per_m2());
    if !said {
        return Ok(Box::new(Flat { texture, distance_mm }));
    }
    let Some((depth, plane_mm, all)) = deep else { return Err(Faults::new()) };
    let ends = all.iter().fold([f32::INFINITY, 0.0_f32], |[a, b], d| [a.min(*d), b.max(*d)]);
    Ok(Box::new(DeepPicture {
        field: HeightField::new(texture.width_px, texture.height_px, &all, depth.edge),
        map: texture,
        plane_mm,
        eye_mm: depth.eye_mm,
        nearest_mm: f64::from(ends[0]),
        farthest_mm: f64::from(ends[1]),
    }))
}

/// The color model under `color`, for this light.
pub(crate) fn color_model(
    color: Option<StageNode>,
    light: &SpectralPower,
    params: &Params,
    context: &Context<'_>,
) -> Result<Arc<dyn ColorModel>, Faults> {
    let color = color.map_or_else(|| Ok(params.nothing_said("color")), |node| node.params())?;
    build_stage::<dyn ColorModel>(&color, &Context { illuminant: Some(light), ..*context }).map(Arc::from)
}

/// A fault of a picture file, at the key that it belongs to.
pub(crate) fn trouble(file: &str, trouble: &Trouble, params: &Params) -> Fault {
    let named = trouble.key == "depth" && trouble.text.starts_with("the file has no depth channel");
    let key = match trouble.key {
        "depth" if named && params.get("channel").is_some() => "channel",
        "depth" if named && params.get("depth").is_some_and(|depth| depth.get("channel").is_some()) => "depth.channel",
        key => key,
    };
    let fault = params.fault(key, format!("picture `{file}`: {}", trouble.text));
    fault.hint(
        trouble.hint.as_deref().unwrap_or("is the file complete? Save it again as OpenEXR, PNG, JPEG, TIFF or HDR"),
    )
}

pub(crate) fn find(file: &str, params: &Params, context: &Context<'_>) -> Result<Resource, Fault> {
    context.resources.read(file, &["scenes"], &[], MAX_BYTES).map_err(|e| {
        let hint = match &e {
            ResourceError::NotFound(near) if !near.is_empty() => format!("did you mean `{}`?", near.join("` or `")),
            ResourceError::NotFound(_) if file.contains('\\') => "write `/` between folders and file".to_owned(),
            ResourceError::NotFound(_) => "paths are relative to the folder of the scene".to_owned(),
            _ => "OpenEXR, PNG, JPEG, TIFF and Radiance HDR files are read".to_owned(),
        };
        params.fault("file", format!("picture `{file}`: {e}")).hint(hint)
    })
}

/// Luminance weights of linear sRGB (IEC 61966-2-1): good enough to say where a picture is bright.
fn brightness([r, g, b]: [f32; 3]) -> f32 {
    0.2126 * r + 0.7152 * g + 0.0722 * b
}

pub(crate) fn assemble(
    linear: &Linear,
    name: &str,
    width_mm: f64,
    model: Arc<dyn ColorModel>,
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
        height_mm: width_mm * height as f64 / (width as f64 * linear.pixel_aspect),
        coefficients: linear.rgb.iter().map(|p| model.coefficients(p.map(f64::from))).collect(),
        mean: model.spectrum(mean).scaled(scale),
        peak_over_mean: if mean_brightness > 0.0 { f64::from(peak) / mean_brightness } else { 1.0 },
        importance: Importance::new(width, height, &bright),
        scale,
        model,
        name: name.to_owned(),
    }
}
