//! Rows of values under named columns.

use crate::number;
use serde::Serialize;
use serde_json::{Map, Value};
use spectra_plot::Cell;

/// How the values of a column are shown to readers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Format {
    /// Values as they are, to the left.
    Text,
    /// Values as they are, to the right.
    Plain,
    /// Numbers with this many decimals.
    Fixed(usize),
    /// Numbers with six digits.
    Significant,
    /// Fractions as percentages with this many decimals.
    Percent(usize),
    /// Values that are in the data only.
    Hidden,
}

/// A column of a table.
#[derive(Clone, Debug, PartialEq)]
pub struct Column {
    key: String,
    label: String,
    format: Format,
}

impl Column {
    fn new(key: &str, label: &str, format: Format) -> Self {
        Self { key: key.to_owned(), label: label.to_owned(), format }
    }

    /// Creates a column of texts. `key` names the column in JSON and CSV, and ends with the unit (`_nm`); `label` stands over it in text.
    #[must_use]
    pub fn text(key: &str, label: &str) -> Self {
        Self::new(key, label, Format::Text)
    }

    /// Creates a column of numbers that are shown with all their digits.
    #[must_use]
    pub fn plain(key: &str, label: &str) -> Self {
        Self::new(key, label, Format::Plain)
    }

    /// Creates a column of numbers that are shown with this many decimals.
    #[must_use]
    pub fn fixed(key: &str, label: &str, decimals: usize) -> Self {
        Self::new(key, label, Format::Fixed(decimals))
    }

    /// Creates a column of numbers that are shown with six digits.
    #[must_use]
    pub fn significant(key: &str, label: &str) -> Self {
        Self::new(key, label, Format::Significant)
    }

    /// Creates a column of fractions that are shown as percentages with this many decimals.
    #[must_use]
    pub fn percent(key: &str, label: &str, decimals: usize) -> Self {
        Self::new(key, label, Format::Percent(decimals))
    }

    /// Creates a column that is in JSON and CSV but not in text.
    #[must_use]
    pub fn hidden(key: &str) -> Self {
        Self::new(key, "", Format::Hidden)
    }

    fn is_right(&self) -> bool {
        self.format != Format::Text
    }

    /// Formats a value; `-` if there is none.
    fn show(&self, value: &Value) -> String {
        match (value, value.as_f64(), self.format) {
            (Value::Null, ..) => "-".to_owned(),
            (_, Some(number), Format::Fixed(decimals)) => {
                let shown = format!("{number:.decimals$}");
                // A value that rounds to zero has no sign.
                if shown.bytes().any(|digit| digit.is_ascii_digit() && digit != b'0') {
                    shown
                } else {
                    shown.trim_start_matches('-').to_owned()
                }
            }
            (_, Some(number), Format::Significant) => number::significant(number),
            (_, Some(fraction), Format::Percent(decimals)) => number::percent(fraction, decimals),
            (Value::String(text), ..) => text.clone(),
            (value, ..) => value.to_string(),
        }
    }
}

/// A table with a name, whose rows have a value for each column.
#[derive(Clone, Debug, PartialEq)]
pub struct Table {
    pub(crate) key: String,
    columns: Vec<Column>,
    rows: Vec<Vec<Value>>,
    most: usize,
}

impl Table {
    /// Creates an empty table. `key` names it in JSON.
    #[must_use]
    pub fn new(key: &str, columns: impl IntoIterator<Item = Column>) -> Self {
        Self { key: key.to_owned(), columns: columns.into_iter().collect(), rows: Vec::new(), most: usize::MAX }
    }

    /// Limits the rows that text shows; JSON, CSV and HTML have all of them.
    #[must_use]
    pub fn most(self, most: usize) -> Self {
        Self { most, ..self }
    }

    /// Adds a row: a tuple, array or vector with a value for each column. Values that are missing, infinite or not a number are shown as `-`.
    ///
    /// # Panics
    /// If the row has another number of values than the table has columns, which is an error in the program.
    pub fn push(&mut self, row: impl Serialize) {
        let row = match serde_json::to_value(row) {
            Ok(Value::Array(row)) => row,
            Ok(value) => vec![value],
            Err(_) => Vec::new(),
        };
        assert_eq!(row.len(), self.columns.len(), "a row of table `{}`", self.key);
        self.rows.push(row);
    }

    /// Number of rows of the table.
    #[must_use]
    pub fn len(&self) -> usize {
        self.rows.len()
    }

