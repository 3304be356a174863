//! Numbers that a stage draws for itself: a pure function of (seed, estimator, stream, sample, stage, event).
//!
//! Each pair of them is a copy of the first two Sobol dimensions of its own, shuffled and scrambled by a hash of all but the
//! sample (padding: B. Burley, "Practical hash-based Owen scrambling", J. Computer Graphics Techniques 9 (2020), section 4). So
//! strata do not end with the dimensions of one sequence, pairs are independent of each other, and a stage more, or an event
//! more, moves no number of another.

use super::{GOLDEN, Kind, Numbers, SampleRng, fill_strata, mix64, owen_scramble_reversed, point_reversed};
use super::{unit_from_u32, unit_from_u64};
use crate::batch::Column;
use std::ops::Range;

/// A name, as 64 bits.
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
    /// The source.
    pub const SOURCE: Self = Self::new("source", 0);
    /// The imager, with what stands before its pixels.
    pub const IMAGER: Self = Self::new("imager", 0);

    /// Of the stage `kind`; `which` counts those of the same kind that draw.
    #[must_use]
    pub const fn new(kind: &str, which: u64) -> Self {
        Self(hash(kind, mix64(which.wrapping_add(GOLDEN))))
    }
}

/// The numbers of one ray at one stage.
///
/// A stage draws by event: a decision that it takes for a ray, counted by the stage from 0. The same event of the same ray
/// gives the same numbers whenever it is asked, in a batch of any size, and whoever else is in it. Over the samples of a pixel
/// (forward: over all paths) each event's numbers are spread as evenly as those of the pupil.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RayNumbers {
    kind: Kind,
    key: u64,
    sample: u64,
}

impl RayNumbers {
    /// One number in [0, 1).
    #[must_use]
    pub fn number(&self, event: u32) -> f64 {
        self.coordinate(event, 0)
    }

    /// Two numbers in [0, 1) that fill the square evenly. The first is [`RayNumbers::number`] of the same event.
    #[must_use]
    pub fn pair(&self, event: u32) -> [f64; 2] {
        [self.coordinate(event, 0), self.coordinate(event, 1)]
    }

    /// A generator for code that uses `rand` or `rand_distr`: as many numbers as it likes, independent of each other and of
    /// those of other events, rays and stages. They have no strata, so [`RayNumbers::pair`] gives less noise where one or two
    /// numbers do.
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

/// What the stage at work may draw, for the rays of a batch.
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

    /// The numbers of ray `i`; `None` where there are none, as in drawings and in the search for focus.
    #[inline]
    #[must_use]
    pub fn of(&self, i: usize) -> Option<RayNumbers> {
        let key = mix64(self.streams.get(i)? ^ self.stage.0);
        Some(RayNumbers { kind: self.kind?, key, sample: self.samples[i] })
    }

    /// Moves ray `from` to `to`.
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
    /// `None` until the rays have their places.
    pub kind: Option<Kind>,
    pub stage: StageKey,
    /// Seed, estimator and stream in one.
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
