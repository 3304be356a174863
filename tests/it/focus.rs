//! Tests focus as on a camera: through the plates in front of the frame, and by default where the picture is sharpest.

use glam::DVec3;
use spectra_analysis::AnalysisLight;
use spectra_analysis::focus::conjugate;
use spectra_core::frame::ExposureFrame;
use spectra_core::spectral::SystemResponse;
use spectra_optics::{Beam, ObjectPoint};
use spectra_plugins as _;
use spectra_render::{Control, RenderOptions, Renderer, Threads};
use spectra_scene::{FocusBy, Scene};
use std::path::Path;

fn load(scene: &str, overrides: &[&str]) -> Result<Scene, String> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes").join(scene);
    let overrides: Vec<String> = overrides.iter().map(|s| (*s).to_owned()).collect();
    spectra_scene::load(&path, &overrides).map_err(|faults| faults.to_string())
}

fn render(overrides: &[&str]) -> ExposureFrame {
    let scene = load("biotar-color.yaml", overrides).expect("a scene");
    Renderer::new(scene.clone(), &RenderOptions::default())
        .expect("ready")
        .run(&Threads(2), &Control::new())
        .expect("rendered")
        .exposure
}

/// Returns the position, mm, and the light of each column.
fn columns(frame: &ExposureFrame) -> Vec<(f64, f64)> {
    let (width, size) = (frame.size.width_px as usize, frame.size.width_mm);
    let y = &frame.channel("Y").expect("XYZ").values;
    let sum = |column: usize| y.iter().skip(column).step_by(width).map(|v| f64::from(*v)).sum::<f64>();
    (0..width).map(|c| (((c as f64 + 0.5) / width as f64 - 0.5) * size, sum(c))).collect()
}

/// Returns the width, mm, that excludes 1 % of the light on each side.
fn width_of_98_percent(frame: &ExposureFrame) -> f64 {
    let columns = columns(frame);
    let total: f64 = columns.iter().map(|c| c.1).sum();
    let pixel = columns[1].0 - columns[0].0;
    let within = |part: f64| {
        let mut before = 0.0;
        for (x, light) in &columns {
            if before + light >= part * total {
                return x + pixel * ((part * total - before) / light - 0.5);
            }
            before += light;
        }
        f64::NAN
    };
    within(0.99) - within(0.01)
}

/// Returns the RMS distance of the light from its center along x, mm.
fn rms(frame: &ExposureFrame) -> f64 {
    let columns = columns(frame);
    let mean = |of: &dyn Fn(f64) -> f64| {
        columns.iter().map(|(x, l)| of(*x) * l).sum::<f64>() / columns.iter().map(|c| c.1).sum::<f64>()
    };
    let middle = mean(&|x| x);
    mean(&|x| (x - middle) * (x - middle)).sqrt()
}

const POINT: &str = "source={kind: point, distance: 1 m, spectrum: 'line:d'}";
const IMAGER: &str = "imager={kind: xyz, width: 0.4 mm, height: 0.05 mm, resolution: [800, 4]}";
const COVER: &str = "imager.cover=[{glass: SCHOTT/N-BK7, thickness: 0.5 mm, gap: 0.2 mm}]";
const LOW_PASS: &str = "imager.low-pass=[{thickness: 0.85 mm}, {thickness: 0.85 mm, azimuth: 90 deg}]";
const FORWARD: [&str; 3] = ["render.direction=forward", "render.rays=200000", "lens.f-number=f/5.6"];

/// A point through cover glass and low-pass plates is as sharp as without them, for every way to focus. The width with 98 % of its
/// light grows by less than 8 um, of which the low-pass itself makes 5 um; plates that focusing ignores would cost 110 um.
#[test]
fn a_point_is_sharp_through_plates() {
    for focus in [
        "1 m",
        "{distance: 1 m, by: paraxial}",
        "{distance: 1 m, by: rms}",
        "{distance: 1 m, by: spot}",
        "{distance: 1 m, by: contrast, frequency: 30}",
    ] {
        let focus = format!("lens.focus={focus}");
        let all = [&[POINT, IMAGER, focus.as_str()], &FORWARD[..]].concat();
        let plain = width_of_98_percent(&render(&all));
        let through = width_of_98_percent(&render(&[&all[..], &[COVER, LOW_PASS]].concat()));
        println!("{focus}: {:.1} um without, {:.1} um with", plain * 1e3, through * 1e3);
        assert!(plain < 0.015 && through - plain < 0.008, "{focus}: {plain} without, {through} with");
        assert!(through - plain > 0.002, "{focus}: the low-pass splits every point: {plain} {through}");
    }
}

