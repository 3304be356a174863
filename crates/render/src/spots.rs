//! Lamps whose light comes from small spots: each ray stands for all of its spot.
//!
//! A lamp of one pixel of a picture is a spot that fades from its middle. Where it is in the spot that a ray starts makes no difference to
//! what it carries, but moves where it lands, by as much as the lens magnifies. So rays start in the middle of spots, and each one's
//! light lands at several places, spread over the image of the spot by the same share each: of a disk of light out of focus a pixel has
//! the light of as many more rays as the image is larger than a pixel. No ray is traced for it.
//!
//! How a step in a spot moves a ray as it lands is measured: rays are traced from beside the middle, through the same points of the plane
//! of the entrance pupil. Over the frame that is smooth, and polynomials of second degree in the place where rays land hold it; where they
//! do not within a tenth, or the image of a spot is smaller than a pixel, rays start anywhere in a spot instead.

use spectra_core::RayBatch;
use spectra_core::isa::Vectorized;
use spectra_core::linear::least_squares;
use spectra_core::loss::ALIVE;
use spectra_core::numbers::mix64;
use spectra_lens::{Tracer, Travel};

/// Places that the light of a ray lands at: a Fibonacci lattice, turned for each ray.
pub(crate) const PLACES: usize = 13;
const LATTICE: usize = 8;
/// Rays that have to land to say how spots are imaged.
const LEAST: usize = 128;
/// Smallest image of a spot that light is spread over: half its width, pixels.
const SMALLEST: f64 = 0.5;
/// Largest deviation from the polynomials, as a part of the image (root mean square).
const MOST_OFF: f64 = 0.1;
/// Terms of the polynomials.
const TERMS: usize = 6;

/// How spots are imaged.
#[derive(Debug)]
pub(crate) struct Spots {
    /// For half the width and half the height of a spot, how far it moves a ray to the right and up as it lands, mm: polynomials in the
    /// place where it lands.
    moves: [[[f64; TERMS]; 2]; 2],
}

/// What a batch was before its light was spread, and how each ray's is.
#[derive(Default)]
pub(crate) struct Before {
    /// Positions, then by how much the lattice is turned, then the moves to the right and up for half the width and half the height of a
    /// spot.
    columns: [Vec<f64>; 9],
    weight: Vec<f64>,
    state: Vec<u64>,
}

#[inline(always)]
fn terms([x, y]: [f64; 2]) -> [f64; TERMS] {
    [1.0, x, y, x * x, x * y, y * y]
}

/// A place under a tent of half width 1 about 0, by a number in [0, 2) of which the whole part does not count.
#[inline(always)]
fn tent(u: f64) -> f64 {
    let u = if u < 1.0 { u } else { u - 1.0 };
    let (is_left, from_end) = (u < 0.5, if u < 0.5 { u } else { 1.0 - u });
    let inward = 1.0 - (2.0 * from_end).sqrt();
    if is_left { -inward } else { inward }
}

/// Where a ray meets the plane of the image, mm.
#[inline(always)]
fn landed(rays: &RayBatch, i: usize) -> [f64; 2] {
    let ([x, y, z], [l, m, n]) = (rays.positions(), rays.directions());
    [x[i] - z[i] / n[i] * l[i], y[i] - z[i] / n[i] * m[i]]
}

impl Spots {
    /// Looks how spots of this half width and height (mm) on the plane at `source_z_mm` are imaged, by rays that start in the middle of some, are
    /// aimed and go through the same points of the plane at `through_z_mm`; `None` where they cannot be spread.
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
                // From the source's plane, through the same point of the plane of the pupil.
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

    /// Remembers a batch as it comes from the lens.
    pub(crate) fn keep(&self, rays: &RayBatch, before: &mut Before) {
        before.columns.iter_mut().for_each(Vec::clear);
        let [x, y, z] = rays.positions();
        for i in 0..rays.len() {
            // Turned by the place itself, which is as good as chance and the same however rays are cut into batches.
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

/// Sets a batch to what it was before, each ray with its share of the light at one of its [`PLACES`].
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
