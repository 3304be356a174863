//! Maps, lists and variants of a walk.

use super::super::node::{Key, Node, Value};
use super::super::path::Step;
use super::error::NodeError;
use super::findings::Standin;
use super::placeholder::Placeholder;
use super::walker::Walker;
use serde::de::value::{BorrowedStrDeserializer, StrDeserializer};
use serde::de::{
    DeserializeSeed, Deserializer, EnumAccess, Error, IntoDeserializer, MapAccess, SeqAccess, VariantAccess, Visitor,
};
use serde::forward_to_deserialize_any;

/// A list in a walk.
pub(super) struct SeqWalk<'n, 'p> {
    list: Walker<'n, 'p>,
    elements: std::iter::Enumerate<std::slice::Iter<'n, Node>>,
}

impl<'n, 'p> SeqWalk<'n, 'p> {
    pub(super) fn new(list: Walker<'n, 'p>, elements: &'n [Node]) -> Self {
        Self { list, elements: elements.iter().enumerate() }
    }
}

impl<'n> SeqAccess<'n> for SeqWalk<'n, '_> {
    type Error = NodeError;

    fn next_element_seed<T: DeserializeSeed<'n>>(&mut self, seed: T) -> Result<Option<T::Value>, NodeError> {
        let findings = self.list.findings;
        let Some((index, node)) = self.elements.find(|(_, node)| findings.standin(node) != Some(Standin::Left)) else {
            return Ok(None);
        };
        let element = self.list.child(Step::Index(index), node);
        seed.deserialize(element).map(Some).map_err(|error| element.place(error))
    }

    fn size_hint(&self) -> Option<usize> {
        Some(self.elements.len())
    }
}

/// A map in a walk: its entries, then placeholders for what is missing.
pub(super) struct MapWalk<'n, 'p> {
    map: Walker<'n, 'p>,
    entries: std::vec::IntoIter<&'n (Key, Node)>,
    value: Option<&'n (Key, Node)>,
    missing: std::vec::IntoIter<(&'static str, usize)>,
    placeholder: Option<(&'static str, usize)>,
}

impl<'n, 'p> MapWalk<'n, 'p> {
    /// With `fields`, other keys are reported and left out.
    pub(super) fn new(
        map: Walker<'n, 'p>,
        entries: &'n [(Key, Node)],
        fields: Option<&'static [&'static str]>,
    ) -> Self {
        let findings = map.findings;
        let mut taken = Vec::with_capacity(entries.len());
        for entry in entries {
            let known = fields.is_none_or(|fields| findings.is_known(map.node, &|| map.path(), entry, fields));
            if known && findings.standin(&entry.1) != Some(Standin::Left) {
                taken.push(entry);
            }
        }
        let missing = findings.missing_of(map.node);
        Self { map, entries: taken.into_iter(), value: None, missing: missing.into_iter(), placeholder: None }
    }
}

impl<'n> MapAccess<'n> for MapWalk<'n, '_> {
    type Error = NodeError;

    fn next_key_seed<K: DeserializeSeed<'n>>(&mut self, seed: K) -> Result<Option<K::Value>, NodeError> {
        if let Some(entry) = self.entries.next() {
            self.value = Some(entry);
            let value = self.map.child(Step::Key(&entry.0.text), &entry.1);
            return seed.deserialize(KeyText(&entry.0.text)).map(Some).map_err(|error| value.place(error));
        }
        self.placeholder = self.missing.next();
        let Some((key, _)) = self.placeholder else { return Ok(None) };
        let key_text: StrDeserializer<'_, NodeError> = key.into_deserializer();
        seed.deserialize(key_text).map(Some).map_err(|_| self.map.missing(key))
    }

    fn next_value_seed<V: DeserializeSeed<'n>>(&mut self, seed: V) -> Result<V::Value, NodeError> {
        if let Some((key, node)) = self.value.take() {
            let value = self.map.child(Step::Key(&key.text), node);
            return seed.deserialize(value).map_err(|error| value.place(error));
        }
        match self.placeholder.take() {
            Some((key, level)) => seed.deserialize(Placeholder::new(level)).map_err(|_| self.map.missing(key)),
            None => Err(NodeError::custom("a value was asked for before its key")),
        }
    }

    fn size_hint(&self) -> Option<usize> {
        Some(self.entries.len())
    }
}

/// The key of a map; also of one whose keys are numbers.
struct KeyText<'n>(&'n str);

macro_rules! numeric_keys {
    ($($name:ident, $visit:ident, $ty:ty, $what:literal;)*) => {$(
        fn $name<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, NodeError> {
            match self.0.parse::<$ty>() {
                Ok(value) => visitor.$visit(value),
                Err(_) => Err(NodeError::custom(format!(
                    "found the key `{}`, expected {}", super::super::text::shown(self.0), $what
                ))),
            }
        }
    )*};
}

