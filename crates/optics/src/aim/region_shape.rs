//! The ellipse or rectangle that contains points on a plane.

use super::probe::Bounds;
use spectra_core::math::sin_cos_turns;

/// An ellipse along the axes of its plane, or the rectangle around it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct RegionShape {
    pub center: [f64; 2],
    pub half: [f64; 2],
    pub ellipse: bool,
}

impl RegionShape {
    /// Returns the smaller of the rectangle and the ellipse that contain all points with `margin` around each. The ellipse
    /// has the center and the proportions of the rectangle. Returns `None` if there are no points.
    pub fn around(places: &[[f64; 2]], margin: [f64; 2]) -> Option<Self> {
        let bounds = Bounds::around(places)?.widened(margin);
        let (center, half) = (bounds.center(), bounds.half());
        let reach2 = places.iter().map(|p| {
            let [a, b] = std::array::from_fn(|i| ((p[i] - center[i]).abs() + margin[i]) / half[i]);
            a * a + b * b
        });
        let reach2 = reach2.fold(0.0, f64::max).max(1e-6);
        // Relative areas: 4 for the rectangle, pi times the square of the reach for the ellipse.
        let ellipse = std::f64::consts::PI * reach2 < 4.0;
        let scale = if ellipse { reach2.sqrt() } else { 1.0 };
        Some(Self { center, half: half.map(|h| h * scale), ellipse })
    }

    /// Returns a point around the shape: on its edge for `reach` 1, farther out for more. `share` in [0, 1) goes around.
    pub fn beside(&self, share: f64, reach: f64) -> [f64; 2] {
        let (sin, cos) = sin_cos_turns(share);
        let scale = if self.ellipse { reach } else { reach / sin.abs().max(cos.abs()) };
        [self.center[0] + self.half[0] * cos * scale, self.center[1] + self.half[1] * sin * scale]
    }

    /// Whether the shape contains a point.
    #[cfg(test)]
    pub fn holds(&self, place: [f64; 2]) -> bool {
        let [a, b] = std::array::from_fn(|i| (place[i] - self.center[i]).abs() / self.half[i]);
        if self.ellipse { a * a + b * b <= 1.0 } else { a <= 1.0 && b <= 1.0 }
    }
}

/// Returns the corners of the convex hull (A. M. Andrew's monotone chain, Inf. Process. Lett. 9, 1979). Any
/// convex shape that contains them contains all points, also as seen on another plane from the same point.
pub(super) fn hull(places: &[[f64; 2]]) -> Vec<[f64; 2]> {
    // Among points on one line along the second axis, those between its ends are no corners.
    let ends = |line: &[[f64; 2]]| {
        let of = |better: fn(f64, f64) -> bool| {
            line.iter().copied().reduce(|a, b| if better(b[1], a[1]) { b } else { a }).unwrap_or_default()
        };
        [of(|a, b| a < b), of(|a, b| a > b)].into_iter().take(line.len())
    };
    let mut sorted: Vec<[f64; 2]> = places.chunk_by(|a, b| a[0] == b[0]).flat_map(ends).collect();
    sorted.sort_unstable_by(|a, b| a[0].total_cmp(&b[0]).then(a[1].total_cmp(&b[1])));
    if sorted.len() < 4 {
        return sorted;
    }
    let turns_left =
        |a: [f64; 2], b: [f64; 2], c: [f64; 2]| (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]) > 0.0;
    let half = |along: &mut dyn Iterator<Item = [f64; 2]>| {
        let mut chain: Vec<[f64; 2]> = Vec::new();
        for place in along {
            while chain.len() > 1 && !turns_left(chain[chain.len() - 2], chain[chain.len() - 1], place) {
                chain.pop();
            }
            chain.push(place);
        }
        chain.pop();
        chain
    };
    let mut corners = half(&mut sorted.iter().copied());
    corners.extend(half(&mut sorted.iter().rev().copied()));
    corners
}

#[cfg(test)]
mod tests {
    use super::*;
    use spectra_core::math::concentric_disk;

    fn disk(n: usize) -> Vec<[f64; 2]> {
        let at = |k: usize| (k as f64 + 0.5) / n as f64;
        (0..n * n)
            .map(|k| {
                let (p, q) = concentric_disk(at(k % n), at(k / n));
                [3.0 + 2.0 * p, -1.0 + 0.5 * q]
            })
            .collect()
    }

    #[test]
    fn a_disk_gets_an_ellipse_and_a_square_a_rectangle() {
        let shape = RegionShape::around(&disk(100), [0.0, 0.0]).unwrap();
        assert!(shape.ellipse);
        for (got, want) in
            [shape.center[0], shape.center[1], shape.half[0], shape.half[1]].iter().zip([3.0, -1.0, 2.0, 0.5])
        {
            assert!((got - want).abs() < 0.02, "{shape:?}");
        }
        let square: Vec<[f64; 2]> = (0..100).map(|k| [f64::from(k % 10), f64::from(k / 10)]).collect();
        let shape = RegionShape::around(&square, [0.0, 0.0]).unwrap();
        assert_eq!(shape, RegionShape { center: [4.5, 4.5], half: [4.5, 4.5], ellipse: false });
    }

    #[test]
    fn all_places_are_held_with_their_margin() {
        let places = disk(40);
        let shape = RegionShape::around(&places, [0.1, 0.05]).unwrap();
        for [x, y] in places {
            for turn in 0..16 {
                let (sin, cos) = spectra_core::math::sin_cos_turns(f64::from(turn) / 16.0);
                assert!(shape.holds([x + 0.1 * cos, y + 0.05 * sin]));
            }
        }
    }

    #[test]
    fn the_hull_holds_what_its_places_hold() {
        let places = disk(30);
        let corners = hull(&places);
        assert!(corners.len() < places.len() / 4);
        assert_eq!(RegionShape::around(&corners, [0.1, 0.1]), RegionShape::around(&places, [0.1, 0.1]));
        let square: Vec<[f64; 2]> = (0..100).map(|k| [f64::from(k % 10), f64::from(k / 10)]).collect();
        assert_eq!(hull(&square), [[0.0, 0.0], [9.0, 0.0], [9.0, 9.0], [0.0, 9.0]]);
    }

    #[test]
    fn beside_is_outside_of_both_kinds() {
        for ellipse in [false, true] {
            let shape = RegionShape { center: [1.0, 2.0], half: [3.0, 0.5], ellipse };
            for k in 0..40 {
                let share = (f64::from(k) + 0.3) / 40.0;
                assert!(!shape.holds(shape.beside(share, 1.0 + 1e-9)));
                assert!(shape.holds(shape.beside(share, 1.0 - 1e-9)));
            }
        }
    }

    #[test]
    fn nothing_has_no_shape() {
        assert_eq!(RegionShape::around(&[], [1.0, 1.0]), None);
    }
}
