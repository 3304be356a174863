//! View of the frame through the lens: real rays from points all over the frame, traced backward at the lens's reference
//! wavelength.
//!
//! From each point a bundle is aimed at the paraxial exit pupil and somewhat beyond it. If no ray of it passes (a wide angle, a
//! fold, a vignetted corner), the bundle is aimed at the real exit pupil, which takes longer to find. Each ray that passes is a
//! line of sight.

use spectra_core::RayBatch;
use spectra_core::frame::FrameSize;
use spectra_core::frame_view::{FrameView, SightLine};
use spectra_core::glam::DVec3;
use spectra_core::loss::ALIVE;
use spectra_core::stage::Imager;
use spectra_core::workers::{SingleThread, Workers};
use spectra_optics::{Effort, Optics, RearPupil};
use spectra_tracer::{Indices, Tracer, Travel};
use std::sync::Arc;

/// Number of points along each side of the frame, including its edges.
const SIDE: usize = 13;
/// Radius of the first bundle, in radii of the paraxial exit pupil. The real pupil of a fast lens is larger than the paraxial
/// one.
const BEYOND: f64 = 1.15;
/// Number of rays along each side of the grid over the real exit pupil.
const CELLS: usize = 12;
/// Number of bisection steps from the middle of the frame to a corner, in the search for the edge of the light.
const HALVINGS: usize = 7;

/// Settings of the search for what the frame sees.
#[derive(Clone, Copy)]
pub struct ViewSearch<'a> {
    /// Effort of the search. A draft has a view that differs slightly from that of the picture.
    pub effort: Effort,
    /// Threads that trace. The result has the same bits for any number of threads. If they are told to stop, the assembly of the
    /// scene fails, and its error means nothing.
    pub workers: &'a dyn Workers,
}

impl Default for ViewSearch<'_> {
    fn default() -> Self {
        Self { effort: Effort::Full, workers: &SingleThread }
    }
}

/// The view of the frame, and its dark part.
pub(crate) struct ViewSearchResult {
    pub view: FrameView,
    /// The part of the frame that the lens leaves dark, if any.
    pub dark: Option<UncoveredFrame>,
}

/// A frame that is larger than the image circle of the lens.
#[derive(Clone, Debug)]
pub(crate) struct UncoveredFrame {
    /// Diameter of the image circle, mm; `None` if the middle of the frame is dark.
    pub circle_mm: Option<f64>,
    /// Diagonal of the frame, mm.
    pub diagonal_mm: f64,
    /// Fraction of the points of the frame that get no light.
    pub share: f64,
}

/// Returns what the frame of `imager` sees through `lens`. `None` if that cannot be found: an imager that launches no rays, or a
/// lens with no surface that states its size.
pub(crate) fn find_view(lens: &Optics, imager: &dyn Imager, search: ViewSearch<'_>) -> Option<ViewSearchResult> {
    let aim = Aim::new(lens)?;
    let points = points(imager, &grid())?;
    let mut found = aim.sights(&points);
    let lost: Vec<usize> = (0..points.len()).filter(|point| found[*point].is_empty()).collect();
    let pupil = if lost.is_empty() { None } else { Some(aim.pupil(&points, search)?) };
    if let Some(pupil) = &pupil {
        let again = aim.through(pupil, &lost.iter().map(|i| points[*i]).collect::<Vec<_>>());
        for (point, sights) in lost.iter().zip(again) {
            found[*point] = sights;
        }
    }
    let (mut sights, mut beside) = (Vec::new(), Vec::new());
    for (point, of_point) in found.iter().enumerate() {
        if of_point.iter().any(Option::is_none) {
            beside.push(point);
        }
        sights.extend(of_point.iter().flatten().map(|sight| SightLine { point, ..*sight }));
    }
    let unlit = found.iter().filter(|sights| sights.is_empty()).count();
    let dark = pupil.filter(|_| unlit > 0).map(|pupil| UncoveredFrame {
        circle_mm: circle_mm(&aim, &pupil, imager),
        diagonal_mm: diagonal_mm(imager.size()),
        share: unlit as f64 / points.len() as f64,
    });
    let view = FrameView::new(sights, beside).with_focal_length(lens.first_order(lens.reference_nm).efl_mm);
    Some(ViewSearchResult { view, dark })
}

