//! The cross-section of a scene's lens, with rays of three fields.

use spectra_analysis::draw::{Fans, Ground, Sheet, View};
use spectra_analysis::fan::FanFinder;
use spectra_lens::{Lens, Section};
use spectra_scene::Scene;

/// Fields beyond this are not looked for, degrees.
const WIDEST_DEG: f64 = 85.0;
/// Fields, as parts of the largest.
const PARTS: [f64; 3] = [0.0, 0.6, 0.95];
/// Wavelengths, nm.
const COLORS_NM: [f64; 3] = [450.0, 550.0, 640.0];

/// The drawing as SVG.
///
/// # Errors
/// Why there is none.
pub fn svg(scene: &Scene, is_dark: bool) -> Result<String, String> {
    let lens: &Lens = &scene.lens;
    let object_mm = scene.focus.distance_mm.unwrap_or(f64::INFINITY);
    let said = |error: spectra_glass::DispersionError| error.to_string();
    let finder = FanFinder::new(lens, Section::Y, lens.reference_nm).map_err(said)?;
    let largest = finder.largest_field_rad(object_mm, WIDEST_DEG.to_radians()).unwrap_or(0.0).to_degrees();
    let mut fields_deg: Vec<f64> = PARTS.map(|part| part * largest).into();
    fields_deg.dedup();
    let fans = Fans { fields_deg, object_mm, rays: 7, wavelengths_nm: COLORS_NM.into() };
    let rays = fans.trace(lens, Section::Y).map_err(said)?;
    let sheet = Sheet {
        width: 720.0,
        height: None,
        width_mm: None,
        ground: if is_dark { Ground::Dark } else { Ground::Light },
        view: View { section: Section::Y },
        caption: lens.name.clone(),
        image: true,
    };
    Ok(sheet.draw(lens, &rays).to_svg())
}
