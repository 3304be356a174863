//! Reaches: how far the passing light extends from a point in each direction, and the corners that represent it.

use spectra_core::math::{atan2, sin_cos_turns};
use std::sync::LazyLock;

/// Number of directions in which a reach is known.
pub(super) const DIRECTIONS: usize = 512;
/// Number of corners of an outline. They form as many triangles with the center, of nearly equal areas.
pub(super) const CORNERS: usize = 64;
/// Fraction of the farthest reach that a direction gets in which nothing passes, so that the outline goes around its center.
const LEAST: f64 = 0.15;
/// Number of directions to each side of a corner between which the corner is detected.
const NEAR: usize = 4;
/// Sine of the angle, 25 degrees, by which a line must turn from [`NEAR`] directions before a point to as many after it to have a
/// corner there.
const SHARP: f64 = 0.42;
/// Largest number of sharp corners; more of them count as roughness.
const MOST_SHARP: usize = 24;

/// Unit vectors of all directions.
static WAYS: LazyLock<[[f64; 2]; DIRECTIONS]> = LazyLock::new(|| {
    std::array::from_fn(|direction| {
        let (sin, cos) = sin_cos_turns(direction as f64 / DIRECTIONS as f64);
        [cos, sin]
    })
});

/// The smallest star-shaped region about the origin of a plane that contains all given lines and points: one radius per direction, mm.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct StarRegion([f64; DIRECTIONS]);

impl StarRegion {
    /// The empty reach, which contains nothing.
    pub const EMPTY: Self = Self([0.0; DIRECTIONS]);

    /// Returns the unit vector of a direction.
    pub fn way(direction: usize) -> [f64; 2] {
        WAYS[direction]
    }

    pub fn is_empty(&self) -> bool {
        self.0.iter().all(|r| *r <= 0.0)
    }

    /// Returns the area of the region in arbitrary units.
    pub fn area(&self) -> f64 {
        self.0.iter().map(|r| r * r).sum()
    }

    /// Returns the radius in a direction, mm.
    pub fn at(&self, direction: usize) -> f64 {
        self.0[direction]
    }

    /// Extends the region to contain a closed line.
    pub fn include(&mut self, line: &[[f64; 2]]) {
        let ways = &*WAYS;
        let Some(first) = line.first() else { return };
        let before = |place: [f64; 2]| (share(place) * DIRECTIONS as f64) as usize % DIRECTIONS;
        // The last direction at or before the point that the walk along the line has reached.
        let mut at = before(*first);
        for (k, &from) in line.iter().enumerate() {
            let to = line[(k + 1) % line.len()];
            let edge = [to[0] - from[0], to[1] - from[1]];
            let most = length(from).max(length(to));
            let distance = cross(from, edge);
            let mut meet = |d: usize| {
                let crossed = distance / cross(ways[d], edge);
                // If the edge runs along the line of sight, its farther end counts.
                let r = if crossed.is_finite() && crossed >= 0.0 { crossed.min(most) } else { most };
                self.0[d] = self.0[d].max(r);
            };
            // No edge spans more than half a turn.
            if distance >= 0.0 {
                for _ in 0..DIRECTIONS / 2 {
                    let next = (at + 1) % DIRECTIONS;
                    if cross(ways[next], to) < 0.0 {
                        break;
                    }
                    at = next;
                    meet(at);
                }
            } else {
                for _ in 0..DIRECTIONS / 2 {
                    if cross(ways[at], to) >= 0.0 {
                        break;
                    }
                    meet(at);
                    at = (at + DIRECTIONS - 1) % DIRECTIONS;
                }
            }
            let mut next = (at + 1) % DIRECTIONS;
            // An edge through or close to the origin may lead anywhere.
            if cross(ways[at], to) < 0.0 || cross(ways[next], to) > 0.0 {
                at = before(to);
                next = (at + 1) % DIRECTIONS;
            }
            // A corner between two directions counts for the nearer one.
            let d = if along(ways[at], to) >= along(ways[next], to) { at } else { next };
            self.0[d] = self.0[d].max(length(to));
        }
    }

