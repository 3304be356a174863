use super::*;
use crate::catalog::Catalog;
use crate::formula::SELLMEIER_1;
use crate::glass::{Category, Glass};
use crate::{LineTriple, ModelGlass};

fn medium(name: &str) -> Medium {
    Catalog::bundled().find(name).expect(name).into()
}

/// Every optical glass of every maker over the whole band: a rational function within 2e-10, or 1e-9 for a few whose
/// polynomials wind where they are extrapolated; a table within 1e-9 for what is a table. Checked between the fit's own
/// check points.
#[test]
fn all_optical_glasses_within_tolerance() {
    let mut degrees = [0usize; Rational::MAX_DEGREE + 1];
    let (mut tables, mut coarse) = (0, 0);
    for glass in Catalog::bundled().glasses().filter(|g| g.category == Category::OpticalGlass) {
        let name = glass.full_name();
        let tabulated = glass.table().is_some();
        let medium = Medium::from(glass);
        let fast = Dispersion::fit(&medium, 350.0, 830.0).expect(&name);
        let worst = (0..977).map(|i| 350.0 + 480.0 * (f64::from(i) + 0.37) / 977.0);
        let worst = worst.map(|w| (fast.evaluate(w) - medium.index(w)).abs()).fold(0.0, f64::max);
        match fast.rational() {
            Some(rational) => {
                degrees[rational.degree()] += 1;
                coarse += usize::from(fast.max_error() > 2e-10);
                assert!(fast.max_error() <= 1e-9 && worst <= 1.05 * fast.max_error() + 1e-12, "{name} {worst}");
            }
            None => {
                tables += 1;
                assert!(tabulated, "{name}: no rational function");
                assert!(worst <= 1.1e-9, "{name} {worst}");
            }
        }
    }
    println!("degrees 0 to 6: {degrees:?}, {coarse} of them between 2e-10 and 1e-9; {tables} tables");
    assert!(coarse < 50 && tables < 3 && degrees.iter().sum::<usize>() > 2400);
}

/// The fit of a tracer's everyday glasses is short.
#[test]
fn degrees_of_well_known_glasses() {
    for (name, most) in [
        ("SCHOTT/BAF9", 2),
        ("SCHOTT/SK20", 2),
        ("SCHOTT/SK10", 3),
        ("LZ_LF5", 5),
        ("SCHOTT/SF5", 4),
        ("SCHOTT/N-BK7", 3),
        ("SCHOTT/N-SF11", 4),
    ] {
        let fast = Dispersion::fit(&medium(name), 350.0, 830.0).expect("a band");
        assert!(fast.max_error() <= 2e-10 && fast.rational().is_some_and(|r| r.degree() <= most), "{name}");
    }
}

#[test]
fn batch_gives_the_same_bits_and_the_inverse() {
    for name in ["SCHOTT/N-BK7", "SCHOTT/N-SF11", "LZOS/LF5", "H2O/Hale"] {
        let fast = Dispersion::fit(&medium(name), 350.0, 830.0).expect("a band");
        let wavelengths: Vec<f64> = (0..131).map(|i| 350.0 + f64::from(i) * 3.69).collect();
        let (mut n, mut inverse) = (vec![0.0; 131], vec![0.0; 131]);
        fast.index_and_inverse(&wavelengths, &mut n, &mut inverse);
        for i in 0..131 {
            assert_eq!(n[i].to_bits(), fast.evaluate(wavelengths[i]).to_bits());
            assert!((n[i] * inverse[i] - 1.0).abs() < 1e-15);
        }
    }
}

#[test]
fn media_without_dispersion_have_degree_0() {
    for (medium, n) in [(Medium::Air, 1.0), (Medium::Constant(1.5168), 1.5168)] {
        let fast = Dispersion::fit(&medium, 350.0, 830.0).expect("a band");
        assert_eq!(fast.constant(), Some(n));
        assert_eq!(fast.evaluate(500.0), n);
    }
    let model = Medium::from_nd_vd(1.6, 50.0).expect("a glass");
    let fast = Dispersion::fit(&model, 350.0, 830.0).expect("a band");
    // Powers of L^2 from 1 to -3 are a rational function of degree 4.
    assert_eq!(fast.rational().map(Rational::degree), Some(4));
    assert!(fast.max_error() <= 2e-10);
}

#[test]
fn other_bands() {
    for (min, max, tolerance) in
        [(400.0, 700.0, 2e-10), (330.0, 1100.0, 2e-10), (550.0, 550.1, 2e-10), (350.0, 2300.0, 1e-9)]
    {
        let medium = medium("SCHOTT/N-SF6");
        let fast = Dispersion::fit(&medium, min, max).expect("a band");
        assert!(fast.max_error() <= tolerance, "{min} {max}");
        assert_eq!(fast.band_nm(), (min, max));
    }
}

#[test]
fn bands_and_media_that_cannot_be_fitted() {
    let air = Medium::Air;
    for (min, max) in [(500.0, 500.0), (600.0, 500.0), (0.0, 500.0), (f64::NAN, 500.0), (400.0, f64::INFINITY)] {
        assert!(matches!(Dispersion::fit(&air, min, max), Err(DispersionError::Band { .. })));
    }
    // A pole at 500 nm: n^2 is negative on its short side.
    let pole = SELLMEIER_1.with(&[1.0, 0.25, 0.0, 0.0, 0.0, 0.0]);
    let glass = Glass::new("TEST", "POLE", Category::User, pole, (350.0, 830.0));
    assert!(matches!(Dispersion::fit(&glass.into(), 350.0, 830.0), Err(DispersionError::NoIndex { .. })));
}

/// Measured points with steps between them are followed as they are.
#[test]
fn rough_tables_are_followed() {
    for name in ["Ag/Johnson", "Au/Johnson", "H2O/Hale"] {
        let medium = medium(name);
        let fast = Dispersion::fit(&medium, 400.0, 800.0).expect("a band");
        for i in 0..500 {
            let w = 400.0 + 0.79 * f64::from(i);
            assert!((fast.evaluate(w) - medium.index(w)).abs() <= 2e-9, "{name} {w}");
        }
    }
}

#[test]
fn model_for_other_lines() {
    let model = ModelGlass::new(1.6, 40.0, LineTriple::F_PRIME_E_C_PRIME).map(Medium::Model).expect("a glass");
    let fast = Dispersion::fit(&model, 350.0, 830.0).expect("a band");
    assert!((fast.evaluate(546.074) - 1.6).abs() < 1e-13);
}
