//! Bundled illuminants and ColorChecker patches against values computed by another program.
//!
//! `tests/data/*.csv` are written by `xtask/import_colour_science.py` with colour-science 0.4.7.

use spectra_color::{cct, chromaticity, lab, xyz_of_light, xyz_of_reflectance};
use spectra_spectrum::{BAND, Observer, find_reflectance, illuminant, illuminant_names};

fn rows(text: &'static str) -> impl Iterator<Item = Vec<&'static str>> {
    text.lines().skip(1).map(|l| l.split(',').collect())
}

fn number(field: &str) -> f64 {
    field.parse().expect("a number")
}

/// Chromaticities of all 59 illuminants, aligned to 360-830 nm by 1 nm, linear, with constant ends, as in colour-science.
#[test]
fn all_illuminants_have_their_chromaticity() {
    let mut count = 0;
    let mut worst = 0.0_f64;
    for row in rows(include_str!("../data/illuminants.csv")) {
        let light = illuminant(row[0]).expect("bundled");
        let [x, y] = chromaticity(Observer::cie_1931_2deg().xyz(&light)).expect("light");
        let off = (x - number(row[1])).abs().max((y - number(row[2])).abs());
        assert!(off < 5e-5, "{}: {x} {y}, wanted {} {}", row[0], row[1], row[2]);
        worst = worst.max(off);
        count += 1;
    }
    assert_eq!((count, illuminant_names().count()), (59, 59));
    println!("largest difference in x or y: {worst:e}");
}

/// Correlated color temperatures by Y. Ohno (Leukos 10, 47, 2014). The published method is good to 1 K within 0.01 of the locus
/// from 1000 to 20 000 K; ours searches the locus itself.
#[test]
fn color_temperatures_agree_with_ohno() {
    let mut count = 0;
    for row in rows(include_str!("../data/illuminants.csv")).filter(|r| !r[3].is_empty()) {
        let got = cct([number(row[1]), number(row[2])]).expect("near the locus");
        let (kelvin, duv) = (number(row[3]), number(row[4]));
        let allowed = if duv.abs() < 0.01 { 1.0 } else { 3.0 };
        assert!((got.kelvin - kelvin).abs() < allowed, "{}: {} K, wanted {kelvin}", row[0], got.kelvin);
        assert!((got.duv - duv).abs() < 2e-5, "{}: {} , wanted {duv}", row[0], got.duv);
        count += 1;
    }
    assert!(count > 50, "{count}");
}

/// CIE 15:2004, tables T.3 and T.8: tristimulus values at Y = 100, and chromaticities.
#[test]
fn published_white_points() {
    for (name, xyz) in
        [("D65", [95.047, 100.0, 108.883]), ("D50", [96.42, 100.0, 82.51]), ("A", [109.85, 100.0, 35.59])]
    {
        let got = xyz_of_light(&illuminant(name).expect("bundled"), Observer::cie_1931_2deg()).expect("light");
        assert!(got.iter().zip(xyz).all(|(a, b)| (a - b).abs() < 0.02), "{name}: {got:?}");
    }
    for (name, x, y) in [("E", 1.0 / 3.0, 1.0 / 3.0), ("FL2", 0.3721, 0.3751), ("FL11", 0.3805, 0.3769)] {
        let light = illuminant(name).expect("bundled");
        let [gx, gy] = chromaticity(Observer::cie_1931_2deg().xyz(&light)).expect("light");
        assert!((gx - x).abs() < 3e-4 && (gy - y).abs() < 3e-4, "{name}: {gx} {gy}");
    }
}

fn patch_color(patch: &str) -> ([f64; 3], [f64; 3]) {
    let d50 = illuminant("D50").expect("bundled");
    let observer = Observer::cie_1931_2deg();
    let white = xyz_of_light(&d50, observer).expect("light");
    let surface = find_reflectance(&format!("colorchecker#{patch}")).expect("bundled");
    let xyz = xyz_of_reflectance(&surface, &d50, observer).expect("light");
    (xyz, lab(xyz, white))
}

/// ISO 17321-1 spectra under D50, computed independently: XYZ within 0.02, Lab within 0.1.
#[test]
fn colorchecker_under_d50() {
    for (patch, xyz, want) in [
        ("dark skin", [11.69, 9.99, 4.58], [37.8, 15.5, 16.5]),
        ("light skin", [40.35, 36.28, 19.88], [66.7, 17.4, 18.2]),
        ("blue sky", [17.14, 18.71, 26.03], [50.4, -4.9, -21.8]),
        ("blue", [7.33, 5.91, 22.64], [29.2, 17.0, -52.1]),
        ("green", [14.76, 23.23, 7.47], [55.3, -39.9, 33.2]),
        ("red", [22.64, 12.86, 3.93], [42.6, 56.1, 28.5]),
        ("yellow", [60.37, 60.97, 7.68], [82.4, 3.7, 79.0]),
        ("white", [85.46, 88.73, 72.48], [95.5, -0.2, 0.7]),
        ("neutral 5", [19.58, 20.31, 16.79], [52.2, 0.0, -0.1]),
        ("black", [3.22, 3.35, 2.89], [21.4, -0.2, -1.0]),
    ] {
        let (got, got_lab) = patch_color(patch);
        assert!(got.iter().zip(xyz).all(|(a, b)| (a - b).abs() < 0.02), "{patch}: {got:?}");
        assert!(got_lab.iter().zip(want).all(|(a, b)| (a - b).abs() < 0.1), "{patch}: {got_lab:?}");
    }
}

/// All 24 patches compared with the other program; they differ because of the band below 360 nm.
#[test]
fn all_patches_agree_with_another_program() {
    let mut count = 0;
    for row in rows(include_str!("../data/checker-d50.csv")) {
        let (xyz, lab) = patch_color(row[0]);
        for (i, got) in xyz.into_iter().chain(lab).enumerate() {
            assert!((got - number(row[i + 1])).abs() < 1e-3, "{}: {got}, wanted {}", row[0], row[i + 1]);
        }
        count += 1;
    }
    assert_eq!(count, 24);
}

/// Every daylight illuminant is tabulated down to the 350 nm edge of the band, because film is sensitive there.
#[test]
fn daylight_reaches_the_ultraviolet_edge() {
    for name in ["D50", "D55", "D60", "D65", "D75"] {
        let light = illuminant(name).expect("bundled").on_grid(&BAND);
        assert!(light[0] > 15.0 && light[0] < light[30], "{name}: {}", light[0]);
    }
}

/// ISO 7589:2002 defines its film illuminants from 350 to 690 nm and nowhere else (the printer's from a shorter range).
#[test]
fn film_illuminants_are_defined_from_350_to_690_nm() {
    let files = spectra_spectrum::bundled_spectra().filter(|(name, _)| name.starts_with("iso-7589-"));
    let mut count = 0;
    for (name, path) in files {
        let bytes = spectra_data::get(path).expect("bundled");
        let table = spectra_spectrum::table::Table::parse_bytes(path, bytes, None).expect("sound");
        let (from, to) = (table.wavelengths_nm[0], table.wavelengths_nm[table.wavelengths_nm.len() - 1]);
        assert!(from >= 350.0 && to <= 690.0, "{name}: {from} to {to}");
        if !name.ends_with("printer") {
            assert_eq!((from, to), (350.0, 690.0), "{name}");
        }
        count += 1;
    }
    assert_eq!(count, 7);
}
