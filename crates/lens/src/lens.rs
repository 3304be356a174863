//! A lens: surfaces along the axis, the media between them, and the source of its figures.

use crate::coating::Coating;
use crate::focus::FocusLaw;
use crate::group::Group;
use crate::origin::Rims;
use crate::pose::{AxisBreak, Pose};
use crate::{Element, symmetry};
use spectra_core::cover::CoverStack;
use spectra_core::surface::Action;
use spectra_glass::{LineTriple, Medium};

/// A medium of a lens as the prescription names it.
#[derive(Clone, Debug)]
pub struct LensMedium {
    /// Dispersion of the medium.
    pub medium: Medium,
    /// Index that the prescription states at its reference line; `None` if it states none.
    pub stated_nd: Option<f64>,
    /// Name of the medium in the lens file, such as `SCHOTT/BAF9` or `air`.
    pub label: String,
}

impl LensMedium {
    /// Returns air, which has index 1 because glass catalogues state indices relative to air.
    #[must_use]
    pub fn air() -> Self {
        Self { medium: Medium::Air, stated_nd: Some(1.0), label: "air".to_owned() }
    }
}

/// A lens: its surfaces, the media between them, and the source of its figures.
#[derive(Clone, Debug)]
pub struct Lens {
    /// Name of the lens, as people call it.
    pub name: String,
    /// Year of design; `None` if not known.
    pub year: Option<i32>,
    /// F-number in the name of the lens, as makers round it: the f-number at full aperture.
    pub nominal_f_number: Option<f64>,
    /// Factor by which the lens squeezes the picture horizontally, as makers round it; 1 for a lens that is not anamorphic.
    pub squeeze: f64,
    /// Patent and example from which the lens comes; `None` if not known.
    pub patent: Option<String>,
    /// Maker of the lens; `None` if not known.
    pub maker: Option<String>,
    /// Source of the figures of the prescription.
    pub source: Option<String>,
    /// Doubts about the figures, and choices that were made in the lens file.
    pub remark: Option<String>,
    /// Origin of the semi-diameters in the lens file; `None` if not known.
    pub rims: Option<Rims>,
    /// Wavelength of the reference line, nm. Focus and first-order figures are computed at it.
    pub reference_nm: f64,
    /// Lines of the Abbe numbers that belong to the reference line.
    pub abbe_lines: LineTriple,
    /// Surfaces of the lens, in the order in which light meets them.
    pub elements: Vec<Element>,
    /// Groups of surfaces that move together.
    pub groups: Vec<Group>,
    /// Focusing laws of the groups; if there is none, the whole lens moves.
    pub focus_laws: Vec<FocusLaw>,
    /// Object distance from the first vertex at which the lens is focused, mm; infinite as read from the file.
    pub focused_mm: f64,
    /// Bends of the axis between the last surface and the image plane.
    pub image_breaks: Vec<AxisBreak>,
    /// Plates directly in front of the frame of the camera, if there are any; see [`Lens::with_cover`].
    pub cover: Option<CoverStack>,
    /// Pose of the image plane in the frame of the lens. [`Lens::arrange`] computes it from the fields above.
    pub image_pose: Pose,
    /// Length of the axis from the first vertex to the image plane, mm: the z of the plane if the axis is not folded.
    /// [`Lens::arrange`] computes it, too.
    pub image_along_axis_mm: f64,
    /// Media of the lens; number 0 is air.
    pub media: Vec<LensMedium>,
    /// Coating of every surface that has none of its own.
    pub coating: Coating,
    /// Whether [`Lens::coating`] is assumed (usual for lenses of its time), instead of known.
    pub coating_assumed: bool,
    /// Whether glass absorbs light, as far as data are known.
    pub absorption: bool,
    /// Notes on how the lens is set up, which need no action.
    pub notes: Vec<String>,
    /// Warnings about the lens file, for example a glass that disagrees with the stated index.
    pub warnings: Vec<String>,
}

impl Lens {
    /// Creates a lens with a name, default values and no surfaces, to be filled in.
    #[must_use]
    pub fn empty(name: &str) -> Self {
        Self {
            name: name.to_owned(),
            year: None,
            nominal_f_number: None,
            squeeze: 1.0,
            patent: None,
            maker: None,
            source: None,
            remark: None,
            rims: None,
            reference_nm: LineTriple::FDC.mid.wavelength_nm,
            abbe_lines: LineTriple::FDC,
            elements: Vec::new(),
            groups: Vec::new(),
            focus_laws: Vec::new(),
            focused_mm: f64::INFINITY,
            image_breaks: Vec::new(),
            cover: None,
            image_pose: Pose::IDENTITY,
            image_along_axis_mm: 0.0,
            media: vec![LensMedium::air()],
            coating: Coating::Ideal,
            coating_assumed: false,
            absorption: false,
            notes: Vec::new(),
            warnings: Vec::new(),
        }
    }

