//! Tests the field of a lens: its limit, chief rays, telecentricity.

use glam::DVec3;
use spectra_core::RayBatch;
use spectra_core::loss::ALIVE;
use spectra_lens::Lens;
use spectra_optics::{Optics, stop_down};
use spectra_plugins as _;
use spectra_scene::FileResources;
use spectra_tracer::{Indices, Tracer, Travel};
use std::path::Path;

fn lens(path: &str) -> Lens {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join(path);
    spectra_lens::load(&path.to_string_lossy(), &FileResources::beside(Path::new("."))).expect("a lens")
}

/// Returns by brute force how many rays of a field angle (degrees) pass, from a dense square grid over a disk of radius `reach_mm`
/// around a point on the axis.
fn brute(lens: &Lens, field_deg: f64, middle_z_mm: f64, reach_mm: f64, cells: usize) -> usize {
    let tracer = Tracer::new(lens, Indices::At(lens.reference_nm)).expect("media");
    let (s, c) = field_deg.to_radians().sin_cos();
    let (d, up) = (DVec3::new(0.0, s, c), DVec3::new(0.0, c, -s));
    let at = |i: usize| ((i as f64 + 0.5) / cells as f64 * 2.0 - 1.0) * reach_mm;
    let mut passed = 0;
    let mut rays = RayBatch::new(cells);
    let mut work = tracer.work_in_place(cells);
    for j in 0..cells {
        rays.restart(cells);
        let col = rays.columns_mut();
        for i in 0..cells {
            let p = DVec3::new(at(i), 0.0, middle_z_mm) + at(j) * up - 10.0 * reach_mm * d;
            (col.x[i], col.y[i], col.z[i]) = p.into();
            (col.l[i], col.m[i], col.n[i]) = d.into();
            col.wavelength_nm[i] = lens.reference_nm;
        }
        tracer.trace(&mut rays, &mut work, Travel::Forward);
        passed += rays.states().iter().filter(|s| **s == ALIVE).count();
    }
    passed
}

/// Inside the limit light passes, and outside it a million rays do not.
#[test]
fn the_largest_field_is_the_largest() {
    for path in [
        "lenses/zeiss-biotar-50-f1.4.yaml",
        "tests/data/lenses/minolta-fisheye-1-f2.7.yaml",
        "tests/data/lenses/zeiss-hologon-15-f8.yaml",
    ] {
        let lens = lens(path);
        let first = &lens.elements[0];
        let rim_mm = first.semi_diameter_mm.expect("a rim");
        let (middle_z_mm, reach_mm) = (first.surface.sag_mm(rim_mm, 0.0).expect("a rim") / 2.0, 1.2 * rim_mm);
        let found = Optics::new(lens.clone()).field_limit(f64::INFINITY).expect("media").expect("it has a field");
        let deg = found.field_rad.to_degrees();
        println!("{path}: {deg} {:?}", found.limit);
        assert!(found.limit.is_some(), "{found:?}");
        assert!(brute(&lens, deg - 0.3, middle_z_mm, reach_mm, 1000) > 0, "{path}: nothing passes at {deg} - 0.3");
        assert_eq!(brute(&lens, deg + 0.02, middle_z_mm, reach_mm, 1000), 0, "{path}: light passes at {deg} + 0.02");
    }
}

/// A fisheye sees more than 90 degrees from its axis.
#[test]
fn a_fisheye_sees_more_than_the_half_space() {
    let fisheye = lens("tests/data/lenses/minolta-fisheye-1-f2.7.yaml");
    let limit = Optics::new(fisheye.clone())
        .field_limit(f64::INFINITY)
        .expect("media")
        .expect("a field")
        .field_rad
        .to_degrees();
    assert!((85.0..115.0).contains(&limit), "{limit}");
    let fields: Vec<f64> = (0..=90).step_by(10).map(|deg| f64::from(deg).to_radians()).collect();
    let rays = Optics::new(fisheye.clone()).chief_rays(f64::INFINITY, &fields).expect("media");
    let heights: Vec<f64> = rays.iter().map(|r| r.expect("a chief ray").image_mm[1]).collect();
    assert!(heights.windows(2).all(|w| w[1] > w[0]), "{heights:?}");
    // Near the axis it is equidistant: height = focal length x angle.
    let efl = fisheye.first_order(fisheye.reference_nm).efl_mm;
    assert!((heights[1] / (efl * fields[1]) - 1.0).abs() < 0.01, "{}", heights[1]);
}

