//! The zones of a pupil, and the aiming itself.

use super::outline::{self, Outlines};
use super::search::Sphere;
use glam::DVec3;
use spectra_core::isa::{Isa, Vectorized};
use spectra_core::math::{self, concentric_disk, polar_disk, sin_cos_turns};
use spectra_core::{Loss, RayBatch};

/// How numbers in the unit square become places on the ellipse of a zone.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum AimPattern {
    /// Neighbors to neighbors (Shirley and Chiu's concentric map).
    Disk,
    /// Equal-area rings: the first number is the ring, the second the angle.
    Rings,
}

/// Zones of the angle in one row; the rest of its slots pass nothing. A power of two, so that a
/// masked index needs no bounds check and the lookup is a vector gather.
pub(super) const SLOTS: usize = 128;
/// Numbers of a zone that are in use, and their room: two lines of a cache.
const USED: usize = 14;
pub(super) const FIELDS: usize = 16;

/// The region of one zone, in the frame of the point: `radial` away from the axis through the point,
/// `across` at right angles to that and to the axis, `axial` along +z.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Zone {
    /// Middle of the shape: radial, across, axial (from the reference point), mm.
    pub center: [f64; 3],
    /// Half the shape, in the plane of the point and the axis: radial and axial part, mm.
    pub half_along: [f64; 2],
    /// Half the shape across, mm.
    pub half_across: f64,
    /// An ellipse, or else the rectangle around it.
    pub ellipse: bool,
    /// How outlines change over the zone.
    pub drift: Drift,
}

/// How what passes changes from the lower end of a zone's angle to its upper end.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Drift {
    /// It moves by this much along and across, mm.
    pub shift: [f64; 2],
    /// It grows by this much along and across, in parts of its size in the middle.
    pub growth: [f64; 2],
}

impl Drift {
    /// A place at a part of the zone, -0.5 to 0.5, for one in the middle.
    pub fn moved(&self, place: [f64; 2], part: f64) -> [f64; 2] {
        std::array::from_fn(|i| place[i] * (1.0 + part * self.growth[i]) + part * self.shift[i])
    }

    /// The place in the middle of the zone for one at a part of it.
    pub fn still(&self, place: [f64; 2], part: f64) -> [f64; 2] {
        std::array::from_fn(|i| (place[i] - part * self.shift[i]) / (1.0 + part * self.growth[i]))
    }
}

impl Zone {
    pub fn area_mm2(&self) -> f64 {
        let [r, z] = self.half_along;
        let unit = if self.ellipse { std::f64::consts::PI } else { 4.0 };
        unit * (r * r + z * z).sqrt() * self.half_across
    }
}

/// Zones of one depth and azimuth: what a ray asks of its zone lies together.
#[derive(Clone, Debug)]
pub(super) struct Row(pub(super) [[f64; FIELDS]; SLOTS]);

impl Row {
    pub fn new(zones: &[Zone]) -> Self {
        let mut row = [[0.0; FIELDS]; SLOTS];
        for (own, zone) in row.iter_mut().zip(zones).take(SLOTS - 1) {
            let [r, z] = zone.half_along;
            let length = (r * r + z * z).sqrt();
            // The plane's normal, radial and axial; of a zone that passes nothing any will do.
            let (nr, nz) = if length > 0.0 { (-z / length, r / length) } else { (0.0, 1.0) };
            let [cr, ca, cz] = zone.center;
            let flag = if zone.ellipse { 1.0 } else { 0.0 };
            let Drift { shift: [sa, sc], growth: [ga, gc] } = zone.drift;
            let fields = [cr, ca, cz, r, z, zone.half_across, nr, nz, zone.area_mm2(), flag, sa, sc, ga, gc];
            own[..USED].copy_from_slice(&fields);
        }
        Self(row)
    }

    /// The same with every region larger: whatever lay in it may be moved by `margin_mm` in its plane.
    fn widened(&self, margin_mm: f64) -> Self {
        let mut row = self.0;
        for row in &mut row {
            let (along, across) = ((row[3] * row[3] + row[4] * row[4]).sqrt(), row[5]);
            if row[8] <= 0.0 || along <= 0.0 || across <= 0.0 {
                continue;
            }
            // An ellipse that grows in proportion holds disks about all of its places; a rectangle needs the margin alone.
            let ellipse = row[9] > 0.0;
            let grown = |half: f64| if ellipse { 1.0 + margin_mm / along.min(across) } else { 1.0 + margin_mm / half };
            let (f, g) = (grown(along), grown(across));
            row[3] *= f;
            row[4] *= f;
            row[5] *= g;
            row[8] *= f * g;
        }
        Self(row)
    }
}

/// The depth of a point: how near it is (forward), or where along the axis (backward).
#[derive(Clone, Copy, Debug)]
pub(super) struct Depth {
    /// Lower end of the first zone.
    pub from: f64,
    /// Upper end of the last zone.
    pub to: f64,
    /// Number of zones.
    pub zones: usize,
}

impl Depth {
    /// Where a depth lies, 0 at the lower end and 1 at the upper one. The division is the same for all rays of a batch.
    #[inline(always)]
    fn share(&self, depth: f64) -> f64 {
        (depth - self.from) * (1.0 / (self.to - self.from))
    }
}

