//! Elements: one surface with its position, its media and everything on it.

use crate::Solid;
use crate::aperture::Aperture;
use crate::coating::Coating;
use crate::onion::OnionRings;
use crate::pose::{AxisBreak, Displacement, Pose};
use crate::scatter::Layer;
use crate::separation::Separation;
use spectra_core::params::Params;
use spectra_core::surface::{Action, Surface};
use std::sync::Arc;

/// An element of a lens: one surface with its position, its media and everything on it, or a prism.
#[derive(Clone, Debug)]
pub struct Element {
    /// The `kind` of the surface in the lens file.
    pub kind: String,
    /// Parameters of the surface's kind as they stand in the lens file, for export; `None` if the surface was not read from a file.
    pub parameters: Option<Params>,
    /// The prism, if this element is one. [`Element::surface`] is then a plane that stands for it in first-order optics.
    pub solid: Option<Arc<Solid>>,
    /// Shape of the surface, and how it bends light.
    pub surface: Arc<dyn Surface>,
    /// Bends of the axis in front of this surface, in order.
    pub breaks: Vec<AxisBreak>,
    /// Shift and tilt of this surface alone about its vertex. Elements that follow stay where they are.
    pub displacement: Displacement,
    /// Whether the surface is reversed, that is, turned by half a turn about its y axis.
    pub reversed: bool,
    /// Distance to the next vertex along the axis, mm; for the last surface, to the image plane.
    pub thickness_mm: f64,
    /// Clear semi-diameter, mm; if `None`, the surface clips nothing.
    pub semi_diameter_mm: Option<f64>,
    /// Semi-diameter of the edge of the glass element, in mm. It is used for drawing and clips no light. A flat annulus lies
    /// outside the clear semi-diameter.
    pub outer_semi_diameter_mm: Option<f64>,
    /// Leg of the 45 degree chamfer at the edge, mm: positive toward +z.
    pub chamfer_mm: f64,
    /// Apertures besides the clear semi-diameter that limit the light at this surface.
    pub apertures: Vec<Aperture>,
    /// Whether this surface is the aperture stop of the lens.
    pub stop: bool,
    /// What the surface does to light: refract, reflect or pass it.
    pub action: Action,
    /// Coating of this surface; `None` for the coating of the lens.
    pub coating: Option<Coating>,
    /// Where the cement of this surface has separated; `None` if it holds, or if the surface is not cemented.
    pub separation: Option<Separation>,
    /// Rings left on the surface by the turning of its mold.
    pub onion_rings: Option<OnionRings>,
    /// Layers on the surface that scatter light.
    pub layers: Vec<Layer>,
    /// Fraction of the light that the surface reflects if it is a mirror, 0 to 1.
    pub reflectance: f64,
    /// Medium in front of the surface: index into [`crate::Lens::media`].
    pub medium_before: usize,
    /// Medium behind the surface: index into [`crate::Lens::media`].
    pub medium_after: usize,
    /// Pose of the surface in the frame of the lens. [`crate::Lens::arrange`] computes it from the fields above.
    pub pose: Pose,
    /// Length of the axis from the first vertex to this surface, mm: the z of the vertex if the axis is not folded.
    pub along_axis_mm: f64,
    /// Whether light that runs forward through the lens arrives here in the +z direction of the axis. Behind a mirror it arrives
    /// in the -z direction.
    pub along: bool,
}

impl Element {
    /// Creates a refracting surface (or a stop, if `surface` is one) on the axis. The media are indices into
    /// [`crate::Lens::media`]. [`crate::Lens::arrange`] must still place the surface.
    #[must_use]
    pub fn new(kind: &str, surface: Arc<dyn Surface>, medium_before: usize, medium_after: usize) -> Self {
        let stop = surface.is_stop();
        Self {
            kind: kind.to_owned(),
            parameters: None,
            solid: None,
            surface,
            breaks: Vec::new(),
            displacement: Displacement::NONE,
            reversed: false,
            thickness_mm: 0.0,
            semi_diameter_mm: None,
            outer_semi_diameter_mm: None,
            chamfer_mm: 0.0,
            apertures: Vec::new(),
            stop,
            action: if stop { Action::Pass } else { Action::Refract },
            coating: None,
            separation: None,
            onion_rings: None,
            layers: Vec::new(),
            reflectance: 1.0,
            medium_before,
            medium_after,
            pose: Pose::IDENTITY,
            along_axis_mm: 0.0,
            along: true,
        }
    }

    /// Position of the vertex along the lens's z axis, mm from the first vertex.
    #[must_use]
    pub fn vertex_z_mm(&self) -> f64 {
        self.pose.origin_mm.z
    }

    /// Curvature at the vertex along x and y, 1/mm. Its sign is reversed if the surface is reversed.
    #[must_use]
    pub fn vertex_curvature_per_mm(&self) -> (f64, f64) {
        let (x, y) = self.surface.vertex_curvature_per_mm();
        if self.reversed { (-x, -y) } else { (x, y) }
    }
}
