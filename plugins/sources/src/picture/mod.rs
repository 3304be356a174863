//! `kind: picture`: a picture file on a plane at a distance, or with the depth of each pixel.

mod backdrop;
mod bounds;
mod deep;
mod depth;
mod edges;
mod emitted;
mod gamut;
mod height_field;
mod highlights;
mod light_sampler;
pub(crate) mod lights;
mod narrowing;
mod pending_picture;
mod picture_file;
pub(crate) mod picture_texture;
mod pixel_quad;
mod planes;
mod settings;
mod starts;
mod tone;

use crate::deferred_source::DeferredSource;
use crate::frame::{Edge, PlanePlacement, Width};
use crate::plane_source::PlaneSource;
use crate::white;
use depth::Depth;
use pending_picture::PendingPicture;
pub(crate) use picture_file::{PictureFile, find};
use schemars::JsonSchema;
use serde::Deserialize;
pub(crate) use settings::{PictureSettings, color_model};
use spectra_core::frame_view::FrameView;
use spectra_core::params::{Deferred, Faults, Length, Luminance, Params, Positive, Quantity};
use spectra_core::registry::{Context, StageOf};
use spectra_core::stage::{ColorModel, Source};
use spectra_pictures::read::Header;
use std::sync::Arc;
use tone::Tone;

/// A picture file (EXR, PNG, JPEG, TIFF, WebP, BMP, HDR) on a plane at a distance.
///
/// The picture is perpendicular to the axis, upright and unmirrored as the photographer sees it, and emits light as a Lambertian
/// surface. A file may state its colors (by cICP, a color profile of three primaries, gAMA and cHRM, or chromaticities). Otherwise
/// integers of 8 and 16 bits are taken as sRGB-encoded (255 of 8 bits is 1) and floating point as linear with the primaries of sRGB. A
/// value of 1 is white, with the given luminance and the chromaticity of the illuminant. Light is interpolated between pixels, so that
/// no mosaic is seen at any magnification.
///
/// With `depth` each pixel has its own distance, in the perspective of the camera that took the picture: what is out of focus is
/// blurred, and edges cover what lies behind them. A single picture does not show what is hidden behind an edge, so the background is
/// continued there; use `kind: layers` if you have the hidden parts.
///
/// A renderer averages color over a pixel, so the pixels on an edge contain light of two objects but only one depth. These pixels are
/// separated: the near object covers its fraction of the pixel, and the background continues behind it. `depth: {edges: as-is}` leaves
/// them unchanged.
///
/// # Example
/// ```yaml
/// {kind: picture, file: holiday.png, distance: 3 m, width: fill, illuminant: D55, luminance: 1000 cd/m2}
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
    /// OpenEXR, PNG, JPEG, TIFF, WebP, BMP or Radiance HDR file beside the scene, or any other that OpenImageIO reads if `spectra` was
    /// built with it. At most 1 GiB.
    file: String,
    /// Encoding of the code values: `linear`, `srgb`, `rec709` or `cineon`. If left out, the encoding that the file states is used, or
    /// else `srgb` for integers and `linear` for floating point.
    transfer: Option<String>,
    /// Tone curve that was applied to the light before it was encoded: `camera`, which is undone channel by channel (18 % gray stays, and
    /// white lies 2.96 stops above it), or `none`. Only for integers that are encoded for a display. `none` if left out, but `camera` for
    /// such files in `spectra film develop`.
    tone: Option<Tone>,
    /// Layer of an OpenEXR file; its plain R, G and B if left out.
    layer: Option<String>,
    /// Distance of the picture from the first vertex, mm if bare.
    distance: Positive<Length>,
    /// Width of the picture on that plane, mm if bare; the height follows. Overscan of an OpenEXR file (its data window beyond the display
    /// window) lies outside this width. `fill` makes the picture 2 % wider than what the frame sees there through this lens, so that no
    /// border shows; parts that do not fit into the shape of the frame are cut off.
    width: Width,
    /// Light beyond the picture: `black` (none), `clamp` (continues the color of the border) or `mirror` (mirrors the picture). `black` if
    /// left out, with a warning if the frame sees it. With `clamp` and `mirror` light is traced backward only.
    edge: Option<Edge>,
    /// Light whose chromaticity is white: the name of a spectrum, a file beside the scene, or an expression such as
    /// `blackbody:3200`.
    #[serde(default = "daylight")]
    illuminant: String,
    /// Luminance of white (255 of 8 bits, 1.0 of floating point), cd/m2 if bare.
    #[serde(default = "luminance")]
    luminance: Positive<Luminance>,
    /// Color model that turns RGB into a spectrum; `smooth` if left out.
    color: Option<Deferred<StageOf<dyn ColorModel>>>,
    /// Distance of each pixel, from a depth channel; all pixels lie on the plane if left out.
    depth: Option<Deferred<depth::DepthParams>>,
    /// Estimates the light of clipped highlights in integer files; they stay clipped if left out.
    recover_highlights: Option<RecoverParams>,
}

