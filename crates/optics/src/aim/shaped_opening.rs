//! One opening that is not round (blades, a drawing, a mask) in a lens that is otherwise round.
//!
//! The light that passes such a lens is the light that passes the round lens around it, cut by the opening as seen from the point. So the
//! round lens is searched, with few zones. The edge of the opening is carried to the pupil by a cubic map that is fitted to traced rays,
//! and cut by the rims. The result is kept in the frame of the lens, by zones of azimuth. If the opening looks the same after a fraction of
//! a turn, only one such sector is computed. Through a zone the outlines move either as the light that the rims pass or as the opening,
//! whichever leaves the smaller area to aim at.

use super::nodes::Node;
use glam::DVec3;
use spectra_core::RayBatch;
use spectra_core::linear::solve_definite;
use spectra_core::loss::ALIVE;
use spectra_core::math::sin_cos_turns;
use spectra_lens::{Aperture, ApertureShape};
use spectra_lens::{Lens, Pose};
use spectra_tracer::{Indices, Path, Route, Tracer, Travel};

/// Number of points on the edge of the opening.
const EDGE: usize = 120;
/// Number of steps from outside in which the edge is searched, and of halvings of the step that finds it.
const ROUGH: usize = 64;
const HALVINGS: usize = 12;
/// Largest number of folds of symmetry that are tested.
const FOLDS: usize = 16;
/// Smallest number of zones of the azimuth.
const AZIMUTHS: usize = 64;
/// Fractions of the distance to the edge of what passes at which points are traced to fit the map.
const PARTS: [f64; 3] = [0.4, 0.75, 0.98];

/// The opening that is not round, and the lens through which it is seen.
pub(super) struct ShapedOpening {
    /// Edge of the opening, in the plane at right angles to the axis, in the frame that rays start in, mm.
    edge: Vec<[f64; 2]>,
    /// Number of folds: the opening looks the same after a turn by one over this.
    pub folds: usize,
    tracer: Tracer,
    route: Route,
    /// Pose that converts the frame that rays leave in to the frame that they start in.
    back: Pose,
}

/// Returns the lens without its one opening that is not round, and the element of that opening; `None` if there is not exactly one.
pub(super) fn split(lens: &Lens) -> Option<(Lens, usize)> {
    let uneven = |e: &spectra_lens::Element| e.apertures.iter().any(|a| !a.is_round());
    let mut several = (0..lens.elements.len()).filter(|k| uneven(&lens.elements[*k]));
    let (at, None) = (several.next()?, several.next()) else { return None };
    let mut round = lens.clone();
    let e = &mut round.elements[at];
    let semi = e.semi_diameter_mm;
    let iris = e.apertures.iter().any(|a| !a.obscures && matches!(a.shape, ApertureShape::Iris(_)));
    let mut reach = semi.filter(|_| !iris).unwrap_or(f64::INFINITY);
    for a in e.apertures.iter().filter(|a| !a.obscures) {
        reach = reach.min(reach_mm(a, semi));
    }
    if !reach.is_finite() {
        return None;
    }
    e.semi_diameter_mm = Some(reach);
    e.apertures.clear();
    // Behind an odd number of mirrors the picture of the lens is mirrored and turns the other way.
    (round.has_axis_of_revolution() && lens.image_pose.is_on_axis()).then_some((round, at))
}

fn reach_mm(aperture: &Aperture, semi_mm: Option<f64>) -> f64 {
    match (&aperture.shape, semi_mm) {
        (ApertureShape::Iris(iris), Some(semi)) => {
            let [x, y] = aperture.center_mm;
            iris.opening(semi).corner_radius_mm() + (x * x + y * y).sqrt()
        }
        _ => aperture.reach_mm(),
    }
}

