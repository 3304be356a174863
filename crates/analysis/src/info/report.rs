//! Report of a lens: first-order figures, pupils and prescription.

use super::lens_field::{
    FREQUENCY_PER_MM, FieldReport, LimitReport, PARTS, field, field_points, fields_at_heights, focus_shift_mm,
};
use super::mounts::{Glass, MountReport, cleared};
use crate::AnalysisLight;
use glam::DVec3;
use serde::Serialize;
use spectra_core::surface::Action;
use spectra_lens::{Element, FirstOrder, Lens, Rims, Section};
use spectra_optics::{Criterion, MarginalRay, Optics};
use spectra_tracer::Indices;

/// Report of a lens in one light. Positions along the axis (`..._z_mm`) are measured from the first vertex, +z toward the image.
/// A figure that the lens does not have is `None` or infinite, which JSON writes as `null`. Examples are a pupil without a stop,
/// and a focal length without power.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct LensReport {
    /// Name of the lens.
    pub name: String,
    /// Year of design.
    pub year: Option<i32>,
    /// Maker or designer.
    pub maker: Option<String>,
    /// Number of the patent, and of the example in it.
    pub patent: Option<String>,
    /// Source of the prescription.
    pub source: Option<String>,
    /// Remarks on the prescription: doubts, choices of glass.
    pub remark: Option<String>,
    /// Origin of the semi-diameters.
    pub rims: Option<Rims>,
    /// Wavelength in air, nm; `None` at the stated indices.
    pub wavelength_nm: Option<f64>,
    /// Name of the spectral line at this wavelength.
    pub line: Option<&'static str>,
    /// Effective focal length, mm.
    pub efl_mm: f64,
    /// Effective focal length in the x-z section, mm; `None` if it equals that of the y-z section.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub efl_x_mm: Option<f64>,
    /// Back focal length, mm: from the last vertex to the rear focal point.
    pub bfl_mm: f64,
    /// Front focal length, mm: from the first vertex to the front focal point, negative in front of it.
    pub ffl_mm: f64,
    /// F-number: 1 / (2 sin theta') of the real marginal ray of an axial object at infinity.
    pub f_number: Option<f64>,
    /// T-number: the f-number divided by the square root of the transmittance. Exposure depends on it.
    pub t_number: Option<f64>,
    /// Part of the light of the axial beam that reaches the image, after losses by coatings, mirrors, absorption and obstructions.
    pub transmittance: Option<f64>,
    /// Description of the coatings and absorption included in the transmittance, and of what is assumed for them.
    pub losses: String,
    /// Nominal f-number in the name of the lens.
    pub nominal_f_number: Option<f64>,
    /// Position of the paraxial entrance pupil, mm from the first vertex.
    pub entrance_pupil_z_mm: Option<f64>,
    /// Entrance pupil diameter, mm: diameter of the beam that the lens accepts from an axial object at infinity, twice the height of the
    /// real marginal ray.
    pub entrance_pupil_diameter_mm: Option<f64>,
    /// Position of the paraxial exit pupil, mm from the first vertex.
    pub exit_pupil_z_mm: Option<f64>,
    /// Diameter, in the plane of the exit pupil, of the beam that the lens accepts from an axial object at infinity, mm. It comes
    /// from the real marginal ray, or from the pupil magnification if the lens is not rotationally symmetric about one axis.
    pub exit_pupil_diameter_mm: Option<f64>,
    /// Paraxial pupil magnification: exit pupil over entrance pupil.
    pub pupil_magnification: Option<f64>,
    /// Position of the front principal plane, mm from the first vertex.
    pub front_principal_z_mm: f64,
    /// Position of the rear principal plane, mm from the first vertex.
    pub rear_principal_z_mm: f64,
    /// Position of the front nodal point, mm from the first vertex.
    pub front_nodal_z_mm: f64,
    /// Position of the rear nodal point, mm from the first vertex.
    pub rear_nodal_z_mm: f64,
    /// Object distance from the first vertex at which the lens is focused, mm; infinite by default.
    pub focus_distance_mm: f64,
    /// Paraxial magnification at that distance: image size over object size, negative for an inverted image.
    pub magnification: f64,
    /// Distance of the paraxial image of the axial point in focus behind the image plane, mm.
    pub paraxial_focus_shift_mm: Option<f64>,
    /// Distance behind the image plane at which the axial spot is smallest (root mean square radius, real rays), mm.
    pub rms_focus_shift_mm: Option<f64>,
    /// Distance behind the image plane at which the axial contrast is highest (geometrical, real rays), mm.
    pub contrast_focus_shift_mm: Option<f64>,
    /// Spatial frequency of that contrast, line pairs per mm.
    pub contrast_frequency_per_mm: f64,
    /// Largest field angle from which any real ray passes, degrees.
    pub max_field_deg: Option<f64>,
    /// Surface that ends the last rays beyond the largest field.
    pub max_field_limit: Option<LimitReport>,
    /// Field points, by real chief rays through the center of the stop. They range from the axis to the largest field or to the requested
    /// image height. If no rim limits the field to a useful size, they end at the corner of 135 film.
    pub chief_ray_exit_angle_deg: Vec<FieldReport>,
    /// Mounts that the lens fits, judged by the distances of its glass from the image plane.
    pub mounts: Vec<MountReport>,
    /// Whether the text report lists all mounts instead of only the common ones.
    #[serde(skip)]
    pub every_mount: bool,
    /// Whether the field points end at the corner of 135 film, before the largest field.
    #[serde(skip)]
    pub is_cut: bool,
    /// Distance from the first vertex to the image plane along the axis, mm.
    pub total_track_mm: f64,
    /// Distance from the first vertex to the last along the axis, mm.
    pub vertex_length_mm: f64,
    /// Distance from the last vertex to the image plane along the axis, mm.
    pub image_distance_mm: f64,
    /// Whether the lens has a stop.
    pub has_stop: bool,
    /// Clear semi-diameter of the stop as it is set, mm; `None` if it is open, so that only rims limit the light.
    pub stop_semi_diameter_mm: Option<f64>,
    /// Surfaces in the order of the light.
    pub surfaces: Vec<SurfaceReport>,
    /// Veiling glare, if it was requested.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub glare: Option<crate::glare::Glare>,
    /// Media with assumed properties.
    pub assumed_media: Vec<super::media::AssumedMedium>,
    /// Notes on how the lens is set.
    pub notes: Vec<String>,
    /// Warnings about the lens file.
    pub warnings: Vec<String>,
}

