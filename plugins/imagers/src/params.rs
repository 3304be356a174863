//! The parameters of the frame, which all plane imagers share.

use crate::formats::{FORMATS, FormatName, format_named};
use crate::placement::{FrameShape, Placement};
use crate::plane::{MAX_PIXELS, MAX_SIDE_PX, Plane};
use crate::plates::{Plate, Plates};
use schemars::JsonSchema;
use serde::Deserialize;
use spectra_core::frame::FrameSize;
use spectra_core::names;
use spectra_core::params::{Angle, Fault, Faults, Length, NonNegative, Params, Positive, Whole};
use spectra_core::registry::Context;
use spectra_glass::Catalog;
use spectra_spectrum::find_transmittance_in;

/// The frame as written in a scene, shared by all imagers: a named format or width and height, the number of pixels, and its
/// position and shape.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub struct Frame {
    /// Name of the frame size, such as `135` (36 x 24 mm), `6x6` or `super-35`. Write either this or `width` and `height`.
    #[serde(default)]
    #[schemars(extend("x-formats" = crate::formats::listed()))]
    pub(crate) format: Option<FormatName>,
    /// Width of the frame, 0.001 mm to 100 m, mm if bare; written with `height` instead of `format`.
    #[serde(default)]
    #[schemars(range(min = 1e-3, max = 1e5))]
    pub(crate) width: Option<Positive<Length>>,
    /// Height of the frame, 0.001 mm to 100 m, mm if bare; written with `width` instead of `format`.
    #[serde(default)]
    #[schemars(range(min = 1e-3, max = 1e5))]
    pub(crate) height: Option<Positive<Length>>,
    /// Aspect ratio to which the frame is cropped about its center, such as `16:9` or 1.85 (width over height); not cropped if
    /// left out.
    #[serde(default)]
    pub(crate) crop: Option<Crop>,
    /// Number of pixels across and down, 1 to 32768 each and at most 200 million in all; or only the number across, and as
    /// many down as make pixels square.
    pub(crate) resolution: Resolution,
    /// Position of the center of the frame in the image plane, along x and y, mm if bare; +y is up. The image is upside
    /// down: a frame moved up shows more of what is below. The shift is measured from the point that `around` names; not
    /// shifted if left out.
    #[serde(default)]
    #[schemars(inner(range(min = -1e5, max = 1e5)))]
    pub(crate) shift: Option<[Length; 2]>,
    /// Point from which `shift` is measured: the `axis` (the default), or the point where the light of the `source` lands. Use
    /// `source` for the spot of an off-axis point or the spectrum of a prism.
    #[serde(default)]
    pub(crate) around: Around,
    /// Tilt of the frame about its own center, first about x, then about the y axis that was turned with it, degrees if bare,
    /// right-handed. A positive tilt about x moves the upper edge away from the lens. At most 80 degrees each; perpendicular
    /// to the axis if left out.
    #[serde(default)]
    #[schemars(inner(range(min = -80, max = 80)))]
    pub(crate) tilt: Option<[Angle; 2]>,
    /// Shape and radius of a curved frame; flat if left out.
    #[serde(default)]
    pub(crate) curvature: Option<Curvature>,
    /// Plates of glass in front of a flat frame: cover glass, filters against ultraviolet and infrared. The frame stands where
    /// they put the image, and the lens is focused through them. No plates if left out.
    #[serde(default)]
    pub(crate) cover: Vec<CoverParams>,
    /// Plates of a crystal in front of a flat frame that split every point in two, against false colors. No plates if left
    /// out.
    #[serde(default)]
    pub(crate) low_pass: Vec<LowPassParams>,
}

/// The center of a frame that is not shifted, as written in a scene.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
#[schemars(inline)]
pub(crate) enum Around {
    /// The optical axis of the lens.
    #[default]
    Axis,
    /// The point where the light of the source lands.
    Source,
}

/// `resolution` as written in a scene.
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema)]
#[serde(untagged)]
pub(crate) enum Resolution {
    /// Number of pixels across; those down make pixels square.
    Across(Side),
    /// Numbers of pixels across and down.
    Both([Side; 2]),
}

type Side = Whole<1, { MAX_SIDE_PX as u64 }>;

