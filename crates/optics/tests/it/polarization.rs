//! Polarized light, against closed forms.

use glam::DVec3;
use spectra_core::RayBatch;
use spectra_core::surface::{Kernel, Surface};
use spectra_glass::Medium;
use spectra_lens::{Coating, Displacement, Element, Lens, LensMedium};
use spectra_plugin_surfaces::Plane;
use spectra_tracer::{Indices, Path, Tracer, Travel};
use std::sync::Arc;

const N: f64 = 1.5168;

/// Plates of glass, each tilted about x and y by these angles, degrees, 50 mm apart.
fn plates(tilts_deg: &[[f64; 2]]) -> Lens {
    let mut lens = Lens::empty("plates");
    lens.media.push(LensMedium { medium: Medium::Constant(N), ..LensMedium::air() });
    let plane = || -> Arc<dyn Surface> { Arc::new(Kernel(Plane::refracting())) };
    for [x, y] in tilts_deg {
        // Both sides turn about their own vertices: they stay parallel.
        let displacement = Displacement { tilt_rad: [x.to_radians(), y.to_radians(), 0.0], ..Displacement::NONE };
        for (before, after, thickness_mm) in [(0, 1, 2.0), (1, 0, 50.0)] {
            lens.elements.push(Element { displacement, thickness_mm, ..Element::new("plane", plane(), before, after) });
        }
    }
    lens.arrange();
    lens.with_coating(Coating::Bare)
}

/// Fresnel's transmittances of one surface for s and p light at an angle of incidence in air, by the law of sines and tangents
/// (Born and Wolf 1.5.2, eq. 21a).
fn fresnel(angle_deg: f64) -> [f64; 2] {
    let a = angle_deg.to_radians();
    let b = (a.sin() / N).asin();
    let [r_s, r_p] = [((a - b).sin() / (a + b).sin()).powi(2), ((a - b).tan() / (a + b).tan()).powi(2)];
    [1.0 - r_s, 1.0 - r_p]
}

/// Traces one ray along z or against it, with the Stokes numbers Q, U, V about an axis at this angle from x. Returns its weight behind the
/// plates and its degree of polarization.
fn passes(lens: &Lens, travel: Travel, [q, u, v]: [f64; 3], axis_deg: f64) -> (f64, f64) {
    let tracer = Tracer::new(lens, Indices::At(587.56)).expect("media");
    let mut rays = RayBatch::new(1).with_polarization();
    rays.restart(1);
    let c = rays.columns_mut();
    let forward = travel == Travel::Forward;
    (c.x[0], c.y[0], c.z[0]) = (0.3, -0.2, if forward { -20.0 } else { 1.0 });
    (c.l[0], c.m[0], c.n[0]) = (0.0, 0.0, if forward { 1.0 } else { -1.0 });
    c.wavelength_nm[0] = 587.56;
    let p = c.polarization;
    (p.q[0], p.u[0], p.v[0]) = (q, u, v);
    if [q, u, v] != [0.0; 3] {
        let (sin, cos) = axis_deg.to_radians().sin_cos();
        (p.axis[0][0], p.axis[1][0]) = (cos, sin);
    }
    let mut work = tracer.work(1);
    tracer.trace(&mut rays, &mut work, travel);
    let p = rays.columns_mut().polarization;
    let degree = (p.q[0] * p.q[0] + p.u[0] * p.u[0] + p.v[0] * p.v[0]).sqrt();
    let axis = DVec3::new(p.axis[0][0], p.axis[1][0], p.axis[2][0]);
    assert!(axis == DVec3::ZERO || (axis.length() - 1.0).abs() < 1e-12 && axis.z.abs() < 1e-12, "{axis}");
    (rays.weights()[0], degree)
}

const NONE: [f64; 3] = [0.0; 3];

fn near(got: f64, want: f64) {
    assert!((got - want).abs() < 1e-12, "{got} {want}");
}

