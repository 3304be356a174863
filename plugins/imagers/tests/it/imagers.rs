//! Tests of the imagers `xyz` and `film` as a scene uses them.

use spectra_core::frame::{ExposureChannel, ExposureFrame};
use spectra_core::params::Faults;
use spectra_core::registry::{Context, Stage};
use spectra_core::resources::Resources;
use spectra_core::spectral::BAND;
use spectra_core::stage::Imager;
use spectra_plugin_imagers::Plane;
use spectra_scene::FileResources;
use spectra_spectrum::illuminant;

fn build(kind: &str, yaml: &str) -> Result<Box<dyn Imager>, Faults> {
    // Names the crate, so that it is linked and its entries with it.
    let _ = Plane::new;
    let folder = tempfile::tempdir().expect("a folder");
    std::fs::write(folder.path().join("imager.yaml"), yaml).expect("written");
    let resources = FileResources::beside(folder.path());
    let params = resources.document("imager.yaml", &[], &[]).expect("YAML");
    let entries = <dyn Imager as Stage>::entries();
    let entry = entries.iter().find(|e| e.name == kind).expect("registered");
    (entry.build)(&params, &Context::new(&resources, BAND))
}

#[test]
fn sizes_are_given_by_name_or_in_millimetres() {
    for (yaml, width, height) in [
        ("format: 135\nresolution: [960, 640]", 36.0, 24.0),
        ("format: 6x7\nresolution: [960, 640]", 69.5, 56.0),
        ("format: super-35\nresolution: [960, 640]", 24.89, 18.67),
        ("width: 3.6 cm\nheight: 24\nresolution: [960, 640]", 36.0, 24.0),
    ] {
        for kind in ["xyz", "film"] {
            let size = build(kind, yaml).expect(yaml).size();
            assert_eq!((size.width_mm, size.height_mm, size.width_px, size.height_px), (width, height, 960, 640));
        }
    }
}

#[test]
fn faulty_frames_are_told_at_their_keys() {
    for (yaml, place, word) in [
        ("format: 136\nresolution: [960, 640]", "1:9", "did you mean `135`"),
        ("resolution: [960, 640]", "1:1", "format"),
        ("format: 135\nwidth: 36\nresolution: [960, 640]", "1:9", "twice"),
        ("width: 36\nresolution: [960, 640]", "1:8", "height"),
        ("width: 36\nheight: -3\nresolution: [960, 640]", "2:9", "positive"),
        ("width: 36\nheight: 1e9\nresolution: [960, 640]", "2:9", "100000 mm"),
        ("format: 135\nresolution: [0, 640]", "2:14", "1 to 32768"),
        ("format: 135\nresolution: [960, 40000]", "2:19", "1 to 32768"),
        ("format: 135\nresolution: [32768, 32768]", "2:13", "megapixels"),
        ("format: 135\nresolution: [960.5, 640]", "2:14", "960.5"),
        ("format: 135\nresolution: [960, 640]\npitch: 3 um", "3:1", "pitch"),
        ("format: 135\nresolution: [9, 6]\ntilt: [5 deg, 85 deg]", "3:15", "80 deg"),
        ("format: 135\nresolution: [9, 6]\ntilt: 5 deg", "3:7", "list of 2"),
        ("format: 135\nresolution: [9, 6]\nshift: [1 s, 0]", "3:9", "length"),
        ("format: 135\nresolution: [9, 6]\nshift: [0, 1e9]", "3:12", "100000 mm"),
        ("format: 135\nresolution: [9, 6]\ncover: [{glass: N-BK99, thickness: 1}]", "3:17", "N-BK"),
        ("format: 135\nresolution: [9, 6]\ncover: [{glass: N-BK7, thickness: 1 m}]", "3:35", "100 mm"),
        ("format: 135\nresolution: [9, 6]\nlow-pass: [{crystal: sugar, thickness: 1}]", "3:22", "quartz"),
        ("format: 135\nresolution: [9, 6]\ncurvature: {shape: saddle, radius: 9}", "3:20", "cylinder"),
        ("format: 135\nresolution: [9, 6]\ncurvature: {shape: sphere, radius: -20}", "3:36", "60 degrees"),
        ("format: 135\nresolution: [9, 6]\ncurvature: {shape: sphere, radius: 0}", "3:36", "60 degrees"),
    ] {
        for kind in ["xyz", "film"] {
            let text = build(kind, yaml).map(|_| ()).unwrap_err().to_string();
            assert!(text.contains(&format!("imager.yaml:{place}:")) && text.contains(word), "{yaml}: {text}");
        }
    }
}