impl ShapedOpening {
    /// Creates the opening of `lens` at one of its elements; `round` is the lens without the opening.
    pub fn new(
        lens: &Lens,
        round: &Lens,
        at: usize,
        travel: Travel,
        band_nm: [f64; 2],
        whole: &Tracer,
    ) -> Option<Self> {
        let e = &lens.elements[at];
        let rim = round.elements[at].semi_diameter_mm?;
        let iris = e.apertures.iter().any(|a| !a.obscures && matches!(a.shape, ApertureShape::Iris(_)));
        let passes = |way: [f64; 2], r: f64| {
            let own = iris || e.semi_diameter_mm.is_none_or(|semi| r <= semi);
            own && e.apertures.iter().all(|a| a.transmittance(way[0] * r, way[1] * r, e.semi_diameter_mm) > 0.0)
        };
        let radius = |turns: f64| {
            let (sin, cos) = sin_cos_turns(turns - turns.floor());
            let step = rim / ROUGH as f64;
            let Some(k) = (1..=ROUGH).rev().find(|k| passes([cos, sin], step * *k as f64)) else { return 0.0 };
            let (mut low, mut high) = (step * k as f64, (step * (k + 1) as f64).min(rim));
            for _ in 0..HALVINGS {
                let middle = 0.5 * (low + high);
                *(if passes([cos, sin], middle) { &mut low } else { &mut high }) = middle;
            }
            high
        };
        let samples: Vec<f64> = (0..24).map(|k| 0.013 + f64::from(k) / 24.0).collect();
        let own: Vec<f64> = samples.iter().map(|t| radius(*t)).collect();
        let alike =
            |n: usize| samples.iter().zip(&own).all(|(t, r)| (radius(t + 1.0 / n as f64) - r).abs() < 1e-3 * rim);
        let folds = (2..=FOLDS).rev().find(|n| alike(*n)).unwrap_or(1);
        let edge = (0..EDGE).map(|k| {
            let turns = k as f64 / EDGE as f64;
            let (sin, cos) = sin_cos_turns(turns);
            let r = radius(turns);
            let place = e.pose.point(DVec3::new(r * cos, r * sin, 0.0));
            let place = if travel == Travel::Forward { place } else { lens.image_pose.local_point(place) };
            [place.x, place.y]
        });
        let edge = edge.collect();
        let tracer = Tracer::new(round, Indices::Band { min_nm: band_nm[0], max_nm: band_nm[1] }).ok()?;
        let path = Path::through(round.elements.len(), travel).up_to(|k| k == at);
        // An opening behind a surface that scatters cannot be aimed at.
        let (_, before) = path.steps().split_last()?;
        if before.iter().any(|step| whole.is_random_at(step.element)) {
            return None;
        }
        let back = if travel == Travel::Forward { lens.image_pose } else { lens.image_pose.inverse() };
        Some(Self { edge, folds, route: tracer.route(&path), tracer, back })
    }

    /// Number of zones of the azimuth: the same number in each fold.
    pub fn azimuths(&self) -> usize {
        self.folds * AZIMUTHS.div_ceil(self.folds)
    }

    /// Fits the map from points of the opening to lines of sight from a node, at one wavelength. Returns `None` if too little
    /// of the opening is seen.
    pub fn opening_map(&self, node: &Node, line: &[DVec3], wavelength_nm: f64) -> Option<OpeningMap> {
        let middle = line.iter().sum::<DVec3>() / line.len() as f64;
        let targets: Vec<DVec3> = std::iter::once(middle)
            .chain(PARTS.iter().flat_map(|part| line.iter().step_by(3).map(move |p| middle + (*p - middle) * *part)))
            .collect();
        let (mut work, mut rays) = (self.tracer.work_unweighed(targets.len()), RayBatch::new(targets.len()));
        rays.restart(targets.len());
        let c = rays.columns_mut();
        for (i, target) in targets.iter().enumerate() {
            (c.x[i], c.y[i], c.z[i]) = (*target).into();
            (c.l[i], c.m[i], c.n[i]) = (*target - node.point).normalize().into();
            c.wavelength_nm[i] = wavelength_nm;
        }
        self.tracer.follow(&self.route, &mut rays, &mut work);
        let [x, y, z] = rays.positions();
        let mut fit = [Fit::default(), Fit::default(), Fit::default()];
        for (i, target) in targets.iter().enumerate() {
            if rays.states()[i] != ALIVE {
                continue;
            }
            let at = DVec3::new(x[i], y[i], z[i]);
            let at = self.back.point(at);
            let terms = terms([at.x, at.y]);
            let away = *target - middle;
            for (fit, value) in fit.iter_mut().zip([away.x, away.y, away.z]) {
                fit.add(&terms, value);
            }
        }
        let [a, b, c] = fit.map(|f| f.solved());
        Some(OpeningMap { middle, by: [a?, b?, c?] })
    }

