//! Numbers for sampling: a pure function of (seed, stream, sample, dimension).
//!
//! In backward rendering a stream is a pixel, or the rays of a pixel to the rim of the pupil, and samples count within it. In
//! forward rendering there is one stream, and a sample is a path. There is no state, so the numbers are the same however the
//! work is divided.
//!
//! [`Numbers::sobol`] draws from Owen-scrambled Sobol points: direction numbers by S. Joe and F. Y. Kuo,
//! "Constructing Sobol sequences with better two-dimensional projections", SIAM J. Sci. Comput. 30
//! (2008); hash-based nested scrambling by S. Laine and T. Karras (2011) with the constants of
//! B. Burley, "Practical hash-based Owen scrambling", J. Computer Graphics Techniques 9 (2020).
//! [`Numbers::lattice`] draws from an extensible rank-1 lattice (F. J. Hickernell, H. S. Hong, P. L'Ecuyer and C. Lemieux,
//! "Extensible lattice sequences for quasi-Monte Carlo quadrature", SIAM J. Sci. Comput. 22 (2000)), shifted.
//! [`Numbers::random`] draws independent numbers with the SplitMix64 finalizer; [`Numbers::stratified`] draws jittered numbers,
//! one in each of n equal parts, in a separate order for each dimension.
//!
//! A path has five [`Dimension`]s, the first five of one Sobol sequence. Wavelength and pupil have its first three coordinates,
//! which are the most even together: what a lens does with a point depends on all three at once. The wavelength's place is the
//! same in all of its 64 strata, mirrored from each to the next. An error that the slope of a spectrum makes in one stratum is
//! compensated in its neighbor.
//!
//! A stage that makes random choices draws further numbers from the rays; see [`RayNumbers`].

mod stage;

pub(crate) use stage::RayColumns;
pub use stage::{RayNumbers, StageKey, StageNumbers};

pub use spectra_numerics::hash::{GOLDEN, SplitMix64, mix64, unit};
pub use spectra_numerics::poisson::quantile as poisson;

use crate::isa::{Isa, Vectorized};

/// Dimensions of a path, named after what their numbers decide. The wavelength has a dimension of its own, so that strategies
/// can be compared with equal numbers everywhere else.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u32)]
pub enum Dimension {
    /// The wavelength.
    Wavelength = 0,
    /// Horizontal position in the pixel, or on the source.
    PlaceU = 1,
    /// Vertical position in the pixel, or on the source.
    PlaceV = 2,
    /// First coordinate on the pupil.
    PupilU = 3,
    /// Second coordinate on the pupil.
    PupilV = 4,
}

/// Number of dimensions that have Sobol points; later ones are independent random numbers.
pub const SOBOL_DIMENSIONS: usize = 8;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Kind {
    Random,
    Sobol,
    /// A shifted lattice.
    Lattice,
    /// Jittered, in this many strata, at least 1.
    Stratified(u32),
}

/// Generating vector of the lattice, in units of 1 / 2^32 per dimension. It is the best of 79 vectors with random last bits, by
/// the error of random vignetted integrands at 16 to 256 points.
const LATTICE: [u32; 5] = [1, 136_980_787, 1_326_550_667, 3_009_221_399, 872_425_555];

/// A generator of sample coordinates in [0, 1): independent random numbers, Sobol points, a shifted lattice or jittered strata.
#[derive(Clone, Debug)]
pub struct Numbers {
    kind: Kind,
    seed: u64,
    /// Contribution of the low eight bits of the index to the points of each dimension.
    low: Box<[[u32; 256]; SOBOL_DIMENSIONS]>,
}

/// Derives the seed of one frame of an animation from the seed of the whole. It depends on nothing else, so a frame rendered
/// alone has the same numbers as in the sequence.
#[must_use]
pub fn seed_of_frame(seed: u64, frame: u64) -> u64 {
    mix64(mix64(seed.wrapping_add(GOLDEN)) ^ mix64(frame.wrapping_mul(GOLDEN)).rotate_left(32))
}

