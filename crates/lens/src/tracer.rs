//! Sequential tracing of whole batches, in either sense.

use crate::aperture::Shape;
use crate::pose::Pose;
use crate::transmission::{Absorption, Before, Passage};
use crate::{Element, Lens};
use glam::{DMat3, DVec3};
use spectra_core::batch::Column;
use spectra_core::isa::{Isa, Vectorized};
use spectra_core::surface::{Action, IndexColumns, Interface, Travel};
use spectra_core::{Loss, LossCounts, RayBatch};
use spectra_glass::{Dispersion, DispersionError, Medium};

/// Which refractive indices a tracer uses.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Indices {
    /// Those of each ray's wavelength, over this band, nm.
    Band {
        /// Shortest wavelength, nm.
        min_nm: f64,
        /// Longest, nm.
        max_nm: f64,
    },
    /// Every medium at the index that the prescription states, where it does.
    Stated,
    /// Every medium at this wavelength, nm, whatever the ray's own is.
    At(f64),
}

/// A lens made ready for one band of light.
#[derive(Debug)]
pub struct Tracer {
    elements: Vec<Element>,
    /// Square of the radius at which each clips, mm^2.
    clips: Vec<f64>,
    forward: Vec<Step>,
    backward: Vec<Step>,
    media: Vec<Dispersion>,
    /// What each surface does to the weight of light.
    passages: Vec<Passage>,
    /// What each medium absorbs, where that is asked for.
    absorptions: Vec<Option<Absorption>>,
    isa: Isa,
}

/// How rays come from one frame into the next.
#[derive(Clone, Copy, Debug)]
enum Step {
    /// Both stand alike on one line along z: the next origin lies this far, mm.
    Shift(f64),
    /// Anything else: the pose of the frame they are in, seen from the next one.
    Turn(Pose),
}

impl Step {
    fn between(from: &Pose, to: &Pose) -> Self {
        let aside = from.origin_mm - to.origin_mm;
        if from.rotation == to.rotation && from.rotation == DMat3::IDENTITY && aside.x == 0.0 && aside.y == 0.0 {
            return Self::Shift(to.origin_mm.z - from.origin_mm.z);
        }
        Self::Turn(to.inverse().then(from))
    }

    /// The steps along a list of frames.
    fn along<'a>(frames: impl Iterator<Item = &'a Pose> + Clone) -> Vec<Self> {
        frames.clone().zip(frames.skip(1)).map(|(from, to)| Self::between(from, to)).collect()
    }
}

/// What one thread needs to trace: index columns, and what was lost.
#[derive(Debug)]
pub struct Work {
    media: Vec<IndexColumnPair>,
    /// Rays lost so far, by cause and surface.
    pub losses: LossCounts,
    compact: bool,
    /// Of a lens that does not pass everything.
    before: Option<Before>,
}

/// One ray, surface by surface.
#[derive(Clone, Debug, PartialEq)]
pub struct RayPath {
    /// The start, then the point on each surface that it met, mm, frame of the lens.
    pub points: Vec<DVec3>,
    /// Direction behind the last surface it passed.
    pub direction: DVec3,
    /// Why and where it ended, if it did.
    pub end: Option<(Loss, u32)>,
}

impl Tracer {
    /// Makes a lens ready.
    ///
    /// # Errors
    /// A medium has no usable index somewhere in the band.
    pub fn new(lens: &Lens, indices: Indices, isa: Isa) -> Result<Self, DispersionError> {
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
        let own = std::iter::once(&Pose::IDENTITY);
        let frames: Vec<&Pose> =
            own.chain(lens.elements.iter().map(|e| &e.pose)).chain(std::iter::once(&lens.image_pose)).collect();
        let forward = Step::along(frames.iter().copied());
        let backward = Step::along(frames.iter().rev().copied());
        let clips = lens.elements.iter().map(round_clip2_mm2).collect();
        let passages = lens.elements.iter().map(|e| Passage::of(lens, e)).collect();
        let (min_nm, max_nm) = match indices {
            Indices::Band { min_nm, max_nm } => (min_nm, max_nm),
            Indices::Stated => (lens.reference_nm, lens.reference_nm),
            Indices::At(wavelength_nm) => (wavelength_nm, wavelength_nm),
        };
        let absorption =
            |medium: &Medium| lens.absorption.then(|| Absorption::of(medium, lens.year, min_nm, max_nm)).flatten();
        let absorptions = lens.media.iter().map(|m| absorption(&m.medium)).collect();
        let elements = lens.elements.clone();
        Ok(Self { elements, clips, forward, backward, media, passages, absorptions, isa })
    }

