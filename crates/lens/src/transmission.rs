//! Light that surfaces reflect and glass absorbs: what a ray weighs behind each surface.
//!
//! Asked for only where a lens states coatings, mirrors that are not perfect, or absorption; an ideal lens does nothing
//! here. The normal of a refracting surface is parallel to n' d' - n d, so that the angles follow from the directions
//! before and after, whatever the kind of surface.

use crate::absorption::{Absorptions, Locate};
use crate::coating::{Amplitudes, CHUNK, Coating, Films, Polarizing, Sides, Singles, Swift, bare_reflectance};
use crate::separation::Separation;
use crate::{Element, Lens, LensMedium};
use spectra_core::Loss;
use spectra_core::RayBatch;
use spectra_core::batch::{Column, Weighing};
use spectra_core::isa::{Isa, Vectorized};
use spectra_core::loss::ALIVE;
use spectra_core::math;
use spectra_core::surface::Action;
use spectra_glass::Lender;

/// Indices that differ by less let everything pass: reflectance is below 1e-16 there.
const SAME_INDEX: f64 = 1e-8;

/// A way of less than this runs backward: cemented surfaces and rounding are on the other side of it, mm.
const BEHIND_MM: f64 = -1e-6;

/// Sine of the angle between the directions before and after below which light keeps its axis: it meets the surface along the
/// normal, where s and p are the same.
const NO_PLANE: f64 = 1e-9;

/// How a coating is worked out for a batch.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Kernel {
    /// Fresnel's equations.
    Bare,
    /// Clear layers, with the number of times that [`Films`] halves the angle; and in single precision, where that is enough.
    One(Films<1>, u32, Option<Swift<1>>),
    Two(Films<2>, u32, Option<Swift<2>>),
    Three(Films<3>, u32, Option<Swift<3>>),
    /// Any coating: [`Coating::transmittance`].
    RayByRay,
}

impl Kernel {
    /// Of a coating between media of which the lower index is `low`, for light of this wavelength, nm, or longer.
    fn of(coating: &Coating, low: f64, shortest_nm: f64) -> Self {
        match coating {
            Coating::Bare => return Self::Bare,
            Coating::Layer { index, thickness_nm } => {
                let films = Films::new(&[[*index, *thickness_nm]]);
                return films
                    .halvings(shortest_nm, low)
                    .map_or(Self::RayByRay, |h| Self::One(films, h, Swift::of(&films, shortest_nm, low)));
            }
            Coating::Stack(stack) => {
                let one = || {
                    let films = Films::new(&stack.clear_layers::<1>()?);
                    Some(Self::One(films, films.halvings(shortest_nm, low)?, Swift::of(&films, shortest_nm, low)))
                };
                let two = || {
                    let films = Films::new(&stack.clear_layers::<2>()?);
                    Some(Self::Two(films, films.halvings(shortest_nm, low)?, Swift::of(&films, shortest_nm, low)))
                };
                let three = || {
                    let films = Films::new(&stack.clear_layers::<3>()?);
                    Some(Self::Three(films, films.halvings(shortest_nm, low)?, Swift::of(&films, shortest_nm, low)))
                };
                one().or_else(two).or_else(three)
            }
            Coating::Ideal | Coating::Measured(_) => None,
        }
        .unwrap_or(Self::RayByRay)
    }
}

/// What a surface does to the weight of light.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Passage {
    /// Nothing.
    All,
    /// Fresnel, under a coating or bare.
    Coated(Coating, Kernel),
    /// This part is reflected by a mirror.
    Mirror(f64),
    /// What it does where the cement holds, beside a gap of air.
    Apart(Box<Passage>, Gap),
}

/// Where the cement of a surface has come apart.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Gap {
    separation: Separation,
    semi_diameter_mm: Option<f64>,
}

