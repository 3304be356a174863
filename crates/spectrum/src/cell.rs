//! Integration of a function that is smooth between given breaks.

/// Nodes on (-1, 1) and weights of the eight-point Gauss-Legendre rule (Abramowitz and Stegun, table 25.4).
const GAUSS: [(f64, f64); 4] = [
    (0.183_434_642_495_649_80, 0.362_683_783_378_361_98),
    (0.525_532_409_916_328_99, 0.313_706_645_877_887_29),
    (0.796_666_477_413_626_74, 0.222_381_034_453_374_47),
    (0.960_289_856_497_536_23, 0.101_228_536_290_376_26),
];

/// Integrates `f` over the intervals between neighbors of the sorted `breaks`; exact for polynomials of degree 15 on each.
pub(crate) fn integral(f: impl Fn(f64) -> f64, breaks: &[f64]) -> f64 {
    let mut sum = 0.0;
    for pair in breaks.windows(2) {
        let (middle, half) = (0.5 * (pair[0] + pair[1]), 0.5 * (pair[1] - pair[0]));
        if half > 0.0 {
            for (x, weight) in GAUSS {
                sum += half * weight * (f(middle - half * x) + f(middle + half * x));
            }
        }
    }
    sum
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn exact_to_degree_fifteen() {
        for degree in 0..16 {
            let got = integral(|x: f64| x.powi(degree), &[0.0, 0.3, 0.3, 2.0]);
            let want = 2.0_f64.powi(degree + 1) / f64::from(degree + 1);
            assert!((got / want - 1.0).abs() < 1e-13, "{degree}");
        }
    }
}
