//! Surfaces in a lens file: every kind is built as documented, and all faults are reported at once.

use spectra_core::params::Faults;
use spectra_core::registry::{Context, build};
use spectra_core::resources::Resources;
use spectra_core::spectral::BAND;
use spectra_core::surface::Surface;
use spectra_plugin_surfaces as _;
use spectra_scene::FileResources;

/// Builds the surface that a line of YAML describes. The folder holds a sag table of a paraboloid and two faulty tables.
fn surface(line: &str) -> Result<Box<dyn Surface>, Faults> {
    let folder = tempfile::tempdir().expect("a folder");
    let write = |name: &str, text: &str| std::fs::write(folder.path().join(name), text).expect("written");
    let rows: Vec<String> = (-3..=3)
        .map(|j| (-3..=3).map(|i| format!("{}", f64::from(i * i + j * j) * 0.01)).collect::<Vec<_>>().join(", "))
        .collect();
    write("good.csv", &format!("# a paraboloid\n{}\n", rows.join("\n")));
    write("bad.csv", "0,0,0,0\n0,0,0,0\n0,0,zero,0\n0,0,0,0\n");
    write("short.csv", "0,0,0,0\n0,0,0\n0,0,0,0\n0,0,0,0\n");
    write("surface.yaml", line);
    let resources = FileResources::beside(folder.path());
    let params = resources.document("surface.yaml", &[], &[])?;
    let params = spectra_core::params::Params::stage(params.node().clone(), "").expect("a map");
    build::<dyn Surface>(&params, &Context::new(&resources, BAND))
}

#[test]
fn every_kind_is_built_as_written() {
    let plane = (0.0, 0.0);
    for (line, curvature, x_mm, y_mm, sag_mm) in [
        ("{kind: conic, radius: -200, conic: -1}", (-0.005, -0.005), 3.0, 4.0, -25.0 / 400.0),
        ("{kind: even-asphere, radius: inf, coefficients: [1e-3, 1e-5]}", (0.002, 0.002), 0.0, 10.0, 0.2),
        ("{kind: even-asphere, radius: 1 cm, conic: -1, coefficients: [0, 0]}", (0.1, 0.1), 2.0, 0.0, 0.2),
        ("{kind: odd-asphere, radius: inf, coefficients: [0.05]}", plane, 3.0, 4.0, 0.25),
        ("{kind: cylinder, radius: 50, axis: x}", (0.0, 0.02), 9.0, 30.0, 10.0),
        ("{kind: toroid, radius: inf, rotation-radius: 50}", (0.02, 0.0), 30.0, 9.0, 10.0),
        ("{kind: toroid, radius: inf, coefficients: [0.01], rotation-radius: inf}", (0.0, 0.02), 9.0, 2.0, 0.04),
        ("{kind: biconic, radius-x: 50, radius-y: inf}", (0.02, 0.0), 30.0, 9.0, 10.0),
        ("{kind: tilted-plane, tilt-x: 45}", plane, 1.0, 3.0, 3.0),
        ("{kind: tilted-plane, tilt-y: -45 deg}", plane, 2.0, 3.0, 2.0),
        ("{kind: thin-lens, focal-length: 50}", plane, 1.0, 2.0, 0.0),
        ("{kind: grating, lines-per-mm: 600 lines/mm, order: -1, direction: 90}", plane, 1.0, 2.0, 0.0),
        ("{kind: grating, lines-per-mm: 600, order: 1, radius: -50}", (-0.02, -0.02), 0.0, 30.0, -10.0),
        (
            "{kind: zernike, normalization-radius: 10, coefficients: [0, 0, 0, 0.5], ordering: fringe}",
            (0.02, 0.02),
            0.0,
            10.0,
            0.5,
        ),
        ("{kind: sag-table, step: 1, file: good.csv}", (0.02, 0.02), 1.5, -2.25, 0.01 * (2.25 + 5.0625)),
        ("{kind: sag-table, step: 2, sag: [[0,1,2,3],[0,1,2,3],[0,1,2,3],[0,1,2,3]]}", plane, -3.0, 0.0, 0.0),
    ] {
        let built = surface(line).unwrap_or_else(|e| panic!("{line}: {e}"));
        let (cx, cy) = built.vertex_curvature_per_mm();
        assert!((cx - curvature.0).abs() < 1e-12 && (cy - curvature.1).abs() < 1e-12, "{line}: {cx} {cy}");
        let sag = built.sag_mm(x_mm, y_mm).unwrap_or_else(|| panic!("{line} does not reach out there"));
        assert!((sag - sag_mm).abs() < 1e-12, "{line}: {sag}");
    }
}

#[test]
fn faults_are_found_all_at_once() {
    let many = format!("{{kind: even-asphere, radius: 10, coefficients: [{}]}}", vec!["0"; 21].join(","));
    for (line, words) in [
        ("{kind: conic, radius: 0, conic: 1}", &["radius of 0"][..]),
        ("{kind: conic, radius: 5, conic: inf}", &["found the text `inf`"]),
        ("{kind: conic, radius: 5}", &["conic"]),
        ("{kind: conic, radius: 5, conic: 0, konic: 1}", &["konic"]),
        (&many, &["list of 21"]),
        ("{kind: even-asphere, radius: 10, coefficients: [1, x]}", &["coefficients[1]"]),
        ("{kind: odd-asphere, radius: 0, coefficients: [1e999]}", &["coefficients[0]"]),
        ("{kind: cylinder, radius: 10, axis: z}", &["z"]),
        ("{kind: toroid, radius: 10, rotation-radius: 0}", &["radius of 0"]),
        ("{kind: biconic, radius-x: 0, radius-y: 0}", &["radius-x", "radius-y"]),
        ("{kind: tilted-plane, tilt-x: 90, tilt-y: 120}", &["tilt-x", "tilt-y"]),
        ("{kind: thin-lens, focal-length: 0}", &["focal length"]),
        ("{kind: grating, lines-per-mm: -5, order: 1}", &["lines-per-mm"]),
        ("{kind: grating, lines-per-mm: 5, order: 1.5}", &["order"]),
        ("{kind: zernike, normalization-radius: 0, coefficients: [], ordering: noll}", &["normalization-radius"]),
        ("{kind: zernike, normalization-radius: 1, coefficients: [], ordering: ansi}", &["ansi"]),
        ("{kind: sag-table, step: 1}", &["no sags"]),
        (
            "{kind: sag-table, step: 1, file: good.csv, sag: [[0, 0, 0, 0], [0, 0, 0, 0], [0, 0, 0, 0], [0, 0, 0, 0]]}",
            &["both"],
        ),
        ("{kind: sag-table, step: 1, sag: []}", &["list of 0"]),
        ("{kind: sag-table, step: 1, file: none.csv}", &["none.csv"]),
        ("{kind: sag-table, step: 1, file: bad.csv}", &["line 3", "zero"]),
        ("{kind: sag-table, step: 1, file: short.csv}", &["row 2 has 3 numbers"]),
    ] {
        let faults = surface(line).map(|s| panic!("{line} is {s:?}")).unwrap_err();
        let text: Vec<String> = faults.iter().map(|f| format!("{} {f}", f.path)).collect();
        for word in words {
            assert!(text.iter().any(|t| t.contains(word)), "{line}: {text:?} without `{word}`");
        }
    }
}
