//! Places in the texts that values are read from.

use std::fmt;
use std::path::Path;

/// A place in a file.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Span {
    /// Line, from 1.
    pub line: usize,
    /// Column in characters, from 1.
    pub column: usize,
    /// Offset in bytes, from 0.
    pub offset: usize,
    /// Length in bytes; 0 if nothing was written.
    pub len: usize,
}

impl Default for Span {
    /// The start of a file, empty.
    fn default() -> Self {
        Self { line: 1, column: 1, offset: 0, len: 0 }
    }
}

impl Span {
    /// Returns the span of `part`, which must be a slice of `text`; otherwise the span is the start of the file. A byte order
    /// mark does not count as a character.
    #[must_use]
    pub fn of(part: &str, text: &str) -> Self {
        let offset = (part.as_ptr() as usize).wrapping_sub(text.as_ptr() as usize);
        match text.get(..offset) {
            Some(before) if offset + part.len() <= text.len() => {
                let before = before.strip_prefix('\u{feff}').unwrap_or(before);
                let line = 1 + before.matches('\n').count();
                let column = 1 + before.rsplit('\n').next().unwrap_or("").chars().count();
                Self { line, column, offset, len: part.len() }
            }
            _ => Self::default(),
        }
    }

    /// Returns the part of the span on its first line; messages point there if a value spans several lines.
    #[must_use]
    pub fn first_line(self, text: &str) -> Self {
        let covered = text.get(self.offset..).unwrap_or("");
        let end = covered.find(['\n', '\r']).unwrap_or(covered.len());
        let line = covered[..end].trim_end();
        Self { len: self.len.min(line.len()), ..self }
    }
}

/// A text that values were read from: a file or an argument.
#[derive(Clone, PartialEq, Eq)]
pub struct SourceFile {
    /// Name in messages: a path, `bundled:...`, or the argument `--set path=value`.
    pub name: String,
    /// Content of the file or argument.
    pub text: String,
}

impl SourceFile {
    /// Creates a text that is named in messages.
    #[must_use]
    pub fn new(name: impl Into<String>, text: impl Into<String>) -> Self {
        Self { name: name.into(), text: text.into() }
    }

    /// Returns whether this text is an argument of the command line instead of a file; messages then give no line and column.
    #[must_use]
    pub fn is_argument(&self) -> bool {
        self.name.starts_with("--")
    }

    /// Folder that relative paths in the text start from: empty (the working folder) for an argument, `None` for a text without
    /// a folder on disk.
    #[must_use]
    pub fn folder(&self) -> Option<&Path> {
        if self.is_argument() {
            Some(Path::new(""))
        } else if self.name.starts_with("bundled:") {
            None
        } else {
            Path::new(&self.name).parent()
        }
    }
}

impl fmt::Debug for SourceFile {
    /// Prints the name only, because every node refers to its file.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "SourceFile({})", self.name)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_slice_has_its_line_and_column() {
        let text = "\u{feff}a,\u{e9},b\nc,d";
        let span = |part: &str| Span::of(part, text);
        assert_eq!(span(&text[8..9]), Span { line: 1, column: 5, offset: 8, len: 1 });
        assert_eq!(span(&text[12..]), Span { line: 2, column: 3, offset: 12, len: 1 });
        assert_eq!(span(&text[text.len()..]), Span { line: 2, column: 4, offset: 13, len: 0 });
        assert_eq!(span("elsewhere"), Span::default());
    }
}
