//! The tree that a scene file is read into: values, each with the place where it was written.

use super::fault::Fault;
use super::place::{SourceFile, Span};
use crate::quantity::decimal_end;
use std::sync::Arc;

/// Deepest nesting of maps and lists that is read or built. It limits recursion over a [`Node`].
pub const MAX_DEPTH: usize = 64;

/// A number as written.
#[derive(Clone, Debug, PartialEq)]
pub struct Number {
    /// Value of the number; infinite if it is too large for an f64.
    pub value: f64,
    /// Spelling, so that integers keep all digits and a name such as `135` stays a name.
    pub text: String,
}

/// The key of a map.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Key {
    /// Text of the key.
    pub text: String,
    /// Place of the key, in the same file as its value.
    pub span: Span,
}

/// The content of a node.
#[derive(Clone, Debug)]
pub enum Value {
    /// No value: nothing is written, or `null` or `~`.
    Null,
    /// `true` or `false`.
    Bool(bool),
    /// A number without a unit.
    Number(Number),
    /// A text; this includes numbers with a unit.
    String(String),
    /// A list.
    Seq(Vec<Node>),
    /// A map, in the order of the file, without duplicate keys.
    Map(Vec<(Key, Node)>),
}

impl Value {
    /// Reads an unquoted scalar by the core schema of YAML 1.2 (section 10.3.2), with strict booleans: only `true` and `false`.
    #[must_use]
    pub fn from_plain(text: &str) -> Self {
        match text {
            "" | "~" | "null" | "Null" | "NULL" => Self::Null,
            "true" => Self::Bool(true),
            "false" => Self::Bool(false),
            _ => match plain_number(text) {
                Some(value) => Self::Number(Number { value, text: text.to_owned() }),
                None => Self::String(text.to_owned()),
            },
        }
    }
}

/// Reads the spelling of a number by the core schema; infinite on overflow.
fn plain_number(text: &str) -> Option<f64> {
    if let Some(digits) = text.strip_prefix("0x") {
        return radix(digits, 16);
    }
    if let Some(digits) = text.strip_prefix("0o") {
        return radix(digits, 8);
    }
    let (negative, unsigned) = match text.as_bytes().first()? {
        b'-' => (true, &text[1..]),
        b'+' => (false, &text[1..]),
        _ => (false, text),
    };
    match unsigned {
        ".inf" | ".Inf" | ".INF" => return Some(if negative { f64::NEG_INFINITY } else { f64::INFINITY }),
        _ if matches!(text, ".nan" | ".NaN" | ".NAN") => return Some(f64::NAN),
        _ => {}
    }
    let end = decimal_end(unsigned)?;
    if end == unsigned.len() { text.parse().ok() } else { None }
}

fn radix(digits: &str, base: u32) -> Option<f64> {
    if digits.is_empty() {
        return None;
    }
    digits.chars().try_fold(0.0, |sum: f64, c| Some(sum * f64::from(base) + f64::from(c.to_digit(base)?)))
}

/// A value with its place.
#[derive(Clone, Debug)]
pub struct Node {
    /// Content of the node.
    pub value: Value,
    /// Place where the node was written.
    pub span: Span,
    /// File in which the node was written.
    pub file: Arc<SourceFile>,
}

impl Node {
    /// Creates a node from a value and its place.
    #[must_use]
    pub fn new(value: Value, span: Span, file: Arc<SourceFile>) -> Self {
        Self { value, span, file }
    }

    /// Returns the value under a key, if this is a map that has it.
    #[must_use]
    pub fn get(&self, key: &str) -> Option<&Node> {
        self.entry(key).map(|(_, node)| node)
    }

    /// Returns the key and the value under it, if this is a map that has it.
    #[must_use]
    pub fn entry(&self, key: &str) -> Option<(&Key, &Node)> {
        match &self.value {
            Value::Map(entries) => entries.iter().find(|(k, _)| k.text == key).map(|(k, node)| (k, node)),
            _ => None,
        }
    }

    /// Returns an element of a list, if this is a list that has it.
    #[must_use]
    pub fn element(&self, index: usize) -> Option<&Node> {
        match &self.value {
            Value::Seq(elements) => elements.get(index),
            _ => None,
        }
    }

    /// Returns the text of a string, or the spelling of a number.
    #[must_use]
    pub fn as_str(&self) -> Option<&str> {
        match &self.value {
            Value::String(text) => Some(text),
            Value::Number(number) => Some(&number.text),
            _ => None,
        }
    }

    /// Returns whether the value was written in quotes.
    #[must_use]
    pub fn is_quoted(&self) -> bool {
        matches!(self.file.text.as_bytes().get(self.span.offset), Some(b'"' | b'\'')) && self.span.len > 1
    }

    /// Place that messages about this node point to: its part on the first line.
    #[must_use]
    pub fn place(&self) -> (Arc<SourceFile>, Span) {
        (Arc::clone(&self.file), self.span.first_line(&self.file.text))
    }

    /// Creates a fault at this place.
    #[must_use]
    pub fn fault(&self, message: impl Into<String>) -> Fault {
        Fault { place: Some(self.place()), ..Fault::new(message) }
    }
}
