//! Compares each kind with a closed form: foci of conics, the lens and the grating equation, and spheres and planes written as
//! other kinds.

use crate::common::{Line, meet, meet_all, sense};
use glam::DVec3;
use spectra_core::math::{asin, cos, sin};
use spectra_core::surface::{Action, FromSag, Kernel, PerRay, SagShape, Surface, Travel};
use spectra_core::{Isa, Loss};
use spectra_plugin_surfaces::*;

const AIR_GLASS: (f64, f64) = (1.0, 1.5168);

/// Returns the distance between a line and a point.
fn miss((p, d): Line, point: DVec3) -> f64 {
    (point - p).cross(d).length()
}

/// Returns rays from a point toward points of a disk on the vertex plane.
fn pencil(from: DVec3, radius_mm: f64) -> Vec<Line> {
    (0..24)
        .map(|i| {
            let (r, a) = (radius_mm * f64::from(i % 4 + 1) / 4.0, f64::from(i) * 1.1);
            (from, (DVec3::new(r * cos(a), r * sin(a), 0.0) - from).normalize())
        })
        .collect()
}

/// Returns rays parallel to the axis, toward +z, over a disk.
fn beam(radius_mm: f64) -> Vec<Line> {
    let up = DVec3::new(0.0, 0.0, 1.0);
    pencil(DVec3::new(0.0, 0.0, -1.0), radius_mm).into_iter().map(|(p, d)| (p + d / d.z - 50.0 * up, up)).collect()
}

fn reflected(surface: &dyn Surface, rays: &[Line]) -> Vec<Line> {
    rays.iter().map(|r| meet(surface, *r, (1.0, 1.0), Action::Reflect).expect("it meets the mirror")).collect()
}

/// A paraboloid of radius -200 has its focus at -100, and light from there leaves parallel.
#[test]
fn parabolic_mirror_has_a_focus() {
    let mirrors: [Box<dyn Surface>; 4] = [
        Box::new(Kernel(Conic::new(-200.0, -1.0))),
        Box::new(Kernel(EvenAsphere::<4>::new(f64::INFINITY, 0.0, &[-1.0 / 400.0]))),
        Box::new(PerRay(FromSag(OddAsphere::new(f64::INFINITY, 0.0, &[0.0, -1.0 / 400.0])))),
        Box::new(PerRay(FromSag(Biconic::new((-200.0, -200.0), (-1.0, -1.0))))),
    ];
    let focus = DVec3::new(0.0, 0.0, -100.0);
    for mirror in mirrors {
        for ray in reflected(&*mirror, &beam(60.0)) {
            assert!(ray.1.z < 0.0 && miss(ray, focus) < 1e-12, "{mirror:?} {}", miss(ray, focus));
        }
        for (_, d) in reflected(&*mirror, &pencil(focus, 60.0)) {
            assert!((d - DVec3::new(0.0, 0.0, -1.0)).length() < 1e-14);
        }
    }
}

/// Foci of an ellipsoid and a hyperboloid lie at R / (1 + e) and R / (1 - e) for the eccentricity e = sqrt(-k).
#[test]
fn ellipse_and_hyperbola_image_focus_to_focus() {
    for (radius, k) in [(-100.0, -0.25), (-80.0, -0.64), (150.0, -2.25), (-120.0, -4.0)] {
        let e = f64::sqrt(-k);
        let (near, far) = (DVec3::new(0.0, 0.0, radius / (1.0 + e)), DVec3::new(0.0, 0.0, radius / (1.0 - e)));
        let mirror = Kernel(Conic::new(radius, k));
        // The light starts at the focus on its own side. The lines then pass through the other focus, real or virtual.
        let (from, to) = if near.z < 0.0 { (near, far) } else { (far, near) };
        for ray in reflected(&mirror, &pencil(from, 30.0)) {
            assert!(miss(ray, to) < 1e-11, "{radius} {k}: {}", miss(ray, to));
        }
    }
}

/// An ellipsoid of glass with e = 1/n focuses parallel light at its far focus, R n / (n - 1), without aberration (Descartes).
#[test]
fn ellipsoid_of_descartes() {
    let n = 1.5168;
    let surface = Kernel(Conic::new(20.0, -1.0 / (n * n)));
    for ray in beam(12.0) {
        let after = meet(&surface, ray, (1.0, n), Action::Refract).unwrap();
        assert!(miss(after, DVec3::new(0.0, 0.0, 20.0 * n / (n - 1.0))) < 1e-13);
    }
}

