//! RGB to a spectrum to XYZ to sRGB: each model measured over all 8-bit colors in steps of 15 per channel.

use spectra_color::{RgbSpace, from_u8};
use spectra_core::params::{Faults, Key, Node, Params, SourceFile, Span, Value};
use spectra_core::registry::{Context, build};
use spectra_core::resources::{Resource, ResourceError, Resources};
use spectra_core::spectral::{BAND, SpectralPower};
use spectra_core::stage::ColorModel;
use spectra_plugin_colors as _;
use spectra_spectrum::{Observer, illuminant};
use std::sync::Arc;

struct NoFiles;

impl Resources for NoFiles {
    fn read(&self, _: &str, _: &[&str], _: &[&str], _: u64) -> Result<Resource, ResourceError> {
        Err(ResourceError::NotFound(Vec::new()))
    }

    fn document(&self, _: &str, _: &[&str], _: &[&str]) -> Result<Params, Faults> {
        Err(Faults::new())
    }
}

/// The model `kind` with nothing else said, white being `light`.
fn model(kind: &str, light: Option<&SpectralPower>) -> Box<dyn ColorModel> {
    let text = format!("kind: {kind}");
    let file = Arc::new(SourceFile::new("scene.yaml", text.clone()));
    let span = |offset, len| Span { line: 1, column: offset + 1, offset, len };
    let value = Node::new(Value::from_plain(kind), span(6, kind.len()), Arc::clone(&file));
    let entries = vec![(Key { text: "kind".to_owned(), span: span(0, 4) }, value)];
    let node = Node::new(Value::Map(entries), span(0, text.len()), file);
    let params = Params::stage(node, "source.color").expect("a stage");
    let context = Context { illuminant: light, ..Context::new(&NoFiles, BAND) };
    build::<dyn ColorModel>(&params, &context).unwrap_or_else(|e| panic!("{kind}: {e}"))
}

/// Largest and mean difference, in 255ths of a channel, over all colors in steps of 15; clipped as a screen clips.
fn round_trip(model: &dyn ColorModel) -> (f64, f64) {
    let (observer, srgb) = (Observer::cie_1931_2deg(), RgbSpace::srgb());
    let white = observer.xyz_of_power(&model.spectrum([1.0; 3]))[1];
    let (mut largest, mut sum, mut count) = (0.0_f64, 0.0, 0.0);
    for r in (0..=255).step_by(15) {
        for g in (0..=255).step_by(15) {
            for b in (0..=255).step_by(15) {
                let encoded = [r, g, b].map(from_u8);
                let xyz = observer.xyz_of_power(&model.spectrum(srgb.decode(encoded)));
                let back = srgb.encode(srgb.from_xyz(xyz.map(|v| v / white)));
                for (a, b) in back.iter().zip(encoded) {
                    let off = 255.0 * (a.clamp(0.0, 1.0) - b).abs();
                    largest = largest.max(off);
                    sum += off;
                    count += 1.0;
                }
            }
        }
    }
    (largest, sum / count)
}

/// Under D65, and with nothing said: at most 0.5 of 255 for the models that may be the default.
#[test]
fn faithful_models_round_trip_within_half_a_step() {
    let light = illuminant("D65").expect("bundled").to_power(&BAND);
    for kind in ["primaries", "smooth"] {
        for light in [Some(&light), None] {
            let (largest, mean) = round_trip(&*model(kind, light));
            println!("{kind}: largest {largest:.4}, mean {mean:.4} of 255");
            assert!(largest <= 0.5, "{kind}: {largest}");
        }
    }
}

/// The others keep white only: their channels are not the primaries of sRGB, and a picture comes back in other colors.
#[test]
fn other_models_keep_white_but_not_colors() {
    let light = illuminant("D65").expect("bundled").to_power(&BAND);
    for kind in ["gaussians", "fraunhofer"] {
        let model = model(kind, Some(&light));
        let (largest, mean) = round_trip(&*model);
        println!("{kind}: largest {largest:.1}, mean {mean:.1} of 255");
        assert!(largest > 0.5, "{kind} is faithful: name it so");
        let observer = Observer::cie_1931_2deg();
        let white = observer.xyz_of_power(&model.spectrum([1.0; 3]));
        for v in RgbSpace::srgb().from_xyz(white.map(|v| v / white[1])) {
            assert!((v - 1.0).abs() < 1e-3, "{kind}: white is {v}");
        }
    }
}

/// No green that was not there: a full red stays without green in the models that may be the default.
#[test]
fn red_has_no_phantom_green() {
    let (observer, srgb) = (Observer::cie_1931_2deg(), RgbSpace::srgb());
    for kind in ["primaries", "smooth"] {
        let model = model(kind, None);
        let white = observer.xyz_of_power(&model.spectrum([1.0; 3]))[1];
        let xyz = observer.xyz_of_power(&model.spectrum([1.0, 0.0, 0.0]));
        let green = 255.0 * srgb.encode(srgb.from_xyz(xyz.map(|v| v / white)))[1];
        assert!(green.abs() < 0.5, "{kind}: {green}");
    }
}