    /// Extends the region to contain another one.
    pub fn join(&mut self, other: &Self) {
        self.0.iter_mut().zip(other.0).for_each(|(own, other)| *own = own.max(other));
    }

    /// Limits the region to another one.
    pub fn limit(&mut self, other: &Self) {
        self.0.iter_mut().zip(other.0).for_each(|(own, other)| *own = own.min(other));
    }

    /// Scales the region in proportion.
    pub fn scale(&mut self, by: f64) {
        self.0.iter_mut().for_each(|r| *r *= by);
    }

    /// Extends the region to contain a missed point and its neighborhood, unless the point lies within `slight` times the reach. The
    /// neighbors reach as far as the point or, if `alike` is true, grow at most in proportion, since along the tips of a star neighbors
    /// differ by more than the missed distance. Returns whether the point lay farther out than `by` times the reach.
    pub fn raise(&mut self, place: [f64; 2], slight: f64, by: f64, alike: bool) -> bool {
        let (middle, r) = ((share(place) * DIRECTIONS as f64).round() as usize, length(place));
        let own = self.0[middle % DIRECTIONS];
        if r > slight * own {
            let (upto, growth) = (1.002 * r, 1.002 * r / own);
            for d in middle + DIRECTIONS - 1..=middle + DIRECTIONS + 1 {
                let own = &mut self.0[d % DIRECTIONS];
                *own = own.max(if alike { upto.min(*own * growth) } else { upto });
            }
        }
        r > by * own
    }

    /// Returns the corners of an outline around the region, with the first one repeated at the end. They form triangles of
    /// nearly equal areas with the center.
    pub fn corners(&self) -> [[f32; 2]; CORNERS + 1] {
        let most = self.0.iter().fold(0.0_f64, |a, b| a.max(*b));
        if most <= 0.0 {
            return [[0.0; 2]; CORNERS + 1];
        }
        let edge: Vec<[f64; 2]> = (0..=DIRECTIONS)
            .map(|d| {
                let r = self.0[d % DIRECTIONS].max(LEAST * most);
                Self::way(d % DIRECTIONS).map(|w| w * r)
            })
            .collect();
        let mut upto = vec![0.0];
        for pair in edge.windows(2) {
            upto.push(upto[upto.len() - 1] + cross(pair[0], pair[1]));
        }
        let places = shares(&edge, &upto);
        // A chord may cut off what lies between its ends: both ends are moved out until it does not.
        let growth: Vec<f64> = (0..CORNERS)
            .map(|k| {
                let ((from, a), (to, b)) = (places[k], places[(k + 1) % CORNERS]);
                let to = if k + 1 == CORNERS { to + DIRECTIONS as f64 } else { to };
                let chord = [b[0] - a[0], b[1] - a[1]];
                let between = from.floor() as usize + 1..to.ceil() as usize;
                between.map(|d| cross(edge[d % DIRECTIONS], chord) / cross(a, chord)).fold(1.0, f64::max)
            })
            .collect();
        // The fan begins in the direction of the first point, so that neighboring outlines begin alike.
        let first =
            (0..CORNERS).min_by(|a, b| from_zero(places[*a].0).total_cmp(&from_zero(places[*b].0))).unwrap_or(0);
        std::array::from_fn(|k| {
            let k = (k + first) % CORNERS;
            let by = growth[k].max(growth[(k + CORNERS - 1) % CORNERS]);
            places[k].1.map(|p| (p * by) as f32)
        })
    }
}

/// Returns the distance of a direction from the first one, in turns; the direction may exceed a whole turn.
fn from_zero(direction: f64) -> f64 {
    let turns = direction / DIRECTIONS as f64;
    (turns - turns.round()).abs()
}

