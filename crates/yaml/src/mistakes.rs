//! Finds the mistake that causes an error of the parser. The parser often fails at a place after the mistake itself.

use super::behind;
use super::syntax;
use serde_saphyr::granit_parser::ErrorKind;
use spectra_core::params::{SourceFile, Span};

/// A mistake in a file, with message and hint.
pub(super) struct Mistake {
    pub place: Span,
    pub message: String,
    pub hint: Option<String>,
}

/// Returns the mistake that causes an error at `place`; `open` is the outermost bracket that is open there.
pub(super) fn find_mistake(kind: &ErrorKind, file: &SourceFile, place: Span, open: Option<Span>) -> Mistake {
    let lines = Lines::around(&file.text, place);
    if syntax::is_tab(kind) {
        let (message, hint) = syntax::message(kind, "");
        let place = lines.first_tab().unwrap_or_else(|| lines.tab_behind(place));
        return Mistake { place, message, hint: hint.map(str::to_owned) };
    }
    never_closed(file, &lines, place, open)
        .or_else(|| no_space(kind, &lines, place))
        .or_else(|| no_comma(kind, &lines))
        .or_else(|| uneven(kind, &lines))
        .unwrap_or_else(|| {
            let (message, hint) = syntax::message(kind, &lines.line[..lines.at]);
            Mistake { place, message, hint: hint.map(str::to_owned) }
        })
}

/// Detects a bracket that should have been closed above: the line of the error is indented no deeper than the line of the bracket.
fn never_closed(file: &SourceFile, lines: &Lines<'_>, place: Span, open: Option<Span>) -> Option<Mistake> {
    let open = open.filter(|open| open.line < place.line)?;
    let indent = |line: &str| line.len() - line.trim_start_matches(' ').len();
    let of_open = Lines::around(&file.text, open);
    if lines.line.trim().is_empty() || indent(lines.line) > indent(of_open.line) {
        return None;
    }
    let (bracket, closing) = if file.text[open.offset..].starts_with('{') { ('{', '}') } else { ('[', ']') };
    Some(Mistake {
        place: Span { len: 1, ..open },
        message: format!("`{bracket}` is never closed"),
        hint: Some(format!("add `{closing}` after its last entry; the next key starts on line {}", place.line)),
    })
}

/// Detects a missing space after the colon: `key:value`.
fn no_space(kind: &ErrorKind, lines: &Lines<'_>, place: Span) -> Option<Mistake> {
    if !matches!(kind, ErrorKind::SimpleKeyExpected | ErrorKind::InvalidSimpleKey) {
        return None;
    }
    let text = lines.line[lines.at..].trim_end();
    let (key, value) = text.split_once(':')?;
    let is_slip = !key.is_empty() && !key.contains(' ') && !value.is_empty() && !value.starts_with([' ', '/']);
    is_slip.then(|| Mistake {
        place: Span { len: text.len(), ..place },
        message: "`:` without a space after it".to_owned(),
        hint: Some(format!("write `{}: {}`", short(key), short(value))),
    })
}

/// Detects a missing comma between two pairs: `{a: 1 b: 2}`.
fn no_comma(kind: &ErrorKind, lines: &Lines<'_>) -> Option<Mistake> {
    let before = &lines.line[..lines.at];
    if !matches!(kind, ErrorKind::ExpectedFlowMappingSeparator) || !lines.line[lines.at..].starts_with(':') {
        return None;
    }
    let key = before.rsplit([' ', ',', '{']).next().filter(|key| !key.is_empty())?;
    let place = behind(lines.start, &before[..before.len() - key.len()]);
    Some(Mistake {
        place: Span { len: key.len(), ..place },
        message: format!("expected `,` or `}}` before `{}`", short(key)),
        hint: Some("separate `key: value` pairs with commas".to_owned()),
    })
}

