//! Tests that forward and backward tracing estimate the same exposure (P8).

use crate::common::repository;
use crate::common::statistics::{self, Estimate, estimates, over_seeds, ready, regions, rendered};
use spectra_render::Renderer;

const REGIONS: [usize; 2] = [5, 4];
const SEEDS: u64 = 6;

fn card(overrides: &[&str]) -> Renderer {
    ready(statistics::load(&repository("scenes/gray-card.yaml"), overrides))
}

/// Returns the mean illuminance of each region of the frame, for the given number of columns and rows.
fn estimate(overrides: &[&str], [columns, rows]: [usize; 2]) -> Vec<Estimate> {
    estimates(&over_seeds(&card(overrides), 11..11 + SEEDS, |rendering| regions(rendering, columns, rows)))
}

/// Factor for Student's t with 5 + 5 degrees of freedom, at the 3-sigma level for 20 regions together. Three standard errors are
/// multiplied by 1.6, because they are estimated from six seeds.
const STUDENT: f64 = 1.6;

fn compare(common: &[&str], samples: &str, rays: &str) {
    compare_in(REGIONS, common, samples, rays);
}

fn compare_in(parts: [usize; 2], common: &[&str], samples: &str, rays: &str) {
    let backward = estimate(&[common, &["render.direction=backward", samples]].concat(), parts);
    let forward = estimate(&[common, &["render.direction=forward", rays]].concat(), parts);
    for (region, (backward, forward)) in backward.iter().zip(&forward).enumerate() {
        let (b, f, error) = (backward.mean, forward.mean, backward.error.hypot(forward.error));
        println!("region {region}: {backward:?} {forward:?} lx, ratio {:.5}", f / b);
        assert!((f / b - 1.0).abs() < 0.01, "region {region}: {f} and {b} lx differ by more than 1 %");
        assert!((f - b).abs() < 3.0 * STUDENT * error, "region {region}: {f} and {b} lx, standard error {error}");
    }
}

/// Returns the path of a lens of the test data as an override.
fn lens(name: &str) -> String {
    format!("lens.file={}/tests/data/lenses/{name}.yaml", env!("CARGO_MANIFEST_DIR"))
}

/// A card close to a lens of 1 mm: the edges of the frame see it at 80 degrees from the axis.
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
    compare(&common, "render.samples=64", "render.rays=1000000");
}

#[test]
fn a_wide_angle_lens() {
    let lens = lens("zeiss-hologon-15-f8");
    let common = [&lens, "source.width=5.4 m", "imager.resolution=[60, 40]"];
    compare(&common, "render.samples=96", "render.rays=1000000");
}

#[test]
fn gray_card_wide_open() {
    compare(&["imager.resolution=[60, 40]"], "render.samples=64", "render.rays=600000");
}

#[test]
fn gray_card_stopped_down_with_independent_numbers_and_rings() {
    // Independent numbers converge only with the square root, so the whole frame is compared instead of its regions. These rays
    // determine 1 % of it better than eight times as many would determine 1 % of a twentieth of it.
    let common = ["imager.resolution=[60, 40]", "lens.f-number=f/2.8", "render.numbers=random", "render.cone=rings"];
    compare_in([1, 1], &common, "render.samples=256", "render.rays=3000000");
}

/// The illuminance on the axis is pi L tau / (4 N^2 (1 + m/P)^2). N is that of the real marginal ray at infinity, m the magnification
/// and P the pupil magnification (1.32 for this lens). Nothing is reflected or absorbed.
#[test]
fn gray_card_has_the_illuminance_of_the_camera_equation() {
    let lossless = ["lens.f-number=f/4", "lens.coating=ideal", "lens.absorption=false"];
    let renderer = card(&[&lossless[..], &["imager.resolution=[36, 24]", "render.samples=1024"]].concat());
    let scene = renderer.scene();
    let n = scene.lens.marginal_ray().expect("stopped down").f_number();
    assert!((n - 4.0).abs() < 1e-6, "{n}");
    let m = scene.lens.paraxial_magnification(2000.0, scene.lens.reference_nm).abs();
    let luminance = 300.0 * 0.18;
    let want = std::f64::consts::PI * luminance / (4.0 * n * n * (1.0 + m / 1.32) * (1.0 + m / 1.32));
    let y = statistics::pixels(&rendered(&renderer));
    let axis: f64 = [11 * 36 + 17, 11 * 36 + 18, 12 * 36 + 17, 12 * 36 + 18].iter().map(|p| y[*p] / 4.0).sum();
    assert!((axis / want - 1.0).abs() < 0.01, "{axis} lx, the equation says {want} lx");
}
