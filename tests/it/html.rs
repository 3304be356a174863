//! Tests `output: [html]`: a page about a picture or a sweep, in one file that needs no network.

use crate::common::{good, shown};
use std::fs;
use std::path::Path;

const SCENE: &str = "spectra: 1\n# a remark with <markup> & \"quotes\"\n\
    source: {kind: chart, chart: color-checker, distance: 1 m, width: fill, illuminant: D55, luminance: 300 cd/m2}\n\
    lens: {file: zeiss-biotar-50-f1.4, f-number: f/4, focus: 1 m}\n\
    imager: {kind: film, format: 135, resolution: [60, 40]}\n\
    film: {stock: tri-x, metering: average}\nrender: {samples: 4, seed: 1}\noutput: [html]\n";

fn written(folder: &Path, text: &str) -> String {
    let path = folder.join("card.yaml");
    fs::write(&path, text).expect("written");
    shown(&path).to_owned()
}

/// Checks that a page loads nothing, runs no script and closes every tag.
fn stands_alone(html: &str) {
    assert!(html.starts_with("<!doctype html>") && html.trim_end().ends_with("</html>"));
    for word in ["src=\"http", "src='", "<script", "<link", "@import", "url(", "onload", "<iframe"] {
        assert!(!html.contains(word), "{word}");
    }
    let sources = html.matches("src=\"").count();
    assert!(sources > 0 && sources == html.matches("src=\"data:image/").count());
    assert!(html.contains("default-src 'none'"));
    for tag in ["table", "tr", "td", "th", "figure", "pre", "main", "h2", "p", "div"] {
        let opened = html.matches(&format!("<{tag}>")).count() + html.matches(&format!("<{tag} ")).count();
        assert_eq!(opened, html.matches(&format!("</{tag}>")).count(), "{tag}");
    }
}

#[test]
fn a_page_shows_picture_lens_film_light_time_and_scene() {
    let folder = tempfile::tempdir().expect("a folder");
    let scene = written(folder.path(), SCENE);
    let said = good(&["run", &scene, "--json", "-o", shown(folder.path())]);
    assert!(said.contains("card.html"), "{said}");
    let html = fs::read_to_string(folder.path().join("card.html")).expect("written");
    stands_alone(&html);
    for words in [
        "<title>card</title>",
        "data:image/png;base64,",
        "data:image/svg+xml;base64,",
        "Zeiss Biotar 50 mm f/1.4",
        "US 1786916",
        "Kodak Tri-X 400",
        "exposed for",
        "light traced in",
        "recorded",
        "vignetted",
        "# a remark with &lt;markup&gt; &amp; &quot;quotes&quot;",
    ] {
        assert!(html.contains(words), "{words}");
    }
    // A page can be the only output, under its own name, like other pictures.
    let alone = folder.path().join("alone.html");
    good(&["run", &scene, "-q", "-o", shown(&alone)]);
    stands_alone(&fs::read_to_string(&alone).expect("written"));
}

/// Several films share a page.
#[test]
fn films_share_a_page() {
    let folder = tempfile::tempdir().expect("a folder");
    let text = SCENE.replace(
        "film: {stock: tri-x, metering: average}",
        "film: [{name: pan, stock: tri-x, exposure: 1/60 s}, {name: ortho, stock: ilford-ortho-plus, exposure: 1/60 s}]",
    );
    good(&["run", &written(folder.path(), &text), "-q", "-o", shown(folder.path())]);
    let html = fs::read_to_string(folder.path().join("card.html")).expect("written");
    stands_alone(&html);
    assert_eq!(html.matches("data:image/png;base64,").count(), 2);
    assert!(html.contains("<figcaption>pan</figcaption>") && html.contains("<figcaption>ortho</figcaption>"));
}

/// A sweep has a page for each picture and one for all, with the contact sheet, the values and links.
#[test]
fn a_sweep_has_a_page_of_all() {
    let folder = tempfile::tempdir().expect("a folder");
    let text = format!("{SCENE}sweep: {{lens.f-number: [f/2, f/8]}}\n");
    let said = good(&["run", &written(folder.path(), &text), "--json", "-o", shown(folder.path())]);
    assert!(said.contains("card-series.html"), "{said}");
    let html = fs::read_to_string(folder.path().join("card-series.html")).expect("written");
    stands_alone(&html);
    for words in [
        "sweep: 2 of 2 pictures",
        "lens.f-number",
        "f/8",
        "href=\"./card-001.html\"",
        "card-contact.png",
        "sweep: {lens.f-number: [f/2, f/8]}",
    ] {
        assert!(html.contains(words), "{words}");
    }
    stands_alone(&fs::read_to_string(folder.path().join("card-002.html")).expect("written"));
}
