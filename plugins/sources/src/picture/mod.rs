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
pub(crate) mod picture_texture;
mod pixel_quad;
mod planes;
mod starts;
mod tone;

use crate::deferred_source::DeferredSource;
use crate::frame::{Edge, PlanePlacement, Width};
use crate::plane_source::PlaneSource;
use crate::split_source::{LightPart, SplitSource};
use crate::white;
use backdrop::Backdrop;
use deep::DeepPicture;
use depth::Depth;
use edges::Mixed;
use height_field::HeightField;
use light_sampler::LightSampler;
use lights::Lights;
use picture_texture::{Importance, PictureTexture, are_lamps};
use planes::Pixels;
use schemars::JsonSchema;
use serde::Deserialize;
use spectra_core::frame_view::FrameView;
use spectra_core::params::{Deferred, Fault, Faults, Length, Luminance, Params, Positive, Quantity, Warning};
use spectra_core::registry::{Context, StageOf, build as build_stage};
use spectra_core::resources::{FoundFile, ResourceError};
use spectra_core::spectral::SpectralPower;
use spectra_core::stage::{ColorModel, Source, Still};
use spectra_pictures::read::{self, FileProblem, Header, LinearPicture, ReadOptions};
use std::sync::Arc;
use tone::CameraTone;

/// Size limit of a picture file, bytes.
const MAX_BYTES: u64 = 1 << 30;

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

/// `tone` as written in a scene.
#[derive(Clone, Copy, Debug, Default, Deserialize, JsonSchema, PartialEq, Eq)]
#[serde(rename_all = "kebab-case")]
enum Tone {
    /// The tone curve of a camera.
    Camera,
    /// No tone curve: values are proportional to light.
    #[default]
    None,
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
    // Use the overscan that both the picture and its depth file have.
    let overscan = header.as_ref().map_or([0; 2], |header| match &depth {
        Some(depth) => depth.overscan(header.overscan),
        None => header.overscan,
    });
    if let Some(header) = header.as_ref().filter(|header| header.overscan != overscan) {
        let [own, used] = [header.overscan, overscan].map(|[x, y]| format!("{x} x {y}"));
        let text =
            format!("the picture has {own} pixels of overscan on each side, but its depth has fewer: {used} are used");
        context.warn(params.fault("depth", text).hint("render depth with the same overscan as the picture"));
    }
    let recover_stops = p.recover_highlights.as_ref().map(|recover| recover.stops);
    if let (Some(_), Some(header)) = (recover_stops, &header) {
        let key = "recover-highlights";
        if !header.clips {
            let fault = params.fault(key, format!("`{}` holds floating-point values, which are not clipped", p.file));
            faults.push(fault.hint("remove `recover-highlights`"));
        }
    }
    let tone = p.tone.unwrap_or_default();
    if let (Tone::Camera, Some(header)) = (tone, header.as_ref().filter(|header| !header.is_for_display)) {
        let holds = if header.clips { "light or its logarithm" } else { "floating point" };
        let fault = params.fault("tone", format!("`{}` holds {holds}, which has no camera tone curve", p.file));
        faults.push(fault.hint("remove `tone`"));
    }
    let model = light.and_then(|light| faults.take(color_model(p.color, &light, params, context)));
    let distance_mm = p.distance.mm();
    let aspect = header.as_ref().map_or(1.0, Header::aspect);
    // With depth, too, `width` is the width on the plane, as seen from the picture's center of projection.
    let eye_mm = depth.as_ref().map_or(0.0, |depth| depth.eye_mm);
    let width_mm = faults.take(p.width.mm(aspect, distance_mm, [0.0; 2], context.view, params));
    if depth.is_some() && distance_mm + eye_mm <= 0.0 {
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
    let making = Arc::new(PictureSettings { model, width_mm, luminance_cd_m2: p.luminance.cd_per_m2(), edge });
    let stand_in = PlaneSource { texture: making.white(aspect, &file.name), distance_mm };
    let emits = edge == Edge::Black;
    let file = Arc::new(file);
    let is_flat = depth.is_none();
    let focal_length_mm = context.view.and_then(FrameView::focal_length_mm);
    let pixels = {
        let (file, making) = (Arc::clone(&file), Arc::clone(&making));
        move |overscan: [u32; 2]| -> Result<LinearPicture, Faults> {
            let mut linear = file.read(overscan)?;
            if tone == Tone::Camera {
                let curve = CameraTone::new();
                curve.take_back(&mut linear.rgb);
                linear.clipped_at = linear.clipped_at.map(|at| curve.value(at));
            }
            if let (Some(stops), Some(clipped_at)) = (recover_stops, linear.clipped_at) {
                highlights::recover(&mut linear.rgb, linear.width as usize, clipped_at, stops);
            }
            gamut::bring_in(&mut linear, &*making.model);
            Ok(linear)
        }
    };
    let still = {
        let (file, pixels, making) = (Arc::clone(&file), pixels.clone(), Arc::clone(&making));
        move || {
            pixels([0; 2]).map(|linear| {
                let doubts = file.warnings(&linear);
                (making.still(linear), doubts)
            })
        }
    };
    let lazy = DeferredSource::new(Box::new(stand_in), emits, move || {
        let mut linear = pixels(overscan)?;
        let mut doubts = file.warnings(&linear);
        let Some(depth) = &depth else {
            let map = making.map(linear, &file.name);
            return Ok((with_halves(map, emits, |texture| PlaneSource { texture, distance_mm }), doubts));
        };
        let plane_mm = distance_mm + depth.eye_mm;
        let mut all = depth.of(&linear, plane_mm, width_mm, overscan)?;
        let size_px = [linear.width, linear.height];
        let pixels = Pixels { size_px, aspect: linear.pixel_aspect, pixel_mm: width_mm / f64::from(linear.width) };
        doubts.extend(
            depth.scale_warning(&all, plane_mm, focal_length_mm).or_else(|| depth.kind_warning(&all, plane_mm, pixels)),
        );
        // The raw depths of the picture are no longer needed.
        linear.depth = None;
        let width_px = linear.width as usize;
        let mixed = match depth.cleans_edges {
            true => edges::part(&mut linear.rgb, &mut all, width_px, depth.edge),
            false => None,
        };
        let meaning: Arc<str> = depth.describe(all.len(), mixed.as_ref()).into();
        let map = assemble(linear, &file.name, &making, mixed.as_ref());
        let behind = mixed.map(|mixed| Arc::new(Backdrop::new(mixed, &*making.model, &all, width_px, depth.edge)));
        let ends = all.iter().fold([f32::INFINITY, 0.0_f32], |[a, b], d| [a.min(*d), b.max(*d)]);
        let field = Arc::new(HeightField::new(map.width_px, map.height_px, &all, depth.edge));
        let eye_mm = depth.eye_mm;
        let ends_mm = ends.map(f64::from);
        let deep = |map| {
            let fields = (Arc::clone(&field), behind.clone());
            DeepPicture::new(map, fields, plane_mm, eye_mm, ends_mm, Arc::clone(&meaning))
        };
        Ok((with_halves(map, emits, deep), doubts))
    });
    let lazy = lazy.of_picture(tone::MID_GRAY, header.clips);
    Ok(Box::new(if is_flat { lazy.with_still(still) } else { lazy }))
}

/// Makes the source of a picture. If the picture has lights and may emit, the source also has a part with the lights and one with the
/// rest.
fn with_halves<S: Source + 'static>(
    map: PictureTexture,
    emits: bool,
    make: impl Fn(PictureTexture) -> S,
) -> Box<dyn Source> {
    let Some(pays) = map.lights.as_ref().filter(|_| emits).map(|lights| lights.pays) else {
        return Box::new(make(map));
    };
    let [lights, rest] = [LightPart::Lights, LightPart::Rest].map(|half| make(map.half(half)));
    Box::new(SplitSource { lights, rest, whole: make(map), pays })
}

