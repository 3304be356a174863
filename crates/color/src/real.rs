//! The colors that light can have: which lie beyond sRGB, how far, and where those go that no light has.
//!
//! A color is real if its chromaticity lies within the spectral locus and the line of purples (CIE 1931, 2 degrees). Smooth spectra
//! reach all but the last [`MARGIN`] of that. A color nearer to the rim, or beyond it, moves in xy toward D65 until it is within reach,
//! and keeps its luminance.
//!
//! Colors of linear sRGB with a negative value lie between the triangle of sRGB and that rim. [`RealColors::place`] says where: in which
//! direction from white, and how far from the triangle (0) to the rim (1). Tables of spectra are kept over these two numbers.

use crate::rgb::{RgbSpace, xyz_of_xy};
use spectra_core::stage::ColorGamut;
use spectra_spectrum::Observer;
use std::sync::OnceLock;

/// Distance in xy from the spectral locus and the line of purples that colors keep.
pub const MARGIN: f64 = 0.001;

/// A color brought into a gamut.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Fitted {
    /// Linear light, sRGB primaries.
    pub rgb: [f64; 3],
    /// How far it moved, a distance in xy; 0 where it stayed. Infinite where it became black, having no luminance.
    pub moved: f64,
}

/// A color of linear sRGB brought into `gamut`: toward D65 in xy, luminance kept. A color of negative luminance becomes black.
#[must_use]
pub fn fit(rgb: [f64; 3], gamut: ColorGamut) -> Fitted {
    if rgb.iter().all(|v| *v >= 0.0) {
        return Fitted { rgb, moved: 0.0 };
    }
    let Some(line) = Line::new(rgb) else { return Fitted { rgb: [0.0; 3], moved: f64::INFINITY } };
    let end = match gamut {
        ColorGamut::Srgb => line.border,
        ColorGamut::Real if RealColors::rough().toward(&line).2 >= 1.0 => 1.0,
        ColorGamut::Real => line.place_of(RealColors::exact(line.toward)),
    };
    if end >= 1.0 {
        return Fitted { rgb, moved: 0.0 };
    }
    let mut fitted = line.at(end);
    if gamut == ColorGamut::Srgb {
        fitted = fitted.map(|v| v.max(0.0));
    }
    // What has no chromaticity is beyond the whole diagram.
    Fitted { rgb: fitted, moved: (line.distance(1.0) - line.distance(end)).min(1.0) }
}

/// Where a color beyond sRGB lies.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Place {
    /// The direction before it, counted from 0, and how far it lies toward the next one, 0 to 1.
    pub direction: usize,
    /// See [`Place::direction`].
    pub along: f64,
    /// 0 on the triangle of sRGB, 1 on the rim.
    pub depth: f64,
    /// Its largest value of red, green and blue, moved onto the rim where it lay beyond.
    pub largest: f64,
}

/// Directions from white, each with the point of the rim that it leads to.
#[derive(Clone, Debug)]
pub struct RealColors {
    /// Turn of each direction, rising from 0 to 4.
    turns: Vec<f64>,
    /// From white to the rim, in xy.
    rim: Vec<[f64; 2]>,
}

impl RealColors {
    /// The rim seen in these directions, given by their turns ([`RealColors::turn`]); 0 and 4, which are one, are added.
    #[must_use]
    pub fn new(turns: impl IntoIterator<Item = f64>) -> Self {
        let mut turns: Vec<f64> =
            turns.into_iter().filter(|turn| *turn > 0.0 && *turn < 4.0).chain([0.0, 4.0]).collect();
        turns.sort_by(f64::total_cmp);
        turns.dedup();
        let rim = turns.iter().map(|turn| Self::rim_at(*turn)).collect();
        Self { turns, rim }
    }

    /// Even turns, and those of the corners of sRGB, where the way to the rim has a kink.
    #[must_use]
    pub fn even(count: usize) -> Self {
        let white = RgbSpace::srgb().white_xy;
        let corners = RgbSpace::srgb().primaries_xy.map(|xy| Self::turn([xy[0] - white[0], xy[1] - white[1]]));
        Self::new((0..count).map(|i| 4.0 * i as f64 / count as f64).chain(corners))
    }

    /// Turns of its directions, from 0 to 4.
    #[must_use]
    pub fn turns(&self) -> &[f64] {
        &self.turns
    }

