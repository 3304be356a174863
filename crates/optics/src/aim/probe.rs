//! Probes: rays from one point over a plane that show which of them pass.

use glam::DVec3;
use spectra_core::RayBatch;
use spectra_core::batch::Columns;
use spectra_core::isa::Vectorized;
use spectra_core::loss::ALIVE;
use spectra_lens::Lens;
use spectra_tracer::{Indices, Route, Tracer, Travel, Work};
use std::borrow::Borrow;

/// Number of rays in one batch of probes.
const BATCH: usize = 4096;

/// The plane at which the probes of one point are aimed.
#[derive(Clone, Copy, Debug)]
pub(super) struct Plane {
    pub origin: DVec3,
    /// Unit vector in the plane, within the section of point and axis.
    pub along: DVec3,
    /// Unit vector in the plane, across that section.
    pub across: DVec3,
}

impl Plane {
    pub fn at(&self, [along, across]: [f64; 2]) -> DVec3 {
        self.origin + self.along * along + self.across * across
    }

    /// Returns where the line from `point` through `target` crosses the plane, and the ratio of that distance from
    /// the point to the distance of `target`. Returns `None` if the line does not cross it.
    pub fn project(&self, point: DVec3, target: DVec3) -> Option<([f64; 2], f64)> {
        let normal = self.along.cross(self.across);
        let way = target - point;
        let factor = (self.origin - point).dot(normal) / way.dot(normal);
        let from_origin = point + way * factor - self.origin;
        let at = [from_origin.dot(self.along), from_origin.dot(self.across)];
        (factor.is_finite() && factor > 0.0).then_some((at, factor))
    }
}

/// A rectangle on a plane: lower and upper ends along and across, mm.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Bounds {
    pub low: [f64; 2],
    pub high: [f64; 2],
}

impl Bounds {
    /// The empty rectangle, which contains no point.
    pub const EMPTY: Self = Self { low: [f64::INFINITY; 2], high: [f64::NEG_INFINITY; 2] };

    pub fn around(points: &[[f64; 2]]) -> Option<Self> {
        let mut bounds = Self::EMPTY;
        points.iter().for_each(|p| bounds.include(*p));
        (!points.is_empty()).then_some(bounds)
    }

    pub fn include(&mut self, point: [f64; 2]) {
        for i in 0..2 {
            self.low[i] = self.low[i].min(point[i]);
            self.high[i] = self.high[i].max(point[i]);
        }
    }

    pub fn center(&self) -> [f64; 2] {
        std::array::from_fn(|i| 0.5 * (self.low[i] + self.high[i]))
    }

    pub fn half(&self) -> [f64; 2] {
        std::array::from_fn(|i| 0.5 * (self.high[i] - self.low[i]))
    }

    pub fn widened(mut self, by: [f64; 2]) -> Self {
        for i in 0..2 {
            self.low[i] -= by[i];
            self.high[i] += by[i];
        }
        self
    }
}

/// A lens through which probes are sent.
struct Stage<T> {
    tracer: T,
    /// Route up to the first surface that scatters: light that it passes may come from anywhere behind it.
    route: Route,
}

impl<T: Borrow<Tracer>> Stage<T> {
    fn new(tracer: T, travel: Travel) -> Self {
        Self { route: tracer.borrow().route_without_chance(travel), tracer }
    }

    fn work(&self) -> Work {
        self.tracer.borrow().work_unweighed(BATCH)
    }

    fn trace(&self, rays: &mut RayBatch, work: &mut Work) {
        self.tracer.borrow().follow(&self.route, rays, work);
    }
}

/// The lens, preceded by versions of it with enlarged small openings. Each step passes everything that the next one does. By closing in on
/// the pupil step by step it is found, however small it is.
pub(super) struct Stages<'a> {
    /// Wavelengths at the ends and the middle of the band, nm; only one if they are equal.
    wavelengths_nm: Vec<f64>,
    opened: Vec<Stage<Tracer>>,
    whole: Stage<&'a Tracer>,
}

/// The buffers that one thread needs to send probes through the stages.
pub(super) struct Prober<'a> {
    stages: &'a Stages<'a>,
    /// Work buffers of each opened stage, then of the whole lens.
    work: Vec<Work>,
    rays: RayBatch,
}