/// Converts the upper 52 bits to a number in [0, 1): the same bits on every tier, without an integer conversion.
#[inline(always)]
fn unit_from_u64(x: u64) -> f64 {
    f64::from_bits((x >> 12) | 0x3ff0_0000_0000_0000) - 1.0
}

/// Converts 32 bits to the center of their cell in [0, 1).
#[inline(always)]
fn unit_from_u32(x: u32) -> f64 {
    f64::from_bits((u64::from(x) << 20) | 0x3ff0_0000_0008_0000) - 1.0
}

/// Scrambles the bits of `x` by nested uniform scrambling. The bits of `x` are reversed; the result is in the usual order.
#[inline(always)]
fn owen_scramble_reversed(x: u32, seed: u32) -> u32 {
    let mut x = x ^ x.wrapping_mul(0x3d20_adea);
    x = x.wrapping_add(seed);
    x = x.wrapping_mul((seed >> 16) | 1);
    x ^= x.wrapping_mul(0x0552_6c56);
    x ^= x.wrapping_mul(0x53a2_2864);
    x.reverse_bits()
}

/// Degree, coefficients and initial numbers of each dimension after the first (Joe and Kuo 2008).
const JOE_KUO: [(u32, u32, &[u32]); SOBOL_DIMENSIONS - 1] = [
    (1, 0, &[1]),
    (2, 1, &[1, 3]),
    (3, 1, &[1, 3, 1]),
    (3, 2, &[1, 1, 1]),
    (4, 1, &[1, 1, 3, 3]),
    (4, 4, &[1, 3, 5, 13]),
    (5, 2, &[1, 1, 5, 5, 17]),
];

/// Direction numbers, bit-reversed: bit k of the index flips `DIRECTIONS[d][k]`.
static DIRECTIONS: [[u32; 32]; SOBOL_DIMENSIONS] = directions();

const fn directions() -> [[u32; 32]; SOBOL_DIMENSIONS] {
    let mut all = [[0_u32; 32]; SOBOL_DIMENSIONS];
    let mut k = 0;
    while k < 32 {
        all[0][k] = 1 << k; // bit-reversed radical inverse
        k += 1;
    }
    let mut d = 1;
    while d < SOBOL_DIMENSIONS {
        let (degree, coefficients, initial) = JOE_KUO[d - 1];
        let s = degree as usize;
        let mut v = [0_u32; 32];
        let mut i = 0;
        while i < 32 {
            if i < s {
                v[i] = initial[i] << (31 - i);
            } else {
                v[i] = v[i - s] ^ (v[i - s] >> s);
                let mut j = 1;
                while j < s {
                    if (coefficients >> (s - 1 - j)) & 1 == 1 {
                        v[i] ^= v[i - j];
                    }
                    j += 1;
                }
            }
            i += 1;
        }
        i = 0;
        while i < 32 {
            all[d][i] = v[i].reverse_bits();
            i += 1;
        }
        d += 1;
    }
    all
}

/// Sobol coordinate of each dimension. The first three coordinates are the most even together, and what a lens draws depends
/// most on wavelength and pupil together. With place before pupil, a picture on color film takes 1.16 times as many samples for
/// the same noise.
const COORDINATE: [usize; SOBOL_DIMENSIONS] = {
    let mut all = [0, 1, 2, 3, 4, 5, 6, 7];
    all[Dimension::PupilU as usize] = 1;
    all[Dimension::PupilV as usize] = 2;
    all[Dimension::PlaceU as usize] = 3;
    all[Dimension::PlaceV as usize] = 4;
    all
};

/// Returns a coordinate of the Sobol point `index`, with its bits reversed.
///
/// The first two coordinates have closed forms. The first is the index. In the second, bit `j` is the parity of those bits of
/// the index whose numbers contain all bits of `j` (Pascal's triangle modulo 2). Five steps compute it, one for each bit of a
/// bit number.
#[inline]
fn point_reversed(coordinate: usize, index: u32) -> u32 {
    match coordinate {
        0 => index,
        1 => {
            let mut x = index;
            x ^= (x & 0xaaaa_aaaa) >> 1;
            x ^= (x & 0xcccc_cccc) >> 2;
            x ^= (x & 0xf0f0_f0f0) >> 4;
            x ^= (x & 0xff00_ff00) >> 8;
            x ^ (x >> 16)
        }
        _ => by_directions(coordinate, index),
    }
}

