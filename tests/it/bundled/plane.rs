//! Measurements on a picture: means, places, sizes, contrasts.

use spectra_core::frame::FrameSize;
use std::f64::consts::PI;

/// Values over the frame as the picture shows it: upright, x to the right and y up from its center, mm on the film.
#[derive(Clone)]
pub struct Plane {
    width: usize,
    pub pixel_mm: [f64; 2],
    size_mm: [f64; 2],
    pub values: Vec<f64>,
}

/// A window: the center of a rectangle and half of its sides, mm.
pub type Window = ([f64; 2], [f64; 2]);

/// A connected region of light.
pub struct Spot {
    pub center: [f64; 2],
    pub area_mm2: f64,
    /// Diameters of an ellipse, mm: four times the standard deviations along the long and the short axis.
    pub axes_mm: [f64; 2],
    pub places: Vec<[f64; 2]>,
}

impl Plane {
    pub fn new(size: FrameSize, values: Vec<f64>) -> Self {
        let pixel_mm = [size.width_mm / f64::from(size.width_px), size.height_mm / f64::from(size.height_px)];
        Self { width: size.width_px as usize, pixel_mm, size_mm: [size.width_mm, size.height_mm], values }
    }

    fn place(&self, at: usize) -> [f64; 2] {
        let (column, row) = ((at % self.width) as f64 + 0.5, (at / self.width) as f64 + 0.5);
        [column * self.pixel_mm[0] - 0.5 * self.size_mm[0], 0.5 * self.size_mm[1] - row * self.pixel_mm[1]]
    }

    /// Returns whether a point lies inside the outermost pixels.
    pub fn is_inside(&self, place: [f64; 2]) -> bool {
        (0..2).all(|k| place[k].abs() < 0.5 * self.size_mm[k] - self.pixel_mm[k])
    }

    pub fn pixel_area_mm2(&self) -> f64 {
        self.pixel_mm[0] * self.pixel_mm[1]
    }

    /// Returns the positions and values of all pixels.
    pub fn all(&self) -> impl Iterator<Item = ([f64; 2], f64)> {
        self.values.iter().enumerate().map(|(at, value)| (self.place(at), *value))
    }

    /// Returns the positions and values of the pixels inside a window.
    pub fn part(&self, (middle, half): Window) -> impl Iterator<Item = ([f64; 2], f64)> {
        self.all().filter(move |(p, _)| (0..2).all(|k| (p[k] - middle[k]).abs() <= half[k]))
    }

    pub fn mean(&self, window: Window) -> f64 {
        mean(self.part(window).map(|(_, value)| value))
    }

    /// Returns the mean of the pixels that have light: each color of a mosaic fills only some of them.
    pub fn mean_of_lit(&self, window: Window) -> f64 {
        mean(self.part(window).map(|(_, value)| value).filter(|value| *value > 0.0))
    }

    pub fn sum(&self) -> f64 {
        self.values.iter().sum()
    }

    pub fn most(&self) -> f64 {
        self.values.iter().copied().fold(f64::MIN, f64::max)
    }

    /// Returns the value below which this share of the pixels lies.
    pub fn quantile(&self, part: f64) -> f64 {
        let mut sorted = self.values.clone();
        sorted.sort_by(f64::total_cmp);
        sorted[((sorted.len() - 1) as f64 * part) as usize]
    }

    /// Returns the position of the brightest pixel.
    pub fn brightest(&self) -> [f64; 2] {
        self.all().fold(([0.0; 2], f64::MIN), |most, one| if one.1 > most.1 { one } else { most }).0
    }

    /// Returns the center of the light in a window and its variances along x and y, with the variance of a pixel subtracted.
    pub fn moments(&self, window: Window) -> ([f64; 2], [f64; 2]) {
        let mut sums = [0.0; 5];
        for ([x, y], v) in self.part(window) {
            sums = [sums[0] + v, sums[1] + x * v, sums[2] + y * v, sums[3] + x * x * v, sums[4] + y * y * v];
        }
        let [all, x, y, xx, yy] = sums;
        let center = [x / all, y / all];
        let variance = |square: f64, k: usize| square / all - center[k] * center[k] - self.pixel_mm[k].powi(2) / 12.0;
        (center, [variance(xx, 0), variance(yy, 1)])
    }

    pub fn center(&self, window: Window) -> [f64; 2] {
        self.moments(window).0
    }

    pub fn map(&self, value: impl Fn(f64) -> f64) -> Self {
        Self { values: self.values.iter().map(|v| value(*v)).collect(), ..self.clone() }
    }

    pub fn with(&self, other: &Self, value: impl Fn(f64, f64) -> f64) -> Self {
        Self { values: self.values.iter().zip(&other.values).map(|(a, b)| value(*a, *b)).collect(), ..self.clone() }
    }

    /// Returns the means of the columns (axis 0) or rows (axis 1) of a window, each after its position along that axis, ascending.
    pub fn along(&self, axis: usize, window: Window) -> Vec<[f64; 2]> {
        let mut sums: Vec<[f64; 3]> = Vec::new();
        for (p, value) in self.part(window) {
            match sums.iter_mut().find(|line| (line[0] - p[axis]).abs() < 0.1 * self.pixel_mm[axis]) {
                Some(line) => *line = [line[0], line[1] + value, line[2] + 1.0],
                None => sums.push([p[axis], value, 1.0]),
            }
        }
        sums.sort_by(|a, b| a[0].total_cmp(&b[0]));
        sums.iter().map(|[at, sum, count]| [*at, sum / count]).collect()
    }

