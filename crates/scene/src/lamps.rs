//! Notes about lamps whose line strengths are estimates.

use spectra_core::params::{Node, Params, Value};
use spectra_spectrum::{Strengths, bundled_meta, bundled_spectra};

/// Returns a note on the bundled lamps in the source whose line strengths are estimates: the light and color of the scene are no
/// better than these.
pub(crate) fn notes(scene: &Params) -> Vec<String> {
    let mut lamps = Vec::new();
    if let Some(source) = scene.get("source") {
        gather(source, &mut lamps);
    }
    let note = |names: String| {
        format!(
            "the line strengths of {names} were estimated by eye: lines far apart are not comparable, so the color of the light \
             is a guess"
        )
    };
    let quoted: Vec<String> = lamps.iter().map(|name| format!("`{name}`")).collect();
    match &quoted[..] {
        [] => Vec::new(),
        [one] => vec![note(one.clone())],
        [others @ .., last] => vec![note(format!("{} and {last}", others.join(", ")))],
    }
}

fn gather(node: &Node, lamps: &mut Vec<String>) {
    match &node.value {
        Value::Map(entries) => entries.iter().for_each(|(_, value)| gather(value, lamps)),
        Value::Seq(items) => items.iter().for_each(|item| gather(item, lamps)),
        _ => {
            // A light may be composed of others: `0.5 * neon + D65`.
            let words = node.as_str().unwrap_or_default().split(['+', '*', ' ', '(', ')']);
            for name in words.filter(|word| is_estimated(word)) {
                if !lamps.iter().any(|known: &String| known.eq_ignore_ascii_case(name)) {
                    lamps.push(name.to_owned());
                }
            }
        }
    }
}

fn is_estimated(name: &str) -> bool {
    bundled_spectra().any(|(known, path)| path.starts_with("spectra/lamps/") && known.eq_ignore_ascii_case(name))
        && bundled_meta(name).is_some_and(|m| m.strengths == Some(Strengths::Estimated))
}