/// One surface of a lens in a report.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct SurfaceReport {
    /// Number of the surface, from 1.
    pub number: usize,
    /// Kind of the surface, as in a lens file.
    pub kind: String,
    /// Position of the vertex, mm from the first vertex.
    pub z_mm: f64,
    /// Radius of curvature at the vertex in the y-z plane, mm; `None` if flat.
    pub radius_mm: Option<f64>,
    /// Radius of curvature at the vertex in the x-z plane, mm. `None` if the surface is flat in that plane or has the same radius
    /// as in the y-z plane.
    pub radius_x_mm: Option<f64>,
    /// Distance to the next vertex, mm; for the last surface, to the image plane.
    pub thickness_mm: f64,
    /// Clear semi-diameter, mm; `None` if the surface clips nothing.
    pub semi_diameter_mm: Option<f64>,
    /// Name of the medium behind the surface.
    pub medium: String,
    /// Refractive index of that medium in this light.
    pub index: f64,
    /// Whether the surface is a mirror.
    pub mirror: bool,
}

impl LensReport {
    /// Computes the report of a lens, as it is focused and stopped, in one light.
    #[must_use]
    pub fn of(lens: &Optics, light: AnalysisLight) -> Self {
        let held = Optics::new(light.with_fixed_indices(lens));
        let first_order = held.first_order(held.reference_nm);
        let marginal = held.marginal_ray().ok();
        let efl_x_mm = held.first_order_in(Section::X, held.reference_nm).efl_mm;
        // Skip the f-number and the focus of a lens without power: it has no image, and the values are rounding errors.
        let images = first_order.efl_mm.is_finite();
        let f_number = marginal.map(|ray| ray.f_number()).filter(|n| n.is_finite() && images);
        let shift_mm = |criterion| focus_shift_mm(&held, criterion).filter(|_| images);
        let indices = indices(light);
        let transmittance = lens.axial_transmittance(indices, marginal).ok();
        let field = field(lens, &held, indices);
        let paraxial = held.paraxial_defocus_mm(held.focused_mm);
        let exit_pupil_z_mm = first_order.exit_pupil_z_mm.filter(|z| z.is_finite());
        Self {
            name: lens.name.clone(),
            year: lens.year,
            maker: lens.maker.clone(),
            patent: lens.patent.clone(),
            source: lens.source.clone(),
            remark: lens.remark.clone(),
            rims: lens.rims.clone(),
            wavelength_nm: light.wavelength_nm(),
            line: light.line(),
            efl_mm: first_order.efl_mm,
            bfl_mm: first_order.bfl_mm,
            ffl_mm: first_order.ffl_mm,
            efl_x_mm: Some(efl_x_mm).filter(|x| (x - first_order.efl_mm).abs() > 1e-9 * first_order.efl_mm.abs()),
            f_number,
            t_number: f_number.zip(transmittance).map(|(n, t)| n / t.sqrt()).filter(|n| n.is_finite()),
            transmittance,
            losses: lens.losses(),
            nominal_f_number: lens.nominal_f_number,
            entrance_pupil_z_mm: first_order.entrance_pupil_z_mm.filter(|z| z.is_finite()),
            entrance_pupil_diameter_mm: marginal.map(|ray| 2.0 * ray.height_mm),
            exit_pupil_z_mm,
            exit_pupil_diameter_mm: marginal.zip(exit_pupil_z_mm).and_then(|(ray, z)| {
                if held.has_axis_of_revolution() {
                    diameter_at_mm(&held, ray, z)
                } else {
                    // Behind a fold no plane of constant z is the plane of the pupil.
                    pupil_magnification(&first_order).map(|magnification| 2.0 * ray.height_mm * magnification)
                }
            }),
            pupil_magnification: pupil_magnification(&first_order),
            front_principal_z_mm: first_order.front_principal_z_mm,
            rear_principal_z_mm: first_order.rear_principal_z_mm,
            front_nodal_z_mm: first_order.front_nodal_z_mm,
            rear_nodal_z_mm: first_order.rear_nodal_z_mm,
            focus_distance_mm: lens.focused_mm,
            magnification: magnification(&held),
            // Give no paraxial shift if the image plane is off the axis: first-order optics follows the axis, and the distance has no
            // meaning.
            paraxial_focus_shift_mm: Some(paraxial).filter(|z| z.is_finite() && lens.image_pose.is_on_axis()),
            rms_focus_shift_mm: shift_mm(Criterion::Rms),
            contrast_focus_shift_mm: shift_mm(Criterion::Contrast { per_mm: FREQUENCY_PER_MM }),
            contrast_frequency_per_mm: FREQUENCY_PER_MM,
            max_field_deg: field.largest_deg,
            max_field_limit: field.limit,
            chief_ray_exit_angle_deg: field.points,
            mounts: glass(lens).map(|glass| cleared(&glass)).unwrap_or_default(),
            every_mount: false,
            is_cut: field.is_cut,
            total_track_mm: if lens.image_pose.is_on_axis() { lens.image_z_mm() } else { lens.image_along_axis_mm },
            vertex_length_mm: lens.elements.last().map_or(0.0, |e| e.along_axis_mm),
            // The axis may bend behind the last surface, too.
            image_distance_mm: if lens.image_breaks.is_empty() {
                lens.image_gap_mm()
            } else {
                lens.image_along_axis_mm - lens.elements.last().map_or(0.0, |e| e.along_axis_mm)
            },
            has_stop: lens.stop().is_some(),
            stop_semi_diameter_mm: lens.stop().and_then(|stop| lens.elements[stop].semi_diameter_mm),
            surfaces: surfaces(&held),
            glare: None,
            assumed_media: super::media::assumed(lens),
            notes: lens.notes.clone(),
            warnings: (lens.warnings.iter().cloned())
                .chain(misplaced_image(lens, &first_order, paraxial))
                .chain(lens.glass_warnings())
                .collect(),
        }
    }
}