    /// Returns the area, mm2, and the center of a dark shape that has `contrast` less of the light `ground` around it.
    pub fn dark(&self, window: Window, ground: f64, contrast: f64) -> (f64, [f64; 2]) {
        let dark = self.map(|value| (1.0 - value / ground) / contrast);
        let sum: f64 = dark.part(window).map(|(_, value)| value).sum();
        (sum * self.pixel_area_mm2(), dark.center(window))
    }

    /// Returns the center of the shape that is darker than the lightest tenth of a window.
    pub fn dark_middle(&self, window: Window) -> [f64; 2] {
        let mut values: Vec<f64> = self.part(window).map(|(_, value)| value).collect();
        values.sort_by(f64::total_cmp);
        self.dark(window, values[values.len() * 9 / 10], 1.0).1
    }

    /// Returns the contrast of a star's spokes on a circle. With a sector, counts only the spokes within so many radians of a
    /// direction or its opposite.
    pub fn spokes(&self, center: [f64; 2], radius: f64, cycles: f64, sector: Option<[f64; 2]>) -> f64 {
        let mut sums = [0.0; 3];
        for (p, value) in self.all() {
            let (x, y) = (p[0] - center[0], p[1] - center[1]);
            let turn = y.atan2(x);
            let beside = |[at, _]: [f64; 2]| ((turn - at + 2.5 * PI).rem_euclid(PI) - 0.5 * PI).abs();
            if (x.hypot(y) / radius - 1.0).abs() < 0.08 && sector.is_none_or(|sector| beside(sector) < sector[1]) {
                let (sin, cos) = (cycles * turn).sin_cos();
                sums = [sums[0] + value, sums[1] + cos * value, sums[2] + sin * value];
            }
        }
        2.0 * sums[1].hypot(sums[2]) / sums[0]
    }

    /// Returns the connected regions of more than `least` light and at least `pixels` pixels.
    pub fn spots(&self, least: f64, pixels: usize) -> Vec<Spot> {
        let mut is_seen: Vec<bool> = self.values.iter().map(|value| *value < least).collect();
        let (mut found, rows) = (Vec::new(), self.values.len() / self.width);
        for first in 0..is_seen.len() {
            let (mut places, mut next) = (Vec::new(), vec![first]);
            while let Some(at) = next.pop() {
                if std::mem::replace(&mut is_seen[at], true) {
                    continue;
                }
                places.push(self.place(at));
                let (column, row) = (at % self.width, at / self.width);
                next.extend((column > 0).then(|| at - 1));
                next.extend((column + 1 < self.width).then(|| at + 1));
                next.extend((row > 0).then(|| at - self.width));
                next.extend((row + 1 < rows).then(|| at + self.width));
            }
            if places.len() >= pixels {
                found.push(self.spot(places));
            }
        }
        found
    }

    fn spot(&self, places: Vec<[f64; 2]>) -> Spot {
        let count = places.len() as f64;
        let center = [0, 1].map(|k| places.iter().map(|p| p[k]).sum::<f64>() / count);
        let of =
            |i: usize, k: usize| places.iter().map(|p| (p[i] - center[i]) * (p[k] - center[k])).sum::<f64>() / count;
        let [xx, yy, xy] =
            [of(0, 0) + self.pixel_mm[0].powi(2) / 12.0, of(1, 1) + self.pixel_mm[1].powi(2) / 12.0, of(0, 1)];
        let (mean, apart) = (0.5 * (xx + yy), (0.5 * (xx - yy)).hypot(xy));
        let axes_mm = [mean + apart, mean - apart].map(|variance| 4.0 * variance.max(0.0).sqrt());
        Spot { center, area_mm2: count * self.pixel_area_mm2(), axes_mm, places }
    }
}

pub fn mean(values: impl Iterator<Item = f64>) -> f64 {
    let (count, sum) = values.fold((0.0, 0.0), |(count, sum), value| (count + 1.0, sum + value));
    assert!(count > 0.0, "no pixels");
    sum / count
}

/// Returns where a profile passes half of the way between its ends, and the distance between a quarter and three quarters of that
/// way.
pub fn edge(profile: &[[f64; 2]]) -> [f64; 2] {
    let level = |part: &[[f64; 2]]| mean(part.iter().map(|[_, value]| *value));
    let ends = [level(&profile[..3]), level(&profile[profile.len() - 3..])];
    let passes = |share: f64| {
        let wanted = ends[0] + share * (ends[1] - ends[0]);
        let is_between = |pair: &&[[f64; 2]]| (pair[0][1] - wanted) * (pair[1][1] - wanted) <= 0.0;
        let crossings = profile.windows(2).filter(is_between);
        let place = |pair: &[[f64; 2]]| {
            let part = (wanted - pair[0][1]) / (pair[1][1] - pair[0][1]);
            pair[0][0] + part * (pair[1][0] - pair[0][0])
        };
        mean(crossings.map(place))
    };
    [passes(0.5), (passes(0.75) - passes(0.25)).abs()]
}
