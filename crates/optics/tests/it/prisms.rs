//! Prisms, in which light goes to the nearest face: against closed forms.

use glam::{DMat3, DVec3};
use spectra_core::{Loss, RayBatch};
use spectra_lens::{Coating, Lens};
use spectra_plugin_surfaces as _;
use spectra_scene::FileResources;
use spectra_tracer::{Indices, Tracer, Travel};

const D_NM: f64 = 587.5618;

/// Loads a lens of these surfaces; otherwise returns the faults.
fn lens(surfaces: &str) -> Result<Lens, String> {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("lens.yaml");
    std::fs::write(&path, format!("name: Prisms\ncoating: ideal\nsurfaces:\n{surfaces}")).expect("written");
    spectra_lens::load(path.to_str().expect("UTF-8"), &FileResources::beside(folder.path())).map_err(|f| f.to_string())
}

/// Traces rays, each given by a point and a direction in the frame of the lens. Returns point, direction and weight behind the lens, in
/// the frame of the lens, or the cause of loss.
fn traced(lens: &Lens, nm: f64, rays: &[(DVec3, DVec3)]) -> Vec<Result<(DVec3, DVec3, f64), Loss>> {
    let tracer = Tracer::new(lens, Indices::Band { min_nm: 380.0, max_nm: 780.0 }).expect("media");
    let batch = RayBatch::with_optical_path(rays.len());
    let mut batch = if tracer.polarizes() { batch.with_polarization() } else { batch };
    batch.restart(rays.len());
    let c = batch.columns_mut();
    for (i, (p, d)) in rays.iter().enumerate() {
        (c.x[i], c.y[i], c.z[i]) = (*p).into();
        (c.l[i], c.m[i], c.n[i]) = d.normalize().into();
        (c.wavelength_nm[i], c.weight[i]) = (nm, 1.0);
    }
    tracer.trace(&mut batch, &mut tracer.work_in_place(rays.len()), Travel::Forward);
    let pose = lens.image_pose;
    (0..rays.len())
        .map(|i| match batch.loss(i) {
            Some((cause, _)) => Err(cause),
            None => {
                let at = |columns: [&[f64]; 3]| DVec3::from_array(columns.map(|c| c[i]));
                Ok((pose.point(at(batch.positions())), pose.direction(at(batch.directions())), batch.weights()[i]))
            }
        })
        .collect()
}

/// The deviation is D = 2 asin(n sin(A / 2)) - A, the smallest at any incidence, and the axis leaves at this angle.
#[test]
fn the_least_deviation_is_that_of_the_textbook() {
    for (apex, glass) in [(60.0_f64, "SCHOTT/N-SF11"), (45.0, "SCHOTT/N-BK7"), (20.0, "SCHOTT/N-BK7")] {
        let text = format!("  - {{kind: prism, apex: {apex} deg, side: 30 mm, glass: {glass}, thickness: 100}}\n");
        let prism = lens(&text).expect("a prism");
        let n = prism.index(1, D_NM);
        let half = 0.5 * apex.to_radians();
        let want = 2.0 * (n * half.sin()).asin() - 2.0 * half;
        let out = traced(&prism, D_NM, &[(DVec3::new(0.0, 0.0, -50.0), DVec3::Z)]);
        let (at, way, _) = out[0].expect("passes");
        let got = (-way.y).atan2(way.z);
        assert!((got - want).abs() < 1e-9, "{apex}: {got} {want}");
        // The axis of the lens bends by the same angle: the image plane stands across it.
        assert!((prism.image_pose.rotation.z_axis - way).length() < 1e-9);
        assert!((prism.image_pose.origin_mm - at).cross(way).length() < 1e-7, "{at} {:?}", prism.image_pose);
        for incidence in [0.8, 0.95, 1.06, 1.3] {
            let i = (n * half.sin()).asin() * incidence;
            if i > 1.5 || (n * half.sin()).asin() * 0.8 > i {
                continue;
            }
            let text = text.replace("side:", &format!("incidence: {} deg, side:", i.to_degrees()));
            let other = lens(&text).expect("a prism");
            let Ok((_, way, _)) = traced(&other, D_NM, &[(DVec3::new(0.0, 0.0, -50.0), DVec3::Z)])[0] else { continue };
            assert!((-way.y).atan2(way.z) > want + 1e-6, "{apex} at {incidence}");
        }
    }
    // Seven entries with angles computed by hand make the same prism.
    let bundled = concat!(env!("CARGO_MANIFEST_DIR"), "/../../lenses/prism-60-sf11.yaml");
    let by_hand = spectra_lens::load(bundled, &FileResources::beside(std::path::Path::new(""))).expect("a lens");
    let own = lens("  - {kind: prism, apex: 60, side: 30, glass: SCHOTT/N-SF11, thickness: 150}\n").expect("a prism");
    for nm in [420.0, 520.0, 656.0] {
        for y in [-2.0, 0.0, 3.0] {
            let ray = [(DVec3::new(0.5, y, -50.0), DVec3::new(0.001, 0.002, 1.0))];
            let by_hand = by_hand.clone().with_coating(Coating::Ideal);
            let (Ok(a), Ok(b)) = (traced(&by_hand, nm, &ray)[0], traced(&own, nm, &ray)[0]) else { panic!("{nm} {y}") };
            assert!((a.1 - b.1).length() < 1e-5 && (a.0 - b.0).cross(a.1).length() < 1e-3, "{a:?} {b:?}");
        }
    }
}

