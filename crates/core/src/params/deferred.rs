//! Fields that keep their node: the map of a nested stage, or another part that is read later.

use super::fault::{Fault, Faults};
use super::node::Node;
use super::params::Params;
use super::reader::{self, Readable};
use super::schema::PART;
use schemars::{JsonSchema, Schema, SchemaGenerator};
use serde::Deserialize;
use serde::de::Deserializer;
use std::borrow::Cow;
use std::fmt;
use std::marker::PhantomData;
use std::ops::Deref;

/// A part of a scene or lens file as it was written, with the place of each value.
#[derive(Clone, Debug)]
pub struct StageNode {
    node: Node,
    path: String,
}

impl StageNode {
    /// Creates a part of a scene or lens file from its node and the node's path in the file, such as `source.color`.
    #[must_use]
    pub fn new(node: Node, path: impl Into<String>) -> Self {
        Self { node, path: path.into() }
    }

    /// Returns the node as it was written.
    #[must_use]
    pub fn node(&self) -> &Node {
        &self.node
    }

    /// Path of the node in the file, such as `source.color`.
    #[must_use]
    pub fn path(&self) -> &str {
        &self.path
    }

    /// Reads the node as the parameters of a stage: a map with or without `kind`, or just the name of a kind.
    ///
    /// # Errors
    /// A fault if it is neither.
    pub fn params(&self) -> Result<Params, Faults> {
        Params::stage(self.node.clone(), &self.path)
    }

    /// Reads the node as a value of a known type.
    ///
    /// # Errors
    /// Everything that is wrong with it.
    pub fn parse<T: Readable>(&self) -> Result<T, Faults> {
        reader::parse(&self.node, &self.path)
    }

    /// Creates a fault placed at this node.
    #[must_use]
    pub fn fault(&self, message: impl Into<String>) -> Fault {
        self.node.fault(message).path(&self.path)
    }
}

impl<'de> Deserialize<'de> for StageNode {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        reader::node(deserializer)
    }
}

/// A part of a file that is kept as written, and read later in the form `T`. Its schema is the schema of `T`, and a fault in it
/// is found when it is read. A nested stage is a `Deferred<StageOf<dyn ColorModel>>`; see [`crate::registry::StageOf`].
///
/// A part does not work inside serde's untagged or flattened types, which buffer values without their places.
pub struct Deferred<T>(StageNode, PhantomData<fn() -> T>);

impl<T> Deferred<T> {
    /// Reads the part as its type.
    ///
    /// # Errors
    /// Everything that is wrong with it.
    pub fn read(&self) -> Result<T, Faults>
    where
        T: Readable,
    {
        self.0.parse()
    }
}

impl<T> Clone for Deferred<T> {
    fn clone(&self) -> Self {
        Self(self.0.clone(), PhantomData)
    }
}

impl<T> fmt::Debug for Deferred<T> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.0.fmt(f)
    }
}

impl<T> Deref for Deferred<T> {
    type Target = StageNode;

    fn deref(&self) -> &StageNode {
        &self.0
    }
}

impl<'de, T> Deserialize<'de> for Deferred<T> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        StageNode::deserialize(deserializer).map(|node| Self(node, PhantomData))
    }
}

impl<T: JsonSchema> JsonSchema for Deferred<T> {
    fn inline_schema() -> bool {
        true
    }

    fn schema_name() -> Cow<'static, str> {
        format!("Part_{}", T::schema_name()).into()
    }

    fn json_schema(generator: &mut SchemaGenerator) -> Schema {
        let mut schema = generator.subschema_for::<T>();
        schema.insert(PART.to_owned(), true.into());
        schema
    }
}

/// Any value; its meaning is decided later.
impl JsonSchema for StageNode {
    fn inline_schema() -> bool {
        true
    }

    fn schema_name() -> Cow<'static, str> {
        "Any".into()
    }

    fn json_schema(_: &mut SchemaGenerator) -> Schema {
        schemars::json_schema!({ PART: true })
    }
}