/// A picture file that was found, with its keys in the scene.
pub(crate) struct PictureFile {
    pub found: FoundFile,
    pub name: String,
    pub transfer: Option<String>,
    pub layer: Option<String>,
    /// Whether to read alpha, too.
    pub cover: bool,
    /// The depth channel; `None` if depth is not read from this file.
    pub depth: Option<String>,
    /// Parameters that hold the keys of this file.
    pub params: Params,
}

impl PictureFile {
    fn choice(&self) -> ReadOptions<'_> {
        ReadOptions {
            name: &self.name,
            transfer: self.transfer.as_deref(),
            alpha: self.cover,
            layer: self.layer.as_deref(),
            depth: self.depth.as_deref(),
            overscan: [0; 2],
            is_plain: false,
        }
    }

    /// Reads the header of the file.
    pub(crate) fn header(&self) -> Result<Header, Faults> {
        read::header(&self.found, self.choice()).map_err(|e| trouble(&self.name, &e, &self.params).into())
    }

    /// Reads the file in linear light, with this many pixels of its overscan on each side.
    fn read(&self, overscan: [u32; 2]) -> Result<LinearPicture, Faults> {
        read::decode(&self.found, ReadOptions { overscan, ..self.choice() })
            .map_err(|e| trouble(&self.name, &e, &self.params).into())
    }

    /// Returns the warnings about the pixels of the file.
    pub(crate) fn warnings(&self, linear: &LinearPicture) -> Vec<Warning> {
        linear.warnings.iter().map(|doubt| trouble(&self.name, doubt, &self.params).into()).collect()
    }

    /// Reports the warnings about the header, and warns of a photograph whose code values are taken as light.
    pub(crate) fn warn(&self, header: &Header, context: &Context<'_>) {
        header.warnings.iter().for_each(|doubt| context.warn(trouble(&self.name, doubt, &self.params)));
        if header.is_jpeg && self.transfer.as_deref() == Some("linear") {
            let text =
                format!("`{}` is a JPEG, whose code values are sRGB: as linear light it is far too pale", self.name);
            context.warn(self.params.fault("transfer", text).hint("leave `transfer` out"));
        }
    }
}

