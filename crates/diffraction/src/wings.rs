//! The diffraction pattern of a point far from its core: the light that each edge of the opening sends along its normal.
//!
//! The squared transform of a polygon is a sum over pairs of edges. Pairs that do not meet beat with a period of wavelength times f-number,
//! which pixels and colors average out. What remains is the edges alone and the pairs that share a corner. An edge alone makes a spike
//! across it that falls off as 1/r^2, with the angular width wavelength over length. A bent edge sends its light into a fan of normals.

use crate::Polygon;
use spectra_core::math;
use std::f64::consts::{PI, TAU};
use std::sync::OnceLock;

/// Angle between successive edges below which they belong to one line, rad.
const CORNER_RAD: f64 = 0.2;
/// Angle below which a line of edges makes a spike rather than a fan, rad.
const SPIKE_RAD: f64 = 0.03;
/// Angle of the widest fan, rad: a line that bends by more is divided.
const WIDEST_RAD: f64 = 0.12;

/// The light that a line of edges diffracts to both its sides.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Fan {
    /// Unit vector in the middle of the fan, pointing out of the opening.
    pub normal: [f64; 2],
    /// Angle of the fan, rad; 0 for a straight edge.
    pub spread_rad: f64,
    /// Length of the edge from which the fan comes, in direction cosines.
    pub length: f64,
    /// Length of the whole line to which the edge belongs, in direction cosines.
    pub line: f64,
}

impl Fan {
    /// Returns whether the fan is a spike, which comes from a whole line that hardly bends.
    #[must_use]
    pub fn is_spike(&self) -> bool {
        self.length == self.line && self.spread_rad <= SPIKE_RAD
    }
}

/// The diffraction of a polygon far from its core.
#[derive(Clone, Debug, PartialEq)]
pub struct Wings {
    fans: Vec<Fan>,
    /// Indices of the fans before and after each corner.
    corners: Vec<[usize; 2]>,
    area: f64,
    /// Length of all edges together.
    around: f64,
}

impl Wings {
    /// Computes the wings of an opening given in direction cosines.
    #[must_use]
    pub fn new(opening: &Polygon) -> Self {
        let (mut fans, mut corners) = (Vec::new(), Vec::new());
        for ring in opening.rings() {
            lines(ring, &mut fans, &mut corners);
        }
        let around = fans.iter().map(|fan| fan.length).sum();
        Self { fans, corners, area: opening.area(), around }
    }

    /// Fans of all edges, each with its line.
    #[must_use]
    pub fn fans(&self) -> &[Fan] {
        &self.fans
    }

    /// Returns the fraction of the light of a wavelength (mm) that falls farther than `r_mm` from the middle of the pattern. It
    /// is the light from the edges: wavelength times circumference over 2 pi^2 times area times r.
    #[must_use]
    pub fn fraction_beyond(&self, r_mm: f64, wavelength_mm: f64) -> f64 {
        wavelength_mm * self.around / (2.0 * PI * PI * self.area * r_mm)
    }

    /// Returns the fraction of the light of a wavelength (mm) that one fan sends beyond `r_mm` from the middle, both sides
    /// together.
    #[must_use]
    pub fn of_fan(&self, fan: &Fan, r_mm: f64, wavelength_mm: f64) -> f64 {
        wavelength_mm * fan.length / (2.0 * PI * PI * self.area * r_mm)
    }

    /// Returns the fraction of the light per mm^2 at a place on film (mm from the middle of the pattern). It is averaged over
    /// fringes and over a cell with the half sides `half_mm`. `without_boxes` subtracts from each spike the light of its boxes;
    /// see [`Wings::boxes`].
    #[must_use]
    pub fn intensity(&self, at: [f64; 2], half_mm: [f64; 2], wavelength_mm: f64, without_boxes: bool) -> f64 {
        let r2 = at[0] * at[0] + at[1] * at[1];
        let r = r2.sqrt();
        let across = |fan: &Fan| {
            let [nx, ny] = fan.normal;
            let t = at[1] * nx - at[0] * ny;
            // The cell, seen along the edge, is one box convolved with another; so is the fan.
            let (a, b) = (half_mm[0] * ny.abs(), half_mm[1] * nx.abs());
            (at[0] * nx + at[1] * ny, t, [a.max(b) + 0.5 * r * fan.spread_rad, a.min(b)])
        };
        let mut sum = 0.0;
        for fan in &self.fans {
            let (along, t, half) = across(fan);
            let per_mm = PI * fan.line / wavelength_mm;
            let half = half.map(|half| half * per_mm);
            let mut share = spike_mean(t * per_mm, half);
            if without_boxes && fan.is_spike() {
                share -= mean(t * per_mm, half, boxes_integrals);
            }
            sum += fan.length * fan.line * along * along * share;
        }
        let mut together = 0.0;
        for pair in &self.corners {
            let one = |at: usize| {
                let fan = &self.fans[at];
                let (along, t, half) = across(fan);
                let least = half[0] + half[1] + wavelength_mm / (PI * fan.line);
                along * t / (t * t + least * least)
            };
            together -= one(pair[0]) * one(pair[1]);
        }
        let pairs = together * wavelength_mm * wavelength_mm / (2.0 * PI * PI);
        let all = sum + pairs;
        (if without_boxes { all } else { all.max(0.0) }) / (4.0 * PI * PI * self.area * r2 * r2)
    }

