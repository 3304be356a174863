//! Spreads the light of lamps that consist of small spots: each ray stands for its whole spot.
//!
//! A lamp of one pixel of a picture is a spot that fades from its middle. The position in the spot from which a ray starts does not change
//! what the ray carries; it only moves the point where it lands, by as much as the lens magnifies. Rays therefore start in the middle of
//! spots. The light of each ray lands in 13 equal shares, spread evenly over the image of the spot and shifted by a hash of the landing
//! point. In a disk of light out of focus, a pixel then gets the light of more rays, by the ratio of the areas of image and pixel. No
//! additional ray is traced for this, and a lamp of that size blurs its image as much anyway. Light of all wavelengths mixes over the
//! image.
//!
//! The shift that a step in the spot causes is measured: rays are traced from beside the middle through the same points of the plane of the
//! entrance pupil. The shift is smooth over the frame and is described by polynomials of second degree in the place where rays land. If
//! they miss it by more than a tenth, or if the image of a spot is smaller than a pixel, rays start anywhere in a spot instead.

use spectra_core::RayBatch;
use spectra_core::isa::Vectorized;
use spectra_core::linear::least_squares;
use spectra_core::loss::ALIVE;
use spectra_core::numbers::mix64;
use spectra_tracer::{Tracer, Travel};

/// Number of places at which the light of a ray lands: a Fibonacci lattice, shifted at random for each ray.
pub(crate) const PLACES: usize = 13;
/// Generator of the Fibonacci lattice.
const LATTICE: usize = 8;
/// Smallest number of landed rays from which the imaging of spots is measured.
const LEAST: usize = 128;
/// Smallest half width of the image of a spot over which light is spread, pixels.
const SMALLEST: f64 = 0.5;
/// Largest error of the polynomials, as a fraction of the image (root mean square).
const MOST_OFF: f64 = 0.1;
/// Number of terms of the polynomials.
const TERMS: usize = 6;

/// The way in which the lens images spots.
#[derive(Debug)]
pub(crate) struct Spots {
    /// Shift of the landing point to the right and up, mm, for a step by half the width and by half the height of a spot: polynomials in
    /// the place where the ray lands.
    moves: [[[f64; TERMS]; 2]; 2],
}

/// A batch before its light is spread, and the shifts by which each ray's light is spread.
#[derive(Default)]
pub(crate) struct Before {
    /// Positions of the rays, two shifts of the lattice, and the shifts to the right and up for half the width and for half the height of a
    /// spot.
    columns: [Vec<f64>; 9],
    weight: Vec<f64>,
    state: Vec<u64>,
}

#[inline(always)]
fn terms([x, y]: [f64; 2]) -> [f64; TERMS] {
    [1.0, x, y, x * x, x * y, y * y]
}

/// Maps a number in [0, 2), of which only the fractional part counts, to a position distributed as a tent of half width 1 about 0.
#[inline(always)]
fn tent(u: f64) -> f64 {
    let u = if u < 1.0 { u } else { u - 1.0 };
    let (is_left, from_end) = (u < 0.5, if u < 0.5 { u } else { 1.0 - u });
    let inward = 1.0 - (2.0 * from_end).sqrt();
    if is_left { -inward } else { inward }
}

/// Returns the point where a ray meets the image plane, mm.
#[inline(always)]
fn landed(rays: &RayBatch, i: usize) -> [f64; 2] {
    let ([x, y, z], [l, m, n]) = (rays.positions(), rays.directions());
    [x[i] - z[i] / n[i] * l[i], y[i] - z[i] / n[i] * m[i]]
}

