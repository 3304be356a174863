//! Tests of the round trip from RGB to a spectrum, XYZ and sRGB: each model is measured over 8-bit colors in steps of 15 per channel.

use spectra_color::{Adaptation, RgbSpace, fit_to_gamut, from_u8, lab};
use spectra_core::params::{Faults, Key, Node, Params, SourceFile, Span, Value};
use spectra_core::registry::{Context, build};
use spectra_core::resources::{Resource, ResourceError, Resources};
use spectra_core::spectral::{BAND, SpectralPower};
use spectra_core::stage::{ColorGamut, ColorModel};
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

/// Builds the model `kind` with its defaults, for the illuminant `light`.
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

/// Returns the largest and mean difference after the round trip, in 255ths of a channel, over all colors in steps of 15. Values are clipped
/// as on a screen.
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

/// The models that may be the default have a largest difference of 0.5 of 255, under D65 and without an illuminant.
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

/// The other models keep only white: their channels are not the primaries of sRGB, so a picture comes back in other colors.
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

/// The models that may be the default keep a full red free of green.
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

/// Colors of wide spaces, uniform in their linear cubes, keep luminance within 1 % and hue within 3 degrees under `smooth`. Colors that no
/// light can have are compared with those to which they are moved. Models of sRGB keep luminance. Chromaticities are compared by CIELAB at
/// half of white's luminance, adapted to D65 by Bradford.
#[test]
fn colors_of_wide_spaces_keep_luminance_and_hue() {
    let light = illuminant("D65").expect("bundled").to_power(&BAND);
    let (observer, srgb) = (Observer::cie_1931_2deg(), RgbSpace::srgb());
    let (smooth, primaries) = (model("smooth", Some(&light)), model("primaries", Some(&light)));
    let of_white = |model: &dyn ColorModel| observer.xyz_of_power(&model.spectrum([1.0; 3]))[1];
    let whites = [of_white(&*smooth), of_white(&*primaries)];
    let hue = |xyz: [f64; 3]| {
        let [_, a, b] = lab(xyz.map(|v| 0.5 * v / xyz[1]), srgb.white_xyz());
        (b.atan2(a).to_degrees(), a.hypot(b))
    };
    let mut state = 7_u64;
    let mut draw = move || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 11) as f64 / (1_u64 << 53) as f64
    };
    for space in [RgbSpace::aces_cg(), RgbSpace::rec2020(), RgbSpace::display_p3()] {
        let adapted = Adaptation::Bradford.matrix(space.white_xyz(), srgb.white_xyz());
        let primary = |k: usize| std::array::from_fn(|i| if i == k { 0.5 } else { 0.0 });
        let (mut beyond, mut moved, mut worst) = (0, 0, [0.0_f64; 2]);
        for i in 0..1003 {
            let rgb: [f64; 3] = if i < 3 { primary(i) } else { [draw(), draw(), draw()] };
            let wanted = srgb.from_xyz(spectra_color::matrix::apply(&adapted, space.to_xyz(rgb)));
            beyond += u32::from(wanted.iter().any(|v| *v < 0.0));
            let fitted = fit_to_gamut(wanted, ColorGamut::Real);
            moved += u32::from(fitted.distance_xy > 1e-4);
            let xyz = srgb.to_xyz(fitted.rgb);
            let power = smooth.spectrum(wanted);
            assert!(power.continuum.iter().all(|v| *v >= 0.0));
            let got = observer.xyz_of_power(&power).map(|v| v / whites[0]);
            let off = (got[1] / srgb.to_xyz(wanted)[1] - 1.0).abs();
            let ((a, chroma), (b, _)) = (hue(xyz), hue(got));
            let turned = ((a - b + 540.0) % 360.0 - 180.0).abs();
            assert!(off < 0.01 && (turned < 3.0 || chroma < 2.0), "{} {rgb:?}: {off} {turned}", space.name);
            worst = [worst[0].max(off), worst[1].max(if chroma < 2.0 { 0.0 } else { turned })];
            let power = primaries.spectrum(wanted);
            assert!(power.continuum.iter().all(|v| *v >= 0.0));
            let got = observer.xyz_of_power(&power)[1] / whites[1];
            assert!((got / srgb.to_xyz(wanted)[1] - 1.0).abs() < 0.01, "{} {rgb:?}: {got}", space.name);
        }
        let [luminance, turned] = worst;
        println!(
            "{}: {beyond} beyond sRGB, {moved} moved, luminance within {:.2} %, hue within {turned:.2} degrees",
            space.name,
            100.0 * luminance
        );
        assert!(beyond > 50 && moved > 0, "{}: {beyond} {moved}", space.name);
    }
}