/// Backward tracing agrees: a patch too small to be resolved has an image 4 um wide.
#[test]
fn plates_are_in_focus_in_both_directions() {
    let patch = "source={kind: chart, chart: white, distance: 1 m, width: 0.08 mm, illuminant: 'line:d', color: {kind: smooth}}";
    let imager = "imager={kind: xyz, width: 0.06 mm, height: 0.03 mm, resolution: [60, 30]}";
    let common = [patch, imager, "lens.focus=1 m", "lens.f-number=f/5.6", COVER, LOW_PASS];
    let seen = |direction: &[&str]| width_of_98_percent(&render(&[&common[..], direction].concat()));
    let forward = seen(&["render.direction=forward", "render.rays=400000"]);
    let backward = seen(&["render.direction=backward", "render.samples=1024"]);
    println!("forward {:.2} um, backward {:.2} um", forward * 1e3, backward * 1e3);
    assert!(forward < 0.018 && (forward - backward).abs() < 0.001, "{forward} {backward}");
}

/// A lens focused at 1 m for the smallest spot, through 1.5 mm of glass, is sharpest for 1 m within 1 %. Checked with the light from
/// points around that distance, and with rays traced back from the middle of the frame.
#[test]
fn the_sharpest_distance_is_the_one_asked_for() {
    let cover = "imager.cover=[{glass: SCHOTT/N-BK7, thickness: 1.5 mm}]";
    let focus = "lens.focus={distance: 1 m, by: rms}";
    let distances = [0.9, 0.95, 1.0, 1.05, 1.1];
    let spots = distances.map(|m: f64| {
        let source = format!("source={{kind: point, distance: {m} m, spectrum: 'line:d'}}");
        rms(&render(&[&[source.as_str(), IMAGER, focus, cover], &FORWARD[..]].concat()))
    });
    // The squared spot size is a parabola in reciprocal distance.
    let (mut squares, mut moments) = (glam::DMat3::ZERO, DVec3::ZERO);
    for (m, spot) in distances.iter().zip(spots) {
        let v = 1.0 / m - 1.0;
        let powers = DVec3::new(1.0, v, v * v);
        squares += glam::DMat3::from_cols(powers * powers.x, powers * powers.y, powers * powers.z);
        moments += powers * (spot * spot);
    }
    let [_, linear, square] = (squares.inverse() * moments).to_array();
    let sharpest = 1.0 / (1.0 - 0.5 * linear / square);
    println!("spots {spots:?} mm, smallest for {sharpest:.4} m");
    assert!((sharpest - 1.0).abs() < 0.01, "{sharpest} m: {spots:?}");
    let scene = load("biotar-color.yaml", &[focus, cover, "lens.f-number=f/5.6", POINT]).expect("a scene");
    let found =
        conjugate(&scene.lens, AnalysisLight::Wavelength(587.5618), DVec3::ZERO).expect("media").expect("light");
    assert!((found.distance_mm - 1000.0).abs() < 10.0, "{} mm", found.distance_mm);
}

/// The frame moves back as much as the plates move the image, focused or not: t (1 - 1/n) of N-BK7 at d.
#[test]
fn the_frame_stands_where_the_plates_put_the_image() {
    let cover = "imager.cover=[{glass: SCHOTT/N-BK7, thickness: 2 mm}]";
    for focus in ["null", "infinity", "{distance: 3 m, by: paraxial}"] {
        let focus = format!("lens.focus={focus}");
        let [plain, through] = [&[][..], &[cover]].map(|set| {
            load("gray-card.yaml", &[&["lens.f-number=f/8", focus.as_str()], set].concat()).expect("a scene")
        });
        let back = through.lens.image_z_mm() - plain.lens.image_z_mm();
        // Focusing by contrast also takes the aberration of the plate into account.
        let tolerance = if focus.contains("infinity") { 0.01 } else { 1e-4 };
        assert!((back - 2.0 * (1.0 - 1.0 / 1.5168)).abs() < tolerance, "{focus}: {back}");
    }
}

/// The contrast at the default focus is compared with that on planes around it, for the whole light with many rays over the whole
/// pupil. No plane has more contrast than an error of 1 um in focus would explain.
#[test]
fn the_default_focus_is_where_contrast_is_highest() {
    let nikkor = "lens.file=nikkor-100-f1.4";
    let bladed = "lens.aperture={shape: iris, blades: 7}";
    for (name, set) in [
        ("biotar-ortho.yaml", &["lens.f-number=null"][..]),
        ("biotar-color.yaml", &["lens.f-number=null"]),
        ("biotar-color.yaml", &["lens.f-number=null", nikkor, "lens.focus=2.5 m"]),
        ("biotar-color.yaml", &["lens.f-number=f/2.8", bladed]),
        ("biotar-color.yaml", &["lens.f-number=f/8", COVER]),
        ("low-pass.yaml", &[]),
    ] {
        let scene = load(name, set).expect("a scene");
        let FocusBy::Contrast { per_mm } = scene.focus.by else { panic!("{name}: {}", scene.focus) };
        let system = SystemResponse {
            grid: scene.grid,
            source: scene.source.spectrum().clone(),
            channels: scene.channels.clone(),
        };
        let response = system.summed_response();
        let light: Vec<(f64, f64)> = (0..60)
            .map(|i| scene.grid.start_nm + (f64::from(i) + 0.5) * (scene.grid.end_nm() - scene.grid.start_nm) / 60.0)
            .map(|nm| {
                let at = |table: &[f64]| scene.grid.interpolate(table, nm);
                (nm, at(&system.source.continuum) * at(&response))
            })
            .chain(
                system
                    .source
                    .lines
                    .iter()
                    .map(|l| (l.wavelength_nm, l.power * scene.grid.interpolate(&response, l.wavelength_nm))),
            )
            .filter(|(_, weight)| *weight > 0.0)
            .collect();
        let object_mm = scene.focus.distance_mm.expect("focused");
        let point = ObjectPoint::on_plane(&scene.lens, object_mm, 0.0);
        let beam = Beam::trace(&scene.lens, point, &light, 64).expect("media").expect("light");
        let best = beam.best_contrast_z_mm(per_mm).expect("a plane");
        let (here, there) = (beam.contrast(0.0, per_mm), beam.contrast(best, per_mm));
        println!("{name} {set:?}: {} contrast {here:.4}, at {:+.2} um {there:.4}", scene.focus, best * 1e3);
        assert!(there - here < 1e-3, "{name} {set:?}: {here} here, {there} at {best} mm");
    }
}

