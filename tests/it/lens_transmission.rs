//! Tests the reflection of surfaces and the absorption of glass, ray by ray.

use glam::DVec3;
use spectra_core::{Isa, RayBatch};
use spectra_glass::Catalog;
use spectra_lens::{Coating, Lens};
use spectra_plugins as _;
use spectra_scene::FileResources;
use spectra_tracer::{Indices, Tracer, Travel};
use std::path::Path;

fn load(path: &Path) -> Lens {
    spectra_lens::load(&path.to_string_lossy(), &FileResources::beside(Path::new("."))).expect("a lens")
}

fn written(text: &str) -> Lens {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("lens.yaml");
    std::fs::write(&path, text).expect("written");
    load(&path)
}

fn biotar() -> Lens {
    load(&Path::new(env!("CARGO_MANIFEST_DIR")).join("lenses/zeiss-biotar-50-f1.4.yaml"))
}

/// A ray: its position, direction and wavelength in nm.
type Ray = (DVec3, DVec3, f64);

/// Returns rays with their weights where they leave the lens, or `None` for rays that end.
fn trace(lens: &Lens, rays: &[Ray], travel: Travel, isa: Isa) -> Vec<Option<(DVec3, DVec3, f64)>> {
    let tracer = Tracer::new(lens, Indices::Band { min_nm: 350.0, max_nm: 830.0 }).expect("media");
    let mut batch = RayBatch::new(rays.len()).on(isa);
    batch.restart(rays.len());
    let c = batch.columns_mut();
    for (i, (p, d, nm)) in rays.iter().enumerate() {
        (c.x[i], c.y[i], c.z[i]) = (*p).into();
        (c.l[i], c.m[i], c.n[i]) = (*d).into();
        c.wavelength_nm[i] = *nm;
    }
    tracer.trace(&mut batch, &mut tracer.work_in_place(rays.len()), travel);
    let (p, d) = (batch.positions(), batch.directions());
    (0..rays.len())
        .map(|i| {
            let at = |c: [&[f64]; 3]| DVec3::new(c[0][i], c[1][i], c[2][i]);
            batch.loss(i).is_none().then(|| (at(p), at(d), batch.weights()[i]))
        })
        .collect()
}

fn fan(count: usize) -> Vec<Ray> {
    let ray = |k: usize| {
        let k = k as f64;
        let d = DVec3::new(0.15 * k.sin(), 0.2 * (0.7 * k).cos(), 1.0).normalize();
        (DVec3::new(14.0 * (3.0 * k).cos(), 14.0 * (2.0 * k).sin(), -10.0), d, 380.0 + 400.0 * ((0.37 * k) % 1.0))
    };
    (0..count).map(ray).collect()
}

/// One plane into n = 1.5 has textbook reflectances of unpolarized light, checked to six decimals from s and p.
#[test]
fn a_plane_reflects_by_the_textbook() {
    let plane = written("name: p\ncoating: bare\nsurfaces:\n  - {kind: plane, thickness: 5, glass: {nd: 1.5}}\n");
    for (angle, s, p) in [(0.0, 0.04, 0.04), (30.0, 0.057796, 0.025249), (60.0, 0.176571, 0.001802)] {
        let (sin, cos) = f64::to_radians(angle).sin_cos();
        let ray = (DVec3::new(0.0, 0.0, -3.0), DVec3::new(0.6 * sin, 0.8 * sin, cos), 550.0);
        let (.., weight) = trace(&plane, &[ray], Travel::Forward, Isa::Baseline)[0].expect("it passes");
        assert!((weight - (1.0 - 0.5 * (s + p))).abs() < 1e-6, "{angle}: {weight}");
    }
}

/// N-BK7 at 550 nm, uncoated and under 99.6 nm of magnesium fluoride, with the catalog's index.
#[test]
fn a_layer_reflects_less() {
    for (coating, want) in [("bare", 0.042_388), ("{layer: 1.38, thickness: 99.6 nm}", 0.012_708_8)] {
        let text =
            format!("name: p\ncoating: {coating}\nsurfaces:\n  - {{kind: plane, thickness: 5, glass: SCHOTT/N-BK7}}\n");
        let ray = (DVec3::new(0.0, 0.0, -3.0), DVec3::Z, 550.0);
        let (.., weight) = trace(&written(&text), &[ray], Travel::Forward, Isa::Baseline)[0].expect("it passes");
        assert!((1.0 - weight - want).abs() < 5e-7, "{coating}: {weight}");
    }
}

