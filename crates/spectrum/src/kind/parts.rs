//! `kind: product` and `kind: sum`.

use super::{Making, SpectrumEntry, SpectrumForm, SpectrumKind, build_kind};
use crate::error::SpectrumError;
use crate::meta::Kind;
use crate::piece::Piece;
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
/// Lamps that shine together, or bands of one filter. In a line: `0.5 * D65 + line:e`.
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
        together(&self.factors, "factors", making, wanted, Piece::times)
    }
}

impl SpectrumKind for Sum {
    fn make(&self, making: &Making<'_>) -> Result<Piece, Faults> {
        together(&self.parts, "parts", making, |_| making.wanted(), Piece::plus)
    }
}

fn together(
    nodes: &[Part<SpectrumForm>],
    key: &str,
    making: &Making<'_>,
    wanted: impl Fn(usize) -> Kind,
    join: impl Fn(Piece, Piece) -> Result<Piece, SpectrumError>,
) -> Result<Piece, Faults> {
    let mut faults = Faults::new();
    let mut joined: Option<Piece> = None;
    for (i, node) in nodes.iter().enumerate() {
        // What is wrong with one hides nothing that is wrong with the next.
        let Some(next) = faults.take(making.part(node, wanted(i))) else { continue };
        joined = match joined {
            None => Some(next),
            Some(before) => Some(join(before, next).map_err(|e| node.fault(e.to_string()))?),
        };
    }
    faults.into_result(())?;
    joined.ok_or_else(|| making.params().fault(key, "there are none").into())
}
