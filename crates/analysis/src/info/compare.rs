//! Comparison of several lenses side by side.

use super::LensReport;
use super::lens_field::{FREQUENCY_PER_MM, NEAR_AXIS_RAD, distortion};
use crate::AnalysisLight;
use serde::Serialize;
use spectra_optics::{Beam, ObjectPoint, Optics};
use spectra_sheet::{Column, Sheet, Table};

/// Several lenses side by side, in the order in which they were named.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Comparison {
    /// Figures of each lens.
    pub lenses: Vec<Compared>,
    /// Spatial frequency of the contrasts, line pairs per mm.
    pub contrast_frequency_per_mm: f64,
    /// Field angle of the off-axis contrasts and of distortion, degrees: the same for all lenses, 0.7 of the smallest of their largest
    /// fields. `None` if the largest field of a lens is not known.
    pub field_deg: Option<f64>,
}

/// Figures of one lens in a comparison.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Compared {
    /// Full report of the lens, as in `lens info`.
    pub info: LensReport,
    /// Image circle: diameter of the picture at the largest field, mm.
    pub image_circle_mm: Option<f64>,
    /// Geometrical contrast on the axis in the plane where it is highest.
    pub axial_contrast: Option<f64>,
    /// Geometrical contrast at the field angle, in the same plane.
    pub field_contrast: Option<f64>,
    /// Distortion at the field angle: image height divided by the height without distortion, less one. The height without
    /// distortion has the image scale of the center everywhere.
    pub distortion: Option<f64>,
}

/// Fraction of the common field at which lenses are compared.
const PART: f64 = 0.7;
/// Number of rays across the beam for a contrast.
const CELLS: usize = 96;

impl Comparison {
    /// Computes the figures of several lenses as they are focused and stopped down. `light` applies to all lenses; with `None`,
    /// each is analyzed at its own reference line.
    #[must_use]
    pub fn of(lenses: &[Optics], light: Option<AnalysisLight>) -> Self {
        let light = |lens: &Optics| light.unwrap_or(AnalysisLight::Wavelength(lens.reference_nm));
        let reports: Vec<LensReport> = lenses.iter().map(|lens| LensReport::of(lens, light(lens))).collect();
        let largest: Option<Vec<f64>> = reports.iter().map(|r| r.max_field_deg).collect();
        let field_deg = largest.and_then(|all| all.into_iter().reduce(f64::min)).map(|deg| PART * deg);
        let each = lenses.iter().zip(reports).map(|(lens, info)| {
            let held = Optics::new(light(lens).with_fixed_indices(lens));
            let beam = |field_rad: f64| {
                let point = ObjectPoint::on_plane(&held, held.focused_mm, field_rad);
                Beam::trace(&held, point, &[(held.reference_nm, 1.0)], CELLS).ok().flatten()
            };
            let axis = beam(0.0);
            let z_mm = axis.as_ref().and_then(|b| b.best_contrast_z_mm(FREQUENCY_PER_MM));
            let contrast = |beam: Option<&Beam>| Some(beam?.contrast(z_mm?, FREQUENCY_PER_MM));
            let field_rad = field_deg.map(f64::to_radians);
            let rays = field_rad.and_then(|field| held.chief_rays(held.focused_mm, &[NEAR_AXIS_RAD, field]).ok());
            let distorted = rays.and_then(|rays| distortion(&held, rays.get(1)?.as_ref()?, rays.first()?.as_ref()?));
            Compared {
                image_circle_mm: info.chief_ray_exit_angle_deg.last().map(|ray| 2.0 * ray.image_height_mm.abs()),
                axial_contrast: contrast(axis.as_ref()),
                field_contrast: contrast(field_rad.and_then(beam).as_ref()),
                distortion: distorted,
                info,
            }
        });
        Self { lenses: each.collect(), contrast_frequency_per_mm: FREQUENCY_PER_MM, field_deg }
    }
}

