//! The pupil as the film sees it.

use super::aiming::AimPattern;
use super::effort::Effort;
use super::front::AimRegion;
use super::measure::measure;
use super::nodes::Geometry;
use super::part::AimPart;
use super::sphere::Sphere;
use super::table::{Depth, Table};
use super::task::Task;
use crate::{Lens, Tracer, Travel};
use glam::DVec3;
use spectra_core::workers::{Alone, Workers};
use spectra_core::{Isa, RayBatch};

/// Where on its way out of the lens light comes from, for each point of the imager: the real exit pupil,
/// as it is seen from there.
///
/// Points are in the frame of the image plane (mm, z = 0 there, the lens at negative z). They may lie
/// anywhere behind the lens: zones go by the angle to the axis at which a point is seen from the last
/// vertex, and by its z where points differ in it. Points beside the depths that the search was told of
/// are aimed at the whole last surface: slower, as true.
#[derive(Clone, Debug)]
pub struct RearPupil {
    table: Table,
}

/// Zones of the depth are this fine, times the distance from the last vertex.
const DEPTH_STEP: f64 = 0.02;
/// Points within this of one plane, as a share of their distance, are on it.
const FLAT: f64 = 1e-7;

impl RearPupil {
    /// Searches the rear of a lens as `tracer` holds it, for the points of an imager, of which `points`
    /// are examples all over it, its corners among them (mm), and light from `min_nm` to `max_nm`. `None`
    /// where no surface states a size, or no point is given.
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
        let bound = Sphere::around(lens, Travel::Backward)?;
        let vertex = lens.image_pose.local_point(lens.elements.last()?.pose.origin_mm);
        let nearest = points.iter().map(|p| p.z).reduce(f64::min)?;
        // The last vertex; of a lens that stands among the points, some place in front of them.
        let eye_z_mm = vertex.z.min(nearest - 0.1 * bound.radius_mm);
        let ahead = |p: &DVec3| p.z - eye_z_mm;
        let near = points.iter().map(ahead).reduce(f64::min)?;
        let far = points.iter().map(ahead).reduce(f64::max)?;
        let beside = |p: &DVec3| (p.x * p.x + p.y * p.y).sqrt();
        let most = points.iter().map(|p| measure(beside(p), ahead(p)));
        // A little beyond the points that were shown, which stand for those between them.
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

    /// The same for an imager that moves rays aside by up to `margin_mm` after they were aimed, as plates of glass do.
    #[must_use]
    pub fn widened(self, margin_mm: f64) -> Self {
        Self { table: self.table.widened(margin_mm) }
    }

    /// The same without outlines: rays go all over the ellipse or rectangle of each zone, which holds what passes with a wide
    /// margin. Slower, and a reference for what outlines estimate.
    #[must_use]
    pub fn without_outlines(mut self) -> Self {
        self.table.outlines = None;
        self
    }

    /// Turns the rays of a batch, which are at points of the imager, toward the pupil, starts them
    /// there, and multiplies their weights by the projected solid angle of the region, sr; the imager's
    /// unit normal stands in the place of each direction. `u` and `v`, one a ray in [0, 1), choose the
    /// place. Rays of points to which nothing comes end, vignetted at the last surface; returns how many.
    pub fn aim(&self, rays: &mut RayBatch, u: &[f64], v: &[f64], isa: Isa) -> usize {
        self.aim_part(rays, u, v, AimPart::Whole, isa)
    }

    /// The same for a part of it; the core is all of it where there is no [rim](Self::has_rim).
    pub fn aim_part(&self, rays: &mut RayBatch, u: &[f64], v: &[f64], part: AimPart, isa: Isa) -> usize {
        debug_assert!(part != AimPart::Rim || self.has_rim());
        self.table.aim::<true>(rays, u, v, (AimPattern::Disk, part), isa)
    }

    /// Whether what passes has a rim: outlines do, ellipses and rectangles do not.
    #[must_use]
    pub fn has_rim(&self) -> bool {
        self.table.outlines.is_some()
    }

    /// The region for a point of the imager, mm in the frame of the image plane. `None` where the point
    /// lies at a depth that was not searched.
    #[must_use]
    pub fn region(&self, point: DVec3) -> Option<AimRegion> {
        let (zone, radial, across) = self.table.zone::<true>(point)?;
        Some(AimRegion::new(&zone, radial, across, self.table.eye_z_mm))
    }
}