impl LensReport {
    /// Replaces the field points by points at 0, 0.5, 0.7 and 1 times the image height `height_mm` (mm), which must be above 0.
    ///
    /// # Errors
    /// No chief ray lands at this height. The error is the largest height at which one lands, mm.
    pub fn to_image_height(mut self, lens: &Optics, light: AnalysisLight, height_mm: f64) -> Result<Self, f64> {
        let held = Optics::new(light.with_fixed_indices(lens));
        let fields = fields_at_heights(&held, &PARTS.map(|part| part * height_mm))?;
        self.chief_ray_exit_angle_deg = field_points(lens, &held, indices(light), &fields);
        self.is_cut = false;
        Ok(self)
    }
}

/// Refractive indices that a tracer uses in this light.
fn indices(light: AnalysisLight) -> Indices {
    light.wavelength_nm().map_or(Indices::Stated, Indices::At)
}

/// Largest plausible distance of the image plane from the image, in focal lengths: published last distances may belong to another focus or
/// be rounded.
const FAR: f64 = 0.1;

/// Returns a warning if the image plane of a straight lens lies far from the image. A scene refocuses the lens, but a reader of the
/// prescription wants to know.
fn misplaced_image(lens: &Lens, first_order: &FirstOrder, defocus_mm: f64) -> Option<String> {
    let images = lens.image_pose.is_on_axis() && first_order.efl_mm > 0.0 && first_order.bfl_mm > 0.0;
    (images && defocus_mm.abs() > FAR * first_order.efl_mm).then(|| {
        format!(
            "the image lies {:.2} mm {} the image plane: check the radii, their signs and the thicknesses",
            defocus_mm.abs(),
            if defocus_mm > 0.0 { "behind" } else { "in front of" }
        )
    })
}