/// Two silvered faces at 45 degrees turn light by 90 degrees, however the prism stands.
#[test]
fn a_penta_prism_turns_by_a_right_angle_at_any_tilt() {
    let faces = penta(20.0);
    for tilt in [0.0, 1.0, -2.5, 4.0] {
        let text = format!(
            "  - {{kind: prism, corners: {faces}, silvered: [2, 4], glass: SCHOTT/N-BK7, tilt: [{tilt}, 0, 0], thickness: 50}}\n"
        );
        let prism = lens(&text).unwrap_or_else(|e| panic!("{e}"));
        for (y, slope) in [(0.0, 0.0), (2.0, 0.0), (-1.0, 0.01)] {
            let way = DVec3::new(0.0, slope, 1.0).normalize();
            let out = traced(&prism, D_NM, &[(DVec3::new(0.0, y, -60.0), way)]);
            let (_, after, _) = out[0].expect("passes");
            assert!(after.dot(way).abs() < 1e-12, "{tilt} {slope}: {after}");
        }
    }
}

/// Returns the corners, [y, z], of a penta prism whose entrance and exit are this wide, mm.
fn penta(s: f64) -> String {
    // The right angle is at the lower front: entrance along y at z = 0, exit along z at y = 0, the mirrors at 112.5 degrees to them.
    let h = 0.5 * s;
    let k = s * (22.5_f64.to_radians()).tan();
    // Right angle, end of the entrance, the far corner of each mirror, end of the exit.
    let p = [[-h, 0.0], [h, 0.0], [h + k, s], [h, s + k], [-h, s]];
    format!("[{}]", p.map(|[y, z]| format!("[{y}, {z}]")).join(", "))
}

/// A Dove prism turned about the axis by an angle turns the image by twice as much, after one reflection.
#[test]
fn a_dove_prism_turns_the_image_twice_as_far() {
    // Base 40, height 8, ends at 45 degrees; the axis goes through the middle.
    let corners = "[[-4, -20], [4, -12], [4, 12], [-4, 20]]";
    for turn in [0.0_f64, 15.0, 30.0, 77.0] {
        let text = format!(
            "  - {{kind: prism, corners: {corners}, glass: SCHOTT/N-BK7, tilt: [0, 0, {turn}], thickness: 30}}\n"
        );
        let prism = lens(&text).unwrap_or_else(|e| panic!("{e}"));
        assert!((prism.image_pose.rotation.z_axis - DVec3::Z).length() < 1e-12);
        let two = |angle: f64| {
            let (s, c) = angle.sin_cos();
            DMat3::from_cols(DVec3::new(c, s, 0.0), DVec3::new(-s, c, 0.0), DVec3::Z)
        };
        let own = two(turn.to_radians());
        // The image is upside down in the prism's own frame, so it is a mirrored picture, turned by twice the angle.
        let image = own * DMat3::from_diagonal(DVec3::new(1.0, -1.0, 1.0)) * own.transpose();
        let twice = two(2.0 * turn.to_radians()) * DMat3::from_diagonal(DVec3::new(1.0, -1.0, 1.0));
        assert!((0..3).all(|k| (image.col(k) - twice.col(k)).length() < 1e-12));
        let axis = traced(&prism, D_NM, &[(DVec3::new(0.0, 0.0, -60.0), DVec3::Z)])[0].expect("passes");
        for way in [DVec3::new(0.02, 0.0, 1.0), DVec3::new(0.0, 0.03, 1.0), DVec3::new(-0.01, 0.02, 1.0)] {
            let way = way.normalize();
            let (_, after, _) = traced(&prism, D_NM, &[(-60.0 * way, way)])[0].expect("passes");
            assert!((after - twice * way).length() < 1e-9, "{turn}: {way} {after}");
        }
        assert!((axis.1 - DVec3::Z).length() < 1e-12);
    }
}

