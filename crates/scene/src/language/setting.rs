//! What is set for one of several pictures, and where paths of that may lead.

use spectra_core::params::{Fault, Key, Node, steps};
use std::sync::Arc;

/// The key of a sweep.
pub(super) const SWEEP: &str = "sweep";
/// The key of an animation.
pub(super) const ANIMATION: &str = "animation";
/// Sections that a path cannot lead into: they say what is made, and are used up before it is.
const RESERVED: [&str; 3] = ["include", SWEEP, ANIMATION];

/// One picture's own values: paths and what is put there, in order.
pub(super) type Setting = Vec<(String, Node)>;

/// Whether a path can be set; the key that it stands in is blamed.
pub(super) fn check_path(key: &Key, value: &Node, section: &str) -> Result<(), Fault> {
    let fault = |text: String| Fault::new(text).at(Arc::clone(&value.file), key.span).path(section);
    let found = steps(&key.text).map_err(|text| fault(text).hint("a path as of `--set`, such as `lens.f-number`"))?;
    match found.first() {
        Some(spectra_core::params::Step::Key(first)) if RESERVED.contains(first) => {
            Err(fault(format!("`{first}` cannot change from picture to picture"))
                .hint("a path leads into a stage, `render` or `variables`"))
        }
        _ => Ok(()),
    }
}
