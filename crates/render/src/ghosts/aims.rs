//! The points on the front of the lens where the rays of a batch are aimed.

use super::Entrance;
use super::density::ABREAST;
use super::guide::{Aim, Guide};
use glam::DVec3;
use spectra_core::isa::{Isa, Vectorized};
use spectra_core::{Loss, RayBatch};
use spectra_optics::FrontOpening;

/// The aims of the rays of a batch, stored as columns.
#[derive(Clone, Debug, Default)]
pub(super) struct Aims {
    zones: Vec<usize>,
    places: [Vec<f64>; 2],
    densities: Vec<f64>,
    /// Directions around the axis from which rays start, if they were noted.
    azimuths: Vec<[f64; 2]>,
}

impl Aims {
    /// Draws the aims by two random numbers for each ray, from the guide of its zone.
    pub fn drawn(guides: &[Guide], zones: Vec<usize>, numbers: [&[f64]; 2], isa: Isa) -> Self {
        let len = zones.len();
        let mut own =
            Self { zones, places: [vec![0.0; len], vec![0.0; len]], densities: vec![0.0; len], azimuths: Vec::new() };
        isa.run(Draw { guides, numbers, aims: &mut own });
        own
    }

    /// Creates aims at the given places.
    pub fn at(places: &[[f64; 2]]) -> Self {
        let axis = |axis: usize| places.iter().map(|place| place[axis]).collect();
        let len = places.len();
        Self { zones: vec![0; len], places: [axis(0), axis(1)], densities: vec![0.25; len], azimuths: Vec::new() }
    }

    /// Returns where a ray enters the lens: its zone, its position, and the direction of its source point around the axis, if
    /// that was noted.
    pub fn landed(&self, ray: usize) -> Entrance {
        let azimuth = self.azimuths.get(ray).copied().unwrap_or([0.0, 1.0]);
        Entrance { zone: self.zones[ray], place: [self.places[0][ray], self.places[1][ray]], azimuth }
    }

    /// Notes for each ray the direction around the axis, a unit vector, of the point from which it starts.
    pub fn note_azimuths(&mut self, rays: &RayBatch) {
        let [x, y, _] = rays.positions();
        self.azimuths = x.iter().zip(y).map(|(x, y)| azimuth(*x, *y)).collect();
    }

    /// Creates aims for light that sets its directions itself, from the random numbers of the rays.
    pub fn of_numbers([a, b]: [&[f64]; 2]) -> Self {
        let place = |numbers: &[f64]| numbers.iter().map(|number| 2.0 * number - 1.0).collect();
        Self {
            zones: vec![0; a.len()],
            places: [place(a), place(b)],
            densities: vec![0.25; a.len()],
            azimuths: Vec::new(),
        }
    }

    /// Iterates over the zone and the aim of each ray.
    pub fn each(&self) -> impl Iterator<Item = (usize, Aim)> {
        let aim = |i: usize| Aim { place: [self.places[0][i], self.places[1][i]], density: self.densities[i] };
        self.zones.iter().enumerate().map(move |(i, zone)| (*zone, aim(i)))
    }

    /// Moves rays from the source to the places where they are aimed.
    pub fn send(&self, rays: &mut RayBatch, opening: FrontOpening) {
        let isa = rays.isa();
        let c = rays.columns_mut();
        isa.run(Send {
            opening,
            places: self.places.each_ref().map(Vec::as_slice),
            densities: &self.densities,
            position: [c.x, c.y, c.z],
            direction: [c.l, c.m, c.n],
            weight: c.weight,
            state: c.state,
        });
    }
}

struct Draw<'a> {
    guides: &'a [Guide],
    numbers: [&'a [f64]; 2],
    aims: &'a mut Aims,
}

impl Vectorized for Draw<'_> {
    type Output = ();
    #[inline(always)]
    fn run(self) {
        let Self { guides, numbers: [a, b], aims } = self;
        let len = aims.zones.len();
        for first in (0..len).step_by(ABREAST) {
            let (mut own, mut places, mut density) = ([&guides[0]; ABREAST], [[0.0; ABREAST]; 2], [0.0; ABREAST]);
            for k in 0..ABREAST {
                // Repeat the last ray if there are too few.
                let i = if first + k < len { first + k } else { len - 1 };
                own[k] = &guides[aims.zones[i]];
                (places[0][k], places[1][k]) = (a[i], b[i]);
            }
            Guide::draw_abreast(own, &mut places, &mut density);
            let end = if first + ABREAST < len { first + ABREAST } else { len };
            aims.places[0][first..end].copy_from_slice(&places[0][..end - first]);
            aims.places[1][first..end].copy_from_slice(&places[1][..end - first]);
            aims.densities[first..end].copy_from_slice(&density[..end - first]);
        }
    }
}

struct Send<'a> {
    opening: FrontOpening,
    places: [&'a [f64]; 2],
    densities: &'a [f64],
    position: [&'a mut [f64]; 3],
    direction: [&'a mut [f64]; 3],
    weight: &'a mut [f64],
    state: &'a mut [u64],
}

impl Vectorized for Send<'_> {
    type Output = ();
    #[inline(always)]
    fn run(self) {
        let ([x, y, z], [l, m, n]) = (self.position, self.direction);
        send(
            &self.opening,
            [self.places[0], self.places[1], self.densities],
            x,
            y,
            z,
            l,
            m,
            n,
            self.weight,
            self.state,
        );
    }
}

/// Columns are separate arguments, so the compiler knows that they do not overlap.
#[inline(always)]
#[expect(clippy::too_many_arguments, reason = "columns")]
fn send(
    opening: &FrontOpening,
    [right, up, density]: [&[f64]; 3],
    x: &mut [f64],
    y: &mut [f64],
    z: &mut [f64],
    l: &mut [f64],
    m: &mut [f64],
    n: &mut [f64],
    weight: &mut [f64],
    state: &mut [u64],
) {
    // The source point is within the opening: a lens with room for a subject gets no light from there.
    let inside = Loss::Vignetted.state(1);
    let len = state.len();
    let (right, up, density) = (&right[..len], &up[..len], &density[..len]);
    let (x, y, z) = (&mut x[..len], &mut y[..len], &mut z[..len]);
    let (l, m, n, weight) = (&mut l[..len], &mut m[..len], &mut n[..len], &mut weight[..len]);
    for i in 0..len {
        let point = DVec3::new(x[i], y[i], z[i]);
        let (is_outside, disk) = opening.disk_from(point);
        let at = disk.center + disk.radial * right[i] + disk.across * up[i];
        let way = at - point;
        let distance2 = way.length_squared();
        let direction = way / distance2.sqrt();
        // The solid angle that the ray stands for, sr.
        let stands_for = disk.radial.length_squared() * direction.dot(disk.sight) / (distance2 * density[i]);
        x[i] = if is_outside { at.x } else { x[i] };
        y[i] = if is_outside { at.y } else { y[i] };
        z[i] = if is_outside { at.z } else { z[i] };
        l[i] = if is_outside { direction.x } else { l[i] };
        m[i] = if is_outside { direction.y } else { m[i] };
        n[i] = if is_outside { direction.z } else { n[i] };
        weight[i] *= if is_outside { stands_for } else { 1.0 };
        state[i] = if is_outside { state[i] } else { inside };
    }
}

/// Returns the direction of a point around the axis, a unit vector.
#[inline]
pub(super) fn azimuth(x: f64, y: f64) -> [f64; 2] {
    let away = (x * x + y * y).sqrt();
    if away > 0.0 { [x / away, y / away] } else { [0.0, 1.0] }
}
