//! Tests of the sensor: electrons, noise, colors, and messages about faulty keys.

use spectra_color::{Adaptation, ciede2000, lab};
use spectra_core::frame::{ExposureChannel, ExposureFrame, RawFrame};
use spectra_core::params::Faults;
use spectra_core::registry::{Context, Stage};
use spectra_core::resources::Resources;
use spectra_core::spectral::{BAND, Channel, SpectralPower};
use spectra_core::stage::Imager;
use spectra_plugin_imagers::Plane;
use spectra_plugin_imagers::sensor::CameraColor;
use spectra_scene::FileResources;
use spectra_spectrum::COLOR_CHECKER;
use spectra_spectrum::{Observer, find_emission, find_reflectance};

fn build(yaml: &str) -> Result<Box<dyn Imager>, Faults> {
    // Names the crate, so that it is linked and its entries with it.
    let _ = Plane::new;
    let folder = tempfile::tempdir().expect("a folder");
    std::fs::write(folder.path().join("imager.yaml"), yaml).expect("written");
    std::fs::write(folder.path().join("mono.csv"), "wavelength_nm,sensitivity\n400,0.5\n700,0.5\n").expect("written");
    let resources = FileResources::beside(folder.path());
    let params = resources.document("imager.yaml", &[], &[]).expect("YAML");
    let entries = <dyn Imager as Stage>::entries();
    let entry = entries.iter().find(|e| e.name == "sensor").expect("registered");
    (entry.build)(&params, &Context::new(&resources, BAND))
}

const FRAME: &str = "width: 1 mm\nheight: 1 mm\nresolution: [200, 200]\nexposure: 1/100 s\n";

fn sensor(more: &str) -> Box<dyn Imager> {
    build(&format!("{FRAME}{more}")).unwrap_or_else(|f| panic!("{f}"))
}

fn channels(imager: &dyn Imager) -> Vec<Channel> {
    imager.response().expect("its own").channels()
}

/// Returns the numbers of the sensor's raw file.
fn raw(imager: &dyn Imager, exposure: &ExposureFrame) -> RawFrame {
    imager.response().and_then(|own| own.digitize()).expect("a converter").raw(exposure)
}

/// Returns an exposure with the same mean number of electrons in every well.
fn flat(imager: &dyn Imager, electrons: f32) -> ExposureFrame {
    let size = imager.size();
    let all = channels(imager).into_iter().enumerate().map(|(i, c)| ExposureChannel {
        name: c.name,
        unit: c.unit,
        values: vec![if i == 0 { electrons } else { 0.0 }; size.pixels()],
    });
    ExposureFrame { size, channels: all.collect() }
}

/// 1 W m^-2 at a wavelength is wavelength / (h c) photons: 2.7689e18 per second and m^2 at 550 nm (h c = 1.98645e-25 J m).
/// The pixel measures 5 um; at the peak of the quantum efficiency 40 % of the photons become electrons.
#[test]
fn electrons_are_photons_times_quantum_efficiency() {
    let imager = sensor("peak-quantum-efficiency: 40 %\n");
    let photons_per_nm = 25e-12 / 1.986_445_857e-25 * 1e-9;
    let mut peak = 0.0_f64;
    for channel in channels(&*imager) {
        assert_eq!(channel.unit, "e-");
        for (i, nm) in BAND.wavelengths_nm().enumerate() {
            peak = peak.max(channel.response[i] / (photons_per_nm * nm));
        }
    }
    assert!((peak - 0.4).abs() < 1e-9, "{peak}");
    assert_eq!(imager.response().and_then(|own| own.exposure_time_s()), Some(0.01));
    // The pitch determines the area, not the pixels of the picture.
    let green = |imager: &dyn Imager| channels(imager)[1].response[200];
    let coarse = sensor("pitch: 10 um\npeak-quantum-efficiency: 40 %\n");
    assert!((green(&*coarse) / green(&*imager) - 4.0).abs() < 1e-12);
    let mono = sensor("pattern: monochrome\nsensitivity: mono.csv\n");
    let [only] = &channels(&*mono)[..] else { panic!("one channel") };
    assert_eq!(only.name, "Y");
}

