//! Compares aspheric surfaces with rays that `xtask/reference_surfaces.py` computed with 40 digits.

use crate::common::meet;
use glam::DVec3;
use spectra_core::surface::{Action, FromSag, Kernel, PerRay, Surface};
use spectra_plugin_surfaces::{
    Biconic, Cylinder, CylinderAxis, EvenAsphere, OddAsphere, Toroid, Zernike, ZernikeOrdering,
};

/// Returns the largest errors of position (mm) and of direction over the rays of a kind, and the number of rays.
fn errors(kind: &str, make: impl Fn(&[f64]) -> Box<dyn Surface>) -> (f64, f64, usize) {
    let path = format!("{}/../../tests/data/surfaces/{kind}.csv", env!("CARGO_MANIFEST_DIR"));
    let text = std::fs::read_to_string(path).expect("the reference rays are in the repository");
    let numbers = |text: &str| -> Vec<f64> { text.split(',').map(|v| v.parse().expect("a number")).collect() };
    let mut surfaces: Vec<Box<dyn Surface>> = Vec::new();
    let (mut position, mut direction, mut rays) = (0.0_f64, 0.0_f64, 0);
    for line in text.lines() {
        if let Some(set) = line.strip_prefix("# set ") {
            surfaces.push(make(&numbers(set.split(": ").nth(1).expect("parameters"))));
        } else if line.starts_with(|c: char| c.is_ascii_digit()) {
            let v = numbers(line);
            let at = |i: usize| DVec3::new(v[i], v[i + 1], v[i + 2]);
            let surface = &surfaces[v[0] as usize];
            let (point, after) = meet(&**surface, (at(4), at(7)), (v[2], v[3]), Action::Refract)
                .unwrap_or_else(|loss| panic!("{kind}: {loss:?} at {line}"));
            position = position.max((point - at(10)).length());
            direction = direction.max((after - at(13)).length());
            rays += 1;
        }
    }
    println!("{kind}: {rays} rays, position {position:.1e} mm, direction {direction:.1e}");
    (position, direction, rays)
}

fn check(kind: &str, make: impl Fn(&[f64]) -> Box<dyn Surface>) {
    let (position, direction, rays) = errors(kind, make);
    assert!(rays >= 40, "{kind}: {rays} rays");
    assert!(position < 1e-9 && direction < 1e-12, "{kind}: {position} mm, {direction}");
}

#[test]
fn even_asphere() {
    check("even_asphere", |p| Box::new(Kernel(EvenAsphere::<20>::new(p[0], p[1], &p[2..]))));
}

#[test]
fn odd_asphere() {
    check("odd_asphere", |p| Box::new(PerRay(FromSag(OddAsphere::new(p[0], p[1], &p[2..])))));
}

#[test]
fn toroid() {
    check("toroid", |p| Box::new(PerRay(FromSag(Toroid::new(p[0], p[1], &p[3..], p[2])))));
}

#[test]
fn biconic() {
    check("biconic", |p| Box::new(PerRay(FromSag(Biconic::new((p[0], p[1]), (p[2], p[3]))))));
}

#[test]
fn cylinder() {
    let axis = |x: f64| if x == 1.0 { CylinderAxis::X } else { CylinderAxis::Y };
    check("cylinder", |p| Box::new(Kernel(Cylinder::new(p[0], axis(p[1])))));
}

#[test]
fn zernike() {
    let ordering = |fringe: f64| if fringe == 1.0 { ZernikeOrdering::Fringe } else { ZernikeOrdering::Noll };
    check("zernike", |p| Box::new(PerRay(FromSag(Zernike::new(p[0], p[1], p[2], &p[4..], ordering(p[3]))))));
}
