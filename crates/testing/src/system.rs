//! Systems of source and channels for tests of wavelength samplers.

use spectra_core::math::exp;
use spectra_core::spectral::{BAND, Channel, Line, SpectralPower, SystemResponse};

/// Returns systems of each sort, with names: a sloping continuum, a continuum with two lines, or lines alone, recorded by one broad
/// channel or by three narrow ones with gaps between them. Units are arbitrary.
#[must_use]
pub fn systems() -> Vec<(&'static str, SystemResponse)> {
    let table = |f: &dyn Fn(f64) -> f64| BAND.wavelengths_nm().map(f).collect::<Vec<f64>>();
    let bell = |center: f64, width: f64| move |w: f64| exp(-0.5 * ((w - center) / width) * ((w - center) / width));
    let channel = |name: &str, response: Vec<f64>| Channel { name: name.into(), unit: "lx s".into(), response };
    let slope = table(&|w| 0.5 + 0.003 * (w - 350.0));
    let lines = vec![Line { wavelength_nm: 435.84, power: 40.0 }, Line { wavelength_nm: 546.07, power: 90.0 }];
    let light = |continuum: &[f64], lines: &[Line]| SpectralPower {
        grid: BAND,
        continuum: continuum.to_vec(),
        lines: lines.to_vec(),
    };
    let broad = vec![channel("broad", table(&bell(540.0, 80.0)))];
    let three = vec![
        channel("blue", table(&|w| if (430.0..=470.0).contains(&w) { 1.0 } else { 0.0 })),
        channel("green", table(&bell(540.0, 20.0))),
        channel("red", table(&|w| if (600.0..=680.0).contains(&w) { (w - 600.0) / 80.0 } else { 0.0 })),
    ];
    let system =
        |source: SpectralPower, channels: &[Channel]| SystemResponse { grid: BAND, source, channels: channels.into() };
    let dark = vec![0.0; BAND.count];
    vec![
        ("a continuum, one channel", system(light(&slope, &[]), &broad)),
        ("a continuum, three channels", system(light(&slope, &[]), &three)),
        ("a continuum with lines", system(light(&slope, &lines), &broad)),
        ("lines alone", system(light(&dark, &lines), &broad)),
    ]
}
