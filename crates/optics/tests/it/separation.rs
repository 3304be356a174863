//! Separated cement: the transmittance and reflectance of a gap of air, checked with Airy's sum over all its reflections and with the
//! positions of fringes.

use spectra_core::RayBatch;
use spectra_lens::{Lens, Separation};
use spectra_plugin_surfaces as _;
use spectra_scene::FileResources;
use spectra_tracer::{Indices, Path, Tracer, Travel};
use std::f64::consts::TAU;

const NM: f64 = 587.5618;
const N: [f64; 2] = [1.5, 1.8];
const EDGE_MM: f64 = 10.0;

/// Loads a lens of two glasses that meet in a plane with the extra keys `rest`, behind a front of this radius and in front of a third
/// glass.
fn lens(front: &str, rest: &str) -> Result<Lens, String> {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("lens.yaml");
    let text = format!(
        "name: Apart\ncoating: ideal\nabsorption: false\nsurfaces:\n\
         - {{kind: sphere, radius: {front}, thickness: 10, glass: {{nd: {}}}, semi-diameter: {EDGE_MM}}}\n\
         - {{kind: sphere, radius: inf, thickness: 2, glass: {{nd: {}}}, semi-diameter: {EDGE_MM}{rest}}}\n\
         - {{kind: sphere, radius: inf, thickness: 50, glass: {{nd: 1.7}}, semi-diameter: {EDGE_MM}}}\n",
        N[0], N[1]
    );
    std::fs::write(&path, text).expect("written");
    spectra_lens::load(path.to_str().expect("UTF-8"), &FileResources::beside(folder.path())).map_err(|f| f.to_string())
}

fn loaded(front: &str, rest: &str) -> Lens {
    lens(front, rest).unwrap_or_else(|faults| panic!("{faults}"))
}

/// Returns the weights behind a path of light that enters parallel to the axis at these heights, with or without Stokes numbers.
fn weights(lens: &Lens, heights_mm: &[f64], path: Option<&Path>, polarized: bool) -> Vec<f64> {
    let tracer = Tracer::new(lens, Indices::Stated).expect("media");
    let count = heights_mm.len();
    let mut rays = RayBatch::new(count);
    if polarized {
        rays = rays.with_polarization();
    }
    rays.restart(count);
    let c = rays.columns_mut();
    for (i, height) in heights_mm.iter().enumerate() {
        (c.x[i], c.y[i], c.z[i]) = (0.6 * height, 0.8 * height, -1.0);
        (c.l[i], c.m[i], c.n[i]) = (0.0, 0.0, 1.0);
        (c.wavelength_nm[i], c.weight[i]) = (NM, 1.0);
    }
    let mut work = tracer.work_in_place(count);
    match path {
        Some(path) => tracer.follow(&tracer.route(path), &mut rays, &mut work),
        None => tracer.trace(&mut rays, &mut work, Travel::Forward),
    }
    (0..count).map(|i| if rays.loss(i).is_none() { rays.weights()[i] } else { 0.0 }).collect()
}

type Complex = [f64; 2];

fn times(a: Complex, b: Complex) -> Complex {
    [a[0] * b[0] - a[1] * b[1], a[0] * b[1] + a[1] * b[0]]
}

fn over(a: Complex, b: Complex) -> Complex {
    let size = b[0] * b[0] + b[1] * b[1];
    times(a, [b[0] / size, -b[1] / size])
}

fn add(a: Complex, b: Complex) -> Complex {
    [a[0] + b[0], a[1] + b[1]]
}

/// Reflectance of unpolarized light at a gap, from the first glass at this sine of incidence: Airy's sum of all reflections in the gap
/// (Born and Wolf, 7.6), with complex cosines, so that it also holds beyond the critical angle.
fn airy(gap_nm: f64, sine: f64) -> f64 {
    let n = [N[0], 1.0, N[1]];
    // Where light decays, its cosine is -i times a positive number.
    let cosine = n.map(|n| {
        let square = 1.0 - (N[0] * sine / n) * (N[0] * sine / n);
        if square >= 0.0 { [square.sqrt(), 0.0] } else { [0.0, -(-square).sqrt()] }
    });
    let phase = [2.0 * TAU * gap_nm / NM * cosine[1][0], 2.0 * TAU * gap_nm / NM * cosine[1][1]];
    // exp(-i phase)
    let turn = [phase[1].exp() * phase[0].cos(), -phase[1].exp() * phase[0].sin()];
    let reflectance = |p: bool| {
        let at = |k: usize| cosine[k].map(|c| if p { c / n[k] } else { c * n[k] });
        let r = |a: Complex, b: Complex| over(add(a, b.map(|b| -b)), add(a, b));
        let (first, second) = (r(at(0), at(1)), times(r(at(1), at(2)), turn));
        let all = over(add(first, second), add([1.0, 0.0], times(first, second)));
        all[0] * all[0] + all[1] * all[1]
    };
    0.5 * (reflectance(false) + reflectance(true))
}