    /// The instruction set in use.
    #[must_use]
    pub fn isa(&self) -> Isa {
        self.isa
    }

    /// Number of surfaces, the stop included, the image plane not.
    #[must_use]
    pub fn surfaces(&self) -> usize {
        self.elements.len()
    }

    /// Whether light keeps its weight through it.
    fn is_ideal(&self) -> bool {
        self.passages.iter().all(|p| *p == Passage::All) && self.absorptions.iter().all(Option::is_none)
    }

    /// Scratch space for batches of up to `capacity` rays. Rays that end are dropped from the batch
    /// once they are the most of it.
    #[must_use]
    pub fn work(&self, capacity: usize) -> Work {
        let media = self.media.iter().map(|medium| IndexColumnPair::new(medium, capacity)).collect();
        let before = (!self.is_ideal()).then(|| Before::new(capacity));
        Work { media, losses: LossCounts::default(), compact: true, before }
    }

    /// The same, but no ray leaves its place in the batch.
    #[must_use]
    pub fn work_in_place(&self, capacity: usize) -> Work {
        Work { compact: false, ..self.work(capacity) }
    }

    /// Traces a batch through the whole lens. Forward, it enters in the frame of the lens and leaves
    /// in that of the image plane; backward the other way round.
    pub fn trace(&self, rays: &mut RayBatch, work: &mut Work, travel: Travel) {
        self.refractive_indices(rays, work);
        let steps = if travel == Travel::Forward { &self.forward } else { &self.backward };
        let mut alive = rays.len();
        for (step, into) in steps[..self.elements.len()].iter().enumerate() {
            let at = if travel == Travel::Forward { step } else { self.elements.len() - 1 - step };
            let ended = self.interact(rays, work, at, into, travel, self.isa, step == 0);
            if ended > 0 {
                self.count(rays, at as u32 + 1, &mut work.losses);
                alive -= ended;
                if work.compact && alive * 2 < rays.len() {
                    rays.compact();
                    self.refractive_indices(rays, work);
                }
            }
        }
        let outside = match travel {
            Travel::Forward => self.elements.last().map_or(0, |e| e.medium_after),
            Travel::Backward => self.elements.first().map_or(0, |e| e.medium_before),
        };
        let len = rays.len();
        let index = work.media[outside].n.slice(len);
        let shift_mm = match steps[self.elements.len()] {
            Step::Shift(shift_mm) => shift_mm,
            Step::Turn(pose) => {
                self.isa.run(Reframe { rays, pose });
                0.0
            }
        };
        self.isa.run(Leave { rays, index, shift_mm: -shift_mm });
    }

