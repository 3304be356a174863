//! Positions in a text file, for error messages.

use spectra_core::params::{Fault, SourceFile, Span};
use std::sync::Arc;

/// A text file whose parts can be located in error messages.
#[derive(Clone, Debug)]
pub(crate) struct Source {
    file: Arc<SourceFile>,
}

impl Source {
    pub(crate) fn new(name: &str, text: &str) -> Self {
        Self { file: Arc::new(SourceFile::new(name, text)) }
    }

    /// Text of the file.
    pub(crate) fn text(&self) -> &str {
        &self.file.text
    }

    /// Creates a fault at a word of the text, which must be a slice of [`Source::text`].
    pub(crate) fn fault(&self, word: &str, message: impl Into<String>) -> Fault {
        Fault::new(message).at(Arc::clone(&self.file), Span::of(word, self.text()))
    }

    /// Creates a fault that concerns the whole file.
    pub(crate) fn fault_here(&self, message: impl Into<String>) -> Fault {
        Fault::new(message).at(Arc::clone(&self.file), Span::default())
    }
}

/// Shortens a user's text to one line of bounded length, for a note.
pub(crate) fn shortened(text: &str) -> String {
    /// Largest number of characters that are repeated.
    const LONGEST: usize = 80;
    let mut out: String = text.trim().chars().take(LONGEST).map(|c| if c.is_control() { ' ' } else { c }).collect();
    if text.trim().chars().nth(LONGEST).is_some() {
        out.push_str("...");
    }
    out
}
