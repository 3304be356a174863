//! The pictures that a scene stands for, and which of them has a value.

use crate::controls::PICTURE;
use spectra_session::Session;

/// Most pictures that a page chooses among by their values.
const MANY: usize = 1000;

/// The values of each picture, by path, as they are written; and which picture is seen.
#[derive(Clone, Debug, Default)]
pub struct Picks {
    all: Vec<Vec<(String, String)>>,
    at: usize,
}

impl Picks {
    /// Those of a session.
    #[must_use]
    pub fn of(session: &Session) -> Self {
        let series = session.series();
        let count = if series.count() > 1 { series.count().min(MANY) } else { 0 };
        Self { all: (0..count).map(|index| series.member(index).values).collect(), at: session.index() }
    }

    /// The picture that has this value at a path, and of those the one that has most in common with the picture from which it is turned:
    /// that which is seen, if none is said. Of `picture` itself the value is its number.
    #[must_use]
    pub fn with(&self, from: Option<usize>, path: &str, word: &str) -> Option<usize> {
        if path == PICTURE {
            let number: usize = word.split(':').next()?.trim().parse().ok()?;
            return number.checked_sub(1).filter(|index| *index < self.all.len());
        }
        let from = self.all.get(from.unwrap_or(self.at))?;
        let in_common = |values: &[(String, String)]| values.iter().filter(|value| from.contains(value)).count();
        let has = |values: &[(String, String)]| values.iter().any(|(own, value)| own == path && value == word);
        let mut found = self.all.iter().enumerate().filter(|(_, values)| has(values));
        // The first one of several that have as much.
        let first = found.next()?;
        let best = found.fold(first, |best, other| if in_common(other.1) > in_common(best.1) { other } else { best });
        Some(best.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_value_is_found_in_the_picture_that_differs_least() {
        let picture = |stop: &str, blades: &str| {
            vec![("lens.f-number".to_owned(), stop.to_owned()), ("lens.aperture.blades".to_owned(), blades.to_owned())]
        };
        let all = vec![picture("2", "7"), picture("2", "8"), picture("16", "7"), picture("16", "8")];
        let picks = Picks { all, at: 1 };
        assert_eq!(picks.with(None, "lens.f-number", "16"), Some(3));
        assert_eq!(picks.with(Some(0), "lens.f-number", "16"), Some(2));
        assert_eq!(picks.with(None, "lens.aperture.blades", "7"), Some(0));
        assert_eq!(picks.with(None, "lens.f-number", "4"), None);
        assert_eq!((picks.with(None, PICTURE, "3"), picks.with(None, PICTURE, "0")), (Some(2), None));
    }
}