    /// Where a color of linear sRGB with a negative value lies; `None` where it has no luminance.
    #[must_use]
    pub fn place(&self, rgb: [f64; 3]) -> Option<Place> {
        let line = Line::new(rgb)?;
        let (direction, along, rim) = self.toward(&line);
        let depth = if rim < 1.0 {
            1.0
        } else {
            let [own, border] = [1.0, line.border].map(|place| line.distance(place));
            let whole = length(self.rim_between(direction, along)) - border;
            ((own - border) / whole).clamp(0.0, 1.0)
        };
        let [r, g, b] = if rim < 1.0 { line.at(rim) } else { rgb };
        Some(Place { direction, along, depth, largest: r.max(g).max(b) })
    }

    /// The direction before a line, how far it lies toward the next, and its place on the chord of the rim between both.
    fn toward(&self, line: &Line) -> (usize, f64, f64) {
        let turn = Self::turn(line.toward);
        let direction = self.turns.partition_point(|t| *t <= turn).clamp(1, self.turns.len() - 1) - 1;
        let [a, b] = [self.rim[direction], self.rim[direction + 1]];
        let [before, behind] = [cross(a, line.toward), cross(line.toward, b)];
        let along = (before / (before + behind)).clamp(0.0, 1.0);
        (direction, along, line.place_of(self.rim_between(direction, along)))
    }

    /// The rim between a direction and the next one, on the chord, from white in xy.
    fn rim_between(&self, direction: usize, along: f64) -> [f64; 2] {
        let [a, b] = [self.rim[direction], self.rim[direction + 1]];
        [a[0] + (b[0] - a[0]) * along, a[1] + (b[1] - a[1]) * along]
    }

    /// Chords that lie within reach, by which most colors are known to do so, too.
    fn rough() -> &'static Self {
        static ONE: OnceLock<RealColors> = OnceLock::new();
        ONE.get_or_init(|| Self::even(360))
    }

    /// The color in a direction, by its turn, at `depth`, scaled to a largest value of 1.
    #[must_use]
    pub fn color(turn: f64, depth: f64) -> [f64; 3] {
        let srgb = RgbSpace::srgb();
        let [white, rim] = [srgb.white_xy, Self::rim_at(turn)];
        let at = |share: f64| [white[0] + share * rim[0], white[1] + share * rim[1]];
        let linear = |xy| srgb.from_xyz(xyz_of_xy(xy, 1.0));
        let border = Line::new(linear(at(1.0))).map_or(1.0, |line| line.distance(line.border) / line.distance(1.0));
        let rgb = linear(at(border + depth * (1.0 - border)));
        let largest = rgb[0].max(rgb[1]).max(rgb[2]);
        rgb.map(|v| v / largest)
    }

    /// A direction in xy as a number from 0 (+x) by 1 (+y), 2 (-x), 3 (-y) to 4.
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

    /// From white to the rim in the direction `along`.
    fn exact(along: [f64; 2]) -> [f64; 2] {
        let share = edges().iter().fold(f64::INFINITY, |share, edge| {
            let toward = edge.inward[0] * along[0] + edge.inward[1] * along[1];
            if toward < 0.0 { share.min(edge.from_white / -toward) } else { share }
        });
        along.map(|v| v * share)
    }
}

/// The line from white through a color beyond sRGB, at constant luminance: 0 is white, 1 the color.
struct Line {
    rgb: [f64; 3],
    luminance: f64,
    /// X + Y + Z of the color, and of white of its luminance. The former may be negative of a color that no light has.
    sums: [f64; 2],
    /// From white toward the color in xy, times that of the color's `sums`.
    toward: [f64; 2],
    /// Where it leaves sRGB.
    border: f64,
}

impl Line {
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

    /// The color there.
    fn at(&self, place: f64) -> [f64; 3] {
        self.rgb.map(|v| self.luminance + place * (v - self.luminance))
    }

    /// Distance of a place from white in xy; infinite where it has no chromaticity.
    fn distance(&self, place: f64) -> f64 {
        let [sum, white] = self.sums;
        let sum = white + place * (sum - white);
        if sum > 0.0 { place * length(self.toward) / sum } else { f64::INFINITY }
    }

    /// The place of a point in this direction, given from white in xy; infinite where the line does not come so far.
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

/// A side of the polygon within reach.
struct Edge {
    /// Unit vector.
    inward: [f64; 2],
    /// Distance from white.
    from_white: f64,
}

/// The sides of the convex hull of the spectral locus, moved inward by [`MARGIN`].
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

/// Corners of the convex hull, counterclockwise (A. M. Andrew, Information Processing Letters 9, 216, 1979).
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

