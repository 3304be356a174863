//! Tests that every kind of data can be added with files only, in an empty folder with just the program.

use crate::common::{self, text};
use serde_json::Value;
use std::path::Path;
use std::process::Output;

/// Creates a folder with these files.
fn folder(files: &[(&str, &str)]) -> tempfile::TempDir {
    let folder = tempfile::tempdir().expect("a folder");
    for (name, content) in files {
        write(folder.path(), name, content);
    }
    folder
}

fn write(folder: &Path, name: &str, content: &str) {
    let path = folder.join(name);
    std::fs::create_dir_all(path.parent().expect("in the folder")).expect("a folder");
    std::fs::write(path, content).expect("written");
}

fn run_in(folder: &tempfile::TempDir, arguments: &[&str]) -> Output {
    common::run_in(folder.path(), arguments)
}

fn good(folder: &tempfile::TempDir, arguments: &[&str]) -> String {
    let output = run_in(folder, arguments);
    assert!(output.status.success(), "{arguments:?}: {}", text(&output.stderr));
    text(&output.stdout)
}

fn json(folder: &tempfile::TempDir, arguments: &[&str]) -> Value {
    serde_json::from_str(&good(folder, arguments)).expect("JSON")
}

/// Returns what `spectra check` says about a broken scene.
fn said(folder: &tempfile::TempDir, scene: &str) -> String {
    let output = run_in(folder, &["check", scene]);
    assert_eq!(output.status.code(), Some(2), "{}", text(&output.stdout));
    text(&output.stderr)
}

/// Returns the mean of a channel of an EXR file in the folder.
fn mean(folder: &tempfile::TempDir, file: &str, channel: &str) -> f64 {
    let image = exr::prelude::read_all_flat_layers_from_file(folder.path().join(file)).expect("an EXR");
    let of = |c: &&exr::prelude::AnyChannel<exr::prelude::FlatSamples>| c.name.to_string() == channel;
    let layers = image.layer_data.iter().flat_map(|layer| &layer.channel_data.list);
    let found = layers.clone().find(of).unwrap_or_else(|| panic!("no {channel}"));
    let values: Vec<f64> = found.sample_data.values_as_f32().map(f64::from).collect();
    values.iter().sum::<f64>() / values.len() as f64
}

/// A glass with SCHOTT's coefficients of N-BK7; its data sheet states nd 1.51680 and Vd 64.17.
const CROWN: &str = "name: MY-CROWN\nformula: sellmeier-1\ncoefficients:\n  [1.03961212, 0.00600069867, 0.231792344, \
    0.0200179144, 1.01046945, 103.560653]\nrange: [310, 2325]\nnd: 1.5168\nvd: 64.17\n\
    internal-transmittance: {thickness: 10 mm, table: [[400, 0.997], [546, 0.998], [700, 0.998]]}\n";

const SINGLE: &str = "name: single\nsurfaces:\n  - {kind: sphere, radius: 100, thickness: 5, glass: GLASS, semi-diameter: 10}\n  \
    - {kind: sphere, radius: -100, thickness: 95, semi-diameter: 10, stop: true}\n";

/// A scene of a white sheet in equal-energy light, through a lens in the folder.
const SHEET: &str = "spectra: 1\nsource: {kind: chart, chart: white, distance: 1 m, width: 2 m, illuminant: E}\n\
    lens: {file: single.yaml}\nimager: {kind: xyz, width: 4, height: 4, resolution: [8, 8]}\nrender: {samples: 64, seed: 1}\noutput: [exr]\n";

