//! The spectra of `kind: line` and `kind: lines`.

use super::{SpectrumContext, SpectrumEntry, SpectrumKind, build_kind};
use crate::emission::Emission;
use crate::error::SpectrumError;
use crate::inline::{line_nm, number};
use crate::lines::LineOrWavelength;
use crate::pending_spectrum::PendingSpectrum;
use schemars::JsonSchema;
use serde::Deserialize;
use spectra_core::params::{Faults, NonNegative};
use spectra_core::quantity::light_nm;
use spectra_core::spectral::Line;

/// One spectral line.
///
/// Use it for a laser, or for a line of a lamp that a filter has picked out. A line is drawn as such, at its own wavelength. As
/// an expression: `line:632.8`, `line:C'`.
///
/// # Example
/// ```yaml
/// {kind: line, wavelength: 632.8 nm, power: 2}
/// ```
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
struct LineParams {
    /// Wavelength of the line, nm if bare, or a short name such as `C'`.
    wavelength: LineOrWavelength,
    /// Power of the line, relative or W; 1 if absent.
    power: Option<NonNegative<f64>>,
}

/// Several spectral lines.
///
/// Use it for a discharge lamp, by its lines and their powers. As an expression: `lines:404.66=1,435.84=2`.
///
/// # Example
/// ```yaml
/// {kind: lines, lines: [{wavelength: 435.83 nm, power: 2}, {wavelength: e}]}
/// ```
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
struct LinesParams {
    /// The lines, one or more.
    #[schemars(length(min = 1))]
    lines: Vec<LineParams>,
}

spectra_core::register!(SpectrumEntry, "line": LineParams, build_kind::<LineParams>);
spectra_core::register!(SpectrumEntry, "lines": LinesParams, build_kind::<LinesParams>);
crate::expression!("line:C'", "write a letter or a wavelength in nm, such as line:C' or line:632.8", |text| {
    line_nm(text).map(|nm| of_lines(vec![Line { wavelength_nm: nm, power: 1.0 }]))
});
crate::expression!(
    "lines:404.66=1,435.84=2",
    "write wavelengths (or letters) with their powers, such as lines:404.66=1,435.84=2",
    |text| {
        let lines = text.split(',').map(weighted).collect::<Option<Vec<_>>>()?;
        Some(of_lines(lines))
    }
);

impl SpectrumKind for LineParams {
    fn make(&self, making: &SpectrumContext<'_>) -> Result<PendingSpectrum, Faults> {
        of_lines(vec![self.line()]).map_err(making.at("wavelength"))
    }
}

impl SpectrumKind for LinesParams {
    fn make(&self, making: &SpectrumContext<'_>) -> Result<PendingSpectrum, Faults> {
        let lines: Vec<Line> = self.lines.iter().map(LineParams::line).collect();
        let mut faults = Faults::new();
        for (i, line) in lines.iter().enumerate() {
            if let Err(wrong) = light_nm(line.wavelength_nm) {
                let fault = making.params().fault(&format!("lines[{i}].wavelength"), wrong.to_string());
                faults.push(fault.hint(wrong.hint()));
            }
        }
        faults.into_result(())?;
        of_lines(lines).map_err(making.at("lines"))
    }
}

impl LineParams {
    fn line(&self) -> Line {
        Line { wavelength_nm: self.wavelength.nm(), power: self.power.map_or(1.0, NonNegative::get) }
    }
}

fn of_lines(lines: Vec<Line>) -> Result<PendingSpectrum, SpectrumError> {
    // Wavelengths that are not positive are refused below.
    for line in lines.iter().filter(|line| line.wavelength_nm > 0.0) {
        light_nm(line.wavelength_nm)?;
    }
    Emission::new(None, lines).map(PendingSpectrum::from)
}

/// Reads a line of an expression: `435.84=2`.
fn weighted(text: &str) -> Option<Line> {
    let (nm, power) = match text.split_once('=') {
        Some((nm, power)) => (nm, number(power)?),
        None => (text, 1.0),
    };
    Some(Line { wavelength_nm: line_nm(nm)?, power })
}
