//! Values that are set for one of several pictures, and the paths that they may have.

use spectra_core::params::{Fault, Key, Node, steps};
use std::sync::Arc;

/// The key `sweep` of a scene.
pub(super) const SWEEP: &str = "sweep";
/// The key `animation` of a scene.
pub(super) const ANIMATION: &str = "animation";
/// Sections that a path cannot lead into, because they define the pictures and are consumed before any is made.
const RESERVED: [&str; 3] = ["include", SWEEP, ANIMATION];

/// Values of one picture: paths and nodes, in order.
pub(super) type PictureValues = Vec<(String, Node)>;

/// Checks that a path can be set. A fault is placed at the key that holds the path.
pub(super) fn check_path(key: &Key, value: &Node, section: &str) -> Result<(), Fault> {
    let fault = |text: String| Fault::new(text).at(Arc::clone(&value.file), key.span).path(section);
    let found =
        steps(&key.text).map_err(|text| fault(text).hint("write a path as for `--set`, such as `lens.f-number`"))?;
    match found.first() {
        Some(spectra_core::params::Step::Key(first)) if RESERVED.contains(first) => {
            Err(fault(format!("`{first}` cannot change from picture to picture"))
                .hint("a path leads into a stage, `render` or `variables`"))
        }
        _ => Ok(()),
    }
}
