use super::read;
use crate::prescription::{
    Aperture, ApertureShape, CoordinateBreak, Displacement, FieldKind, Item, Medium, Ordering, Prescription, Shape,
    Surface, SystemAperture,
};

/// A file with these records in its one surface.
fn with(system: &str, surface: &str) -> Prescription {
    let text = format!("{system}\nSURF 0\n  DISZ INFINITY\nSURF 1\n{surface}\nSURF 2\n  CURV 0\n");
    read("x.zmx", &text).unwrap_or_else(|faults| panic!("{faults}"))
}

fn surface(system: &str, records: &str) -> Surface {
    with(system, records).surfaces().next().expect("a surface").clone()
}

fn altering(lens: &Prescription) -> Vec<&str> {
    lens.left_out.iter().filter(|note| note.alters).map(|note| note.text.as_str()).collect()
}

#[test]
fn every_type_has_its_form() {
    let radius = 50.0;
    let even = |coefficients: &[f64]| Shape::EvenAsphere { radius, conic: -1.0, coefficients: coefficients.to_vec() };
    for (records, shape) in [
        ("  CURV 0.02", Shape::Sphere { radius }),
        ("  TYPE STANDARD\n  CURV 0.02\n  CONI -1", Shape::Conic { radius, conic: -1.0 }),
        ("  TYPE EVENASPH\n  CURV 0.02\n  CONI -1\n  PARM 1 1e-3\n  PARM 2 2e-5\n  PARM 3 0", even(&[1e-3, 2e-5])),
        (
            "  TYPE ODDASPHE\n  CURV 0.02\n  PARM 3 1e-4",
            Shape::OddAsphere { radius, conic: 0.0, coefficients: vec![0.0, 0.0, 1e-4] },
        ),
        // a_2 (r/10)^2 + a_4 (r/10)^4.
        (
            "  TYPE XASPHERE\n  CURV 0.02\n  CONI -1\n  XDAT 1 2\n  XDAT 2 10\n  XDAT 3 0.5\n  XDAT 4 2",
            even(&[5e-3, 2e-4]),
        ),
        ("  TYPE TOROIDAL\n  CURV 0.02\n  PARM 1 0", Shape::Cylinder { radius, along_x: true }),
        ("  TYPE TOROIDAL\n  CURV 0\n  PARM 1 30", Shape::Cylinder { radius: 30.0, along_x: false }),
        (
            "  TYPE TOROIDAL\n  CURV 0.02\n  PARM 1 30\n  PARM 3 1e-6",
            Shape::Toroid { radius, conic: 0.0, coefficients: vec![0.0, 1e-6], rotation_radius: 30.0 },
        ),
        (
            "  TYPE BICONICX\n  CURV 0.02\n  CONI 0.5\n  PARM 1 0\n  PARM 2 -1",
            Shape::Biconic { radius_x: f64::INFINITY, radius_y: radius, conic_x: -1.0, conic_y: 0.5 },
        ),
        ("  TYPE TILTSURF\n  PARM 1 0.25\n  PARM 2 -0.5", Shape::TiltedPlane { tan_x: 0.25, tan_y: -0.5 }),
        ("  TYPE PARAXIAL\n  PARM 1 80\n  PARM 2 1", Shape::ThinLens { focal_length: 80.0 }),
        (
            "  TYPE DGRATING\n  CURV 0.02\n  PARM 1 0.6\n  PARM 2 -1",
            Shape::Grating { lines_per_mm: 600.0, order: -1.0, radius, conic: 0.0, direction_deg: 0.0 },
        ),
        (
            "  TYPE FZERNSAG\n  CURV 0.02\n  XDAT 1 3\n  XDAT 2 12\n  XDAT 5 1e-4",
            Shape::Zernike {
                radius,
                conic: 0.0,
                normalization_radius: 12.0,
                coefficients: vec![0.0, 0.0, 1e-4],
                ordering: Ordering::Fringe,
            },
        ),
    ] {
        let lens = with("", &format!("{records}\n  GLAS N-BK7 0 0 1.5 40"));
        assert_eq!(lens.surfaces().next().expect("a surface").shape, shape, "{records}");
        let grating = matches!(shape, Shape::Grating { .. });
        assert!(grating || lens.left_out.is_empty(), "{:?}", lens.left_out);
    }
    let lens = with("", "  TYPE BINARY_2\n  CURV 0.02");
    assert_eq!(lens.surfaces().next().expect("a surface").shape, Shape::Sphere { radius });
    assert!(altering(&lens)[0].contains("BINARY_2"));
}