/// In a pile of plates s and p light pass all surfaces separately. The second plate therefore passes more than its mean transmittance of
/// what the first left, and at Brewster's angle all p light passes.
#[test]
fn a_pile_of_plates_polarizes() {
    for angle in [20.0, 45.0, N.atan().to_degrees(), 75.0] {
        let [s, p] = fresnel(angle);
        for count in [1, 2, 5] {
            let lens = plates(&vec![[angle, 0.0]; count]);
            let surfaces = 2 * count as i32;
            let (s, p) = (s.powi(surfaces), p.powi(surfaces));
            let (weight, degree) = passes(&lens, Travel::Forward, NONE, 0.0);
            near(weight, 0.5 * (s + p));
            near(degree, (p - s) / (p + s));
        }
    }
}

/// Two plates have planes of incidence at right angles: the s light of one is the p light of the other, and the light leaves
/// unpolarized again. The product of the mean transmittances, which plain batches use, is larger.
#[test]
fn crossed_plates_cancel() {
    let [s, p] = fresnel(60.0);
    let (weight, degree) = passes(&plates(&[[60.0, 0.0], [0.0, 60.0]]), Travel::Forward, NONE, 0.0);
    near(weight, (s * p).powi(2));
    near(degree, 0.0);
}

/// Malus's law: linearly polarized light at an angle to the plane of incidence splits by the squares of cosine and sine.
#[test]
fn linear_light_splits_by_its_angle() {
    let [s, p] = fresnel(55.0);
    let lens = plates(&[[55.0, 0.0]]);
    for degrees in [0.0_f64, 25.0, 45.0, 90.0] {
        // The plate is tilted about x: s lies along x.
        let (weight, degree) = passes(&lens, Travel::Forward, [1.0, 0.0, 0.0], degrees);
        let along = degrees.to_radians().cos().powi(2);
        near(weight, along * s * s + (1.0 - along) * p * p);
        near(degree, 1.0);
    }
    // Circularly polarized light has no preferred angle.
    near(passes(&lens, Travel::Forward, [0.0, 0.0, 1.0], 17.0).0, 0.5 * (s * s + p * p));
}

/// Unpolarized light has the same weight in both directions, whatever the position of the plates; with coatings, too.
#[test]
fn it_is_the_same_both_ways() {
    for coating in
        [Coating::Bare, Coating::quarter_wave(1.38, 500.0), Coating::Layer { index: 2.1, thickness_nm: 90.0 }]
    {
        let lens = plates(&[[60.0, 0.0], [35.0, -40.0], [0.0, 55.0]]).with_coating(coating);
        let (there, back) = (passes(&lens, Travel::Forward, NONE, 0.0), passes(&lens, Travel::Backward, NONE, 0.0));
        assert!((there.0 - back.0).abs() < 1e-12 && there.1 > 0.01, "{there:?} {back:?}");
    }
}

/// A ghost in a plate at Brewster's angle: the reflected light is all s.
#[test]
fn what_brewster_reflects_is_one_state() {
    let angle = N.atan().to_degrees();
    let [s, _] = fresnel(angle);
    let lens = plates(&[[angle, 0.0]]);
    let tracer = Tracer::new(&lens, Indices::At(587.56)).expect("media");
    let mut rays = RayBatch::new(1).with_polarization();
    rays.restart(1);
    let c = rays.columns_mut();
    (c.x[0], c.y[0], c.z[0], c.l[0], c.m[0], c.n[0]) = (0.0, 0.0, -20.0, 0.0, 0.0, 1.0);
    c.wavelength_nm[0] = 587.56;
    let ghost = Path::reflected(2, Travel::Forward, &[1, 0]).expect("a path");
    tracer.follow(&tracer.route(&ghost), &mut rays, &mut tracer.work(1));
    // Into the plate, back and forth in it, out of it.
    near(rays.weights()[0], 0.5 * s * s * (1.0 - s) * (1.0 - s));
    near(rays.columns_mut().polarization.q[0], 1.0);
}
