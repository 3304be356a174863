//! Tests exposure in absolute units: the camera equation on the axis, the solid angle of the exit pupil in the corners.

use spectra_core::RayBatch;
use spectra_core::frame::ExposureFrame;
use spectra_lens::Lens;
use spectra_plugins as _;
use spectra_render::{Control, RenderOptions, Renderer, Threads};
use spectra_scene::Scene;
use spectra_tracer::{Indices, Tracer, Travel};
use std::f64::consts::PI;
use std::path::Path;

/// Luminance of white, cd/m^2.
const LUMINANCE: f64 = 300.0;
const WIDTH: usize = 45;
const HEIGHT: usize = 30;
/// Wavelength that represents photopic light, nm.
const PHOTOPIC_NM: f64 = 555.0;

fn scene(lens: &str, f_number: &str, object: &str) -> Scene {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes/gray-card.yaml");
    // The card extends well beyond the field in both cases.
    let (distance, width) = if object == "infinity" { ("10 km", "16 km") } else { (object, "3.4 m") };
    let overrides = [
        format!("lens={{file: {lens}, f-number: {f_number}, focus: {object}, coating: ideal, absorption: false}}"),
        format!("source={{kind: chart, chart: white, distance: {distance}, width: {width}, luminance: {LUMINANCE}}}"),
        format!("imager.resolution=[{WIDTH}, {HEIGHT}]"),
        "render.samples=1024".to_owned(),
    ];
    spectra_scene::load(&path, &overrides).unwrap_or_else(|faults| panic!("{faults}"))
}

fn render(scene: &Scene) -> ExposureFrame {
    Renderer::new(scene.clone(), &RenderOptions::default())
        .expect("ready")
        .run(&Threads(2), &Control::new())
        .expect("rendered")
        .exposure
}

/// Returns illuminance over luminance at a point of the film, sr: the projected solid angle of all directions from which light
/// arrives through the lens. It is computed by brute force over a plane in front of the film.
fn projected_solid_angle_sr(lens: &Lens, x_mm: f64, y_mm: f64) -> f64 {
    const N: usize = 500;
    let tracer = Tracer::new(lens, Indices::At(PHOTOPIC_NM)).expect("media");
    let last = lens.elements.last().expect("surfaces");
    let half = 1.3 * last.semi_diameter_mm.unwrap_or(20.0);
    let z = last.vertex_z_mm() - lens.image_z_mm();
    let cell = 2.0 * half / N as f64;
    let mut rays = RayBatch::new(N);
    let mut work = tracer.work_in_place(N);
    let mut sum = 0.0;
    for row in 0..N {
        rays.restart(N);
        let v = (row as f64 + 0.5) * cell - half;
        let mut weights = [0.0; N];
        let c = rays.columns_mut();
        for i in 0..N {
            let u = (i as f64 + 0.5) * cell - half;
            let (dx, dy, dz) = (u - x_mm, v - y_mm, z);
            let r2 = dx * dx + dy * dy + dz * dz;
            let r = r2.sqrt();
            (c.x[i], c.y[i], c.z[i]) = (u, v, z);
            (c.l[i], c.m[i], c.n[i]) = (dx / r, dy / r, dz / r);
            c.wavelength_nm[i] = PHOTOPIC_NM;
            weights[i] = (dz / r) * (dz / r) / r2 * cell * cell;
        }
        tracer.trace(&mut rays, &mut work, Travel::Backward);
        sum += (0..N).filter(|i| rays.loss(*i).is_none()).map(|i| weights[i]).sum::<f64>();
    }
    sum
}

/// On the axis E = pi L / (4 N^2 (1 + m/P)^2) within 1 %, with N of the real marginal ray at infinity, m the magnification and P the
/// pupil magnification. In the corners E is L times the projected solid angle of the traced exit pupil, within 2 %.
#[test]
fn a_gray_card_is_exposed_as_optics_says() {
    for lens in ["zeiss-biotar-50-f1.4", "canon-fd-50-f1.8"] {
        for f_number in ["f/2", "f/5.6"] {
            for object in ["infinity", "2 m"] {
                let scene = scene(lens, f_number, object);
                let frame = render(&scene);
                let y = &frame.channel("Y").expect("an XYZ imager").values;
                let at = |column: usize, row: usize| f64::from(y[row * WIDTH + column]);
                let axis = (0..4).map(|k| at(WIDTH / 2 + k % 2, HEIGHT / 2 - k / 2)).sum::<f64>() / 4.0;
                let first = scene.lens.first_order(scene.lens.reference_nm);
                let pupils = first.exit_pupil_magnification.zip(first.entrance_pupil_magnification);
                let p = pupils.map(|(exit, entrance)| (exit / entrance).abs()).expect("a stop");
                let m = if object == "infinity" {
                    0.0
                } else {
                    scene.lens.paraxial_magnification(2000.0, scene.lens.reference_nm).abs()
                };
                let n = scene.lens.clone().marginal_ray().expect("a stop").f_number();
                let want = PI * LUMINANCE / (4.0 * n * n * (1.0 + m / p) * (1.0 + m / p));
                let axial = axis / want;
                // The center of the pixel in the upper left corner of the picture.
                let (x, y_mm) = scene.imager.size().point_of(0, 0.5, 0.5);
                let corner = at(0, 0) / (LUMINANCE * projected_solid_angle_sr(&scene.lens, x, y_mm));
                println!(
                    "{lens} {f_number} {object}: axis {axial:.4}, corner {corner:.4} ({:.3} of the axis)",
                    at(0, 0) / axis
                );
                assert!((axial - 1.0).abs() < 0.01, "{lens} {f_number} {object}: {axial} of the camera equation");
                assert!((corner - 1.0).abs() < 0.02, "{lens} {f_number} {object}: {corner} of the solid angle");
            }
        }
    }
}
