//! Every built-in source that needs no file passes the checks that apply to all sources.

use spectra_plugin_colors as _;
use spectra_plugin_sources as _;
use spectra_testing::{SourceLaws, assert_fault, source};

#[test]
fn charts_emit_what_they_answer_for() {
    let laws = SourceLaws { extent_mm: 700.0, aperture_mm: 20.0, ..SourceLaws::default() };
    for yaml in [
        "{kind: chart, chart: gray-card, distance: 2 m, width: 1 m, illuminant: D65, luminance: 300 cd/m2}",
        "{kind: chart, chart: siemens, distance: 1 m, width: 0.8 m, illuminant: D65, luminance: 300 cd/m2}",
        "{kind: chart, chart: color-checker, distance: 2 m, width: 1 m, illuminant: FL11, luminance: 300 cd/m2}",
    ] {
        println!("{yaml}"); // shown where a law fails
        laws.hold(&*source(yaml));
    }
}

#[test]
fn points_and_beams_emit() {
    for yaml in [
        "{kind: point, distance: 2 m, spectrum: mercury}",
        "{kind: beam, distance: 10, diameter: 1 mm, direction: [5, -3]}",
    ] {
        println!("{yaml}");
        SourceLaws::default().hold(&*source(yaml));
    }
    assert_fault("source", "{kind: point, distance: -2 m}", "distance");
}
