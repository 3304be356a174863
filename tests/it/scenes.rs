//! Tests that every lens of the repository loads, and that the registry is sound and complete.

use spectra_plugins as _;
use spectra_scene::FileResources;
use std::path::{Path, PathBuf};

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

fn files(folder: &Path, ending: &str) -> Vec<PathBuf> {
    let mut found = Vec::new();
    for entry in std::fs::read_dir(folder).expect("a folder of the repository").flatten() {
        let path = entry.path();
        if path.is_dir() {
            found.extend(files(&path, ending));
        } else if path.extension().is_some_and(|e| e == ending) {
            found.push(path);
        }
    }
    found.sort();
    found
}

#[test]
fn every_lens_loads_and_names_its_source() {
    let lenses = files(&root().join("lenses"), "yaml");
    assert!(!lenses.is_empty());
    for path in lenses {
        let name = path.to_string_lossy();
        let lens =
            spectra_lens::load(&name, &FileResources::beside(root())).unwrap_or_else(|faults| panic!("{faults}"));
        // A textbook design has no year, and its remark says so.
        assert!(lens.source.is_some() && (lens.year.is_some() || lens.remark.is_some()), "{name}");
    }
}

/// EFL and BFL in mm of the bundled Biotar at its stated indices, computed independently from the prescription of US 1786916, example
/// 2, halved.
#[test]
fn the_bundled_biotar_is_the_patents() {
    let lens = spectra_lens::load("zeiss-biotar-50-f1.4", &FileResources::beside(root())).expect("bundled");
    let first_order = lens.first_order_at_stated_nd();
    assert!((first_order.efl_mm - 49.784_021_6).abs() < 1e-6, "{first_order:?}");
    assert!((first_order.bfl_mm - 32.474_238_7).abs() < 1e-6, "{first_order:?}");
}

#[test]
fn the_registry_is_sound_and_complete() {
    spectra_core::registry::check().expect("no duplicates, well-formed names, summaries, one default");
    let listed: Vec<String> =
        spectra_core::registry::list().iter().map(|l| format!("{}/{}", l.stage, l.name)).collect();
    for expected in [
        "color/fraunhofer",
        "color/gaussians",
        "film/stock",
        "film/three-strip",
        "imager/detector",
        "imager/film",
        "imager/sensor",
        "imager/xyz",
        "response/photopic",
        "response/scotopic",
        "response/sensitivities",
        "source/chart",
        "source/picture",
        "source/point",
        "surface/plane",
        "surface/sphere",
        "surface/stop",
        "wavelengths/lines",
        "wavelengths/source-times-response",
        "wavelengths/uniform",
    ] {
        assert!(listed.iter().any(|l| l == expected), "{expected} is missing among {listed:?}");
    }
}
