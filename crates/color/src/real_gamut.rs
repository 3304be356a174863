//! Real colors: which colors outside sRGB light can have, and where the others are moved.
//!
//! A color is real if its chromaticity lies inside the spectral locus and the line of purples (CIE 1931, 2 degrees). Smooth spectra reach
//! this whole area except for its last [`MARGIN`].
//! The boundary of the reachable colors lies this far inside. A color beyond the boundary moves in xy toward D65 until it lies on the
//! boundary, and keeps its luminance.
//!
//! Reachable colors of linear sRGB with a negative value lie between the sRGB triangle and this boundary. [`RealGamut::place`] computes
//! where: the direction from white, and the depth from the triangle (0) to the boundary (1).
//! Tables of spectra are indexed by these two numbers.

use crate::rgb::{RgbSpace, xyz_of_xy};
use spectra_core::stage::ColorGamut;
use spectra_spectrum::Observer;
use std::sync::OnceLock;

/// Smallest distance of a reachable color from the spectral locus and the line of purples, in xy.
pub const MARGIN: f64 = 0.001;

/// A color brought into a gamut.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GamutFit {
    /// The color in linear sRGB.
    pub rgb: [f64; 3],
    /// Distance moved in xy, at most 1; 0 if the color did not move. Infinite if the color became black because its luminance was not
    /// positive.
    pub distance_xy: f64,
}

/// Brings a color of linear sRGB into `gamut`: moves it in xy toward D65 and keeps its luminance. A color whose luminance is not positive
/// becomes black.
#[must_use]
pub fn fit_to_gamut(rgb: [f64; 3], gamut: ColorGamut) -> GamutFit {
    if rgb.iter().all(|v| *v >= 0.0) {
        return GamutFit { rgb, distance_xy: 0.0 };
    }
    let Some(line) = WhiteLine::new(rgb) else { return GamutFit { rgb: [0.0; 3], distance_xy: f64::INFINITY } };
    let end = match gamut {
        ColorGamut::Srgb => line.border,
        ColorGamut::Real if RealGamut::rough().toward(&line).2 >= 1.0 => 1.0,
        ColorGamut::Real => line.place_of(RealGamut::exact(line.toward)),
    };
    if end >= 1.0 {
        return GamutFit { rgb, distance_xy: 0.0 };
    }
    let mut fitted = line.at(end);
    if gamut == ColorGamut::Srgb {
        fitted = fitted.map(|v| v.max(0.0));
    }
    // A color without a chromaticity counts as beyond the whole diagram.
    GamutFit { rgb: fitted, distance_xy: (line.distance(1.0) - line.distance(end)).min(1.0) }
}

/// Position of a color outside sRGB, relative to the triangle of sRGB and the boundary of the real colors.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GamutPosition {
    /// Index of the direction before the color's direction, from 0, in [`RealGamut::turns`].
    pub direction: usize,
    /// Position of the color's direction between this direction (0) and the next (1).
    pub fraction: f64,
    /// Depth of the color: 0 on the sRGB triangle, 1 on the boundary.
    pub depth: f64,
    /// Largest of the red, green and blue values. A color beyond the boundary is moved onto it first.
    pub peak: f64,
}

/// The boundary of the real colors, sampled in directions from white.
#[derive(Clone, Debug)]
pub struct RealGamut {
    /// Turn of each direction, ascending from 0 to 4.
    turns: Vec<f64>,
    /// Vectors from white to the boundary, in xy.
    rim: Vec<[f64; 2]>,
}

impl RealGamut {
    /// Samples the boundary in the directions with these turns (see [`RealGamut::turn`]). The turns 0 and 4, which are the same
    /// direction, are added.
    #[must_use]
    pub fn new(turns: impl IntoIterator<Item = f64>) -> Self {
        let mut turns: Vec<f64> =
            turns.into_iter().filter(|turn| *turn > 0.0 && *turn < 4.0).chain([0.0, 4.0]).collect();
        turns.sort_by(f64::total_cmp);
        turns.dedup();
        let rim = turns.iter().map(|turn| Self::rim_at(*turn)).collect();
        Self { turns, rim }
    }

    /// Samples the boundary in `count` evenly spaced turns, and in the directions of the corners of the sRGB triangle, where the
    /// depth has a kink.
    #[must_use]
    pub fn even(count: usize) -> Self {
        let white = RgbSpace::srgb().white_xy;
        let corners = RgbSpace::srgb().primaries_xy.map(|xy| Self::turn([xy[0] - white[0], xy[1] - white[1]]));
        Self::new((0..count).map(|i| 4.0 * i as f64 / count as f64).chain(corners))
    }

    /// Turns of the directions, ascending from 0 to 4.
    #[must_use]
    pub fn turns(&self) -> &[f64] {
        &self.turns
    }

