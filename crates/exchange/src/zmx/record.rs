//! The lines of a file, sorted into system, surfaces and the rest.

use super::known;

/// One line that says something.
#[derive(Clone, Debug)]
pub(super) struct Record<'a> {
    /// Line, from 1.
    pub(super) line: usize,
    /// Its keyword.
    pub(super) keyword: &'a str,
    /// What stands behind it.
    pub(super) rest: &'a str,
}

impl<'a> Record<'a> {
    /// Words behind the keyword; quotes hold one together.
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

    /// A word by its number, from 0.
    pub(super) fn word(&self, number: usize) -> Option<&'a str> {
        self.words().nth(number)
    }

    /// A number that is there and is one.
    pub(super) fn number(&self, at: usize) -> Option<f64> {
        self.word(at).and_then(crate::number::parse)
    }
}

/// All lines of a file.
#[derive(Debug, Default)]
pub(super) struct Records<'a> {
    /// Before the first surface.
    pub(super) system: Vec<Record<'a>>,
    /// Each with its `SURF` line first.
    pub(super) surfaces: Vec<Vec<Record<'a>>>,
    /// Merit function, tolerances, configurations.
    pub(super) rest: Vec<Record<'a>>,
}

/// Sorts the lines. Surface records are indented in most files; where they are not, their keywords are known.
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
        in_surface = in_surface && (indented || known::is_of_surface(keyword));
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
