//! Fans of rays for a drawing, at several field angles and wavelengths.

use super::DrawnRay;
use crate::fan::FieldPoint;
use spectra_glass::DispersionError;
use spectra_lens::Section;
use spectra_optics::Optics;

/// The fans of rays drawn through a lens.
#[derive(Clone, Debug, PartialEq)]
pub struct Fans {
    /// Field angles, degrees.
    pub fields_deg: Vec<f64>,
    /// Distance of the object from the first vertex, mm; infinity allowed.
    pub object_mm: f64,
    /// Number of rays per fan and wavelength, evenly spaced over the rays that pass; an odd number includes the middle.
    pub rays: usize,
    /// Wavelengths, nm.
    pub wavelengths_nm: Vec<f64>,
}

impl Fans {
    /// Traces the fans in `section`. A field at which no ray passes adds no rays to the result.
    ///
    /// # Errors
    /// A medium has no index at one of the wavelengths.
    pub fn trace(&self, optics: &Optics, section: Section) -> Result<Vec<DrawnRay>, DispersionError> {
        let mut drawn = Vec::new();
        // Sort so that the brightest color is drawn last, on top.
        let mut wavelengths_nm = self.wavelengths_nm.clone();
        wavelengths_nm.sort_by(|a, b| (b - 550.0).abs().total_cmp(&(a - 550.0).abs()));
        for field_deg in &self.fields_deg {
            for wavelength_nm in &wavelengths_nm {
                let point = FieldPoint { section, field_rad: field_deg.to_radians(), object_mm: self.object_mm };
                let Some(fan) = point.fan(optics, *wavelength_nm)? else { continue };
                for k in 0..self.rays {
                    // Keep the outermost rays 1 % of the fan's width off the edge, so that they are sure to pass.
                    let part = if self.rays > 1 { k as f64 / (self.rays - 1) as f64 } else { 0.5 };
                    let path = fan.path(0.01 + 0.98 * part);
                    drawn.push(DrawnRay { path, wavelength_nm: *wavelength_nm, strength: 1.0 });
                }
            }
        }
        Ok(drawn)
    }
}
