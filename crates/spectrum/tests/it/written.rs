//! Spectra as people write them: in YAML, and in one line.

use spectra_core::params::Fault;
use spectra_scene::FileResources;
use spectra_spectrum::{
    AnySpectrum, BAND, Emission, Kind, SpectrumError, find, find_emission_in, find_in, find_reflectance_in,
    find_sensitivity_in, find_transmittance_in, planck_radiance,
};
use std::path::Path;

/// A folder with one file `a.yaml`.
fn folder(text: &str) -> (tempfile::TempDir, FileResources) {
    let folder = tempfile::tempdir().expect("a folder");
    std::fs::write(folder.path().join("a.yaml"), text).expect("written");
    let files = FileResources::beside(folder.path());
    (folder, files)
}

fn light(text: &str) -> Emission {
    let (_folder, files) = folder(text);
    find_emission_in("a.yaml", &files).unwrap_or_else(|e| panic!("{text}: {e}"))
}

fn refused(text: &str) -> String {
    let (_folder, files) = folder(text);
    let error = find_emission_in("a.yaml", &files).expect_err(text);
    error.to_string()
}

fn near(got: f64, want: f64) {
    assert!((got - want).abs() <= 1e-12 * want.abs().max(1.0), "{got} {want}");
}

#[test]
fn every_kind_has_the_value_of_its_formula() {
    let gauss = |x: f64, c: f64, s: f64| libm_exp(-0.5 * ((x - c) / s) * ((x - c) / s));
    near(light("{kind: constant, value: 0.3}").at(700.0), 0.3);
    near(light("{kind: constant}").at(700.0), 1.0);
    let box_of = light("{kind: rectangle, from: 500 nm, to: 0.6 um, value: 2}");
    assert_eq!([box_of.at(499.9), box_of.at(550.0), box_of.at(600.1)], [0.0, 2.0, 0.0]);
    near(light("{kind: gaussian, center: 540, sigma: 30 nm, peak: 4}").at(520.0), 4.0 * gauss(520.0, 540.0, 30.0));
    near(light("{kind: blackbody, temperature: 2856 K}").at(560.0), planck_radiance(560.0, 2856.0));
    near(light("{kind: table, wavelengths: [400, 500], values: [1, 3]}").at(425.0), 1.5);
    near(light("{kind: table, wavelengths: [400, 500], values: [0, 2], scale: log10, outside: zero}").at(450.0), 10.0);
    // 50 counts between 400 and 410 nm are 5 per nanometer.
    let bins = light("{kind: histogram, edges: [400, 410, 430], counts: [50, 8]}");
    assert_eq!([bins.at(405.0), bins.at(420.0), bins.at(399.0), bins.at(431.0)], [5.0, 0.4, 0.0, 0.0]);
    let terms = "terms: [{amplitude: 1, center: 560, sigma: 300}, {amplitude: -0.6, center: 520, sigma: 25}]";
    near(
        light(&format!("{{kind: mixture, {terms}}}")).at(510.0),
        gauss(510.0, 560.0, 300.0) - 0.6 * gauss(510.0, 520.0, 25.0),
    );
    let lines = light("{kind: lines, lines: [{wavelength: \"C'\"}, {wavelength: 546.074 nm, power: 3}]}");
    assert_eq!(
        lines.lines().iter().map(|l| (l.wavelength_nm, l.power)).collect::<Vec<_>>(),
        [(643.85, 1.0), (546.074, 3.0)]
    );
    assert_eq!(light("{kind: line, wavelength: e, power: 2}").lines()[0].power, 2.0);
    let daylight = light("{kind: daylight, temperature: 6504}");
    assert!((daylight.at(450.0) / daylight.at(560.0) - 1.17).abs() < 0.02);
}

/// Loads a file as each kind through the same module.
fn libm_exp(x: f64) -> f64 {
    spectra_core::math::exp(x)
}