/// Ratio of one opening to the one before. Light that fills the grid of one step is still seen on a dozen of its rays at the next.
const STEP: f64 = 0.4;
/// Cells per side of the grid of a step that only narrows the bounds.
const COARSE: usize = 24;
/// Cells per side of the finest grid; if nothing is seen on it, nothing passes.
const FINE: usize = 96;
/// Number of directions in which the end of what passes is searched.
pub(super) const EDGE: usize = 96;
/// Number of steps outward in each direction, and of halvings of the last step.
const ROUGH: usize = 8;
const HALVINGS: usize = 8;

impl<'a> Stages<'a> {
    /// Creates the stages of a lens. Returns `None` if a medium has no index in the middle of the band, or no surface states a size.
    pub fn new(lens: &Lens, tracer: &'a Tracer, travel: Travel, min_nm: f64, max_nm: f64) -> Option<Self> {
        let middle_nm = 0.5 * (min_nm + max_nm);
        let smallest = lens.elements.iter().filter_map(|e| e.semi_diameter_mm).reduce(f64::min)?;
        let mut opening = lens.largest_semi_diameter_mm()?;
        let met_first = if travel == Travel::Forward { 0 } else { lens.elements.len() - 1 };
        let mut opened = Vec::new();
        while opening > smallest {
            let mut open = lens.clone();
            for (at, element) in open.elements.iter_mut().enumerate() {
                // An obstruction may scale with the opening in which it stands, so it is removed.
                element.apertures.retain(|a| !a.obscures);
                if at != met_first {
                    element.semi_diameter_mm = element.semi_diameter_mm.map(|own| own.max(opening));
                }
            }
            let tracer = Tracer::new(&open, Indices::At(middle_nm)).ok()?.scattering_like(tracer);
            opened.push(Stage::new(tracer, travel));
            opening *= STEP;
        }
        let wavelengths_nm = if min_nm < max_nm { vec![min_nm, middle_nm, max_nm] } else { vec![middle_nm] };
        Some(Self { wavelengths_nm, opened, whole: Stage::new(tracer, travel) })
    }

    /// Creates stages for probes of the lens itself, without a search.
    pub fn of(tracer: &'a Tracer, travel: Travel) -> Self {
        Self { wavelengths_nm: Vec::new(), opened: Vec::new(), whole: Stage::new(tracer, travel) }
    }

    /// Creates the buffers for one thread.
    pub fn prober(&'a self) -> Prober<'a> {
        let work = self.opened.iter().map(Stage::work).chain([self.whole.work()]).collect();
        Prober { stages: self, work, rays: RayBatch::new(BATCH) }
    }
}

impl Prober<'_> {
    /// Searches the light that passes from `point` through `start` on `plane`, at the ends and the middle of the band. Returns its
    /// points on the plane and the cell size of the grid that found them.
    pub fn search(&mut self, point: DVec3, plane: &Plane, start: Bounds, grid: usize) -> Option<PassingPoints> {
        let mut bounds = start;
        let stages = self.stages;
        let all = &stages.wavelengths_nm[..];
        for level in 0..=stages.opened.len() {
            let last = level == stages.opened.len();
            let mut n = COARSE;
            let found = loop {
                let mut found = Vec::new();
                let colors = if last { all } else { &all[all.len() / 2..][..1] };
                for wavelength_nm in colors {
                    self.grid(level, point, plane, &bounds, n, *wavelength_nm, &mut found);
                }
                // A handful of points tells little about the size: use a finer grid.
                if found.len() >= if last { all.len() * 12 } else { 6 } || n >= FINE {
                    break found;
                }
                n = (n * 2).min(FINE);
            };
            let seen = Bounds::around(&found)?;
            let cell: [f64; 2] = bounds.half().map(|h| 2.0 * h / n as f64);
            bounds = seen.widened(cell.map(|c| 1.5 * c));
            if last {
                // Search once more, on a grid that fits.
                let mut places = Vec::new();
                for wavelength_nm in all {
                    self.grid(level, point, plane, &bounds, grid, *wavelength_nm, &mut places);
                }
                places.extend(found);
                return Some(PassingPoints { places, cell: bounds.half().map(|h| 2.0 * h / grid as f64) });
            }
        }
        None
    }

