//! Faults in a user's files.

use super::place::{SourceFile, Span};
use std::fmt;
use std::sync::Arc;

/// One fault: what was found and expected, where, and what to write instead.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Fault {
    /// Message that says what is wrong, on one line.
    pub message: String,
    /// Place of the fault; `None` if it has no place in a file, such as the fault of a missing file.
    pub place: Option<(Arc<SourceFile>, Span)>,
    /// Path of the key that is at fault, such as `source.color.R` or `surfaces[3].radius`; may be empty.
    pub path: String,
    /// Hint: what to write instead, or what to do.
    pub hint: Option<String>,
}

impl Fault {
    /// Creates a fault without a place.
    #[must_use]
    pub fn new(message: impl Into<String>) -> Self {
        Self { message: message.into(), place: None, path: String::new(), hint: None }
    }

    /// Adds a hint to the fault.
    #[must_use]
    pub fn hint(self, hint: impl Into<String>) -> Self {
        Self { hint: Some(hint.into()), ..self }
    }

    /// Places the fault in a file.
    #[must_use]
    pub fn at(self, file: Arc<SourceFile>, span: Span) -> Self {
        Self { place: Some((file, span)), ..self }
    }

    /// Sets the path of the key.
    #[must_use]
    pub fn path(self, path: impl Into<String>) -> Self {
        Self { path: path.into(), ..self }
    }

    /// Narrows the fault to a part of `text`, the text at the place of the fault: `len` characters from character `at` (from 0).
    /// If `text` cannot be found in the file, as on the command line, the message states the number of the character.
    #[must_use]
    pub fn within(mut self, text: &str, at: usize, len: usize) -> Self {
        let offset_of = |character: usize| text.char_indices().nth(character).map_or(text.len(), |(offset, _)| offset);
        let (start, end) = (offset_of(at), offset_of(at.saturating_add(len)));
        if let Some((file, span)) = &mut self.place {
            let covered = file.text.get(span.offset..span.offset.saturating_add(span.len)).unwrap_or("");
            let found = covered.find(text).filter(|found| !covered[..*found].contains('\n') && !text.contains('\n'));
            if let Some(found) = found.filter(|_| !file.is_argument()) {
                let before = covered[..found].chars().count() + at;
                let (offset, len) = (span.offset + found + start, end - start);
                *span = Span { line: span.line, column: span.column + before, offset, len };
                return self;
            }
        }
        if !text.is_empty() {
            let shown: String = text.chars().take(80).collect();
            self.message = format!("{}, at character {} of `{shown}`", self.message, at.min(text.chars().count()) + 1);
        }
        self
    }

    /// Formats the place for display as `file:line:column`, or as the command-line argument; `None` if the fault has no place.
    #[must_use]
    pub fn place_text(&self) -> Option<String> {
        self.place.as_ref().map(|(file, span)| {
            if file.is_argument() { file.name.clone() } else { format!("{}:{}:{}", file.name, span.line, span.column) }
        })
    }
}

impl fmt::Display for Fault {
    /// Writes one line: `file:line:column: message (hint)`.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if let Some(place) = self.place_text() {
            write!(f, "{place}: ")?;
        }
        f.write_str(&self.message)?;
        match &self.hint {
            Some(hint) => write!(f, " ({hint})"),
            None => Ok(()),
        }
    }
}

impl std::error::Error for Fault {}

impl From<String> for Fault {
    fn from(message: String) -> Self {
        Self::new(message)
    }
}

impl From<&str> for Fault {
    fn from(message: &str) -> Self {
        Self::new(message)
    }
}

/// All faults that were found, in order.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Faults(pub Vec<Fault>);

impl Faults {
    /// Creates an empty list of faults.
    #[must_use]
    pub const fn new() -> Self {
        Self(Vec::new())
    }

    /// Adds one fault to the list.
    pub fn push(&mut self, fault: Fault) {
        self.0.push(fault);
    }

    /// Returns whether there are no faults.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// Number of faults in the list.
    #[must_use]
    pub fn len(&self) -> usize {
        self.0.len()
    }

    /// Iterates over the faults in order.
    pub fn iter(&self) -> std::slice::Iter<'_, Fault> {
        self.0.iter()
    }

    /// Returns the value of `result`, if it has one; otherwise adds its faults to this list and returns `None`. The next part can
    /// then be checked, too.
    pub fn take<T>(&mut self, result: Result<T, impl Into<Self>>) -> Option<T> {
        result.map_err(|faults| self.0.extend(faults.into().0)).ok()
    }

    /// Returns the value, if there are no faults.
    ///
    /// # Errors
    /// These faults, if there are any.
    pub fn into_result<T>(self, value: T) -> Result<T, Self> {
        if self.is_empty() { Ok(value) } else { Err(self) }
    }
}

impl From<Fault> for Faults {
    fn from(fault: Fault) -> Self {
        Self(vec![fault])
    }
}

impl From<Vec<Fault>> for Faults {
    fn from(faults: Vec<Fault>) -> Self {
        Self(faults)
    }
}

impl Extend<Fault> for Faults {
    fn extend<I: IntoIterator<Item = Fault>>(&mut self, faults: I) {
        self.0.extend(faults);
    }
}

impl IntoIterator for Faults {
    type Item = Fault;
    type IntoIter = std::vec::IntoIter<Fault>;

    fn into_iter(self) -> Self::IntoIter {
        self.0.into_iter()
    }
}

impl<'a> IntoIterator for &'a Faults {
    type Item = &'a Fault;
    type IntoIter = std::slice::Iter<'a, Fault>;

    fn into_iter(self) -> Self::IntoIter {
        self.iter()
    }
}

impl fmt::Display for Faults {
    /// Writes one line per fault.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (i, fault) in self.0.iter().enumerate() {
            if i > 0 {
                writeln!(f)?;
            }
            write!(f, "{fault}")?;
        }
        Ok(())
    }
}

impl std::error::Error for Faults {}