fn diagonal_mm(size: FrameSize) -> f64 {
    (size.width_mm * size.width_mm + size.height_mm * size.height_mm).sqrt()
}

/// Returns places in the frame, from 0 to 1 across and down.
fn grid() -> Vec<[f64; 2]> {
    let at = |k: usize| k as f64 / (SIDE - 1) as f64;
    (0..SIDE * SIDE).map(|i| [at(i % SIDE), at(i / SIDE)]).collect()
}

/// Returns the points of the imager at these places, mm in the frame of the image plane.
fn points(imager: &dyn Imager, places: &[[f64; 2]]) -> Option<Vec<DVec3>> {
    let (launch, size) = (imager.launch()?, imager.size());
    let mut rays = RayBatch::new(places.len());
    rays.restart(places.len());
    let split = |at: f64, pixels: u32| {
        let at = at * f64::from(pixels);
        let pixel = (at as u32).min(pixels - 1);
        (pixel, at - f64::from(pixel))
    };
    let (mut u, mut v) = (Vec::new(), Vec::new());
    for (tag, [across, down]) in rays.columns_mut().tag.iter_mut().zip(places) {
        let (column, x) = split(*across, size.width_px);
        let (row, y) = split(*down, size.height_px);
        *tag = row * size.width_px + column;
        u.push(x);
        v.push(y);
    }
    launch.place(&mut rays, &u, &v);
    let [x, y, z] = rays.positions();
    Some((0..places.len()).map(|i| DVec3::new(x[i], y[i], z[i])).collect())
}

/// Returns the diameter of the image circle about the axis, mm. Searches from the middle of the frame toward each corner for the
/// edge of the light.
fn circle_mm(aim: &Aim<'_>, pupil: &RearPupil, imager: &dyn Imager) -> Option<f64> {
    let passes = |places: &[[f64; 2]]| -> Option<Vec<(bool, f64)>> {
        let points = points(imager, places)?;
        let lit = aim.through(pupil, &points);
        let beside = |p: &DVec3| (p.x * p.x + p.y * p.y).sqrt();
        Some(lit.iter().zip(&points).map(|(sights, p)| (!sights.is_empty(), beside(p))).collect())
    };
    let corners = [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [1.0, 1.0]];
    let along = |corner: [f64; 2], part: f64| [0, 1].map(|k| 0.5 + (corner[k] - 0.5) * part);
    if !passes(&[[0.5; 2]])?[0].0 {
        return None;
    }
    let (mut lit, mut dark) = ([0.0_f64; 4], [1.0_f64; 4]);
    let mut radius_mm = 0.0_f64;
    for _ in 0..HALVINGS {
        let middle: [f64; 4] = std::array::from_fn(|i| 0.5 * (lit[i] + dark[i]));
        let places: Vec<[f64; 2]> = (0..4).map(|i| along(corners[i], middle[i])).collect();
        for (i, (passes, beside_mm)) in passes(&places)?.into_iter().enumerate() {
            if passes {
                lit[i] = middle[i];
                radius_mm = radius_mm.max(beside_mm);
            } else {
                dark[i] = middle[i];
            }
        }
    }
    Some(2.0 * radius_mm)
}

/// Lines of sight of a point; `None` for a line that runs backward.
type Sights = Vec<Option<SightLine>>;

struct Aim<'a> {
    lens: &'a Optics,
    tracer: Arc<Tracer>,
}

impl<'a> Aim<'a> {
    fn new(lens: &'a Optics) -> Option<Self> {
        lens.largest_semi_diameter_mm()?;
        let tracer = lens.tracer(Indices::At(lens.reference_nm)).ok()?;
        Some(Self { lens, tracer })
    }

