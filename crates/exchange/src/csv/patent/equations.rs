//! Reads tables of equations: `r1 = 61.844 d1 = 4.99 n1 = 1.77250 v1 = 49.6`, on one line or many.

use super::vocabulary::{figure, is_back_focus, is_end, is_other, is_plane, is_stop_phrase};
use super::{FoundRows, PatentRow, value};
use crate::MAX_ITEMS;

/// An equation of a patent: its name, its number and its value.
pub(super) struct Equation {
    /// Letters of the name, in lower case.
    pub name: String,
    /// Name as printed.
    written: String,
    pub number: Option<u32>,
    pub value: String,
    /// Words after the value.
    pub words: String,
    /// Whether an asterisk follows the value.
    pub is_marked: bool,
}

/// Whether a word continues a number: `e-5`, `×10^-5`.
fn is_power(word: &str) -> bool {
    let rest = word.strip_prefix(['×', 'e', 'E']);
    rest.is_some_and(|rest| rest.starts_with(|c: char| c.is_ascii_digit() || c == '-' || c == '+'))
}

/// Removes the markup of subscripts and the rules of a table from a line.
fn unmarked(line: &str) -> String {
    line.replace(".sub.", "").replace("<sub>", "").replace("</sub>", "").replace(['_', '{', '}'], "").replace('|', " ")
}

/// Returns the equations of a line.
pub(super) fn equations_of(line: &str) -> Vec<Equation> {
    let plain = unmarked(line);
    let parts: Vec<&str> = plain.split('=').collect();
    let mut found = Vec::new();
    let mut name = parts.first().map(|part| last_name(part).0).unwrap_or_default();
    for (k, part) in parts.iter().enumerate().skip(1) {
        let (next, value) = if k + 1 < parts.len() { last_name(part) } else { (String::new(), (*part).to_owned()) };
        let words: Vec<&str> = value.split(|c: char| c.is_whitespace() || c == ';').filter(|w| !w.is_empty()).collect();
        let mut count = 0;
        for word in &words {
            let signs = ["-", "+", "x", "×", "X"];
            let goes_on =
                count == 0 || signs.contains(&words[count - 1]) || signs[2..].contains(word) || is_power(word);
            if !goes_on {
                break;
            }
            count += 1;
        }
        let text = words[..count].concat();
        let text = text.trim_end_matches([',', ';']);
        let is_marked = text.ends_with('*');
        let text = text.trim_end_matches('*');
        let text = if text.contains('.') { text.to_owned() } else { text.replacen(',', ".", 1) };
        let digits: String = name.chars().filter(char::is_ascii_digit).collect();
        found.push(Equation {
            name: name.chars().filter(|c| c.is_alphabetic()).flat_map(char::to_lowercase).collect(),
            written: std::mem::replace(&mut name, next),
            number: digits.parse().ok(),
            value: figure(&text),
            words: words[count..].join(" "),
            is_marked,
        });
    }
    found
}

/// Splits the name of the next equation off the end of a text: `4.99 n 1` is `n1` after `4.99`.
fn last_name(part: &str) -> (String, String) {
    let words: Vec<&str> = part.split_whitespace().collect();
    let Some(last) = words.last() else { return (String::new(), String::new()) };
    let digits = last.trim_end_matches('*').chars().all(|c| c.is_ascii_digit());
    let is_split = digits && words.len() >= 2 && words[words.len() - 2].chars().all(char::is_alphabetic);
    let count = if is_split { 2 } else { 1 };
    let at = words.len() - count;
    (words[at..].concat(), words[..at].join(" "))
}

/// Returns an index and an Abbe number found in a text without equations.
fn glass_in(words: &str) -> Option<[String; 2]> {
    let figures: Vec<&str> = words.split_whitespace().filter(|word| value(word).is_some()).collect();
    let pair = figures.windows(2).find(|pair| {
        let of = |i: usize| value(pair[i]).unwrap_or(0.0);
        (1.3..2.3).contains(&of(0)) && (15.0..100.0).contains(&of(1))
    })?;
    Some([pair[0], pair[1]].map(|word| if word.contains('.') { word.to_owned() } else { word.replacen(',', ".", 1) }))
}

