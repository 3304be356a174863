//! Strategies built from the text of a scene, through the registry.

use crate::world::{draw, light, sobol, system, xyz};
use spectra_core::params::{Faults, Params};
use spectra_core::registry::{self, Context};
use spectra_core::spectral::BAND;
use spectra_core::stage::WavelengthSampler;
use spectra_scene::{FileResources, yaml};

fn build(text: &str) -> Result<Box<dyn WavelengthSampler>, Faults> {
    let files = FileResources::beside("/nowhere".as_ref());
    let params = Params::stage(yaml::parse_bytes("scene.yaml", text.as_bytes())?, "wavelengths")?;
    registry::build(&params, &Context::new(&files, BAND))
}

#[test]
fn every_kind_is_built_from_a_scene() {
    let daylight = system(light("D65"), xyz());
    for text in [
        "{}",
        "kind: source-times-response",
        "kind: uniform",
        "{kind: stratified, strata: 100}",
        "{kind: inverse-transform, spectrum: y-bar}",
        "{kind: inverse-transform, spectrum: D65, floor: 0}",
        "{kind: inverse-transform, spectrum: 'gaussian:550,50', floor: 10 %}",
        "{kind: truncated-gaussian, center: 550 nm, sigma: 0.06 um}",
        "{kind: gaussian-terms, terms: 3, follow: term-then-wavelength}",
        "{kind: gaussian-terms}",
        "{kind: gaussian-terms, follow: one-term}",
        "kind: hero",
        "{kind: hero, group: 8, density: uniform}",
        "{kind: hero, density: {kind: truncated-gaussian, center: 550, sigma: 60}}",
    ] {
        let sampler = build(text).unwrap_or_else(|e| panic!("{text}: {e}"));
        let density = sampler.prepare(&daylight).unwrap_or_else(|e| panic!("{text}: {e}"));
        assert!(draw(density.as_ref(), &sobol(0, 64)).weight.iter().all(|w| w.is_finite()), "{text}");
    }
    assert!(build("kind: lines").expect("built").prepare(&system(light("mercury"), xyz())).is_ok());
    registry::check().expect("well-formed names");
}

#[test]
fn faults_name_the_key_and_the_reason() {
    for (text, wanted) in [
        ("{kind: uniform, strata: 3}", "unknown key `strata`"),
        ("{kind: stratified, strata: 0}", "found 0, which is out of range"),
        ("{kind: inverse-transform}", "missing key `spectrum`"),
        ("{kind: inverse-transform, spectrum: mercury}", "lines only"),
        ("{kind: inverse-transform, spectrum: nowhere}", "nowhere"),
        ("{kind: inverse-transform, spectrum: D65, floor: 100 %}", "a ratio from 0 to below 1"),
        ("{kind: truncated-gaussian, center: 550, sigma: 1e9}", "standard deviation"),
        ("{kind: truncated-gaussian, center: 550, sigma: -1}", "a positive wavelength"),
        ("{kind: gaussian-terms, terms: 33}", "found 33, which is out of range"),
        ("{kind: gaussian-terms, follow: two-terms}", "two-terms"),
        ("{kind: hero, group: 1}", "found 1, which is out of range"),
        ("{kind: hero, density: hero}", "a group cannot contain groups"),
        ("{kind: hero, density: unifrom}", "did you mean `uniform`"),
        ("{kind: hero, density: {kind: stratified, strata: 0}}", "found 0, which is out of range"),
    ] {
        let faults = build(text).err().unwrap_or_else(|| panic!("{text} was built")).to_string();
        assert!(faults.contains(wanted) && faults.starts_with("scene.yaml:1:"), "{text}: {faults}");
    }
}
