//! Tests imagers in a camera: sensors behind lenses, both directions, several films.

use crate::common::repository;
use crate::common::statistics::{self, Estimate, estimates, over_seeds, ready, rendered};
use spectra_core::frame::ExposureFrame;

fn load(scene: &str, overrides: &[&str]) -> spectra_scene::Scene {
    statistics::load(&repository("scenes").join(scene), overrides)
}

fn render(scene: &spectra_scene::Scene) -> ExposureFrame {
    rendered(&ready(scene.clone())).exposure
}

/// Returns the mean electrons of the wells under red, green and blue filters (rggb) in a square of the frame.
fn colors(frame: &ExposureFrame, left: usize, top: usize, side: usize) -> [f64; 3] {
    let width = frame.size.width_px as usize;
    let (mut sums, mut counts) = ([0.0; 3], [0.0; 3]);
    for row in top..top + side {
        for column in left..left + side {
            let color = column % 2 + row % 2;
            counts[color] += 1.0;
            sums[color] += frame.channels.iter().map(|c| f64::from(c.values[row * width + column])).sum::<f64>();
        }
    }
    [0, 1, 2].map(|i| sums[i] / counts[i])
}

/// Returns red over green and blue over green, relative to the middle of the frame, in stops: half way to the corner and in the
/// corner.
fn casts(frame: &ExposureFrame) -> [[f64; 2]; 2] {
    let (width, height) = (frame.size.width_px as usize, frame.size.height_px as usize);
    let side = 16;
    // Adds the same square of all four quadrants, so that the falloff of light between neighboring filters cancels.
    let at = |share: f64| {
        let near = |pixels: usize| ((1.0 - share) * (pixels - side) as f64 / 2.0) as usize / 2 * 2;
        let (left, top) = (near(width), near(height));
        let corners = [(left, top), (width - side - left, top), (left, height - side - top)];
        let all = corners.into_iter().chain([(width - side - left, height - side - top)]);
        all.map(|(left, top)| colors(frame, left, top, side)).fold([0.0; 3], |a, c| [0, 1, 2].map(|i| a[i] + c[i]))
    };
    let stops = |c: [f64; 3], m: [f64; 3]| [0, 2].map(|i| libm::log2(c[i] / c[1] / (m[i] / m[1])));
    let middle = at(0.0);
    [stops(at(0.5), middle), stops(at(1.0), middle)]
}

const PHOTOSITE: &str = "imager.photosite={stack: 3 um, microlens: 60 %, well: 3 um}";
/// Settings that leave only the cast of the sensor: glass and coatings color oblique light too.
const COMMON: [&str; 5] =
    ["imager.resolution=[120, 80]", "render.samples=256", PHOTOSITE, "lens.coating=ideal", "lens.absorption=false"];

/// Oblique light mixes colors. Behind the symmetric Hologon, whose corners see 55 degrees, the color cast increases toward the
/// corner. Behind a retrofocus lens, and behind the Hologon without a stack, there is no cast.
#[test]
fn a_symmetric_wide_angle_lens_casts_color_and_a_retrofocus_does_not() {
    let hologon = casts(&render(&load("sensor-wide-angle.yaml", &COMMON)));
    println!("Hologon {hologon:.3?} stops of red and blue over green, half way and corner");
    let shallow = ["imager.photosite={stack: 0, microlens: 0}"];
    let shallow = casts(&render(&load("sensor-wide-angle.yaml", &[&COMMON[..], &shallow].concat())));
    println!("without stack {shallow:.3?}");
    let lens = format!("lens.file={}/tests/data/lenses/nikon-retrofocus-100-f2.8.yaml", env!("CARGO_MANIFEST_DIR"));
    // Frame size for which a lens of 100 mm has the field of a 28 mm lens on 36 x 24 mm.
    let retrofocus = [&lens, "lens.f-number=f/8", "imager.format=null", "imager.width=128 mm", "imager.height=85 mm"];
    let retrofocus = casts(&render(&load("sensor-wide-angle.yaml", &[&COMMON[..], &retrofocus].concat())));
    println!("retrofocus {retrofocus:.3?}");
    for color in 0..2 {
        assert!(hologon[1][color] > 0.12 && hologon[0][color].abs() < 0.5 * hologon[1][color], "{hologon:?}");
        assert!(shallow[1][color].abs() < 0.01 && retrofocus[1][color].abs() < 0.02, "{shallow:?} {retrofocus:?}");
    }
}

/// Returns estimates of the figures of a picture, over seeds.
fn estimate(scene: &str, overrides: &[&str], of: impl Fn(&ExposureFrame) -> Vec<f64>) -> Vec<Estimate> {
    estimates(&over_seeds(&ready(load(scene, overrides)), 3..8, |rendering| of(&rendering.exposure)))
}

/// Factor for Student's t with 4 + 4 degrees of freedom at the level of 3 normal standard errors, for a dozen figures together.
const STUDENT: f64 = 2.0;

