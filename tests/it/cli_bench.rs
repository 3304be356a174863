//! Tests that the figures of `spectra bench` are correct and machine-readable.

use crate::common::{good, repository, run, shown, text as text_of};
use serde_json::Value;
use std::path::Path;

fn scene(name: &str) -> String {
    shown(&repository(&format!("scenes/bench/sampling-{name}.yaml"))).to_owned()
}

/// Returns the report of a benchmark that writes its files to `folder`.
fn report(folder: &Path, name: &str, more: &[&str]) -> Value {
    let scene = scene(name);
    let arguments = ["bench", &scene, "--json", "--threads", "2", "-o", shown(folder)];
    let arguments: Vec<&str> = arguments.into_iter().chain(more.iter().copied()).collect();
    serde_json::from_str(&good(&arguments)).expect("JSON")
}

fn number(value: &Value) -> f64 {
    value.as_f64().unwrap_or_else(|| panic!("a number, not {value}"))
}

fn series<'a>(report: &'a Value, measure: &'a str, numbers: &'a str) -> impl Iterator<Item = &'a Value> {
    let all = report["series"].as_array().expect("a list");
    all.iter().filter(move |s| s["measure"] == measure && s["numbers"] == numbers)
}

#[test]
fn a_tiny_benchmark_writes_what_programs_read() {
    let folder = tempfile::tempdir().expect("a folder");
    let tiny = ["--seeds", "3", "--samples", "1,4", "--set", "imager.resolution=[6, 4]"];
    let tiny: Vec<&str> = tiny.into_iter().chain(["--strategies", "source-times-response,uniform"]).collect();
    let report = report(folder.path(), "d65-xyz", &tiny);
    assert_eq!(report["channels"], serde_json::json!(["X", "Y", "Z"]));
    // Two strategies, each with three series: the integral with both kinds of numbers, and the scene.
    assert_eq!(report["series"].as_array().expect("a list").len(), 6);

    let csv = std::fs::read_to_string(folder.path().join("sampling-d65-xyz-sampling.csv")).expect("a table");
    let mut lines = csv.lines().map(|line| line.split(',').collect::<Vec<_>>());
    let head = lines.next().expect("a head");
    let rows: Vec<Vec<&str>> = lines.collect();
    assert_eq!(rows.len(), 12);
    let column = |name: &str| head.iter().position(|h| *h == name).unwrap_or_else(|| panic!("no column {name}"));
    for row in &rows {
        assert_eq!(row.len(), head.len(), "{row:?}");
        let value = |name: &str| row[column(name)].parse::<f64>().unwrap_or_else(|e| panic!("{name}: {e}: {row:?}"));
        let (low, error, high) = (value("error_low"), value("relative_rms_error"), value("error_high"));
        assert!(low <= error && error <= high && error > 0.0, "{row:?}");
        assert!(value("seconds") > 0.0 && value("ciede2000") > 0.0, "{row:?}");
    }
    // Errors of the single seeds: their root mean square is the error in the table.
    let seeds = std::fs::read_to_string(folder.path().join("sampling-d65-xyz-sampling-seeds.csv")).expect("a table");
    let of_seeds: Vec<Vec<&str>> = seeds.lines().map(|line| line.split(',').collect()).collect();
    assert_eq!(of_seeds[0][5..], ["relative_rms_error", "relative_error X", "relative_error Y", "relative_error Z"]);
    let of_first: Vec<f64> = of_seeds[1..]
        .iter()
        .filter(|row| row[..4] == [rows[0][0], rows[0][1], rows[0][2], rows[0][3]])
        .map(|row| row[5].parse().expect("a number"))
        .collect();
    let error: f64 = rows[0][column("relative_rms_error")].parse().expect("a number");
    let mean = of_first.iter().map(|e| e * e).sum::<f64>() / of_first.len() as f64;
    assert_eq!(of_first.len().to_string(), rows[0][column("seeds")]);
    assert!((mean.sqrt() / error - 1.0).abs() < 1e-9, "{mean} {error}");
    let svg = std::fs::read_to_string(folder.path().join("sampling-d65-xyz-sampling.svg")).expect("a picture");
    assert!(svg.starts_with("<svg") && svg.contains("samples per pixel"));
    assert!(folder.path().join("sampling-d65-xyz-sampling.png").exists());
}

/// Another base seed gives other numbers, and the same seed the same numbers.
#[test]
fn a_base_seed_is_followed() {
    let of = |seed: &str| {
        let folder = tempfile::tempdir().expect("a folder");
        let more = ["--integral-only", "--strategies", "uniform", "--samples", "4", "--seeds", "5", "--seed", seed];
        report(folder.path(), "d65-xyz", &more);
        std::fs::read_to_string(folder.path().join("sampling-d65-xyz-sampling-seeds.csv")).expect("a table")
    };
    assert!(of("7") == of("7") && of("7") != of("8"));
}

