//! Light that surfaces reflect and glass absorbs: what a ray weighs behind each surface.
//!
//! Asked for only where a lens states coatings, mirrors that are not perfect, or absorption; an ideal lens does nothing
//! here. The normal of a refracting surface is parallel to n' d' - n d, so that the angles follow from the directions
//! before and after, whatever the kind of surface.

use crate::coating::{self, Coating};
use crate::{Element, Lens, LensMedium};
use spectra_core::RayBatch;
use spectra_core::batch::Column;
use spectra_core::isa::{Isa, Vectorized};
use spectra_core::loss::ALIVE;
use spectra_core::math;
use spectra_core::surface::Action;
use spectra_glass::{Lender, Medium};

/// Indices that differ by less let everything pass: reflectance is below 1e-17 there.
const SAME_INDEX: f64 = 1e-8;
/// A medium of a lower index is a gas: a surface between two others is cemented, and no coating lies in it.
const GAS_INDEX: f64 = 1.05;
/// Step of the tables of absorption, nm.
const STEP_NM: f64 = 0.5;

/// What a surface does to the weight of light.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Passage {
    /// Nothing.
    All,
    /// Fresnel, under a coating or bare.
    Coated(Coating),
    /// This part is reflected by a mirror.
    Mirror(f64),
}

impl Passage {
    /// Of an element of a lens.
    pub(crate) fn of(lens: &Lens, element: &Element) -> Self {
        match element.action {
            Action::Pass => Self::All,
            Action::Reflect if element.reflectance == 1.0 => Self::All,
            Action::Reflect => Self::Mirror(element.reflectance),
            Action::Refract if element.medium_before == element.medium_after => Self::All,
            // What a grating sends into its order, or a surface scatters, is not a matter of Fresnel's equations.
            Action::Refract if element.surface.is_directional() || element.surface.draws() => Self::All,
            Action::Refract => match lens.coating_of(element) {
                Coating::Ideal => Self::All,
                coating => Self::Coated(coating),
            },
        }
    }
}