impl Gap {
    /// Of living rays that met it: which, the part of their light that did, and the gap as a coating.
    fn met<'a>(
        &'a self,
        [x, y, _]: [&'a [f64]; 3],
        state: &'a [u64],
    ) -> impl Iterator<Item = (usize, f64, Coating)> + 'a {
        (0..state.len()).filter(|i| state[*i] == ALIVE).filter_map(move |i| {
            let (part, coating) = self.separation.at([x[i], y[i]], self.semi_diameter_mm)?;
            Some((i, part, coating))
        })
    }
}

impl Passage {
    /// Of an element of a lens, for light of this wavelength, nm, or longer.
    pub(crate) fn of(lens: &Lens, element: &Element, shortest_nm: f64) -> Self {
        match element.action {
            Action::Pass => Self::All,
            Action::Reflect if element.reflectance == 1.0 => Self::All,
            Action::Reflect => Self::Mirror(element.reflectance),
            Action::Refract if element.medium_before == element.medium_after => Self::All,
            // What a grating sends into its order, or a surface scatters, is not a matter of Fresnel's equations.
            Action::Refract if element.surface.is_directional() || element.surface.draws() => Self::All,
            Action::Refract => {
                let intact = match lens.coating_of(element) {
                    Coating::Ideal => Self::All,
                    coating => {
                        let sides = [element.medium_before, element.medium_after].map(|m| lens.index(m, shortest_nm));
                        let kernel = Kernel::of(&coating, sides[0].min(sides[1]), shortest_nm);
                        Self::Coated(coating, kernel)
                    }
                };
                match element.separation.clone() {
                    Some(separation) => {
                        let gap = Gap { separation, semi_diameter_mm: element.semi_diameter_mm };
                        Self::Apart(Box::new(intact), gap)
                    }
                    None => intact,
                }
            }
        }
    }

    /// Whether it sends back light that should pass.
    pub(crate) fn reflects(&self) -> bool {
        matches!(self, Self::Coated(..) | Self::Apart(..))
    }

    /// The coating where it has one, and where cement holds.
    pub(crate) fn coating(&self) -> Option<&Coating> {
        match self {
            Self::Coated(coating, _) => Some(coating),
            Self::Apart(intact, _) => intact.coating(),
            Self::All | Self::Mirror(_) => None,
        }
    }
}

impl Lens {
    /// The coating of an element: its own, else the lens's; of the latter a surface between two glasses has none, it is
    /// cemented.
    #[must_use]
    pub fn coating_of(&self, element: &Element) -> Coating {
        match (&element.coating, &self.coating) {
            (Some(own), _) => own.clone(),
            (None, all @ (Coating::Ideal | Coating::Bare)) => all.clone(),
            (None, _) if !self.is_gas(element.medium_before) && !self.is_gas(element.medium_after) => Coating::Bare,
            (None, all) => all.clone(),
        }
    }

    /// The coating of the faces of a prism: its own, else the lens's.
    pub(crate) fn solid_coating_of(&self, element: &Element) -> Coating {
        element.coating.as_ref().unwrap_or(&self.coating).clone()
    }

    /// The media whose absorption is borrowed, each with its label and the glass that lends; whether or not glass absorbs
    /// now.
    #[must_use]
    pub fn borrowed_absorption(&self) -> Vec<(&str, Lender)> {
        let lender = |m: &LensMedium| m.medium.absorption(self.year)?.lender;
        self.media.iter().filter_map(|m| Some((m.label.as_str(), lender(m)?))).collect()
    }

    /// The same lens with this coating everywhere, whatever its surfaces state.
    #[must_use]
    pub fn with_coating(mut self, coating: Coating) -> Self {
        self.coating = coating;
        self.coating_assumed = false;
        for e in &mut self.elements {
            e.coating = None;
        }
        self
    }
}