/// The error of independent uniform wavelengths falls with the square root of their number, by the central limit theorem.
#[test]
fn random_numbers_have_a_slope_of_one_half() {
    let folder = tempfile::tempdir().expect("a folder");
    let more = ["--integral-only", "--strategies", "uniform", "--samples", "4,16,64,256,1024"];
    let report = report(folder.path(), "d65-ortho", &more);
    let slope = number(&series(&report, "integral", "random").next().expect("a series")["slope"]["value"]);
    assert!((slope + 0.5).abs() < 0.02, "{slope}");
    let even = number(&series(&report, "integral", "sobol").next().expect("a series")["slope"]["value"]);
    assert!(even < -0.9, "{even}");
}

/// The default strategy keeps its promised errors: 64 jittered strata, 1 000 seeds.
#[test]
fn the_usual_strategy_is_as_good_as_promised() {
    let folder = tempfile::tempdir().expect("a folder");
    let cases = [("d65-ortho", 0.002), ("fl11-ortho", 0.006), ("d65-xyz", 0.005), ("fl11-xyz", 0.010)];
    for (name, most) in cases.into_iter().chain([("mercury-ortho", 1e-9)]) {
        let more = ["--integral-only", "--strategies", "source-times-response", "--samples", "64"];
        let report = report(folder.path(), name, &more);
        let point = &series(&report, "integral", "sobol").next().expect("a series")["points"][0];
        assert!(number(&point["error"]["value"]) <= most, "{name}: {point}");
    }
}

/// Three curves in a file act as a color sensor: each column is a channel, and only the integral is measured.
#[test]
fn responses_of_ones_own_are_measured() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("sensor.csv");
    let curve = |nm: f64, center: f64| (-0.5 * ((nm - center) / 35.0) * ((nm - center) / 35.0)).exp();
    let mut text = String::from("# spectra: 1\n# kind: sensitivity\nwavelength_nm,red,green,blue\n");
    for i in 0..=40 {
        let nm = 380.0 + 10.0 * f64::from(i);
        text += &format!("{nm},{:.6},{:.6},{:.6}\n", curve(nm, 600.0), curve(nm, 540.0), curve(nm, 455.0));
    }
    std::fs::write(&path, text).expect("written");
    let more = ["--response", shown(&path), "--samples", "64", "--strategies", "source-times-response,uniform,hero"];
    let report = report(folder.path(), "fl11-xyz", &more);
    assert_eq!(report["channels"], serde_json::json!(["red", "green", "blue"]));
    assert!(report["reference"].is_null());
    let errors: Vec<f64> =
        series(&report, "integral", "sobol").map(|s| number(&s["points"][0]["error"]["value"])).collect();
    assert!(errors.len() == 3 && errors[0] < 0.02 && errors[1] > 3.0 * errors[0], "{errors:?}");
    let scene = scene("fl11-xyz");
    for (name, word) in [("no-such", "no-such"), ("D65", "kind emission"), ("nowhere.csv", "nowhere.csv")] {
        let output = run(&["bench", &scene, "--response", name, "-o", shown(folder.path())]);
        assert_eq!(output.status.code(), Some(2), "{name}");
        assert!(text_of(&output.stderr).contains("--response") && text_of(&output.stderr).contains(word), "{name}");
    }
}

/// The third kind of numbers, selected with `render.numbers`, is measured.
#[test]
fn stratified_numbers_are_measured() {
    let folder = tempfile::tempdir().expect("a folder");
    let more = [
        "--integral-only",
        "--strategies",
        "source-times-response",
        "--samples",
        "64",
        "--set",
        "render.numbers=stratified",
    ];
    let report = report(folder.path(), "d65-xyz", &more);
    let error = |numbers| {
        number(&series(&report, "integral", numbers).next().expect("a series")["points"][0]["error"]["value"])
    };
    assert!(error("stratified") < 0.005 && error("random") > 10.0 * error("stratified"));
}

#[test]
fn no_strategy_is_biased() {
    let folder = tempfile::tempdir().expect("a folder");
    for name in ["d65-ortho", "fl11-xyz", "mercury-ortho"] {
        let report = report(folder.path(), name, &["--integral-only", "--samples", "4,64"]);
        let mut strategies = 0;
        for one in series(&report, "integral", "sobol").chain(series(&report, "integral", "random")) {
            strategies += 1;
            for point in one["points"].as_array().expect("a list") {
                for bias in point["bias"].as_array().expect("a list") {
                    assert!(number(&bias["standard_errors"]).abs() < 4.0, "{name}, {}: {bias}", one["strategy"]);
                }
            }
        }
        assert!(strategies >= 8, "{name}: {strategies}");
    }
}

