use crate::prescription::{AxisItem, Medium, Prescription, SurfaceShape};
use spectra_core::params::Faults;

fn read(name: &str, text: &str) -> Result<Prescription, Faults> {
    super::read(name, text, &[])
}

#[test]
fn a_table_of_a_patent() {
    let text = "# transcribed\nlens,surface,type,radius_mm,thickness_mm,nd_after,vd_after,glass_after,semi_diameter_mm,asphere_coefficients\n\
                a-lens,1,spherical,164.13,10.99,1.5168,64.17,N-BK7,54,\n\
                a-lens,2,stop,inf,15,1,,,25.5,\n\
                a-lens,3,aspherical,-40.42,2.74,1.6992,30.2,,0,0 1e-6\n\
                a-lens,4,cyl-y,55,50,1,,,36,\n";
    let lens = read("t.csv", text).unwrap_or_else(|faults| panic!("{faults}"));
    let surfaces: Vec<_> = lens.surfaces().collect();
    assert_eq!(lens.name, "a-lens");
    let glass = Medium::Glass { name: "SCHOTT/N-BK7".to_owned(), nd: Some(1.5168), vd: Some(64.17) };
    assert_eq!((&surfaces[0].shape, &surfaces[0].medium), (&SurfaceShape::Sphere { radius: 164.13 }, &glass));
    assert_eq!((&surfaces[1].shape, surfaces[1].semi_diameter_mm), (&SurfaceShape::Stop, Some(25.5)));
    assert_eq!(
        surfaces[2].shape,
        SurfaceShape::EvenAsphere { radius: -40.42, conic: 0.0, coefficients: vec![0.0, 1e-6] }
    );
    assert_eq!(
        (&surfaces[2].medium, surfaces[2].semi_diameter_mm),
        (&Medium::Model { nd: 1.6992, vd: Some(30.2), ng: None }, None)
    );
    assert_eq!(surfaces[3].shape, SurfaceShape::Cylinder { radius: 55.0, along_x: false });
    assert_eq!(surfaces[3].thickness_mm, 50.0);
}

#[test]
fn other_habits() {
    let text = "#;R [mm];d;Glass;Diameter;A4\nobject;;inf;;;\n1;50,5;5;N-BK7;20;1,5e-6\n2;0;47;;18;\nimage;0;0;;;\n";
    let text = text.replacen("#;", "type;", 1);
    let lens = read("t.csv", &text).unwrap_or_else(|faults| panic!("{faults}"));
    let AxisItem::Surface(first) = &lens.items[0] else { panic!("a surface") };
    assert_eq!(first.shape, SurfaceShape::EvenAsphere { radius: 50.5, conic: 0.0, coefficients: vec![0.0, 1.5e-6] });
    assert_eq!((first.semi_diameter_mm, lens.items.len(), lens.object_distance_mm), (Some(10.0), 2, None));
    // Notes: `1` and `2` are not types, and a radius of 0 is a plane.
    assert_eq!(lens.left_out.len(), 3);
}

#[test]
fn faults_have_row_and_column() {
    let text = "radius,thickness,nd,colour\n50,x,0.3,\n-50,inf,1,red,7\n";
    let message = read("t.csv", text).unwrap_err().to_string();
    for word in [
        "t.csv:1:21: unknown column `colour`",
        "t.csv:2:4: `x` is not a number",
        "t.csv:2:6: an index of 0.3",
        "t.csv:3:5",
        "t.csv:3:15: this cell has no column",
    ] {
        assert!(message.contains(word), "{word}: {message}");
    }
    for (text, word) in [
        ("", "empty"),
        ("thickness\n1\n", "no column `radius`"),
        ("radius\n", "no surfaces"),
        ("radius,r\n1,2\n", "appears twice"),
        ("lens,radius\na,1\nb,2\n", "t.csv:3:1: a second lens, `b`"),
    ] {
        assert!(read("t.csv", text).unwrap_err().to_string().contains(word), "{text}");
    }
}

fn message(text: &str) -> String {
    read("t.csv", text).map_or_else(|faults| faults.to_string(), |lens| panic!("{text}: {lens:?}"))
}