/// Positions and directions in front of a surface, in its frame.
#[derive(Debug)]
pub(crate) struct Before {
    position: [Column<f64>; 3],
    direction: [Column<f64>; 3],
    /// What each medium that absorbs does at each ray's wavelength, 1/mm.
    per_mm: Vec<Column<f64>>,
    /// Where the wavelengths lie in the tables of absorption.
    cell: Column<u64>,
    part: Column<f64>,
    /// What was absorbed since rays were weighed by it: the sum of that times the way.
    depth: Column<f64>,
    /// Whether anything was.
    absorbed: bool,
    /// Whether layers are worked out in single precision, where that is within 1e-6; then one over each ray's wavelength, 1/nm.
    swift: bool,
    per_nm: Vec<f32>,
    /// Then, too, the index of each medium at each ray's wavelength.
    n: Vec<Vec<f32>>,
}

impl Before {
    /// Room for batches of up to `capacity` rays, in a lens with so many media that absorb.
    pub(crate) fn new(capacity: usize, absorbing: usize) -> Self {
        let column = || Column::new(capacity);
        let three = || std::array::from_fn(|_| column());
        Self {
            position: three(),
            direction: three(),
            per_mm: (0..absorbing).map(|_| column()).collect(),
            cell: Column::new(capacity),
            part: column(),
            depth: column(),
            absorbed: false,
            swift: false,
            per_nm: Vec::new(),
            n: Vec::new(),
        }
    }

    /// The same, with clear layers in single precision; for batches of up to `capacity` rays, in a lens of so many media.
    pub(crate) fn swift(self, capacity: usize, media: usize) -> Self {
        // Whole chunks.
        let column = vec![1.0; capacity.next_multiple_of(CHUNK)];
        Self { swift: true, per_nm: column.clone(), n: vec![column; media], ..self }
    }