const PORRO: &str = "corners: [[-10, 0], [30, 0], [10, 20]], glass: SCHOTT/N-BK7";

/// One Porro prism sends light back and turns it over; two across each other turn the image by half a turn.
#[test]
fn porro_prisms_turn_the_image_round() {
    let one = lens(&format!("  - {{kind: prism, {PORRO}, thickness: 50}}\n")).unwrap_or_else(|e| panic!("{e}"));
    for way in [DVec3::Z, DVec3::new(0.0, 0.05, 1.0), DVec3::new(0.03, -0.02, 1.0)] {
        let way = way.normalize();
        let (at, after, _) = traced(&one, D_NM, &[(DVec3::ZERO - 20.0 * way, way)])[0].expect("passes");
        // Two mirrors at a right angle: half a turn about their edge, whatever the incidence.
        assert!((after - DVec3::new(way.x, -way.y, -way.z)).length() < 1e-12, "{way} {after}");
        if way == DVec3::Z {
            assert!((at.y - 20.0).abs() < 1e-9, "leaves as far from the other end: {at}");
        }
    }
    let pair = format!(
        "  - {{kind: prism, {PORRO}, thickness: 25}}\n  - {{kind: coordinate-break, tilt: [0, 0, 90]}}\n  - {{kind: prism, {PORRO}, \
         thickness: 60}}\n  - {{kind: plane, thickness: 10}}\n"
    );
    let pair = lens(&pair).unwrap_or_else(|e| panic!("{e}"));
    for way in [DVec3::Z, DVec3::new(0.02, 0.01, 1.0), DVec3::new(-0.01, 0.03, 1.0)] {
        let way = way.normalize();
        let (_, after, _) = traced(&pair, D_NM, &[(-20.0 * way, way)])[0].expect("passes");
        assert!((after - DVec3::new(-way.x, -way.y, way.z)).length() < 1e-12, "{way} {after}");
    }
}

/// Backward light follows the same path. Light that misses, hits the ground sides or is trapped reports it; faces take their part.
#[test]
fn light_is_booked() {
    let text = format!("  - {{kind: prism, {PORRO}, width: 20, thickness: 50}}\n");
    let porro = lens(&text).expect("a prism");
    let tracer = Tracer::new(&porro, Indices::At(D_NM)).expect("media");
    let mut rays = RayBatch::new(1);
    rays.restart(1);
    let c = rays.columns_mut();
    let way = DVec3::new(0.01, 0.02, 1.0).normalize();
    (c.x[0], c.y[0], c.z[0]) = (1.0, 2.0, -30.0);
    (c.l[0], c.m[0], c.n[0]) = way.into();
    (c.wavelength_nm[0], c.weight[0]) = (D_NM, 1.0);
    let mut work = tracer.work_in_place(1);
    tracer.trace(&mut rays, &mut work, Travel::Forward);
    let c = rays.columns_mut();
    (c.l[0], c.m[0], c.n[0]) = (-c.l[0], -c.m[0], -c.n[0]);
    tracer.trace(&mut rays, &mut work, Travel::Backward);
    let at = DVec3::from_array(rays.positions().map(|c| c[0]));
    let back = DVec3::from_array(rays.directions().map(|c| c[0]));
    assert!(
        (back + way).length() < 1e-12 && (at - DVec3::new(1.0, 2.0, -30.0)).cross(way).length() < 1e-9,
        "{at} {back}"
    );

    let end =
        |p: [f64; 3], d: [f64; 3]| traced(&porro, D_NM, &[(p.into(), d.into())])[0].map(|_| ()).expect_err("ends");
    assert_eq!(end([0.0, 50.0, -5.0], [0.0, 0.0, 1.0]), Loss::Missed);
    assert_eq!(end([11.0, 0.0, -5.0], [0.0, 0.0, 1.0]), Loss::Missed);
    assert_eq!(end([7.0, 0.0, -5.0], [0.5, 0.0, 1.0]), Loss::Vignetted);
    // Bare, two faces at normal incidence: (1 - R)^2, R = ((n - 1) / (n + 1))^2.
    let mut bare = porro.clone().with_coating(Coating::Bare);
    bare.absorption = false;
    let n = bare.index(1, D_NM);
    let part = 1.0 - ((n - 1.0) / (n + 1.0)) * ((n - 1.0) / (n + 1.0));
    let (_, _, weight) = traced(&bare, D_NM, &[(DVec3::new(0.0, 0.0, -5.0), DVec3::Z)])[0].expect("passes");
    assert!((weight - part * part).abs() < 1e-9, "{weight} {}", part * part);
    let silver = lens(&text.replace("width: 20", "width: 20, silvered: [2], reflectance: 0.9")).expect("a prism");
    let (_, _, weight) = traced(&silver, D_NM, &[(DVec3::new(0.0, 0.0, -5.0), DVec3::Z)])[0].expect("passes");
    assert!(weight < 0.9 + 1e-12 && weight > 0.85, "{weight}");
}

