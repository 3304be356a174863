//! A value for what failed or is missing, so that the walk goes on. It is thrown away with the walk.

use super::super::node::{Node, SourceFile, Span, Value};
use super::super::quantity::QUANTITY;
use super::super::stage_node;
use super::NODE;
use super::error::{Cause, NodeError};
use serde::de::value::StrDeserializer;
use serde::de::{
    DeserializeSeed, Deserializer, EnumAccess, IntoDeserializer, MapAccess, SeqAccess, VariantAccess, Visitor,
};
use std::sync::Arc;

/// How many forms a placeholder can take for a type that accepts several.
pub(super) const LEVELS: usize = 5;

/// Deepest placeholder: types that hold themselves end here.
const DEEPEST: usize = 8;

/// A value that goes through most types: 1, a text, nothing inside of lists.
#[derive(Clone, Copy)]
pub(super) struct Placeholder {
    /// What it is for a type that accepts several.
    level: usize,
    depth: usize,
}

fn failed() -> NodeError {
    NodeError::new(Cause::Placeholder)
}

impl Placeholder {
    pub(super) fn new(level: usize) -> Self {
        Self { level, depth: 0 }
    }

    fn inside(self) -> Result<Self, NodeError> {
        if self.depth < DEEPEST { Ok(Self { depth: self.depth + 1, ..self }) } else { Err(failed()) }
    }
}

macro_rules! values {
    ($($name:ident => $visit:ident($value:expr);)*) => {$(
        fn $name<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, NodeError> {
            visitor.$visit($value)
        }
    )*};
}

impl<'de> Deserializer<'de> for Placeholder {
    type Error = NodeError;

    values! {
        deserialize_bool => visit_bool(false);
        deserialize_i8 => visit_i8(1);
        deserialize_i16 => visit_i16(1);
        deserialize_i32 => visit_i32(1);
        deserialize_i64 => visit_i64(1);
        deserialize_i128 => visit_i128(1);
        deserialize_u8 => visit_u8(1);
        deserialize_u16 => visit_u16(1);
        deserialize_u32 => visit_u32(1);
        deserialize_u64 => visit_u64(1);
        deserialize_u128 => visit_u128(1);
        deserialize_f32 => visit_f64(1.0);
        deserialize_f64 => visit_f64(1.0);
        deserialize_char => visit_char('x');
        deserialize_str => visit_str("x");
        deserialize_string => visit_str("x");
        deserialize_bytes => visit_bytes(b"x");
        deserialize_byte_buf => visit_bytes(b"x");
        deserialize_identifier => visit_str("x");
    }

    fn deserialize_any<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, NodeError> {
        match self.level {
            0 => visitor.visit_f64(1.0),
            1 => visitor.visit_str("x"),
            2 => visitor.visit_map(Row { inside: self, fields: &[], left: 0 }),
            3 => visitor.visit_seq(Row { inside: self, fields: &[], left: 0 }),
            _ => visitor.visit_unit(),
        }
    }

    fn deserialize_option<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, NodeError> {
        visitor.visit_none()
    }

    fn deserialize_unit<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, NodeError> {
        visitor.visit_unit()
    }

