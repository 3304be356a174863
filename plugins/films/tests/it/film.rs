//! A film as a scene describes it, for the tests of its effects.

use spectra_core::registry::Context;
use spectra_core::resources::Resources;
use spectra_core::spectral::BAND;
use spectra_plugin_films::StockFilm;
use spectra_scene::FileResources;

/// Builds the film of these parameters, in YAML.
pub fn build(yaml: &str) -> StockFilm {
    let folder = tempfile::tempdir().expect("a folder");
    std::fs::write(folder.path().join("film.yaml"), yaml).expect("written");
    let resources = FileResources::beside(folder.path());
    let params = resources.document("film.yaml", &[], &[]).expect("YAML");
    StockFilm::build(&params, &Context::new(&resources, BAND)).unwrap_or_else(|faults| panic!("{yaml}: {faults}"))
}
