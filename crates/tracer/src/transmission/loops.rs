//! The loops over a batch that compute transmission.

use spectra_core::batch::WeightColumns;
use spectra_core::isa::{Isa, Vectorized};
use spectra_core::loss::ALIVE;
use spectra_core::math;
use spectra_lens::Coating;
use spectra_lens::coating::{CHUNK, Films, FilmsF32, Sides, Singles, bare_reflectance};
use spectra_lens::coating::{SAME_INDEX, cosine_of_mirrored, versine};

/// Path length below which a ray runs backward, mm. Cemented surfaces and rounding stay above it.
pub(super) const BEHIND_MM: f64 = -1e-6;

/// Kernel that measures the path lengths from the earlier positions of rays, along their directions.
pub(super) struct Measure<'a> {
    pub(super) from: [&'a [f64]; 3],
    pub(super) direction: [&'a [f64]; 3],
    pub(super) shift_mm: f64,
    pub(super) rays: WeightColumns<'a>,
}

impl Vectorized for Measure<'_> {
    type Output = ();
    #[inline(always)]
    fn run(self) {
        let Self { from, direction, shift_mm, rays: WeightColumns { position, way_mm, .. } } = self;
        let len = way_mm.len();
        let [from, direction, to] = [from, direction, position].map(|columns| columns.map(|column| &column[..len]));
        for i in 0..len {
            let step = [to[0][i] - from[0][i], to[1][i] - from[1][i], to[2][i] - (from[2][i] - shift_mm)];
            way_mm[i] = step[0] * direction[0][i] + step[1] * direction[1][i] + step[2] * direction[2][i];
        }
    }
}

/// Kernel that measures the angles between the directions before and after.
pub(super) struct MeasureAngles<'a> {
    pub(super) direction: [&'a [f64]; 3],
    pub(super) rays: WeightColumns<'a>,
}

impl Vectorized for MeasureAngles<'_> {
    type Output = ();
    #[inline(always)]
    fn run(self) {
        let (before, WeightColumns { direction: after, versine: versines, .. }) = (self.direction, self.rays);
        let len = versines.len();
        let [[bl, bm, bn], [l, m, n]] = [before, after].map(|columns| columns.map(|column| &column[..len]));
        for i in 0..len {
            versines[i] = versine([bl[i], bm[i], bn[i]], [l[i], m[i], n[i]]);
        }
    }
}

/// Kernel that adds the absorption along the path, or starts the sum with it if `FIRST` is set.
pub(super) struct Absorb<'a, const FIRST: bool> {
    pub(super) way_mm: &'a [f64],
    pub(super) per_mm: &'a [f64],
    pub(super) depth: &'a mut [f64],
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

/// Kernel that counts live rays that ran backward; there are hardly ever any.
pub(super) struct CountBehind<'a> {
    pub(super) way_mm: &'a [f64],
    pub(super) state: &'a [u64],
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

pub(super) struct WeighAbsorbed<'a> {
    pub(super) rays: WeightColumns<'a>,
    pub(super) depth: &'a [f64],
}

impl Vectorized for WeighAbsorbed<'_> {
    type Output = ();
    #[inline(always)]
    fn run(self) {
        weigh_absorbed(self.depth, self.rays.state, self.rays.weight);
    }
}

/// Multiplies the weights by what absorption leaves. Columns are separate arguments, so the compiler knows that weights overlap none of the
/// others.
#[inline(always)]
fn weigh_absorbed(depth: &[f64], state: &[u64], weight: &mut [f64]) {
    let len = weight.len();
    let (depth, state) = (&depth[..len], &state[..len]);
    for i in 0..len {
        let left = math::exp_within_700(-depth[i]);
        weight[i] *= if state[i] == ALIVE { left } else { 1.0 };
    }
}

/// The transmittance of a surface, as a trait: methods are inlined where told to, but closures are not and would be compiled for the
/// baseline.
trait Passes {
    /// Returns the fraction of unpolarized light that passes, for the sides of the surface at a wavelength, nm.
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

/// The rays at a surface that they met, with the indices on both sides.
pub(super) struct Pass<'a> {
    pub(super) rays: WeightColumns<'a>,
    pub(super) n: &'a [f64],
    pub(super) n_after: &'a [f64],
}

impl Pass<'_> {
    /// Multiplies the weights by the transmittance of clear layers.
    pub(super) fn through<const N: usize>(self, films: &Films<N>, halvings: u32, isa: Isa) {
        match halvings {
            0 | 1 => isa.run(PassFilms::<N, 1>(self, films)),
            2 => isa.run(PassFilms::<N, 2>(self, films)),
            3 => isa.run(PassFilms::<N, 3>(self, films)),
            _ => isa.run(PassFilms::<N, 5>(self, films)),
        }
    }

    /// Multiplies the weights by the transmittance of any coating.
    pub(super) fn ray_by_ray(self, coating: &Coating) {
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

/// Multiplies the weights by the transmittance. Columns are separate arguments, as in [`weigh_absorbed`].
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

pub(super) struct PassBare<'a>(pub(super) Pass<'a>);

impl Vectorized for PassBare<'_> {
    type Output = ();
    #[inline(always)]
    fn run(self) {
        self.0.weigh(Bare);
    }
}

/// Kernel that multiplies the weights by the reflectance of bare glass.
pub(super) struct ReflectBare<'a>(pub(super) Pass<'a>);

impl Vectorized for ReflectBare<'_> {
    type Output = ();
    #[inline(always)]
    fn run(self) {
        let Pass { rays: c, n, n_after } = self.0;
        reflect_bare([n, n_after, c.versine], c.state, c.weight);
    }
}

/// Multiplies the weights by the reflectance of bare glass. Columns are separate arguments, as in [`weigh_absorbed`].
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

/// Kernel that computes one over the wavelengths, 1/nm.
pub(super) struct Invert<'a> {
    pub(super) wavelength_nm: &'a [f64],
    pub(super) per_nm: &'a mut [f32],
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

/// Kernel that converts indices to single precision.
pub(super) struct ToSingle<'a> {
    pub(super) n: &'a [f64],
    pub(super) single: &'a mut [f32],
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

/// Kernel that multiplies the weights by the transmittance of layers in single precision. The columns are the indices on both sides and one
/// over the wavelengths, 1/nm.
pub(super) struct PassSwift<'a, const N: usize>(
    pub(super) WeightColumns<'a>,
    pub(super) &'a FilmsF32<N>,
    pub(super) [&'a [f32]; 3],
);

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

/// Weighs one chunk in three loops, so that the middle one contains only single precision.
#[inline(always)]
fn swift_chunk<const N: usize>(
    swift: &FilmsF32<N>,
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
