//! Users' glass catalogue files.

use spectra_glass::{Catalog, agf};

/// One medium for each formula number that makers and handbooks use: nd and Vd as `xtask/agf_forms.py` computes them.
#[test]
fn formulas_by_their_numbers() {
    let agf = agf::read(include_bytes!("../data/forms.agf"), "FORMS");
    assert_eq!(agf.problems, []);
    let names: Vec<&str> = agf.glasses.iter().map(|g| g.formula.name()).collect();
    assert_eq!(names[..4], ["Schott", "Sellmeier 1", "Herzberger", "Conrady"]);
    assert_eq!(names[4..8], ["Sellmeier 3", "Handbook of Optics 1", "Handbook of Optics 2", "Sellmeier 4"]);
    assert_eq!(names[8..], ["Extended 3", "Sellmeier 5", "Extended 2"]);
    for glass in &agf.glasses {
        if let (Some(nd), Some(vd)) = (glass.listed_nd, glass.listed_vd) {
            assert!((glass.nd() - nd).abs() <= 1e-6, "{} {}", glass.name, glass.nd());
            assert!((glass.vd() - vd).abs() <= 1e-4, "{} {}", glass.name, glass.vd());
        }
    }
    let by_name = |name: &str| agf.glasses.iter().find(|g| g.name == name).expect(name);
    // KRS-5: 2.37069 at 10 um (Rodney and Malitson 1956). Silicon at 5 um: 3.426066 by Edwards and Ochoa's coefficients,
    // computed apart; samples differ (3.4223, Salzberg and Villa 1957).
    assert!((by_name("KRS5").index(10_000.0) - 2.37069).abs() < 1e-5);
    assert!((by_name("SI-EDWARDS").index(5000.0) - 3.426_066).abs() < 1e-6);
    // What makers list: HOYA's, Hikari's and OHARA's catalogues.
    for (name, nd, vd) in [
        ("APL1", 1.517277, 69.5632),
        ("Q-LASFH19S", 1.82098, 42.6567),
        ("E-KZFH1", 1.61266, 44.4614),
        ("N-BK7", 1.5168, 64.17),
    ] {
        let glass = by_name(name);
        assert!(
            (glass.nd() - nd).abs() <= 2e-6 && (glass.vd() - vd).abs() <= 5e-3,
            "{name} {} {}",
            glass.nd(),
            glass.vd()
        );
    }
    let mut catalogue = Catalog::bundled().clone();
    catalogue.add(agf.glasses);
    assert!(catalogue.find("forms/zno-o").is_ok() && catalogue.find("SCHOTT/N-BK7").is_ok());
}