/// Photon transfer curve after J. R. Janesick: the variance as a function of the mean has the slope 1 / gain and starts at the read
/// noise. Each value is within five standard errors of 40000 pixels, including quantization (1/12).
#[test]
fn photon_transfer_gives_back_gain_and_read_noise() {
    let imager = sensor("full-well: 20000\nread-noise: 4\niso: 200\nbits: 14\nblack-level: 500\n");
    let gain = 10_000.0 / (16_383.0 - 500.0);
    for mean in [0.0_f32, 2.0, 50.0, 1000.0, 8000.0] {
        let raw = raw(&*imager, &flat(&*imager, mean));
        let n = raw.values.len() as f64;
        let values = || raw.values.iter().map(|v| f64::from(*v) - 500.0);
        let got = values().sum::<f64>() / n;
        let variance = values().map(|v| (v - got) * (v - got)).sum::<f64>() / (n - 1.0);
        let want = f64::from(mean) / gain;
        let wanted = (f64::from(mean) + 16.0) / (gain * gain) + 1.0 / 12.0;
        assert!((got - want).abs() < 5.0 * (wanted / n).sqrt(), "{mean}: mean {got} {want}");
        assert!((variance / wanted - 1.0).abs() < 5.0 * (2.3 / n).sqrt(), "{mean}: variance {variance} {wanted}");
        // The raw file states the same noise, relative to the range.
        let (noise, range) = (raw.noise.expect("noisy"), 16_383.0 - 500.0);
        let said = noise.scale * want / range + noise.offset;
        assert!((said * range * range / wanted - 1.0).abs() < 1e-9, "{mean}: {said}");
    }
    let quiet = sensor("noise: false\n");
    assert!(raw(&*quiet, &flat(&*quiet, 1.0)).noise.is_none());
}

#[test]
fn wells_and_numbers_end_somewhere() {
    let quiet = sensor("noise: false\nfull-well: 20000\nblack-level: 600\n");
    let number = |imager: &dyn Imager, electrons| raw(imager, &flat(imager, electrons)).values[7];
    assert_eq!([number(&*quiet, 0.0), number(&*quiet, 20_000.0), number(&*quiet, 1e6)], [600, 16_383, 16_383]);
    assert_eq!(number(&*quiet, 10_000.0), 600 + 7892);
    // At four times the base setting a quarter of the well gives the largest number.
    let fast = sensor("noise: false\nfull-well: 20000\nblack-level: 600\niso: 400\n");
    assert_eq!([number(&*fast, 2500.0), number(&*fast, 5000.0)], [600 + 7892, 16_383]);
    let again = sensor("noise-seed: 5\n");
    let frame = flat(&*again, 100.0);
    assert_eq!(raw(&*again, &frame), raw(&*again, &frame));
    assert_ne!(raw(&*again, &frame).values, raw(&*sensor("noise-seed: 6\n"), &frame).values);
}

/// The inverse matrix restores the colors of the ColorChecker as the eye sees them: CIEDE2000 below 2 on average and below 6
/// for the worst patch, which a camera with three colors and a linear matrix can reach. White is exact.
#[test]
fn the_matrix_gives_colors_back() {
    let imager = sensor("");
    let channels = channels(&*imager);
    let light = find_emission("D65").expect("bundled");
    let color = CameraColor::fit(&channels, &light, &BAND).expect("three colors");
    assert!((color.camera_from_xyz * color.white_xyz - color.neutral).length() < 1e-12);
    let raw = raw(&*imager, &flat(&*imager, 1.0));
    assert_eq!(raw.neutral, color.neutral.to_array());
    assert_eq!(raw.illuminant, 21);
    assert_eq!(raw.colors.iter().map(|c| c.illuminant).collect::<Vec<_>>(), [17, 21]);
    let power = light.to_power(&BAND);
    let observer = Observer::cie_1931_2deg().on_grid(&BAND);
    let largest = channels.iter().map(|c| power.seen_by(&c.response)).fold(0.0, f64::max);
    let y = power.seen_by(&observer[1]);
    let mut errors = Vec::new();
    for patch in [
        "dark-skin",
        "light-skin",
        "blue-sky",
        "foliage",
        "orange",
        "blue",
        "green",
        "red",
        "yellow",
        "cyan",
        "neutral-5",
    ] {
        let reflectance = find_reflectance(&format!("colorchecker#{patch}")).expect("bundled");
        let continuum = power.continuum.iter().zip(BAND.wavelengths_nm()).map(|(p, w)| p * reflectance.at(w)).collect();
        let lit = SpectralPower { continuum, ..power.clone() };
        let camera = glam::DVec3::from_array([0, 1, 2].map(|i: usize| lit.seen_by(&channels[i].response) / largest));
        let got = color.camera_from_xyz.inverse() * camera;
        let want = [0, 1, 2].map(|i: usize| lit.seen_by(&observer[i]) / y);
        let white = color.white_xyz.to_array();
        errors.push(ciede2000(lab(got.to_array(), white), lab(want, white)));
    }
    let mean = errors.iter().sum::<f64>() / errors.len() as f64;
    println!("CIEDE2000 mean {mean:.2}, all {errors:.2?}");
    assert!(mean < 2.0 && errors.iter().all(|e| *e < 6.0), "{errors:?}");
}