/// A lens in inches is the same lens in millimeters: the sag of every term scales like a length.
#[test]
fn units_scale_every_term() {
    let records = "  TYPE EVENASPH\n  CURV 0.02\n  PARM 1 1e-3\n  PARM 2 2e-5\n  DISZ 2\n  DIAM 3\n  CLAP 0 2.5 0";
    let found = surface("UNIT IN X W X CM MR CPMM", records);
    let Shape::EvenAsphere { radius, coefficients, .. } = &found.shape else { panic!("{:?}", found.shape) };
    assert_eq!((*radius, found.thickness_mm), (1270.0, 50.8));
    let (r_in, inch) = (1.5_f64, 25.4_f64);
    for (at, in_inches) in [(0, 1e-3 * r_in.powi(2)), (1, 2e-5 * r_in.powi(4))] {
        let mm = coefficients[at] * (r_in * inch).powi(2 * (at as i32 + 1));
        assert!((mm / inch / in_inches - 1.0).abs() < 1e-14, "{mm}");
    }
    assert_eq!((found.semi_diameter_mm, found.outer_semi_diameter_mm), (Some(63.5), Some(3.0 * 25.4)));
    for (unit, mm) in [("MM", 2.0), ("CM", 20.0), ("METER", 2000.0)] {
        assert_eq!(surface(&format!("UNIT {unit}"), records).thickness_mm, mm);
    }
    assert!(read("x", "UNIT FURLONG\nSURF 0\nSURF 1\nSURF 2\n").unwrap_err().to_string().contains("x:1:6"));
}

#[test]
fn apertures_clip_and_sizes_do_not() {
    let aperture = |shape, center_mm, obscures| Aperture { shape, center_mm, obscures };
    let ring = |inner, outer| ApertureShape::Ring { inner, outer };
    let found = surface("", "  DIAM 10 0 0 0 1 \"\"");
    assert_eq!((found.semi_diameter_mm, found.outer_semi_diameter_mm), (None, Some(10.0)));
    let found = surface("", "  DIAM 10 1\n  FLAP 0 10 0");
    assert_eq!((found.semi_diameter_mm, found.outer_semi_diameter_mm), (Some(10.0), None));
    let found = surface("", "  DIAM 10\n  MEMA 12\n  FLAP 0 0 0");
    assert_eq!((found.semi_diameter_mm, found.outer_semi_diameter_mm), (Some(10.0), Some(12.0)));
    for (records, wanted) in [
        ("  CLAP 2 10 0", aperture(ring(2.0, 10.0), [0.0; 2], false)),
        ("  CLAP 0 10 0\n  OBDC 1 -2", aperture(ring(0.0, 10.0), [1.0, -2.0], false)),
        ("  OBSC 0 3 0", aperture(ring(0.0, 3.0), [0.0; 2], true)),
        ("  SQAP 3 2 0", aperture(ApertureShape::Rectangle { half_width: 3.0, half_height: 2.0 }, [0.0; 2], false)),
        ("  ELOB 3 2 0", aperture(ApertureShape::Ellipse { half_width: 3.0, half_height: 2.0 }, [0.0; 2], true)),
    ] {
        assert_eq!(surface("", records).apertures, [wanted], "{records}");
    }
    assert_eq!(altering(&with("", "  USAP 0 0 0")).len(), 1);
    assert_eq!(altering(&with("", "  SQAP 3 0 0")).len(), 1);
    assert!(surface("ENPD 5", "  STOP").semi_diameter_mm.is_none(), "a pupil chooses rays");
    assert_eq!(surface("FLOA", "  STOP\n  DIAM 4").semi_diameter_mm, Some(4.0));
}

#[test]
fn glasses_by_name_figures_and_pickup() {
    let medium = |system: &str, glass: &str| surface(system, &format!("  CURV 0.01\n  GLAS {glass}")).medium;
    let named = |name: &str| Medium::Glass { name: name.to_owned(), nd: None, vd: None };
    assert_eq!(medium("GCAT SCHOTT", "N-BK7 0 0 1.5 40 0 0 0"), named("SCHOTT/N-BK7"));
    assert_eq!(medium("GCAT HOYA SCHOTT", "F2 0 0 1.5 40"), named("HOYA/F2"));
    assert_eq!(medium("GCAT SCHOTT HOYA", "F2 0 0 1.5 40"), named("SCHOTT/F2"));
    assert_eq!(medium("", "___BLANK 1 0 1.6 50"), Medium::Model { nd: 1.6, vd: Some(50.0) });
    assert_eq!(medium("", "___BLANK 1 0 1.6 0"), Medium::Model { nd: 1.6, vd: None });
    assert_eq!(medium("", "___BLANK 1 0 1.0 0"), Medium::Air);
    assert_eq!(medium("", "NOBODYS 0 0 1.7 30"), Medium::Model { nd: 1.7, vd: Some(30.0) });
    assert_eq!(medium("", "NOBODYS 0 0 1.5 40"), Medium::Unknown { name: "NOBODYS".to_owned() });
    assert_eq!(altering(&with("", "  GLAS NOBODYS 0 0 1.5 40")).len(), 1);
    let text = "SURF 0\nSURF 1\n  GLAS N-BK7\n  DISZ 1\nSURF 2\n  GLAS ___BLANK 2 1 1.5 40\nSURF 3\n";
    let lens = read("x", text).expect("a lens");
    assert_eq!(lens.surfaces().nth(1).map(|s| s.medium.clone()), Some(named("SCHOTT/N-BK7")));
}

