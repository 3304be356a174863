//! Display of faults for people and for programs.
//!
//! [`render`] shows each fault with its place, the lines around it, a label at the exact token and the hint; [`to_json`] gives
//! the same facts as data.

use miette::{
    Diagnostic, GraphicalReportHandler, GraphicalTheme, LabeledSpan, MietteError, MietteSpanContents, SourceCode,
    SourceSpan, SpanContents,
};
use serde_json::{Value, json};
use spectra_core::params::{Fault, Faults, SourceFile, Span, Warning};
use std::fmt;

/// Width that messages are wrapped to, columns.
const WIDTH: usize = 100;
/// Largest number of characters shown of a line.
const SHOWN: usize = 160;
/// Characters shown before the label if the line is longer than that.
const BEFORE: usize = 60;
/// Largest distance from a place, bytes, that is searched for the ends of its lines.
const REACH: usize = 4096;

/// Formats all faults as text for a terminal, with or without color. Each fault states `file:line:column` on the line above its
/// snippet.
#[must_use]
pub fn render(faults: &Faults, color: bool) -> String {
    let theme = if color { GraphicalTheme::unicode() } else { GraphicalTheme::unicode_nocolor() };
    let handler = GraphicalReportHandler::new_themed(theme)
        .with_width(WIDTH)
        .with_links(false)
        // The header is our own, because places on the command line have no line and column.
        .without_primary_span_start();
    let mut out = String::new();
    for (i, fault) in faults.iter().enumerate() {
        if i > 0 {
            out.push('\n');
        }
        let report = Report::of(fault);
        if handler.render_report(&mut out, &report).is_err() {
            // If rendering fails, the plain line is shown.
            out.push_str(&fault.to_string());
            out.push('\n');
        }
    }
    out
}

/// Returns all faults as a JSON array of objects with `file`, `line`, `column`, `path`, `message` and `hint`. Missing values are
/// null.
#[must_use]
pub fn to_json(faults: &Faults) -> Value {
    Value::Array(faults.iter().map(one_to_json).collect())
}

/// Returns warnings in the form of [`to_json`].
#[must_use]
pub fn warnings_to_json(warnings: &[Warning]) -> Value {
    Value::Array(warnings.iter().map(warning_to_json).collect())
}

/// Returns one warning as an object in the form of [`to_json`].
#[must_use]
pub fn warning_to_json(warning: &Warning) -> Value {
    one_to_json(&warning.0)
}

fn one_to_json(fault: &Fault) -> Value {
    let (file, span) = fault.place.as_ref().map(|(file, span)| (file, span)).unzip();
    json!({
        "file": file.map(|file| file.name.as_str()),
        "line": span.map(|span| span.line),
        "column": span.map(|span| span.column),
        "path": (!fault.path.is_empty()).then_some(fault.path.as_str()),
        "message": fault.message,
        "hint": fault.hint,
    })
}

/// A fault in the form that the renderer needs.
#[derive(Debug)]
struct Report<'a> {
    fault: &'a Fault,
    snippet: Option<Snippet>,
}

impl<'a> Report<'a> {
    fn of(fault: &'a Fault) -> Self {
        let snippet =
            fault.place.as_ref().map(|(file, span)| Snippet::of(file, *span, fault.place_text().unwrap_or_default()));
        Self { fault, snippet }
    }
}

impl fmt::Display for Report<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.fault.message)
    }
}

impl std::error::Error for Report<'_> {}

impl Diagnostic for Report<'_> {
    fn help<'a>(&'a self) -> Option<Box<dyn fmt::Display + 'a>> {
        self.fault.hint.as_ref().map(|hint| Box::new(hint) as Box<dyn fmt::Display>)
    }

    fn source_code(&self) -> Option<&dyn SourceCode> {
        self.snippet.as_ref().map(|snippet| snippet as &dyn SourceCode)
    }

    fn labels(&self) -> Option<Box<dyn Iterator<Item = LabeledSpan> + '_>> {
        let snippet = self.snippet.as_ref()?;
        let text = if self.fault.path.is_empty() { "here" } else { &self.fault.path };
        Some(Box::new(std::iter::once(LabeledSpan::new(Some(text.to_owned()), snippet.label.0, snippet.label.1))))
    }
}

