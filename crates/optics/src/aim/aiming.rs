//! Aims rays at points of the zones of a table.

use super::fan;
use super::part::AimPart;
use super::table::{FIELDS, SLOTS, Table};
use super::toward::toward;
use glam::DVec3;
use spectra_core::isa::Vectorized;
use spectra_core::math::{concentric_disk, polar_disk};
use spectra_core::{Loss, RayBatch};

/// The mapping from numbers in the unit square to points on the ellipse of a zone.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum AimPattern {
    /// Shirley and Chiu's concentric map, in which neighbors stay neighbors.
    Disk,
    /// Rings of equal area: the first number chooses the ring, the second the angle.
    Rings,
}

/// Kernel that aims one batch at the shapes of a table.
struct Aim<'a, const BACKWARD: bool, const RINGS: bool, const MANY: bool> {
    table: &'a Table,
    u: &'a [f64],
    v: &'a [f64],
    rays: &'a mut RayBatch,
}

/// The result for the rays of a batch.
struct Aimed {
    /// Number of rays whose points pass nothing.
    dark: usize,
}

impl Table {
    /// Aims the rays of a batch, which are at their points, at points of the pupil, starts them
    /// there, and multiplies their weights by the solid angle. Returns how many have ended because
    /// nothing passes from their point.
    pub fn aim<const BACKWARD: bool>(
        &self,
        rays: &mut RayBatch,
        u: &[f64],
        v: &[f64],
        (pattern, part): (AimPattern, AimPart),
    ) -> usize {
        let isa = rays.isa();
        let strays = self.strays::<BACKWARD>(rays, u, v);
        let rings = pattern == AimPattern::Rings;
        let dark = match (&self.outlines, rings, self.rows.len() > 1) {
            (Some(outlines), ..) => fan::aim::<BACKWARD>(self, outlines, rays, [u, v], rings, part),
            (None, false, false) => isa.run(Aim::<BACKWARD, false, false> { table: self, u, v, rays }).dark,
            (None, false, true) => isa.run(Aim::<BACKWARD, false, true> { table: self, u, v, rays }).dark,
            (None, true, false) => isa.run(Aim::<BACKWARD, true, false> { table: self, u, v, rays }).dark,
            (None, true, true) => isa.run(Aim::<BACKWARD, true, true> { table: self, u, v, rays }).dark,
        };
        let c = rays.columns_mut();
        let mut revived = 0;
        for stray in strays {
            let i = stray.ray;
            revived += usize::from(c.state[i] != spectra_core::loss::ALIVE);
            c.state[i] = spectra_core::loss::ALIVE;
            (c.x[i], c.y[i], c.z[i]) = stray.position.into();
            (c.l[i], c.m[i], c.n[i]) = stray.direction.into();
            // Strays have no rim.
            c.weight[i] = if part == AimPart::Rim { 0.0 } else { stray.weight };
        }
        dark - revived
    }

    /// Aims the rays of points at a depth that was not searched at the whole surface that is met first. They are rare, and
    /// this is slow.
    fn strays<const BACKWARD: bool>(&self, rays: &RayBatch, u: &[f64], v: &[f64]) -> Vec<Stray> {
        let isa = rays.isa();
        let [x, y, z] = rays.positions();
        let found = isa.run(CountStrays::<BACKWARD> { table: self, x, y, z });
        if found == 0 {
            return Vec::new();
        }
        let mut strays = Vec::with_capacity(found);
        let [l, m, n] = rays.directions();
        for i in 0..x.len() {
            if self.is_stray::<BACKWARD>(x[i], y[i], z[i]) {
                let (position, direction, solid_angle) = self.bound.aim(DVec3::new(x[i], y[i], z[i]), u[i], v[i]);
                let cosine = if BACKWARD { direction.dot(DVec3::new(l[i], m[i], n[i])).max(0.0) } else { 1.0 };
                let weight = rays.weights()[i] * solid_angle * cosine;
                strays.push(Stray { ray: i, position, direction, weight });
            }
        }
        strays
    }
}