    /// Takes down what media absorb at the wavelengths of rays, and what layers need of those, and of the indices of media.
    pub(crate) fn note_wavelengths<'a>(
        &mut self,
        rays: &RayBatch,
        indices: impl Iterator<Item = &'a [f64]>,
        absorptions: Option<&Absorptions>,
        isa: Isa,
    ) {
        let len = rays.len();
        if self.swift {
            isa.run(Invert { wavelength_nm: rays.wavelengths_nm(), per_nm: &mut self.per_nm[..len] });
            for (n, single) in indices.zip(&mut self.n) {
                isa.run(ToSingle { n, single: &mut single[..len] });
            }
        }
        let Some(absorptions) = absorptions else { return };
        let (cell, part) = (self.cell.slice_mut(len), self.part.slice_mut(len));
        isa.run(Locate { grid: absorptions.grid, wavelengths_nm: rays.wavelengths_nm(), cell, part });
        for (table, per_mm) in self.per_mm.iter_mut().enumerate() {
            absorptions.fill(table, cell, part, per_mm.slice_mut(len));
        }
    }

    /// Takes down whereto rays run.
    pub(crate) fn note_directions(&mut self, rays: &RayBatch) {
        let len = rays.len();
        for (to, from) in self.direction.iter_mut().zip(rays.directions()) {
            to.slice_mut(len).copy_from_slice(from);
        }
    }

    /// What was taken down of the directions of so many rays.
    pub(crate) fn directions(&self, len: usize) -> [&[f64]; 3] {
        self.direction.each_ref().map(|column| column.slice(len))
    }

    /// Takes down where rays are.
    pub(crate) fn note_positions(&mut self, rays: &RayBatch) {
        let len = rays.len();
        for (to, from) in self.position.iter_mut().zip(rays.positions()) {
            to.slice_mut(len).copy_from_slice(from);
        }
    }

    /// Works out how rays met a surface that does not note it by itself: by positions and directions that were taken down before; `shift_mm` is the
    /// surface's vertex in the frame of those.
    pub(crate) fn measure(&self, rays: &mut RayBatch, shift_mm: f64, isa: Isa) {
        let len = rays.len();
        let from = self.position.each_ref().map(|column| column.slice(len));
        isa.run(Measure { from, direction: self.directions(len), shift_mm, rays: rays.weighing() });
        self.measure_angles(rays, isa);
    }

    /// Works out by which angle rays were bent: by directions that were taken down before.
    pub(crate) fn measure_angles(&self, rays: &mut RayBatch, isa: Isa) {
        isa.run(MeasureAngles { direction: self.directions(rays.len()), rays: rays.weighing() });
    }

    /// Takes down what a medium absorbed of rays on their way to a surface, by its table. Their weights follow in
    /// [`Before::weigh_absorbed`]: one power for the whole way through a lens.
    pub(crate) fn absorb(&mut self, rays: &mut RayBatch, table: usize, isa: Isa) {
        let len = rays.len();
        let way_mm = rays.weighing().way_mm;
        let (per_mm, depth) = (self.per_mm[table].slice(len), self.depth.slice_mut(len));
        if self.absorbed {
            isa.run(Absorb::<false> { way_mm, per_mm, depth });
        } else {
            isa.run(Absorb::<true> { way_mm, per_mm, depth });
        }
        self.absorbed = true;
    }

    /// Weighs rays by what was absorbed of them so far.
    pub(crate) fn weigh_absorbed(&mut self, rays: &mut RayBatch, isa: Isa) {
        if std::mem::take(&mut self.absorbed) {
            let depth = self.depth.slice(rays.len());
            isa.run(WeighAbsorbed { rays: rays.weighing(), depth });
        }
    }

    /// Ends rays that met a surface behind them: a steep reflection may send light sideways, past the surface that comes next. Says
    /// how many.
    pub(crate) fn end_behind(rays: &mut RayBatch, number: u32, isa: Isa) -> usize {
        let c = rays.weighing();
        let many = isa.run(CountBehind { way_mm: c.way_mm, state: c.state }) as usize;
        if many > 0 {
            let is_behind = |i: &usize| c.state[*i] == ALIVE && c.way_mm[*i] < BEHIND_MM;
            let behind: Vec<usize> = (0..c.state.len()).filter(is_behind).collect();
            let c = rays.columns_mut();
            behind.iter().for_each(|i| c.state[*i] = Loss::Missed.state(number));
        }
        many
    }

    /// Adds the way to a surface to the optical path of batches that carry it, in a medium of these indices.
    pub(crate) fn lengthen(rays: &mut RayBatch, index: &[f64]) {
        let c = rays.weighing();
        for ((path, index), way_mm) in c.optical_path_mm.iter_mut().zip(index).zip(c.way_mm) {
            *path += *index * *way_mm;
        }
    }

    /// Weighs rays by what a refracting surface reflects; `n_beyond` are the indices on its other side.
    pub(crate) fn reflect(rays: &mut RayBatch, passage: &Passage, n: &[f64], n_beyond: &[f64], isa: Isa) {
        let (coating, gap) = match passage {
            Passage::All | Passage::Mirror(_) => return,
            Passage::Coated(..) => (passage.coating(), None),
            Passage::Apart(_, gap) => (passage.coating(), Some(gap)),
        };
        let c = rays.weighing();
        let len = c.weight.len();
        if let Passage::Coated(Coating::Bare, _) = passage {
            return isa.run(ReflectBare(Pass { rays: c, n, n_after: n_beyond }));
        }
        let reflected = |i: usize, coating: &Coating| {
            let cosine = cosine_of_mirrored(c.versine[i]);
            coating.reflectance(n[i], n_beyond[i], cosine, c.wavelength_nm[i]).mean()
        };
        let came = gap.map(|_| c.weight.to_vec());
        for i in 0..len {
            if c.state[i] == ALIVE {
                c.weight[i] *= coating.map_or(0.0, |coating| reflected(i, coating));
            }
        }
        if let (Some(gap), Some(came)) = (gap, came) {
            for (i, part, coating) in gap.met(c.position, c.state) {
                c.weight[i] += part * (came[i] * reflected(i, &coating) - c.weight[i]);
            }
        }
    }

    /// Weighs polarized rays by what a surface passes, or sends `back`, and gives them the state that they leave it in;
    /// `n_beyond` are the indices on its other side.
    pub(crate) fn polarize(&self, rays: &mut RayBatch, passage: &Passage, back: bool, [n, n_beyond]: [&[f64]; 2]) {
        let mut c = rays.weighing();
        let amplitudes = passage.coating().map(Amplitudes::of);
        let gap = match passage {
            Passage::Apart(_, gap) => Some(gap),
            _ => None,
        };
        for i in 0..c.weight.len() {
            if c.state[i] != ALIVE {
                continue;
            }
            let d: [f64; 3] = std::array::from_fn(|k| self.direction[k].slice(i + 1)[i]);
            let after = c.direction.map(|column| column[i]);
            let of = |amplitudes: &Amplitudes<'_>| {
                let h = versine(d, after);
                if back {
                    return amplitudes.back(n[i], n_beyond[i], cosine_of_mirrored(h), c.wavelength_nm[i]);
                }
                let sides = Sides::of(n[i], n_beyond[i], h);
                if sides.step() < SAME_INDEX {
                    Polarizing::evenly(1.0, false)
                } else {
                    amplitudes.through(n[i], n_beyond[i], sides.cosine(), c.wavelength_nm[i])
                }
            };
            let mut does = match (passage, &amplitudes) {
                (Passage::Mirror(reflectance), _) => Polarizing::evenly(*reflectance, true),
                // Where cement holds that reflects nothing, a gap of air beside it may.
                (Passage::Apart(..), None) if back => Polarizing::evenly(0.0, true),
                (_, None) => Polarizing::evenly(1.0, back),
                (_, Some(amplitudes)) => of(amplitudes),
            };
            if let Some(gap) = gap {
                let place = [c.position[0][i], c.position[1][i]];
                if let Some((part, coating)) = gap.separation.at(place, gap.semi_diameter_mm) {
                    does = does.beside(part, of(&Amplitudes::of(&coating)));
                }
            }
            // Across the plane of incidence; where there is none, any axis will do.
            let across = cross(d, after);
            let size = dot(across, across).sqrt();
            if size > NO_PLANE {
                c.polarization.turn(i, d, across.map(|a| a / size));
            }
            let p = &mut c.polarization;
            let (mean, half) = (0.5 * (does.s + does.p), 0.5 * (does.s - does.p));
            let left = mean + half * p.q[i];
            c.weight[i] *= left;
            if left > 0.0 {
                let [re, im] = does.mixed;
                let (u, v) = (p.u[i], p.v[i]);
                p.q[i] = (half + mean * p.q[i]) / left;
                (p.u[i], p.v[i]) = ((re * u - im * v) / left, (re * v + im * u) / left);
            }
        }
    }

    /// Weighs rays by what a surface between these media passes, of these indices.
    pub(crate) fn pass(
        &self,
        rays: &mut RayBatch,
        passage: &Passage,
        media: [usize; 2],
        [n, n_after]: [&[f64]; 2],
        isa: Isa,
    ) {
        if let Passage::Apart(intact, gap) = passage {
            let came = rays.weights().to_vec();
            self.pass(rays, intact, media, [n, n_after], isa);
            let c = rays.weighing();
            for (i, part, coating) in gap.met(c.position, c.state) {
                let sides = Sides::of(n[i], n_after[i], c.versine[i]);
                let passed = if sides.step() < SAME_INDEX {
                    1.0
                } else {
                    coating.transmittance(n[i], n_after[i], sides.cosine(), c.wavelength_nm[i]).mean()
                };
                c.weight[i] += part * (came[i] * passed - c.weight[i]);
            }
            return;
        }
        let rays = rays.weighing();
        match passage {
            Passage::All | Passage::Apart(..) => {}
            Passage::Mirror(reflectance) => {
                for weight in rays.weight {
                    *weight *= *reflectance;
                }
            }
            Passage::Coated(coating, kernel) => {
                let at = Pass { rays, n, n_after };
                let singles = || [&self.n[media[0]][..], &self.n[media[1]], &self.per_nm];
                match kernel {
                    Kernel::Bare => isa.run(PassBare(at)),
                    Kernel::One(.., Some(swift)) if self.swift => isa.run(PassSwift(at.rays, swift, singles())),
                    Kernel::Two(.., Some(swift)) if self.swift => isa.run(PassSwift(at.rays, swift, singles())),
                    Kernel::Three(.., Some(swift)) if self.swift => isa.run(PassSwift(at.rays, swift, singles())),
                    Kernel::One(films, halvings, _) => at.through(films, *halvings, isa),
                    Kernel::Two(films, halvings, _) => at.through(films, *halvings, isa),
                    Kernel::Three(films, halvings, _) => at.through(films, *halvings, isa),
                    Kernel::RayByRay => at.ray_by_ray(coating),
                }
            }
        }
    }
}