    /// Adds the points of a grid over `bounds` that pass.
    fn grid(
        &mut self,
        level: usize,
        point: DVec3,
        plane: &Plane,
        bounds: &Bounds,
        n: usize,
        wavelength_nm: f64,
        found: &mut Vec<[f64; 2]>,
    ) {
        let at: Vec<f64> = (0..n).map(|k| ((k as f64 + 0.5) / n as f64) * 2.0 - 1.0).collect();
        let lines = GridLines { point, plane, center: bounds.center(), half: bounds.half(), at: &at };
        let isa = self.rays.isa();
        let most = (BATCH / n).max(1);
        for first in (0..n).step_by(most) {
            let count = most.min(n - first);
            self.rays.restart(count * n);
            let columns = self.rays.columns_mut();
            columns.wavelength_nm[..count * n].fill(wavelength_nm);
            isa.run(Probes { lines, first, columns });
            self.follow(level);
            for (line, states) in (first..).zip(self.rays.states().chunks(n)) {
                let along = lines.along(line);
                let passed = (0..n).filter(|k| states[*k] == ALIVE);
                found.extend(passed.map(|k| [along, lines.across(line, k)]));
            }
        }
    }

    /// Finds the edge of what passes in [`EDGE`] directions from a point on the plane, at each of these wavelengths: the farthest
    /// points beyond which nothing was seen up to `bounds`. A line is empty if no probe passes.
    pub fn edges(
        &mut self,
        point: DVec3,
        plane: &Plane,
        from: [f64; 2],
        bounds: &Bounds,
        colors_nm: &[f64],
    ) -> Vec<Vec<[f64; 2]>> {
        let half = bounds.half();
        // In each direction out to the side of the rectangle; the directions are even around the ellipse in it.
        let ways: Vec<[f64; 2]> = (0..EDGE)
            .map(|k| {
                let (sin, cos) = spectra_core::math::sin_cos_turns(k as f64 / EDGE as f64);
                let way = [cos * half[0], sin * half[1]];
                let to = |i: usize| {
                    let side = if way[i] > 0.0 { bounds.high[i] } else { bounds.low[i] };
                    if way[i] == 0.0 { f64::INFINITY } else { ((side - from[i]) / way[i]).max(0.0) }
                };
                let out = to(0).min(to(1));
                way.map(|w| w * out)
            })
            .collect();
        let place = |k: usize, part: f64| [from[0] + part * ways[k][0], from[1] + part * ways[k][1]];
        let rays = colors_nm.len() * EDGE;
        let color = |ray: usize| colors_nm[ray / EDGE];
        // First the last step outward at which light passes, then halvings of the step after it.
        let mut low = vec![-1.0_f64; rays];
        let rough: Vec<(usize, usize)> = (0..rays).flat_map(|ray| (0..=ROUGH).map(move |step| (ray, step))).collect();
        for chunk in rough.chunks(BATCH) {
            let probes = chunk
                .iter()
                .map(|(ray, step)| (point, plane.at(place(ray % EDGE, *step as f64 / ROUGH as f64)), color(*ray)));
            let states = self.pass(probes);
            for ((ray, step), _) in chunk.iter().zip(states).filter(|(_, s)| **s == ALIVE) {
                low[*ray] = low[*ray].max(*step as f64 / ROUGH as f64);
            }
        }
        let mut high: Vec<f64> =
            low.iter().map(|l| if *l < 0.0 { 0.0 } else { (l + 1.0 / ROUGH as f64).min(1.0) }).collect();
        let open: Vec<usize> = (0..rays).filter(|ray| low[*ray] >= 0.0 && low[*ray] < high[*ray]).collect();
        for _ in 0..HALVINGS {
            for chunk in open.chunks(BATCH) {
                let probes = chunk
                    .iter()
                    .map(|ray| (point, plane.at(place(ray % EDGE, 0.5 * (low[*ray] + high[*ray]))), color(*ray)));
                let states = self.pass(probes);
                for (ray, state) in chunk.iter().zip(states) {
                    let middle = 0.5 * (low[*ray] + high[*ray]);
                    *(if *state == ALIVE { &mut low[*ray] } else { &mut high[*ray] }) = middle;
                }
            }
        }
        let line = |c: usize| {
            let own = c * EDGE..(c + 1) * EDGE;
            if low[own.clone()].iter().all(|l| *l < 0.0) {
                return Vec::new();
            }
            own.map(|ray| place(ray % EDGE, high[ray])).collect()
        };
        (0..colors_nm.len()).map(line).collect()
    }

