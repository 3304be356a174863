//! Draws `docs/images/cone-density.png`: rays from a near point beside the axis, distributed evenly over the area of the front, and
//! evenly per solid angle.
//!
//! `cargo run --release -p spectra-optics --example cone_density [FILE]`

use glam::DVec3;
use spectra_core::math::concentric_disk;
use spectra_core::numbers::Numbers;
use spectra_core::surface::Kernel;
use spectra_core::{Isa, RayBatch};
use spectra_lens::{Element, Lens};
use spectra_optics::{AimPattern, FrontPupil};
use spectra_plot::{Canvas, Color, Point, Stroke, TextStyle};
use spectra_plugin_surfaces::Plane;
use spectra_tracer::{Indices, Tracer};
use std::path::Path;
use std::sync::Arc;

/// Radius of the rim, 20 mm, and a point 16 mm in front of its plane.
const RIM_MM: f64 = 20.0;
const POINT: DVec3 = DVec3::new(0.0, -34.0, -16.0);
/// Number of points per panel.
const POINTS: usize = 1500;
/// Number of points drawn before a part of them is kept by weight.
const DRAWN: usize = 16 * POINTS;
const PANEL: f64 = 420.0;
const HEIGHT: f64 = 216.0;
const TOP: f64 = 92.0;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let path = std::env::args().nth(1);
    let path = path.as_deref().unwrap_or(concat!(env!("CARGO_MANIFEST_DIR"), "/../../docs/images/cone-density.png"));
    let by_area = by_area();
    let by_solid_angle = by_solid_angle()?;
    let mut canvas =
        Canvas::new(2.0 * PANEL, TOP + HEIGHT + 46.0, "Rays of a near point: by area, and per solid angle");
    let strong = TextStyle::new(17.0).weight(1.3);
    let title = "A round front, 40 mm wide, seen from a point 16 mm in front of its plane and 34 mm beside its axis";
    canvas.text([PANEL, 26.0], title, &TextStyle::new(14.5).middle());
    let panels = [
        ("even over the area of the front", &by_area, Color::GREY),
        ("even per solid angle", &by_solid_angle, Color::BLUE),
    ];
    for (k, (what, directions, color)) in panels.into_iter().enumerate() {
        let middle = [PANEL * (k as f64 + 0.5), TOP + 0.5 * HEIGHT];
        canvas.text([middle[0], 66.0], what, &strong.clone().middle());
        draw(&mut canvas, middle, directions, color);
    }
    let note = "Both as the point sees them, equal areas of the figure being equal solid angles; 1500 rays each.";
    canvas.text([PANEL, TOP + HEIGHT + 26.0], note, &TextStyle::new(13.0).middle());
    canvas.write(Path::new(path))?;
    Ok(())
}

/// Returns directions to points distributed evenly over the area of the front.
fn by_area() -> Vec<DVec3> {
    let numbers = Numbers::sobol(1);
    (0..POINTS as u64)
        .map(|i| {
            let (p, q) = concentric_disk(numbers.one(0, i, 3), numbers.one(0, i, 4));
            (DVec3::new(p * RIM_MM, q * RIM_MM, 0.0) - POINT).normalize()
        })
        .collect()
}

/// Returns directions as the front pupil aims them, each kept with a probability proportional to its weight.
fn by_solid_angle() -> Result<Vec<DVec3>, Box<dyn std::error::Error>> {
    let mut lens = Lens::empty("a plane with a rim");
    let mut front = Element::new("plane", Arc::new(Kernel(Plane::refracting())), 0, 0);
    front.semi_diameter_mm = Some(RIM_MM);
    front.thickness_mm = 10.0;
    lens.elements.push(front);
    lens.arrange();
    let tracer = Tracer::new(&lens, Indices::At(lens.reference_nm))?;
    let pupil = FrontPupil::search(&lens, &tracer, &[POINT], 400.0, 700.0).ok_or("no aperture")?;
    let numbers = Numbers::sobol(1);
    let mut rays = RayBatch::new(DRAWN);
    rays.restart(DRAWN);
    let mut columns = [vec![0.0; DRAWN], vec![0.0; DRAWN], vec![0.0; DRAWN]];
    for (column, dimension) in columns.iter_mut().zip([3, 4, 5]) {
        numbers.fill(Isa::detect(), 0, 0, dimension, column);
    }
    let c = rays.columns_mut();
    for i in 0..DRAWN {
        (c.x[i], c.y[i], c.z[i]) = POINT.into();
        c.wavelength_nm[i] = 550.0;
    }
    let [u, v, keep] = &columns;
    pupil.aim(&mut rays, u, v, AimPattern::Disk);
    let [l, m, n] = rays.directions().map(<[f64]>::to_vec);
    let weights = rays.weights().to_vec();
    tracer.trace(&mut rays, &mut tracer.work_in_place(DRAWN), spectra_tracer::Travel::Forward);
    let passing = |i: &usize| rays.loss(*i).is_none();
    let total: f64 = (0..DRAWN).filter(passing).map(|i| weights[i]).sum();
    Ok((0..DRAWN)
        .filter(passing)
        .filter(|i| keep[*i] * total < POINTS as f64 * weights[*i])
        .map(|i| DVec3::new(l[i], m[i], n[i]))
        .collect())
}

/// Draws directions in Lambert's azimuthal projection about the middle of the front: equal areas are equal solid angles.
fn draw(canvas: &mut Canvas, middle: Point, directions: &[DVec3], color: Color) {
    let rim: Vec<DVec3> = (0..=360)
        .map(|k| {
            let (s, c) = spectra_core::math::sin_cos_turns(f64::from(k) / 360.0);
            (DVec3::new(c * RIM_MM, s * RIM_MM, 0.0) - POINT).normalize()
        })
        .collect();
    let axis = (rim.iter().sum::<DVec3>()).normalize();
    let right = DVec3::X;
    let up = right.cross(axis) * -1.0;
    let project = |d: &DVec3| {
        let scale = (2.0 / (1.0 + d.dot(axis))).sqrt();
        [d.dot(right) * scale, d.dot(up) * scale]
    };
    let edge: Vec<[f64; 2]> = rim.iter().map(project).collect();
    let span = |k: usize| {
        let (low, high) = edge.iter().fold((f64::MAX, f64::MIN), |(a, b), p| (a.min(p[k]), b.max(p[k])));
        (0.5 * (low + high), high - low)
    };
    let ((cx, width), (cy, height)) = (span(0), span(1));
    let unit = (0.88 * PANEL / width).min(HEIGHT / height);
    let place = |p: [f64; 2]| [middle[0] + (p[0] - cx) * unit, middle[1] - (p[1] - cy) * unit];
    let outline: Vec<Point> = edge.into_iter().map(place).collect();
    for direction in directions {
        canvas.disc(place(project(direction)), 1.5, color);
    }
    canvas.polyline(&outline, &Stroke::new(Color::BLACK, 1.4));
}