#[inline(always)]
fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

/// Versine of the angle between two unit directions: half the square of their difference.
#[inline(always)]
pub(crate) fn versine(before: [f64; 3], after: [f64; 3]) -> f64 {
    let turn = [after[0] - before[0], after[1] - before[1], after[2] - before[2]];
    0.5 * dot(turn, turn)
}

/// Cosine of the angle of incidence of a ray that a surface sent back, bent by an angle of this versine: directions before and after differ by
/// twice the cosine, along the normal.
#[inline(always)]
fn cosine_of_mirrored(versine: f64) -> f64 {
    let cosine = (0.5 * versine).sqrt();
    if cosine < 1.0 { cosine } else { 1.0 }
}

/// The way from where rays were, along where they went.
struct Measure<'a> {
    from: [&'a [f64]; 3],
    direction: [&'a [f64]; 3],
    shift_mm: f64,
    rays: Weighing<'a>,
}

impl Vectorized for Measure<'_> {
    type Output = ();
    #[inline(always)]
    fn run(self) {
        let Self { from, direction, shift_mm, rays: Weighing { position, way_mm, .. } } = self;
        let len = way_mm.len();
        let [from, direction, to] = [from, direction, position].map(|columns| columns.map(|column| &column[..len]));
        for i in 0..len {
            let step = [to[0][i] - from[0][i], to[1][i] - from[1][i], to[2][i] - (from[2][i] - shift_mm)];
            way_mm[i] = step[0] * direction[0][i] + step[1] * direction[1][i] + step[2] * direction[2][i];
        }
    }
}

