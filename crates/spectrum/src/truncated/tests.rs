use super::*;
use spectra_core::numbers::Numbers;

/// Centers and widths that a scene may hold, and worse.
const CENTERS: [f64; 11] = [-1e9, -20_000.0, 0.0, 379.9, 380.0, 420.5, 580.0, 779.99, 800.0, 3000.0, 1e9];
const WIDTHS: [f64; 10] = [1e-6, 0.01, 0.3, 1.0, 5.0, 40.0, 200.0, 1000.0, 10_000.0, 1e6];

fn on_visible(center: f64, sigma: f64) -> TruncatedGaussian {
    TruncatedGaussian::new(center, sigma, 380.0, 780.0).expect("valid")
}

/// Quantiles .1, .5 and .9, mean, standard deviation and mass on 380-780 nm, computed twice by other programs.
#[test]
fn truncated_gaussian_table() {
    for (center, sigma, quantiles, mean, deviation, mass) in [
        (550.0, 50.0, [486.0087, 550.0210, 614.0866], 550.06112, 49.89391, 0.999661),
        (700.0, 120.0, [529.9244, 661.9749, 753.8320], 650.29262, 84.95317, 0.743677),
        (400.0, 30.0, [386.5739, 409.6578, 443.2388], 412.82053, 21.89117, 0.747507),
    ] {
        let g = on_visible(center, sigma);
        for (u, want) in [0.1, 0.5, 0.9].into_iter().zip(quantiles) {
            assert!((g.quantile(u) - want).abs() < 0.5e-4, "{center} {u}: {}", g.quantile(u));
        }
        assert!((g.mean() - mean).abs() < 0.5e-5, "{center}: {}", g.mean());
        assert!((g.standard_deviation() - deviation).abs() < 0.5e-5, "{center}: {}", g.standard_deviation());
        assert!((g.mass() - mass).abs() < 0.5e-6, "{center}: {}", g.mass());
    }
}

/// The share below a quantile is u: for every width and center, and near both ends of [0, 1).
#[test]
fn quantile_inverts_the_cumulative() {
    let mut worst = 0.0_f64;
    for center in CENTERS {
        for sigma in WIDTHS {
            let g = on_visible(center, sigma);
            let mut before = 380.0;
            for i in 0..=2000 {
                let u = match i {
                    0..=40 => libm::exp(f64::from(i - 41)),
                    1960..=2000 => 1.0 - libm::exp(f64::from(1959 - i)),
                    _ => f64::from(i) / 2000.0,
                };
                let x = g.quantile(u);
                assert!((380.0..=780.0).contains(&x), "{center} {sigma} {u}: {x}");
                assert!(i == 41 || i == 1960 || x >= before, "{center} {sigma} {u}: not monotone");
                before = x;
                // What roundings hide: two units in the last place of the wavelength, and of sigma or a far center.
                let step = 2.3e-13 + 4.5e-16 * (center.abs().min(26.0 * sigma) + 2.0 * sigma);
                let (low, high) = (g.cumulative(x - step), g.cumulative(x + step));
                let off = (low - u).max(u - high);
                assert!(off < 1e-13, "{center} {sigma} {u}: {off:e}, {low} {high}");
                if sigma >= 0.3 && center.abs() < 1e4 {
                    worst = worst.max(off);
                }
            }
        }
    }
    println!("largest |cumulative(quantile(u)) - u| beyond the rounding of the wavelength: {worst:e}");
}

#[test]
fn no_width_or_center_gives_nan() {
    for center in CENTERS {
        for sigma in WIDTHS {
            let g = on_visible(center, sigma);
            for u in [0.0, 1e-300, 1e-16, 0.3, 0.5, 1.0 - f64::EPSILON / 2.0, 1.0, -1.0, 2.0, f64::NAN] {
                assert!((380.0..=780.0).contains(&g.quantile(u)), "{center} {sigma} {u}");
            }
            let (mean, deviation) = (g.mean(), g.standard_deviation());
            assert!((380.0..=780.0).contains(&mean), "{center} {sigma}: {mean}");
            // No density on a band is wider than half of it.
            assert!(deviation > 0.0 && deviation <= 200.0, "{center} {sigma}: {deviation}");
            for w in [380.0, 500.0, 780.0] {
                assert!(g.density(w).is_finite() && g.density(w) >= 0.0, "{center} {sigma} {w}");
            }
            assert_eq!([g.density(379.9), g.density(780.1), g.density(f64::NAN)], [0.0; 3]);
            assert!((0.0..=1.0).contains(&g.mass()));
        }
    }
}

/// Far out the Gaussian is an exponential: mean distance sigma^2 / distance, and as much standard deviation.
#[test]
fn far_tail_is_an_exponential() {
    let g = on_visible(-20_000.0, 10.0);
    let scale = 100.0 / 20_380.0;
    assert!(((g.mean() - 380.0) / scale - 1.0).abs() < 1e-5, "{}", g.mean());
    assert!((g.standard_deviation() / scale - 1.0).abs() < 1e-5);
    assert!(((g.quantile(0.5) - 380.0) / (scale * std::f64::consts::LN_2) - 1.0).abs() < 1e-5);
    // And from the other side, mirrored.
    let h = on_visible(21_160.0, 10.0);
    for u in [0.01, 0.3, 0.9] {
        assert!((h.quantile(u) - 1160.0 + g.quantile(1.0 - u)).abs() < 1e-9);
    }
}

