use super::*;
use crate::{SpectralFunction, find_emission, find_reflectance, find_sensitivity};

/// Grid of 380-780 nm in steps of 1 nm.
const GRID: Grid = Grid { start_nm: 380.0, step_nm: 1.0, count: 401 };

/// Fits with each number of terms, and requires at most 1.1 times the relative L2 error that 60 random starts of another
/// program reached.
fn reaches(name: &str, values: &[f64], rows: &[(usize, f64)]) {
    for (terms, wanted) in rows {
        let start = std::time::Instant::now();
        let fit = fit_gaussians(&GRID, values, *terms).expect("fits");
        let r = fit.report;
        println!(
            "{name}, {terms} terms: relative L2 {:.6} of {wanted}, maximum {:.5}, integral {:.1e}, smallest {:.4}, kappa {:.2}, {:.2} s",
            r.relative_l2,
            r.maximum,
            r.integral,
            r.smallest,
            r.kappa,
            start.elapsed().as_secs_f64()
        );
        assert_eq!(fit.mixture.terms().len(), *terms);
        assert!(r.relative_l2 <= 1.1 * wanted, "{name}, {terms} terms: {}", r.relative_l2);
    }
}

#[test]
fn fit_of_planck_5000_k() {
    let values = SpectralFunction::blackbody(5000.0).expect("valid").on_grid(&GRID);
    reaches("Planck 5000 K", &values, &[(1, 0.023), (2, 0.0003), (3, 0.000_05)]);
}

#[test]
fn fit_of_colorchecker_green() {
    let values = find_reflectance("colorchecker#green").expect("bundled").on_grid(&GRID);
    reaches("ColorChecker green", &values, &[(2, 0.053), (4, 0.0123), (8, 0.0024)]);
}

#[test]
fn fit_of_ortho_plus() {
    let values = find_sensitivity("ilford-ortho-plus").expect("bundled").on_grid(&GRID);
    reaches("Ortho Plus", &values, &[(4, 0.0227), (6, 0.0072), (8, 0.0050)]);
}

#[test]
fn fit_of_d65() {
    let values = find_emission("D65").expect("bundled").on_grid(&GRID);
    reaches("D65", &values, &[(4, 0.034), (8, 0.0158)]);
}

/// The lines of FL11 cannot be fitted by few Gaussian terms: they are better kept as lines.
#[test]
fn fit_of_fl11() {
    let values = find_emission("FL11").expect("bundled").on_grid(&GRID);
    reaches("FL11", &values, &[(8, 0.16 / 1.1)]);
}