#[test]
fn a_gap_passes_and_reflects_what_airys_sum_says() {
    for gap_nm in [20.0, 147.0, 294.0, 1000.0, 20_000.0] {
        let apart = loaded("inf", &format!(", separation: {{gap: {} nm}}", gap_nm));
        let back = airy(gap_nm, 0.0);
        let passed = weights(&apart, &[0.0, 3.0, 9.0], None, false);
        assert!(passed.iter().all(|w| (w - (1.0 - back)).abs() < 1e-9), "{gap_nm}: {passed:?} {back}");
        // The path up to the gap and back to the front.
        let up = Path::reflected(3, Travel::Forward, &[1]).expect("a path");
        let sent = weights(&apart, &[0.0, 3.0, 9.0], Some(&up), false);
        assert!(sent.iter().all(|w| (w - back).abs() < 1e-9), "{gap_nm}: {sent:?} {back}");
    }
}

/// Rays bent by a curved front meet the gap at an angle, near the edge beyond the angle of total reflection. There a narrow gap passes
/// the light that tunnels through it, a wide gap nothing.
#[test]
fn aslant_too_and_with_stokes_numbers() {
    let radius_mm = 10.001;
    // The last one meets it at 44.7 degrees; light from 41.8 degrees on would be reflected totally.
    let heights = [2.0, 5.0, 9.0, 9.99];
    for gap_nm in [60.0, 300.0, 5000.0] {
        let apart = loaded(&radius_mm.to_string(), &format!(", separation: {{gap: {} nm}}", gap_nm));
        let passed = weights(&apart, &heights, None, false);
        let polarized = weights(&apart, &heights, None, true);
        for (i, height) in heights.iter().enumerate() {
            let (outside, inside) = ((height / radius_mm).asin(), (height / radius_mm / N[0]).asin());
            let want = 1.0 - airy(gap_nm, (outside - inside).sin());
            assert!((passed[i] - want).abs() < 1e-7, "{gap_nm} {height}: {} {want}", passed[i]);
            assert!((polarized[i] - want).abs() < 1e-7, "{gap_nm} {height}: {} {want}", polarized[i]);
        }
    }
}

/// A wedge of air has bright fringes where its width is a whole number of half waves: the reflections of its two faces, of opposite
/// sign, cancel there as far as possible.
#[test]
fn a_wedge_has_newtons_rings() {
    let (gap_nm, depth_mm) = (1500.0, 6.0);
    let apart = loaded("inf", &format!(", separation: {{gap: {gap_nm} nm, depth: {depth_mm}}}"));
    let heights: Vec<f64> = (0..=2000).map(|i| 9.999 * f64::from(i) / 2000.0).collect();
    let passed = weights(&apart, &heights, None, false);
    let bright: Vec<f64> =
        (1..2000).filter(|i| passed[*i] > passed[i - 1] && passed[*i] >= passed[i + 1]).map(|i| heights[i]).collect();
    let want: Vec<f64> = (1..=5).map(|k| EDGE_MM - depth_mm * (1.0 - 0.5 * NM * f64::from(k) / gap_nm)).collect();
    assert_eq!(bright.len(), want.len(), "{bright:?} {want:?}");
    assert!(bright.iter().zip(&want).all(|(a, b)| (a - b).abs() < 0.01), "{bright:?} {want:?}");
    // Farther in than the depth, the cement holds.
    assert!(heights.iter().zip(&passed).all(|(height, w)| *height > EDGE_MM - depth_mm || *w == 1.0));
}

/// The gap lies where `where` says, forward and backward alike, and the tracer counts it as reflecting.
#[test]
fn it_lies_where_it_is_said_to() {
    let apart = loaded("inf", ", separation: {gap: 300 nm, where: {shape: ring, inner: 6}}");
    let passed = weights(&apart, &[5.9, 6.1], None, false);
    assert_eq!(passed[0], 1.0);
    assert!((passed[1] - (1.0 - airy(300.0, 0.0))).abs() < 1e-9);
    let reversed = apart.reversed().expect("no mirror, no prism");
    let back = weights(&reversed, &[5.9, 6.1], None, false);
    assert!(back.iter().zip(&passed).all(|(a, b)| (a - b).abs() < 1e-12), "{back:?} {passed:?}");
    let tracer = Tracer::new(&apart, Indices::Stated).expect("media");
    assert_eq!(tracer.reflecting(), [1]);
    let separation = Separation { gap_nm: 300.0, depth_mm: None, places: Vec::new() };
    assert_eq!(apart.with_separation(&separation).1, 2);
}

#[test]
fn only_cement_comes_apart() {
    let text = "name: Single\nsurfaces:\n- {kind: sphere, radius: 50, thickness: 4, glass: {nd: 1.5}, separation: {gap: 1 um}}\n";
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("lens.yaml");
    std::fs::write(&path, text).expect("written");
    let faults = spectra_lens::load(path.to_str().expect("UTF-8"), &FileResources::beside(folder.path()))
        .expect_err("no cement")
        .to_string();
    assert!(faults.contains("only cement can separate: no two glasses meet here"), "{faults}");
    assert!(faults.contains("state it at a surface between two glasses"), "{faults}");
    let faults = lens("inf", ", separation: {gap: 2 mm}").expect_err("too wide");
    assert!(faults.contains("out of range"), "{faults}");
}
