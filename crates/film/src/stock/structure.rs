//! Structure of a film besides its sensitive layers: base, backing, granularity and modulation transfer.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use spectra_core::params::{Fault, Faults, Length, Params, Positive};

/// The base on which an emulsion is coated.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Base {
    /// Film formats with this base, as the sheet names them.
    pub formats: String,
    /// Material of the base, for example `acetate`.
    pub material: Option<String>,
    /// Thickness, mm.
    pub thickness_mm: f64,
    /// Refractive index; `None` if the sheet states none.
    pub index: Option<f64>,
    /// Whether thickness and index are assumed.
    pub assumed: bool,
}

/// RMS granularity: 1000 times the standard deviation of density through a round aperture.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Granularity {
    /// RMS granularity of the sheet.
    pub rms: f64,
    /// Diameter of the aperture, mm; usually 0.048.
    pub aperture_mm: f64,
    /// Density at which it was measured; usually 1.
    pub density: f64,
    /// Whether the value is assumed.
    pub assumed: bool,
}

/// Anti-halation backing, which absorbs light at the film's back. Makers name the kind and no figure: the figures are assumed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize, Serialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
#[schemars(inline)]
pub enum Backing {
    /// Soot in a binder on the back, washed off before development: absorbs nearly all light.
    RemJet,
    /// Fine silver under the emulsion, bleached in processing: absorbs most light.
    Silver,
    /// A dye under the emulsion or in the base: absorbs some light.
    Dye,
    /// No backing, or one that was removed before exposure: clear base.
    Removed,
}

impl Backing {
    /// Returns the assumed transmittance of base and backing, for one pass.
    #[must_use]
    pub fn transmittance(self) -> f64 {
        match self {
            Self::RemJet => 0.12,
            Self::Silver => 0.2,
            Self::Dye => 0.35,
            Self::Removed => 0.95,
        }
    }

    /// Name of this kind in a file.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::RemJet => "rem-jet",
            Self::Silver => "silver",
            Self::Dye => "dye",
            Self::Removed => "removed",
        }
    }
}

/// Halation: light that returns from the film's back.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Halation {
    /// Light that enters the base, relative to the light that exposes the layer next to the base, 0 to 1.
    pub scattered: f64,
    /// Transmittance of base and backing for one pass, 0 to 1. Light passes them twice.
    pub backing: f64,
    /// Kind of backing, if the file names it.
    #[serde(rename = "backing_kind")]
    pub kind: Option<Backing>,
    /// Share of the returning light that the emulsion reflects down again, 0 to 0.95.
    pub reflected: f64,
    /// Light that returns to each layer, relative to the light that returns to the layer next to the base; in the order of the
    /// stock.
    pub layers: Vec<f64>,
    /// Whether the figures are assumed: sheets hardly ever state them.
    pub assumed: bool,
    /// Reasons for the figures.
    pub remark: Option<String>,
}

/// Figures that are assumed for all layers of a stock, each with its reasons.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Assumptions {
    /// Reasons for assumed spectra of the dyes.
    pub dyes: Option<String>,
    /// Reasons for an assumed granularity of the layers.
    pub granularity: Option<String>,
    /// Reasons for an assumed modulation transfer of the layers.
    pub mtf: Option<String>,
}

impl Assumptions {
    /// Returns the assumptions that are present, each with its key in a stock file.
    pub fn iter(&self) -> impl Iterator<Item = (&'static str, &str)> {
        let all = [("dyes", &self.dyes), ("granularity", &self.granularity), ("mtf", &self.mtf)];
        all.into_iter().filter_map(|(key, text)| Some((key, text.as_deref()?)))
    }
}

/// Figures that were chosen rather than measured for all layers, each with its reasons.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
pub(super) struct AssumptionsFile {
    /// Reasons for the assumed spectra of the dyes. Taken from the sheet if absent.
    dyes: Option<String>,
    /// Reasons for the assumed granularity of the layers. Taken from the sheet if absent.
    granularity: Option<String>,
    /// Reasons for the assumed modulation transfer of the layers. Taken from the sheet if absent.
    mtf: Option<String>,
}

impl AssumptionsFile {
    pub(super) fn read(self, params: &Params) -> Result<Assumptions, Faults> {
        let Self { dyes, granularity, mtf } = self;
        let assumptions = Assumptions { dyes, granularity, mtf };
        let mut faults = Faults::new();
        for (key, text) in assumptions.iter() {
            if text.trim().is_empty() {
                let fault = params.fault(&format!("assumed.{key}"), "an assumption needs a reason");
                faults.push(fault.hint("write a text that says what it is based on"));
            }
        }
        faults.into_result(assumptions)
    }
}

/// A base on which a film is coated.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
pub(super) struct BaseFile {
    /// Formats that have this base, for people.
    formats: String,
    /// Material of the base; not known if absent.
    material: Option<String>,
    /// Thickness, mm if bare.
    thickness: Positive<Length>,
    /// Refractive index, 1 to 3; not known if absent. Halation needs it.
    #[schemars(range(min = 1, max = 3))]
    index: Option<f64>,
    /// Whether the figures were chosen rather than measured.
    #[serde(default)]
    assumed: bool,
}

impl BaseFile {
    pub(super) fn read(&self) -> Base {
        Base {
            formats: self.formats.clone(),
            material: self.material.clone(),
            thickness_mm: self.thickness.mm(),
            index: self.index,
            assumed: self.assumed,
        }
    }
}

