//! The table of the zones of a pupil.

use super::measure::{azimuth_measure, measure, whole};
use super::outline::Outlines;
use super::sphere::Sphere;
use glam::DVec3;

/// Number of slots for zones of the angle in one row; unused slots pass nothing. A power of two, so that a
/// masked index needs no bounds check and the lookup is a vector gather.
pub(super) const SLOTS: usize = 128;
/// Number of fields of a zone that are in use, and of those allocated: two cache lines.
const USED: usize = 14;
pub(super) const FIELDS: usize = 16;

/// The region of one zone, in the frame of the point: `radial` is the direction away from the axis through the point,
/// `across` is at right angles to that and to the axis, `axial` runs along +z.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Zone {
    /// Middle of the shape: radial, across, axial (from the reference point), mm.
    pub center: [f64; 3],
    /// Half-axis of the shape in the plane of the point and the axis: radial and axial component, mm.
    pub half_along: [f64; 2],
    /// Half-axis of the shape across that plane, mm.
    pub half_across: f64,
    /// Whether the shape is an ellipse; otherwise it is the rectangle around it.
    pub ellipse: bool,
    /// Change of the outlines over the zone.
    pub drift: Drift,
}

/// The change of the passing light from the lower end of a zone's angle to its upper end.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Drift {
    /// Shift along and across, mm.
    pub shift: [f64; 2],
    /// Growth along and across, as fractions of the size in the middle.
    pub growth: [f64; 2],
}

impl Drift {
    /// Converts a point in the middle of the zone to a fraction of the zone, -0.5 to 0.5.
    pub fn moved(&self, place: [f64; 2], part: f64) -> [f64; 2] {
        std::array::from_fn(|i| place[i] * (1.0 + part * self.growth[i]) + part * self.shift[i])
    }

    /// Converts a point at a fraction of the zone, -0.5 to 0.5, to the middle of the zone.
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

/// The zones of one depth and azimuth. The data that a ray needs of its zone lie together.
#[derive(Clone, Debug)]
pub(super) struct ZoneRow(pub(super) [[f64; FIELDS]; SLOTS]);

impl ZoneRow {
    pub fn new(zones: &[Zone]) -> Self {
        let mut row = [[0.0; FIELDS]; SLOTS];
        for (own, zone) in row.iter_mut().zip(zones).take(SLOTS - 1) {
            let [r, z] = zone.half_along;
            let length = (r * r + z * z).sqrt();
            // The normal of the plane, radial and axial; arbitrary if the zone passes nothing.
            let (nr, nz) = if length > 0.0 { (-z / length, r / length) } else { (0.0, 1.0) };
            let [cr, ca, cz] = zone.center;
            let flag = if zone.ellipse { 1.0 } else { 0.0 };
            let Drift { shift: [sa, sc], growth: [ga, gc] } = zone.drift;
            let fields = [cr, ca, cz, r, z, zone.half_across, nr, nz, zone.area_mm2(), flag, sa, sc, ga, gc];
            own[..USED].copy_from_slice(&fields);
        }
        Self(row)
    }

    /// Returns the row with every region enlarged, so that everything in it may be moved by `margin_mm` in its plane.
    fn widened(&self, margin_mm: f64) -> Self {
        let mut row = self.0;
        for row in &mut row {
            let (along, across) = ((row[3] * row[3] + row[4] * row[4]).sqrt(), row[5]);
            if row[8] <= 0.0 || along <= 0.0 || across <= 0.0 {
                continue;
            }
            // An ellipse that grows in proportion contains disks about all of its points; a rectangle needs only the margin.
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

/// The zones of the depth of a point: one over its distance (forward), or its position along the axis (backward).
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
    /// Returns the position of a depth, 0 at the lower end and 1 at the upper one. The division is the same for all rays of a batch.
    #[inline(always)]
    fn share(&self, depth: f64) -> f64 {
        (depth - self.from) * (1.0 / (self.to - self.from))
    }
}

/// All zones of one side of a lens.
#[derive(Clone, Debug)]
pub(super) struct Table {
    /// Position of the reference point on the axis, mm in the frame of the rays on this side.
    pub eye_z_mm: f64,
    /// Number of zones per unit of the angle's measure; see [`measure`].
    pub angle_scale: f64,
    pub depth: Depth,
    /// Number of zones of the azimuth; 1 if the lens has an axis of revolution.
    pub azimuths: usize,
    /// Rows of zones, by depth, then azimuth.
    pub rows: Vec<ZoneRow>,
    /// Sphere around the whole surface that is met first.
    pub bound: Sphere,
    /// Number of that surface, from 1: light that no zone passes is recorded as lost there.
    pub surface: u32,
    /// Outlines of what passes in each zone, tighter than its ellipse or rectangle.
    pub outlines: Option<Outlines>,
}

impl Table {
    /// Returns the table with all regions and outlines enlarged by `margin_mm`; see [`ZoneRow::widened`].
    pub fn widened(self, margin_mm: f64) -> Self {
        Self {
            rows: self.rows.iter().map(|row| row.widened(margin_mm)).collect(),
            outlines: self.outlines.map(|outlines| outlines.widened(margin_mm)),
            ..self
        }
    }
}

impl Table {
    #[inline(always)]
    fn depth_of<const BACKWARD: bool>(radius2: f64, ahead: f64) -> f64 {
        if BACKWARD { ahead } else { 1.0 / (radius2 + ahead * ahead).sqrt() }
    }

    /// Returns the position of a point in its zone of the depth, -0.5 to 0.5; 0 if its depth was not searched.
    #[inline(always)]
    pub(super) fn depth_part<const BACKWARD: bool>(&self, x: f64, y: f64, z: f64) -> f64 {
        let ahead = if BACKWARD { z - self.eye_z_mm } else { self.eye_z_mm - z };
        let share = self.depth.share(Self::depth_of::<BACKWARD>(x * x + y * y, ahead));
        let zones = share * self.depth.zones as f64;
        let at = whole(zones, (self.depth.zones - 1) as f64);
        let part = zones - at as f64 - 0.5;
        // Points at other depths are aimed at in another way.
        if part.abs() <= 0.5 { part } else { 0.0 }
    }

    #[inline(always)]
    pub fn is_stray<const BACKWARD: bool>(&self, x: f64, y: f64, z: f64) -> bool {
        let ahead = if BACKWARD { z - self.eye_z_mm } else { self.eye_z_mm - z };
        if BACKWARD {
            !((ahead >= self.depth.from) & (ahead <= self.depth.to))
        } else {
            // Tests whether one over the distance is below the upper end (the lower one is 0), without a root or division.
            !((x * x + y * y + ahead * ahead) * (self.depth.to * self.depth.to) >= 1.0)
        }
    }

    /// Returns the zone of a point and the frame of that point: the unit vectors radial and across in the plane of the lens.
    /// Returns `None` at a depth that was not searched.
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

    /// Returns row and slot of a point, the unit vector from the axis to the point, and the angle in zones.
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
        // Unit vector away from the axis; on the axis it is arbitrary.
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
