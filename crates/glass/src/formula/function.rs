//! An index that is written out as a formula.

use super::{Formula, FormulaEntry};
use schemars::JsonSchema;
use serde::Deserialize;
use spectra_core::params::Fault;
use spectra_numerics::formula;
use std::sync::Arc;

/// The index as a formula of the wavelength, for a form that is not in the list.
///
/// `w` is the wavelength in nm. A formula may contain `+ - * / ^`, parentheses, `pi`, and abs, cos, erf, exp, ln, log10, max,
/// min, sin, sqrt, step, tan, tanh.
///
/// # Example
/// ```yaml
/// {formula: function, n: "1.5046 + 4200 / w^2"}
/// ```
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
struct Params {
    /// The index, as a formula of the wavelength `w` in nm.
    n: String,
}

spectra_core::register!(FormulaEntry, "function": Params, |params, _| {
    let Params { n } = params.parse()?;
    let formula = formula::Formula::parse(&n, "w").map_err(|fault| -> Fault {
        params.fault("n", fault.message.clone()).hint(fault.hint.clone()).within(&n, fault.at, 1)
    })?;
    Ok(Box::new(Formula::Function(Arc::new(formula))))
});

#[cfg(test)]
mod tests {
    use super::*;

    /// Equals Cauchy's formula with its coefficients in micrometers.
    #[test]
    fn a_formula_is_a_dispersion() {
        let text = formula::Formula::parse("1.5046 + 4200 / w^2", "w").expect("a formula");
        let (written, cauchy) = (Formula::Function(Arc::new(text)), Formula::cauchy(&[1.5046, 0.0042]));
        for nm in [404.66, 587.56, 656.27] {
            assert!((written.index(nm) - cauchy.index(nm)).abs() < 1e-14);
        }
    }
}