/// Parameters that turn the pixels of a picture into light.
pub(crate) struct PictureSettings {
    pub model: Arc<dyn ColorModel>,
    pub width_mm: f64,
    pub luminance_cd_m2: f64,
    pub edge: Edge,
}

impl PictureSettings {
    /// Reads a file, with colors moved into the gamut of the color model.
    pub(crate) fn read(&self, file: &PictureFile, overscan: [u32; 2]) -> Result<LinearPicture, Faults> {
        let mut linear = file.read(overscan)?;
        gamut::bring_in(&mut linear, &*self.model);
        Ok(linear)
    }

    /// Returns a white picture with this ratio of width to height.
    pub(crate) fn white(&self, aspect: f64, name: &str) -> PictureTexture {
        let pixel = LinearPicture {
            width: 1,
            height: 1,
            pixel_aspect: aspect,
            rgb: vec![[1.0; 3]],
            alpha: None,
            depth: None,
            clipped_at: None,
            warnings: Vec::new(),
        };
        self.map(pixel, name)
    }

    /// Returns the factor that gives the model's white the luminance of white.
    fn scale(&self) -> f64 {
        self.luminance_cd_m2 / white::luminance_cd_m2(&self.model.spectrum([1.0; 3]))
    }

    /// Returns the pixels of the picture, for exposing film without a lens.
    fn still(&self, linear: LinearPicture) -> Still {
        let LinearPicture { width, height, pixel_aspect, rgb, .. } = linear;
        let (model, scale) = (Arc::clone(&self.model), self.scale());
        Still { width_px: width, height_px: height, pixel_aspect, rgb, model, scale }
    }

    /// Returns the picture on its plane. Its pixels are replaced in place by the coefficients of the color model.
    pub(crate) fn map(&self, linear: LinearPicture, name: &str) -> PictureTexture {
        assemble(linear, name, self, None)
    }
}

/// Builds the color model under `color`, for this light.
pub(crate) fn color_model(
    color: Option<Deferred<StageOf<dyn ColorModel>>>,
    light: &SpectralPower,
    params: &Params,
    context: &Context<'_>,
) -> Result<Arc<dyn ColorModel>, Faults> {
    let color = color.map_or_else(|| Ok(params.default_stage("color")), |node| node.params())?;
    build_stage::<dyn ColorModel>(&color, &Context { illuminant: Some(light), ..*context }).map(Arc::from)
}

/// Returns the fault of a picture file, at the key to which it belongs.
pub(crate) fn trouble(file: &str, trouble: &FileProblem, params: &Params) -> Fault {
    let named = trouble.key == "depth" && trouble.text.starts_with("the file has no depth channel");
    let key = match trouble.key {
        "depth" if named && params.get("channel").is_some() => "channel",
        "depth" if named && params.get("depth").is_some_and(|depth| depth.get("channel").is_some()) => "depth.channel",
        key => key,
    };
    let fault = params.fault(key, format!("picture `{file}`: {}", trouble.text));
    fault.hint(trouble.advice())
}

/// Returns the hint for a numbered sequence of pictures: `plate.####.exr`, `plate.%04d.exr` or `plate.${frame}.exr`.
fn sequence_hint(file: &str) -> Option<String> {
    let from = file.find(['#', '%', '$', '*'])?;
    let (mark, behind) = file[from..].split_at(1);
    let rest = match mark {
        "%" => behind.split_once('d')?.1,
        "$" => behind.strip_prefix('{').and_then(|name| name.split_once('}')).map_or(behind, |(_, rest)| rest),
        _ => behind.trim_start_matches(mark),
    };
    let frame = |n: u32| format!("{}{n:04}{rest}", &file[..from]);
    Some(format!(
        "write a sequence as an animation with one picture per frame: `animation: {{frames: 2, animate: {{source.file: {{1: {}, 2: {}, \
         interpolation: hold}}}}}}`; `film develop` without a scene accepts a pattern with `####`",
        frame(1),
        frame(2)
    ))
}

