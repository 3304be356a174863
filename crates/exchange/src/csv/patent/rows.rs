//! Reads tables with a line of headings, whose columns are separated by tabs, commas, semicolons or blanks.

use super::vocabulary::{figure, is_end, is_other, is_plane, is_stop, is_stop_phrase, is_variable, mark};
use super::{FoundRows, PatentRow, value};
use crate::MAX_ITEMS;
use crate::csv::cells::cells;
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
    fn with_effective(&self, line: &str, next: &str) -> Self {
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

    fn has(&self, column: Column) -> bool {
        self.columns.contains(&Some(column))
    }

    fn place(&self, column: Column) -> Option<usize> {
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
    let columns = &columns.with_effective(lines[head], lines.get(head + 1).copied().unwrap_or_default());
    let mut found =
        FoundRows { head, rows: Vec::new(), end: lines.len(), notes: Vec::new(), is_needed: false, is_line_e: false };
    let mut resumed = head + 1;
    for (at, line) in lines.iter().enumerate().skip(head + 1) {
        let plain = line.trim();
        // Skip lines of a spreadsheet that contain only separators.
        if !plain.contains(char::is_alphanumeric) || plain.starts_with('#') || at < resumed {
            continue;
        }
        let last = found.rows.last().and_then(|row| row.number);
        // Skip the column numbers at the head of a page.
        let page: Vec<u32> = plain.split_whitespace().filter_map(|word| word.parse().ok()).collect();
        if columns.separator.is_none()
            && page.len() == 2
            && page[1] == page[0] + 1
            && plain.split_whitespace().count() == 2
        {
            continue;
        }
        let has_figures = |separator: char| {
            let own = cells(line, separator);
            let of =
                |column| columns.place(column).and_then(|at| own.get(at)).is_some_and(|cell| value(cell).is_some());
            of(Column::Radius) || of(Column::Thickness)
        };
        if is_other(plain) && !columns.separator.is_some_and(has_figures) || found.rows.len() > MAX_ITEMS {
            if let Some(next) = goes_on(lines, at, last, columns).filter(|_| found.rows.len() <= MAX_ITEMS) {
                resumed = next;
                continue;
            }
            found.end = at;
            found.is_needed = true;
            break;
        }
        let cells = match columns.separator {
            Some(separator) => cells(line, separator)
                .into_iter()
                .zip(&columns.columns)
                .filter_map(|(cell, column)| Some(((*column)?, cell.to_owned())))
                .filter(|(_, cell)| !cell.is_empty())
                .collect(),
            None => by_rule(plain, columns),
        };
        let mut row = PatentRow { line: at, ..PatentRow::default() };
        let mut is_row = true;
        for (column, cell) in cells {
            let Some(name) = name_of(column) else { continue };
            match column {
                Column::Number => match mark(&cell) {
                    Some((number, is_stop, is_marked)) => {
                        found.is_needed |= is_marked || is_stop && number.is_some();
                        (row.number, row.is_stop, row.is_marked) = (number, is_stop, is_marked);
                    }
                    // Skip the object, the image, and words about something else.
                    None if is_end(&cell) || columns.separator.is_none() => {
                        found.is_needed |= is_end(&cell);
                        is_row = false;
                    }
                    None => drop(row.cells.insert("comment", cell)),
                },
                Column::Comment => {
                    // Skip the object and the image, named in a column without a heading.
                    is_row &= columns.separator.is_some() || !is_end(&cell);
                    found.is_needed |= is_stop_phrase(&cell) && columns.separator.is_none();
                    row.is_stop |= is_stop_phrase(&cell);
                    row.is_marked |= columns.separator.is_none() && cell.to_lowercase().contains("aspher");
                    row.cells.insert(name, cell);
                }
                Column::Thickness if is_variable(&cell) => {
                    found.is_needed = true;
                    row.cells.insert(name, cell);
                }
                Column::Radius if columns.separator.is_none() && is_plane(&cell) => {
                    row.cells.insert(name, "inf".to_owned());
                }
                _ => {
                    let typed = figure(&cell);
                    found.is_needed |= typed != cell && !cell.contains(',');
                    row.cells.insert(name, typed);
                }
            }
        }
        // Skip a line of words among the rows, which has none of their columns.
        if !is_row || row.cells.is_empty() && row.number.is_none() && !row.is_stop && !plain.contains([',', ';', '\t'])
        {
            found.is_needed |= is_row;
            continue;
        }
        // Stop at a sentence with commas after the rows.
        let has_figures =
            ["radius", "thickness", "nd", "semi-diameter", "diameter"].iter().any(|name| row.cells.contains_key(name));
        if columns.separator.is_some()
            && row.number.is_none()
            && !has_figures
            && !row.is_stop
            && row.cells.contains_key("comment")
        {
            found.is_needed = true;
            found.end = at;
            break;
        }
        // Stop at something else after the rows that has no heading of its own.
        if columns.separator.is_none() && value_of(&row, "radius").is_none() {
            if found.rows.is_empty() {
                continue;
            }
            if let Some(next) = goes_on(lines, at, last, columns) {
                resumed = next;
                continue;
            }
            found.end = at;
            break;
        }
        if columns.separator.is_none() {
            let told = |pair: String| (at, false, format!("`{pair}` is read as one number"));
            found.notes.extend(broken(plain).into_iter().map(told).map(|(at, alters, text)| (at + 1, alters, text)));
        }
        found.rows.push(row);
    }
    // If every row but the last has a size, and the last has one figure near the size of the row before, that figure is its size.
    let size = ["diameter", "semi-diameter"]
        .into_iter()
        .find(|name| found.rows.first().is_some_and(|row| row.cells.contains_key(name)));
    if let (None, Some(size), Some((last, others))) = (columns.separator, size, found.rows.split_last_mut())
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
    found
}

/// Whether a row has a radius: a number, or a word for a plane.
fn value_of(row: &PatentRow, name: &str) -> Option<()> {
    let cell = row.cells.get(name)?;
    (is_plane(cell) || cell.eq_ignore_ascii_case("stop") || value(cell).is_some()).then_some(())
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

/// Returns the numbers of a row that [`by_rule`] joins again, for a note about them.
fn broken(line: &str) -> Vec<String> {
    let words: Vec<&str> = line.split_whitespace().skip(1).collect();
    words.windows(2).filter(|pair| is_broken(pair[0], pair[1])).map(|pair| pair.join(" ")).collect()
}

/// Finds where the rows continue after a page break. Returns the line of the row with the next number, if it is near and nothing else
/// begins before it.
fn goes_on(lines: &[&str], from: usize, last: Option<u32>, columns: &Head) -> Option<usize> {
    /// Largest number of lines that the foot of a page and the head of the next one take.
    const FEW: usize = 14;
    let next = last? + 1;
    if columns.separator.is_some() || !columns.has(Column::Number) {
        return None;
    }
    for (at, line) in lines.iter().enumerate().skip(from).take(FEW) {
        let plain = line.trim().to_lowercase();
        let is_unit = plain.starts_with("unit") && plain.contains("mm");
        if Head::of(line).is_some() || is_other(line) && !plain.contains("continued") && !is_unit {
            return None;
        }
        let cells = by_rule(line.trim(), columns);
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

/// Splits a row whose columns are separated by blanks, where cells may be empty. Surface, type, radius and thickness come first. The index
/// and the Abbe number of a glass follow in the order of the headings, then a diameter. Words that are not a glass come last.
fn by_rule(line: &str, head: &Head) -> Vec<(Column, String)> {
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
    let mut words = words.into_iter().peekable();
    let mut cells = Vec::new();
    if head.has(Column::Number)
        && let Some(mut first) = words.next()
    {
        let is_end = is_end(&first);
        while let Some(next) = words.peek() {
            let bare: String = next.to_lowercase().chars().filter(|c| c.is_alphabetic()).collect();
            if !(next == "*"
                || is_stop(&bare)
                || bare.starts_with("asp")
                || is_end && ["plane", "surface"].contains(&bare.as_str()))
            {
                break;
            }
            first.push(' ');
            first.push_str(&words.next().unwrap_or_default());
        }
        if is_marked {
            first.push('*');
        }
        cells.push((Column::Number, first));
    }
    let is_word = |word: &String| word.chars().next().is_some_and(char::is_alphabetic) && value(word).is_none();
    /// Largest number after `Lens` that is read as the number of the lens instead of a radius.
    const MOST_LENSES: u8 = 20;
    // Read words such as `Lens 1`, `Ape. Stop`, `IR-cut filter` between number and radius, in a column without a heading.
    let mut named = String::new();
    while head.has(Column::Number)
        && !head.has(Column::Kind)
        && words.peek().is_some_and(|word| is_word(word) && !is_plane(word))
    {
        let word = words.next().unwrap_or_default();
        let is_lens = word.to_lowercase().starts_with("lens");
        named = format!("{named} {word}").trim().to_owned();
        // Skip the number of the lens, since no lens has more than a few elements.
        if is_lens && words.peek().is_some_and(|next| next.parse::<u8>().is_ok_and(|number| number <= MOST_LENSES)) {
            words.next();
        }
    }
    if !named.is_empty() {
        cells.push((Column::Comment, named));
    }
    if head.has(Column::Kind)
        && let Some(kind) = words.next_if(is_word)
    {
        cells.push((Column::Kind, kind));
    }
    cells.extend(words.next().map(|radius| (Column::Radius, radius)));
    // Treat a dash as an empty cell.
    cells.extend(words.next().filter(|gap| gap != "-").map(|gap| (Column::Thickness, gap)));
    let mut rest: Vec<String> = words.filter(|word| word != "-").collect();
    // Remove the mark of a solve.
    if rest.first().is_some_and(|word| word.len() == 3 && word.starts_with('(') && word.ends_with(')')) {
        rest.remove(0);
    }
    // Remove a word for the kind of medium, which is not a glass.
    if rest.first().is_some_and(|word| ["plastic", "glass"].contains(&word.to_lowercase().as_str())) {
        rest.remove(0);
    }
    if head.has(Column::Glass)
        && rest.first().is_some_and(is_word)
        && rest.get(1).is_some_and(|word| value(word).is_some())
    {
        cells.push((Column::Glass, rest.remove(0)));
    }
    let figures: Vec<String> = rest.iter().take_while(|word| value(word).is_some()).cloned().collect();
    let remark = rest[figures.len()..].join(" ");
    let at = |i: usize| figures.get(i).and_then(|word| value(word)).unwrap_or(0.0);
    let is_index = |n: f64| (1.2..3.0).contains(&n);
    let mut left = 0;
    let has_size = head.has(Column::Diameter) || head.has(Column::SemiDiameter);
    let is_lone_index = figures.len() == 1 && (is_index(at(0)) || at(0) == 1.0) && !has_size;
    let has_abbe = head.has(Column::Abbe);
    if has_abbe && (is_index(at(0)) && at(1) > 10.0 || is_index(at(1)) && at(0) > 10.0) {
        let abbe_first = head.place(Column::Abbe) < head.place(Column::Index);
        let (index, abbe) = if is_index(at(0)) && !(abbe_first && is_index(at(1))) { (0, 1) } else { (1, 0) };
        cells.push((Column::Index, figures[index].clone()));
        cells.push((Column::Abbe, figures[abbe].clone()));
        left = 2;
    } else if is_lone_index || !has_abbe && is_index(at(0)) && figures.len() > 1 {
        cells.push((Column::Index, figures[0].clone()));
        left = 1;
    } else if at(0) == 1.0 && figures.len() > 1 {
        // Skip the index of air.
        left = 1;
    }
    // Skip partial dispersions before a diameter: they are below 1, and a diameter is not.
    let least = if head.has(Column::Unused) { 1.0 } else { 0.0 };
    if has_size && let Some(size) = (left..figures.len()).find(|i| at(*i) >= least) {
        let column = if head.has(Column::Diameter) { Column::Diameter } else { Column::SemiDiameter };
        cells.push((column, figures[size].clone()));
    }
    if !remark.is_empty() {
        // Read the rest as a glass name in the last column, or as a comment.
        let is_glass = head.has(Column::Glass) && !head.has(Column::Comment) && left == 2;
        cells.push((if is_glass { Column::Glass } else { Column::Comment }, remark));
    }
    // Keep the first of two cells of a column.
    let mut seen = Vec::new();
    cells.retain(|(column, _)| {
        let is_first = !seen.contains(column);
        seen.push(*column);
        is_first
    });
    cells
}
