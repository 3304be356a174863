//! Numbers that a stage draws for itself: a pure function of (seed, estimator, stream, sample, stage, event).
//!
//! A stage that makes random choices (a surface that scatters, a plate that splits light, a source or an imager) says so by `draws`. It
//! draws by *event*, a decision that it makes for a ray: [`RayNumbers::number`], [`RayNumbers::pair`], or [`RayNumbers::generator`] for the
//! crates `rand` and `rand_distr`.
//!
//! **Strata do not run out.** Each pair of numbers is its own copy of the first two Sobol dimensions, shuffled and scrambled by a hash of
//! everything but the sample (padding: B. Burley, "Practical hash-based Owen scrambling", J. Computer Graphics Techniques 9 (2020), section
//! 4). Of every aligned 2^n samples of a pixel, the numbers of each event form a net. Pairs are independent of each other.
//!
//! **One more stage or event changes no number of another.** A surface is identified by its kind, by its position among the surfaces of
//! that kind that draw (counted from the front), and by how often the path met it before. Source and imager are identified as such.
//!
//! **Numbers stay with their ray.** A batch carries stream and sample (`RayBatch::with_numbers`), also where rays are dropped. It carries
//! them only if a stage of the scene draws; other scenes pay nothing. `set_stage` states which stage draws next, so no signature mentions
//! it.
//!
//! **Without numbers there is no chance.** Drawings, focus, f-numbers and the search for what passes trace batches without numbers. A stage
//! then does what it does to most of the light: it lets it pass straight, or treats it as the ordinary ray.
//!
//! The search for what passes ends where chance begins: it goes from the side that rays start on to the first surface that draws. Forward,
//! rays are aimed at all of a filter in front of the lens; backward, at the exit pupil as it is without the filter.
//!
//! `plugins/examples/diffusion-filter` is an example. Its steps are as likely one way as back and keep the etendue, so both directions
//! agree with weights of 1.

use super::{GOLDEN, Kind, Numbers, SampleRng, fill_strata, mix64, owen_scramble_reversed, point_reversed};
use super::{unit_from_u32, unit_from_u64};
use crate::batch::Column;
use std::ops::Range;

/// Hashes a name to 64 bits.
const fn hash(name: &str, mut from: u64) -> u64 {
    let mut i = 0;
    while i < name.len() {
        from = mix64(from ^ name.as_bytes()[i] as u64).wrapping_add(GOLDEN);
        i += 1;
    }
    from
}

/// Identifies a stage that draws numbers: its kind, and its number among the stages of that kind.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct StageKey(u64);

impl StageKey {
    /// Key of the source.
    pub const SOURCE: Self = Self::new("source", 0);
    /// Key of the imager, including what lies in front of its pixels.
    pub const IMAGER: Self = Self::new("imager", 0);

    /// Returns the key of a stage of this `kind`. `which` is its number, from 0, among the stages of that kind that draw numbers.
    #[must_use]
    pub const fn new(kind: &str, which: u64) -> Self {
        Self(hash(kind, mix64(which.wrapping_add(GOLDEN))))
    }
}

/// Random numbers of one ray at one stage.
///
/// A stage draws by event. An event is a decision that the stage makes for a ray; the stage counts its events from 0. The same
/// event of the same ray always gives the same numbers, whatever the size of the batch and the other rays in it. Over the
/// samples of a pixel (forward: over all paths), the numbers of each event are spread as evenly as those of the pupil.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RayNumbers {
    kind: Kind,
    key: u64,
    sample: u64,
}

impl RayNumbers {
    /// Returns one number in [0, 1) for an event.
    #[must_use]
    pub fn number(&self, event: u32) -> f64 {
        self.coordinate(event, 0)
    }

    /// Returns two numbers in [0, 1) that fill the square evenly. The first is [`RayNumbers::number`] of the same event.
    #[must_use]
    pub fn pair(&self, event: u32) -> [f64; 2] {
        [self.coordinate(event, 0), self.coordinate(event, 1)]
    }