    /// Traces these probes (point, target, wavelength), at most a batch, through the lens itself and returns their states.
    pub fn pass(&mut self, probes: impl ExactSizeIterator<Item = (DVec3, DVec3, f64)>) -> &[u64] {
        let level = self.stages.opened.len();
        self.trace(level, probes);
        self.rays.states()
    }

    /// Largest number of probes at once.
    pub fn capacity(&self) -> usize {
        BATCH
    }

    fn trace(&mut self, level: usize, probes: impl ExactSizeIterator<Item = (DVec3, DVec3, f64)>) {
        self.rays.restart(probes.len());
        let c = self.rays.columns_mut();
        for (i, (point, target, wavelength_nm)) in probes.enumerate() {
            let direction = (target - point).normalize();
            (c.x[i], c.y[i], c.z[i]) = target.into();
            (c.l[i], c.m[i], c.n[i]) = direction.into();
            c.wavelength_nm[i] = wavelength_nm;
        }
        self.follow(level);
    }

    /// Traces the probes that are in the batch.
    fn follow(&mut self, level: usize) {
        let (rays, work) = (&mut self.rays, &mut self.work[level]);
        match self.stages.opened.get(level) {
            Some(stage) => stage.trace(rays, work),
            None => self.stages.whole.trace(rays, work),
        }
    }
}

/// A square grid of points over a rectangle of a plane, line by line, seen from a point.
#[derive(Clone, Copy)]
struct GridLines<'a> {
    point: DVec3,
    plane: &'a Plane,
    center: [f64; 2],
    half: [f64; 2],
    /// Middles of the cells, from -1 to 1.
    at: &'a [f64],
}

impl GridLines<'_> {
    #[inline(always)]
    fn along(&self, line: usize) -> f64 {
        self.center[0] + self.half[0] * self.at[line]
    }

    /// Returns the coordinate across of point `k` on a line. Every other line is shifted by half a cell, because all lines of an aligned
    /// grid may miss a narrow tip.
    #[inline(always)]
    fn across(&self, line: usize, k: usize) -> f64 {
        let shift = if line % 2 == 1 { 0.5 } else { -0.5 } / self.at.len() as f64;
        self.center[1] + self.half[1] * (self.at[k] + shift)
    }
}

/// Kernel that puts rays through the points of some lines, from the `first` on.
struct Probes<'a> {
    lines: GridLines<'a>,
    first: usize,
    columns: Columns<'a>,
}

impl Vectorized for Probes<'_> {
    type Output = ();

    #[inline(always)]
    fn run(self) {
        let Self { lines, first, columns: c } = self;
        let (n, point, plane) = (lines.at.len(), lines.point, lines.plane);
        let own = c.x.chunks_exact_mut(n).zip(c.y.chunks_exact_mut(n)).zip(c.z.chunks_exact_mut(n));
        let own = own.zip(c.l.chunks_exact_mut(n)).zip(c.m.chunks_exact_mut(n)).zip(c.n.chunks_exact_mut(n));
        for (line, (((((x, y), z), l), m), cosine)) in (first..).zip(own) {
            let start = plane.origin + plane.along * lines.along(line);
            for k in 0..n {
                let target = start + plane.across * lines.across(line, k);
                let direction = (target - point).normalize();
                (x[k], y[k], z[k]) = target.into();
                (l[k], m[k], cosine[k]) = direction.into();
            }
        }
    }
}

/// The light found to pass from one point.
#[derive(Clone, Debug)]
pub(super) struct PassingPoints {
    /// Points on the plane.
    pub places: Vec<[f64; 2]>,
    /// Cell size of the grid, mm: the largest distance beyond each point at which light may pass undetected.
    pub cell: [f64; 2],
}
