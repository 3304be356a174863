//! Reading a typed value from a [`Node`]: the tree is checked against the schema of the type, then serde reads what is known to
//! be right.

use super::at::At;
use super::check::check;
use super::fault::{Fault, Faults};
use super::node::{Node, Value};
// A circle with `deferred.rs`: a part keeps the node that the reader hands it, and reads it later.
use super::deferred::StageNode;
use super::path::Step;
use super::whole::Exact;
use schemars::JsonSchema;
use schemars::generate::SchemaSettings;
use serde::de::value::{MapAccessDeserializer, MapDeserializer, SeqDeserializer, StrDeserializer};
use serde::de::{DeserializeOwned, Deserializer, Error, IntoDeserializer, Visitor};
use serde::forward_to_deserialize_any;
use std::any::TypeId;
use std::collections::HashMap;
use std::fmt;
use std::sync::{Arc, LazyLock, PoisonError, RwLock};

/// A type that can be read from a scene: serde reads it, and its schema says what is allowed.
pub trait Readable: DeserializeOwned + JsonSchema + 'static {}

impl<T: DeserializeOwned + JsonSchema + 'static> Readable for T {}

/// Cache of schemas by type. Making a schema takes longer than reading a section with it, and a viewer reads a scene again at
/// each change.
static SCHEMAS: LazyLock<RwLock<HashMap<TypeId, Arc<serde_json::Value>>>> = LazyLock::new(RwLock::default);

/// Returns the schema of a type, with all subschemas inlined.
fn schema<T: Readable>() -> Arc<serde_json::Value> {
    let of = TypeId::of::<T>();
    if let Some(known) = SCHEMAS.read().unwrap_or_else(PoisonError::into_inner).get(&of) {
        return Arc::clone(known);
    }
    // Made without holding the lock: a type may ask for other schemas.
    let settings = SchemaSettings::draft2020_12().with(|s| s.inline_subschemas = true);
    let made = Arc::new(settings.into_generator().into_root_schema_for::<T>().to_value());
    Arc::clone(SCHEMAS.write().unwrap_or_else(PoisonError::into_inner).entry(of).or_insert(made))
}

/// Returns the keys that the map of type `T` may have, for [`super::Params::split`].
#[must_use]
pub fn keys_of<T: Readable>() -> Vec<String> {
    let properties = schema::<T>().get("properties").and_then(serde_json::Value::as_object).cloned();
    properties.map_or_else(Vec::new, |all| all.into_iter().map(|(key, _)| key).collect())
}

/// Reads a value from a node, or returns everything that is wrong with it. `prefix` is the path of the node.
pub(super) fn parse<T: Readable>(node: &Node, prefix: &str) -> Result<T, Faults> {
    let at = At::root(node, prefix);
    check(&at, &schema::<T>())?;
    T::deserialize(Reader(at)).map_err(|error| match *error.0 {
        Inner::Placed(fault) => fault.into(),
        Inner::Words(words) => at.fault(words).into(),
        Inner::Node(_) => at.fault("a part with its places is wanted here").into(),
    })
}

/// The name by which a field asks for the node itself.
const NODE: &str = "spectra::node";

/// Returns the node that a deserializer stands at. serde hands over only plain values; of all types that cross it, only an
/// error may carry any other type (as its source), so the node comes as an error.
pub(super) fn node<'de, D: Deserializer<'de>>(deserializer: D) -> Result<StageNode, D::Error> {
    struct Refused;

    impl Visitor<'_> for Refused {
        type Value = ();

        fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
            f.write_str("a part of a scene with its places")
        }
    }

    let Err(error) = deserializer.deserialize_newtype_struct(NODE, Refused) else {
        return Err(D::Error::custom(
            "a stage can be read only through `Params::parse`, not with another deserializer",
        ));
    };
    let handed = std::error::Error::source(&error).and_then(|source| source.downcast_ref::<Handed>());
    handed.map(|Handed(node)| node.clone()).ok_or(error)
}

/// A node on its way to the field that keeps it.
#[derive(Debug)]
struct Handed(StageNode);

impl fmt::Display for Handed {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.0.path())
    }
}

impl std::error::Error for Handed {}

/// Reason why a reader stopped.
#[derive(Debug)]
struct ReadError(Box<Inner>);

#[derive(Debug)]
enum Inner {
    Words(String),
    Placed(Fault),
    Node(Handed),
}

impl ReadError {
    fn at(self, at: &At<'_, '_>) -> Self {
        match *self.0 {
            Inner::Words(words) => Self(Box::new(Inner::Placed(at.fault(words)))),
            _ => self,
        }
    }
}

