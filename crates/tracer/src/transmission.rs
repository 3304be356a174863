//! Transmission: the weight of a ray behind each surface, after reflection losses and absorption.
//!
//! This is computed only if a lens states coatings, imperfect mirrors, or absorption; an ideal lens skips it. The normal of a refracting
//! surface is parallel to n' d' - n d, so the angles follow from the directions before and after, whatever the kind of surface. Absorption
//! is applied once, behind the last surface, summed over all glass. Where cement has separated, a part of the light meets the gap. The
//! light that the gap passes or reflects is mixed with that of the rest of the surface, ray by ray, in this proportion.

mod loops;
mod passage;

pub(crate) use passage::Passage;

use crate::absorption::{Absorptions, Locate};
use loops::{
    Absorb, BEHIND_MM, CountBehind, Invert, Measure, MeasureAngles, Pass, PassBare, PassSwift, ReflectBare, ToSingle,
    WeighAbsorbed,
};
use passage::Kernel;
use spectra_core::Loss;
use spectra_core::RayBatch;
use spectra_core::batch::{Column, Polarization};
use spectra_core::loss::ALIVE;
use spectra_lens::Coating;
use spectra_lens::coating::{Amplitudes, CHUNK, Polarizing, Sides};
use spectra_lens::coating::{SAME_INDEX, cosine_of_mirrored, cross, dot, versine};

/// Sine of the angle between the directions before and after below which light keeps its axis. Such light meets the surface along the
/// normal, where s and p are the same.
const NO_PLANE: f64 = 1e-9;

/// Returns the fraction of ray `i` that continues from a surface that acts on its polarization, and updates its state. `direction` is the
/// direction in front of the surface, `across` any vector across the plane of incidence. If `across` has no length, light meets the surface
/// along the normal, and any axis will do.
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

/// The positions and directions of rays in front of a surface, in its frame, and their absorption so far.
#[derive(Debug)]
pub(crate) struct RaysBefore {
    position: [Column<f64>; 3],
    direction: [Column<f64>; 3],
    /// Absorption coefficient of each absorbing medium at each ray's wavelength, 1/mm.
    per_mm: Vec<Column<f64>>,
    /// Positions of the wavelengths in the tables of absorption.
    cell: Column<u64>,
    part: Column<f64>,
    /// Optical depth since rays were last weighed by it: the sum of absorption coefficient times path length.
    depth: Column<f64>,
    /// Whether any absorption was added to `depth`.
    absorbed: bool,
    /// Whether layers are computed in single precision where that is within 1e-6. `per_nm` is then one over each ray's wavelength, 1/nm.
    swift: bool,
    per_nm: Vec<f32>,
    /// Index of each medium at each ray's wavelength, if `swift` is set.
    n: Vec<Vec<f32>>,
}

impl RaysBefore {
    /// Allocates buffers for batches of up to `capacity` rays, in a lens with `absorbing` absorbing media.
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

    /// Switches clear layers to single precision, for batches of up to `capacity` rays in a lens with `media` media.
    pub(crate) fn in_single_precision(self, capacity: usize, media: usize) -> Self {
        // The columns hold whole chunks.
        let column = vec![1.0; capacity.next_multiple_of(CHUNK)];
        Self { swift: true, per_nm: column.clone(), n: vec![column; media], ..self }
    }