/// Finds the directions in which the line has sharp corners, in order.
fn sharp(edge: &[[f64; 2]]) -> Vec<usize> {
    let turn = |d: usize| {
        let [before, here, after] = [DIRECTIONS - NEAR, 0, NEAR].map(|k| edge[(d + k) % DIRECTIONS]);
        let (a, b) = ([here[0] - before[0], here[1] - before[1]], [after[0] - here[0], after[1] - here[1]]);
        let backward = a[0] * b[0] + a[1] * b[1] < 0.0;
        let sine = (cross(a, b) / (length(a) * length(b))).abs();
        if backward { 2.0 - sine } else { sine }
    };
    let turns: Vec<f64> = (0..DIRECTIONS).map(turn).collect();
    let is_peak = |d: &usize| {
        let near = |k: usize| turns[(d + DIRECTIONS + k - NEAR) % DIRECTIONS];
        // Among equal ones the first counts.
        turns[*d] > SHARP
            && (0..NEAR).all(|k| turns[*d] > near(k))
            && (NEAR + 1..=2 * NEAR).all(|k| turns[*d] >= near(k))
    };
    let found: Vec<usize> = (0..DIRECTIONS).filter(is_peak).collect();
    if found.len() > MOST_SHARP { Vec::new() } else { found }
}

/// Divides a line around the origin into pieces of nearly equal area and returns the points between them, with their directions. Sharp
/// corners come first, then even shares of the area between two of them. `upto` is the area before each direction.
fn shares(edge: &[[f64; 2]], upto: &[f64]) -> Vec<(f64, [f64; 2])> {
    let mut ends = sharp(edge);
    if ends.is_empty() {
        ends.push(0);
    }
    let whole = upto[DIRECTIONS];
    let area = |k: usize| {
        let next = if k + 1 < ends.len() { upto[ends[k + 1]] } else { whole + upto[ends[0]] };
        next - upto[ends[k]]
    };
    // One piece for each corner; the others go where the pieces are largest.
    let mut counts = vec![1_usize; ends.len()];
    for _ in ends.len()..CORNERS {
        let mean = |k: &usize| area(*k) / counts[*k] as f64;
        let largest = (0..ends.len()).max_by(|a, b| mean(a).total_cmp(&mean(b)).then(b.cmp(a))).unwrap_or(0);
        counts[largest] += 1;
    }
    let mut places = Vec::with_capacity(CORNERS);
    for (k, count) in counts.iter().enumerate() {
        for part in 0..*count {
            if part == 0 {
                places.push((ends[k] as f64, edge[ends[k]]));
                continue;
            }
            let want = upto[ends[k]] + area(k) * part as f64 / *count as f64;
            let (want, turn) = if want >= whole { (want - whole, DIRECTIONS as f64) } else { (want, 0.0) };
            let d = upto.partition_point(|area| *area <= want).clamp(1, DIRECTIONS) - 1;
            let part = (want - upto[d]) / (upto[d + 1] - upto[d]);
            let place = std::array::from_fn(|i| edge[d][i] + part * (edge[d + 1][i] - edge[d][i]));
            places.push((turn + d as f64 + part, place));
        }
    }
    places
}

fn cross(a: [f64; 2], b: [f64; 2]) -> f64 {
    a[0] * b[1] - a[1] * b[0]
}

fn along(a: [f64; 2], b: [f64; 2]) -> f64 {
    a[0] * b[0] + a[1] * b[1]
}

fn length(a: [f64; 2]) -> f64 {
    (a[0] * a[0] + a[1] * a[1]).sqrt()
}

