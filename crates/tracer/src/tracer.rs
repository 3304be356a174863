//! Tracing of whole batches along a path: straight through the lens in either direction, or by reflections.
//!
//! The index of each glass is evaluated once per ray. The batch is brought into the frame of one surface after the other: by a shift on the
//! axis, by a rotation where a surface is tilted or the axis is folded. The tracer knows only poses. Behind a mirror light runs the other
//! way, so the direction of travel is stored for each surface (`Element::along`). The tracer ends at the nominal image plane and knows no
//! plates in front of the frame.
//!
//! **Optical path and polarization** are carried by batches on request: the path length, and Stokes numbers relative to the
//! weight with an axis across the ray. The tracer turns the axis to each plane of incidence and applies the complex amplitudes of
//! the coating. Other batches take unpolarized light at every surface, by the fast kernels, and pay nothing. Renders ask for
//! polarization where surfaces are steep ([`Tracer::polarizes`]: prisms, tilted plates). A surface that bends light by a law
//! other than Snell's adds its phase to the optical path (`phase`).

mod compile;
mod kernels;
mod phase;
mod prism;
mod program;
mod route;
mod run;
mod single;
mod work;

pub use route::Route;
pub use single::RayPath;
pub use work::Work;

use crate::absorption::{Absorption, Absorptions, Grid};
use crate::path::Path;
use crate::transmission::{Passage, RaysBefore};
use glam::DVec3;
use route::{ImagePlane, arrives, route};
use spectra_core::surface::{Action, Travel};
use spectra_glass::{Dispersion, DispersionError, Medium};
use spectra_lens::{ApertureShape, Coating, Element, Layer, Lens, Opening};

/// The refractive indices that a tracer uses.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Indices {
    /// The index of each medium at each ray's own wavelength, within a band.
    Band {
        /// Shortest wavelength, nm.
        min_nm: f64,
        /// Longest wavelength, nm.
        max_nm: f64,
    },
    /// The index that the prescription states for each medium; if it states none, the index at the reference line.
    Stated,
    /// The index of each medium at this wavelength (nm), whatever the wavelengths of the rays.
    At(f64),
}

/// Shortest wavelength of rays if the indices do not depend on their wavelength, nm.
const ANY_NM: f64 = 200.0;

/// A lens made ready for one band of light.
#[derive(Clone, Debug)]
pub struct Tracer {
    elements: Vec<Element>,
    /// Square of the radius at which each element clips, mm^2.
    clips: Vec<f64>,
    /// Openings of the irises of each element, by its apertures; `None` for other apertures.
    openings: Vec<Vec<Option<Opening>>>,
    image: ImagePlane,
    /// Distance from the first vertex at which the lens is focused, mm.
    focused_mm: f64,
    forward: Route,
    backward: Route,
    media: Vec<Dispersion>,
    /// What each surface does to the weight of light.
    passages: Vec<Passage>,
    /// Coatings of prisms, by element; [`Coating::Ideal`] for everything else.
    solid_coatings: Vec<Coating>,
    /// Layers of haze, dust and scratches on each surface.
    layers: Vec<Vec<Layer>>,
    /// Whether it traces light that layers scatter at least once. If false, it traces light that they never scatter.
    scattered: bool,
    /// What each medium absorbs; `None` if absorption is off.
    absorptions: Option<Absorptions>,
}

impl Tracer {
    /// Prepares a lens for tracing with these indices.
    ///
    /// # Errors
    /// A medium has no usable index somewhere in the band.
    pub fn new(lens: &Lens, indices: Indices) -> Result<Self, DispersionError> {
        let media = lens
            .media
            .iter()
            .map(|m| match indices {
                Indices::Band { min_nm, max_nm } => Dispersion::fit(&m.medium, min_nm, max_nm),
                Indices::Stated => {
                    let nd = m.stated_nd.unwrap_or_else(|| m.medium.index(lens.reference_nm));
                    Dispersion::fit(&Medium::Constant(nd), 350.0, 830.0)
                }
                Indices::At(wavelength_nm) => {
                    Dispersion::fit(&Medium::Constant(m.medium.index(wavelength_nm)), 350.0, 830.0)
                }
            })
            .collect::<Result<_, _>>()?;
        let clips = lens.elements.iter().map(round_clip2_mm2).collect();
        let openings = lens
            .elements
            .iter()
            .map(|e| e.apertures.iter().map(|aperture| aperture.opening(e.semi_diameter_mm)).collect());
        let openings = openings.collect();
        let shortest_nm = match indices {
            Indices::Band { min_nm, .. } => min_nm,
            Indices::Stated | Indices::At(_) => ANY_NM,
        };
        let passages = lens.elements.iter().map(|e| Passage::of(lens, e, shortest_nm)).collect();
        let solid_coating = |e: &Element| if e.solid.is_some() { lens.solid_coating_of(e) } else { Coating::Ideal };
        let solid_coatings = lens.elements.iter().map(solid_coating).collect();
        let (min_nm, max_nm) = match indices {
            Indices::Band { min_nm, max_nm } => (min_nm, max_nm),
            Indices::Stated => (lens.reference_nm, lens.reference_nm),
            Indices::At(wavelength_nm) => (wavelength_nm, wavelength_nm),
        };
        let grid = Grid::over(min_nm, max_nm);
        let absorption = |medium: &Medium| lens.absorption.then(|| Absorption::of(medium, lens.year, &grid)).flatten();
        let absorptions: Vec<Option<Absorption>> = lens.media.iter().map(|m| absorption(&m.medium)).collect();
        let absorptions = Absorptions::of(grid, &absorptions);
        let elements = lens.elements.clone();
        let layers: Vec<Vec<Layer>> = elements.iter().map(|e| e.layers.clone()).collect();
        let image = ImagePlane {
            pose: lens.image_pose,
            along_axis_mm: lens.image_along_axis_mm,
            sense: lens
                .elements
                .last()
                .map_or(1.0, |last| if last.action == Action::Reflect { -arrives(last) } else { arrives(last) }),
        };
        let way = |travel| route(&elements, &image, &Path::through(elements.len(), travel), None);
        let (forward, backward) = (way(Travel::Forward), way(Travel::Backward));
        Ok(Self {
            elements,
            clips,
            openings,
            image,
            focused_mm: lens.focused_mm,
            forward,
            backward,
            media,
            passages,
            solid_coatings,
            layers,
            scattered: false,
            absorptions,
        })
    }