    /// Returns a generator for code that uses `rand` or `rand_distr`. It gives any amount of numbers, independent of each other
    /// and of those of other events, rays and stages. They are not stratified, so [`RayNumbers::pair`] gives less noise where
    /// one or two numbers are enough.
    ///
    /// ```
    /// use rand_distr::{Distribution, Poisson};
    /// # use spectra_core::{RayBatch, numbers::Numbers};
    /// # let mut rays = RayBatch::new(1).with_numbers();
    /// # rays.restart(1);
    /// # rays.number(0, &Numbers::sobol(1), "example", 0, 0);
    /// # let numbers = rays.columns_mut().numbers.of(0).unwrap();
    /// let times_scattered: f64 = Poisson::new(2.5).unwrap().sample(&mut numbers.generator(0));
    /// # assert!(times_scattered >= 0.0 && times_scattered.fract() == 0.0);
    /// ```
    #[must_use]
    pub fn generator(&self, event: u32) -> SampleRng {
        SampleRng { state: mix64(self.event_key(event) ^ mix64(self.sample.wrapping_mul(GOLDEN))) }
    }

    fn event_key(&self, event: u32) -> u64 {
        mix64(self.key ^ mix64(u64::from(event).wrapping_add(GOLDEN)))
    }

    fn coordinate(&self, event: u32, dimension: usize) -> f64 {
        let event = self.event_key(event);
        let own = mix64(event.wrapping_add((dimension as u64 + 1).wrapping_mul(GOLDEN)));
        match self.kind {
            Kind::Random => unit_from_u64(mix64(own.wrapping_add(self.sample.wrapping_mul(GOLDEN)))),
            Kind::Stratified(strata) => {
                let mut out = [0.0];
                fill_strata(own, self.sample, strata, &mut out);
                out[0]
            }
            Kind::Sobol | Kind::Lattice => {
                // Beyond 2^32 samples: another scrambling of the same points.
                let block = (self.sample >> 32).wrapping_mul(GOLDEN);
                let shuffled = owen_scramble_reversed((self.sample as u32).reverse_bits(), mix64(event ^ block) as u32);
                unit_from_u32(owen_scramble_reversed(point_reversed(dimension, shuffled), mix64(own ^ block) as u32))
            }
        }
    }
}

/// Random numbers that the current stage may draw for the rays of a batch.
#[derive(Debug)]
pub struct StageNumbers<'a> {
    kind: Option<Kind>,
    stage: StageKey,
    streams: &'a mut [u64],
    samples: &'a mut [u64],
}

impl StageNumbers<'_> {
    pub(crate) fn none() -> Self {
        Self { kind: None, stage: StageKey(0), streams: &mut [], samples: &mut [] }
    }

    /// Returns the numbers of ray `i`; `None` if rays have no numbers, as in drawings and in the search for focus.
    #[inline]
    #[must_use]
    pub fn of(&self, i: usize) -> Option<RayNumbers> {
        let key = mix64(self.streams.get(i)? ^ self.stage.0);
        Some(RayNumbers { kind: self.kind?, key, sample: self.samples[i] })
    }

    /// Moves the numbers of ray `from` to ray `to`.
    #[inline(always)]
    pub(crate) fn keep(&mut self, from: usize, to: usize) {
        if let (Some(stream), Some(sample)) = (self.streams.get(from).copied(), self.samples.get(from).copied()) {
            (self.streams[to], self.samples[to]) = (stream, sample);
        }
    }
}

/// The columns that a batch carries for [`StageNumbers`].
#[derive(Clone, Debug)]
pub(crate) struct RayColumns {
    /// Kind of the numbers; `None` until [`crate::RayBatch::number`] has assigned samples to the rays.
    pub kind: Option<Kind>,
    pub stage: StageKey,
    /// Hash of seed, estimator and stream.
    streams: Column<u64>,
    samples: Column<u64>,
}

impl RayColumns {
    pub fn new(capacity: usize) -> Self {
        Self { kind: None, stage: StageKey(0), streams: Column::new(capacity), samples: Column::new(capacity) }
    }

    pub fn view(&mut self, len: usize) -> StageNumbers<'_> {
        let (streams, samples) = (self.streams.slice_mut(len), self.samples.slice_mut(len));
        StageNumbers { kind: self.kind, stage: self.stage, streams, samples }
    }

    pub fn number(&mut self, rays: Range<usize>, numbers: &Numbers, estimator: &str, stream: u64, first: u64) {
        self.kind = Some(numbers.kind);
        let key = mix64(hash(estimator, numbers.seed) ^ mix64(stream.wrapping_mul(GOLDEN)));
        self.streams.slice_mut(rays.end)[rays.start..].fill(key);
        for (sample, at) in self.samples.slice_mut(rays.end)[rays.start..].iter_mut().zip(first..) {
            *sample = at;
        }
    }
}

#[cfg(test)]
mod tests;
