//! Glasses as a lens file states them.

use spectra_lens::Lens;
use spectra_plugin_surfaces as _;
use spectra_scene::FileResources;

const D_NM: f64 = 587.5618;

/// Loads a lens of one surface in front of this glass; otherwise returns the faults.
fn behind(glass: &str) -> Result<Lens, String> {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("lens.yaml");
    let text = format!(
        "name: One glass\ncoating: ideal\nsurfaces:\n  - {{kind: sphere, radius: 50, thickness: 5, glass: {glass}}}\n"
    );
    std::fs::write(&path, text).expect("written");
    spectra_lens::load(path.to_str().expect("UTF-8"), &FileResources::beside(folder.path())).map_err(|f| f.to_string())
}

/// `abbe: {curve: resonance}` is n = A + B / (L^2 - 0.014 um^2) through the stated figures, and accepts no other figures.
#[test]
fn a_curve_by_name_is_what_its_formula_says() {
    let lens = behind("{abbe: {curve: resonance, lines: [F, d, C], n: 1.62004, v: 36.37}}").expect("a glass");
    let index = |nm: f64| lens.index(1, nm);
    assert!((index(D_NM) - 1.62004).abs() < 1e-9);
    assert!(((index(D_NM) - 1.0) / (index(486.1327) - index(656.2725)) - 36.37).abs() < 1e-4);
    // Three indices over 1 / (L^2 - 0.014) lie on a line.
    let at = |nm: f64| (1.0 / (nm * nm * 1e-6 - 0.014), index(nm));
    let [(x0, n0), (x1, n1), (x2, n2)] = [420.0, 550.0, 700.0].map(at);
    assert!(((n1 - n0) / (x1 - x0) - (n2 - n0) / (x2 - x0)).abs() < 1e-12);
    for (glass, asks) in [
        ("{abbe: {curve: resonance, lines: [F, d, C], v: 36.37}, nd: 1.62004}", "no other figure"),
        ("{abbe: {curve: resonance, lines: [F, d, C], n: 1.62004, v: 36.37}, ve: 36.1}", "one Abbe number"),
    ] {
        let text = behind(glass).expect_err("refused");
        assert!(text.contains(asks), "{text}");
    }
}