impl<'de> Deserializer<'de> for KeyText<'de> {
    type Error = NodeError;

    numeric_keys! {
        deserialize_u8, visit_u8, u8, "a whole number up to 255";
        deserialize_u16, visit_u16, u16, "a whole number up to 65535";
        deserialize_u32, visit_u32, u32, "a whole number, not negative";
        deserialize_u64, visit_u64, u64, "a whole number, not negative";
        deserialize_i8, visit_i8, i8, "a whole number";
        deserialize_i16, visit_i16, i16, "a whole number";
        deserialize_i32, visit_i32, i32, "a whole number";
        deserialize_i64, visit_i64, i64, "a whole number";
    }

    fn deserialize_any<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, NodeError> {
        visitor.visit_borrowed_str(self.0)
    }

    fn deserialize_f64<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, NodeError> {
        match Value::from_plain(self.0) {
            Value::Number(number) if number.value.is_finite() => visitor.visit_f64(number.value),
            _ => Err(NodeError::custom(format!(
                "found the key `{}`, expected a number",
                super::super::text::shown(self.0)
            ))),
        }
    }

    fn deserialize_f32<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, NodeError> {
        self.deserialize_f64(visitor)
    }

    /// Keys that are quantities, too.
    fn deserialize_newtype_struct<V: Visitor<'de>>(
        self,
        _name: &'static str,
        visitor: V,
    ) -> Result<V::Value, NodeError> {
        visitor.visit_newtype_struct(self)
    }

    fn deserialize_enum<V: Visitor<'de>>(
        self,
        _name: &'static str,
        _variants: &'static [&'static str],
        visitor: V,
    ) -> Result<V::Value, NodeError> {
        visitor.visit_enum(BorrowedStrDeserializer::new(self.0))
    }

    forward_to_deserialize_any! {
        bool i128 u128 char str string bytes byte_buf option unit unit_struct
        seq tuple tuple_struct map struct identifier ignored_any
    }
}

/// A variant in a walk: a name, or a map of one name.
pub(super) struct EnumWalk<'n, 'p> {
    node: Walker<'n, 'p>,
    name: &'n str,
    value: Option<&'n Node>,
}

impl<'n, 'p> EnumWalk<'n, 'p> {
    pub(super) fn unit(node: Walker<'n, 'p>, name: &'n str) -> Self {
        Self { node, name, value: None }
    }

    pub(super) fn with_value(node: Walker<'n, 'p>, entry: &'n (Key, Node)) -> Self {
        Self { node, name: &entry.0.text, value: Some(&entry.1) }
    }

    fn value<R>(&self, read: impl FnOnce(Walker<'n, '_>) -> Result<R, NodeError>) -> Result<R, NodeError> {
        let Some(node) = self.value else {
            return Err(NodeError::custom(format!(
                "`{}` needs parameters\nhint: write {{{}: ...}}",
                self.name, self.name
            )));
        };
        let value = self.node.child(Step::Key(self.name), node);
        read(value).map_err(|error| value.place(error))
    }
}

impl<'n> EnumAccess<'n> for EnumWalk<'n, '_> {
    type Error = NodeError;
    type Variant = Self;

    fn variant_seed<V: DeserializeSeed<'n>>(self, seed: V) -> Result<(V::Value, Self), NodeError> {
        let name: BorrowedStrDeserializer<'n, NodeError> = BorrowedStrDeserializer::new(self.name);
        seed.deserialize(name).map(|variant| (variant, self))
    }
}

impl<'n> VariantAccess<'n> for EnumWalk<'n, '_> {
    type Error = NodeError;

    fn unit_variant(self) -> Result<(), NodeError> {
        match self.value.map(|node| &node.value) {
            None | Some(Value::Null) => Ok(()),
            Some(_) => {
                Err(NodeError::custom(format!("`{}` takes no parameters\nhint: write just `{}`", self.name, self.name)))
            }
        }
    }

    fn newtype_variant_seed<T: DeserializeSeed<'n>>(self, seed: T) -> Result<T::Value, NodeError> {
        self.value(|value| seed.deserialize(value))
    }

    fn tuple_variant<V: Visitor<'n>>(self, len: usize, visitor: V) -> Result<V::Value, NodeError> {
        self.value(|value| value.deserialize_tuple(len, visitor))
    }

    fn struct_variant<V: Visitor<'n>>(
        self,
        fields: &'static [&'static str],
        visitor: V,
    ) -> Result<V::Value, NodeError> {
        self.value(|value| value.deserialize_struct("", fields, visitor))
    }
}