/// Returns rays from both sides of a surface, in either direction of travel.
fn sheaf(radius_mm: f64) -> Vec<Line> {
    let forward = pencil(DVec3::new(3.0, -5.0, -30.0), radius_mm);
    let backward = pencil(DVec3::new(-4.0, 2.0, 40.0), radius_mm);
    forward.into_iter().chain(backward).collect()
}

fn same(a: &dyn Surface, b: &dyn Surface, radius_mm: f64, tolerance: f64) {
    let mut met = 0;
    for ray in sheaf(radius_mm) {
        for action in [Action::Refract, Action::Reflect, Action::Pass] {
            let (got, want) = (meet(a, ray, AIR_GLASS, action), meet(b, ray, AIR_GLASS, action));
            match (got, want) {
                (Ok(got), Ok(want)) => {
                    let error = (got.0 - want.0).length().max((got.1 - want.1).length());
                    assert!(error < tolerance, "{a:?} and {b:?}: {error:e}");
                    met += 1;
                }
                (got, want) => assert_eq!(got.err(), want.err(), "{a:?} and {b:?} at {ray:?}"),
            }
        }
    }
    assert!(met >= 100, "{met} met");
    let curvature = (a.vertex_curvature_per_mm(), b.vertex_curvature_per_mm());
    assert!(
        (curvature.0.0 - curvature.1.0).abs() + (curvature.0.1 - curvature.1.1).abs() < 1e-6,
        "{a:?} {curvature:?}"
    );
}

#[test]
fn spheres_in_disguise() {
    for radius in [25.0, -25.0] {
        let sphere = Kernel(Sphere::new(radius));
        // The series of a sphere: the coefficient of r^2i is the one before times (2 i - 3) / (2 i) / R^2.
        let (mut series, mut a) = (vec![0.5 / radius], 0.5 / radius);
        for i in 2..=20 {
            a *= f64::from(2 * i - 3) / f64::from(2 * i) / (radius * radius);
            series.push(a);
        }
        same(&Kernel(Conic::new(radius, 0.0)), &sphere, 12.0, 1e-13);
        same(&Kernel(EvenAsphere::<4>::new(radius, 0.0, &[0.0])), &sphere, 12.0, 1e-13);
        // At r = 8 the rest of the series is below (8/25)^40.
        same(&Kernel(EvenAsphere::<20>::new(f64::INFINITY, 0.0, &series)), &sphere, 8.0, 1e-13);
        same(&PerRay(FromSag(Toroid::new(radius, 0.0, &[], radius))), &sphere, 12.0, 1e-13);
        same(&PerRay(FromSag(Biconic::new((radius, radius), (0.0, 0.0)))), &sphere, 12.0, 1e-13);
        same(&PerRay(FromSag(OddAsphere::new(radius, 0.0, &[]))), &sphere, 12.0, 1e-13);
        same(&PerRay(FromSag(Zernike::new(radius, 0.0, 1.0, &[], ZernikeOrdering::Noll))), &sphere, 12.0, 1e-13);
        same(&PerRay(Grating::new(600.0, 0, radius, 0.3)), &sphere, 12.0, 1e-13);
    }
}

#[test]
fn planes_in_disguise() {
    let plane = Kernel(Plane::refracting());
    same(&Kernel(Conic::new(f64::INFINITY, -3.0)), &plane, 20.0, 1e-13);
    same(&Kernel(Cylinder::new(f64::INFINITY, CylinderAxis::X)), &plane, 20.0, 1e-13);
    same(&Kernel(TiltedPlane::new(0.0, 0.0)), &plane, 20.0, 1e-13);
    same(&Kernel(EvenAsphere::<4>::new(f64::INFINITY, 0.0, &[])), &plane, 20.0, 1e-13);
}

