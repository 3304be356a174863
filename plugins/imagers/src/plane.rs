//! A frame of pixels, the base of every imager. It lies flat in the nominal image plane and centered on the axis unless it
//! is given another position or shape.

use crate::placement::Placement;
use crate::plates::Plates;
use glam::{DVec2, DVec3};
use spectra_core::cover::CoverStack;
use spectra_core::frame::FrameSize;
use spectra_core::isa::Vectorized;
use spectra_core::loss::ALIVE;
use spectra_core::math::floor_index;
use spectra_core::numbers::RayNumbers;
use spectra_core::stage::{Launch, Receive};
use spectra_core::{Loss, RayBatch};
use std::sync::Arc;

/// Largest number of pixels along one side.
pub const MAX_SIDE_PX: u32 = 32_768;
/// Largest number of pixels of a frame.
pub const MAX_PIXELS: u64 = 200_000_000;

/// A frame of pixels. By default it lies at z = 0, upright and centered, with no plates in front of it.
#[derive(Clone, Debug, PartialEq)]
pub struct Plane {
    size: FrameSize,
    standing: Placement,
    plates: Option<Arc<Plates>>,
}

/// The point where a ray meets a frame.
pub(crate) struct FrameHit {
    /// Point in the coordinates of the nominal image plane, mm.
    pub(crate) point: DVec3,
    /// Position x on the frame, mm.
    pub(crate) x: f64,
    /// Position y on the frame, mm.
    pub(crate) y: f64,
    /// Fraction of the light that the plates transmit.
    pub(crate) passed: f64,
}

impl Plane {
    /// Creates a flat frame of this size, at z = 0, upright and centered.
    #[must_use]
    pub fn new(size: FrameSize) -> Self {
        Self { size, standing: Placement::NOMINAL, plates: None }
    }

    /// Returns this frame shifted, tilted or curved as `standing` says.
    #[must_use]
    pub fn with_placement(self, standing: Placement) -> Self {
        Self { standing, ..self }
    }

    /// Returns this frame behind plates that are parallel to it. The frame must be flat.
    #[must_use]
    pub fn behind(self, plates: Plates) -> Self {
        Self { plates: (!plates.is_empty()).then(|| Arc::new(plates)), ..self }
    }

    /// Size of the frame; on a curved frame, measured along its surface.
    #[must_use]
    pub fn size(&self) -> FrameSize {
        self.size
    }

    /// Returns the plates in front of the frame for focusing; `None` if there are none.
    pub(crate) fn cover(&self) -> Option<CoverStack> {
        self.plates.as_ref().map(|plates| plates.cover())
    }

    /// Intersects the frame with a ray that travels along `way` (see [`Placement::meet`]), through the plates if there are any.
    pub(crate) fn meet(
        &self,
        from: DVec3,
        way: DVec3,
        wavelength_nm: f64,
        numbers: Option<RayNumbers>,
    ) -> Option<FrameHit> {
        let (point, x, y) = self.standing.meet(from, way)?;
        let Some(plates) = &self.plates else { return Some(FrameHit { point, x, y, passed: 1.0 }) };
        let (beside, passed) = plates.pass(self.axes(x, y).transpose() * way, wavelength_nm, numbers);
        let (x, y) = (x + beside.x, y + beside.y);
        Some(FrameHit { point: self.standing.at(x, y).0, x, y, passed })
    }

    /// Returns whether plates in front of the frame split points.
    pub(crate) fn splits(&self) -> bool {
        self.plates.as_ref().is_some_and(|plates| plates.splits())
    }

    /// Returns the axes of the frame's surface at a point of it, see [`Placement::axes`].
    pub(crate) fn axes(&self, x_mm: f64, y_mm: f64) -> glam::DMat3 {
        self.standing.axes(x_mm, y_mm)
    }

    /// Returns whether the frame is as [`Plane::new`] makes it.
    fn is_plain(&self) -> bool {
        self.standing == Placement::NOMINAL && self.plates.is_none()
    }
}