/// Paraxial magnification; 0 for an object at infinity.
fn magnification(held: &Optics) -> f64 {
    if held.focused_mm == f64::INFINITY { 0.0 } else { held.paraxial_magnification(held.focused_mm, held.reference_nm) }
}

/// Returns the glass surfaces for the test against mounts; `None` if the axis is folded.
fn glass(lens: &Lens) -> Option<Vec<Glass>> {
    if !lens.image_pose.is_on_axis() || lens.elements.iter().any(|e| e.action == Action::Reflect) {
        return None;
    }
    let seen = |e: &Element| {
        let sense = if e.reversed { -1.0 } else { 1.0 };
        let rim = e.semi_diameter_mm.and_then(|r| e.surface.sag_mm(0.0, r)).map_or(0.0, |sag| sense * sag);
        Glass {
            nearest_mm: lens.image_z_mm() - e.vertex_z_mm() - rim.max(0.0),
            semi_diameter_mm: e.semi_diameter_mm.unwrap_or(0.0),
        }
    };
    Some(lens.elements.iter().filter(|e| e.action != Action::Pass).map(seen).collect())
}

fn pupil_magnification(first_order: &FirstOrder) -> Option<f64> {
    let (exit, entrance) = (first_order.exit_pupil_magnification?, first_order.entrance_pupil_magnification?);
    Some((exit / entrance).abs()).filter(|p| p.is_finite())
}

/// Returns twice the distance from the axis at which the marginal ray, behind the lens, crosses the plane `z_mm`, mm.
fn diameter_at_mm(held: &Optics, ray: MarginalRay, z_mm: f64) -> Option<f64> {
    let tracer = held.tracer(Indices::At(held.reference_nm)).ok()?;
    let path = tracer.path(DVec3::new(0.0, ray.height_mm, 0.0), DVec3::Z, held.reference_nm);
    let last = path.points.last().filter(|_| path.end.is_none())?;
    let y = last.y + (z_mm - last.z) * path.direction.y / path.direction.z;
    Some(2.0 * y.abs()).filter(|d| d.is_finite())
}

fn surfaces(held: &Optics) -> Vec<SurfaceReport> {
    let each = held.elements.iter().enumerate().map(|(at, e)| {
        let (curvature_x, curvature) = e.vertex_curvature_per_mm();
        SurfaceReport {
            number: at + 1,
            kind: e.kind.clone(),
            z_mm: e.vertex_z_mm(),
            radius_mm: (curvature != 0.0).then(|| 1.0 / curvature),
            radius_x_mm: (curvature_x != 0.0 && curvature_x != curvature).then(|| 1.0 / curvature_x),
            thickness_mm: e.thickness_mm,
            semi_diameter_mm: e.semi_diameter_mm,
            medium: held.media[e.medium_after].label.clone(),
            index: held.index(e.medium_after, held.reference_nm),
            mirror: e.action == Action::Reflect,
        }
    });
    each.collect()
}
