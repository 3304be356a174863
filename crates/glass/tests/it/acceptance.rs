//! Published values: makers' glasses, Cauchy constants, refraction and reflection.

use spectra_glass::fit::{Sample, cauchy_by_rows};
use spectra_glass::interface::{brewster_angle, fresnel, refraction_angle, single_layer_reflectance};
use spectra_glass::{Catalog, LineTriple, lines};

fn index(name: &str, wavelength_nm: f64) -> f64 {
    Catalog::bundled().find(name).expect(name).index(wavelength_nm)
}

/// One unit in the last digit printed.
fn near(got: f64, printed: f64, digits: i32) -> bool {
    (got - printed).abs() <= 1.000_001 * 0.1f64.powi(digits)
}

/// Makers' coefficients: nd, nF, nC, ng to 1e-6 and Vd to 0.01.
fn glass(name: &str, [nd, nf, nc, ng, vd]: [f64; 5]) {
    let glass = Catalog::bundled().find(name).expect(name);
    for (line, printed) in [(lines::D, nd), (lines::F, nf), (lines::C, nc), (lines::G, ng)] {
        let got = glass.index(line.wavelength_nm);
        assert!(near(got, printed, 6), "{name} {}: {got}, printed {printed}", line.name);
    }
    assert!(near(glass.vd(), vd, 2), "{name}: Vd {}", glass.vd());
}

#[test]
fn schott_n_bk7() {
    glass("SCHOTT/N-BK7", [1.516800, 1.522376, 1.514322, 1.526685, 64.17]);
}

#[test]
fn schott_f2() {
    glass("SCHOTT/F2", [1.620040, 1.632081, 1.615032, 1.642018, 36.37]);
}

#[test]
fn schott_n_sf11() {
    glass("SCHOTT/N-SF11", [1.784720, 1.806513, 1.775955, 1.825325, 25.68]);
}

#[test]
fn schott_n_sf6() {
    glass("SCHOTT/N-SF6", [1.805180, 1.827829, 1.796079, 1.847380, 25.36]);
}

#[test]
fn schott_sf10() {
    glass("SCHOTT/SF10", [1.728250, 1.746481, 1.720848, 1.761978, 28.41]);
}

#[test]
fn schott_n_sk16() {
    glass("SCHOTT/N-SK16", [1.620410, 1.627556, 1.617272, 1.633122, 60.32]);
}

#[test]
fn schott_n_lak9() {
    glass("SCHOTT/N-LAK9", [1.691002, 1.699789, 1.687159, 1.706669, 54.71]);
}

#[test]
fn ohara_s_fpl53() {
    glass("OHARA/S-FPL53", [1.438750, 1.441954, 1.437333, 1.444423, 94.95]);
}

#[test]
fn hoya_fcd1() {
    glass("HOYA/FCD1", [1.496997, 1.501228, 1.495137, 1.504509, 81.61]);
}

#[test]
fn n_bk7_at_the_e_line() {
    let glass = Catalog::bundled().find("N-BK7").expect("N-BK7");
    assert!(near(glass.index(lines::E.wavelength_nm), 1.518722, 6));
    assert!(near(glass.abbe_number(LineTriple::F_PRIME_E_C_PRIME), 63.96, 2));
}

#[test]
fn precise_lines() {
    let printed = [
        ("h", 404.6561),
        ("g", 435.8343),
        ("F'", 479.9914),
        ("F", 486.1327),
        ("e", 546.074),
        ("d", 587.5618),
        ("D", 589.2938),
        ("C'", 643.8469),
        ("C", 656.2725),
        ("r", 706.5188),
        ("A'", 768.195),
    ];
    for (name, wavelength_nm) in printed {
        assert_eq!(lines::by_name(name).map(|line| line.wavelength_nm), Some(wavelength_nm));
    }
}

/// Rows of CRC Handbook of Chemistry and Physics (D. R. Lide, 1990), see the file's head.
fn table(material: &str) -> Vec<Sample> {
    let rows = include_str!("../data/cauchy-tables.csv").lines().map(|line| line.split(',').collect::<Vec<_>>());
    rows.filter(|row| row[0] == material)
        .map(|row| Sample { wavelength_nm: row[1].parse().expect("a number"), n: row[2].parse().expect("a number") })
        .collect()
}

fn cauchy(material: &str, a: f64, a_digits: i32, b_nm2: f64, b_digits: i32) {
    let rows = cauchy_by_rows(&table(material)).expect(material);
    assert!(near(rows.a, a, a_digits), "{material}: A {}", rows.a);
    assert!(near(rows.b_nm2, b_nm2, b_digits), "{material}: B {}", rows.b_nm2);
}

#[test]
fn cauchy_of_water() {
    cauchy("water-20c", 1.3238, 4, 3126.8, 1);
}

#[test]
fn cauchy_of_zinc_crown() {
    cauchy("zinc-crown", 1.5020, 4, 4964.6, 1);
}

#[test]
fn cauchy_of_higher_dispersion_crown() {
    cauchy("higher-dispersion-crown", 1.5037, 4, 5569.1, 1);
}

