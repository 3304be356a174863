//! Converts lens tables as printed in patents to tables with separators.
//!
//! A patent prints a title, then a line of headings (`Surface No. R D Nd vd Effective diameter Remarks`) and rows with columns separated by
//! blanks. Or it prints equations: `r1 = 61.844 d1 = 4.99 n1 = 1.77250 v1 = 49.6`. Surfaces are marked as aspherical (`14*`) or as the stop
//! (`7 stop`), gaps vary, and coefficients of aspheres and values of gaps follow below. All of this becomes one table. If possible, each
//! row stays on the line on which it was printed, so that error messages name the right line.

mod auxiliary_data;
mod blank_cells;
mod equations;
mod head;
mod lists;
mod rows;
mod vocabulary;

use super::cells::cells;
use super::columns::Column;
use crate::number;
use crate::source::shortened;
use auxiliary_data::AuxiliaryData;
use head::Head;
use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write as _;
pub(super) use vocabulary::{figure, is_stop_phrase, is_variable, plain};

/// A table converted to one with separators.
pub(super) struct ConvertedTable {
    pub text: String,
    /// Notes of what was assumed or could not be carried over: line, whether light takes another path without it, text.
    pub notes: Vec<TableNote>,
}

/// A note: line from 1, or 0; whether light takes another path without it; text.
type TableNote = (usize, bool, String);

/// A surface of the table.
#[derive(Clone, Debug, Default)]
struct PatentRow {
    line: usize,
    number: Option<u32>,
    /// Cells by the names in [`COLUMNS`].
    cells: BTreeMap<&'static str, String>,
    is_stop: bool,
    is_marked: bool,
    /// Name of the gap in a table of equations: `d3` is the gap of the third lens.
    gap: Option<(String, u32)>,
}

/// The rows found in a table, and its extent.
struct FoundRows {
    /// Index of the line of headings.
    head: usize,
    rows: Vec<PatentRow>,
    /// Index of the line after the last row.
    end: usize,
    notes: Vec<TableNote>,
    /// Whether something in the table requires a conversion.
    is_needed: bool,
    /// Whether the indices are at the line e.
    is_line_e: bool,
}

/// Columns of the resulting table.
const COLUMNS: [&str; 10] =
    ["surface", "type", "radius", "thickness", "nd", "vd", "glass", "diameter", "semi-diameter", "comment"];

/// Converts a table. `None` if the text is already a table with separators and headings in which nothing requires a conversion.
pub(super) fn retype(text: &str) -> Option<ConvertedTable> {
    let lines: Vec<&str> = text.lines().collect();
    let is_word = |line: &&str| !line.trim().is_empty() && !line.trim().starts_with('#');
    let first = lines.iter().position(is_word)?;
    let is_table = |line: &str| Head::of(line).is_some_and(|head| head.separator.is_some());
    let by_equations =
        if is_table(lines[first]) { None } else { lists::rows(&lines).or_else(|| equations::rows(&lines)) };
    let head = lines.iter().position(|line| Head::of(line).is_some()).filter(|_| by_equations.is_none());
    let mut head = head.and_then(|at| Some((at, Head::of(lines[at])?)));
    let mut found = match &head {
        Some((at, head)) => {
            let found = rows::rows(&lines, *at, head);
            if head.separator.is_some() && *at == first && !found.is_needed {
                return None;
            }
            found
        }
        None => by_equations?,
    };
    let separator = head.take().and_then(|(_, head)| Some((head.separator?, head)));
    let below = AuxiliaryData::of(&lines, found.end);
    let mut notes = std::mem::take(&mut found.notes);
    fill_gaps(&mut found.rows, &below, &mut notes);
    if !found.rows.iter().any(|row| row.cells.contains_key("nd") || row.cells.contains_key("glass")) {
        notes.push((
            0,
            true,
            "no row has a glass: add the index and Abbe number of each glass in columns `nd` and `vd`".to_owned(),
        ));
    }
    if !found.rows.iter().any(|row| row.is_stop) {
        notes.extend(vocabulary::stop_in_prose(&lines));
    }
    let text = match &separator {
        Some((separator, head)) => kept(&lines, *separator, head, &found, &below, &mut notes),
        None => written(&lines, &found, &below, &mut notes),
    };
    Some(ConvertedTable { text, notes })
}

/// Converts a table that has separators. Rows stay as they are except for marks, gaps that vary and data from below the table. Lines that
/// are not rows are removed.
fn kept(
    lines: &[&str],
    separator: char,
    head: &Head,
    found: &FoundRows,
    below: &AuxiliaryData,
    notes: &mut Vec<TableNote>,
) -> String {
    let powers = below.powers();
    let mut out: Vec<String> = lines.iter().map(|_| "#".to_owned()).collect();
    let joined = |cells: Vec<String>| {
        let quoted = cells.into_iter().map(|cell| if cell.contains(separator) { format!("\"{cell}\"") } else { cell });
        quoted.collect::<Vec<_>>().join(&separator.to_string())
    };
    let own = |line: &str| -> Vec<String> { cells(line, separator).into_iter().map(str::to_owned).collect() };
    let has_aspheres = !below.aspheres.is_empty();
    let mut heads = own(lines[found.head]);
    let count = heads.len();
    // Note an unknown heading and clear it, so that its column is ignored.
    for (cell, column) in heads.iter_mut().zip(&head.columns) {
        if column.is_none() && !cell.is_empty() {
            notes.push((found.head + 1, false, format!("the column `{}` is not read", shortened(cell))));
            cell.clear();
        }
    }
    if has_aspheres {
        heads.push("conic".to_owned());
        heads.extend(powers.iter().map(|power| format!("a{power}")));
    }
    out[found.head] = joined(heads);
    let place = |column: Column| head.columns.iter().position(|c| *c == Some(column));
    let mut used = BTreeSet::new();
    for row in &found.rows {
        let mut cells = own(lines[row.line]);
        if cells.len() <= count {
            cells.resize(count, String::new());
        }
        if let Some(at) =
            place(Column::Number).filter(|at| cells.get(*at).is_some_and(|cell| vocabulary::mark(cell).is_some()))
        {
            cells[at] =
                if row.is_stop { "stop".to_owned() } else { row.number.map(|n| n.to_string()).unwrap_or_default() };
        }
        if let Some(at) = place(Column::Thickness).filter(|at| cells.get(*at).is_some_and(|cell| is_variable(cell))) {
            cells[at] = row.cells.get("thickness").cloned().unwrap_or_default();
        }
        if has_aspheres {
            cells.truncate(count);
            cells.extend(below.terms(row.number, &powers));
        }
        used.extend(row.number);
        tell_marked(row, below, notes);
        out[row.line] = joined(cells);
    }
    tell_unused(&used, below, notes);
    out.join("\n") + "\n"
}

