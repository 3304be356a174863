//! Exact sums in 64-bit fixed point, so that the order of adding cannot matter.

use spectra_core::batch::pixel_and_channel;
use std::hint::black_box;
use std::ops::Range;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicI64, Ordering::Relaxed};

/// Number of bits for the largest contribution that a pilot run saw. With 2^32 of them in one pixel the sum stays within 62 bits; rounding
/// is 2^-30 of that contribution.
const BITS_OF_LARGEST: i32 = 29;
/// The largest contribution that is expected, scaled to integers.
pub(crate) const LARGEST_EXPECTED: f64 = (1_u64 << BITS_OF_LARGEST) as f64;
/// Limit below which the sum of a cell must stay.
const LIMIT: u64 = 1 << 62;
/// Limit below which one contribution must stay so that its rounding is exact.
pub(crate) const LARGEST_CONTRIBUTION: f64 = (1_u64 << 50) as f64;

/// Number of rays of a pilot batch: the brightest of them sets the scale.
pub(crate) const PILOT_RAYS: u32 = 4096;

/// Returns the scale for contributions whose largest is about `largest`: a power of two, so that scaling is exact.
pub(crate) fn scale_for(largest: f64) -> f64 {
    if !(largest.is_finite() && largest > 0.0) {
        return 1.0;
    }
    let exponent = libm::ilogb(largest) + 1;
    libm::ldexp(1.0, BITS_OF_LARGEST - exponent)
}

/// Rounds a scaled value to the nearest integer, ties to even, by the same operations on every instruction set. Also returns whether it
/// fits.
#[inline(always)]
pub(crate) fn rounded(scaled: f64) -> (i64, bool) {
    // Adding 1.5 * 2^52 leaves the integer in the low bits.
    const MAGIC: f64 = 6_755_399_441_055_744.0;
    const BITS: i64 = MAGIC.to_bits() as i64;
    ((scaled + MAGIC).to_bits() as i64 - BITS, scaled.abs() < LARGEST_CONTRIBUTION)
}

/// Work that rounds values times a scale with [`rounded`].
#[cfg(test)]
pub(crate) struct Round<'a> {
    pub values: &'a [f64],
    pub scale: f64,
    pub out: &'a mut [i64],
}

#[cfg(test)]
impl spectra_core::isa::Vectorized for Round<'_> {
    /// Whether every value fits.
    type Output = bool;
    #[inline(always)]
    fn run(self) -> bool {
        let mut good = true;
        for (value, out) in self.values.iter().zip(self.out) {
            let (whole, fits) = rounded(value * self.scale);
            *out = whole;
            good &= fits;
        }
        good
    }
}

/// The sums of an estimator, one integer for each pixel and channel, shared by all threads.
pub struct ExactSums {
    cells: Vec<AtomicI64>,
    overflow: AtomicBool,
}

impl ExactSums {
    /// Allocates sums of 0; `None` if there is not enough memory.
    pub(crate) fn new(cells: usize) -> Option<Self> {
        let mut all = Vec::new();
        all.try_reserve_exact(cells).ok()?;
        all.extend((0..cells).map(|_| AtomicI64::new(0)));
        Some(Self { cells: all, overflow: AtomicBool::new(false) })
    }

    /// Adds an integer to a cell. The cells of a pixel are its recorded channels, one after the other; the pixels follow row by row.
    /// A sum that reaches 2^62 ends the render with [`RenderError::Overflow`](crate::RenderError::Overflow).
    ///
    /// # Panics
    /// If there is no such cell.
    #[inline(always)]
    pub fn add(&self, cell: usize, value: i64) {
        let old = self.cells[cell].fetch_add(value, Relaxed);
        if old.unsigned_abs() >= LIMIT {
            self.overflow.store(true, Relaxed);
        }
    }

    /// Adds the contributions of rays to the cells that begin at `first`: to the pixel that each ray's tag names, one integer per channel.
    pub(crate) fn add_rays(&self, first: usize, tags: &[u32], integers: &[Vec<i64>], recorded: &[usize]) {
        for start in (0..tags.len()).step_by(AHEAD) {
            let rays = start..(start + AHEAD).min(tags.len());
            look_ahead(&tags[rays.clone()], integers.len(), |cell| self.get(first + cell));
            each(tags, integers, recorded, rays, |cell, value| self.add(first + cell, value));
        }
    }