/// Adds a glass as formula, table, CSV, AGF and a page of refractiveindex.info, and uses it in the command and in a lens. The focal
/// length follows the lensmaker's formula with nd 1.5168: 1/f = (n - 1) (2/R - (n - 1) d / (n R^2)).
#[test]
fn a_glass() {
    let n: f64 = 1.5168;
    let folder = folder(&[
        ("glasses/crown.yaml", CROWN),
        (
            "table.csv",
            "wavelength_nm,n,k\n486.1327,1.5223763,1e-8\n546.074,1.518722,1e-8\n587.5618,1.5168,1e-8\n656.2725,1.5143223,1e-8\n",
        ),
        (
            "inline.yaml",
            &SINGLE
                .replace("GLASS", "{name: X, table: [[486.1327, 1.52238], [587.5618, 1.5168], [656.2725, 1.51432]]}"),
        ),
        (
            "mine.agf",
            "NM K1 2 0 1.5168 64.17 0 1 -\nCD 1.03961212 6.00069867E-03 0.231792344 2.00179144E-02 1.01046945 103.560653\nLD 0.31 2.325\n",
        ),
        (
            "page.yml",
            "REFERENCES: a sheet\nDATA:\n  - type: formula 2\n    wavelength_range: 0.3 2.5\n    coefficients: 0 1.03961212 \
             0.00600069867 0.231792344 0.0200179144 1.01046945 103.560653\n  - type: tabulated k\n    data: |\n        0.400 1.0E-8\n        0.700 1.0E-8\n",
        ),
    ]);
    for name in ["glasses/crown.yaml", "table.csv", "mine.agf", "mine.agf#k1", "page.yml"] {
        let info = json(&folder, &["glass", "info", name, "--json"]);
        let (nd, vd) = (info["nd"].as_f64().expect("nd"), info["vd"].as_f64().expect("vd"));
        assert!((nd - n).abs() < 1e-6 && (vd - 64.17).abs() < 0.05, "{name}: {nd} {vd}");
        write(folder.path(), "single.yaml", &SINGLE.replace("GLASS", name));
        let efl = json(&folder, &["lens", "info", "single.yaml", "--json"])["efl_mm"].as_f64().expect("a length");
        let want = 1.0 / ((n - 1.0) * (2.0 / 100.0 - (n - 1.0) * 5.0 / (n * 1e4)));
        assert!((efl - want).abs() < 1e-4, "{name}: {efl} {want}");
    }
    assert!(json(&folder, &["lens", "info", "inline.yaml", "--json"])["efl_mm"].as_f64().expect("a length") > 90.0);
    // exp(-4 pi k d / lambda): a k of 1e-8 in the table, through 10 mm at the e line.
    let tau = json(&folder, &["glass", "info", "table.csv", "--wavelength-nm", "546.074", "--json"]);
    let want = (-4.0 * std::f64::consts::PI * 1e-8 * 1e7 / 546.074_f64).exp();
    assert!((tau["internal_transmittance_10mm_at"].as_f64().expect("known") - want).abs() < 1e-9);
    // Each fault points into the file of the glass.
    write(folder.path(), "single.yaml", &SINGLE.replace("GLASS", "glasses/crown.yaml"));
    write(folder.path(), "s.yaml", SHEET);
    for (broken, place) in [
        (CROWN.replace("nd: 1.5168", "nd: 1.6168"), "crown.yaml:6:5"),
        (CROWN.replace("sellmeier-1", "sellmeyer-1"), "did you mean `sellmeier-1`?"),
        (CROWN.replace(", 103.560653]", "]"), "found a list of 5, expected a list of 6"),
        (CROWN.replace("0.997", "99.7"), "crown.yaml:8:52"),
    ] {
        write(folder.path(), "glasses/crown.yaml", &broken);
        let said = said(&folder, "s.yaml");
        assert!(said.contains(place), "{place}: {said}");
    }
    write(folder.path(), "table.csv", "wavelength_nm,n\n400,1.5\n500,1.5x\n");
    write(folder.path(), "single.yaml", &SINGLE.replace("GLASS", "table.csv"));
    assert!(said(&folder, "s.yaml").contains("table.csv:3:5"));
}