fn compare(scene: &str, common: &[&str], samples: &str, rays: &str, of: impl Fn(&ExposureFrame) -> Vec<f64>) {
    let backward = estimate(scene, &[common, &["render.direction=backward", samples]].concat(), &of);
    let forward = estimate(scene, &[common, &["render.direction=forward", rays]].concat(), &of);
    for (at, (backward, forward)) in backward.iter().zip(&forward).enumerate() {
        let (b, f, error) = (backward.mean, forward.mean, backward.error.hypot(forward.error));
        println!("{at}: {backward:?}, {forward:?}, ratio {:.5}", f / b);
        assert!(error < 0.005 * b, "{at}: {b} is known only to {error}");
        assert!((f - b).abs() < 3.0 * STUDENT * error && (f / b - 1.0).abs() < 0.03, "{at}: {f} and {b}, {error}");
    }
}

/// A shifted and tilted sensor with walls, wells and microlenses records the same light in both directions.
#[test]
fn forward_and_backward_agree_on_a_sensor() {
    let stands = "imager={kind: sensor, format: 135, resolution: [40, 28], pitch: 5 um, fill-factor: 70 %, tilt: [5, -8], \
                  shift: [2, 1], exposure: 1 s, photosite: {stack: 4 um, microlens: 50 %, well: 3 um, exit-pupil: 40 mm}}";
    let squares = |frame: &ExposureFrame| {
        [(0, 0), (26, 0), (0, 14), (14, 8)].iter().flat_map(|(left, top)| colors(frame, *left, *top, 14)).collect()
    };
    compare("sensor-wide-angle.yaml", &[stands], "render.samples=512", "render.rays=1200000", squares);
}

/// Behind a thick cover glass, which displaces steep rays by much of this lens's small pupil, both directions agree too.
#[test]
fn forward_and_backward_agree_behind_plates() {
    let stands = "imager={kind: sensor, format: 135, resolution: [40, 28], pitch: 5 um, exposure: 1 s, \
                  cover: [{glass: SCHOTT/N-BK7, thickness: 1.5 mm}]}";
    let squares = |frame: &ExposureFrame| {
        [(0, 0), (26, 0), (0, 14), (14, 8)].iter().flat_map(|(left, top)| colors(frame, *left, *top, 14)).collect()
    };
    compare("sensor-wide-angle.yaml", &[stands], "render.samples=512", "render.rays=1200000", squares);
}

/// On a curved, tilted colorimeter, wide open, both directions agree too.
#[test]
fn forward_and_backward_agree_on_a_curved_frame() {
    let stands = "imager={kind: xyz, format: 135, resolution: [48, 32], tilt: [-6, 4], shift: [1, -2], \
                  curvature: {shape: sphere, radius: -60}}";
    let mean = |frame: &ExposureFrame| {
        let values = &frame.channel("Y").expect("XYZ").values;
        (0..8).map(|strip| values[strip * 192..][..192].iter().map(|v| f64::from(*v)).sum::<f64>() / 192.0).collect()
    };
    compare("gray-card.yaml", &[stands], "render.samples=64", "render.rays=400000", mean);
}

/// Several films in the light of one trace record what each records alone, with their own exposure times. The mean exposures agree
/// within the noise of different wavelengths (half a percent).
#[test]
fn films_side_by_side_record_what_each_records_alone() {
    let small = ["imager.resolution=[48, 32]", "render.samples=256"];
    let ortho = "{stock: ilford-ortho-plus, exposure: 1/60 s}";
    let trix = "{stock: kodak-tri-x-400, exposure: 1/240 s}";
    let both = format!("film=[{ortho}, {trix}]");
    let scene = load("three-films.yaml", &[&small[..], &[&both]].concat());
    let names: Vec<_> = scene.films.iter().map(|f| f.name.clone().expect("named")).collect();
    assert_eq!(names, ["ilford-ortho-plus", "kodak-tri-x-400"]);
    let all = render(&scene);
    for (at, alone) in [ortho, trix].iter().enumerate() {
        let alone = load("three-films.yaml", &[&small[..], &[&format!("film={alone}")]].concat());
        let frame = render(&alone);
        let part = scene.films[at].exposure(&all);
        assert_eq!(part.channels.len(), frame.channels.len());
        for (a, b) in part.channels.iter().zip(&frame.channels) {
            assert_eq!((&a.name, &a.unit), (&b.name, &b.unit));
            let mean = |c: &[f32]| c.iter().map(|v| f64::from(*v)).sum::<f64>() / c.len() as f64;
            let ratio = mean(&a.values) / mean(&b.values);
            println!("{}: {ratio}", names[at]);
            assert!((ratio - 1.0).abs() < 0.005, "{ratio}");
        }
    }
}

#[test]
fn faulty_films_are_told_at_their_places() {
    let path = repository("scenes/three-films.yaml");
    for (film, word) in [
        ("[]", "1 to 16"),
        ("[{stock: ilford-ortho-plus, exposure: 1 s, name: a/b}]", "file's name"),
        (
            "[{stock: ilford-ortho-plus, exposure: 1 s, name: a}, {stock: kodak-tri-x-400, exposure: 1 s, name: a}]",
            "two films",
        ),
        ("[{stock: ilford-ortho-plus, exposure: 1 s}, {stock: kodak-tri-y, exposure: 1 s}]", "kodak-tri-x"),
    ] {
        let faults = spectra_scene::load(&path, &[format!("film={film}")]).map(|_| ()).unwrap_err().to_string();
        assert!(faults.contains(word), "{film}: {faults}");
    }
    let faults = spectra_scene::load(&path, &["output=[dng]".to_owned()]).map(|_| ()).unwrap_err().to_string();
    assert!(faults.contains("no A/D converter"), "{faults}");
}