/// All zones of one side of a lens.
#[derive(Clone, Debug)]
pub(super) struct Table {
    /// The reference point on the axis, mm in the frame that rays of this side are in.
    pub eye_z_mm: f64,
    /// Zones a unit of the angle's measure; see [`measure`].
    pub angle_scale: f64,
    pub depth: Depth,
    /// 1 where the lens has an axis of revolution.
    pub azimuths: usize,
    /// By depth, then azimuth.
    pub rows: Vec<Row>,
    /// Holds the whole of the surface that is met first.
    pub bound: Sphere,
    /// Number of that surface: light that no zone passes is booked there.
    pub surface: u32,
    /// What passes in each zone, closer than its ellipse or rectangle.
    pub outlines: Option<Outlines>,
}

impl Table {
    /// See [`Row::widened`].
    pub fn widened(self, margin_mm: f64) -> Self {
        Self {
            rows: self.rows.iter().map(|row| row.widened(margin_mm)).collect(),
            outlines: self.outlines.map(|outlines| outlines.widened(margin_mm)),
            ..self
        }
    }
}

/// A measure of the angle at which a point is seen from the reference point, `radius` beside the axis
/// and `ahead` in front of it: 0 on the axis, 1 at 90 degrees, 2 straight behind. Grows with the
/// angle, and takes one division.
#[inline(always)]
pub(super) fn measure(radius: f64, ahead: f64) -> f64 {
    let share = radius / (radius + ahead.abs());
    if ahead < 0.0 { 2.0 - share } else { share }
}

/// [`math::whole`] as an index.
#[inline(always)]
pub(super) fn whole(at: f64, last: f64) -> usize {
    math::whole(at, last).0 as usize
}

/// [`measure`] for the azimuth of (x, y): in [0, 4), a quarter turn a unit.
#[inline(always)]
pub(super) fn azimuth_measure(x: f64, y: f64) -> f64 {
    let share = y / (x.abs() + y.abs());
    if x < 0.0 {
        2.0 - share
    } else if y < 0.0 {
        4.0 + share
    } else {
        share
    }
}

/// What a table does for one batch.
struct Aim<'a, const BACKWARD: bool, const RINGS: bool, const MANY: bool> {
    table: &'a Table,
    u: &'a [f64],
    v: &'a [f64],
    rays: &'a mut RayBatch,
}

/// What became of the rays of a batch.
struct Aimed {
    /// Rays of points from which nothing passes.
    dark: usize,
}

impl Table {
    /// Turns the rays of a batch, which are at their points, to places of the pupil, starts them
    /// there, and multiplies their weights by the solid angle. Returns how many have ended, because
    /// nothing passes from their point.
    pub fn aim<const BACKWARD: bool>(
        &self,
        rays: &mut RayBatch,
        u: &[f64],
        v: &[f64],
        pattern: AimPattern,
        isa: Isa,
    ) -> usize {
        let strays = self.strays::<BACKWARD>(rays, u, v, isa);
        let dark = match (&self.outlines, pattern == AimPattern::Rings, self.rows.len() > 1) {
            (Some(outlines), ..) => outline::aim::<BACKWARD>(self, outlines, rays, [u, v], pattern, isa),
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
            c.weight[i] = stray.weight;
        }
        dark - revived
    }

