use crate::prescription::{
    ApertureShape, AxisItem, CoordinateBreak, Displacement, Medium, Prescription, Surface, SurfaceShape, SystemAperture,
};
use spectra_core::params::Faults;

fn read(name: &str, text: &str) -> Result<Prescription, Faults> {
    super::read(name, text, &[])
}

fn lens(text: &str) -> Prescription {
    read("x.seq", text).unwrap_or_else(|faults| panic!("{faults}"))
}

fn first(text: &str) -> Surface {
    lens(&format!("RDM\nSO 0 1e11\n{text}\nSI 0 0\n")).surfaces().next().expect("a surface").clone()
}

#[test]
fn radii_curvatures_and_units() {
    let radius = |text: &str| match lens(text).surfaces().next().expect("a surface").shape {
        SurfaceShape::Sphere { radius } => radius,
        ref other => panic!("{other:?}"),
    };
    assert_eq!(radius("RDM;LEN\nS 50 5 NBK7_SCHOTT\nSI 0 0"), 50.0);
    assert_eq!(radius("RDM N\nS 0.02 5 NBK7_SCHOTT\nSI 0 0"), 50.0);
    assert_eq!(radius("RDM\nDIM I\nS 2 5 NBK7_SCHOTT\nSI 0 0"), 50.8);
    assert_eq!(radius("RDM N\nCUY S1 0.5\nS 1 1\nCUY S0 0.04\nSI 0 0\n").recip().abs().recip(), 25.0);
    // If the file does not say which, the values decide.
    assert_eq!(radius("S 50 5 NBK7_SCHOTT\nSI 0 0"), 50.0);
    assert_eq!(radius("S 0.02 5 NBK7_SCHOTT\nSI 0 0"), 50.0);
    assert!(lens("S 50 5\nSI 0 0").left_out.iter().any(|note| note.alters && note.text.contains("RDM is missing")));
}

#[test]
fn forms() {
    let asphere = |radius, conic, coefficients: &[f64]| SurfaceShape::EvenAsphere {
        radius,
        conic,
        coefficients: coefficients.to_vec(),
    };
    for (text, shape) in [
        ("S 50 1 NBK7_SCHOTT\n CON\n K -1", SurfaceShape::Conic { radius: 50.0, conic: -1.0 }),
        (
            "S 50 1 NBK7_SCHOTT\n ASP\n K -1; A 1e-6; B 2e-9; C 0.0; D &\n 3e-15",
            asphere(50.0, -1.0, &[0.0, 1e-6, 2e-9, 0.0, 3e-15]),
        ),
        ("S 50 1 NBK7_SCHOTT\n CYL", SurfaceShape::Cylinder { radius: 50.0, along_x: true }),
        (
            "S 50 1 NBK7_SCHOTT\n YTO\n RDX 80",
            SurfaceShape::Toroid { radius: 50.0, conic: 0.0, coefficients: vec![], rotation_radius: 80.0 },
        ),
        (
            "S 50 1 NBK7_SCHOTT\n AAS\n RDX 80\n KX -1",
            SurfaceShape::Biconic { radius_x: 80.0, radius_y: 50.0, conic_x: -1.0, conic_y: 0.0 },
        ),
    ] {
        assert_eq!(first(text).shape, shape, "{text}");
    }
    let diffractive = lens("RDM\nS 9.93 3.7 NBK7_SCHOTT\n DIF DOE\n HCO C1 -0.0018\nS 0 1\nSI 0 0");
    assert!(diffractive.left_out.iter().any(|note| note.alters && note.text.contains("DIF DOE")));
}

