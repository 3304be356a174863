//! Coatings as lens files, scenes and files of their own write them.

use super::standard::CoatingName;
use super::{Coating, MeasuredCoating, Stack, StackLayer};
use schemars::JsonSchema;
use serde::Deserialize;
use spectra_core::params::{Fault, Faults, NonNegative, Params, Part, StageNode, Wavelength, Whole, nearest};
use spectra_core::resources::{Resources, beside};
use spectra_glass::Medium;
use spectra_glass::file;
use std::sync::Arc;

/// A layer as a file writes it.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
pub struct OneLayer {
    /// Refractive index of the layer, 1 to 5; magnesium fluoride has 1.38.
    #[schemars(range(min = 1, max = 5))]
    layer: f64,
    /// Thickness, nm if bare.
    thickness: Option<Wavelength>,
    /// Wavelength at which it is a quarter of a wave thick, nm if bare.
    quarter_wave_at: Option<Wavelength>,
    /// Whether it is assumed of the lens, not known.
    #[serde(default)]
    assumed: bool,
}

/// A coating by its name, as a map.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
pub struct NamedCoating {
    /// `ideal` (all light passes), `bare` (Fresnel's formulas), `single-layer` (a quarter wave of magnesium fluoride at 550 nm)
    /// or `three-layer` (a quarter wave of index 1.38, half a wave of 2.10, a quarter wave of 1.72, at 515 nm).
    kind: CoatingName,
    /// Whether it is assumed of the lens, not known.
    #[serde(default)]
    assumed: bool,
}

/// A stack, written out or in a file of its own.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
pub struct StackParams {
    /// Version of the format.
    #[expect(dead_code, reason = "its schema allows one version")]
    spectra: Option<Whole<1, 1>>,
    /// Name for people.
    #[expect(dead_code, reason = "for the reader of the file")]
    name: Option<String>,
    /// Where the figures come from.
    #[expect(dead_code, reason = "for the reader of the file")]
    source: Option<String>,
    /// Terms under which they came.
    #[expect(dead_code, reason = "for the reader of the file")]
    licence: Option<String>,
    /// What else is worth knowing.
    #[expect(dead_code, reason = "for the reader of the file")]
    remark: Option<String>,
    /// Whether it is assumed of the lens, not known.
    #[serde(default)]
    assumed: bool,
    /// The layers, the one next to the air first, 1 to 500; without any it is `bare`.
    #[schemars(length(min = 1, max = 500))]
    layers: Vec<Part<LayerOfStack>>,
}

/// A layer of a stack.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
struct LayerOfStack {
    /// A medium of the catalogue, or a glass file.
    material: Option<String>,
    /// Refractive index in place of a material, 0.01 to 10, the same at all wavelengths.
    #[schemars(range(min = 0.01, max = 10))]
    index: Option<f64>,
    /// Extinction coefficient beside `index`.
    k: Option<NonNegative<f64>>,
    /// Thickness, nm if bare.
    thickness: Option<Wavelength>,
    /// Wavelength at which it is a quarter of a wave thick, nm if bare.
    quarter_wave_at: Option<Wavelength>,
}

/// What a coating is written as.
#[derive(JsonSchema)]
#[serde(untagged)]
pub enum CoatingForm {
    /// `ideal` (all light passes), `bare` (Fresnel's formulas), `single-layer` (magnesium fluoride), `three-layer`, or a file:
    /// `my-stack.yaml`, `my-coating.csv`.
    Named(String),
    /// By name, and whether it is assumed.
    Kind(NamedCoating),
    /// One layer.
    Layer(OneLayer),
    /// Several layers.
    Stack(StackParams),
}

/// Coatings with a name.
const NAMED: [&str; 4] = ["ideal", "bare", "single-layer", "three-layer"];
const HINT: &str = "ideal, bare, single-layer, three-layer, {layer: 1.38, quarter-wave-at: 550 nm}, {layers: [...]}, or a file: my-stack.yaml, my-coating.csv";
/// Thickest layer, nm.
const MAX_NM: f64 = 1e5;
/// Largest measurement that is read, bytes.
const MAX_BYTES: u64 = 4 << 20;

/// A coating, and whether it is known of the lens.
#[derive(Clone, Debug, PartialEq)]
pub struct StatedCoating {
    /// The coating.
    pub coating: Coating,
    /// Whether it is assumed, as of lenses of the time.
    pub assumed: bool,
}

/// Reads a name (`ideal`, `bare`, `single-layer`, `three-layer`), a layer, a stack of layers, or the name of a file:
/// `my-stack.yaml` with layers, or `my-coating.csv` with a measured reflectance or transmittance.
///
/// # Errors
/// What is wrong with it, placed; what is wrong with the file, placed there.
pub fn read_coating(node: &StageNode, resources: &dyn Resources) -> Result<Coating, Faults> {
    Ok(read_stated_coating(node, resources)?.coating)
}

/// The same, with what is said of how it is known.
///
/// # Errors
/// As [`read_coating`].
pub fn read_stated_coating(node: &StageNode, resources: &dyn Resources) -> Result<StatedCoating, Faults> {
    if let Some(name) = node.node().as_str() {
        let coating = Coating::by_name(name).map_or_else(|| named(name, node, resources), Ok)?;
        return Ok(StatedCoating { coating, assumed: false });
    }
    let params = Params::section(node.node().clone(), node.path())?;
    if params.get("layers").is_some() {
        return stack(&params, resources);
    }
    if params.get("kind").is_some() {
        let p: NamedCoating = params.parse()?;
        return Ok(StatedCoating { coating: p.kind.coating(), assumed: p.assumed });
    }
    let p: OneLayer = params.parse()?;
    let thickness_nm = thickness(&params, "", p.thickness, p.quarter_wave_at, |_| p.layer)?;
    Ok(StatedCoating { coating: Coating::Layer { index: p.layer, thickness_nm }, assumed: p.assumed })
}