    /// Adds what one thread summed for a cell.
    fn merge(&self, cell: usize, value: i64) {
        let old = self.cells[cell].fetch_add(value, Relaxed);
        if old.unsigned_abs() >= LIMIT || old.wrapping_add(value).unsigned_abs() >= LIMIT {
            self.overflow.store(true, Relaxed);
        }
    }

    pub(crate) fn get(&self, cell: usize) -> i64 {
        self.cells[cell].load(Relaxed)
    }

    /// Number of cells.
    pub(crate) fn cells(&self) -> usize {
        self.cells.len()
    }

    pub(crate) fn overflowed(&self) -> bool {
        self.overflow.load(Relaxed)
    }
}

/// Largest number of cells for which each thread keeps its own sums: 8 MB. An atomic addition takes as long as twenty plain ones, but for
/// larger frames both wait for memory.
const MOST_OWN: usize = 1 << 20;
/// Largest number of cells for which each thread keeps its own steps, if each ray adds to many cells: 100 MB.
const MOST_STEPS: usize = 1 << 23;
/// Upper limit on the rest that the shares of one ray leave, which is less than the number of pixels of its footprint.
const MOST_REST: i32 = 1 << 10;
/// Value at which a thread's own cell is added to the shared one, which stays below [`LIMIT`] then.
const OWN_LIMIT: u64 = 1 << 60;

/// Number of rays after which a cell that was below [`OWN_LIMIT`] is still below [`LIMIT`], whatever the rays bring.
const MOST_RAYS: usize = 1 << 11;

/// Calls `add` with the cell and the integer for each of some rays and each channel that it adds to.
#[inline(always)]
fn each(tags: &[u32], integers: &[Vec<i64>], recorded: &[usize], rays: Range<usize>, mut add: impl FnMut(usize, i64)) {
    for i in rays {
        let (pixel, only) = pixel_and_channel(tags[i]);
        let cell = pixel as usize * integers.len();
        for (channel, integers) in integers.iter().enumerate() {
            if only.is_none_or(|only| only as usize == recorded[channel]) {
                add(cell + channel, integers[i]);
            }
        }
    }
}

/// Number of rays whose cells are loaded before any is added to. Pixels lie far apart in memory, and additions would wait for it one by
/// one.
const AHEAD: usize = 32;

/// Loads the first cell of each of some rays into the cache.
#[inline(always)]
fn look_ahead(tags: &[u32], channels: usize, cell: impl Fn(usize) -> i64) {
    let cells = tags.iter().map(|tag| cell(pixel_and_channel(*tag).0 as usize * channels));
    black_box(cells.fold(0, |all, cell| all | cell));
}

/// Adds `N` channels of some rays. Returns the bitwise or of the magnitudes that the cells reached.
#[inline(always)]
fn add_all<const N: usize>(cells: &mut [i64], tags: &[u32], integers: [&Vec<i64>; N], rays: Range<usize>) -> u64 {
    let mut most = 0;
    for start in rays.clone().step_by(AHEAD) {
        let rays = start..(start + AHEAD).min(rays.end);
        let (tags, integers) = (&tags[rays.clone()], integers.map(|column| &column[rays.clone()]));
        look_ahead(tags, N, |cell| cells[cell]);
        for (i, tag) in tags.iter().enumerate() {
            let first = *tag as usize * N;
            for (cell, column) in cells[first..first + N].iter_mut().zip(integers) {
                *cell += column[i];
                most |= cell.unsigned_abs();
            }
        }
    }
    most
}

/// The sums of one thread until it adds them to the shared ones. They are integers, so it does not matter when.
pub(crate) struct OwnSums {
    cells: Vec<i64>,
}

impl OwnSums {
    /// Allocates sums of 0; `None` if the frame is too large or there is not enough memory.
    pub(crate) fn new(cells: usize) -> Option<Self> {
        if cells > MOST_OWN {
            return None;
        }
        let mut all = Vec::new();
        all.try_reserve_exact(cells).ok()?;
        all.resize(cells, 0);
        Some(Self { cells: all })
    }

