//! The kinds of spectra: each has a file in this folder, and a plugin may bring others.
//!
//! A kind is a struct of parameters with a function that makes the spectrum:
//!
//! ```
//! use schemars::JsonSchema;
//! use serde::Deserialize;
//! use spectra_core::params::{Faults, Wavelength};
//! use spectra_spectrum::{SpectrumContext, PendingSpectrum, SpectralFunction, SpectrumEntry, SpectrumError, SpectrumKind, build_kind};
//!
//! /// Two Gaussians of 20 nm, one on each side of a wavelength.
//! #[derive(Debug, Deserialize, JsonSchema)]
//! #[serde(deny_unknown_fields)]
//! struct Pair {
//!     /// Wavelength between them, nm if bare.
//!     center: Wavelength,
//! }
//!
//! spectra_core::register!(SpectrumEntry, "pair": Pair, build_kind::<Pair>);
//! // The form as an expression, if there is one: `pair:550`.
//! spectra_spectrum::expression!("pair:550", "write a wavelength in nm, such as pair:550", |text| {
//!     text.parse().ok().map(two)
//! });
//!
//! fn two(center_nm: f64) -> Result<PendingSpectrum, SpectrumError> {
//!     let [low, high] = [SpectralFunction::gaussian(center_nm - 50.0, 20.0)?, SpectralFunction::gaussian(center_nm + 50.0, 20.0)?];
//!     Ok(PendingSpectrum::Bare(low.plus(&high)))
//! }
//!
//! impl SpectrumKind for Pair {
//!     fn make(&self, making: &SpectrumContext<'_>) -> Result<PendingSpectrum, Faults> {
//!         two(self.center.nm()).map_err(making.at("center"))
//!     }
//! }
//! # assert!((spectra_spectrum::find_emission("pair:550").unwrap().at(500.0) - 1.0).abs() < 1e-5);
//! ```

mod band;
mod constant;
mod function;
mod gaussian;
mod histogram;
mod led;
mod line;
mod mixture;
mod parts;
mod scale;
mod table;
mod temperature;

use crate::by_name::Loader;
use crate::error::SpectrumError;
use crate::meta::Kind;
use crate::pending_spectrum::PendingSpectrum;
use crate::spectral_function::SpectralFunction;
use crate::table::MAX_ROWS;
use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use spectra_core::params::{Fault, Faults, NonNegative, Params, Readable, StageNode, Wavelength};
use spectra_core::quantity::{SHORTEST_LIGHT_NM, light_nm};
use spectra_core::registry::{self, Context};
use spectra_core::resources::Resources;
use spectra_core::spectral::BAND;

spectra_core::declare!(SpectrumEntry, dyn SpectrumKind, "spectrum", "A registered kind of spectrum.");

/// Parameters that define a spectrum.
pub trait SpectrumKind {
    /// Makes the spectrum of these parameters.
    ///
    /// # Errors
    /// The faults of the parameters, placed.
    fn make(&self, making: &SpectrumContext<'_>) -> Result<PendingSpectrum, Faults>;
}

/// Reads a kind from its parameters, for [`register!`](spectra_core::register).
///
/// # Errors
/// All faults of the parameters.
pub fn build_kind<K: SpectrumKind + Readable + 'static>(
    params: &Params,
    _: &Context<'_>,
) -> Result<Box<dyn SpectrumKind>, Faults> {
    Ok(Box::new(params.parse::<K>()?))
}

/// The context in which a spectrum is made: the kind that is wanted, and other spectra.
pub struct SpectrumContext<'a> {
    params: &'a Params,
    wanted: Kind,
    /// Whether the spectrum is a part of a sum, which is checked as a whole.
    is_part: bool,
    loader: &'a Loader<'a>,
    files: &'a dyn Resources,
}

