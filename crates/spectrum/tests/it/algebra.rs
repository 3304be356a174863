//! Algebra of spectra, compared with numpy and scipy, and the messages for wrong expressions.

use spectra_core::params::Fault;
use spectra_scene::FileResources;
use spectra_spectrum::{
    AnySpectrum, Kind, SpectrumError, find_as_in, find_emission, find_emission_in, find_transmittance,
};
use std::path::Path;

fn nowhere() -> FileResources {
    FileResources::beside(Path::new(""))
}

fn at(found: &AnySpectrum, nm: f64) -> f64 {
    match found {
        AnySpectrum::Emission(light) => light.at(nm),
        AnySpectrum::Transmittance(filter) => filter.at(nm),
        AnySpectrum::Reflectance(surface) => surface.at(nm),
        AnySpectrum::Sensitivity(detector) => detector.at(nm),
    }
}

/// Evaluates 200 random trees; another program evaluated each from the tree and not from the text.
#[test]
fn expressions_have_the_values_of_an_independent_program() {
    const AT_NM: [f64; 5] = [400.0, 470.0, 550.0, 630.0, 700.0];
    let text = include_str!("../data/expressions.csv");
    let (mut count, mut worst) = (0, 0.0_f64);
    for line in text.lines().filter(|line| !line.starts_with('#')).skip(1) {
        let (numbers, expression) = line.split_once(",\"").expect("a row");
        let expression = expression.trim_end_matches('"');
        let mut cells = numbers.split(',');
        let kind = Kind::from_word(cells.next().expect("a kind")).expect("a kind");
        let numbers: Vec<f64> = cells.map(|cell| cell.parse().expect("a number")).collect();
        let found = find_as_in(expression, kind, &nowhere()).unwrap_or_else(|e| panic!("{expression}: {e}"));
        for (i, nm) in AT_NM.into_iter().enumerate() {
            let (want, size) = (numbers[i], numbers[i + AT_NM.len()]);
            let off = (at(&found, nm) - want).abs() / size.max(f64::MIN_POSITIVE);
            assert!(off <= 1e-12, "{expression} at {nm} nm: {}, not {want}", at(&found, nm));
            worst = worst.max(off);
        }
        count += 1;
    }
    println!("{count} expressions, worst {worst:e}");
    assert_eq!(count, 200);
}

/// Returns the fault of an expression as a light: its message and its hint.
fn refused(expression: &str) -> Fault {
    let error: SpectrumError = find_emission_in(expression, &nowhere()).expect_err(expression);
    error.faults(Fault::new).into_iter().next().expect("a fault")
}

/// Each case has the character (from 1) at which it is wrong, words of the message, and words of the hint.
#[test]
fn wrong_expressions_are_told_with_place_and_hint() {
    let cases: [(&str, usize, &str, &str); 40] = [
        ("(D65", 1, "never closed", "write a `)`"),
        ("2 * (D65 + A", 5, "never closed", "write a `)`"),
        ("D65)", 4, "closes nothing", "remove it"),
        ("(D65 + A))", 10, "closes nothing", "remove it"),
        ("()", 2, "missing before this `)`", "after each sign"),
        ("D65 + ", 6, "ends where", "after each sign"),
        ("D65 *", 6, "ends where", "after each sign"),
        ("* D65", 1, "missing before this `*`", "after each sign"),
        ("/ D65", 1, "missing before this `/`", "after each sign"),
        ("^2", 1, "missing before this `^`", "after each sign"),
        ("D65 * * A", 7, "missing before this `*`", "after each sign"),
        ("D65 + * A", 7, "missing before this `*`", "after each sign"),
        ("(D65 + )", 8, "missing before this `)`", "after each sign"),
        ("(D65) A", 7, "sign is missing", "one of"),
        ("((D65) A)", 8, "sign is missing", "one of"),
        ("wratten-12^", 12, "ends where", "after each sign"),
        ("0.5 * D66", 7, "no spectrum is called `D66`", "D65"),
        ("D65 + 2 * mercurry", 11, "no spectrum is called `mercurry`", "mercury"),
        ("1 - wratten-26 * D65", 5, "no spectrum is called `wratten-26`", "wratten-25"),
        ("D65 * A", 5, "emission and emission have no product", "D65 * wratten-15"),
        ("D65 + wratten-12", 5, "have no sum", "like plus like"),
        ("D65 - wratten-12", 5, "have no difference", "like plus like"),
        ("wratten-12 / D65", 12, "have no quotient", "light times filters"),
        ("mercury / A", 9, "quotient", "light times filters"),
        ("D65 / mercury", 5, "quotient", "light times filters"),
        ("D65^2", 4, "power", "light times filters"),
        ("2 ^ D65", 3, "power", "light times filters"),
        ("D65 * colorchecker", 7, "holds 24 spectra", "pick one"),
        ("D65 * colorchecker#pink", 7, "no column", "its columns"),
        ("D65 * gaussian:550", 7, "`gaussian:550` is not understood", "gaussian:550,20"),
        ("A + led:450", 5, "`led:450` is not understood", "led:450,20"),
        ("D65 * function:exp(x)", 7, "neither the variable nor a function", "the variable is `w`"),
        ("D65 * function:log(w)", 7, "base 10 or e", "`ln`"),
        ("D65 * function:(w", 16, "never closed", "write a `)`"),
        ("D65 - 2 * A", 0, "cannot be negative", "subtract less"),
        ("-1 * D65", 0, "cannot be negative", "subtract less"),
        ("1 - 1.2 * gaussian:550,20", 0, "cannot be negative", "subtract less"),
        ("D65 / (gaussian:550,20 - gaussian:550,20)", 0, "no finite value", "a divisor"),
        ("(gaussian:550,20 - 0.5)^0.5", 0, "no finite value", "a divisor"),
        ("2 * (0.3 + no-such-file.csv)", 12, "no spectrum is called `no-such-file.csv`", "beside the one"),
    ];
    for (expression, place, message, hint) in cases {
        let fault = refused(expression);
        let told = fault.hint.clone().unwrap_or_default();
        assert!(fault.message.contains(message), "{expression}: {}", fault.message);
        assert!(told.contains(hint), "{expression}: hint {told}");
        let placed = format!("at character {place} of `{}`", expression.trim_end());
        assert!(place == 0 || fault.message.contains(&placed), "{expression}: {}", fault.message);
    }
}

