//! `kind: layer` and `kind: stack`: the layers evaporated on the glass, written out.

use super::{Coating, CoatingEntry, Stack, StackLayer};
use schemars::JsonSchema;
use serde::Deserialize;
use spectra_core::params::{Deferred, Fault, Faults, NonNegative, Params, Wavelength};
use spectra_core::registry::Context;
use spectra_core::resources::Resources;
use spectra_glass::{Medium, file};
use std::sync::Arc;

/// One dielectric layer of constant index.
///
/// Its index is the same at all wavelengths. Its thickness is stated directly, or as a quarter of a wave at a given wavelength. A
/// coating without `kind` that has a `layer` is of this kind.
///
/// # Example
/// ```yaml
/// {kind: layer, layer: 1.38, quarter-wave-at: 550 nm}
/// ```
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
struct OneLayer {
    /// Refractive index of the layer, 1 to 5; magnesium fluoride has 1.38.
    #[schemars(range(min = 1, max = 5))]
    layer: f64,
    /// Thickness, nm if bare.
    thickness: Option<Wavelength>,
    /// Wavelength at which the layer is a quarter of a wave thick, nm if bare.
    quarter_wave_at: Option<Wavelength>,
}

/// Any number of layers, each of a material or of a stated index.
///
/// Materials disperse and absorb as the catalogue or their file says. A coating without `kind` that has `layers` is of this kind.
///
/// # Example
/// ```yaml
/// kind: stack
/// layers:
///   - {index: 1.38, quarter-wave-at: 520 nm}
///   - {index: 1.70, quarter-wave-at: 520 nm}
/// ```
///
/// # References
/// - H. A. Macleod, Thin-Film Optical Filters, chapter 2.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
pub(super) struct StackParams {
    /// Layers of the stack, the one next to the air first, 1 to 500; for glass without layers write `bare`.
    #[schemars(length(min = 1, max = 500))]
    layers: Vec<Deferred<LayerOfStack>>,
}

/// One layer of a stack.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
struct LayerOfStack {
    /// Material of the layer: a medium in the catalogue, or a glass file.
    material: Option<String>,
    /// Refractive index, 0.01 to 10, the same at all wavelengths; instead of `material`.
    #[schemars(range(min = 0.01, max = 10))]
    index: Option<f64>,
    /// Extinction coefficient k, together with `index`; 0 if absent.
    k: Option<NonNegative<f64>>,
    /// Thickness, nm if bare.
    thickness: Option<Wavelength>,
    /// Wavelength at which the layer is a quarter of a wave thick, nm if bare.
    quarter_wave_at: Option<Wavelength>,
}

/// Largest thickness of a layer, nm.
const MAX_NM: f64 = 1e5;

spectra_core::register!(CoatingEntry, "layer" (default): OneLayer, layer);
spectra_core::register!(CoatingEntry, "stack": StackParams, stack);

fn layer(params: &Params, _: &Context<'_>) -> Result<Box<Coating>, Faults> {
    let p: OneLayer = params.parse()?;
    let thickness_nm = thickness(params, "", p.thickness, p.quarter_wave_at, |_| p.layer)?;
    Ok(Box::new(Coating::Layer { index: p.layer, thickness_nm }))
}

pub(super) fn stack(params: &Params, context: &Context<'_>) -> Result<Box<Coating>, Faults> {
    let p: StackParams = params.parse()?;
    let mut faults = Faults::new();
    let layer = |(i, node)| faults.take(layer_of_stack(params, i, node, context.resources));
    let layers: Vec<StackLayer> = p.layers.iter().enumerate().filter_map(layer).collect();
    faults.into_result(Box::new(Coating::Stack(Arc::new(Stack::new(layers)))))
}

fn layer_of_stack(
    params: &Params,
    i: usize,
    node: &Deferred<LayerOfStack>,
    resources: &dyn Resources,
) -> Result<StackLayer, Faults> {
    let p: LayerOfStack = node.read()?;
    let at = format!("layers[{i}]");
    match (&p.material, p.index) {
        (Some(name), None) => {
            if p.k.is_some() {
                return Err(params.fault(&format!("{at}.k"), "a material has its own k").hint("leave `k` out").into());
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

/// Computes the thickness of a layer, nm; `at` is the path of the layer in the file.
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
            let text = "a layer needs either a `thickness` or a wavelength `quarter-wave-at`";
            let fault = if at.is_empty() { params.fault_here(text) } else { params.fault(at, text) };
            return Err(fault.hint("such as {layer: 1.38, quarter-wave-at: 550 nm}"));
        }
    };
    if !(nm <= MAX_NM && given.nm() <= MAX_NM) {
        return Err(params.fault(&key(name), "a thin layer is at most 100 um thick"));
    }
    Ok(nm)
}

/// Complex index n, k of a medium. Outside the measured range the end values are used.
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
