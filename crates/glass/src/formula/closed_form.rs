//! Closed forms, in which a function of the coefficients gives the index.

use super::Formula;
use std::fmt;

/// A closed form of the refractive index as a function of coefficients and wavelength.
#[derive(Clone, Copy)]
pub struct ClosedForm {
    /// Name of the form, as a person would look it up.
    pub name: &'static str,
    /// Number of coefficients; coefficients that are left out at the end are 0.
    pub count: usize,
    /// Function that returns the index from the coefficients, at least `count` of them, and the wavelength in micrometers.
    pub index: fn(&[f64], f64) -> f64,
}

impl ClosedForm {
    /// Creates the formula of this form with the given coefficients, for wavelengths in micrometers.
    #[must_use]
    pub fn with(self, coefficients: &[f64]) -> Formula {
        let mut coefficients = coefficients.to_vec();
        coefficients.resize(coefficients.len().max(self.count), 0.0);
        Formula::Closed(ClosedFormula { form: self, coefficients: coefficients.into() })
    }
}

/// A closed form with its coefficients.
#[derive(Clone)]
pub struct ClosedFormula {
    form: ClosedForm,
    coefficients: Box<[f64]>,
}

impl ClosedFormula {
    /// Name of the closed form.
    #[must_use]
    pub fn name(&self) -> &'static str {
        self.form.name
    }

    /// Coefficients in the order of the form, for wavelengths in micrometers.
    #[must_use]
    pub fn coefficients(&self) -> &[f64] {
        &self.coefficients
    }

    /// Returns the same form with other coefficients.
    pub(super) fn again(&self, coefficients: &[f64]) -> Self {
        Self { form: self.form, coefficients: coefficients.into() }
    }

    /// Index at a wavelength in micrometers.
    pub(super) fn index(&self, um: f64) -> f64 {
        (self.form.index)(&self.coefficients, um)
    }
}

impl PartialEq for ClosedFormula {
    fn eq(&self, other: &Self) -> bool {
        self.form.name == other.form.name && self.coefficients == other.coefficients
    }
}

impl fmt::Debug for ClosedFormula {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} {:?}", self.form.name, self.coefficients)
    }
}

/// Declares and registers one of our own forms. Its arguments are the name in files, the name for people, how many coefficients
/// may be written, and how many there are, with zeros behind those written. The last argument is the index as a function of the
/// coefficients and the wavelength in micrometers.
macro_rules! form {
    (
        $(#[doc = $doc:literal])*
        $form:ident: $name:literal, $title:literal, $least:literal..=$most:literal of $count:literal, $index:expr
    ) => {
        pub(crate) const $form: $crate::formula::ClosedForm = $crate::formula::ClosedForm { name: $title, count: $count, index: $index };

        const _: () = {
            $(#[doc = $doc])*
            #[derive(Debug, serde::Deserialize, schemars::JsonSchema)]
            #[serde(deny_unknown_fields)]
            struct Params {
                /// Coefficients in the order of the formula, with lengths in micrometers; those left out at the end are 0.
                #[schemars(length(min = $least, max = $most))]
                coefficients: Vec<f64>,
            }

            spectra_core::register!($crate::FormulaEntry, $name: Params, |params, _| {
                let p: Params = params.parse()?;
                Ok(Box::new($form.with(&p.coefficients)))
            });
        };
    };
}

pub(super) use form;