/// `crop` as written in a scene.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(untagged)]
pub(crate) enum Crop {
    /// Ratio of width to height.
    Ratio(#[schemars(range(min = MIN_RATIO, max = MAX_RATIO))] f64),
    /// Width and height as text, such as `16:9`.
    Words(String),
}

const MIN_RATIO: f64 = 0.01;
const MAX_RATIO: f64 = 100.0;

/// The curvature of a frame, as written in a scene.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
pub struct Curvature {
    /// Shape of the frame: `cylinder` (curved along x, like film in a curved gate) or `sphere`.
    pub shape: CurvatureShape,
    /// Radius, mm if bare; positive if its center lies behind the frame, negative if the frame is concave toward the lens.
    /// The frame may span at most 60 degrees to each side.
    pub radius: Length,
}

/// The shape of a curved frame.
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
#[schemars(inline)]
#[allow(missing_docs, reason = "the key says it")]
pub enum CurvatureShape {
    Cylinder,
    Sphere,
}

/// A plate of glass in front of the frame, as written in a scene. Reflections at its surfaces are neglected.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
pub struct CoverParams {
    /// Name of a glass of the catalog, such as `SCHOTT/N-BK7`; its absorption is included.
    pub glass: String,
    /// Thickness, mm if bare, at most 100 mm.
    #[schemars(range(max = 100))]
    pub thickness: Positive<Length>,
    /// Air gap behind the plate, mm if bare: for information only, since it changes nothing.
    #[serde(default)]
    pub gap: Option<NonNegative<Length>>,
    /// Further transmittance, by name or from a file beside the scene: a coating against infrared, a dyed layer. No further
    /// loss if left out.
    #[serde(default)]
    pub transmittance: Option<String>,
}

/// A birefringent plate in front of the frame, as written in a scene, with its optic axis at 45 degrees to the plate.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
pub struct LowPassParams {
    /// Crystal of the plate: `quartz` (the default), `lithium-niobate`, or a uniaxial crystal of the catalog without its `-o`
    /// or `-e`.
    #[serde(default)]
    pub crystal: Option<String>,
    /// Thickness, mm if bare, at most 100 mm: 1.5 mm of quartz split a point by 8.8 um.
    #[schemars(range(max = 100))]
    pub thickness: Positive<Length>,
    /// Direction of the second point, from +x toward +y, degrees if bare; 0 if left out.
    #[serde(default)]
    pub azimuth: Option<Angle>,
}

impl Frame {
    /// Checks the parameters, before any memory is allocated by them, and builds the frame.
    pub(crate) fn plane(&self, params: &Params, context: &Context<'_>) -> Result<Plane, Faults> {
        let mut faults = Faults::new();
        let size = faults.take(self.size(params));
        if let Some(size) = &size {
            self.warn_unless_square(size, params, context);
        }
        let standing = faults.take(self.placement(params, size, context));
        let plates = faults.take(self.plates(params, context));
        match (size, standing, plates) {
            (Some(size), Some(standing), Some(plates)) => {
                faults.into_result(Plane::new(size).with_placement(standing).behind(plates))
            }
            _ => Err(faults),
        }
    }

    /// Builds the plates in front of the frame.
    fn plates(&self, params: &Params, context: &Context<'_>) -> Result<Plates, Faults> {
        let mut faults = Faults::new();
        let catalogue = Catalog::bundled();
        let grid = &context.grid;
        let mut plates = Vec::new();
        for (i, plate) in self.cover.iter().enumerate() {
            let key = |name: &str| format!("cover[{i}].{name}");
            let medium = spectra_glass::file::medium(&plate.glass, params, &key("glass"), context.resources);
            let filter = plate.transmittance.as_ref().map(|name| find_transmittance_in(name, context.resources));
            let filter = filter.transpose().map_err(|e| e.faults(|text| params.fault(&key("transmittance"), text)));
            let (medium, filter) = (faults.take(medium), faults.take(filter));
            if let (Some(medium), Some(filter)) = (medium, filter) {
                plates.push(Plate::glass(
                    &medium,
                    plate.thickness.mm(),
                    |w| filter.as_ref().map_or(1.0, |f| f.at(w)),
                    grid,
                ));
            }
        }
        for (i, plate) in self.low_pass.iter().enumerate() {
            let key = |name: &str| format!("low-pass[{i}].{name}");
            let crystal = match plate.crystal.as_deref() {
                None | Some("quartz") => "SiO2/Ghosh",
                Some("lithium-niobate") => "LiNbO3/Zelmon",
                Some(other) => other,
            };
            let ray = |which: &str| {
                let found = catalogue.medium(&format!("{crystal}-{which}"));
                found.map_err(|e| {
                    params.fault(&key("crystal"), e.to_string()).hint("write `quartz` or `lithium-niobate`")
                })
            };
            let (ordinary, extraordinary) = (faults.take(ray("o")), faults.take(ray("e")));
            if let (Some(o), Some(e)) = (ordinary, extraordinary) {
                plates.push(Plate::crystal(&o, &e, plate.thickness.mm(), plate.azimuth.map_or(0.0, Angle::rad), grid));
            }
        }
        if self.curvature.is_some() && !(self.cover.is_empty() && self.low_pass.is_empty()) {
            let key = if self.cover.is_empty() { "low-pass" } else { "cover" };
            faults
                .push(params.fault(key, "a curved frame cannot have plates").hint("remove `curvature`, or the plates"));
        }
        faults.into_result(Plates::new(grid, plates))
    }