    /// Finds the position of a linear sRGB color that has a negative value; `None` if its luminance is not positive.
    #[must_use]
    pub fn place(&self, rgb: [f64; 3]) -> Option<GamutPosition> {
        let line = WhiteLine::new(rgb)?;
        let (direction, along, rim) = self.toward(&line);
        let depth = if rim < 1.0 {
            1.0
        } else {
            let [own, border] = [1.0, line.border].map(|place| line.distance(place));
            let whole = length(self.rim_between(direction, along)) - border;
            ((own - border) / whole).clamp(0.0, 1.0)
        };
        let [r, g, b] = if rim < 1.0 { line.at(rim) } else { rgb };
        Some(GamutPosition { direction, fraction: along, depth, peak: r.max(g).max(b) })
    }

    /// Finds the direction before a line, how far the line lies toward the next one, and the parameter at which it meets the chord between
    /// both.
    fn toward(&self, line: &WhiteLine) -> (usize, f64, f64) {
        let turn = Self::turn(line.toward);
        let direction = self.turns.partition_point(|t| *t <= turn).clamp(1, self.turns.len() - 1) - 1;
        let [a, b] = [self.rim[direction], self.rim[direction + 1]];
        let [before, behind] = [cross(a, line.toward), cross(line.toward, b)];
        let along = (before / (before + behind)).clamp(0.0, 1.0);
        (direction, along, line.place_of(self.rim_between(direction, along)))
    }

    /// Vector in xy from white to the boundary between a direction and the next one, on the chord.
    fn rim_between(&self, direction: usize, along: f64) -> [f64; 2] {
        let [a, b] = [self.rim[direction], self.rim[direction + 1]];
        [a[0] + (b[0] - a[0]) * along, a[1] + (b[1] - a[1]) * along]
    }

    /// Coarse directions whose chords lie inside the boundary. They suffice to show that most colors are reachable.
    fn rough() -> &'static Self {
        static ONE: OnceLock<RealGamut> = OnceLock::new();
        ONE.get_or_init(|| Self::even(360))
    }

    /// Returns the color in the direction `turn` (0 to 4) from white at `depth` (0 to 1), in linear sRGB, scaled so that its
    /// largest value is 1.
    #[must_use]
    pub fn color(turn: f64, depth: f64) -> [f64; 3] {
        let srgb = RgbSpace::srgb();
        let [white, rim] = [srgb.white_xy, Self::rim_at(turn)];
        let at = |share: f64| [white[0] + share * rim[0], white[1] + share * rim[1]];
        let linear = |xy| srgb.from_xyz(xyz_of_xy(xy, 1.0));
        let border =
            WhiteLine::new(linear(at(1.0))).map_or(1.0, |line| line.distance(line.border) / line.distance(1.0));
        let rgb = linear(at(border + depth * (1.0 - border)));
        let largest = rgb[0].max(rgb[1]).max(rgb[2]);
        rgb.map(|v| v / largest)
    }

    /// Converts a direction in xy to a turn, a measure of angle that rises counterclockwise from 0 (+x) through 1 (+y), 2 (-x)
    /// and 3 (-y) to 4.
    #[must_use]
    pub fn turn([x, y]: [f64; 2]) -> f64 {
        let part = x / (x.abs() + y.abs());
        if y >= 0.0 { 1.0 - part } else { 3.0 + part }
    }

    fn rim_at(turn: f64) -> [f64; 2] {
        let along =
            if turn <= 2.0 { [1.0 - turn, 1.0 - (1.0 - turn).abs()] } else { [turn - 3.0, (turn - 3.0).abs() - 1.0] };
        Self::exact(along)
    }

    /// Vector in xy from white to the boundary in the direction `along`.
    fn exact(along: [f64; 2]) -> [f64; 2] {
        let share = edges().iter().fold(f64::INFINITY, |share, edge| {
            let toward = edge.inward[0] * along[0] + edge.inward[1] * along[1];
            if toward < 0.0 { share.min(edge.from_white / -toward) } else { share }
        });
        along.map(|v| v * share)
    }
}

/// The line from white through a color outside sRGB, at constant luminance. Its parameter is 0 at white and 1 at the color.
struct WhiteLine {
    rgb: [f64; 3],
    luminance: f64,
    /// X + Y + Z of the color, and of white of the same luminance. The former may be negative for a color that no light has.
    sums: [f64; 2],
    /// Vector from white to the color in xy, multiplied by X + Y + Z of the color.
    toward: [f64; 2],
    /// Parameter at which the line leaves sRGB.
    border: f64,
}

