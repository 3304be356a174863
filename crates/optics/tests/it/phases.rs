//! Optical paths through surfaces that bend light by a phase: ideal lenses, gratings, and a zone plate as a plugin would write it.

use glam::DVec3;
use spectra_core::surface::{Action, Bending, BentRay, Intersection, Kernel, PerRay, ScalarShape, Surface};
use spectra_core::{Loss, RayBatch};
use spectra_glass::Medium;
use spectra_lens::{Element, Lens, LensMedium};
use spectra_plugin_surfaces::{Conic, Grating, Plane, Sphere, ThinLens};
use spectra_tracer::{Indices, Tracer, Travel};
use std::sync::Arc;

const WAVELENGTH_NM: f64 = 550.0;
/// Largest difference between optical paths to one image, mm.
const EQUAL_MM: f64 = 1e-9;

fn thin(focal_length_mm: f64) -> Arc<dyn Surface> {
    Arc::new(PerRay(ThinLens::new(focal_length_mm)))
}

fn plane() -> Arc<dyn Surface> {
    Arc::new(Kernel(Plane::refracting()))
}

/// A lens of surfaces, each with the index behind it and its thickness, mm; mirrors have the index -1.
fn lens(surfaces: Vec<(Arc<dyn Surface>, f64, f64)>) -> Lens {
    let mut lens = Lens::empty("by hand");
    let mut before = 0;
    for (surface, index, thickness_mm) in surfaces {
        let after = match index {
            1.0 => 0,
            -1.0 => before,
            index => {
                lens.media.push(LensMedium { medium: Medium::Constant(index), ..LensMedium::air() });
                lens.media.len() - 1
            }
        };
        let mut element = Element { thickness_mm, ..Element::new("by hand", surface, before, after) };
        if index == -1.0 {
            element.action = Action::Reflect;
        }
        lens.elements.push(element);
        before = after;
    }
    lens.arrange();
    lens
}

/// Traces rays through a lens and returns positions, directions and optical paths, in the frame of the image plane or, backward, of the
/// lens.
fn traced(lens: &Lens, rays: &[(DVec3, DVec3)], travel: Travel) -> Vec<(DVec3, DVec3, f64)> {
    let tracer = Tracer::new(lens, Indices::At(WAVELENGTH_NM)).expect("media");
    let mut batch = RayBatch::with_optical_path(rays.len());
    batch.restart(rays.len());
    let c = batch.columns_mut();
    for (i, (p, d)) in rays.iter().enumerate() {
        (c.x[i], c.y[i], c.z[i]) = (*p).into();
        (c.l[i], c.m[i], c.n[i]) = (*d).into();
        c.wavelength_nm[i] = WAVELENGTH_NM;
    }
    tracer.trace(&mut batch, &mut tracer.work_in_place(rays.len()), travel);
    (0..rays.len())
        .map(|i| {
            assert!(batch.loss(i).is_none(), "ray {i}: {:?}", batch.loss(i));
            let at = |c: [&[f64]; 3]| DVec3::from(c.map(|c| c[i]));
            (at(batch.positions()), at(batch.directions()), batch.optical_path_mm().expect("carried")[i])
        })
        .collect()
}

/// Points of a disk, mm.
fn disk(radius_mm: f64) -> impl Iterator<Item = DVec3> {
    (0..=40).map(move |k| {
        let (r, t) = (radius_mm * (f64::from(k) / 40.0), 2.4 * f64::from(k));
        DVec3::new(r * t.cos(), r * t.sin(), 0.0)
    })
}

/// Rays of one plane wave, started on a plane across them through the point 20 mm in front of the first vertex.
fn wave(direction: DVec3, radius_mm: f64) -> Vec<(DVec3, DVec3)> {
    let start = DVec3::new(0.0, 0.0, -20.0);
    disk(radius_mm).map(|p| (p + start - direction * p.dot(direction), direction)).collect()
}