/// Detects a key that is read as a continuation of the text above it, because it is indented deeper or the line above lacks its colon.
fn uneven(kind: &ErrorKind, lines: &Lines<'_>) -> Option<Mistake> {
    let is_colon = matches!(kind, ErrorKind::MappingValueNotAllowed | ErrorKind::InvalidColonPlacement);
    let before = &lines.line[..lines.at];
    let (above, above_place) = lines.above?;
    if !is_colon || before.contains(": ") || before.trim().is_empty() {
        return None;
    }
    let indent = |line: &str| line.len() - line.trim_start().len();
    if indent(lines.line) > indent(above) {
        let place = behind(lines.start, &before[..indent(before)]);
        return Some(Mistake {
            place: Span { len: before.trim().len(), ..place },
            message: "this line is indented deeper than the one above it".to_owned(),
            hint: Some(format!(
                "keys of one map start in the same column: this one in column {}, the one above in column {}",
                place.column,
                indent(above) + 1
            )),
        });
    }
    if above.contains(": ") || above.trim_end().ends_with(':') {
        return None;
    }
    let place = behind(above_place, &above[..indent(above)]);
    if let Some((key, value)) = above.trim().split_once(':').filter(|(key, _)| !key.contains(' ')) {
        return Some(Mistake {
            place: Span { len: above.trim().len(), ..place },
            message: "`:` without a space after it".to_owned(),
            hint: Some(format!("write `{}: {}`", short(key), short(value))),
        });
    }
    Some(Mistake {
        place: Span { len: above.trim().len(), ..place },
        message: "a key without its `:`".to_owned(),
        hint: Some("write `key: value`".to_owned()),
    })
}

/// Returns the first 40 characters of a text, for a message.
fn short(text: &str) -> String {
    text.chars().take(40).filter(|c| !c.is_control()).collect()
}

/// The line of a place, and the nearest line with content above it.
struct Lines<'a> {
    text: &'a str,
    line: &'a str,
    /// Place where the line starts.
    start: Span,
    /// Number of bytes of the line before the place.
    at: usize,
    /// Nearest line above that is neither empty nor a comment, with the place where it starts.
    above: Option<(&'a str, Span)>,
}

impl<'a> Lines<'a> {
    fn around(text: &'a str, place: Span) -> Self {
        let ends = ['\n', '\r'];
        let start = text[..place.offset].rfind(ends).map_or(0, |newline| newline + 1);
        let end = text[place.offset..].find(ends).map_or(text.len(), |newline| place.offset + newline);
        let line = &text[start..end];
        let mut above = None;
        let (mut upper, mut number) = (start, place.line);
        // Enough lines for any comment between two keys.
        for _ in 0..100 {
            let Some(last) = upper.checked_sub(1) else { break };
            let last = if text[..upper].ends_with("\r\n") { last - 1 } else { last };
            upper = text[..last].rfind(ends).map_or(0, |newline| newline + 1);
            number = number.saturating_sub(1);
            let candidate = &text[upper..last];
            if !candidate.trim().is_empty() && !candidate.trim_start().starts_with('#') {
                above = Some((candidate, Span { line: number, column: 1, offset: upper, len: 0 }));
                break;
            }
        }
        let at = (place.offset - start).min(line.len());
        Self { text, line, start: Span { line: place.line, column: 1, offset: start, len: 0 }, at, above }
    }

    /// Returns the first tab in the block of tab-indented lines that ends with this line.
    fn first_tab(&self) -> Option<Span> {
        let tab = |line: &str| line[..line.len() - line.trim_start_matches([' ', '\t']).len()].find('\t');
        let mut found = None;
        let (mut line, mut start) = (self.line, self.start);
        while let Some(at) = tab(line) {
            found = Some(Span { column: at + 1, offset: start.offset + at, len: 1, ..start });
            let Some(upper) = start.offset.checked_sub(1).filter(|upper| self.text[*upper..].starts_with('\n')) else {
                break;
            };
            let above = self.text[..upper].rfind('\n').map_or(0, |newline| newline + 1);
            line = &self.text[above..upper];
            start = Span { line: start.line.saturating_sub(1), offset: above, ..start };
        }
        found
    }

    /// Returns the place of the first tab at or after a place, or the place itself if there is none.
    fn tab_behind(&self, place: Span) -> Span {
        let rest = &self.text[place.offset..];
        rest.find('\t').map_or(place, |tab| Span { len: 1, ..behind(place, &rest[..tab]) })
    }
}
