//! Apertures as a lens file writes them.

use super::{Aperture, Iris, Mask, Shape};
use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::Deserialize;
use spectra_core::params::{
    Angle, Faults, Kinds, Length, LengthOrInfinity, Params, Positive, StageNode, Value, Whole, keys_of,
};
use spectra_core::resources::{Resources, beside};
use spectra_masks::Open;
use std::sync::Arc;

/// Keys of every aperture; the others belong to its shape.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
struct Common {
    /// Its form.
    shape: ShapeName,
    /// Its center, mm if bare.
    center: Option<[Length; 2]>,
    /// Stops what is inside, in place of what is outside.
    #[serde(default)]
    obscures: bool,
}

/// The form of an aperture.
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
#[schemars(inline)]
enum ShapeName {
    Ring,
    Rectangle,
    Ellipse,
    Polygon,
    Iris,
    Mask,
}

/// What lies between two circles.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
struct RingParams {
    /// Inner radius, mm if bare; 0 if absent.
    inner: Option<Length>,
    /// Outer radius, mm if bare; unlimited if absent.
    outer: Option<LengthOrInfinity>,
}

/// What lies within a rectangle or an ellipse of this size.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
struct HalfSizes {
    /// Half the width, mm if bare.
    half_width: Positive<Length>,
    /// Half the height, mm if bare.
    half_height: Positive<Length>,
}

/// What lies within a polygon.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
struct PolygonParams {
    /// Corners in order around it, mm if bare, 3 to 10000.
    #[schemars(length(min = 3, max = 10_000))]
    points: Vec<[Length; 2]>,
}

/// What the blades of a diaphragm leave open; its size is that of the stop.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
struct IrisParams {
    /// Number of blades.
    blades: Whole<3, 100>,
    /// Radius of each blade's edge, mm if bare; straight if absent.
    blade_radius: Option<Positive<Length>>,
    /// Turn of the opening, degrees if bare.
    rotation: Option<Angle>,
}

/// What a picture leaves open.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
struct MaskParams {
    /// A picture (PNG, JPEG, TIFF): white passes, black stops. Or a drawing (SVG): what is filled passes.
    file: String,
    /// Width of the picture or of the drawing's page, mm if bare; of a drawing it may be left out, if it states one itself.
    width: Option<Positive<Length>>,
    /// Of a drawing: `filled`, whatever is painted passes (the default); or `white`, as of a picture: white passes, black
    /// stops, gray passes in part.
    open: Option<Open>,
}

/// What an aperture is written as: one, or a list.
pub struct ApertureForm;

impl JsonSchema for ApertureForm {
    fn schema_name() -> std::borrow::Cow<'static, str> {
        "Aperture".into()
    }

    fn json_schema(generator: &mut SchemaGenerator) -> Schema {
        let shared = Common::json_schema(generator);
        let one = Kinds {
            key: "shape",
            kinds: vec![
                ("ring", RingParams::json_schema(generator)),
                ("rectangle", HalfSizes::json_schema(generator)),
                ("ellipse", HalfSizes::json_schema(generator)),
                ("polygon", PolygonParams::json_schema(generator)),
                ("iris", IrisParams::json_schema(generator)),
                ("mask", MaskParams::json_schema(generator)),
            ],
            default: None,
            shared: Some(&shared),
            by_name: false,
        };
        let one = one.schema();
        json_schema!({ "x-words": "map, or list of maps", "if": { "type": "array" }, "then": { "items": one }, "else": one })
    }
}

const MAX_MASK_BYTES: u64 = 64 << 20;
const MAX_MASK_SIDE: u32 = 8192;

/// Reads one aperture or a list of them, as lens files and scenes write them.
///
/// # Errors
/// What is wrong with them, placed; what is wrong with a drawing, placed in it.
pub fn read(node: &StageNode, resources: &dyn Resources) -> Result<Vec<Aperture>, Faults> {
    let Value::Seq(items) = &node.node().value else {
        return one(&Params::section(node.node().clone(), node.path())?, resources).map(|a| vec![a]);
    };
    let mut faults = Faults::new();
    let mut all = Vec::new();
    for (at, item) in items.iter().enumerate() {
        let params = faults.take(Params::section(item.clone(), &format!("{}[{at}]", node.path())));
        all.extend(params.and_then(|p| faults.take(one(&p, resources))));
    }
    faults.into_result(all)
}

