//! Dispersion formulas: n(lambda) as makers, papers and programs write it.
//!
//! Coefficients are those of formulas in micrometres. One file a family; every form is tested against a published
//! medium.

mod buchdahl;
mod handbook;
mod herzberger;
mod melt;
mod model;
mod numbered;
mod polynomial;
mod sellmeier;
mod table;

pub use melt::Melt;
pub use model::ModelGlass;
pub use numbered::NumberedFormula;
pub use table::{Table, TableError};

use std::sync::Arc;

/// A dispersion formula with its coefficients; L is the wavelength in micrometres.
///
/// Names and order of coefficients are those of the glass catalogue files of optical design programs.
#[derive(Clone, Debug, PartialEq)]
pub enum Formula {
    /// n = c0, whatever the wavelength.
    Constant(f64),
    /// Cauchy: n = c0 + c1 L^-2 + c2 L^-4 + ...
    Cauchy(Vec<f64>),
    /// Conrady: n = c0 + c1 / L + c2 / L^3.5.
    Conrady([f64; 3]),
    /// Schott: n^2 = c0 + c1 L^2 + c2 L^-2 + c3 L^-4 + c4 L^-6 + c5 L^-8.
    Schott([f64; 6]),
    /// Extended: n^2 = c0 + c1 L^2 + c2 L^-2 + c3 L^-4 + c4 L^-6 + c5 L^-8 + c6 L^-10 + c7 L^-12.
    Extended([f64; 8]),
    /// Extended 2: n^2 = c0 + c1 L^2 + c2 L^-2 + c3 L^-4 + c4 L^-6 + c5 L^-8 + c6 L^4 + c7 L^6.
    Extended2([f64; 8]),
    /// Extended 3: n^2 = c0 + c1 L^2 + c2 L^4 + c3 L^-2 + c4 L^-4 + c5 L^-6 + c6 L^-8 + c7 L^-10 + c8 L^-12.
    Extended3([f64; 9]),
    /// Handbook of Optics 1: n^2 = A + B / (L^2 - C) - D L^2.
    Handbook1([f64; 4]),
    /// Handbook of Optics 2: n^2 = A + B L^2 / (L^2 - C) - D L^2.
    Handbook2([f64; 4]),
    /// Herzberger: n = A + B l + C l^2 + D L^2 + E L^4 + F L^6 with l = 1 / (L^2 - 0.028).
    Herzberger([f64; 6]),
    /// Sellmeier 1: n^2 = 1 + sum of three K L^2 / (L^2 - M); coefficients K1 M1 K2 M2 K3 M3.
    Sellmeier1([f64; 6]),
    /// Sellmeier 2, with squared poles: n^2 = 1 + A + B1 L^2 / (L^2 - M1^2) + B2 / (L^2 - M2^2); A B1 M1 B2 M2.
    Sellmeier2([f64; 5]),
    /// Sellmeier 3: four terms of Sellmeier 1.
    Sellmeier3([f64; 8]),
    /// Sellmeier 4: n^2 = A + B L^2 / (L^2 - C) + D L^2 / (L^2 - E).
    Sellmeier4([f64; 5]),
    /// Sellmeier 5: five terms of Sellmeier 1.
    Sellmeier5([f64; 10]),
    /// One of the nine forms of the refractiveindex.info database.
    Numbered(NumberedFormula),
    /// Buchdahl's quadratic model: n = N0 + v1 w + v2 w^2 with w = (L - L0) / (1 + 2.5 (L - L0)); L0 N0 v1 v2.
    Buchdahl([f64; 4]),
    /// On the normal lines of partial dispersion, from an index and an Abbe number.
    Model(ModelGlass),
    /// A catalogue glass as one melt of it was measured.
    Melt(Box<Melt>),
    /// Measured points and a monotone cubic between them.
    Table(Arc<Table>),
}

