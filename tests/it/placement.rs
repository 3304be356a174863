//! Tests tilted, shifted, folded and reversed surfaces against closed forms.

use glam::{DMat3, DVec3};
use spectra_core::RayBatch;
use spectra_lens::{Lens, Section};
use spectra_optics::{Optics, stop_down};
use spectra_plugins as _;
use spectra_scene::FileResources;
use spectra_tracer::{Indices, Tracer, Travel};
use std::path::Path;

fn lens(text: &str) -> Lens {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("lens.yaml");
    std::fs::write(&path, format!("name: test\nsurfaces:\n{text}")).expect("written");
    load(&path)
}

fn load(path: &Path) -> Lens {
    spectra_lens::load(&path.to_string_lossy(), &FileResources::beside(Path::new(".")))
        .unwrap_or_else(|faults| panic!("{faults}"))
}

fn tracer(lens: &Lens) -> Tracer {
    Tracer::new(lens, Indices::At(lens.reference_nm)).expect("media")
}

/// Returns positions and directions of rays where they leave a lens, in the frame of the lens.
fn trace(lens: &Lens, rays: &[(DVec3, DVec3)]) -> Vec<Option<(DVec3, DVec3)>> {
    let tracer = tracer(lens);
    let mut batch = RayBatch::new(rays.len());
    batch.restart(rays.len());
    let c = batch.columns_mut();
    for (i, (p, d)) in rays.iter().enumerate() {
        (c.x[i], c.y[i], c.z[i]) = (*p).into();
        (c.l[i], c.m[i], c.n[i]) = (*d).into();
        c.wavelength_nm[i] = lens.reference_nm;
    }
    tracer.trace(&mut batch, &mut tracer.work_in_place(rays.len()), Travel::Forward);
    let (p, d) = (batch.positions(), batch.directions());
    (0..rays.len())
        .map(|i| {
            batch.loss(i).is_none().then(|| {
                let (p, d) = (DVec3::new(p[0][i], p[1][i], p[2][i]), DVec3::new(d[0][i], d[1][i], d[2][i]));
                // In the frame of the image plane, z = 0 is the plane itself.
                let p = p - p.z / d.z * d;
                (lens.image_pose.point(p), lens.image_pose.direction(d))
            })
        })
        .collect()
}

/// A mirror at 45 degrees sends the axis straight up, and the image plane is perpendicular to the new axis.
#[test]
fn a_fold_mirror_folds() {
    let folded = lens(
        "  - {kind: coordinate-break, tilt: [45, 0, 0], thickness: 0}\n\
         \x20 - {kind: plane, mirror: true}\n\
         \x20 - {kind: coordinate-break, tilt: [45, 0, 0], thickness: -20}\n\
         \x20 - {kind: plane, thickness: -5}\n",
    );
    let hits = trace(&folded, &[(DVec3::new(1.0, 2.0, -10.0), DVec3::Z)]);
    let (p, d) = hits[0].expect("it arrives");
    // The ray at height 2 meets the mirror z = y at z = 2, and goes up along +y to the plane 25 mm above the vertex.
    assert!((p - DVec3::new(1.0, 25.0, 2.0)).length() < 1e-12, "{p}");
    assert!((d - DVec3::Y).length() < 1e-15, "{d}");
    assert!(!folded.has_axis_of_revolution());
}

/// A prism with apex angle A and index n has the minimum deviation 2 asin(n sin(A/2)) - A.
#[test]
fn a_prism_deviates_by_the_textbook() {
    let (apex, n): (f64, f64) = (60.0, 1.5);
    let incidence = (n * (apex / 2.0).to_radians().sin()).asin().to_degrees();
    // Light along z meets a first face whose normal is tilted by the angle of incidence.
    let prism = lens(&format!(
        "  - {{kind: coordinate-break, tilt: [{}, 0, 0]}}\n\
         \x20 - {{kind: plane, glass: {{nd: {n}}}}}\n\
         \x20 - {{kind: coordinate-break, tilt: [{apex}, 0, 0], decenter: [0, 0], thickness: 0}}\n\
         \x20 - {{kind: plane, thickness: 10}}\n",
        -incidence
    ));
    let (_, d) = trace(&prism, &[(DVec3::new(0.0, -1.0, -40.0), DVec3::Z)])[0].expect("it passes");
    let deviation = d.angle_between(DVec3::Z).to_degrees();
    assert!((deviation - (2.0 * incidence - apex)).abs() < 1e-10, "{deviation}");
}