    /// Whether the table has no rows.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.rows.is_empty()
    }

    /// Returns the columns that readers see, with their position in a row.
    fn shown(&self) -> impl Iterator<Item = (usize, &Column)> {
        self.columns.iter().enumerate().filter(|(_, column)| column.format != Format::Hidden)
    }

    /// Formats the table as lines of text, each indented by two spaces, below a header if any column has a label.
    #[must_use]
    pub fn to_text(&self) -> String {
        let mut lines = vec!["  ".to_owned(); self.rows.len().min(self.most) + 1];
        for (at, column) in self.shown() {
            let cells: Vec<String> = std::iter::once(column.label.clone())
                .chain(self.rows.iter().take(self.most).map(|row| column.show(&row[at])))
                .collect();
            let width = cells.iter().map(|cell| cell.chars().count()).max().unwrap_or(0);
            for (line, cell) in lines.iter_mut().zip(cells) {
                *line += &if column.is_right() { format!("{cell:>width$}  ") } else { format!("{cell:<width$}  ") };
            }
        }
        let without = usize::from(self.shown().all(|(_, column)| column.label.is_empty()));
        let mut out: String = lines.iter().skip(without).map(|line| format!("{}\n", line.trim_end())).collect();
        if self.rows.len() > self.most {
            out += &format!("  ... {} rows in all (--json shows each)\n", self.rows.len());
        }
        out
    }

    /// Returns the rows as JSON objects.
    pub(crate) fn to_json(&self) -> Value {
        let keys = || self.columns.iter().map(|column| column.key.clone());
        self.rows.iter().map(|row| keys().zip(row.iter().cloned()).collect::<Map<_, _>>()).collect()
    }

    /// Formats the table as CSV: a row of keys, then all rows with all digits. Texts with commas, quotes or line ends are quoted; a missing
    /// value is an empty cell.
    #[must_use]
    pub fn to_csv(&self) -> String {
        let quoted = |text: &str| match text.contains([',', '"', '\n', '\r']) {
            true => format!("\"{}\"", text.replace('"', "\"\"")),
            false => text.to_owned(),
        };
        let cell = |value: &Value| match value {
            Value::Null => String::new(),
            Value::String(text) => quoted(text),
            value => quoted(&value.to_string()),
        };
        let line = |cells: Vec<String>| cells.join(",") + "\n";
        let head = line(self.columns.iter().map(|column| quoted(&column.key)).collect());
        head + &self.rows.iter().map(|row| line(row.iter().map(cell).collect())).collect::<String>()
    }

    /// Returns the labels and the cells of a table in a page.
    pub(crate) fn cells(&self) -> (Vec<&str>, Vec<Vec<Cell>>) {
        let cell = |row: &[Value], at: usize, column: &Column| {
            let shown = column.show(&row[at]);
            if column.is_right() { Cell::Number(shown) } else { Cell::Text(shown) }
        };
        let rows = self.rows.iter().map(|row| self.shown().map(|(at, column)| cell(row, at, column)).collect());
        (self.shown().map(|(_, column)| column.label.as_str()).collect(), rows.collect())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn table() -> Table {
        let columns = [
            Column::text("glass", "glass"),
            Column::fixed("nd", "nd", 4),
            Column::percent("loss", "loss", 1),
            Column::hidden("note"),
        ];
        let mut table = Table::new("glasses", columns);
        table.push(("BK7, \"old\"", 1.51680, -1e-6, Some("x")));
        table.push(("SF6", f64::NAN, 0.25, None::<&str>));
        table
    }

    #[test]
    fn text_is_aligned_and_hides_what_is_data_only() {
        assert_eq!(
            table().to_text(),
            "  glass           nd    loss\n  BK7, \"old\"  1.5168   0.0 %\n  SF6              -  25.0 %\n"
        );
        assert_eq!(table().most(1).to_text().lines().last(), Some("  ... 2 rows in all (--json shows each)"));
    }

    #[test]
    fn columns_without_labels_have_no_header() {
        let mut table = Table::new("figures", [Column::text("figure", ""), Column::plain("value", "")]);
        table.push(("length", "46.5 mm"));
        assert_eq!(table.to_text(), "  length  46.5 mm\n");
    }

    #[test]
    fn csv_has_every_column_and_all_digits() {
        assert_eq!(table().to_csv(), "glass,nd,loss,note\n\"BK7, \"\"old\"\"\",1.5168,-1e-6,x\nSF6,,0.25,\n");
    }

    #[test]
    #[should_panic(expected = "a row of table `glasses`")]
    fn a_row_has_a_value_for_each_column() {
        table().push(("SF6", 1.8));
    }
}
