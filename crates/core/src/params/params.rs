//! The parameters of one stage.

use super::fault::{Fault, Faults};
use super::node::{Key, Node, Value};
use super::path::joined;
use super::path::steps;
use super::reader::{self, Readable};
use super::text::found;
use crate::names::shown;

/// Key that names the kind of a stage.
const KIND: &str = "kind";

/// The parameters of one stage: a map without its `kind`, with its places and its path in the file.
#[derive(Clone, Debug)]
pub struct Params {
    /// A map without `kind`.
    node: Node,
    kind: Option<(Key, Node)>,
    path: String,
}

impl Params {
    /// Creates the parameters of a stage at a path. The node is a map with or without `kind`, or just the name of a kind.
    ///
    /// # Errors
    /// A fault if the node is neither, or if its `kind` is not a name.
    pub fn stage(node: Node, path: &str) -> Result<Self, Faults> {
        Self::kinded(node, path, KIND)
    }

    /// Creates the parameters of a stage whose kind is named by a key other than `kind`, such as the `shape` of an aperture.
    ///
    /// # Errors
    /// As [`Params::stage`].
    pub fn kinded(mut node: Node, path: &str, key: &str) -> Result<Self, Faults> {
        let kind = match &mut node.value {
            Value::Map(entries) => entries.iter().position(|(k, _)| k.text == key).map(|index| entries.remove(index)),
            Value::String(_) => {
                let map = Node { value: Value::Map(Vec::new()), ..node.clone() };
                let name = std::mem::replace(&mut node, map);
                Some((Key { text: key.to_owned(), span: name.span }, name))
            }
            _ => {
                let message = format!("found {}, expected a map such as {{{key}: ...}}", found(&node));
                let hint = match &node.value {
                    Value::Seq(_) => "write one map, without `- ` or brackets",
                    _ => &format!("name its `{key}` there, and what else that wants"),
                };
                return Err(node.fault(message).path(path).hint(hint).into());
            }
        };
        if let Some((_, name)) = &kind
            && name.as_str().is_none()
        {
            let message = format!("found {}, expected the name of a kind", found(name));
            return Err(name.fault(message).path(join(path, key)).into());
        }
        Ok(Self { node, kind, path: path.to_owned() })
    }

    /// Creates the parameters of something that has no kinds, such as a file or a section. `kind` is an ordinary key here.
    ///
    /// # Errors
    /// A fault if the node is not a map.
    pub fn section(node: Node, path: &str) -> Result<Self, Faults> {
        match &node.value {
            Value::Map(_) => Ok(Self { node, kind: None, path: path.to_owned() }),
            Value::Null if path.is_empty() => Err(node
                .fault("the file is empty")
                .hint("a scene starts with `spectra: 1`, a lens or a stock with its `name`; see `spectra doc scene`, `lens`, `stock`")
                .into()),
            _ => Err(node
                .fault(format!("found {}, expected a map such as {{key: value}}", found(&node)))
                .path(path)
                .hint("write `key: value`, one per line, or {key: value, ...}")
                .into()),
        }
    }

    /// Returns parameters of the same kind, with another map at another path.
    pub(super) fn with_node(&self, node: Node, path: &str) -> Self {
        Self { node, kind: self.kind.clone(), path: path.to_owned() }
    }

    /// Returns the same map without its kind.
    pub(super) fn without_kind(self) -> Self {
        Self { kind: None, ..self }
    }

    /// Returns these parameters without the keys that have the value null.
    #[must_use]
    pub fn without_nulls(&self) -> Self {
        let mut node = self.node.clone();
        if let Value::Map(entries) = &mut node.value {
            entries.retain(|(_, value)| !matches!(value.value, Value::Null));
        }
        Self { node, ..self.clone() }
    }

    /// Name of the kind, if one is given.
    #[must_use]
    pub fn kind(&self) -> Option<&str> {
        self.kind.as_ref().and_then(|(_, name)| name.as_str())
    }

    /// Path of the map in the file, such as `source` or `surfaces[3]`; empty for the file itself.
    #[must_use]
    pub fn path(&self) -> &str {
        &self.path
    }

    /// Returns the map, without `kind`.
    #[must_use]
    pub fn node(&self) -> &Node {
        &self.node
    }

    /// Returns the value under a key, if the key is there.
    #[must_use]
    pub fn get(&self, key: &str) -> Option<&Node> {
        self.node.get(key)
    }

    /// Reads the map as typed parameters.
    ///
    /// # Errors
    /// Everything that is wrong with this map, in one go: unknown keys, wrong types, units of another dimension,
    /// missing keys.
    pub fn parse<T: Readable>(&self) -> Result<T, Faults> {
        reader::parse(&self.node, &self.path)
    }

    /// Creates a fault placed at the value of a key (`radius`, `color.R`, `blades[2]`), or at the map if there is no such key.
    /// For conditions that a type cannot express, such as combinations of keys.
    #[must_use]
    pub fn fault(&self, key: &str, message: impl Into<String>) -> Fault {
        let node = match &self.kind {
            Some((named, name)) if key == named.text => name,
            _ => self.node.nearest_at(key),
        };
        node.fault(message).path(join(&self.path, key))
    }

    /// Creates a fault placed at the map itself.
    #[must_use]
    pub fn fault_here(&self, message: impl Into<String>) -> Fault {
        self.node.fault(message).path(&self.path)
    }
}

/// Appends a path of keys to another one.
fn join(path: &str, key: &str) -> String {
    match steps(key) {
        Ok(steps) => steps.into_iter().fold(path.to_owned(), |path, step| joined(&path, step)),
        Err(_) => shown(path),
    }
}

impl Node {
    /// Reads this node as a value of type `T`, such as the whole of a file.
    ///
    /// # Errors
    /// Everything that is wrong with it, in one go.
    pub fn parse<T: Readable>(&self) -> Result<T, Faults> {
        reader::parse(self, "")
    }
}
