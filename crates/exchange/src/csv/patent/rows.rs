//! Reads tables with a line of headings, row by row.

use super::blank_cells::{broken, cells_by_rule};
use super::head::Head;
use super::vocabulary::{figure, is_end, is_other, is_plane, is_stop_phrase, is_variable, mark};
use super::{FoundRows, PatentRow, value};
use crate::MAX_ITEMS;
use crate::csv::cells::cells;
use crate::csv::columns::Column;

/// Returns the name of a column in the resulting table.
fn name_of(column: Column) -> Option<&'static str> {
    Some(match column {
        Column::Number => "surface",
        Column::Kind => "type",
        Column::Radius => "radius",
        Column::Thickness => "thickness",
        Column::Glass => "glass",
        Column::Index => "nd",
        Column::Abbe => "vd",
        Column::SemiDiameter => "semi-diameter",
        Column::Diameter => "diameter",
        Column::Comment => "comment",
        _ => return None,
    })
}

/// Reads the rows below a line of headings.
pub(super) fn rows(lines: &[&str], head: usize, columns: &Head) -> FoundRows {
    let columns = columns.with_effective(lines[head], lines.get(head + 1).copied().unwrap_or_default());
    let found =
        FoundRows { head, rows: Vec::new(), end: lines.len(), notes: Vec::new(), is_needed: false, is_line_e: false };
    let mut reader = RowReader { lines, columns, found };
    let mut at = head + 1;
    while at < lines.len() {
        match reader.read_line(at) {
            Step::Next => at += 1,
            Step::Resume(next) => at = next.max(at + 1),
            Step::End => {
                reader.found.end = at;
                break;
            }
        }
    }
    if reader.columns.separator.is_none() {
        complete_last_size(&mut reader.found.rows);
    }
    reader.found
}

/// What follows a line of the table.
enum Step {
    Next,
    /// The rows continue at this line.
    Resume(usize),
    /// The line is not part of the table any more.
    End,
}

struct RowReader<'a> {
    lines: &'a [&'a str],
    columns: Head,
    found: FoundRows,
}

