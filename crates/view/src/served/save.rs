//! Saving of changes into the scene's file, where a person would write them.

use spectra_core::params::{Node, SourceFile, Span, Step, Value, steps};
use spectra_files::write_atomically;
use spectra_scene::{FileResources, series_of_text};
use std::io::Write;
use std::path::Path;
use std::sync::Arc;

/// Writes `changes` into a scene's file and returns the new text. A change is a pair of a path and a text `path=value`. `before`
/// is the text of the file when it was read.
///
/// The text is changed only where the values are; everything else stays, comments included. The file is written only if its text
/// is still `before`, and if the new text describes the scene that is shown.
///
/// # Errors
/// The reason why the file is not written.
pub(crate) fn save(
    file: &Path,
    before: &str,
    overrides: &[String],
    changes: &[(String, String)],
) -> Result<String, String> {
    let now = std::fs::read_to_string(file).map_err(|error| format!("{}: {error}", file.display()))?;
    let mut text = now.clone();
    if now != before {
        return Err(format!(
            "{} has changed meanwhile: the page will load it in a moment; then save again",
            file.display()
        ));
    }
    for (path, change) in changes {
        let value = change.split_once('=').map_or("", |(_, value)| value);
        text = with(&text, path, value).ok_or_else(|| format!("{path}: no place for it in {}", file.display()))?;
    }
    let texts: Vec<String> = changes.iter().map(|(_, text)| text.clone()).collect();
    let read = |text: &str, set: &[String]| {
        let folder = file.parent().filter(|p| !p.as_os_str().is_empty()).unwrap_or(Path::new("."));
        let resources = Arc::new(FileResources::beside(folder));
        let series = series_of_text(&file.to_string_lossy(), text, &[overrides, set].concat(), resources)?;
        series.scene(0).map(|scene| said(scene.params.node()))
    };
    let wanted = read(before, &texts).map_err(|faults| faults.to_string())?;
    let found = read(&text, &[]).map_err(|faults| faults.to_string())?;
    if wanted != found {
        return Err("these values cannot be inserted into the file as it is written; use `--set`".to_owned());
    }
    write_atomically(file, |out| Ok(out.write_all(text.as_bytes())?)).map_err(|error| error.to_string())?;
    Ok(text)
}

/// Returns whether two texts of a scene's file have the same value at a path; also true if neither has one.
pub(crate) fn says_same(one: &str, other: &str, path: &str) -> bool {
    let at = |text: &str| {
        let root = spectra_yaml::parse(SourceFile::new("scene", text)).ok()?;
        Some(root.at_path(path).map(said))
    };
    at(one) == at(other)
}

/// Returns the content of a tree as text, with keys sorted so that their order does not matter.
pub(super) fn said(node: &Node) -> String {
    match &node.value {
        Value::Map(entries) => {
            let mut all: Vec<String> =
                entries.iter().map(|(key, node)| format!("{}: {}", key.text, said(node))).collect();
            all.sort();
            format!("{{{}}}", all.join(", "))
        }
        Value::Seq(nodes) => format!("[{}]", nodes.iter().map(said).collect::<Vec<_>>().join(", ")),
        Value::Number(number) => number.value.to_string(),
        Value::String(text) => format!("{text:?}"),
        Value::Bool(is) => is.to_string(),
        Value::Null => "null".to_owned(),
    }
}

