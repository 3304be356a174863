//! Users' glass catalogue files.

use spectra_glass::{Catalogue, agf};

/// One medium for each formula number that makers and handbooks use: nd to 1e-6 and Vd to 1e-3 of what they list.
#[test]
fn formulas_by_their_numbers() {
    let agf = agf::read(include_bytes!("data/forms.agf"), "FORMS");
    assert_eq!(agf.problems, []);
    let names: Vec<&str> = agf.glasses.iter().map(|g| g.formula.name()).collect();
    assert_eq!(names[..4], ["Schott", "Sellmeier 1", "Herzberger", "Conrady"]);
    assert_eq!(names[4..8], ["Sellmeier 3", "Handbook of Optics 1", "Handbook of Optics 2", "Sellmeier 4"]);
    assert_eq!(names[8..], ["Extended 3", "Sellmeier 5", "Extended 2"]);
    for glass in &agf.glasses {
        let (Some(nd), Some(vd)) = (glass.listed_nd, glass.listed_vd) else {
            // KRS-5 is listed without: 2.37069 at 10 um (Rodney and Malitson 1956).
            assert!((glass.index(10_000.0) - 2.37069).abs() < 1e-5, "{}", glass.index(10_000.0));
            continue;
        };
        assert!((glass.nd() - nd).abs() <= 2e-6, "{} {}", glass.name, glass.nd());
        assert!((glass.vd() - vd).abs() <= 5e-3, "{} {}", glass.name, glass.vd());
    }
    let mut catalogue = Catalogue::bundled().clone();
    catalogue.add(agf.glasses);
    assert!(catalogue.find("forms/zno").is_ok() && catalogue.find("SCHOTT/N-BK7").is_ok());
}
