use super::read;
use crate::prescription::{Item, Medium, Shape};

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
    assert_eq!((&surfaces[0].shape, &surfaces[0].medium), (&Shape::Sphere { radius: 164.13 }, &glass));
    assert_eq!((&surfaces[1].shape, surfaces[1].semi_diameter_mm), (&Shape::Stop, Some(25.5)));
    assert_eq!(surfaces[2].shape, Shape::EvenAsphere { radius: -40.42, conic: 0.0, coefficients: vec![0.0, 1e-6] });
    assert_eq!(
        (&surfaces[2].medium, surfaces[2].semi_diameter_mm),
        (&Medium::Model { nd: 1.6992, vd: Some(30.2) }, None)
    );
    assert_eq!(surfaces[3].shape, Shape::Cylinder { radius: 55.0, along_x: false });
    assert_eq!(surfaces[3].thickness_mm, 50.0);
}

#[test]
fn other_habits() {
    let text = "#;R [mm];d;Glass;Diameter;A4\nobject;;inf;;;\n1;50,5;5;N-BK7;20;1,5e-6\n2;0;47;;18;\nimage;0;0;;;\n";
    let text = text.replacen("#;", "type;", 1);
    let lens = read("t.csv", &text).unwrap_or_else(|faults| panic!("{faults}"));
    let Item::Surface(first) = &lens.items[0] else { panic!("a surface") };
    assert_eq!(first.shape, Shape::EvenAsphere { radius: 50.5, conic: 0.0, coefficients: vec![0.0, 1.5e-6] });
    assert_eq!((first.semi_diameter_mm, lens.items.len(), lens.object_distance_mm), (Some(10.0), 2, None));
    // `1` and `2` are no types.
    assert_eq!(lens.left_out.len(), 2);
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
        ("radius,r\n1,2\n", "comes twice"),
        ("lens,radius\na,1\nb,2\n", "t.csv:3:1: a second lens, `b`"),
    ] {
        assert!(read("t.csv", text).unwrap_err().to_string().contains(word), "{text}");
    }
}