/// The transmittance of the whole lens is the product of its surfaces, each at the angle to its own normal.
#[test]
fn surfaces_multiply() {
    let lens = Lens { absorption: false, ..biotar() };
    let layer = Coating::quarter_wave(1.38, 520.0);
    for coating in [Coating::Bare, layer, Coating::three_layer()] {
        let coated = lens.clone().with_coating(coating.clone());
        let rays = fan(200);
        let mut compared = 0;
        for (ray, out) in rays.iter().zip(trace(&coated, &rays, Travel::Forward, Isa::Baseline)) {
            let Some((.., weight)) = out else { continue };
            let path = Tracer::new(&lens, Indices::At(ray.2)).expect("media").path(ray.0, ray.1, ray.2);
            let mut want = 1.0;
            for (at, e) in lens.elements.iter().enumerate().filter(|(_, e)| e.medium_before != e.medium_after) {
                // For a sphere the normal points to the center.
                let center = DVec3::new(0.0, 0.0, e.vertex_z_mm() + 1.0 / e.vertex_curvature_per_mm().0);
                let (before, here) = (path.points[at], path.points[at + 1]);
                let cos = (here - before).normalize().dot((center - here).normalize()).abs();
                let (n, m) = (lens.index(e.medium_before, ray.2), lens.index(e.medium_after, ray.2));
                // Cemented surfaces have no coating.
                let here = if n > 1.1 && m > 1.1 { Coating::Bare } else { coating.clone() };
                want *= here.transmittance(n, m, cos, ray.2).mean();
            }
            assert!((weight - want).abs() < 1e-9, "{weight} {want}");
            compared += 1;
        }
        assert!(compared > 50, "{compared}");
    }
}

/// Light passes backward along a ray with the same weight as forward, and every instruction set gives the same bits. A lens with an
/// ideal coating keeps every weight.
#[test]
fn both_ways_and_all_tiers_alike() {
    let rays = fan(300);
    for coating in [Coating::Ideal, Coating::Bare, Coating::quarter_wave(1.38, 550.0), Coating::three_layer()] {
        let mut lens = biotar().with_coating(coating.clone());
        lens.absorption = coating != Coating::Ideal;
        let there = trace(&lens, &rays, Travel::Forward, Isa::Baseline);
        for isa in Isa::available() {
            assert_eq!(trace(&lens, &rays, Travel::Forward, isa), there, "{}", isa.name());
        }
        let passed: Vec<_> = there.iter().zip(&rays).filter_map(|(out, ray)| out.map(|out| (out, ray.2))).collect();
        assert!(passed.len() > 50);
        let back: Vec<Ray> = passed.iter().map(|((p, d, _), nm)| (*p, -*d, *nm)).collect();
        for (out, ((.., weight), _)) in trace(&lens, &back, Travel::Backward, Isa::Baseline).iter().zip(&passed) {
            let (.., again) = out.expect("the same way back");
            assert!((again - weight).abs() < 1e-11, "{again} {weight}");
            assert_eq!(*weight == 1.0, coating == Coating::Ideal);
        }
    }
}

/// A thick plate of a glass with known absorption, met obliquely, follows exp(-alpha path) of the catalog.
#[test]
fn glass_absorbs_along_the_path() {
    let plate = |absorption: bool| {
        written(&format!(
            "name: p\ncoating: ideal\nabsorption: {absorption}\nsurfaces:\n  - {{kind: plane, thickness: 40, glass: SCHOTT/N-SF11}}\n  \
             - {{kind: plane, thickness: 10}}\n"
        ))
    };
    let glass = Catalog::bundled().find("SCHOTT/N-SF11").expect("known");
    for nm in [395.0, 404.66, 436.0, 500.0] {
        for sin in [0.0, 0.5] {
            let ray = (DVec3::new(0.0, 0.0, -3.0), DVec3::new(0.0, sin, (1.0 - sin * sin).sqrt()), nm);
            let (.., weight) = trace(&plate(true), &[ray], Travel::Forward, Isa::Baseline)[0].expect("it passes");
            let inside = sin / glass.index(nm);
            let path_mm = 40.0 / (1.0 - inside * inside).sqrt();
            let want = glass.internal_transmittance(nm, path_mm).expect("known");
            // The tolerance is the difference between the table in steps of half a nanometer and the catalog's logarithmic
            // interpolation.
            assert!((weight / want - 1.0).abs() < 1e-3, "{nm} {sin}: {weight} {want}");
            assert!(want < 1.0);
            let (.., clear) = trace(&plate(false), &[ray], Travel::Forward, Isa::Baseline)[0].expect("it passes");
            assert_eq!(clear, 1.0);
        }
    }
}

/// A mirror has its stated reflectance, and the coating of a surface has priority over that of the lens.
#[test]
fn surfaces_have_their_own() {
    let mirror = written(
        "name: m\nsurfaces:\n  - {kind: sphere, radius: -100, mirror: true, reflectance: 88 %, thickness: -50}\n",
    );
    let ray = (DVec3::new(0.0, 1.0, -60.0), DVec3::Z, 550.0);
    let (.., weight) = trace(&mirror, &[ray], Travel::Forward, Isa::Baseline)[0].expect("it comes back");
    assert_eq!(weight, 0.88);
    let own = written(
        "name: o\ncoating: bare\nsurfaces:\n  - {kind: plane, thickness: 5, glass: {nd: 1.5}, coating: ideal}\n  \
         - {kind: plane, thickness: 5}\n",
    );
    let (.., weight) = trace(&own, &[ray], Travel::Forward, Isa::Baseline)[0].expect("it passes");
    assert!((weight - 0.96).abs() < 1e-12, "{weight}");
}
