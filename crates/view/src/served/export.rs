//! The current picture in writing: as a command for the shell, and as the text of a scene.

use super::render_job::RenderJob;
use super::{photograph, save};
use spectra_scene::{FileResources, NO_LENS, Series, document, series_of_text};
use std::path::Path;
use std::sync::Arc;

/// Path of the resolution, which the page chooses for itself; it is not part of the scene.
const WIDTH: &str = "imager.resolution";
/// Options of `film develop`, by the keys that they set.
const OPTIONS: [(&str, &str); 9] = [
    ("lens.file", "--lens"),
    ("lens.f-number", "--f-number"),
    ("film.compensation", "--exposure"),
    ("film.iso", "--iso"),
    ("film.push", "--push"),
    ("film.development", "--development"),
    ("film.view", "--view"),
    ("film.print", "--print"),
    ("film.paper.grade", "--grade"),
];
/// Sections of a scene that have no effect if no ray is traced.
const OF_RAYS: [&str; 2] = ["lens.", "render."];

/// Returns the values that are set on top of a scene, as paths and values. The resolution is included only if the order sets it.
fn set(order: &RenderJob, series: &Series) -> Vec<(String, String)> {
    let split = |text: &String| {
        let (path, value) = text.split_once('=')?;
        Some((path.trim().to_owned(), value.trim().to_owned()))
    };
    let ordered: Vec<_> = order.overrides.iter().filter_map(split).collect();
    let own = series.overrides().iter().filter_map(split).filter(|(path, _)| path != WIDTH);
    ordered.iter().filter(|(path, _)| path == WIDTH).cloned().chain(own).collect()
}

/// Returns the command that renders a picture of the series at full size.
pub(super) fn command(order: &RenderJob, series: &Series, index: usize) -> String {
    let mut words = vec!["spectra".to_owned()];
    let file = order.scene.to_string_lossy();
    let set = set(order, series);
    let sets = |words: &mut Vec<String>, all: &[(String, String)]| {
        for (path, value) in all {
            words.extend(["--set".to_owned(), quoted(&format!("{path}={value}"))]);
        }
    };
    let Some(photograph) = &order.photograph else {
        words.extend(["run".to_owned(), quoted(&file)]);
        sets(&mut words, &set);
        if series.count() > 1 {
            let key =
                if matches!(series.kind(), spectra_scene::SeriesKind::Sweep { .. }) { "sweep" } else { "animation" };
            sets(&mut words, &[(key.to_owned(), "null".to_owned())]);
            sets(&mut words, &series.member(index).values);
        }
        return words.join(" ");
    };
    let said = |path: &str| {
        let turned = set.iter().rev().find(|(own, _)| own == path).map(|(_, value)| value.clone());
        turned.or_else(|| photograph.settings.iter().find(|own| own.path == path).map(|own| own.value.clone()))
    };
    let stock = said("film.stock").unwrap_or_default();
    words.extend(["film".to_owned(), "develop".to_owned(), quoted(&file), "--stock".to_owned(), quoted(&stock)]);
    let light = said("source.illuminant").unwrap_or_default();
    if photograph::light_of(&stock).ok().as_ref() != Some(&light) {
        words.extend(["--illuminant".to_owned(), quoted(&light)]);
    }
    let is_flat = series.is_without_lens();
    let mut rest = Vec::new();
    for (path, value) in set {
        if matches!(&*path, "film.stock" | "source.illuminant")
            || value == NO_LENS
            || (is_flat && OF_RAYS.iter().any(|section| path.starts_with(section)))
        {
            continue;
        }
        match OPTIONS.iter().find(|(key, _)| *key == path) {
            // With `=`, a value that begins with a minus sign is not taken for an option.
            Some((_, option)) => words.push(quoted(&format!("{option}={value}"))),
            None => rest.push((path, value)),
        }
    }
    sets(&mut words, &rest);
    words.join(" ")
}

/// Quotes a word for the shell if needed.
fn quoted(word: &str) -> String {
    let is_plain = |c: char| c.is_ascii_alphanumeric() || "_-./=:+,@%".contains(c);
    if !word.is_empty() && word.chars().all(is_plain) {
        word.to_owned()
    } else {
        format!("'{}'", word.replace('\'', r"'\''"))
    }
}

/// Returns the text of a scene that describes a picture of the series: the scene file with changed values in place, or, if that does not
/// work, a newly written scene.
pub(super) fn text(order: &RenderJob, series: &Series, index: usize) -> Result<String, String> {
    let faults = |faults: spectra_core::params::Faults| faults.to_string();
    let wanted = series.scene(index).map_err(faults)?;
    let mut edited = Some(series.written().to_owned());
    let mut set = set(order, series);
    if order.photograph.is_some() {
        // The text may be saved in any folder, so the photograph gets its absolute path.
        let file = std::fs::canonicalize(&order.scene).map_err(|error| error.to_string())?;
        set.push(("source.file".to_owned(), format!("{:?}", file.to_string_lossy())));
    }
    for (path, value) in &set {
        edited = edited.and_then(|text| save::with(&text, path, value));
    }
    let folder = order.scene.parent().filter(|p| !p.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let resources = Arc::new(FileResources::beside(folder));
    let seen = series.with(&format!("{WIDTH}={}", size(order, series, index)?)).and_then(|series| series.scene(index));
    let seen = save::said(seen.map_err(faults)?.params.node());
    let says_so = |text: &String| {
        let read = series_of_text("scene.yaml", text, &[], resources).and_then(|series| series.scene(index));
        read.is_ok_and(|scene| order.photograph.is_some() || save::said(scene.params.node()) == seen)
    };
    Ok(edited.filter(says_so).unwrap_or_else(|| document(wanted.params.node())))
}

/// Returns the resolution of a scene as its file states it.
fn size(order: &RenderJob, series: &Series, index: usize) -> Result<String, String> {
    let session = order.session().map_err(|error| error.to_string())?;
    let index = index.min(series.count() - 1);
    let scene = session.series().scene(index).map_err(|faults| faults.to_string())?;
    let size = scene.imager.size();
    Ok(format!("[{}, {}]", size.width_px, size.height_px))
}

#[cfg(test)]
mod tests {
    use super::*;
    use spectra_core::Isa;
    use spectra_plugins as _;

    #[test]
    fn words_are_quoted_as_a_shell_needs_it() {
        assert_eq!(quoted("lens.f-number=f/4"), "lens.f-number=f/4");
        assert_eq!(quoted("lens.focus=2 m"), "'lens.focus=2 m'");
        assert_eq!(quoted("it's"), r"'it'\''s'");
    }

    #[test]
    fn what_is_seen_is_a_command_and_a_text() {
        let order = RenderJob::of("night-stars".into(), None, Vec::new(), Isa::detect(), 1).expect("a scene");
        let session = order.session().expect("a scene");
        let series = session.series().with_all(&["imager.resolution=[480, 270]", "lens.focus=9 m"]).expect("set");
        let command = command(&order, &series, 3);
        assert_eq!(
            command,
            "spectra run night-stars --set 'lens.focus=9 m' --set sweep=null --set lens.f-number=16 --set lens.aperture.blades=8"
        );
        let text = text(&order, &series, 3).expect("a text");
        assert!(text.contains("9 m") && text.starts_with("# A street at night"), "{text}");
    }
}