/// The line of a place with its neighbors, cut to a window of columns and without control characters.
#[derive(Debug)]
struct Snippet {
    name: String,
    text: String,
    /// Number of the first line of the snippet, from 0.
    line: usize,
    lines: usize,
    /// Offset and length of the label in `text`, in bytes.
    label: (usize, usize),
}

impl Snippet {
    fn of(file: &SourceFile, span: Span, name: String) -> Self {
        let text = &file.text;
        let at = floor_boundary(text, span.offset);
        let start = line_start(text, at);
        let end = line_end(text, at);
        // The column counts from the true start of the line, which may be beyond the searched range.
        let column = text[start..at].chars().count();
        let first = column.saturating_sub(if text[start..end].chars().count() > SHOWN { BEFORE } else { column });
        let mut snippet =
            Self { name, text: String::new(), line: span.line.saturating_sub(1), lines: 0, label: (0, 0) };
        if start > 0 && span.line > 1 && text.as_bytes().get(start - 1) == Some(&b'\n') {
            snippet.line -= 1;
            snippet.push(&text[line_start(text, start - 1)..start - 1], first);
        }
        let offset = snippet.text.len();
        snippet.push(&text[start..end], first);
        let shown = &snippet.text[offset..];
        let byte_of = |character: usize| {
            shown.char_indices().nth(character).map_or(shown.trim_end_matches('\n').len(), |(at, _)| at)
        };
        let label = text.get(at..floor_boundary(text, at + span.len)).unwrap_or("");
        let length = label.lines().next().unwrap_or("").chars().count();
        let (from, to) = (byte_of(column - first), byte_of(column - first + length));
        snippet.label = (offset + from, to - from);
        if text.as_bytes().get(end) == Some(&b'\n') && end + 1 < text.len() {
            snippet.push(&text[end + 1..line_end(text, end + 1)], first);
        }
        snippet
    }

    fn push(&mut self, line: &str, first: usize) {
        for c in line.trim_end_matches('\r').chars().skip(first).take(SHOWN) {
            self.text.push(match c {
                '\t' => ' ',
                c if c.is_control() => '\u{fffd}',
                c => c,
            });
        }
        self.text.push('\n');
        self.lines += 1;
    }
}

/// Returns the last character boundary at or before `offset`.
fn floor_boundary(text: &str, offset: usize) -> usize {
    let mut at = offset.min(text.len());
    while !text.is_char_boundary(at) {
        at -= 1;
    }
    at
}

fn line_start(text: &str, at: usize) -> usize {
    let reach = floor_boundary(text, at.saturating_sub(REACH));
    text[reach..at].rfind('\n').map_or(reach, |newline| reach + newline + 1)
}

fn line_end(text: &str, at: usize) -> usize {
    let reach = floor_boundary(text, at + REACH);
    text[at..reach].find('\n').map_or(reach, |newline| at + newline)
}