/// Thickness, nm; `at` is the path of the layer.
fn thickness(
    params: &Params,
    at: &str,
    stated: Option<Wavelength>,
    quarter_wave: Option<Wavelength>,
    index: impl Fn(f64) -> f64,
) -> Result<f64, Fault> {
    let key = |name: &str| if at.is_empty() { name.to_owned() } else { format!("{at}.{name}") };
    let (given, nm, name) = match (stated, quarter_wave) {
        (Some(thickness), None) => (thickness, thickness.nm(), "thickness"),
        (None, Some(wave)) => (wave, 0.25 * wave.nm() / index(wave.nm()), "quarter-wave-at"),
        _ => {
            let text = "a layer has either a `thickness` or is `quarter-wave-at` a wavelength";
            let fault = if at.is_empty() { params.fault_here(text) } else { params.fault(at, text) };
            return Err(fault.hint("such as {layer: 1.38, quarter-wave-at: 550 nm}"));
        }
    };
    if !(nm <= MAX_NM && given.nm() <= MAX_NM) {
        return Err(params.fault(&key(name), "a thin layer is at most 100 um thick"));
    }
    Ok(nm)
}

/// The coating of a file.
fn named(name: &str, node: &StageNode, resources: &dyn Resources) -> Result<Coating, Faults> {
    let (path, column) = match name.rsplit_once('#') {
        Some((file, column)) => (file.trim(), Some(column.trim())),
        None => (name, None),
    };
    let ending = path.rsplit_once('.').map(|(_, ending)| ending.to_ascii_lowercase());
    let found = beside(node.node(), path);
    match ending.as_deref() {
        Some("yaml" | "yml") => {
            let params = resources.document(&found, &[], &[]).map_err(|faults| placed(faults, node))?;
            Ok(stack(&params, resources)?.coating)
        }
        Some("csv") => {
            let fault = |text: String| node.fault(text);
            let file = resources.read(&found, &[], &[], MAX_BYTES);
            let file = file.map_err(|e| fault(format!("`{path}`: {e}")))?;
            let measured = MeasuredCoating::from_table(&file.name, &file.bytes, column);
            measured.map(|m| Coating::Measured(Arc::new(m))).map_err(|e| e.faults(fault))
        }
        _ => {
            let fault = node.fault(format!("unknown coating `{name}`"));
            Err(fault
                .hint(nearest(name, NAMED).map_or_else(|| HINT.to_owned(), |near| format!("did you mean `{near}`?")))
                .into())
        }
    }
}

/// A file that is not found has no place: the value that names it has.
fn placed(faults: Faults, node: &StageNode) -> Faults {
    let place = |fault: Fault| {
        if fault.place.is_some() {
            return fault;
        }
        Fault { hint: fault.hint, ..node.fault(fault.message) }
    };
    faults.into_iter().map(place).collect::<Vec<_>>().into()
}

fn stack(params: &Params, resources: &dyn Resources) -> Result<StatedCoating, Faults> {
    let p: StackParams = params.parse()?;
    let mut faults = Faults::new();
    let layers = p.layers.iter().enumerate().filter_map(|(i, node)| faults.take(layer(params, i, node, resources)));
    let layers: Vec<StackLayer> = layers.collect();
    faults.into_result(StatedCoating { coating: Coating::Stack(Arc::new(Stack::new(layers))), assumed: p.assumed })
}

fn layer(params: &Params, i: usize, node: &StageNode, resources: &dyn Resources) -> Result<StackLayer, Faults> {
    let p: LayerOfStack = node.parse()?;
    let at = format!("layers[{i}]");
    match (&p.material, p.index) {
        (Some(name), None) => {
            if p.k.is_some() {
                return Err(params.fault(&format!("{at}.k"), "a material has its own k").hint("leave it out").into());
            }
            let medium = file::medium(name, params, &format!("{at}.material"), resources)?;
            let n_and_k = n_and_k(&medium);
            let thickness_nm = thickness(params, &at, p.thickness, p.quarter_wave_at, |nm| n_and_k(nm)[0])?;
            Ok(StackLayer::dispersive(thickness_nm, n_and_k))
        }
        (None, Some(index)) => {
            let thickness_nm = thickness(params, &at, p.thickness, p.quarter_wave_at, |_| index)?;
            Ok(StackLayer::constant(thickness_nm, index, p.k.map_or(0.0, |k| k.get())))
        }
        _ => {
            let fault = params.fault(&at, "a layer has either a `material` or an `index`");
            Err(fault
                .hint("{material: magnesium fluoride, thickness: 99.6 nm}, or {index: 1.38, thickness: 99.6 nm}")
                .into())
        }
    }
}

/// n and k of a medium, held at the ends of what is known of it.
fn n_and_k(medium: &Medium) -> impl Fn(f64) -> [f64; 2] + '_ {
    move |nm| {
        let n = medium.range_nm().map_or(nm, |(from, to)| nm.clamp(from, to));
        let k = match medium {
            Medium::Glass(glass) => glass.extinction.as_ref().and_then(|k| {
                let (from, to) = k.range_nm();
                k.at(nm.clamp(from, to))
            }),
            _ => None,
        };
        [medium.index(n), k.unwrap_or(0.0)]
    }
}
