//! `spectra lens import` and `export`, and lens files of other programs wherever a lens is asked for.

use crate::common::{good, repository, run, shown, text};
use serde_json::Value;
use spectra_scene::FileResources;
use std::path::{Path, PathBuf};

/// All lens files of the repository.
fn lenses() -> Vec<PathBuf> {
    let files = |folder: &str| {
        let entries = std::fs::read_dir(repository(folder)).expect("a folder");
        entries
            .map(|entry| entry.expect("an entry").path())
            .filter(|path| path.extension().is_some_and(|e| e == "yaml"))
    };
    files("tests/data/lenses").chain(files("lenses")).collect()
}

fn efl(lens: &str, light: &[&str]) -> f64 {
    let arguments: Vec<&str> = ["lens", "info", lens, "--json"].into_iter().chain(light.iter().copied()).collect();
    let info: Value = serde_json::from_str(&good(&arguments)).expect("JSON");
    // A prism has none.
    info["efl_mm"].as_f64().unwrap_or(30.0)
}

/// Rays over a square in front of a lens, in three directions.
fn rays(folder: &Path, half_mm: f64) -> PathBuf {
    let mut table = "x_mm,y_mm,z_mm,l,m,n\n".to_owned();
    for slope in [0.0_f64, 0.05, -0.12] {
        for i in -6_i32..=6 {
            for j in -6_i32..=6 {
                let (x, y) = (f64::from(i) * half_mm / 6.0, f64::from(j) * half_mm / 6.0);
                table.push_str(&format!("{},{},-1,0,{slope},{}\n", x, y - slope, (1.0 - slope * slope).sqrt()));
            }
        }
    }
    let path = folder.join("rays.csv");
    std::fs::write(&path, table).expect("written");
    path
}

/// The entrance pupil that a file goes out with is the real one, by the marginal ray: the glass in front of it is far wider.
#[test]
fn exported_pupils_are_the_real_ones() {
    let folder = tempfile::tempdir().expect("a folder");
    for (name, front_mm) in [("zeiss-hologon-15-f8", 22.0), ("zeiss-biotar-50-f1.4", 35.5)] {
        let file = folder.path().join(format!("{name}.zmx"));
        good(&["lens", "export", name, "-o", shown(&file)]);
        let bytes = std::fs::read(&file).expect("written");
        let plain: String =
            bytes.iter().filter(|byte| byte.is_ascii() && **byte != 0).map(|byte| char::from(*byte)).collect();
        let stated = plain.lines().find_map(|line| line.strip_prefix("ENPD ")).expect("a pupil");
        let stated: f64 = stated.trim().parse().expect("a number");
        let info: Value = serde_json::from_str(&good(&["lens", "info", name, "--json"])).expect("JSON");
        let real = info["entrance_pupil_diameter_mm"].as_f64().expect("a number");
        assert!((stated - real).abs() < 1e-9 && stated < front_mm, "{name}: {stated} {real}");
    }
}

/// A surface that names no kind is a sphere, as everywhere.
#[test]
fn a_surface_without_a_kind_keeps_its_curvature() {
    let folder = tempfile::tempdir().expect("a folder");
    let own = folder.path().join("own.yaml");
    let text =
        "name: own\nsurfaces:\n  - {radius: 50, thickness: 5, glass: SCHOTT/N-BK7}\n  - {radius: -25, thickness: 30}\n";
    std::fs::write(&own, text).expect("written");
    let zmx = good(&["lens", "export", shown(&own)]);
    let curvatures: Vec<f64> = zmx
        .lines()
        .filter_map(|line| line.trim().strip_prefix("CURV ")?.split_whitespace().next()?.parse().ok())
        .filter(|curvature| *curvature != 0.0)
        .collect();
    assert_eq!(curvatures, [0.02, -0.04], "{zmx}");
}

