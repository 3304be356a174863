//! What a film is made of beside its sensitive layers, and how fine it is.

use schemars::JsonSchema;
use serde::Deserialize;
use spectra_core::params::{Fault, Faults, Length, Params, Positive};

/// What the emulsion is coated on.
#[derive(Clone, Debug, PartialEq)]
pub struct Base {
    /// The formats that come on it, as the sheet names them.
    pub formats: String,
    /// Material, such as `acetate`.
    pub material: Option<String>,
    /// Thickness, mm.
    pub thickness_mm: f64,
    /// Refractive index; `None` where the sheet does not say.
    pub index: Option<f64>,
    /// Whether thickness and index are assumed.
    pub assumed: bool,
}

/// RMS granularity: 1000 times the standard deviation of density through a round aperture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Granularity {
    /// The figure of the sheet.
    pub rms: f64,
    /// Diameter of the aperture, mm; 0.048 by custom.
    pub aperture_mm: f64,
    /// The density at which it was measured; 1 by custom.
    pub density: f64,
    /// Whether it is assumed.
    pub assumed: bool,
}

/// What keeps light from coming back from the film's back. Makers name the kind and no figure: the figures are assumed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
#[schemars(inline)]
pub enum Backing {
    /// Soot in a binder on the back, washed off before development: it takes nearly all.
    RemJet,
    /// Fine silver under the emulsion, bleached in processing: it takes most.
    Silver,
    /// A dye under the emulsion or in the base: it takes some.
    Dye,
    /// None, or one that was removed before exposure: clear base.
    Removed,
}

impl Backing {
    /// Transmittance of base and backing, passed once.
    #[must_use]
    pub fn transmittance(self) -> f64 {
        match self {
            Self::RemJet => 0.12,
            Self::Silver => 0.2,
            Self::Dye => 0.35,
            Self::Removed => 0.95,
        }
    }

    /// Its name in a file.
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

/// Light that comes back from the film's back.
#[derive(Clone, Debug, PartialEq)]
pub struct Halation {
    /// Share of the exposing light that is scattered on into the base, 0 to 1; of the layer next to the base.
    pub scattered: f64,
    /// Transmittance of the anti-halation backing, passed on the way out and on the way back, 0 to 1.
    pub backing: f64,
    /// The kind of backing, where the file names it.
    pub kind: Option<Backing>,
    /// Share of what comes back that the emulsion throws down again, 0 to 0.95.
    pub reflected: f64,
    /// What comes back to each layer, in the order of the stock, over what would come back to the layer next to the base.
    pub layers: Vec<f64>,
    /// Whether this is assumed: sheets hardly ever say.
    pub assumed: bool,
    /// What it rests on.
    pub remark: Option<String>,
}

/// What was chosen rather than measured in all layers of a stock, each with what it rests on.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Assumptions {
    /// Of the spectra of its dyes.
    pub dyes: Option<String>,
    /// Of the granularity of its layers.
    pub granularity: Option<String>,
    /// Of their modulation transfer.
    pub mtf: Option<String>,
}

impl Assumptions {
    /// Each with the key that a stock file has for it, those that there are.
    pub fn iter(&self) -> impl Iterator<Item = (&'static str, &str)> {
        let all = [("dyes", &self.dyes), ("granularity", &self.granularity), ("mtf", &self.mtf)];
        all.into_iter().filter_map(|(key, text)| Some((key, text.as_deref()?)))
    }
}

/// What was chosen rather than measured in all layers, each with what it rests on.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
pub(super) struct AssumptionsFile {
    /// Of the spectra of the dyes: what they rest on. The sheet has them if absent.
    dyes: Option<String>,
    /// Of the granularity of the layers: what it rests on. The sheet has it if absent.
    granularity: Option<String>,
    /// Of the modulation transfer of the layers: what it rests on. The sheet has it if absent.
    mtf: Option<String>,
}

impl AssumptionsFile {
    pub(super) fn read(self, params: &Params) -> Result<Assumptions, Faults> {
        let Self { dyes, granularity, mtf } = self;
        let assumptions = Assumptions { dyes, granularity, mtf };
        let mut faults = Faults::new();
        for (key, text) in assumptions.iter() {
            if text.trim().is_empty() {
                let fault = params.fault(&format!("assumed.{key}"), "what is assumed needs a reason");
                faults.push(fault.hint("a text that says what it rests on"));
            }
        }
        faults.into_result(assumptions)
    }
}

/// What a film is coated on.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
pub(super) struct BaseFile {
    /// The formats that have this base, for people.
    formats: String,
    /// What it is made of; not known if absent.
    material: Option<String>,
    /// Its thickness, mm if bare.
    thickness: Positive<Length>,
    /// Its refractive index, 1 to 3; not known if absent. Halation needs it.
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

/// How grainy silver is; the layers of a film with dyes say it each for itself.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
pub(super) struct GranularityFile {
    /// RMS granularity as sheets state it: 1000 times the standard deviation of density.
    rms: Positive<f64>,
    /// Diameter of the aperture that it was measured through, mm if bare; 0.048 mm if absent.
    aperture: Option<Positive<Length>>,
    /// Density that it was measured at; 1 if absent.
    density: Option<Positive<f64>>,
    /// Whether it was chosen rather than measured; then `remark` says why.
    #[serde(default)]
    assumed: bool,
    /// Doubts and choices, for people.
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

/// A backing by its kind, or by its transmittance.
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema)]
#[serde(untagged)]
#[schemars(inline)]
enum BackingForm {
    Kind(Backing),
    Transmittance(#[schemars(range(min = 0, max = 1))] f64),
}

/// Light that the base of a film throws back.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
pub(super) struct HalationFile {
    /// Light that enters the base, over the light that exposes the layer next to it, 0 to 1.
    #[schemars(range(min = 0, max = 1))]
    scattered: f64,
    /// What keeps light from coming back: `rem-jet`, `silver`, `dye` or `removed`, with transmittances of 0.12, 0.2, 0.35 and 0.95, which
    /// are assumed; or the transmittance of base and backing, passed once, 0 to 1.
    backing: BackingForm,
    /// Share of what comes back that the emulsion throws down again, for another trip, 0 to 0.95.
    #[serde(default)]
    #[schemars(range(min = 0, max = 0.95))]
    reflected: f64,
    /// What comes back to each layer, in their order, over what comes back to the layer next to the base: layers between, and
    /// a yellow filter, hold it back on both ways. 1 for each if absent.
    #[schemars(inner(range(min = 0, max = 1)))]
    layers: Option<Vec<f64>>,
    /// Whether the figures were chosen rather than measured; then `remark` says why.
    #[serde(default)]
    assumed: bool,
    /// Doubts and choices, for people.
    remark: Option<String>,
}

impl HalationFile {
    /// For a film of `layers` layers.
    pub(super) fn read(&self, params: &Params, layers: usize) -> Result<Halation, Fault> {
        let Self { scattered, backing, reflected, assumed, .. } = *self;
        let shares = self.layers.clone().unwrap_or_else(|| vec![1.0; layers]);
        if shares.len() != layers {
            let text = format!("{} numbers for a film of {layers}", shares.len());
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