fn by_directions(coordinate: usize, mut index: u32) -> u32 {
    let mut x = 0;
    let mut k = 0;
    while index != 0 {
        if index & 1 == 1 {
            x ^= DIRECTIONS[coordinate][k];
        }
        index >>= 1;
        k += 1;
    }
    x
}

impl Numbers {
    fn new(kind: Kind, seed: u64) -> Self {
        let low = std::array::from_fn(|d| std::array::from_fn(|i| point_reversed(COORDINATE[d], i as u32)));
        Self { kind, seed: mix64(seed.wrapping_add(GOLDEN)), low: Box::new(low) }
    }

    /// Creates Owen-scrambled Sobol points: the samples of a stream fill the space evenly. Wavelengths are mirrored between 64
    /// strata, which reduces the noise of smooth light.
    #[must_use]
    pub fn sobol(seed: u64) -> Self {
        Self::new(Kind::Sobol, seed)
    }

    /// Creates a rank-1 lattice in the five [`Dimension`]s, with a random shift of its own for each stream and dimension. Its
    /// points come in the order of the radical inverse, so that the first 2^n of them also form a lattice. For smooth light the
    /// points are more even than Sobol points.
    #[must_use]
    pub fn lattice(seed: u64) -> Self {
        Self::new(Kind::Lattice, seed)
    }

    /// Creates independent random numbers.
    #[must_use]
    pub fn random(seed: u64) -> Self {
        Self::new(Kind::Random, seed)
    }

    /// Creates jittered strata: of every `strata` consecutive samples (starting at a multiple of `strata`), one lies in each of
    /// that many equal parts of [0, 1), at a random position. The order of the parts differs between dimensions and streams.
    ///
    /// A number depends on (seed, stream, sample, dimension) and on the number of strata. The best number of strata is the
    /// number of samples in a stream. 0 counts as 1, which gives independent numbers.
    #[must_use]
    pub fn stratified(seed: u64, strata: u32) -> Self {
        Self::new(Kind::Stratified(strata.max(1)), seed)
    }

    /// Returns independent numbers with the same seed, for the parts of a path that must not be stratified.
    #[must_use]
    pub fn as_random(&self) -> Self {
        Self { kind: Kind::Random, ..self.clone() }
    }

    fn key(&self, stream: u64, dimension: u32) -> u64 {
        mix64(self.seed ^ mix64(stream.wrapping_mul(GOLDEN).wrapping_add(u64::from(dimension))))
    }

    /// Writes to `out` the numbers of the samples `first`, `first + 1`, and so on, of `stream` in `dimension`.
    pub fn fill(&self, isa: Isa, stream: u64, first: u64, dimension: u32, out: &mut [f64]) {
        if let Kind::Stratified(strata) = self.kind {
            return fill_strata(self.key(stream, dimension), first, strata, out);
        }
        if self.kind == Kind::Random || dimension as usize >= SOBOL_DIMENSIONS {
            isa.run(FillRandom { key: self.key(stream, dimension), first, out });
            return;
        }
        let d = dimension as usize;
        if self.kind == Kind::Lattice {
            let Some(step) = LATTICE.get(d).copied() else {
                return isa.run(FillRandom { key: self.key(stream, dimension), first, out });
            };
            return isa.run(FillLattice { step, key: self.key(stream, dimension), first, out });
        }
        self.fill_sobol(isa, std::iter::once(SampleSpan { stream, first, count: out.len() }), d, out);
    }

