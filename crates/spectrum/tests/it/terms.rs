//! Products of signed Gaussian mixtures: exact integrals, and the scatter of following one term of each factor.

use spectra_core::Isa;
use spectra_core::numbers::Numbers;
use spectra_spectrum::{GaussianMixture, GaussianTerm, OneTerm, SpectralFunction};

const BAND_NM: (f64, f64) = (380.0, 780.0);

/// Reproducible numbers in [0, 1).
struct Random {
    numbers: Numbers,
    next: u64,
}

impl Random {
    fn new(seed: u64) -> Self {
        Self { numbers: Numbers::random(seed), next: 0 }
    }

    fn number(&mut self) -> f64 {
        let mut u = [0.0];
        self.numbers.fill(Isa::Baseline, 0, self.next, 0, &mut u);
        self.next += 1;
        u[0]
    }

    /// Mixture of 4 to 6 signed terms of 8 to 250 nm, about a third of them negative.
    fn mixture(&mut self) -> GaussianMixture {
        let count = 4 + (3.0 * self.number()) as usize;
        let term = |random: &mut Self| {
            let sign = if random.number() < 0.35 { -1.0 } else { 1.0 };
            let (height, center) = (0.05 + random.number(), 340.0 + 480.0 * random.number());
            let sigma = 8.0 * spectra_core::math::exp(3.4 * random.number());
            GaussianTerm::new(sign * height, center, sigma).expect("valid")
        };
        GaussianMixture::new((0..count).map(|_| term(self)).collect())
    }
}

/// 1000 random products of four mixtures: the sum of the exact integrals of all terms equals the quadrature of the product of
/// the four sums, within 1e-12 of the sum of the absolute values that are added.
#[test]
fn products_of_four_mixtures_have_the_integral_of_quadrature() {
    let mut random = Random::new(17);
    let (mut worst, mut kappas, mut most) = (0.0_f64, Vec::new(), 0);
    for _ in 0..1000 {
        let factors: Vec<GaussianMixture> = (0..4).map(|_| random.mixture()).collect();
        let product = factors[1..].iter().fold(factors[0].clone(), |all, next| all.times(next));
        let shape = factors[1..].iter().fold(SpectralFunction::mixture(factors[0].clone()), |all, next| {
            all.times(&SpectralFunction::mixture(next.clone()))
        });
        let (min_nm, max_nm) = BAND_NM;
        let exact = product.band_integral(min_nm, max_nm);
        let sizes: f64 = product.terms().iter().map(|t| t.band_integral(min_nm, max_nm).abs()).sum();
        let off = (exact - shape.integral(min_nm, max_nm, 2.0)).abs() / sizes;
        assert!(off < 1e-12, "{off:e}: {factors:?}");
        let kappa = product.kappa(min_nm, max_nm);
        assert!((kappa * exact.abs() / sizes - 1.0).abs() < 1e-9, "{kappa}");
        (worst, most) = (worst.max(off), most.max(product.terms().len()));
        kappas.push(kappa);
    }
    kappas.sort_by(f64::total_cmp);
    println!("worst {worst:e} of the sum of sizes; up to {most} terms");
    println!("kappa: least {:.3}, median {:.3}, largest {:.3e}", kappas[0], kappas[500], kappas[999]);
    assert!(most > 1000);
}

/// The second moment of samples equals that of all choices within four of its own standard errors, which follow from the fourth
/// moment.
#[test]
fn one_term_samples_have_the_computed_second_moment() {
    const SAMPLES: usize = 20_000;
    let mut random = Random::new(23);
    let mut worst = 0.0_f64;
    for _ in 0..20 {
        let factors: Vec<GaussianMixture> = (0..4).map(|_| random.mixture()).collect();
        let one_term = OneTerm::new(factors, BAND_NM.0, BAND_NM.1).expect("terms within the band");
        let (mean, deviation) = one_term.moments();
        let second = deviation * deviation + mean * mean;
        let (mut sums, mut choice) = ([0.0; 3], vec![0.0; one_term.numbers()]);
        for _ in 0..SAMPLES {
            choice.iter_mut().for_each(|u| *u = random.number());
            let value = one_term.estimate(&choice);
            let square = value * value;
            sums[0] += value;
            sums[1] += square;
            sums[2] += square * square;
        }
        let [first, square, fourth] = sums.map(|sum| sum / SAMPLES as f64);
        let root = (SAMPLES as f64).sqrt();
        let error_of_mean = (first - mean).abs() / (deviation / root);
        let error_of_square = (square - second).abs() / ((fourth - square * square).max(0.0).sqrt() / root);
        assert!(error_of_mean < 4.0 && error_of_square < 4.0, "{error_of_mean} {error_of_square}");
        worst = worst.max(error_of_mean).max(error_of_square);
    }
    println!("worst of 40: {worst:.2} standard errors");
}
