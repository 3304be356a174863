//! Tests of Gaussian-term strategies on a setup that two other programs computed: source G(560, 120) with and without
//! -0.3 G(600, 40), n equal filters G(560, 300) - 0.6 G(520, 25), detector G(445, 22) + G(560, 45), band 380-780 nm.

use crate::world::{draw, estimate, exact, light, sobol, system, xyz};
use spectra_core::isa::Isa;
use spectra_core::numbers::Numbers;
use spectra_core::spectral::{Channel, Grid, SpectralPower, SystemResponse};
use spectra_core::stage::WavelengthSampler;
use spectra_plugin_samplers::{Floor, Follow, GaussianTerms, OneTerm};
use spectra_spectrum::{GaussianMixture, GaussianTerm};

const BAND: (f64, f64) = (380.0, 780.0);

fn mixture(terms: &[[f64; 3]]) -> GaussianMixture {
    let term = |[a, c, s]: &[f64; 3]| GaussianTerm::new(*a, *c, *s).expect("in range");
    GaussianMixture::new(terms.iter().map(term).collect())
}

fn filter() -> GaussianMixture {
    mixture(&[[1.0, 560.0, 300.0], [-0.6, 520.0, 25.0]])
}

fn detector() -> GaussianMixture {
    mixture(&[[1.0, 445.0, 22.0], [1.0, 560.0, 45.0]])
}

fn one_term(n: usize) -> OneTerm {
    let mut factors = vec![mixture(&[[1.0, 560.0, 120.0]])];
    factors.extend(std::iter::repeat_n(filter(), n));
    factors.push(detector());
    OneTerm::new(factors, BAND.0, BAND.1).expect("reaches the band")
}

/// Exact second moments by enumeration agree with the computed figures to the printed digits.
#[test]
fn following_one_term_scatters_as_computed() {
    for (n, want, digit) in [(1, 1.1825, 1e-4), (2, 2.361, 1e-3), (4, 9.669, 1e-3), (8, 223.3, 0.1), (12, 5687.0, 1.0)]
    {
        let (mean, deviation) = one_term(n).moments();
        assert!((deviation / mean - want).abs() <= digit, "{n}: {}", deviation / mean);
    }
}

/// Following one term is unbiased with up to four filters; with more, the scatter is too large for samples to show it.
#[test]
fn following_one_term_is_unbiased() {
    for n in [1, 2, 3, 4] {
        let one_term = one_term(n);
        let (want, deviation) = one_term.moments();
        let source = mixture(&[[1.0, 560.0, 120.0]]).times(&detector());
        let whole = (0..n).fold(source, |product, _| product.times(&filter()));
        assert!((want / whole.band_integral(BAND.0, BAND.1) - 1.0).abs() < 1e-12);
        let samples = 200_000;
        let numbers = Numbers::random(17);
        let mut columns = vec![vec![0.0; samples]; one_term.numbers()];
        for (d, column) in columns.iter_mut().enumerate() {
            numbers.fill(Isa::detect(), 0, 0, d as u32, column);
        }
        let estimate = |i: usize| one_term.estimate(&columns.iter().map(|c| c[i]).collect::<Vec<_>>());
        let mean = (0..samples).map(estimate).sum::<f64>() / samples as f64;
        let error = deviation / (samples as f64).sqrt();
        println!("{n} filters: {:.2} standard errors", (mean - want) / error);
        assert!((mean - want).abs() < 3.0 * error, "{n}: {mean} {want} {error}");
    }
}