#[test]
fn spectra_are_made_of_others() {
    let both = light(
        "kind: sum\nparts:\n  - {kind: scale, factor: 2, spectrum: 'gaussian:550,20'}\n  - {kind: line, wavelength: 600}\n",
    );
    near(both.at(550.0), 2.0);
    assert_eq!(both.lines().len(), 1);
    // A filter after a lamp: the mean of a table with a hole.
    let filtered = light("kind: product\nfactors: [A, {kind: rectangle, from: 500, to: 600}, 'constant:0.5']\n");
    let (_folder, files) = folder("");
    let a = find_emission_in("A", &files).expect("bundled");
    near(filtered.at(550.0), 0.5 * a.at(550.0));
    assert_eq!(filtered.at(610.0), 0.0);
    near(light("{kind: scale, spectrum: D65, luminance: 300 cd/m2}").luminance() / 300.0, 1.0);
    near(light("{kind: scale, spectrum: D65, power: 5 mW}").power(&BAND) / 0.005, 1.0);
    near(light("{kind: scale, spectrum: 'gaussian:550.5,20', peak: 7}").at(550.5), 7.0);
    // A shape that is not stated to be light is of the kind that is wanted.
    let (_folder, files) = folder("{kind: gaussian, center: 550, sigma: 20}");
    assert!(find_transmittance_in("a.yaml", &files).is_ok() && find_sensitivity_in("a.yaml", &files).is_ok());
    // Unless the file says so.
    let (_folder, files) = folder("{kind: gaussian, center: 550, sigma: 20, of: reflectance}");
    assert!(matches!(find_in("a.yaml", &files), Ok(AnySpectrum::Reflectance(_))));
    assert!(matches!(find_transmittance_in("a.yaml", &files), Err(SpectrumError::WrongKind { .. })));
    let dim = find_reflectance_in("0.5 * a.yaml", &files).expect("a surface");
    near(dim.at(550.0), 0.5);
}

#[test]
fn sums_and_products_fit_in_a_line() {
    let (_folder, files) = folder("{kind: constant, value: 0.25}");
    let emission = |name: &str| find_emission_in(name, &files).unwrap_or_else(|e| panic!("{name}: {e}"));
    let d65 = emission("D65");
    let sum = emission("0.5 * D65 + line:C' + 2 * lines:404.66=1,e=3 * 0.5");
    near(sum.at(500.0), 0.5 * d65.at(500.0));
    assert_eq!(sum.lines().iter().map(|l| l.power).collect::<Vec<_>>(), [1.0, 1.0, 3.0]);
    near(emission("D65 * a.yaml").at(500.0), 0.25 * d65.at(500.0));
    near(emission("gaussian:500,20 * D65").at(500.0), d65.at(500.0));
    near(emission("colorchecker#red * D65").at(600.0), emission("D65 * colorchecker#red").at(600.0));
    near(find_transmittance_in("constant:0.5 * constant:0.5", &files).expect("a filter").at(500.0), 0.25);
    for (name, want) in [
        ("D65 * A", "emission and emission have no product"),
        ("D65 + constant:0.5 * colorchecker#red", "emission and reflectance have no sum"),
        ("-1 * D65", "emission cannot be negative"),
        ("D65 * no-such", "no-such"),
        ("D65 + ", "ends where a spectrum is expected"),
        ("gaussian:550", "gaussian:550,20"),
        ("lines:404.66=x", "lines:404.66=1"),
        ("lines:404.66=-1", "0 or more"),
    ] {
        let error = find_emission_in(name, &files).expect_err(name).to_string();
        assert!(error.contains(want), "{name}: {error}");
    }
    let error =
        find_transmittance_in("constant:0.9 + constant:0.9", &files).expect_err("a filter passes no more than all");
    assert!(error.to_string().contains("between 0 and 1"), "{error}");
}

