//! The spectrum of `kind: table`.

use super::{SpectrumContext, SpectrumEntry, SpectrumKind, build_kind, lengths, rising, some_light};
use crate::meta::{Outside, Scale};
use crate::pending_spectrum::PendingSpectrum;
use crate::spectral_function::SpectralFunction;
use crate::tabulated::Tabulated;
use schemars::JsonSchema;
use serde::Deserialize;
use spectra_core::params::{Faults, Wavelength};

/// A table of values at wavelengths, linear in between.
///
/// Use it for measured values, or for values read from a printed curve. A table of many rows is better kept as CSV.
///
/// # Example
/// ```yaml
/// {kind: table, wavelengths: [400, 500, 600, 700], values: [0.1, 0.4, 0.85, 0.9], outside: constant}
/// ```
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
struct Table {
    /// Wavelengths, nm if bare, in ascending order.
    #[schemars(length(min = 1))]
    wavelengths: Vec<Wavelength>,
    /// Values at these wavelengths, as many: fractions of 1 for a transmittance or reflectance, any scale for the others.
    values: Vec<f64>,
    /// Scale of the values: `linear`, or `log10` if they are logarithms to base 10; `linear` if absent.
    scale: Option<Scale>,
    /// Values outside of the table: `zero`, `constant` (the nearest value) or `geometric` (falling off as at the end); if absent,
    /// the default of the kind of spectrum.
    outside: Option<Outside>,
}

spectra_core::register!(SpectrumEntry, "table": Table, build_kind::<Table>);

impl SpectrumKind for Table {
    fn make(&self, making: &SpectrumContext<'_>) -> Result<PendingSpectrum, Faults> {
        let (params, wanted) = (making.params(), making.wanted());
        let counts = [self.values.len(), self.wavelengths.len()];
        lengths(params, ["wavelengths", "values"], counts, "the list of wavelengths")?;
        let (mut faults, scale) = (Faults::new(), self.scale.unwrap_or(Scale::Linear));
        rising(params, "wavelengths", &self.wavelengths, &mut faults);
        some_light(params, "wavelengths", &self.wavelengths, &mut faults);
        for (i, value) in self.values.iter().enumerate() {
            let text = match scale {
                Scale::Log10 if value.abs() > 20.0 => format!("{value} is implausible as a logarithm to base 10"),
                Scale::Linear if *value < 0.0 => format!("{wanted} cannot be negative: {value}"),
                Scale::Linear if wanted.bound().is_some_and(|b| *value > b) => {
                    format!("{value} is more than a {wanted} can be: given as percent? divide by 100")
                }
                _ => continue,
            };
            let hint = if *value < 0.0 { "write 0 where nothing was measured" } else { "is the `scale` wrong?" };
            faults.push(params.fault(&format!("values[{i}]"), text).hint(hint));
        }
        faults.into_result(())?;
        let nm: Vec<f64> = self.wavelengths.iter().map(|w| w.nm()).collect();
        let table = Tabulated::new(&nm, &self.values, self.outside.unwrap_or(wanted.outside()), scale)
            .map_err(making.at("values"))?;
        Ok(PendingSpectrum::Bare(SpectralFunction::tabulated(table)))
    }
}
