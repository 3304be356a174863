//! The deserializer of a node.

use super::super::node::{Node, Number, Value};
use super::super::path::{Step, joined};
use super::super::quantity::{QUANTITY, finite};
use super::super::stage_node;
use super::super::text::{found, listed, shown};
use super::super::whole::{Exact, WHOLE, whole_of};
use super::NODE;
use super::access::{EnumWalk, MapWalk, SeqWalk};
use super::error::{Cause, Culprit, NodeError};
use super::findings::{Findings, Standin, address};
use super::placeholder::Placeholder;
use serde::de::{Deserializer, Error, Visitor};

/// A node in a walk, with the way to it.
#[derive(Clone, Copy)]
pub(super) struct Walker<'n, 'p> {
    pub node: &'n Node,
    pub findings: &'p Findings<'n>,
    step: Option<Step<'n>>,
    parent: Option<&'p Walker<'n, 'p>>,
}

impl<'n, 'p> Walker<'n, 'p> {
    pub(super) fn root(node: &'n Node, findings: &'p Findings<'n>) -> Self {
        findings.visit();
        Self { node, findings, step: None, parent: None }
    }

    pub(super) fn child<'q>(&'q self, step: Step<'n>, node: &'n Node) -> Walker<'n, 'q>
    where
        'p: 'q,
    {
        self.findings.visit();
        Walker { node, findings: self.findings, step: Some(step), parent: Some(self) }
    }

    /// Path of the node in the file.
    pub(super) fn path(&self) -> String {
        let mut steps = Vec::new();
        let mut walker = Some(self);
        while let Some(at) = walker {
            steps.extend(at.step);
            walker = at.parent;
        }
        steps.iter().rev().fold(self.findings.prefix().to_owned(), |path, &step| joined(&path, step))
    }

    fn culprit(&self) -> Culprit {
        let mut chain = Vec::new();
        let mut walker = Some(self);
        while let Some(at) = walker {
            chain.push(address(at.node));
            walker = at.parent;
        }
        Culprit { chain, path: self.path() }
    }

    /// The error with this place, unless it has one further inside.
    pub(super) fn place(&self, error: NodeError) -> NodeError {
        let error = if self.findings.standin(self.node).is_some() { error.silenced() } else { error };
        error.at(|| self.culprit())
    }

    /// The failure of the placeholder for a missing key of this map.
    pub(super) fn missing(&self, key: &'static str) -> NodeError {
        NodeError::of_missing(key, self.culprit())
    }

    /// What takes the place of this node, if it failed on an earlier walk.
    fn placeholder(&self) -> Option<Placeholder> {
        match self.findings.standin(self.node)? {
            Standin::Placeholder(level) => Some(Placeholder::new(level)),
            // Left out by the map or list around it; the root of a walk is never replaced.
            Standin::Left => None,
        }
    }

    fn mismatch(&self, expected: &str) -> NodeError {
        let quoted_number = self.node.is_quoted()
            && matches!(&self.node.value, Value::String(text) if matches!(Value::from_plain(text), Value::Number(_) | Value::Bool(_)));
        // `10 000`, `10_000` and `10'000` are numbers to a person.
        let joined = match &self.node.value {
            Value::String(text) if text.starts_with(|c: char| c.is_ascii_digit()) && expected.contains("number") => {
                let joined: String = text.chars().filter(|c| !matches!(c, ' ' | '_' | '\'' | '\u{a0}')).collect();
                matches!(Value::from_plain(&joined), Value::Number(_)).then_some(joined)
            }
            _ => None,
        };
        let hint = match expected.split_once(" such as ") {
            _ if joined.is_some() && !quoted_number => joined.map(|joined| format!("write `{}`", shown(&joined))),
            _ if quoted_number => Some("remove the quotes".to_owned()),
            _ if matches!(self.node.value, Value::Null) => Some(NO_VALUE.to_owned()),
            Some((_, example)) => Some(format!("write it as in `{example}`")),
            None => None,
        };
        NodeError::new(Cause::Text(format!("found {}, expected {expected}", found(self.node)), hint))
    }

    fn float(&self) -> Result<f64, NodeError> {
        match &self.node.value {
            Value::Number(number) => finite(number).map_err(|message| NodeError::text(&message)),
            _ => Err(self.mismatch("a number such as 1.5")),
        }
    }

    /// A whole number between two limits.
    fn integer(&self, least: i128, most: i128) -> Result<i128, NodeError> {
        match whole_of(self.node, least, most) {
            Some(value) => value.map_err(|message| NodeError::text(&message)),
            None => Err(self.mismatch("a whole number such as 16")),
        }
    }

    fn text(&self) -> Result<&'n str, NodeError> {
        match &self.node.value {
            Value::String(text) => Ok(text),
            Value::Number(number) => Ok(&number.text),
            Value::Bool(value) => {
                Err(self.mismatch("a text")).map_err(|error| with_hint(error, format!("write \"{value}\" with quotes")))
            }
            _ => Err(self.mismatch("a text")),
        }
    }
}

