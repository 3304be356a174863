//! Reads a line of headings, whose columns are separated by tabs, commas, semicolons or blanks.

use crate::csv::columns::{Column, by_name};

/// A line of headings.
pub(super) struct Head {
    pub separator: Option<char>,
    pub columns: Vec<Option<Column>>,
}

impl Head {
    /// Reads a line of headings, which must name at least a radius and a thickness.
    pub(super) fn of(line: &str) -> Option<Self> {
        let separator = [';', '\t', ','].into_iter().find(|c| line.contains(*c));
        // Ignore tabs as separators if headings are more than one tab apart: the tabs only align.
        let separator = separator.filter(|c| *c != '\t' || !line.trim().contains("\t\t"));
        let mut columns: Vec<Option<Column>> = match separator {
            Some(separator) => line.split(separator).map(|cell| by_name(cell.trim().trim_matches('"'))).collect(),
            None => by_blanks(line),
        };
        // The first column contains numbers, whatever its heading is called.
        let is_unknown = |word: &str| by_name(word).is_none();
        if separator.is_none()
            && !columns.contains(&Some(Column::Number))
            && line.split_whitespace().next().is_some_and(is_unknown)
        {
            columns.insert(0, Some(Column::Number));
        }
        let has = |wanted: Column| columns.contains(&Some(wanted));
        (has(Column::Radius) && has(Column::Thickness)).then_some(Self { separator, columns })
    }

    /// Resolves a last heading `Effective`: the next line says whether it is a radius or a diameter.
    pub(super) fn with_effective(&self, line: &str, next: &str) -> Self {
        let mut columns = self.columns.clone();
        if self.separator.is_none() && line.trim_end().to_lowercase().ends_with("effective") {
            let is_radius = next.to_lowercase().contains("radius");
            columns.push(Some(if is_radius { Column::SemiDiameter } else { Column::Diameter }));
        }
        Self { separator: self.separator, columns }
    }

    /// Whether the line also names media, so that it is the heading of a table of surfaces.
    pub(super) fn is_of_surfaces(&self) -> bool {
        self.has(Column::Index) || self.has(Column::Glass)
    }

    /// Whether the line names this column.
    pub(super) fn has(&self, column: Column) -> bool {
        self.columns.contains(&Some(column))
    }

    /// Returns the index of this column.
    pub(super) fn place(&self, column: Column) -> Option<usize> {
        self.columns.iter().position(|c| *c == Some(column))
    }
}

/// Splits headings that are separated by blanks and may have several words: the longest run of words that is a name counts.
fn by_blanks(line: &str) -> Vec<Option<Column>> {
    /// Largest number of words in a heading.
    const LONGEST: usize = 5;
    let words: Vec<&str> = line.split_whitespace().collect();
    let mut columns = Vec::new();
    let mut at = 0;
    while at < words.len() {
        let most = LONGEST.min(words.len() - at);
        match (1..=most).rev().find_map(|count| Some((count, by_name(&words[at..at + count].join(" "))?))) {
            Some((count, column)) => {
                columns.push(Some(column));
                at += count;
            }
            None => at += 1,
        }
    }
    columns
}