/// The angle between the directions before and after.
struct MeasureAngles<'a> {
    direction: [&'a [f64]; 3],
    rays: Weighing<'a>,
}

impl Vectorized for MeasureAngles<'_> {
    type Output = ();
    #[inline(always)]
    fn run(self) {
        let (before, Weighing { direction: after, versine: versines, .. }) = (self.direction, self.rays);
        let len = versines.len();
        let [[bl, bm, bn], [l, m, n]] = [before, after].map(|columns| columns.map(|column| &column[..len]));
        for i in 0..len {
            versines[i] = versine([bl[i], bm[i], bn[i]], [l[i], m[i], n[i]]);
        }
    }
}

/// Adds what is absorbed on the way, or begins with it.
struct Absorb<'a, const FIRST: bool> {
    way_mm: &'a [f64],
    per_mm: &'a [f64],
    depth: &'a mut [f64],
}

impl<const FIRST: bool> Vectorized for Absorb<'_, FIRST> {
    type Output = ();
    #[inline(always)]
    fn run(self) {
        let Self { way_mm, per_mm, depth } = self;
        let len = depth.len();
        let (way_mm, per_mm) = (&way_mm[..len], &per_mm[..len]);
        for i in 0..len {
            let own = per_mm[i] * if way_mm[i] > 0.0 { way_mm[i] } else { 0.0 };
            depth[i] = if FIRST { own } else { depth[i] + own };
        }
    }
}

/// Counts living rays that ran backward: hardly ever any.
struct CountBehind<'a> {
    way_mm: &'a [f64],
    state: &'a [u64],
}

