//! Tests `spectra lens ghosts` and `spectra lens trace --path`.

use crate::common::{run, shown, text};
use serde_json::Value;
use std::path::Path;

/// Writes a lens of spherical surfaces from rows of radius, thickness and index behind the surface (1 is air), and returns its path.
fn lens(folder: &Path, rows: &[[f64; 3]]) -> std::path::PathBuf {
    let mut file = String::from("name: by hand\nreference-line: d\ncoating: bare\nsurfaces:\n");
    for [radius, thickness, index] in rows {
        let glass = if *index > 1.0 { format!(", nd: {index}, vd: 60") } else { String::new() };
        file.push_str(&format!("  - {{radius: {radius}, thickness: {thickness}{glass}, semi-diameter: 8}}\n"));
    }
    let path = folder.join("lens.yaml");
    std::fs::write(&path, file).expect("written");
    path
}

/// Returns the paraxial height and slope in the image plane of light that arrives at height 1. Refraction and reflection follow n'u'
/// = n u - y c (n' - n), where a reflection changes the signs of index and direction.
fn paraxial(rows: &[[f64; 3]], turns: [usize; 2]) -> [f64; 2] {
    let index = |gap: usize| if gap == 0 { 1.0 } else { rows[gap - 1][2] };
    let (mut y, mut u, mut sign, mut at, mut left) = (1.0, 0.0, 1.0, 0_isize, turns.to_vec());
    loop {
        let here = at as usize;
        // The gap in front of a surface has the number of the surface, and the gap behind it the next number.
        let (from, through) = if sign > 0.0 { (here, here + 1) } else { (here + 1, here) };
        let is_turn = left.first() == Some(&(here + 1));
        let (n, m) = (sign * index(from), if is_turn { -sign * index(from) } else { sign * index(through) });
        u = (n * u - y / rows[here][0] * (m - n)) / m;
        if is_turn {
            left.remove(0);
            sign = -sign;
        }
        let way = if sign > 0.0 { rows[here][1] } else { -rows.get(here.wrapping_sub(1)).map_or(0.0, |row| row[1]) };
        y += u * way;
        at += if sign > 0.0 { 1 } else { -1 };
        if at as usize == rows.len() {
            return [y, u];
        }
    }
}

/// Foci and focal lengths of all ghosts of a singlet and a cemented doublet agree with paraxial optics, and energies with Fresnel's
/// factors.
#[test]
fn ghosts_are_where_paraxial_optics_has_them() {
    let singlet = [[50.0, 5.0, 1.5168], [-50.0, 47.536, 1.0]];
    let doublet = [[61.5, 6.0, 1.5168], [-44.6, 2.5, 1.6727], [-130.0, 96.0, 1.0]];
    for rows in [&singlet[..], &doublet[..]] {
        let folder = tempfile::tempdir().expect("a folder");
        let file = lens(folder.path(), rows);
        let output = run(&["lens", "ghosts", shown(&file), "--json"]);
        assert!(output.status.success(), "{}", text(&output.stderr));
        let report: Value = serde_json::from_slice(&output.stdout).expect("JSON");
        let paths = report["paths"].as_array().expect("paths");
        assert_eq!(paths.len(), rows.len() * (rows.len() - 1) / 2);
        let mut sum = 0.0;
        for path in paths {
            let surface = |k: usize| path["surfaces"][k].as_u64().expect("a number") as usize;
            let [y, u] = paraxial(rows, [surface(0), surface(1)]);
            let (focus, length) =
                (path["focus_mm"].as_f64().expect("mm"), path["focal_length_mm"].as_f64().expect("mm"));
            assert!((focus * u / -y - 1.0).abs() < 1e-5, "{path}: {}", -y / u);
            assert!((length * -u - 1.0).abs() < 1e-6, "{path}: {}", -1.0 / u);
            sum += path["energy"].as_f64().expect("a number");
            assert!(path["size_mm"].as_f64().is_some_and(|mm| mm > 0.0) && path["color"][1] == 1.0);
        }
        assert!((sum / report["energy"].as_f64().expect("a number") - 1.0).abs() < 1e-12);
        if rows.len() == 2 {
            // (0.5168 / 2.5168)^4, valid at these small angles.
            assert!((sum / 0.001778 - 1.0).abs() < 0.05, "{sum}");
        }
    }
}

