//! Tests of user-written stock files: allowed contents, and messages about faults.

use spectra_film::curve::CharacteristicCurve;
use spectra_film::stock::Stock;
use spectra_scene::FileResources;
use std::fs;

const SOUND: &str = "
name: Mine
source: my densitometer
license: CC0-1.0
iso: 100
reference-illuminant: iso-7589-sensitometric-daylight
layers:
  - name: pan
    sensitivity: {file: tables/pan.csv, reading: linear, measured-under: equal-energy}
    curves:
      - development: D-76, 8 min
        points: [[-3, 0.25], [-2.1, 0.35], [-1, 1.0], [0, 1.7], [1, 2.0]]
      - development: push
        points: [[-3, 0.3], [-2.3, 0.5], [0, 2.4]]
";

fn load(yaml: &str, csv: &str) -> Result<Stock, String> {
    let folder = tempfile::tempdir().expect("a folder");
    fs::create_dir_all(folder.path().join("film/tables")).expect("a folder");
    fs::write(folder.path().join("film/mine.yaml"), yaml).expect("written");
    fs::write(folder.path().join("film/tables/pan.csv"), csv).expect("written");
    // The scene is above the stock's folder: the table is found next to the stock.
    Stock::load("film/mine.yaml", &FileResources::beside(folder.path())).map_err(|faults| {
        let prefix = format!("{}/", folder.path().display());
        faults.to_string().replace(&prefix, "")
    })
}

const TABLE: &str = "wavelength_nm,sensitivity\n400,1\n500,0.8\n650,0.9\n680,0\n";

#[test]
fn a_stock_of_ones_own_is_read_with_the_table_beside_it() {
    let stock = load(SOUND, TABLE).expect("sound");
    let layer = &stock.layers[0];
    assert_eq!(layer.sensitivity.range_nm(), (400.0, 680.0));
    assert_eq!(layer.sensitivity.at(450.0), 0.9);
    let CharacteristicCurve::Tabulated(_) = &layer.development("push").expect("there").curve else { panic!("printed") };
    // 0.1 above the 0.25 of the unexposed film is a printed point.
    assert!((layer.developments[0].curve.speed_point().expect("there") + 2.1).abs() < 1e-9);
    assert!(stock.reciprocity.is_none() && stock.bases.is_empty() && stock.maker.is_none());
}

#[test]
fn an_inline_table_is_read_too() {
    let yaml = SOUND.replace("file: tables/pan.csv, reading: linear", "table: [[400, 0.5], [500, 1]], reading: log10");
    let stock = load(&yaml, "").expect("sound");
    assert!((stock.layers[0].sensitivity.at(500.0) - 10.0).abs() < 1e-12);
}

#[test]
fn all_faults_are_told_at_once_with_their_places() {
    let yaml = SOUND
        .replace("measured-under: equal-energy", "measured-under: D66")
        .replace("reference-illuminant: iso", "reference-illuminant: is0")
        .replace("[-1, 1.0]", "[-2.5, 1.0]")
        .replace("development: push", "development: D-76, 8 min");
    let text = load(&yaml, TABLE).unwrap_err();
    for (line, word) in [(6, "is0-7589"), (9, "D66"), (12, "exposures must increase"), (13, "development of its own")] {
        let found = text.lines().any(|l| l.starts_with(&format!("film/mine.yaml:{line}:")) && l.contains(word));
        assert!(found, "line {line}, {word}, in\n{text}");
    }
}

#[test]
fn each_fault_names_its_key() {
    let broken = [
        ("iso: 100", "iso: -100", "-100"),
        ("iso: 100", "iso: 100\nisso: 3", "isso"),
        ("name: Mine", "nam: Mine", "nam"),
        ("reading: linear", "reading: linear, floor: 0", "floor"),
        ("reading: linear", "reading: linear, column: red", "red"),
        ("file: tables/pan.csv", "file: tables/pin.csv", "pin.csv"),
        ("file: tables/pan.csv, ", "", "no values"),
        ("points: [[-3, 0.3], [-2.3, 0.5], [0, 2.4]]", "assumed: true", "remark"),
        ("points: [[-3, 0.3], [-2.3, 0.5], [0, 2.4]]", "toe: 0.2", "average-gradient"),
        ("[0, 2.4]]", "[0, 2.4]]\n        toe: 1", "no other shape"),
        ("iso: 100", "iso: 100\nreciprocity: {exponent: 0.5, above: 1 s}", "from 1 to 10"),
        ("iso: 100", "iso: 100\nbases: [{formats: sheet, thickness: 0.1 s}]", "positive length"),
    ];
    for (from, to, word) in broken {
        let yaml = SOUND.replacen(from, to, 1);
        assert_ne!(yaml, SOUND);
        let text = load(&yaml, TABLE).unwrap_err();
        assert!(text.contains(word) && text.contains("film/mine.yaml:"), "{to}: {text}");
    }
}

