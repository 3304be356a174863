//! Lights, channels and strategies that all tests share.

use spectra_core::isa::Isa;
use spectra_core::numbers::Numbers;
use spectra_core::spectral::{BAND, Channel, SpectralPower, SystemResponse};
use spectra_core::stage::{WavelengthDensity, WavelengthSampler};
use spectra_film::stock::Stock;
use spectra_plugin_samplers::{
    Floor, Follow, GaussianTerms, Hero, InverseTransform, Lines, SourceTimesResponse, Stratified,
    TruncatedGaussianSampler, Uniform,
};
use spectra_scene::FileResources;
use spectra_spectrum::{Observer, find_emission};
use std::sync::Arc;

/// Line number that marks a wavelength from the continuum.
pub use spectra_core::batch::CONTINUUM;

pub fn light(name: &str) -> SpectralPower {
    find_emission(name).expect("bundled").to_power(&BAND)
}

/// Returns FL11 with the lines of the mercury lamp added; about half of Y is in lines.
pub fn mixed() -> SpectralPower {
    let (mut light, mercury) = (light("FL11"), light("mercury"));
    light.lines = mercury.scaled(0.02).lines;
    light
}

pub fn lights() -> [(&'static str, SpectralPower); 4] {
    [("D65", light("D65")), ("FL11", light("FL11")), ("mercury", light("mercury")), ("FL11+mercury", mixed())]
}

pub fn xyz() -> Vec<Channel> {
    let functions = Observer::cie_1931_2deg().on_grid(&BAND);
    let channel = |(name, response): (&str, Vec<f64>)| Channel { name: name.into(), unit: "lx".into(), response };
    ["X", "Y", "Z"].into_iter().zip(functions).map(channel).collect()
}

pub fn ortho_plus() -> Vec<Channel> {
    let files = FileResources::beside("/nowhere".as_ref());
    Stock::load("ilford-ortho-plus", &files).expect("bundled and sound").channels(&BAND).expect("seen")
}

pub fn imagers() -> [(&'static str, Vec<Channel>); 2] {
    [("XYZ", xyz()), ("Ortho Plus", ortho_plus())]
}

pub fn system(source: SpectralPower, channels: Vec<Channel>) -> SystemResponse {
    SystemResponse { grid: source.grid, source, channels: Arc::from(channels) }
}

pub fn y_bar(floor: Floor) -> InverseTransform {
    let spectrum = Observer::cie_1931_2deg().on_grid(&BAND)[1].clone();
    InverseTransform::new("y-bar", BAND, spectrum, floor).expect("sound")
}

/// Returns all strategies, each with usual parameters.
pub fn strategies() -> Vec<(&'static str, Box<dyn WavelengthSampler>)> {
    let terms = |follow| GaussianTerms::fitted(4, follow, Floor::default()).expect("in range");
    let gaussian = |center, sigma| TruncatedGaussianSampler::new(center, sigma, Floor::default()).expect("in range");
    vec![
        ("source-times-response", Box::new(SourceTimesResponse)),
        ("uniform", Box::new(Uniform)),
        ("stratified", Box::new(Stratified::new(64).expect("in range"))),
        ("lines", Box::new(Lines)),
        ("inverse-transform of y-bar", Box::new(y_bar(Floor::default()))),
        ("truncated-gaussian 550, 60", Box::new(gaussian(550.0, 60.0))),
        ("truncated-gaussian 900, 150", Box::new(gaussian(900.0, 150.0))),
        ("gaussian-terms, collapsed", Box::new(terms(Follow::Collapsed))),
        ("gaussian-terms, term then wavelength", Box::new(terms(Follow::TermThenWavelength))),
        ("gaussian-terms, one term", Box::new(terms(Follow::OneTerm))),
        ("hero", Box::new(Hero::new(4, Box::new(SourceTimesResponse)).expect("in range"))),
    ]
}

/// Drawn wavelengths with their lines and weights.
#[derive(Clone)]
pub struct Draws {
    pub wavelength_nm: Vec<f64>,
    pub line: Vec<u32>,
    pub weight: Vec<f64>,
}

pub fn draw(density: &dyn WavelengthDensity, u: &[f64]) -> Draws {
    let n = u.len();
    let mut draws = Draws { wavelength_nm: vec![0.0; n], line: vec![0; n], weight: vec![1.0; n] };
    density.draw(u, &mut draws.wavelength_nm, &mut draws.line, &mut draws.weight, Isa::detect());
    draws
}

/// Returns the exposure of each channel estimated from the samples, as a renderer sums them.
pub fn estimate(system: &SystemResponse, draws: &Draws) -> Vec<f64> {
    let mut sums = vec![0.0; system.channels.len()];
    for i in 0..draws.line.len() {
        let nm = draws.wavelength_nm[i];
        let power = match draws.line[i] {
            CONTINUUM => system.grid.interpolate(&system.source.continuum, nm),
            line => system.source.lines[line as usize].power,
        };
        for (sum, channel) in sums.iter_mut().zip(system.channels.iter()) {
            *sum += draws.weight[i] * power * system.grid.interpolate(&channel.response, nm);
        }
    }
    sums.iter().map(|s| s / draws.line.len() as f64).collect()
}

/// Returns the exposure of each channel by quadrature.
pub fn exact(system: &SystemResponse) -> Vec<f64> {
    system.channels.iter().map(|c| system.source.seen_by(&c.response)).collect()
}

/// Returns whether a strategy may refuse a source: because it has a continuum, or because terms cancel.
pub fn may_refuse(name: &str) -> bool {
    ["lines", "gaussian-terms, one term"].contains(&name)
}

/// Returns `n` Sobol numbers; if `n` is a power of 2, there is one in each of `n` equal parts of [0, 1), in random order.
pub fn sobol(seed: u64, n: usize) -> Vec<f64> {
    let mut u = vec![0.0; n];
    Numbers::sobol(seed).fill(Isa::detect(), 2, 0, 0, &mut u);
    u
}

/// Returns one number in each of `n` equal parts of [0, 1), at an independent place in each.
pub fn jittered(seed: u64, n: usize) -> Vec<f64> {
    let mut u = vec![0.0; n];
    Numbers::random(seed).fill(Isa::detect(), 1, 0, 0, &mut u);
    u.iter().enumerate().map(|(i, jitter)| (i as f64 + jitter) / n as f64).collect()
}