#[test]
fn glasses_mirrors_and_apertures() {
    let found = first("S 50 1 516800.641700\n STO\n CIR 4\n CIR EDG 5\n CIR OBS 1\n SLB \"front\"");
    assert_eq!(found.medium, Medium::Model { nd: 1.5168, vd: Some(64.17), ng: None });
    assert_eq!((found.stop, found.semi_diameter_mm, found.outer_semi_diameter_mm), (true, Some(4.0), Some(5.0)));
    assert_eq!(found.apertures[0].shape, ApertureShape::Ring { inner: 0.0, outer: 1.0 });
    assert!(found.apertures[0].obscures && found.comment == "front");
    let found = first("S -100 -50 REFL\n REX 7; REY 8; ADY 9");
    assert!(found.mirror);
    assert_eq!(found.apertures[0].shape, ApertureShape::Rectangle { half_width: 7.0, half_height: 8.0 });
    assert_eq!(found.apertures[0].center_mm, [0.0, 9.0]);
    assert_eq!(first("S 0 3\n STO").shape, SurfaceShape::Stop);
}

/// A thin lens of 100 mm in the stop, with glass of no thickness: the quantity that sets the size of the beam sets that of the stop.
#[test]
fn the_beam_sizes_the_stop() {
    let stop = |head: &str, object: &str, rim: &str| {
        let text = format!("RDM\n{head}\nSO 0 {object}\nS 100 0 1.5\n STO\n{rim}\nS -100 100\nSI 0 0\n");
        let found = lens(&text);
        assert!(found.left_out.is_empty(), "{:?}", found.left_out);
        found.surfaces().next().and_then(|surface| surface.semi_diameter_mm).expect("a size")
    };
    for (head, object, wanted) in [
        ("EPD 10", "1e11", 5.0),
        ("DIM I\nEPD 10", "1e11", 127.0),
        ("FNO 5", "1e11", 10.0),
        ("NA 0.1", "1e11", 10.0),
        // Object and image have the same size: the image is 200 mm behind the lens.
        ("FNO 5", "200", 20.0),
        ("NA 0.1", "200", 20.0),
        ("NAO 0.1", "200", 20.0 / (1.0_f64 - 0.01).sqrt()),
    ] {
        let size = stop(head, object, "");
        assert!((size / wanted - 1.0).abs() < 1e-9, "{head}: {size} {wanted}");
    }
    assert_eq!(stop("EPD 10", "1e11", " CIR 6.95"), 5.0);
    assert_eq!(stop("EPD 10", "1e11", " CIR 4"), 4.0);
    let told = lens("RDM\nEPD 10\nSO 0 1e11\nS 100 1 1.5\nS -100 100\nSI 0 0\n").left_out;
    assert!(
        told.len() == 1 && told[0].alters && told[0].line == 2 && told[0].text.contains("write STO at one"),
        "{told:?}"
    );
}

/// Tilts about x and y are left-handed in CODE V and right-handed here.
#[test]
fn decenters_of_four_sorts() {
    let items = |text: &str| lens(&format!("RDM\n{text}\nSI 0 0\n")).items;
    let by = |decenter_mm, tilt_deg| Displacement { decenter_mm, tilt_deg };
    let axis = |by, tilt_first, thickness_mm| AxisItem::Break(CoordinateBreak { by, tilt_first, thickness_mm });
    let thickness = |item: &AxisItem| item.thickness_mm();

    let basic = items("S 0 7\n XDE 1; YDE 2; ADE 10; BDE 20; CDE 30");
    assert_eq!(basic[0], axis(by([1.0, 2.0], [-10.0, -20.0, 30.0]), false, 0.0));
    assert_eq!(thickness(&basic[1]), 7.0);

    let back = items("S 0 7\n DAR; YDE 2; ADE 10; ZDE 3");
    let AxisItem::Surface(surface) = &back[1] else { panic!("{back:?}") };
    assert_eq!((surface.displacement, surface.thickness_mm), (by([0.0, 2.0], [-10.0, 0.0, 0.0]), 4.0));
    assert_eq!(thickness(&back[0]), 3.0);

    let reverse = items("S 0 7\n REV; YDE 2; ADE 10");
    assert_eq!((thickness(&reverse[0]), &reverse[1]), (0.0, &axis(by([0.0, -2.0], [10.0, 0.0, 0.0]), true, 7.0)));

    let bend = items("S 0 -7 REFL\n BEN; ADE 45");
    let turn = by([0.0; 2], [-45.0, 0.0, 0.0]);
    assert_eq!((&bend[0], thickness(&bend[1]), &bend[2]), (&axis(turn, false, 0.0), 0.0, &axis(turn, false, -7.0)));
}