/// A lens with every surface shifted equals the lens with shifted rays. A shifted group of all surfaces gives the same, and a tilted
/// group equals tilted rays.
#[test]
fn moving_the_lens_is_moving_the_rays() {
    let surfaces = |more: &str| {
        format!(
            "  - {{kind: sphere, radius: 50, thickness: 5, glass: SCHOTT/N-BK7, semi-diameter: 12{more}}}\n\
             \x20 - {{kind: sphere, radius: -40, thickness: 3, glass: SCHOTT/F2, semi-diameter: 12{more}}}\n\
             \x20 - {{kind: sphere, radius: 200, thickness: 90, semi-diameter: 12{more}}}\n"
        )
    };
    let still = lens(&surfaces(""));
    let shifted = lens(&surfaces(", decenter: [1.5, -2]"));
    let group = lens(&format!("{}groups: [{{name: all, surfaces: [1, 3], decenter: [1.5, -2]}}]\n", surfaces("")));
    let tilted = lens(&format!("{}groups: [{{name: all, surfaces: [1, 3], tilt: [10, -4, 30]}}]\n", surfaces("")));
    let shift = DVec3::new(1.5, -2.0, 0.0);
    let rays: Vec<_> = (0..20)
        .map(|k| {
            let k = f64::from(k);
            let d = DVec3::new(0.02 * k.sin(), 0.05 * k.cos(), 1.0).normalize();
            (DVec3::new(3.0 * k.cos(), 4.0 * (2.0 * k).sin(), -5.0), d)
        })
        .collect();
    let moved: Vec<_> = rays.iter().map(|(p, d)| (*p + shift, *d)).collect();
    for (a, b) in [(&still, &shifted), (&still, &group)] {
        for (a, b) in trace(a, &rays).iter().zip(trace(b, &moved)) {
            let ((p, d), (q, e)) = (a.expect("hits"), b.expect("hits"));
            assert!((p + shift - q).length() < 1e-12 && (d - e).length() < 1e-14);
        }
    }
    let pose = spectra_lens::Displacement {
        decenter_mm: [0.0; 2],
        tilt_rad: [10.0_f64.to_radians(), -4.0_f64.to_radians(), 30.0_f64.to_radians()],
        tilt_first: false,
    }
    .pose();
    let turned: Vec<_> = rays.iter().map(|(p, d)| (pose.point(*p), pose.direction(*d))).collect();
    for (a, b) in trace(&still, &rays).iter().zip(trace(&tilted, &turned)) {
        let ((p, d), (q, e)) = (a.expect("hits"), b.expect("hits"));
        // The image plane did not rotate with the group, so lines are compared instead of end points.
        let (p, d) = (pose.point(p), pose.direction(d));
        assert!((d - e).length() < 1e-14);
        assert!((q - p).cross(d).length() < 1e-11, "{p} {q}");
    }
}

/// The Biotar, reversed surface by surface, equals the Biotar traced backward.
#[test]
fn a_reversed_lens_is_the_lens_traced_backward() {
    let there = load(&Path::new(env!("CARGO_MANIFEST_DIR")).join("lenses/zeiss-biotar-50-f1.4.yaml"));
    let mut back = there.clone();
    let count = there.elements.len();
    back.elements.reverse();
    for (at, e) in back.elements.iter_mut().enumerate() {
        e.reversed = true;
        std::mem::swap(&mut e.medium_before, &mut e.medium_after);
        e.thickness_mm = if at + 1 < count { there.elements[count - 2 - at].thickness_mm } else { 7.0 };
    }
    back.arrange();
    assert!(back.has_axis_of_revolution());
    let length = there.elements[count - 1].vertex_z_mm();
    let n = 50;
    let rays: Vec<_> = (0..n)
        .map(|k| {
            let k = f64::from(k);
            let d = DVec3::new(0.05 * k.sin(), 0.1 * (0.7 * k).cos(), 1.0).normalize();
            (DVec3::new(6.0 * (3.0 * k).cos(), 6.0 * (2.0 * k).sin(), -10.0), d)
        })
        .collect();
    let reversed = trace(&back, &rays);
    // Half a turn about y through the middle of the lens transforms one into the other.
    let turned = |p: DVec3| DVec3::new(-p.x, p.y, length - p.z);
    let t = tracer(&there);
    let mut batch = RayBatch::new(n as usize);
    batch.restart(n as usize);
    let c = batch.columns_mut();
    for (i, (p, d)) in rays.iter().enumerate() {
        let p = turned(*p) - DVec3::new(0.0, 0.0, there.image_z_mm());
        (c.x[i], c.y[i], c.z[i]) = p.into();
        (c.l[i], c.m[i], c.n[i]) = (-d.x, d.y, -d.z);
        c.wavelength_nm[i] = there.reference_nm;
    }
    t.trace(&mut batch, &mut t.work_in_place(n as usize), Travel::Backward);
    let mut arrived = 0;
    for (i, hit) in reversed.iter().enumerate() {
        assert_eq!(hit.is_some(), batch.loss(i).is_none(), "ray {i}");
        let Some((p, d)) = hit else { continue };
        arrived += 1;
        let (q, e) = (batch.positions().map(|c| c[i]), batch.directions().map(|c| c[i]));
        let (q, e) = (DVec3::from_array(q), DVec3::from_array(e));
        assert!((DVec3::new(-d.x, d.y, -d.z) - e).length() < 1e-14);
        assert!((turned(*p) - q).cross(e).length() < 1e-11);
    }
    assert!(arrived > 20, "{arrived}");
    let (a, b) = (there.first_order(587.56), back.first_order(587.56));
    assert!((a.efl_mm - b.efl_mm).abs() < 1e-10 && (a.ffl_mm + b.bfl_mm).abs() < 1e-10, "{a:?} {b:?}");
}

