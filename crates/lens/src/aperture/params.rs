//! Reads apertures as a lens file writes them.

use super::{Aperture, ApertureShape, Iris, Mask};
use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::Deserialize;
use spectra_core::params::{
    Angle, Faults, Length, LengthOrInfinity, Node, Params, Positive, StageNode, Value, Whole, keys_of,
};
use spectra_core::registry::{self, Context, Stage};
use spectra_core::resources::{Resources, beside};
use spectra_core::spectral::BAND;
use spectra_masks::Open;
use std::sync::Arc;

spectra_core::declare!(ApertureEntry, ApertureShape, "aperture", "A registered shape of apertures.", "shape");

/// The keys that every aperture has; all other keys belong to its shape.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
pub(crate) struct ApertureKeys {
    /// Center of the aperture, [x, y], mm if bare; the vertex of the surface if absent.
    center: Option<[Length; 2]>,
    /// Whether the aperture stops the light inside it; if false, it stops the light outside.
    #[serde(default)]
    obscures: bool,
}

/// A ring: the area between two circles.
///
/// Use it for a clear aperture without blades or, with `obscures`, for the secondary mirror of a telescope.
///
/// # Example
/// ```yaml
/// {shape: ring, inner: 3 mm, outer: 12 mm}
/// ```
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
struct Ring {
    /// Inner radius, mm if bare; 0 if absent.
    inner: Option<Length>,
    /// Outer radius, mm if bare; unlimited if absent.
    outer: Option<LengthOrInfinity>,
}

/// A rectangle along x and y.
///
/// Use it for a slit, a gate, or a prism cut to size. A tall one squeezes highlights as an anamorphic lens does.
///
/// # Example
/// ```yaml
/// {shape: rectangle, half-width: 4 mm, half-height: 9 mm}
/// ```
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
struct Rectangle {
    /// Half the width, mm if bare.
    half_width: Positive<Length>,
    /// Half the height, mm if bare.
    half_height: Positive<Length>,
}

/// An ellipse along x and y.
///
/// Use it for lenses whose highlights are oval, and for mirrors at an angle.
///
/// # Example
/// ```yaml
/// {shape: ellipse, half-width: 4 mm, half-height: 9 mm}
/// ```
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
struct Ellipse {
    /// Half the width, mm if bare.
    half_width: Positive<Length>,
    /// Half the height, mm if bare.
    half_height: Positive<Length>,
}

/// A polygon of any form.
///
/// It is filled by the even-odd rule, so a line that crosses itself leaves its middle closed. Use it for stars, arrows and blades of any
/// form.
///
/// # Example
/// ```yaml
/// {shape: polygon, points: [[-8, -6], [8, -6], [0, 9]]}
/// ```
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
struct Polygon {
    /// Corners of the polygon in order, each [x, y], mm if bare, 3 to 10000.
    #[schemars(length(min = 3, max = 10_000))]
    points: Vec<[Length; 2]>,
}

/// The opening between the blades of an iris diaphragm.
///
/// The stop sets its size: it closes with the f-number, and its area is that of the circle that it replaces. Straight blades leave
/// a polygon; curved ones leave a circle while their radius equals that of the opening.
///
/// # Example
/// ```yaml
/// {shape: iris, blades: 6, blade-radius: 14 mm, rotation: 15 deg}
/// ```
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
struct IrisBlades {
    /// Number of blades.
    blades: Whole<3, 100>,
    /// Radius of curvature of each blade's edge, mm if bare; straight if absent.
    blade_radius: Option<Positive<Length>>,
    /// Rotation of the opening, degrees if bare, counterclockwise; at 0, the value if absent, a corner lies on +y.
    rotation: Option<Angle>,
}

/// A picture or a drawing as an aperture.
///
/// Out-of-focus highlights take its shape: hearts, stars, the bubbles of a dirty filter. A drawing (SVG) has sharp edges at any
/// magnification.
///
/// # Example
/// ```yaml
/// {shape: mask, file: leaves.png, width: 24 mm}
/// ```
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
struct MaskParams {
    /// File name: a picture (PNG, JPEG, TIFF), in which white passes light and black stops it, or a drawing (SVG), in which filled areas
    /// pass.
    file: String,
    /// Width of the picture or of the drawing's page, mm if bare; may be omitted for a drawing that states its own width.
    width: Option<Positive<Length>>,
    /// How a drawing is read. `filled` (the default): everything painted passes. `white`, as in a picture: white passes, black
    /// stops, gray passes a part.
    open: Option<Open>,
}

/// The schema of `aperture` in a lens file: one aperture, or a list of them.
pub struct ApertureForm;

impl JsonSchema for ApertureForm {
    fn inline_schema() -> bool {
        true
    }

    fn schema_name() -> std::borrow::Cow<'static, str> {
        "ApertureForm".into()
    }

    fn json_schema(_: &mut SchemaGenerator) -> Schema {
        let one = json_schema!({ "type": "object", "$ref": "#/$defs/aperture" });
        json_schema!({
            "x-words": "map, or list of maps",
            "x-see": "aperture",
            "if": { "type": "array" },
            "then": { "items": one },
            "else": one,
        })
    }
}

const MAX_MASK_BYTES: u64 = 64 << 20;
const MAX_MASK_SIDE: u32 = 8192;

/// Reads one aperture or a list of apertures, as lens files and scenes write them.
///
/// # Errors
/// Faults in the apertures, each with its place; faults in a drawing, with their place in the drawing.
pub fn read(node: &StageNode, resources: &dyn Resources) -> Result<Vec<Aperture>, Faults> {
    let Value::Seq(items) = &node.node().value else {
        return one(node.node(), node.path(), resources).map(|aperture| vec![aperture]);
    };
    let mut faults = Faults::new();
    let mut all = Vec::new();
    for (at, item) in items.iter().enumerate() {
        all.extend(faults.take(one(item, &format!("{}[{at}]", node.path()), resources)));
    }
    faults.into_result(all)
}

