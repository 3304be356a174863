//! Tracing of whole batches along a path: straight through the lens in either direction, or by reflections.

mod kernels;
mod phase;
mod route;

pub use route::Route;

use crate::absorption::{Absorption, Absorptions, Grid};
use crate::aperture::{Opening, Shape};
use crate::coating::{Amplitudes, Coating};
use crate::ledger::{Booked, Ledger, StepLedger, living};
use crate::onion::Bent;
use crate::path::Path;
use crate::scatter::{self, Layer, Meeting, Shares};
use crate::solid::{Bend, Solid};
use crate::transmission::{Before, Passage, weigh_polarized};
use crate::{Element, Lens};
use glam::DVec3;
use kernels::{Count, Evaluate, Leave, Reframe};
use route::{ImagePlane, Leg, Move, arrives, route};
use spectra_core::batch::{Column, Polarization};
use spectra_core::isa::Isa;
use spectra_core::loss::ALIVE;
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

/// Who looks at rays behind each element.
type Seen<'a> = &'a mut dyn FnMut(usize, &RayBatch);

/// Where indices do not depend on the wavelength, rays may have any down to this, nm.
const ANY_NM: f64 = 200.0;

/// A lens made ready for one band of light.
#[derive(Debug)]
pub struct Tracer {
    elements: Vec<Element>,
    /// Square of the radius at which each clips, mm^2.
    clips: Vec<f64>,
    /// What the blades of each one's irises leave open, by its apertures; none of other apertures.
    openings: Vec<Vec<Option<Opening>>>,
    image: ImagePlane,
    /// Distance from the first vertex that the lens is focused at, mm.
    focused_mm: f64,
    forward: Route,
    backward: Route,
    media: Vec<Dispersion>,
    /// What each surface does to the weight of light.
    passages: Vec<Passage>,
    /// Coatings of prisms, by element; [`Coating::Ideal`] of all else.
    solid_coatings: Vec<Coating>,
    /// What lies on each surface.
    layers: Vec<Vec<Layer>>,
    /// Whether it traces what is scattered at least once, in place of what never is.
    scattered: bool,
    /// What each medium absorbs, where that is asked for.
    absorptions: Option<Absorptions>,
    isa: Isa,
}

/// What one thread needs to trace: index columns, and what was lost.
#[derive(Debug)]
pub struct Work {
    media: Vec<IndexColumnPair>,
    /// Rays lost so far, by cause and surface.
    pub losses: LossCounts,
    compact: bool,
    capacity: usize,
    /// Of a lens that does not pass everything, and of batches that carry their optical path.
    before: Option<Before>,
    /// Where light goes, if somebody asks.
    ledger: Option<(Ledger, Booked)>,
}

impl Work {
    /// From now on books where the light of a path goes. One ledger serves one path: see [`Work::take_ledger`].
    #[must_use]
    pub fn with_ledger(mut self) -> Self {
        self.ledger = Some((Ledger::default(), Booked::new(self.capacity)));
        self
    }

    /// Weighs rays by what media absorbed of them so far.
    fn weigh_absorbed(&mut self, rays: &mut RayBatch, isa: Isa) {
        if let Some(noted) = &mut self.before {
            noted.weigh_absorbed(rays, isa);
        }
    }

    /// The ledger so far, which begins anew; `None` if none is kept.
    pub fn take_ledger(&mut self) -> Option<Ledger> {
        self.ledger.as_mut().map(|(ledger, _)| std::mem::take(ledger))
    }
}