/// Adds the missing equals signs to lines such as `R1  +.4089` and `D1 .0645`; `None` if fewer than three radii are written like this.
fn with_signs(lines: &[&str]) -> Option<Vec<String>> {
    let named = |line: &str| -> Option<(String, String)> {
        let mut words = line.split_whitespace();
        let name = words.next()?;
        let letter = name.chars().next()?.to_ascii_lowercase();
        let is_name = "rdst".contains(letter) && name.len() > 1 && name[1..].chars().all(|c| c.is_ascii_digit());
        let first = words.next()?;
        let is_figure = value(first).is_some() || is_plane(first) || ["+", "-"].contains(&first);
        (is_name && is_figure && !line.contains('=')).then(|| {
            let rest = line.trim().split_once(char::is_whitespace).map_or("", |(_, rest)| rest.trim());
            (name.to_lowercase(), format!("{name} = {rest}"))
        })
    };
    let all: Vec<Option<(String, String)>> = lines.iter().map(|line| named(line)).collect();
    let radii = all.iter().flatten().filter(|(name, _)| name.starts_with('r')).count();
    let typed =
        |(own, line): (Option<(String, String)>, &&str)| own.map_or_else(|| (*line).to_owned(), |(_, text)| text);
    (radii >= 3).then(|| all.into_iter().zip(lines).map(typed).collect())
}

/// Reads the rows of a table of equations; `None` if there are fewer than three radii.
pub(super) fn rows(lines: &[&str]) -> Option<FoundRows> {
    if let Some(typed) = with_signs(lines) {
        return rows_of(&typed.iter().map(String::as_str).collect::<Vec<_>>());
    }
    rows_of(lines)
}

fn rows_of(lines: &[&str]) -> Option<FoundRows> {
    let mut found =
        FoundRows { head: 0, rows: Vec::new(), end: lines.len(), notes: Vec::new(), is_needed: true, is_line_e: false };
    for (at, line) in lines.iter().enumerate() {
        if line.trim().starts_with('#') {
            continue;
        }
        let is_of_aspheres = line.contains("非球面") && !line.contains('=') && found.rows.len() >= 3;
        if is_other(line) && found.rows.len() >= 2 || is_of_aspheres || found.rows.len() > MAX_ITEMS {
            found.end = at;
            break;
        }
        read_line(&mut found, at, line);
    }
    cemented(&mut found.rows);
    glasses_apart(lines, &mut found.rows);
    found.head = found.rows.first()?.line.saturating_sub(1);
    (found.rows.len() >= 3).then_some(found)
}

/// Reads the equations of a line, and the words for the stop and the figures of a glass beside them.
fn read_line(found: &mut FoundRows, at: usize, line: &str) {
    let all = equations_of(line);
    // The stop is printed between the lenses, with a gap but no radius of its own.
    let first_cell = line.split('|').next().unwrap_or_default().split("  ").find(|cell| !cell.trim().is_empty());
    if !all.is_empty()
        && !all.iter().any(|equation| equation.name == "r")
        && first_cell.is_some_and(is_stop_phrase)
        && !found.rows.is_empty()
    {
        let mut row = PatentRow { line: at, is_stop: true, ..PatentRow::default() };
        row.cells.insert("radius", "inf".to_owned());
        found.rows.push(row);
    }
    for equation in &all {
        add_equation(found, at, equation);
    }
    let Some(row) = found.rows.last_mut() else { return };
    if !all.is_empty() {
        // Read the figures of a glass in columns of their own, before the first equation.
        add_glass(row, unmarked(line).split('=').next().unwrap_or_default());
    } else if is_stop_phrase(line) && line.split_whitespace().count() <= 2 {
        // Read a word for the stop that is printed alone below a radius.
        row.is_stop = true;
    }
}

/// Adds the value of an equation to its row. A radius begins a new row.
fn add_equation(found: &mut FoundRows, at: usize, equation: &Equation) {
    let Some(name) = column_of(equation, found.rows.last()) else { return };
    let is_stop_word = is_stop_phrase(&equation.value);
    if name == "radius" {
        found.rows.push(PatentRow {
            // Put one row on each line of the resulting table.
            line: found.rows.last().map_or(at, |last| at.max(last.line + 1)),
            number: equation.number,
            is_marked: equation.written.contains('*')
                || equation.is_marked
                || equation.words.to_lowercase().contains("aspher"),
            is_stop: is_stop_phrase(&equation.words) || is_stop_word,
            ..PatentRow::default()
        });
    }
    found.is_line_e |= matches!(equation.name.as_str(), "ne" | "ve");
    let Some(row) = found.rows.last_mut() else { return };
    let is_plane = name == "radius" && (is_stop_word || is_plane(&equation.value));
    row.cells.insert(name, if is_plane { "inf".to_owned() } else { equation.value.clone() });
    if name == "thickness" {
        row.gap = equation.number.map(|number| (equation.name.clone(), number));
        add_glass(row, &equation.words);
    }
}

