//! Lines of the bundled lamps, compared with the values that makers of glass and laboratories state.

use spectra_color::{chromaticity, dominant_wavelength};
use spectra_spectrum::{Observer, Strengths, balmer, bundled_meta, find_emission, named_line};

fn nearest(lamp: &str, wavelength_nm: f64) -> f64 {
    let light = find_emission(lamp).expect("bundled");
    let off = |w: f64| (w - wavelength_nm).abs();
    light.lines().iter().map(|l| l.wavelength_nm).min_by(|a, b| off(*a).total_cmp(&off(*b))).expect("lines")
}

/// The precise wavelengths in air of the named lines (ISO 7944, Schott TIE-29) against the tables, which come from
/// wavelengths in vacuum: a line left in vacuum would be 0.1 to 0.2 nm off.
#[test]
fn lamps_hold_the_named_lines() {
    for (lamp, symbol) in [
        ("mercury", "h"),
        ("mercury", "g"),
        ("mercury", "e"),
        ("cadmium", "F'"),
        ("cadmium", "C'"),
        ("helium", "d"),
        ("helium", "r"),
    ] {
        let want = named_line(symbol).expect("named").precise_nm;
        let got = nearest(lamp, want);
        assert!((got - want).abs() < 0.0015, "{lamp} {symbol}: {got} {want}");
    }
    // D stands for both lines of sodium; F and C for unresolved doublets whose center depends on the discharge.
    let d = find_emission("sodium").expect("bundled");
    let mean = 0.5 * (d.lines()[0].wavelength_nm + d.lines()[1].wavelength_nm);
    assert!((mean - named_line("D").expect("named").precise_nm).abs() < 0.001, "{mean}");
    assert!((nearest("he-ne", 632.8) - 632.8).abs() < 0.02);
}

#[test]
fn hydrogen_follows_rydberg() {
    for upper in 3..=9 {
        let want = balmer(upper).expect("above level 2");
        assert!((nearest("hydrogen", want) - want).abs() < 0.01, "{upper}: {want}");
    }
}

/// Sodium light is seen as its own wavelength, neon as orange-red, and no lamp is without light.
#[test]
fn lamps_have_the_color_that_one_sees() {
    let observer = Observer::cie_1931_2deg();
    for (lamp, low, high) in [("sodium", 589.0, 589.6), ("neon", 590.0, 620.0), ("he-ne", 632.7, 632.9)] {
        let xy = chromaticity(observer.xyz(&find_emission(lamp).expect("bundled"))).expect("light");
        let seen = dominant_wavelength(xy, [1.0 / 3.0, 1.0 / 3.0]).expect("colored");
        assert!((low..=high).contains(&seen.wavelength_nm), "{lamp}: {seen:?}");
    }
    for lamp in ["mercury", "hydrogen", "helium", "argon", "krypton", "xenon", "cadmium"] {
        assert!(find_emission(lamp).expect("bundled").luminance() > 0.0, "{lamp}");
    }
}

/// Mercury's strengths are those of a measured lamp. The test checks the power by groups of lines (violet, blue, green,
/// yellow), summed by hand from the 5 nm values of the lamp H38HT-100 over a straight base. It also checks the chromaticity of
/// these lines, computed separately. The observers' estimates have half as much green as blue, at (0.234, 0.225).
#[test]
fn mercury_shines_as_it_was_measured() {
    let lamp = find_emission("mercury").expect("bundled");
    let between = |low: f64, high: f64| -> f64 {
        lamp.lines().iter().filter(|l| (low..high).contains(&l.wavelength_nm)).map(|l| l.power).sum()
    };
    let green = between(540.0, 550.0);
    for (low, high, want) in [(400.0, 410.0, 0.390), (430.0, 440.0, 0.792), (570.0, 590.0, 0.894)] {
        assert!((between(low, high) / green - want).abs() < 0.001, "{low}: {}", between(low, high) / green);
    }
    let xy = chromaticity(Observer::cie_1931_2deg().xyz(&lamp)).expect("light");
    assert!((xy[0] - 0.3154).abs() < 2e-4 && (xy[1] - 0.3882).abs() < 2e-4, "{xy:?}");
}

/// Every lamp states the origin of its strengths.
#[test]
fn lamps_say_where_their_strengths_come_from() {
    for (lamp, want) in [
        ("mercury", Strengths::Measured),
        ("he-ne", Strengths::Measured),
        ("neon", Strengths::Computed),
        ("sodium", Strengths::Computed),
        ("hydrogen", Strengths::Estimated),
        ("krypton", Strengths::Estimated),
    ] {
        assert_eq!(bundled_meta(lamp).expect("bundled").strengths, Some(want), "{lamp}");
    }
    assert_eq!(bundled_meta("D65").expect("bundled").strengths, None);
}