/// One number is the width in pixels; the other side follows so that pixels are square.
#[test]
fn a_width_in_pixels_is_enough() {
    let size = build("xyz", "format: 135\nresolution: 960").expect("sound").size();
    assert_eq!((size.width_px, size.height_px), (960, 640));
}

#[test]
fn the_film_decides_what_a_film_plane_records() {
    let film = build("film", "format: 135\nresolution: [9, 6]").expect("sound");
    assert!(film.response().is_none() && film.receive().is_some() && film.launch().is_some());
}

/// Light of one lux records Y = 1, and X and Z according to its chromaticity, with 683 lm/W and the 1931 functions. D65 has
/// XYZ 95.047, 100, 108.883 (CIE 15:2004). The integral here is exact for the tables joined by straight lines instead of the
/// sum over them, which differs by 3e-5.
#[test]
fn xyz_is_absolute() {
    let xyz = build("xyz", "format: 135\nresolution: [9, 6]").expect("sound");
    let channels = xyz.response().expect("its own").channels();
    assert_eq!(channels.iter().map(|c| c.name.as_str()).collect::<Vec<_>>(), ["X", "Y", "Z"]);
    assert!(channels.iter().all(|c| c.unit == "lx"));
    let lux = illuminant("D65").expect("bundled").scaled_to_luminance(100.0).expect("light").to_power(&BAND);
    let recorded: Vec<f64> = channels.iter().map(|c| lux.seen_by(&c.response)).collect();
    for (got, want) in recorded.iter().zip([95.047, 100.0, 108.883]) {
        assert!((got - want).abs() < 0.02, "{recorded:?}");
    }
    // At 555 nm: 683 lx per W m^-2.
    assert_eq!(BAND.interpolate(&channels[1].response, 555.0), 683.0);
    let timed = build("xyz", "format: 135\nresolution: [9, 6]\nexposure: 1/8 s").expect("sound");
    let timed = timed.response().expect("its own");
    assert_eq!(timed.exposure_time_s(), Some(0.125));
    assert!(timed.channels().iter().all(|c| c.unit == "lx s"));
}

#[test]
fn white_is_automatic_or_stated_in_the_unit_of_the_channels() {
    let show = |yaml: &str| {
        let xyz = build("xyz", &format!("format: 135\nresolution: [9, 6]\n{yaml}")).map_err(|e| e.to_string())?;
        let size = xyz.size();
        let channel = |name: &str, value: f32| ExposureChannel {
            name: name.into(),
            unit: "lx".into(),
            values: vec![value; size.pixels()],
        };
        let channels = vec![channel("X", 0.9505 * 8.0), channel("Y", 8.0), channel("Z", 1.0891 * 8.0)];
        let picture = xyz.response().and_then(|own| own.display(&ExposureFrame { size, channels })).expect("complete");
        Ok::<f32, String>(picture.rgb[0][1])
    };
    assert!((show("").expect("automatic") - 0.9).abs() < 1e-3);
    assert!((show("white: 32 lx").expect("stated") - 0.25).abs() < 1e-3);
    assert!((show("white: 32").expect("stated") - 0.25).abs() < 1e-3);
    assert!((show("white: 32 lx s\nexposure: 1 s").expect("stated") - 0.25).abs() < 1e-3);
    for (yaml, word) in
        [("white: 32 lx s", "illuminance"), ("white: 32 lx\nexposure: 1 s", "exposure"), ("white: 0", "positive")]
    {
        let text = show(yaml).unwrap_err();
        assert!(text.contains("imager.yaml:3:8:") && text.contains(word), "{yaml}: {text}");
    }
}
