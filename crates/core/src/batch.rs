//! Rays in batches: structure of arrays, aligned to cache lines.

mod column;
mod polarization;

pub use column::Column;
pub use polarization::Polarization;
use polarization::PolarizationColumns;

use crate::isa::Isa;
use crate::loss::{ALIVE, Loss};
use crate::numbers::{Numbers, RayColumns, StageKey, StageNumbers};
use std::ops::Range;

/// Line number of a ray whose wavelength was drawn from a continuum instead of a spectral line.
pub const CONTINUUM: u32 = u32::MAX;

/// Number of low bits of a tag that hold the pixel number. The bits above them name the only channel that the ray adds to,
/// counted from 1; 0 means all channels.
pub const PIXEL_BITS: u32 = 28;

/// Returns the tag of a ray that adds only to channel `only_channel` (from 0) of `pixel`. Such a ray has passed the filter of
/// that channel, in a mosaic of color filters.
#[inline(always)]
#[must_use]
pub fn tag_of(pixel: u32, only_channel: u32) -> u32 {
    pixel | (only_channel + 1) << PIXEL_BITS
}

/// Splits a tag into the pixel number and the only channel that the ray adds to (from 0); the channel is `None` if the ray adds
/// to all.
#[inline(always)]
#[must_use]
pub fn pixel_and_channel(tag: u32) -> (u32, Option<u32>) {
    (tag & ((1 << PIXEL_BITS) - 1), (tag >> PIXEL_BITS).checked_sub(1))
}

/// A batch of rays, with one array per column. Methods give access to the columns, so new columns can be added without changing
/// plugins.
///
/// | column | unit | meaning |
/// |---|---|---|
/// | `x y z` | mm | a point on the ray, in the frame that the owner of the batch states |
/// | `l m n` | 1 | unit direction |
/// | `wavelength_nm` | nm | wavelength in air, as glass catalogues state it |
/// | `line` | | number of the spectral line of the source that was drawn, or [`CONTINUUM`] |
/// | `index` | 1 | refractive index of the medium that the ray is in |
/// | `weight` | see [`crate::stage`] | flux forward, throughput backward |
/// | `state` | | [`ALIVE`], or cause and surface of the loss ([`Loss::state`]) |
/// | `tag` | | the input row, path or pixel that the ray belongs to |
/// | `optical_path_mm` | mm | on request: [`RayBatch::with_optical_path`] |
/// | `polarization` | 1 | on request: Stokes parameters and their axis, [`RayBatch::with_polarization`] |
/// | `numbers` | | on request: random numbers for stages, [`RayBatch::with_numbers`] |
#[derive(Clone, Debug)]
pub struct RayBatch {
    len: usize,
    capacity: usize,
    isa: Isa,
    x: Column<f64>,
    y: Column<f64>,
    z: Column<f64>,
    l: Column<f64>,
    m: Column<f64>,
    n: Column<f64>,
    wavelength_nm: Column<f64>,
    index: Column<f64>,
    weight: Column<f64>,
    state: Column<u64>,
    optical_path_mm: Option<Column<f64>>,
    polarization: Option<PolarizationColumns>,
    numbers: Option<RayColumns>,
    line: Vec<u32>,
    tag: Vec<u32>,
    surface: u32,
    /// Indices of living rays; [`RayBatch::compact`] reuses this allocation.
    kept: Vec<u32>,
    /// Runs of living rays; reused in the same way.
    runs: Vec<Range<usize>>,
    scratch: Scratch,
}

/// Columns that the two loops of a surface pass to each other.
#[derive(Clone, Debug)]
struct Scratch {
    /// The squares x^2 + y^2 of the positions, mm^2. They stay valid from surface to surface until other code writes positions.
    radius2: Column<f64>,
    radius2_is_true: bool,
    /// Cosine of incidence between the loops; afterwards the margin by which the ray passes, negative or NaN if it ends.
    cosine_then_margin: Column<f64>,
    valid: Column<f64>,
    /// Value that a shape with a stepwise intersection keeps between steps; afterwards [`WeightColumns::versine`].
    kept_then_versine: Column<f64>,
    /// Size of the last step of a stepwise intersection, mm; afterwards [`WeightColumns::way_mm`].
    step_then_way: Column<f64>,
}