impl Receive for Plane {
    fn receive(&self, rays: &mut RayBatch) {
        let isa = rays.isa();
        if self.is_plain() {
            return isa.run(ReceiveBatch { size: self.size, rays });
        }
        let c = rays.columns_mut();
        for i in 0..c.x.len() {
            if c.state[i] != ALIVE {
                continue;
            }
            let (from, way) = (DVec3::new(c.x[i], c.y[i], c.z[i]), DVec3::new(c.l[i], c.m[i], c.n[i]));
            let met = self.meet(from, way, c.wavelength_nm[i], c.numbers.of(i));
            match met.and_then(|met| Some((self.size.pixel_at(met.x, met.y)?, met))) {
                Some((pixel, met)) => {
                    [c.x[i], c.y[i], c.z[i]] = met.point.to_array();
                    c.weight[i] *= met.passed;
                    c.tag[i] = pixel;
                }
                None => c.state[i] = Loss::OutOfFrame.state(0),
            }
        }
    }

    fn draws(&self) -> bool {
        self.splits()
    }
}

impl Launch for Plane {
    fn place(&self, rays: &mut RayBatch, u: &[f64], v: &[f64]) {
        let isa = rays.isa();
        if self.is_plain() {
            return isa.run(PlaceBatch { size: self.size, rays, u, v });
        }
        let lift_mm = self.plates.as_ref().map_or(0.0, |plates| plates.lift_mm());
        let c = rays.columns_mut();
        for i in 0..c.x.len() {
            let (x, y) = self.size.point_of(c.tag[i], u[i], v[i]);
            let (point, normal) = self.standing.at(x, y);
            // Launch from where the frame appears to be through the plates.
            [c.x[i], c.y[i], c.z[i]] = (point + normal * lift_mm).to_array();
            [c.l[i], c.m[i], c.n[i]] = normal.to_array();
        }
    }

    /// Moves the rays from the apparent frame, which is exact near the axis only, to where Snell's law puts them. Rays were
    /// aimed before that, at a region that leaves room for this shift.
    fn admit(&self, rays: &mut RayBatch) {
        let Some(plates) = &self.plates else { return };
        let axes = self.axes(0.0, 0.0);
        let lift_mm = plates.lift_mm();
        let c = rays.columns_mut();
        for i in 0..c.x.len() {
            if c.state[i] != ALIVE {
                continue;
            }
            let way = axes.transpose() * -DVec3::new(c.l[i], c.m[i], c.n[i]);
            let (beside, passed) = plates.pass(way, c.wavelength_nm[i], c.numbers.of(i));
            // The straight ray crosses the frame `lift_mm` behind the point that it was aimed from.
            let across = -beside - DVec2::new(way.x, way.y) * (lift_mm / way.z);
            let across = axes.x_axis * across.x + axes.y_axis * across.y;
            c.x[i] += across.x;
            c.y[i] += across.y;
            c.z[i] += across.z;
            c.weight[i] *= passed;
        }
    }

    fn draws(&self) -> bool {
        self.splits()
    }
}

struct ReceiveBatch<'a> {
    size: FrameSize,
    rays: &'a mut RayBatch,
}

impl Vectorized for ReceiveBatch<'_> {
    type Output = ();

    #[inline(always)]
    fn run(self) {
        let FrameSize { width_px, height_px, width_mm, height_mm } = self.size;
        let (columns, rows) = (f64::from(width_px), f64::from(height_px));
        let (last_column, last_row) = (columns - 1.0, rows - 1.0);
        let beside = Loss::OutOfFrame.state(0);
        let c = self.rays.columns_mut();
        let len = c.x.len();
        // Slicing to equal lengths once removes the bounds checks from the loop.
        let (x, y, z) = (&mut c.x[..len], &mut c.y[..len], &mut c.z[..len]);
        let (l, m, n) = (&c.l[..len], &c.m[..len], &c.n[..len]);
        let (state, tag) = (&mut c.state[..len], &mut c.tag[..len]);
        for i in 0..len {
            let t = -z[i] / n[i];
            let (px, py) = (x[i] + t * l[i], y[i] + t * m[i]);
            // The same as FrameSize::pixel_at, to the bit.
            let column = (0.5 - px / width_mm) * columns;
            let row = (0.5 + py / height_mm) * rows;
            // Also false if a ray runs along the plane and the position is NaN.
            let inside = (column >= 0.0) & (row >= 0.0) & (column < columns) & (row < rows);
            let pixel = floor_index(row, last_row).0 * width_px + floor_index(column, last_column).0;
            let alive = state[i] == ALIVE;
            (x[i], y[i], z[i]) = (px, py, 0.0);
            tag[i] = if alive & inside { pixel } else { tag[i] };
            state[i] = if alive & !inside { beside } else { state[i] };
        }
    }
}

