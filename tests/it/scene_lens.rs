//! Tests the `lens` section of a scene.

use spectra_lens::{Coating, Lens};
use spectra_optics::Optics;
use spectra_plugins as _;
use spectra_render::{Control, RenderOptions, Renderer, Threads};
use spectra_scene::load;
use spectra_tracer::Indices;
use std::path::Path;

fn lens(set: &[&str]) -> Result<Lens, String> {
    let scene = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes/biotar-ortho.yaml");
    let overrides: Vec<String> = set.iter().map(|s| (*s).to_owned()).collect();
    load(&scene, &overrides).map(|scene| Lens::clone(&scene.lens)).map_err(|faults| faults.to_string())
}

#[test]
fn focus_may_say_by_what() {
    let plain = lens(&["lens.focus=2 m", "lens.f-number=f/1.44"]).expect("good");
    for focus in ["{distance: 2 m}", "{distance: 2 m, by: contrast}", "{distance: 2 m, by: contrast, frequency: 30}"] {
        let same = lens(&[&format!("lens.focus={focus}"), "lens.f-number=f/1.44"]).expect("good");
        assert!((plain.image_gap_mm() - same.image_gap_mm()).abs() < 1e-4, "{focus}");
    }
    let paraxial = lens(&["lens.focus={distance: 2 m, by: paraxial}"]).expect("good");
    let rms = lens(&["lens.focus={distance: 2 m, by: rms}", "lens.f-number=f/1.44"]).expect("good");
    let spot = lens(&["lens.focus={distance: 2 m, by: spot}", "lens.f-number=f/1.44"]).expect("good");
    assert_eq!(rms.image_gap_mm().to_bits(), spot.image_gap_mm().to_bits());
    let contrast =
        lens(&["lens.focus={distance: 2 m, by: contrast, frequency: 5 lp/mm}", "lens.f-number=f/1.44"]).expect("good");
    let off =
        lens(&["lens.focus={distance: 2 m, by: rms, field: 12 deg, spectrum: [[486, 1], [656, 1]]}"]).expect("good");
    let gaps = [&paraxial, &plain, &rms, &contrast, &off].map(Lens::image_gap_mm);
    for (i, a) in gaps.iter().enumerate() {
        assert!(gaps[..i].iter().all(|b| (a - b).abs() > 1e-3), "{gaps:?}");
    }
    assert!(gaps.iter().all(|g| (g - gaps[0]).abs() < 1.0));
}

#[test]
fn a_lens_may_be_turned_coated_and_bent() {
    let plain = lens(&["lens.focus=infinity"]).expect("good");
    let turned = lens(&["lens.focus=infinity", "lens.reverse=true"]).expect("good");
    assert_eq!(turned.elements.len(), plain.elements.len());
    assert!((turned.first_order(587.56).ffl_mm + plain.first_order(587.56).bfl_mm).abs() < 1e-9);
    let bare = lens(&["lens.coating=bare", "lens.absorption=true"]).expect("good");
    assert_eq!((bare.coating, bare.absorption), (Coating::Bare, true));
    // The lens dates from 1927.
    assert_eq!((plain.coating, plain.absorption), (Coating::Bare, true));
    let ideal = lens(&["lens.coating=ideal", "lens.absorption=false"]).expect("good");
    assert!(ideal.is_lossless() && !lens(&["lens.coating=ideal"]).expect("good").is_lossless());
}

