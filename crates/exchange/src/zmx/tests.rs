use crate::prescription::{
    Aperture, ApertureShape, AxisItem, CoordinateBreak, Displacement, FieldKind, Medium, Prescription, Surface,
    SurfaceShape, SystemAperture, ZernikeOrdering,
};
use spectra_core::params::Faults;

fn read(name: &str, text: &str) -> Result<Prescription, Faults> {
    super::read(name, text, &[])
}

/// Reads a file with these records in its only surface.
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
    let even =
        |coefficients: &[f64]| SurfaceShape::EvenAsphere { radius, conic: -1.0, coefficients: coefficients.to_vec() };
    for (records, shape) in [
        ("  CURV 0.02", SurfaceShape::Sphere { radius }),
        ("  TYPE STANDARD\n  CURV 0.02\n  CONI -1", SurfaceShape::Conic { radius, conic: -1.0 }),
        ("  TYPE EVENASPH\n  CURV 0.02\n  CONI -1\n  PARM 1 1e-3\n  PARM 2 2e-5\n  PARM 3 0", even(&[1e-3, 2e-5])),
        (
            "  TYPE ODDASPHE\n  CURV 0.02\n  PARM 3 1e-4",
            SurfaceShape::OddAsphere { radius, conic: 0.0, coefficients: vec![0.0, 0.0, 1e-4] },
        ),
        // a_2 (r/10)^2 + a_4 (r/10)^4.
        (
            "  TYPE XASPHERE\n  CURV 0.02\n  CONI -1\n  XDAT 1 2\n  XDAT 2 10\n  XDAT 3 0.5\n  XDAT 4 2",
            even(&[5e-3, 2e-4]),
        ),
        // Its parameters are those of an even asphere, for the same powers.
        (
            "  TYPE XASPHERE\n  CURV 0.02\n  CONI -1\n  PARM 1 1e-3\n  PARM 3 1e-7\n  XDAT 1 2\n  XDAT 2 10\n  XDAT 3 0.5\n  XDAT 4 2",
            even(&[6e-3, 2e-4, 1e-7]),
        ),
        ("  TYPE XASPHERE\n  CURV 0.02\n  CONI -1\n  PARM 2 2e-5", even(&[0.0, 2e-5])),
        // a_1 (r/10) + a_3 (r/10)^3.
        (
            "  TYPE XOSPHERE\n  CURV 0.02\n  XDAT 1 3\n  XDAT 2 10\n  XDAT 3 0.5\n  XDAT 5 2",
            SurfaceShape::OddAsphere { radius, conic: 0.0, coefficients: vec![0.05, 0.0, 2e-3] },
        ),
        ("  TYPE TOROIDAL\n  CURV 0.02\n  PARM 1 0", SurfaceShape::Cylinder { radius, along_x: true }),
        ("  TYPE TOROIDAL\n  CURV 0\n  PARM 1 30", SurfaceShape::Cylinder { radius: 30.0, along_x: false }),
        (
            "  TYPE TOROIDAL\n  CURV 0.02\n  PARM 1 30\n  PARM 3 1e-6",
            SurfaceShape::Toroid { radius, conic: 0.0, coefficients: vec![0.0, 1e-6], rotation_radius: 30.0 },
        ),
        (
            "  TYPE BICONICX\n  CURV 0.02\n  CONI 0.5\n  PARM 1 0\n  PARM 2 -1",
            SurfaceShape::Biconic { radius_x: f64::INFINITY, radius_y: radius, conic_x: -1.0, conic_y: 0.5 },
        ),
        ("  TYPE TILTSURF\n  PARM 1 0.25\n  PARM 2 -0.5", SurfaceShape::TiltedPlane { tan_x: 0.25, tan_y: -0.5 }),
        ("  TYPE PARAXIAL\n  PARM 1 80\n  PARM 2 1", SurfaceShape::ThinLens { focal_length: 80.0 }),
        (
            "  TYPE DGRATING\n  CURV 0.02\n  PARM 1 0.6\n  PARM 2 -1",
            SurfaceShape::Grating { lines_per_mm: 600.0, order: -1.0, radius, conic: 0.0, direction_deg: 0.0 },
        ),
        (
            "  TYPE FZERNSAG\n  CURV 0.02\n  XDAT 1 3\n  XDAT 2 12\n  XDAT 5 1e-4",
            SurfaceShape::Zernike {
                radius,
                conic: 0.0,
                normalization_radius: 12.0,
                coefficients: vec![0.0, 0.0, 1e-4],
                ordering: ZernikeOrdering::Fringe,
            },
        ),
    ] {
        let lens = with("", &format!("{records}\n  GLAS N-BK7 0 0 1.5 40"));
        assert_eq!(lens.surfaces().next().expect("a surface").shape, shape, "{records}");
        let grating = matches!(shape, SurfaceShape::Grating { .. });
        assert!(grating || lens.left_out.is_empty(), "{:?}", lens.left_out);
    }
    let lens = with("", "  TYPE BINARY_2\n  CURV 0.02");
    assert_eq!(lens.surfaces().next().expect("a surface").shape, SurfaceShape::Sphere { radius });
    assert!(altering(&lens)[0].contains("BINARY_2"));
}