#[test]
fn conics_in_disguise() {
    for (radius, k) in [(30.0, -0.7), (-22.0, 0.8), (18.0, -2.5)] {
        let conic = Kernel(Conic::new(radius, k));
        same(&PerRay(FromSag(Biconic::new((radius, radius), (k, k)))), &conic, 10.0, 1e-12);
        same(&Kernel(EvenAsphere::<8>::new(radius, k, &[])), &conic, 10.0, 1e-12);
    }
    // A cylinder is a toroid whose curve is shifted, or whose straight line is rotated.
    let x = Kernel(Cylinder::new(19.0, CylinderAxis::X));
    same(&PerRay(FromSag(Toroid::new(19.0, 0.0, &[], f64::INFINITY))), &x, 10.0, 1e-12);
    let y = Kernel(Cylinder::new(-19.0, CylinderAxis::Y));
    same(&PerRay(FromSag(Toroid::new(f64::INFINITY, 0.0, &[], -19.0))), &y, 10.0, 1e-12);
}

/// In the section across its lines a cylinder is a circle: sin i = h / R for parallel light. The component of the ray along
/// the lines does not change.
#[test]
fn cylinder_is_a_circle_in_its_section() {
    let n = 1.5168;
    for (axis, radius) in [(CylinderAxis::X, 20.0), (CylinderAxis::Y, -20.0)] {
        for h in [-9.0, 4.0, 12.0] {
            let surface = Kernel(Cylinder::new(radius, axis));
            let start = match axis {
                CylinderAxis::X => DVec3::new(7.0, h, -40.0),
                CylinderAxis::Y => DVec3::new(h, 7.0, -40.0),
            };
            let (p, d) = meet(&surface, (start, DVec3::new(0.0, 0.0, 1.0)), (1.0, n), Action::Refract).unwrap();
            let (i, out) = (asin(h / radius), asin(h / radius / n));
            let across = sin(out - i);
            let (want, along) = match axis {
                CylinderAxis::X => (DVec3::new(0.0, across, cos(out - i)), p.x),
                CylinderAxis::Y => (DVec3::new(across, 0.0, cos(out - i)), p.y),
            };
            assert!((d - want).length() < 1e-14 && along == 7.0, "{d} {want}");
            assert!((p.z - radius * (1.0 - cos(i))).abs() < 1e-13);
        }
    }
}

/// The tilts are right-handed rotations: 30 degrees about x move the upper part to larger z, and light along the axis is
/// refracted by Snell's law in the y-z plane.
#[test]
fn tilted_plane_is_a_prism_face() {
    let tilt = 30.0_f64.to_radians();
    let surface = Kernel(TiltedPlane::new(tilt, 0.0));
    let (p, d) =
        meet(&surface, (DVec3::new(1.0, 3.0, -9.0), DVec3::new(0.0, 0.0, 1.0)), AIR_GLASS, Action::Refract).unwrap();
    assert!((p.z - 3.0 * tilt.tan()).abs() < 1e-14);
    // Toward the normal, which leans to -y.
    let turned = tilt - asin(0.5 / 1.5168);
    assert!((d - DVec3::new(0.0, -sin(turned), cos(turned))).length() < 1e-15, "{d}");
    let about_y = TiltedPlane::new(0.0, tilt);
    assert!((spectra_core::surface::KernelShape::sag_mm(&about_y, 2.0, 5.0).unwrap() + 2.0 * tilt.tan()).abs() < 1e-14);
    // Both tilts: first about x, then about the new y axis. The rotated x and y axes span the plane.
    let (a, b) = (0.4_f64, -0.3_f64);
    let both = TiltedPlane::new(a, b);
    for v in [DVec3::new(cos(b), sin(a) * sin(b), -cos(a) * sin(b)), DVec3::new(0.0, cos(a), sin(a))] {
        let sag = spectra_core::surface::KernelShape::sag_mm(&both, v.x, v.y).unwrap();
        assert!((sag - v.z).abs() < 1e-15);
    }
}

