//! Checks that every built-in sampler obeys the laws of samplers.

use spectra_plugin_samplers as _;
use spectra_testing::{SamplerLaws, wavelengths};

#[test]
fn strategies_with_a_density() {
    for yaml in [
        "{kind: source-times-response}",
        "{kind: uniform}",
        "{kind: stratified}",
        "{kind: lines}",
        "{kind: inverse-transform, spectrum: D65}",
        "{kind: truncated-gaussian, center: 550, sigma: 80}",
        "{kind: gaussian-terms}",
        "{kind: hero}",
    ] {
        println!("{yaml}"); // shown where a law fails
        SamplerLaws::default().hold(&*wavelengths(yaml));
    }
}