    /// Returns two boxes that approximate a spike across its width. For each they are its fraction of the spike's light, and its
    /// half width in units of wavelength over the length of the line. Together they are as high as the middle of the spike, and
    /// hold nine tenths of it.
    #[must_use]
    pub fn boxes() -> [[f64; 2]; 2] {
        [[0.7, 0.42], [0.2, 0.6]]
    }
}

/// Finds the lines of edges of a ring, divided at its corners.
fn lines(ring: &[[f64; 2]], fans: &mut Vec<Fan>, corners: &mut Vec<[usize; 2]>) {
    let count = ring.len();
    let edge = |i: usize| {
        let (a, b) = (ring[i % count], ring[(i + 1) % count]);
        [b[0] - a[0], b[1] - a[1]]
    };
    let length = |d: [f64; 2]| (d[0] * d[0] + d[1] * d[1]).sqrt();
    let all: f64 = (0..count).map(|i| length(edge(i))).sum();
    // Edges without length have no direction.
    let edges: Vec<[f64; 2]> = (0..count).map(edge).filter(|d| length(*d) > 1e-12 * all).collect();
    let count = edges.len();
    let turn = |i: usize| {
        let (a, b) = (edges[i % count], edges[(i + 1) % count]);
        math::atan2(a[0] * b[1] - a[1] * b[0], a[0] * b[0] + a[1] * b[1])
    };
    let is_corner = |i: usize| turn(i).abs() > CORNER_RAD;
    let begin = (0..count).find(|i| is_corner(*i)).map_or(0, |i| i + 1);
    let first_fan = fans.len();
    let mut starts: Vec<[usize; 2]> = Vec::new();
    let mut at = 0;
    while at < count {
        let from = at;
        while at + 1 < count && !is_corner(begin + at) {
            at += 1;
        }
        at += 1;
        let span: Vec<usize> = (from..at).map(|i| (begin + i) % count).collect();
        let first = fans.len();
        line(&edges, &span, &turn, at - from == count, fans);
        starts.push([first, fans.len() - 1]);
    }
    if (0..count).any(is_corner) {
        for i in 0..starts.len() {
            corners.push([starts[i][1], starts[(i + 1) % starts.len()][0]]);
        }
    }
    debug_assert!(fans.len() > first_fan);
}

/// Finds the fans of one line of edges.
fn line(edges: &[[f64; 2]], span: &[usize], turn: &dyn Fn(usize) -> f64, closed: bool, fans: &mut Vec<Fan>) {
    let length = |d: [f64; 2]| (d[0] * d[0] + d[1] * d[1]).sqrt();
    let whole: f64 = span.iter().map(|i| length(edges[*i])).sum();
    // Each edge stands for half of the turns at its ends; at the ends of the line, for as much beyond.
    let turns: Vec<f64> = (0..span.len())
        .map(|i| {
            let before = if i > 0 { Some(turn(span[i - 1])) } else { closed.then(|| turn(span[span.len() - 1])) };
            let after = if i + 1 < span.len() || closed { Some(turn(span[i])) } else { None };
            match (before, after) {
                (Some(a), Some(b)) => 0.5 * (a + b),
                (Some(one), None) | (None, Some(one)) => one,
                (None, None) => 0.0,
            }
        })
        .collect();
    let mut at = 0;
    while at < span.len() {
        let mut sum = [0.0; 2];
        let (mut spread, mut long) = (0.0_f64, 0.0);
        let from = at;
        while at < span.len() && (at == from || (spread + turns[at]).abs() <= WIDEST_RAD) {
            let d = edges[span[at]];
            (sum[0], sum[1]) = (sum[0] + d[0], sum[1] + d[1]);
            spread += turns[at];
            long += length(d);
            at += 1;
        }
        let chord = length(sum);
        fans.push(Fan {
            normal: [sum[1] / chord, -sum[0] / chord],
            spread_rad: spread.abs(),
            length: long,
            line: whole,
        });
    }
}