/// Sets each value of each type to something else in turn: either the surface changes, or a note is added. The exceptions, which change
/// neither, are listed.
#[test]
fn no_number_of_a_surface_is_passed_over() {
    const TYPES: [&str; 15] = [
        "STANDARD", "EVENASPH", "ODDASPHE", "XASPHERE", "XOSPHERE", "TOROIDAL", "BICONICX", "TILTSURF", "PARAXIAL",
        "DGRATING", "SZERNSAG", "FZERNSAG", "COORDBRK", "BINARY_2", "IRREGULA",
    ];
    // Exceptions: how optical paths are counted; a normalization that no term uses, or the term's own; the number of terms beyond those
    // stated; and how far a sag extends beyond its radius.
    let means_nothing = |kind: &str, keyword: &str, at: u32| match (kind, keyword) {
        ("PARAXIAL", "PARM") => at == 2,
        ("SZERNSAG" | "FZERNSAG", "PARM") => at == 0,
        ("TOROIDAL", "XDAT") => at <= 2,
        _ => false,
    };
    let base = |kind: &str| {
        let own = match kind {
            "PARAXIAL" => "  PARM 1 80\n",
            "DGRATING" => "  PARM 1 0.6\n  PARM 2 1\n",
            "XASPHERE" | "XOSPHERE" | "SZERNSAG" | "FZERNSAG" => "  XDAT 1 6\n  XDAT 2 10\n  XDAT 3 0.1\n",
            _ => "",
        };
        format!("  TYPE {kind}\n  CURV 0.02\n  DISZ 5\n  GLAS ___BLANK 1 0 1.6 50 0.01 0 0 0 0 0\n{own}")
    };
    let told = |lens: &Prescription| altering(lens).into_iter().map(str::to_owned).collect::<Vec<_>>();
    let mut wrong = Vec::new();
    for kind in TYPES {
        let before = with("", &base(kind));
        let mut changes: Vec<(String, bool)> =
            ["CURV 0.03", "DISZ 6", "CONI -0.5", "GLAS ___BLANK 1 0 1.7 50 0.01", "GLAS ___BLANK 1 0 1.6 40 0.01"]
                .iter()
                .map(|record| ((*record).to_owned(), kind == "COORDBRK" && !record.starts_with("DISZ")))
                .collect();
        changes.push(("GLAS ___BLANK 1 0 1.6 50 0.02".to_owned(), kind == "COORDBRK"));
        // A tilted plane, an ideal lens and a coordinate break have no curvature.
        let flat = ["PARAXIAL", "TILTSURF"].contains(&kind);
        changes
            .iter_mut()
            .filter(|(r, _)| flat && (r.starts_with("CURV") || r.starts_with("CONI")))
            .for_each(|c| c.1 = true);
        for at in 0..=14 {
            changes.push((format!("PARM {at} 0.003"), means_nothing(kind, "PARM", at)));
            changes.push((format!("PARM {at} 0..3"), false));
            changes.push((format!("XDAT {at} 0.003"), means_nothing(kind, "XDAT", at)));
        }
        for (record, is_excused) in changes {
            let after = with("", &format!("{}  {record}\n", base(kind)));
            // An unknown type is noted once as a whole.
            let is_told = told(&after) != told(&before) || told(&after).iter().any(|text| text.contains("is unknown"));
            if !is_excused && after.items == before.items && !is_told {
                wrong.push(format!("{kind}: {record}"));
            }
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

/// Values that are not numbers are noted, or refused if there is no lens without them.
#[test]
fn words_among_numbers_are_told() {
    for record in ["CURV 0.0x2", "DISZ five", "GLAS ___BLANK 1 0 1,6 50"] {
        let text = format!("SURF 0\n  DISZ INFINITY\nSURF 1\n  {record}\nSURF 2\n");
        let message = read("x.zmx", &text).unwrap_err().to_string();
        assert!(message.contains("x.zmx:4:") && message.contains("is not a number"), "{message}");
    }
    for record in [
        "CONI x",
        "PARM 1 x",
        "PARM x 1",
        "XDAT 3 x",
        "DIAM x",
        "MEMA x",
        "CLAP 0 x 0",
        "OBDC x 0",
        "GLAS ___BLANK 1 0 1.6 50 x",
        "GLAS N-BK7 0 0 x",
        "SCBD 1 0 0 x 0 0 0 0",
    ] {
        let lens = with("", &format!("  CURV 0.02\n  {record}"));
        assert!(!altering(&lens).is_empty(), "{record}");
    }
}

/// The shapes of object and image are noted.
#[test]
fn forms_of_object_and_image_are_told() {
    let lens = |object: &str, image: &str| {
        let text = format!("SURF 0\n{object}\nSURF 1\n  CURV 0.02\nSURF 2\n{image}\n");
        read("x.zmx", &text).unwrap_or_else(|faults| panic!("{faults}"))
    };
    assert!(altering(&lens("  DISZ 100", "  CURV 0")).is_empty());
    for (object, image) in [
        ("  PARM 1 0.5", ""),
        ("  XDAT 3 0.5", ""),
        ("", "  PARM 1 0.5"),
        ("", "  TYPE EVENASPH\n  PARM 2 1e-4"),
        ("", "  CURV 0.01\n  CONI -1"),
    ] {
        assert!(!altering(&lens(object, image)).is_empty(), "{object}{image}");
    }
}

/// Behind a lens that is tilted about a point in front of it, the file returns to that point by gaps against the light. These are moves of
/// the axis, and no surface is met there.
#[test]
fn gaps_against_the_light_are_moves() {
    let glass = "GLAS N-BK7 0 0 1.5168 64.17";
    let text = format!(
        "SURF 0\nSURF 1\n  TYPE COORDBRK\n  PARM 3 5\n  DISZ 8\nSURF 2\n  CURV 0.02\n  DISZ 4\n  {glass}\nSURF 3\n  DISZ -4\n\
         SURF 4\n  DISZ -8\nSURF 5\n  TYPE COORDBRK\n  PARM 3 -5\n  DISZ 108\nSURF 6\n"
    );
    let lens = read("x", &text).expect("a lens");
    let steps: Vec<f64> = lens.items.iter().map(AxisItem::thickness_mm).collect();
    assert_eq!((steps, lens.surfaces().count()), (vec![8.0, 4.0, 0.0, -12.0, 108.0], 2));
    // Behind a mirror light runs the other way.
    let mirror = "SURF 0\nSURF 1\n  GLAS MIRROR\n  DISZ -5\nSURF 2\n  DISZ -40\nSURF 3\n";
    assert_eq!(read("x", mirror).expect("a lens").surfaces().count(), 2);
}

/// An index of -1 reflects, as the name `MIRROR` does.
#[test]
fn an_index_of_minus_one_is_a_mirror() {
    let by_index = surface("", "  CURV -0.005\n  GLAS ___BLANK 1 0 -1 0 0 0 0 0 0 0");
    assert!(by_index.mirror);
    assert_eq!(by_index, surface("", "  CURV -0.005\n  GLAS MIRROR 0 0 1.5 40 0 0 0 0 0 0"));
}

/// Checks the definition of relative partial dispersion: (ng - nF) / (nF - nC) = 0.6438 - 0.001682 Vd + deviation. The deviation survives
/// writing and reading back.
#[test]
fn a_model_glass_keeps_its_partial_dispersion() {
    for (nd, vd, off) in [(1.528_554, 76.975_515, 0.0258), (1.558_361, 54.157_173, -0.01)] {
        let lens = with("", &format!("  CURV 0.02\n  GLAS ___BLANK 1 0 {nd} {vd} {off} 0 0 0 0 0"));
        let Medium::Model { ng: Some(ng), .. } = lens.surfaces().next().expect("a surface").medium else {
            panic!("no ng")
        };
        let nf = spectra_glass::Medium::from_nd_vd(nd, vd).expect("a glass").index(486.1327);
        let partial = (ng - nf) / ((nd - 1.0) / vd);
        assert!((partial - (0.6438 - 0.001_682 * vd + off)).abs() < 2e-6, "{partial}");
        let again = read("x", &super::write(&lens).text).expect("a lens");
        assert_eq!(again.surfaces().next().map(|s| &s.medium), lens.surfaces().next().map(|s| &s.medium));
    }
}

/// A lens in inches is the same lens in millimeters: the sag of every term scales like a length.
#[test]
fn units_scale_every_term() {
    let records = "  TYPE EVENASPH\n  CURV 0.02\n  PARM 1 1e-3\n  PARM 2 2e-5\n  DISZ 2\n  DIAM 3\n  CLAP 0 2.5 0";
    let found = surface("UNIT IN X W X CM MR CPMM", records);
    let SurfaceShape::EvenAsphere { radius, coefficients, .. } = &found.shape else { panic!("{:?}", found.shape) };
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
fn apertures_clip_and_chosen_sizes_do_not() {
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
    assert_eq!(surface("FLOA", "  STOP\n  DIAM 4").semi_diameter_mm, Some(4.0));
}

/// A typed-in size is that of a rim if the surface bends light and has no aperture.
#[test]
fn typed_sizes_clip_where_light_is_bent() {
    let sizes = |records: &str| {
        let found = surface("", records);
        (found.semi_diameter_mm, found.outer_semi_diameter_mm)
    };
    let glass = "  CURV 0.02\n  GLAS N-BK7 0 0 1.5 40\n";
    assert_eq!(sizes(&format!("{glass}  DIAM 10 1 0 0 1 \"\"")), (Some(10.0), None));
    assert_eq!(sizes(&format!("{glass}  DIAM 10 0 0 0 1 \"\"")), (None, Some(10.0)));
    assert_eq!(sizes(&format!("{glass}  DIAM 10 1\n  CLAP 0 8 0")), (Some(8.0), Some(10.0)));
    assert_eq!(sizes(&format!("{glass}  DIAM 10 1\n  USAP 0 0 0")), (None, Some(10.0)));
    assert_eq!(sizes("  GLAS MIRROR\n  DIAM 10 1"), (Some(10.0), None));
    assert_eq!(sizes("  TYPE PARAXIAL\n  PARM 1 80\n  DIAM 10 1"), (Some(10.0), None));
    assert_eq!(sizes("  DIAM 10 1"), (None, Some(10.0)), "a plane in air");
    let behind = "SURF 0\nSURF 1\n  GLAS N-BK7\n  DISZ 2\nSURF 2\n  DIAM 7 1\nSURF 3\n";
    let lens = read("x", behind).expect("a lens");
    assert_eq!(lens.surfaces().nth(1).and_then(|s| s.semi_diameter_mm), Some(7.0), "from glass into air");
    // The edge of an element does not become a rim when it is written and read back.
    for records in [format!("{glass}  DIAM 10 0"), format!("{glass}  DIAM 10 1\n  MEMA 12")] {
        let lens = with("", &records);
        let again = read("x", &super::write(&lens).text).expect("a lens");
        let sizes =
            |lens: &Prescription| lens.surfaces().next().map(|s| (s.semi_diameter_mm, s.outer_semi_diameter_mm));
        assert_eq!(sizes(&again), sizes(&lens), "{records}");
    }
}

/// An ideal lens of 100 mm stands 20 mm in front of its stop. A ray parallel to the axis is at 0.8 of its height there. One from 300 mm in
/// front comes down from 300 u at a slope of 2 u.
#[test]
fn the_beam_sizes_the_stop() {
    let lens = |system: &str, object: &str, stop: &str| {
        let text = format!(
            "{system}\nSURF 0\n  DISZ {object}\nSURF 1\n  TYPE PARAXIAL\n  PARM 1 100\n  DISZ 20\nSURF 2\n{stop}\n  DISZ 80\nSURF 3\n"
        );
        read("x.zmx", &text).unwrap_or_else(|faults| panic!("{faults}"))
    };
    let stop = |lens: &Prescription| lens.surfaces().nth(1).and_then(|surface| surface.semi_diameter_mm);
    for (system, object, wanted) in [
        ("ENPD 10", "INFINITY", 4.0),
        ("ENPD 10", "300", 4.0),
        ("UNIT IN\nENPD 10", "INFINITY", 4.0 * 25.4),
        ("FNUM 10 0", "INFINITY", 4.0),
        ("FNUM 10 1", "INFINITY", 4.0),
        ("FNUM 10 0", "300", 4.0),
        ("FNUM 10 1", "300", 6.5),
        ("OBNA 0.05 0", "300", 260.0 * 0.05 / (1.0_f64 - 0.0025).sqrt()),
        ("OBNA 30 1", "300", 260.0 / 3.0_f64.sqrt()),
    ] {
        let found = lens(system, object, "  STOP");
        let size = stop(&found).unwrap_or_else(|| panic!("{system}: {:?}", found.left_out));
        assert!((size / wanted - 1.0).abs() < 1e-9, "{system}, {object}: {size} {wanted}");
        assert!(found.left_out.is_empty() && found.remarks[0].contains("marginal ray"), "{:?}", found.remarks);
    }
    // The narrower size limits the light; the wider one is the edge of the element.
    assert_eq!(stop(&lens("ENPD 10", "INFINITY", "  STOP\n  CLAP 0 3 0")), Some(3.0));
    let wide = lens("ENPD 10", "INFINITY", "  STOP\n  CLAP 0 6.95 0");
    assert_eq!((stop(&wide), wide.surfaces().nth(1).and_then(|s| s.outer_semi_diameter_mm)), (Some(4.0), Some(6.95)));
    assert_eq!(stop(&lens("ENPD 10", "INFINITY", "  STOP\n  CLAP 0 4.0002 0")), Some(4.0002), "the same, rounded");
    for (system, surface, word) in [
        (
            "ENPD 10",
            "",
            "the entrance pupil diameter of 10 mm does not limit the light: no surface is the stop; write STOP",
        ),
        ("OBNA 0.1 0", "  STOP", "the object is at infinity"),
        ("ENPD 10", "  STOP\n  GLAS NOBODYS", "the index of NOBODYS is not known"),
        ("FLOA", "  STOP", "FLOA: the stop states no size"),
        ("ENPD 10", "  STOP\n  SCBD 1 0 0 2 0 0 0 0", "decentered"),
    ] {
        let found = lens(system, "INFINITY", surface);
        let told = found.left_out.iter().find(|note| note.alters && note.text.contains(word));
        assert!(told.is_some_and(|note| note.line == 1), "{system}: {:?}", found.left_out);
        assert!(stop(&found).is_none());
    }
}

/// A lens limited by its rims is written with the beam that they let pass, and read back with its stop as open as before.
#[test]
fn an_open_stop_stays_open() {
    let mut lens = with("", "  CURV 0.02\n  GLAS N-BK7\n  DISZ 5\n  STOP\n  CLAP 0 9 0");
    lens.items.push(AxisItem::Surface(Box::new(Surface {
        shape: SurfaceShape::Stop,
        stop: true,
        ..Surface::default()
    })));
    let AxisItem::Surface(first) = &mut lens.items[0] else { panic!("a surface") };
    first.stop = false;
    lens.system_aperture = Some(SystemAperture::EntrancePupilDiameter(10.0));
    let again = read("x", &super::write(&lens).text).expect("a lens");
    let sizes: Vec<Option<f64>> = again.surfaces().map(|surface| surface.semi_diameter_mm).collect();
    assert_eq!((sizes, again.remarks), (vec![Some(9.0), None], vec![]));
}

#[test]
fn glasses_by_name_figures_and_pickup() {
    let medium = |system: &str, glass: &str| surface(system, &format!("  CURV 0.01\n  GLAS {glass}")).medium;
    let named = |name: &str| Medium::Glass { name: name.to_owned(), nd: None, vd: None };
    assert_eq!(medium("GCAT SCHOTT", "N-BK7 0 0 1.5 40 0 0 0"), named("SCHOTT/N-BK7"));
    assert_eq!(medium("GCAT HOYA SCHOTT", "F2 0 0 1.5 40"), named("HOYA/F2"));
    assert_eq!(medium("GCAT SCHOTT HOYA", "F2 0 0 1.5 40"), named("SCHOTT/F2"));
    assert_eq!(medium("", "___BLANK 1 0 1.6 50"), Medium::Model { nd: 1.6, vd: Some(50.0), ng: None });
    assert_eq!(medium("", "___BLANK 1 0 1.6 0"), Medium::Model { nd: 1.6, vd: None, ng: None });
    assert_eq!(medium("", "___BLANK 1 0 1.0 0"), Medium::Air);
    assert_eq!(medium("", "NOBODYS 0 0 1.7 30"), Medium::Model { nd: 1.7, vd: Some(30.0), ng: None });
    assert_eq!(medium("", "NOBODYS 0 0 1.5 40"), Medium::Unknown { name: "NOBODYS".to_owned() });
    assert_eq!(altering(&with("", "  GLAS NOBODYS 0 0 1.5 40")).len(), 1);
    let text = "SURF 0\nSURF 1\n  GLAS N-BK7\n  DISZ 1\nSURF 2\n  GLAS ___BLANK 2 1 1.5 40\nSURF 3\n";
    let lens = read("x", text).expect("a lens");
    assert_eq!(lens.surfaces().nth(1).map(|s| s.medium.clone()), Some(named("SCHOTT/N-BK7")));
}

/// A mirror keeps the medium in front of it, and so does a break.
#[test]
fn mirrors_and_breaks() {
    let text = "SURF 0\nSURF 1\n  CURV 0.01\n  GLAS N-BK7\n  DISZ 5\nSURF 2\n  TYPE COORDBRK\n  PARM 1 1\n  PARM 3 45\n  PARM 5 -2\n  PARM 6 1\n  DISZ 3\n\
                SURF 3\n  GLAS MIRROR 0 0 1.5 40\n  DISZ -5\nSURF 4\n  STOP\n  DISZ -40\nSURF 5\n  CURV 0.001\n";
    let lens = read("x", text).expect("a lens");
    let by = Displacement { decenter_mm: [1.0, 0.0], tilt_deg: [45.0, 0.0, -2.0] };
    assert_eq!(lens.items[1], AxisItem::Break(CoordinateBreak { by, tilt_first: true, thickness_mm: 3.0 }));
    let surfaces: Vec<&Surface> = lens.surfaces().collect();
    assert!(surfaces[1].mirror && surfaces[1].medium == surfaces[0].medium);
    // From glass into air: a plane that refracts, and therefore not a mere stop.
    assert!(surfaces[2].stop && surfaces[2].shape == SurfaceShape::Plane);
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

/// Follows the hint on how to clip, and checks that the surface clips.
#[test]
fn hints_help_when_followed() {
    let hint = crate::Format::Zmx.how_to_clip();
    let glass = "  STOP\n  CURV 0.02\n  GLAS N-BK7";
    for (shown, system, record) in [
        ("`CLAP 0 RADIUS 0`", "", "  CLAP 0 7 0"),
        ("`DIAM RADIUS 1`", "", "  DIAM 7 1"),
        ("`ENPD DIAMETER`", "ENPD 14", ""),
    ] {
        assert!(hint.contains(shown), "{hint}");
        assert_eq!(surface(system, &format!("{glass}\n{record}")).semi_diameter_mm, Some(7.0), "{shown}");
    }
}
