//! Finds where light lands in the plane of the imager, on the frame or outside it.

use glam::DVec3;
use spectra_core::RayBatch;
use spectra_core::loss::ALIVE;
use spectra_scene::Scene;

/// The place in the plane of the imager where the light of a source lands.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Landing {
    /// Middle (median) of the light, mm on the nominal image plane, the unit of `imager.shift`.
    pub middle_mm: [f64; 2],
    /// Fraction of the light that lands on the frame.
    pub on_frame: f64,
}

impl Landing {
    /// Measures where rays that left the lens land; `None` if none meets the plane of the imager.
    pub(crate) fn of(scene: &Scene, rays: &RayBatch) -> Option<Self> {
        let (middle, across, down) = frame(scene);
        let normal = across.cross(down);
        let ([x, y, z], [l, m, n]) = (rays.positions(), rays.directions());
        let mut places: [Vec<f64>; 2] = [Vec::new(), Vec::new()];
        let mut on_frame = 0_usize;
        for i in (0..rays.len()).filter(|i| rays.states()[*i] == ALIVE) {
            let (from, way) = (DVec3::new(x[i], y[i], z[i]), DVec3::new(l[i], m[i], n[i]));
            let at = from + way * ((middle - from).dot(normal) / way.dot(normal));
            if !at.is_finite() {
                continue;
            }
            let beside = at - middle;
            let inside = |half: DVec3| beside.dot(half).abs() <= half.length_squared();
            on_frame += usize::from(inside(across) && inside(down));
            places[0].push(at.x);
            places[1].push(at.y);
        }
        let many = places[0].len();
        let middle_mm = places.map(|mut along| {
            along.sort_by(f64::total_cmp);
            along.get(many / 2).copied()
        });
        let [Some(x), Some(y)] = middle_mm else { return None };
        Some(Self { middle_mm: [x, y], on_frame: on_frame as f64 / many as f64 })
    }
}

/// Returns the corners of the frame in order around it, mm on the nominal image plane.
pub(crate) fn corners(scene: &Scene) -> Vec<[f64; 2]> {
    let (middle, across, down) = frame(scene);
    [across + down, across - down, -across - down, down - across].map(|p| [middle.x + p.x, middle.y + p.y]).to_vec()
}

/// Returns the middle of the frame and the vectors of half its width and half its height, mm on the nominal image plane.
fn frame(scene: &Scene) -> (DVec3, DVec3, DVec3) {
    let size = scene.imager.size();
    let (width, height) = (DVec3::X * 0.5 * size.width_mm, DVec3::Y * 0.5 * size.height_mm);
    let Some(launch) = scene.imager.launch() else { return (DVec3::ZERO, width, height) };
    // Take the corners of the frame from the pixels in its first and last row and column.
    let (columns, rows) = (size.width_px, size.height_px);
    let last = rows * columns - columns;
    let mut rays = RayBatch::new(4);
    rays.restart(4);
    rays.columns_mut().tag.copy_from_slice(&[0, columns - 1, last, last + columns - 1]);
    launch.place(&mut rays, &[0.0, 1.0, 0.0, 1.0], &[0.0, 0.0, 1.0, 1.0]);
    let [x, y, z] = rays.positions();
    let [a, b, c, d]: [DVec3; 4] = std::array::from_fn(|i| DVec3::new(x[i], y[i], z[i]));
    ((a + b + c + d) * 0.25, (b + d - a - c) * 0.25, (c + d - a - b) * 0.25)
}