/// On other formats the frequency scales with the diagonal; for a frame cut out of a picture, it is at most that of super 8.
#[test]
fn frequency_goes_with_the_format() {
    for (format, want) in [
        ("format: 135", 30.0),
        ("format: 6x6", 30.0 * 43.2666 / 79.196),
        ("format: super-8", 30.0 * 43.2666 / 7.516),
        ("width: 0.3 mm, height: 0.2 mm", 30.0 * 43.2666 / 7.516),
    ] {
        let imager = format!("imager={{kind: xyz, {format}, resolution: [9, 6]}}");
        let scene = load("biotar-color.yaml", &[&imager]).expect("a scene");
        let FocusBy::Contrast { per_mm } = scene.focus.by else { panic!("{}", scene.focus) };
        assert!((per_mm / want - 1.0).abs() < 1e-3, "{format}: {per_mm} {want}");
    }
}

/// Light and response matter: behind a red filter the lens is focused for red, and a meter beside the film changes nothing.
#[test]
fn the_light_of_the_scene_is_focused() {
    let z = |name: &str, set: &[&str]| load(name, set).expect("a scene").lens.image_z_mm();
    let open = z("biotar-trix.yaml", &[]);
    let red = z("biotar-trix.yaml", &["lens.filters=[wratten-25]"]);
    assert!((open - red).abs() > 5e-3, "{open} {red}");
    let timed = z("biotar-trix.yaml", &["film={stock: kodak-tri-x-400, exposure: 1/60 s}"]);
    assert_eq!(open.to_bits(), timed.to_bits());
}

/// If contrast cannot be computed, the lens is focused in first order, with a warning; if contrast is requested by name, it is an
/// error.
#[test]
fn what_cannot_be_focused_by_contrast_is_said() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("blocked.yaml");
    // Light that passes the ring of the stop misses the glass.
    let text = "name: blocked\nsurfaces:\n  \
        - {kind: stop, thickness: 1, semi-diameter: 5, aperture: {shape: ring, inner: 4.9}}\n  \
        - {kind: sphere, radius: 50, thickness: 3, glass: SCHOTT/N-BK7, semi-diameter: 3}\n  \
        - {kind: sphere, radius: -50, thickness: 46, semi-diameter: 3}\n";
    std::fs::write(&file, text).expect("written");
    let lens = format!("lens={{file: {}, focus: 2 m}}", file.display());
    // No light is seen through it, so no width fills the frame.
    let width = "source.width=1.5 m";
    match load("biotar-color.yaml", &[&lens, width]) {
        Ok(scene) => {
            assert_eq!(scene.focus.by, FocusBy::Paraxial);
            assert!(scene.focus.to_string().contains("contrast cannot be computed"), "{}", scene.focus);
            assert!(scene.warnings.iter().any(|w| w.0.path == "lens.focus"), "{:?}", scene.warnings);
        }
        Err(faults) => panic!("{faults}"),
    }
    let asked = format!("lens={{file: {}, focus: {{distance: 2 m, by: contrast}}}}", file.display());
    let faults = load("biotar-color.yaml", &[&asked, width]).err().expect("no light");
    assert!(faults.contains("no light"), "{faults}");
    // A close anamorphic lens that moves as a whole: no plane is sharp in both sections.
    let text = std::fs::read_to_string(concat!(env!("CARGO_MANIFEST_DIR"), "/lenses/schneider-anamorphic-60.yaml"))
        .expect("bundled");
    std::fs::write(&file, text.split("focus:\n").next().expect("a lens")).expect("a folder");
    let whole = format!("lens={{file: {}, focus: 1.5 m}}", file.display());
    let near = load("biotar-color.yaml", &[&whole]).expect("a scene");
    assert!(near.warnings.iter().any(|w| w.0.message.contains("mm apart")), "{:?}", near.warnings);
    // With its front group moving separately, both sections are sharp.
    let near = load("biotar-color.yaml", &["lens={file: schneider-anamorphic-60, focus: 1.5 m}"]).expect("a scene");
    assert!(!near.warnings.iter().any(|w| w.0.message.contains("mm apart")), "{:?}", near.warnings);
}