/// In a dispersing prism of bare glass, s and p light pass both faces with their own transmittances (Fresnel; Born and Wolf 1.5.2).
/// Unpolarized light therefore passes with the mean of the products, not the product of the means. The prism as one solid and as two tilted
/// planes agree.
#[test]
fn light_keeps_its_polarization_from_face_to_face() {
    let solid = "  - {kind: prism, apex: 60, side: 30, glass: SCHOTT/N-SF11, thickness: 150}\n";
    let mut solid = lens(solid).expect("a prism").with_coating(Coating::Bare);
    solid.absorption = false;
    let bundled = concat!(env!("CARGO_MANIFEST_DIR"), "/../../lenses/prism-60-sf11.yaml");
    let mut planes = spectra_lens::load(bundled, &FileResources::beside(std::path::Path::new(""))).expect("a lens");
    planes.absorption = false;
    let n = solid.index(1, D_NM);
    let (a, b) = ((n * 0.5).asin(), std::f64::consts::FRAC_PI_6);
    let s = 1.0 - ((a - b).sin() / (a + b).sin()).powi(2);
    let p = 1.0 - ((a - b).tan() / (a + b).tan()).powi(2);
    // At the least deviation both faces have the same angles.
    let want = 0.5 * (s * s + p * p);
    assert!(want - (0.5 * (s + p)).powi(2) > 0.01);
    for (name, lens) in [("solid", &solid), ("planes", &planes)] {
        let (_, _, weight) = traced(lens, D_NM, &[(DVec3::new(0.0, 0.0, -50.0), DVec3::Z)])[0].expect("passes");
        assert!((weight - want).abs() < 1e-5, "{name}: {weight} {want}");
    }
    // Light outside the plane of symmetry, too.
    for d in [DVec3::new(0.15, 0.02, 1.0), DVec3::new(-0.1, -0.03, 1.0)] {
        let ray = [(DVec3::new(-20.0 * d.x, -20.0 * d.y, -20.0), d)];
        let [a, b] = [&solid, &planes].map(|lens| traced(lens, D_NM, &ray)[0].expect("passes").2);
        assert!((a - b).abs() < 1e-6 && a < 1.0, "{a} {b}");
    }
}

#[test]
fn slips_are_told() {
    for (text, word) in [
        ("{kind: prism, side: 30, glass: SCHOTT/N-BK7}", "`apex` and `side`"),
        ("{kind: prism, apex: 60, side: 30}", "a prism is of glass"),
        ("{kind: prism, apex: 100, side: 30, glass: SCHOTT/N-BK7}", "the apex is too large"),
        ("{kind: prism, corners: [[1, 5], [10, 5], [5, 9]], glass: SCHOTT/N-BK7}", "does not meet the prism"),
        ("{kind: prism, corners: [[-5, 0], [5, 9], [5, 0], [-5, 9]], glass: SCHOTT/N-BK7}", "cross"),
        ("{kind: prism, corners: [[-5, 0], [-5, 0], [5, 9]], glass: SCHOTT/N-BK7}", "in the same place"),
        ("{kind: prism, apex: 60, side: 30, glass: SCHOTT/N-BK7, silvered: [4]}", "there is no face 4"),
        ("{kind: prism, apex: 60, side: 30, glass: SCHOTT/N-BK7, semi-diameter: 4}", "a prism has no `semi-diameter`"),
    ] {
        let error = lens(&format!("  - {text}\n")).map(|_| ()).expect_err(text);
        assert!(error.contains(word), "{text}: {error}");
    }
    let prism = lens("  - {kind: prism, apex: 60, side: 30, glass: SCHOTT/N-BK7, thickness: 20}\n").expect("a prism");
    assert!(prism.reversed().is_err_and(|e| e.to_string().contains("prism")));
}