    /// Rays of points that lie at another depth than the search was asked for: rare, and slow. They are
    /// aimed at the whole of the surface that is met first.
    fn strays<const BACKWARD: bool>(&self, rays: &RayBatch, u: &[f64], v: &[f64], isa: Isa) -> Vec<Stray> {
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

    #[inline(always)]
    fn depth_of<const BACKWARD: bool>(radius2: f64, ahead: f64) -> f64 {
        if BACKWARD { ahead } else { 1.0 / (radius2 + ahead * ahead).sqrt() }
    }

    /// Where a point lies in its zone of the depth, -0.5 to 0.5.
    #[inline(always)]
    pub(super) fn depth_part<const BACKWARD: bool>(&self, x: f64, y: f64, z: f64) -> f64 {
        let ahead = if BACKWARD { z - self.eye_z_mm } else { self.eye_z_mm - z };
        let share = self.depth.share(Self::depth_of::<BACKWARD>(x * x + y * y, ahead));
        let zones = share * self.depth.zones as f64;
        let at = whole(zones, (self.depth.zones - 1) as f64);
        let part = zones - at as f64 - 0.5;
        // A point that was not searched for is aimed at in another way.
        if part.abs() <= 0.5 { part } else { 0.0 }
    }

    #[inline(always)]
    fn is_stray<const BACKWARD: bool>(&self, x: f64, y: f64, z: f64) -> bool {
        let ahead = if BACKWARD { z - self.eye_z_mm } else { self.eye_z_mm - z };
        if BACKWARD {
            !((ahead >= self.depth.from) & (ahead <= self.depth.to))
        } else {
            // One over the distance is below the upper end; the lower one is 0. Without a root or division.
            !((x * x + y * y + ahead * ahead) * (self.depth.to * self.depth.to) >= 1.0)
        }
    }

    /// The zone of a point, and the frame of that point: radial and across in the plane of the lens.
    /// `None` at a depth that was not searched.
    pub fn zone<const BACKWARD: bool>(&self, point: DVec3) -> Option<(Zone, DVec3, DVec3)> {
        if self.is_stray::<BACKWARD>(point.x, point.y, point.z) {
            return None;
        }
        let (row, slot, ex, ey, _) =
            self.place::<BACKWARD, true>(self.eye_z_mm, self.angle_scale, point.x, point.y, point.z);
        let f = |field: usize| self.rows[row].0[slot][field];
        let zone = Zone {
            center: [f(0), f(1), f(2)],
            half_along: [f(3), f(4)],
            half_across: f(5),
            ellipse: f(9) > 0.0,
            drift: Drift { shift: [f(10), f(11)], growth: [f(12), f(13)] },
        };
        Some((zone, DVec3::new(ex, ey, 0.0), DVec3::new(-ey, ex, 0.0)))
    }

    /// Row and slot of a point, the unit vector from the axis to it, and its angle in zones.
    #[inline(always)]
    pub(super) fn place<const BACKWARD: bool, const MANY: bool>(
        &self,
        eye_z_mm: f64,
        angle_scale: f64,
        x: f64,
        y: f64,
        z: f64,
    ) -> (usize, usize, f64, f64, f64) {
        let radius2 = x * x + y * y;
        let radius = radius2.sqrt();
        let ahead = if BACKWARD { z - eye_z_mm } else { eye_z_mm - z };
        let zones = measure(radius, ahead) * angle_scale;
        let slot = whole(zones, (SLOTS - 1) as f64) & (SLOTS - 1);
        // Unit vector away from the axis; on it any will do.
        let on_axis = radius == 0.0;
        let inverse = 1.0 / if on_axis { 1.0 } else { radius };
        let (ex, ey) = (x * inverse, if on_axis { 1.0 } else { y * inverse });
        let mut row = 0;
        if MANY {
            let depth = Self::depth_of::<BACKWARD>(radius2, ahead);
            let share = self.depth.share(depth);
            let at = whole(share * self.depth.zones as f64, (self.depth.zones - 1) as f64);
            row = at * self.azimuths;
            if self.azimuths > 1 {
                let turn = azimuth_measure(ex, ey) * 0.25 * self.azimuths as f64;
                row += whole(turn, (self.azimuths - 1) as f64);
            }
        }
        (row, slot, ex, ey, zones)
    }
}

/// A ray that is aimed at the whole surface.
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

/// Columns come as arguments of their own, and so does the first row: so the compiler knows that none overlaps another.
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
        let (dx, dy, dz) = (tx - px, ty - py, tz - pz);
        let inverse = 1.0 / (dx * dx + dy * dy + dz * dz).sqrt();
        let (dl, dm, dn) = (dx * inverse, dy * inverse, dz * inverse);
        let area = f[8];
        // Solid angle of the share of area, as the point sees it.
        let cosine = ((dl * ex + dm * ey) * f[6] + dn * f[7]).abs();
        let mut solid_angle = area * cosine * inverse * inverse;
        if BACKWARD {
            // The imager's normal stands in the place of the direction.
            solid_angle *= positive(dl * l[i] + dm * m[i] + dn * n[i]);
        }
        weight[i] *= solid_angle;
        let none = area == 0.0;
        dark += u64::from(none);
        state[i] = if none { ended } else { state[i] };
        (x[i], y[i], z[i]) = (tx, ty, tz);
        (l[i], m[i], n[i]) = (dl, dm, dn);
    }
    dark as usize
}

/// The larger of a number and 0: one instruction on every tier.
#[inline(always)]
fn positive(value: f64) -> f64 {
    if value > 0.0 { value } else { 0.0 }
}

impl Sphere {
    /// A ray from `point` to the sphere, evenly over the solid angle of a disk that hides it: where it
    /// starts, its direction, and its weight in sr. From a point inside, evenly in all directions.
    fn aim(&self, point: DVec3, u: f64, v: f64) -> (DVec3, DVec3, f64) {
        let to = self.center - point;
        let distance2 = to.length_squared();
        let radius2 = self.radius_mm * self.radius_mm;
        if distance2 <= 1.01 * radius2 {
            let height = 2.0 * u - 1.0;
            let (sin, cos) = sin_cos_turns(v);
            let beside = (1.0 - height * height).max(0.0).sqrt();
            return (point, DVec3::new(beside * cos, beside * sin, height), 4.0 * std::f64::consts::PI);
        }
        let axis = to / distance2.sqrt();
        let radius = self.radius_mm / (1.0 - radius2 / distance2).sqrt();
        let (a, b) = axis.any_orthonormal_pair();
        let (p, q) = concentric_disk(u, v);
        let target = self.center + (a * p + b * q) * radius;
        let way = target - point;
        let direction = way.normalize();
        let area = std::f64::consts::PI * radius * radius;
        (target, direction, area * direction.dot(axis) / way.length_squared())
    }
}