impl SpectrumContext<'_> {
    /// Returns the parameters as they were written, to place faults.
    #[must_use]
    pub fn params(&self) -> &Params {
        self.params
    }

    /// Kind that is wanted where the spectrum is named; a function of wavelength becomes this kind.
    #[must_use]
    pub fn wanted(&self) -> Kind {
        self.wanted
    }

    /// Returns a conversion of an error to faults that are placed at `key`.
    pub fn at(&self, key: &'static str) -> impl Fn(SpectrumError) -> Faults {
        move |error| match error {
            SpectrumError::NotLight(_) => error.faults(|text| self.params.fault(key, text)),
            error => self.params.fault(key, error.to_string()).into(),
        }
    }

    /// Returns whether the spectrum is a part of a sum. It may then be negative, because the sum is checked as a whole.
    #[must_use]
    pub fn is_part(&self) -> bool {
        self.is_part
    }

    /// Makes another spectrum, from which this one is made. `node` is a name, an expression, or a map with a kind; `wanted` is
    /// the kind of spectrum that is wanted.
    ///
    /// # Errors
    /// The faults of that spectrum, placed.
    pub fn nested(&self, node: &StageNode, wanted: Kind) -> Result<PendingSpectrum, Faults> {
        let piece = self.nested_addend(node, wanted, false)?;
        piece.settled().map_err(|e| e.faults(|text| node.fault(text)))
    }

    /// Makes another spectrum like [`SpectrumContext::nested`]; it may be negative if it `is_part` of a sum.
    pub(crate) fn nested_addend(
        &self,
        node: &StageNode,
        wanted: Kind,
        is_part: bool,
    ) -> Result<PendingSpectrum, Faults> {
        match node.node().as_str() {
            Some(name) => self.loader.part(name, wanted).map_err(|e| match e {
                SpectrumError::Document(faults) => faults,
                other => other.faults(|text| node.fault(text)),
            }),
            None => {
                self.loader.count("this file").map_err(|e| node.fault(e.to_string()))?;
                made(&node.params()?, wanted, is_part, self.loader, self.files)
            }
        }
    }
}

/// Makes the spectrum of a map with its kind and that kind's own keys.
pub(crate) fn of_params(
    params: &Params,
    wanted: Kind,
    loader: &Loader<'_>,
    files: &dyn Resources,
) -> Result<PendingSpectrum, Faults> {
    let piece = made(params, wanted, false, loader, files)?;
    // An error of the whole spectrum has no key of its own.
    piece.settled().map_err(|e| e.faults(|text| params.fault("kind", text)))
}

fn made(
    params: &Params,
    wanted: Kind,
    is_part: bool,
    loader: &Loader<'_>,
    files: &dyn Resources,
) -> Result<PendingSpectrum, Faults> {
    let kind = registry::build::<dyn SpectrumKind>(params, &Context::new(files, BAND))?;
    kind.make(&SpectrumContext { params, wanted, is_part, loader, files })
}

/// The form of a spectrum within a spectrum: a name or an expression, or a map with its kind.
pub struct SpectrumForm;

impl JsonSchema for SpectrumForm {
    fn inline_schema() -> bool {
        true
    }

    fn schema_name() -> std::borrow::Cow<'static, str> {
        "SpectrumForm".into()
    }

    fn json_schema(_: &mut SchemaGenerator) -> Schema {
        json_schema!({
            "x-words": "name, expression or map",
            "x-see": "spectrum",
            "if": { "type": "string" },
            "else": { "$ref": "#/$defs/spectrum" },
        })
    }
}

/// Multiplies a shape by a value, if one is stated.
fn times(shape: SpectralFunction, value: Option<NonNegative<f64>>) -> Result<PendingSpectrum, SpectrumError> {
    match value {
        Some(value) => shape.scaled(value.get()).map(PendingSpectrum::Bare),
        None => Ok(PendingSpectrum::Bare(shape)),
    }
}

/// Checks the center of a Gaussian: it may lie outside of all light if the Gaussian is wide; a narrow one has its center in light.
fn bell_nm(center_nm: f64, width_nm: f64) -> Result<f64, SpectrumError> {
    if center_nm > 0.0 && width_nm < SHORTEST_LIGHT_NM { Ok(light_nm(center_nm)?) } else { Ok(center_nm) }
}

/// Adds a fault if all of these wavelengths, which increase, are too short for light.
fn some_light(params: &Params, key: &str, nm: &[Wavelength], faults: &mut Faults) {
    if let Some(Err(wrong)) = nm.last().map(|last| light_nm(last.nm())) {
        faults.push(params.fault(&format!("{key}[{}]", nm.len() - 1), wrong.to_string()).hint(wrong.hint()));
    }
}

/// Adds a fault for each wavelength that does not increase.
fn rising(params: &Params, key: &str, nm: &[Wavelength], faults: &mut Faults) {
    for (i, pair) in nm.windows(2).enumerate() {
        if pair[1].nm() <= pair[0].nm() {
            let text = format!("{} nm does not come after {} nm", pair[1].nm(), pair[0].nm());
            faults.push(params.fault(&format!("{key}[{}]", i + 1), text).hint("wavelengths must increase"));
        }
    }
}

/// Checks the lengths of two lists before anything is made of them.
fn lengths(params: &Params, keys: [&str; 2], [found, wanted]: [usize; 2], what: &str) -> Result<(), Fault> {
    if found > MAX_ROWS || wanted > MAX_ROWS {
        return Err(params.fault(keys[0], format!("more than {MAX_ROWS} points")));
    }
    if found == 0 || found != wanted {
        let fault = params.fault(keys[1], format!("{found} {}, but {what} needs {wanted}", keys[1]));
        return Err(fault.hint("write exactly that many, in the same order"));
    }
    Ok(())
}
