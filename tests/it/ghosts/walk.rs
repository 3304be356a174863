//! An independent random walk of light through reflections, and its results as a table: `tests/data/ghost-walks.csv`.

use super::{COLUMNS, DISTANCE_MM, HE_NE_NM, REGIONS, ROWS, Setup};
use crate::common::repository;
use crate::common::statistics::Estimate;
use spectra_lens::Lens;
use std::fmt::Write as _;

/// Kinds of light in a walk, by what happened to it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Light {
    /// Light on the frame without reflections.
    Straight,
    /// Light on the frame after two reflections.
    Two,
    /// Light on the frame after four reflections.
    Four,
    /// Light on the frame after two or four reflections.
    Ghosts,
    /// Light that was reflected once more and not followed, wherever it would have gone.
    Left,
    /// The part of that light that no surface totally reflected before.
    LeftNotTotally,
}

impl Light {
    const ALL: [Self; 6] = [Self::Straight, Self::Two, Self::Four, Self::Ghosts, Self::Left, Self::LeftNotTotally];
}

/// Result of a walk: the mean over the rays of each kind of light, for each region. Light that is left untraced is in the first
/// region.
pub struct Walked {
    figures: [[Estimate; REGIONS]; 6],
}

impl Walked {
    /// Walks with this number of rays, with random numbers from a seed.
    pub fn by(setup: &Setup, rays: usize, seed: u64) -> Self {
        let mut walk = Walk::new(&setup.scene(&[]).lens, setup, seed);
        let tangent = setup.field_deg.map(|deg| DISTANCE_MM * deg.to_radians().tan());
        // Largest radius in the plane of the first vertex at which a ray can meet the glass behind it.
        let [_, c, clear, ..] = walk.surfaces[0];
        let sag = c * clear * clear / (1.0 + (1.0 - c * c * clear * clear).sqrt());
        let clear = clear + sag.abs() * tangent[0].hypot(tangent[1]) / DISTANCE_MM;
        let mut sums = [[[0.0_f64; 2]; REGIONS]; 6];
        for _ in 0..rays {
            let (r, turn) = (clear * walk.number().sqrt(), std::f64::consts::TAU * walk.number());
            let p = [r * turn.cos(), r * turn.sin(), 0.0];
            let d = [p[0] - tangent[0], p[1] - tangent[1], DISTANCE_MM];
            let length = dot(d, d).sqrt();
            let weight = (DISTANCE_MM / length).powi(3);
            let d = d.map(|v| v / length);
            let mut own = [[0.0_f64; REGIONS]; 6];
            walk.left = [0.0; 2];
            walk.follow(Part { p, d, weight, gap: 0, bounces: 0, is_total: false }, &mut |bounces, region, weight| {
                own[bounces / 2][region] += weight;
                if bounces > 0 {
                    own[Light::Ghosts as usize][region] += weight;
                }
            });
            (own[Light::Left as usize][0], own[Light::LeftNotTotally as usize][0]) = walk.left.into();
            for (sums, own) in sums.as_flattened_mut().iter_mut().zip(own.as_flattened()) {
                *sums = [sums[0] + own, sums[1] + own * own];
            }
        }
        let n = rays as f64;
        let figure = |[sum, square]: [f64; 2]| {
            let mean = sum / n;
            Estimate { mean, error: ((square / n - mean * mean) / n).max(0.0).sqrt() }
        };
        Self { figures: sums.map(|regions| regions.map(figure)) }
    }

    /// Returns the light of one kind, region by region.
    pub fn of(&self, light: Light) -> impl Iterator<Item = Estimate> {
        self.figures[light as usize].into_iter()
    }

    /// Returns the sum over all regions, as if their errors were independent.
    pub fn total(&self, light: Light) -> Estimate {
        self.of(light).fold(Estimate { mean: 0.0, error: 0.0 }, |all, part| Estimate {
            mean: all.mean + part.mean,
            error: all.error.hypot(part.error),
        })
    }
}

const TABLE: &str = "tests/data/ghost-walks.csv";
/// Seed of the walks in the table.
const SEED: u64 = 7;

