//! The two authoring tiers and the sag alone give the same rays as the built-in sphere, in either sense of travel, on
//! every instruction set; and light goes back the way it came.

use glam::DVec3;
use spectra_core::batch::Column;
use spectra_core::numbers::Numbers;
use spectra_core::surface::{
    Action, FromSag, IndexColumns, Interface, Intersection, Kernel, PerRay, SagShape, ScalarShape, Surface, Travel,
};
use spectra_core::{Isa, RayBatch};
use spectra_plugin_surfaces::Sphere;

const RADIUS_MM: f64 = 40.0;
const RAYS: usize = 2000;

/// A sphere as a plugin author would write it with a pencil: |o + t d - c|^2 = r^2.
#[derive(Debug)]
struct Pencil;

impl ScalarShape for Pencil {
    fn intersect(&self, position: DVec3, direction: DVec3) -> Option<Intersection> {
        let center = DVec3::new(0.0, 0.0, RADIUS_MM);
        let b = (position - center).dot(direction);
        let root = (b * b - (position - center).length_squared() + RADIUS_MM * RADIUS_MM).sqrt();
        let near = if direction.z > 0.0 { -b - root } else { -b + root };
        let point = position + near * direction;
        (root.is_finite() && point.z < RADIUS_MM).then(|| Intersection { distance_mm: near, normal: center - point })
    }
    fn sag_mm(&self, x_mm: f64, y_mm: f64) -> Option<f64> {
        Sag.sag_mm(x_mm, y_mm)
    }
    fn vertex_curvature_per_mm(&self) -> (f64, f64) {
        (1.0 / RADIUS_MM, 1.0 / RADIUS_MM)
    }
}

/// The least a plugin author can write.
#[derive(Debug)]
struct Sag;

impl SagShape for Sag {
    fn sag_mm(&self, x_mm: f64, y_mm: f64) -> Option<f64> {
        let square = RADIUS_MM * RADIUS_MM - x_mm * x_mm - y_mm * y_mm;
        (square >= 0.0).then(|| RADIUS_MM - square.sqrt())
    }
}

/// Random rays, some of which miss the sphere, some beyond the rim, some beyond the critical angle.
fn rays(travel: Travel) -> RayBatch {
    let numbers = Numbers::random(5);
    let mut batch = RayBatch::new(RAYS);
    batch.restart(RAYS);
    let c = batch.columns_mut();
    for i in 0..RAYS {
        let u = |d: u32| 2.0 * numbers.one(0, i as u64, d) - 1.0;
        let side = if travel == Travel::Forward { 1.0 } else { -1.0 };
        let direction = DVec3::new(0.7 * u(2), 0.7 * u(3), side).normalize();
        (c.x[i], c.y[i], c.z[i]) = (36.0 * u(0), 36.0 * u(1), -5.0 * side);
        (c.l[i], c.m[i], c.n[i]) = direction.into();
    }
    batch
}

fn interact(surface: &dyn Surface, travel: Travel, isa: Isa) -> (RayBatch, usize) {
    let (mut glass, mut air) = (Column::<f64>::new(RAYS), Column::<f64>::new(RAYS));
    glass.slice_mut(RAYS).fill(1.5);
    air.slice_mut(RAYS).fill(1.0 / 1.5);
    let mut one = Column::<f64>::new(RAYS);
    one.slice_mut(RAYS).fill(1.0);
    let glass = IndexColumns { n: glass.slice(RAYS), inverse: air.slice(RAYS) };
    let air = IndexColumns { n: one.slice(RAYS), inverse: one.slice(RAYS) };
    let (before, after) = if travel == Travel::Forward { (air, glass) } else { (glass, air) };
    let interface = Interface {
        number: 3,
        shift_mm: 1.25,
        clip_radius2_mm2: 30.0 * 30.0,
        action: Action::Refract,
        travel,
        before,
        after,
    };
    let mut batch = rays(travel);
    let lost = surface.interact(&mut batch, &interface, isa);
    (batch, lost)
}

#[test]
fn tiers_agree_ray_by_ray() {
    for travel in [Travel::Forward, Travel::Backward] {
        let (want, lost) = interact(&Kernel(Sphere::new(RADIUS_MM)), travel, Isa::Baseline);
        let causes: std::collections::BTreeSet<u64> = want.states().iter().copied().collect();
        assert!(lost > 200 && lost < RAYS - 200 && causes.len() >= 3, "a test of all causes: {lost} lost, {causes:?}");
        for isa in Isa::available() {
            let (same, _) = interact(&Kernel(Sphere::new(RADIUS_MM)), travel, isa);
            assert_eq!(same.states(), want.states());
            for (a, b) in same.positions().iter().zip(want.positions()) {
                assert!(a.iter().zip(b).all(|(a, b)| a.to_bits() == b.to_bits()), "bits differ on {}", isa.name());
            }
        }
        let others: [(&str, Box<dyn Surface>); 2] =
            [("scalar", Box::new(PerRay(Pencil))), ("sag", Box::new(PerRay(FromSag(Sag))))];
        for (name, surface) in others {
            let (got, _) = interact(&*surface, travel, Isa::detect());
            for i in 0..RAYS {
                match (got.loss(i), want.loss(i)) {
                    // A sag has no surface beyond its rim: what others clip there, it misses.
                    (Some(got), Some(_)) if name == "sag" => assert_eq!(got.1, 3),
                    (got, want) => assert_eq!(got, want, "{name}, ray {i}"),
                }
                if want.loss(i).is_none() {
                    for (a, b) in got.positions().iter().zip(want.positions()) {
                        assert!((a[i] - b[i]).abs() < 1e-10, "{name}, ray {i}: {} and {} mm", a[i], b[i]);
                    }
                    // The slope of a sag alone comes from differences.
                    let tolerance = if name == "sag" { 1e-9 } else { 1e-12 };
                    for (a, b) in got.directions().iter().zip(want.directions()) {
                        assert!((a[i] - b[i]).abs() < tolerance, "{name}, ray {i}: direction {} and {}", a[i], b[i]);
                    }
                }
            }
        }
    }
}
