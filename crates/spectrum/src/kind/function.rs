//! The spectrum of `kind: function`.

use super::{SpectrumContext, SpectrumEntry, SpectrumKind, build_kind};
use crate::error::SpectrumError;
use crate::pending_spectrum::PendingSpectrum;
use crate::spectral_function::SpectralFunction;
use schemars::JsonSchema;
use serde::Deserialize;
use spectra_core::params::Faults;
use spectra_numerics::formula::Formula;

/// A spectrum that is written as a formula of the wavelength.
///
/// `w` is the wavelength in nm. A formula may contain `+ - * / ^`, parentheses, `pi`, and abs, cos, erf, exp, ln, log10, max,
/// min, sin, sqrt, step, tan, tanh (step is 1 from 0 on, 0 below). As an expression: `function:exp(-((w - 550) / 20)^4)`.
///
/// # Example
/// ```yaml
/// {kind: function, formula: "exp(-((w - 550) / 20)^4)"}
/// ```
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
struct Function {
    /// The formula, a function of the wavelength `w` in nm.
    formula: String,
}

spectra_core::register!(SpectrumEntry, "function": Function, build_kind::<Function>);
crate::expression!(
    "function:exp(-((w-550)/20)^4)",
    "write a formula of the wavelength w in nm, such as function:exp(-((w-550)/20)^4)",
    |text| Some(function(text).map(PendingSpectrum::Bare))
);

impl SpectrumKind for Function {
    fn make(&self, making: &SpectrumContext<'_>) -> Result<PendingSpectrum, Faults> {
        let wrong = |e: SpectrumError| e.faults(|text| making.params().fault("formula", text));
        function(&self.formula).map(PendingSpectrum::Bare).map_err(wrong)
    }
}

fn function(text: &str) -> Result<SpectralFunction, SpectrumError> {
    let formula = Formula::parse(text, "w").map_err(|fault| SpectrumError::Expression {
        text: text.to_owned(),
        at: fault.at,
        message: fault.message,
        hint: fault.hint,
    })?;
    Ok(SpectralFunction::function(formula))
}