/// Raw converters use the file's matrices for A and for D65, whatever light is balanced to white. The camera's colors, each
/// divided by its value for white, become XYZ under D50: white exactly, the ColorChecker to a mean CIEDE2000 of 1.5.
#[test]
fn raw_files_carry_matrices_for_two_lights() {
    let imager = sensor("white-balance: FL11\nmodel: Mine\n");
    let raw = raw(&*imager, &flat(&*imager, 1.0));
    assert_eq!((raw.illuminant, raw.unique_model.as_str()), (255, "spectra Mine nikon-d5100"));
    let d50 = [0.3457 / 0.3585, 1.0, 0.2958 / 0.3585];
    let observer = Observer::cie_1931_2deg().on_grid(&BAND);
    let channels = channels(&*imager);
    for (name, color) in ["A", "D65"].into_iter().zip(&raw.colors) {
        let light = find_emission(name).expect("bundled").to_power(&BAND);
        let of = |matrix: [[f64; 3]; 3], v: [f64; 3]| matrix.map(|r| r[0] * v[0] + r[1] * v[1] + r[2] * v[2]);
        let white = of(color.d50_from_balanced, [1.0; 3]);
        assert!(white.iter().zip(d50).all(|(a, b)| (a - b).abs() < 1e-12), "{name}: {white:?}");
        let camera = |p: &SpectralPower| [0, 1, 2].map(|i: usize| p.seen_by(&channels[i].response));
        let eye = |p: &SpectralPower| [0, 1, 2].map(|i: usize| p.seen_by(&observer[i]));
        let (camera_white, eye_white) = (camera(&light), eye(&light));
        let adapt = Adaptation::Bradford.matrix(eye_white.map(|v| v / eye_white[1]), d50);
        let errors: Vec<f64> = COLOR_CHECKER
            .iter()
            .map(|patch| {
                let patch = find_reflectance(&format!("colorchecker#{patch}")).expect("bundled");
                let lit = light.continuum.iter().zip(BAND.wavelengths_nm()).map(|(p, w)| p * patch.at(w)).collect();
                let lit = SpectralPower { continuum: lit, ..light.clone() };
                let balanced: Vec<f64> = camera(&lit).iter().zip(camera_white).map(|(c, w)| c / w).collect();
                let got = of(color.d50_from_balanced, [balanced[0], balanced[1], balanced[2]]);
                let want = of(adapt, eye(&lit).map(|v| v / eye_white[1]));
                ciede2000(lab(got, d50), lab(want, d50))
            })
            .collect();
        let mean = errors.iter().sum::<f64>() / errors.len() as f64;
        println!("{name}: CIEDE2000 mean {mean:.3}");
        assert!(errors.len() == 24 && mean < 1.5, "{name}: {mean}");
    }
    // The file's other matrix maps the XYZ of D65 white to the camera's three colors of that white.
    let power = find_emission("D65").expect("bundled").to_power(&BAND);
    let white = [0, 1, 2].map(|i: usize| power.seen_by(&observer[i]));
    let seen = raw.colors[1].camera_from_xyz.map(|r| (0..3).map(|i| r[i] * white[i] / white[1]).sum::<f64>());
    let want = [0, 1, 2].map(|i: usize| power.seen_by(&channels[i].response));
    let largest = want.iter().fold(0.0, |a: f64, v| a.max(*v));
    assert!(seen.iter().zip(want).all(|(s, w)| (s - w / largest).abs() < 1e-12), "{seen:?}");
}

