//! `kind: sphere`: part of a sphere, or with `radius: inf` a plane.

use schemars::JsonSchema;
use serde::Deserialize;
use spectra_core::params::{Faults, LengthOrInfinity, Params};
use spectra_core::registry::Context;
use spectra_core::surface::{Hit, Kernel, KernelShape, Ray, Real, Surface};

/// Half of a sphere around (0, 0, radius): the half that contains the vertex. A ray meets it at the root
/// nearer to the vertex.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sphere {
    curvature_per_mm: f64,
    /// Absolute value of the radius, mm.
    size_mm: f64,
}

impl Sphere {
    /// Creates a sphere of this radius, mm: positive if the center lies at larger z, infinite for a plane.
    #[must_use]
    pub fn new(radius_mm: f64) -> Self {
        Self { curvature_per_mm: 1.0 / radius_mm, size_mm: radius_mm.abs() }
    }
}

impl KernelShape for Sphere {
    fn scaled(&self, factor: f64) -> Option<Self> {
        Some(Self { curvature_per_mm: self.curvature_per_mm / factor, size_mm: self.size_mm * factor.abs() })
    }

    /// Solves c t^2 - 2 b t + q = 0 for the distance t, with b = n - c (p . d) and q = c p^2 - 2 z. The form
    /// t = q / (b + sqrt(b^2 - c q)) loses no digits for long radii, and is also valid for a plane.
    #[inline(always)]
    fn hit<R: Real, const FORWARD: bool>(&self, ray: Ray<R, FORWARD>) -> Hit<R> {
        let c = R::constant(self.curvature_per_mm);
        let ([x, y, z], [l, m, n]) = (ray.position, ray.direction);
        let b = n - c * (x * l + y * m + z * n);
        let q = c * (ray.radius2 + z * z) - (z + z);
        let discriminant = b * b - c * q;
        // At the root nearer to the vertex the ray crosses the surface in the direction of travel.
        let cosine = ray.along(discriminant.sqrt());
        let distance = q / (b + cosine);
        // All points of the sphere lie on one side of the vertex plane, so |z| tells which half a point is on.
        let on_vertex_half = R::constant(self.size_mm) - (z + distance * n).abs();
        Hit { distance, cosine, valid: discriminant.min(on_vertex_half) }
    }

    #[inline(always)]
    fn normal<R: Real>(&self, [x, y, z]: [R; 3]) -> [R; 3] {
        let c = R::constant(self.curvature_per_mm);
        [-(c * x), -(c * y), R::constant(1.0) - c * z]
    }

    /// Bends the direction. The normal is linear in the point, so one product with the curvature serves all three components.
    #[inline(always)]
    fn bend<R: Real>(&self, [x, y, z]: [R; 3], [l, m, n]: [R; 3], mu: R, push: R) -> [R; 3] {
        let curved = push * R::constant(self.curvature_per_mm);
        [mu * l - curved * x, mu * m - curved * y, (mu * n + push) - curved * z]
    }

    fn sag_mm(&self, x_mm: f64, y_mm: f64) -> Option<f64> {
        let c = self.curvature_per_mm;
        let r2 = x_mm * x_mm + y_mm * y_mm;
        let square = 1.0 - c * c * r2;
        (square >= 0.0).then(|| c * r2 / (1.0 + square.sqrt()))
    }

    fn vertex_curvature_per_mm(&self) -> (f64, f64) {
        (self.curvature_per_mm, self.curvature_per_mm)
    }
}

/// Part of a sphere.
///
/// Nearly every lens is made of spheres, so this is the default kind in a lens file. The sag is z = c r^2 / (1 +
/// sqrt(1 - c^2 r^2)) with the curvature c = 1 / radius and r the distance from the axis.
///
/// The radius is positive if the center of curvature lies at larger z, that is, toward the image: a biconvex lens in
/// air has a positive first and a negative second radius. Only the half of the sphere that contains the vertex belongs
/// to the surface. A ray that passes outside it counts as missed.
///
/// # Example
/// ```yaml
/// {kind: sphere, radius: 41.8, thickness: 5.375, glass: SCHOTT/N-BAF10, semi-diameter: 18}
/// ```
/// ```yaml
/// {radius: -120 mm, thickness: -60 mm, mirror: true, semi-diameter: 1 in}
/// ```
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
struct SphereParams {
    /// Radius of curvature, mm if bare, not 0: positive if the center lies at larger z; `inf` is a plane.
    radius: LengthOrInfinity,
}