/// Adds coatings. A quarter wave of index 1.38 on index 1.5 has R = ((n0 n2 - n1^2) / (n0 n2 + n1^2))^2 per surface at 550 nm; a
/// measured curve has 2 % per surface. Compared in narrow light of 550 nm with the same lens without reflections.
#[test]
fn a_coating() {
    let folder = folder(&[
        ("single.yaml", &SINGLE.replace("GLASS", "{nd: 1.5}")),
        ("coatings/quarter.yaml", "name: quarter\nlayers:\n  - {index: 1.38, quarter-wave-at: 550 nm}\n"),
        ("measured.csv", "wavelength_nm,reflectance\n400,0.02\n700,0.02\n"),
        ("s.yaml", &SHEET.replace("illuminant: E", "illuminant: \"line:550\"")),
    ]);
    let light = |coating: &str| {
        let set = format!("lens.coating={coating}");
        good(&folder, &["run", "s.yaml", "--output", "out", "--set", &set]);
        mean(&folder, "out/s.exr", "Y")
    };
    let all = light("ideal");
    let r = ((1.5 - 1.38 * 1.38) / (1.5 + 1.38 * 1.38_f64)).powi(2);
    // The rays are the same; angles of incidence of a few degrees change R only by their square.
    for (coating, want) in
        [("coatings/quarter.yaml", (1.0 - r) * (1.0 - r)), ("measured.csv", 0.98 * 0.98), ("bare", 0.96 * 0.96)]
    {
        let got = light(coating) / all;
        assert!((got - want).abs() < 2e-3, "{coating}: {got} {want}");
    }
    write(folder.path(), "coatings/quarter.yaml", "layers:\n  - {material: magnesum fluoride, thickness: 99.6}\n");
    write(folder.path(), "s.yaml", &SHEET.replace("single.yaml}", "single.yaml, coating: coatings/quarter.yaml}"));
    let said = said(&folder, "s.yaml");
    assert!(said.contains("quarter.yaml:2:16") && said.contains("no glass"), "{said}");
}

const TRI_X_MY_WAY: &str = "name: Tri-X, my way\nlike: kodak-tri-x-400\niso: 200\nlayers:\n  - name: panchromatic\n    \
    sensitivity: {file: seen.csv, reading: linear, measured-under: equal-energy}\n";

/// A stock that is like another one except for its speed and sensitivity inherits everything else.
#[test]
fn a_film_stock() {
    let folder = folder(&[
        ("stocks/mine.yaml", TRI_X_MY_WAY),
        ("stocks/seen.csv", "wavelength_nm,sensitivity\n399,0\n400,1\n500,1\n501,0\n"),
        ("single.yaml", &SINGLE.replace("GLASS", "{nd: 1.5}")),
        (
            "s.yaml",
            &SHEET.replace(
                "imager: {kind: xyz,",
                "film: [{stock: stocks/mine.yaml, exposure: 1 s, name: mine}, {stock: kodak-tri-x-400, exposure: 1 s, name: kodak}]\n\
                 imager: {kind: film,",
            ),
        ),
    ]);
    let [mine, kodak] =
        ["stocks/mine.yaml", "kodak-tri-x-400"].map(|name| json(&folder, &["film", "info", name, "--json"]));
    assert_eq!((&mine["iso"], &kodak["iso"]), (&Value::from(200.0), &Value::from(400.0)));
    assert_eq!(mine["reciprocity"], kodak["reciprocity"]);
    assert_eq!(mine["layers"][0]["developments"], kodak["layers"][0]["developments"]);
    assert!(mine["source"].as_str().is_some_and(|s| s.ends_with("; changed: iso, layers")), "{}", mine["source"]);
    let peak = |stock: &Value| stock["layers"][0]["peak_nm"].as_f64().expect("a wavelength");
    assert!((400.0..=500.0).contains(&peak(&mine)), "{}", peak(&mine));
    assert!(kodak["layers"][0]["developments"].as_array().is_some_and(|all| all.len() > 1));
    // A filter that is dark where the stock sees leaves the stock black; both stocks see the other half of the band.
    write(folder.path(), "blue.csv", "wavelength_nm,transmittance\n350,1\n540,1\n541,0\n830,0\n");
    write(folder.path(), "red.csv", "wavelength_nm,transmittance\n350,0\n540,0\n541,1\n830,1\n");
    let light = |filter: &str, film: &str| {
        let set = format!("lens.filters=[{filter}]");
        good(&folder, &["run", "s.yaml", "--output", "out", "--set", &set]);
        mean(&folder, "out/s.exr", &format!("{film}.panchromatic"))
    };
    let (blue, red) = (light("blue.csv", "mine"), light("red.csv", "mine"));
    assert!(blue > 0.0 && red < 1e-6 * blue, "{blue} {red}");
    assert!(light("red.csv", "kodak") > 0.0);
    for (broken, said_of_it) in [
        (TRI_X_MY_WAY.replace("iso: 200", "izo: 200"), "mine.yaml:3:1"),
        (TRI_X_MY_WAY.replace("tri-x-400", "try-x-400"), "did you mean `kodak-tri-x-400`?"),
        (TRI_X_MY_WAY.replace("kodak-tri-x-400", "mine.yaml"), "one builds on itself"),
    ] {
        write(folder.path(), "stocks/mine.yaml", &broken);
        let said = said(&folder, "s.yaml");
        assert!(said.contains(said_of_it), "{said_of_it}: {said}");
    }
    write(folder.path(), "stocks/mine.yaml", TRI_X_MY_WAY);
    write(folder.path(), "stocks/seen.csv", "wavelength_nm,sensitivity\n399,0\n400,one\n");
    assert!(said(&folder, "s.yaml").contains("seen.csv:3:5"));
}