/// The file states how far its numbers reach beyond an exposure by ISO 12232: it is 0 if 78/S lx s of daylight fill the well.
#[test]
fn the_baseline_exposure_is_that_of_a_saturation_based_speed() {
    let stops = |more: &str| {
        let imager = sensor(more);
        raw(&*imager, &flat(&*imager, 1.0)).baseline_exposure_stops
    };
    let even = stops("");
    let channels = channels(&*sensor(""));
    let power = find_emission("D65").expect("bundled").to_power(&BAND);
    let y = power.seen_by(&Observer::cie_1931_2deg().on_grid(&BAND)[1]);
    let largest = channels.iter().map(|c| power.seen_by(&c.response)).fold(0.0, f64::max);
    let saturation_lx_s = 30_000.0 / (largest / (683.0 * y));
    assert!((even - libm::log2(saturation_lx_s * 100.0 / 78.0)).abs() < 1e-9, "{even}");
    // A well twice as large gives one stop more. A higher setting cuts the range by as much as it shortens the exposure.
    assert!((stops("full-well: 60000\n") - even - 1.0).abs() < 1e-9 && (stops("iso: 400\n") - even).abs() < 1e-9);
}

/// A gray card is shown as gray: the picture of white light has three equal values.
#[test]
fn white_is_shown_white() {
    let imager = sensor("noise: false\n");
    let light = find_emission("D65").expect("bundled").scaled_to_luminance(30.0).expect("light").to_power(&BAND);
    let size = imager.size();
    let pixels = || (0..size.pixels()).map(|p| (p % 200 % 2, p / 200 % 2));
    let all = channels(&*imager).into_iter().enumerate().map(|(i, c)| {
        let seen = light.seen_by(&c.response) as f32 * 0.01;
        // rggb
        let own = |(column, row): (usize, usize)| column + row == i;
        ExposureChannel {
            name: c.name,
            unit: c.unit,
            values: pixels().map(|p| if own(p) { seen } else { 0.0 }).collect(),
        }
    });
    let picture = imager
        .response()
        .and_then(|own| own.display(&ExposureFrame { size, channels: all.collect() }))
        .expect("a picture");
    for rgb in [picture.rgb[0], picture.rgb[20_100]] {
        let spread = rgb.iter().fold(0.0_f32, |a, v| a.max((v / rgb[1] - 1.0).abs()));
        assert!(spread < 0.01 && rgb[1] > 0.5, "{rgb:?}");
    }
}

#[test]
fn faulty_keys_are_told_at_their_places() {
    for (yaml, word) in [
        ("pattern: rgbg", "did you mean"),
        ("peak-quantum-efficiency: 140 %", "up to 1"),
        ("fill-factor: 2", "up to 1"),
        ("sensitivity: nikon-d5010", "nikon-d5100"),
        ("sensitivity: colorchecker", "red"),
        ("pattern: monochrome", "needs a `sensitivity`"),
        ("bits: 20", "8 to 16"),
        ("black-level: 20000", "no range"),
        ("iso: 50", "below `base-iso`"),
        ("white-balance: D56", "D55"),
        ("photosite: {stack: 3 um, index: 0.5}", "1 to 5"),
        ("photosite: {stack: 3 um, microlens: 2}", "0 to 1"),
        ("photosite: {well: 3 um}", "stack"),
        ("exposures: 3 s", "exposure"),
    ] {
        let text = build(&format!("{FRAME}{yaml}")).map(|_| ()).unwrap_err().to_string();
        assert!(text.contains("imager.yaml:") && text.contains(word), "{yaml}: {text}");
    }
}
