//! Closed forms: the index from coefficients, by a function.

use super::Formula;
use std::fmt;

/// A closed form of an index.
#[derive(Clone, Copy)]
pub struct Form {
    /// Its name as a person would look it up.
    pub name: &'static str,
    /// Coefficients that it has; those left out at the end are 0.
    pub count: usize,
    /// The index by the coefficients, at least as many, and the wavelength in micrometers.
    pub index: fn(&[f64], f64) -> f64,
}

impl Form {
    /// The formula of these coefficients, in micrometers.
    #[must_use]
    pub fn with(self, coefficients: &[f64]) -> Formula {
        let mut coefficients = coefficients.to_vec();
        coefficients.resize(coefficients.len().max(self.count), 0.0);
        Formula::Closed(Closed { form: self, coefficients: coefficients.into() })
    }
}

/// A closed form with its coefficients.
#[derive(Clone)]
pub struct Closed {
    form: Form,
    coefficients: Box<[f64]>,
}

impl Closed {
    /// The name of its form.
    #[must_use]
    pub fn name(&self) -> &'static str {
        self.form.name
    }

    /// The coefficients in the order of the form, in micrometers.
    #[must_use]
    pub fn coefficients(&self) -> &[f64] {
        &self.coefficients
    }

    /// The same form with other coefficients.
    pub(super) fn again(&self, coefficients: &[f64]) -> Self {
        Self { form: self.form, coefficients: coefficients.into() }
    }

    /// Index at a wavelength in micrometers.
    pub(super) fn index(&self, um: f64) -> f64 {
        (self.form.index)(&self.coefficients, um)
    }
}

impl PartialEq for Closed {
    fn eq(&self, other: &Self) -> bool {
        self.form.name == other.form.name && self.coefficients == other.coefficients
    }
}

impl fmt::Debug for Closed {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} {:?}", self.form.name, self.coefficients)
    }
}

/// Declares and registers a form of our own: its name in files, its name, how many coefficients may be written (and how many there are,
/// with zeros behind them), and its index by the coefficients and the wavelength in micrometers.
macro_rules! form {
    (
        $(#[doc = $doc:literal])*
        $form:ident: $name:literal, $title:literal, $least:literal..=$most:literal of $count:literal, $index:expr
    ) => {
        pub(crate) const $form: $crate::formula::Form = $crate::formula::Form { name: $title, count: $count, index: $index };

        const _: () = {
            $(#[doc = $doc])*
            #[derive(Debug, serde::Deserialize, schemars::JsonSchema)]
            #[serde(deny_unknown_fields)]
            struct Params {
                /// In the order of the formula, with lengths in micrometers; those left out at the end are 0.
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
