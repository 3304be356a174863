//! The pupil as the object sees it.

use super::aiming::AimPattern;
use super::effort::Effort;
use super::nodes::Geometry;
use super::part::AimPart;
use super::sphere::Sphere;
use super::table::{Depth, Table, Zone};
use super::task::Task;
use crate::{Lens, Tracer, Travel};
use glam::DVec3;
use spectra_core::workers::{Alone, Workers};
use spectra_core::{Isa, RayBatch};

/// Where on its way into the lens light passes, for each point in front of it: the real entrance pupil,
/// as it is seen from there.
///
/// Points are in the frame of the lens (mm, first vertex at the origin). They may lie anywhere before or
/// beside it: zones go by the angle at which a point is seen from the paraxial entrance pupil (up to 130
/// degrees to each side) and by one over its distance. Points that lie nearer than those that the search
/// was told of are aimed at the whole first surface: slower, as true.
#[derive(Clone, Debug)]
pub struct FrontPupil {
    table: Table,
}

/// Zones of one over the distance are this fine, times one over the size of the lens.
const DEPTH_STEP: f64 = 0.05;
const MAX_DEPTHS: usize = 6;

impl FrontPupil {
    /// Searches the front of a lens as `tracer` holds it, for source points such as `points` (mm; the
    /// nearest and its surroundings, and all that are farther away, are made ready) and light from
    /// `min_nm` to `max_nm`. `None` where no surface states a size.
    #[must_use]
    pub fn search(lens: &Lens, tracer: &Tracer, points: &[DVec3], min_nm: f64, max_nm: f64) -> Option<Self> {
        Self::search_on(lens, tracer, points, [min_nm, max_nm], &Alone)
    }

    /// The same, shared out over workers, with the same bits on any; light of a band, nm.
    #[must_use]
    pub fn search_on(
        lens: &Lens,
        tracer: &Tracer,
        points: &[DVec3],
        band_nm: [f64; 2],
        workers: &dyn Workers,
    ) -> Option<Self> {
        Self::search_by(lens, tracer, points, band_nm, workers, Effort::Full)
    }

    /// The same with some effort. `None`, too, where the workers are to stop meanwhile.
    #[must_use]
    pub fn search_by(
        lens: &Lens,
        tracer: &Tracer,
        points: &[DVec3],
        band_nm: [f64; 2],
        workers: &dyn Workers,
        effort: Effort,
    ) -> Option<Self> {
        let bound = Sphere::around(lens, Travel::Forward)?;
        let size = lens.image_z_mm().abs() + bound.radius_mm;
        let pupil = lens.first_order(0.5 * (band_nm[0] + band_nm[1])).entrance_pupil_z_mm;
        let eye_z_mm = pupil.filter(|z| z.abs() < 2.0 * size).unwrap_or(bound.center.z);
        let reach = (eye_z_mm - bound.center.z).abs() + bound.radius_mm;
        let eye = DVec3::new(0.0, 0.0, eye_z_mm);
        let nearest = points.iter().map(|p| p.distance(eye)).fold(f64::INFINITY, f64::min) / 1.05;
        // Where the source is nearer than the lens is large, aiming at a region has no meaning.
        let to = 1.0 / nearest.max(1.3 * reach).min(100.0 * reach);
        let zones = ((to * reach / DEPTH_STEP).ceil() as usize).clamp(1, MAX_DEPTHS.min(effort.fineness().depths));
        let task = Task {
            lens,
            tracer,
            geometry: Geometry { travel: Travel::Forward, eye_z_mm, bound },
            depth: Depth { from: 0.0, to, zones },
            depth_nodes: (0..=zones).map(|k| to * k as f64 / zones as f64).collect(),
            most: 2.0,
            band_nm,
            workers,
            effort,
        };
        Some(Self { table: task.run()? })
    }

    /// The same without outlines: rays go all over the ellipse or rectangle of each zone, which holds what passes with a wide
    /// margin. Slower, and a reference for what outlines estimate.
    #[must_use]
    pub fn without_outlines(mut self) -> Self {
        self.table.outlines = None;
        self
    }

    /// Turns the rays of a batch, which are at their source points, toward the pupil, starts them
    /// there, and multiplies their weights by the solid angle of the region (sr), so that all of it
    /// counts alike. `u` and `v`, one a ray in [0, 1), choose the place. Rays of points from which
    /// nothing passes end, vignetted at the first surface; returns how many.
    pub fn aim(&self, rays: &mut RayBatch, u: &[f64], v: &[f64], pattern: AimPattern, isa: Isa) -> usize {
        self.table.aim::<false>(rays, u, v, (pattern, AimPart::Whole), isa)
    }

    /// The region for a source point, mm in the frame of the lens. `None` where the point is nearer than
    /// was searched.
    #[must_use]
    pub fn region(&self, point: DVec3) -> Option<AimRegion> {
        let (zone, radial, across) = self.table.zone::<false>(point)?;
        Some(AimRegion::new(&zone, radial, across, self.table.eye_z_mm))
    }

    /// The paraxial entrance pupil, from which the angle of a point is taken: mm from the first vertex.
    #[must_use]
    pub fn eye_z_mm(&self) -> f64 {
        self.table.eye_z_mm
    }
}

/// A flat region that holds all light from one point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AimRegion {
    /// Its middle, mm.
    pub center: DVec3,
    /// Half of it in the plane of the point and the axis, mm; zero where nothing passes.
    pub half_along: DVec3,
    /// Half of it at right angles to that, mm.
    pub half_across: DVec3,
    /// An ellipse, or else the rectangle around it.
    pub ellipse: bool,
}

impl AimRegion {
    pub(super) fn new(zone: &Zone, radial: DVec3, across: DVec3, eye_z_mm: f64) -> Self {
        let place = |r: f64, a: f64, z: f64| radial * r + across * a + DVec3::Z * z;
        let [r, a, z] = zone.center;
        Self {
            center: place(r, a, z + eye_z_mm),
            half_along: place(zone.half_along[0], 0.0, zone.half_along[1]),
            half_across: across * zone.half_across,
            ellipse: zone.ellipse,
        }
    }

    /// Its area, mm^2; 0 where nothing passes.
    #[must_use]
    pub fn area_mm2(&self) -> f64 {
        let unit = if self.ellipse { std::f64::consts::PI } else { 4.0 };
        unit * self.half_along.length() * self.half_across.length()
    }

    /// Whether the line from `point` in `direction` crosses it.
    #[must_use]
    pub fn holds(&self, point: DVec3, direction: DVec3) -> bool {
        let normal = self.half_along.cross(self.half_across);
        let at = point + direction * ((self.center - point).dot(normal) / direction.dot(normal)) - self.center;
        let a = at.dot(self.half_along) / self.half_along.length_squared();
        let b = at.dot(self.half_across) / self.half_across.length_squared();
        if self.ellipse { a * a + b * b <= 1.0 } else { a.abs() <= 1.0 && b.abs() <= 1.0 }
    }
}