/// A window in front of a mirror, which light meets along the normals. Relative to the light that the mirror sends to the film, the
/// ghost of the window has R^2 with R = ((n - 1) / (n + 1))^2, and the table shows it in per cent.
#[test]
fn ghosts_in_front_of_a_mirror_have_their_share() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("window.yaml");
    let file = "name: window\nreference-line: d\ncoating: bare\nabsorption: false\nsurfaces:\n  - {kind: plane, thickness: 5, nd: 1.5168, vd: 60, semi-diameter: 10}\n  \
                - {kind: plane, thickness: 150, semi-diameter: 10}\n  - {radius: -200, thickness: -100, mirror: true, semi-diameter: 12}\n";
    std::fs::write(&path, file).expect("written");
    let output = run(&["lens", "ghosts", shown(&path), "--json"]);
    let report: Value = serde_json::from_slice(&output.stdout).expect("JSON");
    let r = (0.5168_f64 / 2.5168).powi(2);
    assert_eq!(report["paths"].as_array().map(Vec::len), Some(1), "{report}");
    assert!((report["energy"].as_f64().expect("a number") / (r * r) - 1.0).abs() < 1e-5, "{report}");
    let table = run(&["lens", "ghosts", shown(&path)]);
    assert!(text(&table.stdout).contains("together 0.178 % of the straight light"), "{}", text(&table.stdout));
}

/// A singlet has one path of four reflections, with about the fourth power of its reflectance. With a threshold above the light that
/// the path starts with, the path is cut and its light is reported as not traced.
#[test]
fn paths_of_four_are_cut_where_little_begins() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = lens(folder.path(), &[[50.0, 5.0, 1.5168], [-50.0, 47.536, 1.0]]);
    // Narrow enough that all light stays near the normals.
    let narrow = std::fs::read_to_string(&file).expect("written").replace("semi-diameter: 8", "semi-diameter: 1");
    std::fs::write(&file, narrow).expect("written");
    let found = |more: &[&str]| -> Value {
        let output = run(&[&["lens", "ghosts", shown(&file), "--json"], more].concat());
        assert!(output.status.success(), "{}", text(&output.stderr));
        serde_json::from_slice(&output.stdout).expect("JSON")
    };
    let surfaces = |report: &Value| -> Vec<Value> {
        report["paths"].as_array().expect("paths").iter().map(|path| path["surfaces"].clone()).collect()
    };
    let left = |report: &Value| report["not_traced"].as_f64().expect("a number");
    let r = (0.5168_f64 / 2.5168).powi(2);
    let [two, four, cut] = [&[][..], &["--order", "4"], &["--order", "4", "--share", "1e-3"]].map(found);
    assert_eq!(surfaces(&two), [serde_json::json!([2, 1])]);
    assert_eq!(surfaces(&four), [serde_json::json!([2, 1]), serde_json::json!([2, 1, 2, 1])]);
    assert_eq!(surfaces(&cut), surfaces(&two));
    let energy = four["paths"][1]["energy"].as_f64().expect("a number");
    assert!((energy / r.powi(4) - 1.0).abs() < 0.05, "{energy}");
    // Light that remains after a pair of reflections comes from a third reflection; after four, from a fifth.
    assert!((0.85..1.05).contains(&(left(&two) / r.powi(3))), "{}", left(&two));
    assert!((0.85..1.05).contains(&(left(&four) / r.powi(5))), "{}", left(&four));
    assert!((left(&cut) / left(&two) - 1.0).abs() < 1e-9);
}

