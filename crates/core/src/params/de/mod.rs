//! From a [`Node`] to a typed value, with every fault of the tree in one go.
//!
//! serde stops at the first error. So the tree is walked again and again: what failed is remembered
//! by its node, and the next walk gives it a placeholder that goes through ([`placeholder`]), so that the walk
//! reaches what lies behind. A missing key gets a placeholder too. Unknown keys need no second walk. The
//! value of such a walk is thrown away, and an error that could come from a placeholder is not reported.

mod access;
mod error;
mod findings;
mod placeholder;
mod walker;

use super::fault::Faults;
use super::node::Node;
use findings::Findings;
use serde::de::DeserializeOwned;
use walker::Walker;

/// Name by which a field asks for the node itself.
pub(super) const NODE: &str = "spectra::node";

/// A value from a node, or everything that is wrong with it. `prefix` is the path of the node.
pub(super) fn parse<T: DeserializeOwned>(node: &Node, prefix: &str) -> Result<T, Faults> {
    let findings = Findings::new(node, prefix);
    loop {
        let root = Walker::root(node, &findings);
        let result = T::deserialize(root).map_err(|error| root.place(error));
        match result {
            Ok(value) => return findings.finish().into_result(value),
            Err(error) => {
                if !findings.absorb(error) {
                    return Err(findings.finish());
                }
            }
        }
    }
}