/// Notes a surface that is marked as an asphere but has no coefficients.
fn tell_marked(row: &PatentRow, below: &AuxiliaryData, notes: &mut Vec<TableNote>) {
    if row.is_marked && row.number.is_none_or(|number| !below.aspheres.contains_key(&number)) {
        let number = row.number.map(|n| n.to_string()).unwrap_or_default();
        let text =
            format!("surface {number} is marked as an asphere, but no coefficients follow: carried as its sphere");
        notes.push((row.line + 1, true, text));
    }
}

/// Notes coefficients of surfaces that the table does not have, and how kappa was interpreted.
fn tell_unused(used: &BTreeSet<u32>, below: &AuxiliaryData, notes: &mut Vec<TableNote>) {
    for number in below.aspheres.keys().filter(|number| !used.contains(number)) {
        notes.push((0, true, format!("coefficients of surface {number}, which the table does not have")));
    }
    if below.has_kappa {
        let is = if below.kappa_is_conic {
            "the conic constant: 0 is a sphere"
        } else {
            "1 plus the conic constant: 1 is a sphere"
        };
        notes.push((0, true, format!("kappa is read as {is}")));
    }
}

/// Fills in gaps that vary with the first of their values, and the last gap with the back focus if it is printed anywhere. Otherwise the
/// last gap is removed.
fn fill_gaps(rows: &mut [PatentRow], below: &AuxiliaryData, notes: &mut Vec<TableNote>) {
    let count = rows.len();
    for (at, row) in rows.iter_mut().enumerate() {
        let is_last = at + 1 == count;
        let cell = row.cells.get("thickness").cloned();
        if cell.as_deref().is_some_and(|cell| !is_variable(cell)) || cell.is_none() && !is_last {
            continue;
        }
        let own = vocabulary::gap_number(cell.as_deref()).or(row.number).and_then(|number| below.gaps.get(&number));
        let value = own.or(below.back_focus.as_ref().filter(|_| is_last));
        match (cell, value) {
            (Some(cell), Some(value)) if own.is_some() => {
                notes.push((row.line + 1, true, format!("the gap `{cell}` varies: its first value, {value}, is used")));
                row.cells.insert("thickness", value.clone());
            }
            (_, Some(value)) => drop(row.cells.insert("thickness", value.clone())),
            (Some(cell), None) if is_last => {
                notes.push((
                    row.line + 1,
                    false,
                    format!("`{cell}` is not a number: the film is placed where the lens is in focus"),
                ));
                row.cells.remove("thickness");
            }
            (_, None) => {}
        }
    }
}

/// Returns the resulting table, with one line for each line of the text.
fn written(lines: &[&str], found: &FoundRows, below: &AuxiliaryData, notes: &mut Vec<TableNote>) -> String {
    let powers = below.powers();
    let mut used = BTreeSet::new();
    let mut out: Vec<String> = lines.iter().map(|_| "#".to_owned()).collect();
    let mut head = COLUMNS.join(";");
    if found.is_line_e {
        head = head.replace(";nd;vd;", ";ne;ve;");
    }
    head.push_str(";conic");
    for power in &powers {
        let _ = write!(head, ";a{power}");
    }
    for row in &found.rows {
        let cell = |name: &str| row.cells.get(name).map(|text| text.replace(';', ",")).unwrap_or_default();
        let mut cells: Vec<String> = COLUMNS.iter().map(|name| cell(name)).collect();
        cells[0] = row.number.map(|number| number.to_string()).unwrap_or_default();
        if row.is_stop {
            cells[0] = "stop".to_owned();
        }
        used.extend(row.number);
        tell_marked(row, below, notes);
        cells.extend(below.terms(row.number, &powers));
        while out.len() <= row.line {
            out.push("#".to_owned());
        }
        out[row.line] = cells.join(";");
    }
    tell_unused(&used, below, notes);
    match found.rows.first() {
        // The headings go on a line above the first row.
        Some(first) if first.line == 0 => out.insert(0, head),
        _ => out[found.head] = head,
    }
    out.join("\n") + "\n"
}

/// Parses a number with a decimal point or comma; `None` if it is not one.
fn value(word: &str) -> Option<f64> {
    let point = if word.contains('.') { word.to_owned() } else { word.replacen(',', ".", 1) };
    number::parse(&figure(&point))
}