/// The light that coatings transmit arrives, in both directions: compares the middle of a gray card with the same random numbers.
#[test]
fn coatings_dim_the_picture() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes/gray-card.yaml");
    let middle = |set: &[&str]| {
        let common = [
            "imager.resolution=[12, 8]",
            "lens.absorption=false",
            "lens.f-number=f/4",
            "render.samples=512",
            "render.rays=400000",
        ];
        let overrides: Vec<String> = common.iter().chain(set).map(|s| (*s).to_owned()).collect();
        let scene = load(&path, &overrides).unwrap_or_else(|faults| panic!("{faults}"));
        let frame = Renderer::new(scene.clone(), &RenderOptions::default())
            .expect("a scene")
            .run(&Threads(2), &Control::new())
            .expect("rendered");
        let y = &frame.exposure.channel("Y").expect("XYZ").values;
        let sum: f32 = [3, 4].iter().flat_map(|row| [5, 6].map(|column| y[row * 12 + column])).sum();
        (f64::from(sum), scene.lens)
    };
    for direction in ["render.direction=backward", "render.direction=forward"] {
        let (ideal, lens) = middle(&[direction, "lens.coating=ideal"]);
        for coating in ["bare", "{layer: 1.38, quarter-wave-at: 550 nm}"] {
            let (coated, same) = middle(&[direction, &format!("lens.coating={coating}")]);
            let marginal = lens.marginal_ray().ok();
            // At the peak of Y. Around it, the transmittance of this lens varies by less than a per cent.
            let want = same.axial_transmittance(Indices::At(555.0), marginal).expect("media");
            assert!((coated / ideal / want - 1.0).abs() < 0.01, "{direction} {coating}: {} {want}", coated / ideal);
            assert!(want < 0.99);
        }
    }
}

#[test]
fn faults_of_the_lens_come_at_once() {
    let faults = lens(&[
        "lens.focus={distance: 2 m, by: eye, field: 95}",
        "lens.coating=shiny",
        "lens.adjust=[{group: rear, shift: 0.1}]",
    ])
    .expect_err("bad");
    for word in [
        "unknown value `eye` for `by`",
        "found 95, which is out of range",
        "unknown coating `shiny`",
        "no group `rear`",
    ] {
        assert!(faults.contains(word), "{word}: {faults}");
    }
    for (set, word) in [
        ("lens.focus={distance: 2 m, by: spot, frequency: 30}", "matters only with"),
        ("lens.focus={distance: 2 m, by: paraxial, wavelength: 500}", "matters only with"),
        ("lens.focus={distance: 2 m, by: rms, spectrum: []}", "found a list of 0"),
        ("lens.focus={distance: 2 m, by: rms, wavelength: 10 nm}", "found 10 nm, which is out of range"),
        ("lens.focus={by: rms}", "missing key `distance`"),
        ("lens.focus=3 kg", "expected a positive length"),
        ("lens.revers=true", "did you mean `reverse`"),
    ] {
        let faults = lens(&[set]).expect_err(set);
        assert!(faults.contains(word), "{set}: {faults}");
    }
}

/// A scene that scales a lens gets a lens of that focal length, with the same f-number, field and light.
#[test]
fn a_scene_scales_a_lens_to_a_focal_length() {
    let load = |lens: &str| {
        let text = format!(
            "spectra: 1\nsource: {{kind: chart, chart: gray-card, distance: 10 m, width: fill, illuminant: D55, luminance: 100 cd/m2}}\nlens: {{{lens}}}\n\
             imager: {{kind: xyz, format: 135, resolution: [6, 4]}}\n"
        );
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("scene.yaml");
        std::fs::write(&path, text).expect("written");
        spectra_scene::load(&path, &[]).map_err(|faults| faults.to_string())
    };
    for name in ["zeiss-biotar-50-f1.4", "helios-44-58-f2", "canon-ef-70-200-f2.8-at-72"] {
        let own = load(&format!("file: {name}")).expect("a scene").lens;
        let scene = load(&format!("file: {name}, focal-length: 120 mm")).expect("a scene");
        let lens = &scene.lens;
        let [a, b] = [&own, lens].map(|lens| lens.first_order(lens.reference_nm));
        let factor = 120.0 / a.efl_mm;
        assert!((b.efl_mm - 120.0).abs() < 1e-9, "{name}: {}", b.efl_mm);
        assert!((b.bfl_mm - a.bfl_mm * factor).abs() < 1e-9 * factor, "{name}");
        let f_number = |lens: &spectra_lens::Lens| Optics::new(lens.clone()).marginal_ray().expect("a ray").f_number();
        assert!((f_number(lens) / f_number(&own) - 1.0).abs() < 1e-6, "{name}");
        assert!((lens.image_along_axis_mm / own.image_along_axis_mm / factor - 1.0).abs() < 1e-9, "{name}");
        assert!(scene.all_notes().any(|note| note.contains("scaled from")), "{name}");
    }
    let told = load("file: zeiss-biotar-50-f1.4, focal-length: 0 mm").err().expect("refused");
    assert!(told.contains("greater than 0"), "{told}");
}
