//! Drawing of the cross-section of a scene's lens, with rays of three fields.

use spectra_analysis::draw::{DrawingBackground, Fans, SectionView, Sheet};
use spectra_analysis::fan::largest_field_rad;
use spectra_glass::DispersionError;
use spectra_lens::Section;
use spectra_scene::Scene;

/// Largest field that is searched for, degrees.
const WIDEST_DEG: f64 = 85.0;
/// Drawn fields, as fractions of the largest.
const PARTS: [f64; 3] = [0.0, 0.6, 0.95];
/// Wavelengths of the drawn rays, nm.
const COLORS_NM: [f64; 3] = [450.0, 550.0, 640.0];

/// Draws the cross-section of the scene's lens as SVG, on a dark or light ground.
///
/// # Errors
/// A medium of the lens has no refractive index at a wavelength of the drawing.
pub fn svg(scene: &Scene, is_dark: bool) -> Result<String, DispersionError> {
    let lens = &scene.lens;
    let object_mm = scene.focus.distance_mm.unwrap_or(f64::INFINITY);
    let largest = largest_field_rad(lens, Section::Y, object_mm, WIDEST_DEG.to_radians())?;
    let largest = largest.unwrap_or(0.0).to_degrees();
    let mut fields_deg: Vec<f64> = PARTS.map(|part| part * largest).into();
    fields_deg.dedup();
    let fans = Fans { fields_deg, object_mm, rays: 7, wavelengths_nm: COLORS_NM.into() };
    let rays = fans.trace(lens, Section::Y)?;
    let sheet = Sheet {
        width: 720.0,
        height: None,
        width_mm: None,
        ground: if is_dark { DrawingBackground::Dark } else { DrawingBackground::Light },
        view: SectionView { section: Section::Y },
        caption: lens.name.clone(),
        image: true,
    };
    Ok(sheet.draw(lens, &rays).to_svg())
}