struct PlaceBatch<'a> {
    size: FrameSize,
    rays: &'a mut RayBatch,
    u: &'a [f64],
    v: &'a [f64],
}

impl Vectorized for PlaceBatch<'_> {
    type Output = ();

    #[inline(always)]
    fn run(self) {
        let FrameSize { width_px, height_px, width_mm, height_mm } = self.size;
        let (columns, rows) = (f64::from(width_px), f64::from(height_px));
        let c = self.rays.columns_mut();
        let len = c.x.len();
        let (x, y, z) = (&mut c.x[..len], &mut c.y[..len], &mut c.z[..len]);
        let (l, m, n) = (&mut c.l[..len], &mut c.m[..len], &mut c.n[..len]);
        let (tag, u, v) = (&c.tag[..len], &self.u[..len], &self.v[..len]);
        for i in 0..len {
            // There are fewer than 2^28 pixels and fewer than 2^16 columns. A quotient just below a whole number is
            // therefore at least 2^-16 below it. The division of doubles cannot round up to it, and truncation gives the row.
            let pixel = f64::from(tag[i] as i32);
            let (_, row) = floor_index(pixel / columns, rows - 1.0);
            let column = pixel - row * columns;
            // The same as FrameSize::point_of, to the bit.
            x[i] = (0.5 - (column + u[i]) / columns) * width_mm;
            y[i] = ((row + v[i]) / rows - 0.5) * height_mm;
            z[i] = 0.0;
            (l[i], m[i], n[i]) = (0.0, 0.0, -1.0);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::placement::FrameShape;
    use spectra_core::Isa;
    use spectra_core::numbers::Numbers;

    fn size() -> FrameSize {
        FrameSize { width_px: 961, height_px: 639, width_mm: 36.0, height_mm: 24.0 }
    }

    fn uniform(dimension: u32, n: usize) -> Vec<f64> {
        let mut u = vec![0.0; n];
        Numbers::random(11).fill(Isa::Baseline, 0, 0, dimension, &mut u);
        u
    }

    /// Rays are launched from pixels all over the frame, on every instruction set. They start at points of the frame, and a
    /// ray that returns along any slope is received by the pixel that it left.
    #[test]
    fn receive_undoes_launch() {
        let plane = Plane::new(size());
        let n = 1000;
        let (u, v) = (uniform(0, n), uniform(1, n));
        for isa in Isa::available() {
            let mut rays = RayBatch::new(n).on(isa);
            rays.restart(n);
            let last = size().pixels() as u32 - 1;
            for (i, tag) in rays.columns_mut().tag.iter_mut().enumerate() {
                *tag = (i as u32 * 614_657) % (last + 1);
            }
            rays.columns_mut().tag[n - 1] = last;
            let pixels = rays.tags().to_vec();
            plane.place(&mut rays, &u, &v);
            for i in 0..n {
                let (x, y) = size().point_of(pixels[i], u[i], v[i]);
                let [px, py, pz] = rays.positions();
                assert_eq!((px[i], py[i], pz[i]), (x, y, 0.0));
                let [l, m, nz] = rays.directions();
                assert_eq!((l[i], m[i], nz[i]), (0.0, 0.0, -1.0));
            }
            let c = rays.columns_mut();
            for i in 0..n {
                // From a point of the lens, some 50 mm in front, toward the point of the film; keep clear of the
                // pixel's border by more than the rounding.
                let (x, y) = size().point_of(pixels[i], 0.001 + 0.998 * u[i], 0.001 + 0.998 * v[i]);
                let from = [15.0 * (u[i] - 0.5), 15.0 * (v[i] - 0.5), -50.0];
                let d = [x - from[0], y - from[1], 50.0];
                let length = (d[0] * d[0] + d[1] * d[1] + d[2] * d[2]).sqrt();
                (c.x[i], c.y[i], c.z[i]) = (from[0], from[1], from[2]);
                (c.l[i], c.m[i], c.n[i]) = (d[0] / length, d[1] / length, d[2] / length);
                c.tag[i] = 0;
            }
            plane.receive(&mut rays);
            assert_eq!(rays.alive(), n);
            assert_eq!(rays.tags(), pixels, "{}", isa.name());
        }
    }

    /// On a frame that is shifted, tilted and curved, points lie on the shape, normals are unit vectors perpendicular to it,
    /// and areas are kept (by differences). A ray from any side of the lens is received by the pixel and at the point that it
    /// was aimed at.
    #[test]
    fn a_frame_stands_as_it_is_told() {
        let bends = [
            FrameShape::Flat,
            FrameShape::Cylinder { radius_mm: -60.0 },
            FrameShape::Cylinder { radius_mm: 25.0 },
            FrameShape::Sphere { radius_mm: -40.0 },
            FrameShape::Sphere { radius_mm: 50.0 },
        ];
        let n = 500;
        let (u, v) = (uniform(0, n), uniform(1, n));
        for bend in bends {
            let standing = Placement::new([3.0, -2.0], [0.2, -0.15], bend);
            let plane = Plane::new(size()).with_placement(standing);
            let mut rays = RayBatch::new(n);
            rays.restart(n);
            for (i, tag) in rays.columns_mut().tag.iter_mut().enumerate() {
                *tag = (i as u32 * 614_657) % size().pixels() as u32;
            }
            let pixels = rays.tags().to_vec();
            plane.place(&mut rays, &u, &v);
            let c = rays.columns_mut();
            for i in 0..n {
                let (x, y) = size().point_of(pixels[i], u[i], v[i]);
                let point = DVec3::new(c.x[i], c.y[i], c.z[i]);
                let normal = DVec3::new(c.l[i], c.m[i], c.n[i]);
                assert_eq!((point, normal), standing.at(x, y));
                assert!((normal.length() - 1.0).abs() < 1e-14 && normal.z < 0.0);
                let step = 1e-5;
                let along = |dx: f64, dy: f64| standing.at(x + dx, y + dy).0 - standing.at(x - dx, y - dy).0;
                let cross = along(step, 0.0).cross(along(0.0, step)) / (4.0 * step * step);
                assert!((cross.length() - 1.0).abs() < 1e-8, "{bend:?}: area {}", cross.length());
                assert!((cross.normalize() + normal).length() < 1e-8, "{bend:?}: {cross} {normal}");
                let axes = standing.axes(x, y);
                assert!((axes.z_axis + normal).length() < 1e-14 && (axes.determinant() - 1.0).abs() < 1e-14);
                let from = DVec3::new(15.0 * (v[i] - 0.5), 15.0 * (u[i] - 0.5), -55.0);
                let way = (point - from).normalize();
                let (met, mx, my) = standing.meet(from, way).expect("met");
                assert!((met - point).length() < 1e-12 && (mx - x).abs() + (my - y).abs() < 1e-12, "{bend:?}");
                // Stay a little inside the pixel, clear of its border by more than the rounding.
                let (x, y) = size().point_of(pixels[i], 0.001 + 0.998 * u[i], 0.001 + 0.998 * v[i]);
                let way = (standing.at(x, y).0 - from).normalize();
                [c.x[i], c.y[i], c.z[i]] = from.to_array();
                [c.l[i], c.m[i], c.n[i]] = way.to_array();
                c.tag[i] = 0;
            }
            plane.receive(&mut rays);
            assert_eq!(rays.alive(), n);
            assert_eq!(rays.tags(), pixels, "{bend:?}");
        }
    }

    /// Distances agree with geometry: on the cylinder and the sphere a point is one radius away from the axis or the center.
    /// A tilt of 30 degrees about x moves the upper edge away from the lens by half its height.
    #[test]
    fn shapes_are_where_geometry_says() {
        let shift = DVec3::new(3.0, -2.0, 0.0);
        for r in [-45.0_f64, 45.0] {
            let cylinder = Placement::new([3.0, -2.0], [0.0; 2], FrameShape::Cylinder { radius_mm: r });
            let (p, _) = cylinder.at(15.0, 7.0);
            let d = p - shift - DVec3::new(0.0, 7.0, r);
            assert!((d.length() - 45.0).abs() < 1e-12 && d.y.abs() < 1e-12);
            // The arc of 15 mm is an angle of a third of a radian.
            assert!((p.x - 3.0 - 45.0 * libm::sin(1.0 / 3.0)).abs() < 1e-12);
            let sphere = Placement::new([3.0, -2.0], [0.0; 2], FrameShape::Sphere { radius_mm: r });
            let (p, _) = sphere.at(15.0, 7.0);
            assert!(((p - shift - DVec3::new(0.0, 0.0, r)).length() - 45.0).abs() < 1e-12);
            assert!(p.z * r > 0.0);
        }
        let tilted = Placement::new([0.0; 2], [std::f64::consts::FRAC_PI_6, 0.0], FrameShape::Flat);
        let (p, n) = tilted.at(0.0, 12.0);
        assert!((p - DVec3::new(0.0, 12.0 * 0.75_f64.sqrt(), 6.0)).length() < 1e-12, "{p}");
        assert!((n - DVec3::new(0.0, 0.5, -(0.75_f64.sqrt()))).length() < 1e-12, "{n}");
        // A ray from behind is not received.
        assert!(tilted.meet(DVec3::new(0.0, 0.0, 5.0), DVec3::NEG_Z).is_none());
    }

    /// Behind a tilted stack of plates, launched rays that return along their path land where they came from: the two
    /// directions through the plates undo each other, for each branch.
    #[test]
    fn plates_are_the_same_from_both_sides() {
        use crate::plates::Plate;
        use spectra_core::spectral::BAND;
        let medium = |name: &str| spectra_glass::Catalog::bundled().medium(name).expect("bundled");
        let quartz = Plate::crystal(&medium("SiO2/Ghosh-o"), &medium("SiO2/Ghosh-e"), 1.5, 0.4, &BAND);
        let glass = Plate::glass(&medium("SCHOTT/N-BK7"), 2.0, |_| 0.8, &BAND);
        let standing = Placement::new([1.0, -2.0], [0.1, 0.05], FrameShape::Flat);
        let plane = Plane::new(size()).with_placement(standing).behind(Plates::new(&BAND, vec![glass, quartz]));
        let n = 500;
        let (u, v, p, q) = (uniform(0, n), uniform(1, n), uniform(2, n), uniform(3, n));
        let mut rays = RayBatch::new(n).with_numbers();
        rays.restart(n);
        rays.number(0, &Numbers::sobol(1), "backward", 0, 0);
        let c = rays.columns_mut();
        for i in 0..n {
            c.tag[i] = (i as u32 * 614_657) % size().pixels() as u32;
            c.wavelength_nm[i] = 400.0 + 300.0 * v[i];
        }
        let pixels = rays.tags().to_vec();
        plane.place(&mut rays, &u, &v);
        let c = rays.columns_mut();
        for i in 0..n {
            let at = DVec3::new(c.x[i], c.y[i], c.z[i]);
            let target = DVec3::new(20.0 * p[i] - 10.0, 20.0 * q[i] - 10.0, -40.0);
            [c.x[i], c.y[i], c.z[i]] = target.to_array();
            [c.l[i], c.m[i], c.n[i]] = (target - at).normalize().to_array();
        }
        plane.admit(&mut rays);
        let c = rays.columns_mut();
        for i in 0..n {
            let way = -DVec3::new(c.l[i], c.m[i], c.n[i]);
            let met =
                plane.meet(DVec3::new(c.x[i], c.y[i], c.z[i]), way, c.wavelength_nm[i], c.numbers.of(i)).expect("met");
            let (x, y) = size().point_of(pixels[i], u[i], v[i]);
            assert!((met.x - x).abs() + (met.y - y).abs() < 1e-11, "{} {x} {} {y}", met.x, met.y);
            assert!((c.weight[i] - met.passed).abs() < 1e-15 && (met.passed - 0.8).abs() < 0.02);
        }
    }

    /// A lens images the subject's upper left to +x, -y (seen from behind, the sky is at the bottom of the film);
    /// the picture shows it at the upper left, pixel 0.
    #[test]
    fn the_picture_is_upright() {
        let plane = Plane::new(size());
        let mut rays = RayBatch::new(4);
        rays.restart(4);
        let c = rays.columns_mut();
        for (i, (x, y)) in [(17.99, -11.99), (-17.99, -11.99), (17.99, 11.99), (-17.99, 11.99)].into_iter().enumerate()
        {
            (c.x[i], c.y[i], c.z[i], c.l[i], c.m[i], c.n[i]) = (x, y, -3.0, 0.0, 0.0, 1.0);
        }
        plane.receive(&mut rays);
        assert_eq!(rays.tags(), [0, 960, 638 * 961, 639 * 961 - 1]);
    }

    #[test]
    fn rays_beside_the_frame_end_there_and_ended_rays_stay() {
        let plane = Plane::new(size());
        let mut rays = RayBatch::new(6);
        rays.restart(6);
        let c = rays.columns_mut();
        for i in 0..6 {
            (c.x[i], c.y[i], c.z[i], c.l[i], c.m[i], c.n[i]) = (0.0, 0.0, -1.0, 0.0, 0.0, 1.0);
            c.tag[i] = 77;
        }
        c.x[1] = 18.001;
        c.y[2] = -12.001;
        (c.l[3], c.n[3]) = (1.0, 0.0);
        c.state[4] = Loss::Vignetted.state(3);
        c.x[5] = f64::NAN;
        plane.receive(&mut rays);
        let losses: Vec<_> = (0..6).map(|i| rays.loss(i)).collect();
        let out = Some((Loss::OutOfFrame, 0));
        assert_eq!(losses, [None, out, out, out, Some((Loss::Vignetted, 3)), out]);
        assert_eq!(rays.tags(), [319 * 961 + 480, 77, 77, 77, 77, 77]);
    }

    /// Light of constant irradiance falls on more than the frame. Each pixel gets the flux of its area, within five standard
    /// errors, and none is lost or counted twice.
    #[test]
    fn flux_falls_on_pixels_by_their_area() {
        let size = FrameSize { width_px: 12, height_px: 8, width_mm: 36.0, height_mm: 24.0 };
        let plane = Plane::new(size);
        let n = 200_000;
        let (u, v) = (uniform(2, n), uniform(3, n));
        let mut rays = RayBatch::new(n);
        rays.restart(n);
        let c = rays.columns_mut();
        for i in 0..n {
            (c.x[i], c.y[i], c.z[i]) = (40.0 * (u[i] - 0.5), 30.0 * (v[i] - 0.5), -5.0);
            (c.l[i], c.m[i], c.n[i]) = (0.0, 0.0, 1.0);
        }
        plane.receive(&mut rays);
        let mut counts = vec![0_u32; size.pixels()];
        for i in 0..n {
            if rays.loss(i).is_none() {
                counts[rays.tags()[i] as usize] += 1;
            }
        }
        let p = size.pixel_area_mm2() / (40.0 * 30.0);
        let (mean, sigma) = (n as f64 * p, (n as f64 * p * (1.0 - p)).sqrt());
        for count in &counts {
            assert!((f64::from(*count) - mean).abs() < 5.0 * sigma, "{count} {mean}");
        }
        assert_eq!(counts.iter().sum::<u32>() as usize, rays.alive());
        assert!(rays.weights().iter().all(|w| *w == 1.0));
    }
}