    /// Writes the numbers of several runs of samples one after the other, each as [`Numbers::fill_rotated`] writes it.
    ///
    /// # Panics
    /// If `out` has no room for all of them.
    pub fn fill_spans(
        &self,
        isa: Isa,
        stretches: impl Iterator<Item = SampleSpan>,
        group: u32,
        dimension: u32,
        out: &mut [f64],
    ) {
        if self.kind == Kind::Sobol && group <= 1 && (dimension as usize) < SOBOL_DIMENSIONS {
            return self.fill_sobol(isa, stretches, dimension as usize, out);
        }
        let mut rest = out;
        for SampleSpan { stream, first, count } in stretches {
            let (now, later) = rest.split_at_mut(count);
            self.fill_rotated(isa, stream, first, group, dimension, now);
            rest = later;
        }
    }

    /// Writes the Sobol numbers of several runs. A pixel has few samples, so points and keys of many runs are gathered and
    /// scrambled together.
    fn fill_sobol(&self, isa: Isa, stretches: impl Iterator<Item = SampleSpan>, d: usize, out: &mut [f64]) {
        let (mut points, mut keys, mut gathered, mut written) = ([0_u32; TOGETHER], [0_u32; TOGETHER], 0, 0);
        let scramble = |points: &[u32], keys: &[u32], out: &mut [f64]| {
            if d == Dimension::Wavelength as usize {
                isa.run(ScrambleMirrored { points, keys, out });
            } else {
                isa.run(Scramble { points, keys, out });
            }
        };
        for SampleSpan { stream, first, count } in stretches {
            let (mut at, end) = (first, first + count as u64);
            while at < end {
                // One aligned block of 256 points shares all but the low eight bits of the index.
                let start = (at & 0xff) as usize;
                let many = (256 - start).min((end - at) as usize).min(TOGETHER - gathered);
                let block = at >> 32; // beyond 2^32 samples: another scrambling of the same points
                let key = self.key(stream ^ block.wrapping_mul(0xd1b5_4a32_d192_ed03), d as u32) as u32;
                let high = point_reversed(COORDINATE[d], (at as u32) & !0xff);
                let now = gathered..gathered + many;
                for (point, low) in points[now.clone()].iter_mut().zip(&self.low[d][start..start + many]) {
                    *point = low ^ high;
                }
                keys[now].fill(key);
                (gathered, at) = (gathered + many, at + many as u64);
                if gathered == TOGETHER {
                    scramble(&points, &keys, &mut out[written..written + TOGETHER]);
                    (gathered, written) = (0, written + TOGETHER);
                }
            }
        }
        scramble(&points[..gathered], &keys[..gathered], &mut out[written..written + gathered]);
    }

    /// Writes numbers that `group` consecutive samples share, rotated among them: sample i has number i / group, shifted by (i
    /// mod group) / group around [0, 1). A group covers [0, 1) evenly. Each of its numbers is as uniform as the shared one, and
    /// each is still a function of (seed, stream, sample, dimension). A group of 1 (or 0) is [`Numbers::fill`].
    pub fn fill_rotated(&self, isa: Isa, stream: u64, first: u64, group: u32, dimension: u32, out: &mut [f64]) {
        if group <= 1 {
            return self.fill(isa, stream, first, dimension, out);
        }
        let size = u64::from(group);
        let (Some(last), base) = (out.len().checked_sub(1), first / size) else { return };
        let at = |i: usize| first.wrapping_add(i as u64);
        let groups = (at(last) / size - base) as usize + 1;
        self.fill(isa, stream, base, dimension, &mut out[..groups]);
        // From the end, because the number of a group stands at or before the samples of that group.
        for i in (0..out.len()).rev() {
            let moved = out[(at(i) / size - base) as usize] + (at(i) % size) as f64 / f64::from(group);
            out[i] = if moved < 1.0 { moved } else { moved - 1.0 };
        }
    }

    /// Returns the number of one sample, equal to the one that [`Numbers::fill`] writes.
    #[must_use]
    pub fn one(&self, stream: u64, sample: u64, dimension: u32) -> f64 {
        let mut out = [0.0];
        self.fill(Isa::Baseline, stream, sample, dimension, &mut out);
        out[0]
    }
}