/// A notch, and what a mixture leaves over, are checked as a whole; lines that cancel are gone.
#[test]
fn signed_parts_are_judged_as_a_whole() {
    let notch = find_transmittance("1 - 0.9 * gaussian:550,10").expect("a filter");
    assert!((notch.at(550.0) - 0.1).abs() < 1e-15 && (notch.at(700.0) - 1.0).abs() < 1e-15);
    let complement = find_transmittance("1 - wratten-25").expect("a filter");
    let red = find_transmittance("wratten-25").expect("a filter");
    assert!((complement.at(640.0) + red.at(640.0) - 1.0).abs() < 1e-15);
    // A light over a light is the filter that turns the second into the first.
    let blue = find_transmittance("D65 / A / 10").expect("a filter");
    let (d65, a) = (find_emission("D65").expect("a light"), find_emission("A").expect("a light"));
    assert!((blue.at(500.0) * 10.0 * a.at(500.0) / d65.at(500.0) - 1.0).abs() < 1e-14);
    // Nothing but roundings is left.
    assert!(find_emission("D65 + 0.1 * A - D65 - 0.1 * A").expect("darkness").at(560.0).abs() < 1e-13);
    let lines = find_emission("FdC - line:F").expect("two lines are left");
    assert_eq!(lines.lines().iter().map(|l| l.wavelength_nm).collect::<Vec<_>>(), [587.56, 656.27]);
    assert_eq!(find_emission("F'eC'").expect("a set of lines").lines().len(), 3);
    assert!(find_emission("line:e - 2 * line:e").expect_err("negative").to_string().contains("negative"));
    // A density is a function; a filter twice as thick is its square.
    let density = find_transmittance("10^(-0.3 * gaussian:550,20)").expect("a filter");
    assert!((density.at(550.0) - 0.501_187_233_627_272_2).abs() < 1e-15);
    assert!((find_transmittance("wratten-25^2").expect("a filter").at(600.0) - red.at(600.0).powi(2)).abs() < 1e-15);
}

/// A formula keeps its power on the grid as a Gaussian does, however narrow.
#[test]
fn formulas_are_as_fine_as_they_are() {
    let grid = spectra_spectrum::BAND;
    let root = (2.0 * std::f64::consts::PI).sqrt();
    for sigma in [0.3, 1.5, 2.5, 20.0] {
        let light = find_emission(&format!("function:exp(-0.5*((w-550.3)/{sigma})^2)")).expect("a light");
        let power = light.power(&grid);
        assert!((power / (sigma * root) - 1.0).abs() < 1e-6, "{sigma}: {power}");
    }
    let step = find_emission("function:(step(w-500.25)*step(600.75-w))").expect("a light");
    assert!((step.power(&grid) - 100.5).abs() < 0.02, "{}", step.power(&grid));
}
