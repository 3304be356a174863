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

mod nearest;
mod shown;

pub use nearest::nearest;
pub(crate) use shown::shown;

/// Shortest part of a name that can stand for the name, in letters and digits.
const SHORTEST: usize = 3;
/// Longest text that can be a name, bytes.
const LONGEST: usize = 120;

/// Result of looking up a name that was typed.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Match<'a> {
    /// Exactly this name matches.
    One(&'a str),
    /// Several names match, in the order in which they were given, those in folders last.
    Several(Vec<&'a str>),
    /// No name matches.
    Nothing,
}

/// Converts a name to the form in which names are compared: lower case, without spaces, hyphens and underscores.
#[must_use]
pub fn normalized(name: &str) -> String {
    name.chars().filter(|c| !matches!(c, ' ' | '-' | '_')).flat_map(char::to_lowercase).collect()
}

/// Finds the name among `known` that `typed` stands for. The first of these rules that finds any applies: the exact name; the
/// same name except for case, spaces, hyphens and underscores; names that contain every word of `typed` (`helios`, `canon 50`),
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

/// Largest number of names that a message lists in full.
const LISTED: usize = 12;
/// Number of names that a message shows of a longer list.
const SHOWN: usize = 10;

/// Formats names for a message: `a, b, c`. Of more than twelve names it shows the first ten, how many more there are, and
/// `command`, which shows all of them, such as `spectra list lens`. An empty `command` is left out.
#[must_use]
pub fn listed<S: AsRef<str>>(names: &[S], command: &str) -> String {
    let shown = if names.len() > LISTED { SHOWN } else { names.len() };
    let mut text = names[..shown].iter().map(AsRef::as_ref).collect::<Vec<_>>().join(", ");
    if shown < names.len() {
        text.push_str(&format!(" and {} more", names.len() - shown));
        if !command.is_empty() {
            text.push_str(&format!("; `{command}` shows all"));
        }
    }
    text
}

/// Returns the hint for a name that is not in `known`: the nearest name, the names that contain what was typed, or all names.
/// `command` is used as in [`listed`].
///
/// ```
/// use spectra_core::names::hint;
///
/// let kinds = ["beam", "chart", "picture", "point"];
/// assert_eq!(hint("pictre", &kinds, ""), "did you mean `picture`? Known: beam, chart, picture, point");
/// assert_eq!(hint("lamp", &kinds, ""), "known: beam, chart, picture, point");
/// ```
#[must_use]
pub fn hint<S: AsRef<str>>(typed: &str, known: &[S], command: &str) -> String {
    let all = || listed(known, command);
    if let Some(near) = nearest(typed, known.iter().map(AsRef::as_ref)) {
        return match known.len() {
            0..=LISTED => format!("did you mean `{near}`? Known: {}", all()),
            _ if command.is_empty() => format!("did you mean `{near}`?"),
            _ => format!("did you mean `{near}`? `{command}` shows all"),
        };
    }
    match find(typed, known.iter().map(AsRef::as_ref)) {
        Match::Several(several) => format!("which one? {}", listed(&several, command)),
        _ => format!("known: {}", all()),
    }
}

fn of(mut found: Vec<&str>) -> Match<'_> {
    found.dedup();
    // Files in folders serve special purposes: `surfaces/onion-biotar` comes after all lenses outside of folders.
    found.sort_by_key(|name| name.contains('/'));
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
        let foldered = ["surfaces/onion-biotar", "zeiss-biotar-100-f1.4", "zeiss-biotar-50-f1.4"];
        let several = vec!["zeiss-biotar-100-f1.4", "zeiss-biotar-50-f1.4", "surfaces/onion-biotar"];
        assert_eq!(find("biotar", foldered), Match::Several(several));
        assert_eq!(find("D-65", ["D65", "d65"]), Match::Several(vec!["D65", "d65"]));
        assert_eq!(find("d65", ["D65", "d65"]), Match::One("d65"));
    }

    #[test]
    fn too_little_stands_for_nothing() {
        for typed in ["", "  ", "f2", "f", "- - -", "canon x", "summicron", &"x".repeat(1_000_000)] {
            assert_eq!(find(typed, LENSES), Match::Nothing, "{typed:.20}");
        }
    }

    #[test]
    fn long_lists_are_cut() {
        let names: Vec<String> = (1..=13).map(|i| format!("n{i}")).collect();
        assert_eq!(listed(&names[..12], "x"), "n1, n2, n3, n4, n5, n6, n7, n8, n9, n10, n11, n12");
        assert_eq!(listed(&names, ""), "n1, n2, n3, n4, n5, n6, n7, n8, n9, n10 and 3 more");
        assert!(listed(&names, "spectra list lens").ends_with("n10 and 3 more; `spectra list lens` shows all"));
    }

    #[test]
    fn hints_know_slips_and_parts() {
        assert_eq!(hint("sfere", &["sphere", "plane"], ""), "did you mean `sphere`? Known: sphere, plane");
        assert_eq!(hint("asphere", &["even-asphere", "odd-asphere"], ""), "which one? even-asphere, odd-asphere");
        assert_eq!(hint("grat", &["grating", "plane"], ""), "did you mean `grating`? Known: grating, plane");
        assert_eq!(hint("lens", &["plane"], ""), "known: plane");
    }

    /// A whole name wins even if other names contain it.
    #[test]
    fn the_whole_name_wins() {
        assert_eq!(find("colorchecker", ["colorchecker-babelcolor", "colorchecker"]), Match::One("colorchecker"));
    }
}
