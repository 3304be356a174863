//! Checks that every built-in film obeys the laws of films.

use spectra_plugin_films as _;
use spectra_testing::{FilmLaws, assert_fault, film};

#[test]
fn stocks_develop_what_they_are_given() {
    // Dyes make colors that a screen cannot show. Grain and the meter break the rule that more light makes a brighter picture.
    let laws = FilmLaws { beyond_screen: 0.5, brighter_with_light: false, ..FilmLaws::default() };
    for yaml in [
        "{stock: ilford-ortho-plus, exposure: 1/60 s}",
        "{stock: kodak-double-x-5222, exposure: 1/60 s}",
        "{kind: three-strip, exposure: 1/60 s}",
    ] {
        println!("{yaml}"); // shown where a law fails
        laws.hold(&*film(yaml));
    }
}

#[test]
fn faults_are_placed() {
    assert_fault("film", "{stock: ilford-ortho-pluss, exposure: 1/60 s}", "stock");
    assert_fault("film", "{stock: ilford-ortho-plus, exposure: 1/60 m}", "exposure");
}