/// Returns the walk of a setup from the table.
pub fn known(setup: &Setup) -> Walked {
    let text = std::fs::read_to_string(repository(TABLE)).expect("a table");
    let mut figures = [[Estimate { mean: 0.0, error: 0.0 }; REGIONS]; 6];
    let mut rows = 0;
    for line in text.lines().filter(|line| line.split(',').next() == Some(setup.walk)) {
        let cells: Vec<&str> = line.split(',').collect();
        let number = |at: usize| cells[at].parse::<f64>().expect("a number");
        let light = Light::ALL.iter().position(|light| format!("{light:?}") == cells[1]).expect("a kind of light");
        figures[light][number(2) as usize] = Estimate { mean: number(3), error: number(4) };
        rows += 1;
    }
    assert_eq!(rows, 6 * REGIONS, "{}", setup.walk);
    Walked { figures }
}

/// Writes the table with new walks.
pub fn write(walks: &[(&Setup, usize)]) {
    let mut text = String::from("walk,light,region,mean,error\n");
    for (setup, rays) in walks {
        let walked = Walked::by(setup, *rays, SEED);
        for light in Light::ALL {
            for (region, Estimate { mean, error }) in walked.of(light).enumerate() {
                let _ = writeln!(text, "{},{light:?},{region},{mean:.9e},{error:.3e}", setup.walk);
            }
        }
    }
    std::fs::write(repository(TABLE), text).expect("written");
}

/// A random ray that walks between surfaces without knowing any paths: at each surface it splits, and both parts go on. It is written
/// without the tracer. Spheres are intersected by their two roots, Snell's law uses the component across the normal, and Fresnel's
/// equations both polarizations.
struct Walk {
    /// Vertex, curvature and clear radius, mm and mm^-1, and the index before and behind each surface.
    surfaces: Vec<[f64; 5]>,
    image_z: f64,
    frame_mm: [f64; 2],
    imager: f64,
    order: usize,
    state: u64,
    /// Light that was reflected once more and not followed: all of it, and the part without an earlier total reflection.
    left: [f64; 2],
}

/// Probability that light which was reflected twice goes on to be reflected again; its weight increases accordingly.
const GOES_ON: f64 = 0.125;

impl Walk {
    fn new(lens: &Lens, setup: &Setup, seed: u64) -> Self {
        let surface = |e: &spectra_lens::Element| {
            let index = |medium| lens.index(medium, HE_NE_NM);
            let clear = e.semi_diameter_mm.expect("stated");
            [e.vertex_z_mm(), e.vertex_curvature_per_mm().0, clear, index(e.medium_before), index(e.medium_after)]
        };
        let surfaces = lens.elements.iter().map(surface).collect();
        Self {
            surfaces,
            image_z: lens.image_z_mm(),
            frame_mm: setup.frame_mm,
            imager: setup.imager,
            order: setup.order,
            state: seed,
            left: [0.0; 2],
        }
    }