    /// Brings a batch onto element `at` and through it; says how many rays ended there. What lies in front of the
    /// `first` one is not part of the lens and absorbs nothing.
    fn interact(
        &self,
        rays: &mut RayBatch,
        work: &mut Work,
        at: usize,
        into: &Step,
        travel: Travel,
        isa: Isa,
        first: bool,
    ) -> usize {
        let element = &self.elements[at];
        let shift_mm = match into {
            Step::Shift(shift_mm) => *shift_mm,
            Step::Turn(pose) => {
                isa.run(Reframe { rays, pose: *pose });
                0.0
            }
        };
        let (before, after) = match travel {
            Travel::Forward => (element.medium_before, element.medium_after),
            Travel::Backward => (element.medium_after, element.medium_before),
        };
        let len = rays.len();
        if let Some(noted) = &mut work.before {
            noted.note(rays);
        }
        let interface = Interface {
            number: at as u32 + 1,
            shift_mm,
            clip_radius2_mm2: self.clips[at],
            action: element.action,
            travel: sense(element, travel),
            before: columns(&work.media[before], len),
            after: columns(&work.media[after], len),
        };
        let mut ended = element.surface.interact(rays, &interface, isa);
        if let Some(noted) = &work.before {
            if let (Some(absorption), false) = (&self.absorptions[before], first) {
                noted.absorb(rays, absorption, shift_mm);
            }
            noted.pass(rays, &self.passages[at], interface.before.n, interface.after.n, isa);
        }
        for aperture in &element.apertures {
            ended += aperture.clip(rays, interface.number, element.semi_diameter_mm);
        }
        rays.set_surface(interface.number);
        ended
    }

    /// Follows one ray forward, surface by surface: for drawings and searches, not for light.
    ///
    /// `position` (mm) and the unit `direction` are in the frame of the lens; so are the points.
    #[must_use]
    pub fn path(&self, position: DVec3, direction: DVec3, wavelength_nm: f64) -> RayPath {
        let mut rays = RayBatch::new(1);
        rays.restart(1);
        let c = rays.columns_mut();
        (c.x[0], c.y[0], c.z[0]) = position.into();
        (c.l[0], c.m[0], c.n[0]) = direction.into();
        c.wavelength_nm[0] = wavelength_nm;
        let mut work = self.work_in_place(1);
        self.refractive_indices(&rays, &mut work);
        let mut path = RayPath { points: vec![position], direction, end: None };
        for (at, (element, into)) in self.elements.iter().zip(&self.forward).enumerate() {
            self.interact(&mut rays, &mut work, at, into, Travel::Forward, Isa::Baseline, at == 0);
            let ([x, y, z], [l, m, n]) = (rays.positions(), rays.directions());
            path.end = rays.loss(0);
            if path.end.is_none_or(|(cause, _)| cause == Loss::Vignetted) {
                path.points.push(element.pose.point(DVec3::new(x[0], y[0], z[0])));
            }
            if path.end.is_some() {
                break;
            }
            path.direction = element.pose.direction(DVec3::new(l[0], m[0], n[0]));
        }
        path
    }

    fn refractive_indices(&self, rays: &RayBatch, work: &mut Work) {
        let len = rays.len();
        for (medium, columns) in self.media.iter().zip(&mut work.media) {
            if !columns.constant {
                let (n, inverse) = (columns.n.slice_mut(len), columns.inverse.slice_mut(len));
                self.isa.run(Evaluate { medium, wavelength_nm: rays.wavelengths_nm(), n, inverse });
            }
        }
    }

    fn count(&self, rays: &RayBatch, number: u32, losses: &mut LossCounts) {
        for cause in [Loss::Missed, Loss::Vignetted, Loss::TotalReflection, Loss::Absorbed] {
            let many = self.isa.run(Count { states: rays.states(), state: cause.state(number) });
            if many > 0 {
                losses.add(cause, number, many);
            }
        }
    }
}

/// Index and inverse index of one medium, for each ray of a batch.
#[derive(Debug)]
struct IndexColumnPair {
    n: Column<f64>,
    inverse: Column<f64>,
    /// Air, or an index held: written once, true for every batch.
    constant: bool,
}

impl IndexColumnPair {
    fn new(medium: &Dispersion, capacity: usize) -> Self {
        let (mut n, mut inverse) = (Column::new(capacity), Column::new(capacity));
        if let Some(index) = medium.constant() {
            n.slice_mut(capacity).fill(index);
            inverse.slice_mut(capacity).fill(1.0 / index);
        }
        Self { n, inverse, constant: medium.constant().is_some() }
    }
}

