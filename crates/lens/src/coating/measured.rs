//! Measured coatings: coatings of which only a curve of transmittance or reflectance is known.

use super::Transmittance;
use spectra_core::spectral::Grid;
use spectra_spectrum::table::Table;
use spectra_spectrum::{Kind, SpectrumError};

/// A measured transmittance by wavelength, which is used at every angle, because a maker's curve says no more.
#[derive(Clone, Debug, PartialEq)]
pub struct MeasuredCoating {
    /// Transmittance for each nanometer, on [`GRID`].
    passes: Vec<f64>,
}

/// Grid on which measurements are tabulated: 200 to 2500 nm.
const GRID: Grid = Grid { start_nm: 200.0, step_nm: 1.0, count: 2301 };

impl MeasuredCoating {
    /// Creates a table from a function that returns the transmittance at a wavelength (nm). Values are clamped to 0 to 1.
    #[must_use]
    pub fn new(passes: impl Fn(f64) -> f64) -> Self {
        Self { passes: GRID.wavelengths_nm().map(|nm| passes(nm).clamp(0.0, 1.0)).collect() }
    }

    /// Transmittance at a wavelength (nm), interpolated linearly; the same for s and p light.
    #[must_use]
    pub fn transmittance(&self, wavelength_nm: f64) -> Transmittance {
        let place = (wavelength_nm - GRID.start_nm).clamp(0.0, (GRID.count - 2) as f64 + 1.0);
        let i = (place as usize).min(GRID.count - 2);
        let passes = self.passes[i] + (place - i as f64) * (self.passes[i + 1] - self.passes[i]);
        Transmittance { s: passes, p: passes }
    }

    /// Reads a column of a table: named `reflectance` (the light that does not pass) or `transmittance`, or of the kind that the table's
    /// front matter states. Beyond the ends of the table the nearest value is used.
    pub(super) fn from_table(name: &str, bytes: &[u8], column: Option<&str>) -> Result<Self, SpectrumError> {
        let table = Table::parse_bytes(name, bytes, Some(Kind::Reflectance))?;
        let at = match column {
            None if table.columns.len() == 1 => 0,
            None => return Err(SpectrumError::Ambiguous { name: name.into(), columns: table.columns }),
            Some(column) => {
                let at = table.columns.iter().position(|c| c == column);
                let columns = table.columns.clone();
                at.ok_or_else(|| SpectrumError::NoColumn { name: name.into(), column: column.into(), columns })?
            }
        };
        let passes = match (table.meta.kind, table.columns[at].as_str()) {
            (None, "transmittance") | (Some(Kind::Transmittance), _) => true,
            (None, _) | (Some(Kind::Reflectance), _) => false,
            (Some(other), _) => {
                let wanted = "reflectance or transmittance";
                return Err(SpectrumError::WrongKind { name: name.into(), found: other.word(), wanted });
            }
        };
        let values = table.column_at(at);
        Ok(Self::new(|nm| if passes { values.at(nm) } else { 1.0 - values.at(nm) }))
    }
}