/// Mutable slices of the columns of [`Scratch`].
pub(crate) struct ScratchColumns<'a> {
    pub radius2: &'a mut [f64],
    pub cosine_then_margin: &'a mut [f64],
    pub valid: &'a mut [f64],
    pub kept_then_versine: &'a mut [f64],
    pub step_then_way: &'a mut [f64],
}

/// Mutable access to all columns of a batch at once.
#[derive(Debug)]
pub struct Columns<'a> {
    /// Position along x, mm.
    pub x: &'a mut [f64],
    /// Position along y, mm.
    pub y: &'a mut [f64],
    /// Position along z, mm.
    pub z: &'a mut [f64],
    /// Direction cosine along x.
    pub l: &'a mut [f64],
    /// Direction cosine along y.
    pub m: &'a mut [f64],
    /// Direction cosine along z.
    pub n: &'a mut [f64],
    /// Wavelength, nm.
    pub wavelength_nm: &'a mut [f64],
    /// Refractive index of the medium the ray is in.
    pub index: &'a mut [f64],
    /// Weight: flux forward, throughput backward.
    pub weight: &'a mut [f64],
    /// State: [`ALIVE`], or cause and surface of the loss.
    pub state: &'a mut [u64],
    /// Number of the spectral line that was drawn, or [`CONTINUUM`].
    pub line: &'a mut [u32],
    /// Tag: the input row, path or pixel that the ray belongs to.
    pub tag: &'a mut [u32],
    /// Optical path since [`RayBatch::restart`], mm; empty unless the batch carries it.
    pub optical_path_mm: &'a mut [f64],
    /// State of polarization; empty unless the batch carries it.
    pub polarization: Polarization<'a>,
    /// Random numbers that the current stage may draw, ray by ray.
    pub numbers: StageNumbers<'a>,
}

