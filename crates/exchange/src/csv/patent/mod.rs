//! Tables of lenses as patents print them, typed again as a table with separators.
//!
//! A patent prints a title, then a line of headings (`Surface No. R D Nd vd Effective diameter Remarks`) and rows in columns of blanks;
//! or equations, `r1 = 61.844 d1 = 4.99 n1 = 1.77250 v1 = 49.6`. Surfaces are marked where they are aspherical (`14*`) or the stop
//! (`7 stop`), gaps vary, and coefficients of aspheres and values of gaps follow below. All of it becomes one table, each row of which
//! stands on the line on which it stood where that is possible, so that faults are found.

mod below;
mod equations;
mod rows;
mod words;

use crate::number;
use below::Below;
use rows::Head;
use std::collections::BTreeMap;
use std::fmt::Write as _;
pub(super) use words::{figure, is_variable, plain};

/// A table typed again.
pub(super) struct Retyped {
    pub text: String,
    /// What was assumed or could not be carried: line, whether light goes another way without it, words.
    pub notes: Vec<Told>,
}

/// Something to be told: a line from 1, or 0; whether light goes another way without it; words.
type Told = (usize, bool, String);

/// A surface of the table.
#[derive(Clone, Debug, Default)]
struct Row {
    line: usize,
    number: Option<u32>,
    /// By the names of [`COLUMNS`].
    cells: BTreeMap<&'static str, String>,
    is_stop: bool,
    is_marked: bool,
    /// The name of its gap in a table of equations: `d3` is that of the third lens.
    gap: Option<(String, u32)>,
}

/// The rows of a table, and where it ends.
struct Found {
    /// The line of its headings.
    head: usize,
    rows: Vec<Row>,
    /// The line behind its last row.
    end: usize,
    notes: Vec<Told>,
    /// Whether something in it has to be typed in another way.
    is_needed: bool,
}

/// Columns of the table that is typed.
const COLUMNS: [&str; 10] =
    ["surface", "type", "radius", "thickness", "nd", "vd", "glass", "diameter", "semi-diameter", "comment"];

/// Types a table again; `None` where the text is a table with separators and headings already, and nothing in it needs that.
pub(super) fn retype(text: &str) -> Option<Retyped> {
    let lines: Vec<&str> = text.lines().collect();
    let is_word = |line: &&str| !line.trim().is_empty() && !line.trim().starts_with('#');
    let first = lines.iter().position(is_word)?;
    let by_equations = equations::rows(&lines);
    let head = lines.iter().position(|line| Head::of(line).is_some()).filter(|_| by_equations.is_none());
    let mut found = match head.and_then(|at| Some((at, Head::of(lines[at])?))) {
        Some((at, head)) => {
            let found = rows::rows(&lines, at, &head);
            if head.separator.is_some() && at == first && !found.is_needed {
                return None;
            }
            found
        }
        None => by_equations?,
    };
    let below = Below::of(&lines, found.end);
    let mut notes = std::mem::take(&mut found.notes);
    fill_gaps(&mut found.rows, &below, &mut notes);
    if !found.rows.iter().any(|row| row.cells.contains_key("nd") || row.cells.contains_key("glass")) {
        notes.push((
            0,
            true,
            "no row has a glass: add its index and Abbe number behind each radius, as columns `nd` and `vd`".to_owned(),
        ));
    }
    if !found.rows.iter().any(|row| row.is_stop) {
        notes.extend(words::stop_in_prose(&lines));
    }
    Some(Retyped { text: written(&lines, &found, &below, &mut notes), notes })
}

/// Gaps that vary get the first of their values, the last gap the back focus that stands anywhere; without one it is left out.
fn fill_gaps(rows: &mut [Row], below: &Below, notes: &mut Vec<Told>) {
    let count = rows.len();
    for (at, row) in rows.iter_mut().enumerate() {
        let is_last = at + 1 == count;
        let cell = row.cells.get("thickness").cloned();
        if cell.as_deref().is_some_and(|cell| !is_variable(cell)) || cell.is_none() && !is_last {
            continue;
        }
        let own = words::gap_number(cell.as_deref()).or(row.number).and_then(|number| below.gaps.get(&number));
        let value = own.or(below.back_focus.as_ref().filter(|_| is_last));
        match (cell, value) {
            (Some(cell), Some(value)) if own.is_some() => {
                notes.push((
                    row.line + 1,
                    true,
                    format!("the gap `{cell}` varies: its first value, {value}, is taken"),
                ));
                row.cells.insert("thickness", value.clone());
            }
            (_, Some(value)) => drop(row.cells.insert("thickness", value.clone())),
            (Some(cell), None) if is_last => {
                notes.push((
                    row.line + 1,
                    false,
                    format!("`{cell}` is no number: the film stands where the lens is focused"),
                ));
                row.cells.remove("thickness");
            }
            (_, None) => {}
        }
    }
}

/// The table that is typed, a line of it for each line of the text.
fn written(lines: &[&str], found: &Found, below: &Below, notes: &mut Vec<Told>) -> String {
    let powers: Vec<u32> = {
        let mut all: Vec<u32> = below.aspheres.values().flat_map(|a| a.coefficients.keys().copied()).collect();
        all.sort_unstable();
        all.dedup();
        all
    };
    if below.has_kappa {
        let is = if below.kappa_is_conic {
            "the conic constant: 0 is a sphere"
        } else {
            "1 plus the conic constant: 1 is a sphere"
        };
        notes.push((0, true, format!("kappa is taken as {is}")));
    }
    let mut used: Vec<u32> = Vec::new();
    let mut out: Vec<String> = lines.iter().map(|_| "#".to_owned()).collect();
    let mut head = COLUMNS.join(";");
    head.push_str(";conic");
    for power in &powers {
        let _ = write!(head, ";a{power}");
    }
    for row in &found.rows {
        let cell = |name: &str| row.cells.get(name).map(|text| text.replace(';', ",")).unwrap_or_default();
        let mut cells: Vec<String> = COLUMNS.iter().map(|name| cell(name)).collect();
        cells[0] = row.number.map(|number| number.to_string()).unwrap_or_default();
        if row.is_stop {
            cells[1] = "stop".to_owned();
        }
        let asphere = row.number.and_then(|number| below.aspheres.get(&number));
        used.extend(row.number.filter(|_| asphere.is_some()));
        if row.is_marked && asphere.is_none() {
            let number = row.number.map(|n| n.to_string()).unwrap_or_default();
            let text =
                format!("surface {number} is marked as an asphere, and no coefficients follow: carried as its sphere");
            notes.push((row.line + 1, true, text));
        }
        cells.push(asphere.and_then(|a| a.conic.clone()).unwrap_or_default());
        for power in &powers {
            cells.push(asphere.and_then(|a| a.coefficients.get(power).cloned()).unwrap_or_default());
        }
        while out.len() <= row.line {
            out.push("#".to_owned());
        }
        out[row.line] = cells.join(";");
    }
    for number in below.aspheres.keys().filter(|number| !used.contains(number)) {
        notes.push((0, true, format!("coefficients of surface {number}, which the table does not have")));
    }
    match found.rows.first() {
        // The headings stand somewhere above the first row.
        Some(first) if first.line == 0 => out.insert(0, head),
        _ => out[found.head] = head,
    }
    out.join("\n") + "\n"
}

/// A figure as a number, with a decimal point or comma; `None` where it is none.
fn value(word: &str) -> Option<f64> {
    let point = if word.contains('.') { word.to_owned() } else { word.replacen(',', ".", 1) };
    number::parse(&figure(&point))
}
