//! Finding a medium by name.

use std::fmt;

use thiserror::Error;

use super::{Catalogue, Place};
use crate::glass::Glass;
use crate::medium::Medium;

/// A medium that was meant, perhaps.
#[derive(Clone, Debug, PartialEq)]
pub struct Candidate {
    /// `MAKER/NAME`.
    pub full_name: String,
    /// Its index at the d line.
    pub nd: f64,
    /// Its Abbe number at d, F and C.
    pub vd: f64,
}

impl fmt::Display for Candidate {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if self.nd.is_finite() && self.vd.is_finite() && self.vd.abs() < 1000.0 {
            write!(f, "{} (nd {:.5}, Vd {:.2})", self.full_name, self.nd, self.vd)
        } else {
            f.write_str(&self.full_name)
        }
    }
}

/// Why a name is not one medium.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum FindError {
    /// Nothing has this name.
    #[error("no glass `{name}`; nearest names: {}", list(nearest))]
    Unknown {
        /// The name asked for.
        name: String,
        /// The nearest names, best first.
        nearest: Vec<Candidate>,
    },
    /// Several media have it.
    #[error("`{name}` is the name of {} glasses; write one of: {}", candidates.len(), list(candidates))]
    Ambiguous {
        /// The name asked for.
        name: String,
        /// All that have it.
        candidates: Vec<Candidate>,
    },
}

impl FindError {
    /// What is wrong, without the names.
    #[must_use]
    pub fn message(&self) -> String {
        match self {
            Self::Unknown { name, .. } => format!("no glass `{name}`"),
            Self::Ambiguous { name, candidates } => format!("`{name}` is the name of {} glasses", candidates.len()),
        }
    }

    /// What to write instead.
    #[must_use]
    pub fn hint(&self) -> String {
        match self {
            Self::Unknown { name, .. } if name.parse::<f64>().is_ok_and(|nd| (1.0..=4.0).contains(&nd)) => {
                format!("an index alone is `nd: {name}`; with its Abbe number, `glass: {{nd: {name}, vd: ...}}`")
            }
            Self::Unknown { nearest, .. } => match nearest.as_slice() {
                [] => "a glass of a catalogue, such as SCHOTT/N-BK7, or a file of your own, such as `my-glass.yaml`"
                    .to_owned(),
                [one] => format!("did you mean `{}`?", one.full_name),
                [first, others @ ..] => format!("did you mean `{}`? Near it: {}", first.full_name, list(others)),
            },
            Self::Ambiguous { candidates, .. } => format!("write one of {}", list(candidates)),
        }
    }
}

fn list(candidates: &[Candidate]) -> String {
    candidates.iter().map(ToString::to_string).collect::<Vec<_>>().join(", ")
}

/// How many names an error lists.
const LISTED: usize = 6;

/// Other spellings of makers in old and foreign catalogues, and in the files of optical design programs.
const MAKERS: [(&str, &str); 7] = [
    ("LZ", "LZOS"),
    ("NIKON", "HIKARI"),
    ("NIKON-HIKARI", "HIKARI"),
    ("CORNING-FRANCE", "CORNING"),
    ("JENA", "SCHOTT"),
    ("CHENGDU", "CDGM"),
    ("SCHOTT-GLAS", "SCHOTT"),
];

impl Catalogue {
    /// The medium of that name: `SCHOTT/N-BK7`, or `N-BK7` where one maker only has it; an everyday name such as
    /// `water`; or the substance alone where there is one measurement. Upper and lower case are the same; where
    /// nothing else fits hyphens, underscores, blanks and dots do not count. `LZ_LF5` is `LZOS/LF5`.
    ///
    /// # Errors
    /// A name that nothing or more than one medium has, with the candidates.
    pub fn find(&self, name: &str) -> Result<Glass, FindError> {
        let places = self.places(name);
        match places[..] {
            [place] => Ok(self.glass(place)),
            [] => Err(FindError::Unknown { name: name.to_owned(), nearest: self.nearest_names(name) }),
            _ => Err(FindError::Ambiguous { name: name.to_owned(), candidates: self.candidates(&places) }),
        }
    }

    /// As [`Catalogue::find`], with `air` and `vacuum` as the media that they are in a lens (air is 1).
    ///
    /// # Errors
    /// As [`Catalogue::find`].
    pub fn medium(&self, name: &str) -> Result<Medium, FindError> {
        match name.trim() {
            name if name.eq_ignore_ascii_case("air") => Ok(Medium::Air),
            name if name.eq_ignore_ascii_case("vacuum") => Ok(Medium::Vacuum),
            name => self.find(name).map(Medium::from),
        }
    }

    /// As [`Catalogue::find`], where an index and perhaps an Abbe number are known beside the name (of a patent or
    /// a lens file): of several media of the name the nearest one, if it is within 0.002 in nd and, where `vd` is given,
    /// within 2 % in Vd.
    ///
    /// # Errors
    /// As [`Catalogue::find`]; ambiguous too if none of several is that near.
    pub fn find_with(&self, name: &str, nd: f64, vd: Option<f64>) -> Result<Glass, FindError> {
        let places = self.places(name);
        if places.len() < 2 {
            return self.find(name);
        }
        let far = |glass: &Glass| {
            let n = (glass.nd() - nd).abs() / 0.002;
            let v = vd.map_or(0.0, |vd| (glass.vd() - vd).abs() / (0.02 * vd));
            n.max(v)
        };
        let best = places.iter().map(|&p| self.glass(p)).map(|g| (far(&g), g)).min_by(|a, b| a.0.total_cmp(&b.0));
        match best {
            Some((distance, glass)) if distance <= 1.0 => Ok(glass),
            _ => Err(FindError::Ambiguous { name: name.to_owned(), candidates: self.candidates(&places) }),
        }
    }