/// Writes one number in each of `strata` parts, block by block.
fn fill_strata(key: u64, first: u64, strata: u32, out: &mut [f64]) {
    const BELOW_ONE: f64 = 1.0 - 0.5 * f64::EPSILON;
    let many = u64::from(strata);
    let (mut block, mut order) = (None, 0);
    for (i, out) in out.iter_mut().enumerate() {
        let sample = first.wrapping_add(i as u64);
        if block != Some(sample / many) {
            block = Some(sample / many);
            // The order of one block is independent of that of the next, and of the jitter.
            order = mix64(key ^ mix64((sample / many).wrapping_add(0x0bad_0def_ace5_0f0a)));
        }
        let stratum = shuffled((sample % many) as u32, strata, order);
        let jitter = unit_from_u64(mix64(key.wrapping_add(sample.wrapping_mul(GOLDEN))));
        *out = ((f64::from(stratum) + jitter) / f64::from(strata)).min(BELOW_ONE);
    }
}

/// Returns the position of item `at` of `many` in a permutation that `key` selects; no two items get the same position. Applies
/// invertible steps on as many bits as `many` needs, and repeats them while the position is out of range. This walk stays on
/// one cycle of a permutation, so no position occurs twice.
fn shuffled(at: u32, many: u32, key: u64) -> u32 {
    let bits = 32 - (many - 1).leading_zeros();
    if bits == 0 {
        return 0;
    }
    let mask = u32::MAX >> (32 - bits);
    let shift = bits.div_ceil(2);
    let (a, b) = (key as u32, (key >> 32) as u32);
    let mut x = at;
    loop {
        for round in 0..4_u32 {
            x ^= a.rotate_left(9 * round) & mask;
            x = x.wrapping_mul(0x9e37_79b1 ^ (b.rotate_left(7 * round) & !1)) & mask;
            x ^= x >> shift;
            x = x.wrapping_add(b.rotate_left(11 * round)) & mask;
        }
        if x < many {
            return x;
        }
    }
}

struct FillRandom<'a> {
    key: u64,
    first: u64,
    out: &'a mut [f64],
}

impl Vectorized for FillRandom<'_> {
    type Output = ();
    #[inline(always)]
    fn run(self) {
        for (i, out) in self.out.iter_mut().enumerate() {
            let sample = self.first.wrapping_add(i as u64);
            *out = unit_from_u64(mix64(self.key.wrapping_add(sample.wrapping_mul(GOLDEN))));
        }
    }
}

struct FillLattice<'a> {
    step: u32,
    key: u64,
    first: u64,
    out: &'a mut [f64],
}

impl Vectorized for FillLattice<'_> {
    type Output = ();
    #[inline(always)]
    fn run(self) {
        for (i, out) in self.out.iter_mut().enumerate() {
            let sample = self.first.wrapping_add(i as u64);
            // Beyond 2^32 samples: another shift of the same points.
            let shift = (self.key ^ (sample >> 32).wrapping_mul(GOLDEN)) as u32;
            *out = unit_from_u32((sample as u32).reverse_bits().wrapping_mul(self.step).wrapping_add(shift));
        }
    }
}

/// A run of consecutive samples of a stream.
#[derive(Clone, Copy, Debug)]
pub struct SampleSpan {
    /// Number of the stream.
    pub stream: u64,
    /// First sample of the run.
    pub first: u64,
    /// Number of samples.
    pub count: usize,
}

/// Number of points that are scrambled together.
const TOGETHER: usize = 256;

/// Scrambles points into numbers, each with its own key. The bits of the points are reversed.
struct Scramble<'a> {
    points: &'a [u32],
    keys: &'a [u32],
    out: &'a mut [f64],
}

impl Vectorized for Scramble<'_> {
    type Output = ();
    #[inline(always)]
    fn run(self) {
        for ((out, point), key) in self.out.iter_mut().zip(self.points).zip(self.keys) {
            *out = unit_from_u32(owen_scramble_reversed(*point, *key));
        }
    }
}

/// Number of bits of a [`ScrambleMirrored`] number that are scrambled, which gives 64 strata. With 32 strata, wavelength and
/// pupil together are less even (a picture takes 1.07 times as many samples for the same noise). With 256, little is gained
/// before there are as many samples.
const SCRAMBLED_BITS: u32 = 6;