impl Lens {
    /// The coating of an element: its own, else the lens's; of the latter a surface between two glasses has none, it is
    /// cemented.
    #[must_use]
    pub fn coating_of(&self, element: &Element) -> Coating {
        let is_gas = |medium: usize| self.index(medium, self.reference_nm) < GAS_INDEX;
        match (&element.coating, &self.coating) {
            (Some(own), _) => own.clone(),
            (None, all @ (Coating::Ideal | Coating::Bare)) => all.clone(),
            (None, _) if !is_gas(element.medium_before) && !is_gas(element.medium_after) => Coating::Bare,
            (None, all) => all.clone(),
        }
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

/// Absorption of one medium, 1/mm, over a band.
#[derive(Clone, Debug)]
pub(crate) struct Absorption {
    start_nm: f64,
    per_mm: Vec<f64>,
}

impl Absorption {
    /// Of a medium of a lens of that year, by its own data or borrowed ones ([`Medium::absorption`]); `None` where it
    /// absorbs nothing, as far as is known. Beyond the data the nearest of them holds.
    pub(crate) fn of(medium: &Medium, year: Option<i32>, min_nm: f64, max_nm: f64) -> Option<Self> {
        let k = medium.absorption(year)?.extinction;
        let (first, last) = k.range_nm();
        let count = ((max_nm - min_nm) / STEP_NM).ceil() as usize + 2;
        let at = |i: usize| {
            let wavelength_nm = min_nm + STEP_NM * i as f64;
            let k = k.at(wavelength_nm.clamp(first, last)).unwrap_or(0.0);
            4.0e6 * std::f64::consts::PI * k / wavelength_nm
        };
        let per_mm: Vec<f64> = (0..count).map(at).collect();
        per_mm.iter().any(|a| *a > 0.0).then_some(Self { start_nm: min_nm, per_mm })
    }

    /// At a wavelength, nm, 1/mm.
    fn at(&self, wavelength_nm: f64) -> f64 {
        let place = ((wavelength_nm - self.start_nm) / STEP_NM).clamp(0.0, (self.per_mm.len() - 2) as f64);
        let i = (place as usize).min(self.per_mm.len() - 2);
        let t = place - i as f64;
        self.per_mm[i] + t * (self.per_mm[i + 1] - self.per_mm[i])
    }
}

/// Positions and directions in front of a surface, in its frame.
#[derive(Debug)]
pub(crate) struct Before {
    position: [Column<f64>; 3],
    direction: [Column<f64>; 3],
}

impl Before {
    /// Room for batches of up to `capacity` rays.
    pub(crate) fn new(capacity: usize) -> Self {
        let three = || std::array::from_fn(|_| Column::new(capacity));
        Self { position: three(), direction: three() }
    }

    /// Takes down where rays are and whereto they run.
    pub(crate) fn note(&mut self, rays: &RayBatch) {
        let len = rays.len();
        for (to, from) in self.position.iter_mut().zip(rays.positions()) {
            to.slice_mut(len).copy_from_slice(from);
        }
        for (to, from) in self.direction.iter_mut().zip(rays.directions()) {
            to.slice_mut(len).copy_from_slice(from);
        }
    }

    /// Weighs rays that arrived on a surface by what a medium absorbed on the way; `shift_mm` is the surface's vertex in
    /// the frame of what was noted.
    pub(crate) fn absorb(&self, rays: &mut RayBatch, absorption: &Absorption, shift_mm: f64) {
        let len = rays.len();
        let [x, y, z] = self.position.each_ref().map(|column| column.slice(len));
        let [l, m, n] = self.direction.each_ref().map(|column| column.slice(len));
        let c = rays.columns_mut();
        for i in 0..len {
            if c.state[i] != ALIVE {
                continue;
            }
            let path_mm = (c.x[i] - x[i]) * l[i] + (c.y[i] - y[i]) * m[i] + (c.z[i] - (z[i] - shift_mm)) * n[i];
            c.weight[i] *= math::exp(-absorption.at(c.wavelength_nm[i]) * path_mm.max(0.0));
        }
    }

    /// Adds the way since the note to the optical path of batches that carry it, in a medium of these indices.
    pub(crate) fn lengthen(&self, rays: &mut RayBatch, index: &[f64], shift_mm: f64) {
        let len = rays.len();
        let [x, y, z] = self.position.each_ref().map(|column| column.slice(len));
        let [l, m, n] = self.direction.each_ref().map(|column| column.slice(len));
        let c = rays.columns_mut();
        for (i, path) in c.optical_path_mm.iter_mut().enumerate() {
            let way_mm = (c.x[i] - x[i]) * l[i] + (c.y[i] - y[i]) * m[i] + (c.z[i] - (z[i] - shift_mm)) * n[i];
            *path += index[i] * way_mm;
        }
    }

    /// Weighs rays by what a refracting surface reflects; `n_beyond` are the indices on its other side.
    pub(crate) fn reflect(&self, rays: &mut RayBatch, passage: &Passage, n: &[f64], n_beyond: &[f64]) {
        let Passage::Coated(coating) = passage else {
            return rays.columns_mut().weight.fill(0.0);
        };
        let len = rays.len();
        let before = self.direction.each_ref().map(|column| column.slice(len));
        let c = rays.columns_mut();
        for i in 0..len {
            if c.state[i] != ALIVE {
                continue;
            }
            // Incidence and reflection differ by twice the cosine along the normal.
            let turn = [c.l[i] - before[0][i], c.m[i] - before[1][i], c.n[i] - before[2][i]];
            let cosine = 0.5 * (turn[0] * turn[0] + turn[1] * turn[1] + turn[2] * turn[2]).sqrt();
            c.weight[i] *= coating.reflectance(n[i], n_beyond[i], cosine.min(1.0), c.wavelength_nm[i]).mean();
        }
    }

    /// Weighs rays by what a surface passes.
    pub(crate) fn pass(&self, rays: &mut RayBatch, passage: &Passage, n: &[f64], n_after: &[f64], isa: Isa) {
        let len = rays.len();
        let before = self.direction.each_ref().map(|column| column.slice(len));
        match passage {
            Passage::All | Passage::Coated(Coating::Ideal) => {}
            Passage::Mirror(reflectance) => {
                for weight in rays.columns_mut().weight {
                    *weight *= *reflectance;
                }
            }
            Passage::Coated(Coating::Bare) => {
                isa.run(Pass::<false> { rays, before, n, n_after, index: 1.0, thickness_nm: 0.0 });
            }
            Passage::Coated(Coating::Layer { index, thickness_nm }) => {
                let (index, thickness_nm) = (*index, *thickness_nm);
                let decays = isa.run(Pass::<true> { rays, before, n, n_after, index, thickness_nm });
                if decays {
                    self.tunnel(rays, n, n_after, index, thickness_nm);
                }
            }
            Passage::Coated(coating @ Coating::Stack(stack)) => {
                if let Some(layers) = stack.clear_layers::<3>() {
                    self.pass_layers(rays, isa, coating, &layers, n, n_after);
                } else if let Some(layers) = stack.clear_layers::<2>() {
                    self.pass_layers(rays, isa, coating, &layers, n, n_after);
                } else {
                    self.pass_one_by_one(rays, coating, n, n_after, |_, _| true);
                }
            }
            Passage::Coated(coating) => self.pass_one_by_one(rays, coating, n, n_after, |_, _| true),
        }
    }

    /// Weighs rays by a stack of clear layers.
    fn pass_layers<const N: usize>(
        &self,
        rays: &mut RayBatch,
        isa: Isa,
        coating: &Coating,
        layers: &[[f64; 2]; N],
        n: &[f64],
        n_after: &[f64],
    ) {
        let len = rays.len();
        let before = self.direction.each_ref().map(|column| column.slice(len));
        if isa.run(PassLayers { rays: &mut *rays, before, n, n_after, layers }) {
            self.pass_one_by_one(rays, coating, n, n_after, |n, c| !(coating::least_square(layers, n, c) > 0.0));
        }
    }

    /// Weighs rays by a coating without a kernel of its own; only those that `which` picks by index and cosine of incidence.
    fn pass_one_by_one(
        &self,
        rays: &mut RayBatch,
        coating: &Coating,
        n: &[f64],
        n_after: &[f64],
        which: impl Fn(f64, f64) -> bool,
    ) {
        let len = rays.len();
        let before = self.direction.each_ref().map(|column| column.slice(len));
        let c = rays.columns_mut();
        for i in 0..len {
            let indices = [n[i], n_after[i]];
            let (size, cosines) = angles(indices, before.map(|column| column[i]), [c.l[i], c.m[i], c.n[i]]);
            if c.state[i] != ALIVE || size < SAME_INDEX || !which(n[i], cosines[0]) {
                continue;
            }
            let passes = match coating {
                Coating::Stack(stack) => stack.transmittance(indices, cosines, c.wavelength_nm[i]),
                other => other.transmittance(n[i], n_after[i], cosines[0], c.wavelength_nm[i]),
            };
            c.weight[i] *= passes.mean();
        }
    }

    /// The rays that do not run in the layer, which [`Pass`] left alone.
    fn tunnel(&self, rays: &mut RayBatch, n: &[f64], n_after: &[f64], index: f64, thickness_nm: f64) {
        let len = rays.len();
        let before = self.direction.each_ref().map(|column| column.slice(len));
        let c = rays.columns_mut();
        for i in 0..len {
            let (size, cosines) = angles([n[i], n_after[i]], before.map(|column| column[i]), [c.l[i], c.m[i], c.n[i]]);
            let runs = coating::layer_square(index, n[i], cosines[0]) > 0.0;
            if c.state[i] == ALIVE && size >= SAME_INDEX && !runs {
                c.weight[i] *=
                    coating::layer([n[i], n_after[i]], cosines, index, thickness_nm / c.wavelength_nm[i]).mean();
            }
        }
    }
}

/// Size of n' d' - n d, and the cosines of both directions with it.
#[inline(always)]
fn angles([n, n_after]: [f64; 2], before: [f64; 3], after: [f64; 3]) -> (f64, [f64; 2]) {
    let g =
        [n_after * after[0] - n * before[0], n_after * after[1] - n * before[1], n_after * after[2] - n * before[2]];
    let size = (g[0] * g[0] + g[1] * g[1] + g[2] * g[2]).sqrt();
    let dot = |d: [f64; 3]| ((d[0] * g[0] + d[1] * g[1] + d[2] * g[2]) / size).abs();
    (size, [dot(before), dot(after)])
}

/// Says whether any ray does not run in the layer.
struct Pass<'a, const LAYER: bool> {
    rays: &'a mut RayBatch,
    before: [&'a [f64]; 3],
    n: &'a [f64],
    n_after: &'a [f64],
    index: f64,
    thickness_nm: f64,
}

impl<const LAYER: bool> Vectorized for Pass<'_, LAYER> {
    type Output = bool;
    #[inline(always)]
    fn run(self) -> bool {
        let c = self.rays.columns_mut();
        let len = c.weight.len();
        let [bl, bm, bn] = self.before.map(|column| &column[..len]);
        let (l, m, nz, wavelength_nm) = (&c.l[..len], &c.m[..len], &c.n[..len], &c.wavelength_nm[..len]);
        let (n, n_after, state) = (&self.n[..len], &self.n_after[..len], &c.state[..len]);
        let weight = &mut c.weight[..len];
        let mut decays = false;
        for i in 0..len {
            let indices = [n[i], n_after[i]];
            let (size, cosines) = angles(indices, [bl[i], bm[i], bn[i]], [l[i], m[i], nz[i]]);
            let mut usable = (size >= SAME_INDEX) & (state[i] == ALIVE);
            let passes = if LAYER {
                let square = coating::layer_square(self.index, n[i], cosines[0]);
                let runs = square > 0.0;
                decays |= usable & !runs;
                usable &= runs;
                let in_layer = if runs { square.sqrt() } else { 1.0 };
                let waves = self.thickness_nm / wavelength_nm[i];
                coating::running_layer(indices, cosines, self.index, in_layer, waves).mean()
            } else {
                coating::bare(indices, cosines).mean()
            };
            weight[i] *= if usable { passes } else { 1.0 };
        }
        decays
    }
}

/// Says whether any ray does not run in one of the layers.
struct PassLayers<'a, const N: usize> {
    rays: &'a mut RayBatch,
    before: [&'a [f64]; 3],
    n: &'a [f64],
    n_after: &'a [f64],
    layers: &'a [[f64; 2]; N],
}

impl<const N: usize> Vectorized for PassLayers<'_, N> {
    type Output = bool;
    #[inline(always)]
    fn run(self) -> bool {
        let c = self.rays.columns_mut();
        let len = c.weight.len();
        let [bl, bm, bn] = self.before.map(|column| &column[..len]);
        let (l, m, nz, wavelength_nm) = (&c.l[..len], &c.m[..len], &c.n[..len], &c.wavelength_nm[..len]);
        let (n, n_after, state) = (&self.n[..len], &self.n_after[..len], &c.state[..len]);
        let weight = &mut c.weight[..len];
        let layers = *self.layers;
        let mut decays = false;
        for i in 0..len {
            let indices = [n[i], n_after[i]];
            let (size, cosines) = angles(indices, [bl[i], bm[i], bn[i]], [l[i], m[i], nz[i]]);
            let here = (size >= SAME_INDEX) & (state[i] == ALIVE);
            let runs = coating::least_square(&layers, n[i], cosines[0]) > 0.0;
            decays |= here & !runs;
            let passes = coating::running_layers(indices, cosines, &layers, wavelength_nm[i]).mean();
            weight[i] *= if here & runs { passes } else { 1.0 };
        }
        decays
    }
}
