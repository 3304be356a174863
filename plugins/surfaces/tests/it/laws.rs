//! Every built-in surface passes the checks that apply to all surfaces.

use spectra_plugin_surfaces as _;
use spectra_testing::{SurfaceLaws, surface};

fn hold(laws: SurfaceLaws, all: &[&str]) {
    for yaml in all {
        println!("{yaml}"); // shown where a law fails
        laws.hold(&*surface(yaml));
    }
}

#[test]
fn smooth_surfaces() {
    let all = [
        "{kind: plane}",
        "{kind: stop}",
        "{kind: conic, radius: 60, conic: -1}",
        "{kind: conic, radius: -45, conic: 0.5}",
        "{kind: conic, radius: 30, conic: -2.3}",
        "{kind: even-asphere, radius: 60, conic: -1.5, coefficients: [1e-4, 2e-6, -3e-9]}",
        "{kind: odd-asphere, radius: -50, coefficients: [0, 0, 0, 2e-6]}",
        "{kind: cylinder, radius: 45, axis: x}",
        "{kind: cylinder, radius: -45, axis: y}",
        "{kind: toroid, radius: 50, rotation-radius: -70}",
        "{kind: biconic, radius-x: 50, radius-y: -80}",
        "{kind: zernike, radius: 50, normalization-radius: 12, coefficients: [0, 0, 0, 0, 0, 0.03], ordering: noll}",
    ];
    hold(SurfaceLaws::default(), &all);
}

/// The kernel of the sphere is tuned for the distances within a lens: it loses digits with the square of the distance.
#[test]
fn spheres_from_near() {
    let near = SurfaceLaws { farthest_mm: 50.0, ..SurfaceLaws::default() };
    hold(near, &["{kind: sphere, radius: 40}", "{kind: sphere, radius: -25}"]);
}

#[test]
fn surfaces_whose_vertex_is_not_across_the_axis() {
    let tilted = SurfaceLaws { smooth_vertex: false, ..SurfaceLaws::default() };
    hold(
        tilted,
        &["{kind: tilted-plane, tilt-x: 20, tilt-y: -10}", "{kind: odd-asphere, radius: inf, coefficients: [0.05]}"],
    );
}

#[test]
fn surfaces_with_a_law_of_their_own() {
    let own = SurfaceLaws { snell: false, ..SurfaceLaws::default() };
    hold(own, &["{kind: grating, lines-per-mm: 100, order: 1}"]);
    // An ideal lens is not reversible if the media in front and behind differ.
    hold(SurfaceLaws { reversible: true, ..own }, &["{kind: thin-lens, focal-length: 50}"]);
}