/// Scrambles points into numbers by strata only. The place within the stratum is common to all strata, mirrored from each to
/// the next. The error that the slope of a smooth function causes in one stratum thus cancels in its neighbor. With fewer than
/// 64 samples the numbers are as even as others.
struct ScrambleMirrored<'a> {
    points: &'a [u32],
    keys: &'a [u32],
    out: &'a mut [f64],
}

impl Vectorized for ScrambleMirrored<'_> {
    type Output = ();
    #[inline(always)]
    fn run(self) {
        const INNER: u32 = u32::MAX >> SCRAMBLED_BITS;
        for ((out, point), key) in self.out.iter_mut().zip(self.points).zip(self.keys) {
            let stratum = owen_scramble_reversed(*point, *key);
            let mirror = 0_u32.wrapping_sub((stratum >> (32 - SCRAMBLED_BITS)) & 1);
            let place = point.reverse_bits() ^ mix64(u64::from(*key)) as u32 ^ mirror;
            *out = unit_from_u32((stratum & !INNER) | (place & INNER));
        }
    }
}

/// A random number generator that belongs to one event of one ray; see [`RayNumbers::generator`].
#[derive(Clone, Debug)]
pub struct SampleRng {
    state: u64,
}

impl rand::rand_core::TryRng for SampleRng {
    type Error = std::convert::Infallible;

    fn try_next_u32(&mut self) -> Result<u32, Self::Error> {
        self.try_next_u64().map(|x| (x >> 32) as u32)
    }

    fn try_next_u64(&mut self) -> Result<u64, Self::Error> {
        self.state = self.state.wrapping_add(GOLDEN);
        Ok(mix64(self.state))
    }