/// A thin lens obeys n'/s' = n/s + 1/f, with the magnification s' n / (s n'), for points on and off the axis, in both directions of
/// travel, and as a mirror.
#[test]
fn thin_lens_images_points() {
    for (f, s, y, n, n2) in [
        (50.0, 75.0, 0.0, 1.0, 1.0),
        (50.0, 200.0, 30.0, 1.0, 1.0),
        (-40.0, 60.0, 20.0, 1.0, 1.0),
        (50.0, 300.0, -10.0, 1.0, 1.33),
    ] {
        let lens = PerRay(ThinLens::new(f));
        let distance = n2 / (1.0 / f - n / s);
        let height = -y * distance * n / (s * n2);
        for sense in [1.0, -1.0] {
            let rays = pencil(DVec3::new(2.0, y, -s * sense), 20.0);
            let x = -2.0 * distance * n / (s * n2);
            for ray in rays {
                let after = meet(&lens, ray, (n, n2), Action::Refract).unwrap();
                assert!((after.1.length() - 1.0).abs() < 1e-15 && after.1.z * sense > 0.0);
                assert!(miss(after, DVec3::new(x, height, distance * sense)) < 1e-11);
                if n == n2 {
                    let back = meet(&lens, ray, (n, n2), Action::Reflect).unwrap();
                    assert!(back.1.z * sense < 0.0 && miss(back, DVec3::new(x, height, -distance * sense)) < 1e-11);
                }
            }
        }
        assert_eq!(lens.paraxial_power_per_mm(1.0, 1.0), (1.0 / f, 1.0 / f));
    }
}

/// A grating obeys n' sin i' = sin i + m lambda g in the plane across the lines, with n' the index behind the surface. There is
/// no light where the sine would exceed 1.
#[test]
fn grating_equation() {
    let (g, wavelength) = (600.0, 500.0);
    for order in [-2, -1, 0, 1, 2] {
        let grating = PerRay(Grating::new(g, order, f64::INFINITY, 0.0));
        for incidence in [-0.4_f64, 0.0, 0.25] {
            let ray = (DVec3::new(1.0, 2.0, -5.0), DVec3::new(0.0, sin(incidence), cos(incidence)));
            for (action, n2) in [(Action::Refract, 1.5), (Action::Reflect, 1.0)] {
                let want = (sin(incidence) + f64::from(order) * wavelength * 1e-6 * g) / n2;
                let got = meet_all(&grating, &[ray], (1.0, n2), action, wavelength, Travel::Forward, Isa::detect())[0];
                let (_, d) = got.unwrap();
                let z = (1.0 - want * want).sqrt() * if action == Action::Reflect { -1.0 } else { 1.0 };
                assert!((d - DVec3::new(0.0, want, z)).length() < 1e-15, "{d} {want}");
            }
        }
    }
    let steep = PerRay(Grating::new(2400.0, 1, f64::INFINITY, 0.0));
    let ray = (DVec3::new(0.0, 0.0, -1.0), DVec3::new(0.0, 0.0, 1.0));
    assert_eq!(meet(&steep, ray, (1.0, 1.0), Action::Refract), Err(Loss::TotalReflection));
    // A right angle from +y, right-handed about z, is -x.
    let turned = PerRay(Grating::new(600.0, 1, f64::INFINITY, std::f64::consts::FRAC_PI_2));
    let (_, d) = meet(&turned, ray, (1.0, 1.0), Action::Refract).unwrap();
    assert!((d.x + 0.33).abs() < 1e-15 && d.y.abs() < 1e-15, "{d}");
}

/// A spherical grating images its own Rowland circle sharply in the plane across the lines (to the order of coma). The chief ray
/// obeys sin a + sin b = m lambda g, with the object at R cos a and the image at R cos b.
#[test]
fn rowland_circle() {
    let (radius, g, a) = (-500.0_f64, 600.0, 0.2_f64);
    let grating = PerRay(Grating::new(g, 1, radius, 0.0));
    let object = DVec3::new(0.0, radius.abs() * cos(a) * -sin(a), -radius.abs() * cos(a) * cos(a));
    let ray = |y: f64| {
        let z = radius - radius.signum() * (radius * radius - y * y).sqrt();
        (object, (DVec3::new(0.0, y, z) - object).normalize())
    };
    let after = |y: f64| meet(&grating, ray(y), (1.0, 1.0), Action::Reflect).unwrap();
    let (_, chief) = after(0.0);
    assert!((chief.y - (sin(a) + 550e-6 * g)).abs() < 1e-14);
    let image = radius.abs() * (1.0 - chief.y * chief.y).sqrt() * chief;
    for y in [-5.0, 5.0] {
        // Millimeters off the circle, the blur would be 5 mm / 500 mm of that distance. The third order leaves (5/500)^3.
        assert!(miss(after(y), image) < 2e-3, "{}", miss(after(y), image));
    }
}