/// Contrast of a perfect lens with a round pupil at a fraction of its cutoff frequency, 1 / (wavelength times f-number).
fn diffraction_limit(part: f64) -> f64 {
    if part >= 1.0 {
        return 0.0;
    }
    let root = (1.0 - part * part).sqrt();
    std::f64::consts::FRAC_2_PI * (spectra_core::math::atan2(root, part) - part * root)
}

impl Comparison {
    /// Returns the sheet of the comparison: its fields as data, and a table with a column for each lens.
    #[must_use]
    pub fn sheet(&self) -> Sheet {
        let mut sheet = Sheet::new("lenses side by side");
        sheet.fields(self);
        let names = self.lenses.iter().map(|lens| Column::text(&lens.info.name, &lens.info.name));
        let mut table = Table::new("lenses", std::iter::once(Column::text("figure", "")).chain(names));
        let mut row = |name: &str, figure: &dyn Fn(&Compared) -> Option<String>| {
            let figures = self.lenses.iter().map(figure);
            table.push(std::iter::once(Some(name.to_owned())).chain(figures).collect::<Vec<_>>());
        };
        let mm = |value: Option<f64>| value.filter(|v| v.is_finite()).map(|v| format!("{v:.2} mm"));
        let per_mm = self.contrast_frequency_per_mm;
        row("year", &|l| l.info.year.map(|y| y.to_string()));
        row("focal length", &|l| mm(Some(l.info.efl_mm)));
        row("f-number", &|l| l.info.f_number.map(|n| format!("f/{n:.3}")));
        row("T-number", &|l| l.info.t_number.map(|n| format!("T/{n:.3}")));
        row("  counted", &|l| Some(l.info.losses.clone()));
        row("entrance pupil", &|l| mm(l.info.entrance_pupil_diameter_mm));
        row("largest field", &|l| l.info.max_field_deg.map(|deg| format!("{deg:.1} deg")));
        row("image circle", &|l| mm(l.image_circle_mm));
        row("last surface to image", &|l| mm(Some(l.info.image_distance_mm)));
        row("length", &|l| mm(Some(l.info.vertex_length_mm)));
        row("surfaces", &|l| Some(l.info.surfaces.len().to_string()));
        row(&format!("geometrical contrast at {per_mm} lp/mm, axis, best focus"), &|l| {
            l.axial_contrast.map(|c| format!("{c:.3}"))
        });
        row("  diffraction limit", &|l| {
            let (n, nm) = l.info.f_number.zip(l.info.wavelength_nm)?;
            Some(format!("{:.3}", diffraction_limit(per_mm * n * nm * 1e-6)))
        });
        if let Some(deg) = self.field_deg {
            let contrast = |l: &Compared| l.field_contrast.map(|c| format!("{c:.3}"));
            row(&format!("  at {deg:.1} deg, mean of both sections"), &contrast);
            row(&format!("distortion at {deg:.1} deg"), &|l| l.distortion.map(|d| format!("{:+.2} %", 100.0 * d)));
        }
        sheet.show(table);
        for LensReport { name, notes, warnings, .. } in self.lenses.iter().map(|lens| &lens.info) {
            notes.iter().for_each(|note| sheet.note(&format!("note: {name}: {note}")));
            warnings.iter().for_each(|warning| sheet.note(&format!("warning: {name}: {warning}")));
        }
        sheet
    }
}

#[cfg(test)]
mod tests {
    use super::diffraction_limit;

    /// Known values at 587.56 nm and 30 lp/mm, for f/5, f/16 and f/22.
    #[test]
    fn diffraction_limits_contrast() {
        for (n, wanted) in [(5.0, 0.888), (16.0, 0.646), (22.0, 0.519)] {
            let found = diffraction_limit(30.0 * n * 587.56e-6);
            assert!((found - wanted).abs() < 1e-3, "{n}: {found}");
        }
        assert_eq!((diffraction_limit(0.0), diffraction_limit(1.2)), (1.0, 0.0));
    }
}
