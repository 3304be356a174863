//! `kind: product` and `kind: sum`.

use super::{Making, SpectrumEntry, SpectrumForm, SpectrumKind, build_kind};
use crate::error::SpectrumError;
use crate::meta::Kind;
use crate::piece::{Piece, of_shape};
use schemars::JsonSchema;
use serde::Deserialize;
use spectra_core::params::{Faults, Part};

/// Spectra multiplied: a light behind filters.
///
/// The first is what is wanted, the others are filters; functions take part as filters. In a line: `D65 * wratten-15`.
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
    /// What is multiplied, one or more: the first is what is wanted, such as a light, the others are filters. By name,
    /// or as maps with their `kind`.
    factors: Vec<Part<SpectrumForm>>,
}

/// Spectra added.
///
/// Lamps that shine together, or bands of one filter. Parts may be negative (a notch is 1 minus a band); the sum must not. In a
/// line: `D65 + 5000 * line:e`, `1 - 0.9 * gaussian:550,20`.
///
/// # Example
/// ```yaml
/// {kind: sum, parts: ["blackbody:2856", {kind: line, wavelength: e, power: 3}]}
/// ```
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
struct Sum {
    /// What is added, one or more: by name, or as maps with their `kind`.
    parts: Vec<Part<SpectrumForm>>,
}

spectra_core::register!(SpectrumEntry, "product": Product, build_kind::<Product>);
spectra_core::register!(SpectrumEntry, "sum": Sum, build_kind::<Sum>);

impl SpectrumKind for Product {
    fn make(&self, making: &Making<'_>) -> Result<Piece, Faults> {
        // The first may be what is wanted; what stands behind it are filters.
        let wanted = |i| if i == 0 { making.wanted() } else { Kind::Transmittance };
        together(&self.factors, "factors", making, |node, i| making.part(node, wanted(i)), Piece::times)
    }
}

impl SpectrumKind for Sum {
    fn make(&self, making: &Making<'_>) -> Result<Piece, Faults> {
        let whole =
            together(&self.parts, "parts", making, |node, _| making.addend(node, making.wanted(), true), Piece::plus)?;
        if making.is_part() {
            return Ok(whole);
        }
        let wrong = |e: SpectrumError| e.faults(|text| making.params().fault("parts", text));
        match whole.settled().map_err(wrong)? {
            // What is of no kind yet is judged as what is wanted, so that the fault is told here.
            Piece::Bare(shape) => {
                of_shape(shape.clone(), making.wanted()).map_err(wrong)?;
                Ok(Piece::Bare(shape))
            }
            whole => Ok(whole),
        }
    }
}

fn together(
    nodes: &[Part<SpectrumForm>],
    key: &str,
    making: &Making<'_>,
    part: impl Fn(&Part<SpectrumForm>, usize) -> Result<Piece, Faults>,
    join: impl Fn(Piece, Piece) -> Result<Piece, SpectrumError>,
) -> Result<Piece, Faults> {
    let mut faults = Faults::new();
    let mut joined: Option<Piece> = None;
    for (i, node) in nodes.iter().enumerate() {
        // What is wrong with one hides nothing that is wrong with the next.
        let Some(next) = faults.take(part(node, i)) else { continue };
        joined = match joined {
            None => Some(next),
            Some(before) => Some(join(before, next).map_err(|e| e.faults(|text| node.fault(text)))?),
        };
    }
    faults.into_result(())?;
    joined.ok_or_else(|| making.params().fault(key, "there are none").into())
}
