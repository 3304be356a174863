//! The error of a walk: it keeps the innermost place.

use super::super::text::{hint_for, shown};
use serde::de::{Error, Expected, Unexpected};
use std::fmt;

/// What went wrong.
#[derive(Debug)]
pub(super) enum Cause {
    /// A fault in words, with a hint.
    Text(String, Option<String>),
    /// A key is missing.
    Missing(&'static str),
    /// A placeholder did not go through: nothing that a person did.
    Placeholder,
}

/// A node in the walk and those around it, by address, from the inside out.
#[derive(Debug)]
pub(super) struct Culprit {
    /// Addresses; the first is the node itself.
    pub chain: Vec<usize>,
    /// Path of the node.
    pub path: String,
}

/// The error of a walk.
#[derive(Debug)]
pub struct NodeError(Box<Inner>);

#[derive(Debug)]
struct Inner {
    cause: Cause,
    culprit: Option<Culprit>,
}

impl NodeError {
    pub(super) fn new(cause: Cause) -> Self {
        Self(Box::new(Inner { cause, culprit: None }))
    }

    /// A text, of which a line that starts with `hint: ` is the hint.
    pub(super) fn text(text: &str) -> Self {
        Self::new(match text.split_once("\nhint: ") {
            Some((message, hint)) => Cause::Text(message.to_owned(), Some(hint.to_owned())),
            None => Cause::Text(text.to_owned(), None),
        })
    }

    /// Names the node, unless one further inside is named.
    pub(super) fn at(mut self, culprit: impl FnOnce() -> Culprit) -> Self {
        self.0.culprit.get_or_insert_with(culprit);
        self
    }

    /// The same place, without a message.
    pub(super) fn silenced(mut self) -> Self {
        self.0.cause = Cause::Placeholder;
        self
    }

    /// The same as the failure of the placeholder for a missing key.
    pub(super) fn of_missing(key: &'static str, culprit: Culprit) -> Self {
        Self(Box::new(Inner { cause: Cause::Missing(key), culprit: Some(culprit) }))
    }

    pub(super) fn into_parts(self) -> (Cause, Option<Culprit>) {
        (self.0.cause, self.0.culprit)
    }
}

impl fmt::Display for NodeError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match &self.0.cause {
            Cause::Text(message, _) => f.write_str(message),
            Cause::Missing(key) => write!(f, "missing key `{key}`"),
            Cause::Placeholder => f.write_str("no placeholder goes through"),
        }
    }
}

impl std::error::Error for NodeError {}

/// What serde found, in the words of a scene.
fn found(unexpected: Unexpected<'_>) -> String {
    match unexpected {
        Unexpected::Bool(value) => value.to_string(),
        Unexpected::Unsigned(value) => format!("the number {value}"),
        Unexpected::Signed(value) => format!("the number {value}"),
        Unexpected::Float(value) => format!("the number {value}"),
        Unexpected::Char(c) => format!("the text `{}`", shown(&c.to_string())),
        Unexpected::Str(text) => super::super::text::found_text(text),
        Unexpected::Unit | Unexpected::Option => "nothing".to_owned(),
        Unexpected::Seq => "a list".to_owned(),
        Unexpected::Map => "a map".to_owned(),
        Unexpected::Other(what) => what.to_owned(),
        other => other.to_string(),
    }
}

impl Error for NodeError {
    fn custom<T: fmt::Display>(message: T) -> Self {
        Self::text(&message.to_string())
    }

    fn invalid_type(unexpected: Unexpected<'_>, expected: &dyn Expected) -> Self {
        Self::text(&format!("found {}, expected {expected}", found(unexpected)))
    }

    fn invalid_value(unexpected: Unexpected<'_>, expected: &dyn Expected) -> Self {
        Self::invalid_type(unexpected, expected)
    }

    fn invalid_length(length: usize, expected: &dyn Expected) -> Self {
        Self::text(&format!("found {length} entries, expected {expected}"))
    }

    fn unknown_variant(variant: &str, expected: &'static [&'static str]) -> Self {
        let hint = hint_for(variant, "value", expected);
        Self::new(Cause::Text(format!("unknown value `{}`", shown(variant)), Some(hint)))
    }

    fn unknown_field(field: &str, expected: &'static [&'static str]) -> Self {
        let hint = hint_for(field, "key", expected);
        Self::new(Cause::Text(format!("unknown key `{}`", shown(field)), Some(hint)))
    }

    fn missing_field(field: &'static str) -> Self {
        Self::new(Cause::Missing(field))
    }

    fn duplicate_field(field: &'static str) -> Self {
        // Keys of a node are unique, so two spellings of one field met (serde's `alias`).
        Self::text(&format!("the key `{field}` is given twice, under two names"))
    }
}