/// A lens in any unit is the same lens in millimeters, including its coefficients.
#[test]
fn units_of_the_head_count() {
    let mm = "radius,thickness,glass,semi-diameter,a4,a6\n508,127,N-BK7,50.8,0,0\n-508,254,,50.8,0,0\n";
    let wanted = read("t.csv", mm).expect("a lens");
    for text in [
        "radius [in],thickness [in],glass,semi-diameter [inch],a4 [in^-3],a6 [in]\n20,5,N-BK7,2,0,0\n-20,10,,2,0,0\n",
        "radius (cm),thickness [mm],glass,diameter [m],a4 [mm^-3],a6 [1/m^5]\n50.8,127,N-BK7,0.1016,0,0\n-50.8,254,,0.1016,0,0\n",
        "radius_cm,thickness_mm,glass,semi_diameter_in\n50.8,127,N-BK7,2\n-50.8,254,,2\n",
    ] {
        let found = read("t.csv", text).unwrap_or_else(|faults| panic!("{faults}"));
        assert_eq!(found, wanted, "{text}");
    }
    // The sag in inches is a4 (r / in)^4: 0.001 in at r = 1 in.
    let form = |text: &str| match read("t.csv", text).expect("a lens").surfaces().next().map(|s| s.shape.clone()) {
        Some(SurfaceShape::EvenAsphere { radius, coefficients, .. }) => (radius, coefficients),
        other => panic!("{other:?}"),
    };
    for text in [
        "radius [in],thickness [in],a4 [in^-3]\n20,5,1e-3\n",
        "curvature [1/in],thickness [in],a4 [1/in^3]\n0.05,5,1e-3\n",
        "radius [in],thickness [in],coefficients [in]\n20,5,0 1e-3\n",
    ] {
        let (radius, coefficients) = form(text);
        let sag_mm = coefficients[1] * 25.4_f64.powi(4);
        assert!((radius - 508.0).abs() < 1e-9 && (sag_mm - 0.0254).abs() < 1e-15, "{text}: {radius} {sag_mm}");
    }
    for (text, word) in [
        ("radius [furlong],thickness\n1,1\n", "t.csv:1:1: `furlong` is not a unit for this column"),
        ("radius [furlong],thickness\n1,1\n", "`radius [in]`"),
        ("radius [in],thickness\n1,1\n", "t.csv:1:13: `thickness` states no unit, but other columns do"),
        ("radius [in],thickness [in],a4\n1,1,0\n", "such as `a4 [mm^-3]`"),
        ("radius [mm],thickness [mm],a4 [mm^-5]\n1,1,0\n", "such as [mm^-3]"),
    ] {
        assert!(message(text).contains(word), "{}", message(text));
    }
}

#[test]
fn what_a_lens_file_refuses_is_refused() {
    for (text, word) in [
        ("radius,thickness,glass\n50,,N-BK7\n-50,40,\n", "t.csv:2:5: the glass behind this surface needs a thickness"),
        ("radius,thickness,nd\n50,,1.5\n-50,40,\n", "0 where they touch"),
        ("radius,glass\n50,N-BK7\n-50,\n", "no column `thickness`"),
        ("surface,radius,thickness\n2,50,1\n1,-50,1\n", "t.csv:3:1: surface 1 comes after surface 2"),
        ("no,radius,thickness\n1,50,1\n1,-50,1\n", "t.csv:3:1: surface 1 comes after surface 1"),
    ] {
        assert!(message(text).contains(word), "{}", message(text));
    }
    let found = read("t.csv", "no,radius,thickness\n1,0,1\nstop,50,1\n7,0,1\n").expect("a lens");
    let faults = read("t.csv", "radius,glass\n50,N-BK7\n-50,N-SF5\n-90,\n").expect_err("faults");
    assert_eq!(faults.0.len(), 1, "{faults}");
    assert_eq!(found.left_out.len(), 1);
    assert_eq!(found.left_out[0].to_string(), "line 2: a radius of 0 is taken as a plane (2 rows)");
    assert_eq!(found.surfaces().next().map(|s| s.shape.clone()), Some(SurfaceShape::Plane));
}

