//! The `output` section: what a scene wants written.

use crate::{Output, RaysFigure};
use schemars::{JsonSchema, Schema, SchemaGenerator};
use serde::Deserialize;
use spectra_core::params::{Fault, Faults, Kinds, Length, Params, Positive, StageNode, Whole, nearest};
use spectra_pictures::library;

/// `kind: exr`: the linear exposure.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
struct ExrParams {
    /// In tiles, for viewers that read a part of a large file; needs a program built with OpenImageIO.
    #[serde(default)]
    tiled: bool,
}

/// `kind: rays`: the light's way through the lens, as a figure.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
struct RaysParams {
    /// Width and height, pixels, each 64 to 8192.
    #[serde(default = "rays_size")]
    size: [Whole<64, 8192>; 2],
    /// Width of what is shown, mm if bare; fitted to the lens if absent.
    view: Option<Positive<Length>>,
    /// Rays across the beam for each wavelength, 1 to 1001.
    #[serde(default = "rays_across")]
    rays: Whole<1, 1001>,
    /// Wavelengths over a continuous spectrum, 1 to 4001.
    #[serde(default = "rays_wavelengths")]
    wavelengths: Whole<1, 4001>,
    /// How bright colors are: `full` (the default; all alike) or `true` (relative to the brightest).
    #[schemars(extend("enum" = ["full", "true"]))]
    intensity: Option<String>,
    /// What it is drawn on: `dark` (the default) or `light`.
    #[schemars(extend("enum" = ["dark", "light"]))]
    ground: Option<String>,
    /// What it is written as: `png` (the default) or `svg`.
    #[schemars(extend("enum" = ["png", "svg"]))]
    format: Option<String>,
    /// Whether the image plane is drawn, and ends the rays.
    #[serde(default)]
    screen: bool,
}

fn rays_size() -> [Whole<64, 8192>; 2] {
    [Whole::known(800), Whole::known(600)]
}

fn rays_across() -> Whole<1, 1001> {
    Whole::known(1)
}

fn rays_wavelengths() -> Whole<1, 4001> {
    Whole::known(64)
}

/// What an item of the section is written as.
pub(crate) struct OutputForm;

impl JsonSchema for OutputForm {
    fn schema_name() -> std::borrow::Cow<'static, str> {
        "Output".into()
    }

    fn json_schema(generator: &mut SchemaGenerator) -> Schema {
        let kinds = KINDS.iter().map(|kind| match *kind {
            "exr" => (*kind, ExrParams::json_schema(generator)),
            "rays" => (*kind, RaysParams::json_schema(generator)),
            _ => (*kind, NoParams::json_schema(generator)),
        });
        let kinds = kinds.collect();
        Kinds { key: "kind", kinds, default: None, shared: None, by_name: true }.schema()
    }
}

const KINDS: [&str; 5] = ["exr", "png", "tiff", "dng", "rays"];

/// Reads the section; EXR and PNG where it is absent.
pub(crate) fn read(items: Option<&[StageNode]>) -> Result<Vec<Output>, Faults> {
    let Some(items) = items else { return Ok(vec![Output::Exr, Output::Png]) };
    let mut faults = Faults::new();
    let mut found = Vec::new();
    for item in items {
        let Some(params) = faults.take(item.params()) else { continue };
        let own = match params.kind() {
            Some("exr") => exr(&params),
            Some("png") => nothing_more(&params).map(|()| Output::Png),
            Some("tiff") => nothing_more(&params).map(|()| Output::Tiff),
            Some("dng") => nothing_more(&params).map(|()| Output::Dng),
            Some("rays") => rays(&params).map(Output::Rays),
            Some(other) => {
                let fault = item.fault(format!("unknown kind of output `{other}`"));
                let known = KINDS.join(", ");
                Err(match nearest(other, KINDS) {
                    Some(near) => fault.hint(format!("did you mean `{near}`? One of {known}")),
                    None => fault.hint(format!("one of {known}")),
                }
                .into())
            }
            None => Err(item.fault("an output needs a kind").hint(format!("one of {}", KINDS.join(", "))).into()),
        };
        found.extend(faults.take(own));
    }
    if found.contains(&Output::Exr) && found.contains(&Output::TiledExr) {
        let fault = items.iter().filter_map(|item| item.params().ok()).find(|params| params.get("tiled").is_some());
        let fault = fault.map(|params| params.fault("tiled", "the same file is asked for in rows and in tiles"));
        faults.push(fault.unwrap_or_else(|| Fault::new("one file in rows and in tiles")).hint("leave one `exr` out"));
    }
    let mut once: Vec<Output> = Vec::new();
    for output in found {
        if !once.iter().any(|o| std::mem::discriminant(o) == std::mem::discriminant(&output)) {
            once.push(output);
        }
    }
    faults.into_result(once)
}

#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
struct NoParams {}

fn nothing_more(params: &Params) -> Result<(), Faults> {
    params.parse::<NoParams>().map(|_| ())
}

fn exr(params: &Params) -> Result<Output, Faults> {
    let p: ExrParams = params.parse()?;
    if !p.tiled {
        return Ok(Output::Exr);
    }
    if library::library().is_none() {
        let fault = params.fault("tiled", "tiled OpenEXR files are written by OpenImageIO only");
        return Err(fault.hint(library::WITHOUT).into());
    }
    Ok(Output::TiledExr)
}

fn rays(params: &Params) -> Result<RaysFigure, Faults> {
    let p: RaysParams = params.parse()?;
    let mut faults = Faults::new();
    let [width_px, height_px] = p.size.map(Whole::get_u32);
    let (rays, wavelengths) = (p.rays.get_u32(), p.wavelengths.get_u32());
    let mut second_of = |key: &str, value: &Option<String>, known: [&str; 2]| match value.as_deref() {
        None => false,
        Some(v) if v == known[0] => false,
        Some(v) if v == known[1] => true,
        Some(other) => {
            faults.push(unknown(params, key, other, known));
            false
        }
    };
    let true_intensity = second_of("intensity", &p.intensity, ["full", "true"]);
    let light = second_of("ground", &p.ground, ["dark", "light"]);
    let svg = second_of("format", &p.format, ["png", "svg"]);
    faults.into_result(RaysFigure {
        width_px,
        height_px,
        rays,
        wavelengths,
        true_intensity,
        light,
        svg,
        screen: p.screen,
        view_mm: p.view.map(|v| v.mm()),
    })
}

fn unknown(params: &Params, key: &str, found: &str, known: [&str; 2]) -> Fault {
    params.fault(key, format!("unknown {key} `{found}`")).hint(format!("{} or {}", known[0], known[1]))
}