    /// Returns the circle with the mean radius of the opening's edge, as seen through a map.
    pub fn around(&self, seen: &OpeningMap) -> Vec<DVec3> {
        let radius = self.edge.iter().map(|[x, y]| (x * x + y * y).sqrt()).sum::<f64>() / self.edge.len() as f64;
        let at = |k: usize| {
            let (sin, cos) = sin_cos_turns(k as f64 / AROUND as f64);
            seen.at([radius * cos, radius * sin])
        };
        (0..AROUND).map(at).collect()
    }

    /// Returns the edge of the opening as seen through a map, from a point of this azimuth.
    pub fn line(&self, seen: &OpeningMap, turns: f64) -> Vec<DVec3> {
        let (sin, cos) = sin_cos_turns(turns - turns.floor());
        self.edge.iter().map(|[x, y]| seen.at([x * cos + y * sin, y * cos - x * sin])).collect()
    }
}

/// Number of points on the circle that represents the opening.
const AROUND: usize = 16;

/// Number of terms of a map, to the third power: enough for a pupil seen through lenses.
const TERMS: usize = 10;

fn terms([x, y]: [f64; 2]) -> [f64; TERMS] {
    [1.0, x, y, x * x, x * y, y * y, x * x * x, x * x * y, x * y * y, y * y * y]
}

/// A cubic map from points of the opening to points on the plane of a node.
pub(super) struct OpeningMap {
    middle: DVec3,
    by: [[f64; TERMS]; 3],
}

impl OpeningMap {
    fn at(&self, place: [f64; 2]) -> DVec3 {
        let terms = terms(place);
        let sum = |by: &[f64; TERMS]| by.iter().zip(terms).map(|(a, b)| a * b).sum::<f64>();
        self.middle + DVec3::new(sum(&self.by[0]), sum(&self.by[1]), sum(&self.by[2]))
    }
}

/// A least-squares fit of one coordinate of a cubic map.
#[derive(Clone, Copy, Default)]
struct Fit {
    rows: [[f64; TERMS]; TERMS],
    right: [f64; TERMS],
    count: usize,
}

impl Fit {
    fn add(&mut self, terms: &[f64; TERMS], value: f64) {
        for (i, a) in terms.iter().enumerate() {
            for (j, b) in terms.iter().enumerate() {
                self.rows[i][j] += a * b;
            }
            self.right[i] += a * value;
        }
        self.count += 1;
    }

    /// Solves the normal equations, scaled because powers of mm differ in size. Returns `None` if there are too few points.
    fn solved(mut self) -> Option<[f64; TERMS]> {
        if self.count < 2 * TERMS {
            return None;
        }
        let scale: [f64; TERMS] = std::array::from_fn(|i| 1.0 / self.rows[i][i].sqrt());
        for i in 0..TERMS {
            for j in 0..TERMS {
                self.rows[i][j] *= scale[i] * scale[j];
            }
            self.right[i] *= scale[i];
            self.rows[i][i] += 1e-13;
        }
        let x = solve_definite(self.rows.as_flattened(), &self.right)?;
        Some(std::array::from_fn(|i| x[i] * scale[i])).filter(|x: &[f64; TERMS]| x.iter().all(|v| v.is_finite()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_cubic_map_is_found_again() {
        let want: [f64; TERMS] = std::array::from_fn(|k| 1.0 / (k as f64 + 1.0));
        let value = |p: [f64; 2]| terms(p).iter().zip(want).map(|(a, b)| a * b).sum::<f64>();
        let mut fit = Fit::default();
        for k in 0..49 {
            let p = [f64::from(k % 7) - 3.0, f64::from(k / 7) - 2.5];
            fit.add(&terms(p), value(p));
        }
        for (got, want) in fit.solved().unwrap().iter().zip(want) {
            assert!((got - want).abs() < 1e-8, "{got} {want}");
        }
    }
}