#[test]
fn a_stop_in_the_column_of_radii() {
    let found =
        read("t.csv", "radius,thickness,glass\n50,2,N-BK7\n-50,2,\nSTOP,3,\n40,2,N-BK7\nplane,30,\n").expect("a lens");
    let stop = found.surfaces().nth(2).expect("a surface");
    assert_eq!((&stop.shape, stop.stop, stop.thickness_mm), (&SurfaceShape::Stop, true, 3.0));
}

#[test]
fn slips_with_commas_and_units_have_hints() {
    let faults = read("t.csv", "radius,thickness,nd\n50,2,\"1,628\"\n-50.5,2,\n").expect_err("faults");
    assert_eq!(faults.0.len(), 1);
    assert!(faults.0[0].hint.as_deref().is_some_and(|hint| hint.contains("`1.628`")), "{faults}");
    let faults = read("t.csv", "radius,thickness,nd\n50,5,2,5,1,628\n-50,5,40,2,1\n").expect_err("faults");
    assert_eq!(faults.0.len(), 1, "{faults}");
    assert!(faults.to_string().contains("t.csv:2:1: 6 cells, but the header has 3"), "{faults}");
    assert!(faults.0[0].hint.as_deref().is_some_and(|hint| hint.contains("semicolons")), "{faults}");
    let faults = read("t.csv", "radius,thickness\n50 mm,2\n-50,40\n").expect_err("faults");
    assert!(faults.0[0].hint.as_deref().is_some_and(|hint| hint.contains("`radius [mm]`, and here `50`")), "{faults}");
}

/// The table in the guide is a lens without any notes.
#[test]
fn the_table_of_the_guide() {
    let guide = include_str!("../../../../docs/guide/src/lens-from-patent.md");
    let table =
        guide.split("```csv file=doublet.csv\n").nth(1).and_then(|rest| rest.split("```").next()).expect("a table");
    let lens = read("doublet.csv", table).unwrap_or_else(|faults| panic!("{faults}"));
    let surfaces: Vec<_> = lens.surfaces().collect();
    assert!(lens.left_out.is_empty(), "{:?}", lens.left_out);
    assert!(matches!(surfaces[0].shape, SurfaceShape::Sphere { radius } if (radius - 60.96).abs() < 1e-12));
    assert_eq!((&surfaces[3].shape, surfaces.len()), (&SurfaceShape::Stop, 4));
}

/// Returns radii, thicknesses and indices of a table, the number of the stop from 1, and the notes.
fn printed(text: &str) -> (Vec<[f64; 3]>, Option<usize>, String) {
    let lens = read("t.csv", text).unwrap_or_else(|faults| panic!("{faults}\n{text}"));
    let surfaces: Vec<_> = lens.surfaces().collect();
    let radius = |shape: &SurfaceShape| match shape {
        SurfaceShape::Sphere { radius }
        | SurfaceShape::Conic { radius, .. }
        | SurfaceShape::EvenAsphere { radius, .. } => *radius,
        _ => f64::INFINITY,
    };
    let index = |medium: &Medium| match medium {
        Medium::Model { nd, .. } => *nd,
        Medium::Glass { nd, .. } => nd.unwrap_or(0.0),
        _ => 1.0,
    };
    let rows = surfaces.iter().map(|s| [radius(&s.shape), s.thickness_mm, index(&s.medium)]).collect();
    let stop = surfaces.iter().position(|s| s.stop || s.shape == SurfaceShape::Stop).map(|at| at + 1);
    let notes: Vec<String> = lens.left_out.iter().map(ToString::to_string).collect();
    (rows, stop, notes.join("\n"))
}