    /// Traces lines of sight from each point through the paraxial exit pupil: its center, two rings inside it and one beyond it.
    fn sights(&self, points: &[DVec3]) -> Vec<Sights> {
        let lens = self.lens;
        let first = lens.first_order(lens.reference_nm);
        let radius_mm = lens.stop().and_then(|stop| lens.elements[stop].semi_diameter_mm);
        let (Some(z_mm), Some(by), Some(radius_mm)) =
            (first.exit_pupil_z_mm, first.exit_pupil_magnification, radius_mm)
        else {
            return points.iter().map(|_| Vec::new()).collect();
        };
        let ring = [0.0, 0.125, 0.25, 0.375, 0.5, 0.625, 0.75, 0.875].map(spectra_core::math::sin_cos_turns);
        let mut targets = vec![lens.image_pose.local_point(DVec3::new(0.0, 0.0, z_mm))];
        for part in [0.5, 0.98, BEYOND] {
            for (sin, cos) in ring {
                let r = part * by.abs() * radius_mm;
                targets.push(lens.image_pose.local_point(DVec3::new(r * cos, r * sin, z_mm)));
            }
        }
        self.traced(points, &targets)
    }

    /// Finds the real exit pupil as seen from points of the imager.
    fn pupil(&self, points: &[DVec3], search: ViewSearch<'_>) -> Option<RearPupil> {
        let ViewSearch { effort, workers } = search;
        RearPupil::search_by(self.lens, &self.tracer, points, [self.lens.reference_nm; 2], workers, effort)
    }

    /// Traces lines of sight from each point through the real exit pupil.
    fn through(&self, pupil: &RearPupil, points: &[DVec3]) -> Vec<Sights> {
        let step = |k: usize| (k as f64 + 0.5) / CELLS as f64;
        let (u, v): (Vec<f64>, Vec<f64>) = (0..CELLS * CELLS).map(|i| (step(i % CELLS), step(i / CELLS))).unzip();
        let mut rays = RayBatch::new(u.len());
        let mut work = self.tracer.work_in_place(u.len());
        let one = |point: &DVec3| {
            rays.restart(u.len());
            let c = rays.columns_mut();
            for i in 0..u.len() {
                (c.x[i], c.y[i], c.z[i]) = (*point).into();
                (c.l[i], c.m[i], c.n[i]) = (0.0, 0.0, -1.0);
            }
            c.wavelength_nm.fill(self.lens.reference_nm);
            pupil.aim(&mut rays, &u, &v);
            self.tracer.trace(&mut rays, &mut work, Travel::Backward);
            sights(&rays)
        };
        points.iter().map(one).collect()
    }

    fn traced(&self, points: &[DVec3], targets: &[DVec3]) -> Vec<Sights> {
        let mut rays = RayBatch::new(targets.len());
        let mut work = self.tracer.work_in_place(targets.len());
        let one = |point: &DVec3| {
            rays.restart(targets.len());
            let c = rays.columns_mut();
            for (i, target) in targets.iter().enumerate() {
                // A pupil behind the film lies on the same line, so the ray runs away from it.
                let way = (*target - *point).normalize_or_zero();
                let way = if way.z > 0.0 { -way } else { way };
                (c.x[i], c.y[i], c.z[i]) = (*point).into();
                (c.l[i], c.m[i], c.n[i]) = way.into();
                c.wavelength_nm[i] = self.lens.reference_nm;
            }
            self.tracer.trace(&mut rays, &mut work, Travel::Backward);
            sights(&rays)
        };
        points.iter().map(one).collect()
    }
}

/// Returns the lines of sight of the rays that passed.
fn sights(rays: &RayBatch) -> Sights {
    let ([x, y, z], [l, m, n]) = (rays.positions(), rays.directions());
    let sight = |i: usize| {
        let slope = [l[i] / -n[i], m[i] / -n[i]];
        let start_mm = [x[i] + z[i] * slope[0], y[i] + z[i] * slope[1]];
        let is_ahead = n[i] < 0.0 && slope.iter().chain(&start_mm).all(|v| v.is_finite());
        is_ahead.then_some(SightLine { point: 0, start_mm, slope })
    };
    (0..rays.len()).filter(|i| rays.states()[*i] == ALIVE).map(sight).collect()
}