/// One ray, surface by surface.
#[derive(Clone, Debug, PartialEq)]
pub struct RayPath {
    /// The start, then the point on each surface that it met, mm, frame of the lens.
    pub points: Vec<DVec3>,
    /// The element of each point but the start.
    pub elements: Vec<usize>,
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
            isa,
        })
    }

    /// Makes a path ready, once for all batches that follow it.
    ///
    /// # Panics
    /// If the path names an element that the lens does not have.
    #[must_use]
    pub fn route(&self, path: &Path) -> Route {
        route(&self.elements, &self.image, path, self.scattered.then_some(&self.layers[..]))
    }

    /// The same for light that layers on surfaces scatter at least once ([`crate::Layer`]): batches that follow it must have
    /// [numbers](RayBatch::with_numbers). As it is, a tracer traces light that none of them scatters.
    #[must_use]
    pub fn scattering(mut self) -> Self {
        self.scattered = true;
        let way = |travel| self.route(&Path::through(self.elements.len(), travel));
        (self.forward, self.backward) = (way(Travel::Forward), way(Travel::Backward));
        self
    }

    /// For the same kind of light as another one.
    pub(crate) fn like(self, other: &Self) -> Self {
        if other.scattered { self.scattering() } else { self }
    }

    /// Whether behind an element light may go another way than the one that it goes without chance.
    pub(crate) fn leaves_to_chance(&self, at: usize) -> bool {
        self.elements[at].surface.draws() || self.scattered && !self.layers[at].is_empty()
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

    /// What a surface does to the weight of light.
    pub(crate) fn passage(&self, at: usize) -> &Passage {
        &self.passages[at]
    }

    /// Whether light meets surfaces at so steep angles that what they pass depends on how it was polarized before: prisms and tilted
    /// plates. Batches then carry its polarization ([`RayBatch::with_polarization`]); elsewhere it makes no difference of a percent.
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

    /// As far as light of this direction comes before a surface draws its numbers; straight through where none does.
    pub(crate) fn certain(&self, travel: Travel) -> Route {
        let path = Path::through(self.elements.len(), travel);
        self.route(&path.up_to(|at| self.leaves_to_chance(at)))
    }

    /// Whether surfaces have rings that bend light, for which directions are taken down.
    fn has_rings(&self) -> bool {
        self.elements.iter().any(|e| e.onion_rings.is_some())
    }

    /// Room for what is taken down in front of surfaces.
    fn before(&self, capacity: usize) -> Before {
        Before::new(capacity, self.absorptions.as_ref().map_or(0, Absorptions::tables))
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

    /// Scratch space for batches of up to `capacity` rays. Rays that end are dropped from the batch
    /// once they are the most of it.
    #[must_use]
    pub fn work(&self, capacity: usize) -> Work {
        let media = self.media.iter().map(|medium| IndexColumnPair::new(medium, capacity)).collect();
        let before = (!self.is_ideal()).then(|| self.before(capacity));
        Work { media, losses: LossCounts::default(), compact: true, capacity, before, ledger: None }
    }

    /// The same, but no ray leaves its place in the batch.
    #[must_use]
    pub fn work_in_place(&self, capacity: usize) -> Work {
        Work { compact: false, ..self.work(capacity) }
    }

    /// The same for rendering: what clear coatings of thin layers pass is worked out in single precision, within 1e-6.
    #[must_use]
    pub fn work_for_light(&self, capacity: usize) -> Work {
        let work = self.work(capacity);
        Work { before: work.before.map(|before| before.swift(capacity, self.media.len())), ..work }
    }

    /// The same for whoever asks only which rays pass, and where: their weights are left as they are.
    pub(crate) fn work_unweighed(&self, capacity: usize) -> Work {
        Work { before: self.has_rings().then(|| self.before(capacity)), ..self.work_in_place(capacity) }
    }

    /// Traces a batch straight through the lens. Forward, it enters in the frame of the lens and leaves in that of the image
    /// plane; backward the other way round.
    pub fn trace(&self, rays: &mut RayBatch, work: &mut Work, travel: Travel) {
        self.follow(if travel == Travel::Forward { &self.forward } else { &self.backward }, rays, work);
    }

    /// Traces a batch along a path. At the front rays enter and leave in the frame of the lens, at the rear in that of the image
    /// plane.
    pub fn follow(&self, route: &Route, rays: &mut RayBatch, work: &mut Work) {
        self.go(route, rays, work, None);
    }

    /// The same, and shows the batch behind each element of the path: `seen` gets the element's number, and the rays where they met it, in
    /// the frame of its [`Element::pose`](crate::Element::pose).
    pub fn follow_each(
        &self,
        route: &Route,
        rays: &mut RayBatch,
        work: &mut Work,
        mut seen: impl FnMut(usize, &RayBatch),
    ) {
        self.go(route, rays, work, Some(&mut seen));
    }

    fn go(&self, route: &Route, rays: &mut RayBatch, work: &mut Work, mut seen: Option<Seen<'_>>) {
        self.refractive_indices(rays, work);
        let turns = route.legs.iter().any(|leg| leg.turns);
        if (turns || rays.optical_path_mm().is_some() || rays.is_polarized()) && work.before.is_none() {
            work.before = Some(self.before(work.capacity));
        }
        if let Some((ledger, booked)) = &mut work.ledger {
            ledger.steps.resize(route.legs.len(), StepLedger::default());
            ledger.launched += living(rays);
            booked.note(rays);
        }
        let mut alive = rays.len();
        for (step, leg) in route.legs.iter().enumerate() {
            let ended = self.interact(rays, work, route, step, self.isa);
            if let Some(seen) = &mut seen {
                work.weigh_absorbed(rays, self.isa);
                seen(leg.at, rays);
            }
            if ended > 0 {
                self.count(rays, leg.at as u32 + 1, &mut work.losses);
                alive -= ended;
                if work.compact && alive * 2 < rays.len() {
                    work.weigh_absorbed(rays, self.isa);
                    rays.compact();
                    self.refractive_indices(rays, work);
                    if let Some((_, booked)) = &mut work.ledger {
                        booked.note(rays);
                    }
                }
            }
        }
        work.weigh_absorbed(rays, self.isa);
        if let Some((ledger, _)) = &mut work.ledger {
            ledger.arrived += living(rays);
        }
        let index = work.media[route.outside].n.slice(rays.len());
        let shift_mm = match route.out {
            Move::Shift(shift_mm) => shift_mm,
            Move::Turn(pose) => {
                self.isa.run(Reframe { rays, pose });
                0.0
            }
        };
        self.isa.run(Leave { rays, index, shift_mm: -shift_mm });
    }

    /// Brings a batch along one leg and through its element; says how many rays ended there.
    fn interact(&self, rays: &mut RayBatch, work: &mut Work, route: &Route, step: usize, isa: Isa) -> usize {
        let leg = &route.legs[step];
        let element = &self.elements[leg.at];
        let shift_mm = match &leg.into {
            Move::Shift(shift_mm) => *shift_mm,
            Move::Turn(pose) => {
                isa.run(Reframe { rays, pose: *pose });
                0.0
            }
        };
        if let Some(solid) = &element.solid {
            return self.pass_solid(rays, work, leg, step, shift_mm, solid);
        }
        let len = rays.len();
        let passage = &self.passages[leg.at];
        let absorption = self.absorptions.as_ref().filter(|_| leg.inside).and_then(|all| all.table_of(leg.before));
        let carries_path = rays.optical_path_mm().is_some();
        let needs_way = absorption.is_some() || carries_path || leg.turned;
        let measures = !element.surface.notes_meeting() && (needs_way || passage.reflects());
        if let Some(noted) = &mut work.before {
            if measures {
                noted.note_positions(rays);
            }
            let is_phased = carries_path && element.surface.has_phase();
            if measures || is_phased || leg.soiled.is_some() || element.onion_rings.is_some() || rays.is_polarized() {
                noted.note_directions(rays);
            }
        }
        let interface = Interface {
            number: leg.at as u32 + 1,
            shift_mm,
            clip_radius2_mm2: self.clips[leg.at],
            action: leg.action,
            travel: leg.travel,
            before: columns(&work.media[leg.before], len),
            after: columns(&work.media[leg.after], len),
        };
        if let Some(stage) = leg.stage {
            rays.set_stage(stage);
        }
        let mut ended = element.surface.interact(rays, &interface, isa);
        if let (Some(noted), true) = (&work.before, measures) {
            noted.measure(rays, shift_mm, isa);
        }
        if let (Some(rings), Some(noted)) = (&element.onion_rings, &work.before) {
            let (before, n) = (noted.directions(len), [interface.before.n, interface.after.n]);
            let mirror = leg.action == Action::Reflect;
            ended += rings.bend(rays, &Bent { before, n, mirror, number: interface.number });
            noted.measure_angles(rays, isa);
        }
        if leg.turned && work.before.is_some() {
            ended += Before::end_behind(rays, interface.number, isa);
        }
        if let Some((ledger, booked)) = &mut work.ledger {
            booked.settle(rays, &mut ledger.steps[step], |s| &mut s.absorbed);
        }
        if carries_path {
            Before::lengthen(rays, interface.before.n);
            self.add_phase(rays, work, route, step);
        }
        if let Some(noted) = &mut work.before {
            if let Some(table) = absorption {
                noted.absorb(rays, table, isa);
                if let Some((ledger, booked)) = &mut work.ledger {
                    noted.weigh_absorbed(rays, isa);
                    booked.settle(rays, &mut ledger.steps[step], |s| &mut s.absorbed);
                }
            }
            let beyond = columns(&work.media[leg.beyond], len);
            if leg.turns && *passage == Passage::All {
                rays.weighing().weight.fill(0.0);
            } else if rays.is_polarized() {
                noted.polarize(rays, passage, leg.action == Action::Reflect, [interface.before.n, beyond.n]);
            } else if leg.turns {
                Before::reflect(rays, passage, interface.before.n, beyond.n, isa);
            } else {
                noted.pass(rays, passage, [leg.before, leg.after], [interface.before.n, interface.after.n], isa);
            }
            if let Some((ledger, booked)) = &mut work.ledger {
                let mirror = matches!(passage, Passage::Mirror(_));
                booked.settle(
                    rays,
                    &mut ledger.steps[step],
                    |s| if mirror { &mut s.absorbed } else { &mut s.elsewhere },
                );
            }
        }
        for (aperture, opening) in element.apertures.iter().zip(&self.openings[leg.at]) {
            ended += match opening {
                Some(opening) => aperture.clip_by(opening, rays, interface.number, isa),
                None => aperture.clip(rays, interface.number, element.semi_diameter_mm),
            };
        }
        if let Some((ledger, booked)) = &mut work.ledger {
            booked.settle(rays, &mut ledger.steps[step], |s| &mut s.absorbed);
        }
        // What a surface reflects although it should pass it does so beneath what lies on it.
        if !self.layers[leg.at].is_empty() && !leg.turns {
            ended += self.meet_layers(rays, work, leg, step);
        }
        rays.set_surface(leg.at as u32 + 1);
        ended
    }

    /// Takes a batch that was bent by a surface past what lies on it; says how many rays ended.
    fn meet_layers(&self, rays: &mut RayBatch, work: &mut Work, leg: &Leg, step: usize) -> usize {
        let (layers, semi_diameter_mm) = (&self.layers[leg.at], self.elements[leg.at].semi_diameter_mm);
        if let (Some(place), Some(noted)) = (&leg.soiled, &work.before) {
            let len = rays.len();
            let meeting = Meeting {
                layers,
                semi_diameter_mm,
                before: noted.directions(len),
                n: [leg.before, leg.after].map(|medium| work.media[medium].n.slice(len)),
                mirror: leg.action == Action::Reflect,
                coating: self.passages[leg.at].coating(),
                number: leg.at as u32 + 1,
            };
            let ended = scatter::scatter(rays, place, &meeting);
            if let Some((ledger, booked)) = &mut work.ledger {
                booked.settle(rays, &mut ledger.steps[step], |s| &mut s.absorbed);
            }
            return ended;
        }
        let Some((ledger, booked)) = &mut work.ledger else {
            scatter::dim(rays, layers, semi_diameter_mm, |shares| shares.straight);
            return 0;
        };
        scatter::dim(rays, layers, semi_diameter_mm, |shares| shares.open);
        booked.settle(rays, &mut ledger.steps[step], |s| &mut s.absorbed);
        scatter::dim(
            rays,
            layers,
            semi_diameter_mm,
            |Shares { open, straight }| {
                if open > 0.0 { straight / open } else { 0.0 }
            },
        );
        booked.settle(rays, &mut ledger.steps[step], |s| &mut s.scattered);
        0
    }

    /// Takes a batch through a prism, ray by ray.
    fn pass_solid(
        &self,
        rays: &mut RayBatch,
        work: &mut Work,
        leg: &Leg,
        step: usize,
        shift_mm: f64,
        solid: &Solid,
    ) -> usize {
        let element = &self.elements[leg.at];
        let number = leg.at as u32 + 1;
        let len = rays.len();
        let n = columns(&work.media[leg.before], len).n;
        let inside = columns(&work.media[solid.medium], len).n;
        let absorption = self.absorptions.as_ref().and_then(|all| Some((all, all.table_of(solid.medium)?)));
        let weighs = work.before.is_some();
        let mut paths: Vec<(usize, f64)> = Vec::with_capacity(len);
        let (mut ended, mut clear, mut mirrors) = (0, vec![1.0; len], vec![1.0; len]);
        let coating = (&Amplitudes::of(&self.solid_coatings[leg.at]), element.reflectance);
        // Light keeps its polarization from face to face, whether the batch carries it or not.
        let mut own: [Vec<f64>; 6] =
            if rays.is_polarized() { Default::default() } else { std::array::from_fn(|_| vec![0.0; len]) };
        let mut c = rays.columns_mut();
        let polarization = if c.polarization.is_empty() {
            let [q, u, v, ax, ay, az] = own.each_mut().map(|column| &mut column[..]);
            &mut Polarization { q, u, v, axis: [ax, ay, az] }
        } else {
            &mut c.polarization
        };
        for i in 0..len {
            if c.state[i] != ALIVE {
                continue;
            }
            let from = DVec3::new(c.x[i], c.y[i], c.z[i] - shift_mm);
            let way = DVec3::new(c.l[i], c.m[i], c.n[i]);
            let nm = c.wavelength_nm[i];
            let passed = solid.pass(from, way, inside[i] / n[i], |face| {
                if weighs {
                    let does = face.polarizes([n[i], inside[i]], nm, coating);
                    let across = face.direction.cross(face.normal).to_array();
                    let left = weigh_polarized(polarization, i, face.direction.to_array(), across, does);
                    *(if face.bend == Bend::Mirror { &mut mirrors[i] } else { &mut clear[i] }) *= left;
                }
            });
            match passed {
                Err(cause) => {
                    c.state[i] = cause.state(number);
                    ended += 1;
                }
                Ok(passed) => {
                    (c.x[i], c.y[i], c.z[i]) = passed.position.into();
                    (c.l[i], c.m[i], c.n[i]) = passed.direction.into();
                    if let Some((all, table)) = absorption.filter(|_| weighs) {
                        let per_mm = all.at(table, all.grid.place(nm));
                        mirrors[i] *= spectra_core::math::exp(-per_mm * passed.inside_mm);
                    }
                    // A batch that carries its optical path has a column of it.
                    paths.push((i, n[i] * passed.outside_mm + inside[i] * passed.inside_mm));
                }
            }
        }
        let weighing = rays.weighing();
        if !weighing.optical_path_mm.is_empty() {
            paths.iter().for_each(|(i, path)| weighing.optical_path_mm[*i] += path);
        }
        if leg.turns {
            // A prism as a whole reflects nothing back.
            weighing.weight.fill(0.0);
        }
        // What mirrors and glass absorb, then what faces reflect.
        for (own, absorbed) in [(&mirrors, true), (&clear, false)] {
            rays.weighing().weight.iter_mut().zip(own).for_each(|(weight, left)| *weight *= left);
            if let Some((ledger, booked)) = &mut work.ledger {
                booked.settle(
                    rays,
                    &mut ledger.steps[step],
                    |s| if absorbed { &mut s.absorbed } else { &mut s.elsewhere },
                );
            }
        }
        rays.set_surface(number);
        ended
    }

    /// Follows one ray forward, surface by surface: for drawings and searches, not for light.
    ///
    /// `position` (mm) and the unit `direction` are in the frame of the lens; so are the points.
    #[must_use]
    pub fn path(&self, position: DVec3, direction: DVec3, wavelength_nm: f64) -> RayPath {
        self.path_along(&self.forward, position, direction, wavelength_nm)
    }

    /// The same along a path that enters at the front.
    #[must_use]
    pub fn path_along(&self, route: &Route, position: DVec3, direction: DVec3, wavelength_nm: f64) -> RayPath {
        let mut rays = RayBatch::new(1);
        rays.restart(1);
        let c = rays.columns_mut();
        (c.x[0], c.y[0], c.z[0]) = position.into();
        (c.l[0], c.m[0], c.n[0]) = direction.into();
        c.wavelength_nm[0] = wavelength_nm;
        let mut work = self.work_in_place(1);
        if work.before.is_none() && route.legs.iter().any(|leg| leg.turns) {
            work.before = Some(self.before(1));
        }
        self.refractive_indices(&rays, &mut work);
        let mut path = RayPath { points: vec![position], elements: Vec::new(), direction, end: None };
        for (step, leg) in route.legs.iter().enumerate() {
            let element = &self.elements[leg.at];
            self.interact(&mut rays, &mut work, route, step, Isa::Baseline);
            let ([x, y, z], [l, m, n]) = (rays.positions(), rays.directions());
            path.end = rays.loss(0);
            if path.end.is_none_or(|(cause, _)| cause == Loss::Vignetted) {
                path.elements.push(leg.at);
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
        if let Some(noted) = &mut work.before {
            let indices = work.media.iter().map(|medium| medium.n.slice(len));
            noted.note_wavelengths(rays, indices, self.absorptions.as_ref(), self.isa);
        }
    }

    fn count(&self, rays: &RayBatch, number: u32, losses: &mut LossCounts) {
        let causes = [Loss::Missed, Loss::Vignetted, Loss::TotalReflection, Loss::Absorbed];
        let many = self.isa.run(Count { states: rays.states(), wanted: causes.map(|cause| cause.state(number)) });
        for (cause, many) in causes.into_iter().zip(many).filter(|(_, many)| *many > 0) {
            losses.add(cause, number, many);
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