    /// Prepares a path for all batches that follow it.
    ///
    /// # Panics
    /// If the path names an element that the lens does not have.
    #[must_use]
    pub fn route(&self, path: &Path) -> Route {
        route(&self.elements, &self.image, path, self.scattered.then_some(&self.layers[..]))
    }

    /// Returns a tracer for light that layers on surfaces ([`Layer`]) scatter at least once. Batches must then have
    /// [numbers](spectra_core::RayBatch::with_numbers). Without this, a tracer traces light that no layer scatters.
    #[must_use]
    pub fn scattering(mut self) -> Self {
        self.scattered = true;
        let way = |travel| self.route(&Path::through(self.elements.len(), travel));
        (self.forward, self.backward) = (way(Travel::Forward), way(Travel::Backward));
        self
    }

    /// Returns a tracer for the kind of light that `other` traces: scattered at least once, or never.
    #[must_use]
    pub fn scattering_like(self, other: &Self) -> Self {
        if other.scattered { self.scattering() } else { self }
    }

    /// Returns whether the direction of light behind an element depends on a random number. `at` is the element's index.
    pub fn is_random_at(&self, at: usize) -> bool {
        self.elements[at].surface.draws() || self.scattered && !self.layers[at].is_empty()
    }

    /// Number of surfaces, including the stop but not the image plane.
    #[must_use]
    pub fn surfaces(&self) -> usize {
        self.elements.len()
    }

    /// What a surface does to the weight of light.
    pub(crate) fn passage(&self, at: usize) -> &Passage {
        &self.passages[at]
    }

    /// Whether polarization must be carried from surface to surface. It must if a refracting surface is tilted by more than 30
    /// degrees to the axis, or if there are two or more prisms. Surfaces and prisms that pass all light, such as those with an
    /// ideal coating, do not count. Batches must then carry polarization ([`spectra_core::RayBatch::with_polarization`]). For
    /// other lenses ignoring it changes the light by less than 1 %.
    #[must_use]
    pub fn polarizes(&self) -> bool {
        /// Cosine of 30 degrees. At both sides of a plate of index 1.5 the mean of s and p light is wrong by 0.0003 there, at 60 degrees by 0.008.
        const STEEP: f64 = 0.866;
        let mut axis = DVec3::Z;
        let (mut planes, mut solids) = (0, 0);
        for ((element, passage), coating) in self.elements.iter().zip(&self.passages).zip(&self.solid_coatings) {
            let normal = element.pose.rotation.z_axis;
            let is_steep = axis.dot(normal).abs() < STEEP;
            if let Some(solid) = &element.solid {
                axis = element.pose.then(&solid.exit).rotation.z_axis;
                solids += usize::from(*coating != Coating::Ideal);
            } else if element.action == Action::Reflect {
                axis -= 2.0 * axis.dot(normal) * normal;
            } else if element.action == Action::Refract && is_steep && *passage != Passage::All {
                planes += 1;
            }
        }
        // A single prism keeps polarization by itself.
        planes > 0 || solids > 1
    }

    /// Returns the straight route through the lens in the direction `travel`, up to the first surface that draws random numbers.
    #[must_use]
    pub fn route_without_chance(&self, travel: Travel) -> Route {
        let path = Path::through(self.elements.len(), travel);
        self.route(&path.up_to(|at| self.is_random_at(at)))
    }

    /// Whether surfaces have rings that bend light, for which directions are taken down.
    fn has_rings(&self) -> bool {
        self.elements.iter().any(|e| e.onion_rings.is_some())
    }

    /// Room for what is taken down in front of surfaces.
    fn before(&self, capacity: usize) -> RaysBefore {
        RaysBefore::new(capacity, self.absorptions.as_ref().map_or(0, Absorptions::tables))
    }

    /// Whether light keeps its weight through it.
    fn is_ideal(&self) -> bool {
        let clear =
            |e: &Element, coating: &Coating| e.solid.is_none() || (*coating == Coating::Ideal && e.reflectance == 1.0);
        self.passages.iter().all(|p| *p == Passage::All)
            && self.elements.iter().zip(&self.solid_coatings).all(|(e, coating)| clear(e, coating))
            && self.absorptions.is_none()
            && !self.scattered
            && !self.has_rings()
    }
}

/// Square of the radius at which a surface clips, mm^2: an iris reaches beyond the circle of its area.
fn round_clip2_mm2(element: &Element) -> f64 {
    let Some(size_mm) = element.semi_diameter_mm else { return f64::INFINITY };
    let iris = element.apertures.iter().find_map(|a| match &a.shape {
        ApertureShape::Iris(iris) => Some(iris.opening(size_mm).corner_radius_mm()),
        _ => None,
    });
    let reach_mm = iris.unwrap_or(size_mm);
    reach_mm * reach_mm
}