    /// Determines the size of the frame in pixels and mm.
    fn size(&self, params: &Params) -> Result<FrameSize, Faults> {
        let mut faults = Faults::new();
        let crop = faults.take(self.crop.as_ref().map(|crop| ratio(crop, params)).transpose());
        let size_mm = faults.take(self.size_mm(params));
        let (width_mm, height_mm) = match (size_mm.unwrap_or((1.0, 1.0)), crop.flatten()) {
            ((width, height), Some(ratio)) if width > height * ratio => (height * ratio, height),
            ((width, _), Some(ratio)) => (width, width / ratio),
            (size, None) => size,
        };
        let [width_px, height_px] = match self.resolution {
            Resolution::Across(across) => [across.get_u32(), square_px(across.get_u32(), height_mm / width_mm)],
            Resolution::Both(sides) => sides.map(Whole::get_u32),
        };
        faults.extend(resolution_faults([width_px, height_px], params));
        faults.into_result(FrameSize { width_px, height_px, width_mm, height_mm })
    }

    /// Warns if pixels are not square, which is rarely intended: the picture looks squeezed.
    fn warn_unless_square(&self, size: &FrameSize, params: &Params, context: &Context<'_>) {
        let [across, down] = [size.width_px, size.height_px];
        let ratio = size.height_mm / size.width_mm;
        // Accept pixels that are as nearly square as whole numbers of pixels allow.
        if down.abs_diff(square_px(across, ratio)) <= 1 || across.abs_diff(square_px(down, 1.0 / ratio)) <= 1 {
            return;
        }
        let aspect = size.width_mm / f64::from(across) / (size.height_mm / f64::from(down));
        // Nobody sees a difference of 1 %.
        if (aspect - 1.0).abs() < 0.01 {
            return;
        }
        let text =
            format!("pixels are not square, but {aspect:.2} times as wide as high: the picture will look squeezed");
        let common = gcd(across, down);
        let hint = format!(
            "write `resolution: [{across}, {}]`, or `crop: {}:{}` for a frame of that shape",
            square_px(across, ratio),
            across / common,
            down / common
        );
        context.warn(params.fault("resolution", text).hint(hint));
    }

    fn size_mm(&self, params: &Params) -> Result<(f64, f64), Fault> {
        match (&self.format, self.width, self.height) {
            (Some(FormatName(name)), None, None) => match format_named(name) {
                Some(format) => Ok((format.width_mm, format.height_mm)),
                None => {
                    let known = FORMATS.map(|f| f.name);
                    let fault = params.fault("format", format!("unknown format `{name}`"));
                    let hint = names::hint(name, &known, "spectra list format");
                    let other = if hint.starts_with("known: ") { "; or write `width` and `height`" } else { "" };
                    Err(fault.hint(format!("{hint}{other}")))
                }
            },
            // The limits are far beyond any camera; they keep areas and their inverses well within the range of a double.
            (None, Some(width), Some(height)) => Ok((width.mm(), height.mm())),
            (None, None, None) => Err(params
                .fault("format", "the size of the frame is missing")
                .hint("write `format: 135`, or `width` and `height`")),
            (Some(_), ..) => Err(params
                .fault("format", "the size of the frame is given twice")
                .hint("write either `format`, or `width` and `height`")),
            (None, Some(_), None) => {
                Err(params.fault("width", "`height` is missing").hint("write both `width` and `height`"))
            }
            (None, None, Some(_)) => {
                Err(params.fault("height", "`width` is missing").hint("write both `width` and `height`"))
            }
        }
    }

