//! Capsules, the shapes that make up dust and letters on a film, and their coverage of pixels.

use spectra_film::raster::Raster;

/// A capsule: all places within `radius` of the line from `from` to `to`, mm from the frame's upper left corner.
#[derive(Clone, Copy, Debug)]
pub(super) struct Capsule {
    pub from: [f64; 2],
    pub to: [f64; 2],
    pub radius: f64,
}

impl Capsule {
    fn holds(&self, [x, y]: [f64; 2]) -> bool {
        let ([ax, ay], [bx, by]) = (self.from, self.to);
        let (dx, dy) = (bx - ax, by - ay);
        let length2 = dx * dx + dy * dy;
        let t = if length2 > 0.0 { (((x - ax) * dx + (y - ay) * dy) / length2).clamp(0.0, 1.0) } else { 0.0 };
        let (px, py) = (x - ax - t * dx, y - ay - t * dy);
        px * px + py * py <= self.radius * self.radius
    }
}

/// Least and largest number of samples per pixel along each axis.
const LOOKS: (f64, f64) = (3.0, 48.0);
/// Samples per radius of the thinnest capsule.
const LOOKS_A_RADIUS: f64 = 6.0;

/// Calls `each` for every pixel that the union of the capsules covers, with the pixel's index and the covered fraction.
pub(super) fn cover(capsules: &[Capsule], raster: &Raster, mut each: impl FnMut(usize, f64)) {
    let reach = |pick: &dyn Fn(&Capsule) -> [f64; 2]| {
        capsules.iter().map(pick).fold([f64::INFINITY, f64::NEG_INFINITY], |[a, b], [c, d]| [a.min(c), b.max(d)])
    };
    let side = |axis: usize| {
        let bounds = reach(&|c| {
            let (a, b) = (c.from[axis], c.to[axis]);
            [a.min(b) - c.radius, a.max(b) + c.radius]
        });
        let count = [raster.width, raster.height][axis] as f64;
        let pixel = |mm: f64| mm / raster.pitch_mm - raster.offset_px[axis] as f64;
        (pixel(bounds[0]).floor().clamp(0.0, count) as usize, pixel(bounds[1]).ceil().clamp(0.0, count) as usize)
    };
    let ((left, right), (top, bottom)) = (side(0), side(1));
    let thin = capsules.iter().map(|c| c.radius).fold(f64::INFINITY, f64::min);
    let looks = (LOOKS_A_RADIUS * raster.pitch_mm / thin).ceil().clamp(LOOKS.0, LOOKS.1) as usize;
    let part = 1.0 / looks as f64;
    for y in top..bottom {
        for x in left..right {
            let mut found = 0_usize;
            for j in 0..looks {
                for i in 0..looks {
                    let at = |px: usize, k: usize, axis: usize| {
                        (px as f64 + (k as f64 + 0.5) * part + raster.offset_px[axis] as f64) * raster.pitch_mm
                    };
                    let place = [at(x, i, 0), at(y, j, 1)];
                    found += usize::from(capsules.iter().any(|c| c.holds(place)));
                }
            }
            if found > 0 {
                each(y * raster.width + x, found as f64 * part * part);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::PI;

    /// A capsule covers the same area on pixels of any size.
    #[test]
    fn a_capsule_covers_its_area() {
        let capsule = Capsule { from: [0.5, 0.5], to: [0.9, 0.7], radius: 0.05 };
        let want = PI * 0.0025 + 0.1 * (0.16_f64 + 0.04).sqrt();
        for pixels in [7, 40, 200] {
            let pitch = 1.4 / pixels as f64;
            let mut area = 0.0;
            cover(&[capsule], &Raster::new(pixels, pixels, pitch), |_, share| area += share * pitch * pitch);
            assert!((area / want - 1.0).abs() < 0.03, "{pixels}: {area} {want}");
        }
    }
}