/// Every lens goes out and comes back as the same lens: rays meet the image plane within 1e-12 mm (relative to a
/// focal length of 100 mm), and end for the same cause at the same surface.
#[test]
fn export_and_import_keep_every_ray() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut hits = 0;
    for path in lenses() {
        let lens = shown(&path);
        let zmx = folder.path().join("lens.zmx");
        good(&["lens", "export", lens, "-o", shown(&zmx), "--force"]);
        let yaml = folder.path().join("lens.yaml");
        good(&["lens", "import", shown(&zmx), "-o", shown(&yaml), "--force"]);
        let loaded = spectra_lens::load(lens, &FileResources::beside(Path::new(""))).expect("a lens");
        // A prism has no focal length.
        let efl =
            Some(loaded.first_order(loaded.reference_nm).efl_mm.abs()).filter(|efl| efl.is_finite()).unwrap_or(30.0);
        let scale = (efl / 100.0).max(1.0);
        let rays = rays(folder.path(), 0.35 * efl);
        for light in [&["--nd"][..], &["--line", "g"], &["--line", "C"]] {
            let trace = |lens: &str| {
                // No format holds coatings, nor the year by which a glass borrows its transmittance.
                let losses = ["--coating", "ideal", "--absorption", "false"];
                let arguments = [&["lens", "trace", lens, "--rays", shown(&rays)][..], &losses].concat();
                good(&arguments.into_iter().chain(light.iter().copied()).collect::<Vec<_>>())
            };
            let wanted = trace(lens);
            for found in [trace(shown(&zmx)), trace(shown(&yaml))] {
                assert_eq!(found.lines().count(), wanted.lines().count());
                for (a, b) in wanted.lines().zip(found.lines()).skip(1) {
                    let (a, b): (Vec<&str>, Vec<&str>) = (a.split(',').collect(), b.split(',').collect());
                    assert_eq!(a[..2], b[..2], "{lens} {light:?}");
                    for (a, b) in a.iter().zip(&b).skip(2).filter(|(a, _)| !a.is_empty()) {
                        let (a, b): (f64, f64) = (a.parse().expect("a number"), b.parse().expect("a number"));
                        assert!((a - b).abs() <= 1e-12 * scale, "{lens} {light:?}: {a} {b}");
                    }
                    hits += usize::from(a[0] == "hit");
                }
            }
        }
    }
    assert!(hits > 10_000, "{hits}");
}

#[test]
fn other_files_stand_for_lenses_everywhere() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = |name: &str, text: &str| {
        let path = folder.path().join(name);
        std::fs::write(&path, text).expect("written");
        path
    };
    // The same lens in three languages: N-BK7, R = 50, 5 mm thick; focal length 49.21300 mm at d in closed form.
    let zmx = file(
        "a.zmx",
        "MODE SEQ\nUNIT MM\nGCAT SCHOTT\nSURF 0\n  DISZ INFINITY\nSURF 1\n  STOP\n  CURV 0.02\n  DISZ 5\n  GLAS N-BK7 0 0 1.5 40\n  \
         CLAP 0 10 0\nSURF 2\n  CURV -0.02\n  DISZ 47.5\nSURF 3\n  CURV 0\n",
    );
    let seq = file("a.seq", "RDM\nDIM M\nSO 0 1e11\nS 50 5 NBK7_SCHOTT\n STO\n CIR 10\nS -50 47.5\nSI 0 0\n");
    let csv = file("a.csv", "radius,thickness,glass,semi-diameter\n50,5,SCHOTT/N-BK7,10\n-50,47.5,,\n");
    for path in [&zmx, &seq, &csv] {
        assert!((efl(shown(path), &["--line", "d"]) - 49.21300).abs() < 5e-6, "{}", path.display());
    }
    let scene = "spectra: 1\nsource: {kind: chart, chart: gray-card, distance: 2 m, width: 2.4 m, illuminant: D65, luminance: 300 cd/m2}\n\
                 lens: {file: a.zmx, focus: 2 m}\nimager: {kind: xyz, format: 135, resolution: [30, 20]}\nrender: {samples: 4, seed: 1}\n";
    let scene = file("scene.yaml", scene);
    assert!(good(&["check", shown(&scene)]).contains("good"));
}

