//! Tests the object point of an image point, by real rays.

use glam::DVec3;
use spectra_analysis::AnalysisLight;
use spectra_analysis::focus::conjugate;
use spectra_lens::Lens;
use spectra_optics::stop_down;
use spectra_plugins as _;
use spectra_scene::FileResources;
use std::path::Path;

fn slow_lens() -> Lens {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("lenses/zeiss-biotar-50-f1.4.yaml");
    let lens = spectra_lens::load(&path.to_string_lossy(), &FileResources::beside(Path::new("."))).expect("a lens");
    stop_down(lens, 22.0).expect("f/22")
}

const LIGHT: AnalysisLight = AnalysisLight::Wavelength(587.5618);

/// On the axis, paraxial optics applies: an image plane at the image of an object gives back the object.
#[test]
fn the_axis_is_paraxial() {
    for object_mm in [400.0, 1500.0, 20_000.0] {
        let lens = slow_lens();
        let gap = lens.paraxial_image_gap_mm(object_mm, 587.5618);
        let found = conjugate(&lens.with_image_gap_mm(gap), LIGHT, DVec3::ZERO).expect("media").expect("light");
        // The spherical aberration that remains at f/22 moves the focus by a few micrometers, a vergence below 2e-6 per mm.
        assert!((1.0 / found.distance_mm - 1.0 / object_mm).abs() < 3e-6, "{object_mm}: {found:?}");
        assert!(found.direction.z < -0.999_999 && found.point_mm.truncate().length() < 1e-6 * object_mm);
    }
}

/// Scheimpflug's rule: the objects of a tilted image plane lie on a plane, which meets the image plane in the principal planes. With
/// object distances a from the front principal plane and image distances a' behind the rear one, points obey 1/a + 1/a' = 1/f and y =
/// -y' a / a'.
#[test]
fn a_tilted_image_has_a_tilted_object() {
    let lens = slow_lens();
    let first = lens.first_order(587.5618);
    let gap = lens.paraxial_image_gap_mm(1500.0, 587.5618);
    let lens = lens.with_image_gap_mm(gap);
    let tilt = 5.0_f64.to_radians();
    let points: Vec<(f64, DVec3)> = [-6.0, -3.0, 0.0, 3.0, 6.0]
        .iter()
        .map(|along: &f64| {
            let image = DVec3::new(0.0, along * tilt.cos(), along * tilt.sin());
            let found = conjugate(&lens, LIGHT, image).expect("media").expect("light");
            (*along, found.point_mm)
        })
        .collect();
    for (along, point) in &points {
        let image_mm = lens.image_z_mm() + along * tilt.sin() - first.rear_principal_z_mm;
        let object_mm = 1.0 / (1.0 / first.efl_mm - 1.0 / image_mm);
        let height_mm = -along * tilt.cos() * object_mm / image_mm;
        let (got_mm, got_height) = (first.front_principal_z_mm - point.z, point.y);
        // The field of the Biotar is curved by a few hundredths of a millimeter at 6 mm: 2e-5 per mm in vergence.
        assert!((1.0 / got_mm - 1.0 / object_mm).abs() < 2e-5, "{along}: {got_mm} {object_mm}");
        assert!((got_height / got_mm - height_mm / object_mm).abs() < 2e-3, "{along}: {got_height} {height_mm}");
    }
    // The object plane leans far more than field curvature explains, and in the right direction.
    assert!(points[0].1.z < points[2].1.z - 50.0 || points[0].1.z > points[2].1.z + 50.0, "{points:?}");
}

/// A point outside the illuminated field has no object.
#[test]
fn a_dark_point_has_no_object() {
    assert_eq!(conjugate(&slow_lens(), LIGHT, DVec3::new(0.0, 200.0, 0.0)).expect("media"), None);
}