/// Rays from a point through a disk in the plane of the first vertex.
fn fan(point: DVec3, radius_mm: f64) -> Vec<(DVec3, DVec3)> {
    disk(radius_mm).map(|p| (point, (p - point).normalize())).collect()
}

/// Asserts that all rays meet in one point with equal optical paths.
fn is_one_image(name: &str, rays: &[(DVec3, DVec3, f64)], index: f64) {
    // The focus is where the first and the last ray come closest to each other.
    let ((p, d, _), (q, e, _)) = (rays[0], rays[rays.len() - 1]);
    let (w, b) = (p - q, d.dot(e));
    let focus = p + d * ((b * e.dot(w) - d.dot(w)) / (1.0 - b * b));
    let paths: Vec<f64> = rays
        .iter()
        .map(|(p, d, path)| {
            let along = (focus - *p).dot(*d);
            let miss = (focus - *p - along * *d).length();
            assert!(miss < 1e-8, "{name}: {miss:e} mm beside the focus {focus}");
            path + index * along
        })
        .collect();
    let spread = |paths: &[f64]| {
        let (low, high) = paths.iter().fold((f64::MAX, f64::MIN), |(a, b), p| (a.min(*p), b.max(*p)));
        high - low
    };
    assert!(spread(&paths) < EQUAL_MM, "{name}: paths differ by {:e} mm", spread(&paths));
}

fn tilted(degrees: f64) -> DVec3 {
    let a = degrees.to_radians();
    DVec3::new(0.3 * a.sin(), a.sin(), a.cos()).normalize()
}

#[test]
fn paths_through_ideal_lenses_to_an_image_are_equal() {
    let single = || lens(vec![(thin(50.0), 1.0, 50.0)]);
    for degrees in [0.0, 7.0, 25.0] {
        is_one_image("from infinity", &traced(&single(), &wave(tilted(degrees), 20.0), Travel::Forward), 1.0);
    }
    let near = single().focused_at(2000.0).expect("in focus");
    for y in [0.0, 300.0, -900.0] {
        let point = DVec3::new(0.2 * y, y, -2000.0);
        is_one_image("from 2 m", &traced(&near, &fan(point, 20.0), Travel::Forward), 1.0);
    }
    // A diverging lens, whose image is virtual; an image in glass; and an ideal lens behind a plate, which moves the object and is no
    // ideal lens itself, so only light along the axis is examined.
    let virtual_image = lens(vec![(thin(-80.0), 1.0, 10.0)]);
    is_one_image("virtual", &traced(&virtual_image, &wave(tilted(10.0), 15.0), Travel::Forward), 1.0);
    let into_glass = lens(vec![(thin(50.0), 1.6, 80.0)]);
    is_one_image("in glass", &traced(&into_glass, &wave(tilted(10.0), 15.0), Travel::Forward), 1.6);
    let mirrored = lens(vec![(plane(), 1.0, 30.0), (plane(), -1.0, -30.0), (thin(50.0), 1.0, -50.0)]);
    is_one_image("behind a mirror", &traced(&mirrored, &wave(tilted(6.0), 10.0), Travel::Forward), 1.0);
    let as_mirror = lens(vec![(thin(50.0), -1.0, -50.0)]);
    is_one_image("as a mirror", &traced(&as_mirror, &wave(tilted(6.0), 10.0), Travel::Forward), 1.0);
}