impl fmt::Display for ReadError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match &*self.0 {
            Inner::Words(words) => f.write_str(words),
            Inner::Placed(fault) => fault.fmt(f),
            Inner::Node(node) => node.fmt(f),
        }
    }
}

impl std::error::Error for ReadError {
    fn source(&self) -> Option<&(dyn std::error::Error + 'static)> {
        match &*self.0 {
            Inner::Node(node) => Some(node),
            _ => None,
        }
    }
}

impl Error for ReadError {
    fn custom<T: fmt::Display>(message: T) -> Self {
        Self(Box::new(Inner::Words(message.to_string())))
    }
}

/// Deserializer of a node that conforms to its schema. Any error that remains is placed at the innermost node.
#[derive(Clone, Copy)]
struct Reader<'de, 'p>(At<'de, 'p>);

impl<'de> Reader<'de, '_> {
    fn map<'q>(
        &'q self,
        entries: &'de [(super::Key, Node)],
    ) -> MapDeserializer<'de, impl Iterator<Item = (&'de str, Reader<'de, 'q>)>, ReadError> {
        MapDeserializer::new(
            entries.iter().map(|(key, value)| (key.text.as_str(), Reader(self.0.child(Step::Key(&key.text), value)))),
        )
    }

    fn text<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, ReadError> {
        match self.0.node.as_str() {
            Some(text) => visitor.visit_borrowed_str(text).map_err(|error: ReadError| error.at(&self.0)),
            None => self.deserialize_any(visitor),
        }
    }
}

impl<'de, 'p> IntoDeserializer<'de, ReadError> for Reader<'de, 'p> {
    type Deserializer = Self;

    fn into_deserializer(self) -> Self {
        self
    }
}

impl<'de> Deserializer<'de> for Reader<'de, '_> {
    type Error = ReadError;

    fn deserialize_any<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, ReadError> {
        let read = match &self.0.node.value {
            Value::Null => visitor.visit_unit(),
            Value::Bool(value) => visitor.visit_bool(*value),
            // Whole numbers keep all digits; -0 is read as a float, since only a float keeps its sign.
            Value::Number(number) => match Exact::of(&number.text) {
                Exact::Is(value) if value != 0 || !number.value.is_sign_negative() => {
                    match (u64::try_from(value), i64::try_from(value)) {
                        (Ok(value), _) => visitor.visit_u64(value),
                        (_, Ok(value)) => visitor.visit_i64(value),
                        _ => visitor.visit_f64(number.value),
                    }
                }
                _ => visitor.visit_f64(number.value),
            },
            Value::String(text) => visitor.visit_borrowed_str(text),
            Value::Seq(elements) => {
                let read = |(i, node)| Reader(self.0.child(Step::Index(i), node));
                visitor.visit_seq(SeqDeserializer::new(elements.iter().enumerate().map(read)))
            }
            Value::Map(entries) => visitor.visit_map(self.map(entries)),
        };
        read.map_err(|error: ReadError| error.at(&self.0))
    }

    fn deserialize_str<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, ReadError> {
        self.text(visitor)
    }

    fn deserialize_string<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, ReadError> {
        self.text(visitor)
    }

    fn deserialize_option<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, ReadError> {
        match &self.0.node.value {
            Value::Null => visitor.visit_none(),
            _ => visitor.visit_some(self),
        }
    }

    fn deserialize_newtype_struct<V: Visitor<'de>>(
        self,
        name: &'static str,
        visitor: V,
    ) -> Result<V::Value, ReadError> {
        match name {
            NODE => Err(ReadError(Box::new(Inner::Node(Handed(StageNode::new(self.0.node.clone(), self.0.path())))))),
            _ => visitor.visit_newtype_struct(self),
        }
    }

    fn deserialize_enum<V: Visitor<'de>>(
        self,
        _name: &'static str,
        _variants: &'static [&'static str],
        visitor: V,
    ) -> Result<V::Value, ReadError> {
        let read = match (&self.0.node.value, self.0.node.as_str()) {
            (Value::Map(entries), _) => visitor.visit_enum(MapAccessDeserializer::new(self.map(entries))),
            (_, Some(text)) => visitor.visit_enum(StrDeserializer::new(text)),
            _ => Err(ReadError::custom("a name is wanted here")),
        };
        read.map_err(|error| error.at(&self.0))
    }

    forward_to_deserialize_any! {
        bool i8 i16 i32 i64 i128 u8 u16 u32 u64 u128 f32 f64 char bytes byte_buf unit unit_struct
        seq tuple tuple_struct map struct identifier ignored_any
    }
}