impl WhiteLine {
    fn new(rgb: [f64; 3]) -> Option<Self> {
        let srgb = RgbSpace::srgb();
        let [x, luminance, z] = srgb.to_xyz(rgb);
        let (sum, white) = (x + luminance + z, luminance / srgb.white_xy[1]);
        if !(luminance > 0.0 && sum.is_finite()) {
            return None;
        }
        let toward = [x - srgb.white_xy[0] * sum, luminance - srgb.white_xy[1] * sum];
        let least = rgb[0].min(rgb[1]).min(rgb[2]);
        Some(Self { rgb, luminance, sums: [sum, white], toward, border: luminance / (luminance - least) })
    }

    /// The color at the parameter `place`, in linear sRGB.
    fn at(&self, place: f64) -> [f64; 3] {
        self.rgb.map(|v| self.luminance + place * (v - self.luminance))
    }

    /// Distance in xy from white to the parameter `place`; infinite if there is no chromaticity.
    fn distance(&self, place: f64) -> f64 {
        let [sum, white] = self.sums;
        let sum = white + place * (sum - white);
        if sum > 0.0 { place * length(self.toward) / sum } else { f64::INFINITY }
    }

    /// Parameter of a point in this direction, given as a vector from white in xy; infinite if the line does not reach it.
    fn place_of(&self, point: [f64; 2]) -> f64 {
        let [sum, white] = self.sums;
        let dot = |a: [f64; 2]| a[0] * self.toward[0] + a[1] * self.toward[1];
        let share = dot(point) / dot(self.toward);
        let left = 1.0 - share * (sum - white);
        if left > 0.0 { share * white / left } else { f64::INFINITY }
    }
}

fn cross(a: [f64; 2], b: [f64; 2]) -> f64 {
    a[0] * b[1] - a[1] * b[0]
}

fn length(a: [f64; 2]) -> f64 {
    (a[0] * a[0] + a[1] * a[1]).sqrt()
}

/// A side of the polygon of reachable chromaticities.
struct Edge {
    /// Inward normal, a unit vector.
    inward: [f64; 2],
    /// Distance of the side from white, in xy.
    from_white: f64,
}

/// Sides of the convex hull of the spectral locus, moved inward by [`MARGIN`].
fn edges() -> &'static [Edge] {
    static ONE: OnceLock<Vec<Edge>> = OnceLock::new();
    ONE.get_or_init(|| {
        let observer = Observer::cie_1931_2deg();
        let spectral = (360..=830).map(|nm| {
            let [x, y, z] = observer.at(f64::from(nm));
            [x / (x + y + z), y / (x + y + z)]
        });
        let hull = hull(spectral.collect());
        let white = RgbSpace::srgb().white_xy;
        (0..hull.len())
            .map(|i| {
                let (a, b) = (hull[i], hull[(i + 1) % hull.len()]);
                let along = [b[0] - a[0], b[1] - a[1]];
                let inward = [-along[1] / length(along), along[0] / length(along)];
                let from_white = inward[0] * (white[0] - a[0]) + inward[1] * (white[1] - a[1]);
                Edge { inward, from_white: from_white - MARGIN }
            })
            .collect()
    })
}

