//! Rings on an asphere: deflections and brightness in a defocused spot against closed forms, and backward travel.

use glam::DVec3;
use spectra_core::RayBatch;
use spectra_lens::{Lens, OnionRings};
use spectra_plugin_surfaces as _;
use spectra_scene::FileResources;
use spectra_tracer::{Indices, Tracer, Travel};
use std::f64::consts::{PI, TAU};

const NM: f64 = 587.5618;
const PERIOD_MM: f64 = 0.4;
const HEIGHT_MM: f64 = 50e-6;

fn lens(last: &str) -> Result<Lens, String> {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("lens.yaml");
    let text = format!(
        "name: Rings\ncoating: ideal\nabsorption: false\nsurfaces:\n\
         - {{kind: sphere, radius: inf, thickness: 2, glass: {{nd: 1.5}}, semi-diameter: 10}}\n{last}\n"
    );
    std::fs::write(&path, text).expect("written");
    spectra_lens::load(path.to_str().expect("UTF-8"), &FileResources::beside(folder.path())).map_err(|f| f.to_string())
}

fn with_rings(radius: &str) -> Lens {
    lens(&format!(
        "- {{kind: sphere, radius: {radius}, thickness: 100, semi-diameter: 9, \
         onion-rings: {{period: {PERIOD_MM}, height: {HEIGHT_MM}}}}}"
    ))
    .unwrap_or_else(|faults| panic!("{faults}"))
}

/// Traces rays parallel to the axis at these heights forward through the lens. Returns positions and directions in the image plane.
fn traced(lens: &Lens, heights: &[f64]) -> Vec<(DVec3, DVec3)> {
    let tracer = Tracer::new(lens, Indices::Stated).expect("media");
    let mut rays = RayBatch::new(heights.len());
    rays.restart(heights.len());
    let c = rays.columns_mut();
    for (i, height) in heights.iter().enumerate() {
        (c.x[i], c.y[i], c.z[i]) = (0.6 * height, 0.8 * height, -1.0);
        (c.l[i], c.m[i], c.n[i]) = (0.0, 0.0, 1.0);
        (c.wavelength_nm[i], c.weight[i]) = (NM, 1.0);
    }
    tracer.trace(&mut rays, &mut tracer.work_in_place(heights.len()), Travel::Forward);
    let ([x, y, z], [l, m, n]) = (rays.positions(), rays.directions());
    let there = |i: usize| {
        let t = -z[i] / n[i];
        (DVec3::new(x[i] + t * l[i], y[i] + t * m[i], 0.0), DVec3::new(l[i], m[i], n[i]))
    };
    assert!((0..heights.len()).all(|i| rays.loss(i).is_none()));
    (0..heights.len()).map(there).collect()
}

/// Behind a plane a ray is turned by (n - 1) times the slope of the rings, toward the thicker glass. At a
/// distance z the light has the density 1 / (1 + z (n - 1) h'') where it lands: bright and dark rings.
#[test]
fn a_parallel_beam_gets_rings() {
    let lens = with_rings("inf");
    let curvature = |r: f64| -2.0 * PI * PI * HEIGHT_MM / (PERIOD_MM * PERIOD_MM) * (TAU * r / PERIOD_MM).cos();
    let rings = OnionRings { period_mm: PERIOD_MM, height_mm: HEIGHT_MM };
    let (mut most, mut least) = (0.0_f64, f64::INFINITY);
    for k in 0..60 {
        let r = 3.0 + 0.02 * f64::from(k);
        let step = 1e-4;
        let at = traced(&lens, &[r - step, r, r + step]);
        // Snell's law differs from its linear part by 3e-7 of these slopes.
        let turned = at[1].1.truncate().length() * at[1].1.dot(DVec3::new(0.6, 0.8, 0.0)).signum();
        assert!((turned - 0.5 * rings.slope(r)).abs() < 1e-9, "{r}: {turned} {}", 0.5 * rings.slope(r));
        let density = 2.0 * step / (at[2].0.length() - at[0].0.length());
        let want = 1.0 / (1.0 + 100.0 * 0.5 * curvature(r));
        assert!((density / want - 1.0).abs() < 1e-3, "{r}: {density} {want}");
        (most, least) = (most.max(density), least.min(density));
    }
    // The contrast is visible.
    assert!(most > 1.3 && least < 0.8, "{most} {least}");
}

/// Light that travels backward follows the same path.
#[test]
fn the_way_back_is_the_same() {
    let lens = with_rings("-80");
    let heights = [0.3, 2.1, 4.77, 7.9];
    let there = traced(&lens, &heights);
    let tracer = Tracer::new(&lens, Indices::Stated).expect("media");
    let mut rays = RayBatch::new(heights.len());
    rays.restart(heights.len());
    let c = rays.columns_mut();
    for (i, (at, way)) in there.iter().enumerate() {
        (c.x[i], c.y[i], c.z[i]) = (*at).into();
        (c.l[i], c.m[i], c.n[i]) = (-*way).into();
        (c.wavelength_nm[i], c.weight[i]) = (NM, 1.0);
    }
    tracer.trace(&mut rays, &mut tracer.work_in_place(heights.len()), Travel::Backward);
    for (i, height) in heights.iter().enumerate() {
        let [l, m, n] = rays.directions().map(|column| column[i]);
        assert!(l.abs() < 1e-13 && m.abs() < 1e-13 && n < 0.0, "{l} {m}");
        let [x, y, _] = rays.positions().map(|column| column[i]);
        assert!((x - 0.6 * height).abs() < 1e-11 && (y - 0.8 * height).abs() < 1e-11);
    }
}

#[test]
fn rings_belong_on_glass() {
    let fault = lens("- {kind: stop, thickness: 1, semi-diameter: 5, onion-rings: {period: 0.2, height: 20 nm}}");
    assert!(fault.is_err_and(|fault| fault.contains("onion-rings")));
}
