//! The plane of sharp focus of a tilted imager behind a real lens.

use glam::{DMat3, DVec3};
use spectra_core::RayBatch;
use spectra_core::frame::FrameSize;
use spectra_core::stage::Launch;
use spectra_optics::{RearPupil, stop_down};
use spectra_plugin_imagers::{FrameShape, Placement, Plane};
use spectra_plugin_surfaces as _;
use spectra_scene::FileResources;
use spectra_tracer::{Indices, Tracer, Travel};
use std::path::Path;

/// Returns the point in front of the lens where the light of one pixel comes closest together: the weighted least-squares
/// solution for the distances from its rays.
fn sharp_point(tracer: &Tracer, pupil: &RearPupil, plane: &Plane, pixel: u32, nm: f64) -> DVec3 {
    const SIDE: usize = 64;
    let n = SIDE * SIDE;
    let grid = |k: usize| (k as f64 + 0.5) / SIDE as f64;
    let (a, b): (Vec<f64>, Vec<f64>) = (0..n).map(|i| (grid(i % SIDE), grid(i / SIDE))).unzip();
    let mut rays = RayBatch::new(n);
    rays.restart(n);
    let c = rays.columns_mut();
    c.tag.fill(pixel);
    c.wavelength_nm.fill(nm);
    let middle = vec![0.5; n];
    plane.place(&mut rays, &middle, &middle);
    pupil.aim(&mut rays, &a, &b);
    tracer.trace(&mut rays, &mut tracer.work_in_place(n), Travel::Backward);
    let (mut matrix, mut right) = (DMat3::ZERO, DVec3::ZERO);
    for i in (0..n).filter(|i| rays.loss(*i).is_none()) {
        let at = |[x, y, z]: [&[f64]; 3]| DVec3::new(x[i], y[i], z[i]);
        let (p, d) = (at(rays.positions()), at(rays.directions()));
        let across = DMat3::IDENTITY - DMat3::from_cols(d * d.x, d * d.y, d * d.z);
        matrix += across * rays.weights()[i];
        right += across * p * rays.weights()[i];
    }
    matrix.inverse() * right
}

/// The image plane and the plane of sharp focus meet the principal planes at the same height (T. Scheimpflug, British patent
/// 1196 (1904)). Checked with real rays of a Biotar at f/8, near the axis, where the field is flat, in degrees of the plane.
#[test]
fn a_tilted_imager_is_sharp_on_scheimpflugs_plane() {
    let lens = spectra_lens::load("zeiss-biotar-50-f1.4", &FileResources::beside(Path::new("."))).expect("bundled");
    let lens = stop_down(lens, 8.0).expect("stopped down").focused_at(2000.0).expect("focused");
    let nm = lens.reference_nm;
    let tracer = Tracer::new(&lens, Indices::Band { min_nm: nm - 1.0, max_nm: nm + 1.0 }).expect("a lens");
    let first = lens.first_order(nm);
    for tilt_deg in [-6.0_f64, 2.0, 5.0, 10.0] {
        let tilt = tilt_deg.to_radians();
        let size = FrameSize { width_px: 1, height_px: 5, width_mm: 1.0, height_mm: 2.5 };
        let standing = Placement::new([0.0; 2], [tilt, 0.0], FrameShape::Flat);
        let plane = Plane::new(size).with_placement(standing);
        let points: Vec<DVec3> = (-10..=10).map(|k| standing.at(0.0, 0.125 * f64::from(k)).0).collect();
        let pupil = RearPupil::search(&lens, &tracer, &points, nm - 1.0, nm + 1.0).expect("an aperture");
        let sharp: Vec<DVec3> = (0..5).map(|pixel| sharp_point(&tracer, &pupil, &plane, pixel, nm)).collect();
        // Fit the straight line z = at_axis + slope y through the five points.
        let mean = sharp.iter().sum::<DVec3>() / 5.0;
        let (yz, yy) = sharp.iter().fold((0.0, 0.0), |(yz, yy), p| {
            (yz + (p.y - mean.y) * (p.z - mean.z), yy + (p.y - mean.y) * (p.y - mean.y))
        });
        let slope = yz / yy;
        let at_axis = mean.z - slope * mean.y;
        let height = -(lens.image_z_mm() - first.rear_principal_z_mm) / libm::tan(tilt);
        let wanted = (first.front_principal_z_mm - at_axis) / height;
        let (got, want) = (libm::atan(slope).to_degrees(), libm::atan(wanted).to_degrees());
        println!(
            "tilt {tilt_deg}: sharp plane {got:.4} degrees off upright, Scheimpflug {want:.4}, axis at {at_axis:.2} mm"
        );
        assert!((got - want).abs() < 0.1, "tilt {tilt_deg}: {got} and {want} degrees");
    }
}