/// The chief ray passes through the center of the stop. Near the axis it follows paraxial optics and leaves as if from the center of
/// the exit pupil.
#[test]
fn chief_rays_pass_the_center_of_the_stop() {
    for path in ["lenses/zeiss-biotar-50-f1.4.yaml", "tests/data/lenses/nikon-retrofocus-100-f2.8.yaml"] {
        let lens = lens(path);
        let fields = [0.0, 0.001, 0.2, 0.35];
        let rays = Optics::new(lens.clone()).chief_rays(f64::INFINITY, &fields).expect("media");
        let mut open = lens.clone();
        open.elements.iter_mut().for_each(|e| e.semi_diameter_mm = None);
        let tracer = Tracer::new(&open, Indices::At(lens.reference_nm)).expect("media");
        let stop = lens.stop().expect("a stop");
        for (field, ray) in fields.iter().zip(&rays) {
            let ray = ray.expect("a chief ray");
            let path = tracer.path(ray.start_mm, ray.direction, lens.reference_nm);
            assert!(path.points[stop + 1].truncate().length() < 1e-6);
            assert!((ray.direction.angle_between(DVec3::Z) - field).abs() < 1e-12);
        }
        let near = rays[1].expect("a chief ray");
        let first = lens.first_order(lens.reference_nm);
        let pupil_mm = near.image_mm[1] / near.exit_angle_rad().tan();
        let exit = lens.image_z_mm() - first.exit_pupil_z_mm.expect("a pupil");
        assert!((pupil_mm / exit - 1.0).abs() < 1e-5, "{pupil_mm} {exit}");
    }
}

/// The field of a lens without any sizes has no limit, but there are chief rays.
#[test]
fn chief_rays_need_no_rims() {
    let full = lens("lenses/zeiss-biotar-50-f1.4.yaml");
    let mut open = full.clone();
    open.elements.iter_mut().for_each(|e| e.semi_diameter_mm = None);
    assert_eq!(Optics::new(open.clone()).field_limit(f64::INFINITY).expect("media"), None);
    let fields = [0.0, 0.1, 0.3];
    let rays = |lens: &Lens| Optics::new(lens.clone()).chief_rays(f64::INFINITY, &fields).expect("media");
    for (a, b) in rays(&full).iter().zip(rays(&open)) {
        let (a, b) = (a.expect("a chief ray"), b.expect("a chief ray"));
        assert!((a.image_mm[1] - b.image_mm[1]).abs() < 1e-8);
    }
    // With the stop as the only limit the field is larger, and the whole beam is found.
    let stopped = stop_down(open, 5.6).expect("f/5.6");
    let limit = Optics::new(stopped.clone()).field_limit(f64::INFINITY).expect("media").expect("a stop");
    assert!(limit.field_rad > 0.5, "{limit:?}");
}

/// A lens with its stop in the front focal plane is image-space telecentric: near the axis all chief rays leave parallel to it.
#[test]
fn a_stop_in_the_front_focus_is_telecentric() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("telecentric.yaml");
    let write = |gap: f64| {
        let text = format!(
            "name: t\nsurfaces:\n  - {{kind: stop, thickness: {gap}, semi-diameter: 2}}\n  \
             - {{kind: sphere, radius: 60, thickness: 6, glass: SCHOTT/N-BK7, semi-diameter: 20}}\n  \
             - {{kind: sphere, radius: -60, thickness: 55, semi-diameter: 20}}\n"
        );
        std::fs::write(&file, text).expect("written");
        spectra_lens::load(&file.to_string_lossy(), &FileResources::beside(Path::new("."))).expect("a lens")
    };
    let ffl = write(10.0).first_order(587.5618).ffl_mm;
    let lens = write(10.0 - ffl);
    let angles: Vec<f64> = Optics::new(lens)
        .chief_rays(f64::INFINITY, &[0.0, 0.001, 0.002])
        .expect("media")
        .iter()
        .map(|r| r.expect("a chief ray").exit_angle_rad())
        .collect();
    assert!(angles.iter().all(|a| a.abs() < 1e-7), "{angles:?}");
    let entocentric =
        Optics::new(write(30.0)).chief_rays(f64::INFINITY, &[0.001]).expect("media")[0].expect("a chief ray");
    assert!(entocentric.exit_angle_rad().abs() > 1e-4);
}