    /// Adds the contributions of rays: to the pixel that each ray's tag names, one integer per channel, each below
    /// [`LARGEST_CONTRIBUTION`]. `recorded` holds the numbers of the channels, for rays that add to one only.
    pub(crate) fn add(&mut self, tags: &[u32], integers: &[Vec<i64>], recorded: &[usize], sums: &ExactSums) {
        for start in (0..tags.len()).step_by(MOST_RAYS) {
            let rays = start..(start + MOST_RAYS).min(tags.len());
            let all = tags[rays.clone()].iter().all(|tag| pixel_and_channel(*tag).1.is_none());
            let most = match (integers, all) {
                ([a], true) => add_all(&mut self.cells, tags, [a], rays),
                ([a, b], true) => add_all(&mut self.cells, tags, [a, b], rays),
                ([a, b, c], true) => add_all(&mut self.cells, tags, [a, b, c], rays),
                ([a, b, c, d], true) => add_all(&mut self.cells, tags, [a, b, c, d], rays),
                _ => {
                    let mut most = 0;
                    each(tags, integers, recorded, rays, |cell, value| {
                        self.cells[cell] += value;
                        most |= self.cells[cell].unsigned_abs();
                    });
                    most
                }
            };
            if most >= OWN_LIMIT {
                self.give(sums);
            }
        }
    }

    /// Adds these sums to the shared ones and clears them.
    pub(crate) fn give(&mut self, sums: &ExactSums) {
        for (cell, value) in self.cells.iter_mut().enumerate().filter(|(_, value)| **value != 0) {
            sums.merge(cell, std::mem::take(value));
        }
    }
}

/// The sums of one thread if rays add the same value to boxes of pixels. They are kept as differences from each pixel to the next, along
/// rows and columns, so that a box takes four additions per channel, however large it is.
pub(crate) struct OwnSteps {
    /// The differences: one more column and one more row than there are pixels.
    steps: Vec<i64>,
    /// Number of columns and rows.
    frame: [usize; 2],
    channels: usize,
    /// The one channel of each pixel of a mosaic; `None` if pixels have all channels.
    filters: Option<Arc<[u8]>>,
    /// What single pixels got in addition: less than [`MOST_REST`] per ray.
    rest: Vec<i32>,
    /// The most that any cell can have got since the sums were last added to the shared ones.
    most: u64,
    /// Number of rays since the sums were last added to the shared ones.
    rays: i32,
}

impl OwnSteps {
    /// Whether a frame is small enough for sums of this kind.
    pub(crate) fn suit([columns, rows]: [usize; 2], channels: usize) -> bool {
        (columns + 1) * (rows + 1) * channels <= MOST_STEPS
    }

    /// Allocates sums of 0; `None` if the frame is too large or there is not enough memory.
    pub(crate) fn new(frame: [usize; 2], channels: usize, filters: Option<Arc<[u8]>>) -> Option<Self> {
        if !Self::suit(frame, channels) {
            return None;
        }
        let many = (frame[0] + 1) * (frame[1] + 1) * channels;
        let (mut steps, mut rest) = (Vec::new(), Vec::new());
        steps.try_reserve_exact(many).ok()?;
        steps.resize(many, 0);
        rest.try_reserve_exact(frame[0] * frame[1] * channels).ok()?;
        rest.resize(frame[0] * frame[1] * channels, 0);
        Some(Self { steps, frame, channels, filters, rest, most: 0, rays: 0 })
    }

    /// Makes room for a ray that brings at most `most` to any cell: adds the sums to the shared ones if they could overflow.
    #[inline]
    pub(crate) fn make_room(&mut self, most: u64, sums: &ExactSums) {
        self.most += most;
        self.rays += 1;
        if self.most >= OWN_LIMIT || self.rays > i32::MAX / MOST_REST {
            self.give(sums);
            (self.most, self.rays) = (most, 1);
        }
    }

    /// Adds to a pixel the rest that the shares of a ray leave, one integer per channel.
    #[inline]
    pub(crate) fn add_rest(&mut self, pixel: usize, rest: &[i64]) {
        let at = pixel * self.channels;
        let cells = self.rest[at..at + self.channels].iter_mut();
        cells.zip(rest).for_each(|(cell, rest)| *cell += *rest as i32);
    }