/// The terms have the published values at rho = 0.8, 0.4 rad: Noll (1976), table I; Wyant and Creath (1992), table III.
#[test]
fn zernike_terms_as_published() {
    let (r, t) = (0.8_f64, 0.4_f64);
    let (r2, r3, r4) = (r * r, r * r * r, r * r * r * r);
    let noll = [
        1.0,
        2.0 * r * cos(t),
        2.0 * r * sin(t),
        3f64.sqrt() * (2.0 * r2 - 1.0),
        6f64.sqrt() * r2 * sin(2.0 * t),
        6f64.sqrt() * r2 * cos(2.0 * t),
        8f64.sqrt() * (3.0 * r3 - 2.0 * r) * sin(t),
        8f64.sqrt() * (3.0 * r3 - 2.0 * r) * cos(t),
        8f64.sqrt() * r3 * sin(3.0 * t),
        8f64.sqrt() * r3 * cos(3.0 * t),
        5f64.sqrt() * (6.0 * r4 - 6.0 * r2 + 1.0),
        10f64.sqrt() * (4.0 * r4 - 3.0 * r2) * cos(2.0 * t),
        10f64.sqrt() * (4.0 * r4 - 3.0 * r2) * sin(2.0 * t),
        10f64.sqrt() * r4 * cos(4.0 * t),
        10f64.sqrt() * r4 * sin(4.0 * t),
    ];
    let fringe = [
        1.0,
        r * cos(t),
        r * sin(t),
        2.0 * r2 - 1.0,
        r2 * cos(2.0 * t),
        r2 * sin(2.0 * t),
        (3.0 * r2 - 2.0) * r * cos(t),
        (3.0 * r2 - 2.0) * r * sin(t),
        6.0 * r4 - 6.0 * r2 + 1.0,
        r3 * cos(3.0 * t),
        r3 * sin(3.0 * t),
        (4.0 * r2 - 3.0) * r2 * cos(2.0 * t),
        (4.0 * r2 - 3.0) * r2 * sin(2.0 * t),
        (10.0 * r4 - 12.0 * r2 + 3.0) * r * cos(t),
        (10.0 * r4 - 12.0 * r2 + 3.0) * r * sin(t),
        20.0 * r4 * r2 - 30.0 * r4 + 12.0 * r2 - 1.0,
    ];
    let radius = 7.0;
    let (x, y) = (radius * r * cos(t), radius * r * sin(t));
    for (ordering, table) in [(ZernikeOrdering::Noll, &noll[..]), (ZernikeOrdering::Fringe, &fringe[..])] {
        for (j, want) in table.iter().enumerate() {
            let mut c = vec![0.0; j + 1];
            c[j] = 1.0;
            let z = Zernike::new(f64::INFINITY, 0.0, radius, &c, ordering);
            assert!((z.sag_mm(x, y).unwrap() - want).abs() < 1e-13, "{ordering:?} {}", j + 1);
            // The slope is the derivative.
            let (h, (sx, sy)) = (1e-5, z.slope(x, y).unwrap());
            let by = |dx: f64, dy: f64| (z.sag_mm(x + dx, y + dy).unwrap() - z.sag_mm(x - dx, y - dy).unwrap()) / 2e-5;
            assert!((by(h, 0.0) - sx).abs() < 1e-9 && (by(0.0, h) - sy).abs() < 1e-9);
        }
    }
}