/// Returns the mean of (sin(x) / x)^2 around x over a box of half width `wide` convolved with a box of half width `narrow`.
fn spike_mean(x: f64, [wide, narrow]: [f64; 2]) -> f64 {
    let (x, sum, less) = (x.abs(), wide + narrow, wide - narrow);
    if x - sum < POINTS as f64 * STEP {
        return mean(x, [wide, narrow], spike_integrals);
    }
    // Differences of the series in `spike_integrals`. Equal terms cancel and are left out, and sines of sums are computed from those of the
    // summands.
    let sin_cos = |x: f64| {
        let turns = x / PI;
        math::sin_cos_turns(turns - turns.floor())
    };
    let middle = sin_cos(x);
    let beside =
        |by: f64, (sin, cos): (f64, f64)| (x + by, middle.0 * cos + middle.1 * sin, middle.1 * cos - middle.0 * sin);
    if narrow < 0.02 {
        let (sin, cos) = sin_cos(wide);
        let ripple = |(x, sin, cos): (f64, f64, f64)| (cos / x - sin + 1.5 * sin / (x * x)) / (4.0 * x * x);
        let ripples = ripple(beside(wide, (sin, cos))) - ripple(beside(-wide, (-sin, cos)));
        return 0.5 / (x * x - wide * wide) + ripples / (2.0 * wide);
    }
    let ripple = |(x, sin, cos): (f64, f64, f64)| (0.125 * cos + (0.25 * sin - 0.5625 * cos / x) / x) / (x * x);
    let both = |by: f64| {
        let (sin, cos) = sin_cos(by);
        ripple(beside(by, (sin, cos))) + ripple(beside(-by, (-sin, cos)))
    };
    let area = 4.0 * wide * narrow;
    let part = area / (x * x - less * less);
    let falls = if part < 1e-3 {
        0.5 * part * (1.0 + part * (0.5 + part * (1.0 / 3.0 + 0.25 * part)))
    } else {
        -0.5 * math::log(1.0 - part)
    };
    (falls + both(sum) - both(less)) / area
}

/// Returns the mean of a function around x over one box convolved with another, from its integral and the integral of that.
fn mean(x: f64, [wide, narrow]: [f64; 2], integrals: fn(f64) -> [f64; 2]) -> f64 {
    let at = |x: f64| integrals(x);
    if narrow < 0.02 {
        return (at(x + wide)[0] - at(x - wide)[0]) / (2.0 * wide);
    }
    let second = |x: f64| at(x)[1];
    let (sum, less) = (wide + narrow, wide - narrow);
    (second(x + sum) - second(x + less) - second(x - less) + second(x - sum)) / (4.0 * wide * narrow)
}

/// Number of points in the table of [`spike_integrals`].
const POINTS: usize = 1024;
/// Step between points in the table of [`spike_integrals`].
const STEP: f64 = TAU / 128.0;