/// Read access to the columns that the weight of a ray may depend on, and write access to the weights. Code that only changes
/// weights leaves the rays in place, so cached values of their positions stay valid.
#[derive(Debug)]
pub struct WeightColumns<'a> {
    /// Positions, mm.
    pub position: [&'a [f64]; 3],
    /// Unit directions.
    pub direction: [&'a [f64]; 3],
    /// Wavelengths, nm.
    pub wavelength_nm: &'a [f64],
    /// State: [`ALIVE`], or cause and surface of the loss.
    pub state: &'a [u64],
    /// Distance that each living ray traveled to the last surface, mm; negative if it ran backward. Valid if the surface
    /// records it ([`notes_meeting`](crate::surface::Surface::records_intersection)); code that computes the distance itself may store
    /// it here.
    pub way_mm: &'a mut [f64],
    /// Versine, 1 - cos, of the angle by which the last surface deflected each ray. Valid under the same condition as `way_mm`,
    /// if the surface deflects light at all.
    pub versine: &'a mut [f64],
    /// Weight: flux forward, throughput backward.
    pub weight: &'a mut [f64],
    /// Optical path since [`RayBatch::restart`], mm; empty unless the batch carries it.
    pub optical_path_mm: &'a mut [f64],
    /// State of polarization; empty unless the batch carries it.
    pub polarization: Polarization<'a>,
}

impl RayBatch {
    /// Creates an empty batch with room for `capacity` rays.
    #[must_use]
    pub fn new(capacity: usize) -> Self {
        let column = || Column::<f64>::new(capacity);
        Self {
            len: 0,
            capacity,
            isa: Isa::detect(),
            x: column(),
            y: column(),
            z: column(),
            l: column(),
            m: column(),
            n: column(),
            wavelength_nm: column(),
            index: column(),
            weight: column(),
            state: Column::new(capacity),
            optical_path_mm: None,
            polarization: None,
            numbers: None,
            line: vec![CONTINUUM; capacity],
            tag: vec![0; capacity],
            surface: 0,
            kept: Vec::new(),
            runs: Vec::new(),
            scratch: Scratch {
                radius2: column(),
                radius2_is_true: false,
                cosine_then_margin: column(),
                valid: column(),
                kept_then_versine: column(),
                step_then_way: column(),
            },
        }
    }

    /// Sets the instruction set for all work on the batch, in place of the fastest one that the processor supports. The results
    /// are the same to the bit; tests compare them.
    #[must_use]
    pub fn on(self, isa: Isa) -> Self {
        Self { isa, ..self }
    }

    /// Returns the instruction set for work on the batch.
    #[inline(always)]
    #[must_use]
    pub fn isa(&self) -> Isa {
        self.isa
    }

    /// Creates an empty batch that also carries the optical path: the sum of index times distance, mm. A distance is negative
    /// if a surface lies behind the one before.
    #[must_use]
    pub fn with_optical_path(capacity: usize) -> Self {
        Self { optical_path_mm: Some(Column::new(capacity)), ..Self::new(capacity) }
    }

    /// Adds the state of polarization of each ray, unpolarized at first. Each surface of a lens then transmits and reflects
    /// according to that state, and changes it. Without this column, light is unpolarized at every surface.
    #[must_use]
    pub fn with_polarization(self) -> Self {
        Self { polarization: Some(PolarizationColumns::new(self.capacity)), ..self }
    }

    /// Returns whether rays carry a state of polarization.
    #[must_use]
    pub fn is_polarized(&self) -> bool {
        self.polarization.is_some()
    }

    /// Adds the two columns that a stage needs to draw random numbers. Rays have numbers once [`RayBatch::number`] has given
    /// them their places in a sequence.
    #[must_use]
    pub fn with_numbers(self) -> Self {
        Self { numbers: Some(RayColumns::new(self.capacity)), ..self }
    }

    /// Assigns sample numbers to the rays from index `from` on: ray `from` becomes sample `first` of `stream`, the next ray
    /// sample `first + 1`, and so on. `estimator` is the name of the estimator that traces the rays. From then on, stages draw
    /// each ray's numbers from `numbers` at its sample, even if rays are removed or reordered. Does nothing if the batch was made
    /// without [`RayBatch::with_numbers`].
    pub fn number(&mut self, from: usize, numbers: &Numbers, estimator: &str, stream: u64, first: u64) {
        if let Some(columns) = &mut self.numbers {
            columns.number(from..self.len, numbers, estimator, stream, first);
        }
    }

    /// Sets the stage that draws random numbers from the rays from now on.
    pub fn set_stage(&mut self, stage: StageKey) {
        if let Some(columns) = &mut self.numbers {
            columns.stage = stage;
        }
    }

    /// Restarts the batch with `len` rays that are alive, have weight 1, are in air and are on no spectral line. Positions,
    /// directions and wavelengths keep their old values; the caller overwrites them.
    ///
    /// # Panics
    /// If `len` exceeds the capacity, which the caller chose.
    pub fn restart(&mut self, len: usize) {
        assert!(len <= self.capacity, "a batch of {} rays cannot hold {len}", self.capacity);
        self.len = len;
        self.surface = 0;
        if let Some(columns) = &mut self.numbers {
            columns.kind = None;
        }
        let mut c = self.columns_mut();
        c.index.fill(1.0);
        c.weight.fill(1.0);
        c.state.fill(ALIVE);
        c.line.fill(CONTINUUM);
        c.optical_path_mm.fill(0.0);
        c.polarization.clear();
    }

    /// Number of rays, including those that have ended.
    #[inline(always)]
    #[must_use]
    pub fn len(&self) -> usize {
        self.len
    }

    /// Returns whether the batch holds no rays.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.len == 0
    }

    /// Largest number of rays that the batch has room for.
    #[must_use]
    pub fn capacity(&self) -> usize {
        self.capacity
    }

    /// Number (from 1) of the surface that the living rays passed last; 0 before the first.
    #[must_use]
    pub fn surface(&self) -> u32 {
        self.surface
    }

    /// Sets the number of the surface that the living rays passed last.
    pub fn set_surface(&mut self, surface: u32) {
        self.surface = surface;
    }

    /// Returns all columns at once, writable.
    #[inline(always)]
    pub fn columns_mut(&mut self) -> Columns<'_> {
        self.scratch.radius2_is_true = false;
        self.split().0
    }

    /// Returns the weights, writable, and the columns that they may depend on.
    #[inline(always)]
    pub fn weight_columns(&mut self) -> WeightColumns<'_> {
        let (c, s) = self.split();
        WeightColumns {
            way_mm: s.step_then_way,
            versine: s.kept_then_versine,
            position: [c.x, c.y, c.z],
            direction: [c.l, c.m, c.n],
            wavelength_nm: c.wavelength_nm,
            state: c.state,
            weight: c.weight,
            optical_path_mm: c.optical_path_mm,
            polarization: c.polarization,
        }
    }

    /// Returns all columns, and the scratch columns that the loops of a surface share, with x^2 + y^2 up to date.
    #[inline(always)]
    pub(crate) fn columns_and_scratch_mut(&mut self) -> (Columns<'_>, ScratchColumns<'_>) {
        if !self.scratch.radius2_is_true {
            self.scratch.radius2_is_true = true;
            let (c, s) = self.split();
            for ((r2, x), y) in s.radius2.iter_mut().zip(c.x.iter()).zip(c.y.iter()) {
                *r2 = x * x + y * y;
            }
        }
        self.split()
    }

    #[inline(always)]
    fn split(&mut self) -> (Columns<'_>, ScratchColumns<'_>) {
        let len = self.len;
        let columns = Columns {
            x: self.x.slice_mut(len),
            y: self.y.slice_mut(len),
            z: self.z.slice_mut(len),
            l: self.l.slice_mut(len),
            m: self.m.slice_mut(len),
            n: self.n.slice_mut(len),
            wavelength_nm: self.wavelength_nm.slice_mut(len),
            index: self.index.slice_mut(len),
            weight: self.weight.slice_mut(len),
            state: self.state.slice_mut(len),
            line: &mut self.line[..len],
            tag: &mut self.tag[..len],
            optical_path_mm: self.optical_path_mm.as_mut().map_or(&mut [], |column| column.slice_mut(len)),
            polarization: self.polarization.as_mut().map_or_else(Polarization::default, |columns| columns.view(len)),
            numbers: self.numbers.as_mut().map_or_else(StageNumbers::none, |columns| columns.view(len)),
        };
        let scratch = ScratchColumns {
            radius2: self.scratch.radius2.slice_mut(len),
            cosine_then_margin: self.scratch.cosine_then_margin.slice_mut(len),
            valid: self.scratch.valid.slice_mut(len),
            kept_then_versine: self.scratch.kept_then_versine.slice_mut(len),
            step_then_way: self.scratch.step_then_way.slice_mut(len),
        };
        (columns, scratch)
    }

    /// Positions x, y and z of the rays, mm.
    #[inline]
    #[must_use]
    pub fn positions(&self) -> [&[f64]; 3] {
        [self.x.slice(self.len), self.y.slice(self.len), self.z.slice(self.len)]
    }

    /// Direction cosines l, m and n of the rays.
    #[inline]
    #[must_use]
    pub fn directions(&self) -> [&[f64]; 3] {
        [self.l.slice(self.len), self.m.slice(self.len), self.n.slice(self.len)]
    }

    /// Wavelengths of the rays, nm.
    #[inline]
    #[must_use]
    pub fn wavelengths_nm(&self) -> &[f64] {
        self.wavelength_nm.slice(self.len)
    }

    /// Weights of the rays: flux forward, throughput backward.
    #[inline]
    #[must_use]
    pub fn weights(&self) -> &[f64] {
        self.weight.slice(self.len)
    }

    /// States of the rays: [`ALIVE`], or cause and surface of the loss.
    #[inline]
    #[must_use]
    pub fn states(&self) -> &[u64] {
        self.state.slice(self.len)
    }

    /// Optical path since [`RayBatch::restart`], in mm; `None` unless the batch carries it ([`RayBatch::with_optical_path`]).
    #[must_use]
    pub fn optical_path_mm(&self) -> Option<&[f64]> {
        self.optical_path_mm.as_ref().map(|column| column.slice(self.len))
    }

    /// Numbers of the spectral lines that were drawn, or [`CONTINUUM`].
    #[must_use]
    pub fn lines(&self) -> &[u32] {
        &self.line[..self.len]
    }

    /// Tags of the rays: input rows, paths or pixels.
    #[inline]
    #[must_use]
    pub fn tags(&self) -> &[u32] {
        &self.tag[..self.len]
    }

    /// Cause and surface of the loss of ray `i`; `None` while it is alive.
    #[must_use]
    pub fn loss(&self, i: usize) -> Option<(Loss, u32)> {
        Loss::of_state(self.states()[i])
    }

    /// Number of rays that are alive.
    #[must_use]
    pub fn alive(&self) -> usize {
        self.states().iter().filter(|s| **s == ALIVE).count()
    }

    /// Removes the rays that have ended and keeps the order of the others. Returns how many are left.
    pub fn compact(&mut self) -> usize {
        let len = self.len;
        let Some(first) = self.states().iter().position(|state| *state != ALIVE) else { return len };
        let mut kept = std::mem::take(&mut self.kept);
        kept.resize(self.capacity, 0);
        let mut many = 0_usize;
        // Which rays have ended is unpredictable, so there is no branch.
        for (i, state) in (first as u32..).zip(&self.states()[first..]) {
            kept[many] = i;
            many += usize::from(*state == ALIVE);
        }
        let mut runs = std::mem::take(&mut self.runs);
        runs.clear();
        if (len - first - many) * LONG < many {
            let run = |run: &[u32]| run[0] as usize..run[0] as usize + run.len();
            runs.extend(kept[..many].chunk_by(|a, b| a + 1 == *b).map(run));
        }
        let living = Living { first, kept: &kept[..many], runs: &runs };
        let mut c = self.columns_mut();
        let columns = [&mut c.x, &mut c.y, &mut c.z, &mut c.l, &mut c.m, &mut c.n];
        for column in columns.into_iter().chain([&mut c.wavelength_nm, &mut c.index, &mut c.weight]) {
            living.close_up(column);
        }
        living.close_up(c.line);
        living.close_up(c.tag);
        if !c.optical_path_mm.is_empty() {
            living.close_up(c.optical_path_mm);
        }
        for (to, from) in (first..).zip(&kept[..many]) {
            c.polarization.keep(*from as usize, to);
            c.numbers.keep(*from as usize, to);
        }
        let to = first + many;
        c.state[first..to].fill(ALIVE);
        (self.kept, self.runs) = (kept, runs);
        self.len = to;
        to
    }
}