spectra_core::register!(surface "sphere" (default): SphereParams, build);

fn build(params: &Params, _: &Context<'_>) -> Result<Box<dyn Surface>, Faults> {
    let p: SphereParams = params.parse()?;
    if p.radius.mm() == 0.0 {
        return Err(params
            .fault("radius", "a sphere cannot have a radius of 0")
            .hint("for a plane write `radius: inf` or `kind: plane`")
            .into());
    }
    Ok(Box::new(Kernel(Sphere::new(p.radius.mm()))))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn hit(radius_mm: f64, position: [f64; 3], direction: [f64; 3]) -> Hit<f64> {
        let radius2 = position[0] * position[0] + position[1] * position[1];
        let sphere = Sphere::new(radius_mm);
        if direction[2] >= 0.0 {
            sphere.hit(Ray::<f64, true> { position, direction, radius2 })
        } else {
            sphere.hit(Ray::<f64, false> { position, direction, radius2 })
        }
    }

    /// Closed form: a ray parallel to the axis at height h meets the sphere at the sag
    /// R - sqrt(R^2 - h^2), with cosine sqrt(R^2 - h^2) / R.
    #[test]
    fn parallel_rays_land_on_the_sag() {
        for radius in [50.0, -50.0, 7.5, -1e7] {
            for h in [0.0, 1.0, 5.0] {
                let want = radius - f64::signum(radius) * f64::sqrt(radius * radius - h * h);
                for sense in [1.0, -1.0] {
                    let hit = hit(radius, [h, 0.0, -3.0 * sense], [0.0, 0.0, sense]);
                    let z = -3.0 * sense + hit.distance * sense;
                    assert!(
                        (z - want).abs() < 1e-8_f64.max(1e-14 * radius.abs()) && hit.valid > 0.0,
                        "{radius} {h} {z} {want}"
                    );
                    let cosine = sense * f64::sqrt(1.0 - h * h / (radius * radius));
                    assert!((hit.cosine - cosine).abs() < 1e-12);
                }
            }
        }
    }

    #[test]
    fn rays_that_pass_beside_it_miss() {
        assert!(!(hit(10.0, [0.0, 10.1, -5.0], [0.0, 0.0, 1.0]).valid >= 0.0));
        // This ray meets only the far half of the sphere, which is not part of the surface.
        assert!(!(hit(10.0, [0.0, -20.0, 15.0], [0.0, 1.0, 0.0]).valid >= 0.0));
    }

    #[test]
    fn infinite_radius_is_the_plane() {
        let d = [0.6, 0.0, 0.8];
        let hit = hit(f64::INFINITY, [1.0, 2.0, -4.0], d);
        assert_eq!((hit.distance, hit.cosine), (5.0, 0.8));
        assert_eq!(Sphere::new(f64::INFINITY).sag_mm(3.0, 4.0), Some(0.0));
    }

    #[test]
    fn bend_is_the_general_formula() {
        let sphere = Sphere::new(-30.0);
        let (point, direction) = ([2.0, -3.0, sphere.sag_mm(2.0, -3.0).unwrap()], [0.36, 0.48, 0.8]);
        let n = sphere.normal(point);
        let got = sphere.bend(point, direction, 0.7, 0.2);
        for i in 0..3 {
            assert!((got[i] - (0.7 * direction[i] + 0.2 * n[i])).abs() < 1e-15);
        }
        assert!((n.iter().map(|v| v * v).sum::<f64>() - 1.0).abs() < 1e-14);
    }
}
