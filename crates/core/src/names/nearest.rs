//! Search for the known name nearest to what was typed.

use super::{Match, find};

/// Returns the known name nearest to `name` by edit distance (insertions, deletions, replacements, swaps of neighbors; case is
/// ignored, and `_` equals `-`), if it is near enough: one edit for short names, a third of the length for long ones. If
/// several are equally near, the first one; if none is near enough, the only name that contains `name` ([`find`]).
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
        // `portra-400` is not `tri-x-400`: equal digits do not make up for different words.
        let words = |text: &[char]| -> Vec<char> { text.iter().copied().filter(|c| !c.is_ascii_digit()).collect() };
        let (own, others) = (words(&name), words(&other));
        if distance > allowed(&name, &other) || edit_distance(&own, &others) > allowed(&own, &others) {
            continue;
        }
        // At least one letter must agree: `G` is not a misspelled `R`.
        let near = distance < name.len().max(other.len());
        if near && best.is_none_or(|(least, _)| distance < least) {
            best = Some((distance, candidate));
        }
    }
    if let Some((_, name)) = best {
        return Some(name);
    }
    match find(&typed, known) {
        Match::One(name) => Some(name),
        _ => None,
    }
}

/// Computes the optimal string alignment distance.
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
}
