//! Sorts the lines of a file into system, surfaces and the rest.

use super::keywords;

/// A line of a file that is not empty.
#[derive(Clone, Debug)]
pub(super) struct Record<'a> {
    /// Number of the line, from 1.
    pub(super) line: usize,
    /// Keyword at the start of the line.
    pub(super) keyword: &'a str,
    /// Text after the keyword.
    pub(super) rest: &'a str,
}

impl<'a> Record<'a> {
    /// Iterates over the words after the keyword; a quoted text is one word.
    pub(super) fn words(&self) -> impl Iterator<Item = &'a str> {
        let mut rest = self.rest;
        std::iter::from_fn(move || {
            rest = rest.trim_start();
            let end = match rest.strip_prefix('"') {
                Some(quoted) => quoted.find('"').map_or(rest.len(), |end| end + 2),
                None => rest.find(char::is_whitespace).unwrap_or(rest.len()),
            };
            let (word, behind) = rest.split_at(end);
            rest = behind;
            (!word.is_empty()).then_some(word)
        })
    }

    /// Returns the word with this index, from 0.
    pub(super) fn word(&self, number: usize) -> Option<&'a str> {
        self.words().nth(number)
    }

    /// Returns the word with this index as a number; `None` if it is missing or not a number.
    pub(super) fn number(&self, at: usize) -> Option<f64> {
        self.word(at).and_then(crate::number::parse)
    }
}

/// The records of a file by their place.
#[derive(Debug, Default)]
pub(super) struct Records<'a> {
    /// Records before the first surface.
    pub(super) system: Vec<Record<'a>>,
    /// Records of each surface, with its `SURF` record first.
    pub(super) surfaces: Vec<Vec<Record<'a>>>,
    /// Records of merit function, tolerances and configurations.
    pub(super) rest: Vec<Record<'a>>,
}

/// Sorts the lines of a file. Records of a surface are indented in most files; in others they are recognized by their keywords.
pub(super) fn sort(text: &str) -> Records<'_> {
    let mut records = Records::default();
    let mut in_surface = false;
    for (at, line) in text.lines().enumerate() {
        let trimmed = line.trim_matches(|c: char| c.is_whitespace() || c == '\0');
        let end = trimmed.find(char::is_whitespace).unwrap_or(trimmed.len());
        let (keyword, rest) = trimmed.split_at(end);
        if keyword.is_empty() {
            continue;
        }
        let record = Record { line: at + 1, keyword, rest: rest.trim() };
        if keyword.eq_ignore_ascii_case("SURF") {
            in_surface = true;
            records.surfaces.push(vec![record]);
            continue;
        }
        let indented = line.starts_with([' ', '\t']);
        in_surface = in_surface && (indented || keywords::is_of_surface(keyword));
        match records.surfaces.last_mut() {
            Some(surface) if in_surface => surface.push(record),
            None => records.system.push(record),
            Some(_) => records.rest.push(record),
        }
    }
    records
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_and_quotes() {
        let record = Record { line: 1, keyword: "CURV", rest: "1.5 0  \"a b\" x \"open" };
        assert_eq!(record.words().collect::<Vec<_>>(), ["1.5", "0", "\"a b\"", "x", "\"open"]);
        assert_eq!(record.number(0), Some(1.5));
        assert_eq!(record.number(2), None);
    }

    #[test]
    fn blocks_with_and_without_indents() {
        for indent in ["", "  "] {
            let text =
                format!("MODE SEQ\nSURF 0\n{indent}CURV 0\nSURF 1\n{indent}CURV 1\n{indent}DISZ 2\nBLNK\nTHIC 1 2\n");
            let records = sort(&text);
            let counts: Vec<usize> = records.surfaces.iter().map(Vec::len).collect();
            assert_eq!((records.system.len(), counts, records.rest.len()), (1, vec![2, 3], 2));
        }
    }
}