/// A concave mirror of radius R has the focal length R/2 in front of it. Light that is sent back along its path ends where it began,
/// through a mirror with a lens in both directions.
#[test]
fn mirrors_focus_and_light_is_reversible() {
    let mirror = lens("  - {kind: sphere, radius: -100, mirror: true, thickness: -50, semi-diameter: 10}\n");
    let f = mirror.first_order(587.56);
    assert!((f.efl_mm - 50.0).abs() < 1e-12 && (f.bfl_mm + 50.0).abs() < 1e-12, "{f:?}");
    assert!((f.rear_principal_z_mm).abs() < 1e-12);
    // The image plane faces the light and keeps left and right.
    assert_eq!(mirror.image_pose.rotation, DMat3::from_diagonal(DVec3::new(1.0, 1.0, -1.0)));
    assert!(mirror.has_axis_of_revolution());
    let (p, _) = trace(&mirror, &[(DVec3::new(0.0, 0.01, -200.0), DVec3::Z)])[0].expect("it comes back");
    assert!(p.y.abs() < 1e-7 && (p.z + 50.0).abs() < 1e-12, "{p}");

    // A Mangin mirror: glass in front of the mirror, passed twice.
    let mangin = lens(
        "  - {kind: sphere, radius: -80, thickness: 4, glass: SCHOTT/N-BK7, semi-diameter: 20}\n\
         \x20 - {kind: sphere, radius: -120, mirror: true, thickness: -4, semi-diameter: 20}\n\
         \x20 - {kind: sphere, radius: -80, thickness: -70, semi-diameter: 20}\n",
    );
    let t = tracer(&mangin);
    let n = 40;
    let mut batch = RayBatch::new(n);
    batch.restart(n);
    let c = batch.columns_mut();
    for i in 0..n {
        let k = i as f64;
        let d = DVec3::new(0.03 * k.sin(), 0.03 * k.cos(), 1.0).normalize();
        (c.x[i], c.y[i], c.z[i]) = (10.0 * (2.0 * k).cos(), 10.0 * (3.0 * k).sin(), 0.0);
        (c.l[i], c.m[i], c.n[i]) = d.into();
        c.wavelength_nm[i] = mangin.reference_nm;
    }
    let (start_p, start_d) = (batch.positions().map(<[f64]>::to_vec), batch.directions().map(<[f64]>::to_vec));
    let mut work = t.work_in_place(n);
    t.trace(&mut batch, &mut work, Travel::Forward);
    assert_eq!(batch.alive(), n);
    assert!(batch.directions()[2].iter().all(|z| *z > 0.0));
    let c = batch.columns_mut();
    for i in 0..n {
        (c.l[i], c.m[i], c.n[i]) = (-c.l[i], -c.m[i], -c.n[i]);
    }
    t.trace(&mut batch, &mut work, Travel::Backward);
    assert_eq!(batch.alive(), n);
    for i in 0..n {
        let d = DVec3::from_array(batch.directions().map(|c| -c[i]));
        let p = DVec3::from_array(batch.positions().map(|c| c[i]));
        let (q, e) =
            (DVec3::from_array([0, 1, 2].map(|k| start_p[k][i])), DVec3::from_array([0, 1, 2].map(|k| start_d[k][i])));
        assert!((d - e).length() < 1e-13 && (p - q).cross(e).length() < 1e-11, "ray {i}");
    }
}

