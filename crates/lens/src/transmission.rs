//! Light that surfaces reflect and glass absorbs: what a ray weighs behind each surface.
//!
//! Asked for only where a lens states coatings, mirrors that are not perfect, or absorption; an ideal lens does nothing
//! here. The normal of a refracting surface is parallel to n' d' - n d, so that the angles follow from the directions
//! before and after, whatever the kind of surface.

mod angles;
mod loops;
mod passage;

pub(crate) use angles::versine;
pub(crate) use passage::Passage;

use crate::absorption::{Absorptions, Locate};
use crate::coating::{Amplitudes, CHUNK, Coating, Polarizing, Sides};
use angles::{SAME_INDEX, cosine_of_mirrored, cross, dot};
use loops::{
    Absorb, BEHIND_MM, CountBehind, Invert, Measure, MeasureAngles, Pass, PassBare, PassSwift, ReflectBare, ToSingle,
    WeighAbsorbed,
};
use passage::Kernel;
use spectra_core::Loss;
use spectra_core::RayBatch;
use spectra_core::batch::{Column, Polarization};
use spectra_core::isa::Isa;
use spectra_core::loss::ALIVE;

/// Sine of the angle between the directions before and after below which light keeps its axis: it meets the surface along the
/// normal, where s and p are the same.
const NO_PLANE: f64 = 1e-9;

/// The part of ray `i` that goes on from a surface which acts on its polarization, and the state that it goes on in. `direction` is
/// that in front of the surface, `across` any vector across the plane of incidence; where it has no length, light meets the surface
/// along the normal and any axis will do.
pub(crate) fn weigh_polarized(
    p: &mut Polarization<'_>,
    i: usize,
    direction: [f64; 3],
    across: [f64; 3],
    does: Polarizing,
) -> f64 {
    let size = dot(across, across).sqrt();
    if size > NO_PLANE {
        p.turn(i, direction, across.map(|a| a / size));
    }
    let (mean, half) = (0.5 * (does.s + does.p), 0.5 * (does.s - does.p));
    let left = mean + half * p.q[i];
    if left > 0.0 {
        let [re, im] = does.mixed;
        let (u, v) = (p.u[i], p.v[i]);
        p.q[i] = (half + mean * p.q[i]) / left;
        (p.u[i], p.v[i]) = ((re * u - im * v) / left, (re * v + im * u) / left);
    }
    left
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
            c.weight[i] *= weigh_polarized(&mut c.polarization, i, d, cross(d, after), does);
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