    fn try_fill_bytes(&mut self, dst: &mut [u8]) -> Result<(), Self::Error> {
        for chunk in dst.chunks_mut(8) {
            let bytes = self.try_next_u64()?.to_le_bytes();
            chunk.copy_from_slice(&bytes[..chunk.len()]);
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn closed_forms_of_sobol_coordinates_are_those_of_the_table() {
        for coordinate in 0..SOBOL_DIMENSIONS {
            for index in (0..4096).chain((0..4096).map(|i: u32| i.wrapping_mul(0x9e37_79b9))) {
                assert_eq!(
                    point_reversed(coordinate, index),
                    by_directions(coordinate, index),
                    "{coordinate}, {index}"
                );
            }
        }
    }

    #[test]
    fn numbers_do_not_depend_on_the_cut_or_the_tier() {
        for numbers in [Numbers::sobol(7), Numbers::random(7), Numbers::stratified(7, 100)] {
            for dimension in [0, 3, 11] {
                let mut whole = vec![0.0; 1000];
                numbers.fill(Isa::Baseline, 42, 100, dimension, &mut whole);
                for isa in Isa::available() {
                    let mut parts = vec![0.0; 1000];
                    let (a, b) = parts.split_at_mut(333);
                    numbers.fill(isa, 42, 100, dimension, a);
                    numbers.fill(isa, 42, 433, dimension, b);
                    assert_eq!(parts, whole);
                }
                assert_eq!(numbers.one(42, 555, dimension), whole[455]);
                assert!(whole.iter().all(|v| (0.0..1.0).contains(v)));
            }
        }
    }

    /// One of n numbers in each of n strata, for any n, in every block and every dimension.
    #[test]
    fn strata_hold_one_number_each() {
        for strata in [1, 2, 3, 7, 64, 100, 1000] {
            for (stream, dimension) in [(0, 0), (5, 0), (5, 1), (9, 11)] {
                let n = strata as usize;
                let mut u = vec![0.0; 3 * n];
                Numbers::stratified(3, strata).fill(Isa::detect(), stream, u64::from(strata), dimension, &mut u);
                for block in u.chunks_exact(n) {
                    let mut seen = vec![0; n];
                    block.iter().for_each(|v| seen[(v * n as f64) as usize] += 1);
                    assert!(seen.iter().all(|s| *s == 1), "{strata} {seen:?}");
                }
            }
        }
    }

    /// Every stratum is equally likely for every sample, and dimensions are independent: over 20 000 streams, chi-square of 16
    /// strata below its 0.999 quantile (37.7), and correlation within four standard errors.
    #[test]
    fn orders_of_strata_are_random() {
        let numbers = Numbers::stratified(11, 16);
        let streams = 20_000;
        let column = |sample, dimension| (0..streams).map(|s| numbers.one(s, sample, dimension)).collect::<Vec<_>>();
        let n = streams as f64;
        for sample in [0, 5, 15] {
            let mut counts = [0.0; 16];
            column(sample, 0).iter().for_each(|u| counts[(u * 16.0) as usize] += 1.0);
            let chi2: f64 = counts.iter().map(|c| (c - n / 16.0) * (c - n / 16.0) / (n / 16.0)).sum();
            assert!(chi2 < 37.7, "{sample}: {chi2}");
        }
        let (a, b) = (column(3, 0), column(3, 1));
        let c: f64 = a.iter().zip(&b).map(|(x, y)| (x - 0.5) * (y - 0.5)).sum::<f64>() / n * 12.0;
        assert!(c.abs() < 4.0 / n.sqrt(), "{c}");
        // Two samples of one block are apart on the average: -1/(n - 1) of the strata's variance.
        let d = column(4, 0);
        let c: f64 = a.iter().zip(&d).map(|(x, y)| (x - 0.5) * (y - 0.5)).sum::<f64>() / n * 12.0;
        assert!((c + 1.0 / 15.0).abs() < 4.0 / n.sqrt(), "{c}");
    }

    /// Rotated numbers depend on the sample alone, and a group is evenly spaced.
    #[test]
    fn rotated_numbers_do_not_depend_on_the_cut_and_cover_evenly() {
        for numbers in [Numbers::sobol(7), Numbers::lattice(7), Numbers::random(7)] {
            for group in [1, 2, 3, 4, 7, 1000] {
                let mut whole = vec![0.0; 1000];
                numbers.fill_rotated(Isa::Baseline, 42, 0, group, 0, &mut whole);
                for isa in Isa::available() {
                    for cut in [1, 2, 5, 333, 999] {
                        let mut parts = vec![0.0; 1000];
                        let (a, b) = parts.split_at_mut(cut);
                        numbers.fill_rotated(isa, 42, 0, group, 0, a);
                        numbers.fill_rotated(isa, 42, cut as u64, group, 0, b);
                        assert_eq!(parts, whole, "{group} {cut}");
                    }
                }
                assert_eq!(whole[0], numbers.one(42, 0, 0));
                for (g, comb) in whole.chunks_exact(group as usize).enumerate() {
                    let mut comb = comb.to_vec();
                    assert_eq!(comb[0], numbers.one(42, g as u64, 0));
                    comb.sort_by(f64::total_cmp);
                    let step = 1.0 / f64::from(group);
                    assert!(comb.windows(2).all(|w| (w[1] - w[0] - step).abs() < 1e-15));
                    assert!(comb[0] >= 0.0 && comb[comb.len() - 1] < 1.0);
                }
            }
        }
        Numbers::sobol(1).fill_rotated(Isa::Baseline, 0, 5, 4, 0, &mut []);
    }

    /// A (0, m, 1)-net in base 2: of 2^m points, one lies in each of 2^m equal intervals, also after scrambling.
    #[test]
    fn sobol_points_are_stratified_in_each_dimension() {
        for stream in 0..20 {
            let numbers = Numbers::sobol(3);
            for d in 0..SOBOL_DIMENSIONS as u32 {
                let mut u = vec![0.0; 1024];
                numbers.fill(Isa::detect(), stream, 2048, d, &mut u);
                let mut seen = vec![0; 1024];
                u.iter().for_each(|v| seen[(v * 1024.0) as usize] += 1);
                assert!(seen.iter().all(|s| *s == 1), "dimension {d}");
            }
        }
    }

    /// Every power of two of points has one in each of as many equal parts, in each dimension, and each point is uniform over seeds.
    #[test]
    fn lattice_points_are_stratified_in_each_dimension() {
        for stream in 0..20 {
            for d in 0..LATTICE.len() as u32 {
                for many in [16_usize, 256, 1024] {
                    let mut u = vec![0.0; many];
                    Numbers::lattice(3).fill(Isa::detect(), stream, 4 * many as u64, d, &mut u);
                    let mut seen = vec![0; many];
                    u.iter().for_each(|v| seen[(v * many as f64) as usize] += 1);
                    assert!(seen.iter().all(|s| *s == 1), "dimension {d}");
                }
            }
        }
        let mean = (0..4096).map(|seed| Numbers::lattice(seed).one(7, 5, 3)).sum::<f64>() / 4096.0;
        assert!((mean - 0.5).abs() < 4.0 * (1.0_f64 / 12.0 / 4096.0).sqrt(), "{mean}");
    }

    /// The first two coordinates, of the wavelength and of the pupil, form a (0, 2, 2)-net: every elementary interval of 2^m points
    /// contains one.
    #[test]
    fn first_pair_is_a_net() {
        let numbers = Numbers::sobol(9);
        let (mut u, mut v) = (vec![0.0; 256], vec![0.0; 256]);
        numbers.fill(Isa::detect(), 5, 0, 0, &mut u);
        numbers.fill(Isa::detect(), 5, 0, Dimension::PupilU as u32, &mut v);
        for a in 0..=8 {
            let (nu, nv) = (1 << a, 1 << (8 - a));
            let mut seen = vec![0; 256];
            for i in 0..256 {
                seen[(u[i] * nu as f64) as usize * nv + (v[i] * nv as f64) as usize] += 1;
            }
            assert!(seen.iter().all(|s| *s == 1), "{nu} x {nv}");
        }
    }

    /// The mean of a straight line over 64, 128 and 256 wavelengths' numbers is exact but for rounding, and each number is uniform over
    /// seeds.
    #[test]
    fn wavelengths_are_mirrored_between_strata() {
        for stream in 0..20 {
            for many in [64_usize, 128, 256] {
                let mut u = vec![0.0; many];
                Numbers::sobol(3).fill(Isa::detect(), stream, 4 * many as u64, 0, &mut u);
                let mean = u.iter().sum::<f64>() / many as f64;
                assert!((mean - 0.5).abs() < 1e-9, "{many} of stream {stream}: {mean}");
            }
        }
        let (mut mean, mut square) = (0.0, 0.0);
        for seed in 0..4096 {
            let u = Numbers::sobol(seed).one(7, 5, 0) - 0.5;
            (mean, square) = (mean + u / 4096.0, square + u * u / 4096.0);
        }
        assert!(mean.abs() < 4.0 * (1.0_f64 / 12.0 / 4096.0).sqrt(), "{mean}");
        assert!((square - 1.0 / 12.0).abs() < 4.0 * (1.0_f64 / 180.0 / 4096.0).sqrt(), "{square}");
    }

    /// Mean and variance of a uniform variate, and no correlation between neighboring streams and dimensions.
    #[test]
    fn random_numbers_are_uniform_and_uncorrelated() {
        let n = 200_000;
        let numbers = Numbers::random(1);
        let mut columns = Vec::new();
        for (stream, dimension) in [(0, 0), (0, 1), (1, 0)] {
            let mut u = vec![0.0; n];
            numbers.fill(Isa::detect(), stream, 0, dimension, &mut u);
            columns.push(u);
        }
        let se = (1.0 / 12.0 / n as f64).sqrt();
        for u in &columns {
            let mean = u.iter().sum::<f64>() / n as f64;
            assert!((mean - 0.5).abs() < 4.0 * se, "{mean}");
        }
        for (a, b) in [(0, 1), (0, 2)] {
            let c: f64 =
                columns[a].iter().zip(&columns[b]).map(|(x, y)| (x - 0.5) * (y - 0.5)).sum::<f64>() / n as f64 * 12.0;
            assert!(c.abs() < 4.0 / (n as f64).sqrt(), "{c}");
        }
    }
}
