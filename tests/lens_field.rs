//! The field of a lens: how far it reaches, chief rays, telecentricity.

use glam::DVec3;
use spectra_core::loss::ALIVE;
use spectra_core::{Isa, RayBatch};
use spectra_lens::{Indices, Lens, Tracer, Travel};
use spectra_plugins as _;
use spectra_scene::FileResources;
use std::path::Path;

fn lens(path: &str) -> Lens {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join(path);
    spectra_lens::load(&path.to_string_lossy(), &FileResources::beside(Path::new("."))).expect("a lens")
}

/// Rays of a field angle (degrees) that pass, of a dense square grid over a disk of radius `reach_mm` about a point on the
/// axis: brute force.
fn brute(lens: &Lens, field_deg: f64, middle_z_mm: f64, reach_mm: f64, cells: usize) -> usize {
    let tracer = Tracer::new(lens, Indices::At(lens.reference_nm), Isa::detect()).expect("media");
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

/// Inside of the limit light passes, and outside of it a million rays do not.
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
        let found = lens.field_limit(f64::INFINITY).expect("media").expect("it has a field");
        let deg = found.field_rad.to_degrees();
        println!("{path}: {deg} {:?}", found.limit);
        assert!(found.limit.is_some(), "{found:?}");
        assert!(brute(&lens, deg - 0.3, middle_z_mm, reach_mm, 1000) > 0, "{path}: nothing passes at {deg} - 0.3");
        assert_eq!(brute(&lens, deg + 0.02, middle_z_mm, reach_mm, 1000), 0, "{path}: light passes at {deg} + 0.02");
    }
}

/// A fisheye sees behind itself.
#[test]
fn a_fisheye_sees_more_than_the_half_space() {
    let fisheye = lens("tests/data/lenses/minolta-fisheye-1-f2.7.yaml");
    let limit = fisheye.field_limit(f64::INFINITY).expect("media").expect("a field").field_rad.to_degrees();
    assert!((85.0..115.0).contains(&limit), "{limit}");
    let fields: Vec<f64> = (0..=90).step_by(10).map(|deg| f64::from(deg).to_radians()).collect();
    let rays = fisheye.chief_rays(f64::INFINITY, &fields).expect("media");
    let heights: Vec<f64> = rays.iter().map(|r| r.expect("a chief ray").image_mm[1]).collect();
    assert!(heights.windows(2).all(|w| w[1] > w[0]), "{heights:?}");
    // Equidistant near the axis: height = focal length x angle.
    let efl = fisheye.first_order(fisheye.reference_nm).efl_mm;
    assert!((heights[1] / (efl * fields[1]) - 1.0).abs() < 0.01, "{}", heights[1]);
}

/// The chief ray goes through the center of the stop, and near the axis as paraxial optics has it: it leaves as if from
/// the middle of the exit pupil.
#[test]
fn chief_rays_pass_the_center_of_the_stop() {
    for path in ["lenses/zeiss-biotar-50-f1.4.yaml", "tests/data/lenses/nikon-retrofocus-100-f2.8.yaml"] {
        let lens = lens(path);
        let fields = [0.0, 0.001, 0.2, 0.35];
        let rays = lens.chief_rays(f64::INFINITY, &fields).expect("media");
        let mut open = lens.clone();
        open.elements.iter_mut().for_each(|e| e.semi_diameter_mm = None);
        let tracer = Tracer::new(&open, Indices::At(lens.reference_nm), Isa::Baseline).expect("media");
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

/// Without any sizes there is no limit to the field, but there are chief rays.
#[test]
fn chief_rays_need_no_rims() {
    let full = lens("lenses/zeiss-biotar-50-f1.4.yaml");
    let mut open = full.clone();
    open.elements.iter_mut().for_each(|e| e.semi_diameter_mm = None);
    assert_eq!(open.field_limit(f64::INFINITY).expect("media"), None);
    let fields = [0.0, 0.1, 0.3];
    let rays = |lens: &Lens| lens.chief_rays(f64::INFINITY, &fields).expect("media");
    for (a, b) in rays(&full).iter().zip(rays(&open)) {
        let (a, b) = (a.expect("a chief ray"), b.expect("a chief ray"));
        assert!((a.image_mm[1] - b.image_mm[1]).abs() < 1e-8);
    }
    // With a stop alone the field reaches on, and the whole beam is found.
    let stopped = open.at_f_number(5.6).expect("f/5.6");
    let limit = stopped.field_limit(f64::INFINITY).expect("media").expect("a stop");
    assert!(limit.field_rad > 0.5, "{limit:?}");
}

/// With its stop in the front focal plane a lens is telecentric behind: near the axis all chief rays leave along it.
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
    let angles: Vec<f64> = lens
        .chief_rays(f64::INFINITY, &[0.0, 0.001, 0.002])
        .expect("media")
        .iter()
        .map(|r| r.expect("a chief ray").exit_angle_rad())
        .collect();
    assert!(angles.iter().all(|a| a.abs() < 1e-7), "{angles:?}");
    let entocentric = write(30.0).chief_rays(f64::INFINITY, &[0.001]).expect("media")[0].expect("a chief ray");
    assert!(entocentric.exit_angle_rad().abs() > 1e-4);
}