/// Returns the column of an equation behind the row `last`; `None` if it is not part of the table.
fn column_of(equation: &Equation, last: Option<&PatentRow>) -> Option<&'static str> {
    let is_new_gap = last.is_some_and(|row| !row.cells.contains_key("thickness"));
    let name = match equation.name.as_str() {
        "r" => "radius",
        "d" | "t" | "l" | "s" | "b" if !is_back_focus(&equation.written) => "thickness",
        // Read `a2` as an air gap if the row has none yet, otherwise as a coefficient.
        "a" if is_new_gap => "thickness",
        "n" | "nd" | "ne" => "nd",
        "v" | "vd" | "ve" | "nu" | "ny" => "vd",
        "phi" | "ø" | "φ" => "diameter",
        _ => return None,
    };
    let is_image = is_end(equation.words.trim_start_matches('('));
    let is_radius = is_stop_phrase(&equation.value) || is_plane(&equation.value) || value(&equation.value).is_some();
    // Skip the image plane, and a sentence about radii.
    if name == "radius" && (is_image || !is_radius) {
        return None;
    }
    // A gap without a number is accepted if the row has none yet.
    (equation.number.is_some() || name == "thickness" && is_new_gap).then_some(name)
}

/// Adds the figures of a glass in a text without equations, if the row has none yet.
fn add_glass(row: &mut PatentRow, words: &str) {
    if !row.cells.contains_key("nd")
        && let Some([nd, vd]) = glass_in(words)
    {
        row.cells.insert("nd", nd);
        row.cells.insert("vd", vd);
    }
}

/// Reads indices and Abbe numbers printed on lines of their own, one for each lens: `nD 1.623 1.670` and `v 56.9 47.2`. Lens k fills the
/// gap `dk`.
fn glasses_apart(lines: &[&str], rows: &mut [PatentRow]) {
    if rows.iter().any(|row| row.cells.contains_key("nd")) {
        return;
    }
    let figures = |line: &str, names: &[&str], range: std::ops::Range<f64>| -> Option<Vec<String>> {
        let mut words = line.split_whitespace();
        let name = words.next()?.to_lowercase();
        let figures: Vec<String> = words.map(str::to_owned).collect();
        let is_in = |word: &String| value(word).is_some_and(|n| range.contains(&n));
        (names.contains(&name.as_str()) && figures.len() >= 2 && figures.iter().all(is_in)).then_some(figures)
    };
    let indices = lines.iter().find_map(|line| figures(line, &["nd", "n", "n_d"], 1.3..2.3));
    let abbe = lines.iter().find_map(|line| figures(line, &["v", "vd", "nu", "ny"], 15.0..100.0));
    let (Some(indices), Some(abbe)) = (indices, abbe) else { return };
    for row in rows {
        let Some((letter, number)) = &row.gap else { continue };
        let at = *number as usize;
        if matches!(letter.as_str(), "d" | "t") && (1..=indices.len().min(abbe.len())).contains(&at) {
            row.cells.insert("nd", indices[at - 1].replacen(',', ".", 1));
            row.cells.insert("vd", abbe[at - 1].replacen(',', ".", 1));
        }
    }
}

/// Removes the first of two rows for the same cemented surface, which may be printed twice, as `r4` and `r4'`. The first one has no gap.
fn cemented(rows: &mut Vec<PatentRow>) {
    let is_twice = |pair: &[PatentRow]| {
        pair[0].number.is_some()
            && pair[0].number == pair[1].number
            && pair[0].cells.get("radius") == pair[1].cells.get("radius")
            && !pair[0].cells.contains_key("thickness")
    };
    let twice: Vec<bool> = rows.windows(2).map(is_twice).chain([false]).collect();
    let mut twice = twice.into_iter();
    rows.retain(|_| !twice.next().unwrap_or_default());
}