/// Adds a lamp, a filter and paints. The exposure of a patch is the integral of lamp, filter, reflectance and y-bar. Flat curves are
/// compared with the same sheet without the filter and with a white paint.
#[test]
fn a_light_a_filter_and_paints() {
    let chart = "source: {kind: chart, chart: patches, reflectances: paints.csv, distance: 1 m, width: 0.4 m, illuminant: lamp.csv}";
    let folder = folder(&[
        ("lamp.csv", "wavelength_nm,power\n350,1\n830,1\n"),
        ("half.csv", "wavelength_nm,transmittance\n350,0.5\n830,0.5\n"),
        ("paints.csv", "wavelength_nm,gray\n350,0.25\n830,0.25\n"),
        ("white.csv", "wavelength_nm,white\n350,1\n830,1\n"),
        ("single.yaml", &SINGLE.replace("GLASS", "{nd: 1.5}")),
        (
            "s.yaml",
            &SHEET.replace("source: {kind: chart, chart: white, distance: 1 m, width: 2 m, illuminant: E}", chart),
        ),
    ]);
    let light = |sets: &[&str]| {
        let mut arguments = vec!["run", "s.yaml", "--output", "out"];
        sets.iter().for_each(|set| arguments.extend(["--set", set]));
        good(&folder, &arguments);
        mean(&folder, "out/s.exr", "Y")
    };
    let white = light(&["source.reflectances=white.csv"]);
    for (sets, want) in [(&[][..], 0.25), (&["lens.filters=[half.csv]"], 0.125), (&["source.illuminant=E"], 0.25)] {
        let got = light(sets) / white;
        assert!((got / want - 1.0).abs() < 1e-5, "{sets:?}: {got} {want}");
    }
    for (name, content, place) in [
        ("paints.csv", "wavelength_nm,gray\n350,0.25\n830,25\n", "paints.csv:3:5"),
        ("paints.csv", "wavelength_nm,gray,gray\n350,1,1\n", "paints.csv:1:20"),
        ("lamp.csv", "wavelength_nm,power\n350,1\n360,1\n340,1\n", "lamp.csv:4:1"),
    ] {
        let before = std::fs::read_to_string(folder.path().join(name)).expect("there");
        write(folder.path(), name, content);
        let said = said(&folder, "s.yaml");
        assert!(said.contains(place), "{place}: {said}");
        write(folder.path(), name, &before);
    }
    let info = json(&folder, &["spectrum", "info", "paints.csv", "--json"]);
    assert!(info.is_object());
}

