//! Extreme widths and centers, densities with blind spots, and refused parameters.

use crate::world::{draw, estimate, exact, light, ortho_plus, system, xyz, y_bar};
use spectra_core::isa::Isa;
use spectra_core::numbers::Numbers;
use spectra_core::spectral::{BAND, SpectralPower};
use spectra_core::stage::WavelengthSampler;
use spectra_plugin_samplers::{
    Floor, Follow, GaussianTerms, InverseTransform, Lines, SourceTimesResponse, Stratified, TruncatedGaussianSampler,
    Uniform,
};
use spectra_spectrum::{GaussianMixture, GaussianTerm};

fn numbers() -> Vec<f64> {
    let mut u = vec![0.0; 1024];
    Numbers::sobol(1).fill(Isa::detect(), 0, 0, 0, &mut u);
    u.extend([0.0, 1e-300, 1e-16, 0.0625, 0.0625_f64.next_down(), 0.5, 1.0 - 0.5 * f64::EPSILON]);
    u
}

/// Widths from 0.01 to 10 000 nm, centers far outside the band and numbers at the ends of [0, 1) give finite positive weights.
#[test]
fn no_weight_is_infinite_or_nan() {
    for channels in [xyz(), ortho_plus()] {
        let system = system(light("D65"), channels);
        for center in [1e-3, 100.0, 349.0, 350.0, 425.3, 550.0, 830.0, 2000.0, 1e6] {
            for sigma in [0.01, 0.5, 20.0, 300.0, 10_000.0] {
                let term = GaussianTerm::new(1.0, center, sigma).expect("in range");
                let gaussian = TruncatedGaussianSampler::new(center, sigma, Floor::default()).expect("in range");
                let terms = GaussianTerms::given(GaussianMixture::new(vec![term]), Follow::Collapsed, Floor::default());
                for (name, sampler) in [("gaussian", &gaussian as &dyn WavelengthSampler), ("terms", &terms)] {
                    let density = match sampler.prepare(&system) {
                        Ok(density) => density,
                        // A Gaussian that does not reach the band, or the channels' response in it, is refused with the reason.
                        Err(text) => {
                            let reason =
                                if name == "terms" { "no Gaussian term reaches" } else { "does not reach what" };
                            assert!(text.message.contains(reason), "{name}: {text}");
                            continue;
                        }
                    };
                    let draws = draw(density.as_ref(), &numbers());
                    for (nm, weight) in draws.wavelength_nm.iter().zip(&draws.weight) {
                        assert!((350.0..=830.0).contains(nm), "{name} {center} {sigma}: {nm}");
                        assert!(*weight > 0.0 && weight.is_finite(), "{name} {center} {sigma}: {weight} at {nm}");
                    }
                    assert!(estimate(&system, &draws).iter().all(|e| e.is_finite() && *e > 0.0));
                }
            }
        }
    }
}

#[test]
fn ends_of_the_numbers_stay_in_the_band() {
    let stratified = Stratified::new(7).expect("in range");
    let all: [&dyn WavelengthSampler; 4] = [&SourceTimesResponse, &Uniform, &stratified, &y_bar(Floor::default())];
    for source in [light("D65"), light("mercury"), crate::world::mixed()] {
        let system = system(source, xyz());
        for sampler in all {
            let draws = draw(sampler.prepare(&system).expect("can be sampled").as_ref(), &numbers());
            assert!(draws.wavelength_nm.iter().all(|w| (350.0..=830.0).contains(w)));
            assert!(draws.weight.iter().all(|w| *w > 0.0 && w.is_finite()));
        }
    }
}