/// Returns the corners of the convex hull, counterclockwise (A. M. Andrew, Information Processing Letters 9, 216, 1979).
fn hull(mut points: Vec<[f64; 2]>) -> Vec<[f64; 2]> {
    points.sort_by(|a, b| a[0].total_cmp(&b[0]).then(a[1].total_cmp(&b[1])));
    let half = |points: &mut dyn Iterator<Item = [f64; 2]>| {
        let mut chain: Vec<[f64; 2]> = Vec::new();
        for p in points {
            while let [.., a, b] = chain[..] {
                if cross([b[0] - a[0], b[1] - a[1]], [p[0] - b[0], p[1] - b[1]]) > 0.0 {
                    break;
                }
                chain.pop();
            }
            chain.push(p);
        }
        chain.pop();
        chain
    };
    let mut all = half(&mut points.iter().copied());
    all.extend(half(&mut points.iter().rev().copied()));
    all
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::chromaticity;

    fn xy(rgb: [f64; 3]) -> [f64; 2] {
        chromaticity(RgbSpace::srgb().to_xyz(rgb)).expect("light")
    }

    fn spectral(nm: f64) -> [f64; 3] {
        RgbSpace::srgb().from_xyz(Observer::cie_1931_2deg().at(nm))
    }

    /// Spectral light moves by the margin divided by the cosine between the direction to white and the normal of the boundary: a little
    /// more than a thousandth.
    /// Near 450 nm it moves a little less, because the locus lies inside its hull there.
    #[test]
    fn spectral_light_moves_by_the_margin() {
        let luminance = |rgb| RgbSpace::srgb().luminance(rgb);
        for nm in (400..=690).step_by(5) {
            let rgb = spectral(f64::from(nm));
            let moved = fit_to_gamut(rgb, ColorGamut::Real);
            assert!((0.9 * MARGIN..3.0 * MARGIN).contains(&moved.distance_xy), "{nm}: {moved:?}");
            assert!((luminance(moved.rgb) / luminance(rgb) - 1.0).abs() < 1e-9, "{nm}");
            let [a, b] = [xy(rgb), xy(moved.rgb)];
            assert!((length([a[0] - b[0], a[1] - b[1]]) - moved.distance_xy).abs() < 1e-12, "{nm}");
            // A reachable color does not move.
            assert!(fit_to_gamut(moved.rgb.map(|v| v * 3.0), ColorGamut::Real).distance_xy < 1e-12, "{nm}");
        }
    }

    /// Fits primaries of wide spaces by their published chromaticities. Those of Rec. 2020 are light of 630 nm, 532 nm and 467 nm; those of
    /// ACEScg are imaginary.
    /// Of Display P3, only the red is nearer to the locus than the margin.
    #[test]
    fn primaries_of_wide_spaces() {
        let moved = |space: &RgbSpace| {
            space
                .primaries_xy
                .map(|xy| fit_to_gamut(RgbSpace::srgb().from_xyz(xyz_of_xy(xy, 1.0)), ColorGamut::Real).distance_xy)
        };
        assert!(moved(RgbSpace::rec2020()).iter().all(|m| *m < 0.003), "{:?}", moved(RgbSpace::rec2020()));
        assert!(moved(RgbSpace::rec2020())[0] > 0.0);
        assert!(moved(RgbSpace::aces_cg()).iter().all(|m| *m > 0.003), "{:?}", moved(RgbSpace::aces_cg()));
        let [red, green, _] = moved(RgbSpace::display_p3());
        assert!(red > 0.0 && red < 0.003 && green == 0.0, "{red} {green}");
    }

    #[test]
    fn into_srgb_keeps_luminance_and_leaves_no_negative_value() {
        for rgb in [[0.9, 0.5, -0.2], [-0.3, 0.4, 0.5], [0.1, -0.05, 0.9], [4.0, -0.1, -0.2]] {
            let got = fit_to_gamut(rgb, ColorGamut::Srgb);
            let luminance = |rgb| RgbSpace::srgb().luminance(rgb);
            assert!((luminance(got.rgb) / luminance(rgb) - 1.0).abs() < 1e-12, "{got:?}");
            assert!(got.rgb.iter().all(|v| *v >= 0.0) && got.rgb.iter().any(|v| *v < 1e-12), "{got:?}");
            let [a, b] = [xy(rgb), xy(got.rgb)];
            assert!((length([a[0] - b[0], a[1] - b[1]]) - got.distance_xy).abs() < 1e-12, "{got:?}");
        }
        for gamut in [ColorGamut::Srgb, ColorGamut::Real] {
            assert_eq!(fit_to_gamut([0.2, 0.0, 7.0], gamut), GamutFit { rgb: [0.2, 0.0, 7.0], distance_xy: 0.0 });
            assert_eq!(fit_to_gamut([0.1, -0.5, 0.2], gamut), GamutFit { rgb: [0.0; 3], distance_xy: f64::INFINITY });
            // Its luminance is positive, but X + Y + Z is negative. The color moves as one just before this limit does.
            let [before, beyond] = [-0.44, -0.46].map(|blue| fit_to_gamut([0.2, 0.2, blue], gamut));
            assert!(
                beyond.distance_xy == 1.0 && (RgbSpace::srgb().luminance(beyond.rgb) - 0.1524).abs() < 1e-3,
                "{beyond:?}"
            );
            assert!(before.rgb.iter().zip(beyond.rgb).all(|(a, b)| (a - b).abs() < 0.01), "{before:?} {beyond:?}");
        }
    }

    /// A position leads back to the color from which it was computed.
    #[test]
    fn places_lead_to_their_colors() {
        let real = RealGamut::even(360);
        for (i, turn) in real.turns().windows(2).enumerate() {
            for (share, depth) in [(0.0, 0.0), (0.3, 0.5), (0.5, 0.999), (0.9, 1.0)] {
                let turn = turn[0] + share * (turn[1] - turn[0]);
                let color = RealGamut::color(turn, depth);
                if color.iter().all(|v| *v >= -1e-12) {
                    continue;
                }
                let place = real.place(color.map(|v| 5.0 * v)).expect("light");
                assert!(place.direction == i || share == 0.0, "{turn} {place:?}");
                // The boundary between two directions is a chord of the curve.
                assert!((place.depth - depth).abs() < 0.01, "{turn} {depth} {place:?}");
                // A color beyond the chord moves onto it. Near the sharp corner at violet this changes the color.
                let largest = (place.peak / 5.0 - 1.0).abs();
                assert!(largest < 0.005 || place.depth == 1.0, "{turn} {depth} {place:?}");
            }
        }
        assert_eq!(real.place([0.1, -0.5, 0.2]), None);
    }
}