/// Mean length of the runs of living rays from which these are moved run by run.
const LONG: usize = 16;

/// The living rays of a batch from the first one that ended.
struct Living<'a> {
    /// Index of the first ray that ended.
    first: usize,
    /// Indices of the living rays behind it, in ascending order.
    kept: &'a [u32],
    /// Runs of living rays, if so few rays ended that these are long; otherwise empty.
    runs: &'a [Range<usize>],
}

impl Living<'_> {
    /// Moves the values of a column together.
    #[inline(always)]
    fn close_up<T: Copy>(&self, column: &mut [T]) {
        if self.runs.is_empty() {
            for (to, from) in (self.first..).zip(self.kept) {
                column[to] = column[*from as usize];
            }
        }
        let mut to = self.first;
        for run in self.runs {
            column.copy_within(run.clone(), to);
            to += run.len();
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn columns_start_on_cache_lines() {
        let mut batch = RayBatch::new(100);
        batch.restart(100);
        let c = batch.columns_mut();
        for column in [c.x, c.y, c.z, c.l, c.m, c.n, c.wavelength_nm, c.index, c.weight] {
            assert_eq!(column.as_ptr() as usize % 64, 0);
            assert_eq!(column.len(), 100);
        }
    }

    #[test]
    fn compaction_keeps_order_and_values() {
        let mut batch = RayBatch::new(10);
        batch.restart(10);
        let c = batch.columns_mut();
        for i in 0..10 {
            c.x[i] = i as f64;
            c.tag[i] = i as u32;
            if i % 3 != 0 {
                c.state[i] = Loss::Vignetted.state(2);
            }
        }
        assert_eq!(batch.compact(), 4);
        assert_eq!(batch.tags(), [0, 3, 6, 9]);
        assert_eq!(batch.positions()[0], [0.0, 3.0, 6.0, 9.0]);
        assert_eq!(batch.alive(), 4);
    }

    /// Runs of any length, at the beginning and at the end; all rays or none.
    #[test]
    fn compaction_closes_up_any_gaps() {
        for kind in 0..7_usize {
            let mut batch = RayBatch::new(200);
            batch.restart(200);
            let lives = |i: usize| match kind {
                0 => true,
                1 => false,
                2 => i != 0 && i != 199,
                3 => i % 2 == 1,
                4 => i % 37 > 3,
                5 => i < 100,
                _ => i >= 50,
            };
            let c = batch.columns_mut();
            for i in 0..200 {
                (c.weight[i], c.tag[i]) = (i as f64, i as u32);
                c.state[i] = if lives(i) { ALIVE } else { Loss::Missed.state(1) };
            }
            let want: Vec<u32> = (0..200).filter(|i| lives(*i)).map(|i| i as u32).collect();
            assert_eq!(batch.compact(), want.len());
            assert_eq!(batch.tags(), want);
            assert!(batch.weights().iter().zip(&want).all(|(weight, i)| *weight == f64::from(*i)));
            assert_eq!(batch.alive(), want.len());
        }
    }
}