    /// Index of the stop among the elements; `None` if there is no stop.
    #[must_use]
    pub fn stop(&self) -> Option<usize> {
        self.elements.iter().position(|e| e.stop)
    }

    /// Computes the poses of every surface and the image plane from the thicknesses, bends of the axis, displacements and groups.
    /// Call it after changing any of them.
    pub fn arrange(&mut self) {
        let mut axis = Pose::IDENTITY;
        let mut along_axis_mm = 0.0;
        let mut along = true;
        for e in &mut self.elements {
            (axis, along_axis_mm) = bent(axis, along_axis_mm, &e.breaks);
            e.along_axis_mm = along_axis_mm;
            let pose = if e.displacement.is_none() { axis } else { axis.then(&e.displacement.pose()) };
            e.pose = if e.reversed { pose.reversed() } else { pose };
            e.along = along != e.reversed;
            if e.action == Action::Reflect {
                along = !along;
            }
            if let Some(solid) = &e.solid {
                // The axis continues where it leaves the prism, along the light.
                axis = axis.then(&solid.exit);
                along_axis_mm += solid.reduced_mm;
            }
            axis = axis.advanced(e.thickness_mm);
            along_axis_mm += e.thickness_mm;
        }
        // Behind an odd number of mirrors light arrives from the other side. The image plane then faces that side but keeps the x axis of
        // the lens, so that a picture shows the subject unmirrored.
        let (image, image_along_axis_mm) = bent(axis, along_axis_mm, &self.image_breaks);
        self.image_along_axis_mm = image_along_axis_mm;
        self.image_pose = if along { image } else { image.facing_back() };
        for group in &self.groups {
            group.displace(&mut self.elements);
        }
    }

    /// Distance of the image plane from the first vertex along the lens's z, mm.
    #[must_use]
    pub fn image_z_mm(&self) -> f64 {
        self.image_pose.origin_mm.z
    }

    /// Length of the axis from the vertex of element `at` to the next one, mm.
    pub(crate) fn gap_mm(&self, at: usize) -> f64 {
        match (self.elements.get(at), self.elements.get(at + 1)) {
            (Some(here), Some(next)) => next.along_axis_mm - here.along_axis_mm,
            _ => 0.0,
        }
    }

    /// Returns whether the lens is symmetric about its axis: no surface is displaced, the axis is not folded, and every surface
    /// and aperture is round.
    #[must_use]
    pub fn has_axis_of_revolution(&self) -> bool {
        symmetry::has_axis_of_revolution(&self.elements, &self.image_pose)
    }

    /// Removes all clear semi-diameters and apertures, so that a ray ends only if it misses a surface or is totally reflected.
    pub fn remove_rims(&mut self) {
        for element in &mut self.elements {
            element.semi_diameter_mm = None;
            element.apertures.clear();
        }
    }

    /// Distance from the last vertex to the image plane, mm.
    #[must_use]
    pub fn image_gap_mm(&self) -> f64 {
        self.elements.last().map_or(0.0, |e| e.thickness_mm)
    }

    /// Returns the lens with `gap_mm` as the distance from the last vertex to the image plane.
    #[must_use]
    pub fn with_image_gap_mm(mut self, gap_mm: f64) -> Self {
        if let Some(last) = self.elements.last_mut() {
            last.thickness_mm = gap_mm;
        }
        self.arrange();
        self
    }

    /// Returns the lens with its stop set to this semi-diameter, mm. A lens without a stop is returned unchanged.
    #[must_use]
    pub fn with_stop_semi_diameter_mm(mut self, semi_diameter_mm: f64) -> Self {
        if let Some(stop) = self.stop() {
            self.elements[stop].semi_diameter_mm = Some(semi_diameter_mm);
        }
        self
    }

    /// Refractive index of medium number `medium` at a wavelength (nm), by its dispersion formula.
    #[must_use]
    pub fn index(&self, medium: usize, wavelength_nm: f64) -> f64 {
        self.media[medium].medium.index(wavelength_nm)
    }

    /// Largest stated clear semi-diameter, mm; `None` if no surface states one.
    #[must_use]
    pub fn largest_semi_diameter_mm(&self) -> Option<f64> {
        self.elements.iter().filter_map(|e| e.semi_diameter_mm).reduce(f64::max)
    }
}

/// Returns the axis behind these bends, and its length up to there, mm.
fn bent(mut axis: Pose, mut along_axis_mm: f64, breaks: &[AxisBreak]) -> (Pose, f64) {
    for bend in breaks {
        if !bend.displacement.is_none() {
            axis = axis.then(&bend.displacement.pose());
        }
        axis = axis.advanced(bend.thickness_mm);
        along_axis_mm += bend.thickness_mm;
    }
    (axis, along_axis_mm)
}