/// No strategy deviates from the reference in rendered pixels, and the errors of all fall at a similar rate.
#[test]
fn rendered_pixels_are_not_biased_either() {
    let folder = tempfile::tempdir().expect("a folder");
    let more = ["--seeds", "12", "--samples", "4,64", "--set", "imager.resolution=[12, 8]"];
    let report = report(folder.path(), "d65-xyz", &more);
    let mut strategies = 0;
    for one in series(&report, "scene", "sobol") {
        strategies += 1;
        let slope = number(&one["slope"]["value"]);
        assert!((-1.2..-0.4).contains(&slope), "{}: {slope}", one["strategy"]);
        for point in one["points"].as_array().expect("a list") {
            for bias in point["bias"].as_array().expect("a list") {
                assert!(number(&bias["standard_errors"]).abs() < 4.0, "{}: {bias}", one["strategy"]);
            }
        }
    }
    assert!(strategies >= 5, "{strategies}");
}

#[test]
fn wrong_requests_are_named() {
    let scene = scene("d65-xyz");
    let cases = [
        (["--strategies", "unifrom"], "did you mean `uniform`"),
        (["--strategies", "uniform{"], "not closed"),
        (["--strategies", "stratified{strata: 0}"], "strata"),
        (["--strategies", "lines"], "continuum"),
        (["--samples", "0"], "0"),
        (["--seeds", "1"], "1"),
    ];
    let folder = tempfile::tempdir().expect("a folder");
    for (more, word) in cases {
        let output = run(&[&["bench", &scene, "-o", shown(folder.path())][..], &more].concat());
        assert_eq!(output.status.code(), Some(2), "{more:?}");
        assert!(text_of(&output.stderr).contains(word), "{more:?}: {}", text_of(&output.stderr));
    }
}

/// Measures the noise of one scene in two directions, as a table and as JSON.
#[test]
fn noise_is_measured_between_seeds() {
    let arguments = ["bench", "noise", "gray-card", "--set", "imager.resolution=[48, 32]", "--seconds", "1"];
    let arguments = [&arguments[..], &["--threads", "2", "--directions", "auto,forward"]].concat();
    let rows: Value = serde_json::from_str(&good(&[&arguments[..], &["--json"]].concat())).expect("JSON");
    let rows = rows.as_array().expect("a list");
    assert_eq!(rows.len(), 2);
    for (row, estimator) in rows.iter().zip(["backward", "forward"]) {
        assert_eq!(row["estimators"], serde_json::json!([estimator]));
        let [noise, then, clean] = ["noise", "noise_then", "clean_s"].map(|key| number(&row[key][0]));
        assert!(noise > 0.0 && noise <= number(&row["noise"][1]) && then > 0.0, "{row}");
        // The time to 1 % noise grows with the square of the noise.
        let want = number(&row["seconds"]) * (noise / 0.01) * (noise / 0.01);
        assert!((clean / want - 1.0).abs() < 1e-9, "{row}");
    }
}

/// Writes a scene of a pinhole camera on Ortho Plus with the given source, and returns its path.
fn pinhole(folder: &Path, source: &str) -> String {
    let write = |name: &str, text: &str| {
        let path = folder.join(name);
        std::fs::write(&path, text).expect("written");
        shown(&path).to_owned()
    };
    write(
        "pinhole.yaml",
        "name: Pinhole\nsurfaces:\n  - {kind: plane, stop: true, semi-diameter: 0.3, thickness: 50}\n",
    );
    write(
        "obscura.yaml",
        &format!(
            "spectra: 1\nsource: {source}\nlens: {{file: pinhole.yaml}}\n\
             imager: {{kind: film, width: 36 mm, height: 24 mm, resolution: [12, 8]}}\n\
             film: {{stock: ilford-ortho-plus, exposure: 1 s}}\nrender: {{samples: 64, seed: 1}}\n"
        ),
    )
}

const EDGE: &str =
    "{kind: chart, chart: slanted-edge, distance: 1 m, width: 1.2 m, illuminant: D65, luminance: 3000 cd/m2}";
const EVERY: &str = "one-term-of-every-factor";