fn one(params: &Params, resources: &dyn Resources) -> Result<Aperture, Faults> {
    let (common, own) = params.split(&keys_of::<Common>());
    let common: Common = common.parse()?;
    let shape = match common.shape {
        ShapeName::Ring => ring(&own)?,
        ShapeName::Rectangle => {
            let p: HalfSizes = own.parse()?;
            Shape::Rectangle { half_width_mm: p.half_width.mm(), half_height_mm: p.half_height.mm() }
        }
        ShapeName::Ellipse => {
            let p: HalfSizes = own.parse()?;
            Shape::Ellipse { half_width_mm: p.half_width.mm(), half_height_mm: p.half_height.mm() }
        }
        ShapeName::Polygon => polygon(&own)?,
        ShapeName::Iris => iris(&own)?,
        ShapeName::Mask => mask(&own, resources)?,
    };
    let center_mm = common.center.map_or([0.0; 2], |c| c.map(Length::mm));
    Ok(Aperture { shape, center_mm, obscures: common.obscures })
}

fn ring(params: &Params) -> Result<Shape, Faults> {
    let p: RingParams = params.parse()?;
    let (inner_mm, outer_mm) = (p.inner.map_or(0.0, Length::mm), p.outer.map_or(f64::INFINITY, |o| o.mm()));
    if !(inner_mm >= 0.0 && outer_mm > inner_mm) {
        let fault = params.fault("outer", format!("no ring lies between the radii {inner_mm} and {outer_mm} mm"));
        return Err(fault.hint("0 <= inner < outer").into());
    }
    Ok(Shape::Ring { inner_mm, outer_mm })
}

fn polygon(params: &Params) -> Result<Shape, Faults> {
    let p: PolygonParams = params.parse()?;
    Ok(Shape::Polygon(p.points.into_iter().map(|point| point.map(Length::mm)).collect()))
}

fn iris(params: &Params) -> Result<Shape, Faults> {
    let p: IrisParams = params.parse()?;
    Ok(Shape::Iris(Iris {
        blades: p.blades.get_u32(),
        blade_radius_mm: p.blade_radius.map_or(f64::INFINITY, |r| r.mm()),
        rotation_rad: p.rotation.map_or(0.0, Angle::rad),
    }))
}

fn mask(params: &Params, resources: &dyn Resources) -> Result<Shape, Faults> {
    let p: MaskParams = params.parse()?;
    let fail =
        |text: String| Faults::from(params.fault("file", text).hint("a PNG, JPEG, TIFF or SVG beside the lens file"));
    let open = p.open;
    let path = beside(params.node(), &p.file);
    let found = resources
        .read(&path, &["lenses", "scenes"], &[], MAX_MASK_BYTES)
        .map_err(|e| fail(format!("`{}`: {e}", p.file)))?;
    if p.file.rsplit_once('.').is_some_and(|(_, ending)| ending.eq_ignore_ascii_case("svg")) {
        let drawn = spectra_masks::read(&found.name, &found.bytes, p.width.map(|w| w.mm()), open);
        return drawn.map(Shape::Drawing).map_err(|faults| params.place_at("file", faults));
    }
    if open == Some(Open::Filled) {
        let fault = params.fault("open", "of a picture the white passes: nothing in it is filled");
        return Err(fault.hint("leave `open` out, or draw an SVG").into());
    }
    let Some(width) = p.width else {
        let fault = params.fault_here("how large is the picture? `width` is missing");
        return Err(fault.hint("`width: 24 mm`").into());
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
    Ok(Shape::Mask(Mask::new(width_px as usize, height_px as usize, width.mm(), values)))
}