/// A table of a cubic surface reproduces that surface. The error of a table of a sphere falls with the fourth power of the step.
#[test]
fn sag_table_of_known_surfaces() {
    let table = |step: f64, count: i32, sag: &dyn Fn(f64, f64) -> f64| {
        let at = |i: i32| (f64::from(i) - 0.5 * f64::from(count - 1)) * step;
        let rows: Vec<Vec<f64>> = (0..count).map(|j| (0..count).map(|i| sag(at(i), at(j))).collect()).collect();
        SagTable::new(step, &rows).expect("a good table")
    };
    let cubic = |x: f64, y: f64| {
        0.01 * x - 0.02 * x * y + 0.003 * x * x + 1e-4 * x * y * y * y - 2e-4 * y * y * y + 0.004 * y * y
    };
    let t = table(0.7, 9, &cubic);
    for (x, y) in [(0.0, 0.0), (0.31, -1.2), (-2.7, 2.75), (2.8, -2.8)] {
        assert!((t.sag_mm(x, y).unwrap() - cubic(x, y)).abs() < 1e-14);
        let (sx, sy) = t.slope(x, y).unwrap();
        let want =
            (0.01 - 0.02 * y + 0.006 * x + 1e-4 * y * y * y, -0.02 * x + 3e-4 * x * y * y - 6e-4 * y * y + 0.008 * y);
        assert!((sx - want.0).abs() < 1e-13 && (sy - want.1).abs() < 1e-13);
    }
    assert!(t.sag_mm(2.81, 0.0).is_none() && t.sag_mm(0.0, -2.9).is_none());
    let sphere = |x: f64, y: f64| (x * x + y * y) / (40.0 + (1600.0 - x * x - y * y).sqrt());
    let errors = [17, 33, 65].map(|count| {
        let t = table(32.0 / f64::from(count - 1), count, &sphere);
        let places = [(0.3, 0.4), (-5.2, 3.3), (7.7, 8.1), (1.9, -9.4)];
        places.iter().map(|(x, y)| (t.sag_mm(*x, *y).unwrap() - sphere(*x, *y)).abs()).fold(0.0, f64::max)
    });
    assert!(errors[0] < 1e-5 && errors[1] < errors[0] / 8.0 && errors[2] < errors[1] / 8.0, "{errors:?}");
    // Rays meet the table as they meet the sphere, to that accuracy.
    same(&PerRay(FromSag(table(0.25, 129, &sphere))), &Kernel(Sphere::new(40.0)), 10.0, 1e-7);
    assert!(
        SagTable::new(1.0, &vec![vec![0.0; 4]; 3]).is_none()
            && SagTable::new(1.0, &vec![vec![f64::NAN; 4]; 4]).is_none()
    );
}

/// Rays meet the sag or miss, even near the rim of a deep even asphere, at grazing angles, and outside, where the polynomial grows fast.
#[test]
fn even_asphere_never_lands_on_a_wrong_sheet() {
    let shapes = [
        EvenAsphere::<20>::new(5.0, 0.0, &[0.0, 1e-4, 1e-6]),
        EvenAsphere::<20>::new(-4.0, 0.5, &[0.02, -1e-3, 2e-4, -1e-5]),
        EvenAsphere::<20>::new(3.0, -3.0, &[0.0, -0.01, 3e-3, -2e-4]),
    ];
    let (mut met, mut missed) = (0, 0);
    for shape in shapes {
        let surface = Kernel(shape);
        for i in 0..1000 {
            let u = |k: u32| 2.0 * spectra_core::numbers::Numbers::random(9).one(0, i, k) - 1.0;
            let sense_z = if i % 2 == 0 { 1.0 } else { -1.0 };
            let d = DVec3::new(1.5 * u(0), 1.5 * u(1), sense_z).normalize();
            let p = DVec3::new(5.0 * u(2), 5.0 * u(3), 3.0 * u(4));
            match meet(&surface, (p, d), (1.0, 1.0), Action::Pass) {
                Ok((q, _)) => {
                    let sag = surface.sag_mm(q.x, q.y).expect("on the surface");
                    assert!((q.z - sag).abs() < 1e-9 && (q - p).cross(d).length() < 1e-9, "{} {sag}", q.z);
                    // The ray comes from the side of the light: just before the hit it is on that side.
                    let before = q - 1e-5 * d;
                    if let Some(sag) = surface.sag_mm(before.x, before.y) {
                        assert!((before.z - sag) * sense_z < 1e-9);
                    }
                    met += 1;
                }
                Err(loss) => {
                    assert_eq!(loss, Loss::Missed);
                    missed += 1;
                    // Nowhere within a sphere of 6 mm does the line cross in its direction of travel (sampled coarsely along it).
                    let mut was = None;
                    for k in -1200..=1200 {
                        let at = p + (f64::from(k) * 0.01 - p.dot(d)) * d;
                        let is = surface.sag_mm(at.x, at.y).map(|sag| (at.z - sag) * sense_z);
                        if let (Some(a), Some(b)) = (was, is) {
                            assert!(!(a < -1e-4 && b > 1e-4) || at.length() > 6.0, "a crossing at {at} is missed");
                        }
                        was = is;
                    }
                }
            }
        }
    }
    assert!(met > 1000 && missed > 25, "{met} {missed}");
    assert_eq!(sense(DVec3::new(0.0, 0.0, -1.0)), Travel::Backward);
}
