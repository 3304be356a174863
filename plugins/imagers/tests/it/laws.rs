//! Every built-in imager passes the checks that apply to all imagers.

use spectra_plugin_imagers as _;
use spectra_testing::{ImagerLaws, imager};

fn hold(laws: ImagerLaws, all: &[&str]) {
    for yaml in all {
        println!("{yaml}"); // shown where a law fails
        laws.hold(&*imager(yaml));
    }
}

#[test]
fn flat_frames() {
    let all = [
        "{kind: xyz, format: 135, resolution: [96, 64]}",
        "{kind: xyz, width: 7.3, height: 2.1, resolution: [131, 17], exposure: 1/60 s}",
        "{kind: film, width: 56, height: 56, resolution: [50, 50]}",
        "{kind: spectral, bands: 20, format: 135, resolution: [30, 20]}",
    ];
    hold(ImagerLaws::default(), &all);
}

#[test]
fn frames_that_stand_otherwise() {
    let all = ["{kind: xyz, format: 135, resolution: [96, 64], tilt: [10, -5], shift: [2, 3]}"];
    hold(ImagerLaws { flat: false, ..ImagerLaws::default() }, &all);
}
