//! The layers of a stock's file: their keys, and the checks that go beyond types.

use super::material::DyeFile;
use super::sensitivity_file::{SensitivityFile, sensitivity};
use super::structure::{granularity, mtf};
use super::{Development, Layer};
use crate::curve::{
    AVERAGE_GRADIENT_SPAN, CharacteristicCurve, CurveError, SPEED_POINT_DENSITY, TabulatedCurve, ToeShoulder,
};
use schemars::JsonSchema;
use serde::Deserialize;
use spectra_core::math::log10;
use spectra_core::params::{Fault, Faults, Params, Positive};
use spectra_core::resources::Resources;
use spectra_core::spectral::BAND;
use spectra_spectrum::Emission;

#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
pub(super) struct LayerFile {
    /// Name of the layer and of its channel; different for each layer.
    name: String,
    /// Spectral sensitivity, of which only the shape counts: the speed is in the curve.
    sensitivity: SensitivityFile,
    /// Dye that forms in the layer; silver if absent.
    pub(super) dye: Option<DyeFile>,
    /// Modulation transfer of the emulsion: pairs of spatial frequency (cycles/mm, ascending) and response (0 to 2). Light is not
    /// spread if absent.
    #[serde(default)]
    mtf: Vec<[f64; 2]>,
    /// Granularity of a layer with a dye: pairs of density above the minimum (ascending) and 1000 times the standard deviation
    /// through 48 um. Both are measured on neutral film through the filter of the layer's dye. No grain if absent.
    #[serde(default)]
    granularity: Vec<[f64; 2]>,
    /// Characteristic curves, one for each development.
    curves: Vec<CurveFile>,
}

#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
struct CurveFile {
    /// Name of the development, by which a scene selects it.
    development: String,
    /// Development time, min; not known if absent. Curves with a time form a series, in which a scene can `push`.
    minutes: Option<Positive<f64>>,
    /// Whether it was chosen rather than measured; then `remark` says why.
    #[serde(default)]
    assumed: bool,
    /// Remarks for people: developer, temperature, doubts.
    remark: Option<String>,
    /// The printed curve: pairs of log10 exposure (lx s of the reference illuminant, ascending) and density. Replaces the four
    /// numbers below.
    points: Option<Vec<[f64; 2]>>,
    /// Slope of an assumed curve: that of the chord from the speed point, 0.8/S lx s, over 1.5 in log10 exposure.
    average_gradient: Option<f64>,
    /// Maximum density of an assumed curve, above base and fog.
    maximum_density: Option<f64>,
    /// Width of the toe of an assumed curve, log10 of exposure, above 0 to 2.
    #[schemars(extend("exclusiveMinimum" = 0, "maximum" = 2))]
    toe: Option<f64>,
    /// Sharpness of the shoulder of an assumed curve, 1 to 64.
    #[schemars(range(min = 1, max = 64))]
    shoulder: Option<f64>,
}

/// Reads the layers; those with faults are left out.
pub(super) fn layers(
    params: &Params,
    files: &[LayerFile],
    iso: Option<f64>,
    reference: Option<&Emission>,
    resources: &dyn Resources,
    faults: &mut Faults,
) -> Vec<Layer> {
    let mut layers: Vec<Layer> = Vec::new();
    for (i, layer) in files.iter().enumerate() {
        let at = format!("layers[{i}]");
        if layer.name.is_empty() || files[..i].iter().any(|l| l.name == layer.name) {
            faults.push(
                params.fault(
                    &format!("{at}.name"),
                    "each layer needs a name of its own, which is also that of its channel",
                ),
            );
        }
        if layer.sensitivity.assumed && layer.sensitivity.remark.as_ref().is_none_or(|r| r.trim().is_empty()) {
            let fault = params.fault(&format!("{at}.sensitivity.assumed"), "an assumed sensitivity needs a remark");
            faults.push(fault.hint("add a `remark` that says what it is based on"));
        }
        let sensitivity = faults.take(sensitivity(params, &at, &layer.sensitivity, resources));
        let developments = faults.take(developments(params, &at, &layer.curves, iso));
        let dye = match &layer.dye {
            Some(dye) => faults.take(dye.read(params, &at)).map(Some),
            None => Some(None),
        };
        let mtf = faults.take(mtf(params, &at, &layer.mtf));
        let grain = faults.take(granularity(params, &at, &layer.granularity));
        let (Some(sensitivity), Some(developments), Some(dye), Some(mtf), Some(granularity)) =
            (sensitivity, developments, dye, mtf, grain)
        else {
            continue;
        };
        if let Some(reference) = reference
            && let Err(error) = sensitivity.channel(&layer.name, reference, &BAND)
        {
            let (first, last) = sensitivity.range_nm();
            let fault = params.fault(&format!("{at}.sensitivity"), error.to_string());
            faults.push(fault.hint(format!(
                "its table runs from {first} to {last} nm; light is computed from {} to {} nm",
                BAND.start_nm,
                BAND.end_nm()
            )));
        }
        let (name, remark, assumed) = (layer.name.clone(), layer.sensitivity.remark.clone(), layer.sensitivity.assumed);
        layers.push(Layer { name, sensitivity, assumed, remark, dye, mtf, granularity, developments });
    }
    layers
}