/// Adds a drawing of the stop: the light is proportional to its area, here a square with a fifth of the area of the round opening.
#[test]
fn an_aperture() {
    // pi 10^2 / 5 = 62.83: a square of 7.9267 mm, in a flat stop, with nothing else limiting the light.
    let lens = "name: single\nsurfaces:\n  - {kind: sphere, radius: 100, thickness: 5, glass: {nd: 1.5}}\n  \
                - {kind: sphere, radius: -100, thickness: 2}\n  - {kind: stop, thickness: 95, semi-diameter: 10}\n";
    let svg = r#"<svg xmlns="http://www.w3.org/2000/svg" width="20mm" viewBox="0 0 200 200"><rect x="60.3665" y="60.3665" width="79.267" height="79.267"/></svg>"#;
    let folder =
        folder(&[("stop.svg", svg), ("single.yaml", lens), ("s.yaml", &SHEET.replace("samples: 64", "samples: 4096"))]);
    let light = |aperture: &str| {
        let mut arguments = vec!["run", "s.yaml", "--output", "out"];
        let set = format!("lens.aperture={aperture}");
        if !aperture.is_empty() {
            arguments.extend(["--set", &set]);
        }
        good(&folder, &arguments);
        mean(&folder, "out/s.exr", "Y")
    };
    let open = light("");
    let square = light("{shape: mask, file: stop.svg}") / open;
    // Light on the film falls with the fourth power of the cosine, (1 + r^2 / 95^2)^-2. Its mean over the disk is 1 / (1 + 10^2 /
    // 95^2), and over the square of side a it is 1 - 2 (a^2 / 6) / 95^2.
    let (disk, inner): (f64, f64) = (1.0 / (1.0 + 100.0 / 9025.0), 1.0 - 2.0 * 7.9267 * 7.9267 / 6.0 / 9025.0);
    // With 262 144 samples, a fifth of which pass, independent samples would have a standard error of 0.4 %; the other part has 0.1
    // %.
    assert!((square / (0.2 * inner / disk) - 1.0).abs() < 4e-3, "{square}");
    let obscured = light("{shape: mask, file: stop.svg, obscures: true}") / open;
    assert!((square + obscured - 1.0).abs() < 4e-3, "{square} {obscured}");
    write(folder.path(), "stop.svg", &svg.replace("<rect ", "<image/>\n<rect "));
    write(
        folder.path(),
        "s.yaml",
        &SHEET.replace("single.yaml}", "single.yaml, aperture: {shape: mask, file: stop.svg}}"),
    );
    assert!(said(&folder, "s.yaml").contains("stop.svg:1:"), "{}", said(&folder, "s.yaml"));
}

/// Adds a detector by its sensitivities, in equal-energy light. A Gaussian of standard deviation 20 nm sees 20 sqrt(2 pi) nm of it, a
/// rectangle its width, and CIE Y 683 lm/W times 106.857 nm (the sum of y-bar from 360 to 830 nm in steps of 1 nm).
#[test]
fn a_detector() {
    let folder = folder(&[
        ("bell.yaml", "kind: gaussian\ncenter: 550\nsigma: 20\n"),
        ("box.csv", "wavelength_nm,sensitivity\n499.999,0\n500,1\n600,1\n600.001,0\n"),
        ("single.yaml", &SINGLE.replace("GLASS", "{nd: 1.5}")),
        ("s.yaml", SHEET),
        (
            "d.yaml",
            &SHEET.replace(
                "kind: xyz",
                "kind: detector, exposure: 2 s, response: {kind: sensitivities, channels: {bell: bell.yaml, box: box.csv}, matrix: [[1, 0], [0, 1], [0, 0]]}",
            ),
        ),
        ("p.yaml", &SHEET.replace("kind: xyz", "kind: detector, response: photopic")),
    ]);
    for scene in ["s.yaml", "d.yaml", "p.yaml"] {
        good(&folder, &["run", scene, "--output", "out", "--samples", "1024"]);
    }
    let y = mean(&folder, "out/s.exr", "Y");
    let per_nm = y / (683.0 * 106.857);
    for (channel, want) in [("bell", 2.0 * 20.0 * std::f64::consts::TAU.sqrt()), ("box", 2.0 * 100.0)] {
        let got = mean(&folder, "out/d.exr", channel) / per_nm;
        // With 65 536 samples, each scattering by a few per cent per channel, the error is about 2e-4; the bound is four times that.
        assert!((got / want - 1.0).abs() < 1e-3, "{channel}: {got} {want}");
    }
    assert!((mean(&folder, "out/p.exr", "photopic") / y - 1.0).abs() < 1e-3);
    write(folder.path(), "box.csv", "wavelength_nm,sensitivity\n500,-1\n600,1\n");
    assert!(said(&folder, "d.yaml").contains("box.csv:2:5"));
    write(
        folder.path(),
        "e.yaml",
        &SHEET.replace("kind: xyz", "kind: detector, response: {kind: sensitivities, channels: {a: D65}}"),
    );
    assert!(said(&folder, "e.yaml").contains("sensitivity is expected here"));
}
