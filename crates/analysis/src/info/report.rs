//! First-order figures, pupils and prescription of a lens.

use crate::Light;
use glam::DVec3;
use serde::Serialize;
use spectra_core::Isa;
use spectra_core::surface::Action;
use spectra_lens::{FirstOrder, Indices, Lens, MarginalRay, Tracer};

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
    /// Wavelength in air; `None` at the stated indices.
    pub wavelength_nm: Option<f64>,
    /// Name of the spectral line there.
    pub line: Option<&'static str>,
    /// Effective focal length.
    pub efl_mm: f64,
    /// Back focal length: last vertex to the rear focal point.
    pub bfl_mm: f64,
    /// Front focal length: first vertex to the front focal point, negative in front of it.
    pub ffl_mm: f64,
    /// 1 / (2 sin theta') of the real marginal ray of an axial object at infinity.
    pub f_number: Option<f64>,
    /// Entrance pupil, paraxial.
    pub entrance_pupil_z_mm: Option<f64>,
    /// Diameter of the beam that the lens takes in from an axial object at infinity: twice the height of
    /// the real marginal ray.
    pub entrance_pupil_diameter_mm: Option<f64>,
    /// Exit pupil, paraxial.
    pub exit_pupil_z_mm: Option<f64>,
    /// Diameter of the same beam, by the real marginal ray, in the plane of the exit pupil.
    pub exit_pupil_diameter_mm: Option<f64>,
    /// Exit pupil over entrance pupil, paraxial.
    pub pupil_magnification: Option<f64>,
    /// Front principal plane.
    pub front_principal_z_mm: f64,
    /// Rear principal plane.
    pub rear_principal_z_mm: f64,
    /// First vertex to image plane.
    pub total_track_mm: f64,
    /// First vertex to last.
    pub vertex_length_mm: f64,
    /// Last vertex to image plane.
    pub image_distance_mm: f64,
    /// Clear semi-diameter of the stop, as it is set.
    pub stop_semi_diameter_mm: Option<f64>,
    /// The surfaces, in the order of the light.
    pub surfaces: Vec<SurfaceReport>,
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
        let exit_pupil_z_mm = first_order.exit_pupil_z_mm.filter(|z| z.is_finite());
        Self {
            name: lens.name.clone(),
            year: lens.year,
            maker: lens.maker.clone(),
            patent: lens.patent.clone(),
            source: lens.source.clone(),
            remark: lens.remark.clone(),
            wavelength_nm: light.wavelength_nm(),
            line: light.line(),
            efl_mm: first_order.efl_mm,
            bfl_mm: first_order.bfl_mm,
            ffl_mm: first_order.ffl_mm,
            f_number: marginal.map(|ray| ray.f_number()).filter(|n| n.is_finite()),
            entrance_pupil_z_mm: first_order.entrance_pupil_z_mm.filter(|z| z.is_finite()),
            entrance_pupil_diameter_mm: marginal.map(|ray| 2.0 * ray.height_mm),
            exit_pupil_z_mm,
            exit_pupil_diameter_mm: marginal.zip(exit_pupil_z_mm).and_then(|(ray, z)| diameter_at_mm(&held, ray, z)),
            pupil_magnification: pupil_magnification(&first_order),
            front_principal_z_mm: first_order.front_principal_z_mm,
            rear_principal_z_mm: first_order.rear_principal_z_mm,
            total_track_mm: lens.image_z_mm(),
            vertex_length_mm: lens.elements.last().map_or(0.0, |e| e.along_axis_mm),
            image_distance_mm: lens.image_gap_mm(),
            stop_semi_diameter_mm: lens.stop().and_then(|stop| lens.elements[stop].semi_diameter_mm),
            surfaces: surfaces(&held),
            warnings: lens.warnings.clone(),
        }
    }
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
        let (_, curvature) = e.vertex_curvature_per_mm();
        SurfaceReport {
            number: at + 1,
            kind: e.kind.clone(),
            z_mm: e.vertex_z_mm(),
            radius_mm: (curvature != 0.0).then(|| 1.0 / curvature),
            thickness_mm: e.thickness_mm,
            semi_diameter_mm: e.semi_diameter_mm,
            medium: held.media[e.medium_after].label.clone(),
            index: held.index(e.medium_after, held.reference_nm),
            mirror: e.action == Action::Reflect,
        }
    });
    each.collect()
}