/// Granularity of silver; in a film with dyes, each layer states its own.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
pub(super) struct GranularityFile {
    /// RMS granularity as sheets state it: 1000 times the standard deviation of density.
    rms: Positive<f64>,
    /// Diameter of the aperture with which it was measured, mm if bare; 0.048 mm if absent.
    aperture: Option<Positive<Length>>,
    /// Density at which it was measured; 1 if absent.
    density: Option<Positive<f64>>,
    /// Whether it was chosen rather than measured; then `remark` says why.
    #[serde(default)]
    assumed: bool,
    /// Remarks for people, for example doubts and choices.
    remark: Option<String>,
}

impl GranularityFile {
    pub(super) fn read(&self, params: &Params) -> Result<Granularity, Fault> {
        if self.assumed && self.remark.as_ref().is_none_or(|r| r.trim().is_empty()) {
            let fault = params.fault("granularity.assumed", "an assumed granularity needs a remark");
            return Err(fault.hint("add a `remark` that says what it is based on"));
        }
        Ok(Granularity {
            rms: self.rms.get(),
            aperture_mm: self.aperture.map_or(0.048, |a| a.mm()),
            density: self.density.map_or(1.0, |d| d.get()),
            assumed: self.assumed,
        })
    }
}

/// A backing, given by its kind or by its transmittance.
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema)]
#[serde(untagged)]
#[schemars(inline)]
enum BackingForm {
    Kind(Backing),
    Transmittance(#[schemars(range(min = 0, max = 1))] f64),
}

/// Light that the base of a film reflects back.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
pub(super) struct HalationFile {
    /// Light that enters the base, relative to the light that exposes the layer next to it, 0 to 1.
    #[schemars(range(min = 0, max = 1))]
    scattered: f64,
    /// Anti-halation backing: `rem-jet`, `silver`, `dye` or `removed`, with assumed transmittances of 0.12, 0.2, 0.35 and 0.95; or the
    /// transmittance of base and backing for one pass, 0 to 1.
    backing: BackingForm,
    /// Share of the returning light that the emulsion reflects down again, for another trip, 0 to 0.95.
    #[serde(default)]
    #[schemars(range(min = 0, max = 0.95))]
    reflected: f64,
    /// Light that returns to each layer, in their order, relative to the light that returns to the layer next to the base. Layers between,
    /// and a yellow filter, absorb light on both passes. 1 for each if absent.
    #[schemars(inner(range(min = 0, max = 1)))]
    layers: Option<Vec<f64>>,
    /// Whether the figures were chosen rather than measured; then `remark` says why.
    #[serde(default)]
    assumed: bool,
    /// Remarks for people, for example doubts and choices.
    remark: Option<String>,
}

impl HalationFile {
    /// Checks the halation of a film with `layers` layers.
    pub(super) fn read(&self, params: &Params, layers: usize) -> Result<Halation, Fault> {
        let Self { scattered, backing, reflected, assumed, .. } = *self;
        let shares = self.layers.clone().unwrap_or_else(|| vec![1.0; layers]);
        if shares.len() != layers {
            let text = format!("{} numbers for {layers} layers", shares.len());
            return Err(params.fault("halation.layers", text).hint("one for each layer, in their order"));
        }
        if assumed && self.remark.as_ref().is_none_or(|r| r.trim().is_empty()) {
            let fault = params.fault("halation.assumed", "assumed halation needs a remark");
            return Err(fault.hint("add a `remark` that says what it is based on"));
        }
        let (backing, kind) = match backing {
            BackingForm::Kind(kind) => (kind.transmittance(), Some(kind)),
            BackingForm::Transmittance(passed) => (passed, None),
        };
        Ok(Halation { scattered, backing, kind, reflected, layers: shares, assumed, remark: self.remark.clone() })
    }
}

/// Checks the granularity of a layer over density.
pub(super) fn granularity(params: &Params, at: &str, points: &[[f64; 2]]) -> Result<Vec<[f64; 2]>, Fault> {
    let mut before = f64::NEG_INFINITY;
    for (i, [density, rms]) in points.iter().enumerate() {
        if !(*density > before && (0.0..=10.0).contains(density) && (0.0..=200.0).contains(rms)) {
            let text = format!("[{density}, {rms}] is not a point of granularity over density");
            let fault = params.fault(&format!("{at}.granularity[{i}]"), text);
            return Err(fault
                .hint("[density over the minimum, RMS]: densities increase from 0 to 10, RMS lies between 0 and 200"));
        }
        before = *density;
    }
    Ok(points.to_vec())
}

/// Checks a modulation transfer.
pub(super) fn mtf(params: &Params, at: &str, points: &[[f64; 2]]) -> Result<Vec<[f64; 2]>, Fault> {
    let mut before = 0.0;
    for (i, [frequency, response]) in points.iter().enumerate() {
        if !(*frequency > before && frequency.is_finite() && (0.0..=2.0).contains(response)) {
            let text = format!("[{frequency}, {response}] is not a point of an MTF");
            let fault = params.fault(&format!("{at}.mtf[{i}]"), text);
            return Err(fault.hint("[cycles/mm, response]: frequencies increase, responses lie between 0 and 2"));
        }
        before = *frequency;
    }
    Ok(points.to_vec())
}
