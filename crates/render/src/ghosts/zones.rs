//! Sorts the points of a source by the direction in which the lens sees them.

use glam::DVec3;
use spectra_core::math::atan2;

/// Largest number of zones of the angle to the axis.
const MOST_RINGS: usize = 12;
/// Smallest width of a zone (chord of the unit circle: 0.6 degrees). The sun, 0.53 degrees wide, is in one zone wherever it stands, because
/// rays of both its halves find the same places on the front.
const WIDTH: f64 = 0.6 * std::f64::consts::PI / 180.0;
/// Number of zones around the axis, in a lens without rotational symmetry.
const SECTORS: usize = 8;

/// The zones of a source. The points of a zone share a guide, because the light of a path enters in nearly the same places from all of
/// them.
#[derive(Clone, Debug)]
pub(super) struct Zones {
    eye: DVec3,
    low: f64,
    step: f64,
    rings: usize,
    sectors: usize,
}

impl Zones {
    /// Creates zones for points like the given ones, seen from `eye`. In a round lens all azimuths are equivalent.
    pub fn new(points: &[DVec3], eye: DVec3, is_round: bool) -> Self {
        let unit = |p: &DVec3| (*p - eye).normalize_or(DVec3::NEG_Z);
        let middle = points.iter().map(unit).sum::<DVec3>().normalize_or(DVec3::NEG_Z);
        if points.iter().all(|p| (unit(p) - middle).length() < 0.5 * WIDTH) {
            return Self::one();
        }
        let chords = points.iter().map(|p| chord(*p - eye));
        let (low, high) = chords.fold((2.0_f64, 0.0_f64), |(low, high), c| (low.min(c), high.max(c)));
        let rings = (((high - low) / WIDTH).ceil() as usize).clamp(1, MOST_RINGS);
        let step = ((high - low) / rings as f64).max(1e-9);
        Self { eye, low, step, rings, sectors: if is_round || high < WIDTH { 1 } else { SECTORS } }
    }

    /// Creates a single zone for all points.
    pub fn one() -> Self {
        Self { eye: DVec3::ZERO, low: 0.0, step: 2.0, rings: 1, sectors: 1 }
    }

    pub fn count(&self) -> usize {
        self.rings * self.sectors
    }

    /// Returns for each zone the one of the given points that is nearest to its middle, if any lies in it.
    pub fn middles(&self, points: &[DVec3]) -> Vec<Option<DVec3>> {
        let unit = |point: &DVec3| (*point - self.eye).normalize_or(DVec3::NEG_Z);
        // All places of a ring around the axis are equivalent.
        let turned = |point: &DVec3| {
            let unit = unit(point);
            if self.rings > 1 && self.sectors == 1 { DVec3::new(unit.truncate().length(), 0.0, unit.z) } else { unit }
        };
        let middle = |zone: usize| {
            let own = || points.iter().filter(move |point| self.of(**point) == zone);
            let mean = own().map(turned).sum::<DVec3>() / own().count().max(1) as f64;
            let away = |point: &DVec3| turned(point).distance_squared(mean);
            own().min_by(|a, b| away(a).total_cmp(&away(b))).copied()
        };
        (0..self.count()).map(middle).collect()
    }

    /// Returns the zone of a point.
    #[inline]
    pub fn of(&self, point: DVec3) -> usize {
        if self.count() == 1 {
            return 0;
        }
        let way = point - self.eye;
        let ring = (((chord(way) - self.low) / self.step) as usize).min(self.rings - 1);
        if self.sectors == 1 {
            return ring;
        }
        let turn = atan2(way.y, way.x) / std::f64::consts::TAU + 0.5;
        ring * self.sectors + ((turn * self.sectors as f64) as usize).min(self.sectors - 1)
    }
}

/// Returns the chord on the unit sphere between a direction and the axis toward the subject: twice the sine of half the angle.
fn chord(way: DVec3) -> f64 {
    let unit = way.normalize_or(DVec3::NEG_Z);
    (unit - DVec3::NEG_Z).length()
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DMat3;

    #[test]
    fn a_point_is_one_zone_and_a_wide_field_is_many() {
        let at = |deg: f64| DVec3::new(deg.to_radians().sin(), 0.0, -deg.to_radians().cos()) * 1e4;
        assert_eq!(Zones::new(&[at(20.0)], DVec3::ZERO, true).count(), 1);
        assert_eq!(Zones::new(&[at(19.735), at(20.265)], DVec3::ZERO, true).count(), 1);
        let wide = Zones::new(&[at(0.0), at(30.0)], DVec3::ZERO, true);
        assert_eq!((wide.count(), wide.of(at(0.0)), wide.of(at(29.9)), wide.of(at(80.0))), (12, 0, 11, 11));
        // The sun next to the middle of the field, where two of eight sectors meet.
        let edge = |turn: f64| DMat3::from_rotation_z(turn) * at(0.265);
        let aside = DMat3::from_rotation_y(-20.0_f64.to_radians());
        let sun: Vec<DVec3> = (0..8).map(|k| aside * edge(f64::from(k) * std::f64::consts::FRAC_PI_4)).collect();
        let sectors = Zones { eye: DVec3::ZERO, low: 0.0, step: 2.0, rings: 1, sectors: SECTORS };
        assert_ne!(sectors.of(sun[2]), sectors.of(sun[6]));
        assert_eq!(Zones::new(&sun, DVec3::ZERO, false).count(), 1);
        let turned = Zones::new(&[at(0.0), at(30.0)], DVec3::ZERO, false);
        assert_eq!(turned.count(), 96);
        assert_ne!(turned.of(at(20.0)), turned.of(DVec3::new(-1.0, 1.0, 1.0) * at(20.0)));
    }
}
