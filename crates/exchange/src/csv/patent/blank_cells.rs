//! Splits rows whose columns are separated by blanks, where cells may be empty.

use super::head::Head;
use super::value;
use super::vocabulary::{is_end, is_plane, is_stop};
use crate::csv::columns::Column;
use std::iter::Peekable;

type Cell = (Column, String);
type Words = Peekable<std::vec::IntoIter<String>>;

/// Splits a row. Surface, type, radius and thickness come first. The index and the Abbe number of a glass follow in the order of the
/// headings, then a diameter. Words that are not a glass come last.
pub(super) fn cells_by_rule(line: &str, head: &Head) -> Vec<Cell> {
    let (words, is_marked) = joined_words(line);
    let mut words = words.into_iter().peekable();
    let mut cells = Vec::new();
    if head.has(Column::Number) {
        cells.extend(surface_mark(&mut words, is_marked).map(|mark| (Column::Number, mark)));
        if !head.has(Column::Kind) {
            cells.extend(surface_name(&mut words).map(|name| (Column::Comment, name)));
        }
    }
    if head.has(Column::Kind) {
        cells.extend(words.next_if(|word| is_word(word)).map(|kind| (Column::Kind, kind)));
    }
    cells.extend(words.next().map(|radius| (Column::Radius, radius)));
    // Treat a dash as an empty cell.
    cells.extend(words.next().filter(|gap| gap != "-").map(|gap| (Column::Thickness, gap)));
    add_glass_and_size(&mut cells, words.filter(|word| word != "-").collect(), head);
    // Keep the first of two cells of a column.
    let mut seen = Vec::new();
    cells.retain(|(column, _)| {
        let is_first = !seen.contains(column);
        seen.push(*column);
        is_first
    });
    cells
}

/// Returns the words of a row with split numbers joined, and whether the mark of an asphere was removed.
fn joined_words(line: &str) -> (Vec<String>, bool) {
    let mut words: Vec<String> = Vec::new();
    let mut is_marked = false;
    for word in line.split_whitespace() {
        let count = words.len();
        match words.last_mut() {
            // Join a sign that stands alone with the number after it.
            Some(last)
                if (last == "-" || last == "+") && word.starts_with(|c: char| c.is_ascii_digit() || c == '.')
                    || count > 1 && is_broken(last, word) =>
            {
                last.push_str(word);
            }
            // Remove the mark of an asphere after its radius.
            Some(_)
                if count > 1 && ["(asp)", "(asph)", "asp", "(aspheric)"].contains(&word.to_lowercase().as_str()) =>
            {
                is_marked = true;
            }
            _ => words.push(word.to_owned()),
        }
    }
    (words, is_marked)
}

/// Takes the number of a surface with the words that mark it as the stop, an asphere, the object or the image.
fn surface_mark(words: &mut Words, is_marked: bool) -> Option<String> {
    let mut first = words.next()?;
    let is_end = is_end(&first);
    let belongs = |next: &String| {
        let bare: String = next.to_lowercase().chars().filter(|c| c.is_alphabetic()).collect();
        next == "*"
            || is_stop(&bare)
            || bare.starts_with("asp")
            || is_end && ["plane", "surface"].contains(&bare.as_str())
    };
    while let Some(next) = words.next_if(belongs) {
        first.push(' ');
        first.push_str(&next);
    }
    if is_marked {
        first.push('*');
    }
    Some(first)
}

/// Takes words such as `Lens 1`, `Ape. Stop`, `IR-cut filter` between number and radius, in a column without a heading.
fn surface_name(words: &mut Words) -> Option<String> {
    /// Largest number after `Lens` that is read as the number of the lens instead of a radius.
    const MOST_LENSES: u8 = 20;
    let mut name = String::new();
    while let Some(word) = words.next_if(|word| is_word(word) && !is_plane(word)) {
        name = format!("{name} {word}").trim().to_owned();
        // Skip the number of the lens, since no lens has more than a few elements.
        if word.to_lowercase().starts_with("lens") {
            words.next_if(|next| next.parse::<u8>().is_ok_and(|number| number <= MOST_LENSES));
        }
    }
    (!name.is_empty()).then_some(name)
}