#[test]
fn the_rest_is_told() {
    let found = lens(
        "RDM\nTIT 'A lens'\nEPD 5\nWL 656 588 486\nREF 2\nYAN 0 7\nSO 0 120\nS 50 5 NOBODYS_SCHOTT\nFROB 3\nSI 0 -0.25\nGO\n",
    );
    assert_eq!((found.name.as_str(), found.object_distance_mm), ("A lens", Some(120.0)));
    assert_eq!(found.system_aperture, Some(SystemAperture::EntrancePupilDiameter(5.0)));
    assert_eq!((found.wavelengths.len(), found.primary), (3, Some(1)));
    assert_eq!(found.items[0].thickness_mm(), 4.75, "defocus moves the image plane");
    let notes: Vec<String> = found.left_out.iter().filter(|n| n.alters).map(ToString::to_string).collect();
    assert!(
        notes.iter().any(|note| note.contains("NOBODYS")) && notes.iter().any(|note| note.contains("FROB 3")),
        "{notes:?}"
    );
    let message = read("bad.seq", "RDM\nS 50 5\n THI 5.x\n").unwrap_err().to_string();
    assert!(message.contains("bad.seq:3:6: `5.x` is not a number"), "{message}");
    assert!(read("bad.seq", "").unwrap_err().to_string().contains("no surfaces"));
}

/// Follows the hint on how to clip, and checks that the surface clips.
#[test]
fn hints_help_when_followed() {
    let hint = crate::Format::Seq.how_to_clip();
    assert!(["`CIR RADIUS`", "`EPD DIAMETER`", "`STO`"].iter().all(|word| hint.contains(word)), "{hint}");
    assert_eq!(first("S 50 1 NBK7_SCHOTT\n CIR 7").semi_diameter_mm, Some(7.0));
    assert_eq!(first("EPD 14\nS 50 1 NBK7_SCHOTT\n STO").semi_diameter_mm, Some(7.0));
    assert!(crate::Format::Seq.how_to_stop().contains("`STO`") && first("S 50 1 NBK7_SCHOTT\n STO").stop);
}

