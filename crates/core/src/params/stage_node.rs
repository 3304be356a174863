//! A field that keeps its node: the map of a nested stage, whose types only that stage knows.

use super::de::{self, NODE};
use super::fault::Faults;
use super::node::Node;
use super::params::Params;
use serde::Deserialize;
use serde::de::{DeserializeOwned, Deserializer, Error, Visitor};
use std::cell::RefCell;
use std::fmt;

thread_local! {
    /// The node on its way from the deserializer to the visitor of [`StageNode`], which takes it at once.
    static HANDED_OVER: RefCell<Option<StageNode>> = const { RefCell::new(None) };
}

/// Lays a node ready for the visitor that is called next.
pub(super) fn hand_over(node: Node, path: String) {
    HANDED_OVER.with(|slot| *slot.borrow_mut() = Some(StageNode { node, path }));
}

/// A part of a scene as it was written, with its places: the field of a parameter struct for a nested `{kind: x, ...}`, or for a
/// value whose form is decided later.
///
/// It does not work inside serde's untagged, internally tagged or flattened types, which buffer values without their places.
#[derive(Clone, Debug)]
pub struct StageNode {
    node: Node,
    path: String,
}

impl StageNode {
    /// A node with its path in the file.
    #[must_use]
    pub fn new(node: Node, path: impl Into<String>) -> Self {
        Self { node, path: path.into() }
    }

    /// What was written.
    #[must_use]
    pub fn node(&self) -> &Node {
        &self.node
    }

    /// Its path in the file, such as `source.color`.
    #[must_use]
    pub fn path(&self) -> &str {
        &self.path
    }

    /// As the parameters of a stage: a map with or without `kind`, or just the name of a kind.
    ///
    /// # Errors
    /// It is neither.
    pub fn params(&self) -> Result<Params, Faults> {
        Params::stage(self.node.clone(), &self.path)
    }

    /// As a value of a known type.
    ///
    /// # Errors
    /// Everything that is wrong with it.
    pub fn parse<T: DeserializeOwned>(&self) -> Result<T, Faults> {
        de::parse(&self.node, &self.path)
    }

    /// A fault placed here.
    #[must_use]
    pub fn fault(&self, message: impl Into<String>) -> super::Fault {
        self.node.fault(message).path(&self.path)
    }
}

impl<'de> Deserialize<'de> for StageNode {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Take;

        impl Visitor<'_> for Take {
            type Value = StageNode;

            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("a part of a scene with its places")
            }

            fn visit_unit<E: Error>(self) -> Result<StageNode, E> {
                HANDED_OVER
                    .with(|slot| slot.borrow_mut().take())
                    .ok_or_else(|| E::custom("a stage cannot be read from here"))
            }
        }

        deserializer.deserialize_newtype_struct(NODE, Take)
    }
}
