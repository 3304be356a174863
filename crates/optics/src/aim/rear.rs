//! The exit pupil as the film sees it.

use super::aiming::AimPattern;
use super::effort::Effort;
use super::front::AimRegion;
use super::measure::measure;
use super::nodes::Geometry;
use super::part::AimPart;
use super::sphere::Sphere;
use super::table::{Depth, Table};
use super::task::Task;
use glam::DVec3;
use spectra_core::RayBatch;
use spectra_core::workers::{SingleThread, Workers};
use spectra_lens::Lens;
use spectra_tracer::{Tracer, Travel};

/// A table of the places where light to each point of the imager leaves a lens: the real exit pupil as seen from there.
///
/// Points are in the frame of the image plane (mm, z = 0 there, the lens at negative z), anywhere behind the lens. They are
/// sorted into zones by the angle to the axis at which a point is seen from the last vertex, and by z if the points differ in z.
/// For points at depths that were not given to the search, rays are aimed at the whole last surface: slower, but equally correct.
#[derive(Clone, Debug)]
pub struct RearPupil {
    table: Table,
}

/// Width of the zones of the depth, relative to the distance from the last vertex.
const DEPTH_STEP: f64 = 0.02;
/// Largest spread of points, relative to their distance, at which they count as lying in one plane.
const FLAT: f64 = 1e-7;

impl RearPupil {
    /// Searches the exit pupil of `lens`, as `tracer` traces it. `points` are sample points all over the imager, including its
    /// corners (mm); the light has wavelengths from `min_nm` to `max_nm`. Returns `None` if no surface states a size, or no point
    /// is given.
    #[must_use]
    pub fn search(lens: &Lens, tracer: &Tracer, points: &[DVec3], min_nm: f64, max_nm: f64) -> Option<Self> {
        Self::search_on(lens, tracer, points, [min_nm, max_nm], &SingleThread)
    }

    /// Searches like [`RearPupil::search`], distributed over workers, for light of the band `band_nm`. The result is
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

    /// Searches like [`RearPupil::search_on`] with a given effort. Returns `None` also if the workers are stopped meanwhile.
    #[must_use]
    pub fn search_by(
        lens: &Lens,
        tracer: &Tracer,
        points: &[DVec3],
        band_nm: [f64; 2],
        workers: &dyn Workers,
        effort: Effort,
    ) -> Option<Self> {
        let bound = Sphere::around(lens, Travel::Backward)?;
        let vertex = lens.image_pose.local_point(lens.elements.last()?.pose.origin_mm);
        let nearest = points.iter().map(|p| p.z).reduce(f64::min)?;
        // The last vertex; if the lens stands among the points, a position in front of them.
        let eye_z_mm = vertex.z.min(nearest - 0.1 * bound.radius_mm);
        let ahead = |p: &DVec3| p.z - eye_z_mm;
        let near = points.iter().map(ahead).reduce(f64::min)?;
        let far = points.iter().map(ahead).reduce(f64::max)?;
        let beside = |p: &DVec3| (p.x * p.x + p.y * p.y).sqrt();
        let most = points.iter().map(|p| measure(beside(p), ahead(p)));
        // A little beyond the sample points, which represent those between them.
        let most = most.fold(0.0, f64::max) * 1.01 + 1e-6;
        let flat = far - near <= FLAT * far;
        let (middle, slack) = (0.5 * (near + far), 0.02 * (far - near) + FLAT * far);
        let (from, to) = ((near - slack).max(0.5 * near), far + slack);
        let zones = if flat {
            1
        } else {
            (((to - from) / (DEPTH_STEP * from)).ceil() as usize).clamp(1, effort.fineness().depths)
        };
        let node = |k: usize| from + (to - from) * k as f64 / zones as f64;
        let task = Task {
            lens,
            tracer,
            geometry: Geometry { travel: Travel::Backward, eye_z_mm, bound },
            depth: Depth { from, to, zones },
            depth_nodes: if flat { vec![middle] } else { (0..=zones).map(node).collect() },
            most: most.min(0.999),
            band_nm,
            workers,
            effort,
        };
        Some(Self { table: task.run()? })
    }

    /// Widens the pupil for an imager that shifts rays sideways by up to `margin_mm` after they are aimed, as glass plates do.
    #[must_use]
    pub fn widened(self, margin_mm: f64) -> Self {
        Self { table: self.table.widened(margin_mm) }
    }

    /// Removes the outlines: rays then fill the ellipse or rectangle of each zone, which contains the passing light with a wide
    /// margin. This is slower, and serves as a reference for the estimate with outlines.
    #[must_use]
    pub fn without_outlines(mut self) -> Self {
        self.table.outlines = None;
        self
    }

    /// Aims the rays of a batch at the pupil; on entry their positions are points of the imager, and their directions the
    /// imager's unit normal. Each ray then starts at the pupil, and its weight is multiplied by the projected solid angle of the
    /// region (sr). `u` and `v`, one value per ray in [0, 1), choose the point of the pupil. Rays from points that no light
    /// reaches end as vignetted at the last surface. Returns how many rays end.
    pub fn aim(&self, rays: &mut RayBatch, u: &[f64], v: &[f64]) -> usize {
        self.aim_part(rays, u, v, AimPart::Whole)
    }

    /// Aims rays like [`RearPupil::aim`] at one part of the pupil. If the pupil has no [rim](Self::has_rim), its core is the
    /// whole pupil.
    pub fn aim_part(&self, rays: &mut RayBatch, u: &[f64], v: &[f64], part: AimPart) -> usize {
        debug_assert!(part != AimPart::Rim || self.has_rim());
        self.table.aim::<true>(rays, u, v, (AimPattern::Disk, part))
    }

    /// Returns whether the pupil has a rim, as outlines have; ellipses and rectangles have none.
    #[must_use]
    pub fn has_rim(&self) -> bool {
        self.table.outlines.is_some()
    }

    /// Returns the region at which rays from a point of the imager (mm, frame of the image plane) are aimed; `None` at a depth
    /// that was not searched.
    #[must_use]
    pub fn region(&self, point: DVec3) -> Option<AimRegion> {
        let (zone, radial, across) = self.table.zone::<true>(point)?;
        Some(AimRegion::new(&zone, radial, across, self.table.eye_z_mm))
    }
}