impl RowReader<'_> {
    /// Reads a line, and adds its row if it is one.
    fn read_line(&mut self, at: usize) -> Step {
        let line = self.lines[at];
        let plain = line.trim();
        let by_blanks = self.columns.separator.is_none();
        // Skip lines of a spreadsheet that contain only separators.
        if !plain.contains(char::is_alphanumeric) || plain.starts_with('#') || by_blanks && is_page_head(plain) {
            return Step::Next;
        }
        let is_full = self.found.rows.len() > MAX_ITEMS;
        if is_full || is_other(plain) && !self.has_figures(line) {
            let next = if is_full { None } else { self.goes_on(at) };
            self.found.is_needed |= next.is_none();
            return next.map_or(Step::End, Step::Resume);
        }
        let (row, is_row) = self.row(at);
        // Skip a line of words among the rows, which has none of their columns.
        if !is_row || row.cells.is_empty() && row.number.is_none() && !row.is_stop && !plain.contains([',', ';', '\t'])
        {
            self.found.is_needed |= is_row;
            return Step::Next;
        }
        if !by_blanks && is_sentence(&row) {
            self.found.is_needed = true;
            return Step::End;
        }
        // Stop at something else after the rows that has no heading of its own.
        if by_blanks && !has_radius(&row) {
            if self.found.rows.is_empty() {
                return Step::Next;
            }
            return self.goes_on(at).map_or(Step::End, Step::Resume);
        }
        if by_blanks {
            let note = |pair: String| (at + 1, false, format!("`{pair}` is read as one number"));
            self.found.notes.extend(broken(plain).into_iter().map(note));
        }
        self.found.rows.push(row);
        Step::Next
    }

    /// Whether a line has separators, and a number in the column of the radius or the thickness.
    fn has_figures(&self, line: &str) -> bool {
        let Some(separator) = self.columns.separator else { return false };
        let own = cells(line, separator);
        let of =
            |column| self.columns.place(column).and_then(|at| own.get(at)).is_some_and(|cell| value(cell).is_some());
        of(Column::Radius) || of(Column::Thickness)
    }

    /// Reads the cells of a line, and returns whether it can be a row.
    fn row(&mut self, at: usize) -> (PatentRow, bool) {
        let line = self.lines[at];
        let cells = match self.columns.separator {
            Some(separator) => cells(line, separator)
                .into_iter()
                .zip(&self.columns.columns)
                .filter_map(|(cell, column)| Some(((*column)?, cell.to_owned())))
                .filter(|(_, cell)| !cell.is_empty())
                .collect(),
            None => cells_by_rule(line.trim(), &self.columns),
        };
        let mut row = PatentRow { line: at, ..PatentRow::default() };
        let mut is_row = true;
        for (column, cell) in cells {
            is_row &= self.add_cell(&mut row, column, cell);
        }
        (row, is_row)
    }

    /// Adds a cell to a row. Returns false if it names the object, the image or something else, so that the line is not a row.
    fn add_cell(&mut self, row: &mut PatentRow, column: Column, cell: String) -> bool {
        let Some(name) = name_of(column) else { return true };
        let by_blanks = self.columns.separator.is_none();
        match column {
            Column::Number => match mark(&cell) {
                Some((number, is_stop, is_marked)) => {
                    self.found.is_needed |= is_marked || is_stop && number.is_some();
                    (row.number, row.is_stop, row.is_marked) = (number, is_stop, is_marked);
                }
                None if is_end(&cell) || by_blanks => {
                    self.found.is_needed |= is_end(&cell);
                    return false;
                }
                None => drop(row.cells.insert("comment", cell)),
            },
            Column::Comment => {
                // The object and the image may be named in a column without a heading.
                let is_row = !by_blanks || !is_end(&cell);
                self.found.is_needed |= is_stop_phrase(&cell) && by_blanks;
                row.is_stop |= is_stop_phrase(&cell);
                row.is_marked |= by_blanks && cell.to_lowercase().contains("aspher");
                row.cells.insert(name, cell);
                return is_row;
            }
            Column::Thickness if is_variable(&cell) => {
                self.found.is_needed = true;
                row.cells.insert(name, cell);
            }
            Column::Radius if by_blanks && is_plane(&cell) => {
                row.cells.insert(name, "inf".to_owned());
            }
            _ => {
                let typed = figure(&cell);
                self.found.is_needed |= typed != cell && !cell.contains(',');
                row.cells.insert(name, typed);
            }
        }
        true
    }

    /// Finds where the rows continue after a page break. Returns the line of the row with the next number, if it is near and nothing else
    /// begins before it.
    fn goes_on(&self, from: usize) -> Option<usize> {
        /// Largest number of lines that the foot of a page and the head of the next one take.
        const FEW: usize = 14;
        let columns = &self.columns;
        let next = self.found.rows.last()?.number? + 1;
        if columns.separator.is_some() || !columns.has(Column::Number) {
            return None;
        }
        for (at, line) in self.lines.iter().enumerate().skip(from).take(FEW) {
            let plain = line.trim().to_lowercase();
            let is_unit = plain.starts_with("unit") && plain.contains("mm");
            if Head::of(line).is_some() || is_other(line) && !plain.contains("continued") && !is_unit {
                return None;
            }
            let cells = cells_by_rule(line.trim(), columns);
            let of = |wanted: Column| cells.iter().find(|(column, _)| *column == wanted).map(|(_, cell)| cell.as_str());
            let number = of(Column::Number).and_then(mark).and_then(|(number, ..)| number);
            let has_radius = of(Column::Radius).is_some_and(|cell| is_plane(cell) || value(cell).is_some());
            let has_gap = of(Column::Thickness).is_some_and(|cell| is_variable(cell) || value(cell).is_some());
            match number {
                Some(number) if has_radius && has_gap => return (number == next).then_some(at),
                _ => {}
            }
        }
        None
    }
}

/// Whether a line holds nothing but the numbers of two neighboring columns of a patent, as at the head of a page.
fn is_page_head(plain: &str) -> bool {
    let page: Vec<u32> = plain.split_whitespace().filter_map(|word| word.parse().ok()).collect();
    page.len() == 2 && page[1] == page[0] + 1 && plain.split_whitespace().count() == 2
}

/// Whether a row is a sentence with commas after the rows.
fn is_sentence(row: &PatentRow) -> bool {
    let figures = ["radius", "thickness", "nd", "semi-diameter", "diameter"];
    row.number.is_none()
        && !figures.iter().any(|name| row.cells.contains_key(name))
        && !row.is_stop
        && row.cells.contains_key("comment")
}

/// Moves the last figure of the last row to its size, if every other row has one and the figure is near the size of the row before.
fn complete_last_size(rows: &mut [PatentRow]) {
    let size = ["diameter", "semi-diameter"]
        .into_iter()
        .find(|name| rows.first().is_some_and(|row| row.cells.contains_key(name)));
    if let (Some(size), Some((last, others))) = (size, rows.split_last_mut())
        && others.iter().all(|row| row.cells.contains_key(size))
        && !last.cells.contains_key(size)
        && let Some(figure) = last.cells.get("thickness").filter(|cell| !is_variable(cell)).cloned()
    {
        let of = |cell: Option<&String>| cell.and_then(|cell| value(cell));
        let before = of(others.last().and_then(|row| row.cells.get(size)));
        if before.zip(value(&figure)).is_some_and(|(before, own)| (own / before - 1.0).abs() < 0.3) {
            last.cells.remove("thickness");
            last.cells.insert(size, figure);
        }
    }
}

/// Whether a row has a radius: a number, or a word for a plane.
fn has_radius(row: &PatentRow) -> bool {
    let is_radius = |cell: &String| is_plane(cell) || cell.eq_ignore_ascii_case("stop") || value(cell).is_some();
    row.cells.get("radius").is_some_and(is_radius)
}