pub(crate) fn find(file: &str, params: &Params, context: &Context<'_>) -> Result<FoundFile, Fault> {
    context.resources.find(file, &["scenes"], &[], MAX_BYTES).map_err(|e| {
        let sequence = if matches!(e, ResourceError::NotFound(_)) { sequence_hint(file) } else { None };
        let hint = sequence.unwrap_or_else(|| match &e {
            ResourceError::NotFound(near) if !near.is_empty() => format!("did you mean `{}`?", near.join("` or `")),
            ResourceError::NotFound(_) if file.contains('\\') => "write `/` between folders and file".to_owned(),
            ResourceError::NotFound(_) => "paths are relative to the folder of the scene".to_owned(),
            _ => "OpenEXR, PNG, JPEG, TIFF, WebP, BMP and Radiance HDR files are read".to_owned(),
        });
        params.fault("file", format!("picture `{file}`: {e}")).hint(hint)
    })
}

/// Returns the luminance by the weights of linear sRGB (IEC 61966-2-1), which is accurate enough to find where a picture is bright. Deep
/// violets and reds, which film sees better than the eye, count at least as much as the blue of sRGB, so that rays are drawn from them.
fn brightness([r, g, b]: [f32; 3]) -> f32 {
    (0.2126 * r + 0.7152 * g + 0.0722 * b).max(0.0721 * r.max(g).max(b))
}

/// Makes the map of a picture on its plane. `rgb` holds the front color of mixed pixels.
fn assemble(linear: LinearPicture, name: &str, making: &PictureSettings, mixed: Option<&Mixed>) -> PictureTexture {
    let (width, height) = (linear.width as usize, linear.height as usize);
    let model = &making.model;
    let scale = making.scale();
    let mut rgb = linear.rgb;
    let pixels = rgb.len() as f64;
    let behind = |cell: usize| mixed.and_then(|mixed| mixed.cells.place(cell).map(|place| &mixed.behind[place]));
    // The light of a whole pixel, and the brighter of its front and back, since either may be a light.
    let whole = |cell: usize| match behind(cell) {
        None => rgb[cell],
        Some(behind) => [0, 1, 2].map(|k| behind.rgb[k] + (rgb[cell][k] - behind.rgb[k]) * behind.opacity),
    };
    let bright = |cell: usize| {
        let front = brightness(rgb[cell]);
        behind(cell).map_or(front, |behind| front.max(brightness(behind.rgb)))
    };
    let mut mean = [0.0_f64; 3];
    for cell in 0..rgb.len() {
        for (sum, value) in mean.iter_mut().zip(whole(cell)) {
            *sum += f64::from(value) / pixels;
        }
    }
    let mean_brightness = (0..rgb.len()).map(|cell| f64::from(brightness(whole(cell)))).sum::<f64>() / pixels;
    let peak = (0..rgb.len()).fold(0.0_f32, |a, cell| a.max(bright(cell)));
    let importance = Arc::new(Importance::new(width, height, bright));
    let is_lamps = are_lamps(width, bright, rgb.len());
    let all = if f64::from(peak) > mean_brightness { (0..rgb.len()).map(bright).collect() } else { Vec::new() };
    let lights = if all.is_empty() { None } else { lights::find(width, &all) };
    let lights = lights.map(|found| {
        let mut sums = [[0.0_f64; 3]; 2];
        for (cell, level) in found.level.iter().enumerate() {
            let sum = &mut sums[usize::from(*level == 0.0)];
            sum.iter_mut().zip(whole(cell)).for_each(|(sum, value)| *sum += f64::from(value) / pixels);
        }
        Arc::new(Lights {
            places: LightSampler::new(width, &found.level, found.limit),
            touched: lights::touched(width, &found.level),
            level: found.level,
            mean: sums.map(|sum| model.spectrum(sum).scaled(scale)),
            peak_over_mean: found.peak_over_mean,
            pays: found.pays,
        })
    });
    for pixel in &mut rgb {
        *pixel = model.coefficients(pixel.map(f64::from));
    }
    PictureTexture {
        width_px: width,
        height_px: height,
        width_mm: making.width_mm,
        height_mm: making.width_mm * height as f64 / (width as f64 * linear.pixel_aspect),
        coefficients: Arc::new(rgb),
        mean: model.spectrum(mean).scaled(scale),
        peak_over_mean: if mean_brightness > 0.0 { f64::from(peak) / mean_brightness } else { 1.0 },
        importance,
        is_lamps,
        lights,
        half: LightPart::Whole,
        scale,
        model: Arc::clone(model),
        name: name.to_owned(),
        edge: making.edge,
    }
}