/// The relative standard deviation of one sample agrees with the computed figures within 5 %.
#[test]
fn terms_with_wavelengths_scatter_as_computed() {
    let source = mixture(&[[1.0, 560.0, 120.0], [-0.3, 600.0, 40.0]]);
    let grid = Grid { start_nm: BAND.0, step_nm: 1.0, count: 401 };
    let on_grid = |m: &GaussianMixture| grid.wavelengths_nm().map(|w| m.at(w)).collect::<Vec<_>>();
    let channel = Channel { name: "detector".into(), unit: "1".into(), response: on_grid(&detector()) };
    let power = SpectralPower { grid, continuum: on_grid(&source), lines: Vec::new() };
    let system = SystemResponse { grid, source: power, channels: [channel].into() };
    let samples = 1 << 20;
    let mut u = vec![0.0; samples];
    Numbers::sobol(4).fill(Isa::detect(), 0, 0, 0, &mut u);
    for (follow, wanted) in
        [(Follow::TermThenWavelength, [1.307, 1.653, 1.932, 2.164]), (Follow::Collapsed, [0.763, 0.966, 1.065, 1.121])]
    {
        let density = GaussianTerms::given(source.clone(), follow, Floor::NONE).prepare(&system).expect("can be drawn");
        let draws = draw(density.as_ref(), &u);
        for (n, want) in [1, 4, 8, 12].into_iter().zip(wanted) {
            let value = |i: usize| {
                let nm = draws.wavelength_nm[i];
                draws.weight[i] * source.at(nm) * filter().at(nm).powi(n) * detector().at(nm)
            };
            let (sum, squares) = (0..samples).map(value).fold((0.0, 0.0), |(s, q), v| (s + v, q + v * v));
            let (mean, square) = (sum / samples as f64, squares / samples as f64);
            let relative = (square / (mean * mean) - 1.0).sqrt();
            println!("{follow:?}, {n} filters: {relative:.3} ({want})");
            assert!((relative / want - 1.0).abs() < 0.05, "{follow:?}, {n}: {relative} {want}");
            let whole = (0..n).fold(source.times(&detector()), |product, _| product.times(&filter()));
            let exact = whole.band_integral(BAND.0, BAND.1);
            assert!(
                (mean / exact - 1.0).abs() < 3.0 * relative / (samples as f64).sqrt(),
                "{follow:?} {n} {mean} {exact}"
            );
        }
    }
}

/// Following one term of the source is unbiased even if daylight is fitted by a single Gaussian that misses it by far. The residual is
/// followed, too; otherwise the estimate would be that of the Gaussian.
#[test]
fn following_one_term_of_the_source_is_unbiased_however_bad_the_fit() {
    let system = system(light("D65"), xyz());
    let poor = mixture(&[[90.0, 540.0, 160.0]]);
    let density =
        GaussianTerms::given(poor.clone(), Follow::OneTerm, Floor::NONE).prepare(&system).expect("can be followed");
    let want = exact(&system);
    let (seeds, samples) = (1000, 64);
    let mut sums = vec![[0.0; 2]; want.len()];
    for seed in 0..seeds {
        let got = estimate(&system, &draw(density.as_ref(), &sobol(seed, samples)));
        for (sum, (got, want)) in sums.iter_mut().zip(got.iter().zip(&want)) {
            sum[0] += got / want - 1.0;
            sum[1] += (got / want - 1.0) * (got / want - 1.0);
        }
    }
    let of_fit: Vec<f64> = {
        let continuum = system.grid.wavelengths_nm().map(|w| poor.at(w)).collect();
        let power = SpectralPower { grid: system.grid, continuum, lines: Vec::new() };
        system.channels.iter().map(|c| power.seen_by(&c.response)).collect()
    };
    for (c, [sum, squares]) in sums.into_iter().enumerate() {
        let (mean, n) = (sum / seeds as f64, seeds as f64);
        let error = ((squares / n - mean * mean) / (n - 1.0)).sqrt();
        let fit = of_fit[c] / want[c] - 1.0;
        println!("{}: {:.2} standard errors; the fit alone {:.0}", system.channels[c].name, mean / error, fit / error);
        assert!(mean.abs() < 3.0 * error, "{c}: {mean:e} +- {error:e}");
        assert!(fit.abs() > 10.0 * error, "{c}: the fit is too good to show anything");
    }
    // The usual fit of daylight can be followed; terms that cancel are refused with a reason.
    assert!(GaussianTerms::fitted(4, Follow::OneTerm, Floor::NONE).expect("in range").prepare(&system).is_ok());
    let cancel = mixture(&[[9e4, 540.0, 160.0], [-9e4, 540.0, 160.0]]);
    let refused = GaussianTerms::given(cancel, Follow::OneTerm, Floor::NONE).prepare(&system).err().expect("refused");
    assert!(refused.message.contains("cancel"), "{refused}");
}
