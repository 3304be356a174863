//! First-order figures, pupils and prescription of a lens.

use super::field::{
    FREQUENCY_PER_MM, FieldReport, LimitReport, PARTS, field, field_points, fields_at_heights, focus_shift_mm,
};
use super::mounts::{Glass, MountReport, cleared};
use crate::Light;
use glam::DVec3;
use serde::Serialize;
use spectra_core::Isa;
use spectra_core::surface::Action;
use spectra_lens::{Criterion, Element, FirstOrder, Indices, Lens, MarginalRay, Rims, Section, Tracer};

/// A lens in figures, all in one light. Places along the axis (`..._z_mm`) are measured from the first
/// vertex, +z toward the image. What a lens does not have (a pupil without a stop, a focal length
/// without power) is `None`, or infinite, which JSON writes as `null`.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct LensReport {
    /// Name for people.
    pub name: String,
    /// Year of design.
    pub year: Option<i32>,
    /// Maker.
    pub maker: Option<String>,
    /// Patent and example.
    pub patent: Option<String>,
    /// Where the figures come from.
    pub source: Option<String>,
    /// Doubts, choices of glass.
    pub remark: Option<String>,
    /// Where the semi-diameters come from.
    pub rims: Option<Rims>,
    /// Wavelength in air; `None` at the stated indices.
    pub wavelength_nm: Option<f64>,
    /// Name of the spectral line there.
    pub line: Option<&'static str>,
    /// Effective focal length.
    pub efl_mm: f64,
    /// Effective focal length in the x-z section, where it is another one.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub efl_x_mm: Option<f64>,
    /// Back focal length: last vertex to the rear focal point.
    pub bfl_mm: f64,
    /// Front focal length: first vertex to the front focal point, negative in front of it.
    pub ffl_mm: f64,
    /// 1 / (2 sin theta') of the real marginal ray of an axial object at infinity.
    pub f_number: Option<f64>,
    /// The f-number over the square root of the transmittance: what the exposure goes by.
    pub t_number: Option<f64>,
    /// Part of the light of the axial beam that reaches the image: coatings, mirrors, absorption, obstructions.
    pub transmittance: Option<f64>,
    /// What of coatings and absorption is counted, and what of it is assumed, in words.
    pub losses: String,
    /// The f-number in its name.
    pub nominal_f_number: Option<f64>,
    /// Entrance pupil, paraxial.
    pub entrance_pupil_z_mm: Option<f64>,
    /// Diameter of the beam that the lens takes in from an axial object at infinity: twice the height of
    /// the real marginal ray.
    pub entrance_pupil_diameter_mm: Option<f64>,
    /// Exit pupil, paraxial.
    pub exit_pupil_z_mm: Option<f64>,
    /// Diameter of the same beam in the plane of the exit pupil: by the real marginal ray, or where the lens is not round about one
    /// axis by the magnification.
    pub exit_pupil_diameter_mm: Option<f64>,
    /// Exit pupil over entrance pupil, paraxial.
    pub pupil_magnification: Option<f64>,
    /// Front principal plane.
    pub front_principal_z_mm: f64,
    /// Rear principal plane.
    pub rear_principal_z_mm: f64,
    /// Front nodal point.
    pub front_nodal_z_mm: f64,
    /// Rear nodal point.
    pub rear_nodal_z_mm: f64,
    /// Distance from the first vertex that it is focused at; infinite unless asked for.
    pub focus_distance_mm: f64,
    /// Size of the image over that of the object there, paraxial, negative upside down.
    pub magnification: f64,
    /// How far behind the image plane the paraxial image of the axial point there lies.
    pub paraxial_focus_shift_mm: Option<f64>,
    /// How far behind the image plane its spot is smallest (root mean square, real rays).
    pub rms_focus_shift_mm: Option<f64>,
    /// How far behind the image plane contrast is highest (geometrical, real rays).
    pub contrast_focus_shift_mm: Option<f64>,
    /// Spatial frequency of that contrast, line pairs a mm.
    pub contrast_frequency_per_mm: f64,
    /// Largest field angle from which any real ray passes.
    pub max_field_deg: Option<f64>,
    /// What ends the last light beyond it.
    pub max_field_limit: Option<LimitReport>,
    /// Field points, by their chief rays: real ones through the center of the stop, from the axis to the largest field, or to the image height
    /// that was asked for; to the corner of 135 film where no rim keeps the field within what is of use.
    pub chief_ray_exit_angle_deg: Vec<FieldReport>,
    /// Mounts that it fits, by the distances of its glass from the image plane.
    pub mounts: Vec<MountReport>,
    /// Whether the text names all of them, and not only the common ones.
    #[serde(skip)]
    pub every_mount: bool,
    /// Whether the field points end at the corner of 135 film, before the largest field.
    #[serde(skip)]
    pub is_cut: bool,
    /// First vertex to image plane, along the axis.
    pub total_track_mm: f64,
    /// First vertex to last, along the axis.
    pub vertex_length_mm: f64,
    /// Last vertex to image plane, along the axis.
    pub image_distance_mm: f64,
    /// Whether it has a stop.
    pub has_stop: bool,
    /// Clear semi-diameter of the stop, as it is set; `None` where it is open, and rims alone limit the light.
    pub stop_semi_diameter_mm: Option<f64>,
    /// The surfaces, in the order of the light.
    pub surfaces: Vec<SurfaceReport>,
    /// Veiling glare, where it was asked for.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub glare: Option<crate::glare::Glare>,
    /// Media of which something is assumed.
    pub assumed_media: Vec<super::media::AssumedMedium>,
    /// What is worth knowing of how it is set.
    pub notes: Vec<String>,
    /// What a person should know of the file.
    pub warnings: Vec<String>,
}