    /// Returns a random number from 0 to 1 with SplitMix64 (S. Vigna).
    fn number(&mut self) -> f64 {
        self.state = self.state.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.state;
        z = (z ^ z >> 30).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ z >> 27).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ z >> 31) >> 11) as f64 / (1_u64 << 53) as f64
    }

    /// Returns the weight factor of light that is reflected once more, or `None` if it is not followed.
    fn goes_on(&mut self, bounces: usize) -> Option<f64> {
        if bounces >= self.order {
            return None;
        }
        if bounces != 2 {
            return Some(1.0);
        }
        (self.number() < GOES_ON).then_some(1.0 / GOES_ON)
    }

    /// Adds the light that one ray brings to the regions, direct and by reflections.
    fn follow(&mut self, ray: Part, sums: &mut impl FnMut(usize, usize, f64)) {
        let Part { mut p, mut d, mut weight, mut gap, mut bounces, is_total } = ray;
        loop {
            if d[2] > 0.0 && gap == self.surfaces.len() {
                let t = (self.image_z - p[2]) / d[2];
                let [x, y] = [p[0] + t * d[0], p[1] + t * d[1]];
                let column = (0.5 - x / self.frame_mm[0]) * COLUMNS as f64;
                let row = (0.5 + y / self.frame_mm[1]) * ROWS as f64;
                if !(column >= 0.0 && row >= 0.0 && column < COLUMNS as f64 && row < ROWS as f64) {
                    return;
                }
                sums(bounces, row as usize * COLUMNS + column as usize, weight);
                if self.imager == 0.0 {
                    return;
                }
                let Some(more) = self.goes_on(bounces) else { return };
                weight *= self.imager * more;
                (p, d[2], bounces) = ([x, y, self.image_z], -d[2], bounces + 1);
                continue;
            }
            if d[2] < 0.0 && gap == 0 {
                return;
            }
            let forward = d[2] > 0.0;
            let [vertex, c, clear, n_before, n_behind] = self.surfaces[if forward { gap } else { gap - 1 }];
            let Some(t) = meet(p, d, vertex, c).filter(|t| *t > -1e-6) else { return };
            p = std::array::from_fn(|k| p[k] + t * d[k]);
            if p[0] * p[0] + p[1] * p[1] > clear * clear {
                return;
            }
            let (n, m) = if forward { (n_before, n_behind) } else { (n_behind, n_before) };
            if n != m {
                let mut normal = [-c * p[0], -c * p[1], 1.0 - c * (p[2] - vertex)];
                let mut cos = dot(normal, d);
                if cos < 0.0 {
                    (normal, cos) = (normal.map(|v| -v), -cos);
                }
                // The component across the normal grows by the ratio of the indices.
                let across: [f64; 3] = std::array::from_fn(|k| (d[k] - cos * normal[k]) * n / m);
                let sine2 = dot(across, across);
                let inner = (1.0 - sine2).max(0.0).sqrt();
                let rs = (n * cos - m * inner) / (n * cos + m * inner);
                let rp = (m * cos - n * inner) / (m * cos + n * inner);
                let reflected = if sine2 >= 1.0 { 1.0 } else { 0.5 * (rs * rs + rp * rp) };
                let back: [f64; 3] = std::array::from_fn(|k| d[k] - 2.0 * cos * normal[k]);
                if bounces >= self.order {
                    self.left[0] += weight * reflected;
                    self.left[1] += if is_total || sine2 >= 1.0 { 0.0 } else { weight * reflected };
                } else if (back[2] > 0.0) != forward
                    && let Some(more) = self.goes_on(bounces)
                {
                    let (weight, is_total) = (weight * reflected * more, is_total || sine2 >= 1.0);
                    self.follow(Part { p, d: back, weight, gap, bounces: bounces + 1, is_total }, sums);
                }
                weight *= 1.0 - reflected;
                if weight == 0.0 {
                    return;
                }
                d = std::array::from_fn(|k| across[k] + inner * normal[k]);
            }
            gap = if forward { gap + 1 } else { gap - 1 };
        }
    }
}

/// A part of a ray: its position and direction, in front of surface `gap` and behind the surface before.
struct Part {
    p: [f64; 3],
    d: [f64; 3],
    weight: f64,
    gap: usize,
    bounces: usize,
    is_total: bool,
}

fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// Returns the distance along a ray to a sphere of this curvature, on the half around its vertex.
fn meet(p: [f64; 3], d: [f64; 3], vertex: f64, c: f64) -> Option<f64> {
    if c == 0.0 {
        return Some((vertex - p[2]) / d[2]);
    }
    let r = 1.0 / c;
    let from = [p[0], p[1], p[2] - vertex - r];
    let b = dot(from, d);
    let square = b * b - dot(from, from) + r * r;
    if square < 0.0 {
        return None;
    }
    // Light passes from one side of the vertex to the other: it enters a sphere whose center lies ahead, and leaves one whose center
    // lies behind.
    let t = if (r > 0.0) == (d[2] > 0.0) { -b - square.sqrt() } else { -b + square.sqrt() };
    ((p[2] + t * d[2] - vertex).abs() < r.abs()).then_some(t)
}