impl Vectorized for CountBehind<'_> {
    type Output = u64;
    #[inline(always)]
    fn run(self) -> u64 {
        let mut many = 0;
        for (state, way_mm) in self.state.iter().zip(self.way_mm) {
            many += u64::from((*state == ALIVE) & (*way_mm < BEHIND_MM));
        }
        many
    }
}

struct WeighAbsorbed<'a> {
    rays: Weighing<'a>,
    depth: &'a [f64],
}

impl Vectorized for WeighAbsorbed<'_> {
    type Output = ();
    #[inline(always)]
    fn run(self) {
        weigh_absorbed(self.depth, self.rays.state, self.rays.weight);
    }
}

/// Columns are separate arguments, so the compiler knows that weights overlap none of the others.
#[inline(always)]
fn weigh_absorbed(depth: &[f64], state: &[u64], weight: &mut [f64]) {
    let len = weight.len();
    let (depth, state) = (&depth[..len], &state[..len]);
    for i in 0..len {
        let left = math::exp_within_700(-depth[i]);
        weight[i] *= if state[i] == ALIVE { left } else { 1.0 };
    }
}

/// What a surface passes, as a trait: methods are inlined where told to, closures are not, and would be compiled for the
/// baseline.
trait Passes {
    /// Part of unpolarized light, for the sides of the surface at a wavelength, nm.
    fn part(&self, sides: &Sides, wavelength_nm: f64) -> f64;
}

struct Bare;

impl Passes for Bare {
    #[inline(always)]
    fn part(&self, sides: &Sides, _wavelength_nm: f64) -> f64 {
        sides.bare()
    }
}

struct Layers<const N: usize, const H: usize>(Films<N>);

impl<const N: usize, const H: usize> Passes for Layers<N, H> {
    #[inline(always)]
    fn part(&self, sides: &Sides, wavelength_nm: f64) -> f64 {
        self.0.passes::<H>(sides, 1.0 / wavelength_nm)
    }
}

/// Rays at a surface that they met, and the indices on both sides.
struct Pass<'a> {
    rays: Weighing<'a>,
    n: &'a [f64],
    n_after: &'a [f64],
}

impl Pass<'_> {
    /// Weighs rays by clear layers.
    fn through<const N: usize>(self, films: &Films<N>, halvings: u32, isa: Isa) {
        match halvings {
            0 | 1 => isa.run(PassFilms::<N, 1>(self, films)),
            2 => isa.run(PassFilms::<N, 2>(self, films)),
            3 => isa.run(PassFilms::<N, 3>(self, films)),
            _ => isa.run(PassFilms::<N, 5>(self, films)),
        }
    }

    /// Weighs rays by any coating.
    fn ray_by_ray(self, coating: &Coating) {
        let Self { rays: c, n, n_after } = self;
        for i in 0..c.weight.len() {
            let sides = Sides::of(n[i], n_after[i], c.versine[i]);
            if c.state[i] == ALIVE && sides.step() >= SAME_INDEX {
                c.weight[i] *= coating.transmittance(n[i], n_after[i], sides.cosine(), c.wavelength_nm[i]).mean();
            }
        }
    }

    #[inline(always)]
    fn weigh(self, passes: impl Passes) {
        let c = self.rays;
        weigh_loop([self.n, self.n_after, c.versine, c.wavelength_nm], c.state, c.weight, passes);
    }
}

/// As [`weigh_absorbed`].
#[inline(always)]
fn weigh_loop(columns: [&[f64]; 4], state: &[u64], weight: &mut [f64], passes: impl Passes) {
    let len = weight.len();
    let [n, n_after, versine, wavelength_nm] = columns.map(|column| &column[..len]);
    let state = &state[..len];
    for i in 0..len {
        let sides = Sides::of(n[i], n_after[i], versine[i]);
        let part = passes.part(&sides, wavelength_nm[i]);
        let usable = (sides.step() >= SAME_INDEX) & (state[i] == ALIVE);
        weight[i] *= if usable { part } else { 1.0 };
    }
}

struct PassBare<'a>(Pass<'a>);