/// A ray that is aimed at the whole first surface.
struct Stray {
    ray: usize,
    position: DVec3,
    direction: DVec3,
    weight: f64,
}

struct CountStrays<'a, const BACKWARD: bool> {
    table: &'a Table,
    x: &'a [f64],
    y: &'a [f64],
    z: &'a [f64],
}

impl<const BACKWARD: bool> Vectorized for CountStrays<'_, BACKWARD> {
    type Output = usize;
    #[inline(always)]
    fn run(self) -> usize {
        let len = self.x.len();
        let (x, y, z) = (self.x, &self.y[..len], &self.z[..len]);
        let mut many = 0_u64;
        for i in 0..len {
            many += u64::from(self.table.is_stray::<BACKWARD>(x[i], y[i], z[i]));
        }
        many as usize
    }
}

impl<const BACKWARD: bool, const RINGS: bool, const MANY: bool> Vectorized for Aim<'_, BACKWARD, RINGS, MANY> {
    type Output = Aimed;
    #[inline(always)]
    fn run(self) -> Aimed {
        let c = self.rays.columns_mut();
        let dark = aim_loop::<BACKWARD, RINGS, MANY>(
            self.table,
            &self.table.rows[0].0,
            [self.u, self.v],
            c.x,
            c.y,
            c.z,
            c.l,
            c.m,
            c.n,
            c.weight,
            c.state,
        );
        Aimed { dark }
    }
}

/// Aims all rays. The columns and the first row are separate arguments, so that the compiler knows that none overlaps another.
#[inline(always)]
fn aim_loop<const BACKWARD: bool, const RINGS: bool, const MANY: bool>(
    table: &Table,
    only: &[[f64; FIELDS]; SLOTS],
    [u, v]: [&[f64]; 2],
    x: &mut [f64],
    y: &mut [f64],
    z: &mut [f64],
    l: &mut [f64],
    m: &mut [f64],
    n: &mut [f64],
    weight: &mut [f64],
    state: &mut [u64],
) -> usize {
    let len = x.len();
    let (u, v, y, z) = (&u[..len], &v[..len], &mut y[..len], &mut z[..len]);
    let (l, m, n) = (&mut l[..len], &mut m[..len], &mut n[..len]);
    let (weight, state) = (&mut weight[..len], &mut state[..len]);
    let ended = Loss::Vignetted.state(table.surface);
    let (eye, scale) = (table.eye_z_mm, table.angle_scale);
    let mut dark = 0_u64;
    for i in 0..len {
        let (px, py, pz) = (x[i], y[i], z[i]);
        let (row, k, ex, ey, _) = table.place::<BACKWARD, MANY>(eye, scale, px, py, pz);
        let f = &(if MANY { &table.rows[row].0 } else { only })[k];
        let disk = if RINGS { polar_disk(u[i], v[i]) } else { concentric_disk(u[i], v[i]) };
        let ellipse = f[9] > 0.0;
        let p = if ellipse { disk.0 } else { 2.0 * u[i] - 1.0 };
        let q = if ellipse { disk.1 } else { 2.0 * v[i] - 1.0 };
        let radial = f[0] + p * f[3];
        let across = f[1] + q * f[5];
        let tx = radial * ex - across * ey;
        let ty = radial * ey + across * ex;
        let tz = eye + (f[2] + p * f[4]);
        let area = f[8];
        let facing = [l[i], m[i], n[i]];
        let ([dl, dm, dn], solid_angle) =
            toward::<BACKWARD>([px, py, pz], [tx, ty, tz], [ex, ey], [f[6], f[7]], area, facing);
        weight[i] *= solid_angle;
        let none = area == 0.0;
        dark += u64::from(none);
        state[i] = if none { ended } else { state[i] };
        (x[i], y[i], z[i]) = (tx, ty, tz);
        (l[i], m[i], n[i]) = (dl, dm, dn);
    }
    dark as usize
}