/// A triplet as six patent offices and typists print it: each must be read as the same lens.
#[test]
fn tables_as_patents_print_them() {
    const TRIPLET: [[f64; 3]; 7] = [
        [23.713, 4.831, 1.691],
        [7331.288, 5.86, 1.0],
        [-24.456, 0.975, 1.6727],
        [21.896, 4.822, 1.0],
        [f64::INFINITY, 1.2, 1.0],
        [86.759, 3.127, 1.691],
        [-20.4942, 41.1, 1.0],
    ];
    let modern = "Numerical Example 1\nUnit mm\n\nSurface data\nSurface No.    r        d      nd       νd    Effective diameter\n\
        1      23.713    4.831  1.69100  54.7   20.0\n2    7331.288    5.860                  19.4\n3    −24.456    0.975  1.67270  32.2  15.0\n\
        4      21.896    4.822                  14.0\n5(stop)   ∞       1.200                  13.0\n6      86.759    3.127  1.69100  54.7  16.0\n\
        7    −20.4942  41.100\nImage plane   ∞\n\nVarious data\nFocal length   50.00\nF-number   4.00\n";
    let equations = "r1 = 23.713  d1 = 4.831  n1 = 1.69100  ν1 = 54.7\nr2 = 7331.288  d2 = 5.860\nr3 = -24.456  d3 = 0.975  n2 = 1.67270  ν2 = 32.2\n\
        r4 = 21.896  d4 = 4.822\nr5 = ∞ (stop)  d5 = 1.2\nr6 = 86.759  d6 = 3.127  n3 = 1.69100  ν3 = 54.7\nr7 = -20.4942  d7 = 41.1\n";
    let german = "r1 = + 23,713\n   d1 = 4,831   n1 = 1,6910   v1 = 54,7\nr2 = + 7331,288\n   d2 = 5,860\nr3 = - 24,456\n   d3 = 0,975   n2 = 1,6727   v2 = 32,2\n\
        r4 = + 21,896\n   d4 = 4,822\nr5 = inf  Blende\n   d5 = 1,2\nr6 = + 86,759\n   d6 = 3,127   n3 = 1,6910   v3 = 54,7\nr7 = - 20,4942\n   d7 = 41,1\n";
    let office = "Surface No.,R,D,Nd,νd,Effective diameter,Remarks\n1,23.713,4.831,1.691,54.7,20,\n2,7331.288,5.86,,,19,\n3,−24.456,.975,1.6727,32.2,15,\n\
        4,21.896,4.822,,,14,\n5,∞,1.2,,,13,Aperture stop\n6,86.759,3.127,1.691,54.7,16,\n7,−20.4942,41.1,,,16,\n";
    let japanese = "面番号\t曲率半径\t面間隔\t屈折率\tアッベ数\t備考\n1\t23.713\t4.831\t1.691\t54.7\t\n2\t7331.288\t5.86\t\t\t\n3\t-24.456\t0.975\t1.6727\t32.2\t\n\
        4\t21.896\t4.822\t\t\t\n5\t∞\t1.2\t\t\t絞り\n6\t86.759\t3.127\t1.691\t54.7\t\n7\t-20.4942\t41.1\t\t\t\n";
    let blanks = "LENS DATA OF EXAMPLE 3\nNo.   r   d   nd   vd\n1 23.713 4.831 1.691 54.7\n2 7331.288 5.86\n3 - 24.456 0.975 1.6727 32.2\n4 21.896 4.822\n\
        5 stop ∞ 1.2\n6 86.759 3.127 1.691 54.7\n7 - 20.4942 41.1\n";
    for (name, text) in [
        ("modern", modern),
        ("equations", equations),
        ("german", german),
        ("office", office),
        ("japanese", japanese),
        ("blanks", blanks),
    ] {
        let (rows, stop, notes) = printed(text);
        assert_eq!(rows, TRIPLET, "{name}\n{notes}");
        assert_eq!(stop, Some(5), "{name}");
        assert_eq!(notes, "", "{name}");
    }
}

