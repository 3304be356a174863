//! A flat imager in the nominal image plane, centered on the axis: what each plane imager is made of.

use spectra_core::frame::FrameSize;
use spectra_core::isa::{Isa, Vectorized};
use spectra_core::loss::ALIVE;
use spectra_core::stage::{Launch, Receive};
use spectra_core::{Loss, RayBatch};

/// Most pixels along one side.
pub const MAX_SIDE_PX: u32 = 32_768;
/// Most pixels of a frame.
pub const MAX_PIXELS: u64 = 200_000_000;

/// A flat frame at z = 0, upright and centered.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Plane {
    size: FrameSize,
}

impl Plane {
    /// A plane of that size.
    #[must_use]
    pub fn new(size: FrameSize) -> Self {
        Self { size }
    }

    /// Its size.
    #[must_use]
    pub fn size(&self) -> FrameSize {
        self.size
    }
}

impl Receive for Plane {
    fn receive(&self, rays: &mut RayBatch, isa: Isa) {
        isa.run(ReceiveBatch { size: self.size, rays });
    }
}

impl Launch for Plane {
    fn place(&self, rays: &mut RayBatch, u: &[f64], v: &[f64], isa: Isa) {
        isa.run(PlaceBatch { size: self.size, rays, u, v });
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
        let beside = Loss::OutOfFrame.state(0);
        let c = self.rays.columns_mut();
        let len = c.x.len();
        // Equal lengths, said once, take the bounds checks out of the loop.
        let (x, y, z) = (&mut c.x[..len], &mut c.y[..len], &mut c.z[..len]);
        let (l, m, n) = (&c.l[..len], &c.m[..len], &c.n[..len]);
        let (state, tag) = (&mut c.state[..len], &mut c.tag[..len]);
        for i in 0..len {
            let t = -z[i] / n[i];
            let (px, py) = (x[i] + t * l[i], y[i] + t * m[i]);
            // As FrameSize::pixel_at has it, to the bit.
            let column = (0.5 - px / width_mm) * columns;
            let row = (0.5 + py / height_mm) * rows;
            // Also where a ray runs along the plane and the place is no number.
            let inside = (column >= 0.0) & (row >= 0.0) & (column < columns) & (row < rows);
            // Both are below 32 768 inside, so the signed cast, which every tier has for whole vectors, is exact.
            let pixel = (row as i32 as u32).wrapping_mul(width_px).wrapping_add(column as i32 as u32);
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
            // Pixels number below 2^28 and columns below 2^16: a quotient just under a whole number is at least
            // 2^-16 under it, so the division of doubles cannot round up to it, and truncation gives the row.
            let pixel = f64::from(tag[i] as i32);
            let row = f64::from((pixel / columns) as i32);
            let column = pixel - row * columns;
            // As FrameSize::point_of has it, to the bit.
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
    use spectra_core::numbers::Numbers;

    fn size() -> FrameSize {
        FrameSize { width_px: 961, height_px: 639, width_mm: 36.0, height_mm: 24.0 }
    }

    fn uniform(dimension: u32, n: usize) -> Vec<f64> {
        let mut u = vec![0.0; n];
        Numbers::random(11).fill(Isa::Baseline, 0, 0, dimension, &mut u);
        u
    }

    /// Launched from pixels all over the frame, on every tier: the points are those of the frame, and going back along
    /// any slope each ray is received by the pixel that it left.
    #[test]
    fn receive_undoes_launch() {
        let plane = Plane::new(size());
        let n = 1000;
        let (u, v) = (uniform(0, n), uniform(1, n));
        for isa in Isa::available() {
            let mut rays = RayBatch::new(n);
            rays.restart(n);
            let last = size().pixels() as u32 - 1;
            for (i, tag) in rays.columns_mut().tag.iter_mut().enumerate() {
                *tag = (i as u32 * 614_657) % (last + 1);
            }
            rays.columns_mut().tag[n - 1] = last;
            let pixels = rays.tags().to_vec();
            plane.place(&mut rays, &u, &v, isa);
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
            plane.receive(&mut rays, isa);
            assert_eq!(rays.alive(), n);
            assert_eq!(rays.tags(), pixels, "{}", isa.name());
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
        plane.receive(&mut rays, Isa::detect());
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
        plane.receive(&mut rays, Isa::detect());
        let losses: Vec<_> = (0..6).map(|i| rays.loss(i)).collect();
        let out = Some((Loss::OutOfFrame, 0));
        assert_eq!(losses, [None, out, out, out, Some((Loss::Vignetted, 3)), out]);
        assert_eq!(rays.tags(), [319 * 961 + 480, 77, 77, 77, 77, 77]);
    }

    /// Light of constant irradiance over more than the frame: each pixel gets the share of the flux that is its area,
    /// within five standard errors, and none is lost or doubled.
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
        plane.receive(&mut rays, Isa::detect());
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
