//! What the events of the parser make, in flat storage.

use spectra_core::params::{Span, Value};

/// What an event made.
pub(super) enum Item {
    /// Neither of the others.
    Scalar(Value),
    /// Indices of its elements.
    Seq(Vec<usize>),
    /// Indices of keys and values.
    Map(Vec<(usize, usize)>),
    /// Index of what it names.
    Alias(usize),
}

/// An item with its place.
pub(super) struct Placed {
    pub item: Item,
    pub span: Span,
}