    fn deserialize_unit_struct<V: Visitor<'de>>(self, _name: &'static str, visitor: V) -> Result<V::Value, NodeError> {
        visitor.visit_unit()
    }

    fn deserialize_ignored_any<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, NodeError> {
        visitor.visit_unit()
    }

    fn deserialize_newtype_struct<V: Visitor<'de>>(
        self,
        name: &'static str,
        visitor: V,
    ) -> Result<V::Value, NodeError> {
        match name {
            NODE => {
                let file = Arc::new(SourceFile::new("", ""));
                stage_node::hand_over(Node::new(Value::Null, Span::default(), file), String::new());
                visitor.visit_unit()
            }
            QUANTITY => visitor.visit_f64(1.0),
            _ => visitor.visit_newtype_struct(self.inside()?),
        }
    }

    fn deserialize_seq<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, NodeError> {
        visitor.visit_seq(Row { inside: self, fields: &[], left: 0 })
    }

    fn deserialize_tuple<V: Visitor<'de>>(self, len: usize, visitor: V) -> Result<V::Value, NodeError> {
        visitor.visit_seq(Row { inside: self.inside()?, fields: &[], left: len })
    }

    fn deserialize_tuple_struct<V: Visitor<'de>>(
        self,
        _name: &'static str,
        len: usize,
        visitor: V,
    ) -> Result<V::Value, NodeError> {
        self.deserialize_tuple(len, visitor)
    }

    fn deserialize_map<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, NodeError> {
        visitor.visit_map(Row { inside: self, fields: &[], left: 0 })
    }

    fn deserialize_struct<V: Visitor<'de>>(
        self,
        _name: &'static str,
        fields: &'static [&'static str],
        visitor: V,
    ) -> Result<V::Value, NodeError> {
        visitor.visit_map(Row { inside: self.inside()?, fields, left: fields.len() })
    }

    fn deserialize_enum<V: Visitor<'de>>(
        self,
        _name: &'static str,
        variants: &'static [&'static str],
        visitor: V,
    ) -> Result<V::Value, NodeError> {
        let Some(name) = variants.first() else { return Err(failed()) };
        visitor.visit_enum(Variant { inside: self.inside()?, name })
    }
}

/// Placeholders in a row, with or without keys.
struct Row {
    inside: Placeholder,
    fields: &'static [&'static str],
    left: usize,
}

impl<'de> SeqAccess<'de> for Row {
    type Error = NodeError;

    fn next_element_seed<T: DeserializeSeed<'de>>(&mut self, seed: T) -> Result<Option<T::Value>, NodeError> {
        if self.left == 0 {
            return Ok(None);
        }
        self.left -= 1;
        seed.deserialize(self.inside).map(Some)
    }
}

impl<'de> MapAccess<'de> for Row {
    type Error = NodeError;

    fn next_key_seed<K: DeserializeSeed<'de>>(&mut self, seed: K) -> Result<Option<K::Value>, NodeError> {
        let Some((&key, rest)) = self.fields.split_first() else { return Ok(None) };
        self.fields = rest;
        let key: StrDeserializer<'_, NodeError> = key.into_deserializer();
        seed.deserialize(key).map(Some)
    }

    fn next_value_seed<V: DeserializeSeed<'de>>(&mut self, seed: V) -> Result<V::Value, NodeError> {
        seed.deserialize(self.inside)
    }
}

/// The first variant.
struct Variant {
    inside: Placeholder,
    name: &'static str,
}

impl<'de> EnumAccess<'de> for Variant {
    type Error = NodeError;
    type Variant = Self;

    fn variant_seed<V: DeserializeSeed<'de>>(self, seed: V) -> Result<(V::Value, Self), NodeError> {
        let name: StrDeserializer<'_, NodeError> = self.name.into_deserializer();
        Ok((seed.deserialize(name)?, self))
    }
}

impl<'de> VariantAccess<'de> for Variant {
    type Error = NodeError;

    fn unit_variant(self) -> Result<(), NodeError> {
        Ok(())
    }

    fn newtype_variant_seed<T: DeserializeSeed<'de>>(self, seed: T) -> Result<T::Value, NodeError> {
        seed.deserialize(self.inside)
    }

    fn tuple_variant<V: Visitor<'de>>(self, len: usize, visitor: V) -> Result<V::Value, NodeError> {
        self.inside.deserialize_tuple(len, visitor)
    }

    fn struct_variant<V: Visitor<'de>>(
        self,
        fields: &'static [&'static str],
        visitor: V,
    ) -> Result<V::Value, NodeError> {
        self.inside.deserialize_struct("", fields, visitor)
    }
}
