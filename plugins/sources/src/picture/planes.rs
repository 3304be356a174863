//! Checks whether walls and floors of a depth channel are flat.
//!
//! In perspective, one over the depth along the axis is linear across the picture on every plane, whatever its orientation. One over the
//! distance along the ray is that times the cosine of the angle to the axis, so it is curved. The one that is linear at most points tells
//! which kind of depth a file has, if the picture shows planes at all. Round objects do not decide it.

/// The pixel raster of the depth.
#[derive(Clone, Copy, Debug)]
pub(super) struct Pixels {
    pub size_px: [u32; 2],
    /// Ratio of width to height of a pixel.
    pub aspect: f64,
    /// Width of a pixel on the plane of the picture, mm.
    pub pixel_mm: f64,
}

/// Number of points tested along each side.
const TRIED: u32 = 64;
/// Distance between the points compared, as a fraction of the picture's width.
const STEP: f64 = 1.0 / 12.0;
/// Smallest curvature that counts, relative to the depth: 16-bit numbers are accurate enough for it.
const LEAST: f64 = 1.5e-3;
/// A point is straighter with the other kind of depth if its curvature is below this fraction.
const STRAIGHTER: f64 = 0.1;
/// Ratio of points that are straighter with the other kind to points that are less straight, above which the other kind is right.
const TIMES: usize = 10;
/// Fraction of all points that must be straighter with the other kind.
const PART: f64 = 0.1;

/// Depth, in mm, from which on there is no object: renderers write such a number where a ray hits nothing.
const BACKDROP_MM: f64 = 1e9;

/// Returns whether surfaces are straighter at far more points with the other kind of depth. `depth` is along the axis, mm. If `ray` is
/// true, the other kind is distance along the ray; otherwise the numbers were read as distance along the ray, and the other kind is
/// distance along the axis. Points at `farthest_mm` and beyond do not count.
pub(super) fn are_straighter_as(ray: bool, depth: &[f32], plane_mm: f64, farthest_mm: f64, pixels: Pixels) -> bool {
    let [width, height] = pixels.size_px;
    let step = (STEP * f64::from(width)).round() as u32;
    if step < 2 || height <= 2 * step || depth.len() != width as usize * height as usize {
        return false;
    }
    // The inverse of the cosine of the angle to the axis.
    let slant = |x: u32, y: u32| {
        let from_middle = |at: u32, size: u32| f64::from(at) + 0.5 - 0.5 * f64::from(size);
        let across = from_middle(x, width) * pixels.pixel_mm / plane_mm;
        let down = from_middle(y, height) * pixels.pixel_mm / pixels.aspect / plane_mm;
        (1.0 + across * across + down * down).sqrt()
    };
    let inverse = |x: u32, y: u32| 1.0 / f64::from(depth[y as usize * width as usize + x as usize]);
    let other = |x: u32, y: u32| if ray { inverse(x, y) * slant(x, y) } else { inverse(x, y) / slant(x, y) };
    let is_thing = |x: u32, y: u32| 1.0 / inverse(x, y) < farthest_mm.min(BACKDROP_MM);
    let bend = |of: &dyn Fn(u32, u32) -> f64, [x, y]: [u32; 2], [dx, dy]: [u32; 2]| {
        let (a, b, c) = (of(x - dx, y - dy), of(x, y), of(x + dx, y + dy));
        ((a + c - 2.0 * b) / b).abs()
    };
    let (mut tried, mut better, mut worse) = (0_usize, 0_usize, 0_usize);
    let places = |size: u32| {
        let room = size - 2 * step;
        (0..TRIED.min(room)).map(move |i| step + i * room / TRIED.min(room))
    };
    for y in places(height) {
        for x in places(width) {
            for along in [[step, 0], [0, step]] {
                let [dx, dy] = along;
                if ![(x - dx, y - dy), (x, y), (x + dx, y + dy)].into_iter().all(|(x, y)| is_thing(x, y)) {
                    continue;
                }
                tried += 1;
                let [own, other] = [bend(&inverse, [x, y], along), bend(&other, [x, y], along)];
                better += usize::from(own > LEAST && other < STRAIGHTER * own);
                worse += usize::from(other > LEAST && own < STRAIGHTER * other);
            }
        }
    }
    better > TIMES * worse && better as f64 > PART * tried as f64
}

#[cfg(test)]
mod tests {
    use super::*;

    const PIXELS: Pixels = Pixels { size_px: [240, 135], aspect: 1.0, pixel_mm: 10.0 };
    const PLANE_MM: f64 = 2000.0;

    /// Returns the depth, along the axis or the ray, of a room (a floor 1.2 m below and a slanted wall 5 m away), or of a ball in front of
    /// a dome.
    fn depth(ray: bool, is_room: bool) -> Vec<f32> {
        let [width, height] = PIXELS.size_px;
        let mut all = Vec::new();
        for y in 0..height {
            for x in 0..width {
                let [u, v] = [(x, width), (y, height)]
                    .map(|(at, size)| (f64::from(at) + 0.5 - 0.5 * f64::from(size)) * PIXELS.pixel_mm / PLANE_MM);
                let z = if is_room {
                    let floor = if v > 0.0 { 1200.0 / v } else { f64::INFINITY };
                    (5000.0 / (1.0 + 0.2 * u)).min(floor)
                } else {
                    // The near side of a ball of 900 mm radius at 2 m, and a backdrop like a dome around the eye.
                    let (a, b, c) = (1.0 + u * u + v * v, -2.0 * 2000.0, 2000.0_f64.powi(2) - 900.0_f64.powi(2));
                    let root = b * b - 4.0 * a * c;
                    if root > 0.0 { (-b - root.sqrt()) / (2.0 * a) } else { 4000.0 - 500.0 * (u * u + v * v) }
                };
                all.push((z * if ray { (1.0 + u * u + v * v).sqrt() } else { 1.0 }) as f32);
            }
        }
        all
    }

    #[test]
    fn the_kind_of_depth_shows_in_planes() {
        // Depth that is read correctly is not straighter as the other kind.
        assert!(!are_straighter_as(true, &depth(false, true), PLANE_MM, f64::INFINITY, PIXELS));
        // Distances along the ray that were read as depth.
        assert!(are_straighter_as(true, &depth(true, true), PLANE_MM, f64::INFINITY, PIXELS));
        // Depths that were read as distances along the ray, and therefore divided by the slant.
        let slant = |i: usize| {
            let [u, v] = [(i % 240, 240.0), (i / 240, 135.0)]
                .map(|(at, size)| (at as f64 + 0.5 - 0.5 * size) * PIXELS.pixel_mm / PLANE_MM);
            (1.0 + u * u + v * v).sqrt()
        };
        let divided: Vec<f32> =
            depth(false, true).iter().enumerate().map(|(i, z)| (f64::from(*z) / slant(i)) as f32).collect();
        assert!(are_straighter_as(false, &divided, PLANE_MM, f64::INFINITY, PIXELS));
        assert!(!are_straighter_as(false, &depth(false, true), PLANE_MM, f64::INFINITY, PIXELS));
        // Round objects do not decide it.
        for ray in [false, true] {
            assert!(!are_straighter_as(true, &depth(ray, false), PLANE_MM, f64::INFINITY, PIXELS), "{ray}");
        }
    }
}