/// `recover-highlights` as written in a scene: see [`highlights`].
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
struct RecoverParams {
    /// Number of stops above white that the center of a large highlight can approach, above 0 to 12. A clipped pixel d pixels
    /// inside its highlight gets stops x d / (d + 4).
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
        // Whatever else is wrong, a missing picture is reported at the same time.
        if let Some(file) = params.get("file").and_then(|node| node.as_str()) {
            faults.take(find(file, params, context));
        }
        return Err(faults);
    };
    let light = faults.take(white::illuminant(&p.illuminant, params, context));
    let found = faults.take(find(&p.file, params, context));
    let depth = p.depth.as_ref().and_then(|node| faults.take(Depth::read(node, context)));
    let edge = p.edge.unwrap_or_default();
    if p.depth.is_some() && edge != Edge::Black {
        let fault = params.fault("edge", "a picture with `depth` has no depth beyond its border");
        faults.push(fault.hint("remove `edge`, and write a `width` that fills the frame"));
    }
    let file = found.map(|found| PictureFile {
        found,
        name: p.file.clone(),
        transfer: p.transfer.clone(),
        layer: p.layer.clone(),
        cover: false,
        depth: depth.as_ref().and_then(Depth::channel).map(str::to_owned),
        params: params.clone(),
    });
    let header = file.as_ref().and_then(|file| faults.take(file.header()));
    let overscan = header.as_ref().map_or([0; 2], |header| usable_overscan(header, depth.as_ref(), params, context));
    faults.extend(header.as_ref().map(|header| header_faults(header, &p, params)).unwrap_or_default());
    let model = light.and_then(|light| faults.take(color_model(p.color, &light, params, context)));
    let distance_mm = p.distance.mm();
    let aspect = header.as_ref().map_or(1.0, Header::aspect);
    // With depth, too, `width` is the width on the plane, as seen from the picture's center of projection.
    let width_mm = faults.take(p.width.mm(aspect, distance_mm, [0.0; 2], context.view, params));
    if depth.as_ref().is_some_and(|depth| distance_mm + depth.eye_mm <= 0.0) {
        faults.push(params.fault("distance", "the center of projection lies behind the picture's plane"));
    }
    let (Some(file), Some(header), Some(model), Some(shown_mm)) =
        faults.into_result((file, header, model, width_mm))?
    else {
        return Err(Faults::new());
    };
    let width_mm = shown_mm * header.widened(overscan);
    let aspect = header.aspect_with(overscan);
    let placed = PlanePlacement { width_mm, height_mm: width_mm / aspect, distance_mm, center_mm: [0.0; 2] };
    if p.width.is_fill() {
        placed.warn_of_fisheye("the picture", params, context);
    } else if p.edge.is_none() {
        placed.warn_unless_filled("the picture", params, context);
    }
    file.warn(&header, context);
    let settings = PictureSettings { model, width_mm, luminance_cd_m2: p.luminance.cd_per_m2(), edge };
    let stand_in = PlaneSource { texture: settings.white(aspect, &file.name), distance_mm };
    let picture = Arc::new(PendingPicture {
        file,
        settings,
        tone: p.tone.unwrap_or_default(),
        recover_stops: p.recover_highlights.map(|recover| recover.stops),
        distance_mm,
        overscan,
        depth,
        focal_length_mm: context.view.and_then(FrameView::focal_length_mm),
    });
    let reader = Arc::clone(&picture);
    let lazy = DeferredSource::new(Box::new(stand_in), picture.emits(), move || reader.source());
    let lazy = lazy.of_picture(tone::MID_GRAY, header.clips);
    Ok(Box::new(if picture.depth.is_none() { lazy.with_still(move || picture.still()) } else { lazy }))
}

/// Returns the overscan that both the picture and its depth file have, and warns if that is not all of the picture's.
fn usable_overscan(header: &Header, depth: Option<&Depth>, params: &Params, context: &Context<'_>) -> [u32; 2] {
    let overscan = depth.map_or(header.overscan, |depth| depth.overscan(header.overscan));
    if header.overscan != overscan {
        let [own, used] = [header.overscan, overscan].map(|[x, y]| format!("{x} x {y}"));
        let text =
            format!("the picture has {own} pixels of overscan on each side, but its depth has fewer: {used} are used");
        context.warn(params.fault("depth", text).hint("render depth with the same overscan as the picture"));
    }
    overscan
}

/// Returns the faults of keys that do not suit the code values of the file.
fn header_faults(header: &Header, p: &PictureParams, params: &Params) -> Faults {
    let mut faults = Faults::new();
    if p.recover_highlights.is_some() && !header.clips {
        let text = format!("`{}` holds floating-point values, which are not clipped", p.file);
        faults.push(params.fault("recover-highlights", text).hint("remove `recover-highlights`"));
    }
    if p.tone == Some(Tone::Camera) && !header.is_for_display {
        let holds = if header.clips { "light or its logarithm" } else { "floating point" };
        let fault = params.fault("tone", format!("`{}` holds {holds}, which has no camera tone curve", p.file));
        faults.push(fault.hint("remove `tone`"));
    }
    faults
}