/// Returns the azimuth of a point in turns, from 0 up to 1.
fn share(place: [f64; 2]) -> f64 {
    let turns = atan2(place[1], place[0]) / std::f64::consts::TAU;
    if turns < 0.0 { (turns + 1.0).min(1.0 - 1e-12) } else { turns }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn area(corners: &[[f32; 2]; CORNERS + 1]) -> f64 {
        corners.windows(2).map(|p| 0.5 * cross(p[0].map(f64::from), p[1].map(f64::from))).sum()
    }

    fn ring(n: usize, center: [f64; 2], r: impl Fn(usize) -> f64) -> Vec<[f64; 2]> {
        let at = |k: usize| {
            let (s, c) = sin_cos_turns(k as f64 / n as f64);
            [center[0] + r(k) * c, center[1] + r(k) * s]
        };
        (0..n).map(at).collect()
    }

    #[test]
    fn a_circle_and_a_star_keep_their_areas() {
        let mut circle = StarRegion::EMPTY;
        circle.include(&ring(400, [0.3, 0.1], |_| 2.0));
        let got = area(&circle.corners()) / (4.0 * std::f64::consts::PI);
        assert!((1.0..1.01).contains(&got), "{got}");
        let mut star = StarRegion::EMPTY;
        let line = ring(10, [0.0; 2], |k| if k % 2 == 0 { 10.0 } else { 3.82 });
        star.include(&line);
        let want: f64 = (0..10).map(|k| 0.5 * cross(line[k], line[(k + 1) % 10])).sum();
        let got = area(&star.corners()) / want;
        assert!((1.0..1.02).contains(&got), "{got}");
        // Triangles of a star have equal areas, too, within about a tenth.
        let corners = star.corners();
        for pair in corners.windows(2) {
            let own = 0.5 * cross(pair[0].map(f64::from), pair[1].map(f64::from)) / want * CORNERS as f64;
            assert!((own - 1.0).abs() < 0.12, "{own}");
        }
    }

    #[test]
    fn the_triangles_are_alike_and_hold_all_directions() {
        let mut reach = StarRegion::EMPTY;
        // A cat's eye beside its center.
        reach.include(&ring(200, [0.5, 0.0], |k| 1.0 - 0.4 * sin_cos_turns(k as f64 / 200.0).0.abs()));
        let corners = reach.corners();
        let mean = area(&corners) / CORNERS as f64;
        for pair in corners.windows(2) {
            let [a, b] = [pair[0].map(f64::from), pair[1].map(f64::from)];
            let own = 0.5 * cross(a, b);
            assert!(own > 0.9 * mean && own < 1.2 * mean, "{own} {mean}");
            for d in 0..DIRECTIONS {
                let way = StarRegion::way(d);
                if cross(a, way) >= 0.0 && cross(way, b) >= 0.0 {
                    let chord = [b[0] - a[0], b[1] - a[1]];
                    let r = cross(a, chord) / cross(way, chord);
                    assert!(r >= reach.at(d) * (1.0 - 1e-6), "{d}: {r} {}", reach.at(d));
                }
            }
        }
    }

    #[test]
    fn what_was_overlooked_is_held() {
        let mut reach = StarRegion::EMPTY;
        reach.include(&ring(100, [0.0; 2], |_| 1.0));
        assert!(reach.raise([0.0, 1.2], 1.01, 1.06, false));
        assert!(!reach.raise([0.0, 1.19], 1.01, 1.0, false));
        assert!(!reach.raise([1.005, 0.0], 1.01, 1.06, false));
        assert!(reach.at(DIRECTIONS / 4) >= 1.2 && reach.at(0) < 1.001);
        // Next to a point on the flank of a tip, the slope stays.
        let mut tip = StarRegion::EMPTY;
        tip.include(&ring(8, [0.0; 2], |k| if k % 2 == 0 { 10.0 } else { 3.0 }));
        let (before, d) = (tip.clone(), DIRECTIONS / 16);
        let r = 1.01 * tip.at(d);
        let place = StarRegion::way(d).map(|w| w * r);
        assert!(!tip.raise(place, 1.008, 1.025, true) && tip.at(d) >= r);
        for beside in [d - 1, d, d + 1] {
            assert!((1.0..1.013).contains(&(tip.at(beside) / before.at(beside))), "{beside}");
        }
    }
}