#[test]
fn faults_name_file_line_and_column() {
    for (text, want) in [
        ("", "a.yaml"),
        ("spectra: 1\n", "a.yaml:1:1: which spectrum? `kind` is missing"),
        ("kind: gausian\ncenter: 5\n", "a.yaml:1:7: unknown spectrum `gausian` (did you mean `gaussian`?"),
        ("kind: gaussian\ncenter: 550\nsigma: 0\n", "a.yaml:3:8: found 0"),
        ("kind: gaussian\ncenter: 550\nsigma: 20\nwidth: 3\n", "a.yaml:4:1: unknown key `width`"),
        (
            "kind: table\nwavelengths: [400, 390]\nvalues: [1, 1]\n",
            "a.yaml:2:20: 390 nm does not come after 400 nm (wavelengths must increase)",
        ),
        ("kind: table\nwavelengths: [400, 410]\nvalues: [1, -2]\n", "a.yaml:3:13: emission cannot be negative: -2"),
        (
            "of: sensitivity\nkind: table\nwavelengths: [400, 410]\nvalues: [1, 80]\n",
            "a.yaml:4:13: 80 is more than a sensitivity can be: given as percent? divide by 100",
        ),
        ("kind: table\nwavelengths: [400, 410]\nvalues: [1, .nan]\n", "a.yaml:3:13: "),
        ("kind: table\nwavelengths: [400, 410]\nvalues: [1]\n", "a.yaml:3:9: 1 values, but"),
        ("kind: table\nwavelengths: []\nvalues: []\n", "a.yaml:2:14: found a list of 0"),
        ("kind: histogram\nedges: [400, 410]\ncounts: [-1]\n", "a.yaml:3:10: a count cannot be negative: -1"),
        ("kind: mixture\nterms: []\n", "a.yaml:2:8: found a list of 0"),
        (
            "kind: mixture\nterms: [{amplitude: -1, center: 550, sigma: 20}]\n",
            "a.yaml:2:8: largest value of the sum of Gaussians must be positive",
        ),
        ("kind: lines\nlines: [{wavelength: 500, power: -1}]\n", "a.yaml:2:34: "),
        ("kind: line\nwavelength: Q\n", "a.yaml:2:13: "),
        ("kind: product\nfactors: [D65, A]\n", "a.yaml:2:16: emission and emission have no product"),
        ("kind: product\nfactors: [D65, nothing-of-that-name]\n", "a.yaml:2:16: no spectrum is called"),
        ("kind: scale\nspectrum: D65\n", "a.yaml:1:1: a scale takes one of"),
        ("kind: constant\nof: light\n", "a.yaml:2:5: unknown value `light` for `of`"),
        (
            "kind: blackbody\nof: reflectance\ntemperature: 3000\n",
            "a.yaml:2:5: the spectrum in the file is of kind emission",
        ),
        ("spectra: 2\nkind: constant\n", "a.yaml:1:10: unknown value 2 for `spectra`"),
    ] {
        let got = refused(text);
        assert!(got.contains(want), "{text}: {got}");
    }
    // All faults are reported at once.
    let got = refused("kind: table\nwavelengths: [400, 390, 380]\nvalues: [-1, -2, 1]\n");
    assert_eq!(got.lines().count(), 4, "{got}");
}

/// A file that is made of itself, or of very many, ends at once.
#[test]
fn files_that_name_themselves_end() {
    for text in ["{kind: sum, parts: [a.yaml, a.yaml]}", "{kind: scale, factor: 1, spectrum: './a.yaml'}"] {
        assert!(refused(text).contains("refers to too many spectra, or to itself"));
    }
    let many = format!("kind: sum\nparts: [{}]\n", vec!["'constant:1'"; 1500].join(", "));
    assert!(refused(&many).contains("too many"));
}

/// A name without a folder is found only among the bundled names.
#[test]
fn yaml_needs_a_place_to_be_found() {
    assert!(spectra_spectrum::find("a.yaml").expect_err("nowhere").to_string().contains("beside a scene"));
    let files = FileResources::beside(Path::new("/nowhere"));
    let error = find_emission_in("a.yaml", &files).expect_err("nowhere").to_string();
    assert!(error.contains("a.yaml") && error.contains("no such file"), "{error}");
}

