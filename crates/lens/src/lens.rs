//! A lens: surfaces along the axis, media between them, and where it comes from.

use crate::aperture::Shape;
use crate::coating::Coating;
use crate::focus::FocusLaw;
use crate::group::Group;
use crate::origin::Rims;
use crate::pose::{AxisBreak, Pose};
use crate::{Element, symmetry};
use spectra_core::cover::CoverStack;
use spectra_core::surface::Action;
use spectra_glass::{LineTriple, Medium};

/// A medium as the prescription names it.
#[derive(Clone, Debug)]
pub struct LensMedium {
    /// Its dispersion.
    pub medium: Medium,
    /// The index that the prescription states at its reference line, if it does.
    pub stated_nd: Option<f64>,
    /// How the file names it, such as `SCHOTT/BAF9` or `air`.
    pub label: String,
}

impl LensMedium {
    /// Air, index 1: glass catalogues state indices relative to it.
    #[must_use]
    pub fn air() -> Self {
        Self { medium: Medium::Air, stated_nd: Some(1.0), label: "air".to_owned() }
    }
}

/// A lens.
#[derive(Clone, Debug)]
pub struct Lens {
    /// Name for people.
    pub name: String,
    /// Year of design, where known.
    pub year: Option<i32>,
    /// The f-number in its name: full aperture, as makers round it.
    pub nominal_f_number: Option<f64>,
    /// By how much it squeezes the picture across, as makers round it; 1 of any lens that is not anamorphic.
    pub squeeze: f64,
    /// Patent and example, where known.
    pub patent: Option<String>,
    /// Maker, where known.
    pub maker: Option<String>,
    /// Where the figures come from.
    pub source: Option<String>,
    /// Doubts, and choices that were made.
    pub remark: Option<String>,
    /// Where the semi-diameters come from, where that is known.
    pub rims: Option<Rims>,
    /// Wavelength of the reference line, nm: focus and first order are meant there.
    pub reference_nm: f64,
    /// The lines of the Abbe numbers that go with it.
    pub abbe_lines: LineTriple,
    /// The surfaces, in the order of the light.
    pub elements: Vec<Element>,
    /// Groups of surfaces that move together.
    pub groups: Vec<Group>,
    /// How groups move in focusing; none: the whole lens moves.
    pub focus_laws: Vec<FocusLaw>,
    /// Distance from the first vertex that it is focused at, mm; infinite as the file has it.
    pub focused_mm: f64,
    /// Bends of the axis between the last surface and the image plane.
    pub image_breaks: Vec<AxisBreak>,
    /// The plates right before the frame of the camera that it is on, if there are any: see [`Lens::with_cover`].
    pub cover: Option<CoverStack>,
    /// Where the image plane stands; follows from the above, see [`Lens::arrange`].
    pub image_pose: Pose,
    /// Length of the axis from the first vertex to the image plane, mm: its z where nothing is folded. Follows as well.
    pub image_along_axis_mm: f64,
    /// The media; number 0 is air.
    pub media: Vec<LensMedium>,
    /// Coating of every surface that states none of its own.
    pub coating: Coating,
    /// Whether that coating is assumed, as of lenses of the time, and not known.
    pub coating_assumed: bool,
    /// Whether glass absorbs, where its catalogue says how much.
    pub absorption: bool,
    /// What is worth knowing of how it is set; nothing that one should mend.
    pub notes: Vec<String>,
    /// What a person should know of the file: a glass that disagrees with the stated index, and so on.
    pub warnings: Vec<String>,
}

impl Lens {
    /// A lens without surfaces, of which nothing but the name is known; to be filled.
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

    /// Number of the stop among the elements, if there is one.
    #[must_use]
    pub fn stop(&self) -> Option<usize> {
        self.elements.iter().position(|e| e.stop)
    }

    /// Puts every surface where thicknesses, bends of the axis, displacements and groups say. To be called after any
    /// of them was changed.
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
                // From where the axis leaves it, along the light.
                axis = axis.then(&solid.exit);
                along_axis_mm += solid.reduced_mm;
            }
            axis = axis.advanced(e.thickness_mm);
            along_axis_mm += e.thickness_mm;
        }
        // Behind an odd number of mirrors light arrives from the other side: the image plane faces it, and its x is
        // that of the lens still, so that a picture shows the subject unmirrored.
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

    /// Whether it looks the same from all azimuths: nothing is displaced or folded, and every surface and aperture
    /// is round.
    #[must_use]
    pub fn has_axis_of_revolution(&self) -> bool {
        symmetry::has_axis_of_revolution(&self.elements, &self.image_pose)
    }

    /// The same lens with the blades of its stop opened to their circle: for what the f-number means.
    pub(crate) fn with_round_stop(mut self) -> Self {
        for e in &mut self.elements {
            e.apertures.retain(|a| !matches!(a.shape, Shape::Iris(_)));
        }
        self
    }

    /// Distance of the image plane from the last vertex, mm.
    #[must_use]
    pub fn image_gap_mm(&self) -> f64 {
        self.elements.last().map_or(0.0, |e| e.thickness_mm)
    }

    /// The same lens with another distance from the last vertex to the image plane, mm.
    #[must_use]
    pub fn with_image_gap_mm(mut self, gap_mm: f64) -> Self {
        if let Some(last) = self.elements.last_mut() {
            last.thickness_mm = gap_mm;
        }
        self.arrange();
        self
    }

    /// The same lens with its stop set to this semi-diameter, mm.
    #[must_use]
    pub fn with_stop_semi_diameter_mm(mut self, semi_diameter_mm: f64) -> Self {
        if let Some(stop) = self.stop() {
            self.elements[stop].semi_diameter_mm = Some(semi_diameter_mm);
        }
        self
    }

    /// Index of refraction of medium `medium` at a wavelength, by its formula.
    #[must_use]
    pub fn index(&self, medium: usize, wavelength_nm: f64) -> f64 {
        self.media[medium].medium.index(wavelength_nm)
    }

    /// The largest stated clear semi-diameter, mm; `None` where no surface states one.
    #[must_use]
    pub fn largest_semi_diameter_mm(&self) -> Option<f64> {
        self.elements.iter().filter_map(|e| e.semi_diameter_mm).reduce(f64::max)
    }
}

/// The axis behind bends, and how long it is by then.
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