#[test]
fn what_is_left_out_is_told_and_nothing_is_written_over() {
    let folder = tempfile::tempdir().expect("a folder");
    let zmx = folder.path().join("a.zmx");
    std::fs::write(&zmx, "SURF 0\n  DISZ INFINITY\nSURF 1\n  CURV 0.02\n  DISZ 5\n  GLAS N-BK7 0 0 1.5 40\n  FROB 1\n  COAT AR\nSURF 2\n  DISZ 90\nSURF 3\n")
        .expect("written");
    let out = folder.path().join("a.yaml");
    let first = run(&["lens", "import", shown(&zmx), "-o", shown(&out)]);
    let told = text(&first.stderr);
    assert!(
        first.status.success()
            && told.contains("! line 7: FROB")
            && told.contains("- line 8: coatings of 1 surfaces (AR)"),
        "{told}"
    );
    let written = std::fs::read_to_string(&out).expect("written");
    assert!(written.contains("# ! line 7: FROB") && written.contains("kind: sphere, radius: 50"), "{written}");

    let again = run(&["lens", "import", shown(&zmx), "-o", shown(&out)]);
    assert_eq!(again.status.code(), Some(2));
    assert!(text(&again.stderr).contains("--force"));
    let json = good(&["lens", "import", shown(&zmx), "-o", shown(&out), "--force", "--json"]);
    let json: Value = serde_json::from_str(&json).expect("JSON");
    assert_eq!(json["not_carried"].as_array().map(Vec::len), Some(2));
    assert_eq!(json["not_carried"][0]["alters_light"], Value::Bool(true));
    assert!(good(&["lens", "import", shown(&zmx)]).contains("surfaces:"), "without -o it goes to standard output");
    assert!(good(&["lens", "export", "zeiss-biotar-50-f1.4"]).contains("GLAS BAF9 0 0 1.64329 47.72"));

    // What is stated at other lines is written as nd and Vd, which is all that the format has.
    for (head, glass) in [
        ("reference-line: e\n", "nd: 1.518722, vd: 63.96"),
        ("reference-line: [F', e, C']\n", "nd: 1.518722, vd: 63.96"),
        ("", "ne: 1.518722, ve: 63.96"),
        ("", "glass: {ne: 1.518722, ve: 63.96}"),
        ("", "glass: {abbe: {lines: [F', e, C'], n: 1.518722, v: 63.96}}"),
        ("", "glass: {formula: cauchy, coefficients: [1.5046, 0.0042]}"),
    ] {
        let own = folder.path().join("own.yaml");
        let text = format!(
            "name: own\n{head}surfaces:\n  - {{kind: plane, thickness: 5, {glass}}}\n  - {{kind: plane, thickness: 1}}\n"
        );
        std::fs::write(&own, text).expect("written");
        let zmx = good(&["lens", "export", shown(&own)]);
        let line = zmx.lines().find(|line| line.trim().starts_with("GLAS")).unwrap_or_else(|| panic!("{zmx}"));
        let figures: Vec<f64> = line.split_whitespace().skip(4).take(2).map(|v| v.parse().expect("a number")).collect();
        assert!((figures[0] - 1.5168).abs() < 2e-4 && (figures[1] - 64.17).abs() < 2.0, "{head}{glass}: {line}");
        if !glass.contains("formula") {
            // Vd from Ve by the normal lines of partial dispersion: N-BK7 itself lies 0.02 off them.
            assert!((figures[0] - 1.5168).abs() < 3e-6 && (figures[1] - 64.17).abs() < 0.03, "{head}{glass}: {line}");
        }
    }

    for (arguments, word) in [
        (&["import", "none.zmx"][..], "no such file"),
        (&["import", "lens.stl"], "unknown file extension"),
        (&["export", "zeiss-biotar-50-f1.4", "-o", "x.seq"], "only .zmx"),
        (&["export", "zeiss-biotar-50-f1.5"], "zeiss-biotar-50-f1.4"),
    ] {
        let output = run(&["lens"].into_iter().chain(arguments.iter().copied()).collect::<Vec<_>>());
        let message = text(&output.stderr);
        assert_eq!(output.status.code(), Some(2), "{arguments:?}: {message}");
        assert!(message.contains(word), "{arguments:?}: {message}");
    }
}