/// A wavelength in micrometers is reported, with what to write; widths, wide bells and infrared pass.
#[test]
fn micrometers_are_told() {
    let told = |name: &str| {
        let error = find(name).expect_err(name);
        error.faults(Fault::new).to_string()
    };
    for (name, hint) in [
        ("line:0.55", "0.55 um is 550 nm: write 550"),
        ("lines:404.66=1,0.5461=2", "0.5461 um is 546.1 nm: write 546.1"),
        ("gaussian:0.55,0.02", "0.55 um is 550 nm: write 550"),
        ("led:0.45,0.02", "0.45 um is 450 nm: write 450"),
        ("rectangle:0.5,0.6", "0.6 um is 600 nm: write 600"),
        ("D65 * gaussian:0.55,0.02", "0.55 um is 550 nm: write 550"),
    ] {
        let text = told(name);
        assert!(text.contains("too short for light") && text.contains(hint), "{name}: {text}");
    }
    let written = |yaml: &str| {
        let (_folder, files) = folder(yaml);
        find_in("a.yaml", &files).expect_err(yaml).faults(Fault::new).to_string()
    };
    for yaml in [
        "{kind: line, wavelength: 0.55}",
        "{kind: lines, lines: [{wavelength: 0.55}]}",
        "{kind: gaussian, center: 0.55, sigma: 0.02}",
        "{kind: led, peak: 0.55, width: 0.02}",
        "{kind: rectangle, from: 0.5, to: 0.55}",
        "{kind: table, wavelengths: [0.4, 0.55], values: [1, 1]}",
        "{kind: histogram, edges: [0.4, 0.55], counts: [1]}",
    ] {
        let (text, column) = (written(yaml), yaml.find("0.55").expect("there") + 1);
        let place = format!("a.yaml:1:{column}: a wavelength of 0.55 nm");
        assert!(text.contains("0.55 um is 550 nm: write 550") && text.contains(&place), "{yaml}: {text}");
    }
    for name in
        ["line:0.55 um", "line:10600", "gaussian:0,300", "gaussian:550,0.02", "gaussian:-20,40", "rectangle:1,600"]
    {
        assert!(find(name).is_ok(), "{name}");
    }
}

/// If no kind is requested, the names of columns decide; the place of use and a stated kind take precedence.
#[test]
fn the_header_says_what_a_table_is() {
    let folder = tempfile::tempdir().expect("a folder");
    let files = FileResources::beside(folder.path());
    let kind = |header: &str, name: &str| {
        let columns = header.matches(',').count();
        let row = |nm: &str| format!("{nm}{}\n", ",0.5".repeat(columns));
        std::fs::write(folder.path().join("mine.csv"), format!("{header}\n{}{}", row("400"), row("700")))
            .expect("written");
        find_in(name, &files).map(|found| found.kind()).expect(header)
    };
    for (header, want) in [
        ("wavelength_nm,transmittance", Kind::Transmittance),
        ("Wavelength (nm),Transmission", Kind::Transmittance),
        ("wavelength_nm,spectral reflectance", Kind::Reflectance),
        ("wavelength_nm,reflection", Kind::Reflectance),
        ("wavelength_nm,sensitivity", Kind::Sensitivity),
        ("wavelength_nm,relative response", Kind::Sensitivity),
        ("wavelength_nm,irradiance", Kind::Emission),
        ("wavelength_nm,power", Kind::Emission),
        ("wavelength_nm,red", Kind::Emission),
    ] {
        assert_eq!(kind(header, "mine.csv"), want, "{header}");
    }
    let both = "wavelength_nm,transmittance,reflectance";
    assert_eq!(kind(both, "mine.csv#transmittance"), Kind::Transmittance);
    assert_eq!(kind(both, "mine.csv#reflectance"), Kind::Reflectance);
    assert_eq!(kind("wavelength_nm,transmittance", "0.5 * mine.csv"), Kind::Transmittance);
    assert_eq!(kind("wavelength_nm,reflectance", "D65 * mine.csv"), Kind::Emission);
    // The statement at the place of use takes precedence.
    assert_eq!(kind("wavelength_nm,reflectance", "mine.csv"), Kind::Reflectance);
    assert!(find_transmittance_in("mine.csv", &files).is_ok());
    assert!(spectra_spectrum::find_as_in("mine.csv", Kind::Emission, &files).is_ok());
}