    /// Spectral light moves by the margin over the cosine between the way to white and the rim's normal: a thousandth and little more; a
    /// little less about 450 nm, where the locus lies inside of its hull.
    #[test]
    fn spectral_light_moves_by_the_margin() {
        let luminance = |rgb| RgbSpace::srgb().luminance(rgb);
        for nm in (400..=690).step_by(5) {
            let rgb = spectral(f64::from(nm));
            let moved = fit(rgb, ColorGamut::Real);
            assert!((0.9 * MARGIN..3.0 * MARGIN).contains(&moved.moved), "{nm}: {moved:?}");
            assert!((luminance(moved.rgb) / luminance(rgb) - 1.0).abs() < 1e-9, "{nm}");
            let [a, b] = [xy(rgb), xy(moved.rgb)];
            assert!((length([a[0] - b[0], a[1] - b[1]]) - moved.moved).abs() < 1e-12, "{nm}");
            // Once within reach it stays.
            assert!(fit(moved.rgb.map(|v| v * 3.0), ColorGamut::Real).moved < 1e-12, "{nm}");
        }
    }

    /// Primaries of wide spaces by their published chromaticities: the red of Rec. 2020 is the light of 630 nm, its green that of 532 nm,
    /// its blue that of 467 nm; those of ACEScg are imaginary, and of P3 the red alone is nearer to the locus than the margin.
    #[test]
    fn primaries_of_wide_spaces() {
        let moved = |space: &RgbSpace| {
            space.primaries_xy.map(|xy| fit(RgbSpace::srgb().from_xyz(xyz_of_xy(xy, 1.0)), ColorGamut::Real).moved)
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
            let got = fit(rgb, ColorGamut::Srgb);
            let luminance = |rgb| RgbSpace::srgb().luminance(rgb);
            assert!((luminance(got.rgb) / luminance(rgb) - 1.0).abs() < 1e-12, "{got:?}");
            assert!(got.rgb.iter().all(|v| *v >= 0.0) && got.rgb.iter().any(|v| *v < 1e-12), "{got:?}");
            let [a, b] = [xy(rgb), xy(got.rgb)];
            assert!((length([a[0] - b[0], a[1] - b[1]]) - got.moved).abs() < 1e-12, "{got:?}");
        }
        for gamut in [ColorGamut::Srgb, ColorGamut::Real] {
            assert_eq!(fit([0.2, 0.0, 7.0], gamut), Fitted { rgb: [0.2, 0.0, 7.0], moved: 0.0 });
            assert_eq!(fit([0.1, -0.5, 0.2], gamut), Fitted { rgb: [0.0; 3], moved: f64::INFINITY });
            // Of positive luminance, but X + Y + Z is negative: moved as what lies just before it is.
            let [before, beyond] = [-0.44, -0.46].map(|blue| fit([0.2, 0.2, blue], gamut));
            assert!(
                beyond.moved == 1.0 && (RgbSpace::srgb().luminance(beyond.rgb) - 0.1524).abs() < 1e-3,
                "{beyond:?}"
            );
            assert!(before.rgb.iter().zip(beyond.rgb).all(|(a, b)| (a - b).abs() < 0.01), "{before:?} {beyond:?}");
        }
    }

    /// A place leads back to the color that it was found for.
    #[test]
    fn places_lead_to_their_colors() {
        let real = RealColors::even(360);
        for (i, turn) in real.turns().windows(2).enumerate() {
            for (share, depth) in [(0.0, 0.0), (0.3, 0.5), (0.5, 0.999), (0.9, 1.0)] {
                let turn = turn[0] + share * (turn[1] - turn[0]);
                let color = RealColors::color(turn, depth);
                if color.iter().all(|v| *v >= -1e-12) {
                    continue;
                }
                let place = real.place(color.map(|v| 5.0 * v)).expect("light");
                assert!(place.direction == i || share == 0.0, "{turn} {place:?}");
                // The rim between two directions is a chord of the curve.
                assert!((place.depth - depth).abs() < 0.01, "{turn} {depth} {place:?}");
                // What lies beyond it moves onto it, and is less deep a violet at the sharp corner there.
                let largest = (place.largest / 5.0 - 1.0).abs();
                assert!(largest < 0.005 || place.depth == 1.0, "{turn} {depth} {place:?}");
            }
        }
        assert_eq!(real.place([0.1, -0.5, 0.2]), None);
    }
}