impl SourceCode for Snippet {
    fn read_span<'a>(
        &'a self,
        _span: &SourceSpan,
        _before: usize,
        _after: usize,
    ) -> Result<Box<dyn SpanContents<'a> + 'a>, MietteError> {
        let all = SourceSpan::from((0, self.text.len()));
        let contents =
            MietteSpanContents::new_named(self.name.clone(), self.text.as_bytes(), all, self.line, 0, self.lines);
        Ok(Box::new(contents))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::yaml::{parse, parse_override};
    use spectra_core::params::Length;
    use std::collections::BTreeMap;

    fn faults(text: &str) -> Faults {
        let typed =
            parse(SourceFile::new("scene.yaml", text)).and_then(|node| node.parse::<BTreeMap<String, Length>>());
        typed.expect_err(text)
    }

    #[test]
    fn each_fault_is_shown_with_place_snippet_label_and_hint() {
        let shown = render(&faults("name: 1\nfocus: 2 s   # far\nradius: \u{e9}\n"), false);
        let expected = "  \u{d7} found a time, expected a length such as 50 mm
   \u{256d}\u{2500}[scene.yaml:2:8]
 1 \u{2502} name: 1
 2 \u{2502} focus: 2 s   # far
   \u{b7}        \u{2500}\u{252c}\u{2500}
   \u{b7}         \u{2570}\u{2500}\u{2500} focus
 3 \u{2502} radius: \u{e9}
   \u{2570}\u{2500}\u{2500}\u{2500}\u{2500}
  help: units: nm, um, mm, cm, m, km, in, ft; a bare number is in mm

  \u{d7} found the text `\u{e9}`, expected a length such as 50 mm
   \u{256d}\u{2500}[scene.yaml:3:9]
 2 \u{2502} focus: 2 s   # far
 3 \u{2502} radius: \u{e9}
   \u{b7}         \u{252c}
   \u{b7}         \u{2570}\u{2500}\u{2500} radius
   \u{2570}\u{2500}\u{2500}\u{2500}\u{2500}
  help: write a number with its unit, as in `50 mm`
";
        assert_eq!(shown, expected);
    }

    #[test]
    fn color_adds_nothing_but_color() {
        let faults = faults("focus: 2 s\n");
        let colored = render(&faults, true);
        assert!(colored.contains("\u{1b}["));
        let mut plain = String::new();
        let mut rest = colored.as_str();
        while let Some(start) = rest.find("\u{1b}[") {
            plain.push_str(&rest[..start]);
            let code = &rest[start..];
            rest = &code[code.find('m').unwrap() + 1..];
        }
        plain.push_str(rest);
        assert_eq!(plain, render(&faults, false));
    }

    #[test]
    fn long_lines_are_cut_around_the_label() {
        let text = format!("{{a: 1, focus: 2 s, {}}}", "x".repeat(1000));
        let long = format!("a: 1\n{{{}}}", "z".repeat(200_000));
        for text in [text, long, format!("focus: {}", "\u{e9}".repeat(500_000))] {
            let shown = render(&faults(&text), false);
            assert!(shown.len() < 4000, "{}", shown.len());
            assert!(shown.contains("[scene.yaml:"), "{shown}");
        }
        // The label stands below the token, wherever the line is cut.
        let far = format!("{{{}focus: 2 s}}", (0..2000).map(|i| format!("k{i}: 1, ")).collect::<String>());
        let shown = render(&faults(&far), false);
        let lines: Vec<&str> = shown.lines().collect();
        let column = |line: &str, what: char| line.chars().position(|c| c == what).unwrap();
        let token = lines[2].split("focus: ").next().unwrap().chars().count() + "focus: ".len();
        assert_eq!(column(lines[3], '\u{2500}'), token, "{shown}");
    }

    #[test]
    fn control_characters_do_not_reach_the_terminal() {
        let shown = render(&faults("focus: \"\\e[31m\"  # \u{7f}\n"), false);
        assert!(!shown.chars().any(|c| c.is_control() && c != '\n'), "{shown:?}");
    }

    #[test]
    fn faults_without_a_file_are_shown() {
        let mut all = Faults::from(Fault::new("no such file `x`").hint("near: y"));
        all.extend(parse_override("focus=[1").unwrap_err());
        let shown = render(&all, false);
        assert!(shown.starts_with("  \u{d7} no such file `x`\n  help: near: y\n"), "{shown}");
        assert!(shown.contains("\u{256d}\u{2500}[--set focus=[1]\n"), "{shown}");
    }

    #[test]
    fn json_has_the_same_facts() {
        let mut all = faults("focus: 2 s\n");
        all.push(Fault::new("no such file"));
        let expected = json!([
            {
                "file": "scene.yaml", "line": 1, "column": 8, "path": "focus",
                "message": "found a time, expected a length such as 50 mm",
                "hint": "units: nm, um, mm, cm, m, km, in, ft; a bare number is in mm",
            },
            {"file": null, "line": null, "column": null, "path": null, "message": "no such file", "hint": null},
        ]);
        assert_eq!(to_json(&all), expected);
    }

    /// A broken text gives a readable message, and the same number of faults as data.
    #[test]
    fn hostile_texts_are_shown() {
        for text in
            ["a: [", "\t- x", "{a: 1, a: 2}", "? \u{feff}", "a: \"\\x", "&a [*a]", "%YAML 9", "a: !t 1", "\u{1}: \u{2}"]
        {
            if let Err(faults) = crate::yaml::parse(spectra_core::params::SourceFile::new("x.yaml", text)) {
                assert!(!render(&faults, true).is_empty(), "{text:?}");
                assert_eq!(to_json(&faults).as_array().map_or(0, Vec::len), faults.len(), "{text:?}");
            }
        }
    }
}
