//! Reads tables printed as lists one below the other: all radii, then all thicknesses and gaps, then the glasses of the lenses.

use super::equations::equations_of;
use super::vocabulary::{is_back_focus, is_plane};
use super::{FoundRows, PatentRow, value};
use crate::MAX_ITEMS;

/// Reads the rows of such lists; `None` if radii and gaps are not separate, or their numbers do not match.
pub(super) fn rows(lines: &[&str]) -> Option<FoundRows> {
    let mut rows: Vec<PatentRow> = Vec::new();
    // Letter, value and line of each gap.
    let mut gaps: Vec<(String, String, usize)> = Vec::new();
    for (at, line) in lines.iter().enumerate() {
        let all = equations_of(line);
        let [equation] = &all[..] else {
            // Several equations in a line belong to a table of another kind.
            if all.iter().any(|e| e.name == "r" && e.number.is_some()) {
                return None;
            }
            continue;
        };
        let name = equation.name.as_str();
        // Coefficients of an asphere are not gaps.
        if matches!(name, "k" | "κ") || line.to_lowercase().contains("asph") || line.contains("非球面") {
            break;
        }
        let Some(number) = equation.number else { continue };
        let is_next_gap = number as usize == gaps.iter().filter(|(letter, ..)| letter == name).count() + 1;
        let is_radius = name == "r" && (value(&equation.value).is_some() || is_plane(&equation.value));
        if is_radius && number as usize == rows.len() + 1 && gaps.is_empty() && rows.len() < MAX_ITEMS {
            let mut row = PatentRow { line: at, number: Some(number), ..PatentRow::default() };
            let radius = if is_plane(&equation.value) { "inf" } else { &equation.value };
            row.cells.insert("radius", radius.to_owned());
            rows.push(row);
        } else if matches!(name, "d" | "t" | "l" | "s" | "a" | "e")
            && rows.len() >= 3
            && gaps.len() < rows.len()
            && !is_back_focus(line)
            && value(&equation.value).is_some()
        {
            if !is_next_gap {
                break;
            }
            gaps.push((name.to_owned(), equation.value.clone(), at));
        } else if is_radius && !gaps.is_empty() {
            return None;
        }
    }
    // The last gap is that to the film, which may be printed elsewhere.
    if rows.len() < 3 || gaps.len() + 1 < rows.len() {
        return None;
    }
    let end = gaps.last()?.2 + 1;
    let glasses = glasses(&lines[end..]);
    // If two letters are used, that of the first gap stands for glass, since light meets a lens first.
    let glass = gaps[0].0.clone();
    let has_air = gaps.iter().any(|(letter, ..)| *letter != glass);
    let lenses = gaps.iter().filter(|(letter, ..)| *letter == glass).count();
    let mut notes = Vec::new();
    if has_air && !glasses.is_empty() && glasses.len() != lenses {
        let text = format!(
            "the list of glasses has {} entries, the list of thicknesses {lenses}: find the lens without a glass",
            glasses.len()
        );
        notes.push((end + 1, true, text));
    }
    let mut next = glasses.into_iter();
    for (row, (letter, thickness, _)) in rows.iter_mut().zip(gaps) {
        row.cells.insert("thickness", thickness);
        if has_air
            && letter == glass
            && let Some([nd, vd]) = next.next()
        {
            row.cells.insert("nd", nd);
            row.cells.insert("vd", vd);
        }
    }
    let head = rows.first()?.line.saturating_sub(1);
    Some(FoundRows { head, rows, end, notes, is_needed: true, is_line_e: false })
}

/// Reads the index and Abbe number of each lens, `L1 1.6227 56.9`, in order.
fn glasses(lines: &[&str]) -> Vec<[String; 2]> {
    let mut found = Vec::new();
    for line in lines {
        let words: Vec<&str> = line.split_whitespace().collect();
        let [name, index, abbe] = words[..] else { continue };
        let number = name.trim_start_matches(['L', 'l', '(']).trim_end_matches([')', '.', ':']);
        let of = |word: &str, range: std::ops::Range<f64>| value(word).is_some_and(|n| range.contains(&n));
        if number.parse() == Ok(found.len() + 1) && of(index, 1.3..2.3) && of(abbe, 15.0..100.0) {
            found.push([index, abbe].map(|word| word.replacen(',', ".", 1)));
        }
    }
    found
}