/// Both algorithms, where they meet: the widths differ by 1e-6, so the quantiles do by about as much of their offset.
#[test]
fn algorithms_meet() {
    let sigma = 10.0;
    let near = on_visible(380.0 - (FAR - 1e-7) * sigma, sigma);
    let far = on_visible(380.0 - (FAR + 1e-7) * sigma, sigma);
    assert!(matches!((near.draw, far.draw), (Draw::Central(_), Draw::Tail(_))));
    for i in 1..100 {
        let u = f64::from(i) / 100.0;
        let (a, b) = (near.quantile(u) - 380.0, far.quantile(u) - 380.0);
        assert!((a / b - 1.0).abs() < 2e-8, "{u}: {a} {b}");
    }
}

/// Integral of the density by a different rule from that of the mass.
#[test]
fn density_has_integral_one() {
    for center in CENTERS {
        for sigma in [5.0, 40.0, 200.0, 10_000.0] {
            let g = on_visible(center, sigma);
            let reach = 45.0 * g.standard_deviation();
            let (low, high) = ((g.mean() - reach).max(380.0), (g.mean() + reach).min(780.0));
            let breaks: Vec<f64> = (0..=4000).map(|i| low + (high - low) * f64::from(i) / 4000.0).collect();
            let sum = cell::integral(|w| g.density(w), &breaks);
            // Where all of it lies within a few units in the last place of a wavelength, so do the nodes.
            let tolerance = 1e-9 + 1e-13 / g.standard_deviation();
            assert!((sum - 1.0).abs() < tolerance, "{center} {sigma}: {sum}");
        }
    }
}

/// Pearson's chi-square over 64 cells of equal probability, and Kolmogorov's distance, of random draws.
#[test]
fn draws_follow_the_density() {
    let n = 200_000;
    for (seed, (center, sigma)) in
        [(550.0, 50.0), (700.0, 120.0), (300.0, 9.0), (-5000.0, 100.0), (580.0, 10_000.0), (600.0, 0.01)]
            .into_iter()
            .enumerate()
    {
        let g = on_visible(center, sigma);
        let mut u = vec![0.0; n];
        Numbers::random(seed as u64 + 1).fill(Isa::detect(), 7, 0, 0, &mut u);
        let mut drawn = vec![0.0; n];
        g.draw(&u, &mut drawn, Isa::detect());
        drawn.sort_by(f64::total_cmp);
        let cumulative: Vec<f64> = drawn.iter().map(|w| g.cumulative(*w)).collect();
        let mut cells = [0.0_f64; 64];
        cumulative.iter().for_each(|c| cells[((c * 64.0) as usize).min(63)] += 1.0);
        let expected = n as f64 / 64.0;
        let chi: f64 = cells.iter().map(|c| (c - expected) * (c - expected) / expected).sum();
        // 63 degrees of freedom: mean 63, standard deviation 11.2.
        assert!((chi - 63.0).abs() < 4.0 * 11.2, "{center} {sigma}: chi-square {chi}");
        let distance = (0..n).map(|i| (cumulative[i] - (i as f64 + 0.5) / n as f64).abs()).fold(0.0, f64::max);
        // Kolmogorov's 99.9 % point.
        assert!(distance * (n as f64).sqrt() < 1.95, "{center} {sigma}: {distance}");
    }
}

#[test]
fn every_tier_draws_the_same_bits() {
    let u: Vec<f64> = (0..4099).map(|i| f64::from(i) / 4099.0).collect();
    for (center, sigma) in [(550.0, 50.0), (200.0, 10.0), (-5000.0, 40.0), (9000.0, 40.0)] {
        let g = on_visible(center, sigma);
        let want: Vec<u64> = u.iter().map(|u| g.quantile(*u).to_bits()).collect();
        for isa in Isa::available() {
            let mut drawn = vec![0.0; u.len()];
            g.draw(&u, &mut drawn, isa);
            assert!(drawn.iter().zip(&want).all(|(d, w)| d.to_bits() == *w), "{center} {}", isa.name());
        }
    }
}

#[test]
fn impossible_parameters_are_refused() {
    for (center, sigma, min, max) in [
        (f64::NAN, 1.0, 380.0, 780.0),
        (550.0, 0.0, 380.0, 780.0),
        (550.0, f64::INFINITY, 380.0, 780.0),
        (550.0, 1.0, 780.0, 380.0),
        (550.0, 1.0, 500.0, 500.0),
        (550.0, 1.0, -1.0, 500.0),
        (1e10, 1.0, 380.0, 780.0),
    ] {
        assert!(TruncatedGaussian::new(center, sigma, min, max).is_err(), "{center} {sigma} {min} {max}");
    }
}

/// At least 40 million draws a second on one thread, the uniform numbers not counted.
#[test]
#[ignore = "measures speed: cargo test --release -p spectra-spectrum -- --ignored --nocapture draws_per_second"]
fn draws_per_second() {
    let mut u = vec![0.0; 4096];
    let mut drawn = vec![0.0; 4096];
    Numbers::random(5).fill(Isa::detect(), 0, 0, 0, &mut u);
    for isa in Isa::available() {
        for (center, sigma) in [(550.0, 50.0), (200.0, 9.0), (-5000.0, 40.0)] {
            let g = on_visible(center, sigma);
            let start = std::time::Instant::now();
            let mut sum = 0.0;
            for _ in 0..25_000 {
                g.draw(&u, &mut drawn, isa);
                sum += drawn[17];
            }
            let rate = 4096.0 * 25_000.0 / start.elapsed().as_secs_f64() / 1e6;
            println!("{} {center} {sigma}: {rate:.0} M/s ({sum:.1})", isa.name());
            // Narrower tiers are printed beside it, for the record.
            assert!(isa < Isa::detect() || rate >= 40.0, "{} {center} {sigma}: {rate} M/s", isa.name());
        }
    }
}
