//! Rays to be drawn: fans of several fields, in the colors of their wavelengths.

use super::DrawnRay;
use crate::fan::FanFinder;
use spectra_glass::DispersionError;
use spectra_lens::{Lens, Section};

/// Which rays are drawn through a lens.
#[derive(Clone, Debug, PartialEq)]
pub struct Fans {
    /// Field angles, degrees.
    pub fields_deg: Vec<f64>,
    /// Distance of the object from the first vertex, mm; infinity allowed.
    pub object_mm: f64,
    /// Rays a fan and wavelength, evenly over what passes; an odd number holds the middle.
    pub rays: usize,
    /// Wavelengths, nm.
    pub wavelengths_nm: Vec<f64>,
}

impl Fans {
    /// Traces them; a field at which nothing passes has none.
    ///
    /// # Errors
    /// A medium has no index at one of the wavelengths.
    pub fn trace(&self, lens: &Lens, section: Section) -> Result<Vec<DrawnRay>, DispersionError> {
        let mut drawn = Vec::new();
        // The brightest color lies on top.
        let mut wavelengths_nm = self.wavelengths_nm.clone();
        wavelengths_nm.sort_by(|a, b| (b - 550.0).abs().total_cmp(&(a - 550.0).abs()));
        for field_deg in &self.fields_deg {
            for wavelength_nm in &wavelengths_nm {
                let finder = FanFinder::new(lens, section, *wavelength_nm)?;
                let Some(fan) = finder.fan(field_deg.to_radians(), self.object_mm) else { continue };
                for k in 0..self.rays {
                    // The outermost rays keep off the edge by a hundredth: they are to pass.
                    let part = if self.rays > 1 { k as f64 / (self.rays - 1) as f64 } else { 0.5 };
                    let s_mm = fan.low_mm + (fan.high_mm - fan.low_mm) * (0.01 + 0.98 * part);
                    let path = finder.path(fan.field_rad, fan.object_mm, s_mm);
                    drawn.push(DrawnRay { path, wavelength_nm: *wavelength_nm, strength: 1.0 });
                }
            }
        }
        Ok(drawn)
    }
}