/// Through a pinhole no part of the optics needs a wavelength. One term of every factor then has the same mean as drawn wavelengths,
/// within 3 standard errors, and the scatter that its terms predict.
#[test]
fn one_term_of_every_factor_through_a_pinhole() {
    let folder = tempfile::tempdir().expect("a folder");
    let scene = pinhole(folder.path(), EDGE);
    let both = format!("source-times-response,{EVERY}");
    let arguments = ["bench", &scene, "--json", "--threads", "2", "-o", shown(folder.path()), "--strategies", &both];
    let output = run(&[&arguments[..], &["--seeds", "12", "--samples", "16,64"]].concat());
    let told = text_of(&output.stderr);
    assert!(output.status.success(), "{told}");
    let report: Value = serde_json::from_str(&text_of(&output.stdout)).expect("JSON");
    let deviation: f64 = told
        .split("a sample scatters by ")
        .nth(1)
        .and_then(|rest| rest.split(' ').next())
        .and_then(|number| number.parse().ok())
        .unwrap_or_else(|| panic!("no scatter of a sample in: {told}"));
    let of_terms = |measure, numbers| {
        let mut all = series(&report, measure, numbers).filter(|s| s["strategy"] == EVERY);
        all.next().unwrap_or_else(|| panic!("no row: {report}")).clone()
    };
    let integral = of_terms("integral", "random");
    for point in integral["points"].as_array().expect("points") {
        let expected = deviation / number(&point["samples"]).sqrt();
        let error = number(&point["error"]["value"]);
        println!("{}: {error:.4}, computed {expected:.4}", point["samples"]);
        assert!((error / expected - 1.0).abs() < 0.1, "{error} {expected}");
    }
    for one in [integral, of_terms("scene", "sobol")] {
        for point in one["points"].as_array().expect("points") {
            for bias in point["bias"].as_array().expect("a list") {
                let off = number(&bias["standard_errors"]);
                println!("bias {off:.2} standard errors");
                assert!(off.abs() < 3.0, "{one}");
            }
        }
    }
}

/// Nothing is random with one Gaussian per factor: every sample equals the integral, up to rounding.
#[test]
fn one_gaussian_each_is_exact() {
    let folder = tempfile::tempdir().expect("a folder");
    let scene = pinhole(folder.path(), EDGE);
    let every = format!("{EVERY}{{terms: 1}}");
    let arguments = ["bench", &scene, "--json", "--threads", "2", "--integral-only", "-o", shown(folder.path())];
    let more = ["--seeds", "50", "--samples", "1,16", "--set", "source.illuminant=gaussian:545,40"];
    let which = ["--response", "gaussian:540,45", "--strategies", &every];
    let report: Value = serde_json::from_str(&good(&[&arguments[..], &more, &which].concat())).expect("JSON");
    let mut points = 0;
    for one in series(&report, "integral", "sobol").chain(series(&report, "integral", "random")) {
        for point in one["points"].as_array().expect("points") {
            assert!(number(&point["error"]["value"]) < 1e-12, "{one}");
            points += 1;
        }
    }
    assert_eq!(points, 4);
}

/// In other scenes the strategy is refused, and the message names what needs a wavelength.
#[test]
fn one_term_of_every_factor_says_what_needs_a_wavelength() {
    let folder = tempfile::tempdir().expect("a folder");
    let strategies = format!("source-times-response,{EVERY}{{terms: 1}}");
    let tiny = ["--seeds", "2", "--samples", "1", "--set", "imager.resolution=[3, 2]", "--strategies", &strategies];
    let reason = |report: &Value| report["left_out"][0]["reason"].as_str().unwrap_or("none").to_owned();
    let glass = reason(&report(folder.path(), "d65-ortho", &tiny));
    assert!(glass.contains("surface 1 ") && glass.contains("refracts at"), "{glass}");
    let channels = reason(&report(folder.path(), "d65-xyz", &tiny));
    assert!(channels.contains("records 3"), "{channels}");
    let lines = reason(&report(folder.path(), "mercury-ortho", &tiny));
    assert!(lines.contains("spectral lines"), "{lines}");
    let patches = "{kind: chart, chart: patches, reflectances: colorchecker, distance: 1 m, width: 1.2 m, illuminant: D65, luminance: 3000 cd/m2}";
    let scene = pinhole(folder.path(), patches);
    let arguments = ["bench", &scene, "--json", "--threads", "2", "-o", shown(folder.path())];
    let output = good(&[&arguments[..], &tiny[..4], &tiny[6..]].concat());
    let colors = reason(&serde_json::from_str(&output).expect("JSON"));
    assert!(colors.contains("colors of the source"), "{colors}");
    let wrong =
        run(&["bench", &scene, "--strategies", "one-term-of-every-factor{term: 3}", "-o", shown(folder.path())]);
    assert!(wrong.status.code() == Some(2) && text_of(&wrong.stderr).contains("its only key is `terms`"));
}