    /// Records the absorption at the wavelengths of rays and, in single precision, the wavelengths and the indices of the media.
    pub(crate) fn note_wavelengths<'a>(
        &mut self,
        rays: &RayBatch,
        indices: impl Iterator<Item = &'a [f64]>,
        absorptions: Option<&Absorptions>,
    ) {
        let isa = rays.isa();
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

    /// Records the directions of rays.
    pub(crate) fn note_directions(&mut self, rays: &RayBatch) {
        let len = rays.len();
        for (to, from) in self.direction.iter_mut().zip(rays.directions()) {
            to.slice_mut(len).copy_from_slice(from);
        }
    }

    /// Returns the recorded directions of the first `len` rays.
    pub(crate) fn directions(&self, len: usize) -> [&[f64]; 3] {
        self.direction.each_ref().map(|column| column.slice(len))
    }

    /// Records the positions of rays.
    pub(crate) fn note_positions(&mut self, rays: &RayBatch) {
        let len = rays.len();
        for (to, from) in self.position.iter_mut().zip(rays.positions()) {
            to.slice_mut(len).copy_from_slice(from);
        }
    }

    /// Computes how rays met a surface that does not record it itself, from the recorded positions and directions. `shift_mm` is the vertex
    /// of the surface in the frame of the recorded positions.
    pub(crate) fn measure(&self, rays: &mut RayBatch, shift_mm: f64) {
        let isa = rays.isa();
        let len = rays.len();
        let from = self.position.each_ref().map(|column| column.slice(len));
        isa.run(Measure { from, direction: self.directions(len), shift_mm, rays: rays.weight_columns() });
        self.measure_angles(rays);
    }

    /// Computes the angles by which rays were bent, from the recorded directions.
    pub(crate) fn measure_angles(&self, rays: &mut RayBatch) {
        let isa = rays.isa();
        isa.run(MeasureAngles { direction: self.directions(rays.len()), rays: rays.weight_columns() });
    }

    /// Records the absorption of rays by a medium on their way to a surface, from its table. [`RaysBefore::weigh_absorbed`] applies it to
    /// the weights: one exponential for the whole path through a lens.
    pub(crate) fn absorb(&mut self, rays: &mut RayBatch, table: usize) {
        let isa = rays.isa();
        let len = rays.len();
        let way_mm = rays.weight_columns().way_mm;
        let (per_mm, depth) = (self.per_mm[table].slice(len), self.depth.slice_mut(len));
        if self.absorbed {
            isa.run(Absorb::<false> { way_mm, per_mm, depth });
        } else {
            isa.run(Absorb::<true> { way_mm, per_mm, depth });
        }
        self.absorbed = true;
    }

    /// Multiplies the weights by what the absorption recorded so far leaves.
    pub(crate) fn weigh_absorbed(&mut self, rays: &mut RayBatch) {
        let isa = rays.isa();
        if std::mem::take(&mut self.absorbed) {
            let depth = self.depth.slice(rays.len());
            isa.run(WeighAbsorbed { rays: rays.weight_columns(), depth });
        }
    }

    /// Ends rays that met a surface behind them: a steep reflection may send light sideways, past the next surface. Returns
    /// how many ended.
    pub(crate) fn end_behind(rays: &mut RayBatch, number: u32) -> usize {
        let isa = rays.isa();
        let c = rays.weight_columns();
        let many = isa.run(CountBehind { way_mm: c.way_mm, state: c.state }) as usize;
        if many > 0 {
            let is_behind = |i: &usize| c.state[*i] == ALIVE && c.way_mm[*i] < BEHIND_MM;
            let behind: Vec<usize> = (0..c.state.len()).filter(is_behind).collect();
            let c = rays.columns_mut();
            behind.iter().for_each(|i| c.state[*i] = Loss::Missed.state(number));
        }
        many
    }

    /// Adds the path to a surface to the optical path of batches that carry it, in a medium of these indices.
    pub(crate) fn lengthen(rays: &mut RayBatch, index: &[f64]) {
        let c = rays.weight_columns();
        for ((path, index), way_mm) in c.optical_path_mm.iter_mut().zip(index).zip(c.way_mm) {
            *path += *index * *way_mm;
        }
    }

    /// Multiplies the weights by the reflectance of a refracting surface; `n_beyond` are the indices on its other side.
    pub(crate) fn reflect(rays: &mut RayBatch, passage: &Passage, n: &[f64], n_beyond: &[f64]) {
        let isa = rays.isa();
        let (coating, gap) = match passage {
            Passage::All | Passage::Mirror(_) => return,
            Passage::Coated(..) => (passage.coating(), None),
            Passage::Apart(_, gap) => (passage.coating(), Some(gap)),
        };
        let c = rays.weight_columns();
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

    /// Multiplies the weights of polarized rays by the fraction that a surface passes, or reflects if `back` is set, and updates their
    /// polarization. `n_beyond` are the indices on the other side of the surface.
    pub(crate) fn polarize(&self, rays: &mut RayBatch, passage: &Passage, back: bool, [n, n_beyond]: [&[f64]; 2]) {
        let mut c = rays.weight_columns();
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
                // Cement that holds may reflect nothing while a gap of air beside it reflects.
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

    /// Multiplies the weights by the transmittance of a surface between these media, with these indices.
    pub(crate) fn pass(&self, rays: &mut RayBatch, passage: &Passage, media: [usize; 2], [n, n_after]: [&[f64]; 2]) {
        let isa = rays.isa();
        if let Passage::Apart(intact, gap) = passage {
            let came = rays.weights().to_vec();
            self.pass(rays, intact, media, [n, n_after]);
            let c = rays.weight_columns();
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
        let rays = rays.weight_columns();
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