impl Vectorized for PassBare<'_> {
    type Output = ();
    #[inline(always)]
    fn run(self) {
        self.0.weigh(Bare);
    }
}

/// Weighs rays by what bare glass reflects.
struct ReflectBare<'a>(Pass<'a>);

impl Vectorized for ReflectBare<'_> {
    type Output = ();
    #[inline(always)]
    fn run(self) {
        let Pass { rays: c, n, n_after } = self.0;
        reflect_bare([n, n_after, c.versine], c.state, c.weight);
    }
}

/// As [`weigh_absorbed`].
#[inline(always)]
fn reflect_bare(columns: [&[f64]; 3], state: &[u64], weight: &mut [f64]) {
    let len = weight.len();
    let [n, n_beyond, versine] = columns.map(|column| &column[..len]);
    let state = &state[..len];
    for i in 0..len {
        let part = bare_reflectance(n[i], n_beyond[i], cosine_of_mirrored(versine[i])).mean();
        weight[i] *= if state[i] == ALIVE { part } else { 1.0 };
    }
}

struct PassFilms<'a, const N: usize, const H: usize>(Pass<'a>, &'a Films<N>);

impl<const N: usize, const H: usize> Vectorized for PassFilms<'_, N, H> {
    type Output = ();
    #[inline(always)]
    fn run(self) {
        self.0.weigh(Layers::<N, H>(*self.1));
    }
}

/// One over the wavelengths, 1/nm.
struct Invert<'a> {
    wavelength_nm: &'a [f64],
    per_nm: &'a mut [f32],
}

impl Vectorized for Invert<'_> {
    type Output = ();
    #[inline(always)]
    fn run(self) {
        for (nm, per_nm) in self.wavelength_nm.iter().zip(self.per_nm) {
            *per_nm = 1.0 / *nm as f32;
        }
    }
}

/// Indices in single precision.
struct ToSingle<'a> {
    n: &'a [f64],
    single: &'a mut [f32],
}

impl Vectorized for ToSingle<'_> {
    type Output = ();
    #[inline(always)]
    fn run(self) {
        for (n, single) in self.n.iter().zip(self.single) {
            *single = *n as f32;
        }
    }
}

/// With the indices on both sides and one over the wavelengths, 1/nm.
struct PassSwift<'a, const N: usize>(Weighing<'a>, &'a Swift<N>, [&'a [f32]; 3]);

impl<const N: usize> Vectorized for PassSwift<'_, N> {
    type Output = ();
    #[inline(always)]
    fn run(self) {
        let (c, swift, singles) = (self.0, *self.1, self.2);
        let len = c.weight.len();
        for first in (0..len).step_by(CHUNK) {
            let (span, chunk) = (first..(first + CHUNK).min(len), first..first + CHUNK);
            swift_chunk(
                &swift,
                singles.map(|column| &column[chunk.clone()]),
                &c.versine[span.clone()],
                &c.state[span.clone()],
                &mut c.weight[span],
            );
        }
    }
}

/// In three loops, so that the one in the middle holds nothing but single precision.
#[inline(always)]
fn swift_chunk<const N: usize>(
    swift: &Swift<N>,
    singles: [&[f32]; 3],
    versine: &[f64],
    state: &[u64],
    weight: &mut [f64],
) {
    let len = weight.len().min(CHUNK);
    let [n, n_after, per_nm] = singles.map(|column| &column[..CHUNK]);
    let (versine, state, weight) = (&versine[..len], &state[..len], &mut weight[..len]);
    let (mut h, mut back): (Singles, Singles) = ([0.0; CHUNK], [0.0; CHUNK]);
    for i in 0..len {
        h[i] = versine[i] as f32;
    }
    for i in 0..CHUNK {
        back[i] = swift.reflects(n[i], n_after[i], h[i], per_nm[i]);
    }
    for i in 0..len {
        let usable = (n[i] != n_after[i]) & (state[i] == ALIVE);
        weight[i] -= if usable { weight[i] * f64::from(back[i]) } else { 0.0 };
    }
}
