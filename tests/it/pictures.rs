//! Tests visible properties of pictures by numbers.

use spectra_core::frame::ExposureFrame;
use spectra_core::spectral::{BAND, Channel, SpectralPower};
use spectra_plugins as _;
use spectra_render::{Control, RenderOptions, Renderer, Rendering, Threads};
use std::path::Path;

fn render(scene: &str, overrides: &[&str]) -> Rendering {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes").join(scene);
    let overrides: Vec<String> = overrides.iter().map(|s| (*s).to_owned()).collect();
    let scene = spectra_scene::load(&path, &overrides).unwrap_or_else(|faults| panic!("{faults}"));
    let renderer = Renderer::new(scene.clone(), &RenderOptions::default()).expect("the scene can be rendered");
    renderer.run(&Threads(2), &Control::new()).expect("rendered")
}

/// Returns the centroid of a channel: column and row as fractions of the frame, from the upper left.
fn centroid(frame: &ExposureFrame, channel: &str) -> (f64, f64) {
    let width = frame.size.width_px as usize;
    let (mut sum, mut column, mut row) = (0.0, 0.0, 0.0);
    for (pixel, value) in frame.channel(channel).expect("the channel").values.iter().enumerate() {
        let value = f64::from(*value);
        sum += value;
        column += value * ((pixel % width) as f64 + 0.5);
        row += value * ((pixel / width) as f64 + 0.5);
    }
    (column / sum / f64::from(frame.size.width_px), row / sum / f64::from(frame.size.height_px))
}

/// A point to the right and above is imaged to the right and above, where the paraxial image distance predicts it: tangent of the
/// field times the image distance, within the distortion and coma of the lens (5 %).
#[test]
fn a_point_lands_upright_and_unmirrored() {
    let small = ["imager={kind: xyz, format: 135, resolution: [240, 160]}", "render.rays=400000"];
    let frame = render("biotar-spot.yaml", &small).exposure;
    let (column, row) = centroid(&frame, "Y");
    let (x, y) = ((column - 0.5) * 36.0, (0.5 - row) * 24.0);
    // The entrance pupil of the Biotar lies about 30 mm behind its first vertex, from which the field is measured.
    let expected = |degrees: f64| 49.8 * libm::tan(degrees.to_radians());
    assert!((x / expected(12.0) - 1.0).abs() < 0.06, "{x} {}", expected(12.0));
    assert!((y / expected(8.0) - 1.0).abs() < 0.06, "{y} {}", expected(8.0));
}

/// Returns the mean exposure of a patch of the 6 x 4 ColorChecker that fills the frame.
fn patch(frame: &ExposureFrame, channel: &str, column: usize, row: usize) -> f64 {
    let (width, height) = (frame.size.width_px as usize, frame.size.height_px as usize);
    let values = &frame.channel(channel).expect("the channel").values;
    let (cx, cy) = ((column as f64 + 0.5) / 6.0, (row as f64 + 0.5) / 4.0);
    // The chart covers four fifths of the width of the frame.
    let (x, y) = (0.5 + (cx - 0.5) * 0.8, 0.5 + (cy - 0.5) * 0.8);
    let (x, y) = ((x * width as f64) as usize, (y * height as f64) as usize);
    let mut sum = 0.0;
    for dy in 0..5 {
        for dx in 0..5 {
            sum += f64::from(values[(y + dy - 2) * width + x + dx - 2]);
        }
    }
    sum / 25.0
}

/// Returns a patch relative to the white one in stops, from measured spectra alone: light times reflectance times response.
fn stops_by_spectra(patch: &str, channel: &Channel) -> f64 {
    let light = spectra_spectrum::find_emission("D65").expect("bundled").to_power(&BAND);
    let seen = |patch: &str| {
        let reflectance = spectra_spectrum::find_reflectance(&format!("colorchecker#{patch}")).expect("bundled");
        let lit = light.continuum.iter().zip(BAND.wavelengths_nm()).map(|(p, w)| p * reflectance.at(w)).collect();
        SpectralPower { continuum: lit, ..light.clone() }.seen_by(&channel.response)
    };
    libm::log2(seen(patch) / seen("white"))
}

/// Orthochromatic film sees no red. Through the whole camera the ColorChecker's red is nearly four stops below its white and darker
/// than its blue, which to the eye is the darker one. Both follow from their spectra within 0.02 stop, relative to a uniform card in
/// the same place, which has the same vignetting (glass and coatings are colorless here).
#[test]
fn red_is_black_and_blue_is_light_on_orthochromatic_film() {
    let common = [
        "source.width=1.12 m",
        "render.samples=64",
        "imager.resolution=[180, 120]",
        "lens.coating=ideal",
        "lens.absorption=false",
    ];
    let mut measured = Vec::new();
    for (scene, channel) in [("biotar-ortho.yaml", 0), ("biotar-color.yaml", 1)] {
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes").join(scene);
        let response =
            spectra_scene::load(&path, &[]).unwrap_or_else(|faults| panic!("{faults}")).channels[channel].clone();
        let of = |chart: &str| render(scene, &[&common[..], &[&format!("source.chart={chart}")]].concat()).exposure;
        let (frame, even) = (of("color-checker"), of("gray-card"));
        let name = frame.channels[channel].name.clone();
        let seen = |column, row| patch(&frame, &name, column, row) / patch(&even, &name, column, row);
        let stops = |column, row| libm::log2(seen(column, row) / seen(0, 3));
        for (column, row, patch) in [(2, 2, "red"), (0, 2, "blue")] {
            let (got, want) = (stops(column, row), stops_by_spectra(patch, &response));
            assert!((got - want).abs() < 0.02, "{scene}, {patch}: {got} stops, its spectrum says {want}");
            measured.push(got);
        }
    }
    let [ortho_red, ortho_blue, eye_red, eye_blue] = measured[..] else { panic!("four figures") };
    assert!(ortho_red < ortho_blue - 1.5 && eye_red > eye_blue + 0.5, "{measured:?}");
}

/// Corners are darker wide open than stopped down, for the same gray card.
#[test]
fn corners_are_darker_wide_open() {
    let corner_over_center = |f_number: &str| {
        let frame = render("gray-card.yaml", &[f_number, "imager.resolution=[36, 24]", "render.samples=512"]).exposure;
        let y = &frame.channel("Y").expect("XYZ").values;
        f64::from(y[0]) / f64::from(y[12 * 36 + 18])
    };
    let (open, stopped) = (corner_over_center("lens.f-number=f/1.5"), corner_over_center("lens.f-number=f/5.6"));
    assert!(open < 0.45 && stopped > 0.6, "open {open}, stopped {stopped}");
}