/// One surface.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct SurfaceReport {
    /// Its number, from 1.
    pub number: usize,
    /// Its kind.
    pub kind: String,
    /// Vertex, from the first.
    pub z_mm: f64,
    /// Radius of curvature at the vertex (in the y-z plane); `None` where it is flat.
    pub radius_mm: Option<f64>,
    /// Radius of curvature at the vertex in the x-z plane, where it is curved there by another radius; `None` elsewhere.
    pub radius_x_mm: Option<f64>,
    /// Distance to the next vertex; of the last surface, to the image plane.
    pub thickness_mm: f64,
    /// Clear semi-diameter; `None` clips nothing.
    pub semi_diameter_mm: Option<f64>,
    /// Medium behind it.
    pub medium: String,
    /// Its refractive index in this light.
    pub index: f64,
    /// Whether it is a mirror.
    pub mirror: bool,
}

impl LensReport {
    /// Looks at a lens, as it is focused and stopped, in one light.
    #[must_use]
    pub fn of(lens: &Lens, light: Light) -> Self {
        let held = light.hold(lens.clone());
        let first_order = held.first_order(held.reference_nm);
        let marginal = held.marginal_ray().ok();
        let efl_x_mm = held.first_order_in(Section::X, held.reference_nm).efl_mm;
        // Without power there is no image: what rounding leaves of its place, and of the f-number, means nothing.
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
                    // Behind a fold no plane of z is that of the pupil.
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
            // First order follows the axis; where the image plane stands beside it, the distance to it means nothing.
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
            // Behind the last surface the axis may bend, too.
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
                .chain(lens.glass_doubts())
                .collect(),
        }
    }
}

impl LensReport {
    /// The same with the field shown at the middle and at 0.5, 0.7 and 1 of an image height, mm above 0.
    ///
    /// # Errors
    /// No chief ray lands so far out: the largest height at which one does, mm.
    pub fn to_image_height(mut self, lens: &Lens, light: Light, height_mm: f64) -> Result<Self, f64> {
        let held = light.hold(lens.clone());
        let fields = fields_at_heights(&held, &PARTS.map(|part| part * height_mm))?;
        self.chief_ray_exit_angle_deg = field_points(lens, &held, indices(light), &fields);
        self.is_cut = false;
        Ok(self)
    }
}

/// Which indices a tracer takes in this light.
fn indices(light: Light) -> Indices {
    light.wavelength_nm().map_or(Indices::Stated, Indices::At)
}

/// The image plane may lie this part of the focal length from the image: published last distances are for other focus, or rounded.
const FAR: f64 = 0.1;

/// A doubt where the image plane of a straight lens lies far from the image: a scene focuses anew, but whoever looks at a prescription wants to
/// know.
fn misplaced_image(lens: &Lens, first_order: &FirstOrder, defocus_mm: f64) -> Option<String> {
    let images = lens.image_pose.is_on_axis() && first_order.efl_mm > 0.0 && first_order.bfl_mm > 0.0;
    (images && defocus_mm.abs() > FAR * first_order.efl_mm).then(|| {
        format!(
            "the image lies {:.2} mm {} the image plane: is a radius, its sign or a thickness wrong?",
            defocus_mm.abs(),
            if defocus_mm > 0.0 { "behind" } else { "in front of" }
        )
    })
}

/// At infinity everything is imaged without size.
fn magnification(held: &Lens) -> f64 {
    if held.focused_mm == f64::INFINITY { 0.0 } else { held.paraxial_magnification(held.focused_mm, held.reference_nm) }
}

/// The surfaces of glass, as a mount sees them; `None` where the axis is folded.
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

/// Twice the distance from the axis at which the marginal ray, behind the lens, crosses the plane `z_mm`.
fn diameter_at_mm(held: &Lens, ray: MarginalRay, z_mm: f64) -> Option<f64> {
    let tracer = Tracer::new(held, Indices::At(held.reference_nm), Isa::Baseline).ok()?;
    let path = tracer.path(DVec3::new(0.0, ray.height_mm, 0.0), DVec3::Z, held.reference_nm);
    let last = path.points.last().filter(|_| path.end.is_none())?;
    let y = last.y + (z_mm - last.z) * path.direction.y / path.direction.z;
    Some(2.0 * y.abs()).filter(|d| d.is_finite())
}

fn surfaces(held: &Lens) -> Vec<SurfaceReport> {
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