impl Formula {
    /// Refractive index at `wavelength_nm`. Outside of the range for which the coefficients were fitted this
    /// extrapolates; not a number where the formula has no real index (at a pole, say). A table ends with a tangent.
    #[must_use]
    pub fn index(&self, wavelength_nm: f64) -> f64 {
        let um = wavelength_nm * 1e-3;
        let square = um * um;
        match self {
            Formula::Constant(n) => *n,
            Formula::Cauchy(c) => polynomial::cauchy(c, square),
            Formula::Conrady(c) => polynomial::conrady(c, um),
            Formula::Schott(c) => polynomial::schott(c, square).sqrt(),
            Formula::Extended(c) => polynomial::extended(c, square).sqrt(),
            Formula::Extended2(c) => polynomial::extended2(c, square).sqrt(),
            Formula::Extended3(c) => polynomial::extended3(c, square).sqrt(),
            Formula::Handbook1(c) => handbook::handbook1(c, square).sqrt(),
            Formula::Handbook2(c) => handbook::handbook2(c, square).sqrt(),
            Formula::Herzberger(c) => herzberger::herzberger(c, square),
            Formula::Sellmeier1(c) => sellmeier::terms(c, square).sqrt(),
            Formula::Sellmeier2(c) => sellmeier::sellmeier2(c, square).sqrt(),
            Formula::Sellmeier3(c) => sellmeier::terms(c, square).sqrt(),
            Formula::Sellmeier4(c) => sellmeier::sellmeier4(c, square).sqrt(),
            Formula::Sellmeier5(c) => sellmeier::terms(c, square).sqrt(),
            Formula::Numbered(numbered) => numbered.index(um),
            Formula::Buchdahl(c) => buchdahl::buchdahl(c, um),
            Formula::Model(model) => model.index(wavelength_nm),
            Formula::Melt(melt) => melt.index(wavelength_nm),
            Formula::Table(table) => table.value(wavelength_nm),
        }
    }

    /// The formula's name as a person would look it up.
    #[must_use]
    pub fn name(&self) -> &'static str {
        match self {
            Formula::Constant(_) => "constant",
            Formula::Cauchy(_) => "Cauchy",
            Formula::Conrady(_) => "Conrady",
            Formula::Schott(_) => "Schott",
            Formula::Extended(_) => "Extended",
            Formula::Extended2(_) => "Extended 2",
            Formula::Extended3(_) => "Extended 3",
            Formula::Handbook1(_) => "Handbook of Optics 1",
            Formula::Handbook2(_) => "Handbook of Optics 2",
            Formula::Herzberger(_) => "Herzberger",
            Formula::Sellmeier1(_) => "Sellmeier 1",
            Formula::Sellmeier2(_) => "Sellmeier 2",
            Formula::Sellmeier3(_) => "Sellmeier 3",
            Formula::Sellmeier4(_) => "Sellmeier 4",
            Formula::Sellmeier5(_) => "Sellmeier 5",
            Formula::Numbered(numbered) => numbered.name(),
            Formula::Buchdahl(_) => "Buchdahl",
            Formula::Model(_) => "from index and Abbe number",
            Formula::Melt(_) => "melt",
            Formula::Table(_) => "table",
        }
    }

    /// The coefficients in the order of the form; for a melt those of its catalogue glass; for a table, pairs of wavelength (nm) and index.
    #[must_use]
    pub fn coefficients(&self) -> Vec<f64> {
        match self {
            Formula::Constant(n) => vec![*n],
            Formula::Cauchy(c) => c.clone(),
            Formula::Conrady(c) => c.to_vec(),
            Formula::Schott(c) | Formula::Sellmeier1(c) | Formula::Herzberger(c) => c.to_vec(),
            Formula::Extended(c) | Formula::Extended2(c) | Formula::Sellmeier3(c) => c.to_vec(),
            Formula::Extended3(c) => c.to_vec(),
            Formula::Handbook1(c) | Formula::Handbook2(c) | Formula::Buchdahl(c) => c.to_vec(),
            Formula::Sellmeier2(c) | Formula::Sellmeier4(c) => c.to_vec(),
            Formula::Sellmeier5(c) => c.to_vec(),
            Formula::Numbered(numbered) => numbered.coefficients().to_vec(),
            Formula::Model(model) => vec![model.index_mid(), model.abbe_number()],
            Formula::Melt(melt) => melt.base().coefficients(),
            Formula::Table(table) => table.points().flat_map(|(w, n)| [w, n]).collect(),
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