/// Returns the integral of (sin(x) / x)^2 from 0 to x, and the integral of that, within 1e-6.
fn spike_integrals(x: f64) -> [f64; 2] {
    static TABLE: OnceLock<Vec<[f64; 3]>> = OnceLock::new();
    let value = |x: f64| {
        let s = if x == 0.0 { 1.0 } else { math::sin(x) / x };
        s * s
    };
    let table = TABLE.get_or_init(|| {
        let (mut first, mut second) = (0.0, 0.0);
        (0..POINTS + 1)
            .map(|i| {
                let to = i as f64 * STEP;
                let point = [value(to), first, second];
                // Integral of the cubic through four points of the step (Simpson's 3/8 rule), and its moment about the end.
                let at = [0.0, 1.0, 2.0, 3.0].map(|k| value(to + k / 3.0 * STEP));
                second +=
                    STEP * first + STEP * STEP * (39.0 * at[0] + 108.0 * at[1] + 27.0 * at[2] + 6.0 * at[3]) / 360.0;
                first += STEP / 8.0 * (at[0] + 3.0 * at[1] + 3.0 * at[2] + at[3]);
                point
            })
            .collect()
    });
    // Far out: the asymptotic series of the sine and cosine integrals.
    let far_first = |x: f64| {
        let (sin, cos) = (math::sin(2.0 * x), math::cos(2.0 * x));
        0.5 * PI - 0.5 / x + (cos / x - sin + 1.5 * sin / (x * x)) / (4.0 * x * x)
    };
    let far_second = |x: f64| {
        let (sin, cos) = (math::sin(2.0 * x), math::cos(2.0 * x));
        0.5 * PI * x - 0.5 * math::log(x) + (0.125 * cos + (0.25 * sin - 0.5625 * cos / x) / x) / (x * x)
    };
    let far = x.abs();
    let p = far / STEP;
    let [first, second] = if p < POINTS as f64 {
        let i = p as usize;
        let (f, [da, a, c], [db, b, d]) = (p - i as f64, table[i], table[i + 1]);
        // Cubic Hermite interpolation.
        let cubic = |a: f64, b: f64, da: f64, db: f64| {
            let (m, n) = (STEP * da - (b - a), (b - a) - STEP * db);
            a + f * (b - a) + f * (1.0 - f) * ((1.0 - f) * m + f * n)
        };
        [cubic(a, b, da, db), cubic(c, d, a, b)]
    } else {
        let end = POINTS as f64 * STEP;
        let last = table[POINTS];
        [far_first(far), last[2] + far_second(far) - far_second(end)]
    };
    [if x < 0.0 { -first } else { first }, second]
}

/// Returns the integral from 0 to x of the boxes that approximate a spike, and the integral of that.
fn boxes_integrals(x: f64) -> [f64; 2] {
    let far = x.abs();
    let mut both = [0.0; 2];
    for [part, half] in Wings::boxes() {
        let (all, end) = (0.5 * part * PI, PI * half);
        both[0] += all * (far / end).min(1.0);
        both[1] += if far < end { 0.5 * all * far * far / end } else { all * (far - 0.5 * end) };
    }
    [if x < 0.0 { -both[0] } else { both[0] }, both[1]]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_integral_is_that_of_its_function() {
        let (mut sum, mut second) = (0.0, 0.0);
        let n = 2_000_000;
        let step = 100.0 / f64::from(n);
        for i in 0..n {
            let x = (f64::from(i) + 0.5) * step;
            let before = sum;
            sum += (x.sin() / x).powi(2) * step;
            second += 0.5 * (before + sum) * step;
            if i % 50_021 == 0 {
                let at = x + 0.5 * step;
                let [one, two] = spike_integrals(at);
                assert!((one - sum).abs() < 1e-6 && (two - second).abs() < 1e-5, "{at}: {one} {sum}, {two} {second}");
                assert_eq!(spike_integrals(-at), [-one, two]);
            }
        }
    }

    #[test]
    fn a_mean_far_out_is_that_of_its_function() {
        for (x, wide, narrow) in [
            (60.0, 3.0, 0.0),
            (75.5, 0.4, 0.01),
            (58.0, 2.0, 1.5),
            (300.0, 12.0, 0.7),
            (5e3, 2.8, 2.8),
            (900.0, 400.0, 9.0),
        ] {
            // The second box by the midpoint rule; the first by steps much finer than a ripple.
            let boxed = |x: f64, half: f64, of: &dyn Fn(f64) -> f64| {
                let n = (half * 200.0).ceil().max(1.0);
                (0..n as usize).map(|i| of(x + half * (2.0 * (i as f64 + 0.5) / n - 1.0))).sum::<f64>() / n
            };
            let value = |x: f64| (x.sin() / x).powi(2);
            let want = boxed(x, narrow, &|x| boxed(x, wide, &value));
            let got = spike_mean(x, [wide, narrow]);
            assert!((got - want).abs() < 3e-5 / (x * x), "{x}, {wide}, {narrow}: {got} {want}");
            assert_eq!(spike_mean(-x, [wide, narrow]), got);
        }
    }

    #[test]
    fn lines_are_cut_at_corners_only() {
        let seven = Wings::new(&Polygon::regular(7, 0.03, 0.1));
        assert_eq!((seven.fans().len(), seven.corners.len()), (7, 7));
        assert!(seven.fans().iter().all(|fan| fan.spread_rad == 0.0));
        let round = Wings::new(&Polygon::regular(256, 0.03, 0.0));
        let all: f64 = round.fans().iter().map(|fan| fan.spread_rad).sum();
        assert!((all - TAU).abs() < 1e-9 && round.corners.is_empty(), "{all}");
        assert!((round.around - TAU * 0.03).abs() < 1e-5);
    }
}