    fn places(&self, name: &str) -> Vec<Place> {
        let name = name.trim();
        let name = self.bundle.alias(name).unwrap_or(name);
        let (maker, name) = split_maker(name);
        let maker = maker.map(|m| {
            let m = m.to_uppercase();
            MAKERS.iter().find(|(alias, _)| *alias == m).map_or(m, |(_, maker)| (*maker).to_owned())
        });
        let of_maker = |place: &Place| maker.as_ref().is_none_or(|m| self.maker_of(*place).to_uppercase() == *m);
        let upper = name.to_uppercase();
        let start = self.index.partition_point(|(n, _)| n.as_ref() < upper.as_str());
        let same = self.index[start..].iter().take_while(|(n, _)| n.as_ref() == upper).map(|(_, place)| *place);
        let exact: Vec<Place> = same.filter(of_maker).collect();
        if !exact.is_empty() {
            return exact;
        }
        // A substance without the name of a measurement.
        if maker.is_none() {
            let all: Vec<Place> =
                self.index.iter().map(|(_, p)| *p).filter(|p| self.maker_of(*p).to_uppercase() == upper).collect();
            if !all.is_empty() {
                return all;
            }
        }
        let squeezed = squeeze(name);
        if squeezed.is_empty() {
            return Vec::new();
        }
        self.index.iter().filter(|(n, p)| squeeze(n) == squeezed && of_maker(p)).map(|(_, place)| *place).collect()
    }

    fn candidates(&self, places: &[Place]) -> Vec<Candidate> {
        places.iter().map(|&place| candidate(&self.glass(place))).collect()
    }

    /// The names with the smallest edit distance; those of the maker that was named come first.
    fn nearest_names(&self, name: &str) -> Vec<Candidate> {
        let (maker, bare) = split_maker(name.trim());
        let maker = maker.map(str::to_uppercase);
        let bare: Vec<char> = bare.to_uppercase().chars().take(64).collect();
        let mut scored: Vec<(usize, bool, usize)> = (self.index.iter().enumerate())
            .map(|(i, (candidate, place))| {
                let other_maker = maker.as_ref().is_some_and(|m| self.maker_of(*place).to_uppercase() != *m);
                (edit_distance(&bare, candidate), other_maker, i)
            })
            .collect();
        scored.sort_unstable();
        scored.truncate(LISTED);
        scored.iter().map(|&(_, _, i)| candidate(&self.glass(self.index[i].1))).collect()
    }
}

fn candidate(glass: &Glass) -> Candidate {
    Candidate { full_name: glass.full_name(), nd: glass.nd(), vd: glass.vd() }
}

/// `SCHOTT/N-BK7` and the `LZ_` of LZOS glasses in design programs.
fn split_maker(name: &str) -> (Option<&str>, &str) {
    if let Some((maker, name)) = name.split_once('/') {
        let name = name.trim();
        return (Some(maker.trim()), strip_lzos(name).unwrap_or(name));
    }
    match strip_lzos(name) {
        Some(rest) => (Some("LZOS"), rest),
        None => (None, name),
    }
}

fn strip_lzos(name: &str) -> Option<&str> {
    let prefix = name.get(..3)?;
    (prefix.eq_ignore_ascii_case("LZ_") && name.len() > 3).then(|| &name[3..])
}

fn squeeze(name: &str) -> String {
    name.chars().filter(|c| !matches!(c, '-' | '_' | ' ' | '.')).flat_map(char::to_uppercase).collect()
}

/// Levenshtein's distance: insertions, deletions and replacements of characters.
fn edit_distance(a: &[char], b: &str) -> usize {
    let mut row: Vec<usize> = (0..=a.len()).collect();
    for (j, cb) in b.chars().enumerate() {
        let mut diagonal = row[0];
        row[0] = j + 1;
        for (i, ca) in a.iter().enumerate() {
            let replace = diagonal + usize::from(*ca != cb);
            diagonal = row[i + 1];
            row[i + 1] = replace.min(row[i] + 1).min(diagonal + 1);
        }
    }
    row[a.len()]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn distance_of_words() {
        let chars = |s: &str| s.chars().collect::<Vec<_>>();
        assert_eq!(edit_distance(&chars("KITTEN"), "SITTING"), 3);
        assert_eq!(edit_distance(&chars(""), "ABC"), 3);
        assert_eq!(edit_distance(&chars("N-BK7"), "N-BK7"), 0);
    }

    #[test]
    fn makers_in_names() {
        assert_eq!(split_maker("schott / N-BK7"), (Some("schott"), "N-BK7"));
        assert_eq!(split_maker("LZ_LF5"), (Some("LZOS"), "LF5"));
        assert_eq!(split_maker("lzos/LZ_LF5"), (Some("lzos"), "LF5"));
        assert_eq!(split_maker("LZ_"), (None, "LZ_"));
        assert_eq!(split_maker("\u{df}\u{df}"), (None, "\u{df}\u{df}"));
    }
}