#[test]
fn faulty_tables_are_told_with_line_and_column() {
    let text = load(SOUND, "wavelength_nm,sensitivity\n400,1\n500,x\n").unwrap_err();
    assert!(text.contains("tables/pan.csv:3:5: `x` is not a number"), "{text}");
    let text = load(SOUND, "wavelength_nm,sensitivity\n700,1\n1000,1\n").map(|_| ()).err();
    assert_eq!(text, None, "seen at the very red end of the reference light");
    let text = load(SOUND, "wavelength_nm,sensitivity\n900,1\n1000,1\n").unwrap_err();
    assert!(text.contains("not sensitive to the reference"), "{text}");
}

/// An assumed curve needs a remark, and cannot be built from impossible numbers.
#[test]
fn assumed_curves_are_checked() {
    let assumed = |numbers: &str| {
        let curve = format!("assumed: true\n        remark: none is printed\n        {numbers}");
        load(&SOUND.replace("points: [[-3, 0.3], [-2.3, 0.5], [0, 2.4]]", &curve), TABLE)
    };
    let stock = assumed("average-gradient: 0.6\n        toe: 0.2\n        shoulder: 4\n        maximum-density: 2.2");
    let stock = stock.expect("sound");
    let push = stock.layers[0].development("push").expect("there");
    assert!(push.assumed);
    assert!((push.curve.average_gradient(1.5).expect("there") - 0.6).abs() < 1e-12);
    for (numbers, key) in [
        ("average-gradient: 0.6\n        toe: 3\n        shoulder: 4\n        maximum-density: 2.2", "up to 2"),
        ("average-gradient: 0.6\n        toe: 0.2\n        shoulder: 0\n        maximum-density: 2.2", "from 1 to 64"),
        ("average-gradient: -1\n        toe: 0.2\n        shoulder: 4\n        maximum-density: 2.2", "second point"),
        (
            "average-gradient: 0.6\n        toe: 0.2\n        shoulder: 4\n        maximum-density: 0.9",
            "maximum density",
        ),
    ] {
        let text = assumed(numbers).unwrap_err();
        assert!(text.contains(key), "{numbers}: {text}");
    }
}

/// Faults of color stocks: dyes, densities and curves that do not match each other, each with its place.
#[test]
fn layers_that_do_not_fit_are_told() {
    let layer = |name: &str, dye: &str, curves: &str| {
        format!(
            "  - name: {name}\n    sensitivity: {{table: [[400, 1], [650, 1]], reading: linear, measured-under: equal-energy}}\n{dye}    curves:\n{curves}"
        )
    };
    let dye = "    dye: {name: cyan, table: [[400, 0.1], [650, 1.0]]}\n";
    let curve = "      - {development: normal, points: [[-3, 0.1], [-1, 1.8]]}\n";
    let head = "spectra: 1\nname: Mine\nsource: me\nlicense: CC0-1.0\niso: 100\nreference-illuminant: D55\n";
    let cases = [
        (format!("{head}layers:\n{}{}", layer("red", dye, curve), layer("green", "", curve)), "some have none"),
        (format!("{head}layers:\n{}{}", layer("red", "", curve), layer("green", "", curve)), "a `dye` in each"),
        (format!("{head}density: status-m\nlayers:\n{}", layer("red", dye, curve)), "three layers, not 1"),
        (format!("{head}layers:\n{}", layer("red", "", "      - {development: normal}\n")), "average-gradient"),
        (
            format!("{head}layers:\n{}", layer("red", "    mtf: [[20, 0.9], [10, 0.5]]\n", curve)),
            "not a point of an MTF",
        ),
        (
            format!("{head}minimum-density: {{table: [[400, 0.2]]}}\nlayers:\n{}", layer("red", "", curve)),
            "base and fog",
        ),
        (
            format!("{head}halation: {{scattered: 2, backing: 0.1}}\nlayers:\n{}", layer("red", "", curve)),
            "from 0 to 1",
        ),
        (format!("{head}assumed: {{mtf: \" \"}}\nlayers:\n{}", layer("red", "", curve)), "needs a reason"),
        (format!("{head}reciprocity: {{above: 1 s}}\nlayers:\n{}", layer("red", "", curve)), "`exponent` or a `table`"),
        (
            format!("{head}layers:\n{}", layer("red", "", curve))
                .replace("[[400, 1], [650, 1]]", "[[900, 1], [950, 1]]"),
            "900 to 950 nm",
        ),
        (format!("{head}layers:\n{}", layer("red", "", curve)).replace("iso: 100\n", ""), "needs a speed"),
    ];
    for (yaml, word) in cases {
        let text = load(&yaml, "").expect_err(word);
        assert!(text.contains(word) && text.contains("mine.yaml:"), "{word}: {text}");
    }
}