/// An ideal lens has its focal length in either orientation and for light from either side; a cylinder has power in one section.
#[test]
fn power_by_the_surface_itself() {
    for more in ["", ", reversed: true"] {
        let thin = lens(&format!("  - {{kind: thin-lens, focal-length: 80, thickness: 80{more}}}\n"));
        assert!((thin.first_order(587.56).efl_mm - 80.0).abs() < 1e-12);
    }
    let folded = lens(
        "  - {kind: plane, mirror: true, thickness: -10}\n\
         \x20 - {kind: thin-lens, focal-length: 80, thickness: -80}\n",
    );
    let f = folded.first_order(587.56);
    assert!((f.efl_mm - 80.0).abs() < 1e-12 && (f.bfl_mm + 80.0).abs() < 1e-12, "{f:?}");
    let cylinder =
        lens("  - {kind: cylinder, radius: 50, axis: x, glass: {nd: 1.5}, thickness: 0}\n  - {kind: plane}\n");
    let [x, y] = [Section::X, Section::Y].map(|section| cylinder.first_order_in(section, 587.56).efl_mm);
    assert!((y - 100.0).abs() < 1e-9 && x.is_infinite(), "{x} {y}");
}

/// A stop with blades passes the light of the circle of equal area, and the f-number does not change. Light outside the polygon ends
/// at the stop.
#[test]
fn blades_keep_the_f_number() {
    let surfaces = |aperture: &str| {
        format!(
            "  - {{kind: sphere, radius: 50, thickness: 5, glass: SCHOTT/N-BK7, semi-diameter: 20}}\n\
             \x20 - {{kind: sphere, radius: -50, thickness: 5, semi-diameter: 20}}\n\
             \x20 - {{kind: stop, thickness: 40{aperture}}}\n"
        )
    };
    let round = stop_down(lens(&surfaces("")), 4.0).expect("f/4");
    let blades = stop_down(lens(&surfaces(", aperture: {shape: iris, blades: 5, rotation: 20}")), 4.0).expect("f/4");
    let f = |lens: &Lens| Optics::new(lens.clone()).marginal_ray().expect("limited").f_number();
    assert!((f(&round) - 4.0).abs() < 1e-9 && (f(&blades) - 4.0).abs() < 1e-9);
    let n = 200;
    let rays: Vec<_> = (0..n * n)
        .map(|k| {
            let at = |i: i32| (f64::from(i) + 0.5) / f64::from(n) * 20.0 - 10.0;
            (DVec3::new(at(k % n), at(k / n), -1.0), DVec3::Z)
        })
        .collect();
    let passed = |lens: &Lens| trace(lens, &rays).iter().flatten().count() as f64;
    let ratio = passed(&blades) / passed(&round);
    assert!((ratio - 1.0).abs() < 0.01, "{ratio}");
    assert!(round.has_axis_of_revolution() && !blades.has_axis_of_revolution());
}

/// Faults of placement have places and hints.
#[test]
fn faults_of_placement_say_what_to_do() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("lens.yaml");
    for (text, words) in [
        ("  - {kind: plane, mirror: true, glass: SCHOTT/F2}\n", "there is no glass behind a mirror"),
        ("  - {kind: plane, aperture: {shape: rectangl, half-width: 1, half-height: 1}}\n", "did you mean `rectangle`"),
        ("  - {kind: plane, aperture: [{shape: ring, inner: 3, outer: 2}]}\n", "no ring lies between"),
        ("  - {kind: plane, aperture: {shape: mask, file: nowhere.png, width: 10}}\n", "no such file"),
        ("  - {kind: coordinate-break, order: both}\n", "tilt-first"),
        ("  - {kind: plane}\ngroups: [{name: a, surfaces: [1, 2]}]\n", "no surfaces 1 to 2"),
        ("  - {kind: sphere, radius: 10, thickness: -3, glass: SCHOTT/F2}\n", "negative"),
        ("  - {kind: plane, stop: true}\n  - {kind: stop}\n", "a lens has one"),
    ] {
        std::fs::write(&path, format!("name: test\nsurfaces:\n{text}")).expect("written");
        let faults = spectra_lens::load(&path.to_string_lossy(), &FileResources::beside(Path::new(".")))
            .expect_err(text)
            .to_string();
        assert!(faults.contains(words), "{text}: {faults}");
    }
}
