//! Items that the parser's events create, in flat storage.

use spectra_core::params::{Span, Value};

/// Item created from an event of the parser. Indices refer to the flat storage.
pub(super) enum Item {
    /// A single value: text, number, boolean or null.
    Scalar(Value),
    /// A list, with the indices of its elements.
    Seq(Vec<usize>),
    /// A map, with the indices of its keys and values.
    Map(Vec<(usize, usize)>),
    /// An alias, with the index of the item that it refers to.
    Alias(usize),
}

/// An item with its place in the file.
pub(super) struct SpannedItem {
    pub item: Item,
    pub span: Span,
}
