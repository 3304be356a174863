//! Tests filters and the matte box in front of the lens.

use crate::common::statistics::{drafted, rendered};
use spectra_core::frame::ExposureFrame;
use spectra_plugins as _;
use spectra_scene::Scene;
use spectra_spectrum::{Observer, find_emission, find_transmittance};
use std::path::Path;

fn load(set: &[&str]) -> Result<Scene, String> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes/gray-card.yaml");
    let set: Vec<String> = set.iter().map(|s| (*s).to_owned()).collect();
    spectra_scene::load(&path, &set).map_err(|faults| faults.to_string())
}

fn render(set: &[&str]) -> ExposureFrame {
    let scene = load(set).unwrap_or_else(|faults| panic!("{faults}"));
    rendered(&drafted(scene)).exposure
}

fn mean(frame: &ExposureFrame, channel: &str) -> f64 {
    let values = &frame.channel(channel).expect("an XYZ imager").values;
    values.iter().map(|v| f64::from(*v)).sum::<f64>() / values.len() as f64
}

const SMALL: &str = "imager={kind: xyz, width: 6, height: 4, resolution: [24, 16]}";

/// A gray filter halves all light in both directions, and does not change the choice of wavelengths.
#[test]
fn a_gray_filter_halves_everything() {
    for direction in ["render.direction=backward", "render.direction=forward"] {
        let common = [SMALL, direction, "render.rays=100000", "render.samples=32"];
        let open = render(&common);
        let gray = render(&[&common[..], &["lens.filters=[constant:0.5]"]].concat());
        for (a, b) in open.channels.iter().zip(&gray.channels) {
            for (a, b) in a.values.iter().zip(&b.values) {
                assert!((0.5 * a - b).abs() <= 1e-5 * a.abs() + 1e-9, "{a} {b}");
            }
        }
    }
}

/// Wratten 25 (red) and 58 (green), each used twice and with a gray filter, follow the integral of daylight, filter and observer.
#[test]
fn a_color_filter_does_what_its_table_says() {
    let light = find_emission("D65").expect("bundled");
    let observer = Observer::cie_1931_2deg();
    let common = [SMALL, "render.samples=256", "lens.coating=ideal", "lens.absorption=false"];
    let open = render(&common);
    for name in ["wratten-25", "wratten-58"] {
        let set = format!("lens.filters=[{name}, constant:0.8, {{file: {name}}}]");
        let seen = render(&[&common[..], &[set.as_str()]].concat());
        let filter = find_transmittance(name).expect("bundled");
        let power = light.to_power(&spectra_core::spectral::BAND);
        let mut filtered = power.clone();
        for (i, value) in filtered.continuum.iter_mut().enumerate() {
            let t = filter.at(spectra_core::spectral::BAND.wavelength_nm(i));
            *value *= 0.8 * t * t;
        }
        let (whole, part) = (observer.xyz_of_power(&power), observer.xyz_of_power(&filtered));
        for (k, channel) in ["X", "Y"].iter().enumerate() {
            let got = mean(&seen, channel) / mean(&open, channel);
            let want = part[k] / whole[k];
            println!("{name} {channel}: {got:.5}, by the tables {want:.5}");
            assert!((got / want - 1.0).abs() < 0.01, "{name} {channel}: {got} {want}");
        }
    }
}

fn thin_lens(folder: &Path) -> String {
    let file = folder.join("thin.yaml");
    let text = "name: Thin lens 50 mm\nsurfaces:\n  - {kind: thin-lens, focal-length: 50, semi-diameter: 6.25, stop: true, thickness: 50}\n";
    std::fs::write(&file, text).expect("written");
    format!("lens={{file: {}, focus: 2 m}}", file.display())
}

/// A slit 100 mm in front of an ideal lens cuts the pupil, seen from 2 m, to a strip of 4 mm * 2000 / 1900.
#[test]
fn a_matte_box_cuts_the_pupil() {
    let folder = tempfile::tempdir().expect("a folder");
    let lens = thin_lens(folder.path());
    let common = [
        lens.as_str(),
        "imager={kind: xyz, width: 0.2, height: 0.2, resolution: [8, 8]}",
        "source.width=20",
        "render.rays=1000000",
        "render.samples=1024",
    ];
    let u: f64 = 2.0 * 2000.0 / 1900.0 / 6.25;
    let want = 2.0 / std::f64::consts::PI * (u.asin() + u * (1.0 - u * u).sqrt());
    let slit = "lens.matte-box={distance: 100 mm, width: 4 mm, height: 100 mm}";
    for (direction, tolerance) in [("render.direction=backward", 0.005), ("render.direction=forward", 0.015)] {
        let open = mean(&render(&[&common[..], &[direction]].concat()), "Y");
        let cut = mean(&render(&[&common[..], &[direction, slit]].concat()), "Y");
        println!("{direction}: {:.5} passes, closed form {want:.5}", cut / open);
        assert!((cut / open / want - 1.0).abs() < tolerance, "{direction}: {} {want}", cut / open);
    }
}

#[test]
fn what_stands_in_front_leaves_the_lens_where_it_is() {
    let plain = load(&[]).expect("good").lens;
    let boxed = load(&["lens.matte-box={distance: 120 mm, width: 90 mm, height: 60 mm}"]).expect("good").lens;
    assert_eq!(boxed.elements.len(), plain.elements.len() + 1);
    assert_eq!(boxed.elements[0].vertex_z_mm(), -120.0);
    assert_eq!(boxed.elements[1].vertex_z_mm(), 0.0);
    assert!((boxed.image_z_mm() - plain.image_z_mm()).abs() < 1e-12);
    let (a, b) = (boxed.first_order(587.56), plain.first_order(587.56));
    assert!((a.efl_mm - b.efl_mm).abs() < 1e-9 && (a.bfl_mm - b.bfl_mm).abs() < 1e-9);
}

#[test]
fn faults_in_front_of_the_lens() {
    for (set, word) in [
        ("lens.filters=[wratten-16]", "wratten-1"),
        ("lens.filters=[{glass: SCHOTT/N-BK77, thickness: 2 mm}]", "N-BK7"),
        ("lens.filters=[{glass: SCHOTT/N-BK7}]", "missing key `thickness`"),
        ("lens.filters=[{file: no.csv}]", "no.csv"),
        ("lens.filters=[D65]", "transmittance"),
        ("lens.filters=[constant:0]", "no light of the band passes"),
        ("lens.filters=[7]", "no spectrum is called `7`"),
        ("lens.filters=[[1, 2]]", "this is not a filter"),
        ("lens.filter=[wratten-15]", "did you mean `filters`"),
        ("lens.matte-box={distance: 0, width: 1, height: 1}", "expected a positive length"),
        ("lens.matte-box={distance: 3 m, width: 100, height: 100}", "between the matte box and the lens"),
    ] {
        let faults = load(&[set]).err().unwrap_or_else(|| panic!("{set} is accepted"));
        assert!(faults.contains(word), "{set}: {faults}");
    }
}