/// Returns how far the sagittal and the tangential focus along a chief ray lie behind the image plane, mm along the axis.
/// Coddington's equations (H. Coddington, 1829) are applied to each sphere or plane: n' cos^2 I' / t' - n cos^2 I / t = n' / s' - n /
/// s = (n' cos I' - n cos I) / R.
fn coddington(lens: &Lens, start: DVec3, direction: DVec3) -> [f64; 2] {
    let mut open = lens.clone();
    open.elements.iter_mut().for_each(|e| e.semi_diameter_mm = None);
    let tracer = Tracer::new(&open, Indices::At(lens.reference_nm)).expect("media");
    let path = tracer.path(start, direction, lens.reference_nm);
    assert!(path.end.is_none());
    let index = |medium: usize| lens.index(medium, lens.reference_nm);
    // Light from infinity has no vergence. Distances are measured from the last point along the ray, sagittal and tangential.
    let (mut toward, mut foci) = (direction, [f64::INFINITY; 2]);
    for (at, e) in lens.elements.iter().enumerate() {
        let here = path.points[at + 1];
        let after = match path.points.get(at + 2) {
            Some(next) => (*next - here).normalize(),
            None => path.direction,
        };
        let along = if at == 0 { 0.0 } else { (here - path.points[at]).length() };
        foci = foci.map(|f| f - along);
        let (_, curvature) = e.vertex_curvature_per_mm();
        let normal = match curvature == 0.0 {
            true => DVec3::Z,
            false => (DVec3::new(0.0, 0.0, e.vertex_z_mm() + 1.0 / curvature) - here) * curvature,
        };
        let (n, m) = (index(e.medium_before), index(e.medium_after));
        let (ci, co) = (toward.dot(normal), after.dot(normal));
        let power = (m * co - n * ci) * curvature;
        foci = [m / (n / foci[0] + power), m * co * co / (n * ci * ci / foci[1] + power)];
        toward = after;
    }
    let last = path.points[lens.elements.len()].z;
    foci.map(|f| last + f * toward.z - lens.image_z_mm())
}

/// Close rays meet at the foci of Coddington's equations.
#[test]
fn foci_are_those_of_coddington() {
    for path in ["lenses/zeiss-biotar-50-f1.4.yaml", "lenses/cooke-triplet-50-f5.yaml"] {
        let lens = lens(path);
        let fields = [0.0, 0.1, 0.2, 0.3];
        let rays = Optics::new(lens.clone()).chief_rays(f64::INFINITY, &fields).expect("media");
        for ray in rays {
            let ray = ray.expect("a chief ray");
            let wanted = coddington(&lens, ray.start_mm, ray.direction);
            for (found, wanted) in ray.foci_mm.into_iter().zip(wanted) {
                let found = found.expect("a focus");
                assert!((found - wanted).abs() < 1e-6, "{path}, {}: {found} {wanted}", ray.field_rad);
            }
        }
        // On the axis both foci are the paraxial image.
        let axis = Optics::new(lens.clone()).chief_rays(f64::INFINITY, &[0.0]).expect("media")[0].expect("a chief ray");
        let paraxial = lens.paraxial_defocus_mm(f64::INFINITY);
        assert!(axis.foci_mm.iter().all(|z| (z.expect("a focus") - paraxial).abs() < 1e-6), "{axis:?} {paraxial}");
    }
}

/// A spherical mirror with its stop at the center of curvature has no preferred axis: it has no astigmatism, and its image lies on a
/// sphere of half its radius around the stop. Distances behind the image plane are measured along the light.
#[test]
fn a_mirror_about_its_stop_has_a_curved_field_without_astigmatism() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("mirror.yaml");
    let text = "name: mirror\nsurfaces:\n  - {kind: stop, thickness: 200, semi-diameter: 5}\n  \
                - {radius: -200, thickness: -100, mirror: true}\n";
    std::fs::write(&file, text).expect("written");
    let mirror = spectra_lens::load(&file.to_string_lossy(), &FileResources::beside(Path::new("."))).expect("a lens");
    let fields = [0.0, 0.1, 0.3, 0.6];
    for ray in Optics::new(mirror.clone()).chief_rays(f64::INFINITY, &fields).expect("media") {
        let ray = ray.expect("a chief ray");
        let wanted = 100.0 * (1.0 - ray.field_rad.cos());
        for found in ray.foci_mm {
            assert!((found.expect("a focus") - wanted).abs() < 1e-6, "{ray:?}: {wanted}");
        }
    }
}

/// In one section of a cylinder light stays parallel; in the other one it has a focus.
#[test]
fn a_cylinder_has_one_focus() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("cylinder.yaml");
    let text = "name: cylinder\nsurfaces:\n  - {kind: stop, thickness: 0, semi-diameter: 5}\n  \
                - {kind: cylinder, radius: 50, axis: x, thickness: 0, glass: {nd: 1.5}}\n  - {kind: plane, thickness: 90}\n";
    std::fs::write(&file, text).expect("written");
    let lens = spectra_lens::load(&file.to_string_lossy(), &FileResources::beside(Path::new("."))).expect("a lens");
    for ray in Optics::new(lens.clone()).chief_rays(f64::INFINITY, &[0.0, 0.2]).expect("media") {
        let [sagittal, tangential] = ray.expect("a chief ray").foci_mm;
        assert!(sagittal.is_none() && tangential.is_some_and(|z| z.abs() < 20.0), "{sagittal:?} {tangential:?}");
    }
}