/// Only the radius and the thickness of a surface, without which there is no lens, may make reading fail if they are not numbers. This test
/// sets each value of each form to something else in turn, also on the object and the image surface. Either the result changes, or a note
/// is added.
#[test]
fn no_value_of_a_surface_is_passed_over() {
    const FORMS: [&str; 6] = ["", " ASP\n", " CYL\n", " YTO\n RDX 30\n", " XTO\n RDX 30\n", " AAS\n RDX 30\n"];
    const LENGTHS: [&str; 3] = ["RDY", "RDX", "THI"];
    let commands = [
        "RDY", "CUY", "RDX", "CUX", "THI", "K", "KY", "KX", "A", "B", "C", "D", "E", "F", "G", "H", "J", "XDE", "YDE",
        "ZDE", "ADE", "BDE", "CDE", "CIR", "CIR EDG", "CIR OBS", "REX", "ELY", "ARO", "CUF", "AR", "HCO 3",
    ];
    let file = |at: &str, own: &str| {
        let of = |place: &str| if place == at { own } else { "" };
        let [object, surface, image] = ["object", "surface", "image"].map(of);
        format!("RDM\nSO 0 1e13\n{object}S 50 5 NBK7_SCHOTT\n{surface}S -50 47\nSI 0 0\n{image}GO\n")
    };
    // A form that is not carried is noted once as a whole.
    let is_told = |before: &Prescription, after: &Prescription| {
        after.left_out.len() > before.left_out.len()
            || after.left_out.iter().any(|note| note.text.contains("carried by its radius in y-z"))
    };
    let mut wrong = Vec::new();
    for at in ["object", "surface", "image"] {
        for form in FORMS.iter().filter(|form| at == "surface" || form.is_empty()) {
            let before = read("x.seq", &file(at, form)).expect("a lens");
            let try_out = |statement: String, wrong: &mut Vec<String>| match read(
                "x.seq",
                &file(at, &format!("{form} {statement}\n")),
            ) {
                Ok(after) => {
                    let moved = after.items != before.items || after.object_distance_mm != before.object_distance_mm;
                    if !moved && !is_told(&before, &after) {
                        wrong.push(format!("{at}, {form:?}: {statement} is passed over"));
                    }
                }
                Err(faults) => {
                    let said = faults.to_string();
                    let is_needed = ["RDY", "CUY", "RDX", "CUX", "THI"].iter().any(|name| statement.starts_with(name));
                    if !is_needed || !said.contains("x.seq:") {
                        wrong.push(format!("{at}, {form:?}: {statement} ends it: {said}"));
                    }
                }
            };
            for command in commands {
                let value = if LENGTHS.contains(&command) { "44" } else { "0.003" };
                // Skip a conic constant of a plane and the color of a drawing, which have no effect on light.
                let means_nothing = command == "HCO 3" || command == "THI" && at == "image";
                if !means_nothing {
                    try_out(format!("{command} {value}"), &mut wrong);
                    try_out(format!("{command} {value} 7"), &mut wrong);
                    try_out(format!("{command} 0..3"), &mut wrong);
                    try_out(format!("{command} S9 {value}"), &mut wrong);
                }
            }
        }
    }
    for solve in ["THI HMY 0.0", "THI PIM", "RDY UMY -0.1"] {
        let lens = read("x.seq", &file("surface", &format!(" {solve}\n"))).expect("a lens");
        let plain = read("x.seq", &file("", "")).expect("a lens");
        let says =
            |note: &crate::Note| !note.alters && note.text.contains(solve) && note.text.contains("own line is carried");
        assert!(lens.items == plain.items && lens.left_out.iter().any(says), "{solve}: {:?}", lens.left_out);
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

#[test]
fn words_among_values_are_told() {
    let file = |surface: &str| format!("RDM\nSO 0 1e13\n{surface}\nS -50 47\nSI 0 0\nGO\n");
    for surface in [
        "S 50 5 NBK7_SCHOTT\n K x",
        "S 50 5\n A x",
        "S 50 5\n CIR x",
        "S 50 5\n CIR EDG x",
        "S 50 5\n ADE x",
        "S 50 5\n XDE 1..5",
        "EPD x\nS 50 5",
        "YAN 0 x\nS 50 5",
        "WL 587 x\nS 50 5",
    ] {
        let lens = read("x.seq", &file(surface)).unwrap_or_else(|faults| panic!("{surface}: {faults}"));
        let told = lens.left_out.iter().any(|note| note.alters && note.text.contains("is not a number"));
        assert!(told && lens.surfaces().count() == 2, "{surface}: {:?}", lens.left_out);
    }
    for surface in ["S 5..0 5", "S 50 5\n THI 5..0", "S\n RDY x\n THI 5", "S 50\n THI HMY"] {
        let faults = read("x.seq", &file(surface)).expect_err(surface).to_string();
        assert!(faults.contains("is not a number") && faults.contains("x.seq:"), "{faults}");
    }
    // A glass with a formula is no error if no surface has it.
    let private = "PRV\nPWL 550\n'GLUE' LAU 2.4 0 0.02\nEND\n";
    let lens = read("x.seq", &format!("{private}{}", file("S 50 5 NBK7_SCHOTT"))).expect("a lens");
    assert!(lens.left_out.iter().any(|note| !note.alters && note.text.contains("GLUE") && note.text.contains("LAU")));
    let lens = read("x.seq", &format!("{private}{}", file("S 50 5 'GLUE'"))).expect("a lens");
    assert!(lens.left_out.iter().any(|note| note.alters && note.text.contains("its formula is not read")));
}