    /// Determines the position and shape of the frame; `size` is `None` if it has faults.
    fn placement(&self, params: &Params, size: Option<FrameSize>, context: &Context<'_>) -> Result<Placement, Faults> {
        let mut faults = Faults::new();
        // The scene builds the imager a second time, once it knows where the light lands.
        let from_mm = match self.around {
            Around::Axis => [0.0; 2],
            Around::Source => context.landing_mm.unwrap_or([0.0; 2]),
        };
        let shift_mm = self.shift.map_or([0.0; 2], |shift| shift.map(Length::mm));
        let shift_mm = [from_mm[0] + shift_mm[0], from_mm[1] + shift_mm[1]];
        let tilt_rad = self.tilt.map_or([0.0; 2], |tilt| tilt.map(Angle::rad));
        let bend =
            self.curvature.as_ref().and_then(|c| faults.take(frame_shape(c, params, size))).unwrap_or(FrameShape::Flat);
        faults.into_result(Placement::new(shift_mm, tilt_rad, bend))
    }
}

/// Returns the number of pixels down that makes pixels square, for the number across and the ratio of height to width.
fn square_px(across: u32, ratio: f64) -> u32 {
    (f64::from(across) * ratio).round().clamp(1.0, f64::from(u32::MAX)) as u32
}

fn gcd(a: u32, b: u32) -> u32 {
    if b == 0 { a.max(1) } else { gcd(b, a % b) }
}

/// Reads the ratio of width to height: a number, or two with a colon between them.
fn ratio(crop: &Crop, params: &Params) -> Result<f64, Fault> {
    let ratio = match crop {
        Crop::Ratio(ratio) => Some(*ratio),
        Crop::Words(text) => text.split_once(':').and_then(|(width, height)| {
            let [width, height] = [width, height].map(|side| side.trim().parse::<f64>().ok());
            Some(width? / height?)
        }),
    };
    ratio.filter(|ratio| (MIN_RATIO..=MAX_RATIO).contains(ratio)).ok_or_else(|| {
        let hint = "write width and height, as in `crop: 16:9`, or their ratio, as in `crop: 1.85`";
        params.fault("crop", "this is not an aspect ratio").hint(hint)
    })
}

/// Checks the number of pixels. Sides written in the scene are known to be within their range, but a computed one may not be.
fn resolution_faults([width, height]: [u32; 2], params: &Params) -> Vec<Fault> {
    let pixels = u64::from(width) * u64::from(height);
    let fault = if height > MAX_SIDE_PX {
        let text = format!("a side of {height} pixels is out of range");
        Some(params.fault("resolution", text).hint(format!("write at most {MAX_SIDE_PX} pixels per side")))
    } else {
        let text = format!("{width} x {height} pixels are {} megapixels", pixels / 1_000_000);
        let fault = || {
            params
                .fault("resolution", text)
                .hint(format!("write a resolution of at most {} megapixels", MAX_PIXELS / 1_000_000))
        };
        (pixels > MAX_PIXELS).then(fault)
    };
    fault.into_iter().collect()
}

/// Reads the curvature. The frame must stay well within one half of the cylinder or sphere.
fn frame_shape(curvature: &Curvature, params: &Params, size: Option<FrameSize>) -> Result<FrameShape, Fault> {
    let radius_mm = curvature.radius.mm();
    let bend = match curvature.shape {
        CurvatureShape::Cylinder => FrameShape::Cylinder { radius_mm },
        CurvatureShape::Sphere => FrameShape::Sphere { radius_mm },
    };
    let Some(size) = size else { return Ok(bend) };
    let least_mm = bend.least_radius_mm(size.width_mm, size.height_mm);
    if !(radius_mm.abs() >= least_mm && radius_mm.is_finite()) {
        let text = format!("a radius of {radius_mm} mm bends the frame by more than 60 degrees");
        return Err(params
            .fault("curvature.radius", text)
            .hint(format!("write at least {least_mm:.4} mm, positive or negative")));
    }
    Ok(bend)
}
