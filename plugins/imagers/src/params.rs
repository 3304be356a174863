//! The parameters that all plane imagers share, and the frame that they describe.

use crate::formats::{FORMATS, format_named};
use crate::plane::{MAX_PIXELS, MAX_SIDE_PX, Plane};
use crate::plates::{Plate, Plates};
use crate::standing::{Bend, Standing};
use schemars::JsonSchema;
use serde::Deserialize;
use spectra_core::frame::FrameSize;
use spectra_core::names;
use spectra_core::params::{Angle, Fault, Faults, Length, NonNegative, Params, Positive, StageNode, Value};
use spectra_core::registry::Context;
use spectra_glass::Catalogue;
use spectra_spectrum::find_transmittance_in;

/// Parameters of an imager: those that all share, and its own behind them. One struct holds all, so that an unknown
/// key is compared with every known one.
macro_rules! imager_params {
    ($(#[$doc:meta])* $name:ident { $($(#[$field_doc:meta])* $field:ident: $type:ty,)* }) => {
        $(#[$doc])*
        #[derive(Debug, serde::Deserialize, schemars::JsonSchema)]
        #[serde(deny_unknown_fields, rename_all = "kebab-case")]
        pub struct $name {
            /// Size by name, such as `135` (36 x 24 mm), `6x6` or `super-35`; or else `width` and `height`.
            #[serde(default)]
            #[schemars(extend("x-formats" = $crate::formats::listed()))]
            pub format: Option<String>,
            /// Width of the frame, 0.001 mm to 100 m, mm if bare; together with `height`, in place of `format`.
            #[serde(default)]
            pub width: Option<spectra_core::params::Positive<spectra_core::params::Length>>,
            /// Height of the frame, 0.001 mm to 100 m, mm if bare.
            #[serde(default)]
            pub height: Option<spectra_core::params::Positive<spectra_core::params::Length>>,
            /// The largest part of the frame of this shape, such as `16:9` or 1.85 (width over height), about its center; all
            /// of it if left out.
            #[serde(default)]
            #[schemars(with = "Option<crate::params::CropForm>")]
            pub crop: Option<spectra_core::params::StageNode>,
            /// Pixels across and down, 1 to 32768 each and at most 200 million; or those across alone, and as many down as
            /// make them square.
            #[schemars(with = "crate::params::ResolutionForm")]
            pub resolution: spectra_core::params::StageNode,
            /// Where the center of the frame lies in the image plane, along x and y, mm if bare; +y is up. The image is
            /// upside down: a frame moved up shows more of what is below. On the axis if left out.
            #[serde(default)]
            pub shift: Option<[spectra_core::params::Length; 2]>,
            /// Turns of the frame about its own center, about x and then about the y that turned along, degrees if
            /// bare, right-handed: a positive one about x moves the upper edge away from the lens. Within 80 degrees;
            /// across the axis if left out.
            #[serde(default)]
            pub tilt: Option<[spectra_core::params::Angle; 2]>,
            /// The bend of a frame that is not flat.
            #[serde(default)]
            pub curvature: Option<$crate::params::Curvature>,
            /// Plates of glass before a flat frame: cover glass, filters against ultraviolet and infrared. The frame
            /// stands where they put the image, and the lens is focused through them. None if left out.
            #[serde(default)]
            pub cover: Option<Vec<$crate::params::CoverParams>>,
            /// Plates of a crystal before a flat frame that split every point in two, against false colors. None if left
            /// out.
            #[serde(default)]
            pub low_pass: Option<Vec<$crate::params::LowPassParams>>,
            $($(#[$field_doc])* pub $field: $type,)*
        }

        impl $name {
            /// The part that all imagers share.
            fn frame(&self) -> $crate::params::Frame {
                $crate::params::Frame {
                    format: self.format.clone(),
                    width: self.width,
                    height: self.height,
                    crop: self.crop.clone(),
                    resolution: self.resolution.clone(),
                    shift: self.shift,
                    tilt: self.tilt,
                    curvature: self.curvature.clone(),
                    cover: self.cover.clone().unwrap_or_default(),
                    low_pass: self.low_pass.clone().unwrap_or_default(),
                }
            }
        }
    };
}
pub(crate) use imager_params;

/// `resolution` as written in a scene.
#[derive(JsonSchema)]
#[serde(untagged)]
#[expect(dead_code, reason = "states what is allowed; `Frame` reads it")]
pub enum ResolutionForm {
    /// Pixels across.
    Across(#[schemars(range(min = 1, max = 32768))] u32),
    /// Pixels across and down.
    Both(#[schemars(inner(range(min = 1, max = 32768)))] [u32; 2]),
}

/// `crop` as written in a scene.
#[derive(JsonSchema)]
#[serde(untagged)]
#[expect(dead_code, reason = "states what is allowed; `Frame` reads it")]
pub enum CropForm {
    /// Width over height.
    Ratio(#[schemars(extend("exclusiveMinimum" = 0))] f64),
    /// Width and height, such as `16:9`.
    Words(String),
}

/// How a frame is curved, as written in a scene.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
pub struct Curvature {
    /// `cylinder`: bent along x, as film in a curved gate; or `sphere`.
    #[schemars(extend("enum" = ["cylinder", "sphere"]))]
    pub shape: String,
    /// Radius, mm if bare; positive where its center lies behind the frame, negative where the frame is hollow toward
    /// the lens. It bends the frame by 60 degrees to a side at most.
    pub radius: Length,
}

/// A plate of glass before the frame, as written in a scene. Reflections at its surfaces are not counted.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
pub struct CoverParams {
    /// A glass of the catalogue, such as `SCHOTT/N-BK7`; its absorption is included.
    pub glass: String,
    /// Thickness, mm if bare, at most 100 mm.
    pub thickness: Positive<Length>,
    /// Air behind it, mm if bare: for information only, since it changes nothing.
    #[serde(default)]
    pub gap: Option<NonNegative<Length>>,
    /// A further transmittance, by name or from a file beside the scene: a coating against infrared, a dyed layer. None
    /// if left out.
    #[serde(default)]
    pub transmittance: Option<String>,
}

/// A birefringent plate before the frame, as written in a scene, its axis at 45 degrees to it.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
pub struct LowPassParams {
    /// `quartz` (the default), `lithium-niobate`, or a uniaxial crystal of the catalogue without its `-o` or `-e`.
    #[serde(default)]
    pub crystal: Option<String>,
    /// Thickness, mm if bare, at most 100 mm: 1.5 mm of quartz split by 8.8 um.
    pub thickness: Positive<Length>,
    /// Where the second point lies, from +x toward +y, degrees if bare; 0 if left out.
    #[serde(default)]
    pub azimuth: Option<Angle>,
}

/// The frame as a scene writes it: a named format or width and height, the number of pixels, how it stands.
pub(crate) struct Frame {
    pub(crate) format: Option<String>,
    pub(crate) width: Option<Positive<Length>>,
    pub(crate) height: Option<Positive<Length>>,
    pub(crate) crop: Option<StageNode>,
    pub(crate) resolution: StageNode,
    pub(crate) shift: Option<[Length; 2]>,
    pub(crate) tilt: Option<[Angle; 2]>,
    pub(crate) curvature: Option<Curvature>,
    pub(crate) cover: Vec<CoverParams>,
    pub(crate) low_pass: Vec<LowPassParams>,
}

/// Most of a tilt, degrees.
const MAX_TILT_DEG: f64 = 80.0;
/// Thickest plate, mm.
const MAX_PLATE_MM: f64 = 100.0;
/// Most of a shift, mm.
const MAX_SHIFT_MM: f64 = 1e5;

impl Frame {
    /// Checks it, before anything is allocated by it.
    pub(crate) fn plane(&self, params: &Params, context: &Context<'_>) -> Result<Plane, Faults> {
        let mut faults = Faults::new();
        let size = faults.take(self.size(params));
        if let Some(size) = &size {
            self.warn_unless_square(size, params, context);
        }
        let standing = faults.take(self.standing(params, size));
        let plates = faults.take(self.plates(params, context));
        match (size, standing, plates) {
            (Some(size), Some(standing), Some(plates)) => {
                faults.into_result(Plane::new(size).standing(standing).behind(plates))
            }
            _ => Err(faults),
        }
    }

    /// The plates before it.
    fn plates(&self, params: &Params, context: &Context<'_>) -> Result<Plates, Faults> {
        let mut faults = Faults::new();
        let catalogue = Catalogue::bundled();
        let grid = &context.grid;
        let mut plates = Vec::new();
        let thick = |thickness: &Positive<Length>, key: String| {
            let mm = thickness.mm();
            let fault = || params.fault(&key, format!("a plate of {mm} mm")).hint(format!("at most {MAX_PLATE_MM} mm"));
            if mm <= MAX_PLATE_MM { Ok(mm) } else { Err(fault()) }
        };
        for (i, plate) in self.cover.iter().enumerate() {
            let key = |name: &str| format!("cover[{i}].{name}");
            let medium = spectra_glass::file::medium(&plate.glass, params, &key("glass"), context.resources);
            let filter = plate.transmittance.as_ref().map(|name| find_transmittance_in(name, context.resources));
            let filter = filter.transpose().map_err(|e| e.faults(|text| params.fault(&key("transmittance"), text)));
            let (medium, filter) = (faults.take(medium), faults.take(filter));
            if let (Some(mm), Some(medium), Some(filter)) =
                (faults.take(thick(&plate.thickness, key("thickness"))), medium, filter)
            {
                plates.push(Plate::glass(&medium, mm, |w| filter.as_ref().map_or(1.0, |f| f.at(w)), grid));
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
                found.map_err(|e| params.fault(&key("crystal"), e.to_string()).hint("quartz or lithium-niobate"))
            };
            let (ordinary, extraordinary) = (faults.take(ray("o")), faults.take(ray("e")));
            let mm = faults.take(thick(&plate.thickness, key("thickness")));
            if let (Some(mm), Some(o), Some(e)) = (mm, ordinary, extraordinary) {
                plates.push(Plate::crystal(&o, &e, mm, plate.azimuth.map_or(0.0, Angle::rad), grid));
            }
        }
        if self.curvature.is_some() && !(self.cover.is_empty() && self.low_pass.is_empty()) {
            let key = if self.cover.is_empty() { "low-pass" } else { "cover" };
            faults.push(params.fault(key, "plates stand before a flat frame only").hint("leave `curvature` out"));
        }
        faults.into_result(Plates::new(grid, plates))
    }

    /// Its size.
    fn size(&self, params: &Params) -> Result<FrameSize, Faults> {
        let mut faults = Faults::new();
        let crop = faults.take(self.crop.as_ref().map(ratio).transpose());
        let size_mm = faults.take(self.size_mm(params));
        let (width_mm, height_mm) = match (size_mm.unwrap_or((1.0, 1.0)), crop.flatten()) {
            ((width, height), Some(ratio)) if width > height * ratio => (height * ratio, height),
            ((width, _), Some(ratio)) => (width, width / ratio),
            (size, None) => size,
        };
        let resolution = if matches!(self.resolution.node().value, Value::Number(_)) {
            let across = faults.take(self.resolution.parse::<u32>());
            across.map(|across| [across, square_px(across, height_mm / width_mm)])
        } else {
            faults.take(self.resolution.parse::<[u32; 2]>())
        };
        let Some([width_px, height_px]) = resolution else { return Err(faults) };
        faults.extend(resolution_faults([width_px, height_px], params));
        faults.into_result(FrameSize { width_px, height_px, width_mm, height_mm })
    }

    /// Pixels that are not square are rarely meant: the picture looks squeezed.
    fn warn_unless_square(&self, size: &FrameSize, params: &Params, context: &Context<'_>) {
        let [across, down] = [size.width_px, size.height_px];
        let ratio = size.height_mm / size.width_mm;
        // As near to square as whole numbers of pixels come is square.
        if down.abs_diff(square_px(across, ratio)) <= 1 || across.abs_diff(square_px(down, 1.0 / ratio)) <= 1 {
            return;
        }
        let aspect = size.width_mm / f64::from(across) / (size.height_mm / f64::from(down));
        // Nobody sees 1 %.
        if (aspect - 1.0).abs() < 0.01 {
            return;
        }
        let text =
            format!("pixels are not square, but {aspect:.2} times as wide as high: the picture will look squeezed");
        let common = gcd(across, down);
        let hint = format!(
            "`resolution: [{across}, {}]`, or `crop: {}:{}` for a frame of that shape",
            square_px(across, ratio),
            across / common,
            down / common
        );
        context.warn(params.fault("resolution", text).hint(hint));
    }

    fn size_mm(&self, params: &Params) -> Result<(f64, f64), Fault> {
        match (&self.format, self.width, self.height) {
            (Some(name), None, None) => match format_named(name) {
                Some(format) => Ok((format.width_mm, format.height_mm)),
                None => {
                    let known = FORMATS.map(|f| f.name);
                    let fault = params.fault("format", format!("unknown format `{name}`"));
                    let hint = names::hint(name, &known, "spectra list format");
                    let other = if hint.starts_with("known: ") { "; or state width and height" } else { "" };
                    Err(fault.hint(format!("{hint}{other}")))
                }
            },
            (None, Some(width), Some(height)) => {
                let (width_mm, height_mm) = (width.mm(), height.mm());
                // Far beyond any camera; keeps areas and their inverses well inside of what a double holds.
                const RANGE_MM: std::ops::RangeInclusive<f64> = 1e-3..=1e5;
                for (key, mm) in [("width", width_mm), ("height", height_mm)] {
                    if !RANGE_MM.contains(&mm) {
                        return Err(params
                            .fault(key, format!("{mm} mm is out of range for the size of an imager"))
                            .hint("0.001 mm to 100 m"));
                    }
                }
                Ok((width_mm, height_mm))
            }
            (None, None, None) => Err(params
                .fault("format", "how large is the imager? `format` is missing")
                .hint("`format: 135`, or width and height")),
            (Some(_), ..) => {
                Err(params.fault("format", "the size is given twice").hint("either format, or width and height"))
            }
            (None, Some(_), None) => {
                Err(params.fault("width", "`height` is missing").hint("width and height go together"))
            }
            (None, None, Some(_)) => {
                Err(params.fault("height", "`width` is missing").hint("width and height go together"))
            }
        }
    }

    /// How it stands; `size` as far as it is known.
    fn standing(&self, params: &Params, size: Option<FrameSize>) -> Result<Standing, Faults> {
        let mut faults = Faults::new();
        let shift_mm = self.shift.map_or([0.0; 2], |shift| shift.map(Length::mm));
        for (i, mm) in shift_mm.into_iter().enumerate().filter(|(_, mm)| !(mm.abs() <= MAX_SHIFT_MM)) {
            faults.push(params.fault(&format!("shift[{i}]"), format!("a shift of {mm} mm")).hint("at most 100 m"));
        }
        let tilt_rad = self.tilt.map_or([0.0; 2], |tilt| tilt.map(Angle::rad));
        for (i, rad) in tilt_rad.into_iter().enumerate().filter(|(_, t)| !(t.to_degrees().abs() <= MAX_TILT_DEG)) {
            let text = format!("{} degrees turn the frame away from the lens", rad.to_degrees());
            faults.push(params.fault(&format!("tilt[{i}]"), text).hint(format!("at most {MAX_TILT_DEG} degrees")));
        }
        let bend = self.curvature.as_ref().and_then(|c| faults.take(bend(c, params, size))).unwrap_or(Bend::Flat);
        faults.into_result(Standing::new(shift_mm, tilt_rad, bend))
    }
}

/// Pixels down that are square, for those across and height over width of the frame.
fn square_px(across: u32, ratio: f64) -> u32 {
    (f64::from(across) * ratio).round().clamp(1.0, f64::from(u32::MAX)) as u32
}

fn gcd(a: u32, b: u32) -> u32 {
    if b == 0 { a.max(1) } else { gcd(b, a % b) }
}

/// Width over height: a number, or two with a colon between them.
fn ratio(node: &StageNode) -> Result<f64, Fault> {
    let found = match &node.node().value {
        Value::Number(number) => Some(number.value),
        Value::String(text) => text.split_once(':').and_then(|(width, height)| {
            let [width, height] = [width, height].map(|side| side.trim().parse::<f64>().ok());
            Some(width? / height?)
        }),
        _ => None,
    };
    found.filter(|ratio| (0.01..=100.0).contains(ratio)).ok_or_else(|| {
        node.fault("not a frame shape").hint("width to height, as in `crop: 16:9`, or their ratio, as in `crop: 1.85`")
    })
}

fn resolution_faults(resolution: [u32; 2], params: &Params) -> Vec<Fault> {
    let mut faults = Vec::new();
    for (i, px) in resolution.into_iter().enumerate() {
        if !(1..=MAX_SIDE_PX).contains(&px) {
            let text = format!("a side of {px} pixels is out of range");
            faults.push(params.fault(&format!("resolution[{i}]"), text).hint(format!("1 to {MAX_SIDE_PX}")));
        }
    }
    let [width, height] = resolution.map(u64::from);
    if faults.is_empty() && width * height > MAX_PIXELS {
        let text = format!("{width} x {height} are {} megapixels", width * height / 1_000_000);
        faults.push(params.fault("resolution", text).hint(format!("at most {}", MAX_PIXELS / 1_000_000)));
    }
    faults
}

/// The bend, which must leave the frame well within a half of the cylinder or sphere.
fn bend(curvature: &Curvature, params: &Params, size: Option<FrameSize>) -> Result<Bend, Fault> {
    let radius_mm = curvature.radius.mm();
    let bend = match curvature.shape.as_str() {
        "cylinder" => Bend::Cylinder { radius_mm },
        "sphere" => Bend::Sphere { radius_mm },
        other => {
            let fault = params.fault("curvature.shape", format!("unknown shape `{other}`"));
            return Err(fault.hint("cylinder (bent along x) or sphere"));
        }
    };
    let Some(size) = size else { return Ok(bend) };
    let least_mm = bend.least_radius_mm(size.width_mm, size.height_mm);
    if !(radius_mm.abs() >= least_mm && radius_mm.is_finite()) {
        let text = format!("a radius of {radius_mm} mm bends the frame by more than 60 degrees");
        return Err(params.fault("curvature.radius", text).hint(format!("at least {least_mm:.4} mm, either sign")));
    }
    Ok(bend)
}