/// A density that would cause bias is refused, and the message says where.
#[test]
fn blind_densities_are_refused() {
    let daylight = system(light("D65"), xyz());
    let green: Vec<f64> = BAND.wavelengths_nm().map(|w| f64::from((500.0..=600.0).contains(&w))).collect();
    let blind = InverseTransform::new("green", BAND, green.clone(), Floor::NONE).expect("sound");
    let text = blind.prepare(&daylight).err().expect("refused").to_string();
    assert!(text.contains("`green` is zero at 350 nm"), "{text}");
    let mixed = InverseTransform::new("green", BAND, green, Floor::default()).expect("sound");
    assert!(mixed.prepare(&daylight).is_ok());
    assert!(y_bar(Floor::NONE).prepare(&daylight).is_ok());
    let narrow = TruncatedGaussianSampler::new(550.0, 5.0, Floor::NONE).expect("in range");
    assert!(narrow.prepare(&daylight).err().expect("refused").to_string().contains("add a `floor`"));
    let wide = TruncatedGaussianSampler::new(550.0, 100.0, Floor::NONE).expect("in range");
    assert!(wide.prepare(&daylight).is_ok());
    // 1 - 1.2 exp(...) is below 0 around 520 nm.
    let cancel = |peak| {
        GaussianMixture::new(vec![
            GaussianTerm::new(1.0, 560.0, 300.0).expect("in range"),
            GaussianTerm::new(peak, 520.0, 25.0).expect("in range"),
        ])
    };
    let signed = |peak, follow| GaussianTerms::given(cancel(peak), follow, Floor::NONE);
    assert!(
        signed(-1.2, Follow::TermThenWavelength)
            .prepare(&daylight)
            .err()
            .expect("refused")
            .to_string()
            .contains("cancel")
    );
    assert!(signed(-1.2, Follow::Collapsed).prepare(&daylight).is_ok());
    assert!(signed(-0.6, Follow::TermThenWavelength).prepare(&daylight).is_ok());
    assert!(Lines.prepare(&daylight).is_err());
}

/// A center of `540 mm` instead of nm, or outside the film's sensitivity, is refused: fifteen of sixteen rays would be lost silently.
#[test]
fn a_gaussian_far_from_what_is_seen_is_refused() {
    let ortho = system(light("D65"), ortho_plus());
    let refused = |center, sigma| {
        let sampler = TruncatedGaussianSampler::new(center, sigma, Floor::default()).expect("in range");
        sampler.prepare(&ortho).err()
    };
    for (center, sigma) in [(540e6, 60.0), (5400.0, 60.0), (780.0, 5.0)] {
        let text = refused(center, sigma).expect("refused").to_string();
        assert!(text.contains("set `center` to") && text.contains(&format!("{center} nm")), "{text}");
    }
    // A Gaussian that just reaches the sensitive range, one narrower than a cell, and a distant but wide one are accepted.
    for (center, sigma) in [(780.0, 60.0), (540.3, 0.01), (2000.0, 10_000.0)] {
        assert_eq!(refused(center, sigma), None, "{center} {sigma}");
    }
}

#[test]
fn parameters_out_of_range_are_refused() {
    assert!(Floor::new(1.0).is_none() && Floor::new(-0.1).is_none() && Floor::new(f64::NAN).is_none());
    assert!(Stratified::new(0).is_none() && Stratified::new(100_000).is_none());
    assert!(TruncatedGaussianSampler::new(550.0, 0.0, Floor::default()).is_err());
    assert!(TruncatedGaussianSampler::new(f64::NAN, 1.0, Floor::default()).is_err());
    assert!(GaussianTerms::fitted(0, Follow::Collapsed, Floor::default()).is_none());
    assert!(InverseTransform::new("x", BAND, vec![0.0; BAND.count], Floor::default()).is_none());
    assert!(InverseTransform::new("x", BAND, vec![-1.0; BAND.count], Floor::default()).is_none());
    assert!(InverseTransform::new("x", BAND, vec![1.0; 3], Floor::default()).is_none());
}

/// A source that is dark on the whole may be lit in places, so it can be sampled; the density follows the response.
#[test]
fn darkness_can_be_sampled() {
    let dark = system(SpectralPower::dark(BAND), xyz());
    for sampler in [&SourceTimesResponse as &dyn WavelengthSampler, &Uniform, &y_bar(Floor::default())] {
        let density = sampler.prepare(&dark).expect("can be sampled");
        assert_eq!(estimate(&dark, &draw(density.as_ref(), &numbers())), exact(&dark));
    }
    let mut blind = xyz();
    blind.iter_mut().for_each(|c| c.response.fill(0.0));
    assert!(SourceTimesResponse.prepare(&system(light("D65"), blind)).is_err());
}