/// What helps where a key has no value.
const NO_VALUE: &str = "write the value behind the `:`, or leave the key out";

/// How to write a list of `len` values that was written as a text, such as `960x640`.
fn list_hint(text: &str, len: usize) -> String {
    let parts: Vec<&str> =
        text.split(['x', 'X', '\u{d7}', '*', ',', ';', '/', ' ']).filter(|p| !p.is_empty()).collect();
    if parts.len() == len && parts.iter().all(|p| matches!(Value::from_plain(p), Value::Number(_))) {
        format!("write `[{}]`", listed(parts))
    } else {
        format!("write {len} values in brackets, separated by commas")
    }
}

fn with_hint(error: NodeError, hint: String) -> NodeError {
    match error.into_parts().0 {
        Cause::Text(message, _) => NodeError::new(Cause::Text(message, Some(hint))),
        cause => NodeError::new(cause),
    }
}

/// A method that gives way to a placeholder and places what goes wrong.
macro_rules! methods {
    ($(fn $name:ident($self:ident, $visitor:ident $(, $arg:ident: $ty:ty)*) $body:expr)*) => {$(
        fn $name<V: Visitor<'n>>(self, $($arg: $ty,)* $visitor: V) -> Result<V::Value, NodeError> {
            let $self = self;
            let result = match $self.placeholder() {
                Some(placeholder) => placeholder.$name($($arg,)* $visitor),
                None => $body,
            };
            result.map_err(|error| self.place(error))
        }
    )*};
}

/// Integers by their limits.
macro_rules! integers {
    ($($name:ident, $visit:ident, $ty:ty;)*) => {
        methods! {$(
            fn $name(me, visitor) {
                let value = me.integer(i128::from(<$ty>::MIN), i128::from(<$ty>::MAX));
                // The limits have been checked.
                value.and_then(|value| visitor.$visit(value as $ty))
            }
        )*}
    };
}

