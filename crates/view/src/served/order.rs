//! What is asked of a desk.

use spectra_core::Isa;
use std::path::PathBuf;

/// What is rendered, and by what means.
#[derive(Clone, Debug)]
pub(crate) struct Order {
    pub scene: PathBuf,
    pub overrides: Vec<String>,
    pub isa: Isa,
    pub threads: usize,
}
