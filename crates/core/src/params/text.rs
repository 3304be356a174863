//! Descriptions of what was found, for messages.

use super::node::{Node, Value};
use crate::names::shown;
use crate::quantity::found_text;

/// Describes a node, for `found ...`.
pub(super) fn found(node: &Node) -> String {
    match &node.value {
        Value::Null => "nothing".to_owned(),
        Value::Bool(value) => value.to_string(),
        Value::Number(number) => format!("the number {}", shown(&number.text)),
        Value::String(text) if node.is_quoted() => format!("the text `{}`", shown(text)),
        Value::String(text) => found_text(text),
        Value::Seq(_) => "a list".to_owned(),
        Value::Map(_) => "a map".to_owned(),
    }
}
