//! Dispersion formulas: n(lambda) as makers, papers and programs write it.
//!
//! Coefficients are those of formulas in micrometers. Each family has a file; every form is tested against a published medium.
//! A plugin registers a form of its own in the same way as the forms here:
//!
//! ```
//! use schemars::JsonSchema;
//! use serde::Deserialize;
//! use spectra_core::params::{Faults, Params};
//! use spectra_core::registry::Context;
//! use spectra_glass::{ClosedForm, Formula, FormulaEntry};
//!
//! /// A straight line: n = c0 + c1 L.
//! #[derive(Debug, Deserialize, JsonSchema)]
//! #[serde(deny_unknown_fields)]
//! struct Straight {
//!     /// c0 and c1.
//!     coefficients: [f64; 2],
//! }
//!
//! spectra_core::register!(FormulaEntry, "straight": Straight, build);
//!
//! fn build(params: &Params, _: &Context<'_>) -> Result<Box<Formula>, Faults> {
//!     let p: Straight = params.parse()?;
//!     let form = ClosedForm { name: "straight", count: 2, index: |c, um| c[0] + c[1] * um };
//!     Ok(Box::new(form.with(&p.coefficients)))
//! }
//! # let straight = ClosedForm { name: "straight", count: 2, index: |c, um| c[0] + c[1] * um };
//! # assert_eq!(straight.with(&[1.5]).coefficients(), [1.5, 0.0]);
//! ```

mod buchdahl;
mod closed_form;
mod constant;
mod function;
mod handbook;
mod hartmann;
mod herzberger;
mod melt;
mod model;
mod numbered;
mod polynomial;
pub(crate) mod resonance;
mod sellmeier;
mod table;
mod unit;

pub(crate) use buchdahl::BUCHDAHL;
pub use closed_form::{ClosedForm, ClosedFormula};
pub(crate) use handbook::{HANDBOOK_1, HANDBOOK_2};
pub(crate) use herzberger::HERZBERGER;
pub use melt::Melt;
pub use model::ModelGlass;
pub use numbered::NumberedFormula;
pub(crate) use polynomial::{CAUCHY, CONRADY, EXTENDED, EXTENDED_2, EXTENDED_3, SCHOTT};
pub(crate) use sellmeier::{SELLMEIER_1, SELLMEIER_2, SELLMEIER_3, SELLMEIER_4, SELLMEIER_5};
pub use table::{Table, TableError};

use std::sync::Arc;

spectra_core::declare!(FormulaEntry, Formula, "formula", "A registered dispersion formula.", "formula");

/// A dispersion formula with its coefficients; L is the wavelength in micrometers.
///
/// Names and order of coefficients are those of the glass catalogue files of optical design programs.
#[derive(Clone, Debug, PartialEq)]
pub enum Formula {
    /// A constant index n = c0, whatever the wavelength.
    Constant(f64),
    /// One of the registered closed forms: Sellmeier, Schott, Cauchy and the others.
    Closed(ClosedFormula),
    /// One of the nine forms of the refractiveindex.info database.
    Numbered(NumberedFormula),
    /// A model glass on the normal lines of partial dispersion, from an index and an Abbe number.
    Model(ModelGlass),
    /// A catalogue glass with the nd and Vd that were measured on one melt.
    Melt(Box<Melt>),
    /// Measured points, with a monotone cubic between them.
    Table(Arc<Table>),
    /// A formula written out as a function of the wavelength in nm.
    Function(Arc<spectra_numerics::formula::Formula>),
}

impl Formula {
    /// Cauchy: n = c0 + c1 L^-2 + c2 L^-4 + ...
    #[must_use]
    pub fn cauchy(coefficients: &[f64]) -> Self {
        CAUCHY.with(coefficients)
    }

    /// Refractive index at `wavelength_nm`. Outside the range for which the coefficients were fitted it is extrapolated; a table
    /// continues along its tangent. NaN where the formula has no real index, for example at a pole.
    #[must_use]
    pub fn index(&self, wavelength_nm: f64) -> f64 {
        let um = wavelength_nm * 1e-3;
        match self {
            Formula::Constant(n) => *n,
            Formula::Closed(closed) => closed.index(um),
            Formula::Numbered(numbered) => numbered.index(um),
            Formula::Model(model) => model.index(wavelength_nm),
            Formula::Melt(melt) => melt.index(wavelength_nm),
            Formula::Table(table) => table.value(wavelength_nm),
            Formula::Function(formula) => formula.at(wavelength_nm),
        }
    }

    /// Name of the formula, as a person would look it up.
    #[must_use]
    pub fn name(&self) -> &'static str {
        match self {
            Formula::Constant(_) => "constant",
            Formula::Closed(closed) => closed.name(),
            Formula::Numbered(numbered) => numbered.name(),
            Formula::Model(_) => "from index and Abbe number",
            Formula::Melt(_) => "melt",
            Formula::Table(_) => "table",
            Formula::Function(_) => "function",
        }
    }

    /// Returns the coefficients in the order of the form. A model has its index and Abbe number; a melt has the coefficients of
    /// its catalogue glass; a table has pairs of wavelength (nm) and index. A formula that is written out has none.
    #[must_use]
    pub fn coefficients(&self) -> Vec<f64> {
        match self {
            Formula::Constant(n) => vec![*n],
            Formula::Closed(closed) => closed.coefficients().to_vec(),
            Formula::Numbered(numbered) => numbered.coefficients().to_vec(),
            Formula::Model(model) => vec![model.index_mid(), model.abbe_number()],
            Formula::Melt(melt) => melt.base().coefficients(),
            Formula::Table(table) => table.points().flat_map(|(w, n)| [w, n]).collect(),
            Formula::Function(_) => Vec::new(),
        }
    }
}

#[cfg(test)]
pub(crate) mod check {
    use super::Formula;

    /// Asserts n at each wavelength (nm).
    pub(crate) fn indices(formula: &Formula, expected: &[(f64, f64)], tolerance: f64) {
        for &(wavelength_nm, n) in expected {
            let got = formula.index(wavelength_nm);
            assert!((got - n).abs() <= tolerance, "{} at {wavelength_nm} nm: {got}, not {n}", formula.name());
        }
    }
}