    /// Adds the same values to each pixel of a box (first and last column, first and last row), one integer per channel.
    #[inline]
    pub(crate) fn add_box(&mut self, [[left, right], [low, high]]: [[usize; 2]; 2], shares: &[i64]) {
        match *shares {
            [a] => self.add_box_of([a], left..right + 1, low..high + 1),
            [a, b, c] => self.add_box_of([a, b, c], left..right + 1, low..high + 1),
            [a, b, c, d] => self.add_box_of([a, b, c, d], left..right + 1, low..high + 1),
            _ => {
                for (channel, share) in shares.iter().enumerate() {
                    for (row, share) in [(low, *share), (high + 1, -share)] {
                        let at = |column: usize| (row * (self.frame[0] + 1) + column) * self.channels + channel;
                        let (first, behind) = (at(left), at(right + 1));
                        self.steps[first] += share;
                        self.steps[behind] -= share;
                    }
                }
            }
        }
    }

    /// Adds the same values to each pixel of a box, for a number of channels that is known to the compiler.
    #[inline]
    fn add_box_of<const CHANNELS: usize>(
        &mut self,
        shares: [i64; CHANNELS],
        columns: Range<usize>,
        rows: Range<usize>,
    ) {
        let (cells, _) = self.steps.as_chunks_mut::<CHANNELS>();
        for (row, sign) in [(rows.start, 1), (rows.end, -1)] {
            let first = row * (self.frame[0] + 1);
            for (column, sign) in [(columns.start, sign), (columns.end, -sign)] {
                let cell = &mut cells[first + column];
                (0..CHANNELS).for_each(|channel| cell[channel] += sign * shares[channel]);
            }
        }
    }