#[test]
fn paths_through_relays_are_equal_both_ways() {
    // Focal lengths 50 and 80 mm, their sum apart: a point 50 mm in front, and one elsewhere, which the relay images as well.
    for object_mm in [50.0, 70.0, 400.0] {
        let relay = lens(vec![(thin(50.0), 1.0, 130.0), (thin(80.0), 1.0, 80.0)]);
        let relay = Lens { focused_mm: object_mm, ..relay };
        for y in [0.0, 6.0, -11.0] {
            let point = DVec3::new(0.5 * y, y, -object_mm);
            let there = traced(&relay, &fan(point, 8.0), Travel::Forward);
            is_one_image("4f relay", &there, 1.0);
            // The same rays traced back have the same path and reach the same point.
            let reversed: Vec<(DVec3, DVec3)> = there.iter().map(|(p, d, _)| (*p, -*d)).collect();
            for ((p, d, path), (_, _, want)) in traced(&relay, &reversed, Travel::Backward).iter().zip(&there) {
                let along = (point - *p).dot(*d);
                let miss = (point - *p - along * *d).length();
                assert!(miss < 1e-8, "{object_mm} mm, back: {miss:e} mm beside the object");
                assert!((path + along - want).abs() < EQUAL_MM, "{object_mm} mm, back: {:e} mm", path + along - want);
            }
        }
    }
    // A field lens at the image, which bends light and adds no path there.
    let field = lens(vec![(thin(50.0), 1.0, 50.0), (thin(40.0), 1.0, 100.0), (thin(50.0), 1.0, 100.0)]);
    for degrees in [0.0, 3.0] {
        is_one_image("with a field lens", &traced(&field, &wave(tilted(degrees), 5.0), Travel::Forward), 1.0);
    }
}

/// Behind mirrors light runs against z, where thicknesses are negative. The object of the ideal lens is at the distance that the light has
/// traveled.
#[test]
fn paths_behind_mirrors_are_equal_both_ways() {
    let mirror = |radius_mm: f64| -> Arc<dyn Surface> { Arc::new(Kernel(Conic::new(radius_mm, -1.0))) };
    // A plane mirror: the point at 2 m is 2030 + 30 mm from the lens. A paraboloid of 200 mm that gathers light 50 mm behind the lens.
    let flat = lens(vec![(plane(), 1.0, 30.0), (plane(), -1.0, -30.0), (thin(50.0), 1.0, -50.0)]);
    let flat = Lens { focused_mm: 2000.0, ..flat };
    let curved = lens(vec![(mirror(-400.0), -1.0, -150.0), (thin(70.0), 1.0, -30.0)]);
    let cases = [
        ("plane mirror", flat, fan(DVec3::new(20.0, -70.0, -2000.0), 8.0)),
        ("paraboloid", curved, wave(DVec3::Z, 10.0)),
    ];
    for (name, lens, rays) in cases {
        let there = traced(&lens, &rays, Travel::Forward);
        is_one_image(name, &there, 1.0);
        let reversed: Vec<(DVec3, DVec3)> = there.iter().map(|(p, d, _)| (*p, -*d)).collect();
        for ((back, _, path), ((start, _), (_, _, want))) in
            traced(&lens, &reversed, Travel::Backward).iter().zip(rays.iter().zip(&there))
        {
            let along = (*back - *start).length();
            assert!((path + along - want).abs() < EQUAL_MM, "{name}, back: {:e} mm", path + along - want);
        }
    }
}

/// A zone plate as a plugin would write it: by its phase it focuses parallel light of one wavelength without aberration.
#[derive(Debug)]
struct ZonePlate {
    focal_length_mm: f64,
}

impl ScalarShape for ZonePlate {
    fn intersect(&self, position: DVec3, direction: DVec3) -> Option<Intersection> {
        Some(Intersection { distance_mm: -position.z / direction.z, normal: DVec3::Z })
    }
    fn sag_mm(&self, _: f64, _: f64) -> Option<f64> {
        Some(0.0)
    }
    fn vertex_curvature_per_mm(&self) -> (f64, f64) {
        (0.0, 0.0)
    }
    fn paraxial_power_per_mm(&self, _: f64, _: f64) -> (f64, f64) {
        (1.0 / self.focal_length_mm, 1.0 / self.focal_length_mm)
    }
    fn redirect(&self, at: &Bending) -> Option<Result<DVec3, Loss>> {
        let way = self.focal_length_mm.hypot(at.point.truncate().length());
        let along = (at.n_before * at.direction - at.point / way).truncate() / at.n_after;
        let square = 1.0 - along.length_squared();
        let z = square.sqrt() * at.direction.z.signum();
        Some(if square > 0.0 { Ok(along.extend(z)) } else { Err(Loss::TotalReflection) })
    }
    fn has_phase(&self) -> bool {
        true
    }
    fn phase_mm(&self, ray: &BentRay) -> f64 {
        self.focal_length_mm - self.focal_length_mm.hypot(ray.point.truncate().length())
    }
}

