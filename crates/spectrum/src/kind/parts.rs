//! The spectra of `kind: product` and `kind: sum`.

use super::{SpectrumContext, SpectrumEntry, SpectrumForm, SpectrumKind, build_kind};
use crate::error::SpectrumError;
use crate::meta::Kind;
use crate::pending_spectrum::{PendingSpectrum, spectrum_of_function};
use schemars::JsonSchema;
use serde::Deserialize;
use spectra_core::params::{Deferred, Faults};

/// A product of spectra, such as a light behind filters.
///
/// The first factor is of the kind that is wanted, such as a light; the others are filters. Functions count as filters. As an
/// expression: `D65 * wratten-15`.
///
/// # Example
/// ```yaml
/// kind: product
/// factors:
///   - D65
///   - {kind: rectangle, from: 500 nm, to: 600 nm}
/// ```
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
struct Product {
    /// Factors, one or more, by name or as maps with their `kind`. The first is of the kind that is wanted, such as a light;
    /// the others are filters.
    factors: Vec<Deferred<SpectrumForm>>,
}

/// A sum of spectra.
///
/// Use it for lamps that shine together, or for the bands of one filter. Parts may be negative (a notch is 1 minus a band); the
/// sum must not. As an expression: `D65 + 5000 * line:e`, `1 - 0.9 * gaussian:550,20`.
///
/// # Example
/// ```yaml
/// {kind: sum, parts: ["blackbody:2856", {kind: line, wavelength: e, power: 3}]}
/// ```
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
struct Sum {
    /// Parts to add, one or more, by name or as maps with their `kind`.
    parts: Vec<Deferred<SpectrumForm>>,
}

spectra_core::register!(SpectrumEntry, "product": Product, build_kind::<Product>);
spectra_core::register!(SpectrumEntry, "sum": Sum, build_kind::<Sum>);

impl SpectrumKind for Product {
    fn make(&self, making: &SpectrumContext<'_>) -> Result<PendingSpectrum, Faults> {
        // The first factor may be of the wanted kind; the others are filters.
        let wanted = |i| if i == 0 { making.wanted() } else { Kind::Transmittance };
        together(&self.factors, "factors", making, |node, i| making.nested(node, wanted(i)), PendingSpectrum::times)
    }
}

impl SpectrumKind for Sum {
    fn make(&self, making: &SpectrumContext<'_>) -> Result<PendingSpectrum, Faults> {
        let whole = together(
            &self.parts,
            "parts",
            making,
            |node, _| making.nested_addend(node, making.wanted(), true),
            PendingSpectrum::plus,
        )?;
        if making.is_part() {
            return Ok(whole);
        }
        let wrong = |e: SpectrumError| e.faults(|text| making.params().fault("parts", text));
        match whole.settled().map_err(wrong)? {
            // A bare function is checked as the wanted kind, so that the fault is reported here.
            PendingSpectrum::Bare(shape) => {
                spectrum_of_function(shape.clone(), making.wanted()).map_err(wrong)?;
                Ok(PendingSpectrum::Bare(shape))
            }
            whole => Ok(whole),
        }
    }
}

fn together(
    nodes: &[Deferred<SpectrumForm>],
    key: &str,
    making: &SpectrumContext<'_>,
    part: impl Fn(&Deferred<SpectrumForm>, usize) -> Result<PendingSpectrum, Faults>,
    join: impl Fn(PendingSpectrum, PendingSpectrum) -> Result<PendingSpectrum, SpectrumError>,
) -> Result<PendingSpectrum, Faults> {
    let mut faults = Faults::new();
    let mut joined: Option<PendingSpectrum> = None;
    for (i, node) in nodes.iter().enumerate() {
        // A fault in one part hides no fault in the next.
        let Some(next) = faults.take(part(node, i)) else { continue };
        joined = match joined {
            None => Some(next),
            Some(before) => Some(join(before, next).map_err(|e| e.faults(|text| node.fault(text)))?),
        };
    }
    faults.into_result(())?;
    joined.ok_or_else(|| making.params().fault(key, "the list is empty").into())
}
