//! The entrance pupil as the object sees it.

use super::aiming::AimPattern;
use super::effort::Effort;
use super::nodes::Geometry;
use super::part::AimPart;
use super::sphere::Sphere;
use super::table::{Depth, Table, Zone};
use super::task::Task;
use glam::DVec3;
use spectra_core::RayBatch;
use spectra_core::workers::{SingleThread, Workers};
use spectra_lens::Lens;
use spectra_tracer::{Tracer, Travel};

/// A table of the places where light from each point in front of a lens enters it: the real entrance pupil as seen from there.
///
/// Points are in the frame of the lens (mm, first vertex at the origin), anywhere in front of the lens or beside it. They are
/// sorted into zones by angle and by one over the distance. The angle is measured at the paraxial entrance pupil, up to 130
/// degrees to each side. For points nearer than those given to the search, rays are aimed at the whole first surface: slower, but
/// equally correct.
#[derive(Clone, Debug)]
pub struct FrontPupil {
    table: Table,
}

/// Width of the zones of one over the distance, relative to one over the size of the lens.
const DEPTH_STEP: f64 = 0.05;
const MAX_DEPTHS: usize = 6;

impl FrontPupil {
    /// Searches the entrance pupil of `lens`, as `tracer` traces it. `points` are sample source points (mm): the search covers
    /// the nearest one with its surroundings, and everything farther away. The light has wavelengths from `min_nm` to `max_nm`.
    /// Returns `None` if no surface states a size.
    #[must_use]
    pub fn search(lens: &Lens, tracer: &Tracer, points: &[DVec3], min_nm: f64, max_nm: f64) -> Option<Self> {
        Self::search_on(lens, tracer, points, [min_nm, max_nm], &SingleThread)
    }

    /// Searches like [`FrontPupil::search`], distributed over workers, for light of the band `band_nm`. The result is
    /// bit-identical on any workers.
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

    /// Searches like [`FrontPupil::search_on`] with a given effort. Returns `None` also if the workers are stopped meanwhile.
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
        // If the source is nearer than the size of the lens, aiming at a region is meaningless.
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

    /// Removes the outlines: rays then fill the ellipse or rectangle of each zone, which contains the passing light with a wide
    /// margin. This is slower, and serves as a reference for the estimate with outlines.
    #[must_use]
    pub fn without_outlines(mut self) -> Self {
        self.table.outlines = None;
        self
    }

    /// Aims the rays of a batch at the pupil; on entry their positions are their source points. Each ray then starts at the
    /// pupil, and its weight is multiplied by the solid angle of the region (sr). `u` and `v`, one value per ray in [0, 1),
    /// choose the point of the pupil. If no light from a source point passes, its rays end as vignetted at the first surface.
    /// Returns how many rays end.
    pub fn aim(&self, rays: &mut RayBatch, u: &[f64], v: &[f64], pattern: AimPattern) -> usize {
        self.table.aim::<false>(rays, u, v, (pattern, AimPart::Whole))
    }

    /// Returns the region at which rays from a source point (mm, frame of the lens) are aimed; `None` if the point is nearer than
    /// was searched.
    #[must_use]
    pub fn region(&self, point: DVec3) -> Option<AimRegion> {
        let (zone, radial, across) = self.table.zone::<false>(point)?;
        Some(AimRegion::new(&zone, radial, across, self.table.eye_z_mm))
    }

    /// Position of the point from which the angles of source points are measured, mm from the first vertex. It is the center of
    /// the paraxial entrance pupil or, if that lies far away, the middle of the first surface.
    #[must_use]
    pub fn eye_z_mm(&self) -> f64 {
        self.table.eye_z_mm
    }
}

/// A flat region that contains all light from one point that passes the lens.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AimRegion {
    /// Center of the region, mm.
    pub center: DVec3,
    /// Half-axis in the plane that contains the point and the axis, mm; zero if no light passes.
    pub half_along: DVec3,
    /// Half-axis at right angles to the plane of point and axis, mm.
    pub half_across: DVec3,
    /// Whether the region is an ellipse with these half-axes; otherwise it is the rectangle around that ellipse.
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

    /// Returns the area of the region, mm^2; 0 if no light passes.
    #[must_use]
    pub fn area_mm2(&self) -> f64 {
        let unit = if self.ellipse { std::f64::consts::PI } else { 4.0 };
        unit * self.half_along.length() * self.half_across.length()
    }

    /// Returns whether the line from `point` in `direction` crosses the region.
    #[must_use]
    pub fn holds(&self, point: DVec3, direction: DVec3) -> bool {
        let normal = self.half_along.cross(self.half_across);
        let at = point + direction * ((self.center - point).dot(normal) / direction.dot(normal)) - self.center;
        let a = at.dot(self.half_along) / self.half_along.length_squared();
        let b = at.dot(self.half_across) / self.half_across.length_squared();
        if self.ellipse { a * a + b * b <= 1.0 } else { a.abs() <= 1.0 && b.abs() <= 1.0 }
    }
}
