//! Lamps whose lines are as strong as somebody estimated.

use spectra_core::params::{Node, Params, Value};
use spectra_spectrum::{Strengths, bundled_meta, bundled_spectra};

/// A note for each bundled lamp that the source names and whose line strengths are estimates: light and color of the scene
/// are no better than these.
pub(crate) fn notes(scene: &Params) -> Vec<String> {
    let mut notes = Vec::new();
    if let Some(source) = scene.get("source") {
        gather(source, &mut notes);
    }
    notes
}

fn gather(node: &Node, notes: &mut Vec<String>) {
    match &node.value {
        Value::Map(entries) => entries.iter().for_each(|(_, value)| gather(value, notes)),
        Value::Seq(items) => items.iter().for_each(|item| gather(item, notes)),
        _ => {
            // A light may be made of others: `0.5 * neon + D65`.
            let words = node.as_str().unwrap_or_default().split(['+', '*', ' ', '(', ')']);
            for name in words.filter(|word| is_estimated(word)) {
                let note = format!(
                    "the line strengths of `{name}` were estimated by eye: lines far apart are not comparable, so the color of the light is a guess"
                );
                if !notes.contains(&note) {
                    notes.push(note);
                }
            }
        }
    }
}

fn is_estimated(name: &str) -> bool {
    bundled_spectra().any(|(known, path)| path.starts_with("spectra/lamps/") && known.eq_ignore_ascii_case(name))
        && bundled_meta(name).is_some_and(|m| m.strengths == Some(Strengths::Estimated))
}