impl Spots {
    /// Measures how the lens images spots of this half width and height (mm) on the plane at `source_z_mm`. `start` holds aimed rays from
    /// the middle of some spots; they are traced through the same points of the plane at `through_z_mm`. `None` if the light cannot be
    /// spread.
    pub(crate) fn look(
        half_mm: [f64; 2],
        [source_z_mm, through_z_mm]: [f64; 2],
        start: &RayBatch,
        tracer: &Tracer,
        pixel_mm: f64,
    ) -> Option<Self> {
        let mut work = tracer.work_in_place(start.len());
        let mut landings = Vec::new();
        for step in [[0.0, 0.0], [half_mm[0], 0.0], [0.0, half_mm[1]]] {
            let mut rays = start.clone();
            let c = rays.columns_mut();
            for i in 0..c.x.len() {
                // Start on the source's plane and pass through the same point of the pupil's plane.
                let back = (source_z_mm - c.z[i]) / c.n[i];
                let from = [c.x[i] + back * c.l[i] + step[0], c.y[i] + back * c.m[i] + step[1], source_z_mm];
                let to = (through_z_mm - c.z[i]) / c.n[i];
                let to = [c.x[i] + to * c.l[i], c.y[i] + to * c.m[i], through_z_mm];
                let way = [to[0] - from[0], to[1] - from[1], to[2] - from[2]];
                let long = (way[0] * way[0] + way[1] * way[1] + way[2] * way[2]).sqrt();
                (c.x[i], c.y[i], c.z[i]) = (from[0], from[1], from[2]);
                (c.l[i], c.m[i], c.n[i]) = (way[0] / long, way[1] / long, way[2] / long);
            }
            tracer.trace(&mut rays, &mut work, Travel::Forward);
            landings.push(rays);
        }
        let all = (0..start.len()).filter(|i| landings.iter().all(|rays| rays.states()[*i] == ALIVE));
        let all: Vec<usize> = all.collect();
        if all.len() < LEAST {
            return None;
        }
        let places: Vec<[f64; 2]> = all.iter().map(|i| landed(&landings[0], *i)).collect();
        let rows: Vec<f64> = places.iter().flat_map(|place| terms(*place)).collect();
        let mut moves = [[[0.0; TERMS]; 2]; 2];
        let (mut off, mut size) = (0.0, 0.0);
        for (side, moves) in moves.iter_mut().enumerate() {
            for (axis, polynomial) in moves.iter_mut().enumerate() {
                let moved =
                    all.iter().zip(&places).map(|(i, place)| landed(&landings[1 + side], *i)[axis] - place[axis]);
                let moved: Vec<f64> = moved.collect();
                let found = least_squares(&rows, &moved, TERMS)?;
                polynomial.copy_from_slice(&found);
                for (place, moved) in places.iter().zip(&moved) {
                    let said = dot(polynomial, &terms(*place));
                    off += (said - moved) * (said - moved);
                    size += moved * moved;
                }
            }
        }
        let half_image_mm = (0.5 * size / all.len() as f64).sqrt();
        (off <= MOST_OFF * MOST_OFF * size && half_image_mm >= SMALLEST * pixel_mm).then_some(Self { moves })
    }

    /// Stores a batch as it leaves the lens, with the shifts for spreading its light.
    pub(crate) fn keep(&self, rays: &RayBatch, before: &mut Before) {
        before.columns.iter_mut().for_each(Vec::clear);
        let [x, y, z] = rays.positions();
        for i in 0..rays.len() {
            // The position of the ray shifts the lattice: as good as a random number, and the same however rays are cut into batches.
            let bits = mix64(x[i].to_bits() ^ mix64(y[i].to_bits()));
            let turn = [bits as u32, (bits >> 32) as u32].map(|part| f64::from(part) / 4_294_967_296.0);
            let at = terms(landed(rays, i));
            let [wide, high] = self.moves.each_ref().map(|moves| moves.each_ref().map(|move_| dot(move_, &at)));
            let all = [x[i], y[i], z[i], turn[0], turn[1], wide[0], wide[1], high[0], high[1]];
            before.columns.iter_mut().zip(all).for_each(|(column, value)| column.push(value));
        }
        before.weight.clear();
        before.weight.extend(rays.weights().iter().map(|weight| weight / PLACES as f64));
        before.state.clear();
        before.state.extend_from_slice(rays.states());
    }
}

/// Resets a batch to its state before the light was spread, each ray with its share of the light at one of its [`PLACES`].
pub(crate) struct Land<'a> {
    pub number: usize,
    pub before: &'a Before,
    pub rays: &'a mut RayBatch,
}

impl Vectorized for Land<'_> {
    type Output = ();
    #[inline(always)]
    fn run(self) {
        let Self { number, before, rays } = self;
        let c = rays.columns_mut();
        let len = c.x.len();
        let [x, y, z, turn_a, turn_b, wide_x, wide_y, high_x, high_y] = before.columns.each_ref().map(|c| &c[..len]);
        let [first, second] = [number, number * LATTICE % PLACES].map(|k| k as f64 / PLACES as f64);
        let (to_x, to_y) = (&mut c.x[..len], &mut c.y[..len]);
        for i in 0..len {
            let (a, b) = (tent(first + turn_a[i]), tent(second + turn_b[i]));
            to_x[i] = x[i] + (a * wide_x[i] + b * high_x[i]);
            to_y[i] = y[i] + (a * wide_y[i] + b * high_y[i]);
        }
        c.z.copy_from_slice(z);
        c.weight.copy_from_slice(&before.weight);
        c.state.copy_from_slice(&before.state);
    }
}

#[inline(always)]
fn dot(a: &[f64; TERMS], b: &[f64; TERMS]) -> f64 {
    let mut sum = 0.0;
    for k in 0..TERMS {
        sum += a[k] * b[k];
    }
    sum
}