/// Adds what follows the thickness: the glass, its figures, a size, and the rest as a remark.
fn add_glass_and_size(cells: &mut Vec<Cell>, mut rest: Vec<String>, head: &Head) {
    // Remove the mark of a solve.
    if rest.first().is_some_and(|word| word.len() == 3 && word.starts_with('(') && word.ends_with(')')) {
        rest.remove(0);
    }
    // Remove a word for the kind of medium, which is not a glass.
    if rest.first().is_some_and(|word| ["plastic", "glass"].contains(&word.to_lowercase().as_str())) {
        rest.remove(0);
    }
    if head.has(Column::Glass)
        && rest.first().is_some_and(|word| is_word(word))
        && rest.get(1).is_some_and(|word| value(word).is_some())
    {
        cells.push((Column::Glass, rest.remove(0)));
    }
    let figures: Vec<String> = rest.iter().take_while(|word| value(word).is_some()).cloned().collect();
    let remark = rest[figures.len()..].join(" ");
    let has_size = head.has(Column::Diameter) || head.has(Column::SemiDiameter);
    let used = add_index(cells, &figures, head, has_size);
    // Skip partial dispersions before a diameter: they are below 1, and a diameter is not.
    let least = if head.has(Column::Unused) { 1.0 } else { 0.0 };
    if has_size && let Some(size) = (used..figures.len()).find(|i| figure_at(&figures, *i) >= least) {
        let column = if head.has(Column::Diameter) { Column::Diameter } else { Column::SemiDiameter };
        cells.push((column, figures[size].clone()));
    }
    if !remark.is_empty() {
        // Read the rest as a glass name in the last column, or as a comment.
        let is_glass = head.has(Column::Glass) && !head.has(Column::Comment) && used == 2;
        cells.push((if is_glass { Column::Glass } else { Column::Comment }, remark));
    }
}

/// Adds the index and the Abbe number if these figures start with them, and returns how many figures they are.
fn add_index(cells: &mut Vec<Cell>, figures: &[String], head: &Head, has_size: bool) -> usize {
    let at = |i: usize| figure_at(figures, i);
    let is_index = |n: f64| (1.2..3.0).contains(&n);
    let is_lone_index = figures.len() == 1 && (is_index(at(0)) || at(0) == 1.0) && !has_size;
    let has_abbe = head.has(Column::Abbe);
    if has_abbe && (is_index(at(0)) && at(1) > 10.0 || is_index(at(1)) && at(0) > 10.0) {
        let abbe_first = head.place(Column::Abbe) < head.place(Column::Index);
        let (index, abbe) = if is_index(at(0)) && !(abbe_first && is_index(at(1))) { (0, 1) } else { (1, 0) };
        cells.push((Column::Index, figures[index].clone()));
        cells.push((Column::Abbe, figures[abbe].clone()));
        2
    } else if is_lone_index || !has_abbe && is_index(at(0)) && figures.len() > 1 {
        cells.push((Column::Index, figures[0].clone()));
        1
    } else {
        // Skip the index of air.
        usize::from(at(0) == 1.0 && figures.len() > 1)
    }
}

/// Returns a figure as a number, or 0 if there are fewer figures.
fn figure_at(figures: &[String], i: usize) -> f64 {
    figures.get(i).and_then(|word| value(word)).unwrap_or(0.0)
}

/// Whether this is a word instead of a number.
fn is_word(word: &str) -> bool {
    word.chars().next().is_some_and(char::is_alphabetic) && value(word).is_none()
}

/// Whether two words are one number, with at least three decimals, that text recognition has split at its point: `1. 84666`, `82 .788`.
fn is_broken(first: &str, second: &str) -> bool {
    const DECIMALS: usize = 3;
    let is_whole = |text: &str| {
        let digits = text.trim_start_matches(['-', '+']);
        !digits.is_empty() && digits.chars().all(|c| c.is_ascii_digit())
    };
    let is_part = |text: &str| text.len() >= DECIMALS && text.chars().all(|c| c.is_ascii_digit());
    first.strip_suffix('.').is_some_and(is_whole) && is_part(second)
        || is_whole(first) && second.strip_prefix('.').is_some_and(is_part)
}

/// Returns the numbers of a row that [`cells_by_rule`] joins again, for a note about them.
pub(super) fn broken(line: &str) -> Vec<String> {
    let words: Vec<&str> = line.split_whitespace().skip(1).collect();
    words.windows(2).filter(|pair| is_broken(pair[0], pair[1])).map(|pair| pair.join(" ")).collect()
}
