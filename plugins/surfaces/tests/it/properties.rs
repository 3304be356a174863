//! Tests with random valid shapes and rays: the hit lies on the sag, refraction obeys Snell's law in the plane of incidence, and
//! light returns along the path on which it came.

use crate::common::meet;
use glam::DVec3;
use proptest::prelude::*;
use proptest::test_runner::RngSeed;
use spectra_core::surface::{Action, FromSag, Kernel, PerRay, Surface};
use spectra_plugin_surfaces::*;

/// Generates a radius between 12 and 100 mm, of either sign.
fn radius() -> impl Strategy<Value = f64> {
    (12.0..100.0, any::<bool>()).prop_map(|(r, negative): (f64, bool)| if negative { -r } else { r })
}

/// Generates coefficients that each contribute at most 0.3 mm at 10 mm.
fn coefficients(first: i32, by: i32) -> impl Strategy<Value = Vec<f64>> {
    prop::collection::vec(-0.3..0.3, 1..12).prop_map(move |heights: Vec<f64>| {
        heights.iter().zip(0..).map(|(h, i)| h / 10f64.powi(first + by * i)).collect()
    })
}

/// Generates a sphere, with the largest distance of rays, mm. The kernel of the sphere is tuned for the distances within a
/// lens, and loses digits with the square of the distance.
fn spheres() -> impl Strategy<Value = (Box<dyn Surface>, f64)> {
    radius().prop_map(|r| (Box::new(Kernel(Sphere::new(r))) as Box<dyn Surface>, 50.0))
}

fn others() -> impl Strategy<Value = (Box<dyn Surface>, f64)> {
    surfaces().prop_map(|surface| (surface, f64::INFINITY))
}

fn surfaces() -> impl Strategy<Value = Box<dyn Surface>> {
    let conic = || -2.0..0.9;
    prop_oneof![
        (radius(), conic()).prop_map(|(r, k)| Box::new(Kernel(Conic::new(r, k))) as Box<dyn Surface>),
        (radius(), conic(), coefficients(2, 2))
            .prop_map(|(r, k, a)| Box::new(Kernel(EvenAsphere::<20>::new(r, k, &a))) as Box<dyn Surface>),
        (radius(), conic(), coefficients(1, 1))
            .prop_map(|(r, k, a)| Box::new(PerRay(FromSag(OddAsphere::new(r, k, &a)))) as Box<dyn Surface>),
        (radius(), any::<bool>()).prop_map(|(r, x)| {
            let axis = if x { CylinderAxis::X } else { CylinderAxis::Y };
            Box::new(Kernel(Cylinder::new(r, axis))) as Box<dyn Surface>
        }),
        (radius(), conic(), coefficients(2, 2), radius())
            .prop_map(|(r, k, a, t)| Box::new(PerRay(FromSag(Toroid::new(r, k, &a, t)))) as Box<dyn Surface>),
        ((radius(), radius()), (conic(), conic()))
            .prop_map(|(r, k)| Box::new(PerRay(FromSag(Biconic::new(r, k)))) as Box<dyn Surface>),
        (-0.5..0.5, -0.5..0.5).prop_map(|(a, b)| Box::new(Kernel(TiltedPlane::new(a, b))) as Box<dyn Surface>),
        (radius(), prop::collection::vec(-0.05..0.05, 1..30), any::<bool>()).prop_map(|(r, a, noll)| {
            let ordering = if noll { ZernikeOrdering::Noll } else { ZernikeOrdering::Fringe };
            Box::new(PerRay(FromSag(Zernike::new(r, 0.0, 10.0, &a, ordering)))) as Box<dyn Surface>
        }),
    ]
}

/// Generates a ray through a point of the vertex plane, 5 to 2000 mm away, in either direction of travel.
fn ray() -> impl Strategy<Value = (DVec3, DVec3, f64)> {
    (-7.0..7.0, -7.0..7.0, -0.4..0.4, -0.4..0.4, 5.0..2000.0, any::<bool>()).prop_map(|(x, y, u, v, far, forward)| {
        let d = DVec3::new(u, v, if forward { 1.0 } else { -1.0 }).normalize();
        (DVec3::new(x, y, 0.0), d, far)
    })
}

/// Computes the normal from differences of the sag, to an accuracy of 1e-9.
fn normal(surface: &dyn Surface, q: DVec3) -> Option<DVec3> {
    let h = 1e-3;
    let along = |dx: f64, dy: f64| {
        let at = |k: f64| surface.sag_mm(q.x + k * dx, q.y + k * dy);
        Some((8.0 * (at(h)? - at(-h)?) - (at(2.0 * h)? - at(-2.0 * h)?)) / (12.0 * h))
    };
    Some(DVec3::new(-along(1.0, 0.0)?, -along(0.0, 1.0)?, 1.0).normalize())
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 4000, failure_persistence: None, rng_seed: RngSeed::Fixed(1), ..ProptestConfig::default() })]

    #[test]
    fn light_obeys_the_surface(
        ((surface, farthest), (target, d, far), into_glass) in
            (prop_oneof![1 => spheres(), 8 => others()], ray(), any::<bool>())
    ) {
        let p = target - far.min(farthest) * d;
        let indices = if into_glass { (1.0, 1.7) } else { (1.7, 1.0) };
        if let Ok((q, after)) = meet(&*surface, (p, d), indices, Action::Refract) {
            let sag = surface.sag_mm(q.x, q.y);
            prop_assert!(sag.is_some_and(|sag| (q.z - sag).abs() < 1e-9), "{q} {sag:?}");
            prop_assert!((q - p).cross(d).length() < 1e-9);
            prop_assert!((after.length() - 1.0).abs() < 1e-12);
            if let Some(n) = normal(&*surface, q) {
                // n' (d' x N) = n (d x N): Snell's law, and the plane of incidence.
                let snell = indices.1 * after.cross(n) - indices.0 * d.cross(n);
                prop_assert!(snell.length() < 1e-8, "{}", snell.length());
                prop_assert!(after.dot(n) * d.dot(n) > 0.0);
                let (_, mirrored) = meet(&*surface, (p, d), indices, Action::Reflect).unwrap();
                prop_assert!((mirrored - (d - 2.0 * d.dot(n) * n)).length() < 1e-8);
            }
            // Trace back from a little behind. Light that came close to the surface or along it may meet it elsewhere.
            if after.z * d.z > 0.05 {
                let (back, out) = meet(&*surface, (q + 2.0 * after, -after), (indices.1, indices.0), Action::Refract)
                    .map_err(|loss| TestCaseError::fail(format!("{loss:?} on the way back")))?;
                if (back - q).length() < 1e-3 {
                    prop_assert!((back - q).length() < 1e-9 && (out + d).length() < 1e-9, "{back} {q} {out} {d}");
                } else {
                    let sag = surface.sag_mm(back.x, back.y);
                    prop_assert!(sag.is_some_and(|sag| (back.z - sag).abs() < 1e-9));
                }
            }
        }
    }
}