#[test]
fn a_zone_plate_of_a_plugin_has_equal_paths() {
    let plate = lens(vec![(Arc::new(PerRay(ZonePlate { focal_length_mm: 60.0 })), 1.0, 60.0)]);
    is_one_image("zone plate", &traced(&plate, &wave(DVec3::Z, 15.0), Travel::Forward), 1.0);
}

/// Rays stay normal to surfaces of equal path (Malus and Dupin). Between neighboring rays of a plane wave the path at the image plane
/// changes like their position along their direction: for neighbors a micrometer apart to less than 1e-9 mm.
#[test]
fn rays_stay_normal_to_the_phase() {
    let ruled = |radius_mm: f64| -> Arc<dyn Surface> { Arc::new(PerRay(Grating::new(600.0, 1, radius_mm, 0.4))) };
    let zone = || -> Arc<dyn Surface> { Arc::new(PerRay(ZonePlate { focal_length_mm: 60.0 })) };
    let sphere = |radius_mm: f64| -> Arc<dyn Surface> { Arc::new(Kernel(Sphere::new(radius_mm))) };
    let conic = |radius_mm: f64| -> Arc<dyn Surface> { Arc::new(Kernel(Conic::new(radius_mm, -0.5))) };
    let cases = [
        ("grating", lens(vec![(ruled(f64::INFINITY), 1.0, 30.0)])),
        ("grating on a sphere", lens(vec![(ruled(-120.0), 1.0, 30.0)])),
        ("grating as a mirror", lens(vec![(ruled(-300.0), -1.0, -80.0)])),
        (
            "grating into glass, behind a lens",
            lens(vec![
                (sphere(80.0), 1.6, 5.0),
                (conic(-200.0), 1.0, 3.0),
                (ruled(f64::INFINITY), 1.5, 4.0),
                (plane(), 1.0, 20.0),
            ]),
        ),
        ("zone plate", lens(vec![(zone(), 1.0, 60.0)])),
        ("ideal lens", lens(vec![(thin(50.0), 1.0, 20.0)])),
        ("ideal lenses", lens(vec![(thin(50.0), 1.0, 20.0), (thin(-40.0), 1.0, 20.0), (ruled(90.0), 1.0, 5.0)])),
    ];
    const STEP_MM: f64 = 1e-3;
    for (name, lens) in &cases {
        for degrees in [0.0, 5.0, -12.0] {
            let d = tilted(degrees);
            let across = d.cross(DVec3::X).normalize();
            for p in disk(6.0) {
                let at = |k: f64| {
                    let from = p + DVec3::new(0.0, 0.0, -15.0) + k * STEP_MM * across;
                    (from - d * from.dot(d), d)
                };
                let met = traced(lens, &[at(-1.0), at(0.0), at(1.0), at(-2.0), at(2.0)], Travel::Forward);
                // Differences of fourth order: the curvature of the wave leaves far less.
                let along = met[1].1;
                let to = |i: usize| met[i].2 - along.dot(met[i].0);
                let slope = (8.0 * (to(2) - to(0)) - (to(4) - to(3))) / 12.0;
                assert!(slope.abs() < EQUAL_MM, "{name}, {degrees} degrees, {p}: {slope:e} mm");
            }
        }
    }
}
