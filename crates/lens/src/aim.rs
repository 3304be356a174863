//! Where to aim rays so that few are wasted and none that could pass is forgotten.

use crate::{Lens, Tracer, Travel};
use spectra_core::RayBatch;
use spectra_core::loss::ALIVE;

/// The rim of the first surface: forward rays are aimed at this disk, across the axis.
///
/// Cap and disk close a convex body, so every ray that meets the cap from a field angle less than
/// 90 degrees minus the slope of the cap at its rim crosses the disk.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FrontDisk {
    /// Plane of the rim, mm from the first vertex.
    pub z_mm: f64,
    /// Radius of the rim, mm.
    pub radius_mm: f64,
}

impl FrontDisk {
    /// The rim of the lens's first surface; `None` where neither it nor any other surface states a size.
    #[must_use]
    pub fn of(lens: &Lens) -> Option<Self> {
        let first = lens.elements.first()?;
        let radius_mm = first.semi_diameter_mm.or_else(|| lens.largest_semi_diameter_mm())?;
        let z_mm = first.surface.sag_mm(radius_mm, 0.0).unwrap_or(0.0);
        Some(Self { z_mm, radius_mm })
    }
}

/// Where on the plane of the last vertex light can come from, by distance from the axis on the film.
///
/// Found by tracing: a grid of rays from points of the film over the rear of the lens, at the ends
/// and the middle of the band; each zone of the film keeps the rectangle that holds all that passed
/// at its two edges, widened by a cell of the grid. For lenses with an axis of revolution.
#[derive(Clone, Debug)]
pub struct RearPupil {
    /// Plane of the last vertex, mm from the image plane (negative).
    pub z_mm: f64,
    zone_mm: f64,
    zones: Vec<Rectangle>,
}

/// A rectangle: `along` the radius from the axis through the film point, and `across` it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rectangle {
    /// Lower end along the radius, mm.
    pub along_min_mm: f64,
    /// Upper end along the radius, mm.
    pub along_max_mm: f64,
    /// Half its width across the radius, mm.
    pub across_mm: f64,
}

const ZONES: usize = 48;
const GRID: usize = 48;
/// How far beyond the last surface's rim rays can cross its vertex plane.
const REACH: f64 = 1.6;

impl RearPupil {
    /// Searches the rear of a lens as `tracer` holds it, for film points up to `film_radius_mm` from
    /// the axis and light from `min_nm` to `max_nm`. `None` where no surface states a size.
    #[must_use]
    pub fn search(lens: &Lens, tracer: &Tracer, film_radius_mm: f64, min_nm: f64, max_nm: f64) -> Option<Self> {
        let rear = lens.elements.last()?.semi_diameter_mm.or_else(|| lens.largest_semi_diameter_mm())? * REACH;
        let z_mm = -lens.image_gap_mm();
        let zone_mm = film_radius_mm / ZONES as f64;
        let mut rays = RayBatch::new(GRID * GRID);
        let mut work = tracer.work_in_place(GRID * GRID);
        let edges: Vec<Option<Rectangle>> = (0..=ZONES)
            .map(|edge| {
                let mut seen = None;
                for wavelength_nm in [min_nm, 0.5 * (min_nm + max_nm), max_nm] {
                    let film_mm = zone_mm * edge as f64;
                    probe(tracer, &mut rays, &mut work, [film_mm, z_mm, rear, wavelength_nm], &mut seen);
                }
                seen
            })
            .collect();
        let cell = 2.0 * rear / GRID as f64;
        let whole = Rectangle { along_min_mm: -rear, along_max_mm: rear, across_mm: rear };
        let zones = edges
            .windows(2)
            .map(|pair| match (pair[0], pair[1]) {
                (Some(a), Some(b)) => Rectangle {
                    along_min_mm: a.along_min_mm.min(b.along_min_mm) - cell,
                    along_max_mm: a.along_max_mm.max(b.along_max_mm) + cell,
                    across_mm: a.across_mm.max(b.across_mm) + cell,
                },
                // Light fades out inside of the zone, or a slit is finer than the grid: leave nothing out.
                _ => whole,
            })
            .collect();
        Some(Self { z_mm, zone_mm, zones })
    }

    /// The rectangle for a film point at this distance from the axis, mm.
    #[inline(always)]
    #[must_use]
    pub fn rectangle(&self, film_radius_mm: f64) -> Rectangle {
        let zone = (film_radius_mm / self.zone_mm) as usize;
        self.zones[zone.min(self.zones.len() - 1)]
    }
}

fn probe(
    tracer: &Tracer,
    rays: &mut RayBatch,
    work: &mut crate::Work,
    [film_mm, z_mm, rear_mm, wavelength_nm]: [f64; 4],
    seen: &mut Option<Rectangle>,
) {
    rays.restart(GRID * GRID);
    let at = |i: usize| ((i as f64 + 0.5) / GRID as f64 * 2.0 - 1.0) * rear_mm;
    let c = rays.columns_mut();
    for j in 0..GRID {
        for i in 0..GRID {
            let k = j * GRID + i;
            // The film point lies on +y; x goes across.
            let (dx, dy, dz) = (at(i), at(j) - film_mm, z_mm);
            let length = (dx * dx + dy * dy + dz * dz).sqrt();
            (c.x[k], c.y[k], c.z[k]) = (at(i), at(j), z_mm);
            (c.l[k], c.m[k], c.n[k]) = (dx / length, dy / length, dz / length);
            c.wavelength_nm[k] = wavelength_nm;
        }
    }
    tracer.trace(rays, work, Travel::Backward);
    for (k, state) in rays.states().iter().enumerate() {
        if *state == ALIVE {
            let (x, y) = (at(k % GRID).abs(), at(k / GRID));
            let old = seen.unwrap_or(Rectangle { along_min_mm: y, along_max_mm: y, across_mm: x });
            *seen = Some(Rectangle {
                along_min_mm: old.along_min_mm.min(y),
                along_max_mm: old.along_max_mm.max(y),
                across_mm: old.across_mm.max(x),
            });
        }
    }
}