/// A mirror keeps the medium that it stands in, a break too.
#[test]
fn mirrors_and_breaks() {
    let text = "SURF 0\nSURF 1\n  CURV 0.01\n  GLAS N-BK7\n  DISZ 5\nSURF 2\n  TYPE COORDBRK\n  PARM 1 1\n  PARM 3 45\n  PARM 5 -2\n  PARM 6 1\n  DISZ 3\n\
                SURF 3\n  GLAS MIRROR 0 0 1.5 40\n  DISZ -5\nSURF 4\n  STOP\n  DISZ -40\nSURF 5\n  CURV 0.001\n";
    let lens = read("x", text).expect("a lens");
    let by = Displacement { decenter_mm: [1.0, 0.0], tilt_deg: [45.0, 0.0, -2.0] };
    assert_eq!(lens.items[1], Item::Break(CoordinateBreak { by, tilt_first: true, thickness_mm: 3.0 }));
    let surfaces: Vec<&Surface> = lens.surfaces().collect();
    assert!(surfaces[1].mirror && surfaces[1].medium == surfaces[0].medium);
    // From glass into air: a plane that refracts, and so no mere stop.
    assert!(surfaces[2].stop && surfaces[2].shape == Shape::Plane);
    assert!(altering(&lens)[0].contains("image surface is curved"));
}

#[test]
fn what_chooses_rays_is_read() {
    let system = "NAME A lens\nFNUM 2.8 0\nFTYP 3 0 2 2 0 0 0\nXFLN 0 1\nYFLN 0 2\nWAVM 1 0.486133 1\nWAVM 2 0.587562 2\n\
                  WAVM 3 0.55 1\nPWAV 2\nVCXN 0 0.1\nENVD 35 1 1\nXYZZ 4";
    let lens = with(system, "  CURV 0.01\n  FROB 1 2\n  FROB 3 4");
    assert_eq!((lens.name.as_str(), lens.system_aperture), ("A lens", Some(SystemAperture::FNumber(2.8))));
    let fields = lens.fields.as_ref().expect("fields");
    assert_eq!((fields.kind, fields.points.as_slice()), (FieldKind::RealImageHeight, &[[0.0, 0.0], [1.0, 2.0]][..]));
    assert_eq!((lens.wavelengths.len(), lens.wavelengths[1].nm, lens.primary), (2, 587.562, Some(1)));
    let notes: Vec<String> = lens.left_out.iter().map(ToString::to_string).collect();
    for word in ["vignetting", "35 degrees", "XYZZ 4", "FROB: an unknown record of a surface (2 lines)"] {
        assert!(notes.iter().any(|note| note.contains(word)), "{word}: {notes:?}");
    }
    let configurations = read("x", "SURF 0\nSURF 1\nSURF 2\nMNUM 3 2\nTHIC 1 1 4.5\nTHIC 1 2 5.5\n").expect("a lens");
    assert!(configurations.left_out[0].text.starts_with("3 configurations: the values of number 2"));
    assert!(configurations.left_out[0].text.contains("THIC 1 1 4.5"));
}

#[test]
fn faults_have_places() {
    let text = "MODE NSC\nSURF 0\nSURF 1\n  CURV 0.0x2\n  DISZ 1..5\nSURF 2\n";
    let message = read("bad.zmx", text).unwrap_err().to_string();
    for word in
        ["bad.zmx:1:6: the mode NSC is not sequential", "bad.zmx:4:8: CURV: `0.0x2` is not a number", "bad.zmx:5:8"]
    {
        assert!(message.contains(word), "{message}");
    }
    for empty in ["", "SURF 0\nSURF 1\n", "hello"] {
        assert!(read("e.zmx", empty).unwrap_err().to_string().contains("no surfaces"));
    }
}