impl<'n, 'p> Deserializer<'n> for Walker<'n, 'p> {
    type Error = NodeError;

    integers! {
        deserialize_i8, visit_i8, i8;
        deserialize_i16, visit_i16, i16;
        deserialize_i32, visit_i32, i32;
        deserialize_i64, visit_i64, i64;
        deserialize_u8, visit_u8, u8;
        deserialize_u16, visit_u16, u16;
        deserialize_u32, visit_u32, u32;
        deserialize_u64, visit_u64, u64;
    }

    methods! {
        fn deserialize_any(me, visitor) match &me.node.value {
            Value::Null => visitor.visit_unit(),
            Value::Bool(value) => visitor.visit_bool(*value),
            Value::Number(number) => match Exact::of(&number.text) {
                Exact::Is(value) if !number.text.contains(['.', 'e', 'E']) => match (u64::try_from(value), i64::try_from(value)) {
                    (Ok(value), _) => visitor.visit_u64(value),
                    (_, Ok(value)) => visitor.visit_i64(value),
                    _ => visitor.visit_f64(number.value),
                },
                _ => visitor.visit_f64(number.value),
            },
            Value::String(text) => visitor.visit_borrowed_str(text),
            Value::Seq(elements) => visitor.visit_seq(SeqWalk::new(me, elements)),
            Value::Map(entries) => visitor.visit_map(MapWalk::new(me, entries, None)),
        }

        fn deserialize_bool(me, visitor) match &me.node.value {
            Value::Bool(value) => visitor.visit_bool(*value),
            Value::String(text) => {
                let hint = match text.to_ascii_lowercase().as_str() {
                    "yes" | "on" | "y" | "true" => Some("write `true`, without quotes"),
                    "no" | "off" | "n" | "false" => Some("write `false`, without quotes"),
                    _ => None,
                };
                let error = me.mismatch("true or false");
                Err(match hint {
                    Some(hint) => with_hint(error, hint.to_owned()),
                    None => error,
                })
            }
            _ => Err(me.mismatch("true or false")),
        }

        fn deserialize_i128(me, visitor) me.integer(i128::MIN, i128::MAX).and_then(|value| visitor.visit_i128(value))

        fn deserialize_u128(me, visitor) me.integer(0, i128::MAX).and_then(|value| visitor.visit_u128(value.unsigned_abs()))

        fn deserialize_f32(me, visitor) me.float().and_then(|value| visitor.visit_f64(value))

        fn deserialize_f64(me, visitor) me.float().and_then(|value| visitor.visit_f64(value))

        fn deserialize_char(me, visitor) me.text().and_then(|text| visitor.visit_borrowed_str(text))

        fn deserialize_str(me, visitor) me.text().and_then(|text| visitor.visit_borrowed_str(text))

        fn deserialize_string(me, visitor) me.text().and_then(|text| visitor.visit_borrowed_str(text))

        fn deserialize_bytes(me, visitor) me.text().and_then(|text| visitor.visit_borrowed_bytes(text.as_bytes()))

        fn deserialize_byte_buf(me, visitor) me.text().and_then(|text| visitor.visit_borrowed_bytes(text.as_bytes()))

        fn deserialize_option(me, visitor) match &me.node.value {
            Value::Null => visitor.visit_none(),
            _ => visitor.visit_some(me),
        }

        fn deserialize_unit(me, visitor) match &me.node.value {
            Value::Null => visitor.visit_unit(),
            _ => Err(me.mismatch("nothing")),
        }

        fn deserialize_unit_struct(me, visitor, _name: &'static str) match &me.node.value {
            Value::Null => visitor.visit_unit(),
            _ => Err(me.mismatch("nothing")),
        }

        fn deserialize_newtype_struct(me, visitor, name: &'static str) match (name, &me.node.value) {
            (NODE, _) => {
                stage_node::hand_over(me.node.clone(), me.path());
                visitor.visit_unit()
            }
            (WHOLE, Value::Number(number)) => visitor.visit_str(&number.text),
            (WHOLE, _) => Err(me.mismatch("a whole number such as 16")),
            (QUANTITY, Value::Number(number)) if number.value.is_finite() => visitor.visit_f64(number.value),
            (QUANTITY, Value::Number(Number { text, .. }) | Value::String(text)) => visitor.visit_str(text),
            (QUANTITY, _) => {
                let found = found(me.node);
                let error = NodeError::invalid_type(serde::de::Unexpected::Other(&found), &visitor);
                Err(match &me.node.value {
                    Value::Null => with_hint(error, NO_VALUE.to_owned()),
                    Value::Seq(_) => with_hint(error, "one value, without brackets".to_owned()),
                    _ => error,
                })
            }
            _ => visitor.visit_newtype_struct(me),
        }

        fn deserialize_seq(me, visitor) match &me.node.value {
            Value::Seq(elements) => visitor.visit_seq(SeqWalk::new(me, elements)),
            Value::String(text) => Err(with_hint(me.mismatch("a list"), format!("put it in brackets: `[{}]`", shown(text)))),
            Value::Number(number) => Err(with_hint(me.mismatch("a list"), format!("put it in brackets: `[{}]`", shown(&number.text)))),
            Value::Map(_) => Err(with_hint(me.mismatch("a list"), "put it in brackets, or start each entry with `- `".to_owned())),
            _ => Err(me.mismatch("a list such as [1, 2]")),
        }

        fn deserialize_tuple(me, visitor, len: usize) match &me.node.value {
            Value::Seq(elements) if elements.len() == len => visitor.visit_seq(SeqWalk::new(me, elements)),
            Value::Seq(elements) => Err(NodeError::text(&format!(
                "found a list of {}, expected a list of {len}\nhint: write {len} values in brackets, separated by commas",
                elements.len()
            ))),
            Value::Null => Err(me.mismatch(&format!("a list of {len}"))),
            Value::String(text) => Err(with_hint(me.mismatch(&format!("a list of {len}")), list_hint(text, len))),
            _ => Err(with_hint(me.mismatch(&format!("a list of {len}")), list_hint("", len))),
        }

        fn deserialize_tuple_struct(me, visitor, _name: &'static str, len: usize) me.deserialize_tuple(len, visitor)

        fn deserialize_map(me, visitor) match &me.node.value {
            Value::Map(entries) => visitor.visit_map(MapWalk::new(me, entries, None)),
            _ => Err(me.mismatch("a map such as {key: value}")),
        }

        fn deserialize_struct(me, visitor, _name: &'static str, fields: &'static [&'static str]) match &me.node.value {
            Value::Map(entries) => visitor.visit_map(MapWalk::new(me, entries, Some(fields))),
            _ if fields.is_empty() => Err(me.mismatch("a map without keys, {}")),
            _ => Err(with_hint(me.mismatch("a map such as {key: value}"), format!("known keys: {}", listed(fields.iter().copied())))),
        }

        fn deserialize_enum(me, visitor, _name: &'static str, variants: &'static [&'static str]) match &me.node.value {
            Value::String(_) | Value::Number(_) => me.text().and_then(|text| visitor.visit_enum(EnumWalk::unit(me, text))),
            Value::Map(entries) if entries.len() == 1 => visitor.visit_enum(EnumWalk::with_value(me, &entries[0])),
            _ => Err(me.mismatch(&format!("one of {}", listed(variants.iter().copied())))),
        }

        fn deserialize_identifier(me, visitor) me.text().and_then(|text| visitor.visit_borrowed_str(text))

        fn deserialize_ignored_any(_me, visitor) visitor.visit_unit()
    }
}
