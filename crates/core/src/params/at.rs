//! A node on a walk through its tree, with the path to it.

use super::fault::Fault;
use super::node::Node;
use super::path::{Step, joined};

/// A node, the step that led to it, and the node before it. It is copied freely; the path is only written out for a fault.
#[derive(Clone, Copy)]
pub(super) struct At<'n, 'p> {
    pub node: &'n Node,
    /// Path of the node at which the walk began.
    prefix: &'n str,
    way: Option<(Step<'n>, &'p At<'n, 'p>)>,
}

impl<'n, 'p> At<'n, 'p> {
    pub(super) fn root(node: &'n Node, prefix: &'n str) -> Self {
        Self { node, prefix, way: None }
    }

    pub(super) fn child<'q>(&'q self, step: Step<'n>, node: &'n Node) -> At<'n, 'q> {
        At { node, prefix: self.prefix, way: Some((step, self)) }
    }

    /// Key of the node, if it has one.
    pub(super) fn key(&self) -> Option<&'n str> {
        match self.way {
            Some((Step::Key(key), _)) => Some(key),
            Some((Step::Index(_), _)) => None,
            None => self.prefix.rsplit('.').next().filter(|key| !key.is_empty() && !key.ends_with(']')),
        }
    }

    pub(super) fn path(&self) -> String {
        self.way.map_or_else(|| self.prefix.to_owned(), |(step, before)| joined(&before.path(), step))
    }

    /// Places a fault at this node.
    pub(super) fn fault(&self, fault: impl Into<Fault>) -> Fault {
        let (file, span) = self.node.place();
        fault.into().at(file, span).path(self.path())
    }
}
