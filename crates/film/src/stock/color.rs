//! Interaction between the layers of a color film, and aim densities of print stocks.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use spectra_core::params::{Fault, Faults, Params};

/// Base of a print stock, which determines how the print is viewed.
#[derive(Clone, Copy, Debug, Default, Deserialize, JsonSchema, PartialEq, Eq)]
#[serde(rename_all = "kebab-case")]
pub enum Medium {
    /// A transparent base: projected in the dark.
    #[default]
    Film,
    /// Paper: viewed in a lit room. Densities are reflection densities.
    Paper,
}

/// Inhibition of one layer's development by the development of the others.
///
/// A layer whose neighbors hold less dye than they would for a neutral subject of its exposure develops more, as if it were
/// exposed more. A neutral subject does not change, because the sheet's curves already include the interaction of the layers.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Interlayer {
    /// Element `[i][j]` is how strongly layer j inhibits layer i, both in the order of the stock: log10 of exposure per unit of dye
    /// in layer j.
    pub inhibition: Vec<Vec<f64>>,
    /// Whether the values are assumed, not measured.
    pub assumed: bool,
    /// Reasons for the values.
    pub remark: Option<String>,
}

/// Densities to which the print of a mid gray is timed, including base and fog.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct AimDensity {
    /// Density through the red filter.
    pub red: f64,
    /// Density through the green filter.
    pub green: f64,
    /// Density through the blue filter.
    pub blue: f64,
}

impl AimDensity {
    /// Returns the density through the filter with this name: `red`, `green` or `blue`.
    #[must_use]
    pub fn of(&self, name: &str) -> Option<f64> {
        match name {
            "red" => Some(self.red),
            "green" => Some(self.green),
            "blue" => Some(self.blue),
            _ => None,
        }
    }
}

/// Inhibition between layers.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
pub(super) struct InterlayerFile {
    /// Whether it was chosen rather than measured; then `remark` says why.
    #[serde(default)]
    assumed: bool,
    /// Remarks for people, for example doubts and choices.
    remark: Option<String>,
    /// A row for each layer, in the order of the layers: by how much, in log10 of exposure, a unit of dye in each of the others inhibits
    /// it, 0 to 2.
    inhibition: Vec<Vec<f64>>,
}

impl InterlayerFile {
    pub(super) fn read(&self, params: &Params, layers: usize) -> Result<Interlayer, Faults> {
        let mut faults = Faults::new();
        if self.assumed && self.remark.as_ref().is_none_or(|r| r.trim().is_empty()) {
            let fault = params.fault("interlayer.assumed", "an assumed inhibition needs a remark");
            faults.push(fault.hint("add a `remark` that says what it is based on"));
        }
        if self.inhibition.len() != layers || self.inhibition.iter().any(|row| row.len() != layers) {
            let fault = params.fault(
                "interlayer.inhibition",
                format!("a film of {layers} layers needs {layers} rows of {layers} numbers"),
            );
            faults.push(fault.hint("`[[0, 0.1, 0], [0.2, 0, 0.2], [0, 0.1, 0]]`: 0 for each layer on itself"));
        } else {
            for (i, row) in self.inhibition.iter().enumerate() {
                for (j, value) in row.iter().enumerate() {
                    faults.extend(bad_inhibition(params, i, j, *value));
                }
            }
        }
        faults.into_result(Interlayer {
            inhibition: self.inhibition.clone(),
            assumed: self.assumed,
            remark: self.remark.clone(),
        })
    }
}

fn bad_inhibition(params: &Params, i: usize, j: usize, value: f64) -> Option<Fault> {
    let at = format!("interlayer.inhibition[{i}][{j}]");
    match value {
        _ if i == j && value != 0.0 => {
            let fault =
                params.fault(&at, "the inhibition of a layer by itself must be 0: it is already in the layer's curve");
            Some(fault.hint("write 0 here"))
        }
        v if !(0.0..=2.0).contains(&v) => {
            Some(params.fault(&at, format!("{v} is out of range")).hint("write a number from 0 to 2"))
        }
        _ => None,
    }
}

/// Densities to which a print of a mid gray is timed.
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
pub(super) struct AimDensityFile {
    /// Density through the red filter, above 0 to 4.
    #[schemars(extend("exclusiveMinimum" = 0, "maximum" = 4))]
    red: f64,
    /// Density through the green filter, above 0 to 4.
    #[schemars(extend("exclusiveMinimum" = 0, "maximum" = 4))]
    green: f64,
    /// Density through the blue filter, above 0 to 4.
    #[schemars(extend("exclusiveMinimum" = 0, "maximum" = 4))]
    blue: f64,
}

impl AimDensityFile {
    pub(super) fn read(self, params: &Params) -> Result<AimDensity, Faults> {
        let mut faults = Faults::new();
        for (name, value) in [("red", self.red), ("green", self.green), ("blue", self.blue)] {
            if !(value > 0.0 && value <= 4.0) {
                let fault = params.fault(&format!("aim-density.{name}"), format!("{value} is out of range"));
                faults.push(fault.hint("write a density above 0 and up to 4"));
            }
        }
        faults.into_result(AimDensity { red: self.red, green: self.green, blue: self.blue })
    }
}