/// The ledger in a picture's report states the number of reflections that it covers.
#[test]
fn a_report_says_the_order_of_its_books() {
    let scene = "spectra: 1\n\
        source: {kind: beam, distance: 10 mm, diameter: 0.1 mm, spectrum: he-ne}\n\
        lens: {file: zeiss-biotar-50-f1.4, focus: infinity}\n\
        imager: {kind: xyz, width: 36, height: 24, resolution: [24, 16]}\n\
        render: {direction: forward, samples: 1, rays: 1000}\n\
        output: [exr]\n";
    for order in [2, 4] {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("beam.yaml");
        std::fs::write(&path, scene).expect("written");
        let set = format!("render.reflections.order={order}");
        crate::common::good(&["run", shown(&path), "-o", shown(folder.path()), "--set", &set]);
        let report = std::fs::read(folder.path().join("beam.json")).expect("a report");
        let report: Value = serde_json::from_slice(&report).expect("JSON");
        assert_eq!(report["ledger"]["order"], order);
    }
}

/// The drawing shows the requested number of rays of the requested ghost.
#[test]
fn a_ghost_is_drawn() {
    let folder = tempfile::tempdir().expect("a folder");
    let size = |name: &str, more: &[&str]| {
        let file = folder.path().join(name);
        let output =
            run(&[&["lens", "ghosts", "zeiss-biotar-50-f1.4", "--coating", "bare", "-o", shown(&file)], more].concat());
        assert!(output.status.success(), "{}", text(&output.stderr));
        (std::fs::read_to_string(file).expect("an SVG").matches("<path").count(), text(&output.stderr))
    };
    let (few, said) = size("few.svg", &["--rays", "1", "--path", "9,5"]);
    assert!(said.contains("surfaces 9, 5"), "{said}");
    let (many, _) = size("many.svg", &["--rays", "8", "--path", "9,5"]);
    // The scale bar may differ.
    assert!(many >= few + 7, "{few} {many}");
    let (_, worst) = size("worst.svg", &["--field", "15"]);
    assert!(worst.contains("the ghost of surfaces"), "{worst}");
}

#[test]
fn the_table_is_for_people() {
    let output = run(&["lens", "ghosts", "zeiss-biotar-50-f1.4", "--f-number", "2"]);
    let said = text(&output.stdout);
    assert!(output.status.success() && said.contains("45 ghosts of two reflections"), "{said}");
    assert!(said.contains("--all shows them") && said.contains("7, 3"), "{said}");
    let ideal = run(&["lens", "ghosts", "zeiss-biotar-50-f1.4", "--coating", "ideal"]);
    assert!(text(&ideal.stdout).contains("0 ghosts"), "{}", text(&ideal.stdout));
}

/// A requested path is the one that is traced, compared with a ray of `tests/data/ghost-rays.csv`.
#[test]
fn rays_follow_a_path() {
    let data = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data");
    let table = std::fs::read_to_string(data.join("ghost-rays.csv")).expect("a table");
    let row: Vec<&str> = table.lines().nth(1).expect("a row").split(',').collect();
    let folder = tempfile::tempdir().expect("a folder");
    let rays = folder.path().join("rays.csv");
    std::fs::write(&rays, format!("x_mm,y_mm,z_mm,l,m,n\n{}\n", row[3..9].join(","))).expect("written");
    let file = data.join("lenses").join(format!("{}.yaml", row[0]));
    let trace = |path: &str| run(&["lens", "trace", shown(&file), "--rays", shown(&rays), "--nd", "--path", path]);
    let output = trace(&row[1..3].join(","));
    let said = text(&output.stdout);
    let hit: Vec<&str> = said.lines().nth(1).expect("a row").split(',').collect();
    assert_eq!(hit[0], "hit", "{said}{}", text(&output.stderr));
    for (got, want) in [(hit[2], row[9]), (hit[3], row[10]), (hit[5], row[11])] {
        let [got, want] = [got, want].map(|v| v.parse::<f64>().expect("a number"));
        assert!((got - want).abs() < 1e-9, "{got} {want}");
    }
    for (path, word) in
        [("3", "odd number"), ("6,1", "does not refract"), ("1,3", "does not reach"), ("0,1", "counted from 1")]
    {
        let output = trace(path);
        assert!(!output.status.success() && text(&output.stderr).contains(word), "{path}: {}", text(&output.stderr));
    }
}