fn columns(medium: &IndexColumnPair, len: usize) -> IndexColumns<'_> {
    IndexColumns { n: medium.n.slice(len), inverse: medium.inverse.slice(len) }
}

struct Evaluate<'a> {
    medium: &'a Dispersion,
    wavelength_nm: &'a [f64],
    n: &'a mut [f64],
    inverse: &'a mut [f64],
}

impl Vectorized for Evaluate<'_> {
    type Output = ();
    #[inline(always)]
    fn run(self) {
        self.medium.index_and_inverse(self.wavelength_nm, self.n, self.inverse);
    }
}

/// The sense in which light meets a surface, along the surface's own z: behind a mirror, or where the surface is turned
/// round, it is the other one.
fn sense(element: &Element, travel: Travel) -> Travel {
    // Backward, a mirror is met from where light leaves it forward: on the same side.
    let forward = match travel {
        Travel::Forward => element.along,
        Travel::Backward => element.along == (element.action == Action::Reflect),
    };
    if forward { Travel::Forward } else { Travel::Backward }
}

/// Square of the radius at which a surface clips, mm^2: an iris reaches beyond the circle of its area.
fn round_clip2_mm2(element: &Element) -> f64 {
    let Some(size_mm) = element.semi_diameter_mm else { return f64::INFINITY };
    let iris = element.apertures.iter().find_map(|a| match &a.shape {
        Shape::Iris(iris) => Some(iris.opening(size_mm).corner_radius_mm()),
        _ => None,
    });
    let reach_mm = iris.unwrap_or(size_mm);
    reach_mm * reach_mm
}

/// Brings rays from one frame into another.
struct Reframe<'a> {
    rays: &'a mut RayBatch,
    /// The frame they are in, seen from the one they go to.
    pose: Pose,
}

impl Vectorized for Reframe<'_> {
    type Output = ();
    #[inline(always)]
    fn run(self) {
        let Pose { origin_mm: o, rotation: r } = self.pose;
        let c = self.rays.columns_mut();
        let len = c.x.len();
        let (x, y, z) = (&mut c.x[..len], &mut c.y[..len], &mut c.z[..len]);
        let (l, m, n) = (&mut c.l[..len], &mut c.m[..len], &mut c.n[..len]);
        for i in 0..len {
            let (px, py, pz) = (x[i], y[i], z[i]);
            x[i] = r.x_axis.x * px + r.y_axis.x * py + r.z_axis.x * pz + o.x;
            y[i] = r.x_axis.y * px + r.y_axis.y * py + r.z_axis.y * pz + o.y;
            z[i] = r.x_axis.z * px + r.y_axis.z * py + r.z_axis.z * pz + o.z;
            let (dl, dm, dn) = (l[i], m[i], n[i]);
            l[i] = r.x_axis.x * dl + r.y_axis.x * dm + r.z_axis.x * dn;
            m[i] = r.x_axis.y * dl + r.y_axis.y * dm + r.z_axis.y * dn;
            n[i] = r.x_axis.z * dl + r.y_axis.z * dm + r.z_axis.z * dn;
        }
    }
}

/// Puts rays into the frame that they leave the lens in, and into the medium there.
struct Leave<'a> {
    rays: &'a mut RayBatch,
    index: &'a [f64],
    shift_mm: f64,
}

impl Vectorized for Leave<'_> {
    type Output = ();
    #[inline(always)]
    fn run(self) {
        let c = self.rays.columns_mut();
        c.index.copy_from_slice(self.index);
        for z in c.z.iter_mut() {
            *z += self.shift_mm;
        }
    }
}

struct Count<'a> {
    states: &'a [u64],
    state: u64,
}

impl Vectorized for Count<'_> {
    type Output = u64;
    #[inline(always)]
    fn run(self) -> u64 {
        self.states.iter().map(|s| u64::from(*s == self.state)).sum()
    }
}