/// Reads what follows a table: coefficients of aspheres, and gaps that vary.
#[test]
fn coefficients_and_gaps_below_a_table() {
    let text = "Surface No.  r  d  nd  vd\n1*  50.0  5.0  1.5168  64.2\n2  -40.0  d2\n3  30.0  2.0  1.62  36.3\n4*  ∞  (BF)\n\
        Aspherical surface data\n1st surface\nK = -1.25  A4 = -1.2E-06  A6 = 3.5 × 10^-9\n4th surface\nK=0, A 4=2.0e-5\n\
        Zoom data\n   Wide  Tele\nd2  1.50  12.25\n";
    let lens = read("t.txt", text).unwrap_or_else(|faults| panic!("{faults}"));
    let surfaces: Vec<_> = lens.surfaces().collect();
    let asphere = SurfaceShape::EvenAsphere { radius: 50.0, conic: -1.25, coefficients: vec![0.0, -1.2e-6, 3.5e-9] };
    assert_eq!(surfaces[0].shape, asphere);
    assert_eq!(
        surfaces[3].shape,
        SurfaceShape::EvenAsphere { radius: f64::INFINITY, conic: 0.0, coefficients: vec![0.0, 2e-5] }
    );
    assert_eq!(surfaces[1].thickness_mm, 1.5);
    let notes: Vec<String> = lens.left_out.iter().map(|note| format!("{note} {}", note.alters)).collect();
    assert_eq!(
        notes,
        [
            "line 3: the gap `d2` varies: its first value, 1.50, is used true",
            "line 5: `(BF)` is not a number: the film is placed where the lens is in focus false"
        ]
    );
    // Without values the gap is requested, and without coefficients the asphere is noted.
    let fault = read("t.txt", &text[..text.find("Aspherical").unwrap()]).unwrap_err().to_string();
    assert!(fault.contains("`d2` is not a number") && fault.contains("write its value at one setting"), "{fault}");
    let (_, _, notes) = printed("No. r d nd vd\n1* 50 5 1.5168 64.2\n2 -40 47\n3 30 2 1.62 36.3\n4 -90 40\n");
    assert!(notes.contains("surface 1 is marked as an asphere, but no coefficients follow"), "{notes}");
}

/// A table with separators and headings keeps its meaning, whatever words are in it or above it.
#[test]
fn plain_tables_stay_what_they_are() {
    let inches =
        "radius [in],thickness [in],nd,vd,comment\n2,0.2,1.5168,64.2,behind the aperture stop\n-2,4,,,Zoom group\n";
    let (rows, stop, notes) = printed(inches);
    assert_eq!((rows[0][0], rows.len(), stop), (50.8, 2, None), "{notes}");
    // A title above the table does not change conics and coefficients.
    let text = "radius,thickness,nd,vd,conic,a4\n50,5,1.5168,64.2,-1.5,1e-6\n-40,47,,,,\n";
    let shape = |text: &str| read("t.csv", text).expect("a lens").surfaces().next().expect("a surface").shape.clone();
    assert_eq!(shape(&format!("A singlet of mine\n{text}")), shape(text));
    // Comments are not equations, and the first cell of a row is not a heading.
    let (rows, ..) = printed(&format!("# r1 = 99, r2 = 98 and r3 = 97\n{text}"));
    assert_eq!(rows[0][0], 50.0);
    let kinds = "type,radius,thickness,nd,vd\naspherical,50,5,1.5168,64.2\naspherical,-40,47,,\n";
    assert_eq!(printed(kinds).0.len(), 2);
    // Two figures in a cell are not a number, and a quoted remark is not two cells.
    assert!(read("t.csv", "radius,thickness\n1 0,5\n").is_err());
    let quoted = "no,radius,thickness,nd,vd,comment\n1,50,5,1.5168,64.2,\"front, coated\"\n2 stop,inf,3,,,\n";
    let lens = read("t.csv", quoted).expect("a lens");
    let surfaces: Vec<_> = lens.surfaces().collect();
    assert_eq!((surfaces[0].comment.as_str(), surfaces[1].stop), ("front, coated", true));
    // Indices at the line e are distinguished.
    let e = read("t.csv", "radius,thickness,ne,ve\n50,5,1.5187,64\n-40,47,,\n").expect("a lens");
    assert_eq!(e.reference_line.as_deref(), Some("e"));
    // A focal length below a block of aspheres is not a coefficient, and a second example is another lens.
    let two = "No. r d nd vd\n1* 50 5 1.5168 64.2\n2 -40 47\n3 inf 1\nAspherical surface data\n1st surface\nK = -1 A4 = 1e-6\n\
               Various data\nf = 50.00\nF = 2.8\nExample 2\nNo. r d nd vd\n1* 99 5 1.6 60\nAspherical surface data\n1st surface\nK = -9 A4 = 9e-6\n";
    let SurfaceShape::EvenAsphere { conic, coefficients, .. } = shape(two) else { panic!("an asphere") };
    assert_eq!((conic, coefficients), (-1.0, vec![0.0, 1e-6]));
}