    /// Adds these sums to the shared ones and clears them. In a mosaic each pixel keeps only its own channel.
    pub(crate) fn give(&mut self, sums: &ExactSums) {
        let [columns, rows] = self.frame;
        let (row, channels) = ((columns + 1) * self.channels, self.channels);
        // Differences along a row, summed over all rows so far.
        let mut along = vec![0_i64; row];
        for (at, steps) in self.steps.chunks_exact_mut(row).enumerate() {
            along.iter_mut().zip(steps).for_each(|(along, step)| *along += std::mem::take(step));
            if at == rows {
                break;
            }
            for channel in 0..channels {
                let mut value = 0;
                for column in 0..columns {
                    value += along[column * channels + channel];
                    let pixel = at * columns + column;
                    let cell = pixel * channels + channel;
                    let has = self.filters.as_ref().is_none_or(|filters| usize::from(filters[pixel]) == channel);
                    let whole = value + i64::from(std::mem::take(&mut self.rest[cell]));
                    if whole != 0 && has {
                        sums.merge(cell, whole);
                    }
                }
            }
        }
        (self.most, self.rays) = (0, 0);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use spectra_core::Isa;
    use std::slice::from_ref;

    #[test]
    fn rounding_is_to_nearest_even_on_every_tier() {
        let values = [0.0, 0.4, 0.5, 1.5, 2.5, -0.5, -1.5, 1e9 + 0.3, -7e13];
        for isa in Isa::available() {
            let mut out = [0; 9];
            assert!(isa.run(Round { values: &values, scale: 1.0, out: &mut out }));
            assert_eq!(out, [0, 0, 0, 2, 2, 0, -2, 1_000_000_000, -70_000_000_000_000]);
        }
        let mut out = [0; 1];
        for bad in [f64::NAN, f64::INFINITY, 1e300] {
            assert!(!Isa::detect().run(Round { values: &[bad], scale: 1.0, out: &mut out }));
        }
    }

    #[test]
    fn scale_leaves_room_and_is_a_power_of_two() {
        for largest in [1e-20, 0.3, 1.0, 77.0, 1e12] {
            let scale = scale_for(largest);
            assert_eq!(libm::frexp(scale).0, 0.5);
            let top = largest * scale;
            assert!((2_f64.powi(28)..=2_f64.powi(29)).contains(&top), "{top}");
        }
        assert_eq!(scale_for(0.0), 1.0);
    }

    #[test]
    fn overflow_is_noticed() {
        let sums = ExactSums::new(1).expect("memory");
        // Four values reach the limit exactly; the next addition finds the sum there.
        for _ in 0..4 {
            sums.add(0, 1 << 60);
        }
        assert!(!sums.overflowed());
        sums.add(0, 1);
        assert!(sums.overflowed());
    }

    #[test]
    fn sums_of_threads_add_up_and_none_overflows_unseen() {
        for channels in [1, 2, 3, 4, 5] {
            let (sums, want) =
                (ExactSums::new(7 * channels).expect("memory"), ExactSums::new(7 * channels).expect("memory"));
            let beside = ExactSums::new(7 * channels + 3).expect("memory");
            let mut own = [0, 1].map(|_| OwnSums::new(7 * channels).expect("small"));
            for k in 0..50 {
                let tags: Vec<u32> =
                    (0..90).map(|i| tag(i * 31 % 7, (k % 3 == 0 && i % 5 == 0).then_some(0))).collect();
                let of = |c: usize| (0..90).map(|i| (i * 7919 + k * 31) % 1009 - 400 + c as i64).collect();
                let integers: Vec<Vec<i64>> = (0..channels).map(of).collect();
                let recorded: Vec<usize> = (0..channels).collect();
                own[k as usize % 2].add(&tags, &integers, &recorded, &sums);
                each(&tags, &integers, &recorded, 0..90, |cell, value| want.add(cell, value));
                beside.add_rays(3, &tags, &integers, &recorded);
            }
            // Giving twice must add only once.
            own.iter_mut().for_each(|own| own.give(&sums));
            own[0].give(&sums);
            assert!((0..7 * channels).all(|cell| sums.get(cell) == want.get(cell)), "{channels}");
            assert!((0..7 * channels).all(|cell| beside.get(cell + 3) == want.get(cell)), "{channels}");
            assert!(!sums.overflowed());
        }
        assert!(OwnSums::new(MOST_OWN + 1).is_none());
        let far = ExactSums::new(1).expect("memory");
        let mut own = OwnSums::new(1).expect("small");
        let largest = vec![LARGEST_CONTRIBUTION as i64 - 1; 2 * MOST_RAYS];
        let one = largest[0];
        own.add(&[0; 2 * MOST_RAYS - 1], from_ref(&largest), &[0], &far);
        own.give(&far);
        assert_eq!(far.get(0), (2 * MOST_RAYS as i64 - 1) * one);
        assert!(!far.overflowed());
        own.add(&[0; 2 * MOST_RAYS], from_ref(&largest), &[0], &far);
        assert!(far.overflowed());
    }

    #[test]
    fn boxes_of_pixels_are_kept_as_steps() {
        let (frame, channels) = ([9, 7], 3);
        let filters: Arc<[u8]> = (0..63).map(|pixel| (pixel % 9 % 2 + pixel / 9 % 2) as u8).collect();
        for filters in [None, Some(filters)] {
            let [got, want] = [0, 0].map(|_| ExactSums::new(63 * channels).expect("memory"));
            let mut own = OwnSteps::new(frame, channels, filters.clone()).expect("small");
            for k in 0..200_usize {
                let [left, low] = [k * 5 % 9, k * 3 % 7];
                let pixels = [[left, (left + k % 4).min(8)], [low, (low + k % 3).min(6)]];
                let shares = [k as i64, -(k as i64), 1 << 40];
                own.make_room(1 << 58, &got);
                own.add_box(pixels, &shares);
                let rest = [k as i64 % 7, -(k as i64 % 5), 1];
                own.add_rest(low * 9 + left, &rest);
                for pixel in (0..63).filter(|p| {
                    (pixels[0][0]..=pixels[0][1]).contains(&(p % 9)) && (pixels[1][0]..=pixels[1][1]).contains(&(p / 9))
                }) {
                    let has =
                        |channel: usize| filters.as_ref().is_none_or(|filters| usize::from(filters[pixel]) == channel);
                    (0..channels)
                        .filter(|channel| has(*channel))
                        .for_each(|channel| want.add(pixel * channels + channel, shares[channel]));
                    (0..channels)
                        .filter(|channel| has(*channel) && pixel == low * 9 + left)
                        .for_each(|channel| want.add(pixel * channels + channel, rest[channel]));
                }
            }
            own.give(&got);
            own.give(&got);
            assert!((0..63 * channels).all(|cell| got.get(cell) == want.get(cell)) && !got.overflowed());
        }
        assert!(OwnSteps::new([MOST_STEPS, 1], 1, None).is_none());
    }

    fn tag(pixel: u32, only: Option<u32>) -> u32 {
        only.map_or(pixel, |only| spectra_core::batch::tag_of(pixel, only))
    }
}
