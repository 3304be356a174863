//! Finds the name that a person means. All look-ups of names go through here.
//!
//! ```
//! use spectra_core::names::{Match, find};
//!
//! let stocks = ["kodak-tri-x-400", "kodak-vision-2383", "kodak-vision3-250d-5207"];
//! assert_eq!(find("Tri-X", stocks), Match::One("kodak-tri-x-400"));
//! assert_eq!(find("vision", stocks), Match::Several(vec!["kodak-vision-2383", "kodak-vision3-250d-5207"]));
//! assert_eq!(find("portra-400", stocks), Match::Nothing);
//! ```

/// Shortest part of a name that can stand for it, in letters and digits.
const SHORTEST: usize = 3;
/// Longer texts are never names.
const LONGEST: usize = 120;

/// What a typed name stands for.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Match<'a> {
    /// This name.
    One(&'a str),
    /// All of these contain what was typed, in the order in which they were given.
    Several(Vec<&'a str>),
    /// None of them.
    Nothing,
}

/// Lower case without spaces, hyphens and underscores; names that differ only in these are the same.
#[must_use]
pub fn normalized(name: &str) -> String {
    name.chars().filter(|c| !matches!(c, ' ' | '-' | '_')).flat_map(char::to_lowercase).collect()
}

/// Finds the name among `known` that `typed` stands for. The first of these rules that finds any applies: the exact name; the
/// same name but for case, spaces, hyphens and underscores; names that contain every word of `typed` (`helios`, `canon 50`),
/// where each word has at least two letters or digits and all of them together at least three.
pub fn find<'a>(typed: &str, known: impl IntoIterator<Item = &'a str>) -> Match<'a> {
    let typed = typed.trim();
    if typed.is_empty() || typed.len() > LONGEST {
        return Match::Nothing;
    }
    let known: Vec<&str> = known.into_iter().collect();
    if let Some(name) = known.iter().find(|name| **name == typed) {
        return Match::One(name);
    }
    let key = normalized(typed);
    let same = known.iter().copied().filter(|name| normalized(name) == key);
    let found = of(same.collect());
    if found != Match::Nothing {
        return found;
    }
    let words: Vec<String> = typed.split_whitespace().map(normalized).collect();
    let letters = |word: &str| word.chars().filter(|c| c.is_alphanumeric()).count();
    if letters(&key) < SHORTEST || words.iter().any(|word| letters(word) < 2) {
        return Match::Nothing;
    }
    let holds = |name: &str| {
        let name = normalized(name);
        words.iter().all(|word| name.contains(word.as_str()))
    };
    of(known.into_iter().filter(|name| holds(name)).collect())
}

fn of(mut found: Vec<&str>) -> Match<'_> {
    found.dedup();
    match found[..] {
        [] => Match::Nothing,
        [one] => Match::One(one),
        _ => Match::Several(found),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const LENSES: [&str; 5] =
        ["helios-44-58-f2", "zeiss-biotar-50-f1.4", "zeiss-biotar-100-f1.4", "canon-35-f1.8", "canon-fd-50-f1.8"];

    #[test]
    fn spelling_and_parts_are_enough() {
        for (typed, name) in [
            ("helios-44-58-f2", "helios-44-58-f2"),
            ("Helios 44_58 F2", "helios-44-58-f2"),
            ("helios", "helios-44-58-f2"),
            ("BIOTAR 50", "zeiss-biotar-50-f1.4"),
            ("canon 50", "canon-fd-50-f1.8"),
            ("  fd-50 ", "canon-fd-50-f1.8"),
        ] {
            assert_eq!(find(typed, LENSES), Match::One(name), "{typed}");
        }
    }

    #[test]
    fn what_several_hold_is_left_to_the_person() {
        assert_eq!(find("biotar", LENSES), Match::Several(vec!["zeiss-biotar-50-f1.4", "zeiss-biotar-100-f1.4"]));
        assert_eq!(find("D-65", ["D65", "d65"]), Match::Several(vec!["D65", "d65"]));
        assert_eq!(find("d65", ["D65", "d65"]), Match::One("d65"));
    }

    #[test]
    fn too_little_stands_for_nothing() {
        for typed in ["", "  ", "f2", "f", "- - -", "canon x", "summicron", &"x".repeat(1_000_000)] {
            assert_eq!(find(typed, LENSES), Match::Nothing, "{typed:.20}");
        }
    }

    /// A whole name wins even if other names contain it.
    #[test]
    fn the_whole_name_wins() {
        assert_eq!(find("colorchecker", ["colorchecker-babelcolor", "colorchecker"]), Match::One("colorchecker"));
    }
}
