//! Spectra in YAML: a map with its kind, and what the file says about itself.
//!
//! ```yaml
//! spectra: 1
//! name: a warm lamp behind a filter
//! kind: product
//! factors:
//!   - {kind: blackbody, temperature: 2856 K}
//!   - {kind: mixture, terms: [{amplitude: 0.9, center: 560, sigma: 300}, {amplitude: -0.5, center: 520, sigma: 25}]}
//! ```
//!
//! A file may say what it is a spectrum `of` (`emission`, `transmittance`, `reflectance`, `sensitivity`) and, in words, its
//! `name`, `source`, `license`, `conditions` and `note`. Without `of`, a function becomes the kind of spectrum that is wanted
//! where the file is named.

use crate::by_name::Loader;
use crate::kind::{SpectrumKind, of_params};
use crate::meta::{Kind, Meta};
use crate::pending_spectrum::PendingSpectrum;
use schemars::{JsonSchema, Schema, SchemaGenerator};
use serde::Deserialize;
use spectra_core::params::{Faults, Params, Whole, keys_of};
use spectra_core::registry;
use spectra_core::resources::Resources;

/// Data that a file states about itself beside its spectrum.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
struct Head {
    /// Version of the file format: 1; 1 if absent.
    #[expect(dead_code, reason = "its schema allows one version")]
    spectra: Option<Whole<1, 1>>,
    /// Kind of the spectrum: `emission`, `transmittance`, `reflectance` or `sensitivity`; if absent, the kind that is wanted
    /// where the file is named.
    of: Option<KindName>,
    /// Name for people.
    name: Option<String>,
    /// Source of the figures.
    source: Option<String>,
    /// License of the figures.
    license: Option<String>,
    /// License of the figures, as older files spell it.
    licence: Option<String>,
    /// Conditions of the measurement: angle, temperature, age.
    conditions: Option<String>,
    /// Doubts and choices, for people.
    note: Option<String>,
}

/// The kind of spectrum that a file holds.
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
#[schemars(inline)]
enum KindName {
    Emission,
    Transmittance,
    Reflectance,
    Sensitivity,
}

impl From<KindName> for Kind {
    fn from(name: KindName) -> Self {
        match name {
            KindName::Emission => Self::Emission,
            KindName::Transmittance => Self::Transmittance,
            KindName::Reflectance => Self::Reflectance,
            KindName::Sensitivity => Self::Sensitivity,
        }
    }
}

/// Returns the schema of a file that holds a spectrum.
#[must_use]
pub fn schema(generator: &mut SchemaGenerator) -> Schema {
    let head = Head::json_schema(generator);
    let mut schema = registry::kinds::<dyn SpectrumKind>(generator, Some(&head), false);
    schema.insert("description".to_owned(), ABOUT.into());
    schema
}

/// Documentation of such a file, as a user reads it.
const ABOUT: &str = "\
A spectrum: a light, a filter, a surface or a sensitivity, by its kind.

The key `of` may state what it is a spectrum of. Without it, a function such as a table or a Gaussian becomes the kind of \
spectrum that is wanted where the file is named. Lights are radiance or power per nanometer, relative unless scaled; \
transmittances and reflectances are fractions of 1. `product`, `sum` and `scale` make spectra from others. Each of these is \
a map like the ones here, the name of a bundled spectrum or file (`D65`, `wratten-15`, `gel.csv`), or an expression such as \
`blackbody:3200`. A table of many rows is better kept as CSV.

# Examples
```yaml
# A warm lamp behind a filter
spectra: 1
name: Enlarger lamp
kind: product
factors:
  - {kind: blackbody, temperature: 2856 K}
  - {kind: table, wavelengths: [400, 500, 600, 700], values: [0.1, 0.4, 0.85, 0.9], outside: constant}
```
```yaml
kind: scale
spectrum: {kind: lines, lines: [{wavelength: \"C'\", power: 2}, {wavelength: 546.07 nm}]}
luminance: 120 cd/m2
```";

/// Reads the spectrum of a whole file, and what the file says about itself. The spectrum is of the wanted kind, unless the file
/// states another.
pub(crate) fn of_file(
    file: &Params,
    wanted: Kind,
    loader: &Loader<'_>,
    files: &dyn Resources,
) -> Result<(PendingSpectrum, Meta), Faults> {
    let whole = Params::stage(file.node().clone(), "")?;
    let keys = keys_of::<Head>();
    let (head, own) = whole.split(&keys);
    let mut faults = Faults::new();
    let said: Option<Head> = faults.take(head.parse());
    let of = said.as_ref().and_then(|head| head.of).map(Kind::from);
    let piece = faults.take(of_params(&own, of.unwrap_or(wanted), loader, files));
    let (Some(said), Some(piece)) = (said, piece) else { return Err(faults) };
    faults.into_result(())?;
    let piece = match of {
        Some(kind) => {
            let found = piece.into_any(kind).map_err(|e| whole.fault_here(e.to_string()))?;
            if found.kind() != kind {
                let text = format!("the spectrum in the file is of kind {}", found.kind());
                return Err(whole.fault("of", text).into());
            }
            PendingSpectrum::Typed(found)
        }
        None => piece,
    };
    let Head { name, source, license, licence, conditions, note, .. } = said;
    let license = license.or(licence);
    let notes = note.into_iter().collect();
    Ok((piece, Meta { name, kind: of, source, license, conditions, notes, ..Meta::default() }))
}
