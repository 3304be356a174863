//! Patterns of rays over a rectangle of a window.

use super::window::Extent;
use spectra_core::math::sin_cos_turns;

/// The arrangement of the rays of a bundle over a rectangle of its window.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RayPattern {
    /// Rays in the middles of a square grid with this many cells per side.
    Grid(usize),
    /// One ray in the middle, and 6 k rays on the k-th of this many rings. The last ring is the ellipse that touches the sides of
    /// the rectangle.
    Hexapolar(usize),
    /// This many rays that fill the rectangle evenly, for any number of them.
    Even(usize),
    /// Rays on the line through the middle along the window's first axis, ends included; this many.
    FanAcross(usize),
    /// Rays on the line through the middle along the window's second axis, ends included; this many.
    FanAlong(usize),
}

/// Reciprocals of the plastic number and of its square: the step of the R2 sequence (M. Roberts, "The unreasonable effectiveness of
/// quasirandom sequences", 2018).
const R2: [f64; 2] = [0.754_877_666_246_693, 0.569_840_290_998_053_3];

impl RayPattern {
    /// Returns the number of rays in the pattern.
    #[must_use]
    pub fn count(self) -> usize {
        match self {
            Self::Grid(cells) => cells * cells,
            Self::Hexapolar(rings) => 1 + 3 * rings * (rings + 1),
            Self::Even(count) | Self::FanAcross(count) | Self::FanAlong(count) => count,
        }
    }

    /// Returns the positions of the rays in `extent`, mm.
    pub fn places(self, extent: Extent) -> impl Iterator<Item = [f64; 2]> {
        let at = move |unit: [f64; 2]| [0, 1].map(|k| extent.min[k] + (extent.max[k] - extent.min[k]) * unit[k]);
        let part = |i: usize, count: usize| if count > 1 { i as f64 / (count - 1) as f64 } else { 0.5 };
        (0..self.count()).map(move |i| match self {
            Self::Grid(cells) => at([i % cells, i / cells].map(|k| (k as f64 + 0.5) / cells as f64)),
            Self::Hexapolar(rings) => at(hexapolar(i, rings)),
            Self::Even(_) => at(R2.map(|step| (0.5 + (i + 1) as f64 * step).fract())),
            Self::FanAcross(count) => at([part(i, count), 0.5]),
            Self::FanAlong(count) => at([0.5, part(i, count)]),
        })
    }
}

/// Returns the position of ray `i` of a hexapolar pattern in the unit square.
fn hexapolar(i: usize, rings: usize) -> [f64; 2] {
    let (mut ring, mut first) = (0, 0);
    while first + (6 * ring).max(1) <= i {
        first += (6 * ring).max(1);
        ring += 1;
    }
    let (sin, cos) = sin_cos_turns((i - first) as f64 / (6 * ring).max(1) as f64);
    let radius = 0.5 * ring as f64 / rings.max(1) as f64;
    [0.5 + radius * cos, 0.5 + radius * sin]
}

#[cfg(test)]
mod tests {
    use super::*;

    const EXTENT: Extent = Extent { min: [-2.0, 1.0], max: [4.0, 3.0] };

    #[test]
    fn every_pattern_lies_in_the_extent_about_its_middle() {
        let all = [
            RayPattern::Grid(7),
            RayPattern::Hexapolar(6),
            RayPattern::FanAcross(9),
            RayPattern::FanAlong(9),
            RayPattern::Even(1 << 14),
        ];
        for pattern in all {
            let places: Vec<_> = pattern.places(EXTENT).collect();
            assert_eq!(places.len(), pattern.count());
            for k in 0..2 {
                let inside = |p: &[f64; 2]| p[k] >= EXTENT.min[k] - 1e-12 && p[k] <= EXTENT.max[k] + 1e-12;
                assert!(places.iter().all(inside), "{pattern:?}");
                let mean = places.iter().map(|p| p[k]).sum::<f64>() / places.len() as f64;
                assert!((mean - 0.5 * (EXTENT.min[k] + EXTENT.max[k])).abs() < 1e-3, "{pattern:?} {mean}");
            }
        }
    }

    /// Counts rays in each of 8 by 8 boxes: a random pattern would vary by 12 % of 64 rays a box.
    #[test]
    fn even_fills_every_box() {
        let mut counts = [0; 64];
        for [x, y] in RayPattern::Even(64 * 64).places(Extent { min: [0.0; 2], max: [8.0; 2] }) {
            counts[x as usize + 8 * y as usize] += 1;
        }
        assert!(counts.iter().all(|count| (60..=68).contains(count)), "{counts:?}");
    }

    #[test]
    fn rings_hold_six_rays_more_each() {
        let radius = |p: [f64; 2]| ((p[0] - 0.5).powi(2) + (p[1] - 0.5).powi(2)).sqrt();
        let unit = Extent { min: [0.0; 2], max: [1.0; 2] };
        let radii: Vec<f64> = RayPattern::Hexapolar(3).places(unit).map(radius).collect();
        let on = |ring: usize| radii.iter().filter(|r| (*r - ring as f64 / 6.0).abs() < 1e-12).count();
        assert_eq!([0, 1, 2, 3].map(on), [1, 6, 12, 18]);
    }
}
