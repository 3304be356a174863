//! Forward and backward estimate the same exposure (P8).

use spectra_core::Isa;
use spectra_core::frame::ExposureFrame;
use spectra_plugins as _;
use spectra_render::{Control, Renderer, Threads};
use std::path::Path;

const COLUMNS: usize = 5;
const ROWS: usize = 4;
const SEEDS: u64 = 6;

fn render(overrides: &[&str]) -> ExposureFrame {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes/gray-card.yaml");
    let overrides: Vec<String> = overrides.iter().map(|s| (*s).to_owned()).collect();
    let scene = spectra_scene::load(&path, &overrides).unwrap_or_else(|faults| panic!("{faults}"));
    let renderer = Renderer::new(scene.clone(), Isa::detect()).expect("the scene can be rendered");
    renderer.run(&Threads(2), &Control::new()).expect("rendered").exposure
}

/// Mean illuminance of each of the 20 regions of the frame.
fn regions(frame: &ExposureFrame) -> Vec<f64> {
    let y = &frame.channel("Y").expect("an XYZ imager").values;
    let (width, height) = (frame.size.width_px as usize, frame.size.height_px as usize);
    let mut sums = [0.0; COLUMNS * ROWS];
    for (pixel, value) in y.iter().enumerate() {
        let region = pixel / width * ROWS / height * COLUMNS + pixel % width * COLUMNS / width;
        sums[region] += f64::from(*value);
    }
    sums.iter().map(|s| s / (width * height / sums.len()) as f64).collect()
}

/// Mean and standard error of each region over independent seeds.
fn estimate(overrides: &[&str]) -> Vec<(f64, f64)> {
    let runs: Vec<Vec<f64>> = (0..SEEDS)
        .map(|seed| {
            let seed = format!("render.seed={}", seed + 11);
            regions(&render(&[overrides, &[&seed]].concat()))
        })
        .collect();
    (0..COLUMNS * ROWS)
        .map(|region| {
            let values: Vec<f64> = runs.iter().map(|r| r[region]).collect();
            let mean = values.iter().sum::<f64>() / values.len() as f64;
            let variance = values.iter().map(|v| (v - mean) * (v - mean)).sum::<f64>() / (values.len() - 1) as f64;
            (mean, (variance / values.len() as f64).sqrt())
        })
        .collect()
}

/// Student's t with 5 + 5 degrees of freedom at the 3-sigma level for 20 regions together: a factor of
/// 1.6 on three standard errors that are themselves estimated from six seeds.
const STUDENT: f64 = 1.6;

fn compare(common: &[&str], samples: &str, rays: &str) {
    let backward = estimate(&[common, &["render.direction=backward", samples]].concat());
    let forward = estimate(&[common, &["render.direction=forward", rays]].concat());
    for (region, ((b, eb), (f, ef))) in backward.iter().zip(&forward).enumerate() {
        let error = (eb * eb + ef * ef).sqrt();
        println!("region {region}: backward {b:.5} +- {eb:.5}, forward {f:.5} +- {ef:.5} lx, ratio {:.5}", f / b);
        assert!((f / b - 1.0).abs() < 0.01, "region {region}: {f} and {b} lx differ by more than 1 %");
        assert!((f - b).abs() < 3.0 * STUDENT * error, "region {region}: {f} and {b} lx, standard error {error}");
    }
}

/// The path of a lens of the test data, as an override.
fn lens(name: &str) -> String {
    format!("lens.file={}/tests/data/lenses/{name}.yaml", env!("CARGO_MANIFEST_DIR"))
}

/// A card close to a lens of 1 mm: the frame's edges see it at 80 degrees from the axis.
#[test]
fn a_fisheye_out_to_80_degrees() {
    let lens = lens("minolta-fisheye-1-f2.7");
    let common = [
        &lens,
        "lens.focus=infinity",
        "source.distance=100",
        "source.width=1700",
        "imager={kind: xyz, width: 2.8, height: 1.86, resolution: [30, 20]}",
    ];
    compare(&common, "render.samples=512", "render.rays=10000000");
}

#[test]
fn a_wide_angle_lens() {
    let lens = lens("zeiss-hologon-15-f8");
    let common = [&lens, "source.width=5.4 m", "imager.resolution=[60, 40]"];
    compare(&common, "render.samples=512", "render.rays=6000000");
}

#[test]
fn gray_card_wide_open() {
    compare(&["imager.resolution=[60, 40]"], "render.samples=256", "render.rays=3000000");
}

#[test]
fn gray_card_stopped_down_with_independent_numbers_and_rings() {
    // Independent numbers converge with the square root only: more of them.
    let common = ["imager.resolution=[60, 40]", "lens.f-number=f/2.8", "render.numbers=random", "render.cone=rings"];
    compare(&common, "render.samples=1024", "render.rays=24000000");
}

/// On the axis the illuminance is pi L tau / (4 N^2 (1 + m/P)^2), with N of the real marginal ray at infinity, m the
/// magnification and P the pupil magnification (1.32 for this lens); nothing is reflected or absorbed.
#[test]
fn gray_card_has_the_illuminance_of_the_camera_equation() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes/gray-card.yaml");
    let lossless = ["lens.f-number=f/4", "lens.coating=ideal", "lens.absorption=false"];
    let scene = spectra_scene::load(&path, &lossless.map(str::to_owned)).unwrap_or_else(|faults| panic!("{faults}"));
    let n = scene.lens.marginal_ray().expect("stopped down").f_number();
    assert!((n - 4.0).abs() < 1e-6, "{n}");
    let m = scene.lens.paraxial_magnification(2000.0, scene.lens.reference_nm).abs();
    let luminance = 300.0 * 0.18;
    let want = std::f64::consts::PI * luminance / (4.0 * n * n * (1.0 + m / 1.32) * (1.0 + m / 1.32));
    let frame = render(&[&lossless[..], &["imager.resolution=[36, 24]", "render.samples=1024"]].concat());
    let y = &frame.channel("Y").expect("XYZ").values;
    let axis: f64 =
        [11 * 36 + 17, 11 * 36 + 18, 12 * 36 + 17, 12 * 36 + 18].iter().map(|p| f64::from(y[*p]) / 4.0).sum();
    assert!((axis / want - 1.0).abs() < 0.01, "{axis} lx, the equation says {want} lx");
}