#[test]
fn cauchy_of_light_flint() {
    cauchy("light-flint", 1.5536, 4, 7661.0, 1);
}

#[test]
fn cauchy_of_heavy_flint() {
    cauchy("heavy-flint", 1.6199, 4, 10655.7, 1);
}

#[test]
fn cauchy_of_heaviest_flint() {
    cauchy("heaviest-flint", 1.8321, 4, 20737.8, 1);
}

#[test]
fn cauchy_of_fused_quartz() {
    cauchy("fused-quartz", 1.44751, 5, 3689.68, 2);
    let rows = cauchy_by_rows(&table("fused-quartz")).expect("fused quartz");
    assert!(near(rows.fit.mean_deviation, 0.0004, 4), "{}", rows.fit.mean_deviation);
}

#[test]
fn refraction_into_a_thin_medium() {
    for (incidence, printed) in [(20.0f64, 19.96669), (35.0, 34.93594)] {
        let refracted = refraction_angle(1.0, 1.0016, incidence.to_radians()).expect("into the denser medium");
        assert!(near(refracted.to_degrees(), printed, 5), "{}", refracted.to_degrees());
    }
}

#[test]
fn fresnel_of_index_1_5() {
    let at = |degrees: f64| fresnel(1.0, 1.5, libm::cos(degrees.to_radians()));
    assert!(near(at(0.0).mean(), 0.0400, 4));
    for (degrees, s, p) in
        [(30.0, 0.057796, 0.025249), (45.0, 0.092013, 0.008466), (60.0, 0.176571, 0.001802), (80.0, 0.538595, 0.236814)]
    {
        assert!(near(at(degrees).s, s, 6) && near(at(degrees).p, p, 6), "{degrees}: {:?}", at(degrees));
    }
    let brewster = brewster_angle(1.0, 1.5);
    assert!(near(brewster.to_degrees(), 56.31, 2));
    assert!(fresnel(1.0, 1.5, libm::cos(brewster)).p < 1e-30);
}

#[test]
fn normal_incidence_bare_and_coated() {
    assert!(near(fresnel(1.0, 1.5168, 1.0).s, 0.0421646, 7));
    // A quarter of a wave in the layer.
    let quarter = 550.0 / (4.0 * 1.38);
    assert!(near(single_layer_reflectance(1.0, 1.38, 1.5168, quarter, 550.0), 0.0128354, 7));
}

#[test]
fn n_bk7_at_550_nm_bare_and_coated() {
    let n = index("SCHOTT/N-BK7", 550.0);
    assert!(near(n, 1.518522, 6), "{n}");
    assert!(near(fresnel(1.0, n, 1.0).s, 0.042388, 6));
    assert!(near(single_layer_reflectance(1.0, 1.38, n, 99.6, 550.0), 0.0127088, 7));
}

/// Schott's data sheets of 2018: 1e6 dn/dT between 20 and 40 C at 1060 nm, e and g, relative to air and absolute; 0.05 of
/// rounding, and 0.05 for air and the mean over the range.
#[test]
fn temperature_coefficients_of_schott() {
    for (name, relative, absolute) in [
        ("SCHOTT/N-BK7", [2.4, 3.0, 3.5], [1.1, 1.6, 2.1]),
        ("SCHOTT/N-FK51A", [-6.0, -5.7, -5.3], [-7.3, -7.0, -6.7]),
        ("SCHOTT/SF6", [6.8, 11.1, 16.2], [5.3, 9.5, 14.6]),
    ] {
        let glass = Catalog::bundled().find(name).expect(name);
        for (i, wavelength_nm) in [1060.0, lines::E.wavelength_nm, lines::G.wavelength_nm].into_iter().enumerate() {
            let slope = |n: &dyn Fn(f64) -> f64| (n(40.0) - n(20.0)) / 20.0 * 1e6;
            let got = slope(&|t| glass.absolute_index(wavelength_nm, t));
            assert!((got - absolute[i]).abs() < 0.1, "{name} {wavelength_nm} absolute {got}");
            let got = slope(&|t| glass.index_at(wavelength_nm, t));
            assert!((got - relative[i]).abs() < 0.1, "{name} {wavelength_nm} relative {got}");
        }
    }
}

/// Internal transmittance of 10 mm in Schott's data sheets (2018), three decimals.
#[test]
fn internal_transmittance_of_schott() {
    for (name, rows) in [
        ("SCHOTT/N-BK7", &[(365.0, 0.988), (400.0, 0.997), (460.0, 0.997), (546.0, 0.998), (700.0, 0.998)][..]),
        ("SCHOTT/F2", &[(350.0, 0.905), (365.0, 0.968), (400.0, 0.994), (546.0, 0.999)]),
        ("SCHOTT/SF6", &[(365.0, 0.246), (380.0, 0.720), (400.0, 0.915), (460.0, 0.991), (660.0, 0.998)]),
    ] {
        let glass = Catalog::bundled().find(name).expect(name);
        for &(wavelength_nm, printed) in rows {
            let got = glass.internal_transmittance(wavelength_nm, 10.0).expect("known");
            assert!(near(got, printed, 3), "{name} {wavelength_nm}: {got}");
        }
    }
}