fn one(node: &Node, path: &str, resources: &dyn Resources) -> Result<Aperture, Faults> {
    let params = Params::kinded(Params::section(node.clone(), path)?.node().clone(), path, ApertureShape::KEY)?;
    let (keys, own) = params.split(&keys_of::<ApertureKeys>());
    let keys: ApertureKeys = keys.parse()?;
    let shape = registry::build::<ApertureShape>(&own, &Context::new(resources, BAND))?;
    let center_mm = keys.center.map_or([0.0; 2], |c| c.map(Length::mm));
    Ok(Aperture { shape: *shape, center_mm, obscures: keys.obscures })
}

spectra_core::register!(ApertureEntry, "ring": Ring, ring);
spectra_core::register!(ApertureEntry, "rectangle": Rectangle, rectangle);
spectra_core::register!(ApertureEntry, "ellipse": Ellipse, ellipse);
spectra_core::register!(ApertureEntry, "polygon": Polygon, polygon);
spectra_core::register!(ApertureEntry, "iris": IrisBlades, iris);
spectra_core::register!(ApertureEntry, "mask": MaskParams, mask);

fn ring(params: &Params, _: &Context<'_>) -> Result<Box<ApertureShape>, Faults> {
    let p: Ring = params.parse()?;
    let (inner_mm, outer_mm) = (p.inner.map_or(0.0, Length::mm), p.outer.map_or(f64::INFINITY, |o| o.mm()));
    if !(inner_mm >= 0.0 && outer_mm > inner_mm) {
        let fault = params.fault("outer", format!("no ring lies between the radii {inner_mm} and {outer_mm} mm"));
        return Err(fault.hint("0 <= inner < outer").into());
    }
    Ok(Box::new(ApertureShape::Ring { inner_mm, outer_mm }))
}

fn rectangle(params: &Params, _: &Context<'_>) -> Result<Box<ApertureShape>, Faults> {
    let p: Rectangle = params.parse()?;
    Ok(Box::new(ApertureShape::Rectangle { half_width_mm: p.half_width.mm(), half_height_mm: p.half_height.mm() }))
}

fn ellipse(params: &Params, _: &Context<'_>) -> Result<Box<ApertureShape>, Faults> {
    let p: Ellipse = params.parse()?;
    Ok(Box::new(ApertureShape::Ellipse { half_width_mm: p.half_width.mm(), half_height_mm: p.half_height.mm() }))
}

fn polygon(params: &Params, _: &Context<'_>) -> Result<Box<ApertureShape>, Faults> {
    let p: Polygon = params.parse()?;
    Ok(Box::new(ApertureShape::Polygon(p.points.into_iter().map(|point| point.map(Length::mm)).collect())))
}

fn iris(params: &Params, _: &Context<'_>) -> Result<Box<ApertureShape>, Faults> {
    let p: IrisBlades = params.parse()?;
    Ok(Box::new(ApertureShape::Iris(Iris {
        blades: p.blades.get_u32(),
        blade_radius_mm: p.blade_radius.map_or(f64::INFINITY, |r| r.mm()),
        rotation_rad: p.rotation.map_or(0.0, Angle::rad),
    })))
}

fn mask(params: &Params, context: &Context<'_>) -> Result<Box<ApertureShape>, Faults> {
    let p: MaskParams = params.parse()?;
    let fail =
        |text: String| Faults::from(params.fault("file", text).hint("a PNG, JPEG, TIFF or SVG beside the lens file"));
    let open = p.open;
    let path = beside(params.node(), &p.file);
    let found = context
        .resources
        .read(&path, &["lenses", "scenes"], &[], MAX_MASK_BYTES)
        .map_err(|e| fail(format!("`{}`: {e}", p.file)))?;
    if p.file.rsplit_once('.').is_some_and(|(_, ending)| ending.eq_ignore_ascii_case("svg")) {
        let drawn = spectra_masks::read(&found.name, &found.bytes, p.width.map(|w| w.mm()), open);
        return drawn
            .map(|drawn| Box::new(ApertureShape::Drawing(drawn)))
            .map_err(|faults| params.place_at("file", faults));
    }
    if open == Some(Open::Filled) {
        let fault = params.fault("open", "`filled` is only for a drawing: in a picture white passes");
        return Err(fault.hint("leave `open` out, or draw an SVG").into());
    }
    let Some(width) = p.width else {
        let fault = params.fault_here("missing key `width`: how large is the picture?");
        return Err(fault.hint("add `width: 24 mm`").into());
    };
    let mut reader = image::ImageReader::new(std::io::Cursor::new(&found.bytes[..]))
        .with_guessed_format()
        .map_err(|e| fail(format!("`{}`: {e}", p.file)))?;
    let mut limits = image::Limits::default();
    (limits.max_image_width, limits.max_image_height) = (Some(MAX_MASK_SIDE), Some(MAX_MASK_SIDE));
    reader.limits(limits);
    let picture = reader.decode().map_err(|e| fail(format!("`{}`: {e}", p.file)))?.into_luma16();
    let (width_px, height_px) = picture.dimensions();
    let values: Arc<[f32]> = picture.as_raw().iter().map(|v| f32::from(*v) / 65535.0).collect();
    Ok(Box::new(ApertureShape::Mask(Mask::new(width_px as usize, height_px as usize, width.mm(), values))))
}
