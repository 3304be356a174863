//! Absorption of glasses without published data: it is borrowed, and the lender is named.

use spectra_glass::{Catalog, Category, Medium};

fn medium(name: &str) -> Medium {
    Catalog::bundled().medium(name).unwrap_or_else(|e| panic!("{e}"))
}

#[test]
fn own_data_come_first() {
    let glass = medium("SCHOTT/SF6");
    let own = glass.absorption(Some(1927)).expect("known");
    assert_eq!(own.lender, None);
    let tau = |nm: f64| libm::exp(-4.0e7 * std::f64::consts::PI * own.extinction.at(nm).expect("in range") / nm);
    let same = glass.internal_transmittance(420.0, 10.0).expect("known");
    assert!((tau(420.0) - same).abs() < 1e-12);
}

/// The barium crown of old lenses borrows from its own kind, near by, and the lender is named.
#[test]
fn old_glasses_borrow_from_near_ones() {
    for name in ["SCHOTT/SK16", "SCHOTT/BAF9", "SCHOTT/SK10", "SCHOTT/SF55", "SCHOTT/LAK8", "SCHOTT/LAK31"] {
        let absorption = medium(name).absorption(None).unwrap_or_else(|| panic!("{name} borrows nothing"));
        let lender = absorption.lender.unwrap_or_else(|| panic!("{name} has absorption of its own"));
        println!("{name}: {lender}, distance {:.2}", lender.distance);
        assert!(lender.delta_nd.abs() < 0.03 && lender.delta_vd.abs() < 4.0, "{name}: {lender}");
        // Of 10 mm no old glass passes everything at h, and none is a filter at d.
        let tau = |nm: f64| libm::exp(-4.0e7 * std::f64::consts::PI * absorption.extinction.at(nm).unwrap_or(0.0) / nm);
        assert!(tau(404.7) < 0.995 && tau(404.7) > 0.3 && tau(587.6) > 0.97, "{name}: {} {}", tau(404.7), tau(587.6));
    }
}

/// SF6 absorbs more in the violet without lead: a lens of 1960 does not borrow from N-SF6.
#[test]
fn time_counts_for_figures_alone() {
    let figures = Medium::from_nd_vd(1.8052, 25.4).expect("a glass");
    let lender = |year| figures.absorption(year).and_then(|a| a.lender).expect("borrowed").full_name;
    let (old, new) = (lender(Some(1960)), lender(Some(2015)));
    println!("1960: {old}, 2015: {new}");
    let first = |name: &str| Catalog::bundled().find(name).ok().and_then(|g| g.years).expect("listed").0;
    assert!(first(&old) <= 1983 && first(&new) > 1983, "{old} {new}");
}

#[test]
fn what_is_no_glass_borrows_nothing() {
    for medium in [Medium::Air, Medium::Vacuum, Medium::Constant(1.5)] {
        assert_eq!(medium.absorption(None), None);
    }
    // No glass is near a gas, nor near nd 1.5 with Vd 5.
    for (nd, vd) in [(1.0003, 89.0), (1.5, 5.0)] {
        assert_eq!(Medium::from_nd_vd(nd, vd).expect("a medium").absorption(None), None);
    }
    // A crystal is as clear as it is, whatever glass has its index.
    let clear = medium("CaF2/Malitson");
    assert!(clear.absorption(None).is_none_or(|a| a.lender.is_none()));
}

/// A plate of 3 mm of each plastic: either its own data, or a lender's absorption by which it passes over 80 % from 420 to 700 nm.
#[test]
fn plastics_are_clear_where_nobody_measured_otherwise() {
    let catalogue = Catalog::bundled();
    let mut counted = 0;
    for glass in catalogue.glasses().filter(|glass| glass.category == Category::Plastic) {
        let name = glass.full_name();
        let medium = medium(&name);
        counted += 1;
        let Some(absorption) = medium.absorption(None) else { continue };
        let passed =
            |nm: f64| libm::exp(-4.0 * std::f64::consts::PI * absorption.extinction.at(nm).unwrap_or(0.0) * 3e6 / nm);
        let least = (0..=280).map(|i| passed(420.0 + f64::from(i))).fold(1.0, f64::min);
        println!("{name}: {least:.3} {:?}", absorption.lender.as_ref().map(ToString::to_string));
        assert!(absorption.lender.is_none() || least > 0.8, "{name}: {least}, by {:?}", absorption.lender);
    }
    assert!(counted >= 33, "{counted}");
    for name in ["PMMA", "CR39", "COC", "Zeonex"] {
        assert!(medium(name).absorption(None).is_none_or(|absorption| absorption.lender.is_some()), "{name}");
    }
}
