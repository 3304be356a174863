//! The light's way through the lens, as a figure beside the picture.

use crate::outcome::Failure;
use glam::DVec3;
use spectra_analysis::draw::{DrawnRay, Fans, Ground, Sheet, View};
use spectra_analysis::fan::FanFinder;
use spectra_color::RgbSpace;
use spectra_core::stage::Emit;
use spectra_core::{Isa, RayBatch};
use spectra_lens::{Indices, Section, Tracer};
use spectra_plot::Canvas;
use spectra_scene::{RaysFigure, Scene};
use spectra_spectrum::Observer;

/// Light that a screen can show, nm.
const VISIBLE_NM: [f64; 2] = [390.0, 710.0];
/// Fields of a source that is not a beam, as parts of the largest that passes.
const PARTS: [f64; 3] = [0.0, 0.6, 0.95];
const WIDEST_DEG: f64 = 85.0;

/// Draws it.
pub(crate) fn draw(scene: &Scene, figure: &RaysFigure, isa: Isa) -> Result<Canvas, Failure> {
    let failed = |e: spectra_glass::DispersionError| Failure::Failed(e.to_string());
    let rays = match scene.source.emit().filter(|emit| emit.is_directed()) {
        Some(emit) => beam(scene, emit, figure, isa).map_err(failed)?,
        None => fans(scene, figure).map_err(failed)?,
    };
    let sheet = Sheet {
        width: f64::from(figure.width_px),
        height: Some(f64::from(figure.height_px)),
        ground: if figure.light { Ground::Light } else { Ground::Dark },
        width_mm: figure.view_mm,
        view: View { section: Section::Y },
        caption: String::new(),
        image: figure.screen,
    };
    Ok(sheet.draw(&scene.lens, &rays))
}

/// A beam's own rays: for each line, or for wavelengths over its continuum.
fn beam(
    scene: &Scene,
    emit: &dyn Emit,
    figure: &RaysFigure,
    isa: Isa,
) -> Result<Vec<DrawnRay>, spectra_glass::DispersionError> {
    let spectrum = scene.source.spectrum();
    let visible = |nm: f64| (VISIBLE_NM[0]..=VISIBLE_NM[1]).contains(&nm);
    let lines = spectrum.lines.iter().enumerate().filter(|(_, line)| visible(line.wavelength_nm));
    let lines: Vec<(f64, u32)> = lines.map(|(at, line)| (line.wavelength_nm, at as u32)).collect();
    let continuum = spectrum.continuum.iter().any(|v| *v > 0.0);
    let step = (VISIBLE_NM[1] - VISIBLE_NM[0]) / f64::from(figure.wavelengths);
    let wavelengths =
        (0..figure.wavelengths).filter(|_| continuum).map(|k| VISIBLE_NM[0] + step * (f64::from(k) + 0.5));
    let wavelengths = wavelengths.map(|nm| (nm, spectra_core::batch::CONTINUUM));
    let mut drawn = Vec::new();
    // Lines and continuum have no common measure: each is relative to its own brightest.
    for group in [lines, wavelengths.collect()] {
        let first = drawn.len();
        for (wavelength_nm, line) in group {
            let n = figure.rays as usize;
            let mut rays = RayBatch::new(n);
            rays.restart(n);
            let c = rays.columns_mut();
            c.wavelength_nm.fill(wavelength_nm);
            c.line.fill(line);
            let across: Vec<f64> = (0..n).map(|k| (k as f64 + 0.5) / n as f64).collect();
            emit.place(&mut rays, &vec![0.5; n], &across, isa);
            let tracer = Tracer::new(&scene.lens, Indices::At(wavelength_nm), Isa::Baseline)?;
            for k in 0..n {
                let [position, direction] =
                    [rays.positions(), rays.directions()].map(|columns| DVec3::from_array(columns.map(|c| c[k])));
                let path = tracer.path(position, direction, wavelength_nm);
                drawn.push(DrawnRay { path, wavelength_nm, strength: rays.weights()[k] * brightness(wavelength_nm) });
            }
        }
        let brightest = drawn[first..].iter().map(|r| r.strength).fold(0.0, f64::max);
        for ray in &mut drawn[first..] {
            ray.strength = if figure.true_intensity && brightest > 0.0 { ray.strength / brightest } else { 1.0 };
        }
    }
    Ok(drawn)
}

/// How bright a screen shows one unit of light of a wavelength: the largest channel of its linear sRGB.
fn brightness(wavelength_nm: f64) -> f64 {
    let rgb = RgbSpace::srgb().from_xyz(Observer::cie_1931_2deg().at(wavelength_nm));
    rgb.into_iter().fold(0.0, f64::max)
}

/// Fans over the field, for a source that shines everywhere.
fn fans(scene: &Scene, figure: &RaysFigure) -> Result<Vec<DrawnRay>, spectra_glass::DispersionError> {
    let object_mm = scene.source.distance_mm();
    let finder = FanFinder::new(&scene.lens, Section::Y, scene.lens.reference_nm)?;
    let largest = finder.largest_field_rad(object_mm, f64::to_radians(WIDEST_DEG)).unwrap_or(0.0);
    let lines = [spectra_glass::lines::F_PRIME, spectra_glass::lines::E, spectra_glass::lines::C_PRIME];
    let fans = Fans {
        fields_deg: PARTS.iter().map(|part| part * largest.to_degrees()).collect(),
        object_mm,
        rays: figure.rays.max(3) as usize,
        wavelengths_nm: lines.map(|line| line.wavelength_nm).to_vec(),
    };
    fans.trace(&scene.lens, Section::Y)
}
