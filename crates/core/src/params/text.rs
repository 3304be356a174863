//! Wording for messages: what was found, quoted safely, and the nearest known name.

use super::node::{Node, Value};
use super::units::Reading;
use crate::names::Match;
use std::fmt::Write;

/// Longest part of a user's text that a message repeats, in characters.
const SHOWN: usize = 48;

/// A user's text as messages quote it: on one line, without control characters, of limited length.
pub(super) fn shown(text: &str) -> String {
    let mut out = String::new();
    for (i, c) in text.chars().enumerate() {
        if i == SHOWN {
            out.push_str("...");
            break;
        }
        if c.is_control() {
            // Writing to a String cannot fail.
            let _ = write!(out, "{}", c.escape_default());
        } else {
            out.push(c);
        }
    }
    out
}

/// A noun with its article, such as `a length`, `an angle`, `an f-number`.
pub(super) fn with_article(noun: &str) -> String {
    let vowel = noun.starts_with(['a', 'e', 'i', 'o', 'u']) || noun.starts_with("f-");
    format!("{} {noun}", if vowel { "an" } else { "a" })
}

/// Describes a text: as a quantity of some dimension, or as just a text.
pub(super) fn found_text(text: &str) -> String {
    match Reading::of(text) {
        Reading::Quantity { unit, .. } => with_article(unit.dimension.noun()),
        _ => format!("the text `{}`", shown(text)),
    }
}

/// Describes a node, for `found ...`.
pub(super) fn found(node: &Node) -> String {
    match &node.value {
        Value::Null => "nothing".to_owned(),
        Value::Bool(value) => value.to_string(),
        Value::Number(number) => format!("the number {}", shown(&number.text)),
        Value::String(text) if node.is_quoted() => format!("the text `{}`", shown(text)),
        Value::String(text) => found_text(text),
        Value::Seq(_) => "a list".to_owned(),
        Value::Map(_) => "a map".to_owned(),
    }
}

/// The known name nearest to `name` by edit distance (insertions, deletions, replacements, swaps of neighbors; case is ignored,
/// and `_` equals `-`), if it is near enough: one edit for short names, a third of the length for long ones. The first one if
/// several are equally near; else the only one that `name` is a part of ([`crate::names::find`]).
#[must_use]
pub fn nearest<'a>(name: &str, known: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
    /// No key is longer than this. Limits the work, which grows with the product of both lengths.
    const LONGEST: usize = 64;
    let letters = |text: &str| -> Vec<char> {
        let fold = |c: char| if c == '_' || c == ' ' { '-' } else { c.to_ascii_lowercase() };
        text.chars().take(LONGEST + 1).map(fold).collect()
    };
    let name = letters(name);
    if name.is_empty() || name.len() > LONGEST {
        return None;
    }
    let typed: String = name.iter().collect();
    let known: Vec<&str> = known.into_iter().collect();
    let mut best: Option<(usize, &str)> = None;
    for candidate in known.iter().copied() {
        let other = letters(candidate);
        if other.len() > LONGEST {
            continue;
        }
        let allowed = |a: &[char], b: &[char]| (a.len().max(b.len()) / 3).max(1);
        let distance = edit_distance(&name, &other);
        // `portra-400` is no `tri-x-400`: equal figures do not make up for other words.
        let words = |text: &[char]| -> Vec<char> { text.iter().copied().filter(|c| !c.is_ascii_digit()).collect() };
        let (own, others) = (words(&name), words(&other));
        if distance > allowed(&name, &other) || edit_distance(&own, &others) > allowed(&own, &others) {
            continue;
        }
        // A letter must remain: `G` is not a misspelt `R`.
        let near = distance < name.len().max(other.len());
        if near && best.is_none_or(|(least, _)| distance < least) {
            best = Some((distance, candidate));
        }
    }
    if let Some((_, name)) = best {
        return Some(name);
    }
    match crate::names::find(&typed, known) {
        Match::One(name) => Some(name),
        _ => None,
    }
}

/// Optimal string alignment distance.
fn edit_distance(a: &[char], b: &[char]) -> usize {
    let mut before: Vec<usize> = Vec::new();
    let mut last: Vec<usize> = (0..=b.len()).collect();
    for i in 1..=a.len() {
        let mut row = vec![i; b.len() + 1];
        for j in 1..=b.len() {
            let replaced = last[j - 1] + usize::from(a[i - 1] != b[j - 1]);
            row[j] = replaced.min(last[j] + 1).min(row[j - 1] + 1);
            if i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1] {
                row[j] = row[j].min(before[j - 2] + 1);
            }
        }
        before = std::mem::replace(&mut last, row);
    }
    last[b.len()]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nearest_name() {
        let known = ["radius", "thickness", "semi-diameter", "glass", "nd", "vd", "conic"];
        for (typed, near) in [
            ("raduis", Some("radius")),
            ("thicknes", Some("thickness")),
            ("Semi_Diameter", Some("semi-diameter")),
            ("glas", Some("glass")),
            ("ND", Some("nd")),
            ("n", Some("nd")),
            ("k", None),
            ("ng", Some("nd")),
            ("kn", None),
            ("konik", None),
            ("zzz", None),
            ("diameter", Some("semi-diameter")),
            ("", None),
        ] {
            assert_eq!(nearest(typed, known), near, "{typed}");
        }
        let stocks = ["kodak-tri-x-400", "kodak-double-x-5222"];
        assert_eq!(nearest("kodak-trix-40", stocks), Some("kodak-tri-x-400"));
        assert_eq!(nearest("portra-400", stocks), None);
        assert_eq!(nearest(&"x".repeat(1_000_000), known), None);
    }

    #[test]
    fn distance_counts_edits() {
        let d = |a: &str, b: &str| edit_distance(&a.chars().collect::<Vec<_>>(), &b.chars().collect::<Vec<_>>());
        assert_eq!([d("kitten", "sitting"), d("ab", "ba"), d("", "abc"), d("same", "same")], [3, 1, 3, 0]);
    }

    #[test]
    fn shown_text_is_one_bounded_line() {
        assert_eq!(shown("a\nb\u{1b}[31m"), "a\\nb\\u{1b}[31m");
        assert_eq!(shown(&"x".repeat(1000)).len(), SHOWN + 3);
    }
}
