//! Tests `spectra lens import` and `export`, and lens files of other programs wherever a lens can be named.

use crate::common::{good, repository, run, shown, spectra, text};
use serde_json::Value;
use spectra_optics::Optics;
use spectra_scene::FileResources;
use std::path::{Path, PathBuf};

/// Returns all lens files of the repository.
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
    // A prism has no focal length.
    info["efl_mm"].as_f64().unwrap_or(30.0)
}

/// Writes a table of rays over a square in front of a lens, in three directions, and returns its path.
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

/// An exported file states the real entrance pupil, by the marginal ray, although the front glass is much wider.
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

/// A surface without `kind` is a sphere here too.
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

/// Every lens survives export and import. Rays meet the image plane within 1e-12 mm (relative to a focal length of 100 mm), and end
/// for the same reason at the same surface. For the bundled lenses, nothing that bends light is left out.
#[test]
fn export_and_import_keep_every_ray() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut hits = 0;
    for path in lenses() {
        let lens = shown(&path);
        let zmx = folder.path().join("lens.zmx");
        let yaml = folder.path().join("lens.yaml");
        let is_bundled = path.parent() == Some(&repository("lenses"));
        for (verb, from, to) in [("export", path.as_path(), &zmx), ("import", &zmx, &yaml)] {
            let output = run(&["lens", verb, shown(from), "-o", shown(to), "--force"]);
            let said = text(&output.stderr);
            assert!(output.status.success() && !(is_bundled && said.contains("  ! ")), "{lens}: {verb}: {said}");
        }
        let loaded = spectra_lens::load(lens, &FileResources::beside(Path::new(""))).expect("a lens");
        // A prism has no focal length.
        let efl =
            Some(loaded.first_order(loaded.reference_nm).efl_mm.abs()).filter(|efl| efl.is_finite()).unwrap_or(30.0);
        let scale = (efl / 100.0).max(1.0);
        let rays = rays(folder.path(), 0.35 * efl);
        for light in [&["--nd"][..], &["--line", "g"], &["--line", "C"]] {
            let trace = |lens: &str| {
                // No format holds coatings, or the year by which a glass borrows its transmittance.
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

/// Returns where a ray parallel to the axis through (x, y) meets a plane, in the unit of the file. The ray is refracted at a surface
/// with this sag, from air into a medium of index `n`, at the distance `gap` from the plane. Slopes of the sag are fourth-order
/// differences of four points.
fn refracted(sag: &dyn Fn(f64, f64) -> f64, [x, y]: [f64; 2], n: f64, gap: f64) -> [f64; 2] {
    const STEP: f64 = 1e-3;
    let slope =
        |f: &dyn Fn(f64) -> f64| (8.0 * (f(STEP) - f(-STEP)) - (f(2.0 * STEP) - f(-2.0 * STEP))) / (12.0 * STEP);
    let (zx, zy) = (slope(&|h| sag(x + h, y)), slope(&|h| sag(x, y + h)));
    // Snell's law in vector form; the normal points in the direction of the light.
    let length = (1.0 + zx * zx + zy * zy).sqrt();
    let normal = [-zx / length, -zy / length, 1.0 / length];
    let cosine = normal[2];
    let turned = (1.0 - (1.0 - cosine * cosine) / (n * n)).sqrt() - cosine / n;
    let way = [turned * normal[0], turned * normal[1], 1.0 / n + turned * normal[2]];
    let along = (gap - sag(x, y)) / way[2];
    [x + along * way[0], y + along * way[1]]
}

/// Each surface type of a `.zmx` file bends rays by its formula (OpticStudio user manual, Sequential Surfaces). All its numbers are
/// used, and lengths are in inches, which exposes any number wrongly treated as a length.
#[test]
fn types_of_surfaces_keep_their_formulas() {
    const N: f64 = 1.6;
    const GAP: f64 = 3.0;
    let conic = |r2: f64, c: f64, k: f64| c * r2 / (1.0 + (1.0 - (1.0 + k) * c * c * r2).sqrt());
    let base = move |x: f64, y: f64| conic(x * x + y * y, 0.2, -0.7);
    let r = |x: f64, y: f64| x.hypot(y);
    let powers = move |x: f64, y: f64, first: i32, step: i32, a: &[f64]| -> f64 {
        a.iter().enumerate().map(|(i, a)| a * r(x, y).powi(first + step * i as i32)).sum()
    };
    let polar = |x: f64, y: f64| (x.hypot(y) / 2.0, y.atan2(x));
    type Sag = Box<dyn Fn(f64, f64) -> f64>;
    let head = "  CURV 0.2\n  CONI -0.7\n";
    let list = |keyword: &str, first: usize, values: &[f64]| -> String {
        values.iter().enumerate().map(|(i, value)| format!("  {keyword} {} {value}\n", first + i)).collect()
    };
    const EVEN: [f64; 8] = [1e-2, -2e-3, 3e-4, 1e-5, -1e-5, 2e-6, 1e-6, -1e-6];
    const ODD: [f64; 8] = [2e-3, 1e-2, -2e-3, 1e-4, -1e-4, 2e-5, 1e-5, -1e-6];
    const TERMS: [f64; 11] = [1e-3, 2e-3, -1e-3, 3e-3, 1e-3, -2e-3, 1e-3, 2e-3, -1e-3, 1e-3, 2e-3];
    let cases: Vec<(&str, String, Sag)> = vec![
        ("STANDARD", head.to_owned(), Box::new(base)),
        (
            "EVENASPH",
            format!("{head}{}", list("PARM", 1, &EVEN)),
            Box::new(move |x, y| base(x, y) + powers(x, y, 2, 2, &EVEN)),
        ),
        (
            "ODDASPHE",
            format!("{head}{}", list("PARM", 1, &ODD)),
            Box::new(move |x, y| base(x, y) + powers(x, y, 1, 1, &ODD)),
        ),
        (
            "XASPHERE",
            format!(
                "{head}{}  XDAT 1 3\n  XDAT 2 2\n{}",
                list("PARM", 1, &EVEN),
                list("XDAT", 3, &[0.02, -0.03, 0.01])
            ),
            Box::new(move |x, y| {
                base(x, y) + powers(x, y, 2, 2, &EVEN) + powers(x / 2.0, y / 2.0, 2, 2, &[0.02, -0.03, 0.01])
            }),
        ),
        (
            "XOSPHERE",
            format!("{head}  XDAT 1 4\n  XDAT 2 2\n{}", list("XDAT", 3, &[0.01, 0.02, -0.03, 0.01])),
            Box::new(move |x, y| base(x, y) + powers(x / 2.0, y / 2.0, 1, 1, &[0.01, 0.02, -0.03, 0.01])),
        ),
        (
            "TOROIDAL",
            format!("{head}{}", list("PARM", 1, &[9.0, 1e-3, 2e-3, 1e-4, -1e-4])),
            Box::new(move |x, y| {
                let g = conic(y * y, 0.2, -0.7) + powers(0.0, y, 2, 2, &[1e-3, 2e-3, 1e-4, -1e-4]);
                9.0 - ((9.0 - g) * (9.0 - g) - x * x).sqrt()
            }),
        ),
        (
            "BICONICX",
            format!("{head}{}", list("PARM", 1, &[8.0, 0.4])),
            Box::new(|x, y| {
                let (a, b) = (x * x / 8.0, 0.2 * y * y);
                (a + b) / (1.0 + (1.0 - 1.4 * x * x / 64.0 - 0.3 * 0.04 * y * y).sqrt())
            }),
        ),
        ("TILTSURF", list("PARM", 1, &[0.1, -0.2]), Box::new(|x, y| 0.1 * x - 0.2 * y)),
        (
            // Noll's order, with angles measured from x.
            "SZERNSAG",
            format!("{head}  XDAT 1 11\n  XDAT 2 2\n{}", list("XDAT", 3, &TERMS)),
            Box::new(move |x, y| {
                let (p, t) = polar(x, y);
                let z = [
                    1.0,
                    2.0 * p * t.cos(),
                    2.0 * p * t.sin(),
                    3f64.sqrt() * (2.0 * p * p - 1.0),
                    6f64.sqrt() * p * p * (2.0 * t).sin(),
                    6f64.sqrt() * p * p * (2.0 * t).cos(),
                    8f64.sqrt() * (3.0 * p * p - 2.0) * p * t.sin(),
                    8f64.sqrt() * (3.0 * p * p - 2.0) * p * t.cos(),
                    8f64.sqrt() * p * p * p * (3.0 * t).sin(),
                    8f64.sqrt() * p * p * p * (3.0 * t).cos(),
                    5f64.sqrt() * (6.0 * p.powi(4) - 6.0 * p * p + 1.0),
                ];
                base(x, y) + z.iter().zip(TERMS).map(|(z, a)| z * a).sum::<f64>()
            }),
        ),
        (
            "FZERNSAG",
            format!("{head}  XDAT 1 11\n  XDAT 2 2\n{}", list("XDAT", 3, &TERMS)),
            Box::new(move |x, y| {
                let (p, t) = polar(x, y);
                let z = [
                    1.0,
                    p * t.cos(),
                    p * t.sin(),
                    2.0 * p * p - 1.0,
                    p * p * (2.0 * t).cos(),
                    p * p * (2.0 * t).sin(),
                    (3.0 * p * p - 2.0) * p * t.cos(),
                    (3.0 * p * p - 2.0) * p * t.sin(),
                    6.0 * p.powi(4) - 6.0 * p * p + 1.0,
                    p * p * p * (3.0 * t).cos(),
                    p * p * p * (3.0 * t).sin(),
                ];
                base(x, y) + z.iter().zip(TERMS).map(|(z, a)| z * a).sum::<f64>()
            }),
        ),
    ];
    let points = [[0.3, 0.4], [-0.7, 0.5], [1.1, -0.2], [0.05, -0.9]];
    let found = |kind: &str, own: &str, n: f64| {
        let glass = if n == 1.0 { String::new() } else { format!("  GLAS ___BLANK 1 0 {n} 0\n") };
        traced(
            &format!(
                "UNIT IN\nSURF 0\n  DISZ INFINITY\nSURF 1\n  STOP\n  TYPE {kind}\n{own}  DISZ {GAP}\n{glass}SURF 2\n"
            ),
            &points,
        )
    };
    let close = |kind: &str, found: Vec<[f64; 2]>, wanted: &dyn Fn([f64; 2]) -> [f64; 2]| {
        for (point, found) in points.into_iter().zip(found) {
            let wanted = wanted(point);
            let off = (found[0] - wanted[0]).hypot(found[1] - wanted[1]);
            assert!(off < 1e-9, "{kind} at {point:?}: {found:?}, by the formula {wanted:?}");
        }
    };
    for (kind, own, sag) in &cases {
        close(kind, found(kind, own, N), &|point| refracted(sag, point, N, GAP));
    }
    close("PARAXIAL", found("PARAXIAL", "  PARM 1 5\n  PARM 2 1\n", 1.0), &|point| {
        point.map(|v| v * (1.0 - GAP / 5.0))
    });
    // n' sin' - n sin = order x wavelength x lines, with lines along x.
    let sine = -(0.587_561_8 * 0.4);
    let shift = GAP * sine / (1.0 - sine * sine).sqrt();
    close("DGRATING", found("DGRATING", "  PARM 1 0.4\n  PARM 2 -1\n", 1.0), &|[x, y]| [x, y + shift]);
}

/// Returns where rays parallel to the axis through these points meet the image plane of a lens in inches, at the d line.
fn traced(zmx: &str, points: &[[f64; 2]]) -> Vec<[f64; 2]> {
    let folder = tempfile::tempdir().expect("a folder");
    let (lens, rays) = (folder.path().join("x.zmx"), folder.path().join("rays.csv"));
    std::fs::write(&lens, zmx).expect("written");
    let rows: String = points.iter().map(|[x, y]| format!("{},{},-20,0,0,1\n", 25.4 * x, 25.4 * y)).collect();
    std::fs::write(&rays, format!("x_mm,y_mm,z_mm,l,m,n\n{rows}")).expect("written");
    let table = good(&["lens", "trace", shown(&lens), "--rays", shown(&rays), "--line", "d"]);
    let mut lines = table.lines().map(|line| line.split(',').collect::<Vec<_>>());
    let head = lines.next().expect("a head");
    let at = |name: &str| head.iter().position(|column| *column == name).expect(name);
    let number = |line: &[&str], name: &str| line[at(name)].parse::<f64>().unwrap_or_else(|_| panic!("{table}")) / 25.4;
    lines.map(|line| [number(&line, "x_mm"), number(&line, "y_mm")]).collect()
}

/// A glass that is not bundled comes from a catalog file, which the imported lens file names by its relative path.
#[test]
fn glasses_come_from_a_catalogue_of_ones_own() {
    let folder = tempfile::tempdir().expect("a folder");
    let at = |name: &str| folder.path().join(name);
    for (name, zmx) in [("a.zmx", "GLAS OWN-7 0 0 1.61266 44.46"), ("b.zmx", "GLAS OWN-7 0 0 1.5 40")] {
        let file = format!(
            "SURF 0\n  DISZ INFINITY\nSURF 1\n  STOP\n  CURV 0.02\n  DISZ 5\n  {zmx}\nSURF 2\n  CURV -0.02\n  DISZ 40\nSURF 3\n"
        );
        std::fs::write(at(name), file).expect("written");
    }
    std::fs::create_dir(at("lenses")).expect("a folder");
    let agf = at("maker.agf");
    let forms = std::fs::read_to_string(repository("crates/glass/tests/data/forms.agf")).expect("a catalogue");
    std::fs::write(&agf, forms.replace("NM E-KZFH1 ", "NM OWN-7 ")).expect("written");
    let out = at("lenses/a.yaml");
    good(&["lens", "import", shown(&at("a.zmx")), "--agf", shown(&agf), "-o", shown(&out)]);
    let written = std::fs::read_to_string(&out).expect("written");
    assert!(
        written.contains("glass: ../maker.agf#OWN-7") || written.contains("glass: \"../maker.agf#OWN-7\""),
        "{written}"
    );
    let n = {
        let info = good(&["glass", "info", "OWN-7", "--agf", shown(&agf), "--json"]);
        serde_json::from_str::<Value>(&info).expect("JSON")["n"]["g"].as_f64().expect("a number")
    };
    // Lensmaker's formula for a lens of equal radii.
    let wanted = 1.0 / ((n - 1.0) * (0.04 - 5.0 * (n - 1.0) * 0.0004 / n));
    assert!((efl(shown(&out), &["--line", "g"]) - wanted).abs() < 1e-9);
    // Without the catalog, the command says how to supply one.
    let output = run(&["lens", "import", shown(&at("b.zmx")), "-o", shown(&at("b.yaml"))]);
    assert!(text(&output.stderr).contains("spectra lens import --agf FILE"), "{}", text(&output.stderr));
    let output =
        run(&["lens", "import", shown(&at("b.zmx")), "--agf", shown(&agf), "-o", shown(&at("b.yaml")), "--force"]);
    assert!(output.status.success() && !text(&output.stderr).contains("must be completed"), "{}", text(&output.stderr));
}

/// A tilde after `=`, which shells do not expand, means the home folder.
#[test]
#[cfg(unix)]
fn a_tilde_behind_an_equals_sign_is_the_home_folder() {
    let folder = tempfile::tempdir().expect("a folder");
    let home = folder.path().join("home");
    std::fs::create_dir(&home).expect("a folder");
    let mut command = spectra();
    command.current_dir(folder.path()).env("HOME", &home);
    let output =
        command.args(["lens", "export", "zeiss-biotar-50-f1.4", "--output=~/biotar.zmx"]).output().expect("starts");
    assert!(output.status.success(), "{}", text(&output.stderr));
    assert!(home.join("biotar.zmx").is_file() && !folder.path().join("~").exists());
    // The same is true in a scene, whose file names no shell expands.
    image::RgbImage::new(6, 4).save(home.join("photo.png")).expect("written");
    let scene = "spectra: 1\nsource: {kind: picture, file: ~/photo.png, distance: 2 m, width: fill}\n\
                 lens: {file: ~/biotar.zmx}\nimager: {kind: xyz, format: 135, resolution: [6, 4]}\n";
    std::fs::write(folder.path().join("scene.yaml"), scene).expect("written");
    let mut command = spectra();
    let output = command.current_dir(folder.path()).env("HOME", &home).args(["check", "scene.yaml"]).output();
    let output = output.expect("starts");
    assert!(output.status.success(), "{}", text(&output.stderr));
}

#[test]
fn other_files_stand_for_lenses_everywhere() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = |name: &str, text: &str| {
        let path = folder.path().join(name);
        std::fs::write(&path, text).expect("written");
        path
    };
    // The same lens in three formats: N-BK7, R = 50, 5 mm thick. Its focal length at d is 49.21300 mm in closed form.
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

    // Indices stated at other lines are converted to nd and Vd, which are all that the format has.
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
            // Vd is computed from Ve with the normal lines of partial dispersion; N-BK7 itself deviates by 0.02.
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

/// A scaled lens has another focal length and the same f-number.
#[test]
fn a_lens_is_scaled() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("biotar.yaml");
    good(&["lens", "scale", "zeiss-biotar-100-f1.4", "--to", "58mm", "-o", shown(&file)]);
    let load = |name: &str| {
        spectra_lens::load(name, &spectra_scene::FileResources::beside(std::path::Path::new(""))).expect("a lens")
    };
    let (before, after) = (load("zeiss-biotar-100-f1.4"), load(shown(&file)));
    let efl = |lens: &spectra_lens::Lens| lens.first_order(lens.reference_nm).efl_mm;
    assert!((efl(&after) - 58.0).abs() < 1e-6, "{}", efl(&after));
    // The source of its semi-diameters (`rims`) is kept.
    let written = std::fs::read_to_string(&file).expect("a file");
    let rims = |text: &str| text.lines().find(|line| line.starts_with("rims:")).map(str::to_owned);
    let own = std::fs::read_to_string(repository("lenses/zeiss-biotar-100-f1.4.yaml")).expect("a file");
    assert_eq!(rims(&written), rims(&own));
    let f_number = |lens: &spectra_lens::Lens| Optics::new(lens.clone()).marginal_ray().expect("open").f_number();
    assert!((f_number(&after) / f_number(&before) - 1.0).abs() < 1e-9);
    for (arguments, word) in [
        (&["lens", "scale", "zeiss-biotar-50-f1.4", "--by", "0"][..], "a factor of 0"),
        (&["lens", "scale", "prism-60-sf11", "--to", "50mm"], "--by FACTOR"),
    ] {
        let output = run(arguments);
        assert_ne!(output.status.code(), Some(0), "{arguments:?}");
        assert!(text(&output.stderr).contains(word), "{}", text(&output.stderr));
    }
}
