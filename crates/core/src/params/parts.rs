//! Parts of a map: the stage under a key, or some keys separated from the rest.

use super::fault::{Fault, Faults};
use super::node::{Node, Value};
use super::params::Params;
use std::sync::Arc;

impl Params {
    /// Returns the parameters of the stage under `key`; `None` if the key is absent.
    ///
    /// # Errors
    /// A fault if the value cannot be a stage.
    pub fn stage_at(&self, key: &str) -> Result<Option<Self>, Faults> {
        self.get(key).map(|node| Self::stage(node.clone(), &self.path_of(key))).transpose()
    }

    /// Returns parameters for a stage that the scene does not mention: they stand for the registry's default kind with its
    /// default parameters. `key` is the key under which the stage could be written. Faults are placed at this map.
    #[must_use]
    pub fn default_stage(&self, key: &str) -> Self {
        let map = Node::new(Value::Map(Vec::new()), self.node().span, Arc::clone(&self.node().file));
        self.with_node(map, &self.path_of(key)).without_kind()
    }

    /// Splits the map into the parameters under `keys` and the other ones, in this order. Both keep the kind.
    #[must_use]
    pub fn split(&self, keys: &[impl AsRef<str>]) -> (Self, Self) {
        let (mut inside, mut outside) = (Vec::new(), Vec::new());
        if let Value::Map(entries) = &self.node().value {
            for (key, value) in entries {
                let part = if keys.iter().any(|k| k.as_ref() == key.text) { &mut inside } else { &mut outside };
                part.push((key.clone(), value.clone()));
            }
        }
        let with = |entries| {
            let node = Node::new(Value::Map(entries), self.node().span, Arc::clone(&self.node().file));
            self.with_node(node, self.path())
        };
        (with(inside), with(outside))
    }

    /// Returns `faults`, in which faults without a place, such as that of a missing file, are placed at the value of `key`.
    #[must_use]
    pub fn place_at(&self, key: &str, faults: Faults) -> Faults {
        Faults(faults.0.into_iter().map(|fault| self.placed(key, fault)).collect())
    }

    fn placed(&self, key: &str, fault: Fault) -> Fault {
        if fault.place.is_some() {
            return fault;
        }
        let placed = self.fault(key, fault.message);
        match fault.hint {
            Some(hint) => placed.hint(hint),
            None => placed,
        }
    }

    fn path_of(&self, key: &str) -> String {
        if self.path().is_empty() { key.to_owned() } else { format!("{}.{key}", self.path()) }
    }
}
