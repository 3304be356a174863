//! Selection of a picture of a series by the values that it has.

use crate::controls::PICTURE;
use spectra_session::Session;

/// Largest number of pictures among which a page can select by their values.
const MANY: usize = 1000;

/// The values of each picture of a series, by path and as written, and the index of the picture that is shown.
#[derive(Clone, Debug, Default)]
pub(crate) struct SeriesValues {
    all: Vec<Vec<(String, String)>>,
    at: usize,
}

impl SeriesValues {
    /// Gathers the values of the pictures of a session; empty if there is only one picture.
    pub(crate) fn of(session: &Session) -> Self {
        let series = session.series();
        let count = if series.count() > 1 { series.count().min(MANY) } else { 0 };
        Self { all: (0..count).map(|index| series.member(index).values).collect(), at: session.index() }
    }

    /// Finds the picture that has the value `word` at a path. If several have it, the one that shares most values with picture `from` is
    /// taken, or with the picture that is shown if `from` is `None`. For the path `picture`, the value is the picture's number, from 1.
    /// Returns the index of the picture.
    pub(crate) fn with(&self, from: Option<usize>, path: &str, word: &str) -> Option<usize> {
        if path == PICTURE {
            let number: usize = word.split(':').next()?.trim().parse().ok()?;
            return number.checked_sub(1).filter(|index| *index < self.all.len());
        }
        let from = self.all.get(from.unwrap_or(self.at))?;
        let in_common = |values: &[(String, String)]| values.iter().filter(|value| from.contains(value)).count();
        let has = |values: &[(String, String)]| values.iter().any(|(own, value)| own == path && value == word);
        let mut found = self.all.iter().enumerate().filter(|(_, values)| has(values));
        // If several share as many values, the first one is taken.
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
        let picks = SeriesValues { all, at: 1 };
        assert_eq!(picks.with(None, "lens.f-number", "16"), Some(3));
        assert_eq!(picks.with(Some(0), "lens.f-number", "16"), Some(2));
        assert_eq!(picks.with(None, "lens.aperture.blades", "7"), Some(0));
        assert_eq!(picks.with(None, "lens.f-number", "4"), None);
        assert_eq!((picks.with(None, PICTURE, "3"), picks.with(None, PICTURE, "0")), (Some(2), None));
    }
}