fn developments(params: &Params, at: &str, files: &[CurveFile], iso: Option<f64>) -> Result<Vec<Development>, Faults> {
    let mut faults = Faults::new();
    if files.is_empty() {
        faults.push(params.fault(&format!("{at}.curves"), "a layer has at least one curve"));
    }
    let mut developments: Vec<Development> = Vec::new();
    for (i, file) in files.iter().enumerate() {
        let at = format!("{at}.curves[{i}]");
        if files[..i].iter().any(|f| f.development == file.development) {
            faults.push(params.fault(&format!("{at}.development"), "each curve has a development of its own"));
        }
        if file.assumed && file.remark.as_ref().is_none_or(|r| r.trim().is_empty()) {
            let hint = "add a `remark` that says what it is based on";
            faults.push(params.fault(&format!("{at}.assumed"), "an assumed curve needs a remark").hint(hint));
        }
        if let Some(curve) = faults.take(curve(params, &at, file, iso)) {
            let (name, remark) = (file.development.clone(), file.remark.clone());
            let minutes = file.minutes.map(|m| m.get());
            developments.push(Development { name, minutes, assumed: file.assumed, remark, curve });
        }
    }
    faults.into_result(developments)
}

fn curve(params: &Params, at: &str, file: &CurveFile, iso: Option<f64>) -> Result<CharacteristicCurve, Fault> {
    let shape = [
        ("average-gradient", file.average_gradient),
        ("maximum-density", file.maximum_density),
        ("toe", file.toe),
        ("shoulder", file.shoulder),
    ];
    if let Some(points) = &file.points {
        if let Some((key, _)) = shape.iter().find(|(_, v)| v.is_some()) {
            return Err(params.fault(&format!("{at}.{key}"), "a curve given by `points` can have no other shape"));
        }
        return TabulatedCurve::new(points).map(Into::into).map_err(|error| {
            let (key, hint) = match &error {
                CurveError::Order { index, .. } => (
                    format!("{at}.points[{}]", index.saturating_sub(1)),
                    "pairs of log10 exposure (lx s), increasing, and density, which only rises or only falls",
                ),
                _ => (format!("{at}.points"), "two or more pairs of log10 exposure (lx s) and density"),
            };
            params.fault(&key, error.to_string()).hint(hint)
        });
    }
    let missing: Vec<&str> = shape.iter().filter(|(_, v)| v.is_none()).map(|(key, _)| *key).collect();
    let [Some(gradient), Some(maximum), Some(toe), Some(shoulder)] = shape.map(|(_, v)| v) else {
        let text = format!("the curve has no {}", missing.join(", "));
        return Err(params.fault(at, text).hint("or `points`: pairs of log10 exposure (lx s) and density"));
    };
    let Some(iso) = iso else {
        let text = "without a speed, a curve must be given by `points`";
        return Err(params.fault(at, text).hint("pairs of log10 exposure (lx s) and density"));
    };
    // ISO 6:1993: the exposure 0.8/S lx s gives the density 0.1 above base and fog.
    let low = [log10(0.8 / iso), SPEED_POINT_DENSITY];
    let high = [low[0] + AVERAGE_GRADIENT_SPAN, low[1] + AVERAGE_GRADIENT_SPAN * gradient];
    ToeShoulder::through(low, high, toe, maximum, shoulder).map(Into::into).map_err(|error| {
        let key = match &error {
            CurveError::ToeTooLong { .. } | CurveError::OutOfRange { what: "toe", .. } => ".toe",
            CurveError::OutOfRange { what: "shoulder", .. } => ".shoulder",
            CurveError::OutOfRange { what: "maximum density", .. } => ".maximum-density",
            CurveError::OutOfRange { what: "density of the second point", .. } => ".average-gradient",
            _ => "",
        };
        params.fault(&format!("{at}{key}"), error.to_string())
    })
}

/// Returns faults for layers with other developments than the first: layers are developed together.
pub(super) fn unlike_developments(params: &Params, layers: &[LayerFile]) -> Vec<Fault> {
    let names = |layer: &LayerFile| layer.curves.iter().map(|c| c.development.clone()).collect::<Vec<_>>();
    let Some(first) = layers.first().map(names) else {
        return Vec::new();
    };
    let unlike = layers.iter().enumerate().filter(|(_, layer)| names(layer) != first);
    let text = format!("each layer needs the developments of the first layer: {}", first.join(", "));
    unlike.map(|(i, _)| params.fault(&format!("layers[{i}].curves"), &text)).collect()
}