/// Returns a YAML text in which `path` has this value; `None` if there is no place for it.
pub(super) fn with(text: &str, path: &str, value: &str) -> Option<String> {
    let root = spectra_yaml::parse(SourceFile::new("scene", text)).ok()?;
    if let Some(node) = root.at_path(path) {
        let Span { offset, len, .. } = node.span;
        return Some(format!("{}{value}{}", &text[..offset], &text[offset + len..]));
    }
    // The deepest existing map gets the rest of the path.
    let steps: Vec<Step<'_>> = steps(path).ok()?;
    let (mut at, mut depth) = (&root, 0);
    for step in &steps {
        let Step::Key(key) = step else { return None };
        let Some(next) = at.get(key) else { break };
        (at, depth) = (next, depth + 1);
    }
    let Value::Map(entries) = &at.value else { return None };
    let keys: Option<Vec<&str>> =
        steps[depth..].iter().map(|s| if let Step::Key(key) = s { Some(*key) } else { None }).collect();
    let keys = keys?;
    let inner = keys[1..].iter().rev().fold(value.to_owned(), |inner, key| format!("{{{key}: {inner}}}"));
    let entry = format!("{}: {inner}", keys[0]);
    let Span { offset, len, .. } = at.span;
    let own = text.get(offset..offset + len)?;
    if own.starts_with('{') {
        let close = offset + own.rfind('}')?;
        let gap = if entries.is_empty() { "" } else { ", " };
        let end = text[..close].trim_end().len();
        return Some(format!("{}{gap}{entry}{}", &text[..end], &text[close..]));
    }
    // A map in block style gets one more line, before its first key.
    let (first, _) = entries.first()?;
    let line = text[..first.span.offset].rfind('\n').map_or(0, |at| at + 1);
    let indent = &text[line..first.span.offset];
    if !indent.chars().all(|c| c == ' ') {
        return None;
    }
    Some(format!("{}{indent}{entry}\n{}", &text[..line], &text[line..]))
}

#[cfg(test)]
mod tests {
    use super::*;
    use spectra_plugins as _;

    const SCENE: &str = "# A chart.\nspectra: 1\nsource:\n  kind: chart # of course\n  chart: resolution\n  distance: 2 m\n  luminance: 300 cd/m2\n  width: fill\n\
        lens: {file: zeiss-biotar-50-f1.4, f-number: f/2, focus: 2 m}\nimager: {kind: film, format: 135, resolution: [60, 40]}\n\
        film: {stock: kodak-tri-x-400, exposure: 1/80 s}\noutput: [png]\n";

    fn changes(texts: &[&str]) -> Vec<(String, String)> {
        texts.iter().map(|text| (text.split_once('=').unwrap().0.to_owned(), (*text).to_owned())).collect()
    }

    #[test]
    fn values_are_changed_where_they_stand_and_added_where_they_belong() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("scene.yaml");
        std::fs::write(&file, SCENE).unwrap();
        let set = changes(&[
            "lens.f-number=f/4",
            "source.luminance=150 cd/m2",
            "film.push=1",
            "source.edge=mirror",
            "lens.aperture={shape: iris, blades: 7}",
            "render.samples=8",
        ]);
        save(&file, SCENE, &[], &set).unwrap();
        let text = std::fs::read_to_string(&file).unwrap();
        let wanted = SCENE
            .replace("f/2,", "f/4,")
            .replace("300 cd", "150 cd")
            .replace("  kind: chart", "  edge: mirror\n  kind: chart")
            .replace("1/80 s}", "1/80 s, push: 1}")
            .replace("focus: 2 m}", "focus: 2 m, aperture: {shape: iris, blades: 7}}")
            .replace("spectra: 1", "render: {samples: 8}\nspectra: 1");
        assert_eq!(text, wanted);
        // A second save works on top of the first.
        save(&file, &text, &[], &changes(&["lens.aperture.blades=8"])).unwrap();
        assert!(std::fs::read_to_string(&file).unwrap().contains("blades: 8"));
    }

    #[test]
    fn a_file_that_changed_or_that_would_say_something_else_is_left_alone() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("scene.yaml");
        let anchored =
            SCENE.replace("focus: 2 m}", "focus: $there}").replace("spectra: 1", "spectra: 1\nvariables: {there: 2 m}");
        std::fs::write(&file, &anchored).unwrap();
        assert!(save(&file, SCENE, &[], &changes(&["lens.f-number=f/4"])).unwrap_err().contains("has changed"));
        // The use of a variable is overwritten with the value; the variable itself stays.
        save(&file, &anchored, &[], &changes(&["lens.focus=3 m"])).unwrap();
        assert_eq!(std::fs::read_to_string(&file).unwrap(), anchored.replace("focus: $there", "focus: 3 m"));
        assert!(
            save(&file, &std::fs::read_to_string(&file).unwrap(), &[], &changes(&["lens.f-number=f/0.1"])).is_err()
        );
    }
}
