//! One surface in its place.

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

/// One surface in its place.
#[derive(Clone, Debug)]
pub struct Element {
    /// Its `kind` in the file.
    pub kind: String,
    /// Its own parameters as they stand in the file, for export; `None` where it was built otherwise.
    pub parameters: Option<Params>,
    /// The prism that it is, if it is one; then [`Element::surface`] is a plane that stands for it in first order.
    pub solid: Option<Arc<Solid>>,
    /// Shape and bending.
    pub surface: Arc<dyn Surface>,
    /// Bends of the axis in front of it, in order.
    pub breaks: Vec<AxisBreak>,
    /// Its own shift and tilt about its vertex; what follows stays where it is.
    pub displacement: Displacement,
    /// Whether it stands the other way round, turned by half a turn about its y axis.
    pub reversed: bool,
    /// Distance to the next vertex along the axis, mm; of the last surface, to the image plane.
    pub thickness_mm: f64,
    /// Clear semi-diameter, mm; `None` clips nothing.
    pub semi_diameter_mm: Option<f64>,
    /// Edge of the element that it belongs to, mm, for drawing: a flat annulus lies outside of the clear
    /// semi-diameter. Clips nothing.
    pub outer_semi_diameter_mm: Option<f64>,
    /// Leg of the 45 degree chamfer at the edge, mm: positive toward +z.
    pub chamfer_mm: f64,
    /// What else limits the light here.
    pub apertures: Vec<Aperture>,
    /// Whether it is the aperture stop.
    pub stop: bool,
    /// What it does to light.
    pub action: Action,
    /// Its own coating; `None` has the lens's.
    pub coating: Option<Coating>,
    /// Where its cement has come apart, if it is cemented.
    pub separation: Option<Separation>,
    /// Rings that were left on it when it was made.
    pub onion_rings: Option<OnionRings>,
    /// What lies on it and scatters light.
    pub layers: Vec<Layer>,
    /// Part of the light that it reflects where it is a mirror, 0 to 1.
    pub reflectance: f64,
    /// Medium in front of it: index into [`crate::Lens::media`].
    pub medium_before: usize,
    /// Medium behind it.
    pub medium_after: usize,
    /// Where it stands; follows from the above, see [`crate::Lens::arrange`].
    pub pose: Pose,
    /// Length of the axis from the first vertex, mm: its z where nothing is folded.
    pub along_axis_mm: f64,
    /// Whether light that runs forward arrives here along the axis (and not, behind a mirror, against it).
    pub along: bool,
}

impl Element {
    /// A surface that refracts, on the axis; still to be placed by [`crate::Lens::arrange`].
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

    /// Its vertex, mm from the first one along the lens's z.
    #[must_use]
    pub fn vertex_z_mm(&self) -> f64 {
        self.pose.origin_mm.z
    }

    /// Curvature at the vertex along x and y, 1/mm, as it stands: turned round where the surface is.
    #[must_use]
    pub fn vertex_curvature_per_mm(&self) -> (f64, f64) {
        let (x, y) = self.surface.vertex_curvature_per_mm();
        if self.reversed { (-x, -y) } else { (x, y) }
    }
}
